//! A mesh from four sides as PNG.

use std::io::Write;
use std::path::Path;

use super::drawing::{Anchor, Drawing};
use super::folder::Staged;
use super::quicklook::png_bytes;
use crate::error::{Error, Location, Problem, Result};
use crate::geometry::Mesh;
use crate::study::portrait::{SIDES, portraits};

/// Pixels along a side of a portrait, and of the margin above each.
const SIDE: usize = 360;
const MARGIN: usize = 22;

/// Writes the portraits of a mesh that comes from a file.
///
/// # Errors
/// [`Error::Invalid`] for another ending than `.png`, or if the mesh's file would be replaced; those of [`Staged::file`]; [`Error::Io`].
pub fn write(mesh: &Mesh, target: &Path, replace: bool, input: &Path) -> Result<()> {
    if target.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("png")) {
        let problem = Problem::new(Location::file(target), "meshes are shown as PNG");
        return Err(Error::Invalid(vec![problem.with_help("give it a name that ends in .png")]));
    }
    let (width, height) = (2 * SIDE, 2 * (SIDE + MARGIN));
    let mut page = Drawing::new(width as f64, height as f64);
    let corner = |i: usize| [i % 2 * SIDE, i / 2 * (SIDE + MARGIN)];
    for (i, side) in SIDES.iter().enumerate() {
        let [x, y] = corner(i).map(|n| n as f64);
        page.text([x + 8.0, y + 0.7 * MARGIN as f64], Anchor::Start, 12.0, [60; 3], side.name);
    }
    let too_large = || Error::invalid(Location::file(target), "the picture is too large");
    let (mut rgb, size) = page.rgb(1.0).ok_or_else(too_large)?;
    for (i, portrait) in portraits(mesh, SIDE).iter().enumerate() {
        let [x, y] = corner(i);
        for (row, line) in portrait.chunks_exact(3 * SIDE).enumerate() {
            let first = 3 * ((y + MARGIN + row) * size[0] + x);
            rgb[first..first + line.len()].copy_from_slice(line);
        }
    }
    let bytes = png_bytes(size, png::ColorType::Rgb, &rgb);
    let staged = Staged::file(target, replace)?;
    staged.spares([input])?;
    staged.put(staged.path(), |out| out.write_all(&bytes))?;
    staged.commit()
}
