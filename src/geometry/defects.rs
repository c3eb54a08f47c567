//! What of a mesh is probably not meant: holes, facets that are turned, there twice, or next to nothing.

use glam::DVec3;
use rayon::prelude::*;

use super::{Crossings, Mesh, index_u32};

/// A facet whose height over its longest edge is below this is a sliver.
const SLIVER: f64 = 1e-3;

/// Counts over a mesh. Facets and edges go by the numbers of vertices: vertices at one place, but of two numbers, are not joined.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Defects {
    /// Edges of one facet.
    pub open_edges: usize,
    /// Edges of more than two facets.
    pub crowded_edges: usize,
    /// Edges of two facets, one of which faces the other way than its neighbour.
    pub turned_edges: usize,
    /// Facets of the same three vertices as one before, whichever way they face.
    pub duplicate_facets: usize,
    /// Facets without an area, corners at one place or in a line among them.
    pub flat_facets: usize,
    /// Facets that are higher than nothing, but less than a thousandth of their longest edge.
    pub slivers: usize,
    /// Facets that cross one another.
    pub crossings: Crossings,
    /// Connected parts: facets that share a vertex are connected.
    pub parts: usize,
    /// Vertices at the place of one before.
    pub coincident_vertices: usize,
    /// Vertices that no facet uses.
    pub unused_vertices: usize,
}

impl Defects {
    /// Counts them.
    pub fn of(mesh: &Mesh) -> Self {
        let mut found = Defects::default();
        // Each edge by its vertices, the lower number first, and whether it goes that way.
        let mut edges: Vec<([u32; 2], bool)> = mesh
            .facets
            .par_iter()
            .flat_map_iter(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]])
            .filter(|[a, b]| a != b)
            .map(|[a, b]| if a < b { ([a, b], true) } else { ([b, a], false) })
            .collect();
        edges.par_sort_unstable();
        for edge in edges.chunk_by(|a, b| a.0 == b.0) {
            match edge {
                [_] => found.open_edges += 1,
                [(_, a), (_, b)] => found.turned_edges += usize::from(a == b),
                _ => found.crowded_edges += 1,
            }
        }
        let mut corners: Vec<[u32; 3]> = mesh.facets.par_iter().map(|facet| sorted(*facet)).collect();
        corners.par_sort_unstable();
        found.duplicate_facets = corners.windows(2).filter(|pair| pair[0] == pair[1]).count();
        (found.flat_facets, found.slivers) = (0..mesh.facets.len())
            .into_par_iter()
            .map(|facet| {
                let [a, b, c] = mesh.facet(facet).corners_m;
                let twice = (b - a).cross(c - a).length();
                let longest_squared = [b - a, c - b, a - c].into_iter().map(DVec3::length_squared).fold(0.0, f64::max);
                let is_flat = twice == 0.0;
                (usize::from(is_flat), usize::from(!is_flat && twice < SLIVER * longest_squared))
            })
            .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        // + 0.0 makes -0 and 0 one number.
        let mut places: Vec<[u64; 3]> =
            mesh.vertices_m.par_iter().map(|v| v.to_array().map(|x| (x + 0.0).to_bits())).collect();
        places.par_sort_unstable();
        found.coincident_vertices = places.windows(2).filter(|pair| pair[0] == pair[1]).count();
        (found.parts, found.unused_vertices) = parts(mesh);
        found.crossings = Crossings::of(mesh);
        found
    }
}

fn sorted(mut facet: [u32; 3]) -> [u32; 3] {
    facet.sort_unstable();
    facet
}

/// How many connected parts there are, and vertices in none.
fn parts(mesh: &Mesh) -> (usize, usize) {
    let mut root: Vec<u32> = (0..index_u32(mesh.vertices_m.len())).collect();
    fn find(root: &mut [u32], mut v: u32) -> u32 {
        while root[v as usize] != v {
            root[v as usize] = root[root[v as usize] as usize];
            v = root[v as usize];
        }
        v
    }
    let mut used = vec![false; root.len()];
    for facet in &mesh.facets {
        facet.iter().for_each(|v| used[*v as usize] = true);
        for pair in facet.windows(2) {
            let (a, b) = (find(&mut root, pair[0]), find(&mut root, pair[1]));
            root[a.max(b) as usize] = a.min(b);
        }
    }
    let is_first = |v: &usize| used[*v] && root[*v] as usize == *v;
    ((0..root.len()).filter(is_first).count(), used.iter().filter(|used| !**used).count())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron, outwards.
    const FACETS: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

    fn mesh(vertices: &[[f64; 3]], facets: &[[u32; 3]]) -> Mesh {
        Mesh {
            vertices_m: vertices.iter().map(|v| DVec3::from_array(*v)).collect(),
            facets: facets.to_vec(),
            ..Mesh::default()
        }
    }

    const CORNERS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn a_closed_body_has_none() {
        let whole = Defects::of(&mesh(&CORNERS, &FACETS));
        assert_eq!(whole, Defects { parts: 1, ..Defects::default() });
        assert_eq!(Defects::of(&Mesh::default()), Defects::default());
    }

    #[test]
    fn each_kind_is_counted() {
        let of = |facets: &[[u32; 3]]| Defects::of(&mesh(&CORNERS, facets));
        // Without a facet its three edges are open, and its vertices still used.
        assert_eq!(of(&FACETS[1..]), Defects { open_edges: 3, parts: 1, ..Defects::default() });
        // One that faces inwards turns its three edges.
        let turned = [[0, 1, 2], FACETS[1], FACETS[2], FACETS[3]];
        assert_eq!(of(&turned), Defects { turned_edges: 3, parts: 1, ..Defects::default() });
        // There twice: its edges have three facets each; the other way round, too.
        // A facet that is drawn out below the one across from it passes through that.
        let mut through = CORNERS;
        through[3] = [0.2, 0.2, -1.0];
        let pierced = mesh(&[&through[..], &[[0.2, 0.2, 1.0]]].concat(), &[FACETS[0], [1, 2, 3], [0, 3, 4]]);
        assert_eq!(Defects::of(&pierced).crossings.pairs, 1);
        let twice = [FACETS[0], FACETS[1], FACETS[2], FACETS[3], [1, 2, 0]];
        assert_eq!(of(&twice), Defects { crowded_edges: 3, duplicate_facets: 1, parts: 1, ..Defects::default() });
        // One facet alone: three open edges, and a vertex that nobody uses.
        assert_eq!(of(&FACETS[..1]), Defects { open_edges: 3, parts: 1, unused_vertices: 1, ..Defects::default() });
        // Two triangles side by side that do not know it: -0 is 0.
        let apart = mesh(
            &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, -0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, -0.0]],
            &[[0, 1, 2], [3, 4, 5]],
        );
        assert_eq!(
            Defects::of(&apart),
            Defects { open_edges: 6, parts: 2, coincident_vertices: 2, ..Defects::default() }
        );
        // A line, a corner that is there twice, and heights of 1/999 and 1/1001 of the longest edge.
        let thin = |height: f64| [[0.0; 3], [1.0, 0.0, 0.0], [0.5, height, 0.0]];
        for (height, flat, slivers) in [(0.0, 1, 0), (1.0 / 1001.0, 0, 1), (1.0 / 999.0, 0, 0)] {
            let found = Defects::of(&mesh(&thin(height), &[[0, 1, 2]]));
            assert_eq!((found.flat_facets, found.slivers, found.open_edges), (flat, slivers, 3), "{height}");
        }
        let point = Defects::of(&mesh(&CORNERS, &[[0, 0, 1]]));
        assert_eq!((point.flat_facets, point.open_edges, point.turned_edges), (1, 0, 0));
    }
}
