//! Penumbrae: the Sun is no point.

use super::given::reflectance;
use super::{EffectKind, Finding, Given};
use crate::physics::{bounds, sun};

pub(super) const KIND: EffectKind = EffectKind {
    key: "sun-disc",
    name: "the Sun's disc",
    equation: Some("physics::bounds::penumbra_width_m"),
    step: None,
    light: None,
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let (ray_m, pixel_m) = (given.longest_ray_m(), given.pixel_m());
    let sun_rad = sun::angular_radius_rad(given.scene.sky.sun.distance_m);
    // Square to the rays. On a slope the penumbra is wider by 1 / cos i, and as much less bright.
    let wide_px = bounds::penumbra_width_m(ray_m, sun_rad, 1.0) / pixel_m;
    let edge = given.error_of_edges(wide_px);
    // A facet along the rays.
    let slope = given.error(|at, material, class, _| match class.least_cos_incidence <= sun_rad {
        true => reflectance(material, at.um) * at.white * bounds::terminator(sun_rad),
        false => 0.0,
    });
    Finding {
        missing: Some("the Sun is a point".into()),
        bound: edge.zip(slope).map(|(edge, slope)| edge.and(&slope)),
        note: "only pixels that a shadow's edge crosses change, and slopes along the rays".into(),
        because: format!(
            "with the edge's cause at most {ray_m:.0} m away, penumbrae are up to {wide_px:.2} pixels wide, square to the light"
        ),
        ..Finding::default()
    }
}
