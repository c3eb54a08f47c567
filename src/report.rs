//! What a conversion could not carry over unchanged: nothing is lost silently.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::error::Location;

/// What became of something that has no exact counterpart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Fate {
    /// Left out: the target cannot hold it.
    Dropped,
    /// Replaced by something close; the note says how close.
    Approximated,
    /// Not stated by the source; the note gives the value taken.
    Defaulted,
    /// The target cannot hold it, but a file next to it keeps it for the conversion back.
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

/// One thing that was not carried over unchanged.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// What became of it.
    pub fate: Fate,
    /// Its location in the source.
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
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// The notes.
    pub notes: Vec<Note>,
}

impl Report {
    /// Adds a note.
    pub fn note(&mut self, fate: Fate, at: Location, message: impl Into<String>) {
        self.notes.push(Note { fate, at, message: message.into() });
    }

    /// Whether something is lost, which `--strict` refuses. Defaults, and what a file next to the target keeps, are no loss.
    pub fn has_losses(&self) -> bool {
        self.notes.iter().any(|n| matches!(n.fate, Fate::Dropped | Fate::Approximated))
    }
}
