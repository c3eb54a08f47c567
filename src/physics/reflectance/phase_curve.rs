//! The decrease of brightness with phase angle, for models that have it as a separate factor.

use super::PhotometricAngles;

/// exp(beta g + gamma g^2 + delta g^3), 1 at phase 0; g in rad.
///
/// Source: Li et al. (2009), Takir et al. (2015), who give it in magnitudes and degrees. Limits: an empirical fit; no surge within 1 or 2 deg unless fitted there.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PhaseCurve {
    /// Per rad; below 0.
    pub beta: f64,
    /// Per rad^2.
    pub gamma: f64,
    /// Per rad^3.
    pub delta: f64,
}

impl PhaseCurve {
    /// The same brightness at all phase angles.
    pub const FLAT: PhaseCurve = PhaseCurve { beta: 0.0, gamma: 0.0, delta: 0.0 };

    /// The factor at these angles.
    pub fn at(&self, angles: &PhotometricAngles) -> f64 {
        if *self == Self::FLAT {
            return 1.0;
        }
        let g = angles.phase_rad();
        (g * (self.beta + g * (self.gamma + g * self.delta))).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_starts_at_1_and_falls_as_told() {
        let curve = PhaseCurve { beta: -2.0, gamma: 0.5, delta: 0.0 };
        assert_eq!(curve.at(&PhotometricAngles::ZENITH), 1.0);
        let angles = PhotometricAngles::of_angles(1.0, 0.0, 0.0);
        assert!((curve.at(&angles) - (-1.5f64).exp()).abs() < 1e-15);
        assert_eq!(PhaseCurve::FLAT.at(&angles), 1.0);
    }
}
