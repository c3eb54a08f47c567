//! Lommel and Seeliger's surface: a dark, deep layer of particles, each of which scatters light once.

use std::f64::consts::PI;

use super::{PhaseFunction, PhotometricAngles};

/// f = w p(g) / (4 pi (mu0 + mu)). Source: Seeliger (1887); Hapke (2012), ch. 8. Reciprocal.
///
/// Limits: dark surfaces (w below some 0.2): of light scattered twice there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LommelSeeliger {
    /// Single-scattering albedo w, 0 to 1.
    pub albedo: f64,
    /// Phase function of the particles.
    pub phase: PhaseFunction,
}

impl LommelSeeliger {
    /// The BRDF, 1/sr.
    pub fn brdf(&self, angles: &PhotometricAngles) -> f64 {
        self.albedo / (4.0 * PI) * self.phase.at(angles) / (angles.cos_incidence() + angles.cos_emission())
    }
}
