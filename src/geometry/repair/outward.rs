//! Facets face outwards, and neighbours the same way.

use std::collections::VecDeque;

use glam::DVec3;

use crate::geometry::{Mesh, index_u32};

/// Six times the volume that is enclosed, over the area to the power of 3/2: less is a sheet, flat but for rounding.
const NO_VOLUME: f64 = 1e-9;

/// What turning facets did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Turned {
    /// Facets that face the other way now.
    pub facets: usize,
    /// Parts that are connected by edges of two facets.
    pub parts: usize,
    /// Edges whose two facets cannot face the same way, as on a strip of Moebius.
    pub twisted_edges: usize,
}

/// Makes facets of each part that edges connect face the same way: outwards if the part, closed or seen from its middle, encloses something, else
/// as most of its area does. Edges of three or more facets connect nothing.
pub fn outward(mesh: &mut Mesh) -> Turned {
    let mut edges: Vec<([u32; 2], u32, bool)> = Vec::with_capacity(3 * mesh.facets.len());
    for (facet, [a, b, c]) in mesh.facets.iter().enumerate() {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            if p != q {
                edges.push(([*p.min(q), *p.max(q)], index_u32(facet), p < q));
            }
        }
    }
    edges.sort_unstable();
    // Of each facet its neighbours, and whether they face the same way as it stands.
    let mut beside: Vec<Vec<(u32, bool)>> = vec![Vec::new(); mesh.facets.len()];
    for edge in edges.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, f, way_f), (_, g, way_g)] = edge {
            beside[*f as usize].push((*g, way_f != way_g));
            beside[*g as usize].push((*f, way_f != way_g));
        }
    }
    let mut found = Turned::default();
    let mut turned: Vec<Option<bool>> = vec![None; mesh.facets.len()];
    for start in 0..mesh.facets.len() {
        if turned[start].is_some() {
            continue;
        }
        found.parts += 1;
        turned[start] = Some(false);
        let (mut part, mut next, mut twisted) = (vec![], VecDeque::from([start]), 0);
        while let Some(facet) = next.pop_front() {
            part.push(facet);
            let own = turned[facet] == Some(true);
            for (other, same) in &beside[facet] {
                let wanted = own == *same;
                match turned[*other as usize] {
                    None => {
                        turned[*other as usize] = Some(wanted);
                        next.push_back(*other as usize);
                    }
                    Some(is) => twisted += usize::from(is != wanted),
                }
            }
        }
        found.twisted_edges += twisted / 2;
        // About the middle of its area: of a closed part any point would do.
        let (mut middle, mut area, mut as_it_is) = (DVec3::ZERO, 0.0, 0.0);
        for facet in &part {
            let of = mesh.facet(*facet);
            let own = of.area_m2();
            middle += own * of.centroid_m();
            area += own;
            as_it_is += if turned[*facet] == Some(true) { -own } else { own };
        }
        let middle = if area > 0.0 { middle / area } else { middle };
        let mut volume = 0.0;
        for facet in &part {
            let [a, b, c] = mesh.facet(*facet).corners_m.map(|corner| corner - middle);
            let six = a.dot(b.cross(c));
            volume += if turned[*facet] == Some(true) { -six } else { six };
        }
        let encloses = volume.abs() > NO_VOLUME * area * area.sqrt();
        if (encloses && volume < 0.0) || (!encloses && as_it_is < 0.0) {
            part.iter().for_each(|facet| turned[*facet] = turned[*facet].map(|is| !is));
        }
    }
    for (facet, turned) in turned.iter().enumerate() {
        if *turned == Some(true) {
            mesh.facets[facet].swap(1, 2);
            if let Some(uv) = mesh.uv.get_mut(facet) {
                uv.swap(1, 2);
            }
            found.facets += 1;
        }
    }
    found
}
