//! Vertices at one place become one.

use std::collections::BTreeMap;

use glam::DVec3;

use super::keep;
use crate::geometry::{Mesh, index_u32};

/// What welding did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Welded {
    /// Vertices that became others.
    pub vertices: usize,
    /// Facets of which two corners became one: they are gone.
    pub facets: usize,
}

/// Makes one vertex of those at the same place, or no farther than `within_m` from the first of them, which stays where it is.
pub fn weld(mesh: &mut Mesh, within_m: Option<f64>) -> Welded {
    let within_m = within_m.filter(|m| *m > 0.0 && m.is_finite());
    // Cells as wide as the distance, or the place itself: -0 and 0 are one number.
    let cell = |v: DVec3| match within_m {
        Some(m) => (v / m).floor().to_array().map(|x| x.clamp(-1e15, 1e15)),
        None => v.to_array(),
    };
    let key = |cell: [f64; 3]| cell.map(|x| (x + 0.0).to_bits());
    let mut first_in: BTreeMap<[u64; 3], Vec<u32>> = BTreeMap::new();
    let mut becomes: Vec<u32> = Vec::with_capacity(mesh.vertices_m.len());
    let reach: &[f64] = if within_m.is_some() { &[-1.0, 0.0, 1.0] } else { &[0.0] };
    for (i, vertex) in mesh.vertices_m.iter().enumerate() {
        let [x, y, z] = cell(*vertex);
        let around = reach
            .iter()
            .flat_map(|dx| reach.iter().flat_map(move |dy| reach.iter().map(move |dz| [x + dx, y + dy, z + dz])));
        let is_near = |other: &&u32| {
            let there = mesh.vertices_m[**other as usize];
            there == *vertex || within_m.is_some_and(|m| there.distance(*vertex) <= m)
        };
        let near = around.filter_map(|cell| first_in.get(&key(cell))?.iter().filter(is_near).min().copied()).min();
        becomes.push(near.unwrap_or(index_u32(i)));
        if near.is_none() {
            first_in.entry(key([x, y, z])).or_default().push(index_u32(i));
        }
    }
    let vertices = becomes.iter().enumerate().filter(|(i, to)| *i != **to as usize).count();
    for facet in &mut mesh.facets {
        *facet = facet.map(|v| becomes[v as usize]);
    }
    let is_kept: Vec<bool> = mesh.facets.iter().map(|[a, b, c]| a != b && b != c && c != a).collect();
    let facets = is_kept.iter().filter(|kept| !**kept).count();
    keep(mesh, |facet| is_kept[facet]);
    Welded { vertices, facets }
}
