//! Heat that is stored and conducted.

use super::given::{Place, emission};
use super::{EffectKind, Finding, Given, OwnTolerance, Switch};
use crate::scene::{Models, STEPS_OF_A_DAY, Thermal};
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "thermal-inertia",
    name: "thermal inertia",
    equation: Some("physics::conduction"),
    step: Some("solve::conduction"),
    light: Some(Light::glows),
    switch: Some(Switch {
        add: |models, stated, given, _| {
            let steps = stated.conduction.unwrap_or(STEPS_OF_A_DAY);
            models.conduction = missing(given).is_none().then_some(steps);
        },
        remove: |models| models.conduction = None,
        stated: |fixed| fixed.thermal.then_some("thermal.model"),
        cost_s: |given, models| {
            let facets = given.scene.body.mesh.facets.len() as f64;
            // Each step is solved, and each column followed for some ten days.
            f64::from(models.conduction.unwrap_or(0)) * (given.shadows_s() + facets * (SOLVED_S + STEP_S))
        },
        own: Some(|given, models| OwnTolerance {
            of: "of the temperature of ground at sunset, K: of the steps of a day".into(),
            left: models.conduction.map_or(if missing(given).is_none() { given.noon_k } else { 0.0 }, |steps| {
                // Second order: 48 steps are good to 1 K on Phobos.
                (48.0 / f64::from(steps)).powi(2)
            }),
        }),
        drops_by_own: false,
    }),
    find,
};

/// CPU time to solve a facet, and to follow its column through a step of all days, s.
const SOLVED_S: f64 = 3e-7;
const STEP_S: f64 = 5e-7;

/// What lacks.
pub(super) fn missing(given: &Given) -> Option<&'static str> {
    let conducts = given.materials.iter().any(|(_, material)| material.thermal_inertia > 0.0);
    match (given.scene.sky.rotation.is_some(), conducts) {
        (true, true) => None,
        (false, true) => Some("no length of a day is stated (`thermal.period_s`)"),
        (_, false) => Some("no thermal inertia above 0 is stated (`thermal.inertia`)"),
    }
}

fn find(given: &Given) -> Finding {
    let Models { thermal, conduction, .. } = given.models;
    let noon_k = given.noon_k;
    // What is left may have been cold.
    let cold = given.by(Models { thermal: Thermal::Off, ..given.models });
    let steps = conduction.filter(|_| thermal == Thermal::Equilibrium);
    Finding {
        modelled: steps.is_some(),
        missing: missing(given).map(str::to_owned),
        bound: cold.error(|&Place { at, material, .. }| emission(material, at.um, noon_k)),
        note: match steps {
            Some(steps) => format!(
                "each facet's own column, by {steps} steps of a day, shadows moving{}; no heat flows sideways",
                if given.scene.sky.past.is_some() { ", the Sun and bodies where they were" } else { "" }
            ),
            None => "no heat is stored or conducted".into(),
        },
        because: format!(
            "the emission at {noon_k:.1} K, of a facet under the Sun at its zenith: what a fresh shadow might still send, and more than equilibrium \
             can be wrong in sunlight"
        ),
        ..Finding::default()
    }
}
