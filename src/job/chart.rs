//! A scene becomes a chart of error against time; methods are driven to where they fail.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::formats::Subject;
use crate::formats::chart::ChartFolder;
use crate::progress::{Watch, tell};
use crate::study::chart::{self, Chart, Clock};
use crate::study::stability::{self, Hazard};

/// Renders what was exported to a folder, by another program.
pub type Render<'a> = &'a dyn Fn(&Path) -> Result<()>;

/// Runs all methods on a scene, and writes what they come to; `timed` says what the times of `clock` are. If `mitsuba` is there, it renders the
/// same scene; why it could not is a note in the chart, not an error.
///
/// # Errors
/// Those of [`chart`](chart::chart); [`Error::Invalid`](crate::Error::Invalid) if an input would be replaced;
/// [`Error::Io`](crate::Error::Io).
pub fn chart(
    subject: &Subject,
    folder: ChartFolder,
    clock: Clock<'_>,
    timed: &str,
    mitsuba: Option<Render<'_>>,
    watch: Watch<'_>,
) -> Result<(Chart, Vec<PathBuf>)> {
    folder.spares(subject.inputs.iter().map(|input| input.path.as_path()))?;
    let mut chart = chart::chart(&name(subject), &subject.scene, clock, watch)?;
    if let Some(render) = mitsuba {
        tell(watch, "mitsuba", 0, 1)?;
        let known = chart::lambert_sunlight(&subject.scene)?;
        let rendered =
            folder.export_mitsuba(&known).and_then(|path| render(&path)).and_then(|()| folder.read_mitsuba(&known));
        match rendered {
            Ok(images) => chart.add(&known, images, watch)?,
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(error) => chart.notes.push(format!("Mitsuba is not in this chart: {error}")),
        }
        tell(watch, "mitsuba", 1, 1)?;
    }
    tell(watch, "writing the chart", 0, 1)?;
    let files = folder.write(&chart, timed)?;
    tell(watch, "writing the chart", 1, 1)?;
    Ok((chart, files))
}

/// Drives all methods to where they fail, and writes where that is.
///
/// # Errors
/// Those of [`stability`](stability::stability); [`Error::Io`](crate::Error::Io).
pub fn stability(folder: ChartFolder, watch: Watch<'_>) -> Result<(Vec<Hazard>, Vec<PathBuf>)> {
    let hazards = stability::stability(watch)?;
    let files = folder.write_stability(&hazards)?;
    Ok((hazards, files))
}

/// What people call a scene: the folder of its file, if the file is called like all others.
fn name(subject: &Subject) -> String {
    let Some(path) = subject.inputs.first().map(|input| input.path.as_path()) else { return subject.id.clone() };
    let named = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let stem = named(path).unwrap_or_default();
    let folder = path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    if stem == "scene" { folder.unwrap_or(stem) } else { stem }
}
