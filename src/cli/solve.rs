//! `mmxrt solve`: a scene becomes a facet table.

use std::path::PathBuf;

use mmxrt::formats::Subject;
use mmxrt::{Result, job};

use super::console::Console;
use super::plan::RequestArguments;
use super::{Outcome, product};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    #[command(flatten)]
    request: RequestArguments,
    /// The table to write
    #[arg(long, short, value_name = "TABLE.npz")]
    output: PathBuf,
    /// Replace an existing table
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle(&arguments.output, console)?;
    super::settle_input(&arguments.scene, console)?;
    let staged = job::stage_table(&arguments.output, arguments.force)?;
    let mut subject = Subject::open(&arguments.scene, &watch)?;
    product::say_defaults(&subject, console);
    subject.warnings.iter().for_each(|warning| console.note(&format!("warning: {warning}")));
    let table = job::solve(&mut subject, &arguments.request.request(), staged, &watch)?;
    let (path, facets) = (arguments.output.display().to_string(), table.facets());
    let defaults: Vec<String> = subject.defaults.iter().map(ToString::to_string).collect();
    let json =
        serde_json::json!({ "table": path, "facets": facets, "defaults": defaults, "warnings": subject.warnings });
    console.done(&format!("{path}: {facets} facets"), &json);
    Ok(Outcome::Done)
}
