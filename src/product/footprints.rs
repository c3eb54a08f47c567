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

    /// Adds the pixels of another after its own.
    pub fn append(&mut self, other: &Footprints) {
        let base = self.facet.len();
        // The end of the one is the beginning of the other.
        self.row_start.pop();
        self.row_start.extend(other.row_start.iter().map(|start| base + start));
        self.facet.extend_from_slice(&other.facet);
        self.fraction.extend_from_slice(&other.fraction);
        self.lit_fraction.extend_from_slice(&other.lit_fraction);
    }

    /// Those of images of so many lines, side by side.
    pub fn beside(parts: &[Footprints], lines: usize) -> Footprints {
        let mut all = Footprints { row_start: vec![0], ..Footprints::default() };
        for line in 0..lines {
            for part in parts {
                let samples = part.row_start.len().saturating_sub(1) / lines;
                for pixel in line * samples..(line + 1) * samples {
                    for (facet, fraction, lit_fraction) in part.pixel(pixel) {
                        all.facet.push(facet);
                        all.fraction.push(fraction);
                        all.lit_fraction.push(lit_fraction);
                    }
                    all.row_start.push(all.facet.len());
                }
            }
        }
        all
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
