//! Faces from the facets that they were cut into: the way back of [`triangulate`](super::triangulate).

use std::ops::Range;

use crate::geometry::Mesh;

use super::triangulate::triangulate;

/// Of faces with more corners it is not found out with which one they began.
const CORNERS: usize = 12;

/// The facets of the face that facet `first` begins: those that follow, of the same face and material.
pub(super) fn facets_of_face(mesh: &Mesh, first: usize) -> Range<usize> {
    let of_face = |f: &usize| mesh.face(*f) == mesh.face(first) && mesh.material[*f] == mesh.material[first];
    // Without a list of faces a facet is a face.
    let most = if mesh.face_of_facet.is_empty() { first + 1 } else { mesh.facets.len() };
    first..(first + 1..most).take_while(of_face).last().unwrap_or(first) + 1
}

/// The corners of a face that is cut into exactly these facets, in this order; `None` if there is none.
pub(super) fn polygon(mesh: &Mesh, facets: Range<usize>) -> Option<Vec<u32>> {
    let facets = &mesh.facets[facets];
    let n = facets.len() + 2;
    if !(4..=CORNERS).contains(&n) {
        return None;
    }
    let edges: Vec<(u32, u32)> = facets.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    // The outline: edges that no other facet of the face runs along in the other sense.
    let outline: Vec<(u32, u32)> = edges.iter().copied().filter(|&(a, b)| !edges.contains(&(b, a))).collect();
    let mut corners = vec![facets[0][0]];
    while corners.len() < n {
        let last = corners[corners.len() - 1];
        corners.push(outline.iter().find(|(a, _)| *a == last)?.1);
    }
    let distinct = (1..n).all(|i| !corners[..i].contains(&corners[i]));
    if outline.len() != n || !distinct || !outline.contains(&(corners[n - 1], corners[0])) {
        return None;
    }
    // The cut depends on the corner that comes first.
    (0..n).find_map(|_| {
        let mut cut = Vec::with_capacity(n - 2);
        triangulate(&corners, &mesh.vertices_m, &mut cut);
        if cut == facets {
            return Some(corners.clone());
        }
        corners.rotate_left(1);
        None
    })
}

/// Faces of more than three corners that are written as triangles, because no face is cut as they are.
pub fn faces_lost(mesh: &Mesh) -> usize {
    let (mut first, mut lost) = (0, 0);
    while first < mesh.facets.len() && !mesh.face_of_facet.is_empty() {
        let facets = facets_of_face(mesh, first);
        first = facets.end;
        lost += usize::from(facets.len() > 1 && polygon(mesh, facets).is_none());
    }
    lost
}
