//! What a facet sends towards an observer: a few weights on spectra that many facets share.

use glam::DVec3;

use super::temperature_grid::TemperatureGrid;
use crate::physics::reflectance::{Brdf, PhotometricAngles};
use crate::physics::{blackbody, sun};
use crate::product::FacetTable;
use crate::scene::{Material, Scene};
use crate::spectral::Band;

/// Answers what a facet sends towards an observer.
///
/// Radiance = sum over rows of weight x spectrum. A row is a material under a source, or a material at a temperature.
/// Lambert surfaces send the same everywhere; a reflectance that depends on the view will put it into the weights.
#[derive(Debug)]
pub struct Emission<'a> {
    scene: &'a Scene,
    table: &'a FacetTable,
    grid: TemperatureGrid,
}

impl<'a> Emission<'a> {
    /// For the facets of a scene and what was solved for them.
    pub fn new(scene: &'a Scene, table: &'a FacetTable) -> Self {
        let temperatures_k = table.temperature_lit_k.iter().chain(&table.temperature_shaded_k).copied();
        Emission { scene, table, grid: TemperatureGrid::new(temperatures_k) }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.scene.materials.len() * self.rows_of_material()
    }

    /// Rows of a material: sunlight, Mars-light, then one for each temperature.
    fn rows_of_material(&self) -> usize {
        2 + self.grid.len()
    }

    /// Adds to `add(row, weight)` what a facet sends towards `to_observer` when `area` of it is seen, `lit` of that lit.
    pub fn towards(&self, facet: u32, _to_observer: DVec3, area: f64, lit: f64, mut add: impl FnMut(u32, f64)) {
        let f = facet as usize;
        let first = self.scene.mesh.material[f].0 as usize * self.rows_of_material();
        if lit > 0.0 {
            add(first as u32, lit * self.table.sun_irradiance[f]);
        }
        if let Some(mars) = self.table.mars_irradiance.get(f) {
            add(first as u32 + 1, area * mars);
        }
        if self.grid.len() > 0 {
            let parts = [(lit, &self.table.temperature_lit_k), (area - lit, &self.table.temperature_shaded_k)];
            for (part, temperature_k) in parts {
                if part > 0.0
                    && let Some((at, weights)) = self.grid.weights(temperature_k[f])
                {
                    let row = (first + 2 + at) as u32;
                    for (k, weight) in weights.iter().enumerate() {
                        add(row + k as u32, part * weight);
                    }
                }
            }
        }
    }

    /// The spectra of the rows, [row, band], W m-2 sr-1 um-1 for a weight of 1.
    pub fn spectra(&self) -> Vec<f64> {
        let bands = &self.scene.sensor.bands;
        let temperatures_k: Vec<f64> = self.grid.temperatures_k().collect();
        let mut spectra = vec![0.0; self.rows() * bands.len()];
        for (b, band) in bands.iter().enumerate() {
            let mut put = |row: usize, value: f64| spectra[row * bands.len() + b] += value;
            for (um, weight) in band.quadrature(&self.knots_um(band)) {
                let at = |spectrum: &crate::spectral::Spectrum| spectrum.at(um).unwrap_or(f64::NAN);
                let sunlight = sun::irradiance_at(at(&self.scene.sun.irradiance_1au), self.scene.sun.distance_m);
                let mars = self.scene.mars.as_ref().map_or(0.0, |m| at(&m.reflectance));
                let black: Vec<f64> = temperatures_k.iter().map(|t| blackbody::radiance_w_m2_sr_um(um, *t)).collect();
                for (m, material) in self.scene.materials.iter().enumerate() {
                    let first = m * self.rows_of_material();
                    let reflected = brdf(material, at(&material.reflectance)) * sunlight;
                    put(first, weight * reflected);
                    put(first + 1, weight * reflected * mars);
                    let emissivity = at(&material.emissivity);
                    for (k, b) in black.iter().enumerate() {
                        put(first + 2 + k, weight * emissivity * b);
                    }
                }
            }
        }
        spectra
    }

    /// Where the spectra that meet in a band have corners, um, ascending.
    fn knots_um(&self, band: &Band) -> Vec<f64> {
        let (lo, hi) = band.support_um();
        let materials = self.scene.materials.iter().flat_map(|m| [&m.reflectance, &m.emissivity]);
        let mars = self.scene.mars.iter().map(|m| &m.reflectance);
        let all = materials.chain(mars).chain([&self.scene.sun.irradiance_1au]);
        let mut knots: Vec<f64> =
            all.flat_map(|s| s.wavelength_um()).copied().filter(|um| lo < *um && *um < hi).collect();
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        knots
    }
}

/// BRDF of a material, 1/sr. The angles are those of no facet in particular: the only kind so far is Lambert's.
fn brdf(_: &Material, reflectance: f64) -> f64 {
    let any = PhotometricAngles { cos_incidence: 1.0, cos_emission: 1.0, phase_rad: 0.0 };
    Brdf::Lambert { reflectance }.eval(&any)
}
