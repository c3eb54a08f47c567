//! CCSDS messages: orbits (OEM, blue book 502.0, versions 1 to 3) and attitudes (AEM, 504.0, versions 1 and 2), as `KEY
//! = value` lines (KVN) or XML (505.0).
//!
//! - Each segment is interpolated for itself, as it says. Where it does not: a Hermite polynomial of degree 7 if there are velocities,
//!   otherwise Lagrange's; attitudes turn steadily from one to the next. The report says so.
//! - It holds from USEABLE_START_TIME to USEABLE_STOP_TIME, or where it has none from START_TIME to STOP_TIME, but never beyond its own
//!   lines. Where segments overlap, the later one of the file holds.
//! - Accelerations and covariances are left out.
//! - Attitudes are quaternions, alone or with their derivative or the angular velocity, or Euler angles; `attitude.rs` has the conventions.

mod assembly;
mod attitude;
mod kvn;
mod message;
mod ndm;
mod orbit;
mod segment;
mod write;

use std::path::Path;

use self::message::{Kind, Reading};
use super::flight_file::FlightFile;
use super::format::{Format, Holds};
use super::input::{self, InputFile};
use super::xml;
use crate::error::{Error, Location, Problem, Result};
use crate::flight::LeapSeconds;

pub use write::{aem, ndm, oem};

/// Largest file, bytes.
const LIMIT: u64 = 256 << 20;

/// Orbits, as text.
pub(super) static OEM: Format = Format {
    name: "oem",
    extensions: &["oem"],
    reads: "orbits: CCSDS OEM 1 to 3",
    writes: "the same, version 2",
    mark: &[],
    // Other kinds are refused by name.
    told: Some(|path, beginning| {
        matches!(message::told(beginning), Some((Kind::Oem | Kind::Other(..), false))).then(|| path.to_owned())
    }),
    holds: Holds::Flight { read, write: Some(write::oem) },
};

/// Attitudes, as text.
pub(super) static AEM: Format = Format {
    name: "aem",
    extensions: &["aem"],
    reads: "attitudes: CCSDS AEM 1 and 2",
    writes: "the same, version 2",
    mark: &[],
    told: Some(|path, beginning| matches!(message::told(beginning), Some((Kind::Aem, false))).then(|| path.to_owned())),
    holds: Holds::Flight { read, write: Some(write::aem) },
};

/// Either, or both, as XML.
pub(super) static NDM: Format = Format {
    name: "ndm",
    extensions: &["xml"],
    reads: "OEM and AEM as XML, alone or in an `<ndm>`",
    writes: "the same",
    mark: &[],
    told: Some(|path, beginning| matches!(message::told(beginning), Some((_, true))).then(|| path.to_owned())),
    holds: Holds::Flight { read, write: Some(write::ndm) },
};

/// Reads a message, as text or XML.
///
/// # Errors
/// [`Error::Io`]; as [`parse`].
pub fn read(path: &Path, leap: &LeapSeconds) -> Result<FlightFile> {
    let (text, input) = input::text(path, LIMIT)?;
    parse(&text, input, leap)
}

/// Reads the text of a message.
///
/// # Errors
/// [`Error::Invalid`] with the lines that cannot be used; [`Error::Syntax`] where XML is not well formed; [`Error::Unsupported`] for
/// messages of other kinds, versions and time scales, and for attitudes of a spinning object.
pub fn parse(text: &str, input: InputFile, leap: &LeapSeconds) -> Result<FlightFile> {
    let path = input.path.clone();
    let mut reading = Reading::new(&path, text, leap);
    let root;
    let messages = match message::told(text.as_bytes()) {
        Some((_, true)) => {
            root = xml::parse(text, &path)?;
            ndm::messages(&root, &mut reading)?
        }
        Some((kind @ (Kind::Oem | Kind::Aem), false)) => vec![kvn::message(text, kind, &mut reading)],
        Some((kind, false)) => return Err(kind.refused(Location::line(&path, 1))),
        None => {
            let problem = Problem::new(Location::file(&path), "is not a message of CCSDS");
            let help = "its first line is CCSDS_OEM_VERS = 2.0 or CCSDS_AEM_VERS = 2.0, or it is XML with <oem>, <aem> or <ndm>";
            return Err(Error::Invalid(vec![problem.with_help(help)]));
        }
    };
    assembly::file(&messages, reading, input)
}
