//! The same bytes at any number of threads, and in one pass or two.

use std::collections::BTreeMap;
use std::path::Path;

use crate::cli::mmxrt;
use crate::scratch::Scratch;

/// Shadows, Mars above the horizon, heat, two materials, Gaussian bands.
const SCENE: &str = r#"
mmxrt_scene = 1
origin_m = [11951.9372, 4350.1494, 0.0]
[[mesh]]
recipe = { version = 1, seed = 5, facets = 6000, size_m = 200.0, relief = { rms_m = 5.0, longest_m = 120.0 }, craters = { count = 100, min_diameter_m = 4.0, max_diameter_m = 60.0 }, boulders = { count = 60 } }
[materials]
phobos_blue = { reflectance = 0.06 }
phobos_red = { reflectance = 0.09 }
[sun]
direction = [-0.121202, 0.987109, 0.104528]
distance_au = 1.5237
[mars]
position_m = [9.376e6, 0.0, 0.0]
[observer]
position_m = [12800.0, 4400.0, 300.0]
target_m = [11951.9372, 4350.1494, 0.0]
up = [0.0, 0.0, 1.0]
[sensor]
samples = 48
lines = 40
fit = "scene"
bands = { start_um = 0.95, stop_um = 3.6, count = 21, fwhm_um = 0.02 }
"#;

fn run(folder: &Path, threads: &str, arguments: &[&str]) {
    let output = mmxrt().current_dir(folder).args(["--quiet", "--threads", threads]).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Every file of a folder but run.json, which says when and how fast.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = folder.read_dir().unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    names
        .filter(|name| name != "run.json")
        .map(|name| (name.clone(), std::fs::read(folder.join(name)).unwrap()))
        .collect()
}

fn assert_same(what: &str, one: &BTreeMap<String, Vec<u8>>, other: &BTreeMap<String, Vec<u8>>, but: &[&str]) {
    let mut seen = 0;
    for (name, bytes) in other {
        if !but.contains(&name.as_str()) {
            assert!(!bytes.is_empty() && one.get(name) == Some(bytes), "{what}: {name} differs");
            seen += 1;
        }
    }
    assert!(seen >= 6, "{what}: only {seen} files");
}

#[test]
fn threads_and_steps_change_no_byte() {
    let scratch = Scratch::new();
    let folder = scratch.path();
    scratch.write("scene.toml", SCENE);
    let simulate = |threads: &str| {
        let out = format!("out{threads}");
        run(folder, threads, &["simulate", "scene.toml", "-o", &out, "--exr", "--footprints", "--table"]);
        files(&folder.join(out))
    };
    let [one, two, four] = ["1", "2", "4"].map(simulate);
    assert!(one.len() >= 10, "{:?}", one.keys());
    assert_same("2 threads", &one, &two, &[]);
    assert_same("4 threads", &one, &four, &[]);
    assert_eq!((one.len(), one.len()), (two.len(), four.len()));
    // Something of everything is there: coverage, shadows, Mars-light and heat.
    let radiance = |line: &str| one["cube.hdr"].windows(line.len()).any(|w| w == line.as_bytes());
    assert!(radiance("bands = 21") && one["cube.img"].len() == 48 * 40 * 21 * 4);

    run(folder, "2", &["solve", "scene.toml", "-o", "table.npz"]);
    assert!(std::fs::read(folder.join("table.npz")).unwrap() == one["table.npz"], "the table differs");
    run(folder, "1", &["integrate", "scene.toml", "--table", "table.npz", "-o", "out", "--exr", "--footprints"]);
    let integrated = files(&folder.join("out"));
    assert_same("solve and integrate", &one, &integrated, &["report.json"]);
    // A table has its models with it: nobody plans again.
    let report = |files: &BTreeMap<String, Vec<u8>>| -> serde_json::Value {
        let mut report: serde_json::Value = serde_json::from_slice(&files["report.json"]).unwrap();
        report.as_object_mut().unwrap().remove("plan");
        report
    };
    assert_eq!(report(&one), report(&integrated));
}

#[test]
fn threads_change_no_byte_of_maps_and_textures() {
    let scratch = Scratch::new();
    let folder = scratch.path();
    // A texture of 40 x 40 texels of 6 m over the site, whose local axes stand radially; two maps, one of them hardly knows the site.
    let rows = |k: usize| -> String {
        let row = |r: usize| (0..40).map(|c| (1 + (r * 7 + c * 13 + k) % 11).to_string()).collect::<Vec<_>>().join(",");
        (0..40).map(|r| row(r) + "\n").collect()
    };
    scratch.write("texture.csv", rows(0));
    let outward = "[0.9397, 0.342, 0.0]";
    let plane = format!(
        "plane = {{ corner_m = [41.04, -112.76, 120.0], along_line_m = [-2.052, 5.638, 0.0], line_to_line_m = [0.0, 0.0, -6.0], towards = {outward} }}"
    );
    let texture =
        format!("texture = {{ raster = \"texture.csv\", quantity = \"factor\", placement = \"plane\", {plane} }}");
    scratch.write("scene.toml", SCENE.replace("reflectance = 0.06", &format!("reflectance = 0.06, {texture}")));
    for (name, towards) in [("a", outward), ("b", "[0.5, 0.6, 0.3]")] {
        scratch.write(&format!("{name}.csv"), rows(5));
        let plane = plane.replace(outward, towards);
        let head = "mmxrt_map = 1\nno_data = 7\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nbands = { centres_um = [0.9, 3.7], fwhm_um = 0.1 }\nraster = [\"a.csv\", \"b.csv\"]\n";
        scratch.write(&format!("{name}.map.toml"), format!("{head}placement = \"plane\"\n{plane}\n"));
    }
    let maps = ["--radiance", "a.csv", "--radiance", "b.csv", "--views", "interpolated", "--texels", "bilinear"];
    let made = |threads: &str| {
        let [textured, mapped] = ["textured", "mapped"].map(|name| format!("{name}{threads}"));
        run(folder, threads, &["simulate", "scene.toml", "-o", &textured]);
        let integrate = ["integrate", "scene.toml", "--unknown", "solve", "-o", &mapped];
        run(folder, threads, &[&integrate[..], &maps].concat());
        [textured, mapped].map(|name| files(&folder.join(name)))
    };
    let [one, two, four] = ["1", "2", "4"].map(made);
    for (k, what) in ["textures", "maps"].into_iter().enumerate() {
        assert_same(&format!("{what}, 2 threads"), &one[k], &two[k], &[]);
        assert_same(&format!("{what}, 4 threads"), &one[k], &four[k], &[]);
    }
    // The maps are seen, and not all is known.
    let report: serde_json::Value = serde_json::from_slice(&one[1]["report.json"]).unwrap();
    let unknown = report["maps"]["unknown_share"].as_f64().unwrap();
    assert!((0.001..0.9).contains(&unknown), "{unknown}");
}
