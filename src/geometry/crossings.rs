//! Where a mesh crosses itself: facets that pass through one another, or lie on one another in one plane.
//!
//! Decided by the signs of exact determinants (Shewchuk 1997), without a tolerance. What only touches does not cross: a box on its ground,
//! a corner on its neighbour's edge.

use glam::DVec3;
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::Mesh;
use super::box_tree::{BoxTree, bounds};

/// So many pairs of boxes are looked at in all, at most: where facets lie on one another in heaps, their number would be the square.
const MOST_PAIRS: usize = 1 << 30;

/// Pairs of facets that cross.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Crossings {
    /// Their number.
    pub pairs: usize,
    /// Whether there are more: some facets meet the boxes of too many others.
    pub at_least: bool,
}

impl Crossings {
    /// Counts them. Facets of the same three vertices, and those without an area, are no pair.
    pub fn of(mesh: &Mesh) -> Self {
        let tree = BoxTree::new(mesh);
        let most = MOST_PAIRS / tree.facets().len().max(1);
        let of_one = |facet: &u32| {
            let (mut found, mut looked) = (Crossings::default(), 0);
            let own = corners(mesh, *facet);
            tree.near(bounds(own), |other| {
                // Each pair once.
                if other > *facet {
                    looked += 1;
                    found.pairs += usize::from(cross(own, corners(mesh, other)));
                    found.at_least = looked > most;
                }
                !found.at_least
            });
            found
        };
        let both =
            |a: Crossings, b: Crossings| Crossings { pairs: a.pairs + b.pairs, at_least: a.at_least || b.at_least };
        tree.facets().par_iter().map(of_one).reduce(Crossings::default, both)
    }
}

fn corners(mesh: &Mesh, facet: u32) -> [DVec3; 3] {
    mesh.facet(facet as usize).corners_m
}

/// Whether two triangles share more than where they touch.
fn cross(a: [DVec3; 3], b: [DVec3; 3]) -> bool {
    let (low_a, high_a) = bounds(a);
    let (low_b, high_b) = bounds(b);
    if low_a.cmpgt(high_b).any() || low_b.cmpgt(high_a).any() {
        return false;
    }
    let of_a = a.map(|corner| side(b, corner));
    let is_apart = |sides: [f64; 3]| sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0);
    if is_apart(of_a) {
        return false;
    }
    if of_a == [0.0; 3] {
        return overlap(a, b) && !a.iter().all(|corner| b.contains(corner));
    }
    let of_b = b.map(|corner| side(a, corner));
    !is_apart(of_b) && (is_pierced(a, b, of_b) || is_pierced(b, a, of_a))
}

/// On which side of a triangle's plane a point is: the sign; exactly 0 in it.
fn side(triangle: [DVec3; 3], point: DVec3) -> f64 {
    // Neighbours share corners: for them nothing is computed.
    if triangle.contains(&point) {
        return 0.0;
    }
    let [a, b, c, p] = [triangle[0], triangle[1], triangle[2], point].map(|v| Coord3D { x: v.x, y: v.y, z: v.z });
    orient3d(a, b, c, p)
}

/// Whether an edge of the other triangle, whose corners are on these sides, passes through this one.
fn is_pierced(triangle: [DVec3; 3], other: [DVec3; 3], sides: [f64; 3]) -> bool {
    (0..3).any(|i| {
        let j = (i + 1) % 3;
        if sides[i] * sides[j] >= 0.0 {
            return false;
        }
        // Past which sides of the triangle the edge goes.
        let past = [0, 1, 2].map(|k| side([other[i], other[j], triangle[k]], triangle[(k + 1) % 3]));
        let touches = past.iter().filter(|s| **s == 0.0).count();
        // Through its inside, or through one of its edges; not through a corner, which only touches.
        touches < 2 && (past.iter().all(|s| *s >= 0.0) || past.iter().all(|s| *s <= 0.0))
    })
}

/// Whether two triangles in one plane share an area: no edge of either has all of the other on its outer side.
fn overlap(a: [DVec3; 3], b: [DVec3; 3]) -> bool {
    // Seen along the axis that is most across the plane.
    let across = (a[1] - a[0]).cross(a[2] - a[0]).abs().max_position();
    let flat = |v: DVec3| Coord { x: v[(across + 1) % 3], y: v[(across + 2) % 3] };
    let turned = |t: [DVec3; 3]| {
        let [p, q, r] = t.map(flat);
        if orient2d(p, q, r) < 0.0 { [p, r, q] } else { [p, q, r] }
    };
    let (a, b) = (turned(a), turned(b));
    let is_beside = |a: &[Coord<f64>; 3], b: &[Coord<f64>; 3]| {
        (0..3).any(|i| b.iter().all(|corner| orient2d(a[i], a[(i + 1) % 3], *corner) <= 0.0))
    };
    !is_beside(&a, &b) && !is_beside(&b, &a)
}

#[cfg(test)]
mod tests {
    use glam::Vec3Swizzles as _;

    use super::*;
    use crate::geometry::index_u32;

    fn triangle(corners: [[f64; 3]; 3]) -> [DVec3; 3] {
        corners.map(DVec3::from_array)
    }

    /// In z = 0.
    const FLAT: [[f64; 3]; 3] = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn what_passes_through_crosses_and_what_touches_does_not() {
        for (other, expected, what) in [
            ([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]], true, "an edge through the inside"),
            ([[2.0, 2.0, -1.0], [2.0, 2.0, 1.0], [9.0, 9.0, 1.0]], true, "an edge through an edge"),
            ([[2.5, 2.5, -1.0], [2.5, 2.5, 1.0], [9.0, 9.0, 1.0]], false, "an edge past it"),
            ([[-1.0, 1.0, -1.0], [-1.0, 1.0, 1.0], [9.0, 1.0, 0.5]], true, "a large one around its edges"),
            ([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]], false, "a corner on it"),
            ([[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 1.0]], false, "an edge on it"),
            ([[0.0; 3], [4.0, 0.0, 0.0], [1.0, 1.0, 1.0]], false, "a neighbour"),
            ([[0.0; 3], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]], true, "a corner shared, an edge through it"),
            ([[0.0; 3], [-1.0, 1.0, 1.0], [-1.0, 1.0, -1.0]], false, "a corner shared, beside it"),
            ([[4.0, 4.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], false, "a neighbour in its plane"),
            ([[1.0, 1.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], true, "folded onto it"),
            ([[1.0, 1.0, 0.0], [9.0, 1.0, 0.0], [1.0, 9.0, 0.0]], true, "on it in its plane"),
            ([[4.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 9.0, 0.0]], false, "beside it in its plane"),
            ([[0.0, 4.0, 0.0], [0.0; 3], [4.0, 0.0, 0.0]], false, "itself"),
        ] {
            // In any order and direction, and elsewhere: all coordinates stay exact.
            for turn in 0..6 {
                let (a, b) = (triangle(FLAT), triangle(other));
                let turned = |t: [DVec3; 3]| if turn < 3 { t } else { [t[0], t[2], t[1]] };
                let b = turned([b[turn % 3], b[(turn + 1) % 3], b[(turn + 2) % 3]]).map(|v| v.zxy() * 0.25 + 1024.0);
                let a = a.map(|v| v.zxy() * 0.25 + 1024.0);
                assert_eq!((cross(a, b), cross(b, a)), (expected, expected), "{what}, {turn}");
            }
        }
    }

    #[test]
    fn each_pair_is_counted_once_however_many_there_are() {
        // Needles of one row through sheets of another: 40 x 30 pairs.
        let mut mesh = Mesh::default();
        let mut add = |corners: [[f64; 3]; 3]| {
            let first = index_u32(mesh.vertices_m.len());
            mesh.vertices_m.extend(corners.map(DVec3::from_array));
            mesh.facets.push([first, first + 1, first + 2]);
        };
        for i in 0..40 {
            let x = f64::from(i);
            add([[x, 0.25, -1.0], [x + 0.25, 0.25, -1.0], [x, 0.25, 99.0]]);
        }
        for k in 0..30 {
            let z = f64::from(k);
            add([[-1.0, -1.0, z], [200.0, -1.0, z], [-1.0, 200.0, z]]);
        }
        assert_eq!(Crossings::of(&mesh), Crossings { pairs: 1200, at_least: false });
        assert_eq!(Crossings::of(&Mesh::default()), Crossings::default());
    }
}
