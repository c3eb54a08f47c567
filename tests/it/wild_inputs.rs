//! Files as they are found whose meaning is easily taken for another: what they say is computed by hand.

use glam::DVec3;
use mmxrt::formats::{raster, scene_toml};
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;
use mmxrt::spectral::solar_e490;
use mmxrt::study;
use serde_json::json;

use crate::gltf::{Folder, f32s, quad};
use crate::map_files::{Bench, SCENE};
use crate::scratch::Scratch;

/// ASTM E490-00a has 1366.091 W m-2 in all.
const E490_W_M2: f64 = 1366.090796839;

/// A square under a Sun in the zenith, 1 au away, and what was told of that Sun.
fn under(folder: &Scratch, sun: &str) -> (Scene, String) {
    folder.write("square.obj", "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nf 1 2 3\nf 1 3 4\n");
    let text = SCENE
        .replace("distance_au = 1.5", &format!("distance_au = 1\n{sun}"))
        .replace("reflectance = 0.1", "reflectance = 0.1\nbond_albedo = 0.1\nemissivity_bolometric = 0.9")
        .replace("model = \"off\"", "model = \"equilibrium\"");
    let file = scene_toml::read(&folder.write("scene.toml", text), &unwatched).unwrap();
    let told = file.notes.into_iter().chain(file.defaults.iter().map(|d| format!("{} {}", d.item, d.value)));
    (file.scene, told.collect::<Vec<_>>().join("\n"))
}

fn temperature_k(scene: &Scene) -> f64 {
    study::simulate(scene, &unwatched).unwrap().0.temperature_lit_k[0]
}

#[test]
fn a_lamp_warms_by_what_its_table_holds() {
    let folder = Scratch::new();
    folder.write("lamp.csv", "wavelength_um,irradiance_w_m2_um\n0.9,1\n2.5,1\n");
    let (scene, told) = under(&folder, "spectrum = \"lamp.csv\"");
    // 1.6 W m-2 in all; T = ((1 - A) E / (eps sigma))^(1/4) with A = 1 - eps.
    assert!((scene.sun.total_irradiance_1au_w_m2 - 1.6).abs() < 1e-12);
    assert!((temperature_k(&scene) / (1.6_f64 / 5.670374419e-8).powf(0.25) - 1.0).abs() < 1e-9);
    assert!(told.contains("1.60 W m-2 in the table, which is not that of the Sun: nothing is added"), "{told}");
    // A total that is given is the table's own.
    let (scene, _) = under(&folder, "spectrum = \"lamp.csv\"\ntotal_irradiance_w_m2 = 3.2");
    assert_eq!((scene.sun.total_irradiance_1au_w_m2, scene.sun.irradiance_1au.at(1.0)), (3.2, Some(2.0)));
}

#[test]
fn a_table_of_the_sun_that_ends_early_is_continued_by_e490() {
    let folder = Scratch::new();
    let e490 = solar_e490();
    let rows = e490.wavelength_um().iter().zip(e490.value()).filter(|(um, _)| (0.3..=2.5).contains(*um));
    let rows: String = rows.map(|(um, value)| format!("{um},{}\n", 0.97 * value)).collect();
    folder.write("cut.csv", format!("wavelength_um,irradiance_w_m2_um\n{rows}"));
    let (scene, told) = under(&folder, "spectrum = \"cut.csv\"");
    let total = scene.sun.total_irradiance_1au_w_m2;
    assert!((total / (0.97 * E490_W_M2) - 1.0).abs() < 1e-9, "{total}");
    assert!(told.contains("of E490 beyond its ends, scaled by 0.9700"), "{told}");
    // What the table holds is scaled to the part of the total that it has.
    let (scene, _) = under(&folder, "spectrum = \"cut.csv\"\ntotal_irradiance_w_m2 = 1361");
    let at_1_um = scene.sun.irradiance_1au.at(1.0).unwrap();
    assert!((at_1_um / (747.9 * 1361.0 / E490_W_M2) - 1.0).abs() < 1e-9, "{at_1_um}");
    assert_eq!(scene.sun.total_irradiance_1au_w_m2, 1361.0);
    // One point has the ratio, and no integral.
    folder.write("point.csv", "wavelength_um,irradiance_w_m2_um\n1,373.95\n");
    let (scene, _) = under(&folder, "spectrum = \"point.csv\"");
    assert!((scene.sun.total_irradiance_1au_w_m2 / (0.5 * E490_W_M2) - 1.0).abs() < 1e-9);
}

#[test]
fn a_sun_comes_back_with_its_total() {
    let folder = Scratch::new();
    let e490 = solar_e490();
    let rows = e490.wavelength_um().iter().zip(e490.value()).filter(|(um, _)| (0.3..=2.5).contains(*um));
    let rows: String = rows.map(|(um, value)| format!("{um},{}\n", value / 2000.0)).collect();
    folder.write("relative.csv", format!("wavelength_um,irradiance_w_m2_um\n{rows}"));
    folder.write("lamp.csv", "wavelength_um,irradiance_w_m2_um\n0.9,1\n2.5,1\n");
    for sun in [
        "spectrum = \"relative.csv\"\ntotal_irradiance_w_m2 = 1300",
        "spectrum = \"relative.csv\"",
        "spectrum = \"lamp.csv\"",
        "spectrum = \"lamp.csv\"\ntotal_irradiance_w_m2 = 1361",
    ] {
        let (scene, _) = under(&folder, sun);
        let path = folder.join("back/scene.toml");
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        scene_toml::write(&scene, &path, true).unwrap().0.commit().unwrap();
        let back = scene_toml::read(&path, &unwatched).unwrap().scene;
        let [a, b] = [&scene, &back].map(|s| s.sun.total_irradiance_1au_w_m2);
        assert!((a / b - 1.0).abs() < 1e-12, "{sun}: {a} {b}");
        let [a, b] = [&scene, &back].map(|s| s.sun.irradiance_1au.at(1.0).unwrap());
        assert!((a / b - 1.0).abs() < 1e-12, "{sun}: {a} {b}");
    }
}

#[test]
fn channels_that_are_called_by_bare_numbers_are_compared() {
    let bench = Bench::new();
    let line = |y: u8| [1.0_f32, 1.0, 2.0, 2.0].map(|v| v + f32::from(y)).map(f32::to_le_bytes).concat();
    let head = "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nraster = \"m.exr\"\nplacement = \"plane\"\n\
                plane = { corner_m = [-4, 4, 0], along_line_m = [4, 0, 0], line_to_line_m = [0, -4, 0] }\n";
    for names in [["1050", "450"], ["0.45", "1.05"]] {
        let channels = [(names[0], 2, 1), (names[1], 2, 1)];
        bench.0.write("m.exr", crate::raster::exr(&channels, [2, 2], &[line(0), line(4)], None));
        bench.map(&format!("{head}bands = {{ centres_um = [1.05, 0.45] }}\n"));
        let (code, err) = bench.try_to(&["--radiance", "{}m.map.toml"]);
        assert!(code == 2 || code == 1, "{err}");
        assert!(err.contains("band 1 is at 1.05 um here, but at 0.45 um in the raster"), "{err}");
        bench.map(&format!("{head}bands = {{ centres_um = [0.45, 1.05] }}\n"));
        assert_eq!(bench.try_to(&["--radiance", "{}m.map.toml"]).0, 0);
    }
    // Numbers that are no wavelengths say nothing.
    let channels = [("1", 2, 1), ("2", 2, 1)];
    bench.0.write("m.exr", crate::raster::exr(&channels, [2, 2], &[line(0), line(4)], None));
    bench.map(&format!("{head}bands = {{ centres_um = [1.05, 0.45] }}\n"));
    assert_eq!(bench.try_to(&["--radiance", "{}m.map.toml"]).0, 0);
}

#[test]
fn an_envi_image_with_frame_offsets_or_two_opinions_is_refused() {
    let folder = Scratch::new();
    let head = "ENVI\nsamples = 2\nlines = 1\nbands = 1\ndata type = 4\ninterleave = bsq\nbyte order = 0\n";
    folder.write("a.img", [1_f32, 2.0, 3.0, 4.0].map(f32::to_le_bytes).concat());
    let opened = |more: &str| raster::open(&folder.write("a.hdr", format!("{head}{more}")));
    for key in ["major frame offsets", "minor frame offsets"] {
        let error = opened(&format!("{key} = {{4, 4}}\n")).unwrap_err().to_string();
        assert!(error.contains(&format!("a.hdr:8 {key}")), "{error}");
        opened(&format!("{key} = {{0, 0}}\n")).unwrap();
    }
    let error = opened("samples = 1\n").unwrap_err().to_string();
    assert!(error.contains("a.hdr:8 samples: is there twice, and in line 2 it is another"), "{error}");
    let told = opened("Samples =  2\n").unwrap().report;
    assert!(told.notes.iter().any(|note| note.message.contains("the same as in line 2")), "{told:?}");
}

#[test]
fn the_orientation_of_a_photograph_is_told() {
    let folder = Scratch::new();
    let picture = include_bytes!("../data/pictures/two_greys.jpg");
    // An APP1 segment with one tag, 0x0112, of one SHORT: 6.
    for (is_big, order) in [(true, b"MM"), (false, b"II")] {
        let short = |v: u16| if is_big { v.to_be_bytes() } else { v.to_le_bytes() };
        let long = |v: u32| if is_big { v.to_be_bytes() } else { v.to_le_bytes() };
        let tiff = [
            &order[..],
            &short(42),
            &long(8),
            &short(1),
            &short(0x0112),
            &short(3),
            &long(1),
            &short(6),
            &short(0),
            &long(0),
        ]
        .concat();
        let exif = [&b"Exif\0\0"[..], &tiff].concat();
        let length = (exif.len() as u16 + 2).to_be_bytes();
        let whole = [&picture[..2], &[0xff, 0xe1], &length, &exif, &picture[2..]].concat();
        let raster = raster::open(&folder.write("a.jpg", whole)).unwrap();
        assert!(raster.report.notes.iter().any(|n| n.message.starts_with("orientation 6 of EXIF")), "{is_big}");
    }
    let plain = raster::open(&folder.write("a.jpg", picture)).unwrap();
    assert!(plain.report.notes.iter().all(|n| !n.message.contains("orientation")));
}

#[test]
fn morph_targets_stand_where_weights_put_them() {
    let folder = Folder::new();
    let (mut file, mut binary) = quad();
    // Each vertex one up, and one to the right.
    binary.extend(f32s(&[0.0, 0.0, 1.0].repeat(4)));
    binary.extend(f32s(&[1.0, 0.0, 0.0].repeat(4)));
    for (i, offset) in [60, 108].into_iter().enumerate() {
        let mut add = |list: &str, value| file[list].as_array_mut().unwrap().push(value);
        add("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": 48 }));
        add("accessors", json!({ "bufferView": 2 + i, "componentType": 5126, "type": "VEC3", "count": 4 }));
    }
    file["buffers"][0]["byteLength"] = json!(156);
    file["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 2 }, { "POSITION": 3 }]);
    let first = |file: &serde_json::Value| folder.read(file, &binary).unwrap().0.mesh.vertices_m[0];
    assert_eq!(first(&file), DVec3::ZERO);
    // z of glTF is -y here.
    file["meshes"][0]["weights"] = json!([0.5, 2.0]);
    assert_eq!(first(&file), DVec3::new(2.0, -0.5, 0.0));
    file["nodes"][0]["weights"] = json!([0.25, 0.0]);
    assert_eq!(first(&file), DVec3::new(0.0, -0.25, 0.0));
    file["nodes"][0]["weights"] = json!([0.0, 0.0, 1.0]);
    assert!(folder.read(&file, &binary).unwrap_err().to_string().contains("3 weights for 2 morph targets"));
    file["nodes"][0] = json!({ "mesh": 0, "skin": 0 });
    assert!(folder.read(&file, &binary).unwrap_err().to_string().contains("nodes[0].skin"));
}
