//! The text of a header, as it is written.

use std::fmt::{Display, Write as _};
use std::path::Path;

use super::{Interleave, code};
use crate::error::{Error, Result};
use crate::formats::number::DataType;

/// A header that is being written, key by key.
pub(in crate::formats) struct HeaderText(String);

/// What a header says of a band; the name may be empty.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::formats) struct HeaderBand<'a> {
    pub(in crate::formats) name: &'a str,
    pub(in crate::formats) centre_um: Option<f64>,
    /// Full width at half maximum.
    pub(in crate::formats) fwhm_um: Option<f64>,
    pub(in crate::formats) is_bad: bool,
}

/// The file type of an image.
const STANDARD: &str = "ENVI Standard";

impl HeaderText {
    /// Of an image, little-endian, without anything before the numbers; `size` is samples, lines and bands.
    pub(in crate::formats) fn of_image(
        description: Option<&str>,
        size: [usize; 3],
        data_type: DataType,
        interleave: Interleave,
    ) -> Self {
        Self::new(description, size, STANDARD, data_type, interleave)
    }

    /// Of any file type.
    pub(in crate::formats) fn new(
        description: Option<&str>,
        [samples, lines, bands]: [usize; 3],
        file_type: &str,
        data_type: DataType,
        interleave: Interleave,
    ) -> Self {
        let mut text = HeaderText("ENVI\n".to_owned());
        if let Some(description) = description {
            text.field("description", format_args!("{{{}}}", description.replace(['{', '}', '\n'], " ")));
        }
        text.field("samples", samples);
        text.field("lines", lines);
        text.field("bands", bands);
        text.field("header offset", 0);
        text.field("file type", file_type);
        text.field("data type", code(data_type));
        text.field("interleave", interleave.name());
        text.field("byte order", 0);
        text
    }

    /// A key and its value.
    pub(in crate::formats) fn field(&mut self, key: &str, value: impl Display) {
        let _ = writeln!(self.0, "{key} = {value}");
    }

    /// A key and a list.
    pub(in crate::formats) fn list(&mut self, key: &str, values: impl Iterator<Item = String>) {
        let values: Vec<String> = values.collect();
        let rows: Vec<String> = values.chunks(8).map(|row| row.join(", ")).collect();
        self.field(key, format_args!("{{\n {}}}", rows.join(",\n ")));
    }

    /// What is known of bands. Those without a centre among others that have one are no part of the spectrum, and so bad.
    pub(in crate::formats) fn bands<'a>(&mut self, bands: impl Iterator<Item = HeaderBand<'a>> + Clone) {
        let is_spectral = bands.clone().any(|band| band.centre_um.is_some());
        if is_spectral {
            self.field("wavelength units", "Micrometers");
            self.list("wavelength", bands.clone().map(|band| band.centre_um.unwrap_or(0.0).to_string()));
            if bands.clone().any(|band| band.fwhm_um.is_some()) {
                self.list("fwhm", bands.clone().map(|band| band.fwhm_um.unwrap_or(0.0).to_string()));
            }
        }
        let is_bad = |band: &HeaderBand| band.is_bad || (is_spectral && band.centre_um.is_none());
        if bands.clone().any(|band| is_bad(&band)) {
            self.list("bbl", bands.clone().map(|band| u8::from(!is_bad(&band)).to_string()));
        }
        if bands.clone().any(|band| !band.name.is_empty()) {
            let name = |(i, name): (usize, &str)| match plain(name) {
                name if name.is_empty() => format!("band {}", i + 1),
                name => name,
            };
            self.list("band names", bands.map(|band| band.name).enumerate().map(name));
        }
    }

    /// Writes it.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub(in crate::formats) fn write(&self, path: &Path) -> Result<()> {
        std::fs::write(path, &self.0).map_err(|e| Error::io(path, "writing", e))
    }

    /// Its bytes.
    pub(in crate::formats) fn as_bytes(&self) -> &[u8] {
        self.0.as_bytes()
    }
}

/// A name that the header's lists can hold.
pub(in crate::formats) fn plain(name: &str) -> String {
    name.replace(['{', '}', ',', '\n'], " ")
}
