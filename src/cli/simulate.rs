//! `mmxrt simulate`: a scene becomes a product folder.

use std::path::PathBuf;

use mmxrt::Result;
use mmxrt::study;

use super::console::Console;
use super::product::{self, ProductOptions};
use super::{Outcome, seams};

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
    let opened = seams::open_scene(&arguments.scene, &watch)?;
    let observation = study::simulate(&opened.scene, None, &watch)?;
    let table = observation.table.as_ref().filter(|_| arguments.table);
    product::write("simulate", &arguments.product, staged, &opened, &observation, table, console)?;
    Ok(Outcome::Done)
}
