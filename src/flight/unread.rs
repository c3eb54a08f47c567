//! Data of types that are not read.

use crate::error::{Error, Location};

/// A segment we cannot read. It still overrides earlier data, so asking for it is an error, not an older value.
#[derive(Debug, Clone, PartialEq)]
pub struct Unread {
    /// Where it is.
    pub at: Location,
    /// Its type, e.g. "SPK type 10".
    pub what: String,
}

impl Unread {
    /// The error when it is asked for.
    pub fn error(&self) -> Error {
        Error::Unsupported { at: self.at.clone(), feature: self.what.clone() }
    }
}
