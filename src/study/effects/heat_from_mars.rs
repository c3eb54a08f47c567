//! What Mars warms.

use super::given::{emission, mars_seen};
use super::{EffectKind, Finding, Given, left_out, modelled};
use crate::physics::heat;
use crate::scene::Thermal;
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    name: "heat from Mars",
    equation: Some("physics::mars::uniform_sphere_form_factor"),
    step: Some("solve::irradiance"),
    light: Some(Light::glows),
    find,
};

fn find(given: &Given) -> Finding {
    let (q, has_mars) = mars_seen(given.scene, given.site);
    let total_w_m2 = given.scene.sky.sun.total_irradiance_w_m2();
    // Reflected or emitted, Mars sends no more than sunlight at its zenith.
    let bound = given.largest_up_to(given.noon_k, |um, m, t_k| {
        let own_w_m2 = heat::emitted_w_m2(t_k, m.emissivity_bolometric);
        let heated_k = heat::equilibrium_temperature_k(own_w_m2 + q * q * total_w_m2, m.emissivity_bolometric);
        emission(m, um, heated_k) - emission(m, um, t_k)
    });
    match given.scene.models.thermal {
        Thermal::Equilibrium if has_mars => modelled(
            bound,
            "sunlight that Mars reflects, and its mean thermal exitance on day and night side alike; the bound is all of it",
        ),
        Thermal::Equilibrium => left_out(bound, "no Mars in the scene: the bound is that of a full Mars over Phobos"),
        _ => left_out(bound, "the thermal model has no heat balance"),
    }
}
