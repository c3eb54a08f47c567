//! The lit part of what a pixel sees of a facet: sunlit polygons carried from the Sun's view into the image.

use super::parts::{Parts, Polygons, Window};
use crate::geometry::polygon::{Point, area};
use crate::product::{Lit, Sunlit};
use crate::visibility::Drawing;

/// Computes lit areas in the image.
pub(super) struct LitArea<'a> {
    sunlit: &'a Sunlit,
    parts: Parts<'a>,
}

impl<'a> LitArea<'a> {
    /// `polygons` are those of `sunlit`.
    pub(super) fn new(drawing: &'a Drawing<'a>, sunlit: &'a Sunlit, polygons: &'a Polygons<'a>) -> Self {
        LitArea { sunlit, parts: Parts::new(drawing, polygons) }
    }

    pub(super) fn new_line(&mut self, row: u32) {
        self.parts.new_line(row);
    }

    /// Lit area, pixels, of what `window` shows of a facet's image; `seen` is the area of all that it shows.
    pub(super) fn of(&mut self, facet: u32, window: &Window, seen: f64) -> f64 {
        match self.sunlit.lit[facet as usize] {
            Lit::Dark => 0.0,
            Lit::Full => seen,
            Lit::Part => {
                let mut lit = 0.0;
                self.parts.each(facet, window, |_, common| lit += area(common).max(0.0));
                lit.min(seen)
            }
        }
    }

    /// How much of a facet is lit.
    pub(super) fn state(&self, facet: u32) -> Lit {
        self.sunlit.lit[facet as usize]
    }

    /// Calls `put` with each lit part that `window` shows of a facet that is lit in part.
    pub(super) fn each(&mut self, facet: u32, window: &Window, mut put: impl FnMut(&[Point])) {
        self.parts.each(facet, window, |_, common| put(common));
    }

    /// Whether a facet is lit at an image point that sees it.
    pub(super) fn is_lit_at(&self, facet: u32, at: Point) -> bool {
        match self.sunlit.lit[facet as usize] {
            Lit::Dark => false,
            Lit::Full => true,
            Lit::Part => self.parts.hold(facet, at),
        }
    }
}
