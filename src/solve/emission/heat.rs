//! Thermal emission: a row for each material at each temperature of a grid, or, with few bands, one for each band.
//!
//! A material with a model emits in each direction what it does not reflect from there: the emission of a black body, less what its albedo
//! is the sum of, product by product ([`Separated`]).

use std::sync::Arc;

use super::at;
use super::light::Fragment;
use super::temperature_grid::{POINTS, TemperatureGrid};
use crate::physics::blackbody;
use crate::physics::reflectance::{DirectionalAlbedos, Separated};
use crate::product::FacetTable;
use crate::scene::Scene;
use crate::spectral::Band;

#[derive(Debug)]
pub(super) struct Heat<'a> {
    grid: TemperatureGrid,
    /// Of each facet where the Sun sees it, and in its shadow, K.
    lit_k: &'a [f64],
    shaded_k: &'a [f64],
    bands: usize,
    /// Of each material.
    surfaces: Vec<Surface<'a>>,
    /// Thermal radiance of [spectrum of a material, temperature, band], W m-2 sr-1 um-1.
    radiance: Arc<[f64]>,
}

/// What a material emits: its own spectrum, less those of the products that its albedo is the sum of.
#[derive(Debug)]
struct Surface<'a> {
    /// Number of its first spectrum.
    first: usize,
    albedos: Option<&'a DirectionalAlbedos>,
}

/// Whether there are so few bands that each gets a row: that takes fewer weights than temperatures would.
pub(super) fn has_row_per_band(bands: usize) -> bool {
    bands <= POINTS
}

impl<'a> Heat<'a> {
    /// `None` if nothing is warm. `quadrature` gives wavelengths, um, and weights of a band.
    pub(super) fn new(
        scene: &'a Scene,
        table: &'a FacetTable,
        quadrature: impl Fn(&Band) -> Vec<(f64, f64)>,
    ) -> Option<Self> {
        let FacetTable { temperature_lit_k: lit_k, temperature_shaded_k: shaded_k, .. } = table;
        let grid = TemperatureGrid::new(lit_k.iter().chain(shaded_k).copied());
        if grid.len() == 0 {
            return None;
        }
        let (bands, materials) = (&scene.exposure.bands, &scene.body.materials);
        let temperatures_k: Vec<f64> = grid.temperatures_k().collect();
        let emitting = scene.body.emitting();
        let mut spectra = 0;
        let surface = |of: &'a Option<(Separated, DirectionalAlbedos)>| {
            let first = spectra;
            spectra += 1 + of.as_ref().map_or(0, |(separated, _)| separated.terms());
            Surface { first, albedos: of.as_ref().map(|(_, albedos)| albedos) }
        };
        let surfaces: Vec<Surface> = emitting.iter().map(surface).collect();
        let of_band = |band: &Band| if band.light.glows() { quadrature(band) } else { vec![] };
        let radiance = scene.body.glow(bands.iter().map(of_band).collect(), &temperatures_k, |bands| {
            let mut radiance = vec![0.0; spectra * temperatures_k.len() * bands.len()];
            // One band's lie together while they are summed.
            let mut of_band = vec![0.0; spectra * temperatures_k.len()];
            let mut black = vec![0.0; temperatures_k.len()];
            for (b, quadrature) in bands.iter().enumerate() {
                of_band.fill(0.0);
                for (um, weight) in quadrature {
                    let temperatures = black.iter_mut().zip(&temperatures_k);
                    temperatures.for_each(|(black, t_k)| *black = blackbody::radiance_w_m2_sr_um(*um, *t_k));
                    for ((material, emitting), Surface { first, .. }) in materials.iter().zip(emitting).zip(&surfaces) {
                        let factors = match emitting.as_ref().zip(material.photometry.model()) {
                            None => vec![at(&material.emissivity, *um)],
                            Some(((separated, _), model)) => {
                                [vec![1.0], separated.rows(at(&model.albedo, *um))].concat()
                            }
                        };
                        let spectra = of_band.chunks_exact_mut(temperatures_k.len()).skip(*first);
                        for (spectrum, factor) in spectra.zip(factors) {
                            let times = weight * factor;
                            spectrum.iter_mut().zip(&black).for_each(|(sum, black)| *sum += times * black);
                        }
                    }
                }
                radiance.iter_mut().skip(b).step_by(bands.len()).zip(&of_band).for_each(|(to, value)| *to = *value);
            }
            radiance
        });
        Some(Heat { grid, lit_k, shaded_k, bands: bands.len(), surfaces, radiance })
    }

    /// Number of rows: bands, or [spectrum of a material, temperature].
    pub(super) fn rows(&self) -> usize {
        if has_row_per_band(self.bands) { self.bands } else { self.radiance.len() / self.bands }
    }

    /// Writes the rows' spectra, [row, band].
    pub(super) fn spectra(&self, bands: &[Band], out: &mut [f64]) {
        if has_row_per_band(self.bands) {
            (0..bands.len()).filter(|b| bands[*b].light.glows()).for_each(|b| out[b * bands.len() + b] = 1.0);
        } else {
            out.copy_from_slice(&self.radiance);
        }
    }

    /// The rows' weights for a fragment of a material, of which the Sun sees `lit`, pixels; the cosine of emission is asked for where it counts.
    #[inline]
    pub(super) fn weights(
        &self,
        material: usize,
        fragment: &Fragment,
        lit: f64,
        cos_emission: impl Fn() -> f64,
        mut add: impl FnMut(usize, f64),
    ) {
        let facet = fragment.facet as usize;
        let Surface { first, albedos } = &self.surfaces[material];
        for (part, temperature_k) in [(lit, self.lit_k), (fragment.shown.area - lit, self.shaded_k)] {
            if part > 0.0
                && let Some((at, weights)) = self.grid.weights(temperature_k[facet])
            {
                self.interpolate(part, first * self.grid.len() + at, &weights, &mut add);
                if let Some(albedos) = albedos {
                    self.less_reflected(albedos, cos_emission(), part, (first + 1, at), &weights, &mut add);
                }
            }
        }
    }

    /// Takes away what a surface does not emit because it reflects it. Apart, as what costs more is from what all surfaces take.
    #[inline(never)]
    fn less_reflected(
        &self,
        albedos: &DirectionalAlbedos,
        cos_emission: f64,
        part: f64,
        (first, at): (usize, usize),
        weights: &[f64; POINTS],
        mut add: &mut dyn FnMut(usize, f64),
    ) {
        albedos.weights(cos_emission, |term, albedo| {
            self.interpolate(-albedo * part, (first + term) * self.grid.len() + at, weights, &mut add);
        });
    }

    /// The emission of a part, interpolated between a spectrum's temperatures from `first` on.
    fn interpolate(&self, part: f64, first: usize, weights: &[f64; POINTS], add: &mut impl FnMut(usize, f64)) {
        if has_row_per_band(self.bands) {
            for band in 0..self.bands {
                let of_point = |(k, weight): (usize, &f64)| weight * self.radiance[(first + k) * self.bands + band];
                add(band, part * weights.iter().enumerate().map(of_point).sum::<f64>());
            }
        } else {
            for (k, weight) in weights.iter().enumerate() {
                add(first + k, part * weight);
            }
        }
    }
}
