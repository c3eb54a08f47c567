//! Hill's problem: orbits about a small body that itself orbits a planet, e.g. quasi-satellite orbits about Phobos.
//!
//! Axes rotate with the body's orbital motion: x along the planet-body line (the equations hold for either sign), z
//! along the orbit normal. With n the mean motion and mu the body's GM (Hill 1878; Suarez & Ryba in Scheeres, *Orbital
//! Motion in Strongly Perturbed Environments*, 2012, 10.1):
//!
//! x'' = 2 n y' + 3 n^2 x - mu x / r^3, y'' = -2 n x' - mu y / r^3, z'' = -n^2 z - mu z / r^3

use glam::DVec3;

use super::{Epoch, Span, State};

/// Terms of a Taylor series; with 26 a step spans a tenth of a revolution at full precision.
const TERMS: usize = 26;
/// Step limit: more than any useful orbit takes in a year.
const MOST_STEPS: usize = 200_000;
/// Largest radial velocity, over the speed, at the second crossing of an orbit that closes.
const CLOSED: f64 = 1e-9;
/// Mean motion of Phobos about Mars, rad/s: 2 pi / 27 553.84 s (0.31891 d).
pub const PHOBOS_MEAN_MOTION_RAD_S: f64 = 2.0 * std::f64::consts::PI / 27_553.84;
/// GM of Phobos, m^3 s^-2 (NAIF's kernel gm_de440).
pub const PHOBOS_GM_M3_S2: f64 = 7.087_546_066_894_452e5;

/// A body that orbits a planet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hill {
    /// n, of the body about the planet, rad/s.
    pub mean_motion_rad_s: f64,
    /// mu, of the body, m^3 s^-2.
    pub gm_m3_s2: f64,
}

impl Hill {
    /// Phobos about Mars.
    pub const PHOBOS: Hill = Hill { mean_motion_rad_s: PHOBOS_MEAN_MOTION_RAD_S, gm_m3_s2: PHOBOS_GM_M3_S2 };

    /// Jacobi constant, m^2 s^-2: conserved along an orbit.
    pub fn jacobi_m2_s2(&self, state: State) -> f64 {
        let (p, n) = (state.position_m, self.mean_motion_rad_s);
        0.5 * state.velocity_m_s.length_squared()
            - self.gm_m3_s2 / p.length()
            - n * n * (1.5 * p.x * p.x - 0.5 * p.z * p.z)
    }

    /// The Taylor series of the position about a state, m and s.
    fn series(&self, state: State) -> [DVec3; TERMS] {
        let (n, gm) = (self.mean_motion_rad_s, self.gm_m3_s2);
        let mut p = [DVec3::ZERO; TERMS];
        (p[0], p[1]) = (state.position_m, state.velocity_m_s);
        // r^2, and r^-3 by the recurrence of a power.
        let (mut square, mut power) = ([0.0; TERMS], [0.0; TERMS]);
        for k in 0..TERMS - 2 {
            square[k] = (0..=k).map(|j| p[j].dot(p[k - j])).sum();
            power[k] = match k {
                0 => f64::powf(square[0], -1.5),
                _ => {
                    let term = |j: usize| (-1.5 * (k - j) as f64 - j as f64) * square[k - j] * power[j];
                    (0..k).map(term).sum::<f64>() / (k as f64 * square[0])
                }
            };
            let pull: DVec3 = (0..=k).map(|j| p[j] * power[k - j]).sum();
            let velocity = p[k + 1] * (k + 1) as f64;
            let turning =
                DVec3::new(2.0 * n * velocity.y + 3.0 * n * n * p[k].x, -2.0 * n * velocity.x, -n * n * p[k].z);
            p[k + 2] = (turning - pull * gm) / ((k + 1) * (k + 2)) as f64;
        }
        p
    }

    /// Steps along an orbit, forwards or backwards, until `is_enough` accepts the last step; `None` if it hits the
    /// body's centre.
    fn steps(&self, from: State, forwards: bool, mut is_enough: impl FnMut(&Step) -> bool) -> Option<Vec<Step>> {
        let (mut state, mut start_s) = (from, 0.0);
        let mut all = Vec::new();
        while all.len() < MOST_STEPS {
            let series = self.series(state);
            let size = state.position_m.length();
            // The last two terms are below the rounding of the position.
            let reach = |k: usize| (f64::EPSILON * size / series[k].length()).powf(1.0 / k as f64);
            let length_s = reach(TERMS - 1).min(reach(TERMS - 2)) * 0.9;
            if !(length_s.is_finite() && length_s > 0.0) {
                return None;
            }
            let length_s = if forwards { length_s } else { -length_s };
            let step = Step { start_s, length_s, series };
            state = step.state(length_s);
            start_s += length_s;
            let enough = is_enough(&step);
            all.push(step);
            if enough {
                return Some(all);
            }
        }
        None
    }

    /// When the orbit from this state next crosses y = 0, s, and its state there.
    fn next_crossing(&self, from: State) -> Option<(f64, State)> {
        self.next_zero(from, |state| state.position_m.y, |state| state.velocity_m_s.y)
    }

    /// When a quantity with this rate next returns to 0, s, and the state there.
    fn next_zero(&self, from: State, of: impl Fn(State) -> f64, rate: impl Fn(State) -> f64) -> Option<(f64, State)> {
        let mut before: f64 = 0.0;
        let passed = |step: &Step| {
            let now = of(step.state(step.length_s));
            let changed = before * now < 0.0;
            before = now;
            changed
        };
        let steps = self.steps(from, true, passed)?;
        let step = steps.last()?;
        // Bisection finds it to a part of the step, Newton's method the rest.
        let (mut low, mut high) = (0.0, step.length_s);
        let sign = of(step.state(high)).signum();
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            if of(step.state(middle)) * sign < 0.0 { low = middle } else { high = middle }
        }
        let mut at = 0.5 * (low + high);
        for _ in 0..4 {
            let state = step.state(at);
            at -= of(state) / rate(state);
        }
        at.is_finite().then(|| (step.start_s + at, step.state(at)))
    }

    /// The planar quasi-satellite orbit that crosses the x axis at right angles at `x0_m`, in the retrograde sense:
    /// symmetric, so it closes. `None` if there is none: too near to the body.
    pub fn quasi_satellite(&self, x0_m: f64) -> Option<QuasiSatellite> {
        self.crossing_at_right_angles(DVec3::new(x0_m, 0.0, 0.0))
    }

    /// As [`quasi_satellite`](Hill::quasi_satellite), but starts `height_m` above the plane, vertically at rest. The
    /// vertical period differs from the planar one, so the orbit does not close.
    pub fn quasi_satellite_3d(&self, x0_m: f64, height_m: f64) -> Option<QuasiSatellite> {
        self.crossing_at_right_angles(DVec3::new(x0_m, 0.0, height_m))
    }

    fn crossing_at_right_angles(&self, position_m: DVec3) -> Option<QuasiSatellite> {
        let x0_m = position_m.x;
        if !(x0_m > 0.0 && position_m.is_finite()) {
            return None;
        }
        let start = |speed: f64| State { position_m, velocity_m_s: DVec3::new(0.0, -speed, 0.0) };
        let slant = |speed: f64| Some(self.next_crossing(start(speed))?.1.velocity_m_s.x);
        // First guess: far out the orbit is a 1 : 2 ellipse about the guiding centre; near in, the pull adds escape
        // speed.
        let epicycle = 2.0 * self.mean_motion_rad_s * x0_m;
        let (mut a, mut b) = {
            let speed = (epicycle * epicycle + 2.0 * self.gm_m3_s2 / position_m.length()).sqrt();
            (speed, speed * 0.999)
        };
        let (mut of_a, mut of_b) = (slant(a)?, slant(b)?);
        for _ in 0..60 {
            if of_b == 0.0 || a == b || of_a == of_b {
                break;
            }
            let next = b - of_b * (b - a) / (of_b - of_a);
            (a, of_a) = (b, of_b);
            (b, of_b) = (next, slant(next)?);
        }
        let start = start(b);
        let (half_s, _) = self.next_crossing(start)?;
        let closes = of_b.abs() <= CLOSED * b;
        let (_, far) = self.next_zero(start, |state| state.position_m.x, |state| state.velocity_m_s.x)?;
        closes.then_some(QuasiSatellite { start, period_s: 2.0 * half_s, farthest: far })
    }

    /// The orbit through a state at an epoch, over a span that contains it. `None` if it hits the body's centre, or
    /// takes too many steps.
    pub fn orbit(&self, start: State, at: Epoch, span: Span) -> Option<Orbit> {
        let after_s = span.end.since_s(at);
        let before_s = span.start.since_s(at);
        let mut steps = Vec::new();
        if before_s < 0.0 {
            steps = self.steps(start, false, |step| step.start_s + step.length_s <= before_s)?;
            steps.reverse();
        }
        steps.extend(self.steps(start, true, |step| step.start_s + step.length_s >= after_s)?);
        Some(Orbit { at, steps })
    }
}

/// A quasi-satellite orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuasiSatellite {
    /// On the x axis (or above it), moving along -y.
    pub start: State,
    /// Period, s.
    pub period_s: f64,
    /// Where it crosses the y axis.
    pub farthest: State,
}

/// A part of an orbit: a Taylor series of the position.
#[derive(Debug, Clone, PartialEq)]
struct Step {
    /// Start, s from the orbit's epoch.
    start_s: f64,
    /// Length, s; negative: backwards.
    length_s: f64,
    series: [DVec3; TERMS],
}

impl Step {
    /// The state some seconds after its beginning.
    fn state(&self, t_s: f64) -> State {
        let (mut position_m, mut velocity_m_s) = (DVec3::ZERO, DVec3::ZERO);
        for term in self.series.iter().rev() {
            velocity_m_s = velocity_m_s * t_s + position_m;
            position_m = position_m * t_s + *term;
        }
        State { position_m, velocity_m_s }
    }
}

/// An orbit of Hill's problem, as consecutive Taylor series.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    at: Epoch,
    /// In order of time; those before `at` go backwards.
    steps: Vec<Step>,
}

impl Orbit {
    /// The state at an epoch; beyond the span, by the last series.
    pub(super) fn state(&self, epoch: Epoch) -> State {
        let t_s = epoch.since_s(self.at);
        let ends = |step: &Step| step.start_s.max(step.start_s + step.length_s);
        let index = self.steps.partition_point(|step| ends(step) < t_s).min(self.steps.len().saturating_sub(1));
        self.steps.get(index).map_or(State::ZERO, |step| step.state(t_s - step.start_s))
    }
}
