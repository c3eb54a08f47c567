//! A page for a browser that shows images, curves and tables: one file that loads nothing, and opens without a server.
//!
//! Numbers are blocks of a few bands each, compressed, as text of their own in the page: the script unpacks a block when something of it is
//! to be shown. What the page says of them is one object of JSON. Nothing that comes from a file is ever markup: the browser's own
//! functions for text put it into the page.

mod block;
mod stack;

use std::io::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::base64::base64;
use super::coverage_map::VIRIDIS;
use super::drawing::escaped;
use super::folder::Staged;
use super::input;
use super::quicklook::{BLACK_WHITE, LEAST_POWER};
use crate::error::{Error, Result};

pub use self::stack::{Cells, Layer, Stack};

/// Larger pictures are left out, bytes.
const MOST_OF_A_PICTURE: u64 = 16 << 20;
/// Larger texts are left out, bytes.
const MOST_OF_A_TEXT: u64 = 4 << 20;

const SCRIPT: [&str; 10] = [
    include_str!("script/numbers.js"),
    include_str!("script/blocks.js"),
    include_str!("script/envi.js"),
    include_str!("script/colours.js"),
    include_str!("script/image.js"),
    include_str!("script/curves.js"),
    include_str!("script/pixel.js"),
    include_str!("script/report.js"),
    include_str!("script/controls.js"),
    include_str!("script/main.js"),
];

/// What a page shows.
#[derive(Debug, Default)]
pub struct Page {
    title: String,
    kind: &'static str,
    pictures: Vec<Value>,
    stacks: Vec<Value>,
    texts: Vec<Value>,
    warnings: Vec<String>,
    report: Option<Value>,
    spectra: Vec<Value>,
    tables: Vec<Value>,
    blocks: Vec<String>,
}

impl Page {
    /// An empty page; `kind` says what of, as in "product".
    pub fn new(title: impl Into<String>, kind: &'static str) -> Self {
        Page { title: title.into(), kind, ..Page::default() }
    }

    /// Adds a PNG as it is; says so if it is too large.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn picture(&mut self, title: &str, path: &Path) -> Result<()> {
        if self.fits(path, MOST_OF_A_PICTURE)? {
            let bytes = input::bytes(path, MOST_OF_A_PICTURE)?;
            self.pictures.push(json!({ "title": title, "png": base64(&bytes) }));
        }
        Ok(())
    }

    /// Whether a file has at most so many bytes; says so if not.
    fn fits(&mut self, path: &Path, most: u64) -> Result<bool> {
        let there = std::fs::metadata(path).map_err(|e| Error::io(path, "reading", e))?.len();
        if there > most {
            self.warn(format!("{}: of {there} bytes, too large for this page, which takes {most}", path.display()));
        }
        Ok(there <= most)
    }

    /// Adds the numbers of an image.
    pub fn stack(&mut self, stack: Stack) {
        let Stack { mut about, blocks, .. } = stack;
        let first = self.blocks.len();
        self.blocks.extend(blocks);
        about["first_block"] = json!(first);
        self.stacks.push(about);
    }

    /// Adds a text of a file; says so if it is too large.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Syntax`] for one that is no text.
    pub fn text(&mut self, title: &str, path: &Path) -> Result<()> {
        if self.fits(path, MOST_OF_A_TEXT)? {
            let (text, _) = input::text(path, MOST_OF_A_TEXT)?;
            self.texts.push(json!({ "title": title, "text": text }));
        }
        Ok(())
    }

    /// Adds a table.
    pub fn table(&mut self, title: &str, head: &[&str], rows: Vec<Vec<String>>) {
        self.tables.push(json!({ "title": title, "head": head, "rows": rows }));
    }

    /// What it is of.
    pub fn kind(&self) -> &'static str {
        self.kind
    }

    /// Adds a curve over wavelengths, um, of values in the unit of its file: of a spectrum mostly 1; NaN where it has none.
    pub fn curve(&mut self, name: &str, wavelength_um: &[f64], values: &[f64]) {
        self.spectra.push(json!({ "name": name, "um": wavelength_um, "values": values }));
    }

    /// Says something that the reader should know.
    pub fn warn(&mut self, warning: impl Into<String>) {
        self.warnings.push(warning.into());
    }

    /// Shows a report, which is any JSON.
    pub fn report(&mut self, report: Value) {
        self.report = Some(report);
    }

    /// Whether anything is on it.
    pub fn is_empty(&self) -> bool {
        self.pictures.is_empty()
            && self.stacks.is_empty()
            && self.texts.is_empty()
            && self.spectra.is_empty()
            && self.tables.is_empty()
    }

    /// Writes it, and gives its size, bytes.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write(&self, staged: &Staged) -> Result<u64> {
        let Page { title, kind, pictures, stacks, texts, warnings, report, spectra, tables, blocks } = self;
        let about = json!({
            "mmxrt": env!("CARGO_PKG_VERSION"), "title": title, "kind": kind, "pictures": pictures, "stacks": stacks, "texts": texts,
            "warnings": warnings, "report": report, "spectra": spectra, "tables": tables, "viridis": VIRIDIS,
            "look": { "black_white": BLACK_WHITE, "least_power": LEAST_POWER },
        });
        // No `<` is left that could end the element.
        let about = about.to_string().replace('<', "\\u003c");
        let title = escaped(title);
        let script = SCRIPT.concat();
        let parts =
            [("title", title.as_str()), ("style", include_str!("style.css")), ("about", &about), ("script", &script)];
        staged.put(staged.path(), |out| {
            // The template is cut, not searched again: what is filled in may look like a place to fill.
            for (i, piece) in include_str!("page.html").split("{{").enumerate() {
                let (name, text) = if i == 0 { ("", piece) } else { piece.split_once("}}").unwrap_or(("", piece)) };
                if name == "blocks" {
                    for (i, block) in blocks.iter().enumerate() {
                        writeln!(out, "<script type=\"text/plain\" id=\"block{i}\">{block}</script>")?;
                    }
                }
                let filled = parts.iter().find(|(of, _)| *of == name).map_or("", |(_, filled)| filled);
                out.write_all(filled.as_bytes())?;
                out.write_all(text.as_bytes())?;
            }
            Ok(())
        })?;
        std::fs::metadata(staged.path()).map(|about| about.len()).map_err(|e| Error::io(staged.path(), "reading", e))
    }
}
