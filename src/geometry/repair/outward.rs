//! Facets face outwards, and neighbours the same way.

use std::collections::VecDeque;

use glam::DVec3;

use crate::geometry::{Mesh, index_u32};

/// Six times the volume that is enclosed, over the area to the power of 3/2: less is a sheet, flat but for rounding.
const NO_VOLUME: f64 = 1e-9;
/// What holes leave open, as a flat area, is no more than this share of the area of a body: of ground, half a ball or a box without a lid it is more.
const HOLES: f64 = 0.1;
/// Areas are as large on both sides if they differ by less than this share of both: coordinates have seven digits in most files.
const TIE: f64 = 1e-6;

/// What turning facets did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Turned {
    /// Facets that face the other way now.
    pub facets: usize,
    /// Parts that are connected by edges of two facets.
    pub parts: usize,
    /// Edges whose two facets cannot face the same way, as on a strip of Moebius.
    pub twisted_edges: usize,
    /// Facets of sheets all of whose borders are edges of three or more facets: walls of something, but taken as any sheet.
    pub at_crowded_edges: usize,
}

/// A facet, and those of the same three vertices, which go with it.
struct Group {
    facet: usize,
    /// Of those that face the same way as it less those that face the other.
    same_way: f64,
}

/// Makes facets of each part that edges connect face the same way.
///
/// A part that is closed, but for holes, encloses something, and its facets face away from that. A sheet keeps the side that most of its area has; of
/// two that are as large, that which faces up (+z; where that is none, +y, then +x). Facets of the same three vertices are one, and stay
/// as they are to one another. Edges of three or more others connect nothing.
pub fn outward(mesh: &mut Mesh) -> Turned {
    let (groups, group_of) = groups(mesh);
    let mut edges: Vec<([u32; 2], u32, bool)> = Vec::with_capacity(3 * groups.len());
    for (i, group) in groups.iter().enumerate() {
        let [a, b, c] = mesh.facets[group.facet];
        for [p, q] in [[a, b], [b, c], [c, a]] {
            if p != q {
                edges.push(([p.min(q), p.max(q)], index_u32(i), p < q));
            }
        }
    }
    edges.sort_unstable();
    // Of each group its neighbours, and whether they face the same way as it stands.
    let mut beside: Vec<Vec<(u32, bool)>> = vec![Vec::new(); groups.len()];
    // What has an open edge is no wall of something closed.
    let (mut is_at_crowd, mut is_open) = (vec![false; groups.len()], vec![false; groups.len()]);
    for edge in edges.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, f, way_f), (_, g, way_g)] = edge {
            beside[*f as usize].push((*g, way_f != way_g));
            beside[*g as usize].push((*f, way_f != way_g));
        } else {
            let mark = if edge.len() == 1 { &mut is_open } else { &mut is_at_crowd };
            edge.iter().for_each(|(_, f, _)| mark[*f as usize] = true);
        }
    }
    let mut found = Turned::default();
    let mut turned: Vec<Option<bool>> = vec![None; groups.len()];
    for start in 0..groups.len() {
        if turned[start].is_some() {
            continue;
        }
        found.parts += 1;
        turned[start] = Some(false);
        let (mut part, mut next, mut twisted) = (vec![], VecDeque::from([start]), 0);
        while let Some(group) = next.pop_front() {
            part.push(group);
            let own = turned[group] == Some(true);
            for (other, same) in &beside[group] {
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
        let sign = |group: usize| if turned[group] == Some(true) { -1.0 } else { 1.0 };
        let way = match enclosed(mesh, &groups, &part, sign) {
            Some(volume) => volume,
            None => {
                let has = |which: &[bool]| part.iter().any(|group| which[*group]);
                found.at_crowded_edges += if has(&is_at_crowd) && !has(&is_open) { part.len() } else { 0 };
                kept_side(mesh, &groups, &part, sign)
            }
        };
        if way < 0.0 {
            part.iter().for_each(|group| turned[*group] = turned[*group].map(|is| !is));
        }
    }
    for (facet, group) in group_of.iter().enumerate() {
        if turned[*group as usize] == Some(true) {
            mesh.facets[facet].swap(1, 2);
            if let Some(uv) = mesh.uv.get_mut(facet) {
                uv.swap(1, 2);
            }
            found.facets += 1;
        }
    }
    found
}

/// Facets by their three vertices, in the order of the first of each, and the group of each facet.
fn groups(mesh: &Mesh) -> (Vec<Group>, Vec<u32>) {
    let sorted = |facet: usize| {
        let mut corners = mesh.facets[facet];
        corners.sort_unstable();
        (corners, facet)
    };
    let mut order: Vec<([u32; 3], usize)> = (0..mesh.facets.len()).map(sorted).collect();
    order.sort_unstable();
    let mut first_of = vec![0; mesh.facets.len()];
    for alike in order.chunk_by(|a, b| a.0 == b.0) {
        alike.iter().for_each(|(_, facet)| first_of[*facet] = alike[0].1);
    }
    let mut groups: Vec<Group> = Vec::with_capacity(mesh.facets.len());
    let mut group_of: Vec<u32> = Vec::with_capacity(mesh.facets.len());
    for (facet, first) in first_of.into_iter().enumerate() {
        if facet == first {
            group_of.push(index_u32(groups.len()));
            groups.push(Group { facet, same_way: 1.0 });
            continue;
        }
        let [a, b, c] = mesh.facets[first];
        let is_same_way = [[a, b, c], [b, c, a], [c, a, b]].contains(&mesh.facets[facet]);
        let group = group_of[first];
        groups[group as usize].same_way += if is_same_way { 1.0 } else { -1.0 };
        group_of.push(group);
    }
    (groups, group_of)
}

/// Six times the volume within a part whose groups count as `sign` says, m3: below 0 if they face inwards. `None` for a sheet.
fn enclosed(mesh: &Mesh, groups: &[Group], part: &[usize], sign: impl Fn(usize) -> f64) -> Option<f64> {
    // About the middle of its area: of what is closed any point would do, and of what has holes it is as if seen from there.
    let (mut middle, mut area, mut open) = (DVec3::ZERO, 0.0, DVec3::ZERO);
    for group in part {
        let of = mesh.facet(groups[*group].facet);
        middle += of.area_m2() * of.centroid_m();
        area += of.area_m2();
        open += sign(*group) * 0.5 * of.cross_m2();
    }
    // The normals of what is closed, times areas, add up to 0; of what has holes, to those of lids on them.
    if open.length() > HOLES * area {
        return None;
    }
    middle /= area;
    let mut volume = 0.0;
    for group in part {
        let [a, b, c] = mesh.facet(groups[*group].facet).corners_m.map(|corner| corner - middle);
        volume += sign(*group) * a.dot(b.cross(c));
    }
    (volume.abs() > NO_VOLUME * area * area.sqrt()).then_some(volume)
}

/// Above 0 if a sheet whose groups count as `sign` says has the side that it keeps.
fn kept_side(mesh: &Mesh, groups: &[Group], part: &[usize], sign: impl Fn(usize) -> f64) -> f64 {
    let (mut as_it_is, mut area, mut facing) = (0.0, 0.0, DVec3::ZERO);
    for group in part {
        let Group { facet, same_way } = groups[*group];
        let of = mesh.facet(facet);
        as_it_is += sign(*group) * same_way * of.area_m2();
        area += of.area_m2();
        facing += sign(*group) * 0.5 * of.cross_m2();
    }
    if as_it_is.abs() > TIE * area {
        return as_it_is;
    }
    // Of a sheet that is there with both its sides nothing is to be turned.
    let both_sides = part.iter().all(|group| groups[*group].same_way == 0.0);
    let clear = |along: &f64| !both_sides && along.abs() > TIE * area;
    [facing.z, facing.y, facing.x].into_iter().find(clear).unwrap_or(0.0)
}
