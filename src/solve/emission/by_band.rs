//! A reflectance model of which more than the albedo depends on wavelength: a row for each band, of a texture for each of its layers.

use super::light::{Angles, Modulation, SourceLight};
use crate::physics::reflectance::{Brdf, lambert_radiance};
use crate::scene::Texture;

#[derive(Debug)]
pub(super) struct ByBand<'a> {
    texture: Option<&'a Texture>,
    /// Of each band.
    samples: Vec<Vec<Sample>>,
}

/// The surface at a wavelength.
#[derive(Debug)]
pub(super) struct Sample {
    pub(super) um: f64,
    pub(super) brdf: Brdf,
    /// What is reflected of light from everywhere.
    pub(super) reflectance: f64,
    /// Irradiance of each source normal to its beam, times the wavelength's weight in the band.
    pub(super) incoming: Vec<f64>,
}

impl<'a> ByBand<'a> {
    pub(super) fn new(samples: Vec<Vec<Sample>>, texture: Option<&'a Texture>) -> Self {
        ByBand { texture, samples }
    }

    fn layers(&self) -> usize {
        self.texture.map_or(1, Texture::layers)
    }

    /// Number of rows: [layer, band].
    pub(super) fn rows(&self) -> usize {
        self.layers() * self.samples.len()
    }

    /// Writes the rows' spectra, [row, band].
    pub(super) fn spectra(&self, out: &mut [f64]) {
        let bands = self.samples.len();
        for row in 0..self.rows() {
            out[row * bands + row % bands] = 1.0;
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
            if weight <= 0.0 {
                continue;
            }
            angles(light, &mut |share, angles| {
                for (band, samples) in self.samples.iter().enumerate() {
                    for sample in samples {
                        let reflected = match angles {
                            Angles::Of(angles) => sample.brdf.eval(&angles),
                            Angles::Diffuse { .. } => lambert_radiance(sample.reflectance),
                        };
                        let sent = share * weight * reflected * sample.incoming[i];
                        match self.texture {
                            None => add(band, sent),
                            Some(of) => of.shares(sample.um).into_iter().enumerate().for_each(|(layer, share)| {
                                add(layer * self.samples.len() + band, sent * share * light.mean(texture, layer));
                            }),
                        }
                    }
                }
            });
        }
    }
}
