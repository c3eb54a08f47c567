//! What a conversion could not carry over as it was: nothing is lost in silence.

use std::fmt;

use crate::error::Location;

/// What became of something that has no exact counterpart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fate {
    /// Left out: the target has no place for it.
    Dropped,
    /// Written as something near to it; the note says how near.
    Approximated,
    /// The source did not say; the note says what was taken.
    Defaulted,
    /// The target has no place for it, but a file beside it keeps it for the way back.
    Carried,
}

impl fmt::Display for Fate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Fate::Dropped => "Dropped",
            Fate::Approximated => "Approximated",
            Fate::Defaulted => "Defaulted",
            Fate::Carried => "Carried",
        })
    }
}

/// One thing that was not carried over as it was.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// What became of it.
    pub fate: Fate,
    /// Where it stands in the source.
    pub at: Location,
    /// What it is, and why.
    pub message: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}: {}", self.fate, self.at, self.message)
    }
}

/// All notes of a conversion, in the order of the source.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Report {
    /// The notes.
    pub notes: Vec<Note>,
}

impl Report {
    /// Adds a note.
    pub fn note(&mut self, fate: Fate, at: Location, message: impl Into<String>) {
        self.notes.push(Note { fate, at, message: message.into() });
    }

    /// Whether something is lost: what `--strict` refuses. Defaults and what is carried beside are no loss.
    pub fn has_losses(&self) -> bool {
        self.notes.iter().any(|n| matches!(n.fate, Fate::Dropped | Fate::Approximated))
    }
}
