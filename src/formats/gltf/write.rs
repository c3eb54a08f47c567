//! Writing glTF: one mesh, one primitive for each material, positions in f32 with what that leaves in an attribute beside them. A mesh
//! far from its origin is moved there by its node.

use glam::DVec3;
use serde_json::{Value, json};

use crate::error::{Error, Location, Result};
use crate::formats::mesh_file::ColouredMesh;
use crate::formats::number::single;

use super::RESIDUAL;
use crate::formats::marks::GLB;

/// A mesh as glTF: its JSON but for the buffer, the buffer, and what f32 alone loses.
#[derive(Debug, Clone, PartialEq)]
pub struct Encoded {
    json: Value,
    binary: Vec<u8>,
    /// The farthest that a vertex is from where its f32 position puts it, m.
    pub largest_error_m: f64,
}

/// Encodes a mesh. Vertices keep their order; facets are sorted by material, and keep their order within one.
///
/// # Errors
/// [`Error::Invalid`] if there are no facets, if a position is beyond f32, or if the buffer would be 4 GiB or more.
pub fn encode(surface: &ColouredMesh) -> Result<Encoded> {
    let mesh = &surface.mesh;
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
    let mut primitives = Vec::new();
    let mut of_material: Vec<Vec<u32>> = vec![Vec::new(); surface.materials.len()];
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
    Ok(Encoded { json, binary, largest_error_m })
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
