//! From what cameras come with (angles, focal lengths in pixels or mm, shifted lenses, windows of larger images) to one linear camera.

use std::sync::Arc;

use super::TomlReader;
use super::types::{DistortionToml, Fit, FocalToml, MapSensorToml, SensorFitToml, SensorToml, WindowToml};
use crate::error::number;
use crate::formats::directions;
use crate::geometry::{self, BrownConrady};

/// What a text says of a camera's lens, in a scene or in a map file.
pub(in crate::formats) struct Lens<'a> {
    ifov_mrad: Option<f64>,
    fov_deg: Option<f64>,
    focal_px: Option<&'a FocalToml>,
    focal_mm: Option<f64>,
    sensor_mm: Option<f64>,
    sensor_fit: Option<SensorFitToml>,
    pixel_aspect: Option<f64>,
    boresight_px: Option<[f64; 2]>,
    shift: Option<[f64; 2]>,
    window: Option<&'a WindowToml>,
    distortion: Option<DistortionToml>,
    directions: Option<&'a str>,
}

/// Sides of pixels that are curved by more than this, pixels, are worth a word.
const CURVED_PX: f64 = 1e-3;

/// Size of a pixel over the focal length, and where the boresight is, pixels from the image's corner.
type Linear = ([f64; 2], [f64; 2]);

/// What makes an image of directions.
pub(in crate::formats) struct Optics {
    /// Size of a pixel over the focal length.
    pub(in crate::formats) pitch: [f64; 2],
    /// Where the boresight is, pixels from the image's corner.
    pub(in crate::formats) boresight_px: [f64; 2],
    /// What the lens does to that.
    pub(in crate::formats) lens: Option<Arc<geometry::Lens>>,
}

macro_rules! lens {
    ($toml:expr) => {
        Lens {
            ifov_mrad: $toml.ifov_mrad,
            fov_deg: $toml.fov_deg,
            focal_px: $toml.focal_px.as_ref(),
            focal_mm: $toml.focal_mm,
            sensor_mm: $toml.sensor_mm,
            sensor_fit: $toml.sensor_fit,
            pixel_aspect: $toml.pixel_aspect,
            boresight_px: $toml.boresight_px,
            shift: $toml.shift,
            window: $toml.window.as_ref(),
            distortion: $toml.distortion,
            directions: $toml.directions.as_deref(),
        }
    };
}

impl<'a> From<&'a SensorToml> for Lens<'a> {
    fn from(toml: &'a SensorToml) -> Self {
        lens!(toml)
    }
}

impl<'a> From<&'a MapSensorToml> for Lens<'a> {
    fn from(toml: &'a MapSensorToml) -> Self {
        lens!(toml)
    }
}

impl Lens<'_> {
    /// Whether anything is said of the field of view.
    pub(super) fn says_field(&self) -> bool {
        self.ifov_mrad.is_some() || self.fov_deg.is_some() || self.focal_px.is_some() || self.focal_mm.is_some()
    }

    /// Whether nothing moves the boresight from the middle, and pixels are square.
    pub(super) fn is_plain(&self) -> bool {
        self.pixel_aspect.is_none()
            && self.boresight_px.is_none()
            && self.shift.is_none()
            && self.window.is_none()
            && self.distortion.is_none()
    }
}

impl TomlReader<'_> {
    /// The optics of an image of `samples` x `lines` pixels, of which all are taken at once, or of a slit that is moved along; `preset` is as for `linear`.
    pub(in crate::formats) fn optics(
        &mut self,
        lens: &Lens<'_>,
        [samples, lines]: [u32; 2],
        is_slit: bool,
        preset: Option<f64>,
    ) -> Option<Optics> {
        let size = [samples, if is_slit { 1 } else { lines }];
        if let Some(name) = lens.directions {
            if lens.says_field() || !lens.is_plain() || lens.sensor_mm.is_some() || lens.sensor_fit.is_some() {
                let help =
                    "leave out `ifov_mrad`, `fov_deg`, `focal_px`, `boresight_px`, `window`, `distortion` and the like";
                self.helped("sensor.directions", "says all of where pixels look", help);
                return None;
            }
            let read = directions::read(&self.path(name), size);
            let (centres, input) = self.taken("sensor.directions", read)?;
            self.inputs.push(input);
            return match geometry::Lens::table(centres, size) {
                Ok(lens) => {
                    let (pitch, boresight_px) = (lens.pitch(), lens.boresight_px());
                    Some(Optics { pitch, boresight_px, lens: Some(Arc::new(lens)) })
                }
                Err(message) => {
                    self.problem("sensor.directions", format!("{name}: {message}"));
                    None
                }
            };
        }
        let (pitch, boresight_px) = self.linear(lens, [samples, lines], preset)?;
        let lens = match lens.distortion {
            None => None,
            Some(DistortionToml { k1, k2, k3, p1, p2 }) => {
                let of = BrownConrady { radial: [k1, k2, k3], tangential: [p1, p2] };
                // A slit lies where the boresight does.
                let boresight_px = if is_slit { [boresight_px[0], 0.5] } else { boresight_px };
                match geometry::Lens::brown_conrady(of, pitch, boresight_px, size) {
                    Ok(lens) => lens.map(Arc::new),
                    Err(message) => {
                        let help = "coefficients are OpenCV's, for tangents, not for pixels or millimetres; too many of them fold the image far from its middle";
                        self.helped("sensor.distortion", message, help);
                        return None;
                    }
                }
            }
        };
        let sagitta_px = lens.as_ref().map_or(0.0, |lens| lens.sagitta_px());
        if sagitta_px > CURVED_PX {
            let message =
                format!("curves the sides of pixels, which are drawn straight, by up to {sagitta_px:.1e} pixels");
            self.note("sensor.distortion", message);
        }
        Some(Optics { pitch, boresight_px, lens })
    }

    /// The pinhole of an image of `samples` x `lines` pixels; `preset` is the pixel's size over the focal length where nothing is said of it.
    fn linear(&mut self, lens: &Lens<'_>, [samples, lines]: [u32; 2], preset: Option<f64>) -> Option<Linear> {
        let at = |key: &str| format!("sensor.{key}");
        let (first_px, of_px) = match lens.window {
            None => ([0.0; 2], [samples, lines]),
            Some(WindowToml { first_px, of_px }) => {
                let is_within = (0..2)
                    .all(|k| first_px[k] >= 0.0 && first_px[k] + f64::from([samples, lines][k]) <= f64::from(of_px[k]));
                if !is_within {
                    let message = format!(
                        "{samples} x {lines} pixels from {first_px:?} on do not lie within an image of {} x {}",
                        of_px[0], of_px[1]
                    );
                    self.problem(&at("window"), message);
                    return None;
                }
                (*first_px, *of_px)
            }
        };
        let whole = of_px.map(f64::from);
        let aspect = lens.pixel_aspect.unwrap_or(1.0);
        // Both sides, in widths of a pixel. An AUTO fit of Blender goes by the longer one.
        let sides = [whole[0], whole[1] * aspect];
        let is_wide = match lens.sensor_fit.unwrap_or(SensorFitToml::Auto) {
            SensorFitToml::Auto => sides[0] >= sides[1],
            SensorFitToml::Horizontal => true,
            SensorFitToml::Vertical => false,
        };
        let size = if is_wide { sides[0] } else { sides[1] };
        let across = match (lens.ifov_mrad, lens.fov_deg, lens.focal_px, lens.focal_mm) {
            (Some(ifov_mrad), None, None, None) => {
                let message = format!("a pixel of {} mrad", number(ifov_mrad));
                let help = "if this is microradians, write a thousandth";
                // Half a turn has no tangent.
                if ifov_mrad >= 1e3 * std::f64::consts::PI {
                    self.helped(&at("ifov_mrad"), message, help);
                    return None;
                }
                if ifov_mrad > 1000.0 {
                    self.notes.push(format!("sensor.ifov_mrad: {message}; {help}"));
                }
                [super::pitch_of_ifov(ifov_mrad); 2]
            }
            (None, Some(fov_deg), None, None) => [super::pitch_of_fov(fov_deg, of_px[0]); 2],
            (None, None, Some(focal), None) => match focal {
                FocalToml::Both(focal_px) => [1.0 / focal_px; 2],
                FocalToml::Each(focal_px) => focal_px.map(|f| 1.0 / f),
            },
            (None, None, None, Some(focal_mm)) => {
                let Some(sensor_mm) = lens.sensor_mm else {
                    self.problem(&at("sensor_mm"), "is missing: a focal length in mm needs the size of the sensor");
                    return None;
                };
                [sensor_mm / (focal_mm * size); 2]
            }
            (None, None, None, None) if preset.is_some() => [preset?; 2],
            _ => {
                self.problem(
                    "sensor",
                    "give one of `ifov_mrad`, `fov_deg`, `focal_px`, `focal_mm` with `sensor_mm`, and, in a scene, `fit`",
                );
                return None;
            }
        };
        if lens.sensor_mm.is_some() && lens.focal_mm.is_none() {
            self.problem(&at("sensor_mm"), "goes with `focal_mm` alone");
            return None;
        }
        if lens.sensor_fit.is_some() && lens.focal_mm.is_none() && lens.shift.is_none() {
            self.problem(&at("sensor_fit"), "goes with `focal_mm` or `shift` alone");
            return None;
        }
        if lens.pixel_aspect.is_some() && matches!(lens.focal_px, Some(FocalToml::Each(_))) {
            self.problem(&at("pixel_aspect"), "is in the two numbers of `focal_px` already: leave one of them out");
            return None;
        }
        let pitch = [across[0], across[1] * aspect];
        if let Some(pitch) = pitch.into_iter().find(|pitch| !(*pitch > 0.0 && pitch.is_finite())) {
            self.problem("sensor", format!("a pixel of {} focal lengths", number(pitch)));
            return None;
        }
        let boresight_px = match (lens.boresight_px, lens.shift) {
            (Some(_), Some(_)) => {
                self.problem(
                    &at("shift"),
                    "says where the boresight is, as `boresight_px` does: leave one of them out",
                );
                return None;
            }
            (Some(boresight_px), None) => boresight_px,
            (None, None) => whole.map(|n| 0.5 * n),
            // The image moves against the lens: to the right and up, in sizes of the sensor.
            (None, Some([right, up])) => [0.5 * whole[0] - right * size, 0.5 * whole[1] + up * size / aspect],
        };
        Some((pitch, [boresight_px[0] - first_px[0], boresight_px[1] - first_px[1]]))
    }

    /// Says if a fitted field of view is asked for together with what it does not go with.
    pub(super) fn is_fitted(&mut self, fit: Option<Fit>, lens: &Lens<'_>) -> Option<bool> {
        if fit.is_none() {
            return Some(false);
        }
        if lens.says_field() || lens.directions.is_some() {
            self.problem("sensor", "give one of `ifov_mrad`, `fov_deg` and `fit`, or a focal length");
            return None;
        }
        if !lens.is_plain() {
            self.problem(
                "sensor.fit",
                "works only with square pixels, a boresight in the middle of the image, and no distortion",
            );
            return None;
        }
        Some(true)
    }
}
