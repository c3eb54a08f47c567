//! What glTF files of other programs hold beyond plain meshes: instances, integers, lamps, extensions nobody knows.

use glam::DVec3;
use mmxrt::report::Fate;
use mmxrt::scene::Scene;
use serde_json::{Value, json};

use crate::cli::run;
use crate::gltf::{Folder, corners, f32s, quad};
use crate::scratch::Scratch;

/// Adds an accessor over bytes of its own.
fn accessor(
    json: &mut Value,
    binary: &mut Vec<u8>,
    bytes: &[u8],
    component: u64,
    normalized: bool,
    shape: &str,
) -> usize {
    binary.resize(binary.len().next_multiple_of(4), 0);
    let width: usize = if shape == "VEC4" { 4 } else { 3 };
    let size = match component {
        5120 | 5121 => 1,
        5122 | 5123 => 2,
        _ => 4,
    };
    // Elements begin at multiples of four bytes.
    let stride = (width * size).next_multiple_of(4);
    let rows: Vec<u8> =
        bytes.chunks(width * size).flat_map(|row| row.iter().copied().chain(vec![0; stride - row.len()])).collect();
    let view = json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": rows.len(), "byteStride": stride });
    binary.extend(&rows);
    json["buffers"][0]["byteLength"] = json!(binary.len());
    let views = json["bufferViews"].as_array_mut().unwrap();
    views.push(view);
    let view = views.len() - 1;
    let accessors = json["accessors"].as_array_mut().unwrap();
    let count = bytes.len() / width / size;
    accessors.push(json!({
        "bufferView": view, "componentType": component, "normalized": normalized, "type": shape, "count": count,
    }));
    accessors.len() - 1
}

fn near(a: [f64; 3], b: [f64; 3], within: f64) -> bool {
    (DVec3::from_array(a) - DVec3::from_array(b)).length() < within
}

#[test]
fn instances_stand_where_their_attributes_put_them() {
    let folder = Folder::new();
    let (mut json, mut binary) = quad();
    let translation =
        accessor(&mut json, &mut binary, &f32s(&[0., 0., 0., 10., 0., 0., 0., 5., 0.]), 5126, false, "VEC3");
    // A quarter turn about z as normalized shorts: sine and cosine of 45 deg, 0.70710678 x 32767 = 23170; then no turn.
    let turns: Vec<u8> = [[0_i16, 0, 23170, 23170], [0, 0, 0, 32767], [0, 0, 0, 32767]]
        .concat()
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let rotation = accessor(&mut json, &mut binary, &turns, 5122, true, "VEC4");
    let scale = accessor(&mut json, &mut binary, &f32s(&[1., 1., 1., 2., 3., 1., -1., 1., 1.]), 5126, false, "VEC3");
    let attributes = json!({ "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale });
    json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    json["nodes"][0]["translation"] = json!([0, 0, 100]);
    for used in [json!(["EXT_mesh_gpu_instancing"]), json!([])] {
        json["extensionsUsed"] = used;
        let (surface, report) = folder.read(&json, &binary).unwrap();
        // Of the unit square's corner (1, 1, 0), in glTF: turned (-1, 1, 100); twice and three times as large (12, 3, 100); mirrored
        // and moved (-1, 6, 100). Our z is its y, our y its -z.
        let at = corners(&surface);
        assert_eq!(at.len(), 6);
        assert!(near(at[0][2], [-1., -100., 1.], 1e-9), "{:?}", at[0]);
        assert!(near(at[2][2], [12., -100., 3.], 1e-9), "{:?}", at[2]);
        // The mirrored one is turned over, so that it still faces +z, our -y.
        assert!(at[4].iter().any(|c| near(*c, [-1., -100., 6.], 1e-9)), "{:?}", at[4]);
        assert!((0..6).all(|f| (surface.mesh.facet(f).normal() - DVec3::NEG_Y).length() < 1e-9));
        let told: Vec<String> = report.notes.iter().map(ToString::to_string).collect();
        assert!(told.len() == 1 && told[0].contains("which of 3 objects"), "{told:?}");
    }
    // What is wrong with instances is told.
    for (attributes, told) in [
        (json!({}), "has none of TRANSLATION"),
        (json!({ "TRANSLATION": 99 }), "accessors[99]"),
        (json!({ "TRANSLATION": translation, "SCALE": 0 }), "SCALE: 4 instances, where another attribute has 3"),
        (json!({ "ROTATION": translation }), "where VEC4 is expected"),
    ] {
        json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
        let error = folder.read(&json, &binary).unwrap_err().to_string();
        assert!(error.contains(told), "{told}: {error}");
    }
}

#[test]
fn what_blender_instances_is_where_blender_has_it() {
    // Written by Blender 5.0.1 with "GPU Instances" and lights: four icospheres of 20 facets each, moved, turned and stretched, below an
    // empty that is moved and turned; the Sun, and a lamp. The middles and one corner of each, and the Sun, by Blender's matrix_world.
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/gltf/instances_blender_5_0.gltf");
    let (surface, report, _) = mmxrt::formats::gltf::read(&path, false).unwrap();
    assert_eq!(surface.mesh.facets.len(), 80);
    let expected = [
        ([1.0, 2.0, 3.0], [1.270811, 2.87084, 2.589782]),
        ([2.865537, 4.444491, 1.757328], [3.159616, 5.210042, 0.803428]),
        ([3.918097, 8.622051, 1.093915], [3.739918, 9.375153, -0.263973]),
        ([4.157677, 14.532679, 1.009761], [3.402097, 15.802293, -0.172626]),
    ];
    let mut found = [false; 4];
    for instance in 0..4 {
        let facets = || 20 * instance..20 * (instance + 1);
        let middle = facets().map(|f| surface.mesh.facet(f).centroid_m()).sum::<DVec3>() / 20.0;
        let i =
            expected.iter().position(|(m, _)| near(middle.to_array(), *m, 1e-5)).unwrap_or_else(|| panic!("{middle}"));
        found[i] = true;
        let mut all = facets().flat_map(|f| surface.mesh.facet(f).corners_m);
        assert!(all.any(|c| near(c.to_array(), expected[i].1, 1e-5)), "{i}");
        // Outer sides are outside.
        assert!(facets().all(|f| {
            let facet = surface.mesh.facet(f);
            facet.normal().dot(facet.centroid_m() - middle) > 0.0
        }));
    }
    assert_eq!(found, [true; 4]);
    assert!(near(surface.sun.unwrap().vec().to_array(), [0.2253789, -0.4321216, 0.8731983], 1e-6));
    assert!(report.notes.iter().any(|n| n.message.contains("683 lx")), "{:?}", report.notes);
    assert!(report.notes.iter().any(|n| n.message.contains("point light \"Lamp\"")), "{:?}", report.notes);
}

#[test]
fn integers_are_positions() {
    // The unit square in each kind of integer: as it is with the node's scale, or normalized.
    let square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]].concat();
    for (component, one, normalized) in [
        (5120, 127, true),
        (5121, 255, true),
        (5122, 32767, true),
        (5123, 65535, true),
        (5120, -128, false),
        (5121, 200, false),
        (5122, -32768, false),
        (5123, 65535, false),
    ] {
        let folder = Folder::new();
        let (mut json, mut binary) = quad();
        let bytes: Vec<u8> = square
            .iter()
            .flat_map(|c| {
                let value: i64 = c * one;
                let size = if component < 5122 { 1 } else { 2 };
                value.to_le_bytes()[..size].to_vec()
            })
            .collect();
        let position = accessor(&mut json, &mut binary, &bytes, component, normalized, "VEC3");
        json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(position);
        let scale = if normalized { 3.0 } else { 3.0 / one as f64 };
        json["nodes"][0]["scale"] = json!([scale, scale, scale]);
        json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
        json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        let (surface, report) = folder.read(&json, &binary).unwrap();
        let expected = [[[0., 0., 0.], [3., 0., 0.], [3., 0., 3.]], [[0., 0., 0.], [3., 0., 3.], [0., 0., 3.]]];
        // A negative scale in all axes mirrors: facets are turned over, from their first corner.
        let turned = if one < 0 { expected.map(|[a, b, c]| [a, c, b]) } else { expected };
        for (corner, expected) in corners(&surface).concat().into_iter().zip(turned.concat()) {
            assert!(near(corner, expected, 1e-14), "{component} {one}: {corner:?}");
        }
        assert_eq!(report.notes, []);
    }
}

#[test]
fn compressed_geometry_says_so() {
    let folder = Folder::new();
    let (json, binary) = quad();
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let mut required = json.clone();
        required["extensionsRequired"] = json!([name]);
        let error = folder.read(&required, &binary).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("export it without compression"), "{error}");
        // With the plain numbers beside it nothing is lost.
        let mut used = json.clone();
        used["extensionsUsed"] = json!([name]);
        used["meshes"][0]["primitives"][0]["extensions"] = json!({ name: { "bufferView": 0, "attributes": {} } });
        let (surface, report) = folder.read(&used, &binary).unwrap();
        assert_eq!((surface.mesh.facets.len(), report.notes.len()), (2, 0));
        // Without them it is the compression that lacks.
        used["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        let error = folder.read(&used, &binary).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("primitives[0]"), "{error}");
    }
    let mut buffer = json.clone();
    buffer["buffers"][0] =
        json!({ "byteLength": 60, "extensions": { "EXT_meshopt_compression": { "fallback": true } } });
    let error = folder.read(&buffer, &binary).unwrap_err().to_string();
    assert!(error.contains("buffers[0]: EXT_meshopt_compression"), "{error}");
}

#[test]
fn an_extension_that_may_move_geometry_is_refused() {
    let folder = Folder::new();
    let (json, binary) = quad();
    let read = |change: &dyn Fn(&mut Value)| {
        let mut json = json.clone();
        change(&mut json);
        folder.read(&json, &binary).map(|(_, report)| report.notes.len()).map_err(|e| e.to_string())
    };
    let at = |pointer: &'static str| {
        move |json: &mut Value| {
            json["extensionsUsed"] = json!(["ACME_scatter"]);
            *json.pointer_mut(pointer).unwrap().as_object_mut().unwrap().entry("extensions").or_insert(Value::Null) =
                json!({ "ACME_scatter": { "count": 300 } });
        }
    };
    for pointer in
        ["/nodes/0", "/meshes/0", "/meshes/0/primitives/0", "/accessors/0", "/bufferViews/1", "/scenes/0", ""]
    {
        let error = read(&at(pointer)).unwrap_err();
        assert!(error.contains("extensions.ACME_scatter") && error.contains("may move or add geometry"), "{error}");
    }
    // Also if nothing but its name is there, as of quantization, or if the name is not even listed.
    let error = read(&|json| json["extensionsUsed"] = json!(["ACME_scatter"])).unwrap_err();
    assert!(error.contains("extensionsUsed[0]") && error.contains("ACME_scatter"), "{error}");
    let error = read(&|json| json["nodes"][0]["extensions"] = json!({ "CESIUM_RTC": {} })).unwrap_err();
    assert!(error.contains("nodes[0].extensions.CESIUM_RTC"), "{error}");
    // What only a material has, or what is known to be about looks, is told and no more, also if it is required.
    assert_eq!(read(&at("/materials/0")), Ok(1));
    for name in ["KHR_materials_clearcoat", "KHR_texture_transform", "EXT_texture_webp", "KHR_xmp_json_ld"] {
        let change = |json: &mut Value| {
            json["extensionsUsed"] = json!([name]);
            json["extensionsRequired"] = json!([name]);
        };
        assert_eq!(read(&change), Ok(1), "{name}");
    }
}

#[test]
fn what_is_hidden_is_not_there() {
    let folder = Folder::new();
    let (mut json, binary) = quad();
    json["nodes"] = json!([
        { "mesh": 0, "children": [1] },
        { "extensions": { "KHR_node_visibility": { "visible": false } }, "mesh": 0, "children": [2] },
        { "mesh": 0 },
    ]);
    let (surface, report) = folder.read(&json, &binary).unwrap();
    assert_eq!(surface.mesh.facets.len(), 2);
    assert!(report.notes[0].message.starts_with("is hidden"), "{:?}", report.notes);
    json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = json!(true);
    assert_eq!(folder.read(&json, &binary).unwrap().0.mesh.facets.len(), 6);
}

#[test]
fn the_brightest_directional_light_is_the_sun() {
    let folder = Folder::new();
    let (mut json, binary) = quad();
    json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    json["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "intensity": 2, "name": "Sun" },
        { "type": "directional", "name": "moon" },
        { "type": "point", "name": "lamp" },
        { "type": "spot", "name": "torch", "spot": {} },
    ] } });
    let light = |i: usize| json!({ "KHR_lights_punctual": { "light": i } });
    // Turned by -90 deg about x, -z becomes -y, along which light falls: the Sun is at glTF's y, our z. Its parent turns that by
    // 90 deg about z, to -x; and is stretched, which moves nothing.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    json["nodes"] = json!([
        { "mesh": 0 },
        { "children": [2], "rotation": [0, 0, half, half], "scale": [3, 3, 3] },
        { "rotation": [-half, 0, 0, half], "extensions": light(0) },
        { "extensions": light(1) },
        { "extensions": light(2) },
        { "extensions": light(3) },
    ]);
    json["scenes"][0]["nodes"] = json!([3, 0, 1, 4, 5]);
    let (surface, report) = folder.read(&json, &binary).unwrap();
    let sun = surface.sun.unwrap().vec();
    assert!((sun - DVec3::NEG_X).length() < 1e-15, "{sun}");
    let told: Vec<String> = report.notes.iter().map(|n| format!("{:?} {}", n.fate, n.message)).collect();
    let parts = ["not the brightest", "the point light \"lamp\"", "the spot light \"torch\"", "2 lx"];
    assert!(told.len() == 4 && parts.iter().all(|part| told.iter().any(|told| told.contains(part))), "{told:?}");
    // In the scene it lights what the camera looks at.
    let scratch = Scratch::new();
    json["buffers"][0]["uri"] = json!("quad.bin");
    scratch.write("quad.bin", &binary);
    scratch.write("a.gltf", json.to_string());
    let scene = scene_of(&scratch, &["a.gltf"]);
    assert!((scene.sky.sun.direction.vec() - DVec3::NEG_X).length() < 1e-15);
    // One that does not exist is told.
    json["nodes"][2]["extensions"] = light(9);
    let error = folder.read(&json, &binary).unwrap_err().to_string();
    assert!(error.contains("nodes[2].extensions.KHR_lights_punctual: lights[9]: there are 4"), "{error}");
}

/// The scene that `convert` makes.
fn scene_of(scratch: &Scratch, arguments: &[&str]) -> Scene {
    let input = scratch.argument(arguments[0]);
    let output = scratch.argument("out/scene.toml");
    let (code, out, err) = run(&[&["convert", &input, &output, "--force"], &arguments[1..]].concat());
    assert_eq!(code, 0, "{out}{err}");
    mmxrt::formats::scene_toml::read(&scratch.join("out/scene.toml"), &mmxrt::progress::unwatched).unwrap().scene
}

#[test]
fn white_is_the_colour_that_is_left_out() {
    let folder = Folder::new();
    let (json, binary) = quad();
    let read = |material: Value| {
        let mut json = json.clone();
        json["materials"][0] = material;
        let (surface, report) = folder.read(&json, &binary).unwrap();
        let told: Vec<String> = report.notes.iter().map(|n| format!("{} {}", n.fate, n.message)).collect();
        (surface.materials[0].kd, told)
    };
    for material in [json!({ "name": "w" }), json!({ "name": "w", "pbrMetallicRoughness": { "roughnessFactor": 0.5 } })]
    {
        let (kd, told) = read(material);
        assert_eq!(kd, Some([1.0; 3]));
        assert!(told.len() == 1 && told[0].starts_with("Defaulted") && told[0].contains("white"), "{told:?}");
    }
    // An entry of a dictionary may have no colour; the colours of an older way to say them are colours.
    assert_eq!(read(json!({ "name": "w", "extras": { "spectral_material": "a" } })), (None, vec![]));
    let old = json!({ "KHR_materials_pbrSpecularGlossiness": { "diffuseFactor": [0.25, 0.5, 0.75, 1] } });
    assert_eq!(read(json!({ "name": "w", "extensions": old })), (Some([0.25, 0.5, 0.75]), vec![]));
    let (_, told) =
        read(json!({ "name": "w", "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 1], "metallicFactor": 1 } }));
    assert!(told.len() == 1 && told[0].contains("metal"), "{told:?}");
    // The primitive without any material is none of this.
    let mut bare = json.clone();
    bare["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("material");
    assert_eq!(folder.read(&bare, &binary).unwrap().0.materials[0].kd, None);
}

#[test]
fn smooth_shading_is_told() {
    let folder = Folder::new();
    let (json, binary) = quad();
    for (normals, count) in [([[0., 0., 1.]; 4], 0), ([[0., 0., 1.], [0., 0., 1.], [0.6, 0., 0.8], [0., 0., 1.]], 1)] {
        let (mut json, mut binary) = (json.clone(), binary.clone());
        let normal = accessor(&mut json, &mut binary, &f32s(&normals.concat()), 5126, false, "VEC3");
        json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
        let (_, report) = folder.read(&json, &binary).unwrap();
        assert_eq!(report.notes.len(), count, "{:?}", report.notes);
        assert!(report.notes.iter().all(|n| n.fate == Fate::Dropped && n.message.starts_with("smooth shading")));
    }
}

#[test]
fn a_mesh_far_from_its_origin_keeps_its_shape_in_every_reader() {
    // A cube of 1 m, 9 376 km away: f32 has steps of 1 m there.
    let scratch = Scratch::new();
    let far = 9_376_000.123_456_79_f64;
    let corners: Vec<String> = (0..8)
        .map(|i| format!("v {} {} {}\n", far + f64::from(i & 1), -far / 3.0 + f64::from(i >> 1 & 1), f64::from(i >> 2)))
        .collect();
    let faces = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    scratch.write("cube.obj", corners.concat() + faces);
    let (code, out, err) = run(&["convert", &scratch.argument("cube.obj"), &scratch.argument("cube.glb")]);
    assert_eq!(code, 0, "{out}{err}");
    // Another reader, without our residuals, in f64.
    let bytes = std::fs::read(scratch.join("cube.glb")).unwrap();
    let ::gltf::Gltf { document, blob } = ::gltf::Gltf::from_slice(&bytes).unwrap();
    let (moved, ..) = document.nodes().next().unwrap().transform().decomposed();
    let blob = blob.unwrap();
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    let positions: Vec<[f32; 3]> = primitive.reader(|_| Some(&blob)).read_positions().unwrap().collect();
    for (i, p) in positions.iter().enumerate() {
        let i = i as u32;
        let at = [0, 1, 2].map(|k| f64::from(moved[k]) + f64::from(p[k]));
        let expected = [far + f64::from(i & 1), f64::from(i >> 2), far / 3.0 - f64::from(i >> 1 & 1)];
        assert!(near(at, expected, 1e-7), "{at:?} {expected:?}");
    }
    // And ours.
    let (surface, _, _) = mmxrt::formats::gltf::read(&scratch.join("cube.glb"), false).unwrap();
    let low = surface.mesh.bounds_m().unwrap().0;
    assert!((low - DVec3::new(far, -far / 3.0, 0.0)).length() < 1e-8, "{low}");
    // One about its origin is written as it is.
    scratch.write("near.obj", "v -1 0 0\nv 1 0 0\nv 0 1 0.125\nf 1 2 3\n");
    assert_eq!(run(&["convert", &scratch.argument("near.obj"), &scratch.argument("near.gltf")]).0, 0);
    assert!(!std::fs::read_to_string(scratch.join("near.gltf")).unwrap().contains("translation"));
}
