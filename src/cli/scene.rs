//! Opening a scene, for all commands that need one.

use std::path::Path;

use mmxrt::Result;
use mmxrt::formats::report_json::Input;
use mmxrt::formats::scene_toml;
use mmxrt::progress::Watch;
use mmxrt::scene::{Scene, Thermal};

use super::console::Console;

/// Of more defaults only so many are named in a line.
const TOLD: usize = 4;

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
    /// Says which values of the heat balance the scene left open: temperatures depend on them. In a line, or each with its value.
    pub(super) fn say_defaults(&self, console: &Console) {
        let of_heat = |d: &&String| d.contains(".bond_albedo = ") || d.contains(".emissivity_bolometric = ");
        let open: Vec<&String> = self.defaults.iter().filter(of_heat).collect();
        if self.scene.models.thermal != Thermal::Equilibrium || open.is_empty() {
            return;
        }
        if console.is_verbose() {
            open.iter().for_each(|d| console.note(&format!("default: {d}")));
            return;
        }
        let items: Vec<&str> = open.iter().filter_map(|d| Some(d.split_once(" = ")?.0)).collect();
        let told = match items.len() {
            0..=TOLD => items.join(", "),
            n => format!("{} and {} more", items[..TOLD].join(", "), n - TOLD),
        };
        console.note(&format!("defaults of the heat balance: {told} (values: --verbose, or the report)"));
    }
}

/// Reads a scene and all that it names, to simulate it.
pub(super) fn open(path: &Path, watch: Watch<'_>) -> Result<Opened> {
    let (opened, simulable) = open_to_inspect(path, watch)?;
    simulable.map(|()| opened)
}

/// Reads a scene and all that it names, to say what it holds, and whether it can be simulated.
pub(super) fn open_to_inspect(path: &Path, watch: Watch<'_>) -> Result<(Opened, Result<()>)> {
    let file = scene_toml::read(path, watch)?;
    let simulable = file.simulable();
    let opened = Opened {
        id: scene_toml::id(&file.inputs),
        scene: file.scene,
        inputs: file.inputs.iter().map(Input::from).collect(),
        defaults: file.defaults.iter().map(|d| format!("{} = {}", d.item, d.value)).collect(),
        warnings: file.notes,
    };
    Ok((opened, simulable))
}
