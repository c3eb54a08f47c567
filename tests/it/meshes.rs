//! Meshes in other formats: files that other programs wrote (`tests/data/meshes`, by `referees/meshes.py`), and such as nobody should.

use std::path::PathBuf;

use glam::DVec3;
use mmxrt::Error;
use mmxrt::formats::mesh_file::MeshFile;
use mmxrt::formats::registry;
use mmxrt::geometry::Mesh;

use crate::cli::run;
use crate::scratch::Scratch;

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/meshes").join(name)
}

fn read(name: &str) -> MeshFile {
    registry::mesh(&data(name), true).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The volume that a closed mesh encloses, by the divergence theorem about one of its vertices.
fn volume(mesh: &Mesh) -> f64 {
    let from = mesh.vertices_m[0];
    let of = |[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|v| mesh.vertices_m[*v as usize] - from);
        a.dot(b.cross(c)) / 6.0
    };
    mesh.facets.iter().map(of).sum()
}

#[test]
fn a_box_is_the_same_whoever_wrote_it() {
    let low = DVec3::new(10.5, -20.25, 1000.125);
    let mut corners: Vec<[f64; 3]> = (0..8)
        .map(|i| {
            (low + DVec3::new(f64::from(i & 1) * 2.0, f64::from(i >> 1 & 1) * 3.0, f64::from(i >> 2) * 5.0)).into()
        })
        .collect();
    corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
    let names = [
        "trimesh.stl",
        "trimesh_text.stl",
        "numpy_stl.stl",
        "trimesh.ply",
        "trimesh_text.ply",
        "trimesh_colours.ply",
        "meshio.ply",
        "meshio_text.ply",
        "plyfile_big.ply",
    ];
    for name in names {
        let file = read(name);
        let mesh = &file.surface.mesh;
        assert_eq!((mesh.vertices_m.len(), mesh.facets.len(), mesh.material.len()), (8, 12, 12), "{name}");
        let mut found: Vec<[f64; 3]> = mesh.vertices_m.iter().map(|v| v.to_array()).collect();
        found.sort_by(|a, b| a.partial_cmp(b).unwrap());
        // All coordinates are f32 too.
        assert_eq!(found, corners, "{name}");
        // Outwards, and closed: 2 x 3 x 5.
        assert!((volume(mesh) - 30.0).abs() < 1e-12, "{name}: {}", volume(mesh));
        assert_eq!(file.unit_m, 1.0);
        let quads = name.starts_with("meshio");
        assert_eq!(mesh.face_of_facet.len(), if quads { 12 } else { 0 }, "{name}");
        assert!(!quads || mesh.face_of_facet == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]);
    }
}

#[test]
fn colours_are_materials() {
    let file = read("trimesh_colours.ply");
    let colours: Vec<_> = file.surface.materials.iter().map(|material| material.kd.unwrap()).collect();
    assert_eq!(colours, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    let of_facets: Vec<u16> = file.surface.mesh.material.iter().map(|material| material.0).collect();
    assert_eq!(of_facets, [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1]);
    // One colour of all vertices, by the standard's formula: 10 / 255 / 12.92, ((x / 255 + 0.055) / 1.055)^2.4.
    let [only] = &read("plyfile_big.ply").surface.materials[..] else { panic!() };
    let [r, g, b] = only.kd.unwrap();
    assert!((r - 0.003_035_27).abs() < 1e-8 && (g - 0.577_580).abs() < 1e-6 && (b - 0.012_983_0).abs() < 1e-7);
    assert!(only.name.is_empty());
    // Corners that differ: a facet has no colour then, which is said.
    let scratch = Scratch::new();
    let vertices = "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n";
    let header = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_index\nend_header\n";
    scratch.write("mixed.ply", format!("{header}{vertices}3 0 1 2\n"));
    let mixed = registry::mesh(&scratch.join("mixed.ply"), true).unwrap();
    assert!(mixed.surface.materials[0].kd.is_none() && mixed.report.notes[0].message.contains("differ"));
}

/// CSPICE's kernel, and the same plates as tables; of the volume that trimesh says, km^3.
#[test]
fn shapes_of_bodies_are_in_kilometres() {
    let kernel = read("ellipsoid.bds");
    let mesh = &kernel.surface.mesh;
    assert_eq!((mesh.vertices_m.len(), mesh.facets.len(), kernel.unit_m), (162, 320, 1000.0));
    assert!((volume(mesh) - 5_424.774_434_521_497).abs() < 1e-9, "{}", volume(mesh));
    assert!((mesh.vertices_m[7] - DVec3::new(0.0, 5.940_761_566_946_21, -7.791_961_404_504_686)).length() < 1e-14);
    assert_eq!(mesh.facets[100], [40, 151, 155]);
    let rows = |numbered: bool| {
        let mut text = String::new();
        for (i, v) in mesh.vertices_m.iter().enumerate() {
            let number = if numbered { format!("{:6}", i + 1) } else { String::new() };
            text += &format!("{number} {:?} {:?} {}\n", v.x, v.y, format!("{:e}", v.z).replace('e', "D"));
        }
        text
    };
    let plates: String = mesh
        .facets
        .iter()
        .enumerate()
        .map(|(i, [a, b, c])| format!("{} {} {} {}\n", i + 1, a + 1, b + 1, c + 1))
        .collect();
    let scratch = Scratch::new();
    for (name, text) in [
        ("both.tab", format!("162 320\n{}{plates}", rows(true))),
        ("each.tab", format!("   162\r\n{}   320\n{plates}", rows(true))),
        ("named_otherwise.txt", format!("162\t320\n{}{plates}", rows(true))),
    ] {
        scratch.write(name, text);
        let table = registry::mesh(&scratch.join(name), true).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(
            (&table.surface.mesh.vertices_m, &table.surface.mesh.facets),
            (&mesh.vertices_m, &mesh.facets),
            "{name}"
        );
        assert_eq!(table.unit_m, 1000.0);
    }
    // In a scene that says nothing of units it is as large as Phobos, and larger if the scene does.
    let scene = |unit: &str| {
        let body = data("ellipsoid.bds").display().to_string();
        let text = format!(
            "mmxrt_scene = 1\norigin_m = [0.0, 0.0, 0.0]\n[[mesh]]\nfile = {body:?}\nmaterial = \"grey\"\n{unit}\n[materials]\ngrey = {{ reflectance = 0.07 }}\n\
             [sun]\ndirection = [1.0, 0.0, 0.0]\ndistance_au = 1.5\n[observer]\nposition_m = [1e8, 0.0, 0.0]\ntarget_m = [0.0, 0.0, 0.0]\nup = [0.0, 0.0, 1.0]\n\
             [sensor]\nsamples = 4\nlines = 4\nifov_mrad = 0.1\nbands = {{ centres_um = [1.0] }}\n"
        );
        scratch.write("scene.toml", text);
        let file = mmxrt::formats::scene_toml::read(&scratch.join("scene.toml"), &mmxrt::progress::unwatched).unwrap();
        let (low, high) = file.scene.body.bounds_m().unwrap();
        (high - low).x
    };
    let wide = |km: f64| (km - 25_900.0).abs() < 300.0;
    assert!(wide(scene("")) && wide(scene("unit_m = 2000.0") / 2.0), "{}", scene(""));
    let (code, out, err) = run(&["inspect", data("ellipsoid.bds").to_str().unwrap()]);
    assert!(code == 0 && out.contains("DSK mesh") && out.contains("320") && out.contains("open_edges 0"), "{out}{err}");
    let (code, out, err) = run(&["inspect", "--json", data("ellipsoid.bds").to_str().unwrap()]);
    let facts: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{code} {err}"));
    assert!((facts["volume_in_its_unit"].as_f64().unwrap() - 5_424.774_434_521_497).abs() < 1e-9);
}

/// A cube of 2 x 2 quadrilaterals on each face, whose faces share edges.
#[test]
fn implicitly_connected_quadrilaterals_are_closed_and_face_outwards() {
    let scratch = Scratch::new();
    for turned in [false, true] {
        let mut text = "2\n".to_owned();
        for face in 0..6 {
            for j in 0..3 {
                for i in 0..3 {
                    let [u, v] = [f64::from(i) - 1.0, f64::from(j) - 1.0];
                    let [u, v] = if turned { [v, u] } else { [u, v] };
                    let side = if face % 2 == 0 { 1.0 } else { -1.0 };
                    let p = match face / 2 {
                        0 => [side, side * u, v],
                        1 => [v, side, side * u],
                        _ => [side * u, v, side],
                    };
                    text += &format!("{:?} {:?} {:?}\n", p[0], p[1], p[2]);
                }
            }
        }
        scratch.write("cube.icq", text.clone());
        let file = registry::mesh(&scratch.join("cube.icq"), true).unwrap();
        let mesh = &file.surface.mesh;
        // 6 Q^2 + 2 vertices, 12 Q^2 facets, 8 km^3.
        assert_eq!((mesh.vertices_m.len(), mesh.facets.len(), file.doubts.len()), (26, 48, 1));
        assert!((volume(mesh) - 8.0).abs() < 1e-12 && file.unit_m == 1000.0);
        scratch.write("open.icq", text.replacen("1.0 -1.0 -1.0", "1.0 -1.0 -1.1", 1));
        let open = registry::mesh(&scratch.join("open.icq"), true).unwrap();
        assert!(open.doubts[1].message.contains("do not fit together"), "{:?}", open.doubts);
    }
}

#[test]
fn what_is_wrong_is_said_where_it_is() {
    let scratch = Scratch::new();
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n\
               end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    let tab = "3 1\n1 0 0 0\n2 1 0 0\n3 0 1 0\n1 1 2 3\n";
    for (name, text, from, to, told) in [
        ("a.ply", ply, "3 0 1 2", "3 0 1 3", "face 0: must have three or more of 3 vertices"),
        ("a.ply", ply, "3 0 1 2", "2 0 1", "face 0"),
        ("a.ply", ply, "3 0 1 2", "3 0 1", "face 0: is not there"),
        ("a.ply", ply, "0 1 0", "0 nan 0", "vertex 2: is not finite"),
        ("a.ply", ply, "face 1", "face 0", "has no faces"),
        ("a.ply", ply, "float y", "half y", ":5"),
        ("a.ply", ply, "ascii", "ASCII", ":2: `ASCII` is not a format"),
        ("a.ply", ply, "vertex 3", "vertex 4000000000", ":3"),
        ("a.ply", ply, "vertex 3", "vertex 9000000", "cut off"),
        ("a.ply", ply, "end_header", "end", "has no end"),
        ("a.ply", ply, "property float z\n", "", "no x, y and z"),
        ("a.ply", ply, "vertex_indices", "corners", "no list `vertex_indices`"),
        ("a.stl", stl, "vertex 0 1 0\n", "", ":7: ends a facet with 2 corners"),
        ("a.stl", stl, "vertex 1 0 0", "vertex 1 0", ":5: a vertex has three finite numbers"),
        ("a.stl", stl, "endfacet\n", "", ":2: this facet has no end"),
        ("a.stl", stl, "vertex 0 0 0", "corner 0 0 0", ":4: `corner` is not a word of STL"),
        ("a.tab", tab, "1 1 2 3", "1 1 2 4", ":5: must be a plate: three vertices from 1 to 3"),
        ("a.tab", tab, "1 1 2 3", "1 0 2 3", ":5: must be a plate"),
        ("a.tab", tab, "2 1 0 0", "2 1 0", ":3"),
        ("a.tab", tab, "2 1 0 0", "2 1 0 x", ":3: is not a row of numbers"),
        ("a.tab", tab, "3 1\n", "3 2\n", "cut off"),
        ("a.tab", tab, "1 1 2 3\n", "1 1 2 3\n2 1 2 3\n", ":6: follows the last"),
        ("a.icq", "1\n0 0 0\n", "1\n", "1\n", "24 vertices"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert!(changed != text || from == to, "{name} {from}");
        scratch.write(name, changed);
        let error = registry::mesh(&scratch.join(name), true).expect_err(told).to_string();
        assert!(error.contains(told), "{told} is not in\n{error}");
    }
    let (code, _, err) = run(&["convert", data("trimesh.stl").to_str().unwrap(), &scratch.argument("out.ply")]);
    assert!(code != 0 && err.contains("ply"), "{err}");
    let (code, _, err) = run(&["convert", data("trimesh.stl").to_str().unwrap(), &scratch.argument("out.obj")]);
    assert_eq!(code, 0, "{err}");
}

/// Files that are cut off, and bytes that were changed on the way, are errors or other meshes, and no more.
#[test]
fn damaged_files_are_errors_and_no_more() {
    let scratch = Scratch::new();
    let (mut read, mut refused) = (0, 0);
    let mut state = 7_u64;
    for entry in std::fs::read_dir(data("")).unwrap() {
        let path = entry.unwrap().path();
        let bytes = std::fs::read(&path).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let mut attempt = |bytes: &[u8]| {
            std::fs::write(scratch.join(&name), bytes).unwrap();
            match registry::mesh(&scratch.join(&name), true) {
                Ok(file) => {
                    let mesh = &file.surface.mesh;
                    assert!(mesh.facets.iter().flatten().all(|v| (*v as usize) < mesh.vertices_m.len()));
                    assert!(mesh.vertices_m.iter().all(|v| v.is_finite()) && mesh.material.len() == mesh.facets.len());
                    read += 1;
                }
                Err(Error::Invalid(_) | Error::Unsupported { .. } | Error::Syntax { .. }) => refused += 1,
                Err(other) => panic!("{name}: {other}"),
            }
        };
        for i in 0..40 {
            attempt(&bytes[..bytes.len() * i / 40]);
            let mut changed = bytes.clone();
            for _ in 0..=i % 4 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let place = (state >> 33) as usize % changed.len().min(3000);
                changed[place] = (state >> 20) as u8;
            }
            attempt(&changed);
        }
    }
    assert!(read > 50 && refused > 300, "{read} {refused}");
}

/// A plate of 10 m x 10 m, and a post of 1 m x 1 m through one of its two triangles: each of the post's 8 side triangles crosses that one.
#[test]
fn a_post_through_a_plate_is_counted_and_shown() {
    let scratch = Scratch::new();
    let plate = "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nf 1 2 3\nf 1 3 4\n";
    let ring =
        |z: f64| [[2.0, -3.0], [3.0, -3.0], [3.0, -2.0], [2.0, -2.0]].map(|[x, y]| format!("v {x} {y} {z}\n")).concat();
    let sides = "f 5 6 10\nf 5 10 9\nf 6 7 11\nf 6 11 10\nf 7 8 12\nf 7 12 11\nf 8 5 9\nf 8 9 12\n";
    let obj = scratch.write("a.obj", format!("{plate}{}{}{sides}", ring(-1.0), ring(1.0)));
    let (obj, picture) = (obj.to_str().unwrap(), scratch.argument("a.png"));
    let (code, out, err) = run(&["inspect", "--json", obj, "--picture", &picture]);
    assert_eq!(code, 0, "{out}{err}");
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["defects"]["pairs_of_facets_that_cross"], 8);
    assert_eq!(json["defects"]["more_cross"], false);
    let mut image = registry::image(&scratch.join("a.png")).unwrap();
    assert_eq!((image.columns, image.rows, image.bands.len()), (720, 764, 3));
    // The post is open: from above its inner sides are not seen, of the plate's underside nothing either. Turned over, the plate is red.
    let is_red = |image: &mut mmxrt::formats::raster::Raster| {
        let (mut red, mut green) = (vec![], vec![]);
        image.read(0, &mut red).unwrap();
        image.read(1, &mut green).unwrap();
        red.iter().zip(&green).filter(|(r, g)| **r > 2.0 * **g).count()
    };
    let before = is_red(&mut image);
    let over = plate.replace("f 1 2 3\nf 1 3 4", "f 1 3 2\nf 1 4 3");
    scratch.write("a.obj", format!("{over}{}{}{sides}", ring(-1.0), ring(1.0)));
    let (code, out, err) = run(&["inspect", obj, "--picture", &picture, "--force"]);
    assert_eq!(code, 0, "{out}{err}");
    let after = is_red(&mut registry::image(&scratch.join("a.png")).unwrap());
    assert!(after > before + 20_000, "{before} {after}");
    let (code, _, err) = run(&["inspect", obj, "--picture", &scratch.argument("a.svg")]);
    assert!(code == 1 && err.contains("ends in .png"), "{err}");
}
