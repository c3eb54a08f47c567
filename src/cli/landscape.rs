//! `mmxrt landscape`: a recipe becomes an OBJ file and its MTL.

use std::path::PathBuf;

use mmxrt::Result;
use mmxrt::formats::recipe_toml;
use mmxrt::job::LandscapeFiles;

use super::Outcome;
use super::console::Console;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The recipe file
    recipe: PathBuf,
    /// The mesh to write: a name ending in .obj, or a folder for landscape.obj
    #[arg(long, short, value_name = "OUT")]
    output: PathBuf,
    /// Number of facets, overriding the recipe
    #[arg(long, value_name = "N")]
    facets: Option<u32>,
    /// Seed, overriding the recipe
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Replace existing files
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let files = LandscapeFiles::of(&arguments.output)?;
    super::settle(&files.obj, console)?;
    let (mut recipe, _) = recipe_toml::read(&arguments.recipe)?;
    recipe.facets = arguments.facets.unwrap_or(recipe.facets);
    recipe.seed = arguments.seed.unwrap_or(recipe.seed);
    let inputs = [arguments.recipe.as_path()];
    let landscape = files.write(&recipe, inputs, arguments.force, &|progress| console.watch(progress))?;
    let (path, facets) = (files.obj.display().to_string(), landscape.mesh.facets.len());
    let json = serde_json::json!({ "mesh": path, "materials": files.mtl.display().to_string(), "facets": facets });
    console.done(&format!("{path}: {facets} facets"), &json);
    Ok(Outcome::Done)
}
