//! The camera: where it is, where it looks, its pixels and its bands.

use glam::{DMat3, DVec3};

use crate::error::number;
use crate::geometry::{Direction, Mesh, Pose};
use crate::scene::{FrameCamera, Sensor};
use crate::spectral::Band;

use super::Reader;
use super::lens::Lens;
use super::mesh::UNIT_TOLERANCE;
use super::types::{BandsToml, Coordinates, Fwhm, ObserverToml, Preset, SensorToml};

/// No band lies beyond this, um: wavelengths above are nanometres.
const LONGEST_UM: f64 = 100.0;
/// As many bad centres are told one by one.
const TOLD: usize = 20;

impl Reader<'_> {
    pub(super) fn sensor(&mut self, toml: &SensorToml, observer: &ObserverToml, mesh: Option<&Mesh>) -> Option<Sensor> {
        let preset = toml.preset == Some(Preset::Macromega);
        let pose = self.observer(observer);
        let samples = self.given("sensor.samples", toml.samples, preset.then_some(256));
        let lines = self.given("sensor.lines", toml.lines, preset.then_some(256));
        let bands = match (&toml.bands, preset) {
            (Some(bands), _) => self.bands("sensor.bands", bands),
            (None, true) => {
                self.stated("sensor.bands", "MacrOmega: 300 bands from 0.95 to 3.6 um, monochromatic");
                Some(evenly(0.95, 3.6, 300))
            }
            (None, false) => {
                self.problem("sensor", "`bands` is missing");
                None
            }
        };
        let name = match (&toml.name, preset) {
            (Some(name), _) => name.clone(),
            (None, true) => "MacrOmega".into(),
            (None, false) => {
                self.stated("sensor.name", "frame camera");
                "frame camera".into()
            }
        };
        let (samples, lines) = (samples?, lines?);
        let lens = Lens::from(toml);
        let optics = if self.is_fitted(toml.fit, &lens)? {
            let pitch = match (pose, mesh) {
                (Some(pose), Some(mesh)) => self.fitted(&pose, samples, lines, mesh),
                _ => None,
            };
            pitch.map(|pitch| ([pitch; 2], [samples, lines].map(|n| 0.5 * f64::from(n))))
        } else {
            if preset && !lens.says_field() {
                self.stated("sensor.ifov_mrad", "0.5: MacrOmega");
            }
            self.optics(&lens, [samples, lines], preset.then(|| pitch_of_ifov(0.5)))
        };
        let (pitch, boresight_px) = optics?;
        let camera = FrameCamera { world_from_sensor: pose?, samples, lines, pitch, boresight_px };
        Some(Sensor { name, camera, bands: bands? })
    }

    fn given(&mut self, item: &str, value: Option<u32>, preset: Option<u32>) -> Option<u32> {
        if let (None, Some(preset)) = (value, preset) {
            self.stated(item, format!("{preset}: MacrOmega"));
        } else if value.is_none() {
            self.problem("sensor", format!("`{}` is missing", item.trim_start_matches("sensor.")));
        }
        value.or(preset)
    }

    /// The pixel pitch with which every vertex in front of the camera is in the image, and one is on its border.
    fn fitted(&mut self, pose: &Pose, samples: u32, lines: u32, mesh: &Mesh) -> Option<f64> {
        let sensor_from_world = pose.inverse();
        let mut pitch = 0.0_f64;
        for vertex_m in mesh.used_vertices_m() {
            let v = sensor_from_world.point(vertex_m);
            if v.z > 0.0 {
                pitch = pitch.max((v.x / v.z).abs() / (0.5 * f64::from(samples)));
                pitch = pitch.max((v.y / v.z).abs() / (0.5 * f64::from(lines)));
            }
        }
        if !(pitch > 0.0 && pitch.is_finite()) {
            self.helped("sensor.fit", "no part of the mesh is in front of the camera", "check `observer`");
            return None;
        }
        let ifov_mrad = 2e3 * (0.5 * pitch).atan();
        let fov_deg = (2.0 * (0.5 * pitch * f64::from(samples)).atan()).to_degrees();
        self.stated("sensor.ifov_mrad", format!("{ifov_mrad:.6} (a line spans {fov_deg:.4} deg): fitted to the scene"));
        Some(pitch)
    }

    pub(in crate::formats) fn observer(&mut self, toml: &ObserverToml) -> Option<Pose> {
        if let Some(matrix) = &toml.camera_to_world {
            let beside = toml.position_m.is_some() || toml.target_m.is_some() || toml.up.is_some();
            if beside || toml.h.or(toml.v).or(toml.u).is_some() || toml.world_from_sensor_xyzw.is_some() {
                self.problem("observer.camera_to_world", "says all of position and axes: leave the other keys out");
                return None;
            }
            let (rotation, position_m) = self.camera_to_world(matrix, toml.convention)?;
            let is_local = toml.coordinates == Some(Coordinates::Local);
            let translation_m = if is_local { position_m } else { position_m - self.origin_m };
            return Some(Pose { rotation, translation_m });
        }
        for (key, is_given) in [("convention", toml.convention.is_some()), ("coordinates", toml.coordinates.is_some())]
        {
            if is_given {
                self.problem(&format!("observer.{key}"), "goes with `camera_to_world` alone");
                return None;
            }
        }
        let Some(position_m) = toml.position_m.map(DVec3::from_array) else {
            self.problem("observer", "`position_m` is missing");
            return None;
        };
        let axes = (toml.h, toml.v, toml.u);
        let rotation = match (toml.target_m, toml.up, axes, toml.world_from_sensor_xyzw) {
            (Some(target_m), Some(up), (None, None, None), None) => {
                let Some(u) = Direction::new(DVec3::from_array(target_m) - position_m) else {
                    self.problem("observer.target_m", "is where the camera is: there is no direction to look in");
                    return None;
                };
                let up = DVec3::from_array(up);
                // The right of the image is normal to the boresight and to up. Up along the boresight leaves only rounding.
                let h = Direction::new(up).map(|up| u.vec().cross(up.vec()));
                let Some(h) = h.filter(|h| h.length() > UNIT_TOLERANCE).and_then(Direction::new) else {
                    self.helped(
                        "observer.up",
                        "has no length across the line of sight: the image has no top",
                        "give a direction that is not along the line of sight, as [0, 0, 1] for north",
                    );
                    return None;
                };
                DMat3::from_cols(h.vec(), u.vec().cross(h.vec()), u.vec())
            }
            (None, None, (Some(h), Some(v), Some(u)), None) => {
                let [h, v, u] = [h, v, u].map(DVec3::from_array);
                let lengths = [("h", h), ("v", v), ("u", u)];
                for (name, vector) in lengths {
                    if (vector.length() - 1.0).abs() > UNIT_TOLERANCE {
                        self.problem(
                            &format!("observer.{name}"),
                            format!("is not a unit vector: its length is {}", vector.length()),
                        );
                        return None;
                    }
                }
                if (h.cross(v) - u).length() > UNIT_TOLERANCE {
                    let help = if (h.cross(v) + u).length() <= UNIT_TOLERANCE {
                        "h x v = -u: the image would be a mirror image; exchange or turn one of them"
                    } else {
                        "they must be at right angles"
                    };
                    self.helped("observer.u", "h x v is not u", help);
                    return None;
                }
                DMat3::from_cols(h, v, u)
            }
            (None, None, (None, None, None), Some(xyzw)) => self.rotation("observer.world_from_sensor_xyzw", xyzw)?,
            _ => {
                let message = "give one of: `target_m` and `up`; `h`, `v` and `u`; `world_from_sensor_xyzw`";
                self.problem("observer", message);
                return None;
            }
        };
        Some(Pose { rotation, translation_m: position_m - self.origin_m })
    }

    /// Bands, called `item` in the text.
    pub(in crate::formats) fn bands(&mut self, item: &str, toml: &BandsToml) -> Option<Vec<Band>> {
        let mut bands = self.centres(item, toml)?;
        let is_good = self.check_centres(item, toml, &bands);
        self.widths(item, toml, &mut bands)?;
        let odd = bands.iter().find(|b| b.fwhm_um.is_some_and(|w| !(w > 0.0 && w < b.centre_um)));
        if let Some(Band { centre_um, fwhm_um: Some(fwhm_um) }) = odd.filter(|_| is_good) {
            let message = format!("a width of {} um for a band at {centre_um} um", number(*fwhm_um));
            let help = "widths are in um, positive and less than the centre; leave them out for monochromatic bands";
            self.helped(&format!("{item}.fwhm_um"), message, help);
            return None;
        }
        is_good.then_some(bands)
    }

    fn centres(&mut self, item: &str, toml: &BandsToml) -> Option<Vec<Band>> {
        match (toml.start_um, toml.stop_um, toml.count, &toml.centres_um) {
            (Some(start), Some(stop), Some(count), None) => {
                if !(start < stop || (start == stop && count == 1)) {
                    self.problem(&format!("{item}.stop_um"), format!("{stop} is not beyond start_um = {start}"));
                    return None;
                }
                if count == 1 && start != stop {
                    let message = "one band cannot have two centres: make start_um and stop_um equal";
                    self.problem(&format!("{item}.count"), message);
                    return None;
                }
                Some(evenly(start, stop, count))
            }
            (None, None, None, Some(centres)) => {
                Some(centres.iter().map(|&centre_um| Band { centre_um, fwhm_um: None }).collect())
            }
            _ => {
                self.problem(item, "give `start_um`, `stop_um` and `count`, or `centres_um`");
                None
            }
        }
    }

    /// Whether all centres are wavelengths of light in um.
    fn check_centres(&mut self, item: &str, toml: &BandsToml, bands: &[Band]) -> bool {
        let is_wrong = |band: &Band| !(band.centre_um > 0.0 && band.centre_um < LONGEST_UM);
        let wrong: Vec<usize> = (0..bands.len()).filter(|&i| is_wrong(&bands[i])).collect();
        // Of evenly spaced bands the ends say it all.
        let told = wrong.iter().filter(|&&i| toml.centres_um.is_some() || i == 0 || i + 1 == bands.len());
        for &i in told.take(TOLD) {
            let place = match toml.centres_um {
                Some(_) => format!("{item}.centres_um[{i}]"),
                None if i == 0 => format!("{item}.start_um"),
                None => format!("{item}.stop_um"),
            };
            let um = bands[i].centre_um;
            let problem = self.problem(&place, format!("{} um is outside 0 to {LONGEST_UM} um", number(um)));
            if um >= LONGEST_UM {
                problem.help = Some(format!("if this is nanometres, write {}", number(um / 1000.0)));
            }
        }
        wrong.is_empty()
    }

    fn widths(&mut self, item: &str, toml: &BandsToml, bands: &mut [Band]) -> Option<()> {
        match &toml.fwhm_um {
            Some(Fwhm::All(fwhm)) => bands.iter_mut().for_each(|band| band.fwhm_um = Some(*fwhm)),
            Some(Fwhm::Each(fwhm)) if fwhm.len() == bands.len() => {
                bands.iter_mut().zip(fwhm).for_each(|(band, fwhm)| band.fwhm_um = Some(*fwhm).filter(|w| *w != 0.0));
            }
            Some(Fwhm::Each(fwhm)) => {
                let message =
                    format!("{} widths for {} bands: give one for each, or one for all", fwhm.len(), bands.len());
                self.problem(&format!("{item}.fwhm_um"), message);
                return None;
            }
            None => self.stated(&format!("{item}.fwhm_um"), "none: bands are monochromatic"),
        }
        Some(())
    }
}

/// The pitch of pixels that subtend this angle, mrad, in the middle of the image.
pub(in crate::formats) fn pitch_of_ifov(ifov_mrad: f64) -> f64 {
    2.0 * (0.5 * ifov_mrad * 1e-3).tan()
}

/// The pitch of `samples` pixels whose line subtends this angle, deg.
pub(in crate::formats) fn pitch_of_fov(fov_deg: f64, samples: u32) -> f64 {
    2.0 * (0.5 * fov_deg.to_radians()).tan() / f64::from(samples)
}

/// Bands at equal steps, both ends included.
fn evenly(start_um: f64, stop_um: f64, count: u32) -> Vec<Band> {
    let last = count - 1;
    let centre_um = |i: u32| match i {
        0 => start_um,
        // Not a rounding error beyond the end: tables may end there too.
        i if i == last => stop_um,
        i => start_um + (stop_um - start_um) * (f64::from(i) / f64::from(last)),
    };
    (0..count).map(|i| Band { centre_um: centre_um(i), fwhm_um: None }).collect()
}
