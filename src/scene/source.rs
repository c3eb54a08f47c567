//! What lights and warms the surface.

use glam::DVec3;

use crate::geometry::Direction;
use crate::spectral::{Band, Spectrum};

/// The Sun: a direction and a distance, both from the scene's origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Sun {
    /// Towards the Sun.
    pub direction: Direction,
    /// From the origin to the Sun, m.
    pub distance_m: f64,
    /// Spectral irradiance at 1 au on a plane normal to the beam, W m-2 um-1.
    pub irradiance_1au: Spectrum,
    /// Total irradiance at 1 au, for the heat balance, W m-2.
    pub total_irradiance_1au_w_m2: f64,
}

/// How Mars-light is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MarsModel {
    /// Lambert sphere near at hand: phase, tilt and horizon of each facet.
    #[default]
    NearField,
    /// Domagala (2020), equations (4) to (8) as printed.
    Thesis,
}

/// Lambert reflectance of Mars where nothing else is said.
pub const MARS_ALBEDO: f64 = 0.25;

/// Mars as an extended second source.
#[derive(Debug, Clone, PartialEq)]
pub struct Mars {
    /// Centre, local to the scene's origin, axes of the body-fixed frame, m.
    pub centre_m: DVec3,
    /// Radius, m.
    pub radius_m: f64,
    /// Lambert reflectance (dimensionless).
    pub reflectance: Spectrum,
    /// Bond albedo, for the heat balance.
    pub bond_albedo: f64,
    /// Mean thermal exitance of Mars, for the heat balance, W m-2.
    pub thermal_exitance_w_m2: f64,
    /// Which equations.
    pub model: MarsModel,
}

/// How warm the surface is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Thermal {
    /// Each facet in equilibrium with what it absorbs; lit and shaded parts each their own.
    #[default]
    Equilibrium,
    /// Domagala (2020), equation (9): 150 K + 180 K E_sun / E_S.
    Thesis,
    /// No thermal emission.
    Off,
}

impl Sun {
    pub(super) fn check(&self, bands: &[Band], problem: &mut impl FnMut(&str, String)) {
        if !(self.distance_m > 0.0 && self.distance_m.is_finite()) {
            problem("sun", format!("distance {} m is not a positive length", self.distance_m));
        }
        if let Some(message) = super::uncovered("the solar spectrum", &self.irradiance_1au, bands, |b| b.light.is_lit())
        {
            problem("sun.spectrum", message);
        }
        if let Some(v) = self.irradiance_1au.value().iter().find(|v| **v < 0.0) {
            problem("sun.spectrum", format!("irradiance {v} is negative"));
        }
    }
}

impl Mars {
    pub(super) fn check(&self, bands: &[Band], problem: &mut impl FnMut(&str, String)) {
        if !(self.radius_m > 0.0 && self.radius_m.is_finite()) {
            problem("mars.radius_m", format!("{} is not a positive length", self.radius_m));
        } else if self.centre_m.length() <= self.radius_m {
            problem("mars.position_m", "the scene lies inside Mars".into());
        }
        if let Some(message) = super::uncovered("albedo", &self.reflectance, bands, |b| b.light.is_lit()) {
            problem("mars.albedo", message);
        }
    }
}
