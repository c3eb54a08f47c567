//! Where a ray first meets a mesh: a tree of boxes (surface area heuristic with bins; Wald 2007), double precision, both sides of facets.
//!
//! It answers single questions, as of `locate`, and serves the comparison with renderers: images are exact, and cast no rays.

use glam::DVec3;

use crate::geometry::{Mesh, index_u32, whole};

/// Leaves hold at most this many facets.
const LEAF: usize = 4;
/// Where a box may be divided along an axis.
const BINS: usize = 16;
/// A triple product of these lengths is rounded by less than this times their product: two differences, six products and five sums.
const SIDE_ROUNDING: f64 = 8.0 * f64::EPSILON;
/// More boxes are never open at once: a tree deeper than this ends in larger leaves.
const DEEPEST: usize = 60;

/// A tree of boxes over the facets of a mesh.
#[derive(Debug)]
pub struct RayTree {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
    /// What coordinates are rounded by, with room to spare, m: a ray from a facet does not meet its neighbours nearer than this.
    rounding_m: f64,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Of a leaf its first triangle, else the second child; the first one follows it.
    at: u32,
    /// Triangles of a leaf; 0: it has children.
    count: u16,
    axis: u16,
}

#[derive(Debug, Clone, Copy)]
struct Triangle {
    corners_m: [DVec3; 3],
    facet: u32,
}

/// How a tree orders the facets of its mesh, from which it follows.
#[derive(Debug)]
pub(crate) struct TreeOrder {
    /// Of each node what is at it, how many triangles, and its axis.
    pub(crate) nodes: Vec<[u32; 3]>,
    /// Facets, as leaves hold them.
    pub(crate) facets: Vec<u32>,
}

/// Where a ray meets a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The facet.
    pub facet: u32,
    /// Distance, in lengths of the ray's direction.
    pub t: f64,
    /// Whether it is the facet's outer side.
    pub front: bool,
}

/// What coordinates of a mesh are rounded by, with room to spare, m.
fn rounding_m(mesh: &Mesh) -> f64 {
    let (low_m, high_m) = mesh.bounds_m().unwrap_or_default();
    1e-13 * low_m.abs().max(high_m.abs()).max_element()
}

impl RayTree {
    /// Over all facets that have an area.
    pub fn new(mesh: &Mesh) -> Self {
        let rounding_m = rounding_m(mesh);
        let mut items: Vec<Item> = (0..mesh.facets.len())
            .filter_map(|f| {
                let [a, b, c] = mesh.facet(f).corners_m;
                let (low, high) = (a.min(b).min(c), a.max(b).max(c));
                let has_area = mesh.facet(f).cross_m2() != DVec3::ZERO;
                has_area.then_some(Item { low, high, middle: 0.5 * (low + high), facet: index_u32(f) })
            })
            .collect();
        let mut tree =
            RayTree { nodes: Vec::with_capacity(items.len()), triangles: Vec::with_capacity(items.len()), rounding_m };
        if !items.is_empty() {
            tree.build(mesh, &mut items, 0);
        }
        tree
    }

    fn build(&mut self, mesh: &Mesh, items: &mut [Item], depth: usize) {
        let (low, high) = bounds(items);
        let at = self.nodes.len();
        self.nodes.push(Node { low, high, at: index_u32(self.triangles.len()), count: 0, axis: 0 });
        let divided = if items.len() <= LEAF || depth >= DEEPEST { None } else { divide(items) };
        let Some((axis, middle)) = divided else {
            // A list that is longer than 65535 is of facets in one place: it is cut all the same.
            self.leaf(mesh, items, at, depth);
            return;
        };
        let (first, second) = items.split_at_mut(middle);
        self.build(mesh, first, depth + 1);
        self.nodes[at].at = index_u32(self.nodes.len());
        self.nodes[at].axis = axis;
        self.build(mesh, second, depth + 1);
    }

    fn leaf(&mut self, mesh: &Mesh, items: &mut [Item], at: usize, depth: usize) {
        if let Ok(count) = u16::try_from(items.len()) {
            self.nodes[at].count = count;
            self.triangles.extend(items.iter().map(|item| {
                let corners_m = mesh.facet(item.facet as usize).corners_m;
                Triangle { corners_m, facet: item.facet }
            }));
            return;
        }
        let (first, second) = items.split_at_mut(items.len() / 2);
        self.build(mesh, first, depth + 1);
        self.nodes[at].at = index_u32(self.nodes.len());
        self.build(mesh, second, depth + 1);
    }

    /// How it orders facets.
    pub(crate) fn order(&self) -> TreeOrder {
        let numbers = |node: &Node| [node.at, node.count.into(), node.axis.into()];
        TreeOrder {
            nodes: self.nodes.iter().map(numbers).collect(),
            facets: self.triangles.iter().map(|triangle| triangle.facet).collect(),
        }
    }

    /// The tree of an order; `None` if it is not that of a tree of this mesh.
    pub(crate) fn from_order(mesh: &Mesh, order: TreeOrder) -> Option<Self> {
        let rounding_m = rounding_m(mesh);
        let triangle = |facet: u32| {
            let is_of_mesh = (facet as usize) < mesh.facets.len();
            is_of_mesh.then(|| Triangle { corners_m: mesh.facet(facet as usize).corners_m, facet })
        };
        let triangles: Vec<Triangle> = order.facets.into_iter().map(triangle).collect::<Option<_>>()?;
        let blank = |[at, count, axis]: [u32; 3]| {
            let (count, axis) = (u16::try_from(count).ok()?, u16::try_from(axis).ok().filter(|axis| *axis < 3)?);
            Some((Node { low: DVec3::ZERO, high: DVec3::ZERO, at, count, axis }, 0))
        };
        // Children come behind their parents: from the end on, boxes and depths below are known.
        let mut nodes: Vec<(Node, usize)> = order.nodes.into_iter().map(blank).collect::<Option<_>>()?;
        for i in (0..nodes.len()).rev() {
            let (node, _) = nodes[i];
            let (low, high, depth) = if node.count > 0 {
                let first = node.at as usize;
                let held = triangles.get(first..first + usize::from(node.count))?;
                let corners = || held.iter().flat_map(|triangle| triangle.corners_m);
                (corners().reduce(DVec3::min)?, corners().reduce(DVec3::max)?, 0)
            } else {
                let second = node.at as usize;
                let ((one, above), (other, beside)) =
                    (nodes.get(i + 1)?, nodes.get(second).filter(|_| second > i + 1)?);
                (one.low.min(other.low), one.high.max(other.high), 1 + above.max(beside))
            };
            // So many boxes may be open at once.
            if depth >= 2 * DEEPEST {
                return None;
            }
            nodes[i] = (Node { low, high, ..node }, depth);
        }
        Some(RayTree { nodes: nodes.into_iter().map(|(node, _)| node).collect(), triangles, rounding_m })
    }

    /// The nearest facet that a ray meets.
    pub fn nearest(&self, from_m: DVec3, ray: DVec3) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        self.walk(from_m, ray, f64::INFINITY, |triangle, most| {
            let (t, front) = triangle.met_by(from_m, ray, most)?;
            nearest = Some(Hit { facet: triangle.facet, t, front });
            Some(t)
        });
        nearest
    }

    /// Whether a ray of unit length, to rounding, from a point of `facet` meets another facet.
    pub fn is_hidden(&self, facet: u32, from_m: DVec3, ray: DVec3) -> bool {
        let mut hidden = false;
        self.walk(from_m, ray, f64::INFINITY, |triangle, most| {
            if triangle.facet == facet {
                return None;
            }
            let (t, _) = triangle.met_by(from_m, ray, most)?;
            if t <= self.rounding_m {
                return None;
            }
            hidden = true;
            // Nothing is nearer than this: the walk ends.
            Some(f64::NEG_INFINITY)
        });
        hidden
    }

    /// Calls `meet` with each triangle whose box the ray meets nearer than `most`, near boxes first; it returns what `most` is from then on.
    #[inline]
    fn walk(&self, from_m: DVec3, ray: DVec3, mut most: f64, mut meet: impl FnMut(&Triangle, f64) -> Option<f64>) {
        if self.nodes.is_empty() {
            return;
        }
        let inverse = 1.0 / ray;
        let mut open = [0u32; 2 * DEEPEST];
        let mut count = 0;
        let mut at = 0usize;
        loop {
            let node = &self.nodes[at];
            if node.is_met(from_m, inverse, most) {
                if node.count == 0 {
                    let (near, far) = if ray[node.axis as usize] < 0.0 {
                        (node.at, index_u32(at) + 1)
                    } else {
                        (index_u32(at) + 1, node.at)
                    };
                    open[count] = far;
                    count += 1;
                    at = near as usize;
                    continue;
                }
                let first = node.at as usize;
                for triangle in &self.triangles[first..first + node.count as usize] {
                    if let Some(nearer) = meet(triangle, most) {
                        most = nearer;
                    }
                }
                if most == f64::NEG_INFINITY {
                    return;
                }
            }
            if count == 0 {
                return;
            }
            count -= 1;
            at = open[count] as usize;
        }
    }
}

impl Node {
    #[inline]
    fn is_met(&self, from: DVec3, inverse: DVec3, most: f64) -> bool {
        let (p, q) = ((self.low - from) * inverse, (self.high - from) * inverse);
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for (p, q) in p.to_array().into_iter().zip(q.to_array()) {
            // A ray in a box's wall has 0 times infinity there: it is inside all the way.
            if !(p.is_nan() || q.is_nan()) {
                (near, far) = (near.max(p.min(q)), far.min(p.max(q)));
            }
        }
        near <= far * (1.0 + 4.0 * f64::EPSILON) && near <= most
    }
}

impl Triangle {
    /// Where a ray meets it nearer than `most`, and whether from outside. Where it is not certain on which side of an edge a ray passes, it meets the facets on
    /// both: none slips through between them.
    #[inline]
    fn met_by(&self, from: DVec3, ray: DVec3, most: f64) -> Option<(f64, bool)> {
        let [a, b, c] = self.corners_m.map(|corner| corner - from);
        let side = |p: DVec3, q: DVec3| {
            let (step, sum) = (q - p, q + p);
            let volume = ray.dot(step.cross(sum));
            let rounding = SIDE_ROUNDING * SIDE_ROUNDING;
            let size2 = ray.length_squared() * step.length_squared() * sum.length_squared();
            if volume * volume <= rounding * size2 { 0.0 } else { volume }
        };
        let sides = [side(a, b), side(b, c), side(c, a)];
        if !(sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)) {
            return None;
        }
        let normal = (b - a).cross(c - a);
        let along = normal.dot(ray);
        let t = normal.dot(a) / along;
        (t > 0.0 && t < most).then_some((t, along < 0.0))
    }
}

#[derive(Debug, Clone, Copy)]
struct Item {
    low: DVec3,
    high: DVec3,
    middle: DVec3,
    facet: u32,
}

fn bounds(items: &[Item]) -> (DVec3, DVec3) {
    let all =
        |of: fn(&Item) -> DVec3, by: fn(DVec3, DVec3) -> DVec3| items.iter().map(of).reduce(by).unwrap_or_default();
    (all(|item| item.low, DVec3::min), all(|item| item.high, DVec3::max))
}

/// Sorts items into two groups, and returns the axis along which they are divided and the first item of the second group.
fn divide(items: &mut [Item]) -> Option<(u16, usize)> {
    let middles = |by: fn(DVec3, DVec3) -> DVec3| items.iter().map(|item| item.middle).reduce(by).unwrap_or_default();
    let (low, high) = (middles(DVec3::min), middles(DVec3::max));
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        let width = high[axis] - low[axis];
        if width.is_nan() || width <= 0.0 {
            continue;
        }
        let mut bins = [(f64::INFINITY * DVec3::ONE, f64::NEG_INFINITY * DVec3::ONE, 0usize); BINS];
        for item in items.iter() {
            let bin = &mut bins[bin_of(item.middle[axis], low[axis], width)];
            *bin = (bin.0.min(item.low), bin.1.max(item.high), bin.2 + 1);
        }
        // From the last bin on, the area of what lies behind each border, and the number of items there.
        let mut behind = [(0.0, 0usize); BINS];
        let mut sum = (f64::INFINITY * DVec3::ONE, f64::NEG_INFINITY * DVec3::ONE, 0);
        for i in (1..BINS).rev() {
            sum = (sum.0.min(bins[i].0), sum.1.max(bins[i].1), sum.2 + bins[i].2);
            behind[i] = (surface(sum.0, sum.1), sum.2);
        }
        let mut sum = (f64::INFINITY * DVec3::ONE, f64::NEG_INFINITY * DVec3::ONE, 0);
        for i in 1..BINS {
            sum = (sum.0.min(bins[i - 1].0), sum.1.max(bins[i - 1].1), sum.2 + bins[i - 1].2);
            if sum.2 == 0 || behind[i].1 == 0 {
                continue;
            }
            let cost = surface(sum.0, sum.1) * sum.2 as f64 + behind[i].0 * behind[i].1 as f64;
            if best.is_none_or(|(least, _, _)| cost < least) {
                best = Some((cost, axis, i));
            }
        }
    }
    let (_, axis, border) = best?;
    let width = high[axis] - low[axis];
    let mut first = 0;
    for i in 0..items.len() {
        if bin_of(items[i].middle[axis], low[axis], width) < border {
            items.swap(first, i);
            first += 1;
        }
    }
    Some((
        if axis == 0 {
            0
        } else if axis == 1 {
            1
        } else {
            2
        },
        first,
    ))
}

fn bin_of(x: f64, low: f64, width: f64) -> usize {
    whole((x - low) / width * BINS as f64).min(BINS - 1)
}

/// Half the surface of a box; 0 of none.
fn surface(low: DVec3, high: DVec3) -> f64 {
    let size = (high - low).max(DVec3::ZERO);
    size.x * size.y + size.y * size.z + size.z * size.x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n x n squares in z = 0 of two facets each, of this size, about a place.
    fn ground(n: usize, size_m: f64, place: DVec3) -> Mesh {
        let at = |k: usize| DVec3::new((k % (n + 1)) as f64, (k / (n + 1)) as f64, 0.0) * size_m + place;
        let corner = |k: usize| index_u32(k / n * (n + 1) + k % n);
        let side = index_u32(n + 1);
        let of_square = |k: usize| {
            let a = corner(k);
            [[a, a + 1, a + 1 + side], [a, a + 1 + side, a + side]]
        };
        Mesh {
            vertices_m: (0..(n + 1) * (n + 1)).map(at).collect(),
            facets: (0..n * n).flat_map(of_square).collect(),
            ..Mesh::default()
        }
    }

    #[test]
    fn a_ray_is_tried_on_few_facets_wherever_the_mesh_is() {
        // Coordinates and sums are exact: squares of 2^-10 m, at the origin, 2^30 m away, and there and here at once.
        let (n, size_m) = (32, 1.0 / 1024.0);
        let far = DVec3::new(1.0, -1.0, 1.0) * f64::from(1 << 30);
        let mut both = ground(n, size_m, DVec3::ZERO);
        both.append(ground(n, size_m, far));
        let cases = [
            (ground(n, size_m, DVec3::ZERO), DVec3::ZERO),
            (ground(n, size_m, far), far),
            (both.clone(), DVec3::ZERO),
            (both, far),
        ];
        for (mesh, place) in cases {
            let tree = RayTree::new(&mesh);
            for k in 0..n {
                // Into the lower right half of a square on the diagonal.
                let from = place + DVec3::new(k as f64 + 0.75, k as f64 + 0.25, 8.0) * size_m;
                let (mut tried, hit) = (0, tree.nearest(from, -DVec3::Z).unwrap());
                tree.walk(from, -DVec3::Z, f64::INFINITY, |_, _| {
                    tried += 1;
                    None
                });
                assert!(tried <= 4 * LEAF, "{tried} at {place}");
                let first = if place != DVec3::ZERO && mesh.facets.len() > 2 * n * n { 2 * n * n } else { 0 };
                assert_eq!((hit.facet as usize, hit.t, hit.front), (first + 2 * k * (n + 1), 8.0 * size_m, true));
            }
        }
    }
}
