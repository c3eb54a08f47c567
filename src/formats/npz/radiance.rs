//! What facets send towards an observer, [facet, band]: written here, and read back as any [radiance of facets](crate::formats::radiance_map).

use std::ops::Range;
use std::path::Path;

use super::FacetsSeen;
use super::write::{About, Column, Values, write};
use crate::error::Result;
use crate::scene::Models;
use crate::spectral::Band;

/// What the header says it is, and its version.
pub(in crate::formats) const FACET_RADIANCE: (&str, u32) = ("mmxrt facet radiance", 1);
/// Name of the array.
pub(in crate::formats) const RADIANCE: &str = "radiance_w_m2_sr_um";

/// Radiance of facets towards an observer, made a part at a time.
pub struct RadianceOfFacets<'a> {
    /// The observer, in words.
    pub observer: String,
    /// Which facets, and towards whom.
    pub seen: FacetsSeen,
    /// By which models they were solved.
    pub models: Models,
    /// The bands.
    pub bands: &'a [Band],
    /// Cosine of emission of each facet.
    pub cos_emission: &'a [f64],
    /// Share of each facet that the Sun sees.
    pub sunlit: &'a [f64],
    /// Radiance of a range of facets, [facet, band], W m-2 sr-1 um-1.
    pub radiance: &'a dyn Fn(Range<usize>) -> Vec<f64>,
}

/// Writes radiance of facets; `scene` says which scene it belongs to.
///
/// # Errors
/// [`Error::Io`](crate::Error::Io) if the file cannot be written.
pub fn write_facet_radiance(path: &Path, of: &RadianceOfFacets<'_>, scene: &str) -> Result<()> {
    let RadianceOfFacets { observer, seen, models, bands, cos_emission, sunlit, radiance } = of;
    let wavelength_um: Vec<f64> = bands.iter().map(|band| band.centre_um).collect();
    let fwhm_um: Vec<f64> = bands.iter().map(|band| band.fwhm_um.unwrap_or(0.0)).collect();
    let of_facets = format!(
        "radiance of each facet towards {observer}, mean over all of it, and over each band: parts in sunlight and in shadow count by their areas; \
         angles are those at its centroid; NaN if its outer side does not face there, whatever stands between"
    );
    let shape = [cos_emission.len(), bands.len()];
    let columns = [
        Column::new(RADIANCE, "W m-2 sr-1 um-1", of_facets, Values::Lines(shape, radiance)),
        Column::new("wavelength_um", "um", "centre of each band", Values::F64(&wavelength_um)),
        Column::new(
            "fwhm_um",
            "um",
            "full width of each band at half of its peak; 0: monochromatic",
            Values::F64(&fwhm_um),
        ),
        Column::new(
            "sun_share",
            "1",
            "share of each facet that the Sun sees, penumbrae by the share of the Sun",
            Values::F64(sunlit),
        ),
        Column::new(
            "cos_emission",
            "1",
            "cosine of the angle between each facet's normal and that direction",
            Values::F64(cos_emission),
        ),
    ];
    write(
        path,
        FACET_RADIANCE,
        scene,
        About { models: Some(*models), seen: Some(seen.clone()), ..About::default() },
        &columns,
    )
}
