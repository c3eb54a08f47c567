//! Files of flight dynamics, whatever their format: what they hold goes into an almanac.

use std::path::Path;

use crate::error::{Location, Problem, Result};
use crate::flight::Almanac;

/// Reads a file of trajectories, attitudes, rotations or leap seconds into an almanac; what it knows stands before what is there.
///
/// # Errors
/// Whatever is wrong with the file, or that its format is none of these.
pub fn furnish(path: &Path, _almanac: &mut Almanac) -> Result<()> {
    let message = "is not a file of flight dynamics that is known";
    Err(crate::error::Error::Invalid(vec![Problem::new(Location::file(path), message)]))
}
