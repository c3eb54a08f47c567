//! Light that reaches facets by way of others.

use crate::geometry::MaterialId;

/// Light of a source that surfaces have reflected before it reaches a facet.
///
/// Its spectrum is that of the source times the reflectance of each material of `by`, so that every surface on the way counts once.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reflected {
    /// The source, by its place among those of the table.
    pub source: usize,
    /// The materials that have reflected it, ascending; one that did so twice is there twice.
    pub by: Vec<MaterialId>,
    /// Irradiance, the mean over each facet, relative: as that by the source, for surfaces that reflect everything.
    pub irradiance: Vec<f64>,
}
