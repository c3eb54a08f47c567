//! Fewer facets: edges become vertices, those first that change the shape least.
//!
//! Source: Garland and Heckbert 1997, "Surface simplification using quadric error metrics"; the link condition of Dey et al. 1999 keeps a closed
//! surface closed. How far the surfaces are apart is then measured, between the corners and the middles of facets of each and the other.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::keep;
use crate::geometry::box_tree::BoxTree;
use crate::geometry::{Mesh, index_u32};

/// An edge of one facet, or between materials, counts as a wall across it, so many times its length squared.
const BORDER: f64 = 100.0;
/// A facet may not turn further than this when a corner of it moves: cosine.
const TURN: f64 = 0.2;
/// Of a quadric whose determinant is a smaller share of the cube of its trace no place is best.
const SINGULAR: f64 = 1e-9;
/// A sum of squares is known to this share of what it is the difference of: some ten products and sums of f64.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Edges of a vertex of more facets than this go last: work on a vertex grows with its facets.
const CROWDED: usize = 24;

/// What decimation did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Decimated {
    /// Facets that are left.
    pub facets: usize,
    /// The farthest that a corner or the middle of a facet of one surface is from the other, both ways, m.
    pub farthest_m: f64,
}

/// The sum of squared distances from planes, times their areas: x A x + 2 b x + c.
#[derive(Debug, Clone, Copy)]
struct Quadric {
    a: DMat3,
    b: DVec3,
    c: f64,
}

impl Quadric {
    const ZERO: Quadric = Quadric { a: DMat3::ZERO, b: DVec3::ZERO, c: 0.0 };

    /// Of the plane through a point, with a unit normal.
    fn of_plane(normal: DVec3, through: DVec3, weight: f64) -> Self {
        let d = -normal.dot(through);
        let outer = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Quadric { a: outer * weight, b: normal * (d * weight), c: d * d * weight }
    }

    fn plus(self, other: Quadric) -> Self {
        Quadric { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }

    /// 0 if it is rounding alone: what lies in the planes is all alike.
    fn at(&self, x: DVec3) -> f64 {
        let size = self.trace() * x.length_squared() + 2.0 * self.b.length() * x.length() + self.c;
        let sum = x.dot(self.a * x) + 2.0 * self.b.dot(x) + self.c;
        if sum <= ROUNDING * size { 0.0 } else { sum }
    }

    fn trace(&self) -> f64 {
        self.a.x_axis.x + self.a.y_axis.y + self.a.z_axis.z
    }

    /// Where it is least, if that is one place.
    fn least(&self) -> Option<DVec3> {
        let is_clear = self.a.determinant().abs() > SINGULAR * self.trace().powi(3);
        is_clear.then(|| self.a.inverse() * -self.b).filter(|x| x.is_finite())
    }
}

/// A mesh whose edges are taken away.
struct Work {
    at: Vec<DVec3>,
    quadric: Vec<Quadric>,
    /// Facets of each vertex, among them some that are gone.
    of_vertex: Vec<Vec<u32>>,
    /// How many of them there are.
    count: Vec<usize>,
    facets: Vec<[u32; 3]>,
    alive: Vec<bool>,
    /// How often a vertex has moved: what was planned before is void.
    moved: Vec<u32>,
    /// Of each vertex the other ends of edges that could not be taken away: they are tried again when something beside it has moved.
    refused: Vec<Vec<u32>>,
}

/// Leaves at most so many facets, if that can be had without turning any over or opening what is closed. Texture coordinates are lost; vertices at one
/// place must be one.
pub fn decimate(mesh: &mut Mesh, facets: usize) -> Decimated {
    if mesh.facets.len() <= facets {
        return Decimated { facets: mesh.facets.len(), farthest_m: 0.0 };
    }
    let before = mesh.clone();
    // About the middle, so that squares keep their digits.
    let (low, high) = mesh.bounds_m().unwrap_or_default();
    let middle = 0.5 * low + 0.5 * high;
    let mut work = Work::of(mesh, middle);
    let mut plans = BinaryHeap::new();
    for facet in 0..work.facets.len() {
        let [a, b, c] = work.facets[facet];
        [[a, b], [b, c], [c, a]].into_iter().for_each(|[p, q]| work.plan(p, q, &mut plans));
    }
    let mut left = work.alive.iter().filter(|alive| **alive).count();
    while left > facets {
        let Some(Reverse(Plan { is_crowded, edge: [p, q], moved, .. })) = plans.pop() else { break };
        if moved != [p, q].map(|v| work.moved[v as usize]) {
            continue;
        }
        if !is_crowded && work.is_crowded(p, q) {
            // It has become so since.
            work.plan(p, q, &mut plans);
            continue;
        }
        let (_, to) = work.best(p, q);
        if !work.may_join(p, q, to) {
            work.refused[p as usize].push(q);
            work.refused[q as usize].push(p);
            continue;
        }
        left -= work.join(p, q, to);
        for other in work.around(p) {
            work.plan(p, other, &mut plans);
            let mut again = std::mem::take(&mut work.refused[other as usize]);
            again.sort_unstable();
            again.dedup();
            again.retain(|beyond| work.is_edge(other, *beyond));
            if work.count[other as usize] == CROWDED {
                // It may have had one more until now.
                again = work.around(other);
            }
            again.iter().filter(|beyond| **beyond != p).for_each(|beyond| work.plan(other, *beyond, &mut plans));
        }
    }
    // What stayed where it was keeps its digits.
    for (vertex, (at, moved)) in mesh.vertices_m.iter_mut().zip(work.at.iter().zip(&work.moved)) {
        if *moved > 0 {
            *vertex = *at + middle;
        }
    }
    mesh.facets.clone_from(&work.facets);
    mesh.uv.clear();
    mesh.face_of_facet.clear();
    keep(mesh, |facet| work.alive[facet]);
    mesh.face_of_facet.clear();
    Decimated { facets: mesh.facets.len(), farthest_m: farthest(&before, mesh).max(farthest(mesh, &before)) }
}

/// To take an edge away: those first whose numbers here are least, one after the other. Numbers of at least 0 are ordered as their bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Plan {
    is_crowded: bool,
    cost: u64,
    length_squared: u64,
    /// The lower one first.
    edge: [u32; 2],
    /// How often they had moved: if they have again, the plan is void.
    moved: [u32; 2],
}

impl Work {
    fn of(mesh: &Mesh, middle: DVec3) -> Self {
        let at: Vec<DVec3> = mesh.vertices_m.iter().map(|v| *v - middle).collect();
        let mut work = Work {
            quadric: vec![Quadric::ZERO; at.len()],
            refused: vec![Vec::new(); at.len()],
            of_vertex: vec![Vec::new(); at.len()],
            count: vec![0; at.len()],
            moved: vec![0; at.len()],
            facets: mesh.facets.clone(),
            alive: mesh.facets.iter().map(|[a, b, c]| a != b && b != c && c != a).collect(),
            at,
        };
        let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * mesh.facets.len());
        for facet in (0..mesh.facets.len()).filter(|f| work.alive[*f]) {
            let [a, b, c] = mesh.facets[facet];
            let cross = work.cross([a, b, c]);
            let normal = cross.normalize_or_zero();
            let quadric = Quadric::of_plane(normal, work.at[a as usize], cross.length());
            for v in [a, b, c] {
                work.of_vertex[v as usize].push(index_u32(facet));
                work.count[v as usize] += 1;
                work.quadric[v as usize] = work.quadric[v as usize].plus(quadric);
            }
            edges.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], index_u32(facet))));
        }
        edges.sort_unstable();
        for edge in edges.chunk_by(|a, b| a.0 == b.0) {
            let material = |facet: u32| mesh.material.get(facet as usize);
            if edge.len() == 2 && material(edge[0].1) == material(edge[1].1) {
                continue;
            }
            for ([p, q], facet) in edge {
                let way = work.at[*q as usize] - work.at[*p as usize];
                let across = way.cross(work.cross(mesh.facets[*facet as usize])).normalize_or_zero();
                let wall = Quadric::of_plane(across, work.at[*p as usize], BORDER * way.length_squared());
                for v in [p, q] {
                    work.quadric[*v as usize] = work.quadric[*v as usize].plus(wall);
                }
            }
        }
        work
    }

    fn cross(&self, [a, b, c]: [u32; 3]) -> DVec3 {
        let [a, b, c] = [a, b, c].map(|v| self.at[v as usize]);
        (b - a).cross(c - a)
    }

    /// What joining two vertices costs, and where they go.
    fn best(&self, p: u32, q: u32) -> (f64, DVec3) {
        let sum = self.quadric[p as usize].plus(self.quadric[q as usize]);
        let (a, b) = (self.at[p as usize], self.at[q as usize]);
        // A least place far away is that of planes that are nearly one.
        let near = |x: &DVec3| x.distance(0.5 * (a + b)) <= 2.0 * a.distance(b);
        match sum.least().filter(near) {
            Some(least) => (sum.at(least), least),
            None => [a, b, 0.5 * (a + b)]
                .map(|x| (sum.at(x), x))
                .into_iter()
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f64::INFINITY, a)),
        }
    }

    fn plan(&self, p: u32, q: u32, plans: &mut BinaryHeap<Reverse<Plan>>) {
        let edge = [p.min(q), p.max(q)];
        plans.push(Reverse(Plan {
            is_crowded: self.is_crowded(p, q),
            cost: self.best(edge[0], edge[1]).0.to_bits(),
            length_squared: self.at[p as usize].distance_squared(self.at[q as usize]).to_bits(),
            edge,
            moved: edge.map(|v| self.moved[v as usize]),
        }));
    }

    fn is_crowded(&self, p: u32, q: u32) -> bool {
        [p, q].iter().any(|v| self.count[*v as usize] > CROWDED)
    }

    /// The facets that have both vertices.
    fn shared(&self, p: u32, q: u32) -> Vec<u32> {
        let (few, many) =
            if self.of_vertex[p as usize].len() <= self.of_vertex[q as usize].len() { (p, q) } else { (q, p) };
        self.facets_of(few).filter(|facet| self.facets[*facet as usize].contains(&many)).collect()
    }

    fn is_edge(&self, p: u32, q: u32) -> bool {
        !self.shared(p, q).is_empty()
    }

    fn facets_of(&self, vertex: u32) -> impl Iterator<Item = u32> {
        self.of_vertex[vertex as usize].iter().copied().filter(|facet| self.alive[*facet as usize])
    }

    /// Neighbours of a vertex.
    fn around(&self, vertex: u32) -> Vec<u32> {
        let mut all: Vec<u32> =
            self.facets_of(vertex).flat_map(|facet| self.facets[facet as usize]).filter(|v| *v != vertex).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Whether a vertex has an edge of one facet.
    fn is_at_border(&self, vertex: u32) -> bool {
        let mut ends: Vec<u32> =
            self.facets_of(vertex).flat_map(|facet| self.facets[facet as usize]).filter(|v| *v != vertex).collect();
        ends.sort_unstable();
        ends.chunk_by(|a, b| a == b).any(|facets| facets.len() != 2)
    }

    fn may_join(&self, p: u32, q: u32, to: DVec3) -> bool {
        let shared = self.shared(p, q);
        if shared.is_empty() || shared.len() > 2 {
            return false;
        }
        let (of_p, of_q) = (self.around(p), self.around(q));
        let common = of_p.iter().filter(|v| of_q.binary_search(v).is_ok()).count();
        if common != shared.len() || (shared.len() == 2 && self.is_at_border(p) && self.is_at_border(q)) {
            return false;
        }
        // Of a tetrahedron nothing would be left.
        if of_p.len() <= 3 && of_q.len() <= 3 && shared.len() == 2 {
            return false;
        }
        [p, q].iter().all(|vertex| {
            self.facets_of(*vertex).filter(|f| !shared.contains(f)).all(|facet| {
                let corners = self.facets[facet as usize];
                let before = self.cross(corners);
                let [a, b, c] = corners.map(|v| if v == *vertex { to } else { self.at[v as usize] });
                let after = (b - a).cross(c - a);
                after.dot(before) > TURN * after.length() * before.length()
            })
        })
    }

    /// One facet fewer at a vertex: once half of its list is of such, they are taken out.
    fn forget_one(&mut self, vertex: u32) {
        let (of_vertex, count) = (&mut self.of_vertex[vertex as usize], &mut self.count[vertex as usize]);
        *count -= 1;
        if of_vertex.len() > 2 * *count {
            of_vertex.retain(|facet| self.alive[*facet as usize]);
        }
    }

    /// Puts q into p, which goes there; how many facets that takes away.
    fn join(&mut self, p: u32, q: u32, to: DVec3) -> usize {
        let of_q: Vec<u32> = self.facets_of(q).collect();
        let mut gone = 0;
        for facet in of_q {
            if self.facets[facet as usize].contains(&p) {
                self.alive[facet as usize] = false;
                self.facets[facet as usize].into_iter().for_each(|v| self.forget_one(v));
                gone += 1;
            } else {
                self.facets[facet as usize] = self.facets[facet as usize].map(|v| if v == q { p } else { v });
                self.of_vertex[p as usize].push(facet);
                self.count[p as usize] += 1;
            }
        }
        self.at[p as usize] = to;
        self.quadric[p as usize] = self.quadric[p as usize].plus(self.quadric[q as usize]);
        for v in [p, q] {
            self.moved[v as usize] += 1;
        }
        let alive = &self.alive;
        self.of_vertex[p as usize].retain(|facet| alive[*facet as usize]);
        self.of_vertex[q as usize] = Vec::new();
        self.count[q as usize] = 0;
        // All of their edges are planned anew.
        [p, q].iter().for_each(|v| self.refused[*v as usize] = Vec::new());
        gone
    }
}

/// The farthest that a corner or the middle of a facet is from another mesh, m; 0 of nothing.
fn farthest(from: &Mesh, to: &Mesh) -> f64 {
    let tree = BoxTree::new(to);
    (0..from.facets.len())
        .into_par_iter()
        .map(|facet| {
            let of = from.facet(facet);
            let points = [of.corners_m[0], of.corners_m[1], of.corners_m[2], of.centroid_m()];
            points.into_iter().map(|point| tree.distance_m(to, point)).fold(0.0, f64::max)
        })
        .reduce(|| 0.0, f64::max)
}
