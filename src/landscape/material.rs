//! The materials of a landscape: which there are, and which each facet has.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::recipe::Recipe;
use super::{BOULDERS, GROUND};
use crate::geometry::{MaterialId, whole};

/// A material of a landscape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LandscapeMaterial {
    /// Its name.
    pub name: String,
    /// Linear red, green and blue, 0 to 1.
    pub colour: [f64; 3],
    /// Shares of other materials, by their names, if it is a mixture.
    pub mixture: Option<BTreeMap<String, f64>>,
}

/// Colours of materials that have none of their own, in turn.
const COLOURS: [[f64; 3]; 6] = [
    [0.60, 0.58, 0.55],
    [0.55, 0.30, 0.22],
    [0.30, 0.42, 0.50],
    [0.50, 0.46, 0.28],
    [0.34, 0.44, 0.32],
    [0.46, 0.34, 0.46],
];

/// All materials, in the order in which a recipe uses them: the ground's, the boulders', and what is painted.
pub(super) fn materials(recipe: &Recipe) -> Vec<LandscapeMaterial> {
    let used = std::iter::once(&recipe.ground)
        .chain(recipe.boulders.iter().map(|b| &b.material))
        .chain(recipe.paint.iter().map(|p| &p.material));
    let mut materials: Vec<LandscapeMaterial> = Vec::new();
    for name in used {
        if materials.iter().any(|m| m.name == *name) {
            continue;
        }
        let given = recipe.materials.get(name);
        let own = match name.as_str() {
            GROUND => [0.28, 0.30, 0.34],
            BOULDERS => [0.40, 0.28, 0.20],
            _ => COLOURS[materials.len() % COLOURS.len()],
        };
        let colour = given.and_then(|m| m.colour).unwrap_or(own);
        materials.push(LandscapeMaterial {
            name: name.clone(),
            colour,
            mixture: given.and_then(|m| m.mixture.clone()),
        });
    }
    materials
}

/// The index of a material by its name.
pub(super) fn index(materials: &[LandscapeMaterial], name: &str) -> MaterialId {
    let index = materials.iter().position(|m| m.name == name).unwrap_or(0);
    #[expect(clippy::cast_possible_truncation, reason = "a recipe has fewer than 200 materials")]
    MaterialId(whole(index as f64) as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_come_in_the_order_of_their_use_each_once() {
        let recipe: Recipe = toml::from_str(
            r#"
            version = 2
            seed = 1
            ground = "dust"
            boulders = [{ material = "rock" }, { material = "dust" }, {}]
            paint = [{ material = "mixed" }, { material = "rock" }]
            [materials]
            mixed = { mixture = { dust = 0.25, rock = 0.75 } }
            rock = { colour = [0.1, 0.2, 0.3] }
            unused = {}
            "#,
        )
        .unwrap();
        let materials = materials(&recipe);
        let names: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["dust", "rock", "phobos_red", "mixed"]);
        assert_eq!((materials[1].colour, materials[2].colour), ([0.1, 0.2, 0.3], [0.40, 0.28, 0.20]));
        assert_eq!(materials[3].mixture.as_ref().unwrap()["rock"], 0.75);
        assert_eq!(index(&materials, "mixed"), MaterialId(3));
    }
}
