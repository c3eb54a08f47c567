//! What lights and warms the surface at an instant.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};

use crate::error::{Location, Problem};
use crate::geometry::Direction;
use crate::physics::sun;
use crate::physics::sun_disc::{self, DiscRule, SubSun};
use crate::spectral::Spectrum;
use crate::units::SUN_RADIUS_M;

/// What lights a body at an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Sky {
    /// The Sun.
    pub sun: Sun,
    /// Mars as a second source, if there is one.
    pub mars: Option<Mars>,
    /// Further sources at infinity.
    pub beams: Vec<Beam>,
    /// How the body turns under it, if that is known.
    pub rotation: Option<Rotation>,
}

/// How a body turns under its sky: at a constant rate, Mars where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// Axis in the body-fixed frame: the body turns about it by the right hand.
    pub axis: Direction,
    /// From noon to noon, s.
    pub period_s: f64,
}

/// Parallel light besides the Sun's: of a lamp, another star, or a part of the Sun's disc.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    /// What it is called: letters, digits, `-` and `_`.
    pub name: String,
    /// Towards its source.
    pub direction: Direction,
    /// Spectral irradiance at the scene on a plane normal to the beam, W m-2 um-1.
    pub irradiance: Spectrum,
    /// Total irradiance on such a plane, for the heat balance, W m-2.
    pub total_irradiance_w_m2: f64,
}

/// The Sun: a direction and a distance, both from the scene's origin.
#[derive(Debug, Clone, PartialEq)]
pub struct Sun {
    /// Towards the Sun.
    pub direction: Direction,
    /// From the origin to the Sun, m.
    pub distance_m: f64,
    /// Spectral irradiance at 1 au on a plane normal to the beam, W m-2 um-1.
    pub irradiance_1au: Spectrum,
    /// Total irradiance at 1 au, for the heat balance, W m-2.
    pub total_irradiance_1au_w_m2: f64,
    /// How much darker its limb is than its middle, u in 1 - u (1 - cos(emission)): 0 to 1, 0 for a uniform disc.
    pub limb_darkening: f64,
}

/// Lambert reflectance of Mars where nothing else is said.
pub const MARS_ALBEDO: f64 = 0.25;

/// Brightness temperatures of the day and night side of Mars where nothing else is said, K.
pub const MARS_DAY_NIGHT_K: [f64; 2] = [270.0, 200.0];

/// Mars as an extended second source.
#[derive(Debug, Clone, PartialEq)]
pub struct Mars {
    /// Centre, local to the scene's origin, axes of the body-fixed frame, m.
    pub centre_m: DVec3,
    /// Radius, m.
    pub radius_m: f64,
    /// Lambert reflectance (dimensionless).
    pub reflectance: Spectrum,
    /// Bond albedo, for the heat balance.
    pub bond_albedo: f64,
    /// Mean thermal exitance of Mars, for the heat balance, W m-2.
    pub thermal_exitance_w_m2: f64,
    /// Brightness temperature of its day and of its night side, for what it emits in bands, K.
    pub day_night_k: [f64; 2],
}

impl Sky {
    /// All spectra that its light is made of.
    pub fn spectra(&self) -> impl Iterator<Item = &Spectrum> {
        let beams = self.beams.iter().map(|beam| &beam.irradiance);
        [&self.sun.irradiance_1au].into_iter().chain(self.mars.iter().map(|mars| &mars.reflectance)).chain(beams)
    }

    /// As it was some time ago, if the body turns: the Sun stood elsewhere.
    #[must_use]
    pub fn ago(&self, time_s: f64) -> Sky {
        let mut sky = self.clone();
        if let Some(Rotation { axis, period_s }) = self.rotation {
            let turn = DQuat::from_axis_angle(axis.vec(), 2.0 * PI * time_s / period_s);
            sky.sun.direction = Direction::new(turn * self.sun.direction.vec()).unwrap_or(self.sun.direction);
        }
        sky
    }

    /// What is wrong with it, whatever it lights.
    pub(super) fn problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut problem = |item: &str, message: String| problems.push(Problem::new(Location::item(item), message));
        self.sun.check(&mut problem);
        if let Some(mars) = &self.mars {
            mars.check(&mut problem);
        }
        if let Some(Rotation { period_s, .. }) = self.rotation
            && !(period_s > 0.0 && period_s.is_finite())
        {
            problem("thermal.period_s", format!("{period_s} s is not a positive time"));
        }
        for (i, beam) in self.beams.iter().enumerate() {
            beam.check(&mut problem);
            if [Sky::SUN, Sky::MARS, Sky::MARS_HEAT].contains(&beam.name.as_str())
                || self.beams[..i].iter().any(|other| other.name == beam.name)
            {
                problem(&beam.item(), "another source has this name".into());
            }
        }
        problems
    }
}

impl Sun {
    /// Spectral irradiance at the scene on a plane normal to the beam, W m-2 um-1; `None` where its spectrum is not known.
    pub fn irradiance_w_m2_um(&self, um: f64) -> Option<f64> {
        Some(sun::irradiance_at(self.irradiance_1au.at(um)?, self.distance_m))
    }

    /// Total irradiance at the scene on a plane normal to the beam, W m-2.
    pub fn total_irradiance_w_m2(&self) -> f64 {
        sun::irradiance_at(self.total_irradiance_1au_w_m2, self.distance_m)
    }

    /// Sine of the angular radius of its disc.
    pub fn sin_radius(&self) -> f64 {
        (SUN_RADIUS_M / self.distance_m).min(1.0)
    }

    /// The points that stand for its disc.
    pub fn sub_suns(&self, rule: DiscRule) -> Vec<SubSun> {
        sun_disc::sub_suns(self.direction, self.sin_radius(), self.limb_darkening, rule)
    }

    fn check(&self, problem: &mut impl FnMut(&str, String)) {
        if !(self.distance_m > 0.0 && self.distance_m.is_finite()) {
            problem("sun", format!("distance {} m is not a positive length", self.distance_m));
        }
        if let Some(v) = self.irradiance_1au.value().iter().find(|v| **v < 0.0) {
            problem("sun.spectrum", format!("irradiance {v} is negative"));
        }
        if !(0.0..=1.0).contains(&self.limb_darkening) {
            problem("sun.limb_darkening", format!("{} is outside 0 to 1", self.limb_darkening));
        }
    }
}

impl Beam {
    /// What it is called in messages.
    pub(super) fn item(&self) -> String {
        format!("beams.{:?}", self.name)
    }

    fn check(&self, problem: &mut impl FnMut(&str, String)) {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
        if self.name.is_empty() || !self.name.chars().all(is_plain) {
            problem(&self.item(), "expected a name of letters, digits, - and _".into());
        }
        if let Some(v) = self.irradiance.value().iter().find(|v| !(**v >= 0.0 && v.is_finite())) {
            problem(&format!("{}.irradiance", self.item()), format!("{v} is not a number of at least 0"));
        }
        if !(self.total_irradiance_w_m2 >= 0.0 && self.total_irradiance_w_m2.is_finite()) {
            let message = format!("{} is not a number of at least 0", self.total_irradiance_w_m2);
            problem(&format!("{}.total_irradiance_w_m2", self.item()), message);
        }
    }
}

impl Mars {
    fn check(&self, problem: &mut impl FnMut(&str, String)) {
        super::near_enough("mars.position_m", self.centre_m, problem);
        for (name, t_k) in ["mars.day_k", "mars.night_k"].iter().zip(self.day_night_k) {
            if !(0.0..=1e4).contains(&t_k) {
                problem(name, format!("{t_k} K is not a temperature of a planet"));
            }
        }
        if !(self.radius_m > 0.0 && self.radius_m.is_finite()) {
            problem("mars.radius_m", format!("{} is not a positive length", self.radius_m));
        } else if self.centre_m.length() <= self.radius_m {
            problem("mars.position_m", "the scene lies inside Mars".into());
        }
    }
}
