//! What a format says of itself. The list of all is in `registry.rs`.

use std::path::{Path, PathBuf};

use super::flight_file::FlightFile;
use super::folder::Staged;
use super::mesh_file::MeshFile;
use super::raster::{Raster, Target};
use crate::error::Result;
use crate::flight::LeapSeconds;
use crate::report::Report;
use crate::spectral::SpectralLibrary;

/// A format that is read, written, or both.
#[derive(Debug)]
pub struct Format {
    /// Its name, for `--from` and `--to`.
    pub name: &'static str,
    /// How files' names end, in small letters; nothing for folders.
    pub extensions: &'static [&'static str],
    /// What is read.
    pub reads: &'static str,
    /// What is written; nothing if it is read only.
    pub writes: &'static str,
    /// How all its files begin; empty if that identifies nothing.
    pub(super) mark: &'static [u8],
    /// What else identifies it, given a path and how the file there begins (empty for a folder): the main file or folder. If there is also
    /// a mark, both must fit.
    pub(super) told: Option<Told>,
    /// What it holds, and how that is read and written.
    pub(super) holds: Holds,
}

/// What a format holds.
#[derive(Debug)]
pub(super) enum Holds {
    /// A scene.
    Scene,
    /// A scene of Blender, which exports it.
    Blend,
    /// A simulation of DART.
    Simulation,
    /// A mesh.
    Mesh {
        /// Reads it. Files that it names may lie outside its folder if the flag says so.
        read: fn(&Path, bool) -> Result<MeshFile>,
    },
    /// Spectra.
    Spectra {
        /// Reads all.
        read: ReadSpectra,
        /// Writes all to one file.
        stage: Stage,
        /// The name of a material's own file; `None` where one file holds all of them.
        file_of: Option<fn(&str) -> String>,
    },
    /// An image, and nothing else.
    Image {
        /// What `inspect` calls it.
        kind: &'static str,
        /// Opens it.
        open: fn(&Path) -> Result<Raster>,
        /// How it is written to a path; for a format that is only read, what to do instead.
        target: std::result::Result<fn(&Path) -> Target, &'static str>,
    },
    /// Trajectories and orientations.
    Flight {
        /// Reads all, with these leap seconds.
        read: ReadFlight,
        /// The text of a file, with rows so many seconds apart, or those that are there; `None` if it is read only.
        write: Option<WriteFlight>,
    },
}

/// The main file or folder of a path whose file begins like this, if it is of the format.
pub(super) type Told = fn(&Path, &[u8]) -> Option<PathBuf>;
/// Reads all spectra of a file, and reports what could not be taken over.
pub(super) type ReadSpectra = fn(&Path) -> Result<(Vec<SpectralLibrary>, Report)>;
/// Reads trajectories and orientations.
pub(super) type ReadFlight = fn(&Path, &LeapSeconds) -> Result<FlightFile>;
/// Trajectories and orientations as text, and what is not carried over.
pub(super) type WriteFlight = fn(&FlightFile, &LeapSeconds, Option<f64>) -> Result<(String, Report)>;
/// Writes spectra to a file, which may be replaced if the flag says so, under a hidden name.
pub(super) type Stage = fn(&Path, &[SpectralLibrary], bool) -> Result<(Staged, Report)>;

impl Format {
    /// Whether it holds a mesh and nothing else.
    pub fn is_mesh(&self) -> bool {
        matches!(self.holds, Holds::Mesh { .. })
    }

    /// Whether it holds spectra and nothing else.
    pub fn is_spectral(&self) -> bool {
        matches!(self.holds, Holds::Spectra { .. })
    }

    /// Whether it holds an image and nothing else.
    pub fn is_image(&self) -> bool {
        matches!(self.holds, Holds::Image { .. })
    }

    /// Whether it holds trajectories and orientations.
    pub fn is_flight(&self) -> bool {
        matches!(self.holds, Holds::Flight { .. })
    }

    /// What `inspect` calls one of its files.
    pub fn kind(&self) -> &'static str {
        match self.holds {
            Holds::Image { kind, .. } => kind,
            _ => self.name,
        }
    }

    /// The main file or folder if the path is of this format, by how it begins and what lies in or next to it.
    pub(super) fn told(&self, path: &Path, beginning: &[u8]) -> Option<PathBuf> {
        match self.told {
            Some(told) if beginning.starts_with(self.mark) => told(path, beginning),
            None if !self.mark.is_empty() && beginning.starts_with(self.mark) => Some(path.to_owned()),
            _ => None,
        }
    }

    /// Whether a file that is called like this begins like this, or ends before that shows.
    pub(super) fn may_begin(&self, beginning: &[u8]) -> bool {
        let length = beginning.len().min(self.mark.len());
        self.mark.is_empty() || (length > 0 && beginning[..length] == self.mark[..length])
    }
}

/// There is one of each name.
impl PartialEq for Format {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Format {}

/// The ending of a name, in small letters; empty if there is none.
pub(super) fn ending(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}
