//! Binary PCK: orientations of bodies as series of Euler angles. The layouts are those of NAIF's PCK Required Reading.

use std::path::Path;

use super::daf::Daf;
use super::frames::Frames;
use super::spk::{series, span};
use crate::error::{Error, Result};
use crate::flight::{Almanac, Orientation, Turn, Turning, Unread};

/// Doubles and integers of a summary; two of the integers are addresses.
pub(super) const SUMMARY: (usize, usize) = (2, 5);

/// Whether segments of a type are read.
pub(super) fn is_read(kind: i32) -> bool {
    matches!(kind, 2 | 3)
}

/// Adds the turns of a frame to the last orientation of that frame from `first` on, if its base is the same; else adds the orientation: a later one takes precedence.
pub(super) fn append(orientations: &mut Vec<Orientation>, first: usize, of: Orientation) {
    let last = orientations[first..].iter_mut().rev().find(|last| last.frame == of.frame);
    match last.filter(|last| last.base == of.base) {
        Some(last) => last.turns.extend(of.turns),
        None => orientations.push(of),
    }
}

/// Reads a file's orientations into an almanac.
pub(super) fn furnish(path: &Path, frames: &Frames, almanac: &mut Almanac) -> Result<()> {
    let mut daf = Daf::open(path, SUMMARY.0, SUMMARY.1)?;
    let arrays = std::mem::take(&mut daf.arrays);
    let first = almanac.orientations.len();
    for array in &arrays {
        let [class, base, kind] = array.integers[..] else { continue };
        let at = daf.at(array.index);
        let wrong = |message: String| Error::invalid(at.clone(), message);
        let span = Some(span(array).map_err(wrong)?);
        let turning = match kind {
            kind if is_read(kind) => {
                let each = if kind == 2 { 3 } else { 6 };
                Turning::Angles(series(daf.words(array)?, each).map_err(wrong)?)
            }
            kind => Turning::Unread(Unread { at, what: format!("binary PCK type {kind} (for {class})") }),
        };
        let turn = Turn { span, turning };
        let (frame, base) = (frames.of_class(Frames::PCK, class), frames.of_id(base));
        let source = path.display().to_string();
        append(&mut almanac.orientations, first, Orientation { frame, base, source, turns: vec![turn] });
    }
    Ok(())
}
