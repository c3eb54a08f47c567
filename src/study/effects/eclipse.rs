//! Mars before the Sun.

use super::{EffectKind, Finding, Given, left_out, modelled};
use crate::geometry::Direction;
use crate::physics::sun::{self, Eclipse};
use crate::scene::Setup;

pub(super) const KIND: EffectKind = EffectKind {
    name: "eclipse by Mars",
    equation: Some("physics::sun_disc::share_beside_sphere"),
    step: Some("solve::irradiance"),
    light: None,
    find,
};

/// What a flat disc, and one value on a facet, leave out: share of the Sun.
const ROUNDING: f64 = 1e-3;

fn find(given: &Given) -> Finding {
    if given.scene.models.eclipses && given.scene.sky.mars.is_some() {
        let is_partial = by_mars(given.scene) == Some(Eclipse::Partial);
        let bound = if is_partial { given.all_light().map(|all| all * ROUNDING) } else { Some(0.0) };
        return modelled(bound, "each facet has the sunlight that Mars leaves, seen from its centroid");
    }
    let (bound, note) = match by_mars(given.scene) {
        None => (None, "no Mars in the scene: not known"),
        Some(Eclipse::None) => (Some(0.0), "Mars is not in front of the Sun"),
        Some(Eclipse::Partial) => (given.all_light(), "Mars covers part of the Sun's disc: the site has less sunlight"),
        Some(Eclipse::Total) => (given.all_light(), "Mars covers the Sun: the site has no sunlight"),
    };
    left_out(bound, note)
}

/// Whether Mars covers the Sun: wholly if from everywhere, not if from nowhere; `None` without Mars.
pub(in crate::study) fn by_mars(scene: &Setup) -> Option<Eclipse> {
    let mars = scene.sky.mars.as_ref()?;
    let (low_m, high_m) = scene.body.bounds_m()?;
    let (to_mars_m, half_m) = (mars.centre_m - 0.5 * (low_m + high_m), 0.5 * (high_m - low_m).length());
    let sun_rad = sun::angular_radius_rad(scene.sky.sun.distance_m);
    let separation_rad = scene.sky.sun.direction.angle_rad(Direction::new(to_mars_m)?);
    // From elsewhere on the mesh Mars is in another direction, and as much larger or smaller.
    let off_rad = half_m / (to_mars_m.length() - half_m).max(0.0);
    let from = |off_rad: f64| {
        sun::eclipse(separation_rad + off_rad, (mars.radius_m / to_mars_m.length()).min(1.0).asin(), sun_rad)
    };
    Some(match (from(-2.0 * off_rad), from(2.0 * off_rad)) {
        (Eclipse::None, _) => Eclipse::None,
        (_, Eclipse::Total) => Eclipse::Total,
        _ => Eclipse::Partial,
    })
}
