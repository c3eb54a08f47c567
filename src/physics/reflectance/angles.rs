//! Angles of light and view at a surface point.

use glam::DVec3;

/// The smallest cosine of incidence and emission: some models have powers of them that are infinite at the horizon.
pub const LEAST_COSINE: f64 = 1e-6;

/// Directions of light and view at a surface point.
///
/// Phase and azimuth are stored as tangents of half the angle, which keep all digits at 0 and at 180 deg (infinity), where the arc
/// cosine of a dot product loses half of them. The azimuth is the angle between the horizontal parts of the two directions: 0 if both are on the same
/// side, and also if one of them is at the zenith and has no azimuth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotometricAngles {
    cos_incidence: f64,
    cos_emission: f64,
    tan_half_phase: f64,
    tan_half_azimuth: f64,
}

impl PhotometricAngles {
    /// Light and view at the zenith.
    pub const ZENITH: PhotometricAngles =
        PhotometricAngles { cos_incidence: 1.0, cos_emission: 1.0, tan_half_phase: 0.0, tan_half_azimuth: 0.0 };

    /// From a surface's normal and the directions to source and observer: unit vectors, to rounding.
    #[inline]
    pub fn of_directions(normal: DVec3, to_source: DVec3, to_observer: DVec3) -> Self {
        let (cos_incidence, cos_emission) = (normal.dot(to_source), normal.dot(to_observer));
        let (across, along) = (to_source.cross(to_observer), to_source.dot(to_observer));
        PhotometricAngles {
            cos_incidence: above_horizon(cos_incidence),
            cos_emission: above_horizon(cos_emission),
            tan_half_phase: tan_half_of(across.length(), along),
            // Sine and cosine of the azimuth, both times sin i sin e.
            tan_half_azimuth: tan_half_of(normal.dot(across).abs(), along - cos_incidence * cos_emission),
        }
    }

    /// From incidence, emission and the azimuth between them, rad, each from 0 to pi.
    pub fn of_angles(incidence_rad: f64, emission_rad: f64, azimuth_rad: f64) -> Self {
        let haversine = |angle: f64| (0.5 * angle).sin().powi(2);
        let across = incidence_rad.sin() * emission_rad.sin();
        let phase = haversine(incidence_rad - emission_rad) + across * haversine(azimuth_rad);
        PhotometricAngles {
            cos_incidence: above_horizon(incidence_rad.cos()),
            cos_emission: above_horizon(emission_rad.cos()),
            tan_half_phase: tan_half(phase),
            tan_half_azimuth: if across > 0.0 { (0.5 * azimuth_rad).tan().abs() } else { 0.0 },
        }
    }

    /// From the cosines of incidence, emission and phase angle. If no directions have these, as may happen by rounding, the phase angle is moved to
    /// the nearest possible one.
    pub fn of_cosines(cos_incidence: f64, cos_emission: f64, cos_phase: f64) -> Self {
        let (mu0, mu) = (above_horizon(cos_incidence), above_horizon(cos_emission));
        let across = sine(mu0) * sine(mu);
        let level = 0.5 * (1.0 - (mu0 * mu + across));
        let phase = (0.5 * (1.0 - cos_phase)).max(level).min(level + across);
        PhotometricAngles {
            cos_incidence: mu0,
            cos_emission: mu,
            tan_half_phase: tan_half(phase),
            tan_half_azimuth: if across > 0.0 { tan_half((phase - level) / across) } else { 0.0 },
        }
    }

    /// The same with light and view exchanged.
    pub fn swapped(&self) -> Self {
        PhotometricAngles { cos_incidence: self.cos_emission, cos_emission: self.cos_incidence, ..*self }
    }

    /// Cosine of incidence mu0, from [`LEAST_COSINE`] to 1.
    pub fn cos_incidence(&self) -> f64 {
        self.cos_incidence
    }

    /// Cosine of emission mu, from [`LEAST_COSINE`] to 1.
    pub fn cos_emission(&self) -> f64 {
        self.cos_emission
    }

    /// Cosine of the phase angle, between the directions to source and observer.
    pub fn cos_phase(&self) -> f64 {
        1.0 - 2.0 * haversine_of_tan_half(self.tan_half_phase)
    }

    /// Phase angle, rad, 0 to pi.
    pub fn phase_rad(&self) -> f64 {
        2.0 * self.tan_half_phase.atan()
    }

    /// tan(g / 2), 0 to infinity.
    pub fn tan_half_phase(&self) -> f64 {
        self.tan_half_phase
    }

    /// Sine and cosine of half the phase angle, both from 0 to 1.
    pub fn half_phase_sin_cos(&self) -> (f64, f64) {
        (haversine_of_tan_half(self.tan_half_phase).sqrt(), haversine_of_tan_half(self.tan_half_phase.recip()).sqrt())
    }

    /// Azimuth of the view from that of the light, rad, 0 to pi.
    pub fn azimuth_rad(&self) -> f64 {
        2.0 * self.tan_half_azimuth.atan()
    }

    /// tan(psi / 2) of that azimuth, 0 to infinity.
    pub fn tan_half_azimuth(&self) -> f64 {
        self.tan_half_azimuth
    }

    /// sin^2(psi / 2) of that azimuth, 0 to 1.
    pub fn haversine_azimuth(&self) -> f64 {
        haversine_of_tan_half(self.tan_half_azimuth)
    }

    /// Sine of the angle whose cosine is one of incidence or emission.
    pub fn sine_of(cosine: f64) -> f64 {
        sine(cosine)
    }
}

fn above_horizon(cosine: f64) -> f64 {
    cosine.clamp(LEAST_COSINE, 1.0)
}

fn sine(cosine: f64) -> f64 {
    ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt()
}

/// tan(x / 2) of sin^2(x / 2), which rounding may have moved out of 0 to 1.
fn tan_half(haversine: f64) -> f64 {
    let haversine = haversine.clamp(0.0, 1.0);
    (haversine / (1.0 - haversine)).sqrt()
}

/// sin^2(x / 2) of tan(x / 2), both ends included.
fn haversine_of_tan_half(tan_half: f64) -> f64 {
    1.0 / (1.0 + (tan_half * tan_half).recip())
}

/// tan(x / 2) from the sine (not negative) and the cosine of x, both scaled by the same number; 0 if that number is 0.
#[inline]
fn tan_half_of(sine: f64, cosine: f64) -> f64 {
    let both = (sine * sine + cosine * cosine).sqrt();
    if both == 0.0 {
        0.0
    } else if cosine >= 0.0 {
        sine / (both + cosine)
    } else {
        (both - cosine) / sine
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn direction(zenith_rad: f64, azimuth_rad: f64) -> DVec3 {
        let ((s, c), (sa, ca)) = (zenith_rad.sin_cos(), azimuth_rad.sin_cos());
        DVec3::new(s * ca, s * sa, c)
    }

    #[test]
    fn three_ways_to_the_same_angles() {
        for (i_deg, e_deg, psi_deg) in [
            (0.0, 0.0, 0.0),
            (30.0, 0.0, 0.0),
            (60.0, 40.0, 90.0),
            (80.0, 75.0, 170.0),
            (45.0, 45.0, 1.0),
            (89.0, 89.0, 180.0),
        ] {
            let [i, e, psi] = [i_deg, e_deg, psi_deg].map(|deg: f64| deg.to_radians());
            let cos_g = i.cos() * e.cos() + i.sin() * e.sin() * psi.cos();
            let by_angles = PhotometricAngles::of_angles(i, e, psi);
            let by_directions = PhotometricAngles::of_directions(DVec3::Z, direction(i, 0.3), direction(e, 0.3 - psi));
            let by_cosines = PhotometricAngles::of_cosines(i.cos(), e.cos(), cos_g);
            for (angles, tolerance) in [(by_angles, 1e-15), (by_directions, 1e-14), (by_cosines, 1e-7)] {
                assert!((angles.cos_incidence() - i.cos()).abs() < 1e-15);
                assert!((angles.cos_emission() - e.cos()).abs() < 1e-15);
                assert!((angles.phase_rad() - cos_g.clamp(-1.0, 1.0).acos()).abs() < 3e-8);
                assert!((angles.cos_phase() - cos_g).abs() < 1e-15);
                assert!((angles.azimuth_rad() - psi).abs() < tolerance * 100.0, "{angles:?} {psi}");
            }
        }
    }

    #[test]
    fn ends_lose_no_digits() {
        // A phase of 1e-9 rad, which the cosine cannot hold.
        let angles = PhotometricAngles::of_angles(0.5, 0.5 + 1e-9, 0.0);
        assert!((angles.phase_rad() / 1e-9 - 1.0).abs() < 1e-6);
        let angles = PhotometricAngles::of_directions(DVec3::Z, direction(0.5, 0.0), direction(0.5 + 1e-9, 0.0));
        assert!((angles.phase_rad() / 1e-9 - 1.0).abs() < 1e-6);
        // Opposite directions, one and the same direction, and such as are neither by rounding.
        let x = PhotometricAngles::of_directions(DVec3::Z, DVec3::X, DVec3::NEG_X);
        assert_eq!((x.phase_rad(), x.azimuth_rad(), x.cos_phase()), (PI, PI, -1.0));
        assert_eq!(x.half_phase_sin_cos(), (1.0, 0.0));
        let same = PhotometricAngles::of_directions(DVec3::Z, DVec3::Z, DVec3::Z);
        assert_eq!(same, PhotometricAngles::ZENITH);
        let beyond = PhotometricAngles::of_cosines(1.0 + 1e-15, 1.0 + 1e-15, 1.0 + 1e-15);
        assert_eq!(beyond, PhotometricAngles::ZENITH);
        let opposite = PhotometricAngles::of_cosines(-1e-17, 1e-17, -1.0 - 1e-15);
        assert_eq!(opposite.cos_incidence(), LEAST_COSINE);
        assert!((opposite.phase_rad() - PI).abs() < 1e-5 && (opposite.azimuth_rad() - PI).abs() < 1e-5);
        // A phase angle smaller than the difference of incidence and emission: none has it.
        assert!((PhotometricAngles::of_cosines(1.0, 0.5, 1.0).phase_rad() - PI / 3.0).abs() < 1e-15);
    }

    #[test]
    fn behind_the_horizon_is_at_it() {
        let angles = PhotometricAngles::of_angles(0.3, FRAC_PI_2 + 0.2, 1.0);
        assert_eq!(angles.cos_emission(), LEAST_COSINE);
        assert_eq!(angles.swapped().cos_incidence(), LEAST_COSINE);
        assert_eq!(angles.swapped().swapped(), angles);
    }
}
