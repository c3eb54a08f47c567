//! What lights and warms the surface at an instant.

use std::f64::consts::PI;

use glam::DQuat;

use super::Globe;
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
    pub mars: Option<Globe>,
    /// Further bodies of the sky: the Earth, moons.
    pub bodies: Vec<Globe>,
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

impl Sky {
    /// All spectra that its light is made of.
    pub fn spectra(&self) -> impl Iterator<Item = &Spectrum> {
        let beams = self.beams.iter().map(|beam| &beam.irradiance);
        [&self.sun.irradiance_1au].into_iter().chain(self.globes().map(|globe| &globe.reflectance)).chain(beams)
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
            mars.check("mars", &mut problem);
        }
        for (i, body) in self.bodies.iter().enumerate() {
            let item = body_item(&body.name);
            check_name(&item, &body.name, &mut problem);
            body.check(&item, &mut problem);
            let names = [body.name.clone(), body.heat_name()];
            let of_others = self.bodies[..i].iter().flat_map(|other| [other.name.clone(), other.heat_name()]);
            if names.iter().any(|name| [Sky::SUN, Sky::MARS, Sky::MARS_HEAT].contains(&name.as_str()))
                || of_others.into_iter().any(|other| names.contains(&other))
            {
                problem(&item, "another source has this name".into());
            }
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
                || self.bodies.iter().any(|body| body.name == beam.name || body.heat_name() == beam.name)
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

/// What a body is called in messages.
pub(super) fn body_item(name: &str) -> String {
    format!("bodies.{name:?}")
}

/// Names of sources are parts of names of arrays.
fn check_name(item: &str, name: &str, problem: &mut impl FnMut(&str, String)) {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    if name.is_empty() || !name.chars().all(is_plain) {
        problem(item, "expected a name of letters, digits, - and _".into());
    }
}

impl Beam {
    /// What it is called in messages.
    pub(super) fn item(&self) -> String {
        format!("beams.{:?}", self.name)
    }

    fn check(&self, problem: &mut impl FnMut(&str, String)) {
        check_name(&self.item(), &self.name, problem);
        if let Some(v) = self.irradiance.value().iter().find(|v| !(**v >= 0.0 && v.is_finite())) {
            problem(&format!("{}.irradiance", self.item()), format!("{v} is not a number of at least 0"));
        }
        if !(self.total_irradiance_w_m2 >= 0.0 && self.total_irradiance_w_m2.is_finite()) {
            let message = format!("{} is not a number of at least 0", self.total_irradiance_w_m2);
            problem(&format!("{}.total_irradiance_w_m2", self.item()), message);
        }
    }
}
