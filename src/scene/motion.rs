//! A scene over time: where the spacecraft, the Sun, Mars and other bodies are at a moment, seen from the turning body.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::{Exposure, Past, Scene, Setup, Sky};
use crate::error::{Error, Location, Result};
use crate::flight::{Almanac, Circumstances, Correction, Epoch, Pointing, Up};
use crate::geometry::{Direction, Pose};

/// Half the time between two positions from which a velocity over the ground follows, s: Phobos turns 0.013 deg.
const BESIDE_S: f64 = 0.5;

/// How a spacecraft flies about a body, and where its camera looks.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Where everything is, and how it is turned.
    pub almanac: Arc<Almanac>,
    /// The body that is looked at.
    pub body: String,
    /// Its own frame, in which the surface does not move.
    pub frame: String,
    /// Origin of local coordinates in that frame, m.
    pub origin_m: DVec3,
    /// What carries the camera.
    pub spacecraft: String,
    /// Where the camera looks.
    pub pointing: Pointing,
    /// What light does on its way from Sun and bodies to the surface.
    pub correction: Correction,
    /// When the first exposure begins; scans and jitter count from here.
    pub start: Epoch,
}

/// Errors of a law that can be a sentence.
struct Refused(Error);

impl From<String> for Refused {
    fn from(message: String) -> Self {
        Refused(Error::invalid(Location::item("flight.pointing"), message))
    }
}

impl Motion {
    /// The spacecraft, from the body's centre along its axes, m.
    ///
    /// # Errors
    /// [`Error::Invalid`] that says what is not known, and when it would be.
    pub fn position_m(&self, epoch: Epoch) -> Result<DVec3> {
        self.almanac.position_by_files_m(&self.spacecraft, &self.body, &self.frame, epoch)
    }

    /// A body of the sky as the surface sees it, from the body's centre along its axes, m.
    ///
    /// # Errors
    /// As [`position_m`](Motion::position_m).
    pub fn seen_m(&self, target: &str, epoch: Epoch) -> Result<DVec3> {
        Ok(self.almanac.apparent(target, &self.body, &self.frame, epoch, self.correction)?.0)
    }

    /// The velocity of the spacecraft over the turning body, m/s; to one side where the other is not known.
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

    /// Where the sensor is and how it stands at a moment, local.
    ///
    /// # Errors
    /// As [`position_m`](Motion::position_m); or that the law of pointing has no answer.
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

    /// A sky at a moment: where it has a Sun, a Mars and bodies that the almanac knows when it starts, they are moved, and so is its past; the rest stays.
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

    /// An exposure of a scene at another moment.
    ///
    /// # Errors
    /// As [`position_m`](Motion::position_m), and as [`Scene::new`].
    pub fn at(&self, scene: &Scene, mut exposure: Exposure, epoch: Epoch) -> Result<Scene> {
        exposure.camera.world_from_sensor = self.pose(epoch)?;
        Scene::new(Setup { sky: self.sky(&scene.sky, epoch)?, exposure, ..Setup::clone(scene) })
    }
}
