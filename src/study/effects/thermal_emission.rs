//! What a surface emits at its temperature.

use super::given::{Place, emission};
use super::{Bound, EffectKind, Finding, Given, Switch, thermal_inertia};
use crate::physics::heat;
use crate::scene::{Models, Thermal};
use crate::solve::interpolation_error;
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "heat",
    name: "thermal emission",
    equation: Some("physics::heat::equilibrium_temperature_k, physics::blackbody"),
    step: Some("solve::irradiance, solve::emission"),
    light: Some(Light::glows),
    switch: Some(Switch {
        add: |models, stated, _, _| models.thermal = stated.thermal,
        remove: |models| models.thermal = Thermal::Off,
        stated: |fixed| fixed.thermal.then_some("thermal.model"),
        cost_s: |given, _| FACET_S * given.scene.body.mesh.facets.len() as f64,
        own: None,
        drops_by_own: false,
    }),
    find,
};

/// CPU time that a facet's temperatures, and their part of the image, take, s.
const FACET_S: f64 = 1.5e-7;

fn find(given: &Given) -> Finding {
    // What it is relative to has no heat but that.
    let cold = given.by(Models { thermal: Thermal::Off, ..given.models });
    let bound = cold.error_without(|&Place { at, material, class, side, .. }| {
        let cos_incidence = side.most_cos_incidence(class);
        let t_k = match given.scene.models.thermal {
            _ if material.temperature_k.is_some() => material.temperature_k.unwrap_or(0.0),
            Thermal::Thesis => heat::thesis_temperature_k(cos_incidence),
            // It may have been noon, and the ground keeps its heat.
            _ if thermal_inertia::missing(given).is_none() => given.noon_k,
            _ => given.temperature_k(material, cos_incidence, given.others_w_m2(class)),
        };
        emission(material, at.um, t_k)
    });
    let because = format!(
        "the emission of each facet in equilibrium with sunlight, Mars that sends {:.1} W/m2, further bodies and lamps, and surroundings that send {:.0} W/m2; the warmest {:.1} K",
        given.mars_w_m2(given.most_of_mars()),
        given.around_w_m2(given.most_around()),
        given.noon_k
    );
    let found = |modelled, remaining, note: &str| Finding {
        modelled,
        bound,
        remaining,
        note: note.to_owned(),
        because,
        ..Finding::default()
    };
    match given.models.thermal {
        Thermal::Off => found(false, None, "off: nothing emits heat"),
        Thermal::Thesis => {
            found(true, bound, "Domagala (2020), equation (9): 150 to 330 K at any distance from the Sun")
        }
        Thermal::Equilibrium => {
            let least_um = given.wavelengths.iter().filter(|at| at.light.glows()).map(|at| at.um);
            let least_um = least_um.fold(f64::INFINITY, f64::min);
            // Relative to the emission itself, which is large only where this is small.
            let share = interpolation_error(least_um, given.noon_k).min(1.0);
            let remaining = Bound { lit: share, shadow: share };
            found(
                true,
                Some(remaining),
                "each facet in equilibrium with what it absorbs, its lit and shaded parts separately",
            )
        }
    }
}
