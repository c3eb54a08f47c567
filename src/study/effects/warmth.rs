//! What more heat changes of what a facet sends.

use super::Given;
use super::given::{Place, emission};
use crate::scene::Thermal;

/// Radiance that a facet sends more, W m-2 sr-1 um-1, if it has so much heat more, whatever its surroundings and others send.
pub(super) fn sent(given: &Given, place: &Place, more_w_m2: f64) -> f64 {
    let Place { at, material, class, side, least } = *place;
    if !at.light.glows() || given.models.thermal != Thermal::Equilibrium {
        return 0.0;
    }
    let cos_incidence = side.most_cos_incidence(class);
    let emitted = |w_m2: f64| emission(material, at.um, given.temperature_k(material, cos_incidence, w_m2));
    let added = |others_w_m2: f64| emitted(others_w_m2 + more_w_m2) - emitted(others_w_m2);
    // What adds to a warmer facet changes more at short wavelengths, until it is brighter by its warmth than by all else: from there on, it changes less of that.
    let brightest_w_m2 = given.heat_to_emit(at, material, cos_incidence, least);
    added(brightest_w_m2.min(given.others_w_m2(class)).max(0.0)).max(added(0.0))
}
