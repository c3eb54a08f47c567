//! A recipe becomes a mesh with its materials.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::folder::{Staged, spares};
use crate::formats::{mtl, obj};
use crate::landscape::{self, Landscape, Recipe};
use crate::progress::{Watch, tell};

/// The two files of a landscape.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LandscapeFiles {
    /// The mesh.
    pub obj: PathBuf,
    /// Its materials.
    pub mtl: PathBuf,
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
        Ok(LandscapeFiles { mtl: obj.with_extension("mtl"), obj })
    }

    /// Makes the landscape of a recipe and writes both files; `inputs` are the files that the recipe is from.
    ///
    /// # Errors
    /// Those of [`Staged::file`] and of [`generate`](landscape::generate); [`Error::Invalid`] if one of `inputs` would be replaced.
    pub fn write<'a>(
        &self,
        recipe: &Recipe,
        inputs: impl IntoIterator<Item = &'a Path>,
        replace: bool,
        watch: Watch<'_>,
    ) -> Result<Landscape> {
        let mut staged = Staged::file(&self.obj, replace)?;
        let beside = staged.beside(&self.mtl)?;
        spares(&[self.obj.clone(), self.mtl.clone()], inputs)?;
        let landscape = landscape::generate(recipe, watch)?;
        let materials = mtl::of_landscapes();
        let mtl_name = self.mtl.file_name().unwrap_or_default().to_string_lossy();
        tell(watch, "writing the mesh", 0, 1)?;
        staged.put(&beside, |out| mtl::write(out, &materials))?;
        staged.put(staged.path(), |out| obj::write(out, &landscape.mesh, &materials, Some(&mtl_name)))?;
        tell(watch, "writing the mesh", 1, 1)?;
        staged.commit()?;
        Ok(landscape)
    }
}
