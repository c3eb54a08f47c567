//! `mmxrt inspect SCENE`: a dry run of `simulate`.

use mmxrt::formats::{Subject, scene_toml};
use mmxrt::job;
use mmxrt::product::Quantity;
use mmxrt::progress::unwatched;
use mmxrt::study::{self, Request};
use serde_json::Value;

use crate::cli::run;
use crate::scenes::{SITE, SQUARE, SQUARE_OBJ};
use crate::scratch::Scratch;

/// What is said of a scene, which must begin.
fn expected(text: &str) -> Value {
    let scratch = Scratch::new();
    let scene = scratch.write("scene.toml", text);
    let (code, out, err) = run(&["--json", "inspect", scene.to_str().unwrap()]);
    assert_eq!((code, err.as_str()), (0, ""), "{text}");
    let facts: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&facts["begins"], &facts["dry_run"]), (&Value::Bool(true), &Value::Bool(true)));
    facts
}

fn warnings(facts: &Value) -> Vec<String> {
    facts["warnings"].as_array().unwrap().iter().map(|w| w.as_str().unwrap().to_owned()).collect()
}

/// The report of a product, and the bytes of its numbers and of all its files.
fn simulated(text: &str) -> (Value, u64, u64) {
    let scratch = Scratch::new();
    let scene = scratch.write("scene.toml", text);
    let (code, _, err) = run(&["-q", "simulate", scene.to_str().unwrap(), "-o", &scratch.argument("out")]);
    assert_eq!(code, 0, "{err}");
    let bytes = |name: &str| scratch.join(&format!("out/{name}")).metadata().unwrap().len();
    let all = scratch.join("out").read_dir().unwrap().map(|file| file.unwrap().metadata().unwrap().len()).sum();
    let report = serde_json::from_slice(&std::fs::read(scratch.join("out/report.json")).unwrap()).unwrap();
    (report, bytes("cube.img") + bytes("backplanes.img"), all)
}

#[test]
fn a_product_takes_what_was_said() {
    // 256 pixels: 42 planes (38, and two for each of two materials) of 8 bytes, and 4 bytes for each band.
    for (centres, bytes) in [("[1.0]", 256 * (42 * 8 + 4)), ("[1.0, 1.1, 1.2]", 256 * (42 * 8 + 12))] {
        let text = SITE.replace("[1.0]", centres);
        let facts = expected(&text);
        assert_eq!(facts["expects"]["disk_bytes"], bytes);
        let (_, numbers, all) = simulated(&text);
        // Headers, reports and pictures are not counted: some 20 kB.
        assert!(numbers == bytes && (numbers..numbers + 40_000).contains(&all), "{numbers} {all}");
    }
}

#[test]
fn cubes_in_memory_need_room_for_each_number() {
    let scratch = Scratch::new();
    scratch.write("square.obj", SQUARE_OBJ);
    let subject = || Subject::from(scene_toml::read(&scratch.write("scene.toml", SQUARE), &unwatched).unwrap());
    let scene = &subject().scene;
    let numbers = u64::from(scene.exposure.camera.samples) * u64::from(scene.exposure.camera.lines);
    let numbers = numbers * scene.exposure.bands.len() as u64;
    let weights = study::memory_bytes(scene, false);
    for bytes in [0, 4, 20] {
        let room = weights + bytes * numbers;
        study::has_room_for(scene, false, bytes, Some(room)).unwrap();
        study::has_room_for(scene, false, bytes, Some(room - 1)).unwrap_err();
    }
    // 1e15 bytes a number is more than there is anywhere, and u64::MAX more than can be said.
    for bytes in [1_000_000_000_000_000, u64::MAX] {
        let error = job::hold(subject(), &Request::default(), Quantity::Radiance, bytes, &unwatched).unwrap_err();
        let problems = error.problems();
        assert_eq!(problems[0].at.item.as_deref(), Some("sensor"), "{error}");
        assert!(problems[0].help.as_ref().is_some_and(|help| help.contains("folder")), "{error}");
    }
    job::hold(subject(), &Request::default(), Quantity::Radiance, 8, &unwatched).unwrap();
}

#[test]
fn nothing_is_written_and_that_is_said() {
    let scratch = Scratch::new();
    let scene = scratch.write("scene.toml", SITE);
    let (code, out, err) = run(&["inspect", scene.to_str().unwrap()]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.starts_with("kind: scene\ndry run: nothing is computed or written\nfacets: "), "{out}");
    for said in [
        "\nexpects:\n  memory: about ",
        "\n  disk: about 87.0 kB for the product's folder",
        "\n  time: about 0.0",
        "CPU s (on a machine of 2022, within a factor of 3)\nbegins: yes\n",
        "\nimage: 16 x 16 pixels of ",
        "\nbands: 1 at 1 um, monochromatic\n",
    ] {
        assert!(out.contains(said), "{said:?}: {out}");
    }
    assert_eq!(scratch.names(), ["scene.toml"]);
}

#[test]
fn the_shipped_scene_is_told_on_a_page() {
    let (code, out, _) = run(&["inspect", concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/phobos_site/scene.toml")]);
    assert!(code == 0 && (15..=25).contains(&out.lines().count()), "{out}");
    // 65536 pixels: 42 planes of 8 bytes, 300 bands of 4.
    assert!(out.contains("  disk: about 100.7 MB for the product's folder"), "{out}");
}

/// A limit on memory stands for a small machine.
#[test]
#[cfg(target_os = "linux")]
fn what_would_not_begin_says_all_that_is_wrong() {
    let scratch = Scratch::new();
    scratch.write("rpv.csv", "wavelength_um,g,rho0,k,h\n1,-0.1,0.05,0.8,0.05\n2,-0.2,0.06,0.8,0.07\n");
    scratch.write("texels.csv", "0.1,0.2\n0.3,0.4\n");
    let material = "0.07, rpv = \"rpv.csv\", texture = { raster = \"texels.csv\", quantity = \"reflectance\", placement = \"plane\", plane = \
                    { corner_m = [-1e4, 0, 1e4], along_line_m = [1e4, 0, 0], line_to_line_m = [0, 0, -1e4] } } }";
    let text = SITE.replace("0.07 }", material).replace("= 16\n", "= 16384\n");
    let scene = scratch.write("scene.toml", text);
    let limited = |options: &[&str]| {
        let output = std::process::Command::new("sh")
            .args(["-c", "ulimit -v 4000000; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_mmxrt"), "inspect"])
            .arg(&scene)
            .args(options)
            .output()
            .unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, out, err) = limited(&[]);
    assert!(code == Some(1) && out.contains("begins: no") && out.contains("phobos_blue: rpv"), "{out} {err}");
    assert!(err.contains("`rpv` parameters is not supported") && err.contains("GB of memory"), "{err}");
    let (code, out, err) = limited(&["--json"]);
    let facts: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &facts["begins"]), (Some(1), &Value::Bool(false)));
    let told: Value = serde_json::from_str(&err).unwrap();
    assert_eq!(told["error"]["problems"].as_array().unwrap().len(), 2, "{err}");
}

#[test]
fn what_cannot_be_read_has_no_summary() {
    let scratch = Scratch::new();
    let text = SITE.replace("0.07", "7").replace("distance_au = 1.5", "distance_au = -1.5");
    let scene = scratch.write("scene.toml", text);
    let (code, out, err) = run(&["inspect", scene.to_str().unwrap()]);
    assert!(code == 1 && out.is_empty() && err.contains("distance_au") && err.contains("phobos_blue"), "{err}");
}

#[test]
fn it_warns_of_what_the_simulation_warns_of() {
    let cases = [
        ("as it is", SITE.to_owned(), ""),
        ("elsewhere", SITE.replace("target_m = [0.0, 12000.0", "target_m = [0.0, 1e6"), "nothing is in view"),
        ("below", SITE.replace("82000.0", "2000.0"), "100.0 % of what the camera sees is the back of facets"),
        ("night", SITE.replace("[0.0, 1.0, 0.5]", "[0.0, -1.0, 0.0]"), "nothing is lit: the Sun is below every facet"),
        ("eclipse", SITE.replace("[9.4e6, 12000.0, 0.0]", "[0.0, 9.4e6, 4.7e6]"), "the site is in eclipse"),
    ];
    for (name, text, told) in cases {
        let foreseen = warnings(&expected(&text));
        assert!(told.is_empty() || foreseen.iter().any(|w| w.contains(told)), "{name}: {foreseen:?}");
        let real = warnings(&simulated(&text).0);
        // What the image shows instead of sunlight is known only when it is solved.
        let plain = |all: &[String]| -> Vec<String> {
            all.iter()
                .map(|w| {
                    w.replace("about ", "")
                        .replace(" or behind the terrain", "")
                        .split("; what")
                        .next()
                        .unwrap()
                        .to_owned()
                })
                .collect()
        };
        assert_eq!(plain(&foreseen), plain(&real), "{name}");
    }
}

#[test]
fn how_much_of_the_image_is_filled() {
    // A plate of 1 x 1 m amid an image of 2 x 2 m; then with its middle in the image's corner.
    let text = |x: &str| {
        format!(
            "mmxrt_scene = 1\norigin_m = [0, 0, 0]\n[[mesh]]\nobj = \"plate.obj\"\nmaterial = \"a\"\n[materials]\na = {{ reflectance = 0.1 }}\n\
             [sun]\ndirection = [0, 0, 1]\ndistance_au = 1\n[observer]\nposition_m = [{x}, {x}, 10]\ntarget_m = [{x}, {x}, 0]\nup = [0, 1, 0]\n\
             [sensor]\nsamples = 64\nlines = 64\nfov_deg = 11.421186274999286\nbands = {{ centres_um = [1] }}\n"
        )
    };
    for (x, filled) in [("0", 0.25), ("1", 0.0625), ("10", 0.0)] {
        let scratch = Scratch::new();
        scratch.write("plate.obj", "v -0.5 -0.5 0\nv 0.5 -0.5 0\nv 0.5 0.5 0\nv -0.5 0.5 0\nf 1 2 3 4\n");
        let scene = scratch.write("scene.toml", text(x));
        let (code, out, err) = run(&["--json", "inspect", scene.to_str().unwrap()]);
        assert_eq!(code, 0, "{err}");
        let facts: Value = serde_json::from_str(&out).unwrap();
        assert_eq!(facts["filled"], filled, "{x}");
    }
}

#[test]
fn more_work_is_expected_to_take_longer_and_more() {
    let of = |text: &str, key: &str| expected(text)["expects"][key].as_f64().unwrap();
    let more = [
        ("facets", SITE.replace("facets = 1000", "facets = 10000"), true),
        ("pixels", SITE.replace("= 16\n", "= 64\n"), true),
        ("bands", SITE.replace("[1.0]", "[1.0, 1.5, 2.0, 2.5, 3.0, 3.3, 3.6]"), true),
        // More points stand for the Sun's disc.
        ("grazing light", SITE.replace("[0.0, 1.0, 0.5]", "[0.0, 0.1, 1.0]"), true),
    ];
    for (what, text, takes_memory) in more {
        assert!(of(&text, "cpu_s") > of(SITE, "cpu_s"), "{what}");
        assert_eq!(of(&text, "memory_bytes") > of(SITE, "memory_bytes"), takes_memory, "{what}");
    }
}
