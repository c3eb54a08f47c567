//! Sizes of bodies.

use glam::DVec3;

use crate::units::KM_M;

/// Semi-axes towards longitude 0, longitude 90 deg and the north pole, km: NAIF's kernel pck00011, from Archinal et al.
/// (2018).
const RADII_KM: [(&str, [f64; 3]); 3] =
    [("PHOBOS", [13.0, 11.4, 9.1]), ("DEIMOS", [7.8, 6.0, 5.1]), ("MARS", [3396.19, 3396.19, 3376.20])];

/// Semi-axes of a body's ellipsoid, along its fixed axes, m; `None` if unknown here.
pub fn radii_m(body: &str) -> Option<DVec3> {
    let (_, km) = RADII_KM.iter().find(|(name, _)| *name == body)?;
    Some(DVec3::from_array(*km) * KM_M)
}

/// Height of a point above an ellipsoid, along the line to its centre, m; not finite at the centre.
pub fn altitude_m(position_m: DVec3, radii_m: DVec3) -> f64 {
    position_m.length() * (1.0 - (position_m / radii_m).length().recip())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_counted_from_the_ellipsoid() {
        let radii_m = radii_m("PHOBOS").unwrap();
        for (axis, radius_m) in DVec3::AXES.into_iter().zip([13_000.0, 11_400.0, 9_100.0]) {
            for height_m in [-50.0, 0.0, 20_000.0] {
                let got = altitude_m(-axis * (radius_m + height_m), radii_m);
                assert!((got - height_m).abs() < 1e-10 * radius_m, "{got} m along {axis}");
            }
        }
        assert_eq!(super::radii_m("MMX"), None);
    }
}
