//! What an acquisition sees of each facet: written, and read back to be added up.

use std::path::Path;

use super::archive::Npz;
use super::write::{About, Column, Values, write};
use crate::error::{Error, Problem, Result};
use crate::product::Sights;

/// What the header says it is, and its version.
const SIGHTS: (&str, u32) = ("mmxrt sights", 1);

/// Writes what an acquisition sees; `id` says which one.
///
/// # Errors
/// [`Error::Io`] if the file cannot be written.
pub fn write_sights(path: &Path, sights: &Sights, id: &str) -> Result<()> {
    let Sights { facet, seen, sunlit, sampling_m, incidence_deg, emission_deg } = sights;
    let column = |name, unit, meaning, values| Column::new(name, unit, meaning, Values::F32(values));
    let columns = [
        Column::new("facet", "1", "facets that are seen, from 0, ascending", Values::U32(facet)),
        column("seen", "1", "share of the facet's area that is seen", seen),
        column("sunlit", "1", "share of the facet's area that is seen and sees the middle of the Sun", sunlit),
        column(
            "sampling_m",
            "m",
            "root of the area of the facet's plane that a pixel shows, in the middle of what is seen",
            sampling_m,
        ),
        column("incidence_deg", "deg", "angle between the facet's normal and the Sun", incidence_deg),
        column(
            "emission_deg",
            "deg",
            "angle between the facet's normal and the camera, in the middle of what is seen",
            emission_deg,
        ),
    ];
    write(path, SIGHTS, id, About::default(), &columns)
}

/// Which acquisition a file of sights is of.
///
/// # Errors
/// [`Error::Io`]; those of a file that is something else, or damaged.
pub fn sights_id(path: &Path) -> Result<String> {
    Ok(Npz::open(path)?.header(SIGHTS.0, &[SIGHTS.1])?.scene)
}

/// Reads what an acquisition sees of a mesh of so many facets, and which acquisition that is.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] naming the array that is damaged; [`Error::Invalid`] with everything that is missing or cannot be.
pub fn read_sights(path: &Path, facets: usize) -> Result<(Sights, String)> {
    let mut file = Npz::open(path)?;
    let header = file.header(SIGHTS.0, &[SIGHTS.1])?;
    let mut problems = Vec::new();
    let sights = Sights {
        facet: file.u32s("facet", &mut problems)?,
        seen: file.f32s("seen", &mut problems)?,
        sunlit: file.f32s("sunlit", &mut problems)?,
        sampling_m: file.f32s("sampling_m", &mut problems)?,
        incidence_deg: file.f32s("incidence_deg", &mut problems)?,
        emission_deg: file.f32s("emission_deg", &mut problems)?,
    };
    if problems.is_empty() {
        problems.extend(sights.validate(facets).err().map(|why| Problem::new(file.at("facet"), why)));
    }
    if problems.is_empty() { Ok((sights, header.scene)) } else { Err(Error::Invalid(problems)) }
}
