//! Spectra in any of the formats that hold them, for those who convert from one to another.

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::report::{Fate, Report};
use crate::spectral::{Band, Extend, SpectralLibrary, Spectrum};

use super::dart::database::{self, Database};
use super::dart::kind::distinct_names;
use super::dart::text_spectra;
use super::folder::Staged;
use super::input::{self, InputFile};
use super::spectrum_csv::Quantity;
use super::{sli, spectrum_csv};

/// A format that holds spectra.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A DART optical database, `.db`.
    Database,
    /// DART's text spectra, `.txt`: one material in a file.
    DartText,
    /// An ENVI spectral library, `.sli` with `.hdr`.
    Sli,
    /// A table of text: `.csv` with a header that states units, and as others write them.
    Csv,
}

/// As much of a file is looked at to tell what it is, bytes.
const BEGINNING: u64 = 1 << 12;
/// Endings of tables that are read, and written as `.csv`.
const TABLES: [&str; 5] = ["txt", "tab", "dat", "asc", "tsv"];

impl Format {
    /// The format of a file: a database or a text by how it begins, others by their names; `None` if it is none of these.
    pub fn of(path: &Path) -> Option<Self> {
        let mut start = Vec::new();
        let begun = input::open(path).and_then(|file| file.take(BEGINNING).read_to_end(&mut start));
        match begun {
            Ok(_) if start.starts_with(b"SQLite format 3\0") => Some(Format::Database),
            Ok(_) => Self::of_text(path, &start).or_else(|| Self::of_name(path)),
            Err(_) => Self::of_name(path),
        }
    }

    /// The format of a text by its name and how it begins; `None` if it is called otherwise, or is no text.
    pub(super) fn of_text(path: &Path, beginning: &[u8]) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_lowercase();
        // A cut may go through the last character.
        let is_text = |e: std::str::Utf8Error| e.error_len().is_none();
        let text = match std::str::from_utf8(beginning) {
            Ok(text) => text,
            Err(e) if is_text(e) => std::str::from_utf8(&beginning[..e.valid_up_to()]).unwrap_or_default(),
            Err(_) => return None,
        };
        let is_table = TABLES.contains(&extension.as_str()) && !text.contains('\0');
        match is_table {
            true if text_spectra::begins(path, text) => Some(Format::DartText),
            true => Some(Format::Csv),
            false => None,
        }
    }

    /// The format that the name of a file, which may not be there yet, tells.
    pub fn of_name(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_lowercase().as_str() {
            "db" => Some(Format::Database),
            "txt" => Some(Format::DartText),
            "sli" => Some(Format::Sli),
            "csv" => Some(Format::Csv),
            _ => None,
        }
    }
}

/// Reads all spectra of a file, or of the tables and texts in a folder, by their names.
///
/// The report tells what could not be taken over.
///
/// # Errors
/// Those of the format's reader; [`Error::Unsupported`] if this is none that holds spectra.
pub fn read(path: &Path) -> Result<(Vec<SpectralLibrary>, Report)> {
    if path.is_dir() {
        return read_folder(path);
    }
    match Format::of(path) {
        Some(format) => read_as(path, format),
        None => {
            // Whether it is there matters more than what it is called.
            input::open(path).map_err(|e| Error::io(path, "reading", e))?;
            let feature = "reading spectra from a file with such a name (.db, .txt, .sli or .csv)".into();
            Err(Error::Unsupported { at: Location::file(path), feature })
        }
    }
}

/// Reads all spectra of a file whose format is told.
///
/// # Errors
/// Those of the format's reader.
pub fn read_as(path: &Path, format: Format) -> Result<(Vec<SpectralLibrary>, Report)> {
    match format {
        Format::Database => Database::open(path)?.read_all(),
        Format::DartText => text_spectra::read(path).map(|(library, report)| (vec![library], report)),
        Format::Sli => sli::read(path),
        Format::Csv => spectrum_csv::read_all(path, None),
    }
}

/// Reads one spectrum of a quantity, from a table or from DART's text; fractions, or W m-2 um-1.
///
/// # Errors
/// Those of the format's reader; [`Error::Invalid`] if the file holds other quantities.
pub fn read_one(path: &Path, quantity: Quantity, extend: Extend) -> Result<(Spectrum, InputFile, Report)> {
    if Format::of(path) != Some(Format::DartText) {
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
    files.retain(|file| matches!(Format::of_name(file), Some(Format::Csv | Format::DartText)));
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
/// Tables and texts are written to a folder, a file for each material, if `path` has not their ending. The report tells
/// what has no place in the format.
///
/// # Errors
/// Those of the format's writer; [`Error::Invalid`] for several materials in one text, or if the file exists and is not to
/// be replaced.
pub fn write(path: &Path, format: Format, spectra: &[SpectralLibrary], replace: bool) -> Result<Report> {
    let (staged, report) = stage(path, format, spectra, replace)?;
    staged.commit()?;
    Ok(report)
}

/// As [`write`], but that they do not take their place yet.
pub(super) fn stage(
    path: &Path,
    format: Format,
    spectra: &[SpectralLibrary],
    replace: bool,
) -> Result<(Staged, Report)> {
    let as_file = Format::of_name(path) == Some(format);
    match (format, spectra) {
        (Format::Database, _) => database::stage(path, spectra, replace),
        (Format::Sli, _) => sli::stage(path, spectra, replace),
        (Format::Csv, [one]) if as_file => named_by_file(path, one, spectrum_csv::stage(path, spectra, replace)?),
        (Format::Csv, _) if as_file => spectrum_csv::stage(path, spectra, replace),
        (Format::DartText, [one]) if as_file => named_by_file(path, one, text_spectra::stage(path, one, replace)?),
        (Format::DartText, _) if as_file => {
            let message = format!("cannot hold {} materials: name a folder", spectra.len());
            let help = "a name without an ending, and --to dart-text; or take one of them with --model";
            Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
        }
        (Format::Csv | Format::DartText, _) => stage_folder(path, format, spectra, replace),
    }
}

fn stage_folder(path: &Path, format: Format, spectra: &[SpectralLibrary], replace: bool) -> Result<(Staged, Report)> {
    let staged = Staged::folder(path, replace)?;
    let mut report = Report::default();
    let names = distinct_names(spectra, std::iter::empty(), |name| Location::file(path.join(name)), &mut report)?;
    for (name, library) in names.iter().zip(spectra) {
        let (file, written) = match format {
            Format::DartText => {
                let file = text_spectra::file_name(name);
                let written = text_spectra::write(&staged.path().join(&file), library, false);
                (file, written)
            }
            _ => {
                let file = format!("{name}.csv");
                let written = spectrum_csv::write(&staged.path().join(&file), std::slice::from_ref(library), false);
                (file, written)
            }
        };
        let mut written = written.map_err(|e| staged.named(e))?;
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
