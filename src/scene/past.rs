//! Illumination history: the solar day that ends at the scene's epoch, by flight dynamics.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec3;

use super::{Motion, Rotation, Sky};
use crate::error::Result;
use crate::flight::{Epoch, J2000};
use crate::geometry::Direction;

/// Half step for rotation rates, s: Phobos turns 0.013 deg.
const TURNED_S: f64 = 1.0;
/// Iterations for the length of a day, each of which gains a digit or more.
const STEPS: usize = 16;
/// Rounding of products of rotations.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Positions of the Sun and bodies before an epoch.
#[derive(Debug, Clone)]
pub struct Past {
    motion: Arc<Motion>,
    now: Epoch,
}

impl PartialEq for Past {
    /// Whether both have the same epoch and almanac.
    fn eq(&self, other: &Self) -> bool {
        let (a, b) = (&self.motion, &other.motion);
        self.now == other.now
            && Arc::ptr_eq(&a.almanac, &b.almanac)
            && (&a.body, &a.frame, a.origin_m, a.correction) == (&b.body, &b.frame, b.origin_m, b.correction)
    }
}

impl Past {
    /// What was before a moment.
    pub fn new(motion: &Motion, now: Epoch) -> Self {
        Past { motion: Arc::new(motion.clone()), now }
    }

    /// A sky at a time ago, s.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) that says what is not known, and when it would be: nothing is extrapolated.
    pub fn sky(&self, sky: &Sky, ago_s: f64) -> Result<Sky> {
        self.motion.sky(sky, self.now.after_s(-ago_s))
    }
}

impl Motion {
    /// The body's rotation relative to the Sun: its axis now, and the time since the Sun was last over the same
    /// meridian. `None` for a body that does not rotate.
    ///
    /// A body that librates (Phobos by 1.1 deg each day) is evaluated twice, a day apart.
    ///
    /// # Errors
    /// As [`position_m`](Motion::position_m), if a day ago is not known.
    pub fn day(&self, epoch: Epoch) -> Result<Option<Rotation>> {
        let turned = |ago_s: f64| self.almanac.rotation(&self.frame, J2000, epoch.after_s(-ago_s));
        // What carries components along its axes now into those that they had before: a turn by the right hand, as the body's.
        let back = turned(TURNED_S)? * turned(0.0)?.transpose();
        let axis_sin = 0.5
            * DVec3::new(back.y_axis.z - back.z_axis.y, back.z_axis.x - back.x_axis.z, back.x_axis.y - back.y_axis.x);
        // Less is rounding.
        let Some(axis) = Direction::new(axis_sin).filter(|_| axis_sin.length() > ROUNDING) else { return Ok(None) };
        let (east, north) = axis.frame();
        let longitude_rad = |ago_s: f64| {
            let to_sun_m = self.seen_m("SUN", epoch.after_s(-ago_s))?;
            Ok::<_, crate::Error>(to_sun_m.dot(north).atan2(to_sun_m.dot(east)))
        };
        let now_rad = longitude_rad(0.0)?;
        let further_rad =
            |ago_s: f64| Ok::<_, crate::Error>((longitude_rad(ago_s)? - now_rad + PI).rem_euclid(TAU) - PI);
        // How fast the Sun goes, by the body's own turn and its way about the Sun; as the body turns, if it stands over a pole.
        let gone_rad = further_rad(TURNED_S)?;
        let gone_rad = if gone_rad.abs() > ROUNDING { gone_rad } else { axis_sin.length().min(1.0).asin() };
        let mut period_s = TAU * TURNED_S / gone_rad.abs();
        for _ in 0..STEPS {
            period_s *= 1.0 - gone_rad.signum() * further_rad(period_s)? / TAU;
        }
        Ok(Some(Rotation { axis, period_s }))
    }
}
