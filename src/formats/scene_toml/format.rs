//! What scene files say of themselves.

use crate::formats::dart::format::folder;
use crate::formats::format::{Format, Holds};

/// `scene.toml`, with the files it names.
pub(in crate::formats) static SCENE: Format = Format {
    name: "scene",
    extensions: &["toml"],
    reads: "everything",
    writes: "all but textures: scene file, OBJ, MTL, tables",
    mark: &[],
    // The folder of a simulation is one, whatever lies in it too.
    told: Some(|path, _| Some(path.join("scene.toml")).filter(|scene| scene.is_file() && folder(path).is_none())),
    holds: Holds::Scene,
};
