//! How what is seen of a cell is reported to the caller.

use crate::geometry::polygon::{Point, Rect};

/// Receives what is seen in the parts of a cell.
pub trait Visit {
    /// All of the triangle that lies in `rect` is seen.
    fn whole(&mut self, triangle: u32, rect: &Rect);
    /// A convex piece of the triangle is seen, counter-clockwise (x right, y up); more pieces may follow.
    fn piece(&mut self, triangle: u32, rect: &Rect, polygon: &[Point]);
    /// Of a triangle that was `whole`, this convex piece is hidden nevertheless; such pieces do not overlap.
    /// Only a visitor that is [`SIGNED`](Visit::SIGNED) is told so, and only of the triangle that was whole last.
    fn hidden(&mut self, _triangle: u32, _rect: &Rect, _polygon: &[Point]) {}
    /// Whether pieces may be added first and subtracted later: sums can, lists of polygons cannot.
    const SIGNED: bool = false;
    /// Some or all of the triangle that lies in `rect` is hidden; the pieces that are seen follow.
    fn cut(&mut self, triangle: u32, rect: &Rect);
    /// The cell is not divided, and all of these are wholly seen in it.
    fn settled(&mut self, triangles: &[u32], rect: &Rect) {
        for t in triangles {
            self.whole(*t, rect);
        }
    }
}
