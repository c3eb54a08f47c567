//! Reflectance that depends on the directions of light and view.

use super::{Bound, EffectKind, Finding, Given};
use crate::geometry::angle_rad;
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "photometric-function",
    name: "photometric function",
    equation: Some("physics::reflectance::Brdf"),
    step: Some("solve::Emission"),
    light: Some(Light::is_lit),
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let camera_m = given.scene.exposure.camera.centre_m();
    let phase_deg = angle_rad(camera_m, given.scene.sky.sun.direction.vec()).to_degrees();
    let materials = given.materials.iter().map(|(_, material)| material);
    let lambert: Vec<&str> = materials
        .filter(|material| material.photometry.key().is_none())
        .map(|material| material.name.as_str())
        .collect();
    if lambert.is_empty() {
        return Finding {
            modelled: true,
            remaining: Some(Bound::NOTHING),
            note: "each material by its model, at the angles of the middle of what is seen, and lit, of a facet in a pixel; how far a model is from \
                   the surface is not known"
                .into(),
            because: "the model is an input".into(),
            ..Finding::default()
        };
    }
    let which = match lambert.len() {
        n if n == given.materials.len() => "surfaces are Lambert".to_owned(),
        _ => format!("of the materials, {} are Lambert", lambert.join(", ")),
    };
    Finding {
        missing: Some(format!("{which}, and smooth below the size of a facet")),
        note: format!("the phase angle at the origin is {phase_deg:.1} deg"),
        because: "no bound without a photometric function: one fitted to Phobos gives 0.37 times the radiance of a Lambert surface of its geometric \
                  albedo at 30 deg phase, 0.25 at 60 deg"
            .into(),
        ..Finding::default()
    }
}
