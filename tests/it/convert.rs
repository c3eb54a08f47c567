//! `mmxrt convert`: what comes back of what is written, what is said of what is lost, and what is refused.

use mmxrt::formats::convert::{Content, differences};
use mmxrt::formats::scene_toml;
use mmxrt::physics::sun_disc::DiscRule;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Photometry, Scene, SunModel};
use serde_json::Value;

use crate::cli::run;
use crate::scratch::Scratch;

/// Everything that a scene file can say, with names and numbers that are easily lost.
const SCENE: &str = r##"mmxrt_scene = 1
origin_m = [-2743.5946, 11860.0360, 0.51269]
[[mesh]]
obj = "ground.obj"
[materials]
"blue unit" = { reflectance = "blue.csv", extend = "hold", emissivity_bolometric = 0.9 }
mix = { mixture = { "blue unit" = 0.3, "#b03020" = 0.7 }, emissivity = "heat.csv" }
"#b03020" = { reflectance = 0.123456789012345678, bond_albedo = 0.1 }
shiny = { reflectance = 0.1, hapke = "hapke.csv" }
bowl = { reflectance = 0.1, emissivity = 0.8, rpv = "rpv.csv" }
[sun]
position_m = [3.992e10, 2.1812e11, 1.1501e10]
spectrum = "sun.csv"
total_irradiance_w_m2 = 1361.0
limb_darkening = 0.35
points = 7
[mars]
position_m = [9.376e6, 0.0, 1.0]
albedo = "mars.csv"
model = "thesis"
eclipse = true
points = 12
day_k = 265.5
heat = true
[[bodies]]
name = "earth"
position_m = [1e11, -2e10, 3.5]
radius_m = 6371000
albedo = "mars.csv"
bond_albedo = 0.3
day_k = 290
night_k = 280.5
[[bodies]]
name = "deimos"
position_m = [-9.376e6, 2e7, 1e5]
radius_m = 6200
albedo = 0.07
thermal_exitance_w_m2 = 200
[[lamps]]
name = "star"
direction = [0.6, 0.0, 0.8]
irradiance = "sun.csv"
total_irradiance_w_m2 = 500.0
[thermal]
model = "thesis"
period_s = 27553.84
axis = [0.0, 0.1, 1.0]
inertia = 55.5
floor_k = 41.5
[observer]
position_m = [-20159.4581, 87145.4911, 3.7671]
target_m = [-2743.5946, 11860.0360, 0.51269]
up = [0.0, 0.0, 1.0]
[sensor]
name = "a \"camera\""
samples = 12
lines = 7
fit = "scene"
bands = { centres_um = [1.1, 1.7, 1.3], fwhm_um = [0.0, 0.01, 0.02] }
"##;

/// A scratch folder with a scene and its files.
fn prepared(text: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("scene.toml", text);
    let corners = ["-9.1 0.3 8", "9 0.1 -8", "3 0.12345678901234567 8e-7", "1e-320 5 1", "5 9 2", "-3 7 0", "-5 5 5"];
    let vertices: String = corners.iter().map(|c| format!("v {c}\n")).collect();
    let faces = "usemtl blue unit\nf 1 2 3\nusemtl mix\nf 2 4 3\nusemtl #b03020\nf 1 3 2\nusemtl shiny\nf 1 2 3\n";
    scratch.write(
        "ground.obj",
        format!("{vertices}{faces}usemtl bowl\nf 1 2 3\nf 1 2 5 7\nf 7 1 2 5\nf 1 2 5 6 7\nf 2 5 6 7 1\n"),
    );
    scratch.write("blue.csv", "wavelength_nm,reflectance_percent\n900,5\n1333.3,7.7\n2500,15\n");
    scratch.write("heat.csv", "wavelength_nm,emissivity_percent\n900,5\n1333.3,7.7\n2500,15\n");
    scratch.write("mars.csv", "wavelength_um,albedo\n0.9,0.1\n2.5,0.3\n");
    scratch.write("sun.csv", "wavelength_um,irradiance_w_m2_um\n0.9,900\n1.5,300\n2.5,50\n");
    scratch.write(
        "hapke.csv",
        "wavelength_um,w,c1,c2,c3,c4,h1,h2\n1,0.3,1.5,0.8,0.1,0,1,0.1\n2,0.4,1.5,0.8,0.1,0,1,0.1\n",
    );
    scratch.write("rpv.csv", "wavelength_um,g,rho0,k,h\n1,-0.1,0.05,0.8,0.05\n2,-0.2,0.06,0.8,0.07\n");
    scratch
}

fn scene_of(path: &std::path::Path) -> Scene {
    scene_toml::read(path, &unwatched).unwrap_or_else(|e| panic!("{e}")).scene
}

fn differ(a: &Scene, b: &Scene) -> Vec<String> {
    let content = |scene: &Scene| Content::Scene(Box::new(scene.clone()), Vec::new());
    differences(&content(a), &content(b))
}

#[test]
fn a_scene_that_is_written_reads_back_the_same() {
    let scratch = prepared(SCENE);
    let (code, out, err) = run(&["convert", &scratch.argument("scene.toml"), &scratch.argument("out/again.toml")]);
    assert_eq!(code, 0, "{err}");
    assert!(!out.contains("Dropped") && !out.contains("Approximated"), "{out}");
    let (a, b) = (scene_of(&scratch.join("scene.toml")), scene_of(&scratch.join("out/again.toml")));
    assert_eq!(differ(&a, &b), [""; 0]);
    // Closer than that: the same bits.
    assert_eq!(a.body.mesh, b.body.mesh);
    assert_eq!(a.body.materials, b.body.materials);
    assert_eq!((&a.sky.mars, &a.sky.bodies), (&b.sky.mars, &b.sky.bodies));
    assert_eq!(a.sky.bodies.len(), 2);
    assert_eq!((a.body.origin_m, a.models.thermal), (b.body.origin_m, b.models.thermal));
    assert_eq!(a.exposure.bands, b.exposure.bands);
    assert_eq!(a.exposure.instrument, b.exposure.instrument);
    assert_eq!(a.exposure.camera.world_from_sensor, b.exposure.camera.world_from_sensor);
    assert_eq!(a.exposure.camera.pitch, b.exposure.camera.pitch);
    assert_eq!((a.sky.sun.direction, a.sky.sun.distance_m), (b.sky.sun.direction, b.sky.sun.distance_m));
    assert_eq!(a.models, b.models);
    assert!(a.models.eclipses && a.models.mars_heat && a.models.mars_shadows == Some(DiscRule::G12));
    assert_eq!(
        (a.models.sun, b.models.sun, b.sky.sun.limb_darkening),
        (SunModel::Disc(DiscRule::G7), a.models.sun, 0.35)
    );
    let bands: Vec<_> = b.exposure.bands.iter().map(|b| b.fwhm_um).collect();
    assert_eq!(bands, [None, Some(0.01), Some(0.02)]);
    let Photometry::Hapke(hapke) = &b.body.materials[3].photometry else { panic!() };
    assert_eq!(hapke.w.at(1.5), Some(0.35));
    let Photometry::Rpv(rpv) = &b.body.materials[4].photometry else { panic!() };
    assert_eq!((rpv.rho0.value(), rpv.g.value()), (&[0.05, 0.06][..], &[-0.1, -0.2][..]));
    // A second time it is the same text.
    let (code, _, err) = run(&["convert", &scratch.argument("out/again.toml"), &scratch.argument("twice/again.toml")]);
    assert_eq!(code, 0, "{err}");
    let text = |name: &str| std::fs::read_to_string(scratch.join(name)).unwrap();
    assert_eq!(text("out/again.toml"), text("twice/again.toml"));
}

#[test]
fn the_shipped_scene_keeps_its_radiance() {
    // The mesh of a recipe, and what the camera fits to, become numbers.
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let shipped = std::fs::read_to_string(root.join("scenes/phobos_site/scene.toml")).unwrap();
    let scratch = Scratch::new();
    let text = shipped.replace("count = 300", "count = 3");
    let site = std::fs::read_to_string(root.join("scenes/phobos_site/site.toml")).unwrap();
    assert!(site.contains("200_000"));
    scratch.write("site.toml", site.replace("200_000", "5_000"));
    let path = scratch.write("scene.toml", text);
    for name in ["blue_unit.csv", "red_unit.csv"] {
        std::fs::copy(root.join("scenes/phobos_site").join(name), scratch.join(name)).unwrap();
    }
    let (code, _, err) =
        run(&["convert", &scratch.argument("scene.toml"), &scratch.argument("folder"), "--to", "scene"]);
    assert_eq!(code, 0, "{err}");
    let (a, b) = (scene_of(&path), scene_of(&scratch.join("folder/scene.toml")));
    assert_eq!(differ(&a, &b), [""; 0]);
    assert!(a.body.mesh == b.body.mesh && a.body.materials == b.body.materials);
    // A folder of a scene is one, and is replaced if asked for and if nothing else is in it.
    let again = ["convert", &scratch.argument("scene.toml"), &scratch.argument("folder"), "--to", "scene"];
    assert_eq!(run(&again).0, 1);
    let (code, _, err) = run(&[&again[..], &["--force"]].concat());
    assert_eq!(code, 0, "{err}");
    scratch.write("folder/thesis.tex", "");
    let (code, _, err) = run(&[&again[..], &["--force"]].concat());
    assert!(code == 1 && err.contains("thesis.tex"), "{err}");
}

#[test]
fn what_cannot_be_simulated_says_where_it_is_asked_for() {
    let texture = "hapke = \"hapke.csv\", texture = { raster = \"texels.csv\", quantity = \"reflectance\", placement = \"plane\", plane = \
                   { corner_m = [-10, 10, 0], along_line_m = [10, 0, 0], line_to_line_m = [0, -10, 0] } }";
    let scratch = prepared(&SCENE.replace("hapke = \"hapke.csv\"", texture));
    scratch.write("texels.csv", "0.1,0.2\n0.3,0.4\n");
    let path = scratch.argument("scene.toml");
    for command in [&["simulate", &path, "-o"][..], &["solve", &path, "-o"]] {
        let (code, out, err) = run(&[command, &[&scratch.argument("out.npz")]].concat());
        assert_eq!((code, out.as_str()), (1, ""));
        // Line 9 holds the Hapke material.
        assert!(err.contains("scene.toml:9:") && err.contains("`hapke` parameters is not supported"), "{err}");
    }
    let (code, out, err) = run(&["inspect", &path]);
    assert!(code == 1 && out.contains(": hapke, reflectance") && err.contains("scene.toml:9:"), "{out}{err}");
    assert!(!scratch.names().contains(&"out.npz".to_owned()));
}

#[test]
fn parameters_that_cannot_be_are_told() {
    for (file, text, told) in [
        (
            "hapke.csv",
            "wavelength_um,w,c1,c2,c3,c4,h1,h2\n1,1.3,0,0,0,0,1,0.1\n2,0.4,0,0,0,0,1,0.1\n",
            "w = 1.3 is out of range, which is from 0 to 1",
        ),
        (
            "hapke.csv",
            "wavelength_um,w,c1,c2,c3,c4,h1,h2\n1,0.3,0,0,0,0,1,0\n2,0.4,0,0,0,0,1,0.1\n",
            "h2 = 0 is out of range",
        ),
        ("hapke.csv", "wavelength_um,w,c1,c2,c3,c4,h1\n1,0.3,0,0,0,0,1\n", "hapke.csv:1: there is no column `h2`"),
        (
            "hapke.csv",
            "wavelength_um,w,c1,c2,c3,c4,h1,h2\n1,0.3,0,0,0,0,1,0.1\n1.5,0.4,0,0,0,0,1,0.1\n",
            "scene.toml:9:38",
        ),
        ("rpv.csv", "wavelength_um,rho0,k,g,h\n1,0.1,0.8,-1,0\n2,0.1,0.8,0,0\n", "g = -1 is out of range"),
    ] {
        let scratch = prepared(SCENE);
        scratch.write(file, text);
        let error = scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap_err().to_string();
        assert!(error.contains(told), "{told}: {error}");
    }
    for (from, to, told) in [
        ("hapke = \"hapke.csv\"", "hapke = \"hapke.csv\", rpv = \"rpv.csv\"", "give either `hapke` or `rpv`"),
        ("\"#b03020\" = 0.7 }", "shiny = 0.7 }", "only Lambert surfaces are mixed"),
        ("emissivity = \"heat.csv\"", "hapke = \"hapke.csv\"", "a mixture has no parameters"),
        ("reflectance = 0.1, hapke", "hapke", "give either `reflectance` or `mixture`"),
    ] {
        let scratch = prepared(&SCENE.replace(from, to));
        let error = scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap_err().to_string();
        assert!(error.contains(told), "{told}: {error}");
    }
}

#[test]
fn meshes_lose_what_they_have_no_place_for_and_say_so() {
    let scratch = prepared(SCENE);
    let scene = scratch.argument("scene.toml");
    for name in ["a.glb", "b.gltf", "c.obj"] {
        let (code, out, err) = run(&["convert", &scene, &scratch.argument(name)]);
        assert_eq!(code, 0, "{err}");
        for item in ["materials", "sun", "mars", "observer", "sensor"] {
            assert!(out.contains(&format!("Dropped, {scene} {item}: ")), "{name}: {out}");
        }
        assert_eq!(out.contains("Approximated"), name != "c.obj", "{out}");
        // With --strict none of it is written.
        let (code, out, _) = run(&["convert", &scene, &scratch.argument(&format!("strict-{name}")), "--strict"]);
        assert!(code == 3 && out.contains("not written"), "{out}");
    }
    let left: Vec<String> =
        scratch.names().into_iter().filter(|n| n.contains("strict") || n.contains("partial")).collect();
    assert_eq!(left, [""; 0]);
    // Back, the surface is the same; through OBJ to the last bit.
    let a = scene_of(&scratch.join("scene.toml"));
    for name in ["a.glb", "b.gltf", "c.obj"] {
        let (code, out, err) = run(&["convert", &scratch.argument(name), &scratch.argument(&format!("{name}.toml"))]);
        assert_eq!(code, 0, "{err}");
        assert!(out.contains("Defaulted") && out.contains("sun: 1 au away"), "{out}");
        let b = scene_of(&scratch.join(&format!("{name}.toml")));
        if name == "c.obj" {
            assert_eq!(a.body.mesh.vertices_m, b.body.mesh.vertices_m);
        } else {
            assert_eq!(a.body.origin_m, b.body.origin_m);
        }
        // Which triangles were a polygon is lost, and was told.
        let of_surface = |line: &String| line.starts_with("mesh") && !line.starts_with("mesh, faces");
        assert!(!differ(&a, &b).iter().any(of_surface), "{:?}", differ(&a, &b));
    }
    // One mesh compared with another.
    assert_eq!(run(&["convert", "--diff", &scratch.argument("a.glb"), &scratch.argument("b.gltf")]).0, 0);
    let (code, out, _) = run(&["convert", "--diff", &scratch.argument("a.glb"), &scratch.argument("c.obj")]);
    assert!(code == 1 && out.starts_with("origin_m: "), "{out}");
}

#[test]
fn differences_are_those_of_meaning() {
    let scratch = prepared(SCENE);
    let other =
        SCENE.replace("samples = 12", "samples = 13").replace("0.3, \"#b03020\" = 0.7", "0.4, \"#b03020\" = 0.6");
    scratch.write("other.toml", other);
    let (code, out, _) = run(&["convert", "--diff", &scratch.argument("scene.toml"), &scratch.argument("other.toml")]);
    assert_eq!(code, 1);
    let lines: Vec<&str> = out.lines().collect();
    assert!(lines[0].starts_with("materials.\"mix\".reflectance at 0.9 um (of "), "{out}");
    assert!(lines.contains(&"sensor.samples: 12, 13"), "{out}");
    // The order of facets and materials, and more points on a line, mean nothing.
    let text = std::fs::read_to_string(scratch.join("ground.obj")).unwrap();
    let faces = text.replace("usemtl blue unit\nf 1 2 3\n", "") + "usemtl blue unit\nf 2 3 1\n";
    scratch.write("turned.obj", faces);
    scratch.write("more.csv", "wavelength_um,albedo\n0.9,0.1\n1.7,0.2\n2.5,0.3\n");
    scratch.write("other.toml", SCENE.replace("ground.obj", "turned.obj").replace("mars.csv", "more.csv"));
    let (code, out, _) = run(&["convert", "--diff", &scratch.argument("scene.toml"), &scratch.argument("other.toml")]);
    assert_eq!((code, out.as_str()), (0, "the same in meaning\n"));
}

#[test]
fn formats_are_told_and_listed() {
    let scratch = prepared(SCENE);
    let (code, out, _) = run(&["convert", "--list"]);
    assert_eq!((code, out.lines().count()), (0, 37), "{out}");
    let (_, out, _) = run(&["convert", "--list", "--json"]);
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["formats"][4]["name"], "glb");
    // A GLB under another name is one all the same.
    let argument = |name: &str| scratch.argument(name);
    assert_eq!(run(&["convert", &argument("ground.obj"), &argument("a.glb")]).0, 0);
    std::fs::rename(scratch.join("a.glb"), scratch.join("a.dat")).unwrap();
    let (code, out, err) = run(&["convert", "--list", &argument("a.dat")]);
    assert!(code == 0 && out == "15 facets\n", "{out}{err}");
    for (arguments, code, told) in [
        (vec!["convert"], 2, "Usage"),
        (vec!["convert", "a"], 2, "required"),
        (vec!["convert", "a", "b", "--to", "fbx"], 2, "formats are scene, blend, obj, gltf"),
        (vec!["convert", "a", "b.glb", "--bands", "1:2"], 2, "FIRST:LAST:COUNT"),
        (vec!["convert", "no-such-file", "b.glb"], 1, "no-such-file: there is no such file or folder"),
        (vec!["convert", &argument("scene.toml"), "b.fbx"], 1, "b.fbx: no format's names end like this"),
        (vec!["convert", &argument("blue.csv"), &argument("b.glb")], 1, "they make no scene"),
        (vec!["convert", &argument("ground.obj"), &argument("b.csv")], 1, "it has no spectra"),
    ] {
        let (found, out, err) = run(&arguments);
        assert!(found == code && err.contains(told), "{arguments:?}: {out}{err}");
    }
    // What is there stays.
    let (code, _, err) = run(&["convert", &argument("scene.toml"), &argument("ground.obj")]);
    assert!(code == 1 && err.contains("--force"), "{err}");
    assert!(!scratch.names().contains(&"ground.mtl".to_owned()));
}

#[test]
fn buffers_outside_the_folder_are_read_if_that_is_allowed() {
    let scratch = prepared(SCENE);
    let argument = |name: &str| scratch.argument(name);
    assert_eq!(run(&["convert", &argument("ground.obj"), &argument("in/a.gltf")]).0, 0);
    std::fs::rename(scratch.join("in/a.bin"), scratch.join("a.bin")).unwrap();
    let text = std::fs::read_to_string(scratch.join("in/a.gltf")).unwrap();
    scratch.write("in/a.gltf", text.replace("\"a.bin\"", "\"../a.bin\""));
    let (code, _, err) = run(&["convert", &argument("in/a.gltf"), &argument("a.obj")]);
    assert!(code == 1 && err.contains("buffers[0]: ") && err.contains("--allow-outside"), "{err}");
    assert_eq!(run(&["convert", &argument("in/a.gltf"), &argument("a.obj"), "--allow-outside"]).0, 0);
    // The same for material files.
    scratch.write("one.mtl", "newmtl blue unit\n");
    scratch.write("in/b.obj", "mtllib ../one.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl blue unit\nf 1 2 3\n");
    let (code, out, _) = run(&["convert", &argument("in/b.obj"), &argument("b.glb")]);
    assert!(code == 0 && out.contains("in/b.obj:1") && out.contains("leads out"), "{out}");
    let (code, out, _) = run(&["convert", &argument("in/b.obj"), &argument("b.glb"), "--allow-outside", "--force"]);
    assert!(code == 0 && !out.contains("leads out"), "{out}");
    // Nor by a link.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(scratch.join("a.bin"), scratch.join("in/a.bin")).unwrap();
        scratch.write("in/a.gltf", text);
        let (code, _, err) = run(&["convert", &argument("in/a.gltf"), &argument("b.obj")]);
        assert!(code == 1 && err.contains("leads out"), "{err}");
    }
}

#[cfg(feature = "sqlite")]
#[test]
fn a_scene_goes_to_dart_and_comes_back() {
    // What DART and its sidecar keep: no Hapke next to mixtures of it is asked for here, that is dart_write's.
    let scratch = prepared(SCENE);
    let argument = |name: &str| scratch.argument(name);
    let (code, out, err) = run(&["convert", &argument("scene.toml"), &argument("dart")]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("scene to dart"), "{out}");
    let (code, out, _) = run(&["convert", "--check", &argument("dart")]);
    assert_eq!(code, 0, "{out}");
    let (code, out, err) = run(&["convert", &argument("dart"), &argument("back/scene.toml"), "--json"]);
    assert_eq!(code, 0, "{err}");
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&json["from"], &json["written"]), (&Value::from("dart"), &Value::from(true)));
    let (code, out, _) = run(&["convert", "--diff", &argument("scene.toml"), &argument("back/scene.toml")]);
    assert_eq!((code, out.as_str()), (0, "the same in meaning\n"));
    // Two simulations: the same.
    assert_eq!(run(&["convert", &argument("back/scene.toml"), &argument("again")]).0, 0);
    let (code, out, _) = run(&["convert", "--diff", &argument("dart"), &argument("again")]);
    assert_eq!((code, out.as_str()), (0, "the same in meaning\n"));
    let (code, _, err) = run(&["convert", &argument("scene.toml"), &argument("new"), "--dart-version", "5.11.0"]);
    assert!(code == 1 && err.contains("scene.toml") && err.contains("--dart-version 5.7.4"), "{err}");
    assert!(err.contains("Hapke's reflectance is not known") && err.contains("RPV reflectance is not known"), "{err}");
    scratch.write("plain.toml", SCENE.replace(", hapke = \"hapke.csv\"", "").replace(", rpv = \"rpv.csv\"", ""));
    let (code, _, err) = run(&["convert", &argument("plain.toml"), &argument("new"), "--dart-version", "5.11.0"]);
    assert_eq!(code, 0, "{err}");
    let (code, out, _) = run(&["convert", "--diff", &argument("dart"), &argument("new")]);
    assert!(code == 1 && out.contains("5.11.0"), "{out}");
    // It is replaced if asked for.
    assert_eq!(run(&["convert", &argument("scene.toml"), &argument("dart")]).0, 1);
    assert_eq!(run(&["convert", &argument("scene.toml"), &argument("dart"), "--force"]).0, 0);
    // A mistake is found.
    let path = scratch.join("dart/input/object_3d.xml");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("indexFctPhase=\"0\"", "indexFctPhase=\"99\"")).unwrap();
    let (code, out, _) = run(&["convert", "--check", &argument("dart")]);
    assert!(code == 1 && out.contains("error: ") && out.contains("object_3d.xml:") && out.contains("99"), "{out}");
    // And so is a database that was cut off.
    let database = scratch.join("new/input/mmxrt_lambertian.db");
    let bytes = std::fs::read(&database).unwrap();
    std::fs::write(&database, &bytes[..4000]).unwrap();
    let (code, out, _) = run(&["convert", "--check", &argument("new")]);
    assert!(code == 1 && out.contains("mmxrt_lambertian.db") && out.contains("4000"), "{out}");
}

/// What DART's files cannot hold is told, item by item, and comes back all the same.
#[cfg(feature = "sqlite")]
#[test]
fn what_dart_cannot_hold_of_a_sky_is_told_and_kept() {
    let text = SCENE.replace("model = \"thesis\"\nperiod_s", "model = \"conduction\"\nsteps = 48\nperiod_s");
    let scratch = prepared(&text);
    let argument = |name: &str| scratch.argument(name);
    let (code, out, err) = run(&["convert", &argument("scene.toml"), &argument("dart")]);
    assert_eq!(code, 0, "{err}");
    for (fate, told) in [
        ("Dropped", "beams.\"star\": a second beam"),
        ("Dropped", "bodies.\"earth\": light and heat"),
        ("Dropped", "bodies.\"deimos\": light and heat"),
        ("Dropped", "mars.heat: its heat as light"),
        ("Carried", "sun: bodies may hide the Sun"),
        ("Approximated", "sun.points: 7 points"),
        ("Approximated", "thermal.model: heat is conducted in 48 steps"),
        ("Approximated", "thermal.floor_k: no part of a facet is colder than 41.5 K"),
        ("Carried", "thermal.period_s: length and axis"),
        ("Carried", "thermal.inertia: DART stores no heat"),
    ] {
        assert!(out.lines().any(|line| line.starts_with(fate) && line.contains(told)), "{told}: {out}");
    }
    let (code, _, err) = run(&["convert", &argument("dart"), &argument("back/scene.toml")]);
    assert_eq!(code, 0, "{err}");
    let (code, out, _) = run(&["convert", "--diff", &argument("scene.toml"), &argument("back/scene.toml")]);
    assert_eq!((code, out.as_str()), (0, "the same in meaning\n"));
    let back = scene_of(&scratch.join("back/scene.toml"));
    assert_eq!((back.sky.bodies.len(), back.sky.beams.len(), back.models.conduction), (2, 1, Some(48)));
    assert!(back.sky.rotation.is_some() && back.body.materials.iter().all(|m| m.thermal_inertia == 55.5));
}

#[cfg(feature = "sqlite")]
#[test]
fn spectra_go_through_every_format() {
    let scratch = prepared(SCENE);
    let argument = |name: &str| scratch.argument(name);
    let (code, out, err) = run(&["convert", &argument("scene.toml"), &argument("all.db")]);
    assert!(code == 0 && out.contains("Dropped"), "{out}{err}");
    assert_eq!(run(&["convert", &argument("scene.toml"), &argument("strict.db"), "--strict"]).0, 3);
    assert!(!scratch.join("strict.db").exists());
    // Neighbours do not know of one another.
    scratch.write("plain.csv", "wavelength_um,reflectance\n1,0.5\n2,0.5\n");
    let source = argument("plain.csv");
    let strict: Vec<_> = (0..8)
        .map(|i| {
            let mut command = crate::cli::mmxrt();
            command.args(["convert", &source, &argument(&format!("strict-{i}.sli")), "--strict"]);
            std::thread::spawn(move || command.output().unwrap())
        })
        .collect();
    for (i, one) in strict.into_iter().enumerate() {
        let output = one.join().unwrap();
        assert!(output.status.success(), "{i}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(scratch.join(&format!("strict-{i}.sli")).exists(), "{i}");
    }
    let (code, out, _) = run(&["convert", "--list", &argument("all.db")]);
    assert!(code == 0 && out.lines().count() == 5 && out.contains("h1, h2 at 2 wavelengths, 1 to 2 um"), "{out}");
    assert_eq!(run(&["convert", "--check", &argument("all.db")]).0, 0);
    // One of them as a table, and from there in all other formats and back.
    let (code, _, err) = run(&["convert", &argument("all.db"), &argument("one.csv"), "--model", "blue_unit"]);
    assert_eq!(code, 0, "{err}");
    for name in ["a.txt", "b.sli", "c.db"] {
        let (code, _, err) = run(&["convert", &argument("one.csv"), &argument(name)]);
        assert_eq!(code, 0, "{name}: {err}");
        let back = argument(&format!("{name}.csv"));
        let (code, _, err) = run(&["convert", &argument(name), &back]);
        assert_eq!(code, 0, "{name}: {err}");
    }
    // At other wavelengths: linear between 5 % at 0.9 um and 7.7 % at 1.3333 um.
    let (code, _, err) =
        run(&["convert", &argument("one.csv"), &argument("bands/one.csv"), "--bands", "1:1.2:3", "--strict"]);
    assert_eq!(code, 0, "{err}");
    let text = std::fs::read_to_string(scratch.join("bands/one.csv")).unwrap();
    let row: Vec<f64> =
        text.lines().find(|l| l.starts_with("1.1,")).unwrap().split(',').map(|c| c.parse().unwrap()).collect();
    assert!((row[1] - (0.05 + 0.027 * 0.2 / 0.4333)).abs() < 1e-12, "{text}");
    let (code, _, err) = run(&["convert", &argument("all.db"), &argument("no.csv"), "--model", "green"]);
    assert!(code == 1 && err.contains("no spectra \"green\" in it; there are "), "{err}");
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn any_name_of_a_material_comes_back() {
    let scratch = Scratch::new();
    let name = "q&<>\"' \\ \u{fc} end";
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    scratch.write("a.obj", format!("mtllib a.mtl\n{corners}usemtl {name}\nf 1 2 3\n"));
    scratch.write("a.mtl", format!("newmtl {name}\nKd 1 1 1\n"));
    let argument = |name: &str| scratch.argument(name);
    for (from, to) in [("a.obj", "scene/a.toml"), ("scene/a.toml", "again/a.toml"), ("again/a.toml", "dart")] {
        let (code, _, err) = run(&["convert", &argument(from), &argument(to)]);
        assert_eq!(code, 0, "{to}: {err}");
    }
    assert_eq!(scene_of(&scratch.join("again/a.toml")).body.materials[0].name, name);
    let (code, _, err) = run(&["convert", &argument("dart"), &argument("back/a.toml")]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(scene_of(&scratch.join("back/a.toml")).body.materials[0].name, name);
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_whose_name_is_not_utf_8_is_converted() {
    use std::os::unix::ffi::OsStrExt;
    let scratch = Scratch::new();
    let path = scratch.path().join(std::ffi::OsStr::from_bytes(b"a\xff.obj"));
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let command = |output: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_mmxrt"));
        command.args(["convert", "--json"]).arg(&path).arg(scratch.join(output)).output().unwrap()
    };
    let out = command("a/scene.toml");
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let json: Value = serde_json::from_slice(&out.stdout).unwrap();
    assert!(json["notes"][0]["file"].as_str().unwrap().ends_with("a\u{fffd}.obj"));
    let out = command("a.csv");
    let json: Value = serde_json::from_slice(&out.stderr).unwrap();
    assert_eq!((out.status.code(), &json["error"]["kind"]), (Some(1), &Value::from("invalid")));
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn a_format_that_is_said_overrules_the_name() {
    let scratch = Scratch::new();
    let argument = |name: &str| scratch.argument(name);
    scratch.write("a.dat", "wavelength_um,reflectance\n1,0.25\n2,0.5\n");
    let (code, out, err) = run(&["convert", "--list", "--from", "csv", &argument("a.dat")]);
    assert!(code == 0 && out == "a: reflectance at 2 wavelengths, 1 to 2 um\n", "{out}{err}");
    // A spectral library by its header.
    assert_eq!(run(&["convert", "--from", "csv", &argument("a.dat"), &argument("b.sli")]).0, 0);
    let (code, out, err) = run(&["convert", "--list", &argument("b.hdr")]);
    assert!(code == 0 && out.starts_with("a: reflectance at 2"), "{out}{err}");
    // Of a folder all tables.
    std::fs::create_dir(scratch.join("all")).unwrap();
    for name in ["all/c.csv", "all/d.csv"] {
        std::fs::copy(scratch.join("a.dat"), scratch.join(name)).unwrap();
    }
    let (code, out, err) = run(&["convert", &argument("all"), &argument("all.db"), "--from", "csv"]);
    assert!(code == 0 && out.ends_with("all.db: 2 spectra, csv to db\n"), "{out}{err}");
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn a_database_grows() {
    let scratch = Scratch::new();
    let argument = |name: &str| scratch.argument(name);
    for (name, value) in [("a.csv", 0.25), ("b.csv", 0.5)] {
        scratch.write(name, format!("wavelength_um,reflectance\n1,{value}\n2,{value}\n"));
    }
    let (code, _, err) = run(&["convert", &argument("b.csv"), &argument("x.db"), "--append"]);
    assert!(code == 1 && err.contains("x.db: there is no such file or folder"), "{err}");
    assert_eq!(run(&["convert", &argument("a.csv"), &argument("x.db")]).0, 0);
    let (code, out, err) = run(&["convert", &argument("b.csv"), &argument("x.db"), "--append"]);
    assert!(code == 0 && out.ends_with("x.db: 1 spectra, csv to db\n"), "{out}{err}");
    let (_, out, _) = run(&["convert", "--list", &argument("x.db")]);
    assert_eq!(out.lines().map(|l| &l[..2]).collect::<Vec<_>>(), ["a:", "b:"], "{out}");
    let (code, _, err) = run(&["convert", &argument("b.csv"), &argument("x.db"), "--append"]);
    assert!(code == 1 && err.contains("table b: is there already"), "{err}");
    assert_eq!(run(&["convert", &argument("b.csv"), &argument("x.db"), "--append", "--force"]).0, 2);
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn what_would_change_nothing_is_refused() {
    let scratch = prepared(SCENE);
    let argument = |name: &str| scratch.argument(name);
    let (scene, dart) = (argument("scene.toml"), argument("dart"));
    assert_eq!(run(&["convert", &scene, &dart]).0, 0);
    for (arguments, told) in [
        (vec![&*scene, "x.glb", "--bands", "1:2:3", "--model", "mix"], vec!["--model: changes", "--bands: changes"]),
        (vec![&scene, "x.glb", "--cell-m", "1", "--append"], vec!["--cell-m: ", "--append: "]),
        (vec![&scene, "x", "--sun-deg", "10,20", "--databases", "."], vec!["--sun-deg: ", "--databases: "]),
        (vec![&scene, "x", "--origin-m", "1,2,3"], vec!["--origin-m: changes nothing from scene to dart"]),
        (vec![&dart, "x.toml", "--sun-deg", "90,0"], vec!["--sun-deg: a zenith angle of 90 deg"]),
        (vec![&dart, "x.toml", "--databases", "no-such"], vec!["no-such --databases: is not a folder"]),
        (vec![&scene, "x", "--cell-m", "-1"], vec!["cell: -1 m is not a positive length"]),
    ] {
        let (code, out, err) = run(&[&["convert"], &arguments[..]].concat());
        assert!(code == 1 && told.iter().all(|told| err.contains(told)), "{arguments:?}: {out}{err}");
    }
    // The materials of a scene are taken, and resampled, as those of a file are.
    let (code, out, err) = run(&["convert", &scene, &argument("x.csv"), "--model", "blue unit", "--bands", "1:1.2:3"]);
    assert!(code == 0 && out.ends_with("x.csv: 1 spectra, scene to csv\n"), "{out}{err}");
    // Linear between 5 % at 0.9 um and 7.7 % at 1.3333 um.
    let text = std::fs::read_to_string(scratch.join("x.csv")).unwrap();
    let row = text.lines().find_map(|l| l.strip_prefix("1.1,")).unwrap();
    let value: f64 = row.split(',').next().unwrap().parse().unwrap();
    assert!((value - (0.05 + 0.027 * 0.2 / 0.4333)).abs() < 1e-12, "{text}");
}

#[test]
fn a_mesh_is_put_where_it_is_said() {
    let scratch = prepared(SCENE);
    let argument = |name: &str| scratch.argument(name);
    let placed = argument("placed/a.toml");
    let (code, out, err) = run(&["convert", &argument("ground.obj"), &placed, "--origin-m", "-100,2,3.5"]);
    assert!(code == 0 && !out.contains("origin_m"), "{out}{err}");
    let scene = scene_of(std::path::Path::new(&placed));
    assert_eq!(scene.body.origin_m.to_array(), [-100.0, 2.0, 3.5]);
    assert!((scene.body.mesh.vertices_m[0] - glam::DVec3::new(-9.1, 0.3, 8.0)).length() < 1e-12);
}

#[test]
fn a_mesh_without_area_makes_no_scene() {
    let scratch = Scratch::new();
    scratch.write("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n");
    for output in ["a.toml", "dart"] {
        let (code, _, err) = run(&["convert", &scratch.argument("a.obj"), &scratch.argument(output)]);
        assert!(code == 1 && err.contains("no triangle of the mesh has an area"), "{err}");
    }
}

#[test]
fn what_cannot_be_written_is_said_before_anything_is_read() {
    let scratch = Scratch::new();
    // Damaged, all of them: who reads them says so.
    scratch.write("a.obj", "f 1 2 9\n");
    scratch.write("a.npy", [&b"\x93NUMPY"[..], &[1, 0, 3, 0], b"{x}"].concat());
    scratch.write("a.oem", "CCSDS_OEM_VERS = 2.0\nnonsense\n");
    scratch.write("a.toml", "nonsense");
    for (input, output, told) in [
        ("a.obj", "b.ply", "b.ply: ply is read, and not written"),
        ("a.obj", "b.stl", "b.stl: stl is read, and not written"),
        ("a.obj", "b.csv", "a mesh: it has no spectra"),
        ("a.obj", "b.npy", "anything but an image as npy"),
        ("a.obj", "b.oem", "a mesh as oem: nothing moves in it"),
        ("a.toml", "b.blend", "is read, and not written"),
        ("a.toml", "b.oem", "a scene as oem: nothing moves in it"),
        ("a.npy", "b.obj", "an image as obj: it has neither mesh nor spectra"),
        ("a.npy", "b.tif", "read only"),
        ("a.oem", "b.obj", "they make no obj"),
    ] {
        let (code, _, err) = run(&["convert", &scratch.argument(input), &scratch.argument(output)]);
        assert!(code == 1 && err.contains(told), "{input} to {output}: {err}");
    }
}

#[test]
fn a_mesh_does_not_take_the_name_of_its_own_part() {
    let scratch = prepared(SCENE);
    for (name, format) in [("ground.mtl", "obj"), ("ground.bin", "gltf")] {
        let (code, _, err) =
            run(&["convert", &scratch.argument("ground.obj"), &scratch.argument(name), "--to", format, "--force"]);
        assert!(code == 1 && err.contains("a file of this name goes with the mesh"), "{err}");
        assert!(!scratch.join(name).exists());
    }
}

#[test]
fn objects_that_become_one_are_told() {
    let scratch = Scratch::new();
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\no one\nf 1 2 3\n";
    scratch.write("a.obj", text);
    let (code, out, _) = run(&["convert", &scratch.argument("a.obj"), &scratch.argument("a.glb")]);
    assert!(code == 0 && !out.contains("Dropped"), "{out}");
    scratch.write("b.obj", format!("{text}o two\nf 1 3 2\n"));
    let (code, out, _) = run(&["convert", &scratch.argument("b.obj"), &scratch.argument("b.glb")]);
    assert!(code == 0 && out.contains("which of 2 objects or groups a face belongs to"), "{out}");
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn inspect_knows_what_convert_reads() {
    let scratch = prepared(SCENE);
    let argument = |name: &str| scratch.argument(name);
    assert_eq!(run(&["convert", &argument("scene.toml"), &argument("dart")]).0, 0);
    assert_eq!(run(&["convert", &argument("scene.toml"), &argument("a.db")]).0, 0);
    let (code, out, err) = run(&["inspect", &argument("dart")]);
    assert!(code == 0 && out.starts_with("kind: dart\nsize: 15 facets\nmaterials:\n  name blue unit\n"), "{out}{err}");
    let (code, out, err) = run(&["inspect", &argument("a.db"), "--json"]);
    let json: Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out}{err}"));
    assert_eq!((code, &json["kind"], &json["materials"][0]["name"]), (0, &"db".into(), &"blue_unit".into()));
}
