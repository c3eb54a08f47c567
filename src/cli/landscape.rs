//! `mmxrt landscape`: a recipe becomes an OBJ file and its MTL.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use mmxrt::formats::folder::Staged;
use mmxrt::formats::{mtl, obj, recipe_toml};
use mmxrt::progress::{Progress, tell};
use mmxrt::{Error, Result, landscape};

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
    let is_obj = arguments.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let path = if is_obj { arguments.output.clone() } else { arguments.output.join("landscape.obj") };
    let mtl_path = path.with_extension("mtl");
    let mtl_name = mtl_path.file_name().unwrap_or_default().to_string_lossy();
    let (staged_obj, staged_mtl) = (Staged::file(&path, arguments.force)?, Staged::file(&mtl_path, arguments.force)?);
    let (mut recipe, _) = recipe_toml::read(&arguments.recipe)?;
    recipe.facets = arguments.facets.unwrap_or(recipe.facets);
    recipe.seed = arguments.seed.unwrap_or(recipe.seed);
    let watch = |share: f64| console.watch(Progress::of_share("making the landscape", share));
    let landscape = landscape::generate(&recipe, &watch)?;
    let materials = mtl::of_landscapes();
    tell(&|progress| console.watch(progress), "writing the mesh", 0, 1)?;
    write_file(&staged_mtl, |out| mtl::write(out, &materials))?;
    write_file(&staged_obj, |out| obj::write(out, &landscape.mesh, &materials, Some(&mtl_name)))?;
    tell(&|progress| console.watch(progress), "writing the mesh", 1, 1)?;
    let facets = landscape.mesh.facets.len();
    // The mesh last: it refers to the materials.
    staged_mtl.commit()?;
    staged_obj.commit()?;
    let path = path.display().to_string();
    let json = serde_json::json!({ "mesh": path, "materials": mtl_path.display().to_string(), "facets": facets });
    console.result(&format!("{path}: {facets} facets"), &json)?;
    Ok(Outcome::Done)
}

fn write_file(staged: &Staged, write: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>) -> Result<()> {
    let io = |e| staged.named(Error::io(staged.path(), "writing", e));
    let mut out = BufWriter::with_capacity(1 << 20, File::create(staged.path()).map_err(io)?);
    write(&mut out).and_then(|()| out.flush()).map_err(io)
}
