//! How much of the sky a triangle fills.

use glam::DVec3;

/// Solid angle of a triangle seen from the origin, sr: positive if the origin is behind it (its normal points away).
///
/// tan(Omega / 2) = a.(b x c) / (abc + (a.b) c + (a.c) b + (b.c) a). Over a closed, outward mesh the sum is 4 pi inside and
/// 0 outside. Source: Van Oosterom & Strackee (1983), IEEE Trans. Biomed. Eng. 30, 125. Limits: 0 in the triangle's plane.
pub fn signed_solid_angle_sr([a, b, c]: [DVec3; 3]) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    2.0 * volume.atan2(la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn an_octant_is_an_eighth_of_the_sphere() {
        let octant = [DVec3::X, DVec3::Y, DVec3::Z];
        assert!((signed_solid_angle_sr(octant) - PI / 2.0).abs() < 1e-15);
        assert!((signed_solid_angle_sr([DVec3::X, DVec3::Z, DVec3::Y]) + PI / 2.0).abs() < 1e-15);
    }

    #[test]
    fn a_small_triangle_is_its_area_over_the_squared_distance() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 1000.0);
        let omega = signed_solid_angle_sr([at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)]);
        assert!((omega / 0.5e-6 - 1.0).abs() < 1e-6, "{omega}");
    }

    #[test]
    fn a_triangle_is_nothing_from_its_own_plane_and_corners() {
        let triangle = [DVec3::X, DVec3::Y, -DVec3::Y - 2.0 * DVec3::X];
        assert_eq!(signed_solid_angle_sr(triangle.map(|p| p + 9.0 * DVec3::X)), 0.0);
        assert_eq!(signed_solid_angle_sr([DVec3::ZERO, DVec3::Y, DVec3::X]), 0.0);
    }
}
