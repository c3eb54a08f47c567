//! Opening a scene, for all commands that need one.

use std::path::Path;

use mmxrt::Result;
use mmxrt::formats::report_json::Input;
use mmxrt::formats::scene_toml::{self, SceneFile};
use mmxrt::progress::Watch;
use mmxrt::scene::{Scene, Thermal};

use super::console::Console;

/// A scene with what the report says of its files.
pub(super) struct Opened {
    pub(super) scene: Scene,
    /// A hash of everything it was read from.
    pub(super) id: String,
    pub(super) inputs: Vec<Input>,
    pub(super) defaults: Vec<String>,
    pub(super) warnings: Vec<String>,
}

impl Opened {
    /// Says which values of the heat balance the scene left open: temperatures depend on them.
    pub(super) fn say_defaults(&self, console: &Console) {
        let of_heat = |d: &&String| d.contains(".bond_albedo = ") || d.contains(".emissivity_bolometric = ");
        if self.scene.thermal == Thermal::Equilibrium {
            self.defaults.iter().filter(of_heat).for_each(|d| console.note(&format!("default: {d}")));
        }
    }
}

/// Reads a scene and all that it names, to simulate it.
pub(super) fn open(path: &Path, watch: Watch<'_>) -> Result<Opened> {
    let file = scene_toml::read(path, watch)?;
    file.simulable()?;
    Ok(opened(file))
}

/// Reads a scene and all that it names, to say what it holds.
pub(super) fn open_to_inspect(path: &Path, watch: Watch<'_>) -> Result<Opened> {
    Ok(opened(scene_toml::read(path, watch)?))
}

fn opened(file: SceneFile) -> Opened {
    Opened {
        id: scene_toml::id(&file.inputs),
        scene: file.scene,
        inputs: file.inputs.iter().map(Input::from).collect(),
        defaults: file.defaults.iter().map(|d| format!("{} = {}", d.item, d.value)).collect(),
        warnings: file.notes,
    }
}
