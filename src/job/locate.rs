//! Geolocation queries: ground points of pixels, and pixels of ground points.

use std::path::Path;

use rayon::prelude::*;

use crate::error::{Error, Problem, Result};
use crate::formats::campaign_toml::Campaign;
use crate::formats::folder::Staged;
use crate::formats::points_csv::{Asked, Found, Question};
use crate::formats::{Reading, Subject};
use crate::formats::{isd_json, knowledge_table, knowledge_toml, scene_toml};
use crate::progress::{Watch, tell};
use crate::study;
use crate::study::knowledge::{self, Row};
use crate::study::locate::Locator;

/// Most acquisitions listed in a message.
const TOLD: usize = 8;
/// Questions answered between two reports of progress: some milliseconds of rays, and at worst a second of epochs of a push-broom.
const TOGETHER: usize = 256;

/// A scene, or an acquisition of a campaign, by the name of its file.
#[derive(Debug, Clone, Copy)]
pub struct SceneOf<'a> {
    /// The scene's file, or the campaign's.
    pub file: &'a Path,
    /// Of a campaign the acquisition's name.
    pub acquisition: Option<&'a str>,
    /// How it is read.
    pub reading: &'a Reading,
}

impl SceneOf<'_> {
    /// Reads it.
    ///
    /// # Errors
    /// Those of [`scene_toml::read`], of [`Campaign::open`] and [`Campaign::subject`]; [`Error::Invalid`] for an acquisition that there is none of.
    pub fn open(self, watch: Watch<'_>) -> Result<Subject> {
        let subject = match self.acquisition {
            Some(name) => acquired(self.file, name, self.reading, watch)?,
            None => Subject::from(scene_toml::read_with(self.file, self.reading, watch)?),
        };
        Ok(subject)
    }

    /// The same, with the tree that rays are followed in.
    fn planted(self, watch: Watch<'_>) -> Result<Subject> {
        let subject = self.open(watch)?;
        plant(&subject, self.reading, watch)?;
        Ok(subject)
    }
}

/// Gives a subject's body its tree of rays, from the cache if there is one.
fn plant(subject: &Subject, reading: &Reading, watch: Watch<'_>) -> Result<()> {
    tell(watch, "tree", 0, 1)?;
    match &reading.cache {
        Some(cache) => cache.plant(&subject.scene.body),
        None => _ = subject.scene.body.ray_tree(),
    }
    tell(watch, "tree", 1, 1)
}

/// Writes results as a table.
///
/// # Errors
/// Those of [`Staged::file`]; [`Error::Invalid`](crate::Error::Invalid) if an input would be replaced; [`Error::Io`](crate::Error::Io).
pub fn write_answers(target: &Path, replace: bool, text: &str, inputs: &[&Path]) -> Result<()> {
    let staged = Staged::file(target, replace)?;
    staged.spares(inputs.iter().copied())?;
    staged.put(staged.path(), |out| std::io::Write::write_all(out, text.as_bytes()))?;
    staged.commit()
}

/// Answers queries about what has been read, in order, each with its band counted from 0. The tree of rays is from the cache of `reading`, or kept there.
///
/// # Errors
/// Those of [`Locator::ground`]; [`Error::Interrupted`] if `watch` asks to stop.
pub fn answers(
    subject: &Subject,
    reading: &Reading,
    questions: &[Question],
    watch: Watch<'_>,
) -> Result<Vec<(usize, Found)>> {
    plant(subject, reading, watch)?;
    let motion = subject.motion.as_ref().map(|(motion, timing)| (motion, *timing));
    let locator = Locator::new(&subject.scene, motion);
    let reference = locator.reference_band();
    let answer = |question: &Question| {
        let band = question.band.unwrap_or(reference);
        let found = match question.asked {
            Asked::Pixel(place) => Found::Ground(locator.ground(place, band)?),
            Asked::Ground(point_m) => Found::Place(locator.place(point_m, band)?),
        };
        Ok((band, found))
    };
    let total = questions.len() as u64;
    let mut all = Vec::with_capacity(questions.len());
    tell(watch, "answers", 0, total)?;
    for some in questions.chunks(TOGETHER) {
        all.extend(some.par_iter().map(answer).collect::<Result<Vec<_>>>()?);
        tell(watch, "answers", all.len() as u64, total)?;
    }
    Ok(all)
}

/// An acquisition of a campaign.
pub(super) fn acquired(file: &Path, name: &str, reading: &Reading, watch: Watch<'_>) -> Result<Subject> {
    let mut campaign = Campaign::open_with(file, reading, watch)?;
    let Some(acquisition) = campaign.acquisitions.iter().find(|acquisition| acquisition.name == name).cloned() else {
        let names = campaign.acquisitions.iter().map(|acquisition| acquisition.name.as_str());
        let first: Vec<&str> = names.take(TOLD).collect();
        let more = if campaign.acquisitions.len() > TOLD { " ..." } else { "" };
        let problem = Problem::new(campaign.at("acquisitions"), format!("there is no acquisition called {name:?}"));
        return Err(Error::Invalid(vec![problem.with_help(format!("acquisitions: {}{more}", first.join(", ")))]));
    };
    let look = campaign.look(&acquisition)?;
    campaign.subject(&acquisition, look)
}

/// Most pixels reported when `--every` is not given.
const PIXELS: u32 = 256;

/// Geolocation errors of a scene, or of an acquisition of a campaign, by the uncertainties in a file; on request a
/// folder (whether it may be replaced) receives the table, images and summary.
///
/// # Errors
/// Those of [`scene_toml::read`], [`knowledge_toml::read`], [`knowledge::budget`] and [`Staged::folder_of`]; [`Error::Io`](crate::Error::Io).
pub fn locate_errors(
    of: SceneOf<'_>,
    known: &Path,
    (every, band): (Option<u32>, Option<usize>),
    folder: Option<(&Path, bool)>,
    watch: Watch<'_>,
) -> Result<(Vec<Row>, serde_json::Value)> {
    let staged = |(target, replace)| Staged::folder_of(&knowledge_table::FOLDER, target, replace);
    let folder = folder.map(staged).transpose()?;
    let file = of.planted(watch)?;
    let known = knowledge_toml::read(known, file.scene.body.origin_m)?;
    if let Some(folder) = &folder {
        let inputs = file.inputs.iter().chain(&known.inputs);
        folder.spares(inputs.map(|input| input.path.as_path()))?;
    }
    let locator = Locator::new(&file.scene, file.motion.as_ref().map(|(motion, timing)| (motion, *timing)));
    let camera = &file.scene.exposure.camera;
    let pixels = |every: &u32| camera.samples.div_ceil(*every).saturating_mul(camera.lines.div_ceil(*every));
    let few = || (1..=u32::MAX).find(|every| pixels(every) <= PIXELS).unwrap_or(1);
    let asked = knowledge::Asked {
        band: band.unwrap_or_else(|| locator.reference_band()),
        every: every.unwrap_or_else(few),
        draws: known.draws,
        seed: known.seed,
    };
    let budget = knowledge::budget(&locator, &known.knowledge, asked, watch).map_err(|error| known.placed(error))?;
    let rows = knowledge::summary(&budget);
    let summary = knowledge_table::summary_json(&budget, asked, &rows);
    if let Some(folder) = folder {
        knowledge_table::write(folder.path(), &budget, &summary).map_err(|error| folder.named(error))?;
        folder.commit()?;
    }
    Ok((rows, summary))
}

/// Writes the image support data of a scene, or of an acquisition of a campaign, for CSM, for a tunable filter in a band (from 0; without one the reference).
///
/// # Errors
/// Those of [`scene_toml::read`], [`isd_json::isd`] and [`Staged::file`]; [`Error::Invalid`](crate::Error::Invalid) if an input would be replaced;
/// [`Error::Io`](crate::Error::Io).
pub fn write_isd(
    of: SceneOf<'_>,
    band: Option<usize>,
    (target, replace): (&Path, bool),
    watch: Watch<'_>,
) -> Result<()> {
    let file = of.open(watch)?;
    let motion = file.motion.as_ref().map(|(motion, timing)| (motion, *timing));
    let band = band.unwrap_or_else(|| study::reference_band(&file.scene, motion));
    study::check_band(&file.scene, band, "--band")?;
    let isd = isd_json::isd(&file.scene, motion, band)?;
    let inputs: Vec<&Path> = file.inputs.iter().map(|input| input.path.as_path()).collect();
    write_answers(target, replace, &format!("{isd:#}\n"), &inputs)
}
