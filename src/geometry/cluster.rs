//! Coarser meshes, by merging vertices: Rossignac and Borrel, *Multi-resolution 3D approximations* (1993).

use std::collections::BTreeMap;

use glam::DVec3;

use super::{Mesh, index_u32};

impl Mesh {
    /// A coarser mesh: all vertices of a part in one cube of `cell_m` become one, in their mean, and facets that are left without area are dropped.
    ///
    /// Parts that hang together by edges stay apart, so that a boulder does not merge with its ground. Vertices of a part's open
    /// edge merge to a mean of theirs alone: a sheet keeps its outline. Of two facets that come to lie back to back both
    /// are dropped. So an edge has as many facets on its one side as on the other wherever it had before: what is closed stays closed. Facets
    /// keep their materials and which side is out; parts smaller than a cube vanish.
    #[must_use]
    pub fn clustered(&self, cell_m: f64) -> Mesh {
        let Some((low_m, _)) = self.bounds_m().filter(|_| cell_m > 0.0 && cell_m.is_finite()) else {
            return self.clone();
        };
        let place = welded(&self.vertices_m);
        let part = parts(self, &place);
        let open = on_open_edges(self, &place);
        // Of each cluster the sum of its vertices, their number, and the same of those on open edges.
        let mut clusters: BTreeMap<(u32, [i64; 3]), usize> = BTreeMap::new();
        let mut sums: Vec<[(DVec3, f64); 2]> = Vec::new();
        let mut cluster_of = vec![usize::MAX; self.vertices_m.len()];
        for v in self.facets.iter().flatten().map(|v| place[*v as usize] as usize) {
            if cluster_of[v] != usize::MAX {
                continue;
            }
            // Cubes are counted from the middle of one: a flat sheet at the lowest height does not lie on a border.
            let cube = ((self.vertices_m[v] - low_m) / cell_m + 0.5).floor().to_array();
            #[expect(clippy::cast_possible_truncation, reason = "saturates: such far vertices are all one")]
            let key = (part[v], cube.map(|x| x as i64));
            let cluster = *clusters.entry(key).or_insert_with(|| {
                sums.push([(DVec3::ZERO, 0.0); 2]);
                sums.len() - 1
            });
            cluster_of[v] = cluster;
            let sum = &mut sums[cluster][usize::from(open[v])];
            *sum = (sum.0 + (self.vertices_m[v] - low_m), sum.1 + 1.0);
        }
        let mean_m = |[inner, outer]: &[(DVec3, f64); 2]| {
            let (sum_m, count) = if outer.1 > 0.0 { outer } else { inner };
            low_m + *sum_m / *count
        };
        let mut coarse = Mesh { vertices_m: sums.iter().map(mean_m).collect(), ..Mesh::default() };
        let kept = left_of(self, |v| index_u32(cluster_of[place[v as usize] as usize]));
        for (facet, corners) in kept {
            coarse.facets.push(corners);
            coarse.material.push(self.material[facet]);
            if !self.uv.is_empty() {
                coarse.uv.push(self.uv[facet]);
            }
        }
        coarse
    }
}

/// For each vertex the first one at the same place, bit for bit.
fn welded(vertices_m: &[DVec3]) -> Vec<u32> {
    let mut first: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let bits = |v: &DVec3| v.to_array().map(|x| (x + 0.0).to_bits());
    vertices_m.iter().enumerate().map(|(i, v)| *first.entry(bits(v)).or_insert(index_u32(i))).collect()
}

/// For each vertex the first one of its part.
fn parts(mesh: &Mesh, place: &[u32]) -> Vec<u32> {
    let mut above: Vec<u32> = (0..index_u32(mesh.vertices_m.len())).collect();
    fn root(above: &mut [u32], mut v: u32) -> u32 {
        while above[v as usize] != v {
            above[v as usize] = above[above[v as usize] as usize];
            v = above[v as usize];
        }
        v
    }
    for facet in &mesh.facets {
        let [a, b, c] = facet.map(|v| place[v as usize]);
        for other in [b, c] {
            let (p, q) = (root(&mut above, a), root(&mut above, other));
            above[p.max(q) as usize] = p.min(q);
        }
    }
    (0..index_u32(mesh.vertices_m.len())).map(|v| root(&mut above, v)).collect()
}

/// Which vertices lie on an edge that has a facet on one side only.
fn on_open_edges(mesh: &Mesh, place: &[u32]) -> Vec<bool> {
    let mut sides: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for facet in &mesh.facets {
        let [a, b, c] = facet.map(|v| place[v as usize]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *sides.entry([from.min(to), from.max(to)]).or_insert(0) += if from < to { 1 } else { -1 };
        }
    }
    let mut open = vec![false; mesh.vertices_m.len()];
    sides.iter().filter(|(_, sum)| **sum != 0).flat_map(|(edge, _)| edge).for_each(|v| open[*v as usize] = true);
    open
}

/// Facets with three corners in different clusters, without pairs of which one is the other's back; in their order.
fn left_of(mesh: &Mesh, cluster: impl Fn(u32) -> u32) -> Vec<(usize, [u32; 3])> {
    let mut waiting: BTreeMap<[u32; 3], Vec<usize>> = BTreeMap::new();
    let mut is_kept = vec![false; mesh.facets.len()];
    for (facet, corners) in mesh.facets.iter().enumerate() {
        let [a, b, c] = corners.map(&cluster);
        if a == b || b == c || c == a {
            continue;
        }
        match waiting.get_mut(&from_lowest([a, c, b])).and_then(Vec::pop) {
            Some(back) => is_kept[back] = false,
            None => {
                waiting.entry(from_lowest([a, b, c])).or_default().push(facet);
                is_kept[facet] = true;
            }
        }
    }
    let kept = (0..mesh.facets.len()).filter(|facet| is_kept[*facet]);
    kept.map(|facet| (facet, mesh.facets[facet].map(&cluster))).collect()
}

/// The same facet, its lowest corner first.
fn from_lowest([a, b, c]: [u32; 3]) -> [u32; 3] {
    match a.min(b).min(c) {
        low if low == a => [a, b, c],
        low if low == b => [b, c, a],
        _ => [c, a, b],
    }
}
