//! The part of a mesh that is made in detail: its facets are far smaller than those around it.

use glam::DVec3;

use crate::geometry::Mesh;

/// Facets in detail are smaller than these shares of the mean, whichever finds a part.
const SMALLER: [f64; 4] = [0.25, 0.0625, 0.015_625, 0.003_906_25];
/// They are at least this share of all facets,
const MOST: f64 = 0.5;
/// and have at most this share of the surface: of more, a part by itself would gain little.
const LITTLE: f64 = 0.25;

/// Which facets lie in the box around those that are small; none if there is no such part.
pub(super) fn detail(mesh: &Mesh) -> Option<Vec<bool>> {
    let areas_m2: Vec<f64> = (0..mesh.facets.len()).map(|f| mesh.facet(f).area_m2()).collect();
    let area_m2: f64 = areas_m2.iter().sum();
    let count = areas_m2.len() as f64;
    SMALLER.into_iter().find_map(|smaller| {
        let is_small = |f: &usize| areas_m2[*f] < smaller * area_m2 / count;
        let (mut low_m, mut high_m, mut small) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0);
        for f in (0..areas_m2.len()).filter(is_small) {
            small += 1;
            for corner_m in mesh.facet(f).corners_m {
                (low_m, high_m) = (low_m.min(corner_m), high_m.max(corner_m));
            }
        }
        if f64::from(small) < MOST * count {
            return None;
        }
        let is_within = |p_m: DVec3| p_m.cmpge(low_m).all() && p_m.cmple(high_m).all();
        let within: Vec<bool> =
            (0..areas_m2.len()).map(|f| mesh.facet(f).corners_m.into_iter().all(is_within)).collect();
        let within_m2: f64 = areas_m2.iter().zip(&within).filter(|(_, within)| **within).map(|(area, _)| area).sum();
        (within_m2 <= LITTLE * area_m2).then_some(within)
    })
}
