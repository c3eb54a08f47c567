//! Items of a scene file that the command line replaces: the product is that of a file that says the same, and mistakes are told where they are made.

use serde_json::Value;

use crate::cli::run;
use crate::scratch::Scratch;

const SCENE: &str = "mmxrt_scene = 1\norigin_m = [0, 0, 11000]\n[[mesh]]\nobj = \"square.obj\"\nmaterial = \"grey ground\"\n\
     [materials]\n\"grey ground\" = { reflectance = 0.2 }\n[sun]\ndirection = [0.8660254037844386, 0, 0.5]\ndistance_au = 1\n\
     [observer]\nframe = \"site\"\nposition_m = [0, 0, 1000]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]\n\
     [sensor]\nsamples = 4\nlines = 3\nifov_mrad = 1.0\nbands = { centres_um = [1.0] }\n";

fn folder() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("square.obj", "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nf 1 2 3 4\n");
    scratch.write("scene.toml", SCENE);
    scratch
}

fn simulate(scratch: &Scratch, scene: &str, out: &str, settings: &[&str]) -> (i32, String) {
    let (scene, out) = (scratch.argument(scene), scratch.argument(out));
    let mut arguments = vec!["simulate", &scene, "-o", &out, "--model", "sunlight", "--quiet"];
    settings.iter().for_each(|setting| arguments.extend(["--set", setting]));
    let (code, _, err) = run(&arguments);
    (code, err)
}

fn report(scratch: &Scratch, out: &str) -> Value {
    serde_json::from_slice(&std::fs::read(scratch.join(out).join("report.json")).unwrap()).unwrap()
}

#[test]
fn the_image_is_that_of_a_file_that_says_the_same() {
    let scratch = folder();
    let settings = [
        "sensor.samples=6",
        "materials.\"grey ground\".reflectance=0.4",
        "sun.direction=[0, 0, 1]",
        "mars = { position_m = [9.376e6, 0.0, 0.0] }",
        "mars=",
        "sensor.bands.centres_um[1]=2.5",
    ];
    let (code, err) = simulate(&scratch, "scene.toml", "set", &settings);
    assert_eq!((code, err.as_str()), (0, ""));
    let said = SCENE
        .replace("samples = 4", "samples = 6")
        .replace("reflectance = 0.2", "reflectance = 0.4")
        .replace("[0.8660254037844386, 0, 0.5]", "[0, 0, 1]")
        .replace("[1.0]", "[1.0, 2.5]");
    scratch.write("said.toml", said);
    assert_eq!(simulate(&scratch, "said.toml", "said", &[]).0, 0);
    let read = |name: &str| std::fs::read(scratch.join(name)).unwrap();
    for name in ["cube.img", "backplanes.img"] {
        assert!(read(&format!("set/{name}")) == read(&format!("said/{name}")), "{name}");
    }
    assert_eq!(read("set/cube.img").len(), 6 * 3 * 2 * 4);
    // The report says what was replaced, and it is another scene than the file's own.
    let report_of_set = report(&scratch, "set");
    let kept: Vec<&str> = report_of_set["settings"].as_array().unwrap().iter().map(|s| s.as_str().unwrap()).collect();
    assert_eq!(kept, settings);
    assert_eq!(simulate(&scratch, "scene.toml", "plain", &[]).0, 0);
    let plain = report(&scratch, "plain");
    assert!(plain["scene"] != report_of_set["scene"] && plain.get("settings").is_none());
    // A map of the product is made of the same scene.
    let (code, _, err) =
        run(&["locate", &scratch.argument("set"), "--ortho", "tangent:1", "-o", &scratch.argument("map")]);
    assert_eq!(code, 0, "{err}");
}

#[test]
fn mistakes_are_told_where_they_are_made() {
    let scratch = folder();
    for (setting, told) in [
        ("sensor.sampels=6", "--set sensor.sampels=6"),
        ("sensor.samples=many", "--set sensor.samples=many"),
        ("sensor.samples=0", "--set sensor.samples=0"),
        ("mesh[3].obj=a.obj", "mesh has 1 elements"),
        ("sun.distance_au.x=1", "sun.distance_au is not a table"),
        ("mesh[0].obj=other.obj", "other.obj"),
    ] {
        let (code, err) = simulate(&scratch, "scene.toml", "out", &[setting]);
        assert!(code == 1 && err.contains(told), "{setting}: {code} {err}");
        assert!(!scratch.join("out").exists());
    }
    let deep = format!("{}=1", vec!["a"; 60_000].join("."));
    for setting in
        ["sensor.samples", "=6", "a[=1", "sun.distance_au=1979-05-27", "sun.distance_au=3.0\nsamples = 99", &deep]
    {
        let (code, err) = simulate(&scratch, "scene.toml", "out", &[setting]);
        assert!(code == 2 && err.contains("--set"), "{setting}: {code} {err}");
    }
    // What is wrong in the file does not count if it is replaced.
    scratch.edit("scene.toml", "samples = 4", "samples = \"four\"");
    assert_eq!(simulate(&scratch, "scene.toml", "out", &[]).0, 1);
    assert_eq!(simulate(&scratch, "scene.toml", "out", &["sensor.samples=4"]), (0, String::new()));
    // Other files have no items that are replaced.
    let (code, _, err) = run(&["inspect", &scratch.argument("square.obj"), "--set", "a=1"]);
    assert!(code == 1 && err.contains("not a scene"), "{err}");
    let (code, out, err) = run(&["inspect", &scratch.argument("scene.toml"), "--set", "sensor.samples=7"]);
    assert!(code == 0 && out.contains('7'), "{out}{err}");
}

#[test]
fn a_place_is_looked_for_in_the_scene_as_it_is_set() {
    let scratch = folder();
    let scene = scratch.argument("scene.toml");
    let ask = |settings: &[&str]| run(&[&["locate", &scene, "--pixel", "4,1.5"][..], settings].concat());
    let metres = |out: &str, column: usize| -> f64 {
        out.lines().nth(1).unwrap().split(',').nth(column).unwrap().parse().unwrap()
    };
    // The right edge of an image of 4 samples is 2 samples from the middle; on the ground, 1000 m below, each is as wide as 1 mrad spans.
    let pixel_m = 2.0 * 1000.0 * 0.5e-3_f64.tan();
    let (code, out, err) = ask(&[]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!((metres(&out, 5) - 2.0 * pixel_m).abs() < 1e-9, "{out}");
    // Of 6 samples it is 1 from there.
    let (code, out, _) = ask(&["--set", "sensor.samples=6"]);
    assert_eq!(code, 0);
    assert!((metres(&out, 5) - pixel_m).abs() < 1e-9, "{out}");
    let (code, _, err) = ask(&["--set", "sensor.sample=6"]);
    assert!(code == 1 && err.contains("sensor.sample"), "{err}");
    // A product has its own.
    assert_eq!(simulate(&scratch, "scene.toml", "set", &["sensor.samples=6"]).0, 0);
    let (product, map) = (scratch.argument("set"), scratch.argument("map"));
    let ortho = ["locate", &product, "--ortho", "tangent:1", "-o", &map, "--quiet"];
    let (code, _, err) = run(&[&ortho[..], &["--set", "sensor.samples=4"]].concat());
    assert!(code == 1 && err.contains("settings of its own"), "{err}");
    assert_eq!(run(&ortho).0, 0);
}
