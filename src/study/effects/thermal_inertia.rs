//! Heat that is stored and conducted.

use super::given::emission;
use super::{EffectKind, Finding, Given};
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "thermal-inertia",
    name: "thermal inertia",
    equation: Some("physics::conduction"),
    step: None,
    light: Some(Light::glows),
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let noon_k = given.noon_k;
    Finding {
        missing: Some("no rotation and no thermal inertia are stated".into()),
        bound: given.error(|at, material, _, _| emission(material, at.um, noon_k)),
        note: "no heat is stored or conducted".into(),
        because: format!(
            "the emission at {noon_k:.1} K, of a facet under the Sun at its zenith: what a fresh shadow might still send, and more than equilibrium \
             can be wrong in sunlight"
        ),
        ..Finding::default()
    }
}
