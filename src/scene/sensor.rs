//! What looks at the surface.

use glam::DVec3;

use crate::geometry::Pose;
use crate::spectral::{ALL_UM, Band, MOST_BEYOND};

use super::percent;

/// Smaller pixels, rad, are refused: coordinates of 16 digits would be off by a thousandth of them.
pub(crate) const LEAST_PITCH: f64 = 1e-12;

/// A pinhole camera with square pixels. Sensor axes: +X sample (right), +Y line (down), +Z boresight.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameCamera {
    /// Placement of the sensor in the scene: axes are h, v, u; translation is the projection centre, local to the origin, m.
    pub world_from_sensor: Pose,
    /// Pixels in a line.
    pub samples: u32,
    /// Lines.
    pub lines: u32,
    /// Pixel size over focal length (dimensionless): 2 tan(IFOV / 2).
    pub pitch: f64,
}

impl FrameCamera {
    /// The projection centre, m.
    pub fn centre_m(&self) -> DVec3 {
        self.world_from_sensor.translation_m
    }

    /// Direction (not of unit length: 1 along the boresight) of the ray through image point (x, y), pixels from the first pixel's outer corner.
    pub fn ray(&self, x_px: f64, y_px: f64) -> DVec3 {
        let x = (x_px - 0.5 * f64::from(self.samples)) * self.pitch;
        let y = (y_px - 0.5 * f64::from(self.lines)) * self.pitch;
        self.world_from_sensor.vector(DVec3::new(x, y, 1.0))
    }

    /// Where the boresight meets the image, pixels from the first pixel's outer corner.
    pub fn boresight_px(&self) -> [f64; 2] {
        [0.5 * f64::from(self.samples), 0.5 * f64::from(self.lines)]
    }

    /// By how much rounding may move what is drawn, pixels: 4 eps x range over the width of a pixel at that range.
    pub fn rounding_px(&self) -> f64 {
        4.0 * f64::EPSILON / self.pitch
    }

    /// Angle that the central pixel subtends, rad.
    pub fn ifov_rad(&self) -> f64 {
        2.0 * (0.5 * self.pitch).atan()
    }
}

/// A camera and its bands.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Name of the instrument.
    pub name: String,
    /// Its optics and pose.
    pub camera: FrameCamera,
    /// Its bands, in the order of the cube.
    pub bands: Vec<Band>,
}

impl Sensor {
    pub(super) fn check(&self, problem: &mut impl FnMut(&str, String)) {
        let camera = &self.camera;
        if camera.samples == 0 || camera.lines == 0 {
            problem(
                "sensor",
                format!("an image of {} x {} pixels: both must be at least 1", camera.samples, camera.lines),
            );
        }
        if !(camera.pitch > 0.0 && camera.pitch.is_finite()) {
            problem("sensor", format!("pixel pitch {} is not positive", camera.pitch));
        } else if camera.pitch < LEAST_PITCH {
            problem(
                "sensor",
                format!(
                    "pixels of {:e} rad are smaller than {LEAST_PITCH:e}: the digits of coordinates do not tell them apart",
                    camera.pitch
                ),
            );
        }
        if self.bands.is_empty() {
            problem("sensor.bands", "no bands: a sensor needs at least one".into());
        }
        for (i, band) in self.bands.iter().enumerate() {
            if !(band.centre_um > 0.0 && band.centre_um.is_finite()) {
                problem(&format!("sensor.bands[{i}]"), format!("centre {} um is not a wavelength", band.centre_um));
            }
            if band.fwhm_um.is_some_and(|w| !(w > 0.0 && w.is_finite())) {
                problem(
                    &format!("sensor.bands[{i}]"),
                    "FWHM must be positive; leave it out for a monochromatic band".into(),
                );
            } else if band.fwhm_um.is_some_and(|w| w < f64::EPSILON.sqrt() * band.centre_um) {
                problem(
                    &format!("sensor.bands[{i}]"),
                    "FWHM is too narrow for the digits of a number; leave it out for a monochromatic band".into(),
                );
            } else if band.share_beyond(ALL_UM) > MOST_BEYOND {
                let share = percent(band.share_beyond(ALL_UM));
                problem(&format!("sensor.bands[{i}]"), format!("{share} of the response lies below wavelength 0"));
            }
        }
    }
}
