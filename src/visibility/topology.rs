//! Which facets meet at an edge, and which parts of a mesh are closed.

use std::borrow::Cow;
use std::collections::HashMap;
use std::f64::consts::PI;

use glam::DVec3;

use super::coincident;
use crate::geometry::{GroupSizes, Mesh, index_u32, solid_angle_off_surface_sr};

/// No facet.
pub const NONE: u32 = u32::MAX;

/// How the facets of a mesh hang together.
#[derive(Debug, Clone)]
pub struct Topology {
    /// For each facet and each of its edges (a-b, b-c, c-a): the one facet that runs along it the other way, or [`NONE`].
    pub neighbour: Vec<[u32; 3]>,
    /// Whether a facet belongs to a part proven closed and outward-oriented: its inner side can never be seen from outside.
    pub closed: Vec<bool>,
    /// The connected part of each facet, and what is known of each part that is closed.
    part: Vec<u32>,
    bodies: Vec<Option<ClosedPart>>,
    /// Facets' edges without exactly one other facet along them: one where a facet ends, three where three facets meet.
    pub open_edges: usize,
    /// Facets that must be turned over to agree with the larger part of their surroundings.
    pub flipped_facets: usize,
    /// Facets that lie on an earlier one, with the same side out: a mesh, or a part of it, that is there twice. Of closed parts that
    /// share no vertices they are not counted.
    pub coincident_facets: usize,
}

/// A topology taken apart, to be kept and put together again.
#[derive(Debug)]
pub(crate) struct TopologyParts {
    /// As [`Topology::neighbour`].
    pub(crate) neighbour: Vec<[u32; 3]>,
    /// The connected part of each facet.
    pub(crate) part: Vec<u32>,
    /// Of each part that is closed the least and the greatest of its coordinates, m.
    pub(crate) closed: Vec<Option<[DVec3; 2]>>,
    /// As [`Topology::open_edges`].
    pub(crate) open_edges: usize,
    /// As [`Topology::flipped_facets`].
    pub(crate) flipped_facets: usize,
    /// As [`Topology::coincident_facets`].
    pub(crate) coincident_facets: usize,
}

/// A part that is proven closed: the least and the greatest of its coordinates, m.
#[derive(Debug, Clone, Copy)]
struct ClosedPart {
    low_m: DVec3,
    high_m: DVec3,
}

/// Where an eye is that is not certainly outside all closed parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Enclosure {
    /// Closed parts that it is inside of.
    pub inside: usize,
    /// Closed parts on whose surface it is, to rounding.
    pub on: usize,
}

impl Topology {
    /// Finds neighbours and closed parts. Vertices of open edges at the same place count as one, so seams close.
    pub fn new(mesh: &Mesh) -> Self {
        let mut neighbour = vec![[NONE; 3]; mesh.facets.len()];
        let mut same_way: Vec<[u32; 2]> = Vec::new();
        let mut open = match_by_index(mesh, &mut neighbour, &mut same_way);
        if !open.is_empty() {
            open = match_by_place(mesh, open, &mut neighbour, &mut same_way);
        }
        let mut has_open_edge = vec![false; mesh.facets.len()];
        for code in &open {
            has_open_edge[*code as usize / 4] = true;
        }
        let (doubled, turned): (Vec<_>, Vec<_>) = same_way.iter().partition(|pair| coincident::lies_on(mesh, **pair));
        let coincident_facets = coincident::count(mesh, &has_open_edge, &doubled);
        let parts = Parts::new(&neighbour, &turned);
        let (bodies, flipped_facets) = parts.bodies_and_flipped(mesh, &has_open_edge, &same_way);
        let closed = parts.part.iter().map(|p| bodies[*p as usize].is_some()).collect();
        let open_edges = open.len() + 2 * doubled.len();
        Topology { neighbour, closed, part: parts.part, bodies, open_edges, flipped_facets, coincident_facets }
    }

    /// Taken apart.
    pub(crate) fn parts(&self) -> TopologyParts {
        TopologyParts {
            neighbour: self.neighbour.clone(),
            part: self.part.clone(),
            closed: self.bodies.iter().map(|body| body.map(|body| [body.low_m, body.high_m])).collect(),
            open_edges: self.open_edges,
            flipped_facets: self.flipped_facets,
            coincident_facets: self.coincident_facets,
        }
    }

    /// Put together again; `None` if these are not the parts of a topology of so many facets.
    pub(crate) fn from_parts(parts: TopologyParts, facets: usize) -> Option<Self> {
        let TopologyParts { neighbour, part, closed, open_edges, flipped_facets, coincident_facets } = parts;
        let is_facet = |f: &u32| *f == NONE || (*f as usize) < facets;
        let is_part = |p: &u32| (*p as usize) < closed.len();
        let is_whole = [neighbour.len(), part.len()] == [facets; 2]
            && neighbour.iter().flatten().all(is_facet)
            && part.iter().all(is_part);
        if !is_whole {
            return None;
        }
        let bodies: Vec<_> =
            closed.into_iter().map(|closed| closed.map(|[low_m, high_m]| ClosedPart { low_m, high_m })).collect();
        let closed = part.iter().map(|p| bodies[*p as usize].is_some()).collect();
        Some(Topology { neighbour, closed, part, bodies, open_edges, flipped_facets, coincident_facets })
    }

    /// Whether the mesh is one part, and that one closed.
    pub fn is_one_body(&self) -> bool {
        matches!(self.bodies[..], [Some(_)])
    }

    /// For each facet whether its inner side cannot be seen from a place: it belongs to a closed part, and the place is outside.
    pub(super) fn hides_inner_sides(&self, mesh: &Mesh, eye_m: DVec3) -> Cow<'_, [bool]> {
        let around = self.around(mesh, eye_m);
        if around.is_empty() {
            return Cow::Borrowed(&self.closed);
        }
        let is_around = |part: &u32| around.iter().any(|(p, _)| p == part);
        Cow::Owned(self.closed.iter().zip(&self.part).map(|(closed, part)| *closed && !is_around(part)).collect())
    }

    /// How many closed parts a place is inside of, and on.
    pub fn enclosure(&self, mesh: &Mesh, eye_m: DVec3) -> Enclosure {
        let around = self.around(mesh, eye_m);
        let on = around.iter().filter(|(_, on)| *on).count();
        Enclosure { inside: around.len() - on, on }
    }

    /// The closed parts that a place is not certainly outside of, and whether it is on their surface, to rounding.
    ///
    /// Solid angles add up to 4 pi times the number of turns of the part around the place: 0 outside, also of a part that crosses itself.
    fn around(&self, mesh: &Mesh, eye_m: DVec3) -> Vec<(u32, bool)> {
        let may_hold = |body: &ClosedPart| {
            let margin = 16.0 * f64::EPSILON * body.low_m.abs().max(body.high_m.abs()).max(eye_m.abs()).max_element();
            (body.low_m - margin).cmple(eye_m).all() && eye_m.cmple(body.high_m + margin).all()
        };
        let near: Vec<u32> = (0..index_u32(self.bodies.len()))
            .filter(|p| self.bodies[*p as usize].as_ref().is_some_and(may_hold))
            .collect();
        if near.is_empty() {
            return vec![];
        }
        let mut sums_sr = vec![Some(0.0); near.len()];
        for (f, part) in self.part.iter().enumerate() {
            if let Ok(i) = near.binary_search(part) {
                let omega_sr = solid_angle_off_surface_sr(mesh.facet(f).corners_m.map(|p| p - eye_m));
                sums_sr[i] = sums_sr[i].zip(omega_sr).map(|(sum, omega)| sum + omega);
            }
        }
        let turns = |sum_sr: f64| (sum_sr / (4.0 * PI)).round();
        near.into_iter()
            .zip(sums_sr)
            .filter(|(_, sum_sr)| sum_sr.is_none_or(|sum_sr| turns(sum_sr) != 0.0))
            .map(|(part, sum_sr)| (part, sum_sr.is_none()))
            .collect()
    }
}

fn ends(mesh: &Mesh, code: u32) -> (u32, u32) {
    let facet = mesh.facets[code as usize / 4];
    let k = code as usize % 4;
    (facet[k], facet[if k == 2 { 0 } else { k + 1 }])
}

/// Joins two halves of an edge: the other way round they are neighbours, the same way round one of them is flipped.
fn join(one: (u32, bool), two: (u32, bool), neighbour: &mut [[u32; 3]], same_way: &mut Vec<[u32; 2]>) {
    let (f, g) = (one.0 / 4, two.0 / 4);
    if one.1 != two.1 {
        neighbour[f as usize][one.0 as usize % 4] = g;
        neighbour[g as usize][two.0 as usize % 4] = f;
    } else {
        same_way.push([f, g]);
    }
}

/// Marks the half of an edge that leads from the smaller vertex to the larger.
const UPWARDS: u32 = 1 << 31;

/// Matches edges by vertex index; returns the codes (4 x facet + edge) of those left over.
fn match_by_index(mesh: &Mesh, neighbour: &mut [[u32; 3]], same_way: &mut Vec<[u32; 2]>) -> Vec<u32> {
    let edges = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)];
    // By the smaller vertex.
    let mut sizes = GroupSizes::new(mesh.vertices_m.len());
    for (p, q) in mesh.facets.iter().flat_map(|facet| edges(*facet)).filter(|(p, q)| p != q) {
        sizes.count(p.min(q) as usize);
    }
    // Of each half the larger vertex, and the code: in one number, whose order is that of both.
    let mut halves = sizes.into_groups::<u64>();
    for (i, facet) in mesh.facets.iter().enumerate() {
        for (k, (p, q)) in edges(*facet).into_iter().enumerate().filter(|(_, (p, q))| p != q) {
            let code = index_u32(4 * i + k) | if p < q { UPWARDS } else { 0 };
            halves.put(p.min(q) as usize, u64::from(p.max(q)) << 32 | u64::from(code));
        }
    }
    let mut open = Vec::new();
    #[expect(clippy::cast_possible_truncation, reason = "the lower half of the number is meant")]
    let code = |half: &u64| *half as u32;
    for v in 0..mesh.vertices_m.len() {
        match_halves(halves.of_mut(v), |half| half >> 32, code, neighbour, same_way, &mut open);
    }
    open
}

/// Matches halves of the same key, which comes first in their order: exactly two make a pair, others stay open.
fn match_halves<H: Copy + Ord, K: PartialEq>(
    halves: &mut [H],
    key: impl Fn(&H) -> K,
    code: impl Fn(&H) -> u32,
    neighbour: &mut [[u32; 3]],
    same_way: &mut Vec<[u32; 2]>,
    open: &mut Vec<u32>,
) {
    halves.sort_unstable();
    let way = |code: u32| (code & !UPWARDS, code & UPWARDS != 0);
    for run in halves.chunk_by(|a, b| key(a) == key(b)) {
        match run {
            [one, two] => join(way(code(one)), way(code(two)), neighbour, same_way),
            _ => open.extend(run.iter().map(|half| code(half) & !UPWARDS)),
        }
    }
}

/// Matches left-over edges by the coordinates of their ends; returns the codes of those still left over.
fn match_by_place(mesh: &Mesh, open: Vec<u32>, neighbour: &mut [[u32; 3]], same_way: &mut Vec<[u32; 2]>) -> Vec<u32> {
    let mut place: HashMap<[u64; 3], u32> = HashMap::new();
    let mut id = |v: u32| {
        // + 0.0 makes -0.0 and 0.0 one place.
        let key = mesh.vertices_m[v as usize].to_array().map(|x| (x + 0.0).to_bits());
        *place.entry(key).or_insert(v)
    };
    let mut halves: Vec<((u32, u32), u32)> = open
        .iter()
        .filter_map(|&code| {
            let (p, q) = ends(mesh, code);
            let (p, q) = (id(p), id(q));
            let way = if p < q { UPWARDS } else { 0 };
            (p != q).then_some(((p.min(q), p.max(q)), code | way))
        })
        .collect();
    let mut left = Vec::new();
    match_halves(&mut halves, |h| h.0, |h| h.1, neighbour, same_way, &mut left);
    left.sort_unstable();
    left
}

/// Connected parts, each facet with its turn (whether it is flipped against the first of its part).
struct Parts {
    part: Vec<u32>,
    turned: Vec<bool>,
    count: usize,
}

impl Parts {
    fn new(neighbour: &[[u32; 3]], same_way: &[[u32; 2]]) -> Self {
        let mut across: HashMap<u32, Vec<u32>> = HashMap::new();
        for &[f, g] in same_way {
            across.entry(f).or_default().push(g);
            across.entry(g).or_default().push(f);
        }
        let mut part = vec![NONE; neighbour.len()];
        let mut turned = vec![false; neighbour.len()];
        let mut count = 0;
        let mut stack = Vec::new();
        for first in 0..neighbour.len() {
            if part[first] != NONE {
                continue;
            }
            part[first] = count;
            stack.push(index_u32(first));
            while let Some(f) = stack.pop() {
                let turn = turned[f as usize];
                let mut reach = |g: u32, turn: bool| {
                    if part[g as usize] == NONE {
                        part[g as usize] = count;
                        turned[g as usize] = turn;
                        stack.push(g);
                    }
                };
                for g in neighbour[f as usize] {
                    if g != NONE {
                        reach(g, turn);
                    }
                }
                if !across.is_empty() {
                    for &g in across.get(&f).into_iter().flatten() {
                        reach(g, !turn);
                    }
                }
            }
            count += 1;
        }
        Parts { part, turned, count: count as usize }
    }

    /// The parts that are closed, and how many facets are turned against the rest of their part.
    fn bodies_and_flipped(
        &self,
        mesh: &Mesh,
        has_open_edge: &[bool],
        same_way: &[[u32; 2]],
    ) -> (Vec<Option<ClosedPart>>, usize) {
        let mut facets = vec![0usize; self.count];
        let mut turned = vec![0usize; self.count];
        let mut closed = vec![true; self.count];
        for (f, &part) in self.part.iter().enumerate() {
            facets[part as usize] += 1;
            turned[part as usize] += usize::from(self.turned[f]);
            closed[part as usize] &= !has_open_edge[f];
        }
        for &f in same_way.as_flattened() {
            closed[self.part[f as usize] as usize] = false;
        }
        // Volume about a vertex of the part: positive when normals point outward.
        let mut bodies: Vec<Option<ClosedPart>> = vec![None; self.count];
        let mut about = vec![None; self.count];
        let mut volume_m3 = vec![0.0; self.count];
        for (f, &part) in self.part.iter().enumerate() {
            let part = part as usize;
            if closed[part] {
                let [a, b, c] = mesh.facet(f).corners_m;
                let o = *about[part].get_or_insert(a);
                volume_m3[part] += (a - o).dot((b - o).cross(c - o)) / 6.0;
                let body = bodies[part].get_or_insert(ClosedPart { low_m: a, high_m: a });
                body.low_m = body.low_m.min(a).min(b).min(c);
                body.high_m = body.high_m.max(a).max(b).max(c);
            }
        }
        for (body, volume_m3) in bodies.iter_mut().zip(volume_m3) {
            body.take_if(|_| volume_m3 <= 0.0 || volume_m3.is_nan());
        }
        let flipped = (0..self.count).map(|p| turned[p].min(facets[p] - turned[p])).sum();
        (bodies, flipped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::MaterialId;
    use glam::DVec3;

    fn tetrahedron() -> Mesh {
        Mesh {
            vertices_m: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            facets: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            material: vec![MaterialId(0); 4],
            face_of_facet: vec![],
            uv: vec![],
        }
    }

    #[test]
    fn a_tetrahedron_is_closed() {
        let t = Topology::new(&tetrahedron());
        assert_eq!((t.open_edges, t.flipped_facets), (0, 0));
        assert_eq!(t.closed, [true; 4]);
        assert_eq!(t.neighbour[0], [3, 2, 1]);
    }

    #[test]
    fn inside_out_is_not_outward() {
        let mut mesh = tetrahedron();
        mesh.facets.iter_mut().for_each(|f| f.swap(0, 1));
        let t = Topology::new(&mesh);
        assert_eq!(t.open_edges, 0);
        assert_eq!(t.closed, [false; 4]);
    }

    #[test]
    fn one_flipped_facet_is_counted() {
        let mut mesh = tetrahedron();
        mesh.facets[2].swap(0, 1);
        let t = Topology::new(&mesh);
        assert_eq!((t.open_edges, t.flipped_facets), (0, 1));
        assert_eq!(t.closed, [false; 4]);
    }

    #[test]
    fn a_missing_facet_opens_three_edges() {
        let mut mesh = tetrahedron();
        mesh.facets.pop();
        mesh.material.pop();
        let t = Topology::new(&mesh);
        assert_eq!(t.open_edges, 3);
        assert_eq!(t.closed, [false; 3]);
    }

    #[test]
    fn a_seam_of_doubled_vertices_closes() {
        let mut mesh = tetrahedron();
        let doubled = mesh.facets.iter().flatten().map(|v| mesh.vertices_m[*v as usize]).collect();
        mesh.vertices_m = doubled;
        mesh.facets = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let t = Topology::new(&mesh);
        assert_eq!(t.open_edges, 0);
        assert_eq!(t.closed, [true; 4]);
    }

    #[test]
    fn three_facets_at_an_edge_are_open() {
        let mut mesh = tetrahedron();
        mesh.facets = vec![[0, 1, 2], [1, 0, 3], [0, 1, 3]];
        mesh.material.pop();
        // Three at the edge 0-1, and the free 1-2 and 2-0. The other two facets are back to back: along 0-3 and 1-3 they pair.
        assert_eq!(Topology::new(&mesh).open_edges, 5);
    }
}
