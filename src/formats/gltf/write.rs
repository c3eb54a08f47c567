//! Writing glTF: one mesh, one primitive for each material, positions in f32 with what that leaves in an attribute beside them, texture coordinates. A mesh
//! far from its origin is moved there by its node.

use std::collections::BTreeMap;

use glam::DVec3;
use serde_json::{Value, json};

use crate::error::{Error, Location, Result};
use crate::formats::mesh_file::ColouredMesh;
use crate::formats::number::single;
use crate::geometry::{Mesh, index_u32};

use super::RESIDUAL;
use crate::formats::marks::GLB;

/// A mesh as glTF: its JSON but for the buffer, the buffer, and what f32 alone loses.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoded {
    json: Value,
    binary: Vec<u8>,
    /// The farthest that a vertex is from where its f32 position puts it, m.
    pub largest_error_m: f64,
    /// The farthest that a texture coordinate is from its f32, in images.
    pub largest_uv_error: f64,
}

/// Encodes a mesh. Vertices keep their order, and are followed by those that differ in texture coordinates alone; facets are sorted by material, and keep their order
/// within one.
///
/// # Errors
/// [`Error::Invalid`] if there are no facets, if a position is beyond f32, or if the buffer would be 4 GiB or more.
pub fn encode(surface: &ColouredMesh) -> Result<Encoded> {
    let (split, uv) = split_by_uv(&surface.mesh);
    let mesh = split.as_ref().unwrap_or(&surface.mesh);
    let wrong = |message: &str| Err(Error::invalid(Location::item("mesh"), message));
    if mesh.facets.is_empty() {
        return wrong("has no facets");
    }
    let mut binary = Vec::new();
    let mut views = Vec::new();
    let mut view = |binary: &Vec<u8>, from: usize, target: u32| {
        views.push(json!({ "buffer": 0, "byteOffset": from, "byteLength": binary.len() - from, "target": target }));
        views.len() - 1
    };
    const VERTICES: u32 = 34962;
    const INDICES: u32 = 34963;
    const U32: u32 = 5125;
    const F32: u32 = 5126;

    let mut accessors = Vec::new();
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    let mut largest_error_m = 0.0_f64;
    let mut residuals = Vec::with_capacity(12 * mesh.vertices_m.len());
    let translation = middle(surface);
    for &v in &mesh.vertices_m {
        let v = y_up(v) - translation;
        let rounded = v.to_array().map(single);
        if rounded.iter().any(|c| !c.is_finite()) {
            return wrong("a position is beyond f32");
        }
        let left = v - DVec3::from_array(rounded.map(f64::from));
        largest_error_m = largest_error_m.max(left.length());
        for i in 0..3 {
            low[i] = low[i].min(rounded[i]);
            high[i] = high[i].max(rounded[i]);
            binary.extend_from_slice(&rounded[i].to_le_bytes());
            residuals.extend_from_slice(&single(left[i]).to_le_bytes());
        }
    }
    let count = mesh.vertices_m.len();
    let positions = json!({
        "bufferView": view(&binary, 0, VERTICES), "componentType": F32, "type": "VEC3", "count": count, "min": low, "max": high,
    });
    accessors.push(positions);
    let mut attributes = json!({ "POSITION": 0 });
    if largest_error_m > 0.0 {
        let from = binary.len();
        binary.append(&mut residuals);
        let view = view(&binary, from, VERTICES);
        attributes[RESIDUAL] = json!(accessors.len());
        accessors.push(json!({ "bufferView": view, "componentType": F32, "type": "VEC3", "count": count }));
    }
    let mut with_uv = attributes.clone();
    let rounded = |x: &f64| f64::from(single(*x));
    if uv.iter().flatten().any(|x| !rounded(x).is_finite()) {
        return wrong("a texture coordinate is beyond f32");
    }
    let largest_uv_error = uv.iter().flatten().map(|x| (x - rounded(x)).abs()).fold(0.0, f64::max);
    if !uv.is_empty() {
        let from = binary.len();
        uv.iter().flatten().for_each(|x| binary.extend_from_slice(&single(*x).to_le_bytes()));
        let view = view(&binary, from, VERTICES);
        with_uv["TEXCOORD_0"] = json!(accessors.len());
        accessors.push(json!({ "bufferView": view, "componentType": F32, "type": "VEC2", "count": count }));
    }
    let mut primitives = Vec::new();
    let mut of_material: Vec<Vec<u32>> = vec![Vec::new(); surface.materials.len()];
    // A material of which no facet has any comes back without.
    let mut has_uv = vec![false; surface.materials.len()];
    for (material, corners) in mesh.material.iter().zip(&mesh.uv) {
        if let Some(has) = has_uv.get_mut(usize::from(material.0)) {
            *has |= corners.iter().flatten().all(|x| x.is_finite());
        }
    }
    for (facet, material) in mesh.facets.iter().zip(&mesh.material) {
        match of_material.get_mut(usize::from(material.0)) {
            Some(list) => list.extend_from_slice(facet),
            None => return wrong("a facet has no material"),
        }
    }
    for (material, corners) in of_material.iter().enumerate().filter(|(_, corners)| !corners.is_empty()) {
        let from = binary.len();
        corners.iter().for_each(|v| binary.extend_from_slice(&v.to_le_bytes()));
        let view = view(&binary, from, INDICES);
        let attributes = if has_uv[material] { &with_uv } else { &attributes };
        primitives.push(json!({ "attributes": attributes, "indices": accessors.len(), "material": material }));
        accessors.push(json!({ "bufferView": view, "componentType": U32, "type": "SCALAR", "count": corners.len() }));
    }
    if u32::try_from(binary.len() + (1 << 20)).is_err() {
        return wrong("is too large for glTF, whose files end at 4 GiB");
    }
    let materials: Vec<Value> = surface
        .materials
        .iter()
        .map(|material| {
            // Rough and no metal: the nearest that glTF has to a Lambert surface.
            let mut pbr = json!({ "metallicFactor": 0, "roughnessFactor": 1 });
            if let Some([r, g, b]) = material.kd {
                pbr["baseColorFactor"] = json!([r, g, b, 1]);
            }
            let extras = json!({ "spectral_material": material.name });
            json!({ "name": material.name, "pbrMetallicRoughness": pbr, "extras": extras })
        })
        .collect();
    let mut scene = json!({ "nodes": [0] });
    if let Some(origin_m) = surface.origin_m {
        scene["extras"] = json!({ "origin_m": origin_m.to_array() });
    }
    let mut node = json!({ "name": "surface", "mesh": 0 });
    if translation != DVec3::ZERO {
        node["translation"] = json!(translation.to_array());
    }
    let json = json!({
        "asset": { "version": "2.0", "generator": concat!("mmxrt ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [scene],
        "nodes": [node],
        "meshes": [{ "name": "surface", "primitives": primitives }],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
    });
    Ok(Encoded { json, binary, largest_error_m, largest_uv_error })
}

impl Encoded {
    /// The bytes of a `.glb`.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.with_buffer(None).into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let padded = self.binary.len().next_multiple_of(4);
        let mut bytes = Vec::with_capacity(28 + json.len() + padded);
        // `encode` has seen to it that lengths fit.
        let push = |bytes: &mut Vec<u8>, n: usize| bytes.extend(u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes());
        bytes.extend_from_slice(GLB);
        push(&mut bytes, 2);
        push(&mut bytes, 28 + json.len() + padded);
        push(&mut bytes, json.len());
        bytes.extend_from_slice(b"JSON");
        bytes.append(&mut json);
        push(&mut bytes, padded);
        bytes.extend_from_slice(b"BIN\0");
        bytes.extend_from_slice(&self.binary);
        bytes.resize(bytes.len() + padded - self.binary.len(), 0);
        bytes
    }

    /// The text of a `.gltf`, and its buffer, which will stand beside it in a file `name`.
    pub fn gltf(&self, name: &str) -> (String, &[u8]) {
        (self.with_buffer(Some(name)), &self.binary)
    }

    fn with_buffer(&self, name: Option<&str>) -> String {
        let mut json = self.json.clone();
        let mut buffer = json!({ "byteLength": self.binary.len() });
        if let Some(name) = name {
            let plain = |b: u8| b.is_ascii_alphanumeric() || b"-._~".contains(&b);
            let uri = name.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") });
            buffer["uri"] = json!(uri.collect::<String>());
        }
        json["buffers"] = json!([buffer]);
        json.to_string()
    }
}

/// A mesh with a vertex for each texture coordinate that corners at one place have, and each vertex's coordinates, v down, 0 where a facet has none. Vertices keep
/// their order, and those that are added come last. The mesh is `None` if none are, and there are no coordinates if the mesh has none.
fn split_by_uv(mesh: &Mesh) -> (Option<Mesh>, Vec<[f64; 2]>) {
    if mesh.uv.len() != mesh.facets.len() || mesh.uv.is_empty() {
        return (None, Vec::new());
    }
    let mut uv: Vec<Option<[f64; 2]>> = vec![None; mesh.vertices_m.len()];
    let mut more: BTreeMap<(u32, [u64; 2]), u32> = BTreeMap::new();
    let mut split = mesh.clone();
    for (facet, corners) in split.facets.iter_mut().zip(&mesh.uv) {
        for (vertex, [u, v]) in facet.iter_mut().zip(corners) {
            let own = if u.is_finite() && v.is_finite() { [*u, 1.0 - v] } else { [0.0; 2] };
            let first = *uv[*vertex as usize].get_or_insert(own);
            if first == own {
                continue;
            }
            *vertex = *more.entry((*vertex, own.map(f64::to_bits))).or_insert_with(|| {
                split.vertices_m.push(mesh.vertices_m[*vertex as usize]);
                uv.push(Some(own));
                index_u32(uv.len() - 1)
            });
        }
    }
    let uv = uv.into_iter().map(Option::unwrap_or_default).collect();
    ((!more.is_empty()).then_some(split), uv)
}

/// The middle of a mesh that is farther from its origin than it is large, in glTF's axes and to f32, so that no reader rounds it; else 0.
fn middle(surface: &ColouredMesh) -> DVec3 {
    let (low, high) = surface.mesh.bounds_m().unwrap_or_default();
    let middle = y_up(0.5 * (low + high));
    let is_far = middle.abs().max_element() > (high - low).max_element();
    if is_far { DVec3::from_array(middle.to_array().map(|c| f64::from(single(c)))) } else { DVec3::ZERO }
}

/// glTF's axes from ours.
fn y_up(v: DVec3) -> DVec3 {
    DVec3::new(v.x, v.z, -v.y)
}
