//! A landscape's recipe, as a file of its own or as part of a scene.

use std::path::Path;

use super::InputFile;
use super::located::Document;
use crate::error::{Error, Problem, Result};
use crate::landscape::Recipe;

/// Reads and checks a recipe.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`]; [`Error::Invalid`] with everything that is unknown, missing or out of range, each at
/// its place.
pub fn read(path: &Path) -> Result<(Recipe, InputFile)> {
    let (document, input) = Document::open(path)?;
    let recipe: Recipe = document.read()?;
    let problems = recipe.check();
    if problems.is_empty() { Ok((recipe, input)) } else { Err(placed(Error::Invalid(problems), &document, "")) }
}

/// What [`Recipe::check`] found, with its places in the text that holds the recipe: as its item, or as all of it ("").
pub(super) fn placed(error: Error, document: &Document, item: &str) -> Error {
    let Error::Invalid(problems) = error else { return error };
    let placed = problems.into_iter().map(|problem| {
        let key = problem.at.item.as_deref().and_then(|found| found.strip_prefix("recipe.")).unwrap_or("");
        let dot = if item.is_empty() || key.is_empty() { "" } else { "." };
        Problem { at: document.at(&format!("{item}{dot}{key}")), ..problem }
    });
    Error::Invalid(placed.collect())
}
