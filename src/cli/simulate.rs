//! `mmxrt simulate`: a scene becomes a product folder.

use mmxrt::{Result, job};

use super::Outcome;
use super::console::Console;
use super::plan::{RequestArguments, about_mesh, in_short};
use super::product::ProductArguments;
use super::scene::SceneArguments;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    request: RequestArguments,
    #[command(flatten)]
    product: ProductArguments,
    /// Also write the facet table
    #[arg(long)]
    table: bool,
    /// Also write the thermal part of the cube (thermal.img); the rest of the cube is reflected light
    #[arg(long)]
    split: bool,
    /// The radiance at the aperture: neither the optics nor the detector of the scene's sensor
    #[arg(long)]
    ideal: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle_input(&arguments.scene.scene, console)?;
    let folder = arguments.product.stage(arguments.table, arguments.split, console)?;
    let mut subject = arguments.scene.open(console)?;
    if arguments.ideal {
        subject.chain = None;
    }
    let written = job::simulate(subject, &arguments.request.request(), folder, || console.run("simulate"), &watch)?;
    if let Some(plan) = &written.product.plan {
        console.note(&in_short(plan));
        plan.coarser.iter().for_each(|mesh| console.note(&about_mesh(mesh, plan)));
    }
    arguments.product.say(&written, console);
    Ok(Outcome::Done)
}
