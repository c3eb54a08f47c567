//! Mars before the Sun.

use super::{Bound, EffectKind, Finding, Given};
use crate::geometry::Direction;
use crate::physics::sun::{self, Eclipse};
use crate::scene::Setup;

pub(super) const KIND: EffectKind = EffectKind {
    key: "eclipse",
    name: "eclipse by Mars",
    equation: Some("physics::sun::eclipse"),
    step: None,
    light: None,
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let found = |missing: Option<&str>, bound, because: &str| Finding {
        missing: missing.map(str::to_owned),
        bound,
        note: "where Mars and the Sun are seen from the scene's origin".into(),
        because: because.into(),
        ..Finding::default()
    };
    let all = || given.error_of_all();
    match by_mars(given.scene) {
        None => found(Some("no Mars in the scene"), None, "not known without a Mars"),
        Some(Eclipse::None) => found(None, Some(Bound::NOTHING), "Mars is not in front of the Sun"),
        Some(Eclipse::Partial) => found(None, all(), "Mars covers part of the Sun's disc: the site has less sunlight"),
        Some(Eclipse::Total) => found(None, all(), "Mars covers the Sun: the site has no sunlight"),
    }
}

/// Whether Mars covers the Sun; `None` without Mars.
pub(in crate::study) fn by_mars(scene: &Setup) -> Option<Eclipse> {
    let mars = scene.sky.mars.as_ref()?;
    let (towards_m, sun_rad) = (Direction::new(mars.centre_m)?, sun::angular_radius_rad(scene.sky.sun.distance_m));
    let separation_rad = scene.sky.sun.direction.angle_rad(towards_m);
    Some(sun::eclipse(separation_rad, (mars.radius_m / mars.centre_m.length()).asin(), sun_rad))
}
