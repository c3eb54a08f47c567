//! The native half of the Python package: the library for `python/mmxrt`, which is what people import, and the command line for its entry point.
//!
//! Work runs in a thread of its own without Python's lock (`work`); errors and panics become exceptions (`errors`); arrays are handed over without
//! copies, flat, and get their shape in Python.

// All of the command line is built in; other files of it are used here as well.
#[path = "../../../src/cli/mod.rs"]
mod cli;

mod convert;
mod errors;
mod locate;
mod product;
mod source;
mod table;
mod work;

use std::ffi::OsString;

use pyo3::prelude::*;

/// The command: runs it and gives its exit code.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| cli::run(arguments))
}

#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("version", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(command, module)?)?;
    module.add_function(wrap_pyfunction!(source::tree, module)?)?;
    module.add_function(wrap_pyfunction!(source::inspect, module)?)?;
    module.add_function(wrap_pyfunction!(source::plan, module)?)?;
    module.add_function(wrap_pyfunction!(product::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(product::hold, module)?)?;
    module.add_function(wrap_pyfunction!(product::integrate, module)?)?;
    module.add_function(wrap_pyfunction!(table::solve, module)?)?;
    module.add_function(wrap_pyfunction!(table::hold_table, module)?)?;
    module.add_function(wrap_pyfunction!(table::read_table, module)?)?;
    module.add_function(wrap_pyfunction!(locate::ground, module)?)?;
    module.add_function(wrap_pyfunction!(locate::place, module)?)?;
    module.add_function(wrap_pyfunction!(convert::convert, module)?)
}
