//! Sunlight from a point, with exact shadows.

use super::{Bound, EffectKind, Finding, Given};
use crate::spectral::Light;

/// Shadows and fractions are exact to this, relative: what the tests hold them to.
const ROUNDING: f64 = 1e-9;

pub(super) const KIND: EffectKind = EffectKind {
    key: "sunlight",
    name: "sunlight",
    equation: Some("physics::sun::irradiance_on_facet"),
    step: Some("visibility::Seen, solve::irradiance"),
    light: Some(Light::is_lit),
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    Finding {
        modelled: true,
        bound: given.error_of_all(),
        remaining: Some(Bound { lit: ROUNDING, shadow: ROUNDING }),
        note: "exact shadows and areas of plane facets. The spectrum is an input: E490 is uncertain by 1 to 3 % below 2 um, 3 to 5 % above 2.5 um"
            .into(),
        because: "all of the light".into(),
        ..Finding::default()
    }
}
