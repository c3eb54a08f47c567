//! Radiance that maps add to a slab.

/// Radiance of the pixels that maps reach, and of no others. Empty without maps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Added {
    /// How many of the pixels before each one are reached, and how many there are as the last element.
    pub start: Vec<usize>,
    /// [band, reached pixel], W m-2 sr-1 um-1.
    pub radiance: Vec<f64>,
}

impl Added {
    /// Zeros for the pixels that are reached.
    pub fn zeros(is_reached: impl Iterator<Item = bool>, bands: usize) -> Self {
        let (mut start, mut reached) = (vec![0], 0);
        start.extend(is_reached.map(|is_reached| {
            reached += usize::from(is_reached);
            reached
        }));
        if reached == 0 { Added::default() } else { Added { start, radiance: vec![0.0; reached * bands] } }
    }

    /// Whether it is of this many pixels and bands.
    pub(super) fn fits(&self, pixels: usize, bands: usize) -> bool {
        let Added { start, radiance } = self;
        if start.is_empty() {
            return radiance.is_empty();
        }
        Some(start.len()) == pixels.checked_add(1)
            && start[0] == 0
            && start.windows(2).all(|pair| pair[0] <= pair[1] && pair[1] - pair[0] <= 1)
            && self.reached().checked_mul(bands) == Some(radiance.len())
    }

    /// How many pixels are reached.
    pub fn reached(&self) -> usize {
        self.start.last().copied().unwrap_or(0)
    }

    /// Where a pixel is among those that are reached, if it is one.
    pub fn place(&self, pixel: usize) -> Option<usize> {
        let place = *self.start.get(pixel)?;
        (*self.start.get(pixel + 1)? > place).then_some(place)
    }
}
