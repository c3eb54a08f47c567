//! A rigid placement: rotation and translation, always named `a_from_b`.

use glam::{DMat3, DVec3};

use super::Direction;

/// Carries points of one frame into another: p_a = rotation p_b + translation.
///
/// A value is named `a_from_b`, so that neighbours cancel: `world_from_site * site_from_mesh`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Rotation; columns are the axes of b seen in a.
    pub rotation: DMat3,
    /// Origin of b in a, m.
    pub translation_m: DVec3,
}

/// The axes of a site at this place in the body-fixed frame, as columns: x east, y north, z along the outward radius. At a pole, where no
/// direction is east, x is where it is all along the meridian of longitude 0: +y of the body. `None` at the body's centre.
pub fn body_from_site(origin_m: DVec3) -> Option<DMat3> {
    let up = Direction::new(origin_m)?;
    let east = Direction::new(DVec3::Z.cross(origin_m)).or_else(|| Direction::new(DVec3::Y))?;
    let (up, east) = (up.vec(), east.vec());
    Some(DMat3::from_cols(east, up.cross(east), up))
}

impl Pose {
    /// The placement that changes nothing.
    pub const IDENTITY: Pose = Pose { rotation: DMat3::IDENTITY, translation_m: DVec3::ZERO };

    /// A point, m.
    pub fn point(&self, p_m: DVec3) -> DVec3 {
        self.rotation * p_m + self.translation_m
    }

    /// A vector: rotated, not moved.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.rotation * v
    }

    /// `b_from_a`.
    #[must_use]
    pub fn inverse(&self) -> Pose {
        let rotation = self.rotation.transpose();
        Pose { rotation, translation_m: -(rotation * self.translation_m) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_site_has_its_zenith_up() {
        // On the equator at longitude 90 deg: east is -x, north z, the zenith y.
        let axes = body_from_site(DVec3::new(0.0, 2.0, 0.0)).unwrap();
        assert_eq!(axes, DMat3::from_cols(DVec3::NEG_X, DVec3::Z, DVec3::Y));
        // At the north pole, by the meridian of longitude 0: east is y, north -x.
        let axes = body_from_site(DVec3::new(0.0, 0.0, 5.0)).unwrap();
        assert_eq!(axes, DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z));
        assert_eq!(body_from_site(DVec3::ZERO), None);
    }
}
