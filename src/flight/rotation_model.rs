//! A body's rotation by its pole and prime meridian, as the IAU's working group gives it.

use glam::DMat3;

use super::Epoch;
use crate::geometry::polynomial;

/// Pole right ascension and declination, and prime meridian: each a polynomial plus sines or cosines of periodic
/// angles.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RotationModel {
    /// Of the pole: deg, deg per century, deg per century^2.
    pub right_ascension: Angle,
    /// Of the pole, as before; its periodic terms are cosines.
    pub declination: Angle,
    /// Of the prime meridian: deg, deg per day, deg per day^2.
    pub prime_meridian: Angle,
    /// The angles of periodic terms: deg, deg per century, deg per century^2 and so on.
    pub phases: Vec<Vec<f64>>,
}

/// An angle over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Angle {
    /// Coefficients of a polynomial.
    pub polynomial: Vec<f64>,
    /// Amplitudes of periodic terms, deg, for the first of the phases on.
    pub periodic: Vec<f64>,
}

/// Rotations about z, x and z again: R3(third) R1(second) R3(first), which carry components along fixed axes into components along
/// turned ones.
pub(super) fn euler_313(first_rad: f64, second_rad: f64, third_rad: f64) -> DMat3 {
    // `from_rotation` turns vectors; axes turn the other way.
    DMat3::from_rotation_z(-third_rad) * DMat3::from_rotation_x(-second_rad) * DMat3::from_rotation_z(-first_rad)
}

impl RotationModel {
    /// Right ascension and declination of the pole, and prime meridian, deg.
    pub fn angles_deg(&self, epoch: Epoch) -> [f64; 3] {
        let (centuries, days) = (epoch.centuries(), epoch.days());
        let phases: Vec<f64> = self.phases.iter().map(|of| polynomial(of, centuries).to_radians()).collect();
        let periodic = |angle: &Angle, wave: fn(f64) -> f64| -> f64 {
            angle.periodic.iter().zip(&phases).map(|(amplitude, phase)| amplitude * wave(*phase)).sum()
        };
        [
            polynomial(&self.right_ascension.polynomial, centuries) + periodic(&self.right_ascension, f64::sin),
            polynomial(&self.declination.polynomial, centuries) + periodic(&self.declination, f64::cos),
            polynomial(&self.prime_meridian.polynomial, days) + periodic(&self.prime_meridian, f64::sin),
        ]
    }

    /// The rotation that carries components along inertial axes (J2000) into components along the body's.
    pub fn fixed_from_inertial(&self, epoch: Epoch) -> DMat3 {
        let [right_ascension, declination, meridian] = self.angles_deg(epoch);
        // Whole turns are removed in degrees, where that is exact.
        euler_313(
            (right_ascension + 90.0).to_radians(),
            (90.0 - declination).to_radians(),
            (meridian % 360.0).to_radians(),
        )
    }
}
