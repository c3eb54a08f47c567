//! Spectra as columns of a table: rows of text, and many spectra that share their wavelengths.

use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number};
use crate::spectral::{Column, SpectralLibrary};

use super::dart::kind::{is_known, outside, range, same};
use super::format::ending;
use super::input::Problems;
use super::wave_unit::WaveUnit;

/// Endings of tables of text, besides `.csv`.
const ENDINGS: [&str; 5] = ["txt", "tab", "dat", "asc", "tsv"];

/// The beginning of a table of text, which may be cut within a character; `None` of what is called otherwise, or is not text.
pub(super) fn beginning<'a>(path: &Path, bytes: &'a [u8]) -> Option<&'a str> {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(e) if e.error_len().is_none() => std::str::from_utf8(&bytes[..e.valid_up_to()]).unwrap_or_default(),
        Err(_) => return None,
    };
    (ENDINGS.contains(&ending(path).as_str()) && !text.contains('\0')).then_some(text)
}

/// A row of a table in text.
pub(super) struct Row<'a> {
    /// What stands between the separators, trimmed.
    pub(super) cells: Vec<&'a str>,
}

/// How a column of text is read.
pub(super) struct Reading {
    /// Its name, for messages.
    pub(super) name: String,
    /// From what is written to um, fractions and so on.
    pub(super) convert: fn(f64) -> f64,
    /// What the file has for 1.
    pub(super) unit: f64,
}

/// The place of a part of a text.
pub(super) fn place(path: &Path, text: &str, part: &str) -> Location {
    let start = (part.as_ptr() as usize).saturating_sub(text.as_ptr() as usize);
    Location::span(path, text, start, start + part.len())
}

/// The places of parts of a text, one after the other: each is counted from the one before it.
pub(super) struct Places<'a> {
    path: &'a Path,
    text: &'a str,
    /// Where the last part began, and its line and column.
    last: (usize, usize, usize),
}

impl<'a> Places<'a> {
    pub(super) fn of(path: &'a Path, text: &'a str) -> Self {
        Places { path, text, last: (0, 1, 1) }
    }

    /// The place of a part, as [`place`] tells it.
    pub(super) fn place(&mut self, part: &str) -> Location {
        let start = (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        let (last, line, column) = self.last;
        let Some(between) = self.text.get(last..start) else { return place(self.path, self.text, part) };
        let (line, column) = match between.rfind('\n') {
            None => (line, column + between.chars().count()),
            Some(end) => (line + between.matches('\n').count(), 1 + between[end + 1..].chars().count()),
        };
        self.last = (start, line, column);
        let span = Some((start, (start + part.len()).min(self.text.len())));
        Location { column: Some(column), span, ..Location::line(self.path, line) }
    }
}

/// Numbers of all columns; the first is wavelength, which must be positive and ascend. Rows begin within `text`.
///
/// # Errors
/// [`Error::Invalid`] with all cells that cannot be used: no finite number, outside the range of its column, and rows of
/// another length; for no rows.
pub(super) fn numbers(path: &Path, text: &str, rows: &[Row<'_>], columns: &[Reading]) -> Result<Vec<Vec<f64>>> {
    let mut problems = Problems::default();
    let mut values: Vec<Vec<f64>> = vec![Vec::with_capacity(rows.len()); columns.len()];
    for row in rows {
        let first = row.cells.first().copied().unwrap_or_default();
        if row.cells.len() != columns.len() {
            problems.push(|| {
                let message = format!("{} columns where the header has {}", row.cells.len(), columns.len());
                Problem::new(place(path, text, first), message)
            });
            continue;
        }
        for (i, (cell, column)) in row.cells.iter().zip(columns).enumerate() {
            let Some(written) = cell.parse::<f64>().ok().filter(|x| x.is_finite()) else {
                problems.push(|| Problem::new(place(path, text, cell), format!("`{cell}` is not a finite number")));
                continue;
            };
            let value = (column.convert)(written);
            let previous = values[i].last().copied().unwrap_or(0.0);
            let limits = range(&column.name);
            let wrong = match i {
                0 if value > previous => None,
                0 if value <= 0.0 => Some(format!("wavelength {cell} is not positive")),
                0 if value == previous => Some(format!("wavelength {cell} appears twice")),
                0 => Some(format!("wavelength {cell} is less than the one before it: sort the rows")),
                _ if (limits.0..=limits.1).contains(&value) => None,
                _ => Some(format!("{} {cell} {}", column.name, outside(limits, column.unit))),
            };
            match wrong {
                None => values[i].push(value),
                Some(message) => problems.push(|| Problem::new(place(path, text, cell), message)),
            }
        }
    }
    if rows.is_empty() {
        problems.push(|| Problem::new(Location::file(path), "no rows: a header, then at least one row of numbers"));
    }
    problems.finish(path)?;
    Ok(values)
}

/// What to report about a table in um or nm that has no wavelength between 0.1 and 100 um: it may be in another unit than its header says.
pub(super) fn doubtful_unit(unit: WaveUnit, wavelength_um: &[f64]) -> Option<String> {
    // No one mistakes metres or wavenumbers for either.
    if ![WaveUnit::MICROMETRES, WaveUnit::NANOMETRES].contains(&unit) {
        return None;
    }
    let (first_um, last_um) = (*wavelength_um.first()?, *wavelength_um.last()?);
    let help = if first_um > 100.0 {
        "these look like nanometres: is the header `wavelength_nm`?"
    } else if last_um < 0.1 {
        "these look like micrometres: is the header `wavelength_um`?"
    } else {
        return None;
    };
    Some(format!("wavelengths from {} to {} um: {help}", number(first_um), number(last_um)))
}

/// A [`label`], the wavelengths and the values.
pub(super) type Labelled<'a> = (String, &'a [f64], &'a [f64]);

/// What names a spectrum among those of many materials: the material, and what it is if not its reflectance.
pub(super) fn label(library: &SpectralLibrary, column: &Column) -> String {
    if same(&column.name, "reflectance") { library.name.clone() } else { format!("{}:{}", library.name, column.name) }
}

/// Material and column of a [`label`].
pub(super) fn parts(label: &str) -> (&str, &str) {
    match label.rsplit_once(':') {
        Some((material, column)) if is_labelled(column) => (material.trim(), column),
        _ => (label, "reflectance"),
    }
}

fn is_labelled(column: &str) -> bool {
    is_known(column) || ["albedo", "emissivity"].iter().any(|name| same(column, name))
}

/// Whether a name can stand in a list of names.
pub(super) fn is_plain(name: &str) -> bool {
    !name.is_empty() && name.trim() == name && !name.contains([',', '{', '}', '"', '#', '\n', '\r'])
}

/// Labels and values of many spectra, and the wavelengths that they share. Transmittances of opaque materials are left out.
///
/// # Errors
/// [`Error::Invalid`] if their wavelengths differ; as [`labelled`].
pub(super) fn flat<'a>(path: &Path, spectra: &'a [SpectralLibrary]) -> Result<(&'a [f64], Vec<Labelled<'a>>)> {
    let wavelength_um = spectra.first().map_or(&[][..], |s| &s.wavelength_um);
    let mut problems = Problems::default();
    for library in spectra.iter().filter(|library| library.wavelength_um != wavelength_um) {
        let at = Location::file(path).with_item(format!("spectra of {:?}", library.name));
        let help = "resample them to the same bands, or write one file for each";
        problems.push(|| Problem::new(at, "its wavelengths are not those of the first").with_help(help));
    }
    problems.finish(path)?;
    Ok((wavelength_um, labelled(path, spectra)?))
}

/// Labels, wavelengths and values of many spectra. Transmittances of opaque materials are left out.
///
/// # Errors
/// [`Error::Invalid`] if a label would be read as something else: commas, braces and so on; for no spectra.
pub(super) fn labelled<'a>(path: &Path, spectra: &'a [SpectralLibrary]) -> Result<Vec<Labelled<'a>>> {
    let at = |library: &SpectralLibrary| Location::file(path).with_item(format!("spectra of {:?}", library.name));
    let mut problems = Problems::default();
    let mut all = Vec::new();
    for library in spectra {
        library.check()?;
        if !is_plain(&library.name) {
            problems.push(|| Problem::new(at(library), "such a name cannot be written in a table of spectra"));
        }
        for column in &library.columns {
            let opaque = column.name.ends_with("_transmittance") && column.values.iter().all(|v| *v == 0.0);
            if opaque && library.column("reflectance").is_some() {
                continue;
            }
            let label = label(library, column);
            if parts(&label) != (library.name.as_str(), column.name.as_str()) {
                let message = format!("{} cannot be written in a table of spectra", column.name);
                problems.push(|| Problem::new(at(library), message));
            }
            all.push((label, library.wavelength_um.as_slice(), column.values.as_slice()));
        }
    }
    if spectra.is_empty() {
        problems.push(|| Problem::new(Location::file(path), "there are no spectra to write"));
    }
    problems.finish(path)?;
    Ok(all)
}

/// Puts labelled spectra with the same wavelengths together, material by material.
pub(super) fn gathered(spectra: Vec<(String, Vec<f64>, Vec<f64>)>) -> Vec<SpectralLibrary> {
    let mut all: Vec<SpectralLibrary> = Vec::new();
    for (label, wavelength_um, values) in spectra {
        let (name, column) = parts(&label);
        let column = Column { name: column.to_lowercase(), values };
        match all.last_mut() {
            Some(last)
                if last.name == name && last.wavelength_um == wavelength_um && last.column(&column.name).is_none() =>
            {
                last.columns.push(column);
            }
            _ => all.push(SpectralLibrary {
                name: name.to_owned(),
                comment: String::new(),
                wavelength_um,
                columns: vec![column],
            }),
        }
    }
    all
}

/// An error for a table that is empty of columns.
pub(super) fn no_header(path: &Path, help: &str) -> Error {
    Error::Invalid(vec![Problem::new(Location::file(path), "no header").with_help(help)])
}
