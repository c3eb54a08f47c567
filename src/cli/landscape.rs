//! `mmxrt landscape`: a recipe becomes an OBJ file and its MTL.

use std::path::PathBuf;

use mmxrt::formats::folder::{Staged, spares};
use mmxrt::formats::{mtl, obj, recipe_toml};
use mmxrt::progress::{Progress, tell};
use mmxrt::{Error, Location, Problem, Result, landscape};

use super::Outcome;
use super::console::Console;

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
    let extension = arguments.output.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    // Of a folder's name an ending may be a version.
    if extension != "obj" && !extension.is_empty() && extension.chars().all(char::is_alphabetic) {
        let problem =
            Problem::new(Location::file(&arguments.output), format!("a landscape is written as OBJ, not .{extension}"))
                .with_help("end the name in .obj, or name a folder; `mmxrt convert` makes glTF and others of it");
        return Err(Error::Invalid(vec![problem]));
    }
    let is_obj = arguments.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let path = if is_obj { arguments.output.clone() } else { arguments.output.join("landscape.obj") };
    let mtl_path = path.with_extension("mtl");
    let mtl_name = mtl_path.file_name().unwrap_or_default().to_string_lossy();
    super::settle(&path, console)?;
    let mut staged = Staged::file(&path, arguments.force)?;
    let beside = staged.beside(&mtl_path)?;
    spares(&[path.clone(), mtl_path.clone()], [arguments.recipe.as_path()])?;
    let (mut recipe, _) = recipe_toml::read(&arguments.recipe)?;
    recipe.facets = arguments.facets.unwrap_or(recipe.facets);
    recipe.seed = arguments.seed.unwrap_or(recipe.seed);
    let watch = |share: f64| console.watch(Progress::of_share("making the landscape", share));
    let landscape = landscape::generate(&recipe, &watch)?;
    let materials = mtl::of_landscapes();
    tell(&|progress| console.watch(progress), "writing the mesh", 0, 1)?;
    staged.put(&beside, |out| mtl::write(out, &materials))?;
    staged.put(staged.path(), |out| obj::write(out, &landscape.mesh, &materials, Some(&mtl_name)))?;
    tell(&|progress| console.watch(progress), "writing the mesh", 1, 1)?;
    let facets = landscape.mesh.facets.len();
    staged.commit()?;
    let path = path.display().to_string();
    let json = serde_json::json!({ "mesh": path, "materials": mtl_path.display().to_string(), "facets": facets });
    console.done(&format!("{path}: {facets} facets"), &json);
    Ok(Outcome::Done)
}
