//! Folders of good files, some of which an input replaces; and errors as a terminal shows them.

#![allow(dead_code, reason = "each target uses some of it")]

use std::path::{Path, PathBuf};

use mmxrt::Error;
use mmxrt::formats::picture;

/// What parts the pieces of an input. The byte behind it says which file a piece is, of those in the order of their names.
pub const MARK: &[u8] = b"\0\xff";

/// The pieces of an input: a number and bytes.
pub fn pieces(mut data: &[u8]) -> Vec<(usize, &[u8])> {
    let mut pieces = Vec::new();
    while let Some((which, rest)) = data.split_first() {
        let end = rest.windows(MARK.len()).position(|w| w == MARK);
        pieces.push((usize::from(*which), &rest[..end.unwrap_or(rest.len())]));
        data = end.map_or(&[], |end| &rest[end + MARK.len()..]);
    }
    pieces
}

/// A folder for this process alone: give `TMPDIR` a place in memory.
pub fn scratch(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("mmxrt-fuzz-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A folder of good files.
pub struct Folder {
    pub path: PathBuf,
    good: Vec<(PathBuf, Vec<u8>)>,
}

impl Folder {
    /// A folder that holds these.
    pub fn holding(name: &str, files: &[(&str, &[u8])]) -> Self {
        let path = scratch(name);
        for (name, bytes) in files {
            let file = path.join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, bytes).unwrap();
        }
        Self::of(path)
    }

    /// A folder as it stands.
    pub fn of(path: PathBuf) -> Self {
        let mut good = Vec::new();
        gather(&path, &mut good);
        good.sort();
        Folder { path, good }
    }

    /// Lets `act` see the folder with pieces of the input in place of good files.
    pub fn with(&self, data: &[u8], act: impl FnOnce(&Path)) {
        let mut replaced = Vec::new();
        for (which, bytes) in pieces(data) {
            let (path, good) = &self.good[which % self.good.len()];
            std::fs::write(path, bytes).unwrap();
            replaced.push((path, good));
        }
        act(&self.path);
        for (path, good) in replaced {
            std::fs::write(path, good).unwrap();
        }
    }
}

fn gather(folder: &Path, files: &mut Vec<(PathBuf, Vec<u8>)>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            gather(&path, files);
        } else {
            let bytes = std::fs::read(&path).unwrap();
            files.push((path, bytes));
        }
    }
}

/// What there is, or nothing; an error is told in both ways.
pub fn told<T>(outcome: Result<T, Error>) -> Option<T> {
    outcome
        .inspect_err(|error| {
            let _ = (error.to_string(), picture(error));
        })
        .ok()
}
