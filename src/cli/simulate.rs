//! `mmxrt simulate`: a scene becomes a product folder.

use std::path::PathBuf;

use mmxrt::{Result, study};

use super::console::Console;
use super::product::{self, Made, ProductOptions};
use super::{Outcome, scene};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    #[command(flatten)]
    product: ProductOptions,
    /// Write the facet table as well
    #[arg(long)]
    table: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    let staged = arguments.product.stage()?;
    let opened = scene::open(&arguments.scene, &watch)?;
    let (table, observation) = study::simulate(&opened.scene, &watch)?;
    let made = Made { opened, table, observation, maps: None };
    product::write("simulate", &arguments.product, staged, &made, arguments.table, console)
}
