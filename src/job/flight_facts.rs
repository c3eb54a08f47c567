//! Facts of a flight-dynamics file: objects, coverage, steps, altitudes.

use std::path::Path;

use crate::error::Result;
use crate::flight::{
    self, Almanac, Attitudes, Between, Epoch, Interpolation, LeapSeconds, Nodes, Segment, Span, Trajectory, Turning,
    altitude_m, radii_m,
};
use crate::formats::ephemeris;
use crate::formats::flight_file::FlightFile;

/// Statistics of row spacing, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steps {
    /// The least.
    pub min_s: f64,
    /// Median.
    pub median_s: f64,
    /// The most.
    pub max_s: f64,
}

/// A segment of a trajectory or orientation.
#[derive(Debug, Clone, PartialEq)]
pub struct PartFacts {
    /// Its span; `None`: all times.
    pub span: Option<Span>,
    /// Number of rows.
    pub rows: usize,
    /// Spacing of rows, if there are two.
    pub steps: Option<Steps>,
    /// Interpolation.
    pub interpolation: String,
}

/// Facts of one object or frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightFacts {
    /// The object, or the frame.
    pub of: String,
    /// Its centre, or base frame.
    pub about: String,
    /// The frame of a trajectory.
    pub frame: Option<String>,
    /// Its segments, in file order.
    pub parts: Vec<PartFacts>,
    /// Coverage gaps.
    pub gaps: Vec<Span>,
    /// Least and greatest altitude above the centre's ellipsoid, m, if that and its rotation are known.
    pub altitude_m: Option<[f64; 2]>,
}

/// What a file knows: its trajectories, then its orientations.
///
/// # Errors
/// Those of its reader.
pub fn flight_facts(path: &Path) -> Result<(FlightFile, Vec<FlightFacts>)> {
    let file = ephemeris::read(path, &LeapSeconds::default())?;
    let almanac = Almanac::default();
    let trajectories = file.trajectories.iter().map(|(_, trajectory)| of_trajectory(trajectory, &almanac));
    let orientations = file.orientations.iter().map(|(_, orientation)| of_orientation(orientation));
    let facts = trajectories.chain(orientations).collect();
    Ok((file, facts))
}

fn of_trajectory(of: &Trajectory, almanac: &Almanac) -> FlightFacts {
    let part = |segment: &Segment| {
        let (tdb_s, interpolation) = match &segment.path {
            flight::Path::Nodes(nodes) => (&nodes.tdb_s[..], by_polynomials(nodes)),
            // No file that is read into rows has others.
            _ => (&[][..], "by no rows".to_owned()),
        };
        PartFacts { span: Some(segment.span), rows: tdb_s.len(), steps: steps(tdb_s), interpolation }
    };
    FlightFacts {
        of: of.target.clone(),
        about: of.centre.clone(),
        frame: Some(of.frame.clone()),
        parts: of.segments.iter().map(part).collect(),
        gaps: gaps(&of.spans()),
        altitude_m: altitudes_m(of, almanac),
    }
}

fn of_orientation(of: &flight::Orientation) -> FlightFacts {
    let part = |turn: &flight::Turn| {
        let (tdb_s, interpolation) = match &turn.turning {
            Turning::Attitudes(attitudes) => (&attitudes.tdb_s[..], by_turns(attitudes)),
            _ => (&[][..], "by no rows".to_owned()),
        };
        PartFacts { span: turn.span, rows: tdb_s.len(), steps: steps(tdb_s), interpolation }
    };
    FlightFacts {
        of: of.frame.clone(),
        about: of.base.clone(),
        frame: None,
        parts: of.turns.iter().map(part).collect(),
        gaps: gaps(&of.spans().unwrap_or_default()),
        altitude_m: None,
    }
}

fn by_polynomials(nodes: &Nodes) -> String {
    let with = if nodes.velocity_m_s.is_empty() { "without velocities" } else { "with velocities" };
    let degree = nodes.interpolation.degree();
    match nodes.interpolation {
        Interpolation::Lagrange(2) => format!("linear, {with}"),
        Interpolation::Lagrange(_) => format!("Lagrange, degree {degree}, {with}"),
        Interpolation::Hermite(_) => format!("Hermite, degree {degree}, {with}"),
    }
}

fn by_turns(attitudes: &Attitudes) -> String {
    let degree = attitudes.between.degree();
    match attitudes.between {
        Between::Steps => "each holds until the next".to_owned(),
        Between::SteadyTurn => "a steady turn from one to the next".to_owned(),
        Between::Lagrange(_) => format!("Lagrange, degree {degree}"),
        Between::Hermite(_) => format!("Hermite, degree {degree}"),
    }
}

fn steps(tdb_s: &[f64]) -> Option<Steps> {
    Steps::of(tdb_s.windows(2).map(|two| two[1] - two[0]).collect())
}

impl Steps {
    /// Of some steps; `None` of none.
    pub(super) fn of(steps: Vec<f64>) -> Option<Steps> {
        let [min_s, max_s] = [f64::min as fn(f64, f64) -> f64, f64::max].map(|of| steps.iter().copied().reduce(of));
        Some(Steps { min_s: min_s?, max_s: max_s?, median_s: median(steps)? })
    }
}

/// The median; `None` of none.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let [low, high] = [values.len().checked_sub(1)? / 2, values.len() / 2];
    Some(f64::midpoint(values[low], values[high]))
}

fn gaps(spans: &[Span]) -> Vec<Span> {
    spans.windows(2).map(|two| Span { start: two[0].end, end: two[1].start }).collect()
}

/// The least and greatest altitude at rows.
fn altitudes_m(of: &Trajectory, almanac: &Almanac) -> Option<[f64; 2]> {
    let radii_m = radii_m(&of.centre)?;
    let fixed = format!("IAU_{}", of.centre);
    let mut range: Option<[f64; 2]> = None;
    for segment in &of.segments {
        for epoch in moments(segment) {
            // Rows may lie outside the usable span.
            let Some(state) = of.state(epoch).ok()? else { continue };
            let rotation = almanac.rotation(&fixed, &of.frame, epoch).ok()?;
            let height_m = altitude_m(rotation * state.position_m, radii_m);
            let [least, most] = range.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
            range = Some([least.min(height_m), most.max(height_m)]);
        }
    }
    range.filter(|range| range.iter().all(|height_m| height_m.is_finite()))
}

fn moments(segment: &Segment) -> Vec<Epoch> {
    let Span { start, end } = segment.span;
    match &segment.path {
        flight::Path::Nodes(nodes) => {
            let rows = nodes.tdb_s.iter().filter_map(|s| Epoch::from_tdb_s(*s));
            [start].into_iter().chain(rows).chain([end]).collect()
        }
        _ => vec![start, end],
    }
}
