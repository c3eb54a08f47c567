//! Mars, or another body of the sky, before the Sun.

use glam::DVec3;

use super::{Bound, EffectKind, Finding, Given, Switch, thermal_inertia};
use crate::geometry::Direction;
use crate::physics::sun::{self, Eclipse};
use crate::physics::sun_disc::steepest_share;
use crate::scene::{Globe, Setup, Sky};

pub(super) const KIND: EffectKind = EffectKind {
    key: "eclipse",
    name: "eclipses",
    equation: Some("physics::sun_disc::share_beside_sphere"),
    step: Some("solve::irradiance"),
    light: None,
    switch: Some(Switch {
        add: |models, _, given, _| models.eclipses = given.scene.sky.globes().next().is_some(),
        remove: |models| models.eclipses = false,
        stated: |fixed| fixed.eclipses.then_some("mars.eclipse"),
        cost_s: |_, _| 0.0,
        own: None,
        drops_by_own: false,
    }),
    find,
};

/// What a flat disc leaves out: share of the Sun.
const ROUNDING: f64 = 1e-3;

fn find(given: &Given) -> Finding {
    let found = |missing: Option<&str>, bound, because: &str| {
        Finding {
        modelled: given.models.eclipses && given.scene.sky.globes().next().is_some(),
        missing: missing.map(str::to_owned),
        bound,
        remaining: match by_globes(given.scene) {
            Some(Eclipse::Partial) => {
                let share = (ROUNDING + across_facets(given.scene)).min(1.0);
                Some(Bound { lit: share, shadow: share })
            }
            _ => Some(Bound::NOTHING),
        },
        note: "each facet has the sunlight that bodies of the sky leave, seen from its centroid; what is left is of the Sun's share, and grows with facets, over \
               which the edge of the shadow passes"
            .into(),
        because: because.into(),
    }
    };
    match by_globes(given.scene) {
        None => found(Some("no Mars in the scene"), None, "not known without a Mars, or another body"),
        Some(Eclipse::None) if thermal_inertia::missing(given).is_none() => found(
            None,
            None,
            "nothing is in front of the Sun now; ground that keeps its heat may have lain in eclipse before",
        ),
        Some(Eclipse::None) => found(None, Some(Bound::NOTHING), "nothing is in front of the Sun"),
        Some(Eclipse::Partial) => {
            found(None, None, "part of the Sun's disc is covered: relative to what light is left, there is no bound")
        }
        Some(Eclipse::Total) => found(None, None, "the Sun is covered: the site has no sunlight"),
    }
}

/// What the share of the Sun may differ by, at most, between a facet's centroid and elsewhere on it.
///
/// Who moves by h sees a limb move by h over how far that is away, along the tangent.
fn across_facets(scene: &Setup) -> f64 {
    let (mesh, sun) = (&scene.body.mesh, &scene.sky.sun);
    let Some((low_m, high_m)) = scene.body.bounds_m() else { return 0.0 };
    let of_facet = |f: usize| {
        let facet = mesh.facet(f);
        facet.corners_m.map(|corner_m| (corner_m - facet.centroid_m()).length()).into_iter().fold(0.0, f64::max)
    };
    let widest_m = (0..mesh.facets.len()).map(of_facet).fold(0.0, f64::max);
    let (middle_m, half_m) = (0.5 * (low_m + high_m), 0.5 * (high_m - low_m).length());
    let of_sphere = |(centre_m, radius_m): (DVec3, f64)| {
        let nearest_m = ((centre_m - middle_m).length() - half_m).max(radius_m);
        let to_limb_m = ((nearest_m - radius_m) * (nearest_m + radius_m)).sqrt();
        steepest_share(sun.limb_darkening) * widest_m / to_limb_m / sun.sin_radius().asin()
    };
    let hiding =
        scene.sky.globes().filter(|globe| !matches!(by(scene, globe, (low_m, high_m)), None | Some(Eclipse::None)));
    hiding.map(|globe| of_sphere((globe.centre_m, globe.radius_m))).sum()
}

/// Whether some body of the sky covers the Sun: wholly if from everywhere, not if from nowhere; `None` without any.
pub(in crate::study) fn by_globes(scene: &Setup) -> Option<Eclipse> {
    let mut worst = None;
    for (_, eclipse) in eclipses(scene) {
        worst = match (worst, eclipse) {
            (Some(Eclipse::Total), _) | (_, Eclipse::Total) => Some(Eclipse::Total),
            (Some(Eclipse::Partial), _) | (_, Eclipse::Partial) => Some(Eclipse::Partial),
            _ => Some(Eclipse::None),
        };
    }
    worst
}

/// Who covers it.
pub(in crate::study) fn whose(scene: &Setup) -> String {
    let names: Vec<&str> = eclipses(scene)
        .filter(|(_, eclipse)| *eclipse != Eclipse::None)
        .map(|(globe, _)| if globe.name == Sky::MARS { "Mars" } else { globe.name.as_str() })
        .collect();
    names.join(" and ")
}

fn eclipses(scene: &Setup) -> impl Iterator<Item = (&Globe, Eclipse)> {
    let box_m = scene.body.bounds_m();
    scene.sky.globes().filter_map(move |globe| Some((globe, by(scene, globe, box_m?)?)))
}

fn by(scene: &Setup, globe: &Globe, (low_m, high_m): (DVec3, DVec3)) -> Option<Eclipse> {
    if globe.centre_m.length() >= scene.sky.sun.distance_m {
        return Some(Eclipse::None);
    }
    let (to_centre_m, half_m) = (globe.centre_m - 0.5 * (low_m + high_m), 0.5 * (high_m - low_m).length());
    let sun_rad = sun::angular_radius_rad(scene.sky.sun.distance_m);
    let separation_rad = scene.sky.sun.direction.angle_rad(Direction::new(to_centre_m)?);
    // From elsewhere on the mesh it is in another direction, and as much larger or smaller.
    let off_rad = half_m / (to_centre_m.length() - half_m).max(0.0);
    let from = |off_rad: f64| {
        sun::eclipse(separation_rad + off_rad, (globe.radius_m / to_centre_m.length()).min(1.0).asin(), sun_rad)
    };
    Some(match (from(-2.0 * off_rad), from(2.0 * off_rad)) {
        (Eclipse::None, _) => Eclipse::None,
        (_, Eclipse::Total) => Eclipse::Total,
        _ => Eclipse::Partial,
    })
}
