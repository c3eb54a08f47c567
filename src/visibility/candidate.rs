//! The triangles of a cell: first what shows which of them may be seen, then, of these, what shows where they are.

use super::drawing::Drawing;
use super::topology::NONE;
use crate::geometry::index_u32;
use crate::geometry::polygon::{Line, Point, Rect};

/// Forward error of a nearness, in units of eps x (magnitude of nearness + slope x magnitude of coordinates).
const DEPTH_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A triangle that touches a cell. This is enough to find that most lie behind others.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) triangle: u32,
    /// The facets that continue this one beyond its edges, and where they stand among the candidates; [`NONE`] without any.
    continuations: [u32; 3],
    pub(super) beside: [u32; 3],
    /// The sides of the outline that are open, bit k for the one that starts at corner k.
    pub(super) open: u8,
    /// Counter-clockwise.
    pub(super) outline: [Point; 3],
    pub(super) bounds: Rect,
    /// Greatest and least nearness of its corners.
    pub(super) nearest: f64,
    pub(super) farthest: f64,
}

impl Candidate {
    pub(super) fn new(drawing: &Drawing, triangle: u32) -> Self {
        let [a, b, c] = drawing.corners(triangle).map(|p| p[2]);
        let outline = drawing.outline(triangle);
        Candidate {
            triangle,
            continuations: drawing.continuations(triangle),
            beside: [NONE; 3],
            open: drawing.open_sides(triangle),
            outline,
            bounds: Rect::of(&outline),
            nearest: a.max(b).max(c),
            farthest: a.min(b).min(c),
        }
    }

    /// Finds the continuations of each candidate among all, which stand in the order of their triangles.
    pub(super) fn link(candidates: &mut [Candidate]) {
        for i in 0..candidates.len() {
            for k in 0..3 {
                let facet = candidates[i].continuations[k];
                // Each pair once: the later finds the earlier. A facet in one piece is a triangle of the same number.
                if facet < candidates[i].triangle
                    && let Ok(j) = candidates[..i].binary_search_by_key(&facet, |c| c.triangle)
                {
                    candidates[i].beside[k] = index_u32(j);
                    let triangle = candidates[i].triangle;
                    let other = &mut candidates[j];
                    if let Some(back) = other.continuations.iter().position(|f| *f == triangle) {
                        other.beside[back] = index_u32(i);
                    }
                }
            }
        }
    }

    /// Whether it may overlap a rectangle; errs on the side of yes.
    pub(super) fn may_touch(&self, rect: &Rect) -> bool {
        self.bounds.overlaps(rect) && touch(&sides(&self.outline), rect)
    }
}

/// A candidate that may be seen, with what its contests need: made once for a cell, however often the cell is quartered.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contender {
    pub(super) triangle: u32,
    pub(super) facet: u32,
    continuations: [u32; 3],
    /// Counter-clockwise.
    pub(super) outline: [Point; 3],
    /// Lines along the outline, the inside on the left.
    pub(super) sides: [Line; 3],
    pub(super) bounds: Rect,
    plane: Plane,
    /// Bound of the error of a nearness within the triangle.
    pub(super) error: f64,
}

impl Contender {
    pub(super) fn new(drawing: &Drawing, candidate: &Candidate) -> Self {
        let [magnitude_xy, magnitude_near] = drawing.magnitude();
        let Candidate { triangle, continuations, outline, bounds, .. } = *candidate;
        let corners = drawing.corners(triangle);
        let plane = Plane::through(corners);
        let Spread { b: [bx, by, bz], c: [cx, cy, cz], inverse } = Spread::of(corners);
        let size = bx.abs().max(cx.abs()).max(by.abs()).max(cy.abs());
        let products = (bz * cy).abs() + (cz * by).abs() + (bx * cz).abs() + (cx * bz).abs();
        let steep = plane.slope[0].abs() + plane.slope[1].abs();
        Contender {
            triangle,
            facet: drawing.facet(triangle),
            continuations,
            outline,
            sides: sides(&outline),
            bounds,
            plane,
            error: DEPTH_ROUNDING * (magnitude_near + steep * magnitude_xy + products * inverse.abs() * size),
        }
    }

    #[inline]
    pub(super) fn nearness(&self, p: Point) -> f64 {
        self.plane.nearness(p)
    }

    /// Whether two cannot overlap: one facet, or facets that share an edge and face the same way.
    pub(super) fn continues(&self, other: &Contender) -> bool {
        self.facet == other.facet || self.continuations.contains(&other.facet)
    }

    /// Whether it may overlap a rectangle; errs on the side of yes.
    pub(super) fn may_touch(&self, rect: &Rect) -> bool {
        self.bounds.overlaps(rect) && touch(&self.sides, rect)
    }
}

/// A triangle's second and third corner, seen from the first, and 1 / (twice its area in the drawing, with its sign).
struct Spread {
    b: [f64; 3],
    c: [f64; 3],
    inverse: f64,
}

impl Spread {
    #[inline]
    fn of([a, b, c]: [[f64; 3]; 3]) -> Self {
        let (b, c) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        Spread { b, c, inverse: 1.0 / (b[0] * c[1] - b[1] * c[0]) }
    }
}

/// How near a triangle is at each point of the drawing: anchor[2] + slope . (p - anchor).
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    anchor: [f64; 3],
    slope: [f64; 2],
}

impl Plane {
    #[inline]
    pub(super) fn through(corners: [[f64; 3]; 3]) -> Self {
        let Spread { b: [bx, by, bz], c: [cx, cy, cz], inverse } = Spread::of(corners);
        Plane { anchor: corners[0], slope: [(bz * cy - cz * by) * inverse, (bx * cz - cx * bz) * inverse] }
    }

    #[inline]
    pub(super) fn nearness(&self, p: Point) -> f64 {
        self.anchor[2] + self.slope[0] * (p[0] - self.anchor[0]) + self.slope[1] * (p[1] - self.anchor[1])
    }
}

fn sides(outline: &[Point; 3]) -> [Line; 3] {
    [0, 1, 2].map(|k| Line::through(outline[k], outline[if k == 2 { 0 } else { k + 1 }]))
}

fn touch(sides: &[Line; 3], rect: &Rect) -> bool {
    sides.iter().all(|side| !side.has_on_its_right(rect))
}
