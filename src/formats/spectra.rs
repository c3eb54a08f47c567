//! Spectra in any of the formats that hold them, for those who convert from one to another.

use std::path::Path;

use crate::error::{Error, Location, Result};
use crate::report::Report;
use crate::spectral::{Band, SpectralLibrary};

use super::dart::database::{self, Database};

/// A format that holds spectra.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A DART optical database, `.db`.
    Database,
    /// DART's text spectra, `.txt`.
    DartText,
    /// An ENVI spectral library, `.sli` with `.hdr`.
    Sli,
    /// Comma-separated values with a header that states units, `.csv`.
    Csv,
}

impl Format {
    /// The format that a file's name tells; `None` if it tells none of these.
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

/// Reads all spectra of a file, whose name tells its format.
///
/// # Errors
/// Those of its format's reader; [`Error::Unsupported`] if the name tells no format.
pub fn read(path: &Path) -> Result<(Vec<SpectralLibrary>, Report)> {
    match Format::of_name(path) {
        Some(Format::Database) => Database::open(path)?.read_all(),
        _ => Err(unknown(path)),
    }
}

/// Writes spectra to one file. It appears whole or not at all.
///
/// # Errors
/// Those of the format's writer.
pub fn write(path: &Path, format: Format, spectra: &[SpectralLibrary], replace: bool) -> Result<Report> {
    match format {
        Format::Database => database::create(path, spectra, replace),
        _ => Err(unknown(path)),
    }
}

/// All spectra as bands see them; see [`SpectralLibrary::resample`].
///
/// # Errors
/// [`Error::Invalid`] for bands that reach beyond the wavelengths of any of them.
pub fn resample(spectra: &[SpectralLibrary], bands: &[Band]) -> Result<Vec<SpectralLibrary>> {
    spectra.iter().map(|s| s.resample(bands)).collect()
}

fn unknown(path: &Path) -> Error {
    let feature = "reading or writing spectra in a file with such a name".into();
    Error::Unsupported { at: Location::file(path), feature }
}
