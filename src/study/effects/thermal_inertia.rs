//! Heat that is stored and conducted.

use super::{EffectKind, Finding, Given, left_out};
use crate::spectral::Light;

pub(super) const KIND: EffectKind =
    EffectKind { name: "thermal inertia", equation: None, step: None, light: Some(Light::glows), find };

fn find(given: &Given) -> Finding {
    let noon_k = given.noon_k;
    left_out(
        given.emitted(noon_k),
        format!(
            "no heat is stored, conducted or exchanged between facets. The bound is the emission at {noon_k:.1} K, of a facet \
             under the Sun at its zenith: what a fresh shadow might still send, and more than equilibrium can be wrong in sunlight"
        ),
    )
}
