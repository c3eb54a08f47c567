//! Files as they are found whose meaning is easily taken for another: what they say is computed by hand.

use glam::DVec3;
use mmxrt::formats::{registry, scene_toml, spectrum_csv};
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;
use mmxrt::spectral::{Extend, solar_e490};
use mmxrt::study;
use serde_json::json;

use crate::cli::run;
use crate::gltf::{Folder, f32s, quad};
use crate::map_files::Bench;
use crate::scenes::SQUARE;
use crate::scratch::Scratch;

/// ASTM E490-00a has 1366.091 W m-2 in all.
const E490_W_M2: f64 = 1366.090796839;

/// A square under a Sun in the zenith, 1 au away, and what was told of that Sun.
fn under(folder: &Scratch, sun: &str) -> (Scene, String) {
    folder.write("square.obj", "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nf 1 2 3\nf 1 3 4\n");
    let text = SQUARE
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
    assert!((scene.sky.sun.total_irradiance_1au_w_m2 - 1.6).abs() < 1e-12);
    assert!((temperature_k(&scene) / (1.6_f64 / 5.670374419e-8).powf(0.25) - 1.0).abs() < 1e-9);
    assert!(told.contains("1.60 W m-2 in the table, which is not that of the Sun: nothing is added"), "{told}");
    // A total that is given is the table's own.
    let (scene, _) = under(&folder, "spectrum = \"lamp.csv\"\ntotal_irradiance_w_m2 = 3.2");
    assert_eq!((scene.sky.sun.total_irradiance_1au_w_m2, scene.sky.sun.irradiance_1au.at(1.0)), (3.2, Some(2.0)));
}

#[test]
fn a_table_of_the_sun_that_ends_early_is_continued_by_e490() {
    let folder = Scratch::new();
    let e490 = solar_e490();
    let rows = e490.wavelength_um().iter().zip(e490.value()).filter(|(um, _)| (0.3..=2.5).contains(*um));
    let rows: String = rows.map(|(um, value)| format!("{um},{}\n", 0.97 * value)).collect();
    folder.write("cut.csv", format!("wavelength_um,irradiance_w_m2_um\n{rows}"));
    let (scene, told) = under(&folder, "spectrum = \"cut.csv\"");
    let total = scene.sky.sun.total_irradiance_1au_w_m2;
    assert!((total / (0.97 * E490_W_M2) - 1.0).abs() < 1e-9, "{total}");
    assert!(told.contains("of E490 beyond its ends, scaled by 0.9700"), "{told}");
    // What the table holds is scaled to the part of the total that it has.
    let (scene, _) = under(&folder, "spectrum = \"cut.csv\"\ntotal_irradiance_w_m2 = 1361");
    let at_1_um = scene.sky.sun.irradiance_1au.at(1.0).unwrap();
    assert!((at_1_um / (747.9 * 1361.0 / E490_W_M2) - 1.0).abs() < 1e-9, "{at_1_um}");
    assert_eq!(scene.sky.sun.total_irradiance_1au_w_m2, 1361.0);
    // One point has the ratio, and no integral.
    folder.write("point.csv", "wavelength_um,irradiance_w_m2_um\n1,373.95\n");
    let (scene, _) = under(&folder, "spectrum = \"point.csv\"");
    assert!((scene.sky.sun.total_irradiance_1au_w_m2 / (0.5 * E490_W_M2) - 1.0).abs() < 1e-9);
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
        let [a, b] = [&scene, &back].map(|s| s.sky.sun.total_irradiance_1au_w_m2);
        assert!((a / b - 1.0).abs() < 1e-12, "{sun}: {a} {b}");
        let [a, b] = [&scene, &back].map(|s| s.sky.sun.irradiance_1au.at(1.0).unwrap());
        assert!((a / b - 1.0).abs() < 1e-12, "{sun}: {a} {b}");
    }
}

#[test]
fn the_column_that_names_wavelength_is_it_wherever_it_stands() {
    for text in [
        "band,wavelength_nm,reflectance\n1,400,0.05\n2,900,0.15\n3,2500,0.3\n",
        "reflectance,wavelength_um\n0.05,0.4\n0.15,0.9\n0.3,2.5\n",
        "sigma;reflectance;Wavelength (nm)\n9;0.05;400\n9;0.15;900\n9;0.3;2500\n",
        ",wavelength_um,reflectance\n0,0.4,0.05\n1,0.9,0.15\n2,2.5,0.3\n",
    ] {
        let path = std::path::Path::new("a.csv");
        let read = spectrum_csv::parse(text, path, spectrum_csv::Quantity::Reflectance, Extend::Error);
        let (spectrum, report) = read.unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(spectrum.wavelength_um(), [0.4, 0.9, 2.5], "{text}");
        assert_eq!((spectrum.value(), report.notes.len()), (&[0.05, 0.15, 0.3][..], 0), "{text}");
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
    let opened = |more: &str| registry::image(&folder.write("a.hdr", format!("{head}{more}")));
    for key in ["major frame offsets", "minor frame offsets"] {
        let error = opened(&format!("{key} = {{4, 4}}\n")).unwrap_err().to_string();
        assert!(error.contains(&format!("a.hdr:8 {key}")), "{error}");
        opened(&format!("{key} = {{0, 0}}\n")).unwrap();
    }
    let error = opened("samples = 1\n").unwrap_err().to_string();
    assert!(error.contains("a.hdr:8 samples: appears twice, and in line 2 it is another"), "{error}");
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
        let raster = registry::image(&folder.write("a.jpg", whole)).unwrap();
        assert!(raster.report.notes.iter().any(|n| n.message.starts_with("orientation 6 of EXIF")), "{is_big}");
    }
    let plain = registry::image(&folder.write("a.jpg", picture)).unwrap();
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

#[test]
fn a_file_of_another_kind_is_named() {
    let bench = Bench::new();
    let folder = &bench.0;
    let recipe = "version = 1\nseed = 1\nsize_m = 10\nfacets = 100\n";
    for (name, text) in [("recipe.toml", recipe), ("mesh.fbx", "; FBX 7.4.0 project file\n")] {
        folder.write(name, text);
    }
    folder.write("mesh.glb", b"\x89PNG\r\n\x1a\n");
    folder.write("png.toml", SQUARE.replace("obj = \"square.obj\"", "file = \"mesh.glb\""));
    folder.write("csv.toml", SQUARE.replace("obj = \"square.obj\"", "file = \"facets.csv\""));
    folder.write("both.toml", SQUARE.replace("obj = ", "file = \"square.obj\"\nobj = "));
    folder.write("fbx.toml", SQUARE.replace("square.obj", "mesh.fbx"));
    folder.write("facets.csv", "facet,radiance_w_m2_sr_um at 0.55 um\n0,1.5\n1,2.5\n");
    folder.write("other.hdr", "no header of ENVI\n");
    folder.write("other.mtl", "");
    let out = folder.argument("made");
    let all = |arguments: &[&str]| {
        let arguments: Vec<String> = arguments
            .iter()
            .map(|a| if a.contains('.') && !a.starts_with('-') { folder.argument(a) } else { (*a).to_owned() })
            .collect();
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let (code, told, error) = run(&arguments);
        (code, told + &error)
    };
    for (arguments, expected) in [
        (&["simulate", "square.obj", "-o", &out][..], "is a mesh (OBJ), no TOML text"),
        (&["simulate", "recipe.toml", "-o", &out], "is the recipe of a landscape"),
        (&["simulate", "m.map.toml", "-o", &out], "is a map file"),
        (&["landscape", "scene.toml", "-o", &out], "is a scene file"),
        (&["integrate", "scene.toml", "--radiance", "scene.toml", "-o", &out], "is a scene file"),
        (&["simulate", "png.toml", "-o", &out], "mesh.glb: is PNG, but a mesh is needed"),
        (&["simulate", "csv.toml", "-o", &out], "facets.csv: is csv, but a mesh is needed"),
        (&["simulate", "both.toml", "-o", &out], "give either `file` (or `obj`, which is the same) or `recipe`"),
        (&["simulate", "fbx.toml", "-o", &out], "is a mesh in a format that is not read"),
    ] {
        let (code, told) = all(arguments);
        assert!(code == 1 && told.contains(expected), "{arguments:?}: {told}");
    }
    let (code, told) = all(&["inspect", "facets.csv"]);
    assert!(code == 0 && told.contains("radiance of facets") && told.contains("facets: 2"), "{told}");
    assert_eq!(all(&["inspect", "other.mtl"]).0, 0);
}

#[test]
fn text_is_read_in_utf_16_and_with_cr_alone() {
    let folder = Scratch::new();
    let text = "wavelength_um,reflectance\n0.5,0.25\n1,0.5\n";
    let units: Vec<u16> = format!("\u{feff}{text}").encode_utf16().collect();
    let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    for bytes in [little, big, text.replace('\n', "\r").into_bytes()] {
        let path = folder.write("a.csv", bytes);
        let (read, _, _) = spectrum_csv::read(&path, spectrum_csv::Quantity::Reflectance, Extend::Error).unwrap();
        assert_eq!((read.wavelength_um(), read.value()), (&[0.5, 1.0][..], &[0.25, 0.5][..]));
    }
    folder.write("a.hdr", "ENVI\rsamples = 1\rlines = 1\rbands = 1\rdata type = 1\r");
    assert_eq!(registry::image(&folder.write("a.img", [7])).unwrap().pixels(), 1);
}

#[test]
fn a_table_of_filters_is_not_taken_for_reflectances_in_silence() {
    let folder = Scratch::new();
    folder.write("filters.csv", "wavelength_nm,F1,F2\n400,0,0\n500,1,0\n600,0,1\n700,0,0\n");
    let (code, told, _) = run(&["inspect", &folder.argument("filters.csv")]);
    assert!(code == 0 && told.contains("responses of bands"), "{told}");
    folder.write("square.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let scene = folder.write("scene.toml", SQUARE.replace("reflectance = 0.1", "reflectance = \"filters.csv\""));
    let error = scene_toml::read(&scene, &unwatched).unwrap_err().to_string();
    assert!(error.contains("holds 2 spectra") && error.contains("responses of bands"), "{error}");
}

#[test]
fn a_product_is_looked_at_by_its_folder_or_its_cube() {
    let bench = Bench::new();
    let folder = &bench.0;
    let product = folder.argument("out");
    assert_eq!(run(&["simulate", &folder.argument("scene.toml"), "-o", &product, "--quiet"]).0, 0);
    let (code, _, err) = run(&["inspect", &product, "--picture", &folder.argument("a.png"), "--quiet"]);
    assert!(code == 0 && std::fs::read(folder.join("a.png")).unwrap().starts_with(b"\x89PNG"), "{err}");
    let (code, _, err) = run(&["inspect", &product, "--picture", &folder.argument("a.jpg")]);
    assert!(code == 1 && err.contains("ends in .png") && !folder.join("a.jpg").exists(), "{err}");
    let (code, _, err) = run(&["inspect", &folder.argument("out/cube.img"), "--pixel", "0,0"]);
    assert!(code == 1 && err.contains("is not the folder of a product") && err.contains("out"), "{err}");
    let (code, err) = bench.try_to(&["--radiance", &product]);
    assert!(code == 1 && err.contains("is a product: a map is one of its images"), "{err}");
}

#[test]
fn weights_of_maps_multiply() {
    let bench = Bench::new();
    let once = bench.integrate(&["--radiance", "{}m.csv*6"]);
    assert_eq!(bench.integrate(&["--radiance", "{}m.csv*2*3"]), once);
    assert_eq!(once, [6.0, 12.0, 18.0, 24.0]);
}
