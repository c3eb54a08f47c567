//! Where a camera looks: pointing laws and their disturbances.
//!
//! Sensor axes: +X sample (right), +Y line (down), +Z boresight. Rotations of a disturbance or a scan are about these axes, by the right hand.

use std::f64::consts::{SQRT_2, TAU};

use glam::{DMat3, DQuat, DVec3};

use crate::geometry::Direction;
use crate::random::Draws;

/// Number of sines that make up jitter.
const WAVES: u32 = 64;
/// Least angle between `up` and the boresight, rad.
const ALONG: f64 = 16.0 * f64::EPSILON;

/// What the boresight follows.
#[derive(Debug, Clone, PartialEq)]
pub enum Aim {
    /// The body's centre.
    Nadir,
    /// A point of the body, from its centre along its axes, m.
    Target(DVec3),
    /// A frame of the almanac, e.g. a spacecraft's from an attitude file, and the rotation from sensor axes into that
    /// frame.
    Frame(String, DMat3),
    /// Fixed in a frame of the almanac: the rotation from sensor axes into that frame.
    Fixed(String, DMat3),
}

/// The image's up direction, where the aim leaves it open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Up {
    /// The body's +z.
    North,
    /// Opposite to the ground velocity: later lines lie lower in the image (along-track is down).
    Backward,
    /// The Sun.
    Sun,
    /// A direction along the body's axes.
    Vector(DVec3),
}

/// A constant-rate rotation about a sensor axis, e.g. by a scan mirror.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scan {
    /// About the sensor's X, Y or Z.
    pub axis: DVec3,
    /// At the start, rad.
    pub start_rad: f64,
    /// rad/s.
    pub rate_rad_s: f64,
}

/// Small rotations about the three axes: random sines with a flat spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jitter {
    /// Seed of the random sines.
    pub seed: u64,
    /// Root mean square about each axis, rad.
    pub rms_rad: DVec3,
    /// Lowest and highest frequency, Hz.
    pub band_hz: [f64; 2],
}

impl Jitter {
    /// Rotations about the axes, rad, at a time after the start, s.
    pub fn at(&self, t_s: f64) -> DVec3 {
        let mut draws = Draws::new(self.seed);
        let mut share = || draws.unit();
        let [low, high] = self.band_hz;
        let mut sum = DVec3::ZERO;
        for wave in 0..WAVES {
            // One in each part of the band, so that the spectrum is flat whatever the seed.
            let hz = low + (high - low) * (f64::from(wave) + share()) / f64::from(WAVES);
            sum += DVec3::from_array([0; 3].map(|_| (TAU * (hz * t_s + share())).cos()));
        }
        self.rms_rad * sum * (SQRT_2 / f64::from(WAVES).sqrt())
    }
}

/// Where a camera looks.
#[derive(Debug, Clone, PartialEq)]
pub struct Pointing {
    /// What the boresight follows.
    pub aim: Aim,
    /// The up direction.
    pub up: Up,
    /// A scan, applied after the aim.
    pub scan: Option<Scan>,
    /// Constant error about the axes, rad.
    pub bias_rad: DVec3,
    /// Time-varying error.
    pub jitter: Option<Jitter>,
}

/// What a pointing law needs at an epoch, in body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circumstances {
    /// The spacecraft, from the body's centre, m.
    pub position_m: DVec3,
    /// Its velocity over the turning body, m/s.
    pub velocity_m_s: DVec3,
    /// Towards the Sun.
    pub to_sun: DVec3,
    /// Since the start, s.
    pub t_s: f64,
}

impl Pointing {
    /// The rotation from sensor axes to body axes; `body_from` gives that of a frame.
    ///
    /// # Errors
    /// What `body_from` returns; or why the attitude is undefined, as a sentence.
    pub fn body_from_sensor<E: From<String>>(
        &self,
        now: &Circumstances,
        body_from: impl FnOnce(&str) -> Result<DMat3, E>,
    ) -> Result<DMat3, E> {
        let looking = |towards: DVec3, at: &str| -> Result<DMat3, E> {
            let boresight = Direction::new(towards)
                .ok_or_else(|| format!("the spacecraft is at {at}: the direction to it is undefined"))?;
            Ok(self.upright(boresight, now)?)
        };
        let aimed = match &self.aim {
            Aim::Nadir => looking(-now.position_m, "the body's centre")?,
            Aim::Target(target_m) => looking(*target_m - now.position_m, "its target")?,
            Aim::Frame(frame, frame_from_sensor) | Aim::Fixed(frame, frame_from_sensor) => {
                body_from(frame)? * *frame_from_sensor
            }
        };
        let scan = self.scan.map_or(DQuat::IDENTITY, |scan| {
            DQuat::from_axis_angle(scan.axis, scan.start_rad + scan.rate_rad_s * now.t_s)
        });
        let error_rad = self.bias_rad + self.jitter.map_or(DVec3::ZERO, |jitter| jitter.at(now.t_s));
        Ok(aimed * DMat3::from_quat(scan * DQuat::from_scaled_axis(error_rad)))
    }

    fn upright(&self, boresight: Direction, now: &Circumstances) -> Result<DMat3, String> {
        let (up, name) = match self.up {
            Up::North => (DVec3::Z, "north"),
            Up::Backward => (-now.velocity_m_s, "the ground velocity"),
            Up::Sun => (now.to_sun, "the Sun"),
            Up::Vector(up) => (up, "`up`"),
        };
        let across =
            Direction::new(up).map(|up| boresight.vec().cross(up.vec())).filter(|across| across.length() > ALONG);
        let right = across.and_then(Direction::new);
        let right = right
            .ok_or_else(|| {
                format!("the image's top is undefined: {name} is along the line of sight; choose another `up`")
            })?
            .vec();
        Ok(DMat3::from_cols(right, boresight.vec().cross(right), boresight.vec()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pointing(aim: Aim, up: Up) -> Pointing {
        Pointing { aim, up, scan: None, bias_rad: DVec3::ZERO, jitter: None }
    }

    fn on_x(t_s: f64) -> Circumstances {
        Circumstances { position_m: DVec3::X * 2e4, velocity_m_s: DVec3::NEG_Y, to_sun: DVec3::new(0.0, 1.0, 1.0), t_s }
    }

    fn rotation(law: &Pointing, now: &Circumstances) -> DMat3 {
        law.body_from_sensor(now, |_| Err::<DMat3, String>("no frames".into())).unwrap()
    }

    #[test]
    fn nadir_looks_at_the_centre_with_its_top_where_it_is_told() {
        // From +x: the boresight is -x. North up: right is... seen from +x looking to -x with z up, +y is to the right.
        let axes = rotation(&pointing(Aim::Nadir, Up::North), &on_x(0.0));
        assert_eq!(axes, DMat3::from_cols(DVec3::Y, DVec3::NEG_Z, DVec3::NEG_X));
        // Moving along -y: lines go down along -y.
        let axes = rotation(&pointing(Aim::Nadir, Up::Backward), &on_x(0.0));
        assert_eq!(axes.y_axis, DVec3::NEG_Y);
        let axes = rotation(&pointing(Aim::Target(DVec3::new(0.0, 2e4, 0.0)), Up::North), &on_x(0.0));
        assert!((axes.z_axis - DVec3::new(-1.0, 1.0, 0.0).normalize()).length() < 1e-15);
    }

    #[test]
    fn what_has_no_direction_is_said() {
        let now = Circumstances { position_m: DVec3::ZERO, ..on_x(0.0) };
        let said = |law: Pointing, now: &Circumstances| {
            law.body_from_sensor(now, |_| Err::<DMat3, String>("no frames".into())).unwrap_err()
        };
        assert!(said(pointing(Aim::Nadir, Up::North), &now).contains("centre"));
        let above = Circumstances { position_m: DVec3::Z * 2e4, ..on_x(0.0) };
        assert!(said(pointing(Aim::Nadir, Up::North), &above).contains("north is along"));
        assert_eq!(said(pointing(Aim::Frame("SC".into(), DMat3::IDENTITY), Up::North), &above), "no frames");
    }

    #[test]
    fn a_scan_turns_steadily_and_a_bias_stays() {
        // About +X by the right hand: the boresight goes from +Z towards -Y, up in the image.
        let mut law = pointing(Aim::Nadir, Up::North);
        law.scan = Some(Scan { axis: DVec3::X, start_rad: 0.1, rate_rad_s: 0.01 });
        let still = rotation(&pointing(Aim::Nadir, Up::North), &on_x(0.0));
        let boresight = still.transpose() * rotation(&law, &on_x(10.0)).z_axis;
        assert!((boresight - DVec3::new(0.0, -0.2_f64.sin(), 0.2_f64.cos())).length() < 1e-15);
        law.scan = None;
        law.bias_rad = DVec3::new(0.0, 1e-3, 0.0);
        let boresight = still.transpose() * rotation(&law, &on_x(99.0)).z_axis;
        assert!((boresight - DVec3::new(1e-3_f64.sin(), 0.0, 1e-3_f64.cos())).length() < 1e-15);
    }

    #[test]
    fn jitter_has_the_size_and_the_frequencies_it_is_told() {
        let jitter = Jitter { seed: 7, rms_rad: DVec3::new(1e-4, 2e-4, 0.0), band_hz: [1.0, 5.0] };
        // Long against 1 / (band / WAVES): 16 s.
        let (count, step_s) = (200_000, 0.0137);
        let squares: DVec3 = (0..count).map(|i| jitter.at(f64::from(i) * step_s)).map(|turn| turn * turn).sum();
        let rms = squares / f64::from(count);
        assert!((rms.x.sqrt() / 1e-4 - 1.0).abs() < 0.02 && (rms.y.sqrt() / 2e-4 - 1.0).abs() < 0.02, "{rms:?}");
        assert_eq!(rms.z, 0.0);
        assert_ne!(jitter.at(3.0), Jitter { seed: 8, ..jitter }.at(3.0));
        // A second later it has gone on by at most 2 pi 5 Hz x amplitude: slow is slow.
        let slow = Jitter { band_hz: [0.0, 1e-6], ..jitter };
        assert!((slow.at(1.0) - slow.at(0.0)).length() < 1e-4 * 1e-3);
    }
}
