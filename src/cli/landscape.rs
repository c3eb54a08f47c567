//! `mmxrt landscape`: a recipe becomes an OBJ file and its MTL.

use std::path::PathBuf;

use mmxrt::Result;
use mmxrt::formats::folder::Staged;

use super::console::Console;
use super::{Outcome, seams};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The recipe file
    recipe: PathBuf,
    /// The mesh to write: a name that ends in .obj, or a folder for landscape.obj
    #[arg(long, short, value_name = "OUT")]
    output: PathBuf,
    /// Facets, instead of the recipe's
    #[arg(long, value_name = "N")]
    facets: Option<u32>,
    /// Seed, instead of the recipe's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Replace files that exist
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    let is_obj = arguments.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let obj = if is_obj { arguments.output.clone() } else { arguments.output.join("landscape.obj") };
    let mtl = obj.with_extension("mtl");
    let mtl_name = mtl.file_name().unwrap_or_default().to_string_lossy();
    let (staged_obj, staged_mtl) = (Staged::file(&obj, arguments.force)?, Staged::file(&mtl, arguments.force)?);
    let facets = seams::make_landscape(
        &arguments.recipe,
        arguments.facets,
        arguments.seed,
        staged_obj.path(),
        staged_mtl.path(),
        &mtl_name,
        &watch,
    )?;
    // The mesh last: it refers to the materials.
    staged_mtl.commit()?;
    staged_obj.commit()?;
    let path = obj.display().to_string();
    let json = serde_json::json!({ "mesh": path, "materials": mtl.display().to_string(), "facets": facets });
    console.result(&format!("{path}: {facets} facets"), &json)?;
    Ok(Outcome::Done)
}
