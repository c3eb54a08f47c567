//! What reaches each facet: a scene becomes a facet table.

use crate::error::{Error, Location, Result};
use crate::product::FacetTable;
use crate::progress::Watch;
use crate::scene::Scene;

/// Irradiance, sunlit polygons and temperature of every facet.
///
/// # Errors
/// [`Error::Interrupted`] if `watch` asks to stop.
pub fn solve(_scene: &Scene, _watch: Watch<'_>) -> Result<FacetTable> {
    Err(Error::Unsupported { at: Location::default(), feature: "solving".into() })
}
