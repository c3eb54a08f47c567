//! What is taken of the surface: by which camera, in which bands.

use super::Spectrometer;
use super::coverage::percent;
use crate::error::{Location, Problem};
use crate::geometry::FrameCamera;
use crate::spectral::{ALL_UM, Band, MOST_BEYOND};

/// A boresight farther from the image than this, in image sizes, is taken as a mistake: beyond, digits of pixels are lost.
const FARTHEST: f64 = 1e6;
/// Smaller pixels, rad, are refused: coordinates of 16 digits would be off by a thousandth of them.
pub(crate) const LEAST_PITCH: f64 = 1e-12;

/// An instrument at work: where it looks, and its bands.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    /// Name of the instrument.
    pub instrument: String,
    /// Its optics and pose.
    pub camera: FrameCamera,
    /// Its bands, in the order of the cube.
    pub bands: Vec<Band>,
    /// Smile and keystone of a push-broom.
    pub spectrometer: Spectrometer,
}

impl Exposure {
    /// What is wrong with it, whatever it looks at.
    pub(super) fn problems(&self) -> Vec<Problem> {
        let mut problems = self.spectrometer.problems(self.camera.samples, &self.bands);
        let mut problem = |item: &str, message: String| problems.push(Problem::new(Location::item(item), message));
        check_camera(&self.camera, &mut problem);
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
        problems
    }
}

/// What is wrong with a camera, whatever it looks at.
fn check_camera(camera: &FrameCamera, problem: &mut impl FnMut(&str, String)) {
    super::near_enough("observer.position_m", camera.centre_m(), problem);
    if camera.samples == 0 || camera.lines == 0 {
        problem("sensor", format!("an image of {} x {} pixels: both must be at least 1", camera.samples, camera.lines));
    }
    if let Some(pitch) = camera.pitch.into_iter().find(|pitch| !(*pitch > 0.0 && pitch.is_finite())) {
        problem("sensor", format!("pixel pitch {pitch} is not positive"));
    } else if let Some(pitch) = camera.pitch.into_iter().find(|pitch| *pitch < LEAST_PITCH) {
        problem(
            "sensor",
            format!(
                "pixels of {pitch:e} rad are smaller than {LEAST_PITCH:e}: the digits of coordinates do not tell them apart"
            ),
        );
    }
    if !camera.is_within_lens() {
        problem("sensor", "its lens was made for an image that this one is not part of".into());
    }
    let size_px = f64::from(camera.samples.max(camera.lines));
    if let Some(at) = camera.boresight_px.into_iter().find(|at| at.is_nan() || at.abs() > FARTHEST * size_px) {
        problem(
            "sensor",
            format!("a boresight {at} pixels from the image's corner, {FARTHEST} times the image's size"),
        );
    }
}
