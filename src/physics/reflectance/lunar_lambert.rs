//! McEwen's lunar-Lambert surface: part Lommel and Seeliger, part Lambert.

use std::f64::consts::PI;

use super::{PhaseCurve, PhotometricAngles};

/// f = (A(g) / pi) (2 L(g) / (mu0 + mu) + 1 - L(g)). Source: McEwen (1991). Reciprocal.
///
/// Limits: a fit of the disc's shading; A must carry how brightness falls with phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LunarLambert {
    /// Normal albedo: the reflectance factor with light and view at the zenith, from 0.
    pub albedo: f64,
    /// How brightness falls with phase.
    pub phase: PhaseCurve,
    /// L, how much of it is Lommel and Seeliger's.
    pub partition: Partition,
}

/// L(g): 1 is Lommel and Seeliger's surface, 0 Lambert's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Partition {
    /// The same at all phase angles, 0 to 1.
    Constant(f64),
    /// exp(-g / scale), as is used for small bodies with a scale of 60 deg (Gaskell et al. 2008).
    Exponential {
        /// Phase angle at which L is 1 / e, rad; above 0.
        scale_rad: f64,
    },
    /// The Moon's, 1 - 0.019 g + 2.42e-4 g^2 - 1.46e-6 g^3 with g in deg (McEwen 1996), within 0 and 1.
    Moon,
}

impl Partition {
    /// L at these angles.
    pub fn at(&self, angles: &PhotometricAngles) -> f64 {
        match *self {
            Partition::Constant(share) => share,
            Partition::Exponential { scale_rad } => (-angles.phase_rad() / scale_rad).exp(),
            Partition::Moon => {
                let g = angles.phase_rad().to_degrees();
                (1.0 + g * (-0.019 + g * (2.42e-4 - g * 1.46e-6))).clamp(0.0, 1.0)
            }
        }
    }
}

impl LunarLambert {
    /// The BRDF, 1/sr.
    pub fn brdf(&self, angles: &PhotometricAngles) -> f64 {
        let share = self.partition.at(angles);
        let sum = angles.cos_incidence() + angles.cos_emission();
        self.albedo / PI * self.phase.at(angles) * (2.0 * share / sum + (1.0 - share))
    }
}
