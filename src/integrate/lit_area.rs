//! The part of what a pixel sees of a facet that a source lights: polygons carried from the source's view into the image. Where only
//! some of a wide source lights it, an area counts by the share of the light that it has.

use super::parts::{Parts, Polygons, Window};
use crate::geometry::polygon::{Point, Rect, area, area_and_moment, clip_to_rect};
use crate::solve::ImagePart;
use crate::visibility::Drawing;
use crate::visibility::{Seen, Shown};

/// Computes lit areas in the image.
pub(super) struct LitArea<'a> {
    drawing: &'a Drawing<'a>,
    sunlit: &'a Seen,
    polygons: &'a Polygons<'a>,
    parts: Parts<'a>,
    clipped: Vec<Point>,
    spare: Vec<Point>,
}

impl<'a> LitArea<'a> {
    /// `polygons` are those of `sunlit`.
    pub(super) fn new(drawing: &'a Drawing<'a>, sunlit: &'a Seen, polygons: &'a Polygons<'a>) -> Self {
        LitArea { drawing, sunlit, polygons, parts: Parts::new(drawing, polygons), clipped: vec![], spare: vec![] }
    }

    pub(super) fn new_line(&mut self, rows: [u32; 2]) {
        self.parts.new_line(rows);
    }

    /// Lit area, pixels, of what `window` shows of a facet's image; `seen` is the area of all that it shows.
    #[inline]
    pub(super) fn of(&mut self, facet: u32, window: &Window, seen: f64) -> f64 {
        match self.sunlit.shown[facet as usize] {
            Shown::Nothing => 0.0,
            Shown::Whole => seen,
            Shown::Part => self.of_part(facet, window).min(seen),
        }
    }

    /// The same with its moment; `seen` is all that the window shows.
    pub(super) fn part(&mut self, facet: u32, window: &Window, seen: ImagePart) -> ImagePart {
        match self.sunlit.shown[facet as usize] {
            Shown::Nothing => ImagePart::default(),
            Shown::Whole => seen,
            Shown::Part => {
                let mut lit = ImagePart::default();
                let polygons = self.polygons;
                self.parts.each(facet, window, |i, common| {
                    let (area, moment) = area_and_moment(common);
                    let share = polygons.share(i);
                    lit.add(&ImagePart { area: share * area.max(0.0), moment: moment.map(|m| share * m) });
                });
                ImagePart { area: lit.area.min(seen.area), ..lit }
            }
        }
    }

    fn of_part(&mut self, facet: u32, window: &Window) -> f64 {
        let (mut lit, polygons) = (0.0, self.polygons);
        self.parts.each(facet, window, |i, common| lit += polygons.share(i) * area(common).max(0.0));
        lit
    }

    /// How much of a facet is lit.
    pub(super) fn state(&self, facet: u32) -> Shown {
        self.sunlit.shown[facet as usize]
    }

    /// Calls `put` with each lit part that `window` shows of a facet that is lit in part, and the share of the light that it has.
    pub(super) fn each(&mut self, facet: u32, window: &Window, mut put: impl FnMut(f64, &[Point])) {
        let polygons = self.polygons;
        self.parts.each(facet, window, |i, common| put(polygons.share(i), common));
    }

    /// Area of what is drawn of a facet in the neighbourhood of an image point, hidden or not, and the lit part of it.
    pub(super) fn around(&mut self, facet: u32, at: Point) -> (f64, f64) {
        let rect = around(at);
        let (mut drawn, mut lit) = (0.0, 0.0);
        for triangle in self.drawing.triangles(facet) {
            clip_to_rect(&self.drawing.outline(triangle), &rect, &mut self.clipped, &mut self.spare);
            drawn += area(&self.clipped);
        }
        let window = Window::Rect { rect: &rect, outline: &rect.corners() };
        let polygons = self.polygons;
        self.parts.each(facet, &window, |i, common| lit += polygons.share(i) * area(common));
        (drawn, lit)
    }
}

/// Half the side of a point's neighbourhood, pixels: the geometric mean of a pixel and the rounding of its coordinates.
const NEIGHBOURHOOD: f64 = 1.0 / (1u64 << 26) as f64;

/// The neighbourhood of an image point.
pub(super) fn around(at: Point) -> Rect {
    Rect { min: at.map(|x| x - NEIGHBOURHOOD), max: at.map(|x| x + NEIGHBOURHOOD) }
}
