//! Exact visible area: which part of which facet is seen in each cell.
//!
//! A cell that no open edge crosses holds the same number of layers everywhere (an edge that is not open only passes
//! from a facet to its continuation). If that number, counted at the cell's centre, is one, everything in the cell is seen;
//! nothing needs to be compared. Other cells are quartered until few facets remain, then [partitioned](super::partition).

use robust::{Coord, orient2d};

use super::bins::Bins;
use super::drawing::Drawing;
use super::partition::Partition;
use crate::geometry::polygon::{Point, Rect};

/// Receives what is seen in the parts of a cell.
pub trait Visit {
    /// All of the triangle that lies in `rect` is seen.
    fn whole(&mut self, triangle: u32, rect: &Rect);
    /// A convex piece of the triangle is seen, counter-clockwise (x right, y up); more pieces may follow.
    fn piece(&mut self, triangle: u32, rect: &Rect, polygon: &[Point]);
    /// Some or all of the triangle that lies in `rect` is hidden; the pieces that are seen follow.
    fn cut(&mut self, triangle: u32, rect: &Rect);
    /// The cell is not divided, and all of these are wholly seen in it.
    fn settled(&mut self, triangles: &[u32], rect: &Rect) {
        for t in triangles {
            self.whole(*t, rect);
        }
    }
}

/// A cell with more triangles than this is quartered, if quartering helps.
const FEW: usize = 12;
/// A cell is quartered so often at the most: 4^-25 of a cell is below the rounding of its area.
const DEEPEST: u32 = 25;

/// The drawing, sorted into cells: ready to be asked what is seen in each.
#[derive(Debug)]
pub struct Coverage<'a> {
    drawing: &'a Drawing<'a>,
    bins: Bins,
}

/// Working memory of a thread.
#[derive(Debug, Default)]
pub struct Scratch {
    list: Vec<u32>,
    stack: Vec<(Rect, u32, usize, usize)>,
    waiting: Vec<u32>,
    partition: Partition,
}

impl<'a> Coverage<'a> {
    /// Sorts a drawing's triangles into its cells.
    pub fn new(drawing: &'a Drawing<'a>) -> Self {
        Coverage { drawing, bins: Bins::new(drawing) }
    }

    /// The drawing.
    pub fn drawing(&self) -> &'a Drawing<'a> {
        self.drawing
    }

    /// Tells `visit` what is seen in a cell.
    pub fn cell(&self, column: u32, row: u32, scratch: &mut Scratch, visit: &mut impl Visit) {
        let cell = row as usize * self.drawing.grid.columns as usize + column as usize;
        let Scratch { list, stack, waiting, partition } = scratch;
        self.bins.cell(cell, list);
        let rect = self.drawing.grid.cell(column, row);
        if self.is_settled(&rect, list) {
            visit.settled(list, &rect);
            return;
        }
        // The stack holds rectangles with their triangles, a stretch of `waiting` each; the last one is the last stretch.
        waiting.clear();
        waiting.extend_from_slice(list);
        stack.clear();
        stack.push((rect, 0, 0, waiting.len()));
        while let Some((rect, depth, from, to)) = stack.pop() {
            list.clear();
            list.extend_from_slice(&waiting[from..to]);
            waiting.truncate(from);
            if list.is_empty() {
                continue;
            }
            if depth > 0 && self.is_settled(&rect, list) {
                for t in list.iter() {
                    visit.whole(*t, &rect);
                }
            } else if list.len() <= FEW || depth == DEEPEST {
                let few = if depth == DEEPEST { self.nearest(&rect, list) } else { list.as_slice() };
                partition.resolve(self.drawing, &rect, few, visit);
            } else {
                for quarter in rect.quarters() {
                    let from = waiting.len();
                    waiting.extend(list.iter().copied().filter(|&t| self.may_touch(t, &quarter)));
                    stack.push((quarter, depth + 1, from, waiting.len()));
                }
            }
        }
    }

    /// In a cell too small to matter: the triangle that is nearest at its centre stands for all.
    fn nearest<'l>(&self, rect: &Rect, list: &'l [u32]) -> &'l [u32] {
        let near = |t: u32| self.drawing.corners(t).iter().map(|p| p[2]).fold(f64::NEG_INFINITY, f64::max);
        let covers = (0..list.len()).filter(|&i| covers(self.drawing.outline(list[i]), rect.centre()));
        match covers.max_by(|&i, &j| near(list[i]).total_cmp(&near(list[j]))) {
            Some(i) => &list[i..=i],
            None => &list[..0],
        }
    }

    /// Whether the cell has exactly one layer everywhere, or none.
    fn is_settled(&self, rect: &Rect, list: &[u32]) -> bool {
        for &t in list {
            if self.drawing.has_open_edge(t) && self.open_edge_crosses(t, rect) {
                return false;
            }
        }
        let centre = rect.centre();
        let mut layers = 0;
        for &t in list {
            let outline = self.drawing.outline(t);
            if covers(outline, centre) {
                layers += 1;
                if layers > 1 {
                    return false;
                }
            }
        }
        // No layer although triangles are listed: they only touch the cell's border.
        layers == 1 || list.is_empty() || list.iter().all(|&t| !self.may_touch(t, rect))
    }

    fn open_edge_crosses(&self, triangle: u32, rect: &Rect) -> bool {
        let corners = self.drawing.corners(triangle).map(|p| [p[0], p[1]]);
        (0..3).any(|k| self.drawing.is_open(triangle, k) && may_cross(corners[k], corners[(k + 1) % 3], rect))
    }

    /// Whether a triangle may overlap a rectangle; errs on the side of yes.
    fn may_touch(&self, triangle: u32, rect: &Rect) -> bool {
        let outline = self.drawing.outline(triangle);
        if !Rect::of(&outline).overlaps(rect) {
            return false;
        }
        let corners = rect.corners();
        (0..3).all(|k| {
            let (a, b) = (outline[k], outline[(k + 1) % 3]);
            !corners.iter().all(|c| crate::geometry::polygon::side(a, b, *c) < 0.0)
        })
    }
}

/// Whether a segment may cross a rectangle; errs on the side of yes.
fn may_cross(a: Point, b: Point, rect: &Rect) -> bool {
    if !(Rect::of(&[a, b]).min[0] <= rect.max[0]
        && a[0].max(b[0]) >= rect.min[0]
        && a[1].min(b[1]) <= rect.max[1]
        && a[1].max(b[1]) >= rect.min[1])
    {
        return false;
    }
    let sides = rect.corners().map(|c| crate::geometry::polygon::side(a, b, c));
    !(sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0))
}

/// Whether a counter-clockwise triangle holds a point, in exact arithmetic. A point on a shared edge belongs to one side:
/// it is looked at as if moved by (e, e^2), e infinitesimal.
fn covers(outline: [Point; 3], p: Point) -> bool {
    let lowest = |k: usize| outline[0][k].min(outline[1][k]).min(outline[2][k]);
    let highest = |k: usize| outline[0][k].max(outline[1][k]).max(outline[2][k]);
    if p[0] < lowest(0) || p[0] > highest(0) || p[1] < lowest(1) || p[1] > highest(1) {
        return false;
    }
    let coord = |p: Point| Coord { x: p[0], y: p[1] };
    (0..3).all(|k| {
        let (a, b) = (outline[k], outline[(k + 1) % 3]);
        let turn = orient2d(coord(a), coord(b), coord(p));
        if turn != 0.0 {
            return turn > 0.0;
        }
        // d(turn) = -(b.y - a.y) e + (b.x - a.x) e^2
        if a[1] != b[1] { b[1] < a[1] } else { b[0] > a[0] }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_on_a_shared_edge_belongs_to_one_triangle() {
        let (a, b, c, d) = ([0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]);
        for p in [[0.5, 0.5], [0.25, 0.25], [0.5, 0.25]] {
            assert_eq!(u8::from(covers([a, b, c], p)) + u8::from(covers([a, c, d], p)), 1);
        }
        // Four triangles around a centre: the centre belongs to one of them.
        let m = [0.5, 0.5];
        let fan = [[a, b, m], [b, c, m], [c, d, m], [d, a, m]];
        assert_eq!(fan.iter().filter(|t| covers(**t, m)).count(), 1);
    }

    #[test]
    fn a_segment_beside_a_cell_does_not_cross_it() {
        let rect = Rect { min: [0.0, 0.0], max: [1.0, 1.0] };
        assert!(may_cross([-1.0, 0.5], [2.0, 0.6], &rect));
        assert!(!may_cross([-1.0, 1.5], [2.0, 1.1], &rect));
        assert!(!may_cross([0.9, -1.0], [3.0, 1.0], &rect));
    }
}
