//! Hand-written tables of positions and attitudes: epochs, and for each the states of objects relative to one centre.
//! As CSV or TOML; CONVENTIONS.md describes both, `schemas/flight.schema.json` the TOML.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DQuat, DVec3, DVec4};
use schemars::JsonSchema;
use serde::Deserialize;

use super::decimal;
use super::flight_file::{FlightFile, MOST_OFF, Object};
use super::format::{Format, Holds, ending};
use super::input::{self, InputFile, Problems};
use super::located::Document;
use super::spelling;
use super::table::{Places, place};
use crate::error::{Location, Problem, Result};
use crate::flight::interpolation::{DEFAULT_DEGREE, MOST_NODES, hermite_nodes};
use crate::flight::{
    self, Attitudes, Between, Epoch, Interpolation, LeapSeconds, Nodes, Orientation, Scale, Segment, Span, Trajectory,
    Turn, Turning, body_name, frame_name,
};
use crate::report::{Fate, Report};

/// Largest file, bytes.
const LIMIT: u64 = 256 << 20;
/// Parts of an object's state: position, velocity and quaternion, by their ranges in [`ENDINGS`].
const PARTS: [(&str, std::ops::Range<usize>); 3] = [("position", 0..3), ("velocity", 3..6), ("quaternion", 6..10)];
/// Endings of column names, with units, and the powers of ten that convert to m and m/s.
const ENDINGS: [[(&str, i32); 2]; 10] = [
    [("_x_km", 3), ("_x_m", 0)],
    [("_y_km", 3), ("_y_m", 0)],
    [("_z_km", 3), ("_z_m", 0)],
    [("_vx_km_s", 3), ("_vx_m_s", 0)],
    [("_vy_km_s", 3), ("_vy_m_s", 0)],
    [("_vz_km_s", 3), ("_vz_m_s", 0)],
    [("_q1", 0), ("_q1", 0)],
    [("_q2", 0), ("_q2", 0)],
    [("_q3", 0), ("_q3", 0)],
    [("_qc", 0), ("_qc", 0)],
];

/// The key that identifies a table as TOML.
const KEY: &str = "mmxrt_flight";

/// A table of positions and attitudes.
pub(super) static TABLE: Format = Format {
    name: "flight",
    extensions: &[],
    reads: "tables of positions and attitudes (.csv, .toml)",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| is_table(path, beginning).then(|| path.to_owned())),
    holds: Holds::Flight { read, write: None },
};

/// One column: the index of its object, its quantity in [`ENDINGS`], and its power of ten.
struct Column {
    thing: usize,
    quantity: usize,
    power: i32,
}

/// An object or a frame.
struct Thing<'a> {
    name: &'a str,
    /// Which quantities are given.
    given: [bool; 10],
    /// Values per row, m, m/s and 1.
    values: Vec<[f64; 10]>,
}

/// Name, quantity and power of ten of a column heading.
fn meaning(heading: &str) -> Option<(&str, usize, i32)> {
    let lower = heading.to_ascii_lowercase();
    ENDINGS.iter().enumerate().find_map(|(quantity, units)| {
        let (ending, power) = units.iter().find(|(ending, _)| lower.ends_with(ending))?;
        Some((heading.get(..heading.len() - ending.len()).filter(|name| !name.is_empty())?, quantity, *power))
    })
}

/// Lines that are not comments.
fn rows_of(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'))
}

fn cells(line: &str) -> Vec<&str> {
    let separator = [';', '\t', ','].into_iter().find(|c| line.contains(*c)).unwrap_or(',');
    line.split(separator).map(|cell| cell.trim().trim_matches('"')).collect()
}

fn is_table(path: &Path, beginning: &[u8]) -> bool {
    let text = String::from_utf8_lossy(beginning);
    if ending(path) == "toml" {
        return rows_of(&text).any(|line| line.split('=').next().is_some_and(|key| key.trim() == KEY));
    }
    let header = rows_of(text.trim_start_matches('\u{feff}')).next().unwrap_or_default();
    ["csv", "txt", "tsv", "dat", "tab"].contains(&ending(path).as_str())
        && cells(header).into_iter().any(|cell| meaning(cell).is_some())
}

/// Reads a table.
///
/// # Errors
/// [`Io`](crate::Error::Io); as [`parse`].
pub fn read(path: &Path, leap: &LeapSeconds) -> Result<FlightFile> {
    if ending(path) == "toml" {
        let (document, input) = Document::open(path)?;
        return parse_toml(&document, input, leap);
    }
    let (text, input) = input::text(path, LIMIT)?;
    parse(&text, input, leap)
}

/// What applies to all rows of a table.
struct Heading<'a> {
    centre: Option<&'a str>,
    frame: Option<&'a str>,
    degree: Option<usize>,
    /// Epoch from which seconds count.
    start: Option<Epoch>,
}

/// Reads the text of a table.
///
/// # Errors
/// [`Invalid`](crate::Error::Invalid) with all that cannot be used.
pub fn parse(text: &str, input: InputFile, leap: &LeapSeconds) -> Result<FlightFile> {
    let path = &input.path.clone();
    let mut problems = Problems::default();
    let heading = heading(path, text, leap, &mut problems);
    let mut lines = rows_of(text);
    let header = lines.next().map(cells).unwrap_or_default();
    let clock = header.first().copied().unwrap_or_default();
    let scale = Scale::named(clock);
    let is_of_seconds = clock.eq_ignore_ascii_case("seconds");
    if scale.is_none() && !is_of_seconds && !clock.eq_ignore_ascii_case("time") {
        let problem = || Problem::new(place(path, text, clock), format!("`{clock}` is not a column of time"));
        let help = "the first column is time (with a scale behind each), utc, tai, tt, tdb, gps, or seconds";
        problems.push(|| problem().with_help(help));
    }
    if is_of_seconds && heading.start.is_none() {
        let problem = || Problem::new(place(path, text, clock), "`seconds` needs an `epoch`");
        problems.push(|| problem().with_help("add above it: # epoch = 2026-07-01T00:00:00 UTC"));
    }
    let (columns, mut things) = columns(path, text, header.get(1..).unwrap_or_default(), &mut problems);
    // Without these the rows cannot be interpreted.
    problems.finish(path)?;
    let mut problems = Problems::default();
    let mut places = Places::of(path, text);
    let mut epochs: Vec<Epoch> = Vec::new();
    for line in lines {
        let cells = cells(line);
        if cells.len() != header.len() {
            let message = format!("{} columns where the header has {}", cells.len(), header.len());
            problems.push(|| Problem::new(places.place(line), message));
            continue;
        }
        let moment = match heading.start.filter(|_| is_of_seconds) {
            Some(start) => decimal::parse(cells[0], 0)
                .ok_or_else(|| format!("`{}` is not a finite number", cells[0]))
                .and_then(|seconds| start.checked_after_s(seconds).ok_or_else(|| TOO_FAR.to_owned())),
            None => Epoch::parse(cells[0], scale, leap),
        };
        match moment {
            Err(why) => problems.push(|| Problem::new(places.place(cells[0]), why)),
            Ok(epoch) if epochs.last().is_some_and(|last| *last >= epoch) => {
                let problem = || Problem::new(place(path, text, cells[0]), "is not later than the previous row");
                problems.push(|| problem().with_help("sort the rows by time, each moment once"));
            }
            Ok(epoch) => epochs.push(epoch),
        }
        things.iter_mut().for_each(|thing| thing.values.push([0.0; 10]));
        for (cell, column) in cells[1..].iter().zip(&columns) {
            match (decimal::parse(cell, column.power), things[column.thing].values.last_mut()) {
                (Some(value), Some(row)) => row[column.quantity] = value,
                _ => {
                    let message = format!("`{cell}` is not a finite number");
                    problems.push(|| Problem::new(place(path, text, cell), message));
                }
            }
        }
        for thing in things.iter().filter(|thing| thing.given[6]) {
            let length = thing.values.last().map_or(1.0, |row| quaternion(row).length());
            if length.is_nan() || (length - 1.0).abs() > MOST_OFF {
                let message = format!("the quaternion of {} has length {length:.6}: must be 1", thing.name);
                problems.push(|| Problem::new(place(path, text, line), message));
            }
        }
    }
    if epochs.is_empty() && problems.is_empty() {
        problems.push(|| Problem::new(Location::file(path), "no rows: a header, then at least one row"));
    }
    problems.finish(path)?;
    Ok(file(&heading, &epochs, &things, scale.unwrap_or(Scale::Utc), input))
}

/// What is said of seconds that lead too far.
const TOO_FAR: &str = "is more than 100,000 years away";

/// Positions and attitudes over time; every row has the same objects, rows are in order of time, and every time has a time scale.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TomlTable {
    /// Version of this format.
    #[serde(rename = "mmxrt_flight")]
    #[schemars(range(min = 1, max = 1))]
    _version: u32,
    /// Centre of the positions.
    centre: String,
    /// Frame; default: the centre's.
    frame: Option<String>,
    /// Degree of polynomials; 1 is linear.
    #[schemars(range(min = 1))]
    degree: Option<usize>,
    /// Epoch from which `seconds` count.
    epoch: Option<String>,
    /// Rows, in order of time.
    #[schemars(length(min = 1))]
    row: Vec<TomlRow>,
}

/// The states at an epoch.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TomlRow {
    /// The epoch, with its time scale.
    time: Option<String>,
    /// The epoch, s after `epoch`.
    seconds: Option<f64>,
    /// Positions, km.
    #[serde(default)]
    position_km: BTreeMap<String, [f64; 3]>,
    /// Positions, m.
    #[serde(default)]
    position_m: BTreeMap<String, [f64; 3]>,
    /// Velocities, km/s.
    #[serde(default)]
    velocity_km_s: BTreeMap<String, [f64; 3]>,
    /// Velocities, m/s.
    #[serde(default)]
    velocity_m_s: BTreeMap<String, [f64; 3]>,
    /// Orientations of frames: q1, q2, q3, qc.
    #[serde(default)]
    quaternion: BTreeMap<String, [f64; 4]>,
}

impl TomlRow {
    /// All objects with their given quantities: m, m/s and 1.
    fn things(&self) -> BTreeMap<&str, ([bool; 10], [f64; 10])> {
        let mut things = BTreeMap::<&str, ([bool; 10], [f64; 10])>::new();
        let vectors = [
            (&self.position_km, 0, 1000.0),
            (&self.position_m, 0, 1.0),
            (&self.velocity_km_s, 3, 1000.0),
            (&self.velocity_m_s, 3, 1.0),
        ];
        for (named, from, unit) in vectors {
            for (name, vector) in named {
                let (given, values) = things.entry(name).or_default();
                given[from..from + 3].fill(true);
                values[from..from + 3].copy_from_slice(&vector.map(|part| part * unit));
            }
        }
        for (name, q) in &self.quaternion {
            let (given, values) = things.entry(name).or_default();
            given[6..].fill(true);
            values[6..].copy_from_slice(q);
        }
        things
    }
}

/// The JSON Schema of a table as TOML.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(TomlTable)
}

/// Reads a table as TOML.
///
/// # Errors
/// [`Invalid`](crate::Error::Invalid) with all that cannot be used.
pub fn parse_toml(document: &Document, input: InputFile, leap: &LeapSeconds) -> Result<FlightFile> {
    let table: TomlTable = document.read()?;
    let mut problems = Problems::default();
    let epoch = |text: &str, item: &str, problems: &mut Problems| {
        let read = Epoch::parse(text, None, leap);
        read.map_err(|why| problems.push(|| Problem::new(document.at(item), why))).ok()
    };
    let start = table.epoch.as_ref().and_then(|text| epoch(text, "epoch", &mut problems));
    let mut epochs: Vec<Epoch> = Vec::new();
    let mut things: Vec<Thing<'_>> = Vec::new();
    for (i, row) in table.row.iter().enumerate() {
        let item = format!("row[{i}]");
        let moment = match (&row.time, row.seconds, start) {
            (Some(text), None, _) => epoch(text, &format!("{item}.time"), &mut problems),
            (None, Some(seconds), Some(start)) => {
                let moment = start.checked_after_s(seconds);
                if moment.is_none() {
                    problems.push(|| Problem::new(document.at(&format!("{item}.seconds")), TOO_FAR));
                }
                moment
            }
            _ => {
                let message = "needs either `time` with its scale, or `seconds` and a top-level `epoch`";
                problems.push(|| Problem::new(document.at(&item), message));
                None
            }
        };
        if moment.is_some_and(|epoch| epochs.last().is_some_and(|last| *last >= epoch)) {
            let problem = Problem::new(document.at(&item), "is not later than the previous row");
            problems.push(|| problem.with_help("sort the rows by time, each moment once"));
        }
        epochs.extend(moment);
        let known = row.things();
        if i == 0 {
            things.extend(known.iter().map(|(name, (given, _))| Thing { name, given: *given, values: vec![] }));
        }
        let is_same = known.len() == things.len()
            && known
                .iter()
                .zip(&things)
                .all(|((name, (given, _)), thing)| *name == thing.name && *given == thing.given);
        if !is_same {
            problems.push(|| Problem::new(document.at(&item), "must list the same objects as the first row"));
            continue;
        }
        for ((name, (given, values)), thing) in known.iter().zip(&mut things) {
            let length = quaternion(values).length();
            if given[6] && (length.is_nan() || (length - 1.0).abs() > MOST_OFF) {
                let message = format!("the quaternion of {name} has length {length:.6}: must be 1");
                problems.push(|| Problem::new(document.at(&format!("{item}.quaternion")), message));
            }
            if given[3] && !given[0] {
                let message = format!("{name} has a velocity, but no position");
                problems.push(|| Problem::new(document.at(&item), message));
            }
            thing.values.push(*values);
        }
    }
    problems.finish(&input.path)?;
    let heading = Heading { centre: Some(&table.centre), frame: table.frame.as_deref(), degree: table.degree, start };
    Ok(file(&heading, &epochs, &things, Scale::Utc, input))
}

fn heading<'a>(path: &Path, text: &'a str, leap: &LeapSeconds, problems: &mut Problems) -> Heading<'a> {
    let mut heading = Heading { centre: None, frame: None, degree: None, start: None };
    for line in text.lines().filter_map(|line| line.trim().strip_prefix('#')) {
        let Some((key, value)) = line.split_once('=').map(|(key, value)| (key.trim(), value.trim())) else { continue };
        let mut wrong = |why: String| problems.push(|| Problem::new(place(path, text, value), why));
        match key.to_ascii_lowercase().as_str() {
            "centre" | "center" => heading.centre = Some(value),
            "frame" => heading.frame = Some(value),
            "degree" => match value.parse::<usize>() {
                Ok(degree) if degree > 0 => heading.degree = Some(degree),
                _ => wrong(format!("`{value}` is not a degree of polynomials: 1, 2, 3 ...")),
            },
            "epoch" => match Epoch::parse(value, None, leap) {
                Ok(epoch) => heading.start = Some(epoch),
                Err(why) => wrong(why),
            },
            // A remark may hold what it likes, but for what is meant as a key of these.
            other => {
                if let Some(meant) = spelling::nearest(other, &["centre", "frame", "degree", "epoch"]) {
                    problems.push(|| {
                        let problem =
                            Problem::new(place(path, text, line), format!("`{other}` is not a key of a table"));
                        problem.with_help(format!("did you mean `{meant}`? If it is a remark, leave out the `=`"))
                    });
                }
            }
        }
    }
    if heading.centre.is_none_or(str::is_empty) {
        let problem = Problem::new(Location::file(path), "`centre` is missing");
        problems.push(|| problem.with_help("add at the beginning: # centre = PHOBOS"));
    }
    heading
}

/// The meaning of the columns after the first, and the objects they belong to, without rows.
fn columns<'a>(path: &Path, text: &str, header: &[&'a str], problems: &mut Problems) -> (Vec<Column>, Vec<Thing<'a>>) {
    let (mut columns, mut things) = (Vec::new(), Vec::<Thing<'a>>::new());
    for heading in header {
        let at = || place(path, text, heading);
        let Some((name, quantity, power)) = meaning(heading) else {
            let help = "columns are NAME_x_km or _m, NAME_vx_km_s or _m_s, and NAME_q1, _q2, _q3, _qc";
            problems.push(|| Problem::new(at(), format!("`{heading}` is not a known column")).with_help(help));
            continue;
        };
        let known = things.iter().position(|thing| thing.name.eq_ignore_ascii_case(name));
        let thing = known.unwrap_or(things.len());
        if known.is_none() {
            things.push(Thing { name, given: [false; 10], values: vec![] });
        }
        if std::mem::replace(&mut things[thing].given[quantity], true) {
            problems.push(|| Problem::new(at(), format!("duplicate column `{heading}`")));
        }
        columns.push(Column { thing, quantity, power });
    }
    for Thing { name, given, .. } in &things {
        for (part, range) in PARTS {
            let (count, all) = (given[range.clone()].iter().filter(|given| **given).count(), range.len());
            if count > 0 && count < all {
                let message = format!("{name} has {count} of the {all} {part} columns");
                problems.push(|| Problem::new(Location::file(path), message));
            }
        }
        if given[3] && !given[0] {
            problems.push(|| Problem::new(Location::file(path), format!("{name} has a velocity, but no position")));
        }
    }
    (columns, things)
}

fn quaternion(row: &[f64; 10]) -> DVec4 {
    DVec4::from_slice(&row[6..])
}

/// Trajectories and orientations of a valid table.
fn file(heading: &Heading<'_>, epochs: &[Epoch], things: &[Thing<'_>], scale: Scale, input: InputFile) -> FlightFile {
    let mut report = Report::default();
    let mut said = |what: &str| report.note(Fate::Defaulted, Location::file(&input.path), what);
    let centre = body_name(heading.centre.unwrap_or_default());
    let frame = frame_name(&heading.frame.map_or_else(|| format!("IAU_{centre}"), str::to_owned));
    if heading.frame.is_none() {
        said(&format!("frame: {frame}"));
    }
    if heading.degree.is_none() {
        said(&format!("degree: {DEFAULT_DEGREE}"));
    }
    let degree = heading.degree.unwrap_or(DEFAULT_DEGREE);
    let span = Span { start: epochs[0], end: epochs[epochs.len() - 1] };
    let tdb_s: Vec<f64> = epochs.iter().map(|epoch| epoch.tdb_s()).collect();
    let source = input.path.display().to_string();
    let object = |name: &str| Object { name: name.to_owned(), id: name.to_owned() };
    let trajectory = |thing: &Thing<'_>| {
        let vector = |from: usize| thing.values.iter().map(|row| DVec3::from_slice(&row[from..from + 3])).collect();
        let most = MOST_NODES;
        let interpolation = match thing.given[3] {
            true => Interpolation::Hermite(hermite_nodes(degree).min(most)),
            false => Interpolation::Lagrange(degree.saturating_add(1).min(most)),
        };
        let velocity_m_s = if thing.given[3] { vector(3) } else { vec![] };
        let nodes = Nodes { tdb_s: tdb_s.clone(), position_m: vector(0), velocity_m_s, interpolation };
        let trajectory = Trajectory {
            target: body_name(thing.name),
            centre: centre.clone(),
            frame: frame.clone(),
            source: source.clone(),
            segments: vec![Segment { span, path: flight::Path::Nodes(nodes) }],
        };
        (object(thing.name), trajectory)
    };
    let orientation = |thing: &Thing<'_>| {
        // It turns axes, and components by its inverse.
        let turned = |row| DQuat::from_vec4(quaternion(row).normalize()).conjugate();
        let attitudes = Attitudes {
            tdb_s: tdb_s.clone(),
            frame_from_base: thing.values.iter().map(turned).collect(),
            derivative: vec![],
            between: Between::SteadyTurn,
        };
        let orientation = Orientation {
            frame: frame_name(thing.name),
            base: frame.clone(),
            source: source.clone(),
            turns: vec![Turn { span: Some(span), turning: Turning::Attitudes(attitudes.with_continuous_signs()) }],
        };
        (object(thing.name), orientation)
    };
    FlightFile {
        trajectories: things.iter().filter(|thing| thing.given[0]).map(trajectory).collect(),
        orientations: things.iter().filter(|thing| thing.given[6]).map(orientation).collect(),
        scale,
        made: None,
        comments: vec![],
        report,
        input,
    }
}
