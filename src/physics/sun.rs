//! The Sun as a source.

use std::f64::consts::PI;

use crate::units::{AU_M, LIGHT_SPEED_M_S, SUN_RADIUS_M};

/// Irradiance normal to the beam at a distance, in the unit of `irradiance_1au`: E (1 au / d)^2.
///
/// Source: equation (5) of Domagala (2020). Limits: far outside the Sun; d is Sun to surface, not Sun to planet.
pub fn irradiance_at(irradiance_1au: f64, distance_m: f64) -> f64 {
    irradiance_1au * (AU_M / distance_m).powi(2)
}

/// Irradiance on a surface, in the unit of the beam's: E_S max(0, cos i).
///
/// Source: equation (3) of Domagala (2020), with the night side added.
/// Limits: a point Sun; its disc matters within [`angular_radius_rad`] of the terminator, by at most 2 s / (3 pi) E_S.
pub fn irradiance_on_facet(irradiance_normal: f64, cos_incidence: f64) -> f64 {
    irradiance_normal * cos_incidence.max(0.0)
}

/// Angular radius of the Sun's disc, rad: asin(R / d), R the nominal solar radius (IAU 2015).
pub fn angular_radius_rad(distance_m: f64) -> f64 {
    (SUN_RADIUS_M / distance_m).asin()
}

/// Solid angle of the Sun's disc, sr: 2 pi (1 - cos s) = 4 pi sin^2(s / 2), the second without cancellation.
pub fn solid_angle_sr(distance_m: f64) -> f64 {
    4.0 * PI * (0.5 * angular_radius_rad(distance_m)).sin().powi(2)
}

/// Time that light takes over a distance, s.
pub fn light_time_s(distance_m: f64) -> f64 {
    distance_m / LIGHT_SPEED_M_S
}

/// How much of the Sun another body hides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Eclipse {
    /// Nothing.
    None,
    /// Part of its disc.
    Partial,
    /// All of it.
    Total,
}

/// Whether a larger disc hides the Sun: partly from a separation alpha + s on, wholly from alpha - s on.
///
/// Limits: a body without air, and alpha >= s.
pub fn eclipse(separation_rad: f64, disc_radius_rad: f64, sun_radius_rad: f64) -> Eclipse {
    if separation_rad <= disc_radius_rad - sun_radius_rad {
        Eclipse::Total
    } else if separation_rad < disc_radius_rad + sun_radius_rad {
        Eclipse::Partial
    } else {
        Eclipse::None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mars_eclipses_the_sun_within_its_disc() {
        // Seen from Phobos, 9376 km from Mars, once around in 27553.84 s: 3217.366 s of darkness, and before and after it
        // 26.769 s of partial eclipse (computed independently).
        let (alpha, s) = ((3389.5_f64 / 9376.0).asin(), angular_radius_rad(1.523_679 * AU_M));
        let at = |from_middle_s: f64| eclipse(2.0 * PI / 27_553.843_872 * from_middle_s, alpha, s);
        assert_eq!([0.0, 1608.6].map(at), [Eclipse::Total; 2]);
        assert_eq!([1608.8, 1635.4].map(at), [Eclipse::Partial; 2]);
        assert_eq!([1635.5, 9000.0].map(at), [Eclipse::None; 2]);
    }

    // Values at 1.666 au and 1.523679 au: computed independently in mpmath with R = 6.957e8 m.
    #[test]
    fn the_sun_at_mars() {
        assert!((irradiance_at(1361.0, 1.666 * AU_M) / 490.352_203_306_292_5 - 1.0).abs() < 1e-14);
        assert!((light_time_s(1.666 * AU_M) / 831.341_969_871_036_6 - 1.0).abs() < 1e-14);
        let d_m = 1.523_679 * AU_M;
        assert!((angular_radius_rad(d_m) / 0.003_052_135_312_773_355_5 - 1.0).abs() < 1e-14);
        assert!((solid_angle_sr(d_m) / 2.926_557_779_141_696_4e-5 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_night_side_is_dark() {
        assert_eq!(irradiance_on_facet(600.0, -0.5), 0.0);
        assert_eq!(irradiance_on_facet(600.0, 0.5), 300.0);
    }
}
