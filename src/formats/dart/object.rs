//! Where an object's facets are in a simulation's frame.

use glam::DVec3;

use crate::formats::obj::ObjFile;
use crate::geometry::{Mesh, index_u32};

use super::simulation::{FieldInstance, Object, Version};
use super::{frame, groups};

/// The facets of an object's file that no hidden group owns: DART ignores those.
pub(super) fn seen_facets(object: &Object, obj: &ObjFile, version: &Version) -> Vec<usize> {
    let numbered = groups::order(&obj.groups, version);
    let mut is_hidden = vec![false; obj.groups.len()];
    for group in object.groups.iter().filter(|group| group.hidden) {
        if let Some(i) = (group.number as usize).checked_sub(1).and_then(|n| numbered.get(n)) {
            is_hidden[*i] = true;
        }
    }
    let is_seen = |f: &usize| obj.facet_group.get(*f).is_none_or(|group| !is_hidden[*group as usize]);
    (0..obj.facets.len()).filter(is_seen).collect()
}

/// These facets of an object's file in the simulation's frame, m, at this place, before anything is dropped to the ground; without
/// materials. Outside stays outside where a scale mirrors.
pub(super) fn standing(place: &FieldInstance, obj: &ObjFile, facets: &[usize]) -> Mesh {
    let FieldInstance { position_m, scale, rotation_deg, .. } = *place;
    let turned = frame::object_rotation(rotation_deg);
    let is_turned = rotation_deg != DVec3::ZERO;
    let placed = |vertex: &DVec3| {
        let v = scale * frame::dart_from_obj(*vertex);
        position_m + if is_turned { turned * v } else { v }
    };
    let mut mesh = Mesh {
        vertices_m: obj.vertices.iter().map(placed).collect(),
        facets: facets.iter().map(|f| obj.facets[*f]).collect(),
        material: vec![],
        face_of_facet: match obj.face_of_facet.is_empty() && facets.len() == obj.facets.len() {
            true => vec![],
            false => facets.iter().map(|f| obj.face_of_facet.get(*f).copied().unwrap_or(index_u32(*f))).collect(),
        },
        uv: vec![],
    };
    if scale.x * scale.y * scale.z < 0.0 {
        mesh.flip();
    }
    mesh
}

/// Whether DART leaves out what a field has at this place, in a scene of this size, m.
pub(super) fn is_outside(place: &FieldInstance, [x, y]: [f64; 2]) -> bool {
    !((0.0..=x).contains(&place.position_m.x) && (0.0..=y).contains(&place.position_m.y))
}

/// Whether what spans this, m, reaches beyond the edges of a scene of this size, m.
pub(super) fn reaches_beyond((low_m, high_m): (DVec3, DVec3), [x, y]: [f64; 2]) -> bool {
    // Rounding of a turn is not a reach.
    let slack_m = 1e-9 * x.max(y);
    !(low_m.x >= -slack_m && low_m.y >= -slack_m && high_m.x <= x + slack_m && high_m.y <= y + slack_m)
}
