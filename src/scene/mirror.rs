//! The scan mirror of a whisk-broom: it sweeps one detector element, or a column of them, across the track.

use glam::DMat3;

use crate::geometry::Pose;

/// A scan at constant rate, centred on the boresight in the middle of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    /// Samples of a sweep.
    pub samples: u32,
    /// Time per sample, s.
    pub sample_s: f64,
    /// Scan step per sample, rad, from +Z towards +X of the sensor, about its Y.
    pub step_rad: f64,
    /// Elements in the column, along the sensor's Y: image lines per sweep.
    pub elements: u32,
}

impl Mirror {
    /// Scan angle at a fractional sample coordinate, counted from the first sample's outer border, rad.
    pub fn angle_rad(&self, sample: f64) -> f64 {
        (sample - 0.5 * f64::from(self.samples)) * self.step_rad
    }

    /// Time of a sample's middle, s after the middle of the first.
    pub fn since_s(&self, sample: f64) -> f64 {
        (sample - 0.5) * self.sample_s
    }

    /// Splits a running sample number into sweep and sample.
    pub fn place(&self, i: usize) -> (usize, usize) {
        let samples = self.samples.max(1) as usize;
        (i / samples, i % samples)
    }

    /// The sensor's pose as seen via the mirror at this angle.
    pub fn turned(pose: Pose, angle_rad: f64) -> Pose {
        Pose { rotation: pose.rotation * DMat3::from_rotation_y(angle_rad), ..pose }
    }
}
