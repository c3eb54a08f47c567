//! What a surface is made of.

use crate::error::number;
use crate::spectral::{Band, Spectrum};

use super::coverage::uncovered;
use super::{Photometry, Thermal};
use crate::physics::reflectance::kirchhoff_emissivity;

/// What emits less gets hotter than numbers can say, whatever lights it; polished metals have 0.01.
const LEAST_EMISSIVITY: f64 = 1e-6;
/// No solid surface is warmer, K.
const MOST_K: f64 = 1e4;
/// No ground stores more, J m-2 K-1 s-1/2; copper has 4e4.
const MOST_INERTIA: f64 = 1e9;

/// Optical and thermal properties of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name, as in the scene's dictionary.
    pub name: String,
    /// Hemispherical reflectance (dimensionless), of light from all of the sky: that of a Lambert surface, whose BRDF is reflectance / pi. With
    /// another photometry emissivity and Bond albedo still follow from it, but it says nothing about directions.
    pub reflectance: Spectrum,
    /// How reflectance depends on directions.
    pub photometry: Photometry,
    /// Directional emissivity (dimensionless); Kirchhoff: 1 - reflectance unless stated otherwise.
    pub emissivity: Spectrum,
    /// Share of the Sun's total irradiance that is not absorbed, for the heat balance.
    pub bond_albedo: f64,
    /// Emissivity over all wavelengths, for the heat balance.
    pub emissivity_bolometric: f64,
    /// Thermal inertia of the ground below, J m-2 K-1 s-1/2; 0 if it stores no heat, or none is known.
    pub thermal_inertia: f64,
    /// Temperature at which it is held, K, whatever it absorbs; `None`: that of the thermal model.
    pub temperature_k: Option<f64>,
    /// Share of each dictionary entry: (index into the dictionary, fraction). One entry, fraction 1, unless a mixture.
    pub mixture: Vec<(usize, f64)>,
}

impl Material {
    /// Whether its emissivity is what it does not reflect.
    pub fn has_kirchhoff_emissivity(&self) -> bool {
        self.emissivity == self.reflectance.map(kirchhoff_emissivity)
    }

    /// Says what bands look for where its spectra are not known.
    pub(super) fn covers(&self, bands: &[Band], thermal: Thermal, problem: &mut impl FnMut(&str, String)) {
        let item = format!("materials.{:?}", self.name);
        let is_lit = |band: &Band| band.light.is_lit();
        let glows = |band: &Band| band.light.glows() && thermal != Thermal::Off;
        let found = [
            ("reflectance", uncovered("reflectance", &self.reflectance, bands, is_lit)),
            ("emissivity", uncovered("emissivity", &self.emissivity, bands, glows)),
        ];
        for (what, message) in found {
            if let Some(message) = message {
                problem(&format!("{item}.{what}"), message);
            }
        }
        if let Some(key) = self.photometry.key() {
            self.photometry.covers(bands, |message| problem(&format!("{item}.{key}"), message));
        }
    }

    /// What is wrong with it, whatever the bands.
    pub(super) fn check(&self, problem: &mut impl FnMut(&str, String)) {
        let item = format!("materials.{:?}", self.name);
        for (what, spectrum) in [("reflectance", &self.reflectance), ("emissivity", &self.emissivity)] {
            if let Some(v) = spectrum.value().iter().find(|v| !(0.0..=1.0).contains(*v)) {
                problem(&format!("{item}.{what}"), format!("{v} is outside 0 to 1: is the table in percent?"));
            }
        }
        if let Some(key) = self.photometry.key() {
            self.photometry.check(|parameter, message| {
                let dot = if parameter.is_empty() { "" } else { "." };
                problem(&format!("{item}.{key}{dot}{parameter}"), message);
            });
        }
        if !(0.0..=1.0).contains(&self.bond_albedo) {
            problem(&format!("{item}.bond_albedo"), format!("{} is outside 0 to 1", self.bond_albedo));
        }
        if !(LEAST_EMISSIVITY..=1.0).contains(&self.emissivity_bolometric) {
            let message = format!("{} is not from {LEAST_EMISSIVITY:e} to 1", self.emissivity_bolometric);
            problem(&format!("{item}.emissivity_bolometric"), message);
        }
        if !(0.0..=MOST_INERTIA).contains(&self.thermal_inertia) {
            let message = format!("{} is not from 0 to {MOST_INERTIA:e}", number(self.thermal_inertia));
            problem(&format!("{item}.thermal_inertia"), message);
        }
        if let Some(t_k) = self.temperature_k.filter(|t_k| !(0.0..=MOST_K).contains(t_k)) {
            problem(&format!("{item}.temperature_k"), format!("{} K is not from 0 to {MOST_K:e}", number(t_k)));
        }
    }
}
