//! glTF: files made by hand, what comes back of our own, another reader's opinion, and damaged files.

use std::path::PathBuf;

use glam::DVec3;
use mmxrt::formats::gltf::{encode, read};
use mmxrt::formats::mesh_file::ColouredMesh;
use mmxrt::formats::mtl::ObjMaterial;
use mmxrt::formats::registry;
use mmxrt::geometry::{MaterialId, Mesh, NO_UV};
use mmxrt::report::{Fate, Report};
use serde_json::{Value, json};

use crate::scratch::Scratch;

pub(crate) fn f32s(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn u16s(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A unit square in the plane z = 0 of glTF, seen from +z, in a file and its buffer: positions at byte 0, six indices at byte 48.
pub(crate) fn quad() -> (Value, Vec<u8>) {
    let mut binary = f32s(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    binary.extend(u16s(&[0, 1, 2, 0, 2, 3]));
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "materials": [{ "name": "grey", "pbrMetallicRoughness": { "baseColorFactor": [0.25, 0.25, 0.25, 1.0] } }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4, "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6 },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 12 },
        ],
        "buffers": [{ "byteLength": 60, "uri": "quad.bin" }],
    });
    (json, binary)
}

pub(crate) struct Folder(pub(crate) Scratch);

impl Folder {
    pub(crate) fn new() -> Self {
        Folder(Scratch::new())
    }

    pub(crate) fn put(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    pub(crate) fn read(&self, json: &Value, binary: &[u8]) -> mmxrt::Result<(ColouredMesh, Report)> {
        self.put("quad.bin", binary);
        let path = self.put("quad.gltf", json.to_string().as_bytes());
        read(&path, false).map(|(surface, report, _)| (surface, report))
    }
}

fn glb(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    let total = 28 + text.len() + binary.len();
    for n in [2, total, text.len()] {
        bytes.extend((n as u32).to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(&text);
    bytes.extend((binary.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(binary);
    bytes
}

pub(crate) fn corners(surface: &ColouredMesh) -> Vec<[[f64; 3]; 3]> {
    let mesh = &surface.mesh;
    (0..mesh.facets.len()).map(|f| mesh.facet(f).corners_m.map(|c| c.to_array())).collect()
}

#[test]
fn a_quad_stands_upright() {
    let folder = Folder::new();
    let (json, binary) = quad();
    let (surface, report) = folder.read(&json, &binary).unwrap();
    // glTF's y is our z, its z, towards which the square faces, our -y.
    let expected = [[[0., 0., 0.], [1., 0., 0.], [1., 0., 1.]], [[0., 0., 0.], [1., 0., 1.], [0., 0., 1.]]];
    assert_eq!(corners(&surface), expected);
    assert_eq!(surface.mesh.facet(0).normal(), DVec3::NEG_Y);
    assert_eq!(surface.materials, [ObjMaterial { name: "grey".into(), kd: Some([0.25; 3]) }]);
    assert_eq!((surface.origin_m, report.notes.len()), (None, 0));
    // The same as a GLB, and with the buffer in the text.
    let mut binary_json = json.clone();
    binary_json["buffers"] = json!([{ "byteLength": 60 }]);
    let path = folder.put("quad.glb", &glb(&binary_json, &binary));
    assert_eq!(read(&path, false).unwrap().0, surface);
    // They are told by what they hold, whatever they are called.
    let named_x = folder.put("binary.x", &glb(&binary_json, &binary));
    let text = folder.put("text.x", json.to_string().as_bytes());
    assert_eq!([named_x, text].map(|path| registry::of_input(&path).unwrap().0.name), ["glb", "gltf"]);
    // A file that many buffers name is read once.
    let mut many = json.clone();
    many["buffers"] = vec![json["buffers"][0].clone(); 1000].into();
    many["bufferViews"][1]["buffer"] = json!(999);
    let path = folder.put("many.gltf", many.to_string().as_bytes());
    let (found, _, inputs) = read(&path, false).unwrap();
    assert!(found == surface && inputs.len() == 2, "{inputs:?}");
    let digits: Vec<char> = ('A'..='Z').chain('a'..='z').chain('0'..='9').chain(['+', '/']).collect();
    let sixes = binary.chunks(3).flat_map(|c| {
        let n = u32::from(c[0]) << 16 | u32::from(c[1]) << 8 | u32::from(c[2]);
        [n >> 18, n >> 12 & 63, n >> 6 & 63, n & 63]
    });
    let text: String = sixes.map(|six| digits[six as usize]).collect();
    let mut inline = json;
    inline["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{text}"));
    assert_eq!(folder.read(&inline, &[]).unwrap().0, surface);
}

#[test]
fn transforms_compose_in_f64_and_a_mirror_turns_facets() {
    let folder = Folder::new();
    let (mut json, binary) = quad();
    // A quarter turn about y (z to x), doubled, moved by more than f32 holds; within a parent that mirrors x.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    json["nodes"] = json!([
        { "children": [1], "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] },
        { "mesh": 0, "translation": [9376123.4567, 0, 0.125], "rotation": [0, half, 0, half], "scale": [2, 2, 2] },
    ]);
    let (surface, _) = folder.read(&json, &binary).unwrap();
    // (1, 1, 0): doubled (2, 2, 0), turned (0, 2, -2), moved (9376123.4567, 2, -1.875), mirrored, and z up.
    let at = |v: usize| surface.mesh.vertices_m[v];
    assert!((at(2) - DVec3::new(-9376123.4567, 1.875, 2.0)).length() < 2e-9, "{}", at(2));
    assert!((at(0) - DVec3::new(-9376123.4567, -0.125, 0.0)).length() < 2e-9);
    // The square faced z, after the turn x, after the mirror -x: its corners are still counter-clockwise from there.
    assert_eq!(surface.mesh.facets[0], [0, 2, 1]);
    assert!((surface.mesh.facet(0).normal() - DVec3::NEG_X).length() < 1e-12);
}

#[test]
fn strips_fans_and_bare_lists_are_triangles() {
    let folder = Folder::new();
    let (mut json, binary) = quad();
    json["meshes"][0]["primitives"][0]["indices"] = Value::Null;
    json["meshes"][0]["primitives"][0]["mode"] = json!(5);
    // In the order 0 1 2 3 a strip is 012 and 213 turned: 2 1 3.
    assert_eq!(folder.read(&json, &binary).unwrap().0.mesh.facets, [[0, 1, 2], [2, 1, 3]]);
    json["meshes"][0]["primitives"][0]["mode"] = json!(6);
    assert_eq!(folder.read(&json, &binary).unwrap().0.mesh.facets, [[1, 2, 0], [2, 3, 0]]);
    json["meshes"][0]["primitives"][0]["mode"] = json!(4);
    let error = folder.read(&json, &binary).unwrap_err().to_string();
    assert!(error.ends_with("meshes[0].primitives[0]: 4 corners do not make triangles"), "{error}");
    // Lines have no surface, and say so.
    let triangles = quad().0["meshes"][0]["primitives"][0].clone();
    json["meshes"][0]["primitives"] = json!([{ "attributes": { "POSITION": 0 }, "mode": 3 }, triangles]);
    let (surface, report) = folder.read(&json, &binary).unwrap();
    assert_eq!((surface.mesh.facets.len(), report.notes.len()), (2, 1));
    assert_eq!(report.notes[0].fate, Fate::Dropped);
}

#[test]
fn sparse_accessors_replace_elements() {
    let folder = Folder::new();
    let (mut json, mut binary) = quad();
    binary.extend(u16s(&[2, 0]));
    binary.extend(f32s(&[5.0, 6.0, 7.0]));
    json["buffers"][0]["byteLength"] = json!(76);
    json["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 0, "byteOffset": 60, "byteLength": 2 }));
    json["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 0, "byteOffset": 64, "byteLength": 12 }));
    json["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": { "bufferView": 2, "componentType": 5123 }, "values": { "bufferView": 3 },
    });
    let (surface, _) = folder.read(&json, &binary).unwrap();
    assert_eq!(surface.mesh.vertices_m[2], DVec3::new(5.0, -7.0, 6.0));
    assert_eq!(surface.mesh.vertices_m[1], DVec3::X);
    // Without a view the rest is 0.
    json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let (surface, _) = folder.read(&json, &binary).unwrap();
    assert_eq!(surface.mesh.vertices_m, [DVec3::ZERO, DVec3::ZERO, DVec3::new(5.0, -7.0, 6.0), DVec3::ZERO]);
}

#[test]
fn colours_scenes_and_what_else_there_is() {
    let folder = Folder::new();
    let (mut json, mut binary) = quad();
    binary.extend([51, 102, 255, 255].repeat(4));
    json["buffers"][0]["byteLength"] = json!(76);
    json["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 0, "byteOffset": 60, "byteLength": 16 }));
    json["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "bufferView": 2, "componentType": 5121, "normalized": true, "type": "VEC4", "count": 4 }));
    json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(2);
    json["scenes"] = json!([{ "nodes": [0], "extras": { "origin_m": [1, 2.5, 9376123.4567] } }, { "nodes": [] }]);
    json["materials"][0]["extras"] = json!({ "spectral_material": "phobos_red" });
    json["materials"][0]["doubleSided"] = json!(true);
    let (surface, report) = folder.read(&json, &binary).unwrap();
    assert_eq!(surface.origin_m, Some(DVec3::new(1.0, 2.5, 9376123.4567)));
    // One colour for all vertices: it multiplies that of the material.
    assert_eq!(surface.materials[0], ObjMaterial { name: "phobos_red".into(), kd: Some([0.05, 0.1, 0.25]) });
    let items: Vec<_> = report.notes.iter().filter_map(|n| n.at.item.as_deref()).collect();
    assert_eq!(items, ["scenes[1]", "materials[0]"]);
    // Colours that differ have no place.
    binary[64] = 0;
    let (surface, report) = folder.read(&json, &binary).unwrap();
    assert_eq!(surface.materials[0].kd, Some([0.25; 3]));
    assert!(report.notes.iter().any(|n| n.message.contains("differ from vertex to vertex")));
}

/// A small landscape far from its origin, with three materials.
fn surface() -> ColouredMesh {
    let vertices_m: Vec<DVec3> = (0..16)
        .map(|i| {
            let (x, y) = (f64::from(i % 4), f64::from(i / 4));
            DVec3::new(11860.036 + 0.1 * x, -2743.5946 + y / 3.0, 0.51269 + (x * 7.0 + y * 3.0).sin())
        })
        .collect();
    let cell = |i: u32| i + i / 3;
    let facets: Vec<[u32; 3]> = (0..9).map(cell).flat_map(|a| [[a, a + 1, a + 5], [a, a + 5, a + 4]]).collect();
    let material = (0..18).map(|f| MaterialId(f % 3)).collect();
    let materials = ["a", "phobos blue", "#b03020"].map(|name| ObjMaterial { name: name.into(), kd: None });
    let mesh = Mesh { vertices_m, facets, material, face_of_facet: vec![], uv: vec![] };
    let origin_m = Some(DVec3::new(-2743.5946, 11860.036, 0.51269));
    ColouredMesh { mesh, materials: materials.to_vec(), origin_m, sun: None }
}

#[test]
fn residuals_bring_the_digits_back() {
    let folder = Folder::new();
    let surface = surface();
    let encoded = encode(&surface).unwrap();
    // f32 within some 3 m of the middle: half a step of 1.2e-7 m in each of three axes at most.
    assert!((1e-9..3e-7).contains(&encoded.largest_error_m), "{}", encoded.largest_error_m);
    let (text, buffer) = encoded.gltf("a b.bin");
    folder.put("a b.bin", buffer);
    for path in [folder.put("a.glb", &encoded.glb()), folder.put("a.gltf", text.as_bytes())] {
        let (back, report, inputs) = read(&path, false).unwrap();
        assert!(report.notes.is_empty(), "{:?}", report.notes);
        assert_eq!((back.origin_m, &back.materials), (surface.origin_m, &surface.materials));
        for (a, b) in back.mesh.vertices_m.iter().zip(&surface.mesh.vertices_m) {
            assert!((*a - *b).abs().max_element() <= 1e-14 * b.length(), "{a} {b}");
        }
        // The same facets, by material.
        let sorted = |surface: &ColouredMesh| {
            let mut all: Vec<_> = surface.mesh.material.iter().zip(&surface.mesh.facets).collect();
            all.sort_by_key(|(material, _)| **material);
            all.into_iter().map(|(m, f)| (*m, *f)).collect::<Vec<_>>()
        };
        assert_eq!(sorted(&back), sorted(&surface));
        assert_eq!(inputs.len(), if path.extension().unwrap() == "glb" { 1 } else { 2 });
    }
}

#[test]
fn another_reader_sees_the_same() {
    let surface = surface();
    let encoded = encode(&surface).unwrap();
    let ::gltf::Gltf { document, blob } = ::gltf::Gltf::from_slice(&encoded.glb()).unwrap();
    let blob = blob.unwrap();
    let mesh = document.meshes().next().unwrap();
    assert_eq!(mesh.primitives().len(), 3);
    // The mesh lies 12 km from its origin: the node has the way there.
    let (moved, ..) = document.nodes().next().unwrap().transform().decomposed();
    for primitive in mesh.primitives() {
        let reader = primitive.reader(|_| Some(&blob));
        let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        for (position, v) in positions.iter().zip(&surface.mesh.vertices_m) {
            let there = [0, 1, 2].map(|i| f64::from(moved[i]) + f64::from(position[i]));
            assert!((DVec3::from_array(there) - DVec3::new(v.x, v.z, -v.y)).length() < 3e-7, "{there:?} {v}");
        }
        let material = primitive.material().index().unwrap();
        assert_eq!(primitive.material().name(), Some(surface.materials[material].name.as_str()));
        let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        let mine = surface.mesh.facets.iter().zip(&surface.mesh.material);
        let mine: Vec<u32> = mine.filter(|(_, m)| usize::from(m.0) == material).flat_map(|(f, _)| *f).collect();
        assert_eq!(indices, mine);
        let bounds = primitive.bounding_box();
        assert!(positions.iter().all(|p| (0..3).all(|i| bounds.min[i] <= p[i] && p[i] <= bounds.max[i])));
    }
}

#[test]
fn damaged_files_are_told_where() {
    let folder = Folder::new();
    let cases: &[(&str, Value, &str)] = &[
        ("/asset", json!({}), "asset.version: is missing"),
        ("/asset/version", json!("1.0"), "asset.version: version 1.0 of glTF is not supported"),
        ("/extensionsRequired", json!(["KHR_draco_mesh_compression"]), "required extension KHR_draco_mesh_compression"),
        ("/scene", json!(3), "scene: scenes[3]: there are 1"),
        ("/scenes/0/nodes", json!([7]), "scenes[0].nodes: nodes[7]: there are 1"),
        ("/scenes/0/nodes", json!([0, 0]), "nodes[0]: is reached twice"),
        ("/nodes/0/children", json!([0]), "nodes[0]: is reached twice"),
        ("/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), "nodes[0].matrix: its last row"),
        ("/nodes/0/rotation", json!([0, 0, 0, 0]), "nodes[0].rotation: has no length"),
        ("/nodes/0/scale", json!([1e308, 1e308, 1e308]), ""),
        (
            "/nodes/0/matrix",
            json!([1e308, 0, 0, 0, 1e308, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
            "primitives[0]: its place in the scene is beyond all numbers",
        ),
        ("/nodes/0/mesh", json!(1), "nodes[0]: meshes[1]: there are 1"),
        ("/meshes/0/primitives/0/attributes", json!({}), "primitives[0].attributes: `POSITION` is missing"),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(9), "attributes.POSITION: accessors[9]: there are 2"),
        ("/meshes/0/primitives/0/attributes/_POSITION_RESIDUAL", json!(1), "accessors[1]: its type is \"SCALAR\""),
        ("/meshes/0/primitives/0/mode", json!(9), "primitives[0].mode: 9 is not a kind"),
        ("/meshes/0/primitives/0/material", json!(4), "primitives[0].material: materials[4]"),
        ("/meshes/0/primitives", json!([]), "meshes: the scene has no triangles"),
        (
            "/materials/0/pbrMetallicRoughness/baseColorFactor",
            json!([2, 0, 0, 1]),
            "baseColorFactor: is outside 0 to 1",
        ),
        ("/accessors/0/type", json!("VEC2"), "accessors[0]: its type is \"VEC2\", where VEC3 is expected"),
        ("/accessors/0/componentType", json!(5130), "accessors[0]: `componentType` 5130"),
        (
            "/accessors/0/count",
            json!(5),
            "accessors[0]: 5 elements of 12 bytes, 12 apart from byte 0: bufferViews[0] has 48",
        ),
        ("/accessors/0/count", json!(u64::MAX), "accessors[0]: 18446744073709551615 elements: at most"),
        ("/accessors/0/count", json!(3), "primitives[0].indices: vertex 3: there are 3"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "accessors[0]: 4 elements"),
        ("/accessors/0/bufferView", Value::Null, "accessors[0]: has neither `bufferView` nor `sparse`"),
        ("/accessors/0/sparse", json!({ "count": 9 }), "accessors[0].sparse: replaces 9 of 4"),
        (
            // 3 GB of zeros, of which the file holds none.
            "/accessors/0",
            json!({ "componentType": 5126, "type": "VEC3", "count": 1 << 27, "sparse": {
                "count": 0, "indices": { "bufferView": 0, "componentType": 5123 }, "values": { "bufferView": 0 },
            } }),
            "accessors[0]: 134217728 elements without a `bufferView`: all buffers have 60 bytes",
        ),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "bufferViews[0]: 48 bytes from byte 18446744073709551615"),
        ("/bufferViews/0/byteLength", json!(61), "bufferViews[0]: 61 bytes from byte 0: the buffer has 60"),
        ("/bufferViews/0/byteStride", json!(4), "bufferViews[0]: a `byteStride` of 4 for elements of 12 bytes"),
        ("/bufferViews/0/buffer", json!(2), "bufferViews[0]: buffers[2]: there are 1"),
        ("/buffers/0/byteLength", json!(61), "buffers[0]: `byteLength` 61, but there are 60 bytes"),
        ("/buffers/0/uri", Value::Null, "buffers[0]: has no `uri`"),
        ("/buffers/0/uri", json!("data:;base64,!"), "buffers[0]: its data are not base64"),
        ("/buffers/0/uri", json!("../quad.bin"), "buffers[0]: \"../quad.bin\" leads out of the folder"),
        ("/buffers/0/uri", json!("%2e%2e/quad.bin"), "buffers[0]: \"../quad.bin\" leads out of the folder"),
        ("/buffers/0/uri", json!("/etc/passwd"), "buffers[0]: \"/etc/passwd\" leads out of the folder"),
        ("/buffers/0/uri", json!("http://a.b/c"), "buffers[0]: \"http://a.b/c\" is an address"),
        ("/buffers/0/uri", json!("lost.bin"), "lost.bin, which it names, cannot be read: "),
        ("/nodes/0/mesh", json!("zero"), "quad.gltf:1:"),
        ("/scenes/0/extras", json!({ "origin_m": [1, 2] }), "scenes[0].extras.origin_m: is not three numbers"),
    ];
    for (pointer, value, told) in cases {
        let (mut json, binary) = quad();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        match json.pointer_mut(pointer) {
            Some(place) => *place = value.clone(),
            None => json.pointer_mut(parent).unwrap()[key] = value.clone(),
        }
        match folder.read(&json, &binary) {
            Ok(_) => assert!(told.is_empty(), "{pointer} = {value} is read"),
            Err(error) => {
                let error = error.to_string();
                assert!(
                    !told.is_empty() && error.contains(told) && error.contains("quad"),
                    "{pointer} = {value}: {error}"
                );
            }
        }
    }
    let (json, mut binary) = quad();
    binary[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = folder.read(&json, &binary).unwrap_err().to_string();
    assert!(error.ends_with("accessors[0]: position 0 is not finite"), "{error}");
}

#[test]
fn damaged_containers_are_told() {
    let folder = Folder::new();
    let (mut json, binary) = quad();
    json["buffers"] = json!([{ "byteLength": 60 }]);
    let good = glb(&json, &binary);
    let mut bad = vec![(good[..9].to_vec(), "ends within its header"), (good[..40].to_vec(), "is it cut short?")];
    for (at, value, told) in [
        (4, 1, "version 1 of GLB is not supported"),
        (8, 14, "a chunk's header is cut short at byte 12"),
        (12, u32::MAX, "reaches beyond the file's end"),
        (16, 0, "without a JSON chunk"),
    ] {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&u32::to_le_bytes(value));
        bad.push((bytes, told));
    }
    for (bytes, told) in bad {
        let error = read(&folder.put("bad.glb", &bytes), false).unwrap_err().to_string();
        assert!(error.contains("bad.glb") && error.contains(told), "{told}: {error}");
    }
    // No byte that is wrong leads to a panic.
    let mut outcomes = [0, 0];
    for i in 0..good.len() {
        for value in [0, b'9', 0xff] {
            let mut bytes = good.clone();
            bytes[i] = value;
            outcomes[usize::from(read(&folder.put("bad.glb", &bytes), false).is_ok())] += 1;
        }
    }
    assert!(outcomes[0] > 500 && outcomes[1] > 100, "{outcomes:?}");
}

#[test]
fn what_blender_exports_is_where_blender_has_it() {
    // Written by Blender 5.0: two objects below a parent at (10, 20, 30), turned by 90 deg about z and scaled by (2, 1, 3); the second
    // one below another parent, turned by 30 deg about x, and mirrored.
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/gltf/blender_5_0.gltf");
    let (surface, report, _) = read(&path, false).unwrap();
    let near = |a: DVec3, b: [f64; 3]| (a - DVec3::from_array(b)).length() < 2e-5;
    // By hand: (4, 0, 1) of the floor is scaled to (8, 0, 3), turned to (0, 8, 3) and moved to (10, 28, 33).
    let corner = |facet: usize, corner: usize| surface.mesh.facet(facet).corners_m[corner];
    let floor = [[10.0, 20.0, 33.0], [10.0, 28.0, 33.0], [8.0, 28.0, 33.0]];
    assert!((0..3).all(|i| near(corner(0, i), floor[i])), "{:?}", surface.mesh.facet(0));
    // As Blender's own matrix_world has them; the mirrored object faces outward all the same: its volume is positive, 1/3 x 2 x 3.
    let spike = [[12.5, 22.0, 42.99038], [13.0, 22.0, 45.588455], [13.366025, 22.0, 41.49038], [12.5, 18.0, 42.99038]];
    let all = || (3..7).flat_map(|f| surface.mesh.facet(f).corners_m);
    assert!(spike.iter().all(|s| all().any(|c| near(c, *s))) && all().all(|c| spike.iter().any(|s| near(c, *s))));
    let volume = |f: usize| {
        let [a, b, c] = surface.mesh.facet(f).corners_m;
        a.dot(b.cross(c)) / 6.0
    };
    assert!(((3..7).map(volume).sum::<f64>() - 2.0).abs() < 1e-5);
    let names: Vec<&str> = surface.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["dust & <rock>", "ice 1"]);
    assert_eq!(surface.mesh.material, [0, 0, 1, 1, 1, 1, 1].map(MaterialId));
    let told: Vec<String> =
        report.notes.iter().map(|n| format!("{} {}", n.at.item.as_deref().unwrap(), n.message)).collect();
    for expected in [
        "nodes[0].extras custom properties: albedo_note, x",
        "materials[0] its back",
        "materials[1] its back",
        "nodes which of 2 objects a triangle belongs to",
    ] {
        assert!(told.iter().any(|t| t.starts_with(expected)), "{expected}: {told:#?}");
    }
    assert_eq!(told.len(), 4, "{told:#?}");
}

#[test]
fn attributes_that_have_no_place_are_told() {
    let folder = Folder::new();
    let (mut json, binary) = quad();
    json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(0);
    json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(0);
    json["meshes"][0]["extras"] = json!({ "density": 3.5 });
    let (_, report) = folder.read(&json, &binary).unwrap();
    let told: Vec<String> = report.notes.iter().map(|n| n.message.clone()).collect();
    assert_eq!(told, ["custom properties: density", "TANGENT", "smooth shading: facets are flat"]);
}

#[test]
fn texture_coordinates_are_those_of_the_colours_image() {
    let folder = Folder::new();
    let (mut json, mut binary) = quad();
    // Two sets, of which the second is what the image goes by, as bytes of which 255 is 1; a node that mirrors turns facets.
    binary.extend(f32s(&[0.0; 8]));
    binary.extend([0, 0, 255, 0, 255, 255, 0, 255]);
    json["bufferViews"].as_array_mut().unwrap().extend([
        json!({ "buffer": 0, "byteOffset": 60, "byteLength": 32 }),
        json!({ "buffer": 0, "byteOffset": 92, "byteLength": 8 }),
    ]);
    json["buffers"][0]["byteLength"] = json!(100);
    json["accessors"].as_array_mut().unwrap().extend([
        json!({ "bufferView": 2, "componentType": 5126, "type": "VEC2", "count": 4 }),
        json!({ "bufferView": 3, "componentType": 5121, "normalized": true, "type": "VEC2", "count": 4 }),
    ]);
    let attributes = json!({ "POSITION": 0, "TEXCOORD_0": 2, "TEXCOORD_1": 3 });
    json["meshes"][0]["primitives"][0]["attributes"] = attributes;
    json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0, "texCoord": 1 });
    json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 1 }, { "mesh": 0, "scale": [-1, 1, 1] }]);
    json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let plain = json!({ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] });
    json["meshes"].as_array_mut().unwrap().push(plain);
    let (surface, _) = folder.read(&json, &binary).unwrap();
    // v is up here, and down there.
    let first = [[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0]], [[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]]];
    let uv = &surface.mesh.uv;
    assert_eq!((uv.len(), &uv[..2]), (6, &first[..]));
    assert!(uv[2..4].iter().flatten().flatten().all(|x| x.is_nan()));
    assert_eq!(uv[4..], first.map(|[a, b, c]| [a, c, b]));
    for (name, value, message) in
        [("count", json!(3), "3 texture coordinates for 4 positions"), ("type", json!("VEC3"), "accessors[3]")]
    {
        let mut wrong = json.clone();
        wrong["accessors"][3][name] = value;
        let told = folder.read(&wrong, &binary).unwrap_err().to_string();
        assert!(told.contains(message), "{told}");
    }
}

#[test]
fn texture_coordinates_come_back() {
    let folder = Folder::new();
    // Two facets that share an edge, whose corners have other coordinates in each; a third has none.
    let mut surface = surface();
    let facets = surface.mesh.facets.len();
    surface.mesh.uv = vec![NO_UV; facets];
    surface.mesh.uv[0] = [[0.25, 0.5], [1.0, 0.0], [-0.125, 2.0]];
    surface.mesh.uv[1] = [[0.75, 0.5], [0.0, 0.0], [0.5, 0.5]];
    let path = folder.put("uv.glb", &encode(&surface).unwrap().glb());
    let (back, _, _) = read(&path, false).unwrap();
    let of = |surface: &ColouredMesh| {
        let mesh = &surface.mesh;
        let named = |f: usize| surface.materials[usize::from(mesh.material[f].0)].name.clone();
        let key =
            |f: usize| (named(f), mesh.facet(f).corners_m.map(|p| p.to_array().map(|x| (x * 1e6).round() as i64)));
        let known = mesh.uv.iter().map(|uv| uv.map(|uv| uv.map(|x| if x.is_finite() { x.to_bits() } else { 0 })));
        let mut all: Vec<_> = known.enumerate().map(|(f, uv)| (key(f), uv)).collect();
        all.sort();
        all
    };
    let mut expected = of(&surface);
    // What has none where others of its material have comes back as a corner of the image: v 1 here, 0 there. Of the third material none has.
    for ((material, _), uv) in &mut expected {
        if material != "#b03020" && uv.iter().flatten().all(|bits| *bits == 0) {
            *uv = [[0.0_f64.to_bits(), 1.0_f64.to_bits()]; 3];
        }
    }
    assert_eq!(of(&back), expected);
    assert!(back.mesh.vertices_m.len() > surface.mesh.vertices_m.len());
}

#[test]
fn what_is_dropped_at_many_nodes_is_told_at_each_in_little_time() {
    let folder = Folder::new();
    let (mut json, binary) = quad();
    let nodes = json["nodes"].as_array_mut().unwrap();
    nodes.extend((0..100_000).map(|_| json!({ "camera": 0 })));
    json["scenes"] = json!([{ "nodes": (0..=100_000).collect::<Vec<_>>() }]);
    json["scene"] = json!(0);
    let (_, report) = folder.read(&json, &binary).unwrap();
    assert_eq!(report.notes.iter().filter(|note| note.message == "a camera").count(), 100_000);
}
