//! Mars before the Sun.

use super::{Bound, EffectKind, Finding, Given, Switch};
use crate::geometry::Direction;
use crate::physics::sun::{self, Eclipse};
use crate::scene::Setup;

pub(super) const KIND: EffectKind = EffectKind {
    key: "eclipse",
    name: "eclipse by Mars",
    equation: Some("physics::sun_disc::share_beside_sphere"),
    step: Some("solve::irradiance"),
    light: None,
    switch: Some(Switch {
        add: |models, _, given, _| models.eclipses = given.scene.sky.mars.is_some(),
        remove: |models| models.eclipses = false,
        cost_s: |_, _| 0.0,
        own: None,
        drops_by_own: false,
    }),
    find,
};

/// What a flat disc, and one value on a facet, leave out: share of the Sun.
const ROUNDING: f64 = 1e-3;

fn find(given: &Given) -> Finding {
    let found = |missing: Option<&str>, bound, because: &str| Finding {
        modelled: given.models.eclipses && given.scene.sky.mars.is_some(),
        missing: missing.map(str::to_owned),
        bound,
        remaining: match by_mars(given.scene) {
            Some(Eclipse::Partial) => Some(Bound { lit: ROUNDING, shadow: ROUNDING }),
            _ => Some(Bound::NOTHING),
        },
        note: "each facet has the sunlight that Mars leaves, seen from its centroid".into(),
        because: because.into(),
    };
    match by_mars(given.scene) {
        None => found(Some("no Mars in the scene"), None, "not known without a Mars"),
        Some(Eclipse::None) => found(None, Some(Bound::NOTHING), "Mars is not in front of the Sun"),
        Some(Eclipse::Partial) => {
            found(None, None, "Mars covers part of the Sun's disc: relative to what light is left, there is no bound")
        }
        Some(Eclipse::Total) => found(None, None, "Mars covers the Sun: the site has no sunlight"),
    }
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
