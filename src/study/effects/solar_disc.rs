//! Penumbrae: the Sun is no point.

use super::{EffectKind, Finding, Given, left_out, modelled};
use crate::physics::{bounds, sun};
use crate::scene::SunModel;

pub(super) const KIND: EffectKind = EffectKind {
    name: "the Sun's disc",
    equation: Some("physics::bounds::penumbra_width_m"),
    step: Some("solve::lit, solve::irradiance"),
    light: None,
    find,
};

fn find(given: &Given) -> Finding {
    let (ray_m, pixel_m) = (given.longest_ray_m(), given.pixel_m());
    let sun_rad = sun::angular_radius_rad(given.scene.sky.sun.distance_m);
    // Square to the rays. On a slope the penumbra is wider by 1 / cos i, and as much less bright.
    let wide_px = bounds::penumbra_width_m(ray_m, sun_rad, 1.0) / pixel_m;
    let note = format!(
        "the Sun is a point. Only pixels that a shadow's edge crosses change, and slopes along the rays: with the edge's cause at \
         most {ray_m:.0} m away, penumbrae are up to {wide_px:.2} pixels wide, square to the light"
    );
    if let SunModel::Disc(rule) = given.scene.models.sun {
        let edge = bounds::shadow_edge(rule.edge_error(), given.scene.sky.sun.sin_radius(), ray_m, pixel_m, 1.0);
        let note = format!(
            "{} points stand for the disc, and facets cut it by their own horizon exactly. The bound is that of a pixel which one straight shadow edge \
             crosses, its cause at most {ray_m:.0} m away",
            rule.count()
        );
        return modelled(given.all_light().map(|all| edge * all), note);
    }
    let edge = given.all_light().map(|all| wide_px.min(1.0) * all);
    let slope = given.reference.cos_incidence.map(|cos| bounds::terminator(sun_rad) / cos);
    left_out(edge.zip(slope).map(|(edge, slope)| edge + slope), note)
}
