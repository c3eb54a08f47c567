//! Where a scene comes from: a file or a text, of which items may be replaced.

use std::ffi::CString;
use std::path::{Path, PathBuf};

use mmxrt::formats::located::Document;
use mmxrt::formats::scene_toml::{self, SceneFile};
use mmxrt::formats::{Cache, Reading, Setting, Subject};
use mmxrt::job;
use mmxrt::progress::Watch;
use mmxrt::study::{Choice, Request, WITHIN};
use mmxrt::{Error, Result};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use serde_json::json;

use super::cli;
use super::errors::{self, argument};
use super::work::work;

/// What a `Scene` of Python holds.
#[derive(FromPyObject)]
pub(crate) struct Source {
    #[pyo3(attribute("_path"))]
    path: PathBuf,
    /// What it says, if it is in no file.
    #[pyo3(attribute("_text"))]
    text: Option<String>,
    /// `KEY=VALUE`, as for `--set`.
    #[pyo3(attribute("settings"))]
    settings: Vec<String>,
    /// Where prepared bodies are kept, if anywhere.
    #[pyo3(attribute("_cache"))]
    cache: Option<PathBuf>,
}

impl Source {
    /// How it is read. Warns, as Python does, of a cache that nothing can be added to.
    ///
    /// # Errors
    /// What the library says of settings and of the cache; what Python makes of the warning.
    pub(crate) fn reading(&self, py: Python<'_>) -> PyResult<Reading> {
        let reading = py.detach(|| self.as_asked()).map_err(|error| errors::raised(py, &error))?;
        if let Some(warning) = reading.cache.as_ref().and_then(Cache::warning) {
            // Of whoever called the package, not of the package.
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(warning)?, 2)?;
        }
        Ok(reading)
    }

    fn as_asked(&self) -> Result<Reading> {
        let parsed = |text: &String| text.parse::<Setting>().map_err(|message| argument(text, message));
        let (mut settings, mut problems) = (Vec::new(), Vec::new());
        for setting in &self.settings {
            match parsed(setting) {
                Ok(setting) => settings.push(setting),
                Err(error) => problems.extend(error.problems()),
            }
        }
        if !problems.is_empty() {
            return Err(Error::Invalid(problems));
        }
        let cache = self.cache.as_deref().map(Cache::open).transpose()?;
        Ok(Reading { settings, cache })
    }

    /// Reads it.
    pub(crate) fn file(&self, reading: &Reading, watch: Watch<'_>) -> Result<SceneFile> {
        match &self.text {
            Some(text) => scene_toml::read_text(text.clone(), &self.path, reading, watch),
            None => scene_toml::read_with(&self.path, reading, watch),
        }
    }

    /// Reads it, to be simulated.
    pub(crate) fn subject(&self, reading: &Reading, ideal: bool, watch: Watch<'_>) -> Result<Subject> {
        let file = self.file(reading, watch)?;
        file.simulable()?;
        let subject = Subject::from(file);
        Ok(if ideal { Subject { chain: None, ..subject } } else { subject })
    }
}

/// Which effects are wanted, and how good.
pub(crate) fn request(model: &str, tolerance: f64) -> Result<Request> {
    if tolerance.is_nan() || tolerance <= 0.0 || tolerance.is_infinite() {
        return Err(argument("tolerance", "give a number above 0, such as 1e-3"));
    }
    Ok(Request { choice: Choice::parse(model).map_err(|message| argument("model", message))?, tolerance })
}

/// What a scene file says, as JSON.
#[pyfunction]
pub(crate) fn tree(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let read = |path: &Path| Ok(Document::open(path)?.0.tree().to_string());
    read(&path).map_err(|error: Error| errors::raised(py, &error))
}

/// What `mmxrt inspect --json` says of a scene.
#[pyfunction]
pub(crate) fn inspect(py: Python<'_>, source: Source, tell: &Bound<'_, PyAny>) -> PyResult<String> {
    let reading = source.reading(py)?;
    work(py, tell, |watch| {
        let (outlook, _) = job::plan_of(source.file(&reading, watch)?, &Request::default(), watch)?;
        Ok(cli::dry_run::json_of(&outlook).to_string())
    })
}

/// What `mmxrt plan --json` says of a scene.
#[pyfunction]
pub(crate) fn plan(
    py: Python<'_>,
    source: Source,
    model: &str,
    tolerance: f64,
    tell: &Bound<'_, PyAny>,
) -> PyResult<String> {
    let reading = source.reading(py)?;
    work(py, tell, |watch| {
        let request = request(model, tolerance)?;
        let (outlook, plan) = job::plan_of(source.file(&reading, watch)?, &request, watch)?;
        let expects = json!({
            "memory_bytes": outlook.dry_run.memory_bytes, "disk_bytes": outlook.dry_run.product_bytes,
            "cpu_s": outlook.dry_run.cpu_s, "cpu_s_within_factor": WITHIN,
        });
        outlook.error.map_or(Ok(json!({ "plan": plan, "expects": expects }).to_string()), Err)
    })
}
