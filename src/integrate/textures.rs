//! Textures: how much of what is seen, and of what is lit, each layer's values stand for.

use super::maps::{Lookup, TexelLayout};
use super::pixel::Pixel;
use crate::scene::{Scene, Texture};
use crate::solve::Modulation;
use crate::visibility::Drawing;

/// Of a facet that a texture covers all over, rounding leaves less than this share uncovered.
const UNCOVERED: f64 = 1e-9;

/// Looks textures up, pixel by pixel.
pub(super) struct Textures<'a> {
    textures: &'a [Texture],
    /// For each material its texture.
    of_material: Vec<Option<usize>>,
    lookups: Vec<Lookup<'a>>,
    /// Of the entry at hand: the mean of each layer, and of each lit part its area and the mean of each layer, [part, layer].
    means: Vec<f64>,
    lit_area: Vec<f64>,
    lit_means: Vec<f64>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(scene: &'a Scene, drawing: &'a Drawing<'a>) -> Self {
        let mut of_material = vec![None; scene.body.materials.len()];
        scene.body.textures.iter().enumerate().for_each(|(i, t)| of_material[t.material.0 as usize] = Some(i));
        let lookup = |texture: &'a Texture| {
            let kind = match &texture.lon_lat {
                Some(map) => TexelLayout::LonLat(map),
                None => TexelLayout::Texture(&texture.corners, [texture.columns, texture.rows]),
            };
            Lookup::of(scene, drawing, kind, None, None, texture.texels)
        };
        let lookups = scene.body.textures.iter().map(lookup).collect();
        Textures {
            textures: &scene.body.textures,
            of_material,
            lookups,
            means: vec![],
            lit_area: vec![],
            lit_means: vec![],
        }
    }

    pub(super) fn new_line(&mut self, rows: [u32; 2]) {
        self.lookups.iter_mut().for_each(|lookup| lookup.new_line(rows));
    }

    /// What the texture is over a pixel's entry `index`, of a material that has one; pieces have been sorted.
    pub(super) fn look(&mut self, pixel: &mut Pixel, index: usize, material: usize) -> Option<Modulation<'_>> {
        let entry = pixel.entries[index];
        let number = self.of_material[material]?;
        let (texture, lookup) = (&self.textures[number], &mut self.lookups[number]);
        lookup.look(pixel, index, true);
        let mut area = lookup.seen.area.clamp(0.0, entry.shown.area);
        let is_all = area >= entry.shown.area * (1.0 - UNCOVERED);
        if is_all {
            area = entry.shown.area;
        }
        self.means.clear();
        append_means(&lookup.seen.texels, texture, &mut self.means);
        self.lit_area.clear();
        self.lit_means.clear();
        for (light, share) in lookup.lit.iter().enumerate() {
            let lit = pixel.lit_part(&entry, light).area;
            self.lit_area.push(if is_all { lit } else { share.area.clamp(0.0, lit) });
            append_means(&share.texels, texture, &mut self.lit_means);
        }
        let Textures { means, lit_area, lit_means, .. } = self;
        Some(Modulation { area, means, lit_area, lit_means })
    }
}

/// Mean of each layer over some texels with their weights; 1 without any, so that a mean times nothing is nothing.
fn append_means(weights: &[(u32, f64)], texture: &Texture, means: &mut Vec<f64>) {
    let layers = texture.layers();
    let first = means.len();
    means.resize(first + layers, 0.0);
    let means = &mut means[first..];
    let mut total = 0.0;
    for (texel, weight) in weights {
        total += weight;
        let values = &texture.values[*texel as usize * layers..][..layers];
        means.iter_mut().zip(values).for_each(|(mean, value)| *mean += weight * value);
    }
    means.iter_mut().for_each(|mean| *mean = if total > 0.0 { *mean / total } else { 1.0 });
}
