//! `mmxrt solve`: a scene becomes a facet table.

use std::path::{Path, PathBuf};

use mmxrt::formats::folder::Staged;
use mmxrt::formats::npz;
use mmxrt::progress::tell;
use mmxrt::{Error, Location, Result, solve, study};

use super::console::Console;
use super::{Outcome, scene};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// The table to write
    #[arg(long, short, value_name = "TABLE.npz")]
    output: PathBuf,
    /// Replace a table that exists
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    // So that no slip of the hand replaces a scene or a mesh.
    if arguments.output.extension().is_none_or(|e| e != "npz") {
        return Err(Error::invalid(Location::file(&arguments.output), "a facet table's name ends in .npz"));
    }
    super::settle(&arguments.output, console)?;
    super::settle_input(&arguments.scene, console)?;
    let staged = Staged::file(&arguments.output, arguments.force)?;
    let opened = scene::open(&arguments.scene, &watch)?;
    staged.spares(opened.inputs.iter().map(|input| Path::new(&input.path)))?;
    opened.say_defaults(console);
    opened.warnings.iter().for_each(|warning| console.note(&format!("warning: {warning}")));
    let table = solve::solve(&opened.scene, &watch)?;
    tell(&watch, "writing the table", 0, 1)?;
    npz::write_table(staged.path(), &table, &study::table_id(&opened.scene)).map_err(|e| staged.named(e))?;
    tell(&watch, "writing the table", 1, 1)?;
    staged.commit()?;
    let (path, facets) = (arguments.output.display().to_string(), table.facets());
    let json = serde_json::json!({ "table": path, "facets": facets, "defaults": opened.defaults, "warnings": opened.warnings });
    console.done(&format!("{path}: {facets} facets"), &json);
    Ok(Outcome::Done)
}
