//! Which extensions are read, which say nothing of geometry, and which cannot be ignored.

use std::collections::BTreeSet;

use crate::error::{Error, Result};

use super::accessor::Data;
use super::json::Extensions;

/// Instances of a node's mesh.
pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";
/// Lamps.
pub(super) const LIGHTS: &str = "KHR_lights_punctual";
/// Nodes that are hidden.
pub(super) const VISIBILITY: &str = "KHR_node_visibility";
/// Colours in the stead of `baseColorFactor`.
pub(super) const SPECULAR: &str = "KHR_materials_pbrSpecularGlossiness";

/// What is read. `KHR_mesh_quantization` allows integers for positions and normals, and has no other mark.
const READ: [&str; 5] = ["KHR_mesh_quantization", INSTANCING, LIGHTS, VISIBILITY, SPECULAR];

/// Compressed geometry, which may have plain geometry beside it.
const COMPRESSION: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// What changes how things look, move or are used, and leaves every triangle at rest where it is: beginnings of names.
const HARMLESS: [&str; 38] = [
    "ADOBE_materials_",
    "AGI_articulations",
    "AGI_stk_metadata",
    "CESIUM_primitive_outline",
    "EXT_feature_metadata",
    "EXT_instance_features",
    "EXT_lights_",
    "EXT_materials_",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "EXT_texture_",
    "FB_geometry_metadata",
    "FB_ngon_encoding",
    "GODOT_single_root",
    "KHR_animation_",
    "KHR_audio",
    "KHR_collision_shapes",
    "KHR_environment_map",
    "KHR_implicit_shapes",
    "KHR_interactivity",
    "KHR_lights_",
    "KHR_materials_",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_rigid_bodies",
    "KHR_techniques_webgl",
    "KHR_texture_",
    "KHR_xmp",
    "MOZ_hubs_components",
    "MSFT_lod",
    "MSFT_packing_",
    "MSFT_texture_dds",
    "NEEDLE_",
    "NV_materials_",
    "OMI_",
    "VRM",
    "XMP",
];

fn is_harmless(name: &str) -> bool {
    HARMLESS.iter().any(|beginning| name.starts_with(beginning))
}

/// Refuses what may put triangles elsewhere than the rest of the file has them, also where the file calls that optional.
///
/// # Errors
/// [`Error::Unsupported`] at the extension.
pub(super) fn known(data: &Data<'_>) -> Result<()> {
    let root = &data.root;
    let refused = |item: String, feature: String| Err(Error::Unsupported { at: data.at(item), feature });
    for (i, name) in root.extensions_required.iter().enumerate() {
        let item = format!("extensionsRequired[{i}]");
        if COMPRESSION.contains(&name.as_str()) {
            return refused(item, compressed(&format!("the required extension {name}")));
        }
        if !READ.contains(&name.as_str()) && !is_harmless(name) {
            return refused(item, format!("the required extension {name}"));
        }
    }
    let is_known = |name: &str| READ.contains(&name) || COMPRESSION.contains(&name) || is_harmless(name);
    let doubtful = |name: &str| {
        format!("the extension {name}, which may move or add geometry (if it does not, take it out of the file),")
    };
    for (item, extensions) in of_geometry(data) {
        if let Some(name) = extensions.keys().find(|name| !is_known(name)) {
            return refused(format!("{item}.extensions.{name}").trim_start_matches('.').into(), doubtful(name));
        }
    }
    // What only surfaces and pictures have moves nothing; what is found nowhere may change the meaning of all, as quantization does.
    let of_surfaces: BTreeSet<&String> =
        root.materials.iter().flat_map(|material| material.extensions.keys()).collect();
    let unknown = |(_, name): &(usize, &String)| !is_known(name) && !of_surfaces.contains(*name);
    match root.extensions_used.iter().enumerate().find(unknown) {
        Some((i, name)) => refused(format!("extensionsUsed[{i}]"), doubtful(name)),
        None => Ok(()),
    }
}

/// What says that geometry is compressed, and what to do.
pub(super) fn compressed(what: &str) -> String {
    format!("{what}: the geometry is compressed (export it without compression), which")
}

/// The compression that an object asks for.
pub(super) fn compression(extensions: &Extensions) -> Option<&'static str> {
    COMPRESSION.into_iter().find(|name| extensions.contains_key(*name))
}

/// Names in `extensionsUsed` that are not read, with their places.
pub(super) fn dropped<'a>(data: &'a Data<'_>) -> impl Iterator<Item = (usize, &'a String)> {
    let is_lost =
        |(_, name): &(usize, &String)| !READ.contains(&name.as_str()) && !COMPRESSION.contains(&name.as_str());
    data.root.extensions_used.iter().enumerate().filter(is_lost)
}

/// The extensions of all that geometry is made of.
fn of_geometry<'a>(data: &'a Data<'_>) -> impl Iterator<Item = (String, &'a Extensions)> {
    fn all<'a, T>(
        name: &'static str,
        list: &'a [T],
        of: impl Fn(&'a T) -> &'a Extensions + 'a,
    ) -> impl Iterator<Item = (String, &'a Extensions)> {
        let some = list.iter().map(of).enumerate().filter(|(_, extensions)| !extensions.is_empty());
        some.map(move |(i, extensions)| (format!("{name}[{i}]"), extensions))
    }
    let root = &data.root;
    let primitives = root.meshes.iter().enumerate().flat_map(|(i, mesh)| {
        let of_mesh = move |(k, extensions)| (format!("meshes[{i}].primitives[{k}]"), extensions);
        mesh.primitives.iter().map(|p| &p.extensions).enumerate().map(of_mesh)
    });
    std::iter::once((String::new(), &root.extensions))
        .chain(all("scenes", &root.scenes, |x| &x.extensions))
        .chain(all("nodes", &root.nodes, |x| &x.extensions))
        .chain(all("meshes", &root.meshes, |x| &x.extensions))
        .chain(primitives)
        .chain(all("accessors", &root.accessors, |x| &x.extensions))
        .chain(all("bufferViews", &root.buffer_views, |x| &x.extensions))
        .chain(all("buffers", &root.buffers, |x| &x.extensions))
}
