//! A scene over time: positions of the spacecraft, the Sun, Mars and other bodies, as seen from the rotating body.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::{Exposure, Past, Scene, Setup, Sky};
use crate::error::{Error, Location, Result};
use crate::flight::{Almanac, Circumstances, Correction, Epoch, Pointing, Up};
use crate::geometry::{Direction, Pose};

/// Half step of the central difference for the ground velocity, s: Phobos turns 0.013 deg.
const BESIDE_S: f64 = 0.5;

/// The motion of a spacecraft about a body, and where its camera looks.
#[derive(Debug, Clone)]
pub struct Motion {
    /// All trajectories and orientations.
    pub almanac: Arc<Almanac>,
    /// The target body.
    pub body: String,
    /// Its body-fixed frame, in which the surface does not move.
    pub frame: String,
    /// Origin of local coordinates in that frame, m.
    pub origin_m: DVec3,
    /// The spacecraft.
    pub spacecraft: String,
    /// The pointing law.
    pub pointing: Pointing,
    /// Light-time correction for Sun and bodies as seen from the surface.
    pub correction: Correction,
    /// Start of the first exposure; scans and jitter count from here.
    pub start: Epoch,
}

/// Conversion of a law's errors, which may be sentences.
struct Refused(Error);

impl From<String> for Refused {
    fn from(message: String) -> Self {
        Refused(Error::invalid(Location::item("flight.pointing"), message))
    }
}

impl Motion {
    /// Position of the spacecraft, from the body's centre in body axes, m.
    ///
    /// # Errors
    /// [`Error::Invalid`] that says what is not known, and when it would be.
    pub fn position_m(&self, epoch: Epoch) -> Result<DVec3> {
        self.almanac.position_by_files_m(&self.spacecraft, &self.body, &self.frame, epoch)
    }

    /// Position of a body of the sky as seen from the surface, from the body's centre in body axes, m.
    ///
    /// # Errors
    /// As [`position_m`](Motion::position_m).
    pub fn seen_m(&self, target: &str, epoch: Epoch) -> Result<DVec3> {
        Ok(self.almanac.apparent(target, &self.body, &self.frame, epoch, self.correction)?.0)
    }

    /// Ground velocity of the spacecraft over the turning body, m/s: central difference; one-sided at the ends of the
    /// data.
    ///
    /// # Errors
    /// As [`position_m`](Motion::position_m).
    pub fn velocity_m_s(&self, epoch: Epoch, position_m: DVec3) -> Result<DVec3> {
        let beside = |by_s: f64| self.position_m(epoch.after_s(by_s));
        match (beside(-BESIDE_S), beside(BESIDE_S)) {
            (Ok(before), Ok(after)) => Ok((after - before) / (2.0 * BESIDE_S)),
            (Ok(before), Err(_)) => Ok((position_m - before) / BESIDE_S),
            (_, after) => Ok((after? - position_m) / BESIDE_S),
        }
    }

    /// The sensor's pose at an epoch, local.
    ///
    /// # Errors
    /// As [`position_m`](Motion::position_m); or that the pointing law is undefined.
    pub fn pose(&self, epoch: Epoch) -> Result<Pose> {
        let position_m = self.position_m(epoch)?;
        let needs_velocity = self.pointing.up == Up::Backward;
        let needs_sun = self.pointing.up == Up::Sun;
        let now = Circumstances {
            position_m,
            velocity_m_s: if needs_velocity { self.velocity_m_s(epoch, position_m)? } else { DVec3::ZERO },
            to_sun: if needs_sun { self.seen_m("SUN", epoch)? } else { DVec3::ZERO },
            t_s: epoch.since_s(self.start),
        };
        let body_from = |frame: &str| -> std::result::Result<DMat3, Refused> {
            self.almanac.rotation(&self.frame, frame, epoch).map_err(Refused)
        };
        let rotation = self.pointing.body_from_sensor(&now, body_from).map_err(|Refused(error)| error)?;
        Ok(Pose { rotation, translation_m: position_m - self.origin_m })
    }

    /// The sky at an epoch: its Sun, Mars and bodies are moved where the almanac covers them, and its past with them;
    /// the rest is unchanged.
    ///
    /// # Errors
    /// As [`position_m`](Motion::position_m).
    pub fn sky(&self, sky: &Sky, epoch: Epoch) -> Result<Sky> {
        let mut sky = sky.clone();
        let local_m = |target: &str| Ok::<_, Error>(self.seen_m(target, epoch)? - self.origin_m);
        let to_sun_m = local_m("SUN")?;
        if let Some(direction) = Direction::new(to_sun_m) {
            (sky.sun.direction, sky.sun.distance_m) = (direction, to_sun_m.length());
        }
        if let Some(mars) = &mut sky.mars {
            mars.centre_m = local_m("MARS")?;
        }
        for globe in &mut sky.bodies {
            if self.knows(&globe.name, self.start) {
                globe.centre_m = local_m(&globe.name)?;
            }
        }
        sky.past = sky.past.map(|_| Past::new(self, epoch));
        Ok(sky)
    }

    /// Whether the almanac knows where a body is.
    pub fn knows(&self, name: &str, epoch: Epoch) -> bool {
        self.almanac.state(name, &self.body, &self.frame, epoch).is_ok()
    }

    /// A scene's exposure at another epoch.
    ///
    /// # Errors
    /// As [`position_m`](Motion::position_m), and as [`Scene::new`].
    pub fn at(&self, scene: &Scene, mut exposure: Exposure, epoch: Epoch) -> Result<Scene> {
        exposure.camera.world_from_sensor = self.pose(epoch)?;
        Scene::new(Setup { sky: self.sky(&scene.sky, epoch)?, exposure, ..Setup::clone(scene) })
    }
}
