//! What lights and warms the surface at an instant.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use glam::DQuat;

use super::{Globe, Past};
use crate::error::{Location, Problem, Result, number};
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
    /// What was before, if flight dynamics knows it for as long as a turn takes; the rotation alone says how long that is.
    pub past: Option<Past>,
}

/// How a body turns under its sky: at a constant rate, Mars where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    /// Axis in the body-fixed frame: the body turns about it by the right hand.
    pub axis: Direction,
    /// From noon to noon, s.
    pub period_s: f64,
}

/// No irradiance is more than this, W m-2 um-1, nor a total of it, W m-2: so that sums of all light, times what surfaces have where they are brightest, are numbers
/// in an image, too, which has 32 bits for each.
pub const MOST_IRRADIANCE: f64 = 1e24;
/// Lengths of a day, s, from noon to noon.
const DAYS_S: RangeInclusive<f64> = 1e-3..=1e18;

/// Says if an irradiance is none, or too much.
pub(super) fn check_irradiance(item: &str, value: f64, problem: &mut impl FnMut(&str, String)) {
    if let Some(message) = out_of_irradiances(value) {
        problem(item, message);
    }
}

/// What is wrong with an irradiance at the scene, W m-2 um-1, or with a total, W m-2, if anything is.
pub fn out_of_irradiances(value: f64) -> Option<String> {
    match value {
        0.0..=MOST_IRRADIANCE => None,
        0.0.. => Some(format!(
            "{} is more than {MOST_IRRADIANCE:e}: an image could not hold its light; is the unit W m-2 um-1?",
            number(value)
        )),
        _ => Some(format!("{} is not a number of at least 0", number(value))),
    }
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

    /// As it was some time ago: all of it, if the past is known; else the Sun stood elsewhere, if the body turns.
    ///
    /// # Errors
    /// As [`Past::sky`].
    pub fn ago(&self, time_s: f64) -> Result<Sky> {
        if let Some(past) = &self.past {
            return past.sky(self, time_s);
        }
        let mut sky = self.clone();
        if let Some(Rotation { axis, period_s }) = self.rotation {
            let turn = DQuat::from_axis_angle(axis.vec(), 2.0 * PI * time_s / period_s);
            sky.sun.direction = Direction::new(turn * self.sun.direction.vec()).unwrap_or(self.sun.direction);
        }
        Ok(sky)
    }

    /// Whether the past is known at all of so many steps of a day, if it is to be known at any.
    ///
    /// # Errors
    /// As [`Past::sky`].
    pub fn reaches_back(&self, steps: u32) -> Result<()> {
        let (Some(past), Some(Rotation { period_s, .. })) = (&self.past, self.rotation) else { return Ok(()) };
        (1..steps).try_for_each(|step| past.sky(self, period_s * f64::from(step) / f64::from(steps)).map(|_| ()))
    }

    /// What is wrong with it, whatever it lights.
    pub(super) fn problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut problem = |item: &str, message: String| problems.push(Problem::new(Location::item(item), message));
        self.sun.check(&mut problem);
        let mut taken = [Sky::SUN, Sky::MARS, Sky::MARS_HEAT].map(str::to_owned).to_vec();
        if let Some(mars) = &self.mars {
            mars.check("mars", &mut problem);
        }
        for (i, body) in self.bodies.iter().enumerate() {
            let item = body_item(i);
            body.check(&item, &mut problem);
            check_name(&item, &[body.name.clone(), body.heat_name()], &mut taken, &mut problem);
        }
        if let Some(Rotation { period_s, .. }) = self.rotation
            && !DAYS_S.contains(&period_s)
        {
            let message =
                format!("{period_s} s is not a length of a day: {:e} to {:e} s", DAYS_S.start(), DAYS_S.end());
            problem("thermal.period_s", message);
        }
        for (i, beam) in self.beams.iter().enumerate() {
            let item = beam_item(i);
            beam.check(&item, &mut problem);
            check_name(&item, std::slice::from_ref(&beam.name), &mut taken, &mut problem);
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
        if self.distance_m > 0.0 && self.distance_m.is_finite() {
            self.check_light(problem);
        } else {
            problem("sun", format!("distance {} m is not a positive length", self.distance_m));
        }
        if !(0.0..=1.0).contains(&self.limb_darkening) {
            problem("sun.limb_darkening", format!("{} is outside 0 to 1", self.limb_darkening));
        }
    }

    /// Says what is wrong with its light at the scene.
    fn check_light(&self, problem: &mut impl FnMut(&str, String)) {
        let at_scene = |v: f64| sun::irradiance_at(v, self.distance_m);
        let wrong = |v: &&f64| **v < 0.0 || out_of_irradiances(at_scene(**v)).is_some();
        if let Some(v) = self.irradiance_1au.value().iter().find(wrong) {
            match *v < 0.0 {
                true => problem("sun.spectrum", format!("irradiance {v} is negative")),
                false => check_irradiance("sun.spectrum", at_scene(*v), problem),
            }
        }
        check_irradiance("sun.total_irradiance_w_m2", self.total_irradiance_w_m2(), problem);
    }
}

/// What a body besides Mars is called in messages, as in a scene file.
pub(super) fn body_item(i: usize) -> String {
    format!("bodies[{i}]")
}

/// What a beam is called in messages, as in a scene file.
pub(super) fn beam_item(i: usize) -> String {
    format!("lamps[{i}]")
}

/// Names of sources, the first of which is stated, are parts of names of arrays, and nobody else's; from then on they are taken.
fn check_name(item: &str, names: &[String], taken: &mut Vec<String>, problem: &mut impl FnMut(&str, String)) {
    let Some(name) = names.first() else { return };
    let item = format!("{item}.name");
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    if name.is_empty() || !name.chars().all(is_plain) {
        problem(&item, format!("{name:?}: expected a name of letters, digits, - and _"));
    } else if name.to_ascii_lowercase().ends_with("_polygon") {
        problem(&item, format!("{name:?} ends as names of arrays of a facet table do: call it otherwise"));
    }
    // In images and files they are told apart by more than capital letters.
    let clash = names.iter().find_map(|name| taken.iter().find(|other| other.eq_ignore_ascii_case(name)));
    if let Some(other) = clash {
        problem(
            &item,
            format!(
                "another source has this name: {other:?} is taken, in small and capital letters; call {name:?} otherwise"
            ),
        );
    }
    taken.extend_from_slice(names);
}

impl Beam {
    fn check(&self, item: &str, problem: &mut impl FnMut(&str, String)) {
        if let Some(v) = self.irradiance.value().iter().find(|v| out_of_irradiances(**v).is_some()) {
            check_irradiance(&format!("{item}.irradiance"), *v, problem);
        }
        check_irradiance(&format!("{item}.total_irradiance_w_m2"), self.total_irradiance_w_m2, problem);
    }
}
