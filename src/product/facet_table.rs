//! What reaches each facet, and how warm it is. Not radiance: that depends on who looks.

use crate::geometry::Direction;
use crate::visibility::Seen;

/// What the sources send to each facet, and its temperature.
///
/// Irradiances are geometric: relative to what they scale with, so that spectra are multiplied in afterwards.
#[derive(Debug, Clone, PartialEq)]
pub struct FacetTable {
    /// Towards the Sun, from the scene's origin.
    pub sun_direction: Direction,
    /// Irradiance by the Sun on the lit part of each facet over that on a plane normal to the beam: cos i, or 0 for a facet that faces away.
    pub sun_irradiance: Vec<f64>,
    /// Where each facet is lit.
    pub sunlit: Seen,
    /// Towards the centre of Mars from the scene's origin, if there is a Mars.
    pub mars_direction: Option<Direction>,
    /// Irradiance by Mars on each facet, over Mars' reflectance times the solar irradiance normal to the beam. Empty without Mars.
    pub mars_irradiance: Vec<f64>,
    /// Temperature of the lit part, K. Empty without thermal emission.
    pub temperature_lit_k: Vec<f64>,
    /// Temperature of the shaded part, K. Empty without thermal emission.
    pub temperature_shaded_k: Vec<f64>,
}
