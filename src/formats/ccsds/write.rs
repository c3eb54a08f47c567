//! Writes messages, version 2.0, of orbits and attitudes at their nodes or at regular steps.
//!
//! Numbers have all digits: reading back gives the same bits and times. The output is reproducible: without
//! `FlightFile::made` CREATION_DATE is the day of J2000, and no clock is read.

use std::fmt::Write as _;

use glam::{DQuat, DVec3, DVec4};

use crate::error::{Error, Location, Problem, Result};
use crate::flight::{
    Attitudes, Between, Epoch, Interpolation, J2000, LeapSeconds, Nodes, Orientation, Path, Scale, Span, State,
    Trajectory, Turning,
};
use crate::formats::decimal;
use crate::formats::flight_file::{FlightFile, Object, time_text};
use crate::formats::xml::Element;
use crate::report::{Fate, Report};

/// Most rows in a segment: more means that the step is far too small.
const MOST_ROWS: f64 = 1e7;
/// Default CREATION_DATE and ORIGINATOR.
const MADE: (&str, &str) = ("2000-01-01T00:00:00", "MMXRT");
/// Names and units of a state vector, in KVN order.
const STATE: [(&str, &str); 6] =
    [("X", "km"), ("Y", "km"), ("Z", "km"), ("X_DOT", "km/s"), ("Y_DOT", "km/s"), ("Z_DOT", "km/s")];
const QUATERNION: [&str; 4] = ["Q1", "Q2", "Q3", "QC"];
const DERIVATIVE: [&str; 4] = ["Q1_DOT", "Q2_DOT", "Q3_DOT", "QC_DOT"];

/// A segment's keys with their values, and its rows: a time and numbers.
struct Segment {
    meta: Vec<(&'static str, String)>,
    rows: Vec<(String, Vec<String>)>,
}

/// A message to be written.
struct Message<'a> {
    /// "OEM" or "AEM".
    kind: &'static str,
    file: &'a FlightFile,
    segments: Vec<Segment>,
}

/// What is being written.
struct Writing<'a> {
    file: &'a FlightFile,
    leap: &'a LeapSeconds,
    /// Time between rows, s; `None`: the rows that are there.
    step_s: Option<f64>,
    report: Report,
}

/// The text of an OEM, and what is not carried over.
///
/// # Errors
/// [`Error::Invalid`] if there is no trajectory, or one that is not known at nodes and no step is given; for a step of no use.
pub fn oem(file: &FlightFile, leap: &LeapSeconds, step_s: Option<f64>) -> Result<(String, Report)> {
    let mut writing = Writing::new(file, leap, step_s)?;
    let message = writing.orbits()?;
    writing.left_out(file.orientations.len(), "orientations: an OEM holds orbits");
    Ok((text(&of_some(file, message, "trajectory")?), writing.report))
}

/// The text of an AEM, and what is not carried over.
///
/// # Errors
/// [`Error::Invalid`] if there is no orientation, or one that is not known at nodes and no step is given; for a step of no use.
pub fn aem(file: &FlightFile, leap: &LeapSeconds, step_s: Option<f64>) -> Result<(String, Report)> {
    let mut writing = Writing::new(file, leap, step_s)?;
    let message = writing.attitudes()?;
    writing.left_out(file.trajectories.len(), "trajectories: an AEM holds attitudes");
    Ok((text(&of_some(file, message, "orientation")?), writing.report))
}

/// The XML of an OEM, an AEM, or both in an `<ndm>`, and what is not carried over.
///
/// # Errors
/// As [`oem`] and [`aem`].
pub fn ndm(file: &FlightFile, leap: &LeapSeconds, step_s: Option<f64>) -> Result<(String, Report)> {
    let mut writing = Writing::new(file, leap, step_s)?;
    let messages: Vec<Message<'_>> = [writing.orbits()?, writing.attitudes()?].into_iter().flatten().collect();
    let root = match messages.as_slice() {
        [one] => element(one),
        [] => return Err(Error::invalid(Location::file(&file.input.path), "holds nothing to write")),
        several => Element::new("ndm").and_all(several.iter().map(element)),
    };
    Ok((root.write(), writing.report))
}

fn of_some<'a>(file: &FlightFile, message: Option<Message<'a>>, what: &str) -> Result<Message<'a>> {
    message.ok_or_else(|| Error::invalid(Location::file(&file.input.path), format!("holds no {what} to write")))
}

/// The last row is at least this part of a step after the one before it.
const LEAST_STEP: f64 = 1e-3;

impl<'a> Writing<'a> {
    fn new(file: &'a FlightFile, leap: &'a LeapSeconds, step_s: Option<f64>) -> Result<Self> {
        if let Some(step_s) = step_s.filter(|step_s| !(*step_s > 0.0 && step_s.is_finite())) {
            return Err(Error::invalid(Location::item("step"), format!("{step_s} s is not positive")));
        }
        Ok(Writing { file, leap, step_s, report: Report::default() })
    }

    fn left_out(&mut self, count: usize, what: &str) {
        if count > 0 {
            self.report.note(Fate::Dropped, Location::file(&self.file.input.path), what);
        }
    }

    fn time(&self, epoch: Epoch) -> String {
        time_text(epoch, self.file.scale, self.leap)
    }

    fn orbits(&mut self) -> Result<Option<Message<'a>>> {
        let mut segments = Vec::new();
        for (object, trajectory) in &self.file.trajectories {
            for part in &trajectory.segments {
                let nodes = self.nodes(trajectory, part.span, &part.path)?;
                segments.push(self.orbit(object, trajectory, part.span, &nodes));
            }
        }
        Ok((!segments.is_empty()).then_some(Message { kind: "OEM", file: self.file, segments }))
    }

    /// The nodes of a segment, all with velocities, which CCSDS requires.
    fn nodes(&mut self, of: &Trajectory, span: Span, path: &Path) -> Result<Nodes> {
        let state = |epoch: Epoch| match path {
            Path::Nodes(nodes) => Ok(nodes.state(epoch)),
            other => {
                let alone = crate::flight::Segment { span, path: other.clone() };
                let of = Trajectory { segments: vec![alone], ..of.clone() };
                Ok(of.state(epoch)?.unwrap_or(State::ZERO))
            }
        };
        if let (Path::Nodes(nodes), None) = (path, self.step_s) {
            let mut nodes = nodes.clone();
            if nodes.velocity_m_s.len() < nodes.tdb_s.len() {
                let message = format!(
                    "velocities of {} are not given: they are derived from the position polynomials",
                    of.target
                );
                self.report.note(Fate::Approximated, Location::file(&of.source), message);
                let epochs = nodes.tdb_s.iter().filter_map(|s| Epoch::from_tdb_s(*s));
                nodes.velocity_m_s = epochs.map(|epoch| Ok(state(epoch)?.velocity_m_s)).collect::<Result<_>>()?;
            }
            return Ok(nodes);
        }
        let epochs = self.steps(&of.source, &of.target, span)?;
        let states: Vec<State> = epochs.iter().map(|epoch| state(*epoch)).collect::<Result<_>>()?;
        Ok(Nodes {
            tdb_s: epochs.iter().map(|epoch| epoch.tdb_s()).collect(),
            position_m: states.iter().map(|state| state.position_m).collect(),
            velocity_m_s: states.iter().map(|state| state.velocity_m_s).collect(),
            interpolation: Interpolation::Hermite(4),
        })
    }

    /// Epochs over a span at the requested step.
    fn steps(&mut self, source: &str, name: &str, span: Span) -> Result<Vec<Epoch>> {
        let Some(step_s) = self.step_s else {
            let problem = Problem::new(Location::file(source), format!("has no tabulated states for {name}"));
            return Err(Error::Invalid(vec![problem.with_help("give the time between rows: --step-s 60")]));
        };
        let length_s = span.end.since_s(span.start);
        if length_s / step_s > MOST_ROWS {
            let message = format!("{step_s} s is too short for a span of {length_s} s");
            return Err(Error::invalid(Location::item("step"), message));
        }
        let message = format!("{name}: at steps of {step_s} s, and interpolated between them");
        self.report.note(Fate::Approximated, Location::file(source), message);
        // Steps are even in the scale of the file's times, but for leap seconds.
        let after = |s: f64| match self.file.scale {
            Scale::Tdb => span.start.after_s(s),
            _ => span.start.after_tt_s(s, self.leap),
        };
        let steps = (0_u32..).map(|i| after(f64::from(i) * step_s));
        // A row right before the last one says nothing more, and polynomials through both would magnify rounding.
        let is_before = |epoch: &Epoch| span.end.since_s(*epoch) > LEAST_STEP * step_s;
        let mut epochs: Vec<Epoch> = steps.take_while(is_before).collect();
        epochs.push(span.end);
        Ok(epochs)
    }

    fn orbit(&self, object: &Object, of: &Trajectory, span: Span, nodes: &Nodes) -> Segment {
        let method = match nodes.interpolation {
            Interpolation::Lagrange(2) => "LINEAR",
            Interpolation::Lagrange(_) => "LAGRANGE",
            Interpolation::Hermite(_) => "HERMITE",
        };
        let mut meta = vec![
            ("OBJECT_NAME", one_line(&object.name)),
            ("OBJECT_ID", one_line(&object.id)),
            ("CENTER_NAME", one_line(&of.centre)),
            ("REF_FRAME", frame(&of.frame)),
        ];
        meta.extend(self.times(&nodes.tdb_s, span));
        meta.push(("INTERPOLATION", method.into()));
        meta.push(("INTERPOLATION_DEGREE", nodes.interpolation.degree().to_string()));
        let km = |v: &DVec3| v.to_array().map(|metres| decimal::text(metres, 3));
        let rows = nodes.tdb_s.iter().zip(&nodes.position_m).zip(&nodes.velocity_m_s);
        let rows = rows.map(|((tdb_s, position_m), velocity_m_s)| {
            (self.row_time(*tdb_s), [km(position_m), km(velocity_m_s)].concat())
        });
        Segment { meta, rows: rows.collect() }
    }

    fn attitudes(&mut self) -> Result<Option<Message<'a>>> {
        let mut segments = Vec::new();
        for (object, orientation) in &self.file.orientations {
            for turn in &orientation.turns {
                let Some(span) = turn.span else {
                    let message = format!("{} has no start or stop, which an AEM needs", orientation.frame);
                    return Err(Error::invalid(Location::file(&orientation.source), message));
                };
                let attitudes = self.rows_of(orientation, span, &turn.turning)?;
                segments.push(self.attitude(object, orientation, span, &attitudes));
            }
        }
        Ok((!segments.is_empty()).then_some(Message { kind: "AEM", file: self.file, segments }))
    }

    fn rows_of(&mut self, of: &Orientation, span: Span, turning: &Turning) -> Result<Attitudes> {
        if let (Turning::Attitudes(attitudes), None) = (turning, self.step_s)
            && attitudes.between != Between::Steps
        {
            return Ok(attitudes.clone());
        }
        let epochs = self.steps(&of.source, &of.frame, span)?;
        let alone = crate::flight::Turn { span: Some(span), turning: turning.clone() };
        let of = Orientation { turns: vec![alone], ..of.clone() };
        let rotation = |epoch: &Epoch| -> Result<DQuat> {
            Ok(DQuat::from_mat3(&of.frame_from_base(*epoch)?.unwrap_or_default()).normalize())
        };
        let attitudes = Attitudes {
            tdb_s: epochs.iter().map(|epoch| epoch.tdb_s()).collect(),
            frame_from_base: epochs.iter().map(rotation).collect::<Result<_>>()?,
            derivative: vec![],
            between: Between::SteadyTurn,
        };
        Ok(attitudes.with_continuous_signs())
    }

    fn attitude(&self, object: &Object, of: &Orientation, span: Span, attitudes: &Attitudes) -> Segment {
        let has_derivative = !attitudes.derivative.is_empty();
        let method = match attitudes.between {
            Between::Steps | Between::SteadyTurn => "LINEAR",
            Between::Lagrange(_) => "LAGRANGE",
            Between::Hermite(_) => "HERMITE",
        };
        let kind = if has_derivative { "QUATERNION/DERIVATIVE" } else { "QUATERNION" };
        let mut meta = vec![
            ("OBJECT_NAME", one_line(&object.name)),
            ("OBJECT_ID", one_line(&object.id)),
            ("REF_FRAME_A", frame(&of.base)),
            ("REF_FRAME_B", frame(&of.frame)),
        ];
        meta.extend(self.times(&attitudes.tdb_s, span));
        meta.push(("ATTITUDE_TYPE", kind.into()));
        meta.push(("INTERPOLATION_METHOD", method.into()));
        meta.push(("INTERPOLATION_DEGREE", attitudes.between.degree().to_string()));
        // Q turns axes: its inverse transforms components from A to B.
        let conjugate = |q: DVec4| [0.0 - q.x, 0.0 - q.y, 0.0 - q.z, q.w].map(|part| decimal::text(part, 0));
        let rows = attitudes.tdb_s.iter().zip(&attitudes.frame_from_base).enumerate().map(|(i, (tdb_s, q))| {
            let mut numbers = conjugate(DVec4::from(*q)).to_vec();
            numbers.extend(attitudes.derivative.get(i).into_iter().flat_map(|q| conjugate(*q)));
            (self.row_time(*tdb_s), numbers)
        });
        Segment { meta, rows: rows.collect() }
    }

    fn row_time(&self, tdb_s: f64) -> String {
        Epoch::from_tdb_s(tdb_s).map(|epoch| self.time(epoch)).unwrap_or_default()
    }

    /// The time scale and the times of a segment: of its rows, and its usable span if shorter.
    fn times(&self, tdb_s: &[f64], span: Span) -> Vec<(&'static str, String)> {
        let (first, last) = (tdb_s.first().copied(), tdb_s.last().copied());
        let mut times = vec![("TIME_SYSTEM", self.file.scale.name().to_owned())];
        times.extend(first.map(|s| ("START_TIME", self.row_time(s))));
        if (first, last) != (Some(span.start.tdb_s()), Some(span.end.tdb_s())) {
            times.push(("USEABLE_START_TIME", self.time(span.start)));
            times.push(("USEABLE_STOP_TIME", self.time(span.end)));
        }
        times.extend(last.map(|s| ("STOP_TIME", self.row_time(s))));
        times
    }
}

/// What CCSDS calls a frame.
fn frame(name: &str) -> String {
    if name == J2000 { "EME2000".into() } else { one_line(name) }
}

/// A name as allowed in a line.
fn one_line(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The lines of a file's comments.
fn comments(file: &FlightFile) -> impl Iterator<Item = &str> {
    file.comments.iter().flat_map(|comment| comment.lines()).map(str::trim)
}

/// CREATION_DATE and ORIGINATOR.
fn made(file: &FlightFile) -> (String, String) {
    let (date, by) = file.made.as_ref().map_or(MADE, |(date, by)| (date, by));
    (one_line(date), one_line(by))
}

/// A message as KVN.
fn text(message: &Message<'_>) -> String {
    let kind = message.kind;
    let (date, by) = made(message.file);
    let mut text = format!("CCSDS_{kind}_VERS = 2.0\n");
    let is_of_data = kind == "AEM";
    for comment in comments(message.file) {
        text.push_str(format!("COMMENT {comment}").trim_end());
        text.push('\n');
    }
    let _ = writeln!(text, "CREATION_DATE = {date}\nORIGINATOR = {by}");
    for segment in &message.segments {
        text.push_str("\nMETA_START\n");
        segment.meta.iter().for_each(|(key, value)| text.push_str(&format!("{key} = {value}\n")));
        text.push_str(if is_of_data { "META_STOP\n\nDATA_START\n" } else { "META_STOP\n\n" });
        segment.rows.iter().for_each(|(time, numbers)| text.push_str(&format!("{time} {}\n", numbers.join(" "))));
        text.push_str(if is_of_data { "DATA_STOP\n" } else { "" });
    }
    text
}

/// A message as XML.
fn element(message: &Message<'_>) -> Element {
    let kind = message.kind;
    let (date, by) = made(message.file);
    let said = |name: &str, value: &String| Element::new(name).holding(value);
    let header = Element::new("header")
        .and_all(comments(message.file).map(|comment| Element::new("COMMENT").holding(comment)))
        .and(said("CREATION_DATE", &date))
        .and(said("ORIGINATOR", &by));
    let row = |(time, numbers): &(String, Vec<String>)| {
        let epoch = said("EPOCH", time);
        if kind == "OEM" {
            let numbers =
                STATE.iter().zip(numbers).map(|((name, unit), number)| said(name, number).with("units", *unit));
            return Element::new("stateVector").and(epoch).and_all(numbers);
        }
        let part = |name: &str, names: [&'static str; 4], from: usize| {
            Element::new(name).and_all(names.iter().zip(&numbers[from..]).map(|(name, number)| said(name, number)))
        };
        let quaternion = part("quaternion", QUATERNION, 0);
        Element::new("attitudeState").and(match numbers.len() {
            4 => Element::new("quaternionEphemeris").and(epoch).and(quaternion),
            _ => {
                let mut dot = part("quaternionDot", DERIVATIVE, 4);
                dot.children = dot.children.into_iter().map(|child| child.with("units", "1/s")).collect();
                Element::new("quaternionDerivative").and(epoch).and(quaternion).and(dot)
            }
        })
    };
    let segments = message.segments.iter().map(|segment| {
        Element::new("segment")
            .and(Element::new("metadata").and_all(segment.meta.iter().map(|(key, value)| said(key, value))))
            .and(Element::new("data").and_all(segment.rows.iter().map(row)))
    });
    Element::new(kind.to_lowercase())
        .with("id", format!("CCSDS_{kind}_VERS"))
        .with("version", "2.0")
        .and(header)
        .and(Element::new("body").and_all(segments))
}
