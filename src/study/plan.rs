//! Which effects a simulation models, and which it leaves out: no more than its tolerance wants.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::coarser::{Coarser, coarser};
use super::cost::{self, Looks, Workload};
use super::effects::{ALL, Bound, Decision, Effect, EffectKind, Given, Switch, effects};
use super::extremes::Extremes;
use crate::error::{Error, Location, Result};
use crate::progress::{Watch, tell};
use crate::scene::{Fixed, MarsModel, Models, Scene, Setup, Thermal};

/// The tolerance unless another one is asked for.
pub const TOLERANCE: f64 = 1e-3;

/// Which effects are wanted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Choice {
    /// Those that the tolerance needs.
    #[default]
    Auto,
    /// What Domagala (2020) has: a point Sun, Mars by equations (4) to (8), temperatures by equation (9).
    Thesis,
    /// All that the scene can feed.
    Full,
    /// These, by their keys.
    Only(Vec<String>),
}

/// What is wanted of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Which effects.
    pub choice: Choice,
    /// The largest error of a pixel that all effects left out, and the approximations of the others, may add up to.
    pub tolerance: f64,
}

impl Default for Request {
    fn default() -> Self {
        Request { choice: Choice::Auto, tolerance: TOLERANCE }
    }
}

impl Choice {
    /// From `auto`, `thesis`, `full`, or keys of effects, joined by commas.
    ///
    /// # Errors
    /// A sentence that says which there are.
    pub fn parse(text: &str) -> std::result::Result<Self, String> {
        let mut keys: Vec<String> = Vec::new();
        match text.trim() {
            "auto" => return Ok(Choice::Auto),
            "thesis" => return Ok(Choice::Thesis),
            "full" => return Ok(Choice::Full),
            _ => {}
        }
        for key in text.split(',').map(str::trim) {
            let of_key = |kind: &&EffectKind| kind.switch.is_some() || kind.key == SUNLIGHT;
            let known: Vec<&str> = ALL.iter().filter(of_key).map(|kind| kind.key).chain([SMEAR]).collect();
            if !known.contains(&key) {
                return Err(format!(
                    "{key:?} is not a model: give auto, thesis, full, or some of {}, joined by commas",
                    known.join(", ")
                ));
            }
            if !keys.iter().any(|k| k == key) {
                keys.push(key.to_owned());
            }
        }
        Ok(Choice::Only(keys))
    }

    /// Whether motion within an exposure is integrated as finely as the tolerance needs, where the scene does not say how.
    pub fn has_smear(&self) -> bool {
        match self {
            Choice::Auto | Choice::Full => true,
            Choice::Thesis => false,
            Choice::Only(keys) => keys.iter().any(|key| key == SMEAR),
        }
    }
}

impl std::fmt::Display for Choice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Choice::Auto => f.write_str("auto"),
            Choice::Thesis => f.write_str("thesis"),
            Choice::Full => f.write_str("full"),
            Choice::Only(keys) => f.write_str(&keys.join(",")),
        }
    }
}

/// Sunlight is always there: a list may name it.
const SUNLIGHT: &str = "sunlight";
/// Motion within an exposure, which is no effect on the light.
const SMEAR: &str = "smear";

/// Which effects are modelled, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// What was asked for: `auto`, `thesis`, `full`, or a list.
    pub model: String,
    /// The tolerance, relative, as bounds are.
    pub tolerance: f64,
    /// The sum of the bounds of effects that are dropped; null if one of them is not known. Open ones don't count, nor those that the
    /// scene itself leaves out, nor what has a tolerance of its own.
    pub dropped: Option<Bound>,
    /// The sum of what is left of those that are kept; null if one of them is not known.
    pub remaining: Option<Bound>,
    /// About the CPU time of all of a simulation, s, on a machine of 2022.
    pub cpu_s: f64,
    /// Where the mesh is far finer than pixels: one that would do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coarser: Option<Coarser>,
    /// What is said of a scene that moves: how much during an exposure, and what stands for it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<String>,
    /// Each effect. Bounds are of before the image was made.
    pub effects: Vec<Effect>,
}

impl Plan {
    /// CPU time that its effects take, s, on a machine of 2022.
    pub fn cost_s(&self) -> f64 {
        let kept = self.effects.iter().filter(|effect| effect.decision == Decision::Kept);
        kept.filter_map(|effect| effect.cost_s).sum()
    }

    /// Whether what is dropped, and what remains of what is kept, stays within the tolerance.
    pub fn keeps_tolerance(&self) -> bool {
        let both = self.dropped.zip(self.remaining).map(|(dropped, remaining)| dropped.and(&remaining));
        both.is_some_and(|both| both.most() <= self.tolerance)
    }
}

/// A sentence if a facet table was solved without something that matters in these bands.
pub fn left_out_of_table(effects: &[Effect]) -> Option<String> {
    let matters = |effect: &&Effect| {
        effect.decision == Decision::Dropped
            && effect.own.is_none()
            && effect.stated.is_none()
            && effect.bound.is_none_or(|bound| bound.most() > TOLERANCE)
    };
    let keys: Vec<&str> = effects.iter().filter(matters).map(|effect| effect.key.as_str()).collect();
    (!keys.is_empty()).then(|| {
        format!(
            "the table was solved without {}, which may change a pixel by more than {TOLERANCE} in these bands: `mmxrt solve --model full` has all",
            keys.join(", ")
        )
    })
}

/// What of a request does not come about, or not as the scene states it, as sentences: a list names what the scene cannot feed, or leaves out what it states.
pub fn unheeded(stated: &Setup, request: &Request, planned: &Models, plan: &Plan) -> Vec<String> {
    let Request { choice, .. } = request;
    let mut all = Vec::new();
    if let Choice::Only(keys) = choice {
        let absent =
            plan.effects.iter().filter(|effect| keys.contains(&effect.key) && effect.decision != Decision::Kept);
        all.extend(
            absent.map(|effect| format!("--model asks for {}, which the result has not: {}", effect.key, effect.note)),
        );
    }
    if matches!(choice, Choice::Only(_) | Choice::Thesis) {
        let is_there = |switch: &Switch, models: &Models| {
            let mut without = *models;
            (switch.remove)(&mut without);
            without != *models
        };
        for (kind, switch) in switches() {
            let Some(key) = (switch.stated)(&stated.models.fixed) else { continue };
            match (is_there(switch, &stated.models), is_there(switch, planned)) {
                (true, false) => all.push(format!(
                    "--model {choice} leaves out {}, which the scene states (`{key}`): name it in a list, or take --model auto",
                    kind.key
                )),
                (false, true) => {
                    all.push(format!("--model {choice} has {}, which the scene leaves out (`{key}`)", kind.key));
                }
                _ => {}
            }
        }
    }
    all
}

/// Decides by which models a scene is simulated.
///
/// Effects whose inputs are missing are left open, and `auto` and `full` leave those as they are that the scene itself decides. Of the others, `auto` drops as many as may change half the tolerance together, the ones with the
/// smallest bounds first, and keeps the rest, each as good as its share of the other half wants.
///
/// # Errors
/// [`Error::Invalid`] for a tolerance that is none.
pub fn plan(scene: &Scene, extremes: &Extremes, request: &Request) -> Result<(Models, Plan)> {
    let Request { choice, tolerance } = request;
    if !(*tolerance > 0.0 && tolerance.is_finite()) {
        return Err(Error::invalid(Location::item("--tolerance"), format!("{tolerance} is not a number above 0")));
    }
    let given = Given::new(scene, extremes, &extremes.sunlit).with_draft(extremes.draft.as_ref());
    let models = match choice {
        Choice::Thesis => thesis(),
        Choice::Full => chosen(&given, scene.models.fixed, *tolerance, |_| true),
        // Who names effects decides.
        Choice::Only(keys) => {
            chosen(&given, Fixed::default(), *tolerance, |kind| keys.iter().any(|key| key == kind.key))
        }
        Choice::Auto => {
            let all = given.by(chosen(&given, scene.models.fixed, *tolerance, |_| true));
            let dropped = least_that_fit(&all, 0.5 * tolerance);
            chosen(&given, scene.models.fixed, *tolerance, |kind| !dropped.contains(&kind.key))
        }
    };
    Ok((models, account(scene, &given.by(models), request)))
}

/// As [`plan`], having looked at the scene as closely as its answer is worth: at where shadows are, unless all is chosen by name; at how dark pixels get, if
/// what a first look would keep takes longer than a draft of the image does.
///
/// # Errors
/// As [`plan`], and [`Error::Interrupted`] if `watch` asks to stop.
pub fn decide(scene: &Scene, request: &Request, watch: Watch<'_>) -> Result<(Models, Extremes, Plan)> {
    scene.body.topology_watched(watch)?;
    tell(watch, "plan", 0, 1)?;
    let is_open = matches!(request.choice, Choice::Auto | Choice::Full);
    let mut extremes = if is_open { Extremes::with_shadows(scene, watch)? } else { Extremes::new(scene) };
    let (mut models, mut plan) = self::plan(scene, &extremes, request)?;
    if is_open && plan.cost_s() >= cost::cpu_s(scene, &Workload::of(scene, &extremes)) {
        extremes = extremes.with_draft(scene, watch)?;
        (models, plan) = self::plan(scene, &extremes, request)?;
    }
    plan.coarser = coarser(scene, &extremes, plan.cost_s());
    tell(watch, "plan", 1, 1)?;
    Ok((models, extremes, plan))
}

/// About the CPU time, s, that exposures and optics take beside one plain image by some models.
pub fn looks_s(scene: &Scene, extremes: &Extremes, looks: Looks) -> f64 {
    let given = Given::new(scene, extremes, &extremes.sunlit);
    cost::looks_s(scene, &Workload::of(scene, extremes), looks, given.all_directions())
}

/// The plan that these models are.
pub(super) fn account(scene: &Scene, given: &Given, request: &Request) -> Plan {
    let effects = effects(given);
    // What has a tolerance of its own is not part of the sums: what is left of it, and, if that decides, all of it.
    let is_apart = |kind: &EffectKind, decision: Decision| match &kind.switch {
        Some(switch) => switch.own.is_some() && (decision == Decision::Kept || switch.drops_by_own),
        None => false,
    };
    let sum = |decision: Decision, of: &dyn Fn(&Effect) -> Option<Bound>| {
        let counts =
            |effect: &Effect| effect.decision == decision && (decision == Decision::Kept || effect.stated.is_none());
        let parts = ALL.iter().zip(&effects).filter(|(kind, effect)| counts(effect) && !is_apart(kind, decision));
        parts.map(|(_, effect)| of(effect)).try_fold(Bound::NOTHING, |sum, part| Some(sum.and(&part?)))
    };
    let mut plan = Plan {
        model: request.choice.to_string(),
        tolerance: request.tolerance,
        dropped: sum(Decision::Dropped, &|effect| effect.bound),
        // Of what there is no bound of, nothing is known of what is left, either.
        remaining: sum(Decision::Kept, &|effect| effect.remaining.or(effect.bound.map(|_| Bound::NOTHING))),
        cpu_s: 0.0,
        coarser: None,
        moving: vec![],
        effects,
    };
    plan.cpu_s = cost::cpu_s(scene, &Workload::of(scene, given.extremes)) + plan.cost_s();
    plan
}

/// What the thesis has.
fn thesis() -> Models {
    Models { thermal: Thermal::Thesis, mars_light: MarsModel::Thesis, bodies: 0, ..Models::default() }
}

/// Effects that can be chosen.
fn switches() -> impl Iterator<Item = (&'static EffectKind, &'static Switch)> {
    ALL.iter().filter_map(|kind| Some((kind, kind.switch.as_ref()?)))
}

/// Models with the effects that are wanted of those that there are; what is fixed stays as the scene has it.
fn chosen(given: &Given, fixed: Fixed, tolerance: f64, wants: impl Fn(&EffectKind) -> bool) -> Models {
    let free = || switches().filter(|(_, switch)| (switch.stated)(&fixed).is_none());
    let wanted: Vec<_> = free().filter(|(kind, _)| wants(kind)).collect();
    // What has a tolerance of its own has half of it for itself.
    let sharing = wanted.iter().filter(|(_, switch)| switch.own.is_none()).count();
    let share_of =
        |switch: &Switch| if switch.own.is_some() { 0.5 * tolerance } else { 0.5 * tolerance / sharing as f64 };
    let stated = &given.scene.models;
    let mut models = Models { fixed, ..*stated };
    free().for_each(|(_, switch)| (switch.remove)(&mut models));
    wanted.into_iter().for_each(|(_, switch)| {
        (switch.add)(&mut models, stated, given, share_of(switch));
    });
    models
}

/// Keys of the effects that may be dropped: together they change no more than this.
fn least_that_fit(all: &Given, most: f64) -> Vec<&'static str> {
    let without = |switch: &Switch| {
        let mut models = all.models;
        (switch.remove)(&mut models);
        models
    };
    let free = || switches().filter(|(_, switch)| (switch.stated)(&all.models.fixed).is_none());
    let fits_itself = |(kind, switch): (&'static EffectKind, &'static Switch)| {
        let left = (switch.own.filter(|_| switch.drops_by_own)?)(all, &without(switch)).left;
        (left <= most).then_some(kind.key)
    };
    let mut dropped: Vec<&str> = free().filter_map(fits_itself).collect();
    let summed = free().filter(|(_, switch)| !switch.drops_by_own);
    let mut bounds: Vec<(&str, f64)> =
        summed.filter_map(|(kind, _)| Some((kind.key, kind.in_scene(all).bound?.most()))).collect();
    bounds.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut sum = 0.0;
    let fits = |(_, bound): &(&str, f64)| {
        sum += bound;
        sum <= most
    };
    dropped.extend(bounds.into_iter().take_while(fits).map(|(key, _)| key));
    dropped
}
