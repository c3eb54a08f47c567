//! What a facet sends towards an observer: a few weights on spectra that many facets share.

use glam::DVec3;

use super::temperature_grid::{POINTS, TemperatureGrid};
use crate::physics::reflectance::{Brdf, PhotometricAngles};
use crate::physics::{blackbody, sun};
use crate::product::FacetTable;
use crate::scene::{Material, Scene, TextureKind};
use crate::spectral::{Band, Spectrum};

/// Answers what a facet sends towards an observer.
///
/// Radiance = sum over rows of weight x spectrum. A row is a material under a source, or a material at a temperature.
/// Lambert surfaces send the same everywhere; a reflectance that depends on the view will put it into the weights.
#[derive(Debug)]
pub struct Emission<'a> {
    scene: &'a Scene,
    table: &'a FacetTable,
    grid: TemperatureGrid,
    /// Thermal radiance of [material, temperature, band], W m-2 sr-1 um-1.
    thermal: Vec<f64>,
    /// Few bands take a row each for thermal emission of any temperature: fewer weights than temperatures would need.
    row_per_band: bool,
}

impl<'a> Emission<'a> {
    /// For the facets of a scene and what was solved for them.
    pub fn new(scene: &'a Scene, table: &'a FacetTable) -> Self {
        let temperatures_k = table.temperature_lit_k.iter().chain(&table.temperature_shaded_k).copied();
        let grid = TemperatureGrid::new(temperatures_k);
        let row_per_band = grid.len() > 0 && Emission::has_row_per_band(&scene.exposure.bands);
        let mut emission = Emission { scene, table, grid, thermal: vec![], row_per_band };
        emission.thermal = emission.thermal();
        emission
    }

    /// Whether so few bands take a row each for thermal emission.
    pub(crate) fn has_row_per_band(bands: &[Band]) -> bool {
        bands.len() <= POINTS
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.first_thermal_row()
            + if self.row_per_band {
                self.scene.exposure.bands.len()
            } else {
                self.scene.body.materials.len() * self.grid.len()
            }
    }

    /// The first row of what is emitted: each material under the Sun and under Mars comes first, then each layer of the textures.
    pub fn first_thermal_row(&self) -> usize {
        self.texture_row(self.scene.body.textures.len())
    }

    /// The first row of a texture: its first layer under the Sun.
    fn texture_row(&self, texture: usize) -> usize {
        let layers: usize = self.scene.body.textures[..texture].iter().map(|t| t.layers()).sum();
        2 * (self.scene.body.materials.len() + layers)
    }

    /// Adds to `add(row, weight)` what a facet sends towards `to_observer` when `area` of it is seen, `lit` of that lit: both as shares of the
    /// pixel, 0 to 1, and weights are those of the pixel's mean.
    pub fn towards(&self, facet: u32, _to_observer: DVec3, area: f64, lit: f64, mut add: impl FnMut(u32, f64)) {
        self.reflected(facet, area, lit, &mut add);
        self.heat(facet, area, lit, &mut add);
    }

    /// Adds what a facet reflects with its material's own reflectance; `area` and `lit`, shares of the pixel, as of [`towards`](Self::towards).
    pub fn reflected(&self, facet: u32, area: f64, lit: f64, add: &mut impl FnMut(u32, f64)) {
        let f = facet as usize;
        let row = 2 * u32::from(self.scene.body.mesh.material[f].0);
        if lit > 0.0 {
            add(row, lit * self.table.sun_irradiance[f]);
        }
        if let Some(mars) = self.table.mars_irradiance.get(f)
            && area > 0.0
        {
            add(row + 1, area * mars);
        }
    }

    /// Adds what a facet reflects by a texture: the area that is seen, and that of it that is lit, each with the layers' means over it;
    /// areas are shares of the pixel.
    pub fn textured(
        &self,
        facet: u32,
        texture: usize,
        (area, mean_seen): (f64, &[f64]),
        (lit, mean_lit): (f64, &[f64]),
        add: &mut impl FnMut(u32, f64),
    ) {
        let f = facet as usize;
        let first = self.texture_row(texture) as u32;
        for (layer, (seen, lit_value)) in mean_seen.iter().zip(mean_lit).enumerate() {
            let row = first + 2 * layer as u32;
            if lit > 0.0 {
                add(row, lit * self.table.sun_irradiance[f] * lit_value);
            }
            if let Some(mars) = self.table.mars_irradiance.get(f) {
                add(row + 1, area * mars * seen);
            }
        }
    }

    /// Adds what a facet emits; `area` and `lit`, shares of the pixel, as of [`towards`](Self::towards).
    pub fn heat(&self, facet: u32, area: f64, lit: f64, add: &mut impl FnMut(u32, f64)) {
        if self.grid.len() == 0 {
            return;
        }
        let f = facet as usize;
        let material = self.scene.body.mesh.material[f].0 as usize;
        let parts = [(lit, &self.table.temperature_lit_k), (area - lit, &self.table.temperature_shaded_k)];
        for (part, temperature_k) in parts {
            if part > 0.0
                && let Some((at, weights)) = self.grid.weights(temperature_k[f])
            {
                self.add_thermal(part, material * self.grid.len() + at, &weights, add);
            }
        }
    }

    /// Adds thermal emission, interpolated between some temperatures of a material, the first of which is `first`.
    fn add_thermal(&self, part: f64, first: usize, weights: &[f64; POINTS], add: &mut impl FnMut(u32, f64)) {
        let row = self.first_thermal_row();
        if self.row_per_band {
            let bands = self.scene.exposure.bands.len();
            for band in 0..bands {
                let of_point = |(k, weight): (usize, &f64)| weight * self.thermal[(first + k) * bands + band];
                add((row + band) as u32, part * weights.iter().enumerate().map(of_point).sum::<f64>());
            }
        } else {
            for (k, weight) in weights.iter().enumerate() {
                add((row + first + k) as u32, part * weight);
            }
        }
    }

    /// The spectra of the rows, [row, band], W m-2 sr-1 um-1 for a weight of 1.
    pub fn spectra(&self) -> Vec<f64> {
        let bands = &self.scene.exposure.bands;
        let mut spectra = vec![0.0; self.rows() * bands.len()];
        for (b, band) in bands.iter().enumerate().filter(|(_, band)| band.light.is_lit()) {
            for (um, weight) in self.quadrature(band) {
                let sunlight =
                    sun::irradiance_at(at(&self.scene.sky.sun.irradiance_1au, um), self.scene.sky.sun.distance_m);
                let mars = self.scene.sky.mars.as_ref().map_or(0.0, |m| at(&m.reflectance, um));
                for (m, material) in self.scene.body.materials.iter().enumerate() {
                    let reflected = weight * brdf(material, at(&material.reflectance, um)) * sunlight;
                    spectra[2 * m * bands.len() + b] += reflected;
                    spectra[(2 * m + 1) * bands.len() + b] += reflected * mars;
                }
                for (t, texture) in self.scene.body.textures.iter().enumerate() {
                    let material = &self.scene.body.materials[texture.material.0 as usize];
                    let base = match texture.kind {
                        TextureKind::Factor => at(&material.reflectance, um),
                        TextureKind::Reflectance => 1.0,
                    };
                    let reflected = weight * brdf(material, base) * sunlight;
                    for (layer, share) in texture.shares(um).into_iter().enumerate() {
                        let row = self.texture_row(t) + 2 * layer;
                        spectra[row * bands.len() + b] += share * reflected;
                        spectra[(row + 1) * bands.len() + b] += share * reflected * mars;
                    }
                }
            }
        }
        let thermal = &mut spectra[self.first_thermal_row() * bands.len()..];
        if self.row_per_band {
            (0..bands.len()).filter(|b| bands[*b].light.glows()).for_each(|b| thermal[b * bands.len() + b] = 1.0);
        } else {
            thermal.copy_from_slice(&self.thermal);
        }
        spectra
    }

    /// Thermal radiance of [material, temperature, band], W m-2 sr-1 um-1.
    fn thermal(&self) -> Vec<f64> {
        let (bands, materials) = (&self.scene.exposure.bands, &self.scene.body.materials);
        let temperatures_k: Vec<f64> = self.grid.temperatures_k().collect();
        let mut thermal = vec![0.0; materials.len() * temperatures_k.len() * bands.len()];
        for (b, band) in bands.iter().enumerate().filter(|(_, band)| band.light.glows()) {
            for (um, weight) in self.quadrature(band) {
                let black: Vec<f64> = temperatures_k.iter().map(|t| blackbody::radiance_w_m2_sr_um(um, *t)).collect();
                for (m, material) in materials.iter().enumerate() {
                    let emissivity = at(&material.emissivity, um);
                    for (k, black) in black.iter().enumerate() {
                        thermal[(m * temperatures_k.len() + k) * bands.len() + b] += weight * emissivity * black;
                    }
                }
            }
        }
        thermal
    }

    /// Wavelengths and weights of a band, which ends where the spectra do.
    fn quadrature(&self, band: &Band) -> Vec<(f64, f64)> {
        let known_um = self.scene.known_um(band.light);
        band.quadrature(&self.knots_um(band.support_within_um(known_um)), known_um)
    }

    /// Where the spectra that meet in a band have corners, um, ascending.
    fn knots_um(&self, (lo, hi): (f64, f64)) -> Vec<f64> {
        let materials = self.scene.body.materials.iter().flat_map(|m| [&m.reflectance, &m.emissivity]);
        let mars = self.scene.sky.mars.iter().map(|m| &m.reflectance);
        let all = materials.chain(mars).chain([&self.scene.sky.sun.irradiance_1au]);
        let layers = self.scene.body.textures.iter().flat_map(|t| &t.wavelength_um);
        let mut knots: Vec<f64> =
            all.flat_map(|s| s.wavelength_um()).chain(layers).copied().filter(|um| lo < *um && *um < hi).collect();
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        knots
    }
}

/// A spectrum within its coverage, which [`Parts::check`] has compared with the bands.
fn at(spectrum: &Spectrum, um: f64) -> f64 {
    spectrum.at(um).unwrap_or(f64::NAN)
}

/// BRDF of a material, 1/sr. The angles are those of no facet in particular: the only kind so far is Lambert's.
fn brdf(_: &Material, reflectance: f64) -> f64 {
    let any = PhotometricAngles { cos_incidence: 1.0, cos_emission: 1.0, phase_rad: 0.0 };
    Brdf::Lambert { reflectance }.eval(&any)
}
