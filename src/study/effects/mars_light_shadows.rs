//! Terrain between a facet and Mars.

use super::{EffectKind, Finding, Given, left_out};
use crate::spectral::Light;

pub(super) const KIND: EffectKind =
    EffectKind { name: "shadows in Mars-light", equation: None, step: None, light: Some(Light::is_lit), find };

fn find(given: &Given) -> Finding {
    let bound = match &given.scene.sky.mars {
        Some(_) if given.reference.largest_mars_irradiance == 0.0 => Some(0.0),
        _ => given.mars_light_bound(),
    };
    left_out(bound, "a facet's own horizon cuts Mars, other terrain does not: up to all of the Mars-light")
}
