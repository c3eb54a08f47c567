//! The camera: where it is, where it looks, its pixels and its bands.

use glam::{DMat3, DVec3};

use crate::error::number;
use crate::formats::response_csv;
use crate::geometry::{Direction, FrameCamera, Mesh, Pose};
use crate::scene::{Exposure, LEAST_PITCH, Spectrometer};
use crate::spectral::{Band, Response, Spectrum};
use crate::units::cm_1_per_um;

use super::attitude::no_rotation;
use super::instruments::Instrument;
use super::lens::{Lens, Optics};
use super::types::{
    BandsToml, Coordinates, Frame, Fwhm, LightToml, LightsToml, ObserverToml, Preset, ResponseToml, SensorToml,
    ShapeToml, ShapesToml,
};
use super::{ROUNDED, TomlReader};

/// A camera that has no name.
pub(in crate::formats) const SENSOR_NAME: &str = "frame camera";
/// No band lies beyond this, um, where sunlight is not known: wavelengths above are nanometres.
const LONGEST_UM: f64 = 1000.0;
/// Few instruments look beyond this, um.
pub(in crate::formats) const USUAL_UM: f64 = 100.0;
/// Directions closer than this, rad, may differ only by rounding.
const ALONG: f64 = 16.0 * f64::EPSILON;
/// Rounding of an up that is closer to the line of sight than this, rad, may turn the image noticeably.
const SLANT: f64 = 1e-6;
/// At most this many bad centres are listed one by one.
const TOLD: usize = 20;

impl TomlReader<'_> {
    /// The sensor, at a pose that is `None` if what is wrong with it has been reported; for a slit that is moved along, or of all of its lines at once.
    pub(super) fn exposure(
        &mut self,
        toml: &SensorToml,
        pose: Option<Pose>,
        is_slit: bool,
        mesh: Option<&Mesh>,
    ) -> Option<Exposure> {
        let preset = toml.preset.map(Preset::instrument);
        let samples = self.given("sensor.samples", toml.samples, preset, |of| Some(of.samples));
        let lines = self.given("sensor.lines", toml.lines, preset, |of| of.lines);
        let bands = match (&toml.bands, preset) {
            (Some(bands), _) => self.bands("sensor.bands", bands),
            (None, Some(instrument)) => {
                self.stated("sensor.bands", instrument.told());
                Some(instrument.bands())
            }
            (None, None) => {
                self.problem("sensor", "`bands` is missing");
                None
            }
        };
        let name = match (&toml.name, preset) {
            (Some(name), _) => name.clone(),
            (None, Some(instrument)) => instrument.name.into(),
            (None, None) => {
                self.stated("sensor.name", SENSOR_NAME);
                SENSOR_NAME.into()
            }
        };
        let (samples, lines) = (samples?, lines?);
        let lens = Lens::from(toml);
        let optics = if self.is_fitted(toml.fit, &lens)? {
            let pitch = match (pose, mesh) {
                (Some(pose), Some(mesh)) => self.fitted(&pose, samples, lines, mesh),
                _ => None,
            };
            let boresight_px = [samples, lines].map(|n| 0.5 * f64::from(n));
            pitch.map(|pitch| Optics { pitch: [pitch; 2], boresight_px, lens: None })
        } else {
            if let Some(instrument) = preset.filter(|_| !lens.says_field() && toml.directions.is_none()) {
                self.stated("sensor.ifov_mrad", format!("{}: {}", instrument.ifov_mrad, instrument.name));
            }
            self.optics(&lens, [samples, lines], is_slit, preset.map(|of| pitch_of_ifov(of.ifov_mrad)))
        };
        let Optics { pitch, boresight_px, lens } = optics?;
        if let Some(pitch) = pitch.into_iter().find(|pitch| *pitch < LEAST_PITCH) {
            let item = match (toml.fit, toml.fov_deg, toml.ifov_mrad) {
                (Some(_), ..) => "sensor.fit",
                (_, Some(_), _) => "sensor.fov_deg",
                (_, _, Some(_)) => "sensor.ifov_mrad",
                _ => "sensor",
            };
            let message = format!(
                "makes pixels of {pitch:e} rad, below {LEAST_PITCH:e}: the digits of coordinates do not tell them apart"
            );
            self.problem(item, message);
            return None;
        }
        let camera = FrameCamera { world_from_sensor: pose?, samples, lines, pitch, boresight_px, lens };
        let spectrometer = self.spectrometer(toml, is_slit)?;
        Some(Exposure { instrument: name, camera, bands: bands?, spectrometer })
    }

    /// Smile and keystone, which a slit alone has.
    fn spectrometer(&mut self, toml: &SensorToml, is_slit: bool) -> Option<Spectrometer> {
        let given = [("smile_um", &toml.smile_um), ("keystone_px", &toml.keystone_px)];
        if let Some((key, _)) = given.iter().find(|(_, given)| given.is_some() && !is_slit) {
            self.problem(&format!("sensor.{key}"), "goes with `kind` = \"push_broom\"");
            return None;
        }
        let [smile_um, keystone_px] = given.map(|(_, given)| given.clone().unwrap_or_default());
        Some(Spectrometer { smile_um, keystone_px })
    }

    fn given(
        &mut self,
        item: &str,
        value: Option<u32>,
        preset: Option<&Instrument>,
        of: impl Fn(&Instrument) -> Option<u32>,
    ) -> Option<u32> {
        let by_preset = preset.and_then(|instrument| Some((of(instrument)?, instrument.name)));
        match (value, by_preset) {
            (None, Some((number, name))) => self.stated(item, format!("{number}: {name}")),
            (None, None) => {
                self.problem("sensor", format!("`{}` is missing", item.trim_start_matches("sensor.")));
            }
            (Some(_), _) => {}
        }
        value.or(by_preset.map(|(number, _)| number))
    }

    /// The pixel pitch with which every vertex in front of the camera is in the image, and one is on its border; but those around a site.
    fn fitted(&mut self, pose: &Pose, samples: u32, lines: u32, mesh: &Mesh) -> Option<f64> {
        let sensor_from_world = pose.inverse();
        let mut pitch = 0.0_f64;
        for vertex in mesh.facets.iter().flatten().filter(|v| self.around.binary_search(v).is_err()) {
            let v = sensor_from_world.point(mesh.vertices_m[*vertex as usize]);
            if v.z > 0.0 {
                pitch = pitch.max((v.x / v.z).abs() / (0.5 * f64::from(samples)));
                pitch = pitch.max((v.y / v.z).abs() / (0.5 * f64::from(lines)));
            }
        }
        if !(pitch > 0.0 && pitch.is_finite()) {
            self.helped("sensor.fit", "no part of the mesh is in front of the camera", "check `observer`");
            return None;
        }
        let ifov_mrad = 1e3 * FrameCamera::angle_of_pitch(pitch, 1);
        let fov_deg = FrameCamera::angle_of_pitch(pitch, samples).to_degrees();
        self.stated("sensor.ifov_mrad", format!("{ifov_mrad:.6} (a line spans {fov_deg:.4} deg): fitted to the scene"));
        Some(pitch)
    }

    pub(in crate::formats) fn observer(&mut self, toml: &ObserverToml) -> Option<Pose> {
        if let Some(matrix) = &toml.camera_to_world {
            let beside = toml.position_m.is_some() || toml.target_m.is_some() || toml.up.is_some();
            if toml.frame == Some(Frame::Site) && toml.coordinates == Some(Coordinates::Body) {
                self.problem("observer.coordinates", "the site's frame starts at `origin_m`: leave this out");
                return None;
            }
            if beside || toml.h.or(toml.v).or(toml.u).is_some() || toml.world_from_sensor_xyzw.is_some() {
                self.problem("observer.camera_to_world", "says all of position and axes: leave the other keys out");
                return None;
            }
            let (rotation, position_m) = self.camera_to_world(matrix, toml.convention)?;
            if toml.frame == Some(Frame::Site) {
                let axes = self.body_from_site("observer.frame", "the frame of a site")?;
                return Some(Pose { rotation: axes * rotation, translation_m: axes * position_m });
            }
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
                    self.problem("observer.target_m", "is where the camera is: the direction to it is undefined");
                    return None;
                };
                let help = "give a direction that is not along the line of sight, e.g. [0, 0, 1] for north";
                self.upright("observer.up", u, DVec3::from_array(up), help)?
            }
            (None, None, (Some(h), Some(v), Some(u)), None) => self.axes([h, v, u].map(DVec3::from_array))?,
            (None, None, (None, None, None), Some(xyzw)) => self.rotation("observer.world_from_sensor_xyzw", xyzw)?,
            _ => {
                let message = "give one of: `target_m` and `up`; `h`, `v` and `u`; `world_from_sensor_xyzw`";
                self.problem("observer", message);
                return None;
            }
        };
        match toml.frame {
            Some(Frame::Site) => {
                let axes = self.body_from_site("observer.frame", "the frame of a site")?;
                Some(Pose { rotation: axes * rotation, translation_m: axes * position_m })
            }
            Some(Frame::Body) | None => Some(Pose { rotation, translation_m: position_m - self.origin_m }),
        }
    }

    /// The sensor's axes as columns, with the boresight `u` and `up`, of any length, towards the top of the image; `help` where there is none.
    pub(super) fn upright(&mut self, item: &str, u: Direction, up: DVec3, help: &str) -> Option<DMat3> {
        // The right of the image is normal to the boresight and to up. Up along the boresight leaves only rounding.
        let across = Direction::new(up).map(|up| u.vec().cross(up.vec()));
        let off = across.map_or(0.0, DVec3::length);
        if off > ALONG && off < SLANT {
            let known = ALONG / off;
            self.note(
                item,
                format!("is {off:.1e} rad off the line of sight: which way is up is known to {known:.1e} rad"),
            );
        }
        let Some(h) = across.filter(|_| off > ALONG).and_then(Direction::new) else {
            self.helped(item, "is along the line of sight: the image's top is undefined", help);
            return None;
        };
        Some(DMat3::from_cols(h.vec(), u.vec().cross(h.vec()), u.vec()))
    }

    /// The rotation whose columns are the axes h, v, u, which may be rounded.
    fn axes(&mut self, [h, v, u]: [DVec3; 3]) -> Option<DMat3> {
        for (name, vector) in [("h", h), ("v", v), ("u", u)] {
            if !(0.0..=ROUNDED).contains(&(vector.length() - 1.0).abs()) {
                let message = format!("is not a unit vector: its length is {}", vector.length());
                self.problem(&format!("observer.{name}"), message);
                return None;
            }
        }
        let off = (h.cross(v) - u).length();
        if !(0.0..=ROUNDED).contains(&off) {
            let help = if (h.cross(v) + u).length() <= ROUNDED {
                "h x v = -u: the image would be a mirror image; exchange or turn one of them"
            } else {
                "they must be at right angles"
            };
            self.helped("observer.u", "h x v is not u", help);
            return None;
        }
        let axes = DMat3::from_cols(h, v, u);
        let rotation = self.unrounded("observer", axes);
        if rotation.is_none() {
            self.problem("observer.u", format!("h, v, u: {}", no_rotation(axes)));
        }
        rotation
    }

    /// Bands, called `item` in the text.
    pub(in crate::formats) fn bands(&mut self, item: &str, toml: &BandsToml) -> Option<Vec<Band>> {
        let has_centres = toml.start_um.is_some() || toml.centres_um.is_some();
        if toml.response.is_none() && toml.columns.is_some() {
            self.problem(&format!("{item}.columns"), "are those of `response`, which is missing");
            return None;
        }
        let mut bands = match &toml.response {
            Some(files) if !has_centres => {
                for (key, given) in [
                    ("stop_um", toml.stop_um.is_some()),
                    ("count", toml.count.is_some()),
                    ("fwhm_um", toml.fwhm_um.is_some()),
                    ("fwhm_cm_1", toml.fwhm_cm_1.is_some()),
                    ("shape", toml.shape.is_some()),
                ] {
                    if given {
                        self.problem(&format!("{item}.{key}"), "does not go with `response`, from which it follows");
                        return None;
                    }
                }
                self.responses(item, files, toml.columns.as_deref())?
            }
            _ => self.plain_bands(item, toml)?,
        };
        let lights = match &toml.light {
            None => return Some(bands),
            Some(LightsToml::All(light)) => vec![*light; bands.len()],
            Some(LightsToml::Each(lights)) => lights.clone(),
        };
        if lights.len() != bands.len() {
            let message =
                format!("{} lights for {} bands: give one for each, or one for all", lights.len(), bands.len());
            self.problem(&format!("{item}.light"), message);
            return None;
        }
        for (band, light) in bands.iter_mut().zip(lights) {
            band.light = light.into();
        }
        Some(bands)
    }

    /// Bands by their centres and widths; some of them may be tables.
    fn plain_bands(&mut self, item: &str, toml: &BandsToml) -> Option<Vec<Band>> {
        let mut bands = self.centres(item, toml)?;
        let is_good = self.check_centres(item, toml, &bands);
        self.widths(item, toml, &mut bands)?;
        let is_narrow = |w: f64, band: &Band| w > 0.0 && w < f64::EPSILON.sqrt() * band.centre_um;
        let narrow: Vec<usize> =
            (0..bands.len()).filter(|&i| bands[i].fwhm_um.is_some_and(|w| is_narrow(w, &bands[i]))).collect();
        if let Some(&first) = narrow.first() {
            let message = format!(
                "{} bands are narrower than the digits of wavelengths, as that at {} um: taken as monochromatic",
                narrow.len(),
                number(bands[first].centre_um)
            );
            self.note(&format!("{item}.fwhm_um"), message);
            narrow.into_iter().for_each(|i| bands[i].fwhm_um = None);
        }
        let odd = bands.iter().find(|b| b.fwhm_um.is_some_and(|w| !(w > 0.0 && w <= 2.0 * b.centre_um)));
        if let Some(Band { centre_um, fwhm_um: Some(fwhm_um), .. }) = odd.filter(|_| is_good) {
            let message = format!("a width of {} um for a band at {centre_um} um", number(*fwhm_um));
            let help =
                "widths are in um, positive and at most twice the centre; leave them out for monochromatic bands";
            self.helped(&format!("{item}.fwhm_um"), message, help);
            return None;
        }
        let shapes = match &toml.shape {
            None => vec![ShapeToml::Gaussian; bands.len()],
            Some(ShapesToml::All(shape)) => vec![*shape; bands.len()],
            Some(ShapesToml::Each(shapes)) => shapes.clone(),
        };
        let at = format!("{item}.shape");
        if shapes.len() != bands.len() {
            let message =
                format!("{} shapes for {} bands: give one for each, or one for all", shapes.len(), bands.len());
            self.problem(&at, message);
            return None;
        }
        if let Some(shape) = [(ShapeToml::Box, "a box"), (ShapeToml::Sinc2, "a squared sinc")]
            .iter()
            .find(|(shape, _)| shapes.contains(shape) && bands.iter().all(|b| b.fwhm_um.is_none()))
        {
            self.problem(&at, format!("{} needs its width: give `fwhm_um`", shape.1));
            return None;
        }
        let wanted = shapes.iter().filter(|s| **s == ShapeToml::Table).count();
        let tables = match &toml.response {
            None => vec![],
            Some(files) => self.responses(item, files, toml.columns.as_deref())?,
        };
        if tables.len() != wanted {
            let message = format!("{} responses for {wanted} bands of the shape \"table\"", tables.len());
            let help = "with `response` alone all bands are tables: leave out centres and widths";
            self.helped(
                &format!("{item}.{}", if toml.response.is_some() { "response" } else { "shape" }),
                message,
                help,
            );
            return None;
        }
        let mut tables = tables.into_iter();
        for (band, shape) in bands.iter_mut().zip(shapes) {
            match shape {
                ShapeToml::Gaussian => {}
                ShapeToml::Box => band.response = Response::Box,
                ShapeToml::Sinc2 => band.response = Response::Sinc2,
                ShapeToml::Table => *band = tables.next()?,
            }
        }
        is_good.then_some(bands)
    }

    /// A band for each column of tables of responses, or for those that are named.
    fn responses(&mut self, item: &str, files: &ResponseToml, wanted: Option<&[String]>) -> Option<Vec<Band>> {
        let at = format!("{item}.response");
        let files = match files {
            ResponseToml::One(file) => std::slice::from_ref(file),
            ResponseToml::Several(files) => files,
        };
        let mut all = Vec::new();
        for file in files {
            let read = response_csv::read(&self.path(file));
            let (responses, input) = self.taken(&at, read)?;
            if !self.inputs.contains(&input) {
                self.inputs.push(input);
            }
            self.notes.extend(responses.notes.into_iter().map(|note| format!("{at}: {note}")));
            all.extend(responses.columns);
        }
        let taken: Vec<&(String, Spectrum)> = match wanted {
            None => all.iter().collect(),
            Some(names) => {
                let mut taken = Vec::new();
                for (i, name) in names.iter().enumerate() {
                    let Some(found) = all.iter().find(|(column, _)| column == name) else {
                        let known: Vec<&str> = all.iter().map(|(column, _)| column.as_str()).collect();
                        let message = format!("no response {name:?} in the table");
                        let help = format!("they are {}", known.join(", "));
                        self.helped(&format!("{item}.columns[{i}]"), message, help);
                        return None;
                    };
                    taken.push(found);
                }
                taken
            }
        };
        let bands: Option<Vec<Band>> = taken
            .iter()
            .map(|(name, response)| Some(Band { name: name.clone(), ..Band::tabulated(response)? }))
            .collect();
        if bands.as_ref().is_none_or(Vec::is_empty) {
            self.problem(&at, "holds no responses");
            return None;
        }
        bands
    }

    fn centres(&mut self, item: &str, toml: &BandsToml) -> Option<Vec<Band>> {
        match (toml.start_um, toml.stop_um, toml.count, &toml.centres_um) {
            (Some(start), Some(stop), Some(count), None) => {
                if start == stop && count > 1 {
                    self.problem(
                        &format!("{item}.count"),
                        format!("{count} bands cannot lie between {start} and {stop} um"),
                    );
                    return None;
                }
                if count == 1 && start != stop {
                    let message = "one band cannot have two centres: make start_um and stop_um equal";
                    self.problem(&format!("{item}.count"), message);
                    return None;
                }
                Some(Band::evenly(start, stop, count))
            }
            (None, None, None, Some(centres)) => {
                Some(centres.iter().map(|&centre_um| Band::new(centre_um, None)).collect())
            }
            _ => {
                self.problem(item, "give `start_um`, `stop_um` and `count`, or `centres_um`, or `response`");
                None
            }
        }
    }

    /// Whether all centres are wavelengths of light in um.
    fn check_centres(&mut self, item: &str, toml: &BandsToml, bands: &[Band]) -> bool {
        if let Some(band) = bands.iter().find(|band| band.centre_um >= USUAL_UM && band.centre_um.is_finite()) {
            let um = number(band.centre_um);
            let nm = number(band.centre_um / 1000.0);
            self.notes.push(format!("{item}: a band at {um} um; if this is nanometres, write {nm}"));
        }
        let is_lit = |i: usize| match &toml.light {
            None => true,
            Some(LightsToml::All(light)) => *light != LightToml::Heat,
            Some(LightsToml::Each(lights)) => lights.get(i) != Some(&LightToml::Heat),
        };
        // Where one is, the others are in the same unit.
        let is_beyond = |i: usize| is_lit(i) && bands[i].centre_um > LONGEST_UM;
        let longest_um = if (0..bands.len()).any(is_beyond) { USUAL_UM } else { LONGEST_UM };
        let is_wrong = |&i: &usize| !(bands[i].centre_um > 0.0 && (bands[i].centre_um <= longest_um || !is_lit(i)));
        let wrong: Vec<usize> = (0..bands.len()).filter(is_wrong).collect();
        // Of evenly spaced bands the ends say it all.
        let told = wrong.iter().filter(|&&i| toml.centres_um.is_some() || i == 0 || i + 1 == bands.len());
        for &i in told.take(TOLD) {
            let place = match toml.centres_um {
                Some(_) => format!("{item}.centres_um[{i}]"),
                None if i == 0 => format!("{item}.start_um"),
                None => format!("{item}.stop_um"),
            };
            let um = bands[i].centre_um;
            let of = if um > longest_um { ", for a band with sunlight" } else { "" };
            let problem = self.problem(&place, format!("{} um is outside 0 to {longest_um} um{of}", number(um)));
            if um > longest_um {
                problem.help = Some(format!("if this is nanometres, write {}", number(um / 1000.0)));
            }
        }
        wrong.is_empty()
    }

    fn widths(&mut self, item: &str, toml: &BandsToml, bands: &mut [Band]) -> Option<()> {
        if let (Some(_), Some(_)) = (&toml.fwhm_um, toml.fwhm_cm_1) {
            self.problem(&format!("{item}.fwhm_cm_1"), "does not go with `fwhm_um`: give one of them");
            return None;
        }
        if let Some(fwhm_cm_1) = toml.fwhm_cm_1 {
            bands.iter_mut().for_each(|band| band.fwhm_um = Some(fwhm_cm_1 / cm_1_per_um(band.centre_um)));
            return Some(());
        }
        match &toml.fwhm_um {
            Some(Fwhm::All(fwhm)) => bands.iter_mut().for_each(|band| band.fwhm_um = Some(*fwhm).filter(|w| *w != 0.0)),
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
    FrameCamera::pitch_of_angle(ifov_mrad * 1e-3, 1)
}

/// The pitch of `samples` pixels whose line subtends this angle, deg.
pub(in crate::formats) fn pitch_of_fov(fov_deg: f64, samples: u32) -> f64 {
    FrameCamera::pitch_of_angle(fov_deg.to_radians(), samples)
}
