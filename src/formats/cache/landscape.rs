//! Landscapes, by their recipes and the files that these name.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::entry::Packed;
use super::{Cache, Kept, Key, mesh};
use crate::error::Result;
use crate::formats::recipe_toml::OpenedRecipe;
use crate::landscape::{Grain, Landscape, LandscapeMaterial, MadeBoulder, MadeCrater, WrapReport};
use crate::progress::Watch;

/// All of a landscape but its long lists of numbers.
#[derive(Serialize, Deserialize)]
struct Text {
    origin_m: Option<DVec3>,
    wrap: Option<WrapReport>,
    materials: Vec<LandscapeMaterial>,
    craters: Vec<MadeCrater>,
    boulders: Vec<MadeBoulder>,
    texels: Option<usize>,
    folded: usize,
    size_m: f64,
    relief_m: f64,
}

impl Kept for Landscape {
    const KIND: &'static str = "landscape";

    fn packed(&self) -> Option<Packed> {
        let mut packed = Packed::new(&Text {
            origin_m: self.origin_m,
            wrap: self.wrap,
            materials: self.materials.clone(),
            craters: self.craters.clone(),
            boulders: self.boulders.clone(),
            texels: self.grain.as_ref().map(|grain| grain.texels),
            folded: self.folded,
            size_m: self.size_m,
            relief_m: self.relief_m,
        })?;
        mesh::put(&mut packed, &self.mesh);
        packed.put(self.beyond.iter().map(|vertex| vertex.to_le_bytes()));
        packed.put(self.grain.iter().flat_map(|grain| &grain.factors).map(|factor| factor.to_le_bytes()));
        Some(packed)
    }
}

fn unpacked(mut packed: Packed) -> Option<Landscape> {
    let Text { origin_m, wrap, materials, craters, boulders, texels, folded, size_m, relief_m } = packed.text()?;
    let mesh = mesh::take(&mut packed)?;
    let beyond = packed.take(u32::from_le_bytes)?;
    let factors = packed.take(f64::from_le_bytes)?;
    let is_whole = mesh.material.iter().all(|material| usize::from(material.0) < materials.len())
        && beyond.iter().all(|vertex| (*vertex as usize) < mesh.vertices_m.len())
        && texels.map_or(Some(0), |texels| texels.checked_mul(texels)) == Some(factors.len());
    let grain = texels.map(|texels| Grain { texels, factors });
    is_whole.then_some(Landscape {
        mesh,
        origin_m,
        wrap,
        beyond,
        materials,
        craters,
        boulders,
        grain,
        folded,
        size_m,
        relief_m,
    })
}

impl Cache {
    /// The landscape of a recipe.
    ///
    /// # Errors
    /// Those of [`OpenedRecipe::generate`].
    pub(in crate::formats) fn landscape(&self, opened: &OpenedRecipe, watch: Watch<'_>) -> Result<Landscape> {
        let Ok(recipe) = serde_json::to_vec(&opened.recipe) else { return opened.generate(watch) };
        // The recipe names its files, and the same name may be another file elsewhere: the first of the inputs is the recipe's own text, if it has one.
        let files = opened.inputs.iter().map(|input| input.blake3.as_bytes());
        let key = files.fold(Key::of::<Landscape>().and(&recipe), Key::and);
        self.of(&key, unpacked, || opened.generate(watch))
    }
}
