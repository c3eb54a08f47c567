//! A reflectance model whose albedo alone is a spectrum: a row for each product of what angles and what wavelengths give, under each
//! incoming spectrum, of a texture for each of its layers.

use std::sync::OnceLock;

use super::at;
use super::light::{Angles, Modulation, SourceLight};
use crate::physics::reflectance::albedo::Measure;
use crate::physics::reflectance::lambert_radiance;
use crate::physics::reflectance::{DirectionalAlbedos, Separated};
use crate::scene::{Model, TOLERANCE, Texture, TextureKind};
use crate::spectral::Spectrum;

#[derive(Debug)]
pub(super) struct Modelled<'a> {
    albedo: Spectrum,
    separated: Separated,
    /// Found when light comes from everywhere.
    albedos: OnceLock<DirectionalAlbedos>,
    texture: Option<&'a Texture>,
    /// Each product's row where a texture says that the hemispherical reflectance is 1, instead of an albedo's.
    white: Option<Vec<f64>>,
}

impl<'a> Modelled<'a> {
    pub(super) fn new(model: Model, texture: Option<&'a Texture>) -> Self {
        let separated = model.separated(TOLERANCE);
        let replaces = texture.is_some_and(|texture| texture.kind == TextureKind::Reflectance);
        // One product: other models have no such texture.
        let white =
            replaces.then(|| separated.measured(&Measure::Spherical).into_iter().map(f64::recip).collect::<Vec<_>>());
        Modelled { albedo: model.albedo, separated, albedos: OnceLock::new(), texture, white }
    }

    fn layers(&self) -> usize {
        self.texture.map_or(1, Texture::layers)
    }

    /// Number of products.
    pub(super) fn terms(&self) -> usize {
        self.separated.terms()
    }

    /// Number of rows: [product, layer, incoming spectrum].
    pub(super) fn rows(&self, incoming: usize) -> usize {
        self.terms() * self.layers() * incoming
    }

    /// Adds a wavelength's contribution to the rows' spectra, with its weight in the band.
    pub(super) fn spectra(&self, um: f64, weight: f64, incoming: &[[f64; 2]], mut add: impl FnMut(usize, f64)) {
        let shares = self.texture.map_or_else(|| vec![1.0], |texture| texture.shares(um));
        let terms = self.white.clone().unwrap_or_else(|| self.separated.rows(at(&self.albedo, um)));
        for (term, of_term) in terms.into_iter().enumerate() {
            for (layer, share) in shares.iter().enumerate() {
                for (i, [light, on_the_way]) in incoming.iter().enumerate() {
                    let row = (term * self.layers() + layer) * incoming.len() + i;
                    add(row, share * (weight * of_term * light) * on_the_way);
                }
            }
        }
    }

    /// The rows' weights for a facet of which each source lights this `amount`, at these angles.
    pub(super) fn weights(
        &self,
        facet: u32,
        lights: &[SourceLight],
        amount: impl Fn(&SourceLight) -> f64,
        angles: impl Fn(&SourceLight, &mut dyn FnMut(f64, Angles)),
        texture: &Modulation,
        mut add: impl FnMut(usize, f64),
    ) {
        for (i, light) in lights.iter().enumerate() {
            let weight = amount(light).max(0.0) * light.irradiance(facet);
            if weight > 0.0 {
                let mut put = |term: usize, of_term: f64| {
                    for layer in 0..self.layers() {
                        let mean = if self.texture.is_some() { light.mean(texture, layer) } else { 1.0 };
                        add((term * self.layers() + layer) * lights.len() + i, of_term * mean);
                    }
                };
                angles(light, &mut |share, angles| {
                    self.reflect(angles, |term, of_term| put(term, share * weight * of_term));
                });
            }
        }
    }

    /// Weights of the products: times their rows, the sum is the radiance for an irradiance of 1.
    fn reflect(&self, angles: Angles, mut put: impl FnMut(usize, f64)) {
        match angles {
            Angles::Of(angles) => self.separated.weights(&angles, put),
            // By reciprocity, what goes into this direction of light from everywhere is what goes everywhere of light from it.
            Angles::Diffuse { cos_emission } => {
                let albedos = self.albedos.get_or_init(|| DirectionalAlbedos::new(&self.separated));
                albedos.weights(cos_emission, |term, albedo| put(term, lambert_radiance(albedo)));
            }
        }
    }
}
