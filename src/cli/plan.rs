//! `mmxrt plan`: which effects a simulation would model, and what it would take.

use mmxrt::Result;
use mmxrt::job::{self, Outlook};
use mmxrt::study::{Bound, Choice, Coarser, Decision, Effect, Plan, Request, TOLERANCE, WITHIN};
use serde_json::json;

use super::Outcome;
use super::console::Console;
use super::dry_run::{rounded, size};
use super::scene::SceneArguments;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    request: RequestArguments,
    /// Say how each bound comes about
    #[arg(long)]
    explain: bool,
}

/// Which effects are wanted, and how good.
#[derive(clap::Args)]
pub(crate) struct RequestArguments {
    /// Which effects to model: `auto` those that the tolerance needs, `full` all that the scene has inputs for, `thesis` those of Domagala (2020), or a
    /// list such as `sunlight,mars-light,heat` (`mmxrt plan` names them)
    #[arg(long, value_name = "auto|thesis|full|LIST", default_value = "auto", value_parser = Choice::parse)]
    model: Choice,
    /// The largest error of a pixel that all that is left out may add up to, over its radiance or 0.01 of the median sunlit radiance
    #[arg(long, value_name = "SHARE", default_value_t = TOLERANCE, value_parser = tolerance)]
    tolerance: f64,
}

fn tolerance(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("give a number above 0, such as 1e-3".into()),
    }
}

impl RequestArguments {
    pub(super) fn request(&self) -> Request {
        Request { choice: self.model.clone(), tolerance: self.tolerance }
    }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    let (outlook, plan) = job::plan(
        &arguments.scene.scene,
        &arguments.scene.reading.reading(console)?,
        &arguments.request.request(),
        &watch,
    )?;
    let json = json!({
        "plan": plan,
        "expects": {
            "memory_bytes": outlook.dry_run.memory_bytes, "disk_bytes": outlook.dry_run.product_bytes,
            "cpu_s": outlook.dry_run.cpu_s, "cpu_s_within_factor": WITHIN,
        },
    });
    console.result(&text(&outlook, &plan, arguments.explain), &json)?;
    outlook.error.map_or(Ok(Outcome::Done), Err)
}

fn text(outlook: &Outlook, plan: &Plan, explain: bool) -> String {
    let mut lines = vec![
        format!("model: {}, tolerance {}", plan.model, plan.tolerance),
        "errors of a pixel, over its radiance or 0.01 of the median sunlit radiance; CPU time on a machine of 2022"
            .to_owned(),
        format!("{:<46} {:<17} {:>10} {:>10} {:>8}", "effect", "", "sunlit", "in shadow", "CPU s"),
    ];
    for effect in &plan.effects {
        lines.push(row(effect));
        if explain {
            lines.push(format!("    {}", effect.note));
            lines.extend(
                effect.stated.as_ref().map(|key| format!("    the scene decides it (`{key}`), not the tolerance")),
            );
            lines.push(format!("    bound: {}", effect.because));
            if let Some(remaining) = effect.remaining {
                lines.push(format!(
                    "    left of it: {} sunlit, {} in shadow",
                    short(remaining.lit),
                    short(remaining.shadow)
                ));
            }
        }
    }
    lines.extend(totals(plan));
    // Of what is dropped by a tolerance of its own, as of what is kept by one, no sum has a part.
    let decided = plan.effects.iter().filter(|effect| effect.decision != Decision::Open);
    let own = decided.filter_map(|effect| Some((effect, effect.own.as_ref()?)));
    lines.extend(own.map(|(effect, own)| {
        format!("by itself, {} ({}): {} {}", effect.key, word(effect.decision), short(own.left), own.of)
    }));
    lines.push(format!(
        "expects about {} CPU s (within a factor of {WITHIN}), {} of memory, {} of disk",
        rounded(outlook.dry_run.cpu_s, 2),
        size(outlook.dry_run.memory_bytes),
        size(outlook.dry_run.product_bytes),
    ));
    lines.extend(plan.moving.iter().cloned());
    lines.extend(plan.coarser.as_ref().map(|mesh| about_mesh(mesh, plan)));
    if !explain {
        lines.push("how each bound comes about: --explain".to_owned());
    }
    lines.join("\n")
}

/// What a coarser mesh would do, where this one is far finer than pixels.
pub(super) fn about_mesh(mesh: &Coarser, plan: &Plan) -> String {
    format!(
        "mesh: far finer than pixels, some {} facets a pixel; with {} facets ({} a pixel) it would take about {} CPU s instead of {}, and change 99 of 100 \
         sunlit pixels by less than some {} %, edges of shadows by more (a guess: `mmxrt chart` measures it)",
        rounded(mesh.facets_a_pixel, 2),
        mesh.facets,
        rounded(mesh.facets_a_pixel * mesh.facets as f64 / mesh.facets_of_scene as f64, 2),
        rounded(mesh.cpu_s, 2),
        rounded(plan.cpu_s, 2),
        rounded(100.0 * mesh.change, 1)
    )
}

fn row(effect: &Effect) -> String {
    let of = |part: fn(&Bound) -> f64| effect.bound.as_ref().map_or("not known".to_owned(), |bound| short(part(bound)));
    let cost = effect.cost_s.map_or(String::new(), |s| rounded(s, 2));
    let name = format!("{} ({})", effect.name, effect.key);
    let name = if effect.key == effect.name { effect.name.clone() } else { name };
    let by_scene = if effect.stated.is_some() { " by scene" } else { "" };
    let decision = format!("{}{by_scene}", word(effect.decision));
    format!("{name:<46} {decision:<17} {:>10} {:>10} {cost:>8}", of(|b| b.lit), of(|b| b.shadow))
}

pub(super) fn word(decision: Decision) -> &'static str {
    match decision {
        Decision::Kept => "kept",
        Decision::Dropped => "dropped",
        Decision::Open => "open",
    }
}

fn short(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}

/// What is dropped and what is left, and whether that is within the tolerance.
fn totals(plan: &Plan) -> Vec<String> {
    let sum = |bound: Option<Bound>| match bound {
        Some(bound) => format!("{} sunlit, {} in shadow", short(bound.lit), short(bound.shadow)),
        None => "not known".to_owned(),
    };
    let verdict = if plan.keeps_tolerance() { "within the tolerance" } else { "NOT shown to be within the tolerance" };
    vec![
        format!("dropped, together: {}", sum(plan.dropped)),
        format!("left of what is kept: {}", sum(plan.remaining)),
        format!(
            "that is {verdict}; what is open, because an input is missing, is not counted, nor what the scene leaves out, nor what has a tolerance of its own"
        ),
    ]
}

/// The plan in a line: what is kept, dropped and open.
pub(super) fn in_short(plan: &Plan) -> String {
    let of = |decision: Decision| {
        let named = |effect: &Effect| match &effect.stated {
            Some(key) => format!("{} (by {key})", effect.key),
            None => effect.key.clone(),
        };
        let keys: Vec<String> = plan.effects.iter().filter(|effect| effect.decision == decision).map(named).collect();
        if keys.is_empty() { String::new() } else { format!("; {}: {}", word(decision), keys.join(", ")) }
    };
    let parts: String = [Decision::Kept, Decision::Dropped, Decision::Open].map(of).concat();
    // Who names effects has decided; who leaves it to the tolerance must hear that it is not reached.
    let is_open = matches!(plan.model.as_str(), "auto" | "full") && !plan.keeps_tolerance();
    let verdict = if is_open { " (NOT shown to be kept: `mmxrt plan` says by what)" } else { "" };
    format!("plan: {}, tolerance {}{verdict}{parts}", plan.model, plan.tolerance)
}
