//! The scene that a command is about: a file, of which the command line may replace items.

use std::path::PathBuf;

use mmxrt::Result;
use mmxrt::formats::{Setting, Subject};
use mmxrt::progress::Watch;

#[derive(clap::Args)]
pub(crate) struct SceneArguments {
    /// The scene file
    pub(super) scene: PathBuf,
    #[command(flatten)]
    pub(super) settings: SettingArguments,
}

#[derive(clap::Args)]
pub(crate) struct SettingArguments {
    /// Take this instead of what the scene file says, e.g. sensor.samples=64 or mesh[0].recipe=dunes; nothing behind the = takes the item away. May be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) set: Vec<Setting>,
}

impl SceneArguments {
    /// Reads it, to be simulated.
    pub(super) fn open(&self, watch: Watch<'_>) -> Result<Subject> {
        Subject::open_with(&self.scene, &self.settings.set, watch)
    }
}
