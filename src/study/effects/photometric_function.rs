//! Reflectance that depends on the directions of light and view.

use super::{EffectKind, Finding, Given, left_out};
use crate::geometry::angle_rad;
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    name: "photometric function",
    equation: Some("physics::reflectance::Brdf"),
    step: None,
    light: Some(Light::is_lit),
    find,
};

fn find(given: &Given) -> Finding {
    let camera_m = given.scene.exposure.camera.centre_m();
    let phase_deg = angle_rad(camera_m, given.scene.sky.sun.direction.vec()).to_degrees();
    let note = format!(
        "surfaces are Lambert, and smooth below the size of a facet. No bound without a photometric function: one fitted to Phobos \
         gives 0.37 times the radiance of a Lambert surface of its geometric albedo at 30 deg phase, 0.25 at 60 deg; here the \
         phase angle at the origin is {phase_deg:.1} deg"
    );
    left_out(None, note)
}
