//! Calls of what is being written elsewhere: each is one line once that is there.

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

fn missing<T>(at: &Path, feature: &str) -> Result<T> {
    Err(Error::Unsupported { at: Location::file(at), feature: feature.to_owned() })
}

/// `formats::scene_toml::read`.
pub(super) fn open_scene(path: &Path, _watch: Watch<'_>) -> Result<Opened> {
    missing(path, "reading scenes")
}

/// `formats::picture`.
pub(super) fn picture(error: &Error) -> String {
    format!("error: {error}")
}

/// `landscape::generate` and `formats::obj::write`; gives the number of facets.
pub(super) fn make_landscape(
    recipe: &Path,
    _facets: Option<u32>,
    _seed: Option<u64>,
    _obj: &Path,
    _mtl: &Path,
    _mtl_name: &str,
    _watch: Watch<'_>,
) -> Result<u64> {
    missing(recipe, "making landscapes")
}

/// One line of the table that `validate` prints.
pub(super) struct Case {
    pub(super) name: String,
    pub(super) expected: f64,
    pub(super) found: f64,
    pub(super) tolerance: f64,
    pub(super) source: String,
    /// `None`: skipped.
    pub(super) passed: Option<bool>,
}

/// `study::validate`.
pub(super) fn validate(oracles: Option<&Path>) -> Result<Vec<Case>> {
    missing(oracles.unwrap_or(Path::new("validate")), "validation")
}

/// What `formats::obj::read` counts: (vertices, facets, materials).
pub(super) fn count_obj(path: &Path) -> Result<(u64, u64, u64)> {
    missing(path, "inspecting OBJ")
}
