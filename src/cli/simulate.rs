//! `mmxrt simulate`: a scene becomes a product folder.

use std::path::PathBuf;

use mmxrt::formats::Subject;
use mmxrt::{Result, job};

use super::Outcome;
use super::console::Console;
use super::product::ProductArguments;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    #[command(flatten)]
    product: ProductArguments,
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
    let folder = arguments.product.stage(arguments.table, arguments.split, console)?;
    let subject = Subject::open(&arguments.scene, &watch)?;
    let written = job::simulate(subject, folder, || console.run("simulate"), &watch)?;
    arguments.product.say(&written, console);
    Ok(Outcome::Done)
}
