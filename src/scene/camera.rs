//! The camera that looks at the surface.

use std::ops::Range;

use glam::DVec3;

use crate::geometry::Pose;

/// Farther from the image than this, in sizes of the image, no boresight is taken for meant: beyond, digits of pixels are lost.
const FARTHEST: f64 = 1e6;
/// Smaller pixels, rad, are refused: coordinates of 16 digits would be off by a thousandth of them.
pub(crate) const LEAST_PITCH: f64 = 1e-12;

/// A pinhole camera without distortion. Sensor axes: +X sample (right), +Y line (down), +Z boresight.
///
/// The boresight is the axis of projection, and need not meet the image in its middle, or at all: shifted lenses and windows cut
/// from larger images are cameras too.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameCamera {
    /// Placement of the sensor in the scene: axes are h, v, u; translation is the projection centre, local to the origin, m.
    pub world_from_sensor: Pose,
    /// Pixels in a line.
    pub samples: u32,
    /// Lines.
    pub lines: u32,
    /// Width and height of a pixel over the focal length (dimensionless): 2 tan(IFOV / 2).
    pub pitch: [f64; 2],
    /// Where the boresight meets the image, pixels from the first pixel's outer corner.
    pub boresight_px: [f64; 2],
}

impl FrameCamera {
    /// A camera with square pixels whose boresight goes through the image's middle.
    pub fn centred(world_from_sensor: Pose, samples: u32, lines: u32, pitch: f64) -> Self {
        let boresight_px = [samples, lines].map(|n| 0.5 * f64::from(n));
        FrameCamera { world_from_sensor, samples, lines, pitch: [pitch; 2], boresight_px }
    }

    /// A part of the image: some samples of some lines, from the same place.
    #[must_use]
    pub fn window(&self, samples: Range<u32>, lines: Range<u32>) -> Self {
        let [x, y] = self.boresight_px;
        FrameCamera {
            samples: samples.end.saturating_sub(samples.start),
            lines: lines.end.saturating_sub(lines.start),
            boresight_px: [x - f64::from(samples.start), y - f64::from(lines.start)],
            ..self.clone()
        }
    }

    /// Whether pixels are square, and the boresight goes through the image's middle.
    pub fn is_centred(&self) -> bool {
        let Self { samples, lines, pitch, boresight_px, .. } = self;
        pitch[0] == pitch[1] && *boresight_px == [*samples, *lines].map(|n| 0.5 * f64::from(n))
    }

    /// The projection centre, m.
    pub fn centre_m(&self) -> DVec3 {
        self.world_from_sensor.translation_m
    }

    /// Direction (not of unit length: 1 along the boresight) of the ray through image point (x, y), pixels from the first pixel's outer corner.
    pub fn ray(&self, x_px: f64, y_px: f64) -> DVec3 {
        let x = (x_px - self.boresight_px[0]) * self.pitch[0];
        let y = (y_px - self.boresight_px[1]) * self.pitch[1];
        self.world_from_sensor.vector(DVec3::new(x, y, 1.0))
    }

    /// Angle between the boresight and the corner of the image that is farthest from it, rad: nothing beyond it is in the image.
    pub fn half_cone_rad(&self) -> f64 {
        let far = [self.samples, self.lines].map(f64::from);
        // Of each side the end that is farther from where the boresight is.
        let reach =
            [0, 1].map(|k| self.pitch[k] * self.boresight_px[k].abs().max((far[k] - self.boresight_px[k]).abs()));
        reach[0].hypot(reach[1]).atan()
    }

    /// Size of a pixel over the focal length, of a square one of the same area.
    pub fn mean_pitch(&self) -> f64 {
        if self.pitch[0] == self.pitch[1] { self.pitch[0] } else { (self.pitch[0] * self.pitch[1]).sqrt() }
    }

    /// By how much rounding may move what is drawn, pixels: 4 eps x range over the width of a pixel at that range.
    pub fn rounding_px(&self) -> f64 {
        4.0 * f64::EPSILON / self.pitch[0].min(self.pitch[1])
    }

    /// Angle that a pixel on the boresight subtends along its line, rad.
    pub fn ifov_rad(&self) -> f64 {
        Self::angle_of_pitch(self.pitch[0], 1)
    }

    /// Width of a pixel over the focal length where so many, with the boresight in their middle, subtend this angle, rad.
    pub fn pitch_of_angle(angle_rad: f64, pixels: u32) -> f64 {
        2.0 * (0.5 * angle_rad).tan() / f64::from(pixels)
    }

    /// The angle, rad, that so many pixels subtend, with the boresight in their middle: the inverse of
    /// [`pitch_of_angle`](FrameCamera::pitch_of_angle).
    pub fn angle_of_pitch(pitch: f64, pixels: u32) -> f64 {
        2.0 * (0.5 * f64::from(pixels) * pitch).atan()
    }

    /// What is wrong with it, whatever it looks at.
    pub(super) fn check(&self, problem: &mut impl FnMut(&str, String)) {
        super::near_enough("observer.position_m", self.centre_m(), problem);
        if self.samples == 0 || self.lines == 0 {
            problem("sensor", format!("an image of {} x {} pixels: both must be at least 1", self.samples, self.lines));
        }
        if let Some(pitch) = self.pitch.into_iter().find(|pitch| !(*pitch > 0.0 && pitch.is_finite())) {
            problem("sensor", format!("pixel pitch {pitch} is not positive"));
        } else if let Some(pitch) = self.pitch.into_iter().find(|pitch| *pitch < LEAST_PITCH) {
            problem(
                "sensor",
                format!(
                    "pixels of {pitch:e} rad are smaller than {LEAST_PITCH:e}: the digits of coordinates do not tell them apart"
                ),
            );
        }
        let size_px = f64::from(self.samples.max(self.lines));
        if let Some(at) = self.boresight_px.into_iter().find(|at| at.is_nan() || at.abs() > FARTHEST * size_px) {
            problem(
                "sensor",
                format!("a boresight {at} pixels from the image's corner, {FARTHEST} times the image's size"),
            );
        }
    }
}
