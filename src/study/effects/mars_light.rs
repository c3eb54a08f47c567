//! Sunlight that Mars reflects.

use super::{EffectKind, Finding, Given, left_out, modelled};
use crate::physics::mars_light::MARS_LIGHT_ERROR;
use crate::scene::{MARS_ALBEDO, MarsModel};
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    name: "Mars-light",
    equation: Some("physics::mars_light::MarsLight"),
    step: Some("solve::irradiance"),
    light: Some(Light::is_lit),
    find,
};

fn find(given: &Given) -> Finding {
    let bound = given.mars_light_bound();
    match given.scene.sky.mars.as_ref().map(|_| given.scene.models.mars_light) {
        Some(MarsModel::NearField) => modelled(
            bound.map(|b| b * MARS_LIGHT_ERROR),
            "a Lambert sphere in the near field, with phase, tilt and each facet's horizon; uniform and without an atmosphere: the albedo is an input",
        ),
        Some(MarsModel::Thesis) => modelled(
            bound.map(|b| 2.0 * b),
            "Domagala (2020), equations (4) to (8) as printed: no phase, no horizon; 2.4 times the light of a full Lambert sphere",
        ),
        None => left_out(
            bound,
            format!(
                "no Mars in the scene: the bound is that of a full Mars of albedo {MARS_ALBEDO} over Phobos. It is the main light in shadows that face Mars"
            ),
        ),
    }
}
