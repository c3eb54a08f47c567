//! What simulations of DART say of themselves.

use std::path::{Path, PathBuf};

use crate::formats::format::{Format, Holds};

/// The folder of a simulation.
pub(in crate::formats) static SIMULATION: Format = Format {
    name: "dart",
    extensions: &[],
    reads: "simulations of DART 5.4 to 5.11",
    writes: "a simulation of DART 5.7.4, or 5.11.0: a name without an ending",
    mark: &[],
    told: Some(|path, _| folder(path)),
    holds: Holds::Simulation,
};

/// The folder of a simulation, or of its inputs, of which the file `maket.xml` may be named.
pub(in crate::formats) fn folder(path: &Path) -> Option<PathBuf> {
    if path.is_dir() {
        let is_there = ["maket.xml", "input/maket.xml"].iter().any(|name| path.join(name).is_file());
        return is_there.then(|| path.to_owned());
    }
    let folder = path.parent().filter(|_| path.file_name().is_some_and(|name| name == "maket.xml"))?;
    Some(if folder.as_os_str().is_empty() { ".".into() } else { folder.to_owned() })
}
