//! Opening a scene, for all commands that need one.

use std::path::Path;

use mmxrt::formats::report_json::Input;
use mmxrt::progress::Watch;
use mmxrt::scene::Scene;
use mmxrt::{Error, Location, Result};

/// A scene with what the report says of its files.
pub(super) struct Opened {
    pub(super) scene: Scene,
    /// A hash of everything it was read from.
    pub(super) id: String,
    pub(super) inputs: Vec<Input>,
    pub(super) defaults: Vec<String>,
    pub(super) warnings: Vec<String>,
}

/// Reads a scene and all that it names.
pub(super) fn open(path: &Path, _watch: Watch<'_>) -> Result<Opened> {
    Err(Error::Unsupported { at: Location::file(path), feature: "reading scenes".into() })
}
