//! Meta-kernels: text kernels that name the kernels to load.

use std::path::{Path, PathBuf};

use super::text::Assignment;
use crate::error::{Error, Location, Problem, Result};
use crate::flight::Values;
use crate::formats::input;

/// Names of the variables.
const KERNELS: &str = "KERNELS_TO_LOAD";
const SYMBOLS: &str = "PATH_SYMBOLS";
const VALUES: &str = "PATH_VALUES";

/// A text, and where it stands.
type Placed = (String, usize);

/// Paths of the kernels that a meta-kernel lists, in order, each with its place; empty if the file is not a
/// meta-kernel.
///
/// A relative path starts at the meta-kernel's folder, or else at the working directory, as in SPICE.
///
/// # Errors
/// [`Error::Invalid`] with all missing files and undefined symbols.
pub(super) fn kernels(assignments: &[Assignment<'_>], text: &str, path: &Path) -> Result<Vec<(PathBuf, Location)>> {
    let [names, symbols, values] = [KERNELS, SYMBOLS, VALUES].map(|name| texts(assignments, name));
    let at = |place: usize, item: &str| Location::span(path, text, place, place + 1).with_item(item);
    if symbols.len() != values.len() {
        let place = symbols.first().or(values.first()).map_or(0, |(_, place)| *place);
        let message = format!("{SYMBOLS} and {VALUES} must have equal lengths: {}, {}", symbols.len(), values.len());
        return Err(Error::invalid(at(place, SYMBOLS), message));
    }
    let (mut found, mut problems) = (Vec::new(), Vec::new());
    for (name, place) in names {
        let at = at(place, KERNELS);
        match written_out(&name, &symbols, &values) {
            Err(message) => problems.push(Problem::new(at, message)),
            Ok(name) => match place_of(path, &name) {
                Ok(kernel) => found.push((kernel, at)),
                Err(message) => problems.push(Problem::new(at, message)),
            },
        }
    }
    if problems.is_empty() { Ok(found) } else { Err(Error::Invalid(problems)) }
}

/// The strings of a variable after all assignments; one that ends in + continues in the next.
fn texts(assignments: &[Assignment<'_>], name: &str) -> Vec<Placed> {
    let mut all: Vec<Placed> = Vec::new();
    for assignment in assignments.iter().filter(|of| of.name == name) {
        if !assignment.appends {
            all.clear();
        }
        if let Values::Texts(texts) = &assignment.values {
            all.extend(texts.iter().cloned().zip(assignment.places.iter().copied()));
        }
    }
    let mut joined: Vec<Placed> = Vec::new();
    let mut goes_on = false;
    for (text, place) in all {
        let part = text.trim_end().strip_suffix('+');
        let (text, more) = (part.unwrap_or(text.trim_end()), part.is_some());
        match joined.last_mut().filter(|_| goes_on) {
            Some((before, _)) => before.push_str(text.trim_start()),
            None => joined.push((text.trim_start().to_owned(), place)),
        }
        goes_on = more;
    }
    joined
}

/// Replaces `$SYMBOL`s in a name; the longest matching symbol is used.
fn written_out(name: &str, symbols: &[Placed], values: &[Placed]) -> std::result::Result<String, String> {
    let (mut whole, mut rest) = (String::new(), name);
    while let Some((before, behind)) = rest.split_once('$') {
        whole.push_str(before);
        let fits = symbols.iter().zip(values).filter(|((symbol, _), _)| behind.starts_with(symbol.as_str()));
        let Some(((symbol, _), (value, _))) = fits.max_by_key(|((symbol, _), _)| symbol.len()) else {
            let known: Vec<&str> = symbols.iter().map(|(symbol, _)| symbol.as_str()).collect();
            return Err(format!("{name:?}: no {SYMBOLS} entry matches after $; they are {known:?}"));
        };
        whole.push_str(value);
        rest = &behind[symbol.len()..];
    }
    whole.push_str(rest);
    Ok(whole)
}

/// The file of a name in a meta-kernel.
fn place_of(meta: &Path, name: &str) -> std::result::Result<PathBuf, String> {
    // Kernels are often listed with Windows separators.
    let name = if cfg!(windows) { name.to_owned() } else { name.replace('\\', "/") };
    let name = Path::new(&name);
    let near = input::home(meta, name).join(name);
    match (near.is_file(), name.is_file()) {
        (true, _) => Ok(near),
        (false, true) => Ok(name.to_owned()),
        (false, false) if name.is_absolute() => Err(format!("no such file: {}", name.display())),
        (false, false) => {
            Err(format!("no such file: {}, or {} in the working directory", near.display(), name.display()))
        }
    }
}
