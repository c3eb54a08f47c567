//! Mars before the Sun.

use super::{EffectKind, Finding, Given, left_out};
use crate::geometry::Direction;
use crate::physics::sun::{self, Eclipse};
use crate::scene::Setup;

pub(super) const KIND: EffectKind =
    EffectKind { name: "eclipse by Mars", equation: Some("physics::sun::eclipse"), step: None, light: None, find };

fn find(given: &Given) -> Finding {
    let (bound, note) = match by_mars(given.scene) {
        None => (None, "no Mars in the scene: not known"),
        Some(Eclipse::None) => (Some(0.0), "Mars is not in front of the Sun"),
        Some(Eclipse::Partial) => (given.all_light(), "Mars covers part of the Sun's disc: the site has less sunlight"),
        Some(Eclipse::Total) => (given.all_light(), "Mars covers the Sun: the site has no sunlight"),
    };
    left_out(bound, note)
}

/// Whether Mars covers the Sun; `None` without Mars.
pub(in crate::study) fn by_mars(scene: &Setup) -> Option<Eclipse> {
    let mars = scene.sky.mars.as_ref()?;
    let (towards_m, sun_rad) = (Direction::new(mars.centre_m)?, sun::angular_radius_rad(scene.sky.sun.distance_m));
    let separation_rad = scene.sky.sun.direction.angle_rad(towards_m);
    Some(sun::eclipse(separation_rad, (mars.radius_m / mars.centre_m.length()).asin(), sun_rad))
}
