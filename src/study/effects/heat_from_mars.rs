//! What Mars warms.

use super::by_others::{self, Brought};
use super::given::mars_seen;
use super::{Bound, EffectKind, Finding, Given, warmth};
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
    match given.models.thermal {
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
    if given.models.thermal != Thermal::Equilibrium {
        return Some(Bound::NOTHING);
    }
    let (_, has_mars) = mars_seen(given.scene, given.extremes);
    // Reflected or emitted, Mars sends no more than sunlight at its zenith.
    given.error_without(|place| {
        let of_mars = if has_mars { place.class.most_of_mars } else { given.most_of_mars() };
        let brought = Brought { white: 0.0, all_w_m2: given.mars_w_m2(given.most_of_mars()) };
        warmth::sent(given, place, given.mars_w_m2(of_mars)) + by_others::sent(given, place, brought)
    })
}
