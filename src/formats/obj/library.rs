//! Material files: under which names they may be meant, and where they are.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Result};
use crate::formats::input::{self, InputFile};
use crate::formats::mtl::{self, ObjMaterial};
use crate::report::{Fate, Note};

/// The material files of an OBJ file, as they are read.
pub(super) struct Libraries<'a> {
    /// The OBJ file.
    pub(super) path: &'a Path,
    /// Whether they may lie outside its folder.
    pub(super) outside: bool,
    pub(super) inputs: Vec<InputFile>,
    /// A material's name, a place, and what has no place here.
    pub(super) losses: Vec<(String, Location, &'static str)>,
    pub(super) doubts: Vec<Note>,
    /// Whether one was not found just where it was looked for first.
    pub(super) may_change: bool,
}

impl Libraries<'_> {
    /// The materials of the file of this name.
    ///
    /// # Errors
    /// As [`mtl::read`]; [`Error::Io`] if it is not there.
    pub(super) fn load(&mut self, name: &str) -> Result<Vec<ObjMaterial>> {
        let found = self.find(name);
        self.may_change |= !matches!(found, Ok((_, true)));
        let (found, is_first) = found?;
        let (file, input) = mtl::read(&found)?;
        self.inputs.push(input);
        let mut doubt = |at, message: String| self.doubts.push(Note { fate: Fate::Defaulted, at, message });
        if !is_first {
            doubt(Location::file(self.path), format!("`mtllib {name}`: taken is {}", found.display()));
        }
        if let Some(line) = file.not_utf8 {
            doubt(Location::line(&found, line), "a name that is not UTF-8: taken for Windows-1252".into());
        }
        let at = |(name, line, what)| (name, Location::line(&found, line), what);
        self.losses.extend(file.losses.into_iter().map(at));
        Ok(file.materials)
    }

    /// Where the file of a name is: there, or with the other slashes, or beside the OBJ file under the last part of it; in any case. And whether it is just
    /// what was named, so that no other file that comes to be would take its place.
    fn find(&self, name: &str) -> Result<(PathBuf, bool)> {
        let slashes = name.replace('\\', "/");
        let last = slashes.rsplit('/').next().unwrap_or(&slashes).to_owned();
        let mut why = None;
        for (i, name) in [name, slashes.trim_start_matches("./"), &last].into_iter().enumerate() {
            match input::beside(self.path, name, self.outside) {
                Ok(path) if path.is_file() => return Ok((path, i == 0)),
                Ok(path) => {
                    if let Some(path) = in_any_case(&path) {
                        return Ok((path, false));
                    }
                }
                Err(message) => _ = why.get_or_insert(message),
            }
        }
        let error = why.map_or_else(|| io::ErrorKind::NotFound.into(), io::Error::other);
        Err(Error::io(name, "reading", error))
    }
}

/// A file of the same name but for capitals; of several the first by name.
fn in_any_case(path: &Path) -> Option<PathBuf> {
    let wanted = path.file_name()?.to_string_lossy().to_lowercase();
    let entries = fs::read_dir(path.parent()?).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let same = |path: &PathBuf| path.file_name().is_some_and(|n| n.to_string_lossy().to_lowercase() == wanted);
    entries.filter(|path| same(path) && path.is_file()).min()
}

/// The names that a `mtllib` may mean: the whole of it, and if there is no such file, its parts.
pub(super) fn names(text: &str) -> (String, Vec<String>) {
    let text = text.trim();
    let whole = text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).filter(|t| !t.contains('"')).unwrap_or(text);
    let mut parts: Vec<String> = Vec::new();
    for (i, piece) in text.split('"').enumerate() {
        if i % 2 == 1 {
            parts.push(piece.to_owned());
            continue;
        }
        // Blanks part names, and also occur in them: a name goes on until it ends in .mtl, if one does.
        let words: Vec<&str> = piece.split_whitespace().collect();
        let ends = |word: &&str| word.to_lowercase().ends_with(".mtl");
        let last = words.iter().rposition(ends).map_or(0, |last| last + 1);
        let (named, rest) = words.split_at(last);
        parts.extend(named.split_inclusive(ends).map(|words| words.join(" ")));
        parts.extend(rest.iter().map(|word| (*word).to_owned()));
    }
    parts.retain(|part| !part.is_empty());
    (whole.to_owned(), parts)
}

#[cfg(test)]
mod tests {
    use super::names;

    #[test]
    fn several_names_stand_on_a_line() {
        let parts = |text: &str| names(text).1;
        assert_eq!(parts("a.mtl b.MTL"), ["a.mtl", "b.MTL"]);
        assert_eq!(parts("my file.mtl other one.mtl"), ["my file.mtl", "other one.mtl"]);
        assert_eq!(parts("\"my file.mtl\" b.mtl c"), ["my file.mtl", "b.mtl", "c"]);
        assert_eq!(names("\"my file.mtl\"").0, "my file.mtl");
        assert_eq!(parts("a b"), ["a", "b"]);
        assert_eq!(names(""), (String::new(), vec![]));
    }
}
