//! Which facets each pixel sees, and how much of them.

/// The facets that each pixel sees: a sparse matrix [pixel, facet] of area fractions of the pixel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Footprints {
    /// First entry of each pixel, and the number of entries as the last element.
    pub row_start: Vec<usize>,
    /// The facet of each entry; ascending within a pixel.
    pub facet: Vec<u32>,
    /// Share of the pixel's area that sees the facet.
    pub fraction: Vec<f64>,
    /// Share of the pixel's area that sees the facet's lit part.
    pub lit_fraction: Vec<f64>,
}

impl Footprints {
    /// The entries of a pixel: (facet, fraction, lit fraction).
    pub fn pixel(&self, pixel: usize) -> impl Iterator<Item = (u32, f64, f64)> {
        let range = self.row_start[pixel]..self.row_start[pixel + 1];
        range.map(|i| (self.facet[i], self.fraction[i], self.lit_fraction[i]))
    }

    /// Share of the pixel's area that sees any facet.
    pub fn coverage(&self, pixel: usize) -> f64 {
        self.pixel(pixel).map(|(_, fraction, _)| fraction).sum()
    }

    /// Says what is inconsistent; `Ok` if nothing is.
    ///
    /// # Errors
    /// The first thing that does not hold, as a sentence.
    pub fn validate(&self) -> Result<(), String> {
        for pixel in 0..self.row_start.len().saturating_sub(1) {
            let mut previous = None;
            for (facet, fraction, lit) in self.pixel(pixel) {
                if previous.is_some_and(|p| p >= facet) {
                    return Err(format!("pixel {pixel}: facets are not ascending"));
                }
                previous = Some(facet);
                if !(fraction >= 0.0 && lit >= 0.0 && lit <= fraction * (1.0 + 1e-9) + 1e-12) {
                    return Err(format!("pixel {pixel}, facet {facet}: fraction {fraction}, lit {lit}"));
                }
            }
            let coverage = self.coverage(pixel);
            if coverage > 1.0 + 1e-12 {
                return Err(format!("pixel {pixel}: coverage {coverage}"));
            }
        }
        Ok(())
    }
}
