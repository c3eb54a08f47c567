//! ENVI spectral libraries: a file of numbers (`.sli`), one spectrum after the other, and a text header beside it.
//!
//! A spectrum's name stands for its reflectance; with `:column` behind it, for another quantity of the same material.
//! Numbers times `data gain values`, plus `data offset values`, are fractions times the header's `reflectance scale factor`.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::report::{Fate, Report};
use crate::spectral::SpectralLibrary;

use super::dart::kind::{outside, range};
use super::envi::{self, DataType, Header, HeaderText, Interleave};
use super::folder::Staged;
use super::format::{Format, Holds};
use super::input;
use super::spectral_table::DELETED_BELOW;
use super::table::{flat, gathered, parts};

/// An ENVI spectral library, which is often named by its header.
pub(super) static SLI: Format = Format {
    name: "sli",
    extensions: &["sli", "hdr"],
    reads: "ENVI spectral libraries, with .hdr",
    writes: "the same",
    mark: &[],
    told: None,
    holds: Holds::Spectra { read, stage, file_of: None },
};

/// Longer files of numbers are refused, bytes.
const LIMIT: u64 = 512 << 20;
/// More spectra are refused: each takes far more memory than a number or two of a file.
const MOST_SPECTRA: usize = 1 << 20;
/// Reads a library; either of its two files may be named.
///
/// Numbers that are not there (NaN, the header's `data ignore value`, channels that `bbl` calls bad) leave a gap in
/// their spectrum. Spectra with values outside their range are left out. The report lists both.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] and [`Error::Invalid`] at the lines of the header that cannot be used, for a file
/// shorter than the header says, or no spectrum that can be used; [`Error::Unsupported`] for complex numbers and wavenumbers.
pub fn read(path: &Path) -> Result<(Vec<SpectralLibrary>, Report)> {
    let (header, data) = envi::pair(path)?;
    parse(&envi::read_header(&header)?, &input::bytes(&data, LIMIT)?, &data)
}

/// Reads the numbers of a library; `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(header: &Header, bytes: &[u8], path: &Path) -> Result<(Vec<SpectralLibrary>, Report)> {
    let at = |key: &str| Location::file(&header.path).with_item(key);
    let mut report = header.report.clone();
    let (count, spectra) = (header.samples, header.lines);
    if header.bands != 1 {
        let message = format!("{} bands: a spectral library has 1, and a spectrum in each line", header.bands);
        return Err(Error::invalid(at("bands"), message));
    }
    let start = usize::try_from(header.header_offset).ok();
    let wanted = header.data_bytes().and_then(|n| usize::try_from(n).ok());
    let numbers = start.zip(wanted).and_then(|(start, n)| bytes.get(start..start.checked_add(n)?));
    let Some(numbers) = numbers else {
        let message = format!(
            "{} bytes, but its header asks for {spectra} spectra of {count} numbers of {} bytes after {}",
            bytes.len(),
            header.data_type.bytes(),
            header.header_offset
        );
        return Err(Error::invalid(Location::file(path), message));
    };
    if spectra > MOST_SPECTRA {
        return Err(Error::invalid(at("lines"), format!("{spectra} spectra: at most {MOST_SPECTRA} are read")));
    }
    let stored_um = wavelengths(header, &mut report)?;
    if !stored_um.iter().all(|um| um.is_finite() && *um > 0.0) {
        return Err(Error::invalid(at("wavelength"), "wavelengths must be positive numbers"));
    }
    let order = ascending(&stored_um, at("wavelength"), &mut report);
    let wavelength_um: Vec<f64> = order.iter().map(|i| stored_um[*i]).collect();
    let names = names(header, &mut report)?;
    let mut problems = Vec::new();
    let scales = header.scales(count, &mut problems);
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    let good = header.good(header.samples)?;

    let bytes_each = header.data_type.bytes();
    let mut stored = vec![0.0; count];
    let mut kept = Vec::new();
    let mut deleted = 0;
    for (line, (name, spectrum)) in names.iter().zip(numbers.chunks_exact(count * bytes_each)).enumerate() {
        header.data_type.decode(header.big_endian, spectrum, &mut stored);
        let values: Vec<Option<f64>> = order
            .iter()
            .map(|i| {
                let number = stored[*i];
                let there = good[*i] && number.is_finite() && number > DELETED_BELOW && header.ignore != Some(number);
                there.then(|| scales.get(*i).map_or(number, |scale| scale.value(number)))
            })
            .collect();
        deleted += values.iter().filter(|v| v.is_none()).count();
        let (um, values): (Vec<f64>, Vec<f64>) =
            wavelength_um.iter().zip(&values).filter_map(|(um, v)| Some((*um, (*v)?))).unzip();
        let place = Location::file(path).with_item(format!("spectrum {} {name:?}", line + 1));
        let limits = range(parts(name).1);
        match values.iter().find(|v| !(limits.0..=limits.1).contains(*v)) {
            _ if values.is_empty() => report.note(Fate::Dropped, place, "has no values"),
            Some(bad) => {
                let message = format!(
                    "left out: {bad} {}; if all are in another unit, say `reflectance scale factor` in the header",
                    outside(limits, 1.0)
                );
                report.note(Fate::Dropped, place, message);
            }
            None => kept.push((name.clone(), um, values)),
        }
    }
    if deleted > 0 {
        let message =
            format!("{deleted} numbers are not there: their spectra have gaps, which are linear from end to end");
        report.note(Fate::Dropped, Location::file(path), message);
    }
    if kept.is_empty() {
        let reasons = report.notes.iter().filter(|n| n.fate == Fate::Dropped).take(5);
        let mut problems: Vec<Problem> = reasons.map(|n| Problem::new(n.at.clone(), n.message.clone())).collect();
        problems.push(Problem::new(Location::file(path), "no spectrum can be used"));
        return Err(Error::Invalid(problems));
    }
    Ok((gathered(kept), report))
}

/// Wavelengths in the order of the file, um.
fn wavelengths(header: &Header, report: &mut Report) -> Result<Vec<f64>> {
    let at = |key: &str| Location::file(&header.path).with_item(key);
    if header.wavelength.len() != header.samples {
        let message = format!("{} wavelengths for spectra of {} numbers", header.wavelength.len(), header.samples);
        return Err(Error::invalid(at("wavelength"), message));
    }
    match header.um(&header.wavelength) {
        Some((um, None)) => Ok(um),
        Some((um, Some(taken))) => {
            report.note(Fate::Defaulted, at("wavelength units"), format!("not given: taken as {taken}"));
            Ok(um)
        }
        None => {
            let unit = header.field("wavelength units").unwrap_or_default().to_lowercase();
            Err(Error::Unsupported { at: at("wavelength units"), feature: format!("a spectral library in {unit}") })
        }
    }
}

fn names(header: &Header, report: &mut Report) -> Result<Vec<String>> {
    let at = Location::file(&header.path).with_item("spectra names");
    let Some(list) = header.field("spectra names") else {
        // A header may promise more spectra than memory holds names of; the numbers were counted before.
        report.note(Fate::Defaulted, at, "not given: spectra are called by their numbers");
        return Ok((1..=header.lines).map(|i| format!("spectrum_{i}")).collect());
    };
    let names: Vec<String> = list.split(',').map(|name| name.trim().to_owned()).collect();
    if names.len() != header.lines {
        // Names may contain commas, so there is no telling which pieces belong together.
        let message = format!("{} names for {} spectra: they are called by their numbers", names.len(), header.lines);
        report.note(Fate::Defaulted, at, message);
        return Ok((1..=header.lines).map(|i| format!("spectrum_{i}")).collect());
    }
    let mut known = BTreeSet::new();
    let mut doubled = 0;
    let names = names.into_iter().enumerate().map(|(i, name)| match known.insert(name.to_lowercase()) {
        true => name,
        false => {
            doubled += 1;
            format!("{name}_{}", i + 1)
        }
    });
    let names = names.collect();
    if doubled > 0 {
        report.note(Fate::Approximated, at, format!("{doubled} names appear twice: their spectrum's number is added"));
    }
    Ok(names)
}

/// The order in which wavelengths ascend, each once. Where detectors overlap they step back: told.
fn ascending(um: &[f64], at: Location, report: &mut Report) -> Vec<usize> {
    let mut order: Vec<usize> = (0..um.len()).collect();
    order.sort_by(|a, b| um[*a].total_cmp(&um[*b]));
    order.dedup_by(|b, a| um[*a] == um[*b]);
    let steps_back = um.windows(2).filter(|w| w[1] <= w[0]).count();
    let descends = steps_back > 0 && steps_back + 1 == um.len() && order.len() == um.len();
    if steps_back > 0 && !descends {
        let twice = um.len() - order.len();
        let mut message = format!("wavelengths step back {steps_back} times: they are sorted");
        if twice > 0 {
            message.push_str(&format!("; of {twice} that appear twice the first is kept"));
        }
        report.note(Fate::Approximated, at, message);
    }
    order
}

/// Writes a library in double precision: the numbers to `path`, the header beside it (`.hdr`).
///
/// The report lists comments, which the format cannot hold.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] if a file exists and is not to be replaced, for spectra whose wavelengths differ, for
/// names that a header cannot hold.
pub fn write(path: &Path, spectra: &[SpectralLibrary], replace: bool) -> Result<Report> {
    let (staged, report) = stage(path, spectra, replace)?;
    staged.commit()?;
    Ok(report)
}

/// As [`write`], but that it does not take its place yet.
pub(super) fn stage(path: &Path, spectra: &[SpectralLibrary], replace: bool) -> Result<(Staged, Report)> {
    let (wavelength_um, spectra_flat) = flat(path, spectra)?;
    let mut report = Report::default();
    for library in spectra.iter().filter(|library| !library.comment.is_empty()) {
        let at = Location::file(path).with_item(format!("spectra of {:?}", library.name));
        report.note(Fate::Dropped, at, "a spectral library has no place for comments");
    }
    let size = [wavelength_um.len(), spectra_flat.len(), 1];
    let description = Some("spectral library of mmxrt");
    let mut text = HeaderText::new(description, size, envi::SPECTRAL_LIBRARY, DataType::F64, Interleave::Bsq);
    text.field("wavelength units", "Micrometers");
    text.field("reflectance scale factor", 1);
    text.list("spectra names", spectra_flat.iter().map(|s| s.0.clone()));
    text.list("wavelength", wavelength_um.iter().map(f64::to_string));
    let bytes: Vec<u8> = spectra_flat.iter().flat_map(|s| s.2).flat_map(|v| v.to_le_bytes()).collect();
    let mut staged = Staged::file(path, replace)?;
    let header = staged.beside(&envi::header_of(path)?)?;
    for (path, bytes) in [(header.as_path(), text.as_bytes()), (staged.path(), bytes.as_slice())] {
        staged.put(path, |out| out.write_all(bytes))?;
    }
    Ok((staged, report))
}
