//! `mmxrt integrate`: a scene and the table of its facets become a product folder.

use std::path::PathBuf;

use mmxrt::formats::npz;
use mmxrt::visibility::Topology;
use mmxrt::{Result, study};

use super::console::Console;
use super::product::{self, Made, ProductOptions};
use super::{Outcome, scene};

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
    let mut opened = scene::open(&arguments.scene, &watch)?;
    let (table, header) = npz::read_table(&arguments.table)?;
    if header.scene != opened.id {
        let table = arguments.table.display();
        opened.warnings.push(format!("{table} was solved for another scene or from other files than this one"));
    }
    let topology = Topology::new(&opened.scene.mesh);
    let observation = study::observe(&opened.scene, &topology, &table, &watch)?;
    let made = Made { opened, table, observation };
    product::write("integrate", &arguments.product, staged, &made, false, console)?;
    Ok(Outcome::Done)
}
