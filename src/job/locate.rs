//! Questions about where pixels look, and in which pixels points lie.

use std::path::Path;

use rayon::prelude::*;

use crate::error::Result;
use crate::formats::folder::Staged;
use crate::formats::points_csv::{Asked, Found, Question};
use crate::formats::scene_toml;
use crate::progress::{Watch, tell};
use crate::study::locate::Locator;

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

/// Answers questions about a scene, in their order, each with its band counted from 0.
///
/// # Errors
/// Those of [`scene_toml::read`] and of [`Locator::ground`]; [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn locate(scene: &Path, questions: &[Question], watch: Watch<'_>) -> Result<Vec<(usize, Found)>> {
    let file = scene_toml::read(scene, watch)?;
    tell(watch, "tree", 0, 1)?;
    let motion = file.motion.as_ref().map(|(motion, timing)| (motion, *timing));
    let locator = Locator::new(&file.scene, motion);
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
