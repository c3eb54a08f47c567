//! The program as people call it: exit codes, what is said where, and what is left behind.

use std::process::{Command, Output, Stdio};

use crate::scenes::SITE;
use crate::scratch::Scratch;

pub(crate) fn mmxrt() -> Command {
    Command::new(env!("CARGO_BIN_EXE_mmxrt"))
}

pub(crate) fn run(arguments: &[&str]) -> (i32, String, String) {
    let Output { status, stdout, stderr } = mmxrt().args(arguments).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

/// Writes a file; its path as an argument.
fn written(scratch: &Scratch, name: &str, text: &str) -> String {
    scratch.write(name, text);
    scratch.argument(name)
}

fn recipe_file(scratch: &Scratch, text: &str) -> String {
    written(scratch, "recipe.toml", text)
}

fn scene_file(scratch: &Scratch, text: &str) -> String {
    written(scratch, "scene.toml", text)
}

#[test]
fn usage_errors_exit_with_2() {
    for arguments in [&["simulat"][..], &["simulate"], &["inspect"], &["--threads", "0", "validate"], &[]] {
        let (code, out, err) = run(arguments);
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}");
        assert!(err.contains("--help") || err.contains("Usage"), "{arguments:?}: {err}");
    }
    let (code, out, _) = run(&["--help"]);
    assert!(code == 0 && out.contains("simulate") && out.contains("validate"));
}

#[test]
fn a_landscape_is_made_inspected_and_never_overwritten_unasked() {
    let scratch = Scratch::new();
    let recipe = recipe_file(&scratch, "version = 1\nseed = 7\nfacets = 2000\n");
    let obj = scratch.argument("site/hills.obj");
    let (code, out, err) = run(&["landscape", &recipe, "-o", &obj, "--threads", "2"]);
    assert_eq!((code, err.as_str()), (0, ""));
    // A grid of 31 x 32 cells comes closest, and all boulders are smaller than a quarter of one.
    assert!(out.starts_with(&format!("{obj}: 1984 facets, ")) && out.contains("of 6000 craters"), "{out}");
    let first = std::fs::read(&obj).unwrap();
    assert!(scratch.join("site/hills.mtl").is_file());

    let (code, out, err) = run(&["landscape", &recipe, "-o", &obj, "--seed", "8"]);
    assert_eq!((code, out.as_str()), (1, ""));
    assert!(err.contains("hills.obj") && err.contains("--force"), "{err}");
    assert!(std::fs::read(&obj).unwrap() == first);
    let (code, out, err) = run(&["landscape", &recipe, "-o", &obj, "--seed", "8", "--force", "--quiet"]);
    assert_eq!((code, out.as_str(), err.as_str()), (0, "", ""));
    assert!(std::fs::read(&obj).unwrap() != first);
    assert_eq!(scratch.names(), ["recipe.toml", "site"]);

    let (code, out, _) = run(&["--json", "inspect", &obj]);
    let facts: serde_json::Value = serde_json::from_str(&out).unwrap();
    let facets = facts["facets"].as_u64().unwrap();
    assert!(code == 0 && (1900..2100).contains(&facets), "{facts}");
    // The recipe's site is 2 km wide.
    assert_eq!(
        (facts["size_in_its_unit"]["x"].as_f64(), facts["size_in_its_unit"]["y"].as_f64()),
        (Some(2000.0), Some(2000.0))
    );
    let (code, out, _) = run(&["inspect", &recipe]);
    assert!(code == 0 && out.starts_with("kind: landscape recipe\nseed: 7\n"), "{out}");
}

#[test]
fn errors_name_the_place_as_text_and_as_json() {
    let scratch = Scratch::new();
    let recipe = recipe_file(&scratch, "version = 1\nseed = 7\nfacets = 2\nrelif = 3\n");
    let out = scratch.argument("out/x.obj");
    let (code, _, err) = run(&["landscape", &recipe, "-o", &out]);
    assert!(code == 1 && err.contains("recipe.toml:4") && err.contains("relif"), "{err}");
    let (code, said, err) = run(&["landscape", &recipe, "-o", &out, "--json"]);
    let error: serde_json::Value = serde_json::from_str(&err).unwrap();
    assert_eq!((code, said.as_str(), error["error"]["kind"].as_str()), (1, "", Some("invalid")));
    assert_eq!(error["error"]["problems"][0]["line"], 4);
    assert_eq!(scratch.names(), ["recipe.toml"], "an error left something behind");

    let recipe = recipe_file(&scratch, "version = 1\nseed = 7\nfacets = 2\n");
    let (_, _, err) = run(&["landscape", &recipe, "-o", &out, "--json"]);
    let error: serde_json::Value = serde_json::from_str(&err).unwrap();
    assert_eq!(error["error"]["problems"][0]["line"], 3, "{error}");

    let (code, out, _) = run(&["inspect", concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/oracles.json")]);
    assert!(code == 0 && out.starts_with("kind: oracles"), "{out}");
    let (code, _, err) = run(&["inspect", &scratch.argument("none.npz")]);
    assert!(code == 1 && err.contains("none.npz: there is no such file or folder"), "{err}");
    let (code, _, err) = run(&["inspect", &scratch.argument("none.xyz")]);
    assert!(code == 1 && err.contains("none.xyz"), "{err}");
    let (code, _, err) = run(&["inspect", scratch.path().to_str().unwrap()]);
    assert!(code == 1 && err.contains("neither a product folder"), "{err}");
    // What is no scene, though it is TOML, and what is nothing.
    for (name, text, expected) in [
        ("of.toml", "mmxrt_instrument = 1\nf_number = 4.0\n", "is an instrument: `mmxrt instrument"),
        ("e.bsp", "", "is empty"),
    ] {
        scratch.write(name, text);
        let (code, _, err) = run(&["inspect", &scratch.argument(name)]);
        assert!(code == 1 && err.contains(expected) && err.matches("error").count() == 1, "{name}: {err}");
    }
}

#[test]
fn a_failed_check_exits_with_1() {
    let scratch = Scratch::new();
    let record = |expected: &str| {
        format!(
            r#"{{"oracles": [{{"group": "thermal", "name": "thesis_eq9_T", "inputs": {{"cos_i": 0.5}}, "expected": {expected}, "tol_rel": 1e-9}}, {{"group": "hearsay", "name": "x", "expected": 1}}]}}"#
        )
    };
    let path = written(&scratch, "oracles.json", &record("240"));
    let (code, out, _) = run(&["validate", "--oracles", &path]);
    assert!(code == 0 && out.contains("PASS") && out.ends_with("1 passed, 0 failed, 1 skipped\n"), "{out}");
    scratch.write("oracles.json", record("241"));
    let (code, out, _) = run(&["validate", "--oracles", &path]);
    assert!(code == 1 && out.contains("FAIL") && out.ends_with("0 passed, 1 failed, 1 skipped\n"), "{out}");
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let mut child = mmxrt().arg("validate").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), String::from_utf8(output.stderr).unwrap().as_str()), (Some(0), ""));
}

#[test]
#[cfg(unix)]
fn an_interrupted_command_leaves_nothing() {
    let scratch = Scratch::new();
    let recipe = recipe_file(&scratch, "version = 1\nseed = 7\nfacets = 4000000\n");
    let out = scratch.argument("deep/down/x.obj");
    let mut child = mmxrt().args(["landscape", &recipe, "-o", &out]).stderr(Stdio::piped()).spawn().unwrap();
    while !scratch.join("deep/down").is_dir() {
        std::thread::sleep(std::time::Duration::from_millis(5));
        assert!(child.try_wait().unwrap().is_none(), "ended before it could be interrupted");
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("interrupted"), "{err}");
    assert_eq!(scratch.names(), ["recipe.toml"]);
}

#[test]
fn a_table_serves_another_camera_and_is_refused_for_another_sun() {
    let scratch = Scratch::new();
    let (table, product) = (scratch.argument("table.npz"), scratch.argument("product"));
    let scene = scene_file(&scratch, SITE);
    let (code, _, err) = run(&["solve", &scene, "-o", &table]);
    assert_eq!(code, 0, "{err}");
    scene_file(&scratch, &SITE.replace("samples = 16", "samples = 24").replace("[1.0]", "[1.0, 2.0]"));
    let (code, out, err) = run(&["integrate", &scene, "--table", &table, "-o", &product]);
    assert!(code == 0 && out.ends_with("24 x 16 pixels, 2 bands\n"), "{out}{err}");
    scene_file(&scratch, &SITE.replace("1.0, 0.5]", "1.0, 0.4]"));
    let (code, _, err) = run(&["integrate", &scene, "--table", &table, "-o", &scratch.argument("other")]);
    assert!(code == 1 && err.contains("table.npz") && err.contains("was solved for another scene"), "{err}");
    assert!(err.contains("mmxrt solve"), "{err}");
    assert_eq!(scratch.names(), ["product", "scene.toml", "table.npz"]);
}

#[test]
fn no_slip_of_the_hand_replaces_a_scene_by_its_table() {
    let scratch = Scratch::new();
    let scene = scene_file(&scratch, SITE);
    let (code, _, err) = run(&["solve", &scene, "-o", &scene, "--force"]);
    assert!(code == 1 && err.contains("scene.toml") && err.contains("ends in .npz"), "{err}");
    assert_eq!(std::fs::read_to_string(&scene).unwrap(), SITE);
}

#[test]
fn a_camera_under_the_terrain_is_warned_of() {
    let scratch = Scratch::new();
    let scene =
        scene_file(&scratch, &SITE.replace("position_m = [0.0, 82000.0, 0.0]", "position_m = [0.0, 2000.0, 0.0]"));
    let (code, _, err) = run(&["simulate", &scene, "-o", &scratch.argument("out")]);
    assert!(code == 0 && err.contains("100.0 % of what the camera sees is the back of facets"), "{err}");
}

#[test]
fn a_scene_is_inspected() {
    let scratch = Scratch::new();
    let scene = scene_file(&scratch, &SITE.replace("[mars]\nposition_m = [9.4e6, 12000.0, 0.0]\n", ""));
    let (code, out, err) = run(&["inspect", &scene, "--json"]);
    assert_eq!(code, 0, "{err}");
    let facts: serde_json::Value = serde_json::from_str(&out).unwrap();
    let number = |key: &str| facts[key].as_f64().unwrap_or_else(|| panic!("no {key}: {facts}"));
    // The Sun stands atan(0.5) from the zenith, where the camera is.
    for key in ["phase_deg", "sun_elevation_deg"] {
        let expected = if key == "phase_deg" { 26.565 } else { 63.435 };
        assert!((number(key) - expected).abs() < 1e-3, "{key}: {}", number(key));
    }
    assert!((number("range_m") - 70_000.0).abs() < 1e-6 && number("emission_deg").abs() < 1e-9);
    // 2 x 70 km x tan 0.5 deg, in 16 pixels.
    assert!((number("pixel_m") - 76.36).abs() < 0.01, "{}", number("pixel_m"));
    assert!((950.0..1050.0).contains(&number("facets")) && number("mean_incidence_deg") > 20.0);
    assert_eq!(facts["mars_elevation_deg"], serde_json::Value::Null);
    let (code, out, _) = run(&["inspect", &scene]);
    assert!(code == 0 && out.starts_with("kind: scene\ndry run: ") && out.contains(", phase 26.57 deg\n"), "{out}");
    let table = written(&scratch, "grey.csv", "wavelength_nm,reflectance_percent\n900,5\n2500,15\n");
    let (code, out, _) = run(&["inspect", &table]);
    assert!(code == 0 && out.contains("first_um: 0.9\nlast_um: 2.5\nunit: 1\nmin: 0.05\nmax: 0.15"), "{out}");
}

#[test]
fn what_is_being_done_is_said_on_request() {
    let scratch = Scratch::new();
    let scene = scene_file(&scratch, SITE);
    let (code, out, err) = run(&["simulate", &scene, "-o", &scratch.argument("out"), "--verbose"]);
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("sunlight") && err.contains("facets=") && !out.contains("facets="), "{err}");
    let (code, _, err) = run(&["simulate", &scene, "-o", &scratch.argument("quiet"), "--quiet"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let (code, _, _) = run(&["simulate", &scene, "-o", &scratch.argument("x"), "--quiet", "--verbose"]);
    assert_eq!(code, 2);
}

#[test]
fn a_product_with_all_its_parts_is_replaced_and_with_anything_else_is_not() {
    let scratch = Scratch::new();
    let (scene, product) = (scene_file(&scratch, SITE), scratch.argument("product"));
    let all = ["simulate", &scene, "-o", &product, "--force", "--exr", "--table", "--footprints"];
    assert_eq!(run(&all).0, 0);
    // What GDAL puts beside an image whose statistics it was asked for.
    scratch.write("product/cube.img.aux.xml", "");
    let (code, _, err) = run(&all);
    assert_eq!(code, 0, "{err}");
    let run_json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(scratch.join("product/run.json")).unwrap()).unwrap();
    let stages: Vec<&str> =
        run_json["stages"].as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert_eq!(stages.iter().filter(|name| **name == "reading the scene").count(), 1, "{stages:?}");
    scratch.write("product/notes.txt", "days of work");
    let (code, _, err) = run(&all);
    assert!(code == 1 && err.contains("notes.txt"), "{err}");
    assert_eq!(std::fs::read_to_string(scratch.join("product/notes.txt")).unwrap(), "days of work");
}

#[test]
fn what_was_measured_stands_beside_what_was_predicted() {
    let scratch = Scratch::new();
    let (scene, product) = (scene_file(&scratch, SITE), scratch.argument("product"));
    let (code, _, err) = run(&["simulate", &scene, "-o", &product, "--model", "sunlight,sun-disc,interreflection"]);
    assert!(code == 0 && err.contains("took ") && err.contains("predicted"), "{err}");
    let read = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(scratch.join("product").join(name)).unwrap()).unwrap()
    };
    let (run_json, report) = (read("run.json"), read("report.json"));
    let costs = run_json["costs"].as_array().unwrap();
    let of: Vec<&str> = costs.iter().map(|cost| cost["of"].as_str().unwrap()).collect();
    assert_eq!(of, ["all", "sun-disc", "interreflection"]);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let measured: Vec<f64> = costs.iter().map(|cost| number(&cost["measured_cpu_s"])).collect();
    // All of it is the whole process; its parts are stages, which are no longer together.
    assert_eq!(measured[0], number(&run_json["cpu_s"]));
    assert!(measured.iter().all(|s| *s > 0.0) && measured[1] + measured[2] <= measured[0], "{measured:?}");
    let stages: f64 = run_json["stages"].as_array().unwrap().iter().map(|stage| number(&stage["cpu_s"])).sum();
    assert!(stages <= measured[0], "{stages} {measured:?}");
    assert_eq!(costs[0]["predicted_cpu_s"], report["plan"]["cpu_s"]);
    // What depends on the machine is in no report: a second run has the same.
    let again = scratch.argument("again");
    assert_eq!(run(&["simulate", &scene, "-o", &again, "--model", "sunlight,sun-disc,interreflection"]).0, 0);
    let bytes = |folder: &str| std::fs::read(scratch.join(folder).join("report.json")).unwrap();
    assert_eq!(bytes("product"), bytes("again"));
}

#[test]
fn bands_that_openexr_cannot_tell_apart_are_told_by_the_final_name() {
    let scratch = Scratch::new();
    let scene = scene_file(&scratch, &SITE.replace("[1.0]", "[1.0, 1.0]"));
    let (code, _, err) = run(&["simulate", &scene, "-o", &scratch.argument("product"), "--exr"]);
    assert!(code == 1 && err.contains(&scratch.argument("product/cube.exr")) && err.contains("--exr"), "{err}");
    assert_eq!(scratch.names(), ["scene.toml"]);
}

/// A limit on memory stands for a small machine.
#[test]
#[cfg(target_os = "linux")]
fn an_image_that_memory_cannot_hold_is_refused() {
    let scratch = Scratch::new();
    let scene = scene_file(&scratch, &SITE.replace("= 16\n", "= 16384\n"));
    let limited = Command::new("sh")
        .args(["-c", "ulimit -v 4000000; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_mmxrt")])
        .args(["simulate", &scene, "-o", &scratch.argument("out")])
        .output()
        .unwrap();
    let err = String::from_utf8(limited.stderr).unwrap();
    assert!(limited.status.code() == Some(1) && err.contains("16384 x 16384 pixels take some"), "{err}");
    assert_eq!(scratch.names(), ["scene.toml"]);
}

#[test]
fn inspect_says_where_a_text_is_not_utf_8() {
    let scratch = Scratch::new();
    scratch.write("a.toml", b"# mod\xe9le\n");
    let (code, _, err) = run(&["inspect", &scratch.argument("a.toml")]);
    assert!(code == 1 && err.contains("a.toml:1:6: not UTF-8"), "{err}");
}

/// A limit on the size of files stands for a disk that is full: writes fail half-way.
#[test]
#[cfg(unix)]
fn a_write_that_fails_names_the_final_path_and_leaves_nothing() {
    let scratch = Scratch::new();
    let scene = scene_file(&scratch, SITE);
    for (command, output, culprit) in [("simulate", "product", "product/cube.img"), ("solve", "table.npz", "table.npz")]
    {
        let path = scratch.argument(output);
        let limited = Command::new("sh")
            .args(["-c", "trap '' XFSZ; ulimit -f 1; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_mmxrt")])
            .args([command, &scene, "-o", &path])
            .output()
            .unwrap();
        let err = String::from_utf8(limited.stderr).unwrap();
        assert_eq!(limited.status.code(), Some(1), "{err}");
        assert!(err.contains(&scratch.argument(culprit)) && err.contains("writing"), "{err}");
        assert!(!err.contains("partial"), "{err}");
        assert_eq!(scratch.names(), ["scene.toml"]);
    }
}

#[test]
fn an_output_that_cannot_be_made_is_named() {
    let scratch = Scratch::new();
    let scene = scene_file(&scratch, SITE);
    let (code, _, err) = run(&["simulate", &scene, "-o", &format!("{scene}/out")]);
    assert!(code == 1 && err.contains("scene.toml") && err.contains("making this folder"), "{err}");
    std::fs::create_dir(scratch.join("taken")).unwrap();
    let (code, _, err) = run(&["simulate", &scene, "-o", &scratch.argument("taken")]);
    assert!(code == 1 && err.contains("exists") && err.contains("--force"), "{err}");
    assert_eq!(scratch.names(), ["scene.toml", "taken"]);
}

#[test]
#[cfg(unix)]
fn a_scene_that_is_still_being_made_can_be_interrupted() {
    let scratch = Scratch::new();
    let scene = scene_file(&scratch, &SITE.replace("facets = 1000", "facets = 4000000"));
    let out = scratch.argument("out");
    let mut child = mmxrt().args(["simulate", &scene, "-o", &out]).stderr(Stdio::piped()).spawn().unwrap();
    while scratch.names().len() < 2 {
        std::thread::sleep(std::time::Duration::from_millis(5));
        assert!(child.try_wait().unwrap().is_none(), "ended before it could be interrupted");
    }
    let began = std::time::Instant::now();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && err.contains("interrupted"), "{err}");
    // Making the landscape, and what follows, takes many times this.
    assert!(began.elapsed().as_secs() < 20);
    assert_eq!(scratch.names(), ["scene.toml"]);
}

#[test]
fn shells_and_manuals_know_all_commands() {
    let scratch = Scratch::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (code, script, err) = run(&["completions", shell]);
        assert_eq!((code, err.as_str()), (0, ""));
        for word in ["simulate", "landscape", "tolerance"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    let (code, _, err) = run(&["man", &scratch.argument("man1")]);
    assert_eq!(code, 0, "{err}");
    let names = std::fs::read_dir(scratch.join("man1")).unwrap().count();
    let page = std::fs::read_to_string(scratch.join("man1/mmxrt-simulate.1")).unwrap();
    // A page for each command that the help names, and one for all.
    let (_, help, _) = run(&["--help"]);
    let commands = help.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    let listed = commands.filter(|l| l.starts_with("  ") && !l.starts_with("   ") && !l.contains("  help ")).count();
    assert!(listed > 10);
    assert_eq!(names, listed + 1);
    assert!(page.contains(".TH mmxrt-simulate 1") && page.contains("\\-\\-tolerance"), "{page}");
    assert_eq!(run(&["man", &scratch.argument("man1")]).0, 1);
}
