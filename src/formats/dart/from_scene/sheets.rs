//! Facets that are another one turned round: the two sides of a sheet, which in DART is one facet with a back.

use std::collections::VecDeque;

use glam::DVec3;

use crate::geometry::{Mesh, index_u32};

/// Facets that have a back, and the facet that is it: of two, the earlier one is the front. No facet is in two pairs.
pub(super) fn sheets(mesh: &Mesh) -> Vec<(u32, u32)> {
    let vertex = first_of_place(&mesh.vertices_m);
    let corners = |f: u32| mesh.facets[f as usize].map(|v| vertex[v as usize]);
    let sorted = |f: u32| {
        let mut corners = corners(f);
        corners.sort_unstable();
        corners
    };
    let mut order: Vec<u32> = (0..index_u32(mesh.facets.len())).collect();
    // The order of facets with the same corners stays.
    order.sort_by_key(|f| sorted(*f));
    let mut pairs = Vec::new();
    for same in order.chunk_by(|a, b| sorted(*a) == sorted(*b)) {
        let [a, b, c] = sorted(same[0]);
        // What has no area has no sides.
        if same.len() < 2 || a == b || b == c {
            continue;
        }
        let mut alone = [VecDeque::new(), VecDeque::new()];
        for &facet in same {
            let [p, q, r] = corners(facet);
            let way = usize::from([[p, q, r], [q, r, p], [r, p, q]].contains(&[a, b, c]));
            match alone[1 - way].pop_front() {
                Some(front) => pairs.push((front, facet)),
                None => alone[way].push_back(facet),
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

/// The facets in the order in which they are read back: fronts, and facets without a back; then backs, in the order of their fronts.
pub(super) fn as_read(mesh: &Mesh) -> Vec<u32> {
    let pairs = sheets(mesh);
    let mut is_back = vec![false; mesh.facets.len()];
    pairs.iter().for_each(|(_, back)| is_back[*back as usize] = true);
    let fronts = (0..index_u32(mesh.facets.len())).filter(|f| !is_back[*f as usize]);
    fronts.chain(pairs.iter().map(|(_, back)| *back)).collect()
}

/// For each vertex the first one at its place: files repeat them.
fn first_of_place(vertices_m: &[DVec3]) -> Vec<u32> {
    // 0 and -0 are one place.
    let place = |v: u32| (vertices_m[v as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..index_u32(vertices_m.len())).collect();
    order.sort_by_key(|v| place(*v));
    let mut first = vec![0; vertices_m.len()];
    for same in order.chunk_by(|a, b| place(*a) == place(*b)) {
        same.iter().for_each(|v| first[*v as usize] = same[0]);
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(vertices: &[[f64; 3]], facets: &[[u32; 3]]) -> Vec<(u32, u32)> {
        let vertices_m = vertices.iter().map(|v| DVec3::from_array(*v)).collect();
        sheets(&Mesh { vertices_m, facets: facets.to_vec(), ..Mesh::default() })
    }

    #[test]
    fn a_back_is_the_same_triangle_turned_round() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(of(&square, &[[0, 1, 2], [0, 2, 3]]), []);
        // Whichever corner is first, and in any order of facets.
        assert_eq!(of(&square, &[[0, 1, 2], [0, 3, 2], [0, 2, 3], [1, 0, 2]]), [(0, 3), (1, 2)]);
        // The same way round is no back; of three, one stays alone.
        assert_eq!(of(&square, &[[0, 1, 2], [1, 2, 0]]), []);
        assert_eq!(of(&square, &[[0, 1, 2], [1, 2, 0], [2, 1, 0]]), [(0, 2)]);
        assert_eq!(of(&square, &[[0, 1, 2], [2, 1, 0], [1, 2, 0], [0, 2, 1]]), [(0, 1), (2, 3)]);
        // Needles and points have no sides.
        assert_eq!(of(&square, &[[0, 1, 1], [1, 0, 1], [2, 2, 2], [2, 2, 2]]), []);
    }

    #[test]
    fn backs_are_read_after_all_others() {
        let vertices_m = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
        let facets = vec![[0, 1, 2], [2, 1, 0], [0, 1, 3], [1, 2, 3], [3, 1, 0]];
        assert_eq!(as_read(&Mesh { vertices_m, facets, ..Mesh::default() }), [0, 2, 3, 1, 4]);
    }

    #[test]
    fn vertices_are_the_same_by_their_places() {
        let twice = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-0.0, 0.0, -0.0], [1.0, 1.0, 0.0]];
        assert_eq!(of(&twice, &[[0, 1, 2], [1, 3, 4]]), [(0, 1)]);
        let nearly = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1e-300, 0.0, 0.0]];
        assert_eq!(of(&nearly, &[[0, 1, 2], [1, 3, 2]]), []);
    }
}
