//! What is taken of the surface: by which camera, in which bands.

use super::FrameCamera;
use super::coverage::percent;
use crate::error::{Location, Problem};
use crate::spectral::{ALL_UM, Band, MOST_BEYOND};

/// An instrument at work: where it looks, and its bands.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    /// Name of the instrument.
    pub instrument: String,
    /// Its optics and pose.
    pub camera: FrameCamera,
    /// Its bands, in the order of the cube.
    pub bands: Vec<Band>,
}

impl Exposure {
    /// What is wrong with it, whatever it looks at.
    pub(super) fn problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut problem = |item: &str, message: String| problems.push(Problem::new(Location::item(item), message));
        self.camera.check(&mut problem);
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
