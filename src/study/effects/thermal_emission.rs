//! What a surface emits at its temperature.

use super::given::emission;
use super::{EffectKind, Finding, Given, left_out, modelled};
use crate::scene::Thermal;
use crate::solve::interpolation_error;
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    name: "thermal emission",
    equation: Some("physics::heat::equilibrium_temperature_k, physics::blackbody"),
    step: Some("solve::irradiance, solve::emission"),
    light: Some(Light::glows),
    find,
};

fn find(given: &Given) -> Finding {
    let (warmest_k, noon_k) = (given.reference.warmest_k, given.noon_k);
    match given.scene.models.thermal {
        Thermal::Off => left_out(
            given.emitted(noon_k),
            format!("off: the bound is the emission of a facet under the Sun at its zenith, {noon_k:.1} K"),
        ),
        Thermal::Thesis => modelled(
            given.emitted(noon_k),
            "Domagala (2020), equation (9): 150 to 330 K at any distance from the Sun; the bound is all of the emission",
        ),
        Thermal::Equilibrium => modelled(
            given.largest_up_to(warmest_k, |um, m, t_k| interpolation_error(um, t_k).min(1.0) * emission(m, um, t_k)),
            format!(
                "each facet in equilibrium with what it absorbs, its lit and shaded parts separately; up to {warmest_k:.1} K. The bound is \
                     of the interpolation in temperature; see thermal inertia for the rest"
            ),
        ),
    }
}
