//! Facets that lie on others: a mesh, or a part of one, that is given twice.

use std::collections::HashSet;

use crate::geometry::{Mesh, index_u32};

/// Facets lie in one plane within this, times the magnitude of coordinates: closer than some view can tell, so that no view shall.
pub(super) const SAME_PLANE: f64 = 512.0 * f64::EPSILON;

/// What decides between facets in one place that show the same side: material, then the sorted corners. Not the index, which a user may
/// shuffle, until nothing else is left.
pub(super) type Rank = (u16, [[u64; 3]; 3], u32);

/// A facet's; the lower wins.
pub(super) fn rank(mesh: &Mesh, facet: u32) -> Rank {
    let mut corners = mesh.facet(facet as usize).corners_m.map(|p| p.to_array().map(ordered_bits));
    corners.sort_unstable();
    (mesh.material[facet as usize].0, corners, facet)
}

/// A key whose order is that of the numbers.
fn ordered_bits(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// Whether two facets that run along an edge the same way lie on one another, in one plane with the same side out. Otherwise one of them is
/// turned over.
pub(super) fn lies_on(mesh: &Mesh, [f, g]: [u32; 2]) -> bool {
    let (one, other) = (mesh.facet(f as usize), mesh.facet(g as usize));
    let (a, normal) = (one.corners_m[0], one.cross_m2());
    let magnitude_m = one.corners_m.iter().chain(&other.corners_m).map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let is_near = |p: &glam::DVec3| (*p - a).dot(normal).abs() <= SAME_PLANE * magnitude_m * normal.length();
    other.corners_m.iter().all(is_near) && normal.dot(other.cross_m2()) > 0.0
}

/// How many facets lie on an earlier one: of `doubled`, pairs that do, and of those with an open edge, corner on corner.
pub(super) fn count(mesh: &Mesh, has_open_edge: &[bool], doubled: &[[u32; 2]]) -> usize {
    let mut later: Vec<u32> = doubled.iter().map(|[f, g]| *f.max(g)).collect();
    let mut known = HashSet::new();
    for (f, _) in has_open_edge.iter().enumerate().filter(|(_, is_open)| **is_open) {
        // + 0.0 makes -0.0 and 0.0 one place. The first corner is where the list begins, no more.
        let mut corners = mesh.facet(f).corners_m.map(|p| p.to_array().map(|x| (x + 0.0).to_bits()));
        let least = (0..3).min_by_key(|k| corners[*k]).unwrap_or(0);
        corners.rotate_left(least);
        if !known.insert(corners) {
            later.push(index_u32(f));
        }
    }
    later.sort_unstable();
    later.dedup();
    later.len()
}
