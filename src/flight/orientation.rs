//! The orientation of one frame relative to another, over the times that a file or a model covers.

use glam::{DMat3, DQuat, DVec3, DVec4};

use super::interpolation::{degree, hermite, lagrange, window};
use super::rotation_model::RotationModel;
use super::trajectory::joined;
use super::{Chebyshev, Epoch, Span, Unread};
use crate::error::Result;

/// Interpolation between attitudes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Between {
    /// The last one holds until the next.
    Steps,
    /// Constant rotation rate from one to the next (slerp): the great arc of unit quaternions.
    SteadyTurn,
    /// Lagrange polynomial through the quaternions of this many nodes, normalised.
    Lagrange(usize),
    /// Hermite, through quaternions and their derivatives.
    Hermite(usize),
}

impl Between {
    /// The polynomial degree, if there are enough attitudes; 1 for constant-rate rotation.
    pub fn degree(self) -> usize {
        match self {
            Between::Steps | Between::SteadyTurn => 1,
            Between::Lagrange(nodes) => degree(nodes, 1),
            Between::Hermite(nodes) => degree(nodes, 2),
        }
    }
}

/// Attitudes at some moments.
#[derive(Debug, Clone, PartialEq)]
pub struct Attitudes {
    /// The moments, s of TDB since J2000, ascending.
    pub tdb_s: Vec<f64>,
    /// For each the rotation that carries components along the base's axes into components along the frame's.
    pub frame_from_base: Vec<DQuat>,
    /// For each its derivative, 1/s; empty if it is not known.
    pub derivative: Vec<DVec4>,
    /// Interpolation between them.
    pub between: Between,
}

impl Attitudes {
    /// Chooses signs of quaternions so that neighbours are near: q and -q are the same rotation.
    #[must_use]
    pub fn with_continuous_signs(mut self) -> Self {
        for i in 1..self.frame_from_base.len() {
            if self.frame_from_base[i - 1].dot(self.frame_from_base[i]) < 0.0 {
                self.frame_from_base[i] = -self.frame_from_base[i];
                if let Some(derivative) = self.derivative.get_mut(i) {
                    *derivative = -*derivative;
                }
            }
        }
        self
    }

    fn rotation(&self, epoch: Epoch) -> DQuat {
        let x = epoch.tdb_s();
        let components = |nodes: std::ops::Range<usize>| -> Vec<DVec4> {
            self.frame_from_base[nodes].iter().map(|q| DVec4::from(*q)).collect()
        };
        let normal = |q: DVec4| DQuat::from_vec4(q.normalize_or(DVec4::W));
        match self.between {
            Between::Steps => self.frame_from_base[self.tdb_s.partition_point(|node| *node <= x).saturating_sub(1)],
            Between::SteadyTurn => {
                let nodes = window(&self.tdb_s, x, 2);
                let (first, last) = (nodes.start, nodes.end - 1);
                if first == last {
                    return self.frame_from_base[first];
                }
                let share = (x - self.tdb_s[first]) / (self.tdb_s[last] - self.tdb_s[first]);
                steady_turn(self.frame_from_base[first], self.frame_from_base[last], share)
            }
            Between::Lagrange(nodes) => {
                let nodes = window(&self.tdb_s, x, nodes);
                normal(lagrange(x, &self.tdb_s[nodes.clone()], &components(nodes)).0)
            }
            Between::Hermite(nodes) => {
                let nodes = window(&self.tdb_s, x, nodes);
                let derivative = self.derivative.get(nodes.clone()).unwrap_or(&[]);
                normal(hermite(x, &self.tdb_s[nodes.clone()], &components(nodes), derivative).0)
            }
        }
    }
}

/// Slerp: a fraction of the shorter rotation from one attitude to another. Accurate also at small angles, where an arc
/// cosine is not.
fn steady_turn(a: DQuat, b: DQuat, share: f64) -> DQuat {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    let by = a.inverse() * b;
    let half = by.xyz().length().atan2(by.w);
    let scale = if half > 0.0 { (share * half).sin() / half.sin() } else { 0.0 };
    let axis = by.xyz() * scale;
    (a * DQuat::from_xyzw(axis.x, axis.y, axis.z, (share * half).cos())).normalize()
}

/// Representation of an orientation segment.
#[derive(Debug, Clone, PartialEq)]
pub enum Turning {
    /// Attitudes at some moments.
    Attitudes(Attitudes),
    /// A body's pole and prime meridian.
    Model(RotationModel),
    /// Series of Euler angles 3-1-3, rad: right ascension of the pole + 90 deg, 90 deg - declination, and prime meridian.
    Angles(Chebyshev),
    /// Constant: frame from base.
    Fixed(DMat3),
    /// Constant rotation about an axis that is fixed in both.
    Spin(Spin),
    /// Present in the file, but of a type that is not read.
    Unread(Unread),
}

/// Constant-rate rotation, unlimited in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spin {
    /// Reference epoch, at which `frame_from_base` holds.
    pub since: Epoch,
    /// The rotation that carries components along the base's axes into components along the frame's, at that moment.
    pub frame_from_base: DQuat,
    /// Angular velocity of the frame, in the base's axes, rad/s.
    pub rate_rad_s: DVec3,
}

impl Spin {
    fn rotation(&self, epoch: Epoch) -> DQuat {
        // The frame's axes rotate by this, so components along them rotate back.
        let turned = DQuat::from_scaled_axis(self.rate_rad_s * epoch.since_s(self.since));
        self.frame_from_base * turned.inverse()
    }
}

/// A segment of an orientation: nothing is interpolated across segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Its span; `None`: all times.
    pub span: Option<Span>,
    /// Its representation.
    pub turning: Turning,
}

/// The orientation of a frame relative to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Orientation {
    /// The frame: see [`frame_name`](super::frame_name).
    pub frame: String,
    /// The base frame.
    pub base: String,
    /// Source: a file, or a model's name.
    pub source: String,
    /// Its segments; where they overlap, the later one is used.
    pub turns: Vec<Turn>,
}

impl Orientation {
    /// The segment in use at an epoch.
    fn turn(&self, epoch: Epoch) -> Option<&Turn> {
        self.turns.iter().rev().find(|turn| turn.span.is_none_or(|span| span.contains(epoch)))
    }

    /// Whether an epoch is covered.
    pub fn knows(&self, epoch: Epoch) -> bool {
        self.turn(epoch).is_some()
    }

    /// The rotation that carries components along the base's axes into components along the frame's; `None` where nothing is known.
    ///
    /// # Errors
    /// [`Error::Unsupported`](crate::Error::Unsupported) where what is known is not read.
    pub fn frame_from_base(&self, epoch: Epoch) -> Result<Option<DMat3>> {
        let Some(turn) = self.turn(epoch) else { return Ok(None) };
        Ok(Some(match &turn.turning {
            Turning::Attitudes(attitudes) => DMat3::from_quat(attitudes.rotation(epoch)),
            Turning::Model(model) => model.fixed_from_inertial(epoch),
            Turning::Angles(series) => {
                let [[first, second, third], _] = series.at(epoch.tdb_s());
                super::rotation_model::euler_313(first, second, third)
            }
            Turning::Fixed(rotation) => *rotation,
            Turning::Spin(spin) => DMat3::from_quat(spin.rotation(epoch)),
            Turning::Unread(unread) => return Err(unread.error()),
        }))
    }

    /// Coverage, in order of time, with touching spans merged; `None`: all times.
    pub fn spans(&self) -> Option<Vec<Span>> {
        let spans: Option<Vec<Span>> = self.turns.iter().map(|turn| turn.span).collect();
        Some(joined(spans?.into_iter()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn about_z(angle_rad: f64) -> DQuat {
        DQuat::from_rotation_z(angle_rad)
    }

    #[test]
    fn a_steady_turn_goes_the_short_way() {
        let q = steady_turn(about_z(0.1), -about_z(0.5), 0.25);
        assert!(q.angle_between(about_z(0.2)) < 1e-15, "{q:?}");
        // 1e-9 rad are not lost.
        let q = steady_turn(DQuat::IDENTITY, about_z(1e-9), 0.5);
        assert!((q.z - 0.25e-9).abs() < 1e-24);
        assert_eq!(steady_turn(DQuat::IDENTITY, DQuat::IDENTITY, 0.5), DQuat::IDENTITY);
    }

    #[test]
    fn polynomials_through_quaternions_follow_a_steady_turn() {
        let tdb_s: Vec<f64> = (0..8).map(f64::from).collect();
        let at = |s: f64| about_z(0.1 * s);
        // dq/dt = q (0, 0, rate / 2, 0) for a turn about z.
        let derivative = tdb_s.iter().map(|s| DVec4::from(at(*s) * DQuat::from_xyzw(0.0, 0.0, 0.05, 0.0))).collect();
        let rotation: Vec<DQuat> =
            tdb_s.iter().enumerate().map(|(i, s)| if i % 3 == 1 { -at(*s) } else { at(*s) }).collect();
        for between in [Between::SteadyTurn, Between::Lagrange(7), Between::Hermite(4)] {
            let attitudes = Attitudes {
                tdb_s: tdb_s.clone(),
                frame_from_base: rotation.clone(),
                derivative: Vec::clone(&derivative),
                between,
            };
            let attitudes = Attitudes {
                derivative: attitudes
                    .frame_from_base
                    .iter()
                    .map(|q| DVec4::from(*q * DQuat::from_xyzw(0.0, 0.0, 0.05, 0.0)))
                    .collect(),
                ..attitudes
            };
            let q = attitudes.with_continuous_signs().rotation(Epoch::from_tdb_s(3.4).unwrap());
            let got = DMat3::from_quat(q) * DVec3::X;
            assert!((got - DMat3::from_rotation_z(0.34) * DVec3::X).length() < 1e-11, "{between:?}: {got:?}");
        }
    }
}
