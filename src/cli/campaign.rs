//! `mmxrt campaign`: many acquisitions of a scene, and a record of what of the surface they see.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::time::Instant;

use mmxrt::formats::campaign_folder::COMMAND;
use mmxrt::formats::campaign_toml::Campaign;
use mmxrt::formats::manifest_json::Manifest;
use mmxrt::formats::report_json::Run;
use mmxrt::job::{self, Finished, Order, Shard, State, Status};
use mmxrt::{Error, Problem, Result};
use serde_json::json;

use super::Outcome;
use super::console::Console;
use super::scene::ReadingArguments;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The campaign file
    campaign: PathBuf,
    /// The campaign's folder, instead of the file's `output.folder`: existing products with the same id are kept
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Make only shard K of N: several processes can share a campaign and its folder
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// No products: only what the acquisitions see of the surface
    #[arg(long)]
    coverage_only: bool,
    #[command(flatten)]
    reading: ReadingArguments,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle_input(&arguments.campaign, console)?;
    let mut campaign = Campaign::open_with(&arguments.campaign, &arguments.reading.reading(console)?, &watch)?;
    let folder = folder(arguments, &campaign)?;
    let order = Order { folder: &folder, shard: arguments.shard, coverage_only: arguments.coverage_only };
    // Time per acquisition is counted from the end of the one before.
    let before = Cell::new((Instant::now(), console.cpu_s()));
    let run = || {
        let (began, cpu_s) = before.get();
        Run {
            wall_s: began.elapsed().as_secs_f64(),
            cpu_s: Some(console.cpu_s() - cpu_s),
            stages: vec![],
            ..console.run(COMMAND)
        }
    };
    let mut report = |status: Status| {
        let seconds = before.get().0.elapsed().as_secs_f64();
        before.set((Instant::now(), console.cpu_s()));
        status.told.iter().for_each(|said| console.note(said));
        console.line(&line(&status, seconds))
    };
    let finished = match job::campaign(&mut campaign, &order, &run, &mut report, &watch) {
        // Not that of other commands, of whose output nothing is there then.
        Err(Error::Interrupted) if !console.is_json() => {
            console.finish_progress();
            let folder = folder.display();
            console.note(&format!(
                "interrupted: what is complete in {folder} is kept, and the same command goes on from there"
            ));
            return Ok(Outcome::Failed);
        }
        finished => finished?,
    };
    console.finish_progress();
    say(&finished, console);
    // A shard answers for itself: who runs many would run all that came after a failure again.
    let [_, _, failed] = finished.counts;
    Ok(if failed == 0 { Outcome::Done } else { Outcome::Failed })
}

fn folder(arguments: &Arguments, campaign: &Campaign) -> Result<PathBuf> {
    arguments.output.clone().or(campaign.folder.clone()).ok_or_else(|| {
        let problem = Problem::new(campaign.at("output.folder"), "is missing: where the products go to");
        Error::Invalid(vec![problem.with_help("give it, or --output FOLDER")])
    })
}

/// The status of an acquisition, as a line of JSON.
fn line(status: &Status, seconds: f64) -> serde_json::Value {
    let state = match status.state {
        State::Done => "done",
        State::Kept => "kept",
        State::Failed => "failed",
        State::Busy => "busy",
    };
    let mut line = json!({
        "name": status.name, "epoch": format!("{} UTC", status.epoch_utc), "state": state,
        "seconds": (seconds * 1000.0).round() / 1000.0, "where": status.path.display().to_string(),
    });
    if let Some(first) = status.warnings.first() {
        line["warnings"] = json!(status.warnings.len());
        line["first_warning"] = json!(first);
    }
    if !status.errors.is_empty() {
        line["errors"] = json!(status.errors);
    }
    line
}

/// The result, for people.
fn say(finished: &Finished, console: &Console) {
    let Finished { counts: [done, kept, failed], manifest, path, others } = finished;
    console.note(&format!("{done} done, {kept} kept, {failed} failed"));
    for name in others {
        console.note(&format!("warning: products/{name} belongs to no acquisition of this campaign"));
    }
    match manifest {
        Some(manifest) => {
            let warned = manifest.warned().count();
            let elsewhere = manifest.failed().saturating_sub(*failed);
            if elsewhere > 0 {
                console.note(&format!("{elsewhere} failed in other shards"));
            }
            if warned > 0 {
                let all = manifest.acquisitions.len();
                console.note(&format!("{warned} of {all} have warnings: `first_warning` in {}", path.display()));
            }
            coverage(manifest, path).iter().for_each(|said| console.note(said));
        }
        None => console.note("other shards are unfinished: the last one writes the manifest"),
    }
}

fn coverage(manifest: &Manifest, path: &Path) -> Vec<String> {
    let share = |least: f64, most: f64| format!("{:.2} to {:.2} %", 100.0 * least, 100.0 * most);
    let of = &manifest.coverage;
    let mut said =
        vec![format!("{}: {} of the surface seen", path.display(), share(of.seen.at_least, of.seen.at_most))];
    let within = of.within.iter().filter(|of| of.at_most > 0.0);
    said.extend(within.map(|of| format!("  within {} m: {}", of.within_m, share(of.at_least, of.at_most))));
    said
}
