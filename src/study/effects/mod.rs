//! The effects that shape the light, modelled or not, each in a file of its own with a bound on its influence.
//!
//! Bounds are relative to the **median sunlit radiance**: sunlight reflected by the same material at the median incidence of
//! the sunlit pixels, in the worst band and material. A pixel in shadow may change by more of its own radiance.

mod aberration;
mod eclipse;
mod given;
mod heat_from_mars;
mod instrument;
mod interreflection;
mod mars_light;
mod mars_light_shadows;
mod photometric_function;
mod solar_disc;
mod sunlight;
mod terrain_outside;
mod thermal_emission;
mod thermal_inertia;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spectral::Light;

pub(super) use eclipse::by_mars;
pub(super) use given::{Given, Reference, mars_seen};

/// All effects, in the order of the report.
const ALL: [EffectKind; 13] = [
    sunlight::KIND,
    photometric_function::KIND,
    mars_light::KIND,
    mars_light_shadows::KIND,
    thermal_emission::KIND,
    thermal_inertia::KIND,
    heat_from_mars::KIND,
    interreflection::KIND,
    solar_disc::KIND,
    terrain_outside::KIND,
    eclipse::KIND,
    aberration::KIND,
    instrument::KIND,
];

/// Something that shapes the light.
pub(super) struct EffectKind {
    name: &'static str,
    /// Where its equation is, if there is one.
    equation: Option<&'static str>,
    /// What adds it to a result, if anything does.
    step: Option<&'static str>,
    /// The light that it affects: it changes nothing in bands without that. `None`: all light.
    light: Option<fn(Light) -> bool>,
    find: fn(&Given) -> Finding,
}

/// What is found of an effect.
struct Finding {
    modelled: bool,
    bound: Option<f64>,
    note: String,
}

/// Something that shapes the light, modelled or left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// Its name.
    pub name: String,
    /// Whether it is in the result.
    pub modelled: bool,
    /// By at most this share of the median sunlit radiance would a sunlit pixel change with it (if left out) or without its
    /// approximations (if modelled), in the worst band; null: not known.
    pub bound: Option<f64>,
    /// Where its equation is in the library, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub equation: Option<String>,
    /// What in the library adds it to a result, if anything does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<String>,
    /// How it is modelled, or why it is left out, and what the bound refers to.
    pub note: String,
}

/// A bound as large as all the sunlight, or larger, distinguishes nothing.
const USELESS: f64 = 1.0;

/// All effects in a scene.
pub(super) fn effects(given: &Given) -> Vec<Effect> {
    ALL.iter().map(|kind| kind.in_scene(given)).collect()
}

impl EffectKind {
    fn in_scene(&self, given: &Given) -> Effect {
        let is_in_no_band = |is: &fn(Light) -> bool| !given.bands_um.iter().any(|(_, light)| is(*light));
        let Finding { modelled, bound, mut note } = match self.light.filter(is_in_no_band) {
            // What is in none of the bands changes nothing.
            Some(is) if is(Light::Heat) => left_out(Some(0.0), "no band has heat"),
            Some(_) => left_out(Some(0.0), "no band has sunlight"),
            None => (self.find)(given),
        };
        if bound.is_some_and(|bound| bound >= USELESS) {
            note = format!("not bounded usefully: {note}");
        }
        let [equation, step] = [self.equation, self.step].map(|path| path.map(str::to_owned));
        Effect { name: self.name.to_owned(), modelled, bound, equation, step, note }
    }
}

fn modelled(bound: Option<f64>, note: impl Into<String>) -> Finding {
    Finding { modelled: true, bound, note: note.into() }
}

fn left_out(bound: Option<f64>, note: impl Into<String>) -> Finding {
    Finding { modelled: false, bound, note: note.into() }
}
