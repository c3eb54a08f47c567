//! Textures: how much of what is seen, and of what is lit, each layer's values stand for.

use super::maps::{Kind, Lookup};
use super::pixel::Pixel;
use crate::scene::{Scene, Texture};
use crate::solve::Emission;
use crate::visibility::Drawing;

/// Of a facet that a texture covers all over, rounding leaves less than this share uncovered.
const UNCOVERED: f64 = 1e-9;

/// Looks textures up, pixel by pixel.
pub(super) struct Textures<'a> {
    textures: &'a [Texture],
    /// For each material its texture.
    of_material: Vec<Option<usize>>,
    lookups: Vec<Lookup<'a>>,
    /// Means over what is seen, and over what is lit, of each layer.
    seen: Vec<f64>,
    lit: Vec<f64>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(scene: &'a Scene, drawing: &'a Drawing<'a>) -> Self {
        let mut of_material = vec![None; scene.body.materials.len()];
        scene.body.textures.iter().enumerate().for_each(|(i, t)| of_material[t.material.0 as usize] = Some(i));
        let lookup = |texture: &'a Texture| {
            let kind = Kind::Texture(&texture.corners, [texture.columns, texture.rows]);
            Lookup::of(scene, drawing, kind, None, None, texture.texels)
        };
        let lookups = scene.body.textures.iter().map(lookup).collect();
        Textures { textures: &scene.body.textures, of_material, lookups, seen: vec![], lit: vec![] }
    }

    pub(super) fn new_line(&mut self, row: u32) {
        self.lookups.iter_mut().for_each(|lookup| lookup.new_line(row));
    }

    /// Whether facets of a material have a texture.
    pub(super) fn has(&self, material: usize) -> bool {
        self.of_material[material].is_some()
    }

    /// Adds what a pixel's entry `index`, of a material with a texture, sends; fragments have been sorted.
    pub(super) fn send(
        &mut self,
        pixel: &mut Pixel,
        index: usize,
        material: usize,
        emission: &Emission,
        mut add: impl FnMut(u32, f64),
    ) {
        let entry = pixel.entries[index];
        let Some(number) = self.of_material[material] else { return };
        let (texture, lookup) = (&self.textures[number], &mut self.lookups[number]);
        lookup.look(pixel, index, true);
        let (mut area, mut lit) = (lookup.seen.area.clamp(0.0, entry.area), lookup.lit.area.clamp(0.0, entry.lit));
        if area >= entry.area * (1.0 - UNCOVERED) {
            (area, lit) = (entry.area, entry.lit);
        }
        mean(&lookup.seen.texels, texture, &mut self.seen);
        mean(&lookup.lit.texels, texture, &mut self.lit);
        emission.textured(entry.facet, number, (area, &self.seen), (lit, &self.lit), &mut add);
        emission.reflected(entry.facet, entry.area - area, entry.lit - lit, &mut add);
        emission.heat(entry.facet, entry.area, entry.lit, &mut add);
    }
}

/// Mean of each layer over some texels with their weights; 1 without any, so that a mean times nothing is nothing.
fn mean(weights: &[(u32, f64)], texture: &Texture, means: &mut Vec<f64>) {
    let layers = texture.layers();
    means.clear();
    means.resize(layers, 0.0);
    let mut total = 0.0;
    for (texel, weight) in weights {
        total += weight;
        let values = &texture.values[*texel as usize * layers..][..layers];
        means.iter_mut().zip(values).for_each(|(mean, value)| *mean += weight * value);
    }
    means.iter_mut().for_each(|mean| *mean = if total > 0.0 { *mean / total } else { 1.0 });
}
