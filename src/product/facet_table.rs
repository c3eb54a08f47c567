//! What reaches each facet, and how warm it is. Not radiance: that depends on who looks.

use crate::geometry::Direction;

/// How much of a facet the Sun sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Lit {
    /// Nothing.
    Dark = 0,
    /// All of it: nothing was cut off anywhere.
    Full = 1,
    /// The polygons in [`Sunlit`].
    Part = 2,
}

/// The sunlit part of every facet, as convex polygons that do not overlap.
///
/// Polygon vertices are (u, v) on the facet: point = a + u (b - a) + v (c - a).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sunlit {
    /// How much of each facet is lit.
    pub lit: Vec<Lit>,
    /// The facet of each polygon, ascending.
    pub polygon_facet: Vec<u32>,
    /// First vertex of each polygon, and the number of vertices as the last element.
    pub polygon_start: Vec<u32>,
    /// Vertices of the polygons.
    pub uv: Vec<[f64; 2]>,
}

impl Sunlit {
    /// The polygons of a facet that is lit in part.
    pub fn polygons(&self, facet: u32) -> impl ExactSizeIterator<Item = &[[f64; 2]]> {
        let first = self.polygon_facet.partition_point(|f| *f < facet);
        let last = first + self.polygon_facet[first..].partition_point(|f| *f == facet);
        (first..last).map(|i| &self.uv[self.polygon_start[i] as usize..self.polygon_start[i + 1] as usize])
    }

    /// Share of a facet's area that is lit.
    pub fn fraction(&self, facet: u32) -> f64 {
        match self.lit[facet as usize] {
            Lit::Dark => 0.0,
            Lit::Full => 1.0,
            Lit::Part => self.polygons(facet).map(|p| 2.0 * crate::geometry::polygon::area(p).abs()).sum(),
        }
    }

    /// The first facet whose polygons fill more than `most` of its area, overlaps counted twice, and what they fill.
    pub fn overfull(&self, most: f64) -> Option<(u32, f64)> {
        // Polygons are in the order of their facets.
        let (mut facet, mut sum) = (None, 0.0);
        for (of, bounds) in self.polygon_facet.iter().zip(self.polygon_start.windows(2)) {
            if facet != Some(*of) {
                (facet, sum) = (Some(*of), 0.0);
            }
            sum += 2.0 * crate::geometry::polygon::area(&self.uv[bounds[0] as usize..bounds[1] as usize]).abs();
            if sum > most {
                return Some((*of, sum));
            }
        }
        None
    }

    /// Says what is inconsistent; `Ok` if nothing is.
    ///
    /// # Errors
    /// The first thing that does not hold, as a sentence.
    pub fn validate(&self) -> Result<(), String> {
        if self.polygon_start.len() != self.polygon_facet.len() + 1 {
            return Err(format!("{} polygons, but {} starts", self.polygon_facet.len(), self.polygon_start.len()));
        }
        if self.polygon_start.first() != Some(&0)
            || self.polygon_start.last().map(|e| *e as usize) != Some(self.uv.len())
            || self.polygon_start.windows(2).any(|w| w[0] > w[1])
        {
            return Err("polygon starts are not an ascending list from 0 to the number of vertices".into());
        }
        if self.polygon_facet.windows(2).any(|w| w[0] > w[1]) {
            return Err("polygons are not in the order of their facets".into());
        }
        match self.polygon_facet.iter().find(|f| self.lit.get(**f as usize) != Some(&Lit::Part)) {
            Some(f) => Err(format!("facet {f} has polygons, but is not lit in part")),
            None => Ok(()),
        }
    }
}

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
    pub sunlit: Sunlit,
    /// Towards the centre of Mars from the scene's origin, if there is a Mars.
    pub mars_direction: Option<Direction>,
    /// Irradiance by Mars on each facet, over Mars' reflectance times the solar irradiance normal to the beam. Empty without Mars.
    pub mars_irradiance: Vec<f64>,
    /// Temperature of the lit part, K. Empty without thermal emission.
    pub temperature_lit_k: Vec<f64>,
    /// Temperature of the shaded part, K. Empty without thermal emission.
    pub temperature_shaded_k: Vec<f64>,
}
