//! Between the points of a drawing and the points of a facet.

use glam::DVec3;

use super::drawing::{View, project};
use crate::geometry::Facet;
use crate::geometry::polygon::Point;

/// A facet with corners a, b, c in a view: (u, v) is the point a + u (b - a) + v (c - a).
#[derive(Debug, Clone, Copy)]
pub enum OnFacet {
    /// In a parallel view, which is affine: corner a and the edges to b and c, in the drawing.
    Parallel {
        /// Corner a.
        a: Point,
        /// From a to b.
        to_b: Point,
        /// From a to c.
        to_c: Point,
    },
    /// In a central view: corner a and the edges, (x, y) in cells per tangent times depth, and depth, m.
    Pinhole {
        /// Corner a.
        a: DVec3,
        /// From a to b.
        to_b: DVec3,
        /// From a to c.
        to_c: DVec3,
        /// Where x and y are 0 in the drawing.
        centre: Point,
    },
}

impl OnFacet {
    /// A facet in a view.
    pub fn new(view: &View, facet: &Facet) -> Self {
        match view {
            View::Parallel { .. } => {
                let [a, b, c] = facet.corners_m.map(|p| project(view, p)).map(|p| [p[0], p[1]]);
                OnFacet::Parallel { a, to_b: [b[0] - a[0], b[1] - a[1]], to_c: [c[0] - a[0], c[1] - a[1]] }
            }
            View::Pinhole { from_m, depth_m, h, v, u, scale, offset, .. } => {
                let [a, b, c] = facet.corners_m.map(|p| {
                    let p = p - *from_m;
                    DVec3::new(p.dot(*h) * scale[0], p.dot(*v) * scale[1], p.dot(*u))
                });
                OnFacet::Pinhole { a: a + *depth_m * DVec3::Z, to_b: b - a, to_c: c - a, centre: *offset }
            }
        }
    }

    /// Where the point (u, v) is drawn.
    #[inline]
    pub fn drawn(&self, [u, v]: Point) -> Point {
        match self {
            OnFacet::Parallel { a, to_b, to_c } => [0, 1].map(|k| a[k] + u * to_b[k] + v * to_c[k]),
            OnFacet::Pinhole { a, to_b, to_c, centre } => {
                let p = *a + u * *to_b + v * *to_c;
                [p.x / p.z + centre[0], p.y / p.z + centre[1]]
            }
        }
    }

    /// The point (u, v) of the facet's plane that is drawn at a point.
    #[inline]
    pub fn uv(&self, [x, y]: Point) -> Point {
        match self {
            OnFacet::Parallel { a, to_b, to_c } => {
                let det = to_b[0] * to_c[1] - to_b[1] * to_c[0];
                let (x, y) = (x - a[0], y - a[1]);
                [(x * to_c[1] - y * to_c[0]) / det, (to_b[0] * y - to_b[1] * x) / det]
            }
            OnFacet::Pinhole { a, to_b, to_c, centre } => {
                let ray = DVec3::new(x - centre[0], y - centre[1], 1.0);
                let p = ray.cross(*to_c);
                let q = -a.cross(*to_b);
                let det = p.dot(*to_b);
                [-p.dot(*a) / det, ray.dot(q) / det]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawn_points_and_points_of_the_facet_are_inverse() {
        let facet =
            Facet { corners_m: [DVec3::new(-3.0, 1.0, 20.0), DVec3::new(5.0, 2.0, 30.0), DVec3::new(0.5, -4.0, 25.0)] };
        let (h, v, u) = (DVec3::X, DVec3::Y, DVec3::Z);
        let pinhole = View::pinhole(None, DVec3::ZERO, [h, v, u], [10.0; 2], [4.0, 3.0]);
        let parallel = View::Parallel { h, v, u, scale: [2.0, 0.5], offset: [7.0, 1.0] };
        // Corner a: x = -3/20 * 10 + 4, y = 1/20 * 10 + 3; in parallel -6 + 7, 0.5 + 1.
        for (view, expected) in [(pinhole, [2.5, 3.5]), (parallel, [1.0, 1.5])] {
            let on_facet = OnFacet::new(&view, &facet);
            let corner = on_facet.drawn([0.0, 0.0]);
            assert!((corner[0] - expected[0]).abs() < 1e-14 && (corner[1] - expected[1]).abs() < 1e-14);
            for uv in [[0.0, 0.0], [0.25, 0.5], [1.0, 0.0], [-1.0, 0.3]] {
                let back = on_facet.uv(on_facet.drawn(uv));
                assert!((back[0] - uv[0]).abs() < 1e-13 && (back[1] - uv[1]).abs() < 1e-13, "{uv:?} {back:?}");
            }
        }
    }
}
