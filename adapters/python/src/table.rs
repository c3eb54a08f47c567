//! Facet tables: as files, or as arrays.

use std::path::PathBuf;

use mmxrt::formats::{folder, npz};
use mmxrt::job::{self, TableFiles};
use mmxrt::product::{FacetTable, Lighting, Sees};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::errors::{self, argument};
use super::source::{Source, request};
use super::work::work;

/// Solves a scene into a file, as `mmxrt solve`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub(crate) fn solve(
    py: Python<'_>,
    source: Source,
    out: PathBuf,
    radiance: Option<String>,
    force: bool,
    model: &str,
    tolerance: f64,
    tell: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let reading = source.reading(py)?;
    work(py, tell, |watch| {
        let request = request(model, tolerance)?;
        let towards = radiance.map(|text| text.parse().map_err(|message: String| argument("radiance", message)));
        folder::settle(&out, true)?;
        let files = TableFiles::stage(&out, towards.transpose()?, force)?;
        job::solve(&mut source.subject(&reading, false, watch)?, &request, files, watch)?;
        Ok(())
    })
}

/// Solves a scene in memory: a dictionary of arrays, with a number for each facet.
#[pyfunction]
pub(crate) fn hold_table<'py>(
    py: Python<'py>,
    source: Source,
    model: &str,
    tolerance: f64,
    tell: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let reading = source.reading(py)?;
    let table = work(py, tell, |watch| {
        let mut subject = source.subject(&reading, false, watch)?;
        job::decide(&mut subject, &request(model, tolerance)?, watch)?;
        mmxrt::solve::solve(&subject.scene, watch)
    })?;
    columns(py, table)
}

/// A table in a file: its columns as in memory.
#[pyfunction]
pub(crate) fn read_table(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let read = py.detach(|| npz::read_table(&path));
    columns(py, read.map_err(|error| errors::raised(py, &error))?.0)
}

/// The columns of a table that have a number for each facet, by the names that they have in files, and of each source the share of a facet that it sees.
pub(crate) fn columns(py: Python<'_>, table: FacetTable) -> PyResult<Bound<'_, PyDict>> {
    let columns = PyDict::new(py);
    let facets = table.facets();
    for Lighting { source, irradiance, sees, .. } in table.sources {
        columns.set_item(format!("{source}_irradiance"), irradiance.into_pyarray(py))?;
        let shares = match sees {
            Sees::All => vec![1.0; facets],
            Sees::Shares(shares) => shares,
            Sees::Polygons(seen) => (0_u32..).take(facets).map(|facet| seen.fraction(facet)).collect(),
        };
        columns.set_item(format!("{source}_share"), shares.into_pyarray(py))?;
    }
    let temperatures =
        [("temperature_lit_k", table.temperature_lit_k), ("temperature_shaded_k", table.temperature_shaded_k)];
    for (name, values) in temperatures {
        if !values.is_empty() {
            columns.set_item(name, values.into_pyarray(py))?;
        }
    }
    for (i, reflected) in table.reflected.into_iter().enumerate() {
        columns.set_item(format!("reflected_{i}"), reflected.irradiance.into_pyarray(py))?;
    }
    Ok(columns)
}
