//! What all methods of a chart have in common: the scene, the effects of the reference, and the plans that are compared with it.

use super::bands;
use crate::error::Result;
use crate::physics::sun_disc::DiscRule;
use crate::progress::Watch;
use crate::scene::{Exchange, Exposure, Models, Scene, SunModel};
use crate::study::cost::{self, Workload};
use crate::study::effects::{Decision, Given};
use crate::study::plan::{account, decide};
use crate::study::{Choice, Plan, Request};

/// The reference is planned for this tolerance, a tenth of the finest plan that is compared with it.
const REFERENCE: f64 = 1e-4;
/// Tolerances of the plans that are compared.
const TOLERANCES: [f64; 3] = [1e-1, 1e-2, 1e-3];
/// No effects of the reference may take longer, as their costs are estimated, CPU s: so that a chart takes minutes.
const LONGEST_S: f64 = 100.0;
/// How finely the reference looks for light between facets, if there is time: so far off, as a share of it, ...
const FINE: f64 = 0.01;
/// ... with so many bounces.
const BOUNCES: u32 = 3;
/// A ray, and what follows from where it ends, CPU s.
const RAY_S: f64 = 3.5e-7;

/// A scene whose methods are compared.
#[derive(Debug, Clone)]
pub struct Case {
    /// As stated, with all of its bands: what plans are made for.
    pub(super) scene: Scene,
    /// With the bands that are compared.
    pub(super) exposure: Exposure,
    /// The reference: all effects.
    pub(super) full: Models,
    /// Those of them that a facet gets straight from sources, and its heat: what ways to compute geometry have in common.
    pub(super) direct: Models,
    /// What the reference leaves out or does not show, in sentences.
    pub(super) notes: Vec<String>,
    /// What the reference has and has not, in a sentence.
    pub(super) full_account: String,
    /// Effects that would take too long: no row has them.
    excluded: Excluded,
    /// About what methods take.
    pub(super) seconds: Seconds,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Excluded {
    conduction: bool,
    exchange: bool,
}

/// About what methods take, CPU s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seconds {
    /// The image by a point Sun.
    pub(super) point_sun: f64,
    /// A further point of its disc.
    pub(super) disc_point: f64,
    /// A ray in every pixel.
    pub(super) ray_a_pixel: f64,
    /// The reference.
    pub(super) full: f64,
}

/// A way to choose the effects, and what it comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// What may be asked for to get it.
    pub requests: Vec<Request>,
    /// The effects.
    pub models: Models,
    /// Which it has and which not, in a sentence.
    pub account: String,
    /// About what its effects take, CPU s.
    pub cost_s: f64,
}

impl Case {
    /// Decides what the reference is.
    ///
    /// # Errors
    /// Those of [`decide`] and [`Scene::new`].
    pub fn new(scene: &Scene, watch: Watch<'_>) -> Result<Self> {
        let exposure = Exposure { bands: bands(scene), ..scene.exposure.clone() };
        let request = Request { choice: Choice::Full, tolerance: REFERENCE };
        let (models, extremes, _) = decide(scene, &request, watch)?;
        let given = Given::new(scene, &extremes, &extremes.sunlit).with_draft(extremes.draft.as_ref());
        let reference = |models: Models| account(scene, &given.by(models), &request);
        let tries = finest_first(models);
        let fits = |(models, _): &&(Models, Excluded)| reference(*models).cost_s() <= LONGEST_S;
        let (full, excluded) = *tries.iter().find(fits).unwrap_or(&tries[tries.len() - 1]);
        let plan = reference(full);
        let direct = Models { exchange: None, conduction: None, mars_shadows: None, sun: tries[0].0.sun, ..full };
        let facets = scene.body.mesh.facets.len();
        let pixels = f64::from(scene.exposure.camera.samples) * f64::from(scene.exposure.camera.lines);
        let point_sun = cost::cpu_s(&scene.seen_by(exposure.clone())?, &Workload::of(scene, &extremes));
        let seconds = Seconds {
            point_sun,
            disc_point: cost::pass_s(facets, 1.0),
            ray_a_pixel: RAY_S * pixels,
            full: point_sun + plan.cost_s(),
        };
        let notes = notes(&plan, (&tries[0].0, &full), excluded, &reference);
        let full_account = format!("Exact areas and shadows. {}", described(&plan));
        Ok(Case { scene: scene.clone(), exposure, full, direct, notes, full_account, excluded, seconds })
    }

    /// Plans for each choice of effects; choices that come to the same are one.
    ///
    /// # Errors
    /// Those of [`decide`].
    pub(super) fn plans(&self, watch: Watch<'_>) -> Result<Vec<Planned>> {
        let of = |choice: Choice, tolerance: f64| Request { choice, tolerance };
        let mut requests = vec![of(Choice::Thesis, TOLERANCES[0])];
        requests.extend(TOLERANCES.map(|tolerance| of(Choice::Auto, tolerance)));
        requests.push(of(Choice::Full, Request::default().tolerance));
        let mut plans: Vec<Planned> = Vec::new();
        for request in requests {
            let (models, _, plan) = decide(&self.scene, &request, watch)?;
            let models = self.within(models);
            match plans.iter_mut().find(|planned| planned.models == models) {
                Some(same) => same.requests.push(request),
                None => plans.push(Planned {
                    requests: vec![request],
                    models,
                    account: described(&plan),
                    cost_s: plan.cost_s(),
                }),
            }
        }
        Ok(plans)
    }

    /// Models without what no row has.
    pub(super) fn within(&self, models: Models) -> Models {
        Models {
            conduction: models.conduction.filter(|_| !self.excluded.conduction),
            exchange: models.exchange.filter(|_| !self.excluded.exchange),
            ..models
        }
    }
}

/// Models of the reference, from the finest to the one that takes the least time.
fn finest_first(models: Models) -> [(Models, Excluded); 5] {
    let sun = match models.sun {
        SunModel::Point => SunModel::Point,
        SunModel::Disc(_) => SunModel::Disc(DiscRule::E37),
    };
    let finer = |of: Exchange| {
        let fine = Exchange::to_within(FINE, of.bounces.max(BOUNCES), 1.0);
        if fine.lines_per_facet > of.lines_per_facet { fine } else { of }
    };
    let mars_shadows = models.mars_shadows.map(|_| DiscRule::G12);
    let all = Excluded::default();
    let without_conduction = Excluded { conduction: true, ..all };
    [
        (Models { sun, mars_shadows, exchange: models.exchange.map(finer), ..models }, all),
        (Models { sun, ..models }, all),
        (models, all),
        (Models { conduction: None, ..models }, without_conduction),
        (Models { conduction: None, exchange: None, ..models }, Excluded { exchange: true, ..without_conduction }),
    ]
}

/// Which effects a plan has.
fn described(plan: &Plan) -> String {
    let of = |decision: Decision| -> Vec<&str> {
        plan.effects.iter().filter(|effect| effect.decision == decision).map(|effect| effect.name.as_str()).collect()
    };
    let mut said = format!("Has {}", of(Decision::Kept).join(", "));
    let dropped = of(Decision::Dropped);
    if !dropped.is_empty() {
        said += &format!("; leaves out {}", dropped.join(", "));
    }
    said + "."
}

/// What a reader of errors against the reference must know.
fn notes(
    plan: &Plan,
    (finest, full): (&Models, &Models),
    excluded: Excluded,
    reference: &dyn Fn(Models) -> Plan,
) -> Vec<String> {
    let mut notes = Vec::new();
    let saved = |with: Models, without: Models| reference(with).cost_s() - reference(without).cost_s();
    for (is, name, without) in [
        (excluded.conduction, "heat that the ground stores", Models { conduction: None, ..*finest }),
        (excluded.exchange, "light between facets", Models { exchange: None, ..*finest }),
    ] {
        if is && without != *finest {
            notes.push(format!(
                "The reference and all other rows leave out {name}, which would take some {:.0} CPU s: no error here counts it.",
                saved(*finest, without)
            ));
        }
    }
    if let Some(exchange) = full.exchange {
        let own = plan.effects.iter().find_map(|e| e.own.as_ref().filter(|_| e.key == "interreflection"));
        let left = own.map_or(0.0, |own| own.left);
        let finer = if finest.exchange == full.exchange { "more than plans take" } else { "as plans take it" };
        notes.push(format!(
            "Light between facets is found along {} directions in the reference ({finer}), and is off by some {:.0} % of itself there: that is noise of \
             the reference, which no row can be nearer than. It has a tolerance of its own, apart from --tolerance.",
            exchange.directions,
            100.0 * left
        ));
    }
    let open: Vec<&str> =
        plan.effects.iter().filter(|e| e.decision == Decision::Open).map(|e| e.name.as_str()).collect();
    if !open.is_empty() {
        notes.push(format!("In no image, since an input is missing or nothing here models it: {}.", open.join(", ")));
    }
    notes
}

impl Planned {
    /// A short name.
    pub(super) fn name(&self) -> String {
        let tolerances: Vec<String> = self
            .requests
            .iter()
            .filter(|request| request.choice == Choice::Auto)
            .map(|request| request.tolerance.to_string())
            .collect();
        let auto = (!tolerances.is_empty()).then(|| format!("auto, tolerance {}", listed(&tolerances)));
        let others = self
            .requests
            .iter()
            .filter(|request| request.choice != Choice::Auto)
            .map(|request| request.choice.to_string());
        let names: Vec<String> = auto.into_iter().chain(others).collect();
        names.join(" = ")
    }

    /// What a simulation is asked for to get it: of several ways the first.
    pub(super) fn asked(&self) -> String {
        match self.requests.first() {
            Some(Request { choice: Choice::Auto, tolerance }) => format!("--tolerance {tolerance}"),
            Some(Request { choice, .. }) => format!("--model {choice}"),
            None => String::new(),
        }
    }
}

fn listed(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [some @ .., last] => format!("{} and {last}", some.join(", ")),
    }
}
