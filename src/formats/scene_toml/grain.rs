//! Textures that recipes make, on the materials of their landscapes.

use std::collections::BTreeSet;
use std::ops::Range;

use super::TomlReader;
use super::atlas::UNCOVERED;
use crate::geometry::{MaterialId, Mesh, Texels};
use crate::landscape::Grain;
use crate::scene::{Texture, TextureKind};

/// A recipe's texture, and which facets of the scene are the recipe's.
pub(super) struct OfRecipe {
    pub(super) item: String,
    pub(super) grain: Grain,
    pub(super) facets: Range<usize>,
}

impl TomlReader<'_> {
    /// Adds the textures of recipes to those that the scene states for its materials, which come first.
    pub(super) fn add_grains(&mut self, names: &[String], mesh: &Mesh, textures: &mut Vec<Texture>) {
        for OfRecipe { item, grain, facets } in std::mem::take(&mut self.grains) {
            let of_facets: BTreeSet<u16> = mesh.material[facets.clone()].iter().map(|material| material.0).collect();
            let size = grain.texels as f64;
            let texel = |[u, v]: [f64; 2]| [u * size, (1.0 - v) * size];
            for id in of_facets {
                if textures.iter().any(|texture| texture.material.0 == id) {
                    let name = &names[id as usize];
                    self.note(&item, format!("{name:?} has another texture: the recipe's is not on it"));
                    continue;
                }
                let corners = (0..mesh.facets.len()).map(|f| match mesh.uv.get(f) {
                    Some(uv) if facets.contains(&f) && !uv.as_flattened().iter().any(|x| x.is_nan()) => uv.map(texel),
                    _ => UNCOVERED,
                });
                textures.push(Texture {
                    material: MaterialId(id),
                    kind: TextureKind::Factor,
                    lon_lat: None,
                    corners: corners.collect(),
                    rows: grain.texels,
                    columns: grain.texels,
                    wavelength_um: vec![],
                    values: grain.factors.clone(),
                    texels: Texels::Nearest,
                });
            }
        }
        textures.sort_by_key(|texture| texture.material.0);
    }
}
