//! The scene that a command is about: a file, of which the command line may replace items.

use std::path::PathBuf;

use mmxrt::Result;
use mmxrt::formats::{Cache, Reading, Setting, Subject};

use super::console::Console;

#[derive(clap::Args)]
pub(crate) struct SceneArguments {
    /// The scene file
    pub(super) scene: PathBuf,
    #[command(flatten)]
    pub(super) reading: ReadingArguments,
}

#[derive(clap::Args)]
pub(crate) struct ReadingArguments {
    /// Take this instead of what the scene file says, e.g. sensor.samples=64 or mesh[0].recipe=dunes; nothing behind the = takes the item away. May be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(super) set: Vec<Setting>,
    /// Keep prepared bodies in this folder (landscapes that were made, meshes that were read, how their facets hang together, trees of rays), and take them from there the next time
    #[arg(long, value_name = "FOLDER")]
    cache: Option<PathBuf>,
}

impl ReadingArguments {
    /// How the scene is read.
    pub(super) fn reading(&self, console: &Console) -> Result<Reading> {
        let cache = self.cache.as_deref().map(Cache::open).transpose()?;
        if let Some(warning) = cache.as_ref().and_then(Cache::warning) {
            console.note(&format!("warning: {warning}"));
        }
        Ok(Reading { settings: self.set.clone(), cache })
    }
}

impl SceneArguments {
    /// Reads it, to be simulated.
    pub(super) fn open(&self, console: &Console) -> Result<Subject> {
        Subject::open_with(&self.scene, &self.reading.reading(console)?, &|progress| console.watch(progress))
    }
}
