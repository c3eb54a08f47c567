//! An ellipsoid with three axes.

use glam::DVec3;

/// An ellipsoid, its axes along those of the body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ellipsoid {
    pub(super) axes_m: DVec3,
    pub(super) middle_m: DVec3,
}

impl Ellipsoid {
    pub(super) fn new(axes_m: [f64; 3], middle_m: DVec3) -> Self {
        Ellipsoid { axes_m: DVec3::from_array(axes_m), middle_m }
    }

    /// Where a ray from a point within it leaves it, m, and the outward unit normal there; none from a point outside.
    pub(super) fn hit(&self, from_m: DVec3, direction: DVec3) -> Option<(DVec3, DVec3)> {
        // In units of the axes it is the unit sphere: |o + t d| = 1.
        let (o, d) = ((from_m - self.middle_m) / self.axes_m, direction / self.axes_m);
        let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - 1.0);
        // Of NaN neither holds.
        let (is_within, goes_somewhere) = (c < 0.0, a > 0.0);
        if !is_within || !goes_somewhere {
            return None;
        }
        // The root of which no digits cancel: c < 0.
        let root = (b * b - a * c).sqrt();
        let t = if b > 0.0 { -c / (b + root) } else { (root - b) / a };
        let point_m = from_m + t * direction;
        let normal = ((point_m - self.middle_m) / (self.axes_m * self.axes_m)).normalize();
        Some((point_m, normal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_the_surface_and_its_normal() {
        let ellipsoid = Ellipsoid::new([12_950.0, 11_300.0, 9160.0], DVec3::new(10.0, -20.0, 30.0));
        for (from, towards) in [
            ([0.0; 3], [1.0, 0.0, 0.0]),
            ([500.0, -900.0, 200.0], [-0.3, 0.9, 0.2]),
            ([10.0, -20.0, 30.0], [0.0, 0.0, -1.0]),
        ] {
            let (from, towards) = (DVec3::from_array(from), DVec3::from_array(towards).normalize());
            let (p, n) = ellipsoid.hit(from, towards).unwrap();
            let q = p - ellipsoid.middle_m;
            let level = (q.x / 12_950.0).powi(2) + (q.y / 11_300.0).powi(2) + (q.z / 9160.0).powi(2);
            assert!((level - 1.0).abs() < 1e-14);
            let gradient = DVec3::new(q.x / 12_950f64.powi(2), q.y / 11_300f64.powi(2), q.z / 9160f64.powi(2));
            assert!((n - gradient.normalize()).length() < 1e-14 && (p - from).normalize().dot(towards) > 1.0 - 1e-14);
        }
        assert_eq!(ellipsoid.hit(DVec3::new(13_000.0, 0.0, 0.0), DVec3::X), None);
        assert_eq!(ellipsoid.hit(DVec3::ZERO, DVec3::ZERO), None);
    }
}
