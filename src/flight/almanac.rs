//! Trajectories and orientations together: position, velocity and attitude of any object relative to any other, in any
//! frame.

use glam::{DMat3, DQuat, DVec3};

use super::names::{Names, frame_name};
use super::orientation::{Orientation, Turn, Turning};
use super::rotation_model::RotationModel;
use super::trajectory::known;
use super::{ECLIPTIC, Epoch, J2000, LeapSeconds, Pool, State, Trajectory, mars_system};
use crate::error::{Error, Location, Problem, Result};
use crate::geometry::Direction;
use crate::units::{KM_M, LIGHT_SPEED_M_S};

/// Obliquity of the ecliptic at J2000, arcsec: 84381.448 (Lieske 1976), as in SPICE's ECLIPJ2000.
const OBLIQUITY_ARCSEC: f64 = 84_381.448;

/// Correction for the finite speed of light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Correction {
    /// None: geometric positions.
    #[default]
    None,
    /// Light time: the target is where it was when the light left it.
    LightTime,
    /// Light time and stellar aberration by the observer's velocity.
    LightTimeAndAberration,
}

/// All loaded trajectories and orientations; where two overlap, the later-loaded one is used.
#[derive(Debug, Clone)]
pub struct Almanac {
    /// Trajectories.
    pub trajectories: Vec<Trajectory>,
    /// Approximate trajectories, used only where no file covers a body at any time.
    pub rough: Vec<Trajectory>,
    /// Orientations of frames.
    pub orientations: Vec<Orientation>,
    /// Leap seconds, by which UTC in files was read.
    pub leap: LeapSeconds,
    /// Names that files give to bodies.
    pub names: Names,
    /// Variables of text kernels.
    pub pool: Pool,
}

impl Default for Almanac {
    /// No trajectories; orientations of the ecliptic, Mars, Phobos and Deimos (`IAU_MARS` ...).
    fn default() -> Self {
        let orientation = |frame: &str, turning: Turning, source: &str| Orientation {
            frame: frame.to_owned(),
            base: J2000.to_owned(),
            source: source.to_owned(),
            turns: vec![Turn { span: None, turning }],
        };
        let ecliptic = DMat3::from_rotation_x(-(OBLIQUITY_ARCSEC / 3600.0).to_radians());
        let mut orientations = vec![orientation(ECLIPTIC, Turning::Fixed(ecliptic), "obliquity of 1976")];
        for body in ["MARS", "PHOBOS", "DEIMOS"] {
            let model: Option<RotationModel> = mars_system::rotation_model(body);
            let model = model.map(Turning::Model);
            orientations.extend(model.map(|model| orientation(&format!("IAU_{body}"), model, "IAU 2015")));
        }
        Almanac {
            trajectories: vec![],
            rough: vec![],
            orientations,
            leap: LeapSeconds::default(),
            names: Names::default(),
            pool: Pool::default(),
        }
    }
}

impl Almanac {
    /// Adds approximate trajectories of Mars and its moons: see [`Elements`](super::Elements).
    pub fn with_rough_trajectories() -> Self {
        Almanac { rough: mars_system::roughly(), ..Almanac::default() }
    }

    /// The state of a target relative to a centre, in a frame frozen at that epoch: for a rotating frame the velocity
    /// is the inertial one, rotated into its axes. Approximate trajectories serve bodies that no file covers.
    ///
    /// # Errors
    /// [`Error::Invalid`] that says what is not known, and when it would be.
    pub fn state(&self, target: &str, centre: &str, frame: &str, epoch: Epoch) -> Result<State> {
        let (target, centre) = (self.names.body(target), self.names.body(centre));
        let mut sum = State::ZERO;
        self.links(&target, &centre, epoch, true, |link, state, sign| {
            let rotation = self.rotation(frame, &link.frame, epoch)?;
            sum.position_m += rotation * state.position_m * sign;
            sum.velocity_m_s += rotation * state.velocity_m_s * sign;
            if frame_name(&link.frame) != J2000 {
                let carried_m_s = self.turning_per_s(&link.frame, epoch)? * state.position_m;
                sum.velocity_m_s += self.rotation(frame, J2000, epoch)? * carried_m_s * sign;
            }
            Ok(())
        })?;
        Ok(sum)
    }

    /// The position of a target relative to a centre, in a frame, m, by files alone: approximate trajectories are off by
    /// hundreds of kilometres, which is good enough for light sources, but not for a camera.
    ///
    /// # Errors
    /// As [`state`](Almanac::state).
    pub fn position_by_files_m(&self, target: &str, centre: &str, frame: &str, epoch: Epoch) -> Result<DVec3> {
        let (target, centre) = (self.names.body(target), self.names.body(centre));
        let mut sum_m = DVec3::ZERO;
        self.links(&target, &centre, epoch, false, |link, state, sign| {
            sum_m += self.rotation(frame, &link.frame, epoch)? * state.position_m * sign;
            Ok(())
        })?;
        Ok(sum_m)
    }

    /// Passes the links from a target to a centre (resolved names): each with its state in its own frame, and 1, or -1
    /// if it is reversed.
    fn links(
        &self,
        target: &str,
        centre: &str,
        epoch: Epoch,
        may_be_rough: bool,
        mut pass: impl FnMut(&Trajectory, State, f64) -> Result<()>,
    ) -> Result<()> {
        let all: Vec<&Trajectory> = self.rough.iter().chain(&self.trajectories).collect();
        let exact = &all[self.rough.len()..];
        // Rough ones serve only what no file knows at any time.
        let serving = if !may_be_rough || is_known(exact, target, centre) { exact } else { &all };
        let links = way(serving, target, centre, epoch);
        let Some(links) = links else { return Err(self.no_way(target, centre, epoch)) };
        for (link, is_forward) in links {
            let Some(state) = link.state(epoch)? else { return Err(self.no_way(target, centre, epoch)) };
            pass(link, state, if is_forward { 1.0 } else { -1.0 })?;
        }
        Ok(())
    }

    /// The time derivative of the rotation from a frame to J2000, 1/s: a central difference, one-sided at the ends of
    /// the data. At 1e-3 rad/s, its relative error is 2e-9 and 3e-9.
    fn turning_per_s(&self, frame: &str, epoch: Epoch) -> Result<DMat3> {
        /// Half the time between two rotations, s.
        const BESIDE_S: f64 = 0.1;
        let at = |steps: f64| self.rotation(J2000, frame, epoch.after_s(steps * BESIDE_S));
        let (before, after) = (at(-1.0), at(1.0));
        let (first, second, third) = match (before, after) {
            (Ok(before), Ok(after)) => return Ok((after - before) * (0.5 / BESIDE_S)),
            (Ok(before), Err(_)) => (at(-2.0)?, before, at(0.0)?),
            (Err(_), after) => (at(2.0)?, after?, at(0.0)?),
        };
        let forward = if at(1.0).is_ok() { 1.0 } else { -1.0 };
        Ok((second * 4.0 - first - third * 3.0) * (0.5 * forward / BESIDE_S))
    }

    /// Whether the position of a target relative to a centre comes from the approximate trajectories alone.
    pub fn is_rough(&self, target: &str, centre: &str) -> bool {
        let exact: Vec<&Trajectory> = self.trajectories.iter().collect();
        !self.rough.is_empty() && !is_known(&exact, &self.names.body(target), &self.names.body(centre))
    }

    /// The rotation that carries components along one frame's axes into components along another's.
    ///
    /// # Errors
    /// [`Error::Invalid`] that says what is not known, and when it would be.
    pub fn rotation(&self, to: &str, from: &str, epoch: Epoch) -> Result<DMat3> {
        let (to, from) = (frame_name(to), frame_name(from));
        let links = chain(&self.orientations, &to, &from, |of| (&of.frame, &of.base), |of| of.knows(epoch));
        let Some(links) = links else { return Err(self.no_turn(&to, &from, epoch)) };
        let mut rotation = DMat3::IDENTITY;
        for (link, is_forward) in links {
            let Some(turn) = link.frame_from_base(epoch)? else { return Err(self.no_turn(&to, &from, epoch)) };
            rotation *= if is_forward { turn } else { turn.transpose() };
        }
        Ok(rotation)
    }

    /// Apparent position of a target from an observer, in the axes of a frame, m, and its light time, s.
    ///
    /// Both positions are taken from `base`, a body whose acceleration over the light time is negligible: the solar
    /// system's barycentre if the trajectories reach it.
    ///
    /// # Errors
    /// As [`state`](Almanac::state).
    pub fn apparent(
        &self,
        target: &str,
        observer: &str,
        frame: &str,
        epoch: Epoch,
        correction: Correction,
    ) -> Result<(DVec3, f64)> {
        if correction == Correction::None {
            let state = self.state(target, observer, frame, epoch)?;
            return Ok((state.position_m, state.position_m.length() / LIGHT_SPEED_M_S));
        }
        let base = self.base_of(target, observer, epoch);
        let from = self.state(observer, &base, J2000, epoch)?;
        let mut light_s = 0.0;
        let mut to_m = DVec3::ZERO;
        // Each iteration gains four digits: speeds are below 1e-4 c.
        for _ in 0..5 {
            to_m = self.state(target, &base, J2000, epoch.after_s(-light_s))?.position_m - from.position_m;
            let next_s = to_m.length() / LIGHT_SPEED_M_S;
            if next_s == light_s {
                break;
            }
            light_s = next_s;
        }
        if correction == Correction::LightTimeAndAberration {
            to_m = aberrated(to_m, from.velocity_m_s);
        }
        Ok((self.rotation(frame, J2000, epoch)? * to_m, light_s))
    }

    /// Half axes of a body, m, if a text kernel has them (`BODYn_RADII`).
    pub fn radii_m(&self, body: &str) -> Option<DVec3> {
        match self.of_body(body, "RADII")? {
            [a, b, c] => Some(DVec3::new(*a, *b, *c) * KM_M),
            _ => None,
        }
    }

    /// GM of a body, m^3/s^2, if a text kernel has it (`BODYn_GM`).
    pub fn gm_m3_s2(&self, body: &str) -> Option<f64> {
        self.of_body(body, "GM")?.first().map(|gm| gm * KM_M.powi(3))
    }

    /// A body's numeric variables in text kernels.
    fn of_body(&self, body: &str, what: &str) -> Option<&[f64]> {
        let id = self.names.id(&self.names.body(body))?;
        self.pool.numbers(&format!("BODY{id}_{what}")).ok()?
    }

    /// The body relative to which both are known and that accelerates least: the solar system's barycentre, the Sun, or
    /// the observer itself.
    fn base_of(&self, target: &str, observer: &str, epoch: Epoch) -> String {
        let reaches = |base: &&str| {
            self.state(target, base, J2000, epoch).is_ok() && self.state(observer, base, J2000, epoch).is_ok()
        };
        let base = ["SOLAR SYSTEM BARYCENTER", "SUN", "MARS BARYCENTER", "MARS"].into_iter().find(reaches);
        base.map_or_else(|| self.names.body(observer), str::to_owned)
    }

    /// Error for an unknown position, with the coverage there is.
    fn no_way(&self, target: &str, centre: &str, epoch: Epoch) -> Error {
        let at = Location::item("flight");
        let about: Vec<String> = self
            .trajectories
            .iter()
            .filter(|of| of.target == *target || of.centre == *target || of.target == *centre || of.centre == *centre)
            .map(|of| {
                format!("{} covers {} relative to {} {}", of.source, of.target, of.centre, known(&of.spans(), epoch))
            })
            .collect();
        let message = format!("the position of {target} relative to {centre} is unknown at {epoch}");
        let help = match about.is_empty() {
            true => format!("no file covers {target} or {centre}: add one (OEM, SPK)"),
            false => {
                let exact: Vec<&Trajectory> = self.trajectories.iter().collect();
                let ends = [target, centre].map(|name| end(&exact, name));
                let between = match is_known(&exact, target, centre) {
                    true => String::new(),
                    false => format!("; no file covers {} relative to {}: add one (OEM, SPK)", ends[1], ends[0]),
                };
                about.join("; ") + &between
            }
        };
        Error::Invalid(vec![Problem::new(at, message).with_help(help)])
    }

    /// Error for an unknown orientation, with the coverage there is.
    fn no_turn(&self, to: &str, from: &str, epoch: Epoch) -> Error {
        let at = Location::item("flight");
        let about: Vec<String> = self
            .orientations
            .iter()
            .filter(|of| {
                [&of.frame, &of.base].into_iter().any(|frame| frame != J2000 && (frame == to || frame == from))
            })
            .map(|of| {
                let when = of.spans().map_or("at all times".into(), |spans| known(&spans, epoch));
                format!("{} covers {} relative to {} {when}", of.source, of.frame, of.base)
            })
            .collect();
        let message = format!("the orientation of {to} relative to {from} is unknown at {epoch}");
        let help = match about.is_empty() {
            true => {
                let frames: Vec<&str> = self.orientations.iter().map(|of| of.frame.as_str()).collect();
                format!("known frames: {J2000}, {}", frames.join(", "))
            }
            false => about.join("; "),
        };
        Error::Invalid(vec![Problem::new(at, message).with_help(help)])
    }
}

/// Stellar aberration as in SPICE: the target, at its distance, turned towards the observer's velocity by asin(v / c
/// sin).
fn aberrated(to_m: DVec3, velocity_m_s: DVec3) -> DVec3 {
    let across = to_m.cross(velocity_m_s);
    let sin = across.length() / (to_m.length() * LIGHT_SPEED_M_S);
    match Direction::new(across) {
        Some(axis) if sin < 1.0 => DQuat::from_axis_angle(axis.vec(), sin.asin()) * to_m,
        _ => to_m,
    }
}

/// A link, and whether it is followed forwards (from object to base) or backwards.
type Step<'a, T> = (&'a T, bool);

/// A node of the search: its name, the entry it was reached from, and the step.
struct Reached<'a, T> {
    name: &'a str,
    from: usize,
    by: Option<Step<'a, T>>,
}

/// Whether some trajectories connect a target to a centre, at whatever time.
fn is_known(all: &[&Trajectory], target: &str, centre: &str) -> bool {
    search(all, target, centre, |of| (&of.target, &of.centre), |_| true).is_some()
}

/// The last centre that links lead to from a name.
fn end<'a>(all: &'a [&Trajectory], name: &'a str) -> &'a str {
    let way = climb(all, name, &|of: &'a &Trajectory| (&of.target, &of.centre), &|_| true);
    way.last().map_or(name, |of| of.centre.as_str())
}

/// The steps from a target to a centre at an epoch.
fn way<'a>(
    all: &'a [&'a Trajectory],
    target: &'a str,
    centre: &'a str,
    at: Epoch,
) -> Option<Vec<Step<'a, &'a Trajectory>>> {
    chain(all, target, centre, |of| (&of.target, &of.centre), |of| of.knows(at))
}

/// The steps from `to` to `from`. As in SPICE: climb from both bodies by the last link that covers each until they
/// meet; else the shortest path, links reversed if need be, later links preferred.
fn chain<'a, T>(
    links: &'a [T],
    to: &'a str,
    from: &'a str,
    ends: impl Fn(&'a T) -> (&'a String, &'a String),
    holds: impl Fn(&'a T) -> bool,
) -> Option<Vec<Step<'a, T>>> {
    let (up, down) = (climb(links, to, &ends, &holds), climb(links, from, &ends, &holds));
    let base =
        |way: &[&'a T], i: usize, first: &'a str| i.checked_sub(1).map_or(first, |last| ends(way[last]).1.as_str());
    for i in 0..=up.len() {
        let meeting = (0..=down.len()).find(|j| base(&down, *j, from) == base(&up, i, to));
        if let Some(j) = meeting {
            let back = down[..j].iter().rev().map(|link| (*link, false));
            return Some(up[..i].iter().map(|link| (*link, true)).chain(back).collect());
        }
    }
    search(links, to, from, ends, holds)
}

/// Climbs from an object by the last link that covers it, until nothing is known or a node repeats.
fn climb<'a, T>(
    links: &'a [T],
    first: &'a str,
    ends: &impl Fn(&'a T) -> (&'a String, &'a String),
    holds: &impl Fn(&'a T) -> bool,
) -> Vec<&'a T> {
    let (mut way, mut passed) = (Vec::new(), vec![first]);
    let mut here = first;
    while let Some(link) = links.iter().rev().find(|link| ends(link).0 == here && holds(link)) {
        here = ends(link).1;
        if passed.contains(&here) {
            break;
        }
        passed.push(here);
        way.push(link);
    }
    way
}

/// The shortest path from `from` to `to`; of equally short ones, by links that come later in the list.
fn search<'a, T>(
    links: &'a [T],
    to: &'a str,
    from: &str,
    ends: impl Fn(&'a T) -> (&'a String, &'a String),
    holds: impl Fn(&'a T) -> bool,
) -> Option<Vec<Step<'a, T>>> {
    let mut reached = vec![Reached { name: to, from: 0, by: None }];
    let mut next = 0;
    while next < reached.len() {
        if reached[next].name == from {
            return Some(steps_to(&reached, next));
        }
        for link in links.iter().rev() {
            let (thing, base) = ends(link);
            let (other, is_forward) = match reached[next].name {
                name if name == thing => (base.as_str(), true),
                name if name == base => (thing.as_str(), false),
                _ => continue,
            };
            if !reached.iter().any(|entry| entry.name == other) && holds(link) {
                reached.push(Reached { name: other, from: next, by: Some((link, is_forward)) });
            }
        }
        next += 1;
    }
    None
}

/// The steps by which an entry was reached, first to last.
fn steps_to<'a, T>(reached: &[Reached<'a, T>], mut entry: usize) -> Vec<Step<'a, T>> {
    let mut steps = Vec::new();
    while let Some(step) = reached[entry].by {
        steps.push(step);
        entry = reached[entry].from;
    }
    steps.reverse();
    steps
}
