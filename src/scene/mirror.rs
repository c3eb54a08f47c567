//! The mirror of a whisk-broom: it sweeps one detector element, or a column of them, across the way of the carrier.

use glam::DMat3;

use crate::geometry::Pose;

/// How a mirror sweeps: its angle grows evenly with time, about the boresight, which is in the middle of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    /// Samples of a sweep.
    pub samples: u32,
    /// From one sample to the next, s.
    pub sample_s: f64,
    /// By so much the line of sight turns meanwhile, rad: from +Z to +X of the sensor, about its Y.
    pub step_rad: f64,
    /// Elements in the column, along the sensor's Y: lines of the image that a sweep gives.
    pub elements: u32,
}

impl Mirror {
    /// Where the line of sight stands when it is in the middle of a sample (not a whole number between samples), counted from the first one's outer border, rad.
    pub fn angle_rad(&self, sample: f64) -> f64 {
        (sample - 0.5 * f64::from(self.samples)) * self.step_rad
    }

    /// When the middle of a sample is taken, s after the middle of the first.
    pub fn since_s(&self, sample: f64) -> f64 {
        (sample - 0.5) * self.sample_s
    }

    /// The sweep, and the sample in it, of a number that counts all samples.
    pub fn place(&self, i: usize) -> (usize, usize) {
        let samples = self.samples.max(1) as usize;
        (i / samples, i % samples)
    }

    /// The pose of what looks over the mirror at this angle, of the sensor's.
    pub fn turned(pose: Pose, angle_rad: f64) -> Pose {
        Pose { rotation: pose.rotation * DMat3::from_rotation_y(angle_rad), ..pose }
    }
}
