//! A landscape's recipe as a file of its own.

use std::path::Path;

use super::located::Document;
use super::{InputFile, input};
use crate::error::{Error, Result};
use crate::landscape::Recipe;

/// No recipe is this long, bytes.
const LIMIT: u64 = 1 << 20;

/// Reads a recipe.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`]; [`Error::Invalid`] with everything that is unknown, missing or out of range, each at
/// its place.
pub fn read(path: &Path) -> Result<(Recipe, InputFile)> {
    let (text, file) = input::text(path, LIMIT)?;
    let document = Document::parse(text, path)?;
    let recipe: Recipe = document.read()?;
    let mut problems = recipe.check();
    for problem in &mut problems {
        // A scene holds its recipe under this name; here it is the whole file.
        if let Some(item) = problem.at.item.take() {
            problem.at = document.at(item.strip_prefix("recipe.").unwrap_or(&item));
        }
    }
    if problems.is_empty() { Ok((recipe, file)) } else { Err(Error::Invalid(problems)) }
}
