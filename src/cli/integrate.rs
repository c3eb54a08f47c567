//! `mmxrt integrate`: a scene and the table of its facets become a product folder.

use std::path::PathBuf;

use mmxrt::formats::npz;
use mmxrt::{Result, study};

use super::console::Console;
use super::product::{self, ProductOptions};
use super::{Outcome, seams};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// What its facets receive, from `mmxrt solve` or another solver
    #[arg(long, value_name = "TABLE.npz")]
    table: PathBuf,
    #[command(flatten)]
    product: ProductOptions,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    let staged = arguments.product.stage()?;
    let mut opened = seams::open_scene(&arguments.scene, &watch)?;
    let (table, header) = npz::read_table(&arguments.table)?;
    if header.scene != opened.id {
        let table = arguments.table.display();
        opened.warnings.push(format!("{table} was solved for another scene or from other files than this one"));
    }
    let observation = study::simulate(&opened.scene, Some(&table), &watch)?;
    product::write("integrate", &arguments.product, staged, &opened, &observation, None, console)?;
    Ok(Outcome::Done)
}
