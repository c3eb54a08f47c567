//! A recipe becomes a mesh with its materials, and lists of what it was made with.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::folder::{Staged, spares};
use crate::formats::recipe_toml::OpenedRecipe;
use crate::formats::{grain_png, landscape_csv, mtl, obj};
use crate::landscape::Landscape;
use crate::progress::{Watch, tell};

/// The files of a landscape.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LandscapeFiles {
    /// The mesh.
    pub obj: PathBuf,
    /// Its materials.
    pub mtl: PathBuf,
    /// The craters that the recipe asks for, if any.
    pub craters: PathBuf,
    /// The boulders that the recipe asks for, if any.
    pub boulders: PathBuf,
    /// The texture, if the recipe asks for one.
    pub texture: PathBuf,
}

impl LandscapeFiles {
    /// Of a name that ends in `.obj`, or a folder, for `landscape.obj`.
    ///
    /// # Errors
    /// [`Error::Invalid`] for the name of another kind of file.
    pub fn of(output: &Path) -> Result<Self> {
        let extension = output.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        // Of a folder's name an ending may be a version.
        if extension != "obj" && !extension.is_empty() && extension.chars().all(char::is_alphabetic) {
            let message = format!("a landscape is written as OBJ, not .{extension}");
            let help = "end the name in .obj, or name a folder; `mmxrt convert` makes glTF and others of it";
            return Err(Error::Invalid(vec![Problem::new(Location::file(output), message).with_help(help)]));
        }
        let obj = if extension == "obj" { output.to_owned() } else { output.join("landscape.obj") };
        let stem = obj.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let beside = |ending: &str| obj.with_file_name(format!("{stem}_{ending}"));
        Ok(LandscapeFiles {
            mtl: obj.with_extension("mtl"),
            craters: beside("craters.csv"),
            boulders: beside("boulders.csv"),
            texture: beside("texture.png"),
            obj,
        })
    }

    /// Makes the landscape of a recipe and writes what there is of it.
    ///
    /// # Errors
    /// Those of [`Staged::file`] and of [`OpenedRecipe::generate`]; [`Error::Invalid`] if a file of the recipe would be replaced.
    pub fn write(&self, opened: &OpenedRecipe, replace: bool, watch: Watch<'_>) -> Result<Landscape> {
        let mut staged = Staged::file(&self.obj, replace)?;
        let recipe = &opened.recipe;
        let mut beside = |path: &PathBuf, there: bool| there.then(|| staged.beside(path)).transpose();
        let mtl_path = beside(&self.mtl, true)?;
        let craters = beside(&self.craters, !recipe.craters.is_empty())?;
        let boulders = beside(&self.boulders, !recipe.boulders.is_empty())?;
        let texture = beside(&self.texture, recipe.texture.is_some())?;
        let targets = [&self.obj, &self.mtl, &self.craters, &self.boulders, &self.texture].map(PathBuf::clone);
        let inputs = opened.paths();
        spares(&targets, inputs.iter().map(PathBuf::as_path))?;
        let mut landscape = opened.generate(watch)?;
        let materials = mtl::of_landscape(&landscape.materials);
        let mtl_name = self.mtl.file_name().unwrap_or_default().to_string_lossy();
        tell(watch, "writing the mesh", 0, 1)?;
        if let Some(path) = &mtl_path {
            staged.put(path, |out| mtl::write(out, &materials))?;
        }
        if let Some(path) = &craters {
            staged.put(path, |out| landscape_csv::write_craters(out, &landscape.craters))?;
        }
        if let Some(path) = &boulders {
            staged.put(path, |out| landscape_csv::write_boulders(out, &landscape.boulders))?;
        }
        if let (Some(path), Some(grain)) = (&texture, &landscape.grain) {
            staged.put(path, |out| grain_png::write(out, grain))?;
        }
        // A file has one origin: of a site on a body the body's centre.
        landscape.start_at_centre();
        staged.put(staged.path(), |out| obj::write(out, &landscape.mesh, &materials, Some(&mtl_name)))?;
        tell(watch, "writing the mesh", 1, 1)?;
        staged.commit()?;
        Ok(landscape)
    }
}
