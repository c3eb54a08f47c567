//! The position of one object relative to another, over the times that a file or a model covers.

use std::fmt;

use glam::DVec3;

use super::interpolation::{degree, hermite, lagrange, window};
use super::{Chebyshev, Elements, Epoch, Orbit, Unread};
use crate::error::Result;
use crate::units::KM_M;

/// Position and velocity of one object relative to another, in the axes of some frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// From the centre, m.
    pub position_m: DVec3,
    /// Velocity as seen in the frame's axes, m/s.
    pub velocity_m_s: DVec3,
}

impl State {
    /// At the centre, at rest.
    pub const ZERO: State = State { position_m: DVec3::ZERO, velocity_m_s: DVec3::ZERO };
}

/// A time span, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// The first moment.
    pub start: Epoch,
    /// The last.
    pub end: Epoch,
}

impl Span {
    /// Whether it contains an epoch.
    pub fn contains(&self, epoch: Epoch) -> bool {
        self.start <= epoch && epoch <= self.end
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {}", self.start, self.end)
    }
}

/// Interpolation between nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Lagrange, through this many nodes: positions and velocities separately.
    Lagrange(usize),
    /// Hermite, through positions and velocities of this many nodes.
    Hermite(usize),
}

impl Interpolation {
    /// How many nodes it goes through.
    pub fn nodes(self) -> usize {
        match self {
            Interpolation::Lagrange(nodes) | Interpolation::Hermite(nodes) => nodes,
        }
    }

    /// The polynomial degree, if there are enough nodes.
    pub fn degree(self) -> usize {
        match self {
            Interpolation::Lagrange(nodes) => degree(nodes, 1),
            Interpolation::Hermite(nodes) => degree(nodes, 2),
        }
    }
}

/// States at some moments.
#[derive(Debug, Clone, PartialEq)]
pub struct Nodes {
    /// The moments, s of TDB since J2000, ascending.
    pub tdb_s: Vec<f64>,
    /// For each its position, m.
    pub position_m: Vec<DVec3>,
    /// For each its velocity, m/s; empty if a file has positions only.
    pub velocity_m_s: Vec<DVec3>,
    /// Interpolation between them.
    pub interpolation: Interpolation,
}

impl Nodes {
    /// The state at a moment, also where the polynomial goes beyond the nodes.
    pub fn state(&self, epoch: Epoch) -> State {
        let x = epoch.tdb_s();
        let nodes = window(&self.tdb_s, x, self.interpolation.nodes());
        let (xs, position_m) = (&self.tdb_s[nodes.clone()], &self.position_m[nodes.clone()]);
        let velocity_m_s = self.velocity_m_s.get(nodes);
        let (position_m, velocity_m_s) = match (self.interpolation, velocity_m_s) {
            (Interpolation::Hermite(_), Some(velocity_m_s)) => hermite(x, xs, position_m, velocity_m_s),
            (Interpolation::Lagrange(_), Some(velocity_m_s)) => {
                (lagrange(x, xs, position_m).0, lagrange(x, xs, velocity_m_s).0)
            }
            (_, None) => lagrange(x, xs, position_m),
        };
        State { position_m, velocity_m_s }
    }
}

/// Representation of a trajectory segment.
#[derive(Debug, Clone, PartialEq)]
pub enum Path {
    /// States at some moments.
    Nodes(Nodes),
    /// Series in km, and km/s.
    Chebyshev(Chebyshev),
    /// An orbit about a small body.
    Orbit(Orbit),
    /// Mean elements about the Sun (approximate).
    Elements(Elements),
    /// It does not move, m.
    Fixed(DVec3),
    /// Present in the file, but of a type that is not read.
    Unread(Unread),
}

/// A segment of a trajectory: nothing is interpolated across segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Its span.
    pub span: Span,
    /// Its representation.
    pub path: Path,
}

/// The position of an object relative to another, in some frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// The object: see [`body_name`](super::body_name).
    pub target: String,
    /// The centre.
    pub centre: String,
    /// The frame: see [`frame_name`](super::frame_name).
    pub frame: String,
    /// Source: a file, or a model's name.
    pub source: String,
    /// Its segments; where they overlap, the later one is used.
    pub segments: Vec<Segment>,
}

impl Trajectory {
    /// The segment in use at an epoch.
    fn segment(&self, epoch: Epoch) -> Option<&Segment> {
        self.segments.iter().rev().find(|segment| segment.span.contains(epoch))
    }

    /// Whether an epoch is covered.
    pub fn knows(&self, epoch: Epoch) -> bool {
        self.segment(epoch).is_some()
    }

    /// The state at a moment; `None` where nothing is known.
    ///
    /// # Errors
    /// [`Error::Unsupported`](crate::Error::Unsupported) where what is known is not read.
    pub fn state(&self, epoch: Epoch) -> Result<Option<State>> {
        let Some(segment) = self.segment(epoch) else { return Ok(None) };
        Ok(Some(match &segment.path {
            Path::Nodes(nodes) => nodes.state(epoch),
            Path::Chebyshev(series) => {
                let [position_m, velocity_m_s] = series.at(epoch.tdb_s()).map(|km| DVec3::from_array(km) * KM_M);
                State { position_m, velocity_m_s }
            }
            Path::Orbit(orbit) => orbit.state(epoch),
            Path::Elements(elements) => elements.state(epoch),
            Path::Fixed(position_m) => State { position_m: *position_m, velocity_m_s: DVec3::ZERO },
            Path::Unread(unread) => return Err(unread.error()),
        }))
    }

    /// Coverage, in order of time, with touching spans merged.
    pub fn spans(&self) -> Vec<Span> {
        joined(self.segments.iter().map(|segment| segment.span))
    }
}

/// Spans in order of time, with touching or overlapping ones merged.
pub(super) fn joined(spans: impl Iterator<Item = Span>) -> Vec<Span> {
    let mut spans: Vec<Span> = spans.collect();
    spans.sort_by(|a, b| a.start.tdb_s().total_cmp(&b.start.tdb_s()));
    let mut all: Vec<Span> = Vec::new();
    for span in spans {
        match all.last_mut().filter(|last| span.start <= last.end) {
            Some(last) if last.end < span.end => last.end = span.end,
            Some(_) => {}
            None => all.push(span),
        }
    }
    all
}

/// Coverage as part of a sentence, with the gap an epoch lies in.
pub(super) fn known(spans: &[Span], epoch: Epoch) -> String {
    let (Some(first), Some(last)) = (spans.first(), spans.last()) else { return "at no time".into() };
    let from_to = format!("from {} to {}", first.start, last.end);
    let gap = spans.windows(2).find(|two| two[0].end < epoch && epoch < two[1].start);
    match gap {
        Some(two) => format!("{from_to}, but not from {} to {}", two[0].end, two[1].start),
        None => from_to,
    }
}
