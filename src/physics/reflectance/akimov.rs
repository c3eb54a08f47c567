//! Akimov's disc function: the shading of an extremely rough surface, without parameters.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{PhaseCurve, PhotometricAngles};

/// f = (A(g) / pi) D / mu0, D = cos(g/2) cos\[pi / (pi - g) (l - g/2)\] (cos b)^(g / (pi - g)) / cos l, in photometric longitude l and
/// latitude b. Source: Akimov (1976), Shkuratov et al. (2011). Reciprocal.
///
/// With l' = l - g/2 this is (A/pi) cos(g/2) cos(pi l' / (pi - g)) (cos b)^(pi / (pi - g)) / (mu0 mu), symmetric in light and view.
/// Limits: D is 1 at phase 0 all over the disc, and 0 at the limb and the terminator of any other; A must carry how brightness falls with phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Akimov {
    /// Normal albedo: the reflectance factor with light and view at the zenith, from 0.
    pub albedo: f64,
    /// How brightness falls with phase.
    pub phase: PhaseCurve,
}

impl Akimov {
    /// The BRDF, 1/sr.
    pub fn brdf(&self, angles: &PhotometricAngles) -> f64 {
        let (mu0, mu) = (angles.cos_incidence(), angles.cos_emission());
        let (sin_half, cos_half) = angles.half_phase_sin_cos();
        if cos_half == 0.0 {
            return 0.0;
        }
        // Components of the normal in the plane of light and view: along their bisector, and across it.
        let middle = (0.5 * (mu0 + mu) / cos_half).min(1.0);
        let most_across = ((1.0 - middle) * (1.0 + middle)).sqrt();
        let across = if sin_half == 0.0 { 0.0 } else { (0.5 * (mu0 - mu) / sin_half).clamp(-most_across, most_across) };
        let cos_latitude = middle.hypot(across).min(1.0);
        let stretch = PI / (PI - angles.phase_rad());
        let longitude = (stretch * across.atan2(middle)).clamp(-FRAC_PI_2, FRAC_PI_2);
        let shading = cos_half * longitude.cos() * cos_latitude.powf(stretch) / (mu0 * mu);
        self.albedo / PI * self.phase.at(angles) * shading
    }
}
