//! Bad scene files: each is told at its place, in words that say what to do.

use std::path::Path;

use crate::cli::run;
use crate::scratch::Scratch;
use mmxrt::formats::{picture, scene_toml};
use mmxrt::progress::unwatched;

const GOOD: &str = r##"mmxrt_scene = 1
origin_m = [0, 0, 10000]
[[mesh]]
obj = "plate.obj"
[materials]
ground = { reflectance = "flat.csv" }
"#ff0000" = { reflectance = 0.2, emissivity = 0.8 }
mix = { mixture = { ground = 0.25, "#ff0000" = 0.75 } }
[sun]
direction = [0, 0, 1]
distance_au = 1.5
[mars]
position_m = [9.4e6, 0, 0]
[thermal]
model = "equilibrium"
[observer]
position_m = [0, 0, 20000]
target_m = [0, 0, 10000]
up = [0, 1, 0]
[sensor]
samples = 8
lines = 4
fov_deg = 1.0
[sensor.bands]
start_um = 1.0
stop_um = 2.0
count = 3
"##;

const PLATE: &str = "mtllib plate.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl ground\nf 1 2 3 4\nusemtl red\nf 1 2 3\nusemtl mix\nf 1 2 3\n";

fn prepared() -> Scratch {
    let folder = Scratch::new();
    folder.write("plate.obj", PLATE);
    folder.write("plate.mtl", "newmtl ground\nKd 0.5 0.5 0.5\nnewmtl red\nKd 1 0.002 0\nnewmtl mix\n");
    folder.write("flat.csv", "wavelength_nm,reflectance_percent\n900,5\n2500,15\n");
    folder.write("short.csv", "wavelength_um,reflectance\n0.9,0.05\n1.4,0.15\n");
    folder.write("bare.csv", "110,0.05\n140,0.15\n");
    folder.write("nm.csv", "wavelength_um,reflectance\n900,0.05\n2500,0.15\n");
    // W m-2 nm-1 under the wrong name.
    folder.write("weak.csv", "wavelength_um,irradiance_w_m2_um\n0.9,0.9\n2.5,0.05\n");
    folder.write("wild.csv", "wavelength_um,reflectance\n1,0.1\n0.5,inf\n");
    folder.write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    folder.write("empty.obj", "v 0 0 0\n");
    folder.write("unnamed.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("recipe.toml", "version = 1\nseed = 1\nfacets = 3\n");
    folder.write("recipe_key.toml", "version = 1\nseeds = 1\n");
    folder
}

#[test]
fn a_mesh_is_a_file_of_any_format() {
    let folder = prepared();
    let read = |mesh: &str| {
        let scene = GOOD
            .replace("obj = \"plate.obj\"", mesh)
            .replace("[materials]", "[materials]\ndefault = { reflectance = 0.1 }");
        scene_toml::read(&folder.write("scene.toml", scene), &unwatched).unwrap_or_else(|e| panic!("{mesh}: {e}"))
    };
    let corners = |file: &scene_toml::SceneFile| file.scene.body.mesh.vertices_m.clone();
    let plate = corners(&read("file = \"plate.obj\""));
    assert_eq!((plate[0].to_array(), plate.len()), ([-1.0, -1.0, 0.0], 4));
    assert_eq!(corners(&read("obj = \"plate.obj\"")), plate);
    // What it is called says nothing against what it holds.
    folder.write("plate.txt", PLATE);
    assert_eq!(corners(&read("file = \"plate.txt\"")), plate);
    // (0, 1, 0), (1, 1, 0), (0, 1, -1) as f32 in base64: y is up in glTF, and -z is the north.
    let gltf = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,1,-1],"max":[1,1,0]}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAgD8AAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAIC/"}]}"#;
    folder.write("step.gltf", gltf);
    let found = |more: &str| {
        corners(&read(&format!("file = \"step.gltf\"\n{more}"))).iter().map(|v| v.to_array()).collect::<Vec<_>>()
    };
    assert_eq!(found(""), [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
    assert_eq!(found("up = \"y\"\nunit_m = 10"), [[0.0, 0.0, 10.0], [10.0, 0.0, 10.0], [0.0, 10.0, 10.0]]);
    assert_eq!(found("up = \"z\""), [[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, -1.0]]);
    // The same plate by way of a GLB, whose material names are the scene's; its origin is another.
    let arguments = |names: [&str; 2]| names.map(|name| folder.argument(name));
    let [obj, glb] = arguments(["plate.obj", "plate.glb"]);
    assert_eq!(run(&["convert", &obj, &glb, "--origin-m", "0,0,5"]).0, 0);
    let of_glb = read("file = \"plate.glb\"");
    assert_eq!(corners(&of_glb), plate);
    assert_eq!(of_glb.scene.body.mesh.material, read("file = \"plate.obj\"").scene.body.mesh.material);
    assert!(of_glb.inputs.iter().any(|input| input.path.ends_with("plate.glb")), "{:?}", of_glb.inputs);
    assert!(
        of_glb.notes.iter().any(|note| note.contains("the file's own origin is [0, 0, 5], m")),
        "{:?}",
        of_glb.notes
    );
}

#[test]
fn the_good_scene_is_read() {
    let folder = prepared();
    let file = scene_toml::read(&folder.write("scene.toml", GOOD), &unwatched).unwrap();
    let scene = &file.scene;
    assert_eq!(scene.body.mesh.facets.len(), 4);
    assert_eq!(scene.body.mesh.material.iter().map(|m| m.0).collect::<Vec<_>>(), [0, 0, 1, 2]);
    let names: Vec<&str> = scene.body.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["ground", "#ff0000", "mix"]);
    // 5 to 15 % from 0.9 to 2.5 um: 0.05 + 0.1 x 0.7 / 1.6 at 1.6 um.
    let ground = 0.05 + 0.1 * 0.7 / 1.6;
    let [a, b, mix] = &scene.body.materials[..] else { panic!() };
    assert!((a.reflectance.at(1.6).unwrap() - ground).abs() < 1e-15);
    assert!((a.emissivity.at(1.6).unwrap() - (1.0 - ground)).abs() < 1e-15);
    assert!((mix.reflectance.at(1.6).unwrap() - (0.25 * ground + 0.75 * 0.2)).abs() < 1e-15);
    assert_eq!(mix.mixture, [(0, 0.25), (1, 0.75)]);
    assert_eq!(b.emissivity.at(3.0), Some(0.8));
    assert!((b.bond_albedo - 0.2).abs() < 1e-12 && b.emissivity_bolometric == 0.95);
    assert_eq!(scene.sky.sun.distance_m, 1.5 * 149_597_870_700.0);
    assert!((scene.sky.sun.total_irradiance_1au_w_m2 - 1366.090796839).abs() < 1e-6);
    let camera = &scene.exposure.camera;
    assert_eq!(camera.centre_m().to_array(), [0.0, 0.0, 10000.0]);
    // Looking down with north up: right is east, the image's bottom is south.
    let axes = camera.world_from_sensor.rotation;
    assert_eq!(axes.x_axis.to_array(), [1.0, 0.0, 0.0]);
    assert_eq!(axes.y_axis.to_array(), [0.0, -1.0, 0.0]);
    assert_eq!(axes.z_axis.to_array(), [0.0, 0.0, -1.0]);
    assert!((camera.pitch[0] - 2.0 * 0.5_f64.to_radians().tan() / 8.0).abs() < 1e-18);
    let centres: Vec<f64> = scene.exposure.bands.iter().map(|b| b.centre_um).collect();
    assert_eq!(centres, [1.0, 1.5, 2.0]);
    let read: Vec<&str> = file.inputs.iter().filter_map(|i| i.path.file_name()?.to_str()).collect();
    assert_eq!(read, ["scene.toml", "flat.csv", "plate.obj", "plate.mtl"]);
    for item in ["sun.spectrum", "mars.radius_m", "materials.ground.bond_albedo", "sensor.bands.fwhm_um"] {
        assert!(file.defaults.iter().any(|d| d.item == item), "{item} in {:?}", file.defaults);
    }
}

#[test]
fn faces_without_a_material_are_the_default_and_a_mesh_can_be_of_one() {
    let folder = prepared();
    let with_default = GOOD.replace("[sun]", "default = { reflectance = 0.3 }\n[sun]");
    let read = |text: &str| scene_toml::read(&folder.write("scene.toml", text), &unwatched).unwrap().scene;
    let unnamed = read(&with_default.replace("plate.obj", "unnamed.obj"));
    assert_eq!(unnamed.body.materials[unnamed.body.mesh.material[0].0 as usize].name, "default");
    let all_mix = read(&GOOD.replace("obj = \"plate.obj\"", "obj = \"plate.obj\"\nmaterial = \"mix\""));
    assert_eq!(all_mix.body.mesh.material.iter().map(|m| m.0).collect::<Vec<_>>(), [2; 4]);
    let unnamed = read(&GOOD.replace("obj = \"plate.obj\"", "obj = \"unnamed.obj\"\nmaterial = \"ground\""));
    assert_eq!(unnamed.body.mesh.material.len(), 1);
}

#[test]
fn reading_stops_when_it_is_asked_to() {
    let folder = prepared();
    let path = folder.write("scene.toml", GOOD.replace("obj = \"plate.obj\"", "recipe = \"recipe.toml\""));
    let stopped = scene_toml::read(&path, &|progress| progress.stage != "reading the scene");
    assert!(matches!(stopped, Err(mmxrt::Error::Interrupted)), "{stopped:?}");
    let good = folder.write("scene.toml", GOOD);
    let stopped = scene_toml::read(&good, &|progress| progress.stage != "reading meshes");
    assert!(matches!(stopped, Err(mmxrt::Error::Interrupted)), "{stopped:?}");
}

/// (text of the good scene, what stands in its place, place of the problem, words of the message)
const CASES: &[(&str, &str, &str, &str)] = &[
    // keys, types, values
    ("mmxrt_scene = 1\n", "", "scene.toml", "`mmxrt_scene` is missing"),
    ("mmxrt_scene = 1", "mmxrt_scene = 2", ":1:15 mmxrt_scene", "2 is more than 1"),
    ("origin_m = [0, 0, 10000]", "origin_m = [0, 0]", ":2:12 origin_m", "expected a list of 3, found 2"),
    (
        "origin_m = [0, 0, 10000]",
        "origin_m = [0, 0, \"a\"]",
        ":2:19 origin_m[2]",
        "expected a number, found the string \"a\"",
    ),
    ("origin_m = [0, 0, 10000]", "origin_m = [0, 0, nan]", ":2:19 origin_m[2]", "not a finite number"),
    ("[thermal]", "[thermel]", ":14:2 thermel", "did you mean `thermal`?"),
    ("samples = 8", "sample = 8", ":21:1 sensor.sample", "did you mean `samples`?"),
    ("samples = 8", "samples = 8.5", ":21:11 sensor.samples", "expected a whole number, found 8.5"),
    ("samples = 8", "samples = 1_000_000_000", ":21:11 sensor.samples", "is more than 16384"),
    ("model = \"equilibrium\"", "model = \"thesis2\"", ":15:9 thermal.model", "did you mean \"thesis\"?"),
    ("count = 3", "count = 3\ncount = 4", ":28:1", "duplicate key"),
    ("[sun]", "[sun", ":9:5", ""),
    ("origin_m = [0, 0, 10000]", "origin_m = [0, 0, 1e300]", ":2:12 origin_m", "more than 1e18 m away"),
    ("position_m = [9.4e6, 0, 0]", "position_m = [1e200, 0, 0]", ":13:14 mars.position_m", "more than 1e18 m away"),
    // meshes
    ("obj = \"plate.obj\"", "obj = \"none.obj\"", ":4:7 mesh[0].obj", "none.obj: there is no such file"),
    ("obj = \"plate.obj\"", "obj = \"nan.obj\"", "nan.obj:1: ", "not a finite number"),
    ("obj = \"plate.obj\"", "obj = \"nan.obj\"", "nan.obj:4: ", "vertex index 4: the file has 3 vertices"),
    ("obj = \"plate.obj\"", "obj = \"empty.obj\"", "empty.obj: ", "holds no faces"),
    ("obj = \"plate.obj\"", "obj = \"unnamed.obj\"", ":4:7 mesh[0].obj", "add an entry `default`"),
    (
        "obj = \"plate.obj\"",
        "obj = \"plate.obj\"\nmaterial = \"gruond\"",
        ":5:12 mesh[0].material",
        "did you mean \"ground\"?",
    ),
    ("obj = \"plate.obj\"", "obj = \"plate.obj\"\nunit_m = 0", ":5:10 mesh[0].unit_m", "0 is not more than 0"),
    ("obj = \"plate.obj\"", "obj = \"plate.obj\"\npose = \"up\"", ":5:8 mesh[0].pose", "expected"),
    (
        "obj = \"plate.obj\"",
        "obj = \"plate.obj\"\npose = { world_from_mesh_xyzw = [0, 0, 0, 2] }",
        ":5:33 mesh[0].pose",
        "length 1; this one has 2",
    ),
    (
        "obj = \"plate.obj\"",
        "obj = \"plate.obj\"\nrecipe = \"recipe.toml\"",
        ":3:1 mesh[0]",
        "either `file` (or `obj`, which is the same) or `recipe`",
    ),
    (
        "obj = \"plate.obj\"",
        "recipe = { version = 1, seed = 1, facets = 3 }\npose = \"body\"",
        ":4:44 mesh[0].recipe.facets",
        "3 is not from 1000",
    ),
    (
        "obj = \"plate.obj\"",
        "recipe = \"recipe.toml\"\npose = \"body\"",
        "recipe.toml:3:10 facets",
        "3 is not from 1000",
    ),
    (
        "obj = \"plate.obj\"",
        "recipe = \"recipe_key.toml\"\npose = \"body\"",
        "recipe_key.toml:2:1 seeds",
        "did you mean `seed`?",
    ),
    (
        "obj = \"plate.obj\"",
        "recipe = \"none.toml\"\npose = \"body\"",
        ":4:10 mesh[0].recipe",
        "none.toml: there is no such file",
    ),
    // materials
    ("ground = {", "grounds = {", ":4:7 mesh[0].obj", "material \"ground\" of the mesh"),
    ("\"#ff0000\" = {", "\"#ff000\" = {", ":7:12 materials.\"#ff000\"", "not a colour"),
    ("mix = {", "\"#ff0100\" = { reflectance = 0.1 }\nmix = {", ":4:7 mesh[0].obj", "fits several entries"),
    (
        "reflectance = 0.2",
        "reflectance = 20",
        ":7:29 materials.\"#ff0000\".reflectance",
        "if this is percent, write 0.2",
    ),
    ("reflectance = 0.2", "reflectance = -0.2", ":7:29 materials.\"#ff0000\".reflectance", "-0.2 is outside 0 to 1"),
    ("flat.csv", "short.csv", ":6:26 materials.ground.reflectance", "does not cover band 2 at 1.5 um and 1 more"),
    ("flat.csv", "bare.csv", "bare.csv:1:1: ", "does not state the unit"),
    ("flat.csv", "wild.csv", "wild.csv:3:5: ", "`inf` is not a finite number"),
    ("flat.csv", "none.csv", ":6:26 materials.ground.reflectance", "none.csv: there is no such file"),
    ("flat.csv", "nm.csv", ":6:26 materials.ground.reflectance", "is the header `wavelength_nm`?"),
    (
        "reflectance = 0.2",
        "reflectance = -1e308",
        ":7:29 materials.\"#ff0000\".reflectance",
        "-1e308 is outside 0 to 1",
    ),
    (
        "emissivity = 0.8",
        "emissivity_bolometric = 0",
        ":7:58 materials.\"#ff0000\".emissivity_bolometric",
        "0: nothing would cool",
    ),
    ("ground = 0.25", "ground = 0.5", ":8:19 materials.mix.mixture", "shares add up to 1.25, not 1"),
    ("ground = 0.25", "grond = 0.25", ":8:29 materials.mix.mixture.grond", "did you mean \"ground\"?"),
    ("{ ground = 0.25, \"#ff0000\" = 0.75 }", "{}", ":8:19 materials.mix.mixture", "shares add up to 0, not 1"),
    ("{ ground = 0.25, \"#ff0000\" = 0.75 }", "{ mix = 1 }", ":8:19 materials.mix.mixture", "a mixture of itself"),
    (
        "mix = { mixture",
        "mix = { reflectance = 0.1, mixture",
        ":8:7 materials.mix",
        "either `reflectance` or `mixture`",
    ),
    // Sun and Mars
    ("distance_au = 1.5", "distance_au = 2.2e11", ":11:15 sun.distance_au", "1 au is 149597870700 m"),
    ("distance_au = 1.5", "distance_au = -1.5", ":11:15 sun.distance_au", "the Sun is -1.5000 au from the origin"),
    (
        "direction = [0, 0, 1]\ndistance_au = 1.5",
        "position_m = [3.992e7, 2.1812e8, 1.1501e7]",
        ":10:14 sun.position_m",
        "positions are in metres",
    ),
    ("direction = [0, 0, 1]", "direction = [0, 0, 0]", ":10:13 sun.direction", "has no length"),
    ("direction = [0, 0, 1]\n", "", ":9:1 sun", "give `position_m`, or `direction` and `distance_au`"),
    ("distance_au = 1.5", "distance_au = 1.5\ntotal_irradiance_w_m2 = -1", ":12:25 sun.total", "where it is 1361"),
    ("distance_au = 1.5", "distance_au = 1.5\nspectrum = \"flat.csv\"", "flat.csv:1:15: ", "irradiance_w_m2_nm"),
    ("position_m = [9.4e6, 0, 0]", "position_m = [9400, 0, 0]", ":13:14 mars.position_m", "is this in km?"),
    (
        "position_m = [9.4e6, 0, 0]",
        "position_m = [9.4e6, 0, 0]\nalbedo = \"short.csv\"",
        ":14:10 mars.albedo",
        "does not cover band 2",
    ),
    // observer and sensor
    ("up = [0, 1, 0]", "up = [0, 0, 1]", ":19:6 observer.up", "the image's top is undefined"),
    ("target_m = [0, 0, 10000]", "target_m = [0, 0, 20000]", ":18:12 observer.target_m", "is where the camera is"),
    (
        "target_m = [0, 0, 10000]\nup = [0, 1, 0]",
        "h = [1, 0, 0]\nv = [0, 1, 0]\nu = [0, 0, -1]",
        ":20:5 observer.u",
        "mirror image",
    ),
    (
        "target_m = [0, 0, 10000]\nup = [0, 1, 0]",
        "h = [2, 0, 0]\nv = [0, 1, 0]\nu = [0, 0, -1]",
        ":18:5 observer.h",
        "its length is 2",
    ),
    ("up = [0, 1, 0]\n", "", ":16:1 observer", "give one of: `target_m` and `up`"),
    ("fov_deg = 1.0", "fov_deg = 180", ":23:11 sensor.fov_deg", "180 is not less than 180"),
    ("fov_deg = 1.0", "fov_deg = 1.0\nfit = \"scene\"", ":20:1 sensor", "one of `ifov_mrad`, `fov_deg` and `fit`"),
    (
        "start_um = 1.0\nstop_um = 2.0",
        "start_um = 950\nstop_um = 2000",
        ":25:12 sensor.bands.start_um",
        "if this is nanometres, write 0.95",
    ),
    ("stop_um = 2.0", "stop_um = 1.0", ":27:9 sensor.bands.count", "3 bands cannot lie between 1 and 1 um"),
    ("count = 3", "count = 3\nfwhm_um = [0.01, 0.01]", ":28:11 sensor.bands.fwhm_um", "2 widths for 3 bands"),
    ("count = 3", "count = 3\nfwhm_um = 10", ":28:11 sensor.bands.fwhm_um", "a width of 10 um"),
    ("count = 3", "count = 3\nfwhm_um = -0.1", ":28:11 sensor.bands.fwhm_um", "a width of -0.1 um"),
];

#[test]
fn each_problem_is_told_at_its_place() {
    let folder = prepared();
    let (mut seen, mut failures) = (0, Vec::new());
    for (good, bad, place, words) in CASES {
        assert_eq!(GOOD.matches(good).count(), 1, "{good:?} must be in the good scene once");
        let error = scene_toml::read(&folder.write("scene.toml", GOOD.replace(good, bad)), &unwatched);
        let told = error.as_ref().map_or_else(|e| e.to_string(), |_| "accepted".to_owned());
        if !told.lines().any(|line| line.contains(place) && line.contains(words)) {
            failures.push(format!("{bad:?}\nexpected {place} {words}\n{told}"));
        } else if let Err(error) = error {
            assert!(picture(&error).lines().any(|line| line.contains(words)), "{}", picture(&error));
        }
        seen += 1;
    }
    assert!(failures.is_empty(), "{} of {seen}:\n{}", failures.len(), failures.join("\n\n"));
    assert!(seen >= 50);
}

/// What is changed in the good scene, and what is said of it, once.
const UNUSUAL: &[(&str, &str, &str)] = &[
    ("distance_au = 1.5", "distance_au = 1.5\ntotal_irradiance_w_m2 = 1.361", "where it is 1361"),
    ("distance_au = 1.5", "distance_au = 1.5\nspectrum = \"weak.csv\"", "times the irradiance of the Sun (E490)"),
    ("distance_au = 1.5", "distance_au = 0.05", "the Sun is 0.0500 au from the origin"),
    ("position_m = [9.4e6, 0, 0]", "position_m = [9.4e6, 0, 0]\nradius_m = 3389.5", "if this is km"),
    ("position_m = [9.4e6, 0, 0]", "position_m = [9.4e6, 0, 0]\nthermal_exitance_w_m2 = 2000", "2000 W m-2"),
    (
        "obj = \"plate.obj\"",
        "obj = \"plate.obj\"\npose = { world_from_mesh_xyzw = [0, 0, 0.7071068, 0.7071068] }",
        "2.7e-8 off 1",
    ),
    ("obj = \"plate.obj\"", "obj = \"plate.obj\"\npose = \"radial\"", "east"),
    ("fov_deg = 1.0", "ifov_mrad = 1200", "a pixel of 1200 mrad"),
    (
        "target_m = [0, 0, 10000]\nup = [0, 1, 0]",
        "h = [0.7071068, 0.7071068, 0]\nv = [0.7071068, -0.7071068, 0]\nu = [0, 0, -1]",
        "axes of length 1",
    ),
    ("ground = 0.25, \"#ff0000\" = 0.75", "ground = 0.3333333, \"#ff0000\" = 0.6666666", "rounded shares"),
];

#[test]
fn what_is_unusual_and_defined_is_computed_and_told() {
    let folder = prepared();
    folder.write("plate.obj", PLATE);
    for (good, unusual, words) in UNUSUAL {
        assert_eq!(GOOD.matches(good).count(), 1, "{good:?} must be in the good scene once");
        let file = scene_toml::read(&folder.write("scene.toml", GOOD.replace(good, unusual)), &unwatched)
            .unwrap_or_else(|e| panic!("{unusual}: {e}"));
        let told = file.notes.iter().filter(|note| note.contains(words)).count();
        assert_eq!(told, 1, "{unusual}: {:?}", file.notes);
        let scene = &file.scene;
        let rotation = scene.exposure.camera.world_from_sensor.rotation;
        let off = rotation * rotation.transpose() - glam::DMat3::IDENTITY;
        assert!(off.to_cols_array().iter().all(|x| x.abs() < 1e-15), "{unusual}: {rotation}");
        for material in &scene.body.materials {
            let sum: f64 = material.mixture.iter().map(|(_, share)| share).sum();
            assert!((sum - 1.0).abs() < 1e-15, "{unusual}: {sum}");
        }
    }
    assert!(UNUSUAL.len() >= 10);
    // A turn by 90 deg about z takes (1, 1, 0) to (-1, 1, 0), to the last digits but for the direction that rounding left.
    let turned = GOOD.replace("obj = \"plate.obj\"", UNUSUAL[5].1);
    let corner_m = folder.scene(&turned).body.mesh.vertices_m[2];
    assert!((corner_m - glam::DVec3::new(-1.0, 1.0, 0.0)).length() < 1e-15, "{corner_m}");
    // At the north pole, east is y of the body, as on the meridian of longitude 0, so that north is -x.
    let polar = GOOD.replace("obj = \"plate.obj\"", UNUSUAL[6].1);
    assert_eq!(folder.scene(&polar).body.mesh.vertices_m[2], glam::DVec3::new(-1.0, 1.0, 0.0));
}

#[test]
fn all_problems_are_told_at_once() {
    let folder = prepared();
    let mut text = GOOD.to_owned();
    let edits = [
        ("reflectance = 0.2", "reflectance = 20"),
        ("ground = 0.25", "ground = 0.5"),
        ("distance_au = 1.5", "distance_au = 0"),
        ("up = [0, 1, 0]", "up = [0, 0, 0]"),
        ("stop_um = 2.0", "stop_um = 1.0"),
        ("plate.obj", "empty.obj"),
        // Two files that are not there.
        ("\"flat.csv\"", "\"none.csv\", emissivity = \"neither.csv\""),
    ];
    for (good, bad) in edits {
        text = text.replace(good, bad);
    }
    let told = scene_toml::read(&folder.write("scene.toml", &text), &unwatched).unwrap_err().to_string();
    assert_eq!(told.lines().count(), edits.len() + 1, "{told}");
}

#[test]
fn what_a_windows_editor_puts_into_files_changes_nothing() {
    let folder = prepared();
    let read = || scene_toml::read(&folder.join("scene.toml"), &unwatched);
    folder.write("scene.toml", GOOD);
    // The first statement is a vertex: no other line may take its place.
    folder.write("plate.obj", PLATE.replace("mtllib plate.mtl\nv -1 -1 0\n", "v -1 -1 0\nmtllib plate.mtl\n"));
    let plain = read().unwrap().scene;
    for name in ["scene.toml", "plate.obj", "plate.mtl", "flat.csv"] {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        folder.write(name, format!("\u{feff}{}", text.replace('\n', "\r\n")));
    }
    let marked = read().unwrap();
    assert_eq!((&marked.scene.body.mesh, &marked.scene.body.materials), (&plain.body.mesh, &plain.body.materials));
    assert!(!marked.notes.iter().any(|note| note.contains("ignored")), "{:?}", marked.notes);
    // Errors stand on their own line, though the mark moves all bytes.
    let text = format!("\u{feff}{}", GOOD.replace("samples = 8", "sample = 8"));
    folder.write("scene.toml", &text);
    let shown = picture(&read().unwrap_err());
    assert!(shown.contains("scene.toml:21:1") && shown.contains("21 | sample = 8\n   | ^^^^^^"), "{shown}");
}

#[test]
fn many_materials_are_read_in_no_time_and_too_many_are_refused() {
    let folder = prepared();
    let read = |entries: usize| {
        // Each a mixture of the next: the worst order there is.
        let chain =
            (0..entries).map(|i| format!("m{i} = {{ mixture = {{ m{} = 1.0 }} }}\n", i + 1)).collect::<String>();
        let text = GOOD.replace("[sun]", &format!("{chain}m{entries} = {{ reflectance = 0.1 }}\n[sun]"));
        scene_toml::read(&folder.write("scene.toml", &text), &unwatched)
    };
    assert_eq!(read(500).unwrap().scene.body.materials.len(), 504);
    let flat = (0..70_000).map(|i| format!("m{i} = {{ reflectance = 0.1 }}\n")).collect::<String>();
    let text = GOOD.replace("[sun]", &format!("{flat}[sun]"));
    let told = scene_toml::read(&folder.write("scene.toml", &text), &unwatched).unwrap_err().to_string();
    assert!(told.contains("70003 materials: at most 65536"), "{}", &told[..told.len().min(500)]);
}

#[test]
fn how_many_more_problems_there_are_is_told_at_the_end() {
    let folder = prepared();
    folder.write("scene.toml", GOOD);
    folder.write("plate.obj", format!("{PLATE}{}", "f 1 2 99\n".repeat(50)));
    let told = scene_toml::read(&folder.join("scene.toml"), &unwatched).unwrap_err().to_string();
    assert_eq!(told.lines().count(), 21, "{told}");
    assert!(told.lines().next().unwrap().contains("plate.obj:12: vertex index 99"), "{told}");
    assert!(told.lines().last().unwrap().ends_with("and 30 more problems"), "{told}");
}

#[test]
fn many_problems_do_not_each_tell_of_all_entries() {
    let folder = prepared();
    let many: String = (0..2000).map(|i| format!("m{i} = {{ mixture = {{ nowhere_{i} = 1.0 }} }}\n")).collect();
    let path = folder.write("scene.toml", GOOD.replace("[sun]", &format!("{many}[sun]")));
    let error = scene_toml::read(&path, &unwatched).unwrap_err();
    assert!(error.problems().len() >= 2000);
    assert!(error.to_string().len() < 1_000_000);
}

#[test]
fn no_cut_of_a_scene_makes_the_reader_panic() {
    let folder = prepared();
    let mut refused = 0;
    for end in (0..GOOD.len()).step_by(7) {
        refused += usize::from(scene_toml::read(&folder.write("scene.toml", &GOOD[..end]), &unwatched).is_err());
    }
    assert!(refused > 50);
    for bytes in [&b"\xff\xfe\x00"[..], b"\0", &[b'['; 100_000], b"a.a.a=1\na=2"] {
        assert!(scene_toml::read(&folder.write("bytes.toml", bytes), &unwatched).is_err());
    }
}

#[test]
fn a_missing_scene_is_an_io_error() {
    let error = scene_toml::read(Path::new("/nowhere/scene.toml"), &unwatched).unwrap_err();
    assert!(matches!(error, mmxrt::Error::Io { .. }), "{error}");
}
