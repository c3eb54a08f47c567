//! Minnaert's surface: powers of the cosines.

use std::f64::consts::PI;

use super::{LEAST_COSINE, PhotometricAngles};

/// f = (A / pi) (mu0 mu)^(k - 1). Source: Minnaert (1941). Reciprocal.
///
/// With k below 1 this is infinite at the limb, and would reflect more light than arrives where 2 A mu0^(k - 1) / (k + 1) exceeds 1.
/// Smaller cosines than that are raised to it ([`Minnaert::limb_cosine`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Minnaert {
    /// Normal albedo: the reflectance factor with light and view at the zenith, from 0.
    pub albedo: f64,
    /// Exponent k, from 0: 1 is Lambert's surface, 1/2 that of a full Moon without limb darkening.
    pub exponent: f64,
}

impl Minnaert {
    /// The BRDF, 1/sr.
    pub fn brdf(&self, angles: &PhotometricAngles) -> f64 {
        let limb = self.limb_cosine();
        let product = angles.cos_incidence().max(limb) * angles.cos_emission().max(limb);
        self.albedo / PI * product.powf(self.exponent - 1.0)
    }

    /// The smallest cosine used, at which the unlimited model reflects all light: (2 A / (k + 1))^(1 / (1 - k)).
    pub fn limb_cosine(&self) -> f64 {
        if self.exponent >= 1.0 {
            return LEAST_COSINE;
        }
        (2.0 * self.albedo / (self.exponent + 1.0)).powf((1.0 - self.exponent).recip()).clamp(LEAST_COSINE, 1.0)
    }

    /// Directional-hemispherical albedo of the model without its limb: 2 A mu0^(k - 1) / (k + 1).
    ///
    /// Source: the integral over the hemisphere.
    pub fn albedo_without_limb(&self, cos_incidence: f64) -> f64 {
        2.0 * self.albedo * cos_incidence.powf(self.exponent - 1.0) / (self.exponent + 1.0)
    }
}
