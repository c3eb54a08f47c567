//! Reflectance that depends on the directions of light and view.

use super::{EffectKind, Finding, Given, left_out, modelled};
use crate::geometry::angle_rad;
use crate::scene::Material;
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    name: "photometric function",
    equation: Some("physics::reflectance::Brdf"),
    step: Some("solve::Emission"),
    light: Some(Light::is_lit),
    find,
};

fn find(given: &Given) -> Finding {
    let camera_m = given.scene.exposure.camera.centre_m();
    let phase_deg = angle_rad(camera_m, given.scene.sky.sun.direction.vec()).to_degrees();
    let is_lambert = |material: &&&Material| material.photometry.key().is_none();
    let lambert: Vec<&str> = given.materials.iter().filter(is_lambert).map(|material| material.name.as_str()).collect();
    if lambert.is_empty() {
        return modelled(
            None,
            "each material by its model, at the angles of the middle of what is seen, and lit, of a facet in a pixel; how far a model is from the surface is not known",
        );
    }
    let which = match lambert.len() {
        n if n == given.materials.len() => "surfaces are Lambert".to_owned(),
        _ => format!("of the materials, {} are Lambert", lambert.join(", ")),
    };
    let note = format!(
        "{which}, and smooth below the size of a facet. No bound without a photometric function: one fitted to Phobos \
         gives 0.37 times the radiance of a Lambert surface of its geometric albedo at 30 deg phase, 0.25 at 60 deg; here the \
         phase angle at the origin is {phase_deg:.1} deg"
    );
    left_out(None, note)
}
