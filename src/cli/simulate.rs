//! `mmxrt simulate`: a scene becomes a product folder.

use std::path::PathBuf;

use mmxrt::{Result, solve, study};

use super::console::Console;
use super::product::{self, Extras, Made, ProductOptions};
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
    /// Write the thermal part of the cube as well (thermal.img): the rest of the cube is reflected
    #[arg(long)]
    split: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle_input(&arguments.scene, console)?;
    let staged = arguments.product.stage(console)?;
    let opened = scene::open(&arguments.scene, &watch)?;
    let extras = Extras { with_table: arguments.table, with_split: arguments.split };
    arguments.product.admit(&staged, &opened, &[], false, extras)?;
    let table = solve::solve(&opened.scene, &watch)?;
    let observation = study::observe(&opened.scene, &table, arguments.product.wanted(), &watch)?;
    let made = Made { opened, table, table_from: None, observation, maps: None };
    product::write("simulate", &arguments.product, staged, &made, extras, console)
}
