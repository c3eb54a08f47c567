//! What an image sees at all, and whether its areas add up.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use super::pixel::Pixel;

/// For each facet whether some pixel sees it.
pub(super) struct Census {
    seen: Vec<AtomicBool>,
}

/// What a line of the image says of that.
#[derive(Default)]
pub(super) struct CensusLine {
    /// Area that shows the inner side of a facet, pixels.
    pub(super) back_area_px: f64,
    /// Largest amount by which the areas in a pixel exceed the pixel, pixels.
    pub(super) excess_px: f64,
}

impl Census {
    pub(super) fn new(facets: usize) -> Self {
        let mut seen = Vec::with_capacity(facets);
        seen.resize_with(facets, || AtomicBool::new(false));
        Census { seen }
    }

    /// Notes what a pixel sees.
    pub(super) fn gather(&self, pixel: &Pixel, line: &mut CensusLine) {
        let mut area = 0.0;
        for e in &pixel.entries {
            area += e.shown.area;
            self.seen[e.facet as usize].store(true, Relaxed);
            if !e.front {
                line.back_area_px += e.shown.area;
            }
        }
        line.excess_px = line.excess_px.max(area - 1.0);
    }

    pub(super) fn into_seen(self) -> Vec<bool> {
        self.seen.into_iter().map(AtomicBool::into_inner).collect()
    }
}
