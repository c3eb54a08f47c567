//! A rigid placement: rotation and translation, always named `a_from_b`.

use glam::{DMat3, DVec3};

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
