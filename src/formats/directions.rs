//! Tables of where the pixels of a sensor look: a direction for the centre of each pixel, line by line, as NumPy's array or as CSV.
//!
//! A direction is two tangents (x right, y down, for 1 along the boresight) or a vector (x right, y down, z along the boresight) of any length.

use std::path::Path;

use super::input::{self, InputFile, Problems};
use super::table::Places;
use super::{marks, npy};
use crate::error::{Error, Location, Problem, Result};
use crate::geometry::polygon::Point;

/// A longer table is refused, bytes: 16384 x 16384 vectors take 6 GB.
const LONGEST: u64 = 1 << 33;

/// Ideal tangents of each pixel's centre, line by line, of an image of these samples and lines.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for an array of another size, and with every pixel that looks nowhere ahead; [`Error::Unsupported`] for another type of number.
pub(in crate::formats) fn read(path: &Path, size: [u32; 2]) -> Result<(Vec<Point>, InputFile)> {
    if input::beginning(path, marks::NUMPY.len())? == marks::NUMPY {
        let bytes = input::bytes(path, LONGEST)?;
        Ok((of_array(path, &bytes, size)?, InputFile::of(path, &bytes)))
    } else {
        let (text, input) = input::text(path, LONGEST)?;
        Ok((of_text(path, &text, size)?, input))
    }
}

fn of_array(path: &Path, bytes: &[u8], [samples, lines]: [u32; 2]) -> Result<Vec<Point>> {
    let wrong = |message: String| Error::invalid(Location::file(path), message);
    let array = npy::preamble(bytes).map_err(|message| Error::syntax(Location::file(path), message))?;
    let [samples, lines] = [samples, lines].map(|n| n as usize);
    let axes = match array.shape[..] {
        [l, s, axes @ 2..=3] if [l, s] == [lines, samples] => axes,
        [n, axes @ 2..=3] if n == lines * samples => axes,
        _ => {
            let message = format!("an array of the shape {:?}", array.shape);
            let help = format!(
                "give ({lines}, {samples}, 2) tangents or ({lines}, {samples}, 3) vectors: lines, samples, axes"
            );
            return Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]));
        }
    };
    if array.fortran_order {
        return Err(wrong("its first index runs fastest: save `numpy.ascontiguousarray(a)`".into()));
    }
    let data = &bytes[array.start..];
    let values: Vec<f64> = match array.descr.as_str() {
        "<f8" => data.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
        "<f4" => data.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
        descr => {
            let feature = format!("directions of the type {descr:?} (save them as f8: `a.astype(\"<f8\")`)");
            return Err(Error::Unsupported { at: Location::file(path), feature });
        }
    };
    if values.len() != samples * lines * axes {
        return Err(wrong(format!("{} numbers of {}: it is cut short", values.len(), samples * lines * axes)));
    }
    let mut problems = Problems::default();
    let mut centres = Vec::with_capacity(samples * lines);
    for (i, direction) in values.chunks_exact(axes).enumerate() {
        match tangents(direction) {
            Some(at) => centres.push(at),
            None => problems.push(|| {
                let message =
                    format!("pixel {} of line {}, counted from 0, looks along {direction:?}", i % samples, i / samples);
                Problem::new(Location::file(path), message).with_help(AHEAD)
            }),
        }
    }
    problems.finish(path)?;
    Ok(centres)
}

/// What directions must be.
const AHEAD: &str = "two finite tangents, or a vector x, y, z with z, along the boresight, above 0";

fn of_text(path: &Path, text: &str, [samples, lines]: [u32; 2]) -> Result<Vec<Point>> {
    let mut rows = text.lines().filter(|line| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    let names: Vec<String> = rows.next().map(cells).unwrap_or_default().iter().map(|s| s.to_lowercase()).collect();
    if names != ["x", "y"] && names != ["x", "y", "z"] {
        let help = "give a header `x,y` (tangents) or `x,y,z` (vectors), then a row for each pixel, line by line";
        let problem = Problem::new(Location::line(path, 1), "is not a table of directions").with_help(help);
        return Err(Error::Invalid(vec![problem]));
    }
    let mut problems = Problems::default();
    let mut places = Places::of(path, text);
    let mut centres = Vec::new();
    for row in rows {
        let numbers: Option<Vec<f64>> = cells(row).iter().map(|cell| cell.parse().ok()).collect();
        match numbers.filter(|numbers| numbers.len() == names.len()).and_then(|numbers| tangents(&numbers)) {
            Some(at) => centres.push(at),
            None => {
                let at = places.place(row);
                problems
                    .push(|| Problem::new(at, format!("`{}` is not a direction ahead", row.trim())).with_help(AHEAD));
            }
        }
    }
    problems.finish(path)?;
    let count = samples as usize * lines as usize;
    if centres.len() != count {
        let message =
            format!("{} directions for {samples} x {lines} pixels: a row for each, line by line", centres.len());
        return Err(Error::invalid(Location::file(path), message));
    }
    Ok(centres)
}

fn cells(row: &str) -> Vec<&str> {
    row.split(',').map(str::trim).collect()
}

fn tangents(direction: &[f64]) -> Option<Point> {
    let at = match *direction {
        [x, y] => [x, y],
        [x, y, z] if z > 0.0 => [x / z, y / z],
        _ => return None,
    };
    at.iter().all(|x| x.is_finite()).then_some(at)
}

/// An array of tangents, as [`read`] reads it.
pub(in crate::formats) fn array(centres: &[Point], [samples, lines]: [u32; 2]) -> Vec<u8> {
    let mut bytes = npy::written("<f8", &format!("({lines}, {samples}, 2)"));
    bytes.extend(centres.iter().flatten().flat_map(|x| x.to_le_bytes()));
    bytes
}
