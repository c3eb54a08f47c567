//! A tree of boxes over the facets of a mesh: what is near a box, or nearest to a point.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::{Mesh, index_u32};

/// Leaves hold at most this many facets.
const LEAF: usize = 8;

/// A box around facets: a leaf of some of them, or with two boxes within, the next one and that at `second`.
#[derive(Debug, Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Facets of a leaf, in the order of the tree.
    facets: (u32, u32),
    /// 0 for a leaf.
    second: u32,
}

/// The tree, of facets that have an area.
#[derive(Debug, Default)]
pub(super) struct BoxTree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl BoxTree {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let has_area = |facet: &u32| mesh.facet(*facet as usize).cross_m2() != DVec3::ZERO;
        let order: Vec<u32> = (0..index_u32(mesh.facets.len())).into_par_iter().filter(has_area).collect();
        let mut tree = BoxTree { nodes: Vec::new(), order };
        if !tree.order.is_empty() {
            tree.build(mesh, 0..tree.order.len());
        }
        tree
    }

    /// Its facets.
    pub(super) fn facets(&self) -> &[u32] {
        &self.order
    }

    /// Divides facets at the median of their middles, along the longest side of their box.
    fn build(&mut self, mesh: &Mesh, range: Range<usize>) {
        let part = &mut self.order[range.clone()];
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for facet in part.iter() {
            let (l, h) = bounds(mesh.facet(*facet as usize).corners_m);
            (low, high) = (low.min(l), high.max(h));
        }
        let at = self.nodes.len();
        self.nodes.push(Node { low, high, facets: (index_u32(range.start), index_u32(range.end)), second: 0 });
        if part.len() <= LEAF {
            return;
        }
        let axis = (high - low).max_position();
        let middle = part.len() / 2;
        let key = |facet: &u32| {
            let [a, b, c] = mesh.facet(*facet as usize).corners_m;
            a[axis] + b[axis] + c[axis]
        };
        part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        self.build(mesh, range.start..range.start + middle);
        self.nodes[at].second = index_u32(self.nodes.len());
        self.build(mesh, range.start + middle..range.end);
    }

    /// Calls `meet` with the facets of leaves whose boxes meet this one, until it says no.
    pub(super) fn near(&self, (low, high): (DVec3, DVec3), mut meet: impl FnMut(u32) -> bool) {
        let mut open = if self.nodes.is_empty() { vec![] } else { vec![0_u32] };
        while let Some(at) = open.pop() {
            let node = &self.nodes[at as usize];
            if node.low.cmpgt(high).any() || node.high.cmplt(low).any() {
                continue;
            }
            if node.second > 0 {
                open.extend([node.second, at + 1]);
            } else if !self.order[node.facets.0 as usize..node.facets.1 as usize].iter().all(|facet| meet(*facet)) {
                return;
            }
        }
    }

    /// The distance from a point to the nearest facet of its mesh, m; infinite if there is none.
    pub(super) fn distance_m(&self, mesh: &Mesh, point: DVec3) -> f64 {
        let to_box = |at: u32| {
            let node = &self.nodes[at as usize];
            point.distance(point.clamp(node.low, node.high))
        };
        let mut nearest = f64::INFINITY;
        let mut open = if self.nodes.is_empty() { vec![] } else { vec![(to_box(0), 0_u32)] };
        while let Some((far, at)) = open.pop() {
            if far >= nearest {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.second > 0 {
                let mut both = [(to_box(at + 1), at + 1), (to_box(node.second), node.second)];
                both.sort_by(|a, b| b.0.total_cmp(&a.0));
                open.extend(both);
                continue;
            }
            for facet in &self.order[node.facets.0 as usize..node.facets.1 as usize] {
                nearest = nearest.min(point.distance(nearest_of(mesh.facet(*facet as usize).corners_m, point)));
            }
        }
        nearest
    }
}

/// The box around a triangle.
pub(super) fn bounds([a, b, c]: [DVec3; 3]) -> (DVec3, DVec3) {
    (a.min(b).min(c), a.max(b).max(c))
}

/// The point of a triangle that is nearest to a point (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
fn nearest_of([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_point_is_a_corner_on_an_edge_or_within() {
        let mesh = Mesh {
            vertices_m: vec![DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0],
            facets: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let tree = BoxTree::new(&mesh);
        for (point, expected) in [
            ([1.0, 1.0, 3.0], 3.0),
            ([-3.0, -4.0, 0.0], 5.0),
            ([7.0, -4.0, 0.0], 5.0),
            ([2.0, -2.0, 0.0], 2.0),
            ([3.0, 3.0, 0.0], 2.0_f64.sqrt()),
            ([-2.0, 2.0, 0.0], 2.0),
            ([0.0, 7.0, 4.0], 5.0),
        ] {
            assert!((tree.distance_m(&mesh, DVec3::from_array(point)) - expected).abs() < 1e-15, "{point:?}");
        }
        assert_eq!(BoxTree::new(&Mesh::default()).distance_m(&mesh, DVec3::X), f64::INFINITY);
    }
}
