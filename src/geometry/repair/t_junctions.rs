//! A corner that lies on the edge of a facet it is no corner of makes a gap there: the facet is cut at it.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::geometry::{Mesh, index_u32};

/// A corner is on an edge if it is no farther from it than this share of its length: coordinates have seven digits in most files.
const ON_EDGE: f64 = 1e-6;

/// Cuts facets at the corners that lie on their open edges; how many corners that were. Corners are those of open edges.
///
/// Each piece is a face of its own, as are the other facets of the face that is cut: that face would have corners in a line, which programs cut
/// into triangles without an area.
pub fn t_junctions(mesh: &mut Mesh) -> usize {
    let mut mended = 0;
    let mut cut = BTreeSet::new();
    // A facet may have corners on several edges: each round mends one edge of a facet.
    loop {
        let done = round(mesh, &mut cut);
        mended += done;
        if done == 0 {
            break;
        }
    }
    let free = mesh.face_of_facet.iter().max().map_or(0, |face| face + 1);
    let freed = mesh.face_of_facet.iter_mut().filter(|face| cut.contains(face));
    freed.zip(free..).for_each(|(face, own)| *face = own);
    mended
}

/// One edge of each facet; of those that are cut, the faces go to `cut`.
fn round(mesh: &mut Mesh, cut: &mut BTreeSet<u32>) -> usize {
    let mut edges: Vec<([u32; 2], u32, u8)> = Vec::with_capacity(3 * mesh.facets.len());
    for (facet, corners) in mesh.facets.iter().enumerate() {
        for k in 0..3_u8 {
            let [p, q] = [corners[k as usize], corners[(k as usize + 1) % 3]];
            if p != q {
                edges.push(([p.min(q), p.max(q)], index_u32(facet), k));
            }
        }
    }
    edges.sort_unstable();
    let open: Vec<(u32, u8)> = edges
        .chunk_by(|a, b| a.0 == b.0)
        .filter_map(|edge| if let [(_, f, k)] = edge { Some((*f, *k)) } else { None })
        .collect();
    let ends = |(facet, k): (u32, u8)| {
        let corners = mesh.facets[facet as usize];
        [corners[k as usize], corners[(k as usize + 1) % 3]]
    };
    let mut corners: Vec<u32> = open.iter().flat_map(|edge| ends(*edge)).collect();
    corners.sort_unstable();
    corners.dedup();
    let place = |v: u32| mesh.vertices_m[v as usize];
    // Looked for along x.
    corners.sort_by(|a, b| place(*a).x.total_cmp(&place(*b).x).then(a.cmp(b)));
    let mut cuts: Vec<(u32, u8, Vec<u32>)> = Vec::new();
    for edge in open {
        if cuts.last().is_some_and(|cut| cut.0 == edge.0) {
            continue;
        }
        let [p, q] = ends(edge).map(place);
        let length = p.distance(q);
        let near = ON_EDGE * length;
        let (low, high) = (p.min(q) - near, p.max(q) + near);
        let first = corners.partition_point(|v| place(*v).x < low.x);
        let mut on: Vec<(f64, u32)> = corners[first..]
            .iter()
            .take_while(|v| place(**v).x <= high.x)
            .filter(|v| !mesh.facets[edge.0 as usize].contains(v))
            .filter_map(|v| Some((along(place(*v), p, q, near)?, *v)))
            .collect();
        on.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        on.dedup_by(|a, b| a.0 == b.0);
        if !on.is_empty() {
            cuts.push((edge.0, edge.1, on.into_iter().map(|(_, v)| v).collect()));
        }
    }
    // Sorted by facet, so that what is added has its place by the order of facets, not of edges.
    cuts.sort_by_key(|cut| (cut.0, cut.1));
    cuts.dedup_by_key(|cut| cut.0);
    let mut mended = 0;
    for (facet, k, on) in cuts {
        let (facet, k) = (facet as usize, k as usize);
        mended += on.len();
        let corners = mesh.facets[facet];
        let [a, b, c] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        let of_uv = mesh.uv.get(facet).map(|uv| [0, 1, 2].map(|i| uv[(k + i) % 3]));
        let (from, to) = (mesh.vertices_m[a as usize], mesh.vertices_m[b as usize]);
        let share = |v: u32| (mesh.vertices_m[v as usize] - from).dot(to - from) / (to - from).length_squared();
        let at = |v: u32| of_uv.map(|[p, q, _]| [0, 1].map(|i| p[i] + share(v) * (q[i] - p[i])));
        let chain: Vec<(u32, Option<[f64; 2]>)> = std::iter::once((a, of_uv.map(|uv| uv[0])))
            .chain(on.iter().map(|v| (*v, at(*v))))
            .chain(std::iter::once((b, of_uv.map(|uv| uv[1]))))
            .collect();
        if mesh.face_of_facet.is_empty() {
            mesh.face_of_facet = (0..index_u32(mesh.facets.len())).collect();
        }
        cut.insert(mesh.face_of_facet[facet]);
        for (i, pair) in chain.windows(2).enumerate() {
            let corners = [pair[0].0, pair[1].0, c];
            let uv = match (pair[0].1, pair[1].1, of_uv) {
                (Some(p), Some(q), Some(uv)) => Some([p, q, uv[2]]),
                _ => None,
            };
            if i == 0 {
                mesh.facets[facet] = corners;
                if let (Some(there), Some(uv)) = (mesh.uv.get_mut(facet), uv) {
                    *there = uv;
                }
                continue;
            }
            mesh.facets.push(corners);
            if let Some(material) = mesh.material.get(facet).copied() {
                mesh.material.push(material);
            }
            mesh.face_of_facet.push(mesh.face_of_facet[facet]);
            mesh.uv.extend(uv);
        }
    }
    mended
}

/// What share of the way from p to q a place is, if it is on that way and at neither end.
fn along(v: DVec3, p: DVec3, q: DVec3, near: f64) -> Option<f64> {
    let way = q - p;
    let share = (v - p).dot(way) / way.length_squared();
    let is_between = share > 0.0 && share < 1.0 && v.distance(p) > near && v.distance(q) > near;
    (is_between && v.distance(p + share * way) <= near).then_some(share)
}
