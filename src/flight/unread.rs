//! What a file knows in a way that is not read.

use crate::error::{Error, Location};

/// A part of a file that is known to be there, and no more: it stands before what came earlier, and whoever asks for it is told so.
#[derive(Debug, Clone, PartialEq)]
pub struct Unread {
    /// Where it is.
    pub at: Location,
    /// What it is, as in "SPK type 10".
    pub what: String,
}

impl Unread {
    /// The answer to whoever asks for it.
    pub fn error(&self) -> Error {
        Error::Unsupported { at: self.at.clone(), feature: self.what.clone() }
    }
}
