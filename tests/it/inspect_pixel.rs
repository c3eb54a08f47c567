//! A pixel of a product, reflected light and heat apart, and the built-in Sun: said, written as a table, and drawn.

use serde_json::Value;

use crate::cli::run;
use crate::scratch::Scratch;

/// A square of 10 m, reflectance 0.2, 330 K warm, under a Sun of 40 pi W m-2 um-1 at its zenith: 8 W m-2 sr-1 um-1 are reflected.
const SCENE: &str = r#"
mmxrt_scene = 1
origin_m = [0, 0, 0]
[[mesh]]
obj = "square.obj"
material = "ground"
[materials]
ground = { reflectance = 0.2, emissivity = 0.8 }
[thermal]
model = "thesis"
[sun]
direction = [0, 0, 1]
distance_au = 1
spectrum = "sun.csv"
[observer]
position_m = [0, 0, 1000]
target_m = [0, 0, 0]
up = [0, 1, 0]
[sensor]
samples = 4
lines = 3
ifov_mrad = 1.0
bands = { centres_um = [1.0, 3.0] }
"#;

fn product(scratch: &Scratch, split: bool) -> String {
    scratch.write("square.obj", "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nf 1 2 3 4\n");
    let sun = 40.0 * std::f64::consts::PI;
    scratch.write("sun.csv", format!("wavelength_um,irradiance_w_m2_um\n0.3,{sun}\n10,{sun}\n"));
    scratch.write("scene.toml", SCENE);
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let mut arguments = vec!["simulate", &scene, "-o", &out, "--dtype", "f64", "--force"];
    arguments.extend(split.then_some("--split"));
    let (code, _, err) = run(&arguments);
    assert_eq!(code, 0, "{err}");
    out
}

#[test]
fn a_pixel_is_its_spectrum_its_planes_and_on_request_light_and_heat_apart() {
    let scratch = Scratch::new();
    let out = product(&scratch, true);
    let (code, text, err) = run(&["--json", "inspect", &out, "--pixel", "2,1"]);
    assert_eq!(code, 0, "{err}");
    let pixel: Value = serde_json::from_str(&text).unwrap();
    let number = |name: &str, band: usize| pixel[name][band].as_f64().unwrap();
    // The thesis's law, 150 K + 180 K cos i.
    let t_k = 330.0;
    let planck = |um: f64| 1.191_042_972e8 / um.powi(5) / ((14_387.768_775 / (um * t_k)).exp() - 1.0);
    for (band, um) in [1.0, 3.0].into_iter().enumerate() {
        assert_eq!(pixel["wavelength_um"][band].as_f64(), Some(um));
        let (reflected, thermal) = (number("reflected_w_m2_sr_um", band), number("thermal_w_m2_sr_um", band));
        assert!((reflected - 8.0).abs() < 1e-11, "{reflected}");
        let expected = 0.8 * planck(um);
        assert!((thermal - expected).abs() <= 1e-6 * expected, "{um} um: {thermal} {expected}");
        assert!((number("radiance_w_m2_sr_um", band) - reflected - thermal).abs() < 1e-14);
    }
    assert_eq!(pixel["planes"]["COVERAGE"].as_f64(), Some(1.0));
    // Sample 2, line 1 of 4 x 3 looks half a pixel right of the middle, and at the middle line: 0.5 m east of it.
    let [x, y] = ["BODYFIXEDX (m)", "BODYFIXEDY (m)"].map(|name| pixel["planes"][name].as_f64().unwrap());
    assert!((x - 0.5).abs() < 1e-6 && y.abs() < 1e-6, "{x} {y}");

    let (csv, svg) = (scratch.argument("p.csv"), scratch.argument("p.svg"));
    let (code, text, err) = run(&["inspect", &out, "--pixel", "2,1", "--csv", &csv, "--picture", &svg]);
    assert_eq!(code, 0, "{err}");
    let table = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(text.trim_end(), table.trim_end());
    let header = "wavelength_um,radiance_w_m2_sr_um,reflected_w_m2_sr_um,thermal_w_m2_sr_um";
    assert!(
        table.starts_with("# sample 2, line 1, counted from 0\n# COVERAGE 1\n") && table.contains(header),
        "{table}"
    );
    assert_eq!(table.lines().filter(|line| !line.starts_with('#')).count(), 3);
    let svg_text = std::fs::read_to_string(&svg).unwrap();
    assert!(svg_text.starts_with("<svg") && ["radiance", "reflected", "thermal"].iter().all(|n| svg_text.contains(n)));
    let (code, _, err) = run(&["inspect", &out, "--pixel", "2,1", "--csv", &csv]);
    assert!(code == 1 && err.contains("--force"), "{err}");
}

#[test]
fn numbers_of_single_precision_have_no_more_digits_than_they_have() {
    let scratch = Scratch::new();
    product(&scratch, true);
    // At 10 um and 330 K some 10 W m-2 sr-1 um-1 of heat beside 0.8 / 40 of them: 7 digits of the sum are 5 of the rest.
    let sun = 0.1 * std::f64::consts::PI;
    scratch.write("sun.csv", format!("wavelength_um,irradiance_w_m2_um\n0.3,{sun}\n20,{sun}\n"));
    scratch.write("scene.toml", SCENE.replace("[1.0, 3.0]", "[3.0, 10.0]"));
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("single"));
    let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--split"]);
    assert_eq!(code, 0, "{err}");
    let svg = scratch.argument("s.svg");
    let (code, text, err) = run(&["inspect", &out, "--pixel", "2,1", "--picture", &svg]);
    assert_eq!(code, 0, "{err}");
    let row = std::fs::read_to_string(&svg).map(|_| text.lines().last().unwrap_or_default().to_owned()).unwrap();
    let cells: Vec<&str> = row.split(',').collect();
    let digits = |cell: &str| cell.trim_start_matches(['0', '.']).replace('.', "").len();
    // 0.2 x 0.1 = 0.02 is reflected.
    assert!(cells[0] == "10" && (cells[2].parse::<f64>().unwrap() - 0.02).abs() < 2e-6, "{row}");
    assert!(digits(cells[1]) <= 9 && digits(cells[3]) <= 9 && digits(cells[2]) <= 5, "{row}");
}

#[test]
fn what_is_no_pixel_is_told() {
    let scratch = Scratch::new();
    let out = product(&scratch, false);
    let (_, text, _) = run(&["inspect", &out, "--pixel", "0,0"]);
    assert!(text.contains("wavelength_um,radiance_w_m2_sr_um\n"), "{text}");
    for (arguments, code, told) in [
        (vec!["--pixel", "4,0"], 1, "pixel 4,0 is beyond its 4 samples and 3 lines"),
        (vec!["--pixel", "0,3"], 1, "beyond"),
        (vec!["--pixel", "1"], 2, "two whole numbers"),
        (vec!["--pixel", "-1,2"], 2, "-1"),
        (vec!["--pixel", "1,2,3"], 2, "two whole numbers"),
        (vec!["--csv", "x.csv"], 1, "use --csv with --pixel"),
        (vec!["--pixel", "0,0", "--picture", "x.png"], 1, ".svg"),
    ] {
        let (got, _, err) = run(&[&["inspect", &out][..], &arguments].concat());
        assert!(got == code && err.contains(told), "{arguments:?}: {got} {err}");
    }
    let (code, _, err) = run(&["inspect", scratch.path().to_str().unwrap(), "--pixel", "0,0"]);
    assert!(code == 1 && err.contains("is not the folder of a product"), "{err}");
}

#[test]
fn the_built_in_sun_can_be_had() {
    // ASTM E490-00a: 1366.1 W m-2 in all, 747.9 W m-2 um-1 at 1 um.
    let (code, text, _) = run(&["--json", "inspect", "e490"]);
    let sun: Value = serde_json::from_str(&text).unwrap();
    assert!(code == 0 && (sun["total_w_m2"].as_f64().unwrap() - 1366.1).abs() < 0.05, "{}", sun["total_w_m2"]);
    let um = sun["wavelength_um"].as_array().unwrap();
    let at = um.iter().position(|um| um.as_f64() == Some(1.0)).unwrap();
    assert_eq!(sun["irradiance_w_m2_um"][at].as_f64(), Some(747.9));
    // What it writes is a Sun that a scene reads.
    let scratch = Scratch::new();
    let csv = scratch.argument("sun.csv");
    assert_eq!(run(&["inspect", "e490", "--csv", &csv, "--quiet"]).0, 0);
    let (code, text, err) = run(&["inspect", &csv]);
    assert!(code == 0 && text.contains("W m-2 um-1"), "{text} {err}");
}

/// Spectra of a file are drawn in one plot, each over its own wavelengths, and written as a long table.
#[test]
fn spectra_of_a_file_are_drawn() {
    let scratch = Scratch::new();
    scratch.write("two.csv", "wavelength_um,ice,\"dust, dark\"\n1,0.0,0.1\n2,0.4,0.1\n3,0.2,0.1\n");
    let (file, svg, csv) = (scratch.argument("two.csv"), scratch.argument("two.svg"), scratch.argument("long.csv"));
    let (code, _, err) = run(&["inspect", &file, "--picture", &svg, "--csv", &csv]);
    assert_eq!(code, 0, "{err}");
    let drawn = std::fs::read_to_string(&svg).unwrap();
    // The plot is from 84 to 700 px and from 388 up to 60: 0.4 is its top, 0.1 a quarter of its height.
    assert!(drawn.contains("M84.00 388.00 L392.00 60.00 L700.00 224.00"), "{drawn}");
    assert!(drawn.contains("M84.00 306.00 L392.00 306.00 L700.00 306.00"), "{drawn}");
    assert!(drawn.contains(">ice<") && drawn.contains("dust"), "{drawn}");
    let table = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(table.lines().count(), 1 + 6, "{table}");
    assert!(table.starts_with("spectrum,wavelength_um,value\n\"ice\",1,0\n\"ice\",2,0.4\n"), "{table}");
    // A library of ENVI holds the same. Commas part the names of its spectra.
    let library = scratch.argument("two.sli");
    let plain = scratch.write("plain.csv", "wavelength_um,ice,dust\n1,0.0,0.1\n2,0.4,0.1\n3,0.2,0.1\n");
    let (code, _, err) = run(&["convert", plain.to_str().unwrap(), &library, "--quiet"]);
    assert_eq!(code, 0, "{err}");
    let (code, _, err) = run(&["inspect", &library, "--picture", &svg, "--force", "--quiet"]);
    assert_eq!(code, 0, "{err}");
    let again = std::fs::read_to_string(&svg).unwrap();
    assert!(again.contains("M84.00 306.00 L392.00 306.00 L700.00 306.00"), "{again}");
    let (code, _, err) = run(&["inspect", &library, "--picture", &svg, "--quiet"]);
    assert!(code == 1 && err.contains("exists"), "{err}");
    let (code, _, err) = run(&["inspect", &file, "--picture", &scratch.argument("two.png"), "--quiet"]);
    assert!(code == 1 && err.contains(".svg"), "{err}");
}

/// What is read is not written over, and of two files neither is written unless both are.
#[test]
fn tables_and_drawings_spare_what_they_are_made_from() {
    let scratch = Scratch::new();
    scratch.write("two.csv", "wavelength_um,ice,dust\n1,0.0,0.1\n2,0.4,0.1\n3,0.2,0.1\n");
    let file = scratch.argument("two.csv");
    let library = scratch.argument("two.sli");
    assert_eq!(run(&["convert", &file, &library, "--quiet"]).0, 0);
    scratch.write("ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl soil\nf 1 2 3\n");
    scratch.write(
        "scene.toml",
        "mmxrt_scene = 1\norigin_m = [0.0, 0.0, 11000.0]\n[[mesh]]\nfile = \"ball.obj\"\n[materials]\nsoil = { reflectance = 0.05 }\n\
         [sun]\ndirection = [0.0, 0.0, 1.0]\ndistance_au = 1.5\n[thermal]\nmodel = \"off\"\n[observer]\nposition_m = [0.0, 0.0, 12000.0]\n\
         target_m = [0.0, 0.0, 11000.0]\nup = [0.0, 1.0, 0.0]\n[sensor]\nsamples = 2\nlines = 2\nifov_mrad = 1.0\nbands = { centres_um = [1.0] }\n",
    );
    let scene = scratch.argument("scene.toml");
    let of_scene = [scene.as_str(), "--material", "soil"];
    for (input, target) in [
        (&[file.as_str()][..], "two.csv"),
        (&[library.as_str()], "two.sli"),
        (&[library.as_str()], "two.hdr"),
        (&of_scene, "scene.toml"),
        (&of_scene, "ball.obj"),
    ] {
        let before = std::fs::read(scratch.join(target)).unwrap();
        let out = scratch.argument(target);
        let (code, _, err) = run(&[&["inspect", "--csv", &out, "--force", "--quiet"], input].concat());
        assert!(code == 1 && err.contains("is read for it"), "{target}: {err}");
        assert!(std::fs::read(scratch.join(target)).unwrap() == before, "{target}");
    }
    let there = scratch.write("there.svg", "x");
    let csv = scratch.argument("new.csv");
    let (code, _, err) = run(&["inspect", &file, "--csv", &csv, "--picture", there.to_str().unwrap(), "--quiet"]);
    assert!(code == 1 && err.contains("exists") && !scratch.join("new.csv").exists(), "{err}");
    let both = scratch.argument("both.svg");
    let (code, _, err) = run(&["inspect", &file, "--csv", &both, "--picture", &both, "--quiet"]);
    assert!(code == 1 && err.contains("table and for the drawing") && !scratch.join("both.svg").exists(), "{err}");
}
