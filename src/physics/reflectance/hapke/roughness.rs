//! Hapke's macroscopic roughness: slopes at scales that the mesh does not resolve.

use std::f64::consts::PI;

use crate::physics::reflectance::PhotometricAngles;

/// Mean slope theta-bar, and what follows from it. Source: Hapke (1984).
///
/// Limits: mean slopes up to some 30 deg. Slopes that the mesh resolves must not be included again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roughness {
    tan: f64,
    chi: f64,
}

/// What a rough surface shows of a direction of light and one of view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// mu0e / (mu0e + mue) S / mu0, which is the same with light and view in each other's place; 1 / (mu0 + mu) of a smooth surface.
    pub shading: f64,
    /// Effective cosines: that of the steeper direction first.
    pub cosines: [f64; 2],
}

impl Roughness {
    /// Of a flat surface.
    pub const SMOOTH: Roughness = Roughness { tan: 0.0, chi: 1.0 };

    /// Of a mean slope, rad, from 0 to below pi / 2.
    pub fn of_mean_slope(theta_bar_rad: f64) -> Self {
        let tan = theta_bar_rad.tan();
        Roughness { tan, chi: 1.0 / (1.0 + PI * tan * tan).sqrt() }
    }

    /// Of a surface whose slopes have this mean of their tangents, over its level area: tan theta-bar = (2 / pi) of it.
    pub fn of_tangents(mean_tangent: f64) -> Self {
        Self::of_mean_slope((2.0 / PI * mean_tangent).atan())
    }

    /// What is left of it without the slopes of another one, which are independent of the rest: tangents add up by squares.
    #[must_use]
    pub fn without(&self, other: &Roughness) -> Self {
        Self::of_mean_slope((self.tan * self.tan - other.tan * other.tan).max(0.0).sqrt().atan())
    }

    /// The mean slope, rad.
    pub fn mean_slope_rad(&self) -> f64 {
        self.tan.atan()
    }

    /// The effective cosines, and what shadows leave.
    ///
    /// The published equations are two sets, for i <= e and for i > e. Written for the direction a with the smaller zenith angle and the
    /// other one, b, they are the same, and mu0 cancels:
    /// S mu0e / mu0 = mu0e mue / (eta(i) eta(e)) chi / (1 - F + F chi mu_a / eta(a)).
    #[inline]
    pub fn at(&self, angles: &PhotometricAngles) -> Seen {
        let (mu0, mu) = (angles.cos_incidence(), angles.cos_emission());
        let (a, b) = (mu0.max(mu), mu0.min(mu));
        if self.tan == 0.0 {
            return Seen { shading: 1.0 / (a + b), cosines: [a, b] };
        }
        let (steep, flat) = (self.direction(a), self.direction(b));
        let across = angles.haversine_azimuth();
        let n = 2.0 - flat.e1 - angles.azimuth_rad() / PI * steep.e1;
        let cosine = |of: &Tilted, tilt: f64| self.chi * (of.cos + of.sin_tan * tilt / n);
        let steep_cosine = cosine(&steep, (1.0 - 2.0 * across) * flat.e2 + across * steep.e2);
        let flat_cosine = cosine(&flat, flat.e2 - across * steep.e2);
        let shared_shadow = (-2.0 * angles.tan_half_azimuth()).exp();
        let shadows = self.chi / (1.0 - shared_shadow + shared_shadow * self.chi * steep.cos / steep.eta);
        let shading = steep_cosine * flat_cosine / ((steep_cosine + flat_cosine) * steep.eta * flat.eta) * shadows;
        Seen { shading, cosines: [steep_cosine, flat_cosine] }
    }

    /// E1, E2 and eta at a zenith angle.
    #[inline]
    fn direction(&self, cos: f64) -> Tilted {
        let sin = PhotometricAngles::sine_of(cos);
        // At the zenith the cotangent is infinite, and both are 0.
        let slope = cos / sin / self.tan;
        let (e1, e2) = ((-2.0 / PI * slope).exp(), (-slope * slope / PI).exp());
        let sin_tan = sin * self.tan;
        Tilted { cos, sin_tan, e1, e2, eta: self.chi * (cos + sin_tan * e2 / (2.0 - e1)) }
    }
}

/// A direction over a rough surface.
struct Tilted {
    cos: f64,
    sin_tan: f64,
    e1: f64,
    e2: f64,
    eta: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effective_cosines_and_shadows() {
        // (i, e, azimuth, mean slope, deg; mu0e, mue, S), computed independently in 40 digits.
        for (i_deg, e_deg, azimuth_deg, slope_deg, mu0e, mue, s) in [
            (30.0, 60.0, 60.0, 20.0, 0.748_942_355_591_959_1, 0.493_540_907_319_121_87, 1.001_351_269_767_734_7),
            (60.0, 30.0, 60.0, 20.0, 0.493_540_907_319_121_87, 0.748_942_355_591_959_1, 0.877_305_925_472_316_9),
            (45.0, 45.0, 90.0, 30.0, 0.530_755_331_636_262_5, 0.530_755_331_636_262_5, 0.849_839_559_788_421_8),
        ] {
            let angles = PhotometricAngles::of_angles(
                f64::to_radians(i_deg),
                f64::to_radians(e_deg),
                f64::to_radians(azimuth_deg),
            );
            let seen = Roughness::of_mean_slope(f64::to_radians(slope_deg)).at(&angles);
            assert!((seen.cosines[0] / f64::max(mu0e, mue) - 1.0).abs() < 1e-13);
            assert!((seen.cosines[1] / f64::min(mu0e, mue) - 1.0).abs() < 1e-13);
            let got = seen.shading * angles.cos_incidence() * (mu0e + mue) / mu0e;
            assert!((got / s - 1.0).abs() < 1e-12, "{got} {s}");
        }
    }

    #[test]
    fn slopes_add_up_by_squares_of_tangents() {
        let of = |tan: f64| Roughness::of_mean_slope(tan.atan());
        assert!((of(0.5).without(&of(0.3)).mean_slope_rad() - 0.4f64.atan()).abs() < 1e-15);
        assert_eq!(of(0.3).without(&of(0.5)), Roughness::SMOOTH);
        // Slopes of 45 deg everywhere.
        assert!((Roughness::of_tangents(1.0).mean_slope_rad() - (2.0 / PI).atan()).abs() < 1e-15);
    }

    #[test]
    fn a_little_roughness_is_none() {
        let angles = PhotometricAngles::of_angles(0.7, 0.4, 2.0);
        let (flat, almost) = (Roughness::SMOOTH.at(&angles), Roughness::of_mean_slope(1e-9).at(&angles));
        assert!((almost.shading / flat.shading - 1.0).abs() < 1e-12);
        assert_eq!(flat.shading, 1.0 / (0.7f64.cos() + 0.4f64.cos()));
        assert_eq!(Roughness::of_mean_slope(0.0), Roughness::SMOOTH);
    }
}
