//! CK: orientations of spacecraft and instruments. The layouts are those of NAIF's CK Required Reading.
//!
//! Times are ticks of the spacecraft clock, converted to TDB by its clock kernel. Nothing is interpolated across gaps:
//! each interval of a segment is a part of the orientation. We interpolate linearly in TDB, SPICE in ticks; they differ
//! by about 1e-8 of the turn where the clock rate changes (a few times a year), and by the rotation during the jump
//! where the clock jumps.

use std::path::Path;

use glam::{DQuat, DVec3};

use super::clock::Clock;
use super::daf::Daf;
use super::frames::Frames;
use super::pck::append;
use super::{count, epoch, rows};
use crate::error::{Error, Problem, Result};
use crate::flight::{Almanac, Attitudes, Between, Orientation, Span, Spin, Turn, Turning, Unread};

/// Numbers of a quaternion, w first.
const QUATERNION: usize = 4;

/// Doubles and integers of a summary; two of the integers are addresses.
pub(super) const SUMMARY: (usize, usize) = (2, 6);

/// Whether segments of a type are read.
pub(super) fn is_read(kind: i32) -> bool {
    (1..=3).contains(&kind)
}

/// Reads a file's orientations into an almanac.
pub(super) fn furnish(path: &Path, frames: &Frames, almanac: &mut Almanac) -> Result<()> {
    let mut daf = Daf::open(path, SUMMARY.0, SUMMARY.1)?;
    let arrays = std::mem::take(&mut daf.arrays);
    let first = almanac.orientations.len();
    for array in &arrays {
        let [instrument, base, kind, has_rates] = array.integers[..] else { continue };
        let at = daf.at(array.index);
        let (number, clock) = Clock::of_instrument(instrument, almanac)?;
        let Some(clock) = clock else {
            let message = format!("is timed by clock {number}, whose SCLK kernel is not loaded");
            let problem = Problem::new(at, message).with_help("add it to the files");
            return Err(Error::Invalid(vec![problem]));
        };
        let wrong = |message: String| Error::invalid(at.clone(), message);
        let turns = match kind {
            kind if is_read(kind) => {
                let words = daf.words(array)?;
                let span = [array.doubles[0], array.doubles[1]];
                let turns = match kind {
                    1 => single(&words, has_rates != 0, span, &clock),
                    2 => spins(&words, &clock).and_then(|turns| within(turns, span, &clock)),
                    _ => attitudes(&words, has_rates != 0, &clock).and_then(|turns| within(turns, span, &clock)),
                };
                turns.map_err(wrong)?
            }
            kind => {
                let [start, end] = [array.doubles[0], array.doubles[1]].map(|ticks| clock.tdb_s(ticks).and_then(epoch));
                let span = Span { start: start.map_err(wrong)?, end: end.map_err(wrong)? };
                let unread = Unread { at, what: format!("CK type {kind} (for {instrument})") };
                vec![Turn { span: Some(span), turning: Turning::Unread(unread) }]
            }
        };
        let (frame, base) = (frames.of_class(Frames::CK, instrument), frames.of_id(base));
        let source = path.display().to_string();
        append(&mut almanac.orientations, first, Orientation { frame, base, source, turns });
    }
    Ok(())
}

/// A rotation from SPICE's quaternion.
fn rotation(of: &[f64]) -> std::result::Result<DQuat, String> {
    let q = DQuat::from_xyzw(of[1], of[2], of[3], of[0]);
    // Neither too small nor too large to be squared.
    let square = q.length_squared();
    if square.is_normal() { Ok(q * square.sqrt().recip()) } else { Err("has a quaternion of length 0".into()) }
}

/// Clips to the segment's coverage, in ticks.
fn within(turns: Vec<Turn>, span: [f64; 2], clock: &Clock) -> std::result::Result<Vec<Turn>, String> {
    let [start, end] = span.map(|ticks| clock.tdb_s(ticks).and_then(epoch));
    let (start, end) = (start?, end?);
    let cut = |turn: Turn| {
        let span = turn.span?;
        let latest = if span.start < start { start } else { span.start };
        let earliest = if end < span.end { end } else { span.end };
        (latest <= earliest).then_some(Turn { span: Some(Span { start: latest, end: earliest }), ..turn })
    };
    Ok(turns.into_iter().filter_map(cut).collect())
}

/// Type 1: attitudes at single ticks, each valid half a tick before and after: SPICE too needs a tolerance to find one.
fn single(words: &[f64], has_rates: bool, span: [f64; 2], clock: &Clock) -> std::result::Result<Vec<Turn>, String> {
    let size = if has_rates { QUATERNION + 3 } else { QUATERNION };
    let number = count(*words.last().ok_or("has too few words")?)?;
    let others = number.saturating_add(number.saturating_sub(1) / 100).saturating_add(1);
    let (records, ticks) = parts(words, number, size, others)?;
    let turn = |(record, tick): (&[f64], &f64)| {
        let [start, at, end] = [tick - 0.5, *tick, tick + 0.5].map(|tick| clock.tdb_s_near(tick));
        let attitudes = Attitudes {
            tdb_s: vec![at?],
            frame_from_base: vec![rotation(record)?],
            derivative: vec![],
            between: Between::Steps,
        };
        let span = Span { start: epoch(start?)?, end: epoch(end?)? };
        Ok(Turn { span: Some(span), turning: Turning::Attitudes(attitudes) })
    };
    rows(records, size).zip(ticks).filter(|(_, tick)| (span[0]..=span[1]).contains(*tick)).map(turn).collect()
}

/// Type 2: intervals of constant rotation rate, along the base's axes, in rad/s of a clock with so many seconds per
/// tick.
fn spins(words: &[f64], clock: &Clock) -> std::result::Result<Vec<Turn>, String> {
    const SIZE: usize = QUATERNION + 4;
    // Per interval its record and two times; and the directory: n / 100 more.
    let number = (words.len().saturating_sub(1) / (SIZE + 2)..=words.len() / (SIZE + 2))
        .chain([(100 * words.len() + 99) / (100 * (SIZE + 2) + 1), 100 * words.len() / (100 * (SIZE + 2) + 1)])
        .find(|n| *n > 0 && n * (SIZE + 2) + (n - 1) / 100 == words.len())
        .ok_or_else(|| format!("has {} words, which are not a whole number of intervals", words.len()))?;
    let (records, rest) = words.split_at(number * SIZE);
    let (starts, rest) = rest.split_at(number);
    let ends = &rest[..number];
    let turn = |((record, start), end): ((&[f64], &f64), &f64)| {
        let (start_s, end_s) = (clock.tdb_s(*start)?, clock.tdb_s(*end)?);
        if end_s < start_s {
            return Err("has an interval that ends before it starts".into());
        }
        // Clock seconds per TDB second.
        let pace = if end_s > start_s { record[7] * (end - start) / (end_s - start_s) } else { 0.0 };
        let rate_rad_s = DVec3::new(record[4], record[5], record[6]) * pace;
        let since = epoch(start_s)?;
        let spin = Spin { since, frame_from_base: rotation(record)?, rate_rad_s };
        Ok(Turn { span: Some(Span { start: since, end: epoch(end_s)? }), turning: Turning::Spin(spin) })
    };
    rows(records, SIZE).zip(starts).zip(ends).map(turn).collect()
}

/// Type 3: attitudes with constant rotation rate between them, within intervals whose starts are listed.
fn attitudes(words: &[f64], has_rates: bool, clock: &Clock) -> std::result::Result<Vec<Turn>, String> {
    let size = if has_rates { QUATERNION + 3 } else { QUATERNION };
    let [intervals, number] = *words.last_chunk().ok_or("has too few words")?;
    let (intervals, number) = (count(intervals)?, count(number)?);
    let directory = |of: usize| of.saturating_sub(1) / 100;
    let others = [number, directory(number), intervals, directory(intervals), 2];
    let others = others.into_iter().fold(0, usize::saturating_add);
    let (records, rest) = parts(words, number, size, others)?;
    let ticks = &rest[..number];
    let starts = &rest[number + directory(number)..][..intervals];
    if !ticks.is_sorted_by(|a, b| a < b) || !starts.is_sorted_by(|a, b| a < b) {
        return Err("has ticks that do not ascend".into());
    }
    let rotations: Vec<DQuat> = rows(records, size).map(rotation).collect::<std::result::Result<_, _>>()?;
    let mut turns = Vec::new();
    for (i, start) in starts.iter().enumerate() {
        let first = ticks.partition_point(|tick| tick < start);
        let end = starts.get(i + 1).map_or(number, |next| ticks.partition_point(|tick| tick < next));
        if ticks.get(first) != Some(start) {
            return Err(format!("has an interval that starts at tick {start}, where there is no attitude"));
        }
        let tdb_s: Vec<f64> =
            ticks[first..end].iter().map(|tick| clock.tdb_s(*tick)).collect::<std::result::Result<_, _>>()?;
        if !tdb_s.is_sorted_by(|a, b| a < b) {
            return Err("has ticks whose times do not ascend by its clock".into());
        }
        let span = Span { start: epoch(tdb_s[0])?, end: epoch(tdb_s[tdb_s.len() - 1])? };
        let attitudes = Attitudes {
            tdb_s,
            frame_from_base: rotations[first..end].to_vec(),
            derivative: vec![],
            between: Between::SteadyTurn,
        };
        turns.push(Turn { span: Some(span), turning: Turning::Attitudes(attitudes) });
    }
    Ok(turns)
}

/// Splits the words into records and what follows them.
fn parts(words: &[f64], number: usize, size: usize, others: usize) -> std::result::Result<(&[f64], &[f64]), String> {
    match number.checked_mul(size).filter(|records| records.checked_add(others) == Some(words.len()) && number > 0) {
        Some(records) => Ok(words.split_at(records)),
        None => Err(format!("declares {number} attitudes but holds {} words: the file is damaged", words.len())),
    }
}
