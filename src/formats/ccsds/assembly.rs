//! From the segments of messages to trajectories and orientations.

use super::message::{Block, Entry, Kind, Message, Place, Reading, shown};
use super::{attitude, orbit};
use crate::error::Result;
use crate::flight::{Scale, Span, Turn};
use crate::formats::flight_file::FlightFile;
use crate::formats::input::InputFile;
use crate::report::Fate;

/// Metadata keys of both kinds of segments.
const COMMON: [&str; 9] = [
    "OBJECT_NAME",
    "OBJECT_ID",
    "CENTER_NAME",
    "TIME_SYSTEM",
    "START_TIME",
    "USEABLE_START_TIME",
    "USEABLE_STOP_TIME",
    "STOP_TIME",
    "INTERPOLATION_DEGREE",
];

/// The trajectories and orientations of all messages.
///
/// # Errors
/// `Unsupported` for versions, time scales and attitudes that are not read; `Invalid` with all that is wrong.
pub(super) fn file<'a>(messages: &[Message<'a>], mut reading: Reading<'a>, input: InputFile) -> Result<FlightFile> {
    let (mut trajectories, mut orientations, mut scale) = (Vec::new(), Vec::new(), None);
    for message in messages {
        check_version(message, &mut reading)?;
        if message.blocks.is_empty() {
            reading.wrong(message.version.at, "holds no segment: metadata, then rows");
        }
        for block in &message.blocks {
            let own = if message.kind == Kind::Oem { orbit::KEYS } else { attitude::KEYS };
            check_keys(block, own, &mut reading);
            let Some(of) = scale_of(block, &mut reading)? else { continue };
            scale.get_or_insert(of);
            match message.kind {
                Kind::Oem => {
                    let found = orbit::trajectory(block, of, &mut reading);
                    add_orbit(found, &mut trajectories, block.at, &mut reading);
                }
                _ => {
                    let version = major(message.version.value).unwrap_or(2);
                    let found = attitude::orientation(block, of, version, &mut reading)?;
                    add_attitude(found, &mut orientations, block.at, &mut reading);
                }
            }
        }
    }
    reading.problems.finish(reading.path)?;
    let said = |key: &str| {
        let mut headers = messages.iter().flat_map(|message| &message.header);
        headers.find(|entry| entry.key.eq_ignore_ascii_case(key)).map(|entry| entry.value.to_owned())
    };
    let comments = messages.iter().flat_map(|message| &message.comments).map(|comment| (*comment).to_owned()).collect();
    Ok(FlightFile {
        trajectories,
        orientations,
        scale: scale.unwrap_or(Scale::Utc),
        made: said("CREATION_DATE").zip(said("ORIGINATOR")),
        comments,
        report: reading.report,
        input,
    })
}

/// Adds an orbit; one that continues the previous one is its next segment.
fn add_orbit(found: Option<orbit::Found>, all: &mut Vec<orbit::Found>, at: Place<'_>, reading: &mut Reading<'_>) {
    let Some((object, found)) = found else { return };
    let same = |last: &&mut orbit::Found| {
        last.1.target == found.target && last.1.centre == found.centre && last.1.frame == found.frame
    };
    match all.last_mut().filter(same) {
        Some((_, last)) => {
            let overlaps =
                last.segments.iter().any(|before| found.segments.iter().any(|of| overlap(before.span, of.span)));
            if overlaps {
                note_overlap(at, reading);
            }
            last.segments.extend(found.segments);
        }
        None => all.push((object, found)),
    }
}

/// Adds an attitude; one that continues the previous one is its next segment.
fn add_attitude(
    found: Option<attitude::Found>,
    all: &mut Vec<attitude::Found>,
    at: Place<'_>,
    reading: &mut Reading<'_>,
) {
    let Some((object, found)) = found else { return };
    let same = |last: &&mut attitude::Found| last.1.frame == found.frame && last.1.base == found.base;
    match all.last_mut().filter(same) {
        Some((_, last)) => {
            let spans = |turns: &[Turn]| turns.iter().filter_map(|turn| turn.span).collect::<Vec<_>>();
            let found_spans = spans(&found.turns);
            if spans(&last.turns).iter().any(|before| found_spans.iter().any(|of| overlap(*before, *of))) {
                note_overlap(at, reading);
            }
            last.turns.extend(found.turns);
        }
        None => all.push((object, found)),
    }
}

/// Whether spans share more than an instant.
fn overlap(a: Span, b: Span) -> bool {
    a.start < b.end && b.start < a.end
}

fn note_overlap(at: Place<'_>, reading: &mut Reading<'_>) {
    reading.note(Fate::Approximated, at, "overlaps an earlier segment: the later one is used");
}

/// The number before the point.
fn major(version: &str) -> Option<u32> {
    version.split('.').next()?.parse().ok()
}

fn check_version(message: &Message<'_>, reading: &mut Reading<'_>) -> Result<()> {
    let Entry { value, at, .. } = message.version;
    match major(value) {
        Some(version) if (1..=message.kind.latest()).contains(&version) => Ok(()),
        Some(_) => Err(reading.unsupported(at, format!("version {value} of such a message"))),
        None => {
            reading.wrong(at, format!("`{}` is not a version, e.g. 2.0", shown(value)));
            Ok(())
        }
    }
}

/// Reports keys that are given twice, and unknown ones.
fn check_keys(block: &Block<'_>, own: &[&str], reading: &mut Reading<'_>) {
    for (i, entry) in block.meta.iter().enumerate() {
        if block.meta[..i].iter().any(|before| before.key.eq_ignore_ascii_case(entry.key)) {
            reading.wrong(entry.at, format!("{} is given twice in the metadata of this segment", shown(entry.key)));
        } else if !COMMON.iter().chain(own).any(|known| known.eq_ignore_ascii_case(entry.key)) {
            reading.note(Fate::Dropped, entry.at, format!("{} is not a known key", shown(entry.key)));
        }
    }
}

fn scale_of<'a>(block: &Block<'a>, reading: &mut Reading<'a>) -> Result<Option<Scale>> {
    let Some(entry) = reading.needed(block, "TIME_SYSTEM") else { return Ok(None) };
    match Scale::named(entry.value) {
        Some(scale) => Ok(Some(scale)),
        None => {
            let feature = format!("TIME_SYSTEM = {} (UTC, TAI, TT, TDB and GPS are)", shown(entry.value));
            Err(reading.unsupported(entry.at, feature))
        }
    }
}
