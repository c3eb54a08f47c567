//! Questions about where pixels look, and in which pixels points lie.

use std::path::Path;

use rayon::prelude::*;

use crate::error::{Error, Problem, Result};
use crate::formats::Subject;
use crate::formats::campaign_toml::Campaign;
use crate::formats::folder::Staged;
use crate::formats::points_csv::{Asked, Found, Question};
use crate::formats::scene_toml;
use crate::progress::{Watch, tell};
use crate::study::locate::Locator;

/// At most this many acquisitions are named.
const TOLD: usize = 8;

/// Writes answers as a table.
///
/// # Errors
/// Those of [`Staged::file`]; [`Error::Invalid`](crate::Error::Invalid) if an input would be replaced; [`Error::Io`](crate::Error::Io).
pub fn write_answers(target: &Path, replace: bool, text: &str, inputs: &[&Path]) -> Result<()> {
    let staged = Staged::file(target, replace)?;
    staged.spares(inputs.iter().copied())?;
    staged.put(staged.path(), |out| std::io::Write::write_all(out, text.as_bytes()))?;
    staged.commit()
}

/// Answers questions about a scene, or about the acquisition of this name of a campaign, in their order, each with its band counted from 0.
///
/// # Errors
/// Those of [`scene_toml::read`], of [`Campaign::open`] and [`Campaign::subject`], and of [`Locator::ground`]; [`Error::Invalid`] for an acquisition
/// that there is none of; [`Error::Interrupted`] if `watch` asks to stop.
pub fn locate(
    file: &Path,
    acquisition: Option<&str>,
    questions: &[Question],
    watch: Watch<'_>,
) -> Result<Vec<(usize, Found)>> {
    let subject = match acquisition {
        Some(name) => acquired(file, name, watch)?,
        None => Subject::from(scene_toml::read(file, watch)?),
    };
    tell(watch, "tree", 0, 1)?;
    let motion = subject.motion.as_ref().map(|(motion, timing)| (motion, *timing));
    let locator = Locator::new(&subject.scene, motion);
    let reference = locator.reference_band();
    tell(watch, "tree", 1, 1)?;
    questions
        .par_iter()
        .map(|question| {
            let band = question.band.unwrap_or(reference);
            let found = match question.asked {
                Asked::Pixel(place) => Found::Ground(locator.ground(place, band)?),
                Asked::Ground(point_m) => Found::Place(locator.place(point_m, band)?),
            };
            Ok((band, found))
        })
        .collect()
}

/// An acquisition of a campaign.
fn acquired(file: &Path, name: &str, watch: Watch<'_>) -> Result<Subject> {
    let mut campaign = Campaign::open(file, watch)?;
    let Some(acquisition) = campaign.acquisitions.iter().find(|acquisition| acquisition.name == name).cloned() else {
        let names = campaign.acquisitions.iter().map(|acquisition| acquisition.name.as_str());
        let first: Vec<&str> = names.take(TOLD).collect();
        let more = if campaign.acquisitions.len() > TOLD { " ..." } else { "" };
        let problem = Problem::new(campaign.at("acquisitions"), format!("there is none called {name:?}"));
        return Err(Error::Invalid(vec![problem.with_help(format!("they are {}{more}", first.join(", ")))]));
    };
    let look = campaign.look(&acquisition)?;
    campaign.subject(&acquisition, look)
}
