//! Conversions between formats.

use std::path::PathBuf;

use mmxrt::formats::convert::{Options, convert as converted};
use mmxrt::formats::{Format, folder, registry};
use mmxrt::report::Note;
use pyo3::prelude::*;
use serde_json::json;

use super::errors::argument;
use super::work::work;

/// What may be said of a conversion.
#[derive(FromPyObject)]
pub(crate) struct Choices {
    #[pyo3(item("from"))]
    from_format: Option<String>,
    #[pyo3(item("to"))]
    to_format: Option<String>,
    #[pyo3(item)]
    dart_version: Option<String>,
    #[pyo3(item)]
    origin_m: Option<[f64; 3]>,
    #[pyo3(item)]
    unit_m: Option<f64>,
    #[pyo3(item)]
    flip: bool,
    #[pyo3(item)]
    allow_outside: bool,
    #[pyo3(item)]
    strict: bool,
    #[pyo3(item)]
    force: bool,
    #[pyo3(item)]
    models: Vec<String>,
    #[pyo3(item)]
    bands: Vec<usize>,
}

/// Converts a file, as `mmxrt convert`, and gives an account of it as JSON.
#[pyfunction]
pub(crate) fn convert(
    py: Python<'_>,
    input: PathBuf,
    output: PathBuf,
    choices: Choices,
    tell: &Bound<'_, PyAny>,
) -> PyResult<String> {
    work(py, tell, |watch| {
        let format = |what: &str, name: &Option<String>| -> mmxrt::Result<Option<&'static Format>> {
            let Some(name) = name else { return Ok(None) };
            let names = || registry::ALL.iter().map(|format| format.name).collect::<Vec<_>>().join(", ");
            registry::named(name).map(Some).ok_or_else(|| argument(what, format!("formats are {}", names())))
        };
        let from_1 = |band: &usize| band.checked_sub(1).ok_or_else(|| argument("bands", "bands are counted from 1"));
        let options = Options {
            from: format("from_format", &choices.from_format)?,
            to: format("to_format", &choices.to_format)?,
            dart_version: choices.dart_version.clone(),
            origin_m: choices.origin_m.map(Into::into),
            unit_m: choices.unit_m,
            flip: choices.flip,
            allow_outside: choices.allow_outside,
            strict: choices.strict,
            replace: choices.force,
            models: choices.models.clone(),
            image_bands: choices.bands.iter().map(from_1).collect::<mmxrt::Result<_>>()?,
            scratch: Some(std::env::temp_dir()),
            ..Options::default()
        };
        folder::settle(&output, true)?;
        folder::settle(&input, false)?;
        let done = converted(&input, &output, &options, watch)?;
        let note = |note: &Note| {
            json!({
                "fate": note.fate.to_string(), "file": note.at.file.as_ref().map(|file| file.display().to_string()),
                "line": note.at.line, "column": note.at.column, "item": note.at.item, "message": note.message,
            })
        };
        let notes: Vec<_> = done.report.notes.iter().map(note).collect();
        Ok(json!({
            "output": output.display().to_string(), "written": done.written, "from": done.from.name, "to": done.to.name,
            "size": done.size, "notes": notes,
        })
        .to_string())
    })
}
