//! How much of the sky a triangle fills.

use glam::DVec3;

/// Solid angle of a triangle seen from the origin, sr: positive if the origin is behind it (its normal points away).
///
/// tan(Omega / 2) = a.(b x c) / (abc + (a.b) c + (a.c) b + (b.c) a). Over a closed, outward mesh the sum is 4 pi inside and
/// 0 outside. Source: Van Oosterom & Strackee (1983), IEEE Trans. Biomed. Eng. 30, 125. Limits: 0 in the triangle's plane.
pub fn signed_solid_angle_sr(corners: [DVec3; 3]) -> f64 {
    let (sine, cosine, _) = half_angle(corners);
    2.0 * sine.atan2(cosine)
}

/// The same, unless the origin lies on the triangle or so near it that rounding decides on which side.
///
/// Corners are taken to be known to the last bit of their distance, which is what differences and projections of them are.
pub fn solid_angle_off_surface_sr(corners: [DVec3; 3]) -> Option<f64> {
    let (sine, cosine, size) = half_angle(corners);
    let rounding = 16.0 * f64::EPSILON * size;
    let on_surface = sine.abs() <= rounding && cosine <= 4.0 * rounding;
    (!on_surface).then(|| 2.0 * sine.atan2(cosine))
}

/// Sine and cosine of half the solid angle, times a positive number, and the size of the products that they are sums of.
fn half_angle([a, b, c]: [DVec3; 3]) -> (f64, f64, f64) {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    let size = la * lb * lc;
    (volume, size + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la, size)
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

    #[test]
    fn on_the_surface_there_is_no_solid_angle() {
        let triangle = [DVec3::X, DVec3::Y, -DVec3::X - DVec3::Y];
        let seen_from = |p: DVec3| solid_angle_off_surface_sr(triangle.map(|corner| corner - p));
        let middle = DVec3::new(0.5, 0.5, 0.0);
        for on in [DVec3::ZERO, middle, DVec3::X, 1e-16 * DVec3::Z, middle + 1e-16 * DVec3::X] {
            assert_eq!(seen_from(on), None, "{on}");
        }
        // Half the sky from just above it, none of it from beside it in its plane.
        for side in [1.0, -1.0] {
            let omega = seen_from(side * 1e-12 * DVec3::Z).unwrap();
            assert!((omega + side * 2.0 * PI).abs() < 1e-10, "{omega}");
        }
        assert_eq!(seen_from(DVec3::X * 2.0), Some(0.0));
    }
}
