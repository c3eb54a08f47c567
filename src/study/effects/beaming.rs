//! Warmth that roughness below the facets sends towards the Sun.

use super::given::{Place, emission};
use super::{EffectKind, Finding, Given};
use crate::scene::Thermal;
use crate::spectral::Light;

/// The beaming parameter of rough ground at small phase angles: it emits as if its temperature were higher by this to the power of -1/4. Lebofsky et al.
/// (1986), Icarus 68, 239, have 0.756 for Ceres and Pallas; of most asteroids it is between that and 1.
const ETA: f64 = 0.756;

pub(super) const KIND: EffectKind = EffectKind {
    key: "thermal-beaming",
    name: "thermal beaming",
    equation: None,
    step: None,
    light: Some(Light::glows),
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let bound = given.error(|&Place { at, material, class, side, .. }| {
        let others = given.others_w_m2(class);
        let t_k = given.temperature_k(material, side.most_cos_incidence(class), others);
        emission(material, at.um, t_k / ETA.powf(0.25)) - emission(material, at.um, t_k)
    });
    Finding {
        missing: Some("facets are smooth".into()),
        bound: if given.models.thermal == Thermal::Off { None } else { bound },
        note: "shadows too small for the mesh are cold, and what faces the Sun is warmer than the mean".into(),
        because: format!(
            "temperatures of sunlit ground higher by {:.1} %, as asteroids show it (eta = {ETA}); looking away from the Sun it is the other way round",
            100.0 * (ETA.powf(-0.25) - 1.0)
        ),
        ..Finding::default()
    }
}
