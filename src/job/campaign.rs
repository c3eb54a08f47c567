//! Runs a campaign: a folder of products, and the coverage of the surface.

use std::path::{Path, PathBuf};
use std::str::FromStr;

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
    /// Why it failed.
    pub errors: Vec<String>,
    /// Leftovers of killed runs.
    pub settled: Vec<String>,
}

/// Result of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// Numbers of acquisitions of this shard made, kept and failed.
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
    let leap = campaign.leap();
    let mut counts = [0; 3];
    tell(watch, STAGE, 0, total)?;
    for (done, acquisition) in (0..total).zip(mine) {
        // The stages of each acquisition would only flicker.
        let quiet = |_: Progress| watch(Progress { stage: STAGE, done, total });
        let name = &acquisition.name;
        let settled = folder.settle(name)?;
        let (state, errors) = match one(campaign, &folder, acquisition, order, run, &quiet) {
            Ok(state) => {
                folder.clear_failure(name)?;
                (state, vec![])
            }
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(error) => {
                let errors = sentences(&error);
                let failure = Failure { entry: campaign.entry_id(acquisition), errors: errors.clone() };
                // An acquisition being made by another process has not failed.
                if !CampaignFolder::is_busy(&error) {
                    folder.put_failure(name, &failure)?;
                }
                (State::Failed, errors)
            }
        };
        counts[state as usize] += 1;
        let path = if order.coverage_only { folder.sights(name) } else { folder.product(name) };
        let epoch_utc = acquisition.epoch.to_text(Scale::Utc, 3, &leap);
        report(Status { name: name.clone(), epoch_utc, state, path, errors, settled })?;
        tell(watch, STAGE, done + 1, total)?;
    }
    let manifest = match entries(campaign, &folder, &all, order)? {
        Some(entries) => Some(finish(campaign, &folder, entries, watch)?),
        None => None,
    };
    let others = folder.others(all.iter().map(|acquisition| acquisition.name.as_str()));
    Ok(Finished { counts, manifest, path: folder.manifest(), others })
}

/// All that is wrong, a sentence each.
fn sentences(error: &Error) -> Vec<String> {
    let problems: Vec<String> = error.problems().iter().map(ToString::to_string).collect();
    if problems.is_empty() { vec![error.to_string()] } else { problems }
}

/// Makes the missing parts of an acquisition.
fn one(
    campaign: &mut Campaign,
    folder: &CampaignFolder,
    acquisition: &Acquisition,
    order: &Order<'_>,
    run: &dyn Fn() -> Run,
    watch: Watch<'_>,
) -> Result<State> {
    let name = &acquisition.name;
    let look = campaign.look(acquisition)?;
    let needs_sights = !folder.has_sights(name, &look.sights_id);
    let needs_product = !order.coverage_only && !folder.has_product(name, &look.product_id, &campaign.options);
    if !needs_sights && !needs_product {
        return Ok(State::Kept);
    }
    let sights_id = look.sights_id.clone();
    let subject = campaign.subject(acquisition, look)?;
    if let (Some((motion, timing)), true) = (&subject.motion, needs_sights) {
        let moving = Moving { scene: &subject.scene, motion, timing: *timing, optics: None };
        folder.put_sights(name, &study::sights(moving, watch)?, &sights_id)?;
    }
    if needs_product {
        let product = folder.stage(name, campaign.options.clone())?;
        super::simulate(subject, &campaign.request, product, run, watch)?;
    }
    Ok(State::Done)
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
        let (mut sights, mut product) = (None, None);
        // An acquisition that cannot be opened has failed, which is recorded.
        if let Ok(look) = campaign.look(acquisition) {
            sights = Some(look.sights_id).filter(|id| folder.has_sights(name, id));
            product = Some(look.product_id).filter(|id| folder.has_product(name, id, &campaign.options));
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
            errors: failure.map_or(vec![], |failure| failure.errors),
        });
    }
    Ok(Some(entries))
}

/// Combines the coverage of acquisitions, and writes the manifest.
fn finish(
    campaign: &Campaign,
    folder: &CampaignFolder,
    acquisitions: Vec<AcquisitionEntry>,
    watch: Watch<'_>,
) -> Result<Manifest> {
    const STAGE: &str = "coverage";
    let body = campaign.body();
    let facets = body.mesh.facets.len();
    let mut coverage = Coverage::new(facets, campaign.rule.clone());
    let total = acquisitions.len() as u64;
    for (done, entry) in (0..total).zip(&acquisitions) {
        tell(watch, STAGE, done, total)?;
        if entry.sights.is_some() {
            coverage.add(&folder.read_sights(&entry.name, facets)?);
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
