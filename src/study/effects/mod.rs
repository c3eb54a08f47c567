//! The effects that shape the light, modelled or not, each in a file of its own with a bound on its influence, made before anything is solved.
//!
//! A bound is of the **error of a pixel**: the change of its radiance, over that radiance or 0.01 (`given::FLOOR`) of the band's median sunlit
//! radiance, whichever is more; the largest over bands and pixels, those that show nothing but sunlit ground and the others apart.

mod aberration;
mod beaming;
mod bodies;
mod bound;
mod by_others;
mod eclipse;
mod given;
mod glow_of_mars;
mod glow_of_neighbours;
mod heat_from_mars;
mod in_view;
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
mod warmth;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::product::{FacetTable, Sampling};
use crate::scene::{Fixed, Models, SunModel};
use crate::spectral::Light;

pub use aberration::tell_correction;
pub use bound::Bound;
pub(super) use eclipse::{by_globes, whose};
pub(super) use given::{Given, mars_seen};
pub use instrument::tell_instrument;

/// All effects, in the order of the report.
pub(super) const ALL: [EffectKind; 18] = [
    sunlight::KIND,
    photometric_function::KIND,
    solar_disc::KIND,
    eclipse::KIND,
    mars_light::KIND,
    mars_light_shadows::KIND,
    glow_of_mars::KIND,
    bodies::KIND,
    in_view::KIND,
    interreflection::KIND,
    glow_of_neighbours::KIND,
    thermal_emission::KIND,
    heat_from_mars::KIND,
    thermal_inertia::KIND,
    beaming::KIND,
    terrain_outside::KIND,
    aberration::KIND,
    instrument::KIND,
];

/// Something that shapes the light.
pub(super) struct EffectKind {
    /// What it is called on the command line.
    pub(super) key: &'static str,
    name: &'static str,
    /// Where its equation is, if there is one.
    equation: Option<&'static str>,
    /// What adds it to a result, if anything does.
    step: Option<&'static str>,
    /// The light that it affects: it changes nothing in bands without that. `None`: all light.
    light: Option<fn(Light) -> bool>,
    /// How the choice of models has it, if there is a choice.
    pub(super) switch: Option<Switch>,
    find: fn(&Given) -> Finding,
}

/// Adds an effect to a choice of models, and takes it away.
pub(super) struct Switch {
    /// Adds it, as good as a share of the tolerance wants; of what a scene states, `stated` is the choice.
    pub(super) add: fn(models: &mut Models, stated: &Models, given: &Given, tolerance: f64),
    pub(super) remove: fn(&mut Models),
    /// The key by which a scene decides itself whether the effect is there, if it does.
    pub(super) stated: fn(&Fixed) -> Option<&'static str>,
    /// CPU time that it takes with these models, s.
    pub(super) cost_s: fn(&Given, &Models) -> f64,
    /// What is left with these models, where that has a tolerance of its own.
    pub(super) own: Option<fn(&Given, &Models) -> OwnTolerance>,
    /// Whether that decides if it is dropped, too, instead of its bound.
    pub(super) drops_by_own: bool,
}

/// An error that is not summed with the others: its tolerance is of another kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OwnTolerance {
    /// Where, and relative to what.
    pub of: String,
    /// The most that is left.
    pub left: f64,
}

/// What is found of an effect.
#[derive(Default)]
pub(super) struct Finding {
    /// Whether these models have it.
    modelled: bool,
    /// What lacks to model it, if anything does.
    missing: Option<String>,
    /// What leaving it out would change.
    bound: Option<Bound>,
    /// What the approximations of a modelled one may change.
    remaining: Option<Bound>,
    note: String,
    /// How the bound comes about.
    because: String,
}

/// What becomes of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Decision {
    /// It is in the result.
    Kept,
    /// It is left out.
    Dropped,
    /// It is left out because an input is missing, or nothing models it: its bound counts for nothing.
    Open,
}

/// Something that shapes the light, modelled or left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// What it is called on the command line.
    pub key: String,
    /// Its name.
    pub name: String,
    /// What becomes of it.
    pub decision: Decision,
    /// The key of the scene that decides it, whatever the tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stated: Option<String>,
    /// What leaving it out changes at most; null: not known.
    pub bound: Option<Bound>,
    /// What its approximations change at most, if it is kept; null: not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remaining: Option<Bound>,
    /// The error that is left of it where that has a tolerance of its own, and is not summed with the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub own: Option<OwnTolerance>,
    /// Of light between facets, its error by sampling, as the result itself shows it; null before there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampling: Option<Sampling>,
    /// CPU time that it takes, or would take, s, on a machine of 2022; null: it takes none of its own, or nothing models it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost_s: Option<f64>,
    /// Where a run's time for it is counted, if not together with others'.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stage: Option<StageShare>,
    /// Where its equation is in the library, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub equation: Option<String>,
    /// What in the library adds it to a result, if anything does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<String>,
    /// How it is modelled, or why it is left out.
    pub note: String,
    /// How its bound comes about.
    pub because: String,
}

/// A part of a stage of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StageShare {
    /// What `run.json` calls the stage.
    pub name: String,
    /// The part of its time that is this effect's.
    pub share: f64,
}

/// Where the time of an effect that is modelled is counted.
fn stage(key: &str, models: &Models) -> Option<StageShare> {
    let of = |name: &str, share: f64| Some(StageShare { name: name.to_owned(), share });
    match key {
        // The first of the disc's points takes the place of a point Sun.
        "sun-disc" => match models.sun {
            SunModel::Disc(rule) if rule.count() > 1 => of("sunlight", 1.0 - 1.0 / rule.count() as f64),
            _ => None,
        },
        "mars-shadows" => of("Mars-light", 1.0),
        "interreflection" => of("light between facets", 1.0),
        "thermal-inertia" => of("a day's sunlight", 1.0),
        _ => None,
    }
}

/// All effects in a scene, by its models.
pub(super) fn effects(given: &Given) -> Vec<Effect> {
    ALL.iter().map(|kind| kind.in_scene(given)).collect()
}

/// The same beside a result.
pub(super) fn effects_in(given: &Given, table: &FacetTable) -> Vec<Effect> {
    let with = |kind: &EffectKind| {
        let sampling = table.sampling.filter(|_| kind.key == interreflection::KIND.key);
        Effect { sampling, ..kind.in_scene(given) }
    };
    ALL.iter().map(with).collect()
}

impl EffectKind {
    pub(super) fn in_scene(&self, given: &Given) -> Effect {
        let is_in_no_band = |is: &fn(Light) -> bool| !given.wavelengths.iter().any(|at| is(at.light));
        let found = match self.light.filter(is_in_no_band) {
            // What is in none of the bands changes nothing.
            Some(is) => Finding {
                bound: Some(Bound::NOTHING),
                note: format!("no band has {}", if is(Light::Heat) { "heat" } else { "sunlight" }),
                because: "it changes nothing".into(),
                ..Finding::default()
            },
            None => (self.find)(given),
        };
        let decision = match (found.modelled, &self.switch, &found.missing) {
            (true, ..) => Decision::Kept,
            (false, _, None) if self.switch.is_some() || found.bound == Some(Bound::NOTHING) => Decision::Dropped,
            _ => Decision::Open,
        };
        let note = match found.missing {
            Some(missing) if !found.modelled => format!("{missing}; {}", found.note),
            _ => found.note,
        };
        let stated = self.switch.as_ref().and_then(|switch| (switch.stated)(&given.models.fixed));
        let [equation, step] = [self.equation, self.step].map(|path| path.map(str::to_owned));
        Effect {
            key: self.key.to_owned(),
            name: self.name.to_owned(),
            decision,
            stated: stated.filter(|_| decision != Decision::Open).map(str::to_owned),
            bound: found.bound,
            remaining: found.remaining.filter(|_| decision == Decision::Kept),
            own: self.switch.as_ref().and_then(|switch| Some((switch.own?)(given, &given.models))),
            sampling: None,
            cost_s: self.switch.as_ref().map(|switch| (switch.cost_s)(given, &given.models)),
            stage: stage(self.key, &given.models).filter(|_| decision == Decision::Kept),
            equation,
            step,
            note,
            because: found.because,
        }
    }
}
