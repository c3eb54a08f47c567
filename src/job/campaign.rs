//! Runs a campaign: a folder of products, and the coverage of the surface.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use crate::error::{Error, Result};
use crate::flight::Scale;
use crate::formats::campaign_folder::{CampaignFolder, Failure};
use crate::formats::campaign_toml::{Acquisition, Campaign};
use crate::formats::manifest_json::{
    AcquisitionEntry, CoverageEntry, EntryState, FORMAT, FORMAT_VERSION, Manifest, ShareEntry, WithinEntry,
};
use crate::formats::report_json::{Input, Run};
use crate::product::{Coverage, SurfaceShare};
use crate::progress::{Progress, Watch, tell};
use crate::study::{self, Moving};

/// What a stage of progress is called here.
const STAGE: &str = "acquisitions";
/// Between two looks whether another process has ended.
const PATIENCE: Duration = Duration::from_millis(100);

/// A shard: every `of`-th acquisition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Its number, from 1.
    number: usize,
    of: usize,
}

impl FromStr for Shard {
    type Err = String;

    /// `K/N`.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(k, n)| Some((k.trim().parse().ok()?, n.trim().parse().ok()?)));
        match numbers {
            Some((number, of)) if 1 <= number && number <= of => Ok(Shard { number, of }),
            Some((number, of)) => {
                Err(format!("{number} is not from 1 to {of}: the parts of {of} are 1/{of} to {of}/{of}"))
            }
            None => Err("give K/N, e.g. 2/4 for the second of four parts".into()),
        }
    }
}

impl Shard {
    fn has(self, acquisition: usize) -> bool {
        acquisition % self.of == self.number - 1
    }
}

/// What to run of a campaign.
#[derive(Debug, Clone)]
pub struct Order<'a> {
    /// The campaign's folder.
    pub folder: &'a Path,
    /// Only a shard.
    pub shard: Option<Shard>,
    /// No products: only the facet sightings.
    pub coverage_only: bool,
}

/// Outcome of an acquisition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Made.
    Done,
    /// Already there, with the same id.
    Kept,
    /// Failed.
    Failed,
    /// Being made by another process. It is tried again after all others, and then reported once more.
    Busy,
}

/// Status of an acquisition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Status {
    /// Its name.
    pub name: String,
    /// Start of its first exposure, UTC.
    pub epoch_utc: String,
    /// Outcome.
    pub state: State,
    /// Path of its product, or of its sightings.
    pub path: PathBuf,
    /// Warnings of its product, or of its sightings.
    pub warnings: Vec<String>,
    /// Why it failed.
    pub errors: Vec<String>,
    /// Leftovers of killed runs, and the process it waits for.
    pub told: Vec<String>,
}

/// Result of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// Numbers of acquisitions of this shard: made, kept, failed.
    pub counts: [usize; 3],
    /// The manifest; `None` while acquisitions of other shards are missing.
    pub manifest: Option<Manifest>,
    /// Path of the manifest.
    pub path: PathBuf,
    /// Products in the folder that belong to no acquisition.
    pub others: Vec<String>,
}

/// Makes the missing acquisitions of a campaign and passes each to `report`; `run` supplies the `run.json` of each. A
/// failure does not stop the others. The last of several processes that share a campaign writes the manifest.
///
/// # Errors
/// [`Error::Invalid`] if the folder is not one of a campaign, or holds what it is made from; [`Error::Io`] if what became of an acquisition cannot be
/// written; what `report` returns; [`Error::Interrupted`] if `watch` asks to stop.
pub fn campaign(
    campaign: &mut Campaign,
    order: &Order<'_>,
    run: &dyn Fn() -> Run,
    report: &mut dyn FnMut(Status) -> Result<()>,
    watch: Watch<'_>,
) -> Result<Finished> {
    let inputs: Vec<PathBuf> =
        campaign.inputs().iter().chain([&campaign.input]).map(|input| input.path.clone()).collect();
    let folder = CampaignFolder::open(order.folder, inputs.iter().map(PathBuf::as_path))?;
    let all = campaign.acquisitions.clone();
    let is_mine = |i: usize| order.shard.is_none_or(|shard| shard.has(i));
    let mine: Vec<&Acquisition> = (0..all.len()).filter(|i| is_mine(*i)).map(|i| &all[i]).collect();
    let total = mine.len() as u64;
    let mut counts = [0; 3];
    let mut done = 0;
    let mut left: VecDeque<(&Acquisition, bool)> = mine.into_iter().map(|acquisition| (acquisition, false)).collect();
    tell(watch, STAGE, 0, total)?;
    while let Some((acquisition, is_again)) = left.pop_front() {
        // The stages of each acquisition would only flicker.
        let quiet = |_: Progress| watch(Progress { stage: STAGE, done, total });
        // What another process was making is there when that has ended; if it was killed, it is made here.
        let told = if is_again { await_others(&folder, &acquisition.name, &quiet)? } else { vec![] };
        let mut status = attempt(campaign, &folder, acquisition, order, run, &quiet)?;
        status.told.splice(..0, told);
        if status.state == State::Busy {
            left.push_back((acquisition, true));
            if is_again {
                continue;
            }
        } else {
            counts[status.state as usize] += 1;
            done += 1;
        }
        report(status)?;
        tell(watch, STAGE, done, total)?;
    }
    let manifest = match entries(campaign, &folder, &all, order)? {
        Some(entries) => Some(finish(campaign, &folder, entries, watch)?),
        None => None,
    };
    let others = folder.others(all.iter().map(|acquisition| acquisition.name.as_str()));
    Ok(Finished { counts, manifest, path: folder.manifest(), others })
}

/// Waits until nobody is making something of an acquisition; says what killed ones had left of it.
fn await_others(folder: &CampaignFolder, name: &str, watch: Watch<'_>) -> Result<Vec<String>> {
    let mut told = folder.settle(name)?;
    while folder.is_being_made(name) {
        std::thread::sleep(PATIENCE);
        tell(watch, STAGE, 0, 0)?;
        told.extend(folder.settle(name)?);
    }
    Ok(told)
}

/// Makes an acquisition, if it is not there, and notes if it cannot be made.
fn attempt(
    campaign: &mut Campaign,
    folder: &CampaignFolder,
    acquisition: &Acquisition,
    order: &Order<'_>,
    run: &dyn Fn() -> Run,
    watch: Watch<'_>,
) -> Result<Status> {
    let name = &acquisition.name;
    let mut status = Status {
        name: name.clone(),
        epoch_utc: acquisition.epoch.to_text(Scale::Utc, 3, &campaign.leap()),
        state: State::Failed,
        path: if order.coverage_only { folder.sights(name) } else { folder.product(name) },
        warnings: vec![],
        errors: vec![],
        told: folder.settle(name)?,
    };
    match one(campaign, folder, acquisition, order, run, watch) {
        Ok((state, warnings)) => {
            folder.clear_failure(name)?;
            (status.state, status.warnings) = (state, warnings);
        }
        Err(Error::Interrupted) => return Err(Error::Interrupted),
        Err(error) if CampaignFolder::is_busy(&error) => {
            status.state = State::Busy;
            status.told.extend(sentences(&error));
        }
        Err(error) => {
            status.errors = sentences(&error);
            let failure = Failure { entry: campaign.entry_id(acquisition), errors: status.errors.clone() };
            match folder.put_failure(name, &failure) {
                // Another process finds the same.
                Err(error) if CampaignFolder::is_busy(&error) => {}
                noted => noted?,
            }
        }
    }
    Ok(status)
}

/// All that is wrong, a sentence each.
fn sentences(error: &Error) -> Vec<String> {
    let problems: Vec<String> = error.problems().iter().map(ToString::to_string).collect();
    if problems.is_empty() { vec![error.to_string()] } else { problems }
}

/// Makes the missing parts of an acquisition; returns its warnings too.
fn one(
    campaign: &mut Campaign,
    folder: &CampaignFolder,
    acquisition: &Acquisition,
    order: &Order<'_>,
    run: &dyn Fn() -> Run,
    watch: Watch<'_>,
) -> Result<(State, Vec<String>)> {
    let name = &acquisition.name;
    let look = campaign.look(acquisition)?;
    let (sights_id, product_id) = (look.sights_id.clone(), look.product_id.clone());
    let needs_sights = !folder.has_sights(name, &sights_id);
    let made = || folder.product_report(name, &product_id, &campaign.options);
    let report = if order.coverage_only { None } else { made() };
    let needs_product = !order.coverage_only && report.is_none();
    let state = if needs_sights || needs_product { State::Done } else { State::Kept };
    let mut warnings = report.map(|report| report.warnings);
    if state == State::Done {
        let subject = campaign.subject(acquisition, look)?;
        if let (Some((motion, timing)), true) = (&subject.motion, needs_sights) {
            let moving = Moving { scene: &subject.scene, motion, timing: *timing, optics: None };
            folder.put_sights(name, &sights_id, || study::sights(moving, watch))?;
        }
        if needs_product {
            let product = folder.stage(name, campaign.options.clone())?;
            warnings = Some(super::simulate(subject, &campaign.request, product, run, watch)?.report.warnings);
        }
    }
    let warnings = match warnings {
        Some(warnings) => warnings,
        None => study::warnings_of_sights(&folder.read_sights(name, campaign.body().mesh.facets.len())?),
    };
    Ok((state, warnings))
}

/// Status of all acquisitions, of any shard; `None` while one is neither there nor failed.
fn entries(
    campaign: &mut Campaign,
    folder: &CampaignFolder,
    all: &[Acquisition],
    order: &Order<'_>,
) -> Result<Option<Vec<AcquisitionEntry>>> {
    let leap = campaign.leap();
    let mut entries = Vec::new();
    for acquisition in all {
        let name = &acquisition.name;
        let (mut sights, mut product, mut warnings) = (None, None, vec![]);
        // What cannot even be looked at has failed, and that is noted.
        if let Ok(look) = campaign.look(acquisition) {
            sights = Some(look.sights_id).filter(|id| folder.has_sights(name, id));
            let report = folder.product_report(name, &look.product_id, &campaign.options);
            product = report.is_some().then_some(look.product_id);
            warnings = report.map_or(vec![], |report| report.warnings);
        }
        let is_done = sights.is_some() && (order.coverage_only || product.is_some());
        let failure = folder.failure(name, &campaign.entry_id(acquisition)).filter(|_| !is_done);
        if !is_done && failure.is_none() {
            return Ok(None);
        }
        entries.push(AcquisitionEntry {
            name: name.clone(),
            epoch_utc: acquisition.epoch.to_text(Scale::Utc, 3, &leap),
            epoch_tdb_s: acquisition.epoch.tdb_s(),
            state: if is_done { EntryState::Done } else { EntryState::Failed },
            sights,
            product,
            warnings: warnings.len() as u64,
            first_warning: warnings.into_iter().next(),
            errors: failure.map_or(vec![], |failure| failure.errors),
        });
    }
    Ok(Some(entries))
}

/// Combines the coverage of acquisitions, and writes the manifest.
fn finish(
    campaign: &Campaign,
    folder: &CampaignFolder,
    mut acquisitions: Vec<AcquisitionEntry>,
    watch: Watch<'_>,
) -> Result<Manifest> {
    const STAGE: &str = "coverage";
    let body = campaign.body();
    let facets = body.mesh.facets.len();
    let mut coverage = Coverage::new(facets, campaign.rule.clone());
    let total = acquisitions.len() as u64;
    for (done, entry) in (0..total).zip(&mut acquisitions) {
        tell(watch, STAGE, done, total)?;
        if entry.sights.is_some() {
            let sights = folder.read_sights(&entry.name, facets)?;
            coverage.add(&sights);
            if entry.product.is_none() {
                let warnings = study::warnings_of_sights(&sights);
                entry.warnings = warnings.len() as u64;
                entry.first_warning = warnings.into_iter().next();
            }
        }
    }
    let area_m2: Vec<f64> = (0..facets).map(|facet| body.mesh.facet(facet).area_m2()).collect();
    let SurfaceShare { at_least, at_most } = coverage.seen(&area_m2);
    let within = coverage.within(&area_m2).map(|(within_m, share)| WithinEntry {
        within_m,
        at_least: share.at_least,
        at_most: share.at_most,
    });
    let rule = &campaign.rule;
    let manifest = Manifest {
        format: FORMAT.to_owned(),
        format_version: FORMAT_VERSION,
        mmxrt: env!("CARGO_PKG_VERSION").to_owned(),
        campaign: Input::from(&campaign.input),
        inputs: campaign.inputs().iter().map(Input::from).collect(),
        acquisitions,
        coverage: CoverageEntry {
            facets: facets as u64,
            area_m2: area_m2.iter().sum(),
            in_sunlight: rule.in_sunlight,
            most_emission_deg: rule.most_emission_deg,
            most_incidence_deg: rule.most_incidence_deg,
            seen: ShareEntry { at_least, at_most },
            within: within.collect(),
        },
    };
    // If another process is writing it, that is the same.
    folder.finish(&manifest, &coverage, body)?;
    tell(watch, STAGE, total, total)?;
    Ok(manifest)
}
