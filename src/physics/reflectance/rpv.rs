//! The model of Rahman, Pinty and Verstraete, with four parameters for vegetation and soils.

use std::f64::consts::PI;

use super::PhotometricAngles;

/// f = (rho0 / pi) (mu0 mu (mu0 + mu))^(k - 1) F(g) (1 + (1 - rho_c) / (1 + G)). Source: Rahman, Pinty & Verstraete (1993). Reciprocal.
///
/// F = (1 - t^2) / (1 + 2 t cos g + t^2)^(3/2); G^2 = tan^2 i + tan^2 e - 2 tan i tan e cos psi.
/// Limits: infinite at the limb with k below 1, where cosines count as no smaller than [`LEAST_COSINE`](super::LEAST_COSINE). rho0 is not an albedo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rpv {
    /// Amplitude rho0, from 0.
    pub amplitude: f64,
    /// Exponent k, from 0: below 1 the limb is bright, above 1 dark.
    pub exponent: f64,
    /// Asymmetry t of Henyey and Greenstein, within -1 and 1; below 0 scatters back.
    pub asymmetry: f64,
    /// rho_c of the hot spot; often the same as rho0.
    pub hot_spot: f64,
}

impl Rpv {
    /// The BRDF, 1/sr.
    pub fn brdf(&self, angles: &PhotometricAngles) -> f64 {
        let (mu0, mu, t) = (angles.cos_incidence(), angles.cos_emission(), self.asymmetry);
        let shape = (mu0 * mu * (mu0 + mu)).powf(self.exponent - 1.0);
        let d = 1.0 + 2.0 * t * angles.cos_phase() + t * t;
        let scattering = (1.0 - t * t) / (d * d.sqrt());
        let tan = |cos: f64| PhotometricAngles::sine_of(cos) / cos;
        let (tan_i, tan_e) = (tan(mu0), tan(mu));
        // The difference of tangents, and what the azimuth adds to it: both from 0.
        let g = ((tan_i - tan_e).powi(2) + 4.0 * tan_i * tan_e * angles.haversine_azimuth()).sqrt();
        self.amplitude / PI * shape * scattering * (1.0 + (1.0 - self.hot_spot) / (1.0 + g))
    }
}
