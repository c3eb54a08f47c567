//! What can be said about a simulation before it is run: what it will take, and what its user should know.

use super::cost;
use super::extremes::Extremes;
use super::glimpse::Glimpse;
use super::moving::Moving;
use super::plan::Plan;
use super::summary::{self, Summary};
use super::warnings::{self, Sight};
use crate::scene::{Scene, Take};

/// What can be said about a simulation before it is run.
#[derive(Debug, Clone, PartialEq)]
pub struct DryRun {
    /// The scene in a few numbers.
    pub summary: Summary,
    /// About the share of the image that the surface fills: of some 4000 rays.
    pub filled: f64,
    /// About what the process will hold at most, bytes.
    pub memory_bytes: u64,
    /// Approximate size of the product on the disk with default options, bytes.
    pub product_bytes: u64,
    /// About the CPU time, s, within a factor of [`WITHIN`](super::WITHIN) on a machine of 2022.
    pub cpu_s: f64,
    /// The warnings that the result will carry, as sentences. What is hidden or in shadow is judged by a few rays only.
    pub warnings: Vec<String>,
}

/// Exposures of a scene taken in parts that are looked through, if the one in the middle sees nothing.
const LOOKS: usize = 32;

/// Looks at a scene without simulating it, as it is planned; `moving` is how it is taken in parts, if it is.
pub fn dry_run(scene: &Scene, moving: Option<Moving<'_>>, extremes: &Extremes, plan: &Plan) -> DryRun {
    let Extremes { site, glimpse, open_to_shadow, .. } = extremes;
    let summary = summary::summary(scene, site);
    let sees_mesh = glimpse.facets_in_frame > 0 || moving.is_some_and(sees_some);
    let sight = Sight { sees_mesh, back_share: glimpse.back_share(scene), about: "about " };
    let dark = (!glimpse.faces_sun).then(|| "nothing is lit: the Sun is below every facet".to_owned());
    DryRun {
        filled: glimpse.filled(),
        memory_bytes: cost::memory_bytes(scene, false),
        product_bytes: cost::product_bytes(scene, 4),
        cpu_s: plan.cpu_s,
        warnings: [
            scene.remarks(),
            warnings::of_sight(&sight, dark),
            warnings::of_scene(scene, site, *open_to_shadow, true),
        ]
        .concat(),
        summary,
    }
}

/// Whether any of some exposures, evenly in time, might see a facet: slits and mirrors look elsewhere than the frame in the middle.
fn sees_some(moving: Moving<'_>) -> bool {
    let takes: Vec<Take> = moving.timing.takes(&moving.scene.exposure).collect();
    let some = (0..LOOKS.min(takes.len())).map(|i| &takes[i * takes.len() / LOOKS.min(takes.len())]);
    // A pose that is not known is told of elsewhere.
    let mut exposures = some.filter_map(|take| moving.exposure(take).ok());
    exposures.any(|exposure| Glimpse::through(moving.scene, &exposure.camera).facets_in_frame > 0)
}
