//! A unit vector.

use glam::{DQuat, DVec3};

/// A direction in space: a unit vector that cannot be zero or NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction(DVec3);

impl Direction {
    /// Along z.
    pub const Z: Direction = Direction(DVec3::Z);

    /// The direction of `v`; `None` if `v` is zero, infinite or NaN.
    ///
    /// The largest component is divided out first, so neither 1e200 m nor 1e-200 m overflow.
    pub fn new(v: DVec3) -> Option<Self> {
        let largest = v.abs().max_element();
        if !(largest > 0.0 && v.is_finite()) {
            return None;
        }
        let scaled = v / largest;
        Some(Direction(scaled / scaled.length()))
    }

    /// `v` itself, bit for bit, as read back from a file; `None` unless its length is 1 to rounding.
    pub fn from_unit(v: DVec3) -> Option<Self> {
        ((v.length_squared() - 1.0).abs() <= 8.0 * f64::EPSILON).then_some(Direction(v))
    }

    /// The unit vector.
    pub fn vec(self) -> DVec3 {
        self.0
    }

    /// The opposite direction.
    #[must_use]
    pub fn reversed(self) -> Self {
        Direction(-self.0)
    }

    /// Angle to another direction, rad, by `atan2(|a x b|, a.b)`: exact to rounding near 0 and pi, where `acos` is not.
    pub fn angle_rad(self, other: Direction) -> f64 {
        angle_rad(self.0, other.0)
    }

    /// Two unit vectors that make a right-handed frame (h, v, self) with this one.
    pub fn frame(self) -> (DVec3, DVec3) {
        let w = self.0;
        let helper = if w.x.abs() <= w.y.abs() && w.x.abs() <= w.z.abs() {
            DVec3::X
        } else if w.y.abs() <= w.z.abs() {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let h = helper.cross(w);
        let h = h / h.length();
        (h, w.cross(h))
    }
}

/// Angle between two vectors of any length, rad, to a few units in the last place everywhere.
///
/// Away from 0 and pi by the arc cosine, which is well conditioned there and costs half as much; near them, where it loses
/// half its digits, by `atan2(|a x b|, a.b)`.
pub fn angle_rad(a: DVec3, b: DVec3) -> f64 {
    let dot = a.dot(b);
    let cos = dot / (a.length_squared() * b.length_squared()).sqrt();
    if cos.abs() < 0.9 { cos.acos() } else { a.cross(b).length().atan2(dot) }
}

/// Angle of the turn from one rotation to another, rad, to the last digits also of a small one. q and -q are the same rotation.
pub fn turn_rad(a: DQuat, b: DQuat) -> f64 {
    let turn = a.inverse() * b;
    2.0 * turn.xyz().length().atan2(turn.w.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_measured_the_short_way_and_when_it_is_small() {
        let from = DQuat::from_rotation_x(0.3);
        for angle in [0.0, 1e-9, 1.0, 3.0] {
            let to = from * DQuat::from_rotation_y(angle);
            assert!((turn_rad(from, to) - angle).abs() <= 1e-15 * (1.0 + angle), "{angle}");
            assert!((turn_rad(from, -to) - angle).abs() <= 1e-15 * (1.0 + angle), "{angle}");
        }
    }

    #[test]
    fn refuses_what_has_no_direction() {
        assert!(Direction::new(DVec3::ZERO).is_none());
        assert!(Direction::new(DVec3::new(f64::NAN, 0.0, 1.0)).is_none());
        assert!(Direction::new(DVec3::new(f64::INFINITY, 0.0, 1.0)).is_none());
        let huge = Direction::new(DVec3::new(3e200, 0.0, 4e200)).unwrap().vec();
        assert!((huge - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-15);
    }

    #[test]
    fn unit_vectors_are_taken_as_they_are() {
        let v = Direction::new(DVec3::new(1.0, 2.0, -3.0)).unwrap();
        assert_eq!(Direction::from_unit(v.vec()), Some(v));
        assert!(Direction::from_unit(DVec3::new(1.0, 1e-6, 0.0)).is_none());
        assert!(Direction::from_unit(DVec3::NAN).is_none());
    }

    #[test]
    fn frame_is_right_handed() {
        for v in [DVec3::X, DVec3::NEG_Z, DVec3::new(1.0, 2.0, -3.0), DVec3::new(1.0, 1.0, 1.0)] {
            let w = Direction::new(v).unwrap();
            let (h, v) = w.frame();
            assert!((h.cross(v) - w.vec()).length() < 1e-15);
            assert!((h.length() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn small_angles_keep_their_digits() {
        let a = Direction::new(DVec3::X).unwrap();
        let b = Direction::new(DVec3::new(1.0, 1e-9, 0.0)).unwrap();
        assert!((a.angle_rad(b) / 1e-9 - 1.0).abs() < 1e-12);
    }
}
