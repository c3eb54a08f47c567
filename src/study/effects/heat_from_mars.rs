//! What Mars warms.

use super::given::{emission, mars_seen};
use super::{Bound, EffectKind, Finding, Given};
use crate::scene::Thermal;
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "mars-heat",
    name: "heat from Mars",
    equation: Some("physics::mars::uniform_sphere_form_factor"),
    step: Some("solve::irradiance"),
    light: Some(Light::glows),
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let (_, has_mars) = mars_seen(given.scene, given.extremes);
    let bound = bound(given);
    let because = "as much heat, on day and night side alike, as sunlight at its zenith would be".to_owned();
    let found = |modelled, missing: Option<&str>, note: &str| Finding {
        modelled,
        missing: missing.map(str::to_owned),
        bound,
        remaining: None,
        note: note.into(),
        because,
    };
    match given.scene.models.thermal {
        Thermal::Equilibrium if has_mars => found(
            true,
            None,
            "sunlight that Mars reflects, and its mean thermal exitance on day and night side alike, which is an input",
        ),
        Thermal::Equilibrium => {
            found(false, Some("no Mars in the scene"), "the bound is that of a full Mars over Phobos")
        }
        _ => found(false, Some("no heat balance"), "it comes with thermal emission, in equilibrium"),
    }
}

/// What warmth from Mars changes at most.
pub(super) fn bound(given: &Given) -> Option<Bound> {
    if given.scene.models.thermal != Thermal::Equilibrium {
        return Some(Bound::NOTHING);
    }
    let (_, has_mars) = mars_seen(given.scene, given.extremes);
    // Reflected or emitted, Mars sends no more than sunlight at its zenith.
    given.error(|at, material, class, side| {
        if !at.light.glows() {
            return 0.0;
        }
        let of_mars = if has_mars { class.most_of_mars } else { given.most_from_mars() };
        let around = given.most_around() + given.most_from_bodies();
        let cos_incidence = side.most_cos_incidence(class);
        let warmed = |heat: f64| emission(material, at.um, given.temperature_k(material, cos_incidence, heat));
        // What adds to a warmer facet changes more, at short wavelengths.
        (warmed(of_mars + around) - warmed(around)).max(warmed(of_mars) - warmed(0.0))
    })
}
