//! The thesis's way to see a scene from the Sun: as by a camera at its position, in coordinates divided by depth.
//!
//! It is here to show where it breaks: shadows of the product are found along parallel rays.

use glam::DVec3;

/// Digits of a computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// 24 bits.
    Single,
    /// 53 bits.
    Double,
}

impl Precision {
    /// The nearest number of this precision: applied after each operation, it makes what arithmetic in that precision makes.
    #[inline]
    pub fn round(self, x: f64) -> f64 {
        match self {
            #[expect(clippy::cast_possible_truncation, reason = "rounding is the point")]
            Precision::Single => f64::from(x as f32),
            Precision::Double => x,
        }
    }

    /// [`round`](Precision::round) of each coordinate.
    pub fn round_each(self, v: DVec3) -> DVec3 {
        DVec3::from_array(v.to_array().map(|x| self.round(x)))
    }

    fn dot(self, a: DVec3, b: DVec3) -> f64 {
        let r = |x| self.round(x);
        r(r(r(a.x * b.x) + r(a.y * b.y)) + r(a.z * b.z))
    }
}

/// A camera at the Sun, in the frame of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunCamera {
    /// Projection centre O, m.
    pub centre_m: DVec3,
    /// Axes h, v, u: right, down, boresight.
    pub axes: [DVec3; 3],
    /// Digits of all that follows.
    pub precision: Precision,
}

impl SunCamera {
    /// A camera at `sun_m` that looks at `target_m`; `None` if it is there.
    pub fn new(sun_m: DVec3, target_m: DVec3, precision: Precision) -> Option<Self> {
        let u = crate::geometry::Direction::new(target_m - sun_m)?;
        let (h, v) = u.frame();
        let axes = [h, v, u.vec()].map(|axis| precision.round_each(axis));
        Some(SunCamera { centre_m: precision.round_each(sun_m), axes, precision })
    }

    /// 2D + depth coordinates of a point: X and Y (tangents) and Z, m. Equations (17) to (19) of Domagala (2020).
    pub fn project(&self, point_m: DVec3) -> [f64; 3] {
        let p = self.precision;
        let away = p.round_each(p.round_each(point_m) - self.centre_m);
        let [h, v, u] = self.axes.map(|axis| p.dot(away, axis));
        [p.round(h / u), p.round(v / u), u]
    }

    /// The point of such coordinates, m. Equation (22): from the mesh's origin C, in the same coordinates.
    pub fn point_m(&self, [x, y, z]: [f64; 3]) -> DVec3 {
        let p = self.precision;
        let r = |x| p.round(x);
        let [c_h, c_v, c_u] = self.project(DVec3::ZERO);
        let parts = [r(r(x * z) - r(c_h * c_u)), r(r(y * z) - r(c_v * c_u)), r(z - c_u)];
        let along = |k: usize| {
            let [h, v, u] = self.axes.map(|axis| axis[k]);
            r(r(r(parts[0] * h) + r(parts[1] * v)) + r(parts[2] * u))
        };
        DVec3::new(along(0), along(1), along(2))
    }
}
