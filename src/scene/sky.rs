//! What lights and warms the surface at an instant.

use glam::DVec3;

use crate::error::{Location, Problem};
use crate::geometry::Direction;
use crate::spectral::Spectrum;

/// What lights a body at an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Sky {
    /// The Sun.
    pub sun: Sun,
    /// Mars as a second source, if there is one.
    pub mars: Option<Mars>,
}

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
}

impl Sky {
    /// What is wrong with it, whatever it lights.
    pub(super) fn problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut problem = |item: &str, message: String| problems.push(Problem::new(Location::item(item), message));
        self.sun.check(&mut problem);
        if let Some(mars) = &self.mars {
            mars.check(&mut problem);
        }
        problems
    }
}

impl Sun {
    fn check(&self, problem: &mut impl FnMut(&str, String)) {
        if !(self.distance_m > 0.0 && self.distance_m.is_finite()) {
            problem("sun", format!("distance {} m is not a positive length", self.distance_m));
        }
        if let Some(v) = self.irradiance_1au.value().iter().find(|v| **v < 0.0) {
            problem("sun.spectrum", format!("irradiance {v} is negative"));
        }
    }
}

impl Mars {
    fn check(&self, problem: &mut impl FnMut(&str, String)) {
        super::near_enough("mars.position_m", self.centre_m, problem);
        if !(self.radius_m > 0.0 && self.radius_m.is_finite()) {
            problem("mars.radius_m", format!("{} is not a positive length", self.radius_m));
        } else if self.centre_m.length() <= self.radius_m {
            problem("mars.position_m", "the scene lies inside Mars".into());
        }
    }
}
