//! A mesh as columns.

use glam::DVec3;

use super::entry::Packed;
use crate::geometry::{MaterialId, Mesh};

/// Three numbers of eight bytes, or of four.
type Eights = [u8; 24];
type Fours = [u8; 12];

/// Adds a mesh.
pub(super) fn put(packed: &mut Packed, mesh: &Mesh) {
    packed.put(vertices(mesh));
    packed.put(facets(mesh));
    packed.put(mesh.material.iter().map(|material| material.0.to_le_bytes()));
    packed.put(mesh.face_of_facet.iter().map(|face| face.to_le_bytes()));
    packed.put(mesh.uv.iter().flatten().flatten().map(|number| number.to_le_bytes()));
}

/// Takes a mesh, whose facets are of its vertices, each with all that facets have.
pub(super) fn take(packed: &mut Packed) -> Option<Mesh> {
    let vertices_m = packed.take(vertex)?;
    let facets = packed.take(|of: Fours| threes(of, u32::from_le_bytes))?;
    let material = packed.take(|of| MaterialId(u16::from_le_bytes(of)))?;
    let face_of_facet = packed.take(u32::from_le_bytes)?;
    let uv: Vec<f64> = packed.take(f64::from_le_bytes)?;
    let (uv, rest) = uv.as_chunks::<6>();
    let uv: Vec<[[f64; 2]; 3]> = uv.iter().map(|[a, b, c, d, e, f]| [[*a, *b], [*c, *d], [*e, *f]]).collect();
    let count = facets.len();
    let is_whole = rest.is_empty()
        && material.len() == count
        && [0, count].contains(&face_of_facet.len())
        && [0, count].contains(&uv.len())
        && facets.iter().flatten().all(|v| (*v as usize) < vertices_m.len());
    is_whole.then_some(Mesh { vertices_m, facets, material, face_of_facet, uv })
}

pub(super) fn vertices(mesh: &Mesh) -> impl Iterator<Item = Eights> {
    mesh.vertices_m.iter().map(|vertex| {
        let mut bytes = [0; 24];
        for (of, number) in bytes.as_chunks_mut::<8>().0.iter_mut().zip(vertex.to_array()) {
            *of = number.to_le_bytes();
        }
        bytes
    })
}

pub(super) fn facets(mesh: &Mesh) -> impl Iterator<Item = Fours> {
    mesh.facets.iter().map(|facet| three_bytes(*facet))
}

pub(super) fn three_bytes(numbers: [u32; 3]) -> Fours {
    let mut bytes = [0; 12];
    for (of, number) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(numbers) {
        *of = number.to_le_bytes();
    }
    bytes
}

pub(super) fn vertex(bytes: Eights) -> DVec3 {
    DVec3::from_array(threes(bytes, f64::from_le_bytes))
}

/// Three numbers of `N` bytes each.
pub(super) fn threes<const ALL: usize, const N: usize, T: Copy + Default>(
    bytes: [u8; ALL],
    number: impl Fn([u8; N]) -> T,
) -> [T; 3] {
    let mut numbers = [T::default(); 3];
    for (of, bytes) in numbers.iter_mut().zip(bytes.as_chunks::<N>().0) {
        *of = number(*bytes);
    }
    numbers
}
