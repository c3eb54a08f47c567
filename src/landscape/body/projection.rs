//! The map of a site: directions from a point below it.

use glam::{DVec2, DVec3};

/// Lambert's azimuthal equal-area projection of directions from a centre.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Projection {
    /// Where directions start, m.
    pub(super) centre_m: DVec3,
    /// Radius of the sphere whose areas it keeps, m.
    pub(super) radius_m: f64,
    pub(super) up: DVec3,
    east: DVec3,
    north: DVec3,
}

/// A direction, and how it changes with the place, 1/m.
#[derive(Debug, Clone, Copy)]
pub(super) struct Aim {
    pub(super) direction: DVec3,
    pub(super) by_x: DVec3,
    pub(super) by_y: DVec3,
}

impl Projection {
    /// Around the upright through a point of the ground, from a centre so deep below it. `axes` are the site's east and north.
    pub(super) fn new(ground_m: DVec3, up: DVec3, radius_m: f64, [east, north]: [DVec3; 2]) -> Self {
        Projection { centre_m: ground_m - radius_m * up, radius_m, up, east, north }
    }

    /// The angle from the upright of places so far from the middle, rad; none beyond the opposite point.
    pub(super) fn angle(&self, rho_m: f64) -> Option<f64> {
        let half = rho_m / (2.0 * self.radius_m);
        (half <= 1.0).then(|| 2.0 * half.asin())
    }

    /// The direction of a place: unit vector.
    pub(super) fn direction(&self, x_m: f64, y_m: f64) -> DVec3 {
        self.aim(x_m, y_m).direction
    }

    /// With q = rho^2 / R^2: d = sqrt(1 - q / 4) (x, y) / R + (1 - q / 2) up, which needs no angle.
    pub(super) fn aim(&self, x_m: f64, y_m: f64) -> Aim {
        let r = self.radius_m;
        let q = (x_m * x_m + y_m * y_m) / (r * r);
        let root = (1.0 - 0.25 * q).max(0.0).sqrt();
        let flat = x_m * self.east + y_m * self.north;
        let direction = root / r * flat + (1.0 - 0.5 * q) * self.up;
        // d root / dx = -x / (4 R^2 root); d q / dx = 2 x / R^2.
        let by = |p_m: f64, axis: DVec3| {
            let slope = if root > 0.0 { -p_m / (4.0 * r * r * root) } else { 0.0 };
            slope / r * flat + root / r * axis - p_m / (r * r) * self.up
        };
        Aim { direction, by_x: by(x_m, self.east), by_y: by(y_m, self.north) }
    }

    /// The place of a point, m, and its distance from the centre, m; none opposite to the upright.
    pub(super) fn place(&self, point_m: DVec3) -> Option<(DVec2, f64)> {
        let from_m = point_m - self.centre_m;
        let distance_m = from_m.length();
        let direction = from_m / distance_m;
        // rho = 2 R sin(angle / 2), and sin(angle) = 2 sin(angle / 2) cos(angle / 2).
        let half = (0.5 * (1.0 + direction.dot(self.up))).sqrt();
        (half > 1e-6).then(|| {
            let scale = self.radius_m / half;
            (DVec2::new(direction.dot(self.east), direction.dot(self.north)) * scale, distance_m)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn projection() -> Projection {
        Projection::new(DVec3::new(0.0, 0.0, 7.0), DVec3::Z, 5.0, [DVec3::X, DVec3::Y])
    }

    #[test]
    fn places_and_points_go_there_and_back() {
        let projection = projection();
        assert_eq!(projection.centre_m, DVec3::new(0.0, 0.0, 2.0));
        for (x_m, y_m) in [(0.0, 0.0), (1.0, -2.0), (-6.0, 3.0), (7.0, 7.0)] {
            let aim = projection.aim(x_m, y_m);
            assert!((aim.direction.length() - 1.0).abs() < 1e-14);
            let (place, distance_m) = projection.place(projection.centre_m + 3.0 * aim.direction).unwrap();
            assert!((place - DVec2::new(x_m, y_m)).length() < 1e-12 && (distance_m - 3.0).abs() < 1e-14);
            // Area is kept: the two tangents span 1 / R^2.
            assert!((aim.by_x.cross(aim.by_y).length() * 25.0 - 1.0).abs() < 1e-13, "{x_m} {y_m}");
            let h = 1e-5;
            let slope = (projection.direction(x_m + h, y_m) - projection.direction(x_m - h, y_m)) / (2.0 * h);
            assert!((slope - aim.by_x).length() < 1e-9);
        }
        // A quarter around: 2 R sin 45 deg.
        let (place, _) = projection.place(DVec3::new(4.0, 0.0, 2.0)).unwrap();
        assert!((place.x - 5.0 * 2f64.sqrt()).abs() < 1e-12);
        assert!((projection.angle(place.x).unwrap() - std::f64::consts::FRAC_PI_2).abs() < 1e-14);
        assert_eq!((projection.angle(10.1), projection.place(DVec3::new(0.0, 0.0, -2.0))), (None, None));
    }
}
