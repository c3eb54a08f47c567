//! Vertices at one place become one.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use super::keep;
use crate::geometry::{Mesh, index_u32};

/// From here on whole numbers are no longer one apart: a place is its own cell.
const LAST_CELL: f64 = 1.0 / f64::EPSILON;

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
    let becomes = match within_m.filter(|m| *m > 0.0 && m.is_finite()) {
        Some(m) => firsts_within(&mesh.vertices_m, m),
        None => firsts(&mesh.vertices_m),
    };
    let vertices = joined(&becomes);
    for facet in &mut mesh.facets {
        *facet = facet.map(|v| becomes[v as usize]);
    }
    let is_kept: Vec<bool> = mesh.facets.iter().map(|[a, b, c]| a != b && b != c && c != a).collect();
    let facets = is_kept.iter().filter(|kept| !**kept).count();
    keep(mesh, |facet| is_kept[facet]);
    Welded { vertices, facets }
}

/// Makes one vertex of those whose coordinates are equal (-0 is 0), as where files split them for texture coordinates or flat shading; how many
/// that took away. Of each place the first stays; facets stay as many as they are, in their order, with their texture coordinates.
pub fn join_equal(mesh: &mut Mesh) -> usize {
    let becomes = firsts(&mesh.vertices_m);
    let joined = joined(&becomes);
    if joined == 0 {
        return 0;
    }
    // Where each first vertex is once the others are gone.
    let mut place = vec![0; becomes.len()];
    let mut count = 0;
    for (i, to) in becomes.iter().enumerate() {
        if i == *to as usize {
            place[i] = index_u32(count);
            mesh.vertices_m[count] = mesh.vertices_m[i];
            count += 1;
        }
    }
    mesh.vertices_m.truncate(count);
    for facet in &mut mesh.facets {
        *facet = facet.map(|v| place[becomes[v as usize] as usize]);
    }
    joined
}

fn joined(becomes: &[u32]) -> usize {
    becomes.iter().enumerate().filter(|(i, to)| *i != **to as usize).count()
}

/// Of each vertex the first at its place.
fn firsts(vertices_m: &[DVec3]) -> Vec<u32> {
    let mut order: Vec<([u64; 3], u32)> =
        vertices_m.par_iter().enumerate().map(|(i, v)| (bits(v.to_array()), index_u32(i))).collect();
    order.par_sort_unstable();
    let mut becomes = vec![0; vertices_m.len()];
    for there in order.chunk_by(|a, b| a.0 == b.0) {
        there.iter().for_each(|(_, i)| becomes[*i as usize] = there[0].1);
    }
    becomes
}

/// Of each vertex the first that is no farther than a distance and has become no other.
fn firsts_within(vertices_m: &[DVec3], m: f64) -> Vec<u32> {
    // Cells as wide as the distance: those that stay are farther apart, so that few are in one.
    let cell = |v: DVec3| {
        v.to_array().map(|x| {
            let cell = (x / m).floor();
            if cell.abs() < LAST_CELL { cell } else { x }
        })
    };
    let mut first_in: BTreeMap<[u64; 3], Vec<u32>> = BTreeMap::new();
    let mut becomes: Vec<u32> = Vec::with_capacity(vertices_m.len());
    let reach = [-1.0, 0.0, 1.0];
    for (i, vertex) in vertices_m.iter().enumerate() {
        let [x, y, z] = cell(*vertex);
        let around =
            reach.iter().flat_map(|dx| reach.iter().flat_map(move |dy| reach.map(|dz| [x + dx, y + dy, z + dz])));
        let is_near = |other: &&u32| vertices_m[**other as usize].distance(*vertex) <= m;
        let near = around.filter_map(|cell| first_in.get(&bits(cell))?.iter().filter(is_near).min().copied()).min();
        becomes.push(near.unwrap_or(index_u32(i)));
        if near.is_none() {
            first_in.entry(bits([x, y, z])).or_default().push(index_u32(i));
        }
    }
    becomes
}

/// Alike for numbers that are equal: + 0.0 makes -0 and 0 one.
fn bits(numbers: [f64; 3]) -> [u64; 3] {
    numbers.map(|x| (x + 0.0).to_bits())
}
