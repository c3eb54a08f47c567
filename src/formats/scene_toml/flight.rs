//! Flight dynamics in a scene: its files, orbits and laws of pointing.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::TomlReader;
use super::types::{
    CorrectionToml, FlightToml, JitterToml, KindToml, PointingToml, Preset, ScanToml, SensorAxisToml, SensorToml,
    SunToml, UpNameToml, UpToml,
};
use crate::error::{Error, Problem, Result};
use crate::flight::{Aim, Almanac, Correction, Epoch, Jitter, Pointing, Qso, Scan, Span, Up, body_name, frame_name};
use crate::formats::ephemeris::Furnished;
use crate::formats::{InputFile, ephemeris};
use crate::geometry::Pose;
use crate::report::Fate;
use crate::scene::{Mirror, Motion, Readout, Timing};

/// What carries the camera on an orbit by name, where nothing else is said.
const SPACECRAFT: &str = "SPACECRAFT";
/// An orbit by name is known for so long before and after the scene, and what else it is looked at, s: ten days.
const ORBIT_S: f64 = 864_000.0;
/// Such moments farther away than this are left unknown, s: 400 days, after which an orbit that is computed is not a spacecraft's.
const MOST_ORBIT_S: f64 = 3.456e7;

/// Moments are 0.12 us apart: of a shorter period that would be more than 1 %.
const LEAST_PERIOD_S: f64 = 1e-5;

/// Where things are at the moment of a scene, along the body's axes from its centre, m.
pub(super) struct Placed {
    pub(super) sun_m: DVec3,
    pub(super) mars_m: Option<DVec3>,
    pub(super) pose: Pose,
}

impl TomlReader<'_> {
    pub(super) fn motion(&mut self, toml: &FlightToml) -> Option<Motion> {
        let mut almanac = Almanac::with_rough_trajectories();
        let paths: Vec<PathBuf> = toml.files.iter().map(|name| self.path(name)).collect();
        let mut all_read = true;
        for (i, path) in paths.iter().enumerate().filter(|(_, path)| !path.is_file()) {
            all_read = false;
            let why = if path.is_dir() { "is a folder, but a file is needed" } else { "there is no such file" };
            self.problem(&format!("flight.files[{i}]"), format!("{}: {why}", path.display()));
        }
        if all_read {
            let read = ephemeris::furnish_all(&paths, &mut almanac);
            let read = self.taken("flight.files", read);
            all_read = read.is_some();
            let Furnished { paths, report, doubts } = read.unwrap_or_default();
            self.notes.extend(doubts.iter().map(|doubt| format!("flight.files: {doubt}")));
            for path in paths {
                let input = self.taken("flight.files", InputFile::hashed(&path));
                self.inputs.extend(input.filter(|input| !self.inputs.contains(input)));
            }
            for note in report.notes {
                let what = format!("{}: {}", note.at, note.message);
                match note.fate {
                    Fate::Defaulted => self.stated("flight.files", what),
                    _ => self.note("flight.files", what),
                }
            }
        }
        let start = self.epoch("flight.epoch", &toml.epoch, &almanac);
        let body = match &toml.body {
            Some(name) => body_name(name),
            None => {
                self.stated("flight.body", "PHOBOS");
                "PHOBOS".to_owned()
            }
        };
        let frame = toml.frame.as_deref().map_or_else(|| format!("IAU_{body}"), frame_name);
        let spacecraft = self.spacecraft(toml, &body, start, &mut almanac);
        let pointing = self.pointing(toml.pointing.as_ref().unwrap_or(&PointingToml::default()));
        let correction = match toml.correction {
            None | Some(CorrectionToml::None) => Correction::None,
            Some(CorrectionToml::LightTime) => Correction::LightTime,
            Some(CorrectionToml::LightTimeAndAberration) => Correction::LightTimeAndAberration,
        };
        all_read.then_some(())?;
        Some(Motion {
            almanac: Arc::new(almanac),
            body,
            frame,
            origin_m: self.origin_m,
            spacecraft: spacecraft?,
            pointing: pointing?,
            correction,
            start: start?,
        })
    }

    fn epoch(&mut self, item: &str, text: &str, almanac: &Almanac) -> Option<Epoch> {
        match Epoch::parse(text, None, &almanac.leap) {
            Ok(epoch) => Some(epoch),
            Err(why) => {
                self.problem(item, why);
                None
            }
        }
    }

    /// The name of what carries the camera, whose orbit, if it has a name, goes into the almanac.
    fn spacecraft(
        &mut self,
        toml: &FlightToml,
        body: &str,
        start: Option<Epoch>,
        almanac: &mut Almanac,
    ) -> Option<String> {
        let Some(name) = &toml.orbit else {
            if toml.orbit_epoch.is_some() {
                self.problem("flight.orbit_epoch", "needs `orbit`");
                return None;
            }
            let Some(spacecraft) = &toml.spacecraft else {
                let help = "give `spacecraft`, a name in `files`, or `orbit`, e.g. \"qso-20x27\"";
                self.helped("flight", "the spacecraft is missing", help);
                return None;
            };
            return Some(body_name(spacecraft));
        };
        if body != "PHOBOS" {
            self.problem("flight.orbit", format!("orbits by name are about PHOBOS, not {body}"));
            return None;
        }
        let orbit = Qso::named(name).map_err(|why| self.problem("flight.orbit", why).message.clone()).ok();
        let at = match &toml.orbit_epoch {
            Some(text) => self.epoch("flight.orbit_epoch", text, almanac)?,
            None => start?,
        };
        let start = start?;
        let alone = Span { start, end: start };
        let around = self.moments.map_or(alone, |moments| moments(start, &almanac.leap));
        let [before_s, after_s] = [start.since_s(around.start), around.end.since_s(start)]
            .map(|beside_s| beside_s.clamp(0.0, MOST_ORBIT_S) + ORBIT_S);
        let span = Span { start: start.after_s(-before_s), end: start.after_s(after_s) };
        let spacecraft = toml.spacecraft.as_deref().unwrap_or(SPACECRAFT);
        if almanac.trajectories.iter().any(|of| of.target == almanac.names.body(spacecraft)) {
            let message = format!("`files` already cover {spacecraft}: leave `orbit` out, or rename the spacecraft");
            self.problem("flight.orbit", message);
            return None;
        }
        match orbit?.trajectory(name, spacecraft, at, span) {
            Ok(trajectory) => almanac.trajectories.push(trajectory),
            Err(why) => {
                self.problem("flight.orbit", why);
                return None;
            }
        }
        Some(body_name(spacecraft))
    }

    pub(super) fn pointing(&mut self, toml: &PointingToml) -> Option<Pointing> {
        let item = |key: &str| format!("flight.pointing.{key}");
        let frame_from_sensor = match toml.frame_from_sensor_xyzw {
            Some(xyzw) => self.rotation(&item("frame_from_sensor_xyzw"), xyzw)?,
            None => DMat3::IDENTITY,
        };
        let turned = toml.frame.is_some() || toml.fixed_in.is_some();
        if !turned && toml.frame_from_sensor_xyzw.is_some() {
            self.problem(&item("frame_from_sensor_xyzw"), "needs `frame` or `fixed_in`");
            return None;
        }
        if turned && toml.up.is_some() {
            self.problem(&item("up"), "`up` cannot be combined with `frame` or `fixed_in`");
            return None;
        }
        let aim = match (toml.target_m, &toml.frame, &toml.fixed_in) {
            (None, None, None) => Aim::Nadir,
            (Some(target_m), None, None) => Aim::Target(DVec3::from_array(target_m)),
            (None, Some(frame), None) => Aim::Frame(frame_name(frame), frame_from_sensor),
            (None, None, Some(frame)) => Aim::Fixed(frame_name(frame), frame_from_sensor),
            _ => {
                self.problem(
                    "flight.pointing",
                    "at most one of `target_m`, `frame` and `fixed_in` may be given (none: nadir)",
                );
                return None;
            }
        };
        let up = match toml.up {
            None | Some(UpToml::Named(UpNameToml::North)) => Up::North,
            Some(UpToml::Named(UpNameToml::Backward)) => Up::Backward,
            Some(UpToml::Named(UpNameToml::Sun)) => Up::Sun,
            Some(UpToml::Direction(up)) => Up::Vector(DVec3::from_array(up)),
        };
        let jitter = match &toml.jitter {
            Some(jitter) => Some(self.jitter(jitter)?),
            None => None,
        };
        Some(Pointing {
            aim,
            up,
            scan: toml.scan.as_ref().map(scan),
            bias_rad: DVec3::from_array(toml.bias_mrad.unwrap_or_default()) * 1e-3,
            jitter,
        })
    }

    fn jitter(&mut self, toml: &JitterToml) -> Option<Jitter> {
        let [low, high] = toml.band_hz;
        if !(0.0..=high).contains(&low) {
            self.problem("flight.pointing.jitter.band_hz", format!("{low} to {high} Hz: must be 0 <= low <= high"));
            return None;
        }
        if toml.rms_mrad.iter().any(|rms| *rms < 0.0) {
            self.problem("flight.pointing.jitter.rms_mrad", "must not be negative");
            return None;
        }
        let rms_rad = DVec3::from_array(toml.rms_mrad) * 1e-3;
        Some(Jitter { seed: toml.seed.unwrap_or(1), rms_rad, band_hz: toml.band_hz })
    }

    /// Where things are in the middle of the first exposure.
    pub(super) fn placed_by(&mut self, motion: &Motion, timing: Timing, has_mars: bool) -> Option<Placed> {
        let epoch = motion.start.after_s(timing.middle_s(0));
        let sun_m = motion.seen_m("SUN", epoch);
        let mars_m = has_mars.then(|| motion.seen_m("MARS", epoch)).transpose();
        let pose = motion.pose(epoch);
        if motion.almanac.is_rough("SUN", &motion.body) {
            self.stated(
                "flight",
                "position of the Sun: approximate, by mean elements of Mars; give files for more accuracy",
            );
        }
        if has_mars && motion.almanac.is_rough("MARS", &motion.body) {
            self.stated(
                "flight",
                "position of Mars: approximate, along the body's long axis; give files for more accuracy",
            );
        }
        let sun_m = self.known("flight", sun_m);
        let mars_m = self.known("flight", mars_m);
        let pose = self.known("flight", pose);
        Some(Placed { sun_m: sun_m?, mars_m: mars_m?, pose: pose? })
    }

    /// When what of the image is taken.
    pub(super) fn timing(&mut self, toml: &SensorToml, flies: bool) -> Option<Timing> {
        let preset = toml.preset.map(Preset::instrument).filter(|_| flies);
        let readout = match toml.kind {
            None => preset.map_or(Readout::Frame, |instrument| instrument.readout),
            Some(KindToml::Frame) => Readout::Frame,
            Some(KindToml::TunableFilter) => Readout::Band,
            Some(KindToml::PushBroom) => Readout::Line,
            Some(KindToml::WhiskBroom) => return self.whisk_broom(toml, flies),
        };
        if toml.mirror.is_some() {
            self.problem("sensor.mirror", "needs `kind` = \"whisk_broom\"");
            return None;
        }
        let poses = toml.exposure_poses.unwrap_or(0);
        if poses > 1 && !flies {
            self.helped(
                "sensor.exposure_poses",
                "needs `[flight]`, which says how the camera moves",
                "or leave it out",
            );
            return None;
        }
        if readout == Readout::Frame {
            if toml.period_s.is_some() {
                self.problem("sensor.period_s", "needs `kind` = \"tunable_filter\", \"push_broom\" or \"whisk_broom\"");
                return None;
            }
            return Some(Timing { readout, period_s: 0.0, exposure_s: toml.exposure_s.unwrap_or(0.0), poses });
        }
        if !flies {
            let help = "or leave `kind` out: the whole image is then taken at once";
            self.helped("sensor.kind", "needs `[flight]`: the scene moves between exposures", help);
            return None;
        }
        let by_preset = preset.filter(|of| of.readout == readout).and_then(|of| Some((of.period_s?, of.name)));
        if let (None, Some((period_s, name))) = (toml.period_s, by_preset) {
            self.stated("sensor.period_s", format!("{period_s}: {name}"));
        }
        let Some(period_s) = toml.period_s.or(by_preset.map(|(period_s, _)| period_s)) else {
            self.problem("sensor", "`period_s` is missing: the time from one to the next");
            return None;
        };
        if period_s < LEAST_PERIOD_S {
            let message = format!("{period_s} s is below the resolution of time, {LEAST_PERIOD_S:e} s");
            self.problem("sensor.period_s", message);
            return None;
        }
        let exposure_s = toml.exposure_s.unwrap_or(period_s);
        if exposure_s > period_s {
            self.problem("sensor.exposure_s", format!("{exposure_s} s is longer than `period_s`, {period_s} s"));
            return None;
        }
        Some(Timing { readout, period_s, exposure_s, poses })
    }

    /// When a whisk-broom takes its samples.
    fn whisk_broom(&mut self, toml: &SensorToml, flies: bool) -> Option<Timing> {
        if !flies {
            let help = "or leave `kind` out: the whole image is then taken at once";
            self.helped("sensor.kind", "needs `[flight]`: the scene moves between exposures", help);
            return None;
        }
        let (Some(mirror), Some(period_s)) = (toml.mirror, toml.period_s) else {
            let help = "mirror = { field_deg = 30, active = 0.8 } and period_s = 2";
            self.helped("sensor", "a whisk-broom needs `mirror`, and `period_s` from sweep to sweep", help);
            return None;
        };
        if toml.distortion.is_some() || toml.directions.is_some() {
            let message = "cannot be combined with a whisk-broom, whose elements look along the boresight";
            self.problem(if toml.directions.is_some() { "sensor.directions" } else { "sensor.distortion" }, message);
            return None;
        }
        let (Some(samples), Some(lines)) = (toml.samples, toml.lines) else {
            self.problem("sensor", "a whisk-broom needs `samples` and `lines`");
            return None;
        };
        let elements = mirror.elements.unwrap_or(1);
        if elements == 0 || !lines.is_multiple_of(elements) {
            let message = format!("{lines} lines are not a whole number of sweeps of {elements}");
            self.problem("sensor.lines", message);
            return None;
        }
        let sample_s = mirror.active.unwrap_or(1.0) * period_s / f64::from(samples);
        if sample_s.is_nan() || sample_s < LEAST_PERIOD_S {
            let message = format!("a sample of {sample_s} s is below the resolution of time, {LEAST_PERIOD_S:e} s");
            self.problem("sensor.period_s", message);
            return None;
        }
        if mirror.field_deg == 0.0 || !mirror.field_deg.is_finite() {
            self.problem("sensor.mirror.field_deg", format!("must not be 0: {}", mirror.field_deg));
            return None;
        }
        let exposure_s = toml.exposure_s.unwrap_or(sample_s);
        if exposure_s > sample_s {
            self.problem("sensor.exposure_s", format!("{exposure_s} s is longer than a sample, {sample_s} s"));
            return None;
        }
        let poses = toml.exposure_poses.unwrap_or(0);
        let step_rad = mirror.field_deg.to_radians() / f64::from(samples);
        let readout = Readout::Sample(Mirror { samples, sample_s, step_rad, elements });
        Some(Timing { readout, period_s, exposure_s, poses })
    }

    /// What flight dynamics say, or the problem of the item that asks for it.
    pub(super) fn known<T>(&mut self, item: &str, said: Result<T>) -> Option<T> {
        let at = self.place_of(item);
        let here = |error| match error {
            Error::Invalid(problems) => {
                Error::Invalid(problems.into_iter().map(|problem| Problem { at: at.clone(), ..problem }).collect())
            }
            other => other,
        };
        self.taken(item, said.map_err(here))
    }

    /// What a scene says of the Sun, with the position that flight dynamics gives it.
    pub(super) fn sun_placed(&mut self, toml: &SunToml, placed: Option<&Placed>) -> Option<SunToml> {
        if toml.position_m.is_some() || toml.direction.is_some() || toml.distance_au.is_some() {
            self.problem("sun", "the Sun comes from `flight`: leave its position, direction and distance out");
            return None;
        }
        Some(SunToml { frame: None, position_m: Some(placed?.sun_m.to_array()), ..toml.clone() })
    }
}

fn scan(toml: &ScanToml) -> Scan {
    let axis = match toml.axis {
        SensorAxisToml::X => DVec3::X,
        SensorAxisToml::Y => DVec3::Y,
        SensorAxisToml::Z => DVec3::Z,
    };
    Scan { axis, start_rad: toml.start_deg.unwrap_or(0.0).to_radians(), rate_rad_s: toml.rate_deg_s.to_radians() }
}
