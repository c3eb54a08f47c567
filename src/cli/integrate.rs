//! `mmxrt integrate`: a scene and the table of its facets become a product folder.

use std::path::PathBuf;

use mmxrt::formats::npz;
use mmxrt::visibility::Topology;
use mmxrt::{Error, Location, Problem, Result, study};

use super::console::Console;
use super::product::{self, Made, ProductOptions};
use super::{Outcome, scene};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// What its facets receive, from `mmxrt solve`; one table serves all cameras and bands
    #[arg(long, value_name = "TABLE.npz")]
    table: PathBuf,
    #[command(flatten)]
    product: ProductOptions,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    let staged = arguments.product.stage()?;
    let opened = scene::open(&arguments.scene, &watch)?;
    let (table, header) = npz::read_table(&arguments.table)?;
    if header.scene != study::table_id(&opened.scene) {
        let problem = Problem::new(
            Location::file(&arguments.table),
            "was solved for another scene: another mesh, origin, Sun, Mars or heat (camera, bands and spectra may differ)",
        );
        let help = format!("solve it again: mmxrt solve {} -o TABLE.npz", arguments.scene.display());
        return Err(Error::Invalid(vec![problem.with_help(help)]));
    }
    let topology = Topology::new(&opened.scene.mesh);
    let observation = study::observe(&opened.scene, &topology, &table, &watch)?;
    let made = Made { opened, table, observation };
    product::write("integrate", &arguments.product, staged, &made, false, console)
}
