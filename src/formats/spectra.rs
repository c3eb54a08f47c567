//! Spectra in any of the formats that hold them, for converting between them.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Result};
use crate::report::{Fate, Report};
use crate::spectral::{Band, Extend, SpectralLibrary, Spectrum};

use super::dart::kind::distinct_names;
use super::dart::text_spectra;
use super::folder::Staged;
use super::format::{Format, Holds, Stage};
use super::input::{self, InputFile};
use super::spectrum_csv::Quantity;
use super::{registry, spectrum_csv};

/// Reads all spectra of a file, or of the tables and texts in a folder, by their names.
///
/// The report lists what could not be taken over.
///
/// # Errors
/// Those of the format's reader; [`Error::Unsupported`] if the format holds no spectra.
pub fn read(path: &Path) -> Result<(Vec<SpectralLibrary>, Report)> {
    if path.is_dir() {
        return read_folder(path);
    }
    match registry::of_spectra(path) {
        Some(Format { holds: Holds::Spectra { read, .. }, .. }) => read(path),
        _ => {
            // Whether it is there matters more than what it is called.
            input::open(path).map_err(|e| Error::io(path, "reading", e))?;
            let feature = "reading spectra from a file with such a name (.db, .txt, .sli or .csv)".into();
            Err(Error::Unsupported { at: Location::file(path), feature })
        }
    }
}

/// Reads one spectrum of a quantity, from a table or from DART's text; fractions, or W m-2 um-1.
///
/// # Errors
/// Those of the format's reader; [`Error::Invalid`] if the file holds other quantities.
pub fn read_one(path: &Path, quantity: Quantity, extend: Extend) -> Result<(Spectrum, InputFile, Report)> {
    if registry::of_spectra(path) != Some(&text_spectra::TEXT) {
        return spectrum_csv::read(path, quantity, extend);
    }
    let (library, mut report) = text_spectra::read(path)?;
    let name = if quantity == Quantity::Albedo { Quantity::Reflectance.name() } else { quantity.name() };
    let Some(spectrum) = library.spectrum(name, extend) else {
        let names: Vec<&str> = library.columns.iter().map(|c| c.name.as_str()).collect();
        let message = format!("a text of DART with {}, but no {name}", names.join(", "));
        return Err(Error::invalid(Location::file(path), message));
    };
    if quantity != Quantity::Irradiance {
        report.note(Fate::Defaulted, Location::file(path), "a text of DART: its reflectances are percent");
    }
    Ok((spectrum, InputFile::of(path, &input::bytes(path, 1 << 30)?), report))
}

fn read_folder(path: &Path) -> Result<(Vec<SpectralLibrary>, Report)> {
    let reading = |e| Error::io(path, "reading", e);
    let entries = path.read_dir().map_err(reading)?;
    let mut files: Vec<PathBuf> = entries.map(|e| Ok(e?.path())).collect::<std::io::Result<_>>().map_err(reading)?;
    files.retain(|file| {
        registry::called(file, |f| matches!(f.holds, Holds::Spectra { file_of: Some(_), .. })).is_some()
    });
    files.sort();
    if files.is_empty() {
        return Err(Error::invalid(Location::file(path), "holds no spectra, .csv or .txt"));
    }
    let mut all = (Vec::new(), Report::default());
    for file in &files {
        let (spectra, report) = read(file)?;
        all.0.extend(spectra);
        all.1.notes.extend(report.notes);
    }
    Ok(all)
}

/// Writes spectra to a file, which appears whole or not at all.
///
/// Tables and texts are written to a folder, a file for each material, if `path` has not their ending. The report lists
/// what has no place in the format.
///
/// # Errors
/// Those of the format's writer; [`Error::Invalid`] for several materials in one text, or if the file exists and is not to
/// be replaced.
pub fn write(path: &Path, format: &Format, spectra: &[SpectralLibrary], replace: bool) -> Result<Report> {
    let (staged, report) = stage(path, format, spectra, replace)?;
    staged.commit()?;
    Ok(report)
}

/// As [`write`], but that they do not take their place yet.
pub(super) fn stage(
    path: &Path,
    format: &Format,
    spectra: &[SpectralLibrary],
    replace: bool,
) -> Result<(Staged, Report)> {
    let Holds::Spectra { stage, file_of, .. } = format.holds else {
        return Err(Error::invalid(Location::file(path), format!("spectra are not written as {}", format.name)));
    };
    match (file_of, spectra) {
        (Some(file_of), _) if registry::called(path, Format::is_spectral) != Some(format) => {
            stage_folder(path, stage, file_of, spectra, replace)
        }
        (Some(_), [one]) => named_by_file(path, one, stage(path, spectra, replace)?),
        _ => stage(path, spectra, replace),
    }
}

fn stage_folder(
    path: &Path,
    stage: Stage,
    file_of: fn(&str) -> String,
    spectra: &[SpectralLibrary],
    replace: bool,
) -> Result<(Staged, Report)> {
    let staged = Staged::folder(path, replace)?;
    let mut report = Report::default();
    let names = distinct_names(spectra, std::iter::empty(), |name| Location::file(path.join(name)), &mut report)?;
    for (name, library) in names.iter().zip(spectra) {
        let file = file_of(name);
        let write = || -> Result<Report> {
            let (file, written) = stage(&staged.path().join(&file), std::slice::from_ref(library), false)?;
            file.commit()?;
            Ok(written)
        };
        let mut written = write().map_err(|e| staged.named(e))?;
        written.notes.iter_mut().for_each(|note| note.at.file = Some(path.join(&file)));
        report.notes.extend(written.notes);
    }
    Ok((staged, report))
}

/// Tells if a material will have another name when it is read: that of its file.
fn named_by_file(
    path: &Path,
    library: &SpectralLibrary,
    (staged, mut report): (Staged, Report),
) -> Result<(Staged, Report)> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    if stem.strip_prefix(text_spectra::PREFIX).unwrap_or(&stem) != library.name {
        let message = format!("is named by its file: the name {:?} is not kept", library.name);
        report.note(Fate::Approximated, Location::file(path), message);
    }
    Ok((staged, report))
}

/// All spectra as bands see them; see [`SpectralLibrary::resample`].
///
/// # Errors
/// [`Error::Invalid`] for bands that reach beyond the wavelengths of any of them.
pub fn resample(spectra: &[SpectralLibrary], bands: &[Band]) -> Result<Vec<SpectralLibrary>> {
    spectra.iter().map(|s| s.resample(bands)).collect()
}
