//! A scene becomes a facet table.

use std::path::Path;

use crate::error::{Error, Location, Result};
use crate::formats::folder::Staged;
use crate::formats::{Subject, npz};
use crate::product::FacetTable;
use crate::progress::{Watch, tell};
use crate::solve as solver;
use crate::study::{self, Request};

/// Begins a table's file, before anything is computed: it may not be possible.
///
/// # Errors
/// [`Error::Invalid`] for a name that does not end in `.npz`; those of [`Staged::file`].
pub fn stage_table(target: &Path, replace: bool) -> Result<Staged> {
    // So that no slip of the hand replaces a scene or a mesh.
    if target.extension().is_none_or(|e| e != "npz") {
        return Err(Error::invalid(Location::file(target), "a facet table's name ends in .npz"));
    }
    Staged::file(target, replace)
}

/// Solves a scene, by the models that are requested, and writes the table.
///
/// # Errors
/// [`Error::Invalid`] if an input would be replaced; those of [`solve`](solver::solve); [`Error::Io`].
pub fn solve(subject: &mut Subject, request: &Request, staged: Staged, watch: Watch<'_>) -> Result<FacetTable> {
    staged.spares(subject.inputs.iter().map(|input| input.path.as_path()))?;
    super::plan::decide(&mut subject.scene, request, watch)?;
    let table = solver::solve(&subject.scene, watch)?;
    tell(watch, "writing the table", 0, 1)?;
    npz::write_table(staged.path(), &table, &study::table_id(&subject.scene)).map_err(|e| staged.named(e))?;
    tell(watch, "writing the table", 1, 1)?;
    staged.commit()?;
    Ok(table)
}
