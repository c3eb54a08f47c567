//! What can be said about a simulation before it is run: what it will take, and what its user should know.

use super::cost;
use super::extremes::Extremes;
use super::plan::Plan;
use super::summary::{self, Summary};
use super::warnings::{self, Sight};
use crate::scene::Scene;

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

/// Looks at a scene without simulating it, as it is planned.
pub fn dry_run(scene: &Scene, extremes: &Extremes, plan: &Plan) -> DryRun {
    let Extremes { site, glimpse, open_to_shadow, .. } = extremes;
    let summary = summary::summary(scene, site);
    let sight =
        Sight { sees_mesh: glimpse.facets_in_frame > 0, back_share: glimpse.back_share(scene), about: "about " };
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
