//! Facets that lie on others: a mesh, or a part of one, that is given twice.

use std::collections::HashSet;

use crate::geometry::{Mesh, index_u32};

/// Facets lie in one plane within this, times the magnitude of coordinates: closer than some view can tell, so that no view shall.
pub(super) const SAME_PLANE: f64 = 512.0 * f64::EPSILON;

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
