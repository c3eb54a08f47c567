//! Flight-dynamics files of any format, read into an almanac.

use std::path::{Path, PathBuf};

use super::flight_file::FlightFile;
use super::format::{Format, Holds, ending};
use super::{flight_doubts, input, registry, spice};
use crate::error::{Error, Location, Problem, Result};
use crate::flight::{Almanac, LeapSeconds};
use crate::report::Report;

/// Length of the beginning by which a format is recognised, bytes.
const BEGINNING: usize = 1 << 16;

/// Reads a file of trajectories, attitudes, rotations or leap seconds into an almanac; it overrides what is there.
///
/// # Errors
/// Whatever is wrong with the file, or that its format is none of these.
pub fn furnish(path: &Path, almanac: &mut Almanac) -> Result<()> {
    furnish_all(&[path.to_owned()], almanac).map(|_| ())
}

/// Files that an almanac was furnished with.
#[derive(Debug, Default)]
pub struct Furnished {
    /// All that were read: those that meta-kernels name too.
    pub paths: Vec<PathBuf>,
    /// What was taken that they do not say, and what of them is lost.
    pub report: Report,
    /// What is doubtful in them, as sentences.
    pub doubts: Vec<String>,
}

/// Reads files into an almanac, and returns all that were read, including those that meta-kernels list. Kernels come
/// first, because their names and leap seconds are needed to interpret other files; where two of a kind overlap the
/// later one is used, and other files override kernels.
///
/// # Errors
/// As [`furnish`].
pub fn furnish_all(paths: &[PathBuf], almanac: &mut Almanac) -> Result<Furnished> {
    let (mut kernels, mut others) = (Vec::new(), Vec::new());
    for path in paths {
        let of_its_kind = if is_kernel(path)? { &mut kernels } else { &mut others };
        of_its_kind.push(path.clone());
    }
    let mut all = Furnished { paths: spice::furnish(&kernels, almanac)?, report: Report::default(), doubts: vec![] };
    for path in others {
        let file = read(&path, &almanac.leap)?;
        all.doubts.extend(flight_doubts::doubts(&file).iter().map(|doubt| format!("{}: {doubt}", path.display())));
        for (_, mut trajectory) in file.trajectories {
            trajectory.target = almanac.names.body(&trajectory.target);
            trajectory.centre = almanac.names.body(&trajectory.centre);
            almanac.trajectories.push(trajectory);
        }
        almanac.orientations.extend(file.orientations.into_iter().map(|(_, orientation)| orientation));
        all.paths.push(path);
        all.report.notes.extend(file.report.notes);
    }
    Ok(all)
}

/// Reads a file of trajectories and orientations that is not a kernel, with these leap seconds.
///
/// # Errors
/// Whatever is wrong with the file, or that its format is none of these.
pub fn read(path: &Path, leap: &LeapSeconds) -> Result<FlightFile> {
    match registry::of_input(path)?.0.holds {
        Holds::Flight { read, .. } => read(path, leap),
        _ => {
            let problem = Problem::new(Location::file(path), "is not a file of flight dynamics");
            let help = format!(
                "these are: kernels of SPICE, {}; a table (.csv, .toml) is one by its columns, e.g. `time`, `mmx_x_km`, `mmx_y_km`, `mmx_z_km`",
                registry::dotted(Format::is_flight)
            );
            Err(Error::Invalid(vec![problem.with_help(help)]))
        }
    }
}

/// Whether a file is a kernel of SPICE, by how it begins.
///
/// # Errors
/// [`Error::Io`].
pub fn is_kernel(path: &Path) -> Result<bool> {
    Ok(spice::is_kernel(&input::beginning(path, BEGINNING)?))
}

/// An almanac of the files of these names in a folder and its folders, two levels deep; `None` if one is not there, or cannot be read. Leap
/// seconds are known without their kernel.
pub fn of_names(folder: &Path, names: &[&str]) -> Option<Almanac> {
    let needed = names.iter().filter(|name| ending(Path::new(name)) != "tls");
    let paths: Option<Vec<PathBuf>> = needed.map(|name| input::file_named(folder, name)).collect();
    let mut almanac = Almanac::default();
    furnish_all(&paths?, &mut almanac).ok()?;
    Some(almanac)
}
