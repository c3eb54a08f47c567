//! The library's errors as exceptions of Python.

use std::any::Any;

use mmxrt::{Error, Location, Problem};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The exception for an error, with all its problems.
pub(crate) fn raised(py: Python<'_>, error: &Error) -> PyErr {
    let class = match error {
        Error::Io { .. } => "IoError",
        Error::Syntax { .. } => "TextError",
        Error::Invalid(_) => "InvalidError",
        Error::Unsupported { .. } => "UnsupportedError",
        Error::Interrupted => "StoppedError",
    };
    let mut problems = error.problems();
    // What Python sets is no option of a command line.
    let mut is_set = false;
    for item in problems.iter_mut().filter_map(|problem| problem.at.item.as_mut()) {
        if let Some((key, _)) = item.strip_prefix("--set ").and_then(|setting| setting.split_once('=')) {
            (*item, is_set) = (key.to_owned(), true);
        }
    }
    let message = if is_set { Error::Invalid(problems.clone()).to_string() } else { error.to_string() };
    exception(py, class, &message, &problems)
}

/// The exception for a panic, which is a fault of ours.
pub(crate) fn panicked(py: Python<'_>, panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    let message = format!("a fault of mmxrt, please report it: {}", text.unwrap_or("it stopped for no stated reason"));
    exception(py, "InternalError", &message, &[])
}

/// An argument that cannot be used.
pub(crate) fn argument(name: &str, message: impl Into<String>) -> Error {
    Error::invalid(Location::item(name), message)
}

fn exception(py: Python<'_>, class: &str, message: &str, problems: &[Problem]) -> PyErr {
    let made = || {
        let module = py.import("mmxrt._errors")?;
        let problem = |problem: &Problem| {
            let told = PyDict::new(py);
            told.set_item("message", &problem.message)?;
            told.set_item("file", problem.at.file.as_ref().map(|file| file.display().to_string()))?;
            told.set_item("line", problem.at.line)?;
            told.set_item("column", problem.at.column)?;
            told.set_item("item", &problem.at.item)?;
            told.set_item("help", &problem.help)?;
            module.getattr("Problem")?.call((), Some(&told))
        };
        let problems = problems.iter().map(problem).collect::<PyResult<Vec<_>>>()?;
        module.getattr(class)?.call1((message, problems))
    };
    made().map_or_else(|failed| failed, PyErr::from_value)
}
