//! Sums and differences of maps, heat in them, and pixels that no map knows.

use crate::map_files::Bench;

const ONE: &str = "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nbands = { centres_um = [1.0] }\n\
    placement = \"facets\"\n";

fn value_of(bench: &Bench, path: &[&str]) -> serde_json::Value {
    let text = std::fs::read_to_string(bench.0.join("out/report.json")).unwrap();
    let mut value: serde_json::Value = serde_json::from_str(&text).unwrap();
    for key in path {
        value = value[key].take();
    }
    value
}

#[test]
fn differences_are_allowed_as_long_as_something_is_left() {
    let bench = Bench::new();
    bench.0.write("a.csv", "5\n7\n");
    bench.0.write("a.map.toml", ONE);
    bench.0.write("b.csv", "2\n7\n");
    bench.0.write("b.map.toml", ONE);
    // Facets 0 and 1: 3 and 0; the pixels on the diagonal hold half of each.
    let image = bench.integrate(&["--radiance", "{}a.csv+{}b.csv*-1"]);
    assert!(image.iter().zip([0.0, 1.5, 1.5, 3.0]).all(|(a, b)| *a >= 0.0 && (a - b).abs() < 1e-9), "{image:?}");
    let warnings = value_of(&bench, &["warnings"]).to_string();
    assert!(warnings.contains("maps are subtracted") && warnings.contains("b.csv times -1"), "{warnings}");
    let (code, err) = bench.try_to(&["--radiance", "{}a.csv+{}b.csv*-2"]);
    // 7 - 14 on facet 1, which fills the pixel at sample 0, line 0.
    let place = "at sample 0, line 0 (from 0) of band 1, the least of 3 values below 0";
    assert!(code == 1 && err.contains("the sum is -7") && err.contains(place), "{err}");
    let (code, err) = bench.try_to(&["--radiance", "{}a.csv*-1"]);
    assert!(code == 1 && err.contains("the sum is -7"), "{err}");
    // What single precision leaves of a difference is 0.
    bench.0.write("b.csv", "2\n7.0000002\n");
    assert_eq!(bench.integrate(&["--radiance", "{}a.csv+{}b.csv*-1"])[0], 0.0);
}

/// The bench's scene, warm, at 8 um.
fn warm(bench: &Bench) {
    let text = std::fs::read_to_string(bench.0.join("scene.toml")).unwrap();
    let text = text.replace("[thermal]\nmodel = \"off\"\n", "").replace("centres_um = [1.0]", "centres_um = [8.0]");
    bench.0.write("scene.toml", text);
    let (scene, table) = (bench.0.argument("scene.toml"), bench.0.argument("table.npz"));
    assert_eq!(crate::cli::run(&["solve", &scene, "-o", &table, "--quiet"]).0, 0);
}

#[test]
fn heat_counts_once() {
    let bench = Bench::new();
    warm(&bench);
    let tb = ONE
        .replace("\"radiance\"", "\"brightness_temperature\"")
        .replace("W m-2 sr-1 um-1", "K")
        .replace("1.0]", "8.0]");
    let radiance = ONE.replace("1.0]", "8.0]");
    bench.0.write("tb.csv", "300\n300\n");
    bench.0.write("tb.map.toml", &tb);
    bench.0.write("l.csv", "1\n1\n");
    bench.0.write("l.map.toml", &radiance);
    for sum in ["{}table.npz+{}tb.csv", "{}tb.csv+{}table.npz", "{}tb.csv+{}tb.csv"] {
        let (code, err) = bench.try_to(&["--radiance", sum]);
        assert!(code == 1 && err.contains("thermal emission would count 2 times"), "{err}");
    }
    // Nor two or three times of one.
    for (sum, times) in [("{}tb.csv*2", 2), ("{}tb.csv*3", 3)] {
        let (code, err) = bench.try_to(&["--radiance", sum]);
        assert!(code == 1 && err.contains(&format!("thermal emission would count {times} times")), "{err}");
    }
    // A mean of two holds it once, a difference not at all.
    let one = bench.integrate(&["--radiance", "{}tb.csv"])[0];
    assert!((bench.integrate(&["--radiance", "{}tb.csv*0.25+{}tb.csv*0.75"])[0] - one).abs() < 1e-12 * one);
    assert_eq!(bench.integrate(&["--radiance", "{}tb.csv+{}tb.csv*-1"])[0], 0.0);
    // Of a radiance nobody knows: told, until the map file says.
    bench.integrate(&["--radiance", "{}table.npz+{}l.csv"]);
    assert!(value_of(&bench, &["warnings"]).to_string().contains("if it is in"), "{}", value_of(&bench, &["warnings"]));
    bench.0.write("l.map.toml", format!("heat = false\n{radiance}"));
    bench.integrate(&["--radiance", "{}table.npz+{}l.csv"]);
    assert!(!value_of(&bench, &["warnings"]).to_string().contains("if it is in"));
    bench.0.write("l.map.toml", format!("heat = true\n{radiance}"));
    assert!(bench.try_to(&["--radiance", "{}table.npz+{}l.csv"]).1.contains("would count 2 times"));
    // And one that is said to hold none, though brightness temperatures mostly do.
    bench.0.write("tb.map.toml", format!("heat = false\n{tb}"));
    bench.integrate(&["--radiance", "{}table.npz+{}tb.csv"]);
}

#[test]
fn pixels_that_no_map_knows_are_told_and_marked() {
    // 64 x 64 pixels of 0.125 m; one texel of 0.125 m, on a facet of its own, has no value: 1 / 4096 of what is seen.
    let bench = Bench::new();
    let text = std::fs::read_to_string(bench.0.join("scene.toml")).unwrap();
    bench.0.write("scene.toml", text.replace("samples = 2\nlines = 2", "samples = 64\nlines = 64"));
    // A hole in the square, filled by a quad of its own, a pixel large: columns 32, rows 31 (y from 0 to 0.125).
    bench.0.write(
        "square.obj",
        "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nv 0 0 0\nv 0.125 0 0\nv 0.125 0.125 0\nv 0 0.125 0\n\
         f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n",
    );
    let values: Vec<String> = (0..64)
        .map(|row| (0..64).map(|c| if (row, c) == (31, 32) { "nan" } else { "50" }).collect::<Vec<_>>().join(","))
        .collect();
    bench.0.write("m.csv", values.join("\n") + "\n");
    bench.map(
        "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nbands = { centres_um = [1.0] }\nplacement = \"plane\"\n\
         plane = { corner_m = [-4, 4, 0], along_line_m = [0.125, 0, 0], line_to_line_m = [0, -0.125, 0] }\n",
    );
    let hole = 31 * 64 + 32;
    let image = bench.integrate(&["--radiance", "{}m.csv"]);
    assert!((image[hole] == 0.0) && (image[hole - 1] - 50.0).abs() < 1e-9, "{} {}", image[hole], image[hole - 1]);
    let warnings = value_of(&bench, &["warnings"]).to_string();
    let wanted = "0.024 % of what the camera sees is unknown to the maps";
    assert!(warnings.contains(wanted) && warnings.contains("1 pixels of which nothing is known are 0"), "{warnings}");
    assert_eq!(value_of(&bench, &["maps", "unknown_pixels"]), 1);
    let image = bench.integrate(&["--radiance", "{}m.csv", "--unknown", "nan"]);
    assert!(image[hole].is_nan() && image.iter().filter(|l| l.is_nan()).count() == 1);
    assert!(value_of(&bench, &["warnings"]).to_string().contains("1 pixels of which nothing is known are NaN"));
    let image = bench.integrate(&["--radiance", "{}m.csv", "--unknown", "7.5"]);
    assert!((image[hole] - 7.5).abs() < 1e-9);
    // Any share may be unknown if it is marked.
    bench.0.write("m.csv", vec![vec!["nan"; 64].join(","); 64].join("\n") + "\n");
    assert!(bench.integrate(&["--radiance", "{}m.csv", "--unknown", "nan"]).iter().all(|l| l.is_nan()));
}

#[test]
fn what_filters_leave_below_zero_can_be_cut_off() {
    let bench = Bench::new();
    bench.0.write("m.csv", "10,-0.5\n3,4\n");
    let (code, err) = bench.try_to(&["--radiance", "{}m.csv"]);
    assert!(code == 1 && err.contains("-0.5 is negative") && err.contains("negative = \"clip\""), "{err}");
    let map = std::fs::read_to_string(bench.0.join("m.map.toml")).unwrap();
    bench.map(&format!("negative = \"clip\"\n{map}"));
    let image = bench.integrate(&["--radiance", "{}m.csv"]);
    assert!(image.iter().zip([10.0, 0.0, 3.0, 4.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{image:?}");
    // -9 is no side lobe of 10, and -1 of 3 is more likely a mark.
    for text in ["10,-9\n3,4\n", "1,-1\n3,4\n"] {
        bench.0.write("m.csv", text);
        let (code, err) = bench.try_to(&["--radiance", "{}m.csv"]);
        assert!(code == 1 && err.contains("is negative"), "{err}");
    }
}
