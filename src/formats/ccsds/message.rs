//! A message as keys, values and rows with their places, from KVN or XML.

use std::path::Path;

use crate::error::{Error, Location, Problem};
use crate::flight::{Epoch, LeapSeconds, Scale};
use crate::formats::decimal;
use crate::formats::input::Problems;
use crate::formats::table::place;
use crate::formats::xml::Element;
use crate::report::{Fate, Report};

/// What a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// An orbit's ephemeris.
    Oem,
    /// An attitude's ephemeris.
    Aem,
    /// Several messages, as XML.
    Ndm,
    /// Another kind: its name, and a description.
    Other(&'static str, &'static str),
}

/// All recognised kinds.
const KINDS: [(&str, Kind); 11] = [
    ("OEM", Kind::Oem),
    ("AEM", Kind::Aem),
    ("NDM", Kind::Ndm),
    ("OPM", Kind::Other("OPM", "one state of an orbit, which nothing here propagates: ask for it as an OEM")),
    ("OMM", Kind::Other("OMM", "mean elements of an orbit, which nothing here propagates: ask for it as an OEM")),
    ("OCM", Kind::Other("OCM", "an orbit's comprehensive message: ask for it as an OEM")),
    ("APM", Kind::Other("APM", "one attitude: ask for it as an AEM")),
    ("ACM", Kind::Other("ACM", "an attitude's comprehensive message: ask for it as an AEM")),
    ("TDM", Kind::Other("TDM", "tracking data, not an orbit: ask for an OEM")),
    ("CDM", Kind::Other("CDM", "a conjunction, not an orbit: ask for an OEM")),
    ("RDM", Kind::Other("RDM", "a reentry, not an orbit: ask for an OEM")),
];

impl Kind {
    pub(super) fn named(name: &str) -> Option<Self> {
        KINDS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, kind)| *kind)
    }

    /// The error for what is not an ephemeris.
    pub(super) fn refused(self, at: Location) -> Error {
        let feature = match self {
            Kind::Other(name, what) => format!("a message of kind {name} ({what})"),
            _ => "such a message".to_owned(),
        };
        Error::Unsupported { at, feature }
    }

    /// Latest supported version.
    pub(super) fn latest(self) -> u32 {
        if self == Kind::Aem { 2 } else { 3 }
    }
}

/// The kind of a file by its beginning, and whether it is XML.
pub(super) fn told(beginning: &[u8]) -> Option<(Kind, bool)> {
    // The name stands near the beginning, which may be cut within a character.
    let text = String::from_utf8_lossy(&beginning[..beginning.len().min(1 << 14)]);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    if !text.starts_with('<') {
        let is_said = |line: &&str| !line.trim().is_empty() && !is_comment(line.trim());
        let key = text.lines().find(is_said)?.split('=').next()?.trim().to_ascii_uppercase();
        return Some((Kind::named(key.strip_prefix("CCSDS_")?.strip_suffix("_VERS")?)?, false));
    }
    let mut rest = text;
    loop {
        rest = rest.trim_start();
        rest = match () {
            () if rest.starts_with("<?") => rest.split_once("?>")?.1,
            () if rest.starts_with("<!--") => rest.split_once("-->")?.1,
            () => break,
        };
    }
    let end = |c: char| c.is_whitespace() || c == '>' || c == '/';
    Some((Kind::named(local(rest.strip_prefix('<')?.split(end).next()?))?, true))
}

/// Whether a line is a comment.
pub(super) fn is_comment(line: &str) -> bool {
    line.strip_prefix("COMMENT").is_some_and(|rest| rest.is_empty() || rest.starts_with(char::is_whitespace))
}

/// The name of an element without its prefix.
pub(super) fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// A place: a part of the text, or an element.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place<'a> {
    Text(&'a str),
    Element(&'a Element),
}

/// A key with its value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry<'a> {
    pub(super) key: &'a str,
    pub(super) value: &'a str,
    pub(super) at: Place<'a>,
}

/// Metadata and the rows that follow.
#[derive(Debug)]
pub(super) struct Block<'a> {
    pub(super) at: Place<'a>,
    pub(super) meta: Vec<Entry<'a>>,
    pub(super) rows: Vec<Place<'a>>,
    /// The place of its covariances, if any.
    pub(super) covariance: Option<Place<'a>>,
}

/// One message.
#[derive(Debug)]
pub(super) struct Message<'a> {
    pub(super) kind: Kind,
    /// The version, as it is written.
    pub(super) version: Entry<'a>,
    pub(super) header: Vec<Entry<'a>>,
    pub(super) comments: Vec<&'a str>,
    pub(super) blocks: Vec<Block<'a>>,
}

/// A column of numbers: its XML name, an older alternative, its unit (empty: any), and the power of ten to m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Column {
    pub(super) names: [&'static str; 2],
    pub(super) unit: &'static str,
    pub(super) power: i32,
}

/// A column with the same name in all versions.
pub(super) const fn column(name: &'static str, unit: &'static str, power: i32) -> Column {
    Column { names: [name, name], unit, power }
}

impl<'a> Block<'a> {
    pub(super) fn entry(&self, key: &str) -> Option<Entry<'a>> {
        self.meta.iter().find(|entry| entry.key.eq_ignore_ascii_case(key)).copied()
    }
}

/// A text being read, and the problems and notes found in it.
pub(super) struct Reading<'a> {
    pub(super) path: &'a Path,
    text: &'a str,
    pub(super) leap: &'a LeapSeconds,
    pub(super) problems: Problems,
    pub(super) report: Report,
}

impl<'a> Reading<'a> {
    pub(super) fn new(path: &'a Path, text: &'a str, leap: &'a LeapSeconds) -> Self {
        Reading { path, text, leap, problems: Problems::default(), report: Report::default() }
    }

    pub(super) fn at(&self, at: Place<'_>) -> Location {
        place_of(self.path, self.text, at)
    }

    pub(super) fn wrong(&mut self, at: Place<'_>, message: impl Into<String>) {
        let place = || place_of(self.path, self.text, at);
        self.problems.push(|| Problem::new(place(), message));
    }

    pub(super) fn wrong_with(&mut self, at: Place<'_>, message: impl Into<String>, help: impl Into<String>) {
        let place = || place_of(self.path, self.text, at);
        self.problems.push(|| Problem::new(place(), message).with_help(help));
    }

    pub(super) fn note(&mut self, fate: Fate, at: Place<'_>, message: impl Into<String>) {
        let at = self.at(at);
        self.report.note(fate, at, message);
    }

    pub(super) fn unsupported(&self, at: Place<'_>, feature: impl Into<String>) -> Error {
        Error::Unsupported { at: self.at(at), feature: feature.into() }
    }

    /// The value of a key that must be there.
    pub(super) fn needed(&mut self, block: &Block<'a>, key: &str) -> Option<Entry<'a>> {
        let found = block.entry(key).filter(|entry| !entry.value.is_empty());
        if found.is_none() {
            let at = block.entry(key).map_or(block.at, |entry| entry.at);
            self.wrong(at, format!("this segment's metadata lacks {key}"));
        }
        found
    }

    /// An epoch in a time scale.
    pub(super) fn epoch(&mut self, text: &str, scale: Scale, at: Place<'_>) -> Option<Epoch> {
        if text.ends_with(['Z', 'z']) && scale != Scale::Utc {
            let message = format!("{text:?} ends in Z, which means UTC, but TIME_SYSTEM is {}", scale.name());
            self.wrong_with(at, message, "leave out the Z, or correct TIME_SYSTEM");
            return None;
        }
        match Epoch::parse(text, Some(scale), self.leap) {
            Ok(epoch) => Some(epoch),
            Err(why) => {
                self.wrong(at, why);
                None
            }
        }
    }

    /// The epoch of a row and its numbers, scaled by their columns; `allowed` gives the possible numbers of columns.
    pub(super) fn row(
        &mut self,
        row: Place<'a>,
        columns: &[Column],
        allowed: &[usize],
        scale: Scale,
    ) -> Option<(Epoch, Vec<f64>)> {
        let cells: Vec<(&str, Place<'a>)> = match row {
            Place::Text(line) => line.split_whitespace().map(|cell| (cell, Place::Text(cell))).collect(),
            Place::Element(element) => {
                let mut leaves = Vec::new();
                leaves_of(element, &mut leaves);
                let of = |names: [&str; 2]| {
                    leaves.iter().find(|leaf| names.iter().any(|name| local(&leaf.name).eq_ignore_ascii_case(name)))
                };
                let Some(epoch) = of(["EPOCH"; 2]) else {
                    self.wrong(row, "has no EPOCH");
                    return None;
                };
                let mut cells = vec![(epoch.text.as_str(), Place::Element(epoch))];
                for column in columns {
                    let Some(leaf) = of(column.names) else { continue };
                    let is_other =
                        |unit: &&str| !column.unit.is_empty() && !unit.trim().eq_ignore_ascii_case(column.unit);
                    if let Some(unit) = leaf.get("units").filter(is_other) {
                        self.wrong(Place::Element(leaf), format!("is in {unit:?}: CCSDS has {} here", column.unit));
                    }
                    cells.push((leaf.text.as_str(), Place::Element(leaf)));
                }
                cells
            }
        };
        let count = cells.len().saturating_sub(1);
        if !allowed.contains(&count) {
            let numbers: Vec<String> = allowed.iter().map(usize::to_string).collect();
            let names: Vec<&str> = columns.iter().map(|column| column.names[0]).collect();
            let message = format!("{count} numbers after the time; expected {}", numbers.join(" or "));
            self.wrong_with(row, message, format!("the columns are {}", names.join(" ")));
            return None;
        }
        let mut values = Vec::with_capacity(count);
        for ((cell, at), column) in cells[1..].iter().zip(columns) {
            match decimal::parse(cell, column.power) {
                Some(value) => values.push(value),
                None => self.wrong(*at, format!("`{}` is not a finite number", shown(cell))),
            }
        }
        let (time, at) = cells[0];
        let epoch = self.epoch(time, scale, at)?;
        (values.len() == count).then_some((epoch, values))
    }
}

fn place_of(path: &Path, text: &str, at: Place<'_>) -> Location {
    match at {
        Place::Text(part) => place(path, text, part),
        Place::Element(element) => element.at(),
    }
}

/// The elements within that hold no others, at any depth, without comments.
fn leaves_of<'a>(element: &'a Element, leaves: &mut Vec<&'a Element>) {
    for child in &element.children {
        match child.children.is_empty() {
            true if local(&child.name) != "COMMENT" => leaves.push(child),
            true => {}
            false => leaves_of(child, leaves),
        }
    }
}

/// A word as a message shows it.
pub(super) fn shown(word: &str) -> String {
    word.chars().take(40).collect()
}
