//! SPK: trajectories. The layouts are those of NAIF's SPK Required Reading.

use std::path::Path as FilePath;

use glam::DVec3;

use super::daf::{Array, Daf};
use super::frames::Frames;
use super::{count, epoch, rows};
use crate::error::{Error, Result};
use crate::flight::interpolation::MOST_NODES;
use crate::flight::{Almanac, Chebyshev, Interpolation, Nodes, Path, Segment, Span, Trajectory, Unread};
use crate::units::KM_M;

/// Numbers per state: position, km, and velocity, km/s.
const STATE: usize = 6;

/// Doubles and integers of a summary; two of the integers are addresses.
pub(super) const SUMMARY: (usize, usize) = (2, 6);

/// Whether segments of a type are read.
pub(super) fn is_read(kind: i32) -> bool {
    matches!(kind, 2 | 3 | 8 | 9 | 12 | 13)
}

/// Reads a file's trajectories into an almanac.
pub(super) fn furnish(path: &FilePath, frames: &Frames, almanac: &mut Almanac) -> Result<()> {
    let mut daf = Daf::open(path, SUMMARY.0, SUMMARY.1)?;
    let arrays = std::mem::take(&mut daf.arrays);
    let first = almanac.trajectories.len();
    for array in &arrays {
        let [target, centre, frame, kind] = array.integers[..] else { continue };
        let wrong = |message: String| Error::invalid(daf.at(array.index), message);
        let [target, centre] = [target, centre].map(|id| almanac.names.body(&id.to_string()));
        let frame = frames.of_id(frame);
        let span = span(array).map_err(wrong)?;
        let path_of = match kind {
            kind if is_read(kind) => {
                let at = daf.at(array.index);
                self::path(kind, daf.words(array)?).map_err(|message| Error::invalid(at, message))?
            }
            kind => Path::Unread(Unread { at: daf.at(array.index), what: format!("SPK type {kind} (for {target})") }),
        };
        let segment = Segment { span, path: path_of };
        // A later segment of the same target takes precedence, whatever its centre.
        let last = almanac.trajectories[first..].iter_mut().rev().find(|of| of.target == target);
        match last.filter(|of| of.centre == centre && of.frame == frame) {
            Some(trajectory) => trajectory.segments.push(segment),
            None => {
                let source = path.display().to_string();
                almanac.trajectories.push(Trajectory { target, centre, frame, source, segments: vec![segment] });
            }
        }
    }
    Ok(())
}

/// The span of a segment, from the first two doubles of its summary.
pub(super) fn span(array: &Array) -> std::result::Result<Span, String> {
    let [start, end] = [array.doubles[0], array.doubles[1]];
    if end < start {
        return Err(format!("ends at {end}, before it starts at {start}"));
    }
    Ok(Span { start: epoch(start)?, end: epoch(end)? })
}

/// Interprets the words of a segment.
fn path(kind: i32, words: Vec<f64>) -> std::result::Result<Path, String> {
    match kind {
        2 => Ok(Path::Chebyshev(series(words, 3)?)),
        3 => Ok(Path::Chebyshev(series(words, STATE)?)),
        _ => nodes(kind, &words).map(Path::Nodes),
    }
}

/// Chebyshev records, followed by start, interval length, record length and record count.
pub(super) fn series(mut words: Vec<f64>, series: usize) -> std::result::Result<Chebyshev, String> {
    let [start_s, interval_s, size, records] = *words.last_chunk().ok_or("has too few words")?;
    let (size, records) = (count(size)?, count(records)?);
    words.truncate(words.len() - 4);
    let terms = size.saturating_sub(2) / series;
    if size != 2 + terms * series || size.checked_mul(records) != Some(words.len()) {
        return Err(format!(
            "declares {records} records of {size} words but holds {} words: the file is damaged",
            words.len()
        ));
    }
    let chebyshev = Chebyshev { start_s, interval_s, terms, series, records: words };
    if chebyshev.is_sound() { Ok(chebyshev) } else { Err("has intervals of length 0, or no terms".into()) }
}

/// States at equal steps (types 8, 12) or at any times (9, 13), for Lagrange (8, 9) or Hermite (12, 13) polynomials.
fn nodes(kind: i32, words: &[f64]) -> std::result::Result<Nodes, String> {
    let is_even = matches!(kind, 8 | 12);
    let (degree, number) = match words {
        [.., degree, number] => (count(*degree)?, count(*number)?),
        _ => return Err("has too few words".into()),
    };
    // Every hundredth time is repeated in a directory.
    let others = if is_even { 4 } else { number.saturating_add(number.saturating_sub(1) / 100).saturating_add(2) };
    if number == 0 || number.checked_mul(STATE).and_then(|of| of.checked_add(others)) != Some(words.len()) {
        return Err(format!("declares {number} states but holds {} words: the file is damaged", words.len()));
    }
    if degree >= MOST_NODES {
        return Err(format!("interpolates {} states at once: at most {MOST_NODES} are supported", degree + 1));
    }
    let (states, rest) = words.split_at(number * STATE);
    let tdb_s: Vec<f64> = match is_even {
        #[allow(clippy::cast_precision_loss, reason = "counts of what is in memory are whole numbers of an f64")]
        true => (0..number).map(|i| rest[0] + rest[1] * i as f64).collect(),
        false => rest[..number].to_vec(),
    };
    if !tdb_s.is_sorted_by(|a, b| a < b) {
        return Err("has times that do not ascend".into());
    }
    let vector = |of: &[f64]| DVec3::new(of[0], of[1], of[2]) * KM_M;
    Ok(Nodes {
        tdb_s,
        position_m: rows(states, STATE).map(|state| vector(&state[..3])).collect(),
        velocity_m_s: rows(states, STATE).map(|state| vector(&state[3..])).collect(),
        interpolation: match kind {
            8 | 9 => Interpolation::Lagrange(degree + 1),
            _ => Interpolation::Hermite(degree + 1),
        },
    })
}
