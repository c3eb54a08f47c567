//! What a surface emits at its temperature.

use super::given::{Place, emission};
use super::{Bound, EffectKind, Finding, Given, Switch};
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
        let others = class.most_of_mars + given.most_from_bodies() + class.most_around;
        let t_k = given.temperature_k(material, side.most_cos_incidence(class), others);
        emission(material, at.um, t_k)
    });
    let because = format!(
        "the emission of each facet in equilibrium with sunlight, a Mars of {:.1} % and surroundings of {:.0} % of it; the warmest {:.1} K",
        100.0 * given.most_from_mars(),
        100.0 * given.most_around(),
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
            let ends = [given.noon_k, 0.5 * given.noon_k];
            let least_um = given.wavelengths.iter().filter(|at| at.light.glows()).map(|at| at.um);
            let least_um = least_um.fold(f64::INFINITY, f64::min);
            // Relative to the emission itself, which is large only where this is small.
            let share = ends.map(|t_k| interpolation_error(least_um, t_k).min(1.0))[0];
            let remaining = Bound { lit: share, shadow: share };
            found(
                true,
                Some(remaining),
                "each facet in equilibrium with what it absorbs, its lit and shaded parts separately",
            )
        }
    }
}
