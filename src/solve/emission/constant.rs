//! A reflectance that is the same in all directions, plain or under a texture: a row for each incoming spectrum, of a texture for each
//! of its layers.

use super::at;
use super::light::{Modulation, SourceLight};
use crate::physics::reflectance::Lambert;
use crate::scene::{Material, Texture, TextureKind};

#[derive(Debug, Clone, Copy)]
pub(super) struct Constant<'a> {
    pub(super) material: &'a Material,
    pub(super) texture: Option<&'a Texture>,
}

impl Constant<'_> {
    fn layers(&self) -> usize {
        self.texture.map_or(1, Texture::layers)
    }

    /// Number of rows: [layer, incoming spectrum].
    pub(super) fn rows(&self, incoming: usize) -> usize {
        self.layers() * incoming
    }

    /// Adds a wavelength's contribution to the rows' spectra, with its weight in the band.
    pub(super) fn spectra(&self, um: f64, weight: f64, incoming: &[[f64; 2]], mut add: impl FnMut(usize, f64)) {
        let base = match self.texture.map(|texture| texture.kind) {
            None | Some(TextureKind::Factor) => at(&self.material.reflectance, um),
            Some(TextureKind::Reflectance) => 1.0,
        };
        let reflected = weight * Lambert { reflectance: base }.brdf();
        let shares = self.texture.map_or_else(|| vec![1.0], |texture| texture.shares(um));
        for (layer, share) in shares.into_iter().enumerate() {
            for (i, [light, on_the_way]) in incoming.iter().enumerate() {
                add(layer * incoming.len() + i, share * (reflected * light) * on_the_way);
            }
        }
    }

    /// The rows' weights for a facet of which each source lights this `amount`.
    #[inline]
    pub(super) fn weights(
        &self,
        facet: u32,
        lights: &[SourceLight],
        amount: impl Fn(&SourceLight) -> f64,
        texture: &Modulation,
        mut add: impl FnMut(usize, f64),
    ) {
        for layer in 0..self.layers() {
            for (i, light) in lights.iter().enumerate() {
                let lit = amount(light);
                if lit > 0.0 {
                    let weight = lit * light.irradiance(facet);
                    let mean = if self.texture.is_some() { light.mean(texture, layer) } else { 1.0 };
                    add(layer * lights.len() + i, weight * mean);
                }
            }
        }
    }
}
