//! Charts of scenes that have little to compare: nothing in view, one facet, one pixel, no light; and of names that are no words.

use crate::cli::{mmxrt, run};
use crate::scenes::{SITE, SQUARE, SQUARE_OBJ, replaced};
use crate::scratch::Scratch;

/// Fewer pixels than the site has: a chart casts 1365 rays in each, several times.
const SMALL: [(&str, &str); 2] = [("samples = 16", "samples = 6"), ("lines = 16", "lines = 5")];

/// What a chart's folder holds.
struct Files {
    csv: String,
    svg: String,
    page: String,
    said: String,
}

/// The rows of a table, by columns' names.
fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines().filter(|line| !line.starts_with('#'));
    let at = lines.next().unwrap().split(',').position(|head| head == name).unwrap_or_else(|| panic!("no {name}"));
    // Names of methods with a comma are in quotes, and stand before all numbers.
    let field = |line: &str| {
        let mut quoted = false;
        let plain: String = line
            .chars()
            .map(|c| {
                quoted ^= c == '"';
                if quoted && c == ',' { ';' } else { c }
            })
            .collect();
        plain.split(',').nth(at).unwrap().parse::<f64>().unwrap_or_else(|e| panic!("{e}: {line}"))
    };
    lines.map(field).collect()
}

/// Makes a chart of a scene, in which every number must be one.
fn charted(scratch: &Scratch, text: &str) -> Files {
    let scene = scratch.write("s.toml", text);
    let out = scratch.argument("chart");
    let (code, said, err) = run(&["chart", scene.to_str().unwrap(), "-o", &out, "--force"]);
    assert_eq!(code, 0, "{err}");
    let read = |name: &str| std::fs::read_to_string(scratch.join("chart").join(name)).unwrap();
    let files = Files { csv: read("chart.csv"), svg: read("chart.svg"), page: read("chart.html"), said };
    for text in [&files.csv, &files.svg, &files.said] {
        assert!(!text.contains("NaN"), "{text}");
    }
    assert!(!files.svg.contains("inf") && !files.said.contains("inf"), "{}", files.said);
    // Pictures are text of 64 letters, in which anything may occur.
    let words: Vec<&str> =
        files.page.split("src=\"data:").map(|part| part.split_once('"').map_or(part, |(_, rest)| rest)).collect();
    assert!(!words.concat().contains("NaN"), "{}", words.concat());
    for name in ["all_p50", "all_p99", "all_p99.9", "all_max", "all_rms", "cpu_s"] {
        assert!(column(&files.csv, name).iter().all(|value| *value >= 0.0), "{name}: {}", files.csv);
    }
    assert_eq!(scratch.names().iter().filter(|name| name.starts_with('.')).count(), 0, "{:?}", scratch.names());
    files
}

#[test]
fn a_chart_of_nothing_in_view() {
    let scratch = Scratch::new();
    // The camera looks away from the site.
    let away = ("target_m = [0.0, 12000.0, 0.0]", "target_m = [0.0, 152000.0, 0.0]");
    let files = charted(&scratch, &replaced(SITE, &[SMALL[0], SMALL[1], away]));
    assert!(column(&files.csv, "all_pixels").iter().all(|pixels| *pixels == 0.0), "{}", files.csv);
    assert!(column(&files.csv, "all_max").iter().all(|error| *error == 0.0));
}

#[test]
fn a_chart_of_one_facet_in_one_pixel_of_one_band() {
    let scratch = Scratch::new();
    scratch.write("square.obj", "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nf 1 2 3\n");
    let one = replaced(SQUARE, &[("samples = 2", "samples = 1"), ("lines = 2", "lines = 1")]);
    let files = charted(&scratch, &one);
    // A pixel of 4 x 4 m about the middle of the square, cut by its diagonal: half of it is covered, exactly, and by 1024 evenly spread rays nearly.
    let one_ray = files.csv.lines().find(|line| line.contains(",1 ray a pixel,")).unwrap();
    assert!(one_ray.split(',').nth(11).unwrap().parse::<f64>().unwrap() > 0.9, "{one_ray}");
    let many = files.csv.lines().find(|line| line.contains(",1024 rays,")).unwrap();
    assert!(many.split(',').nth(11).unwrap().parse::<f64>().unwrap() < 0.05, "{many}");
}

#[test]
fn a_chart_of_facets_far_finer_than_pixels() {
    let scratch = Scratch::new();
    // Some 240 facets in each of 4 pixels.
    let edits = [("samples = 16", "samples = 2"), ("lines = 16", "lines = 2"), ("fov_deg = 1.0", "fov_deg = 1.5")];
    let text = replaced(SITE, &edits);
    let files = charted(&scratch, &text);
    let facets = column(&files.csv, "facets");
    assert!(facets.iter().any(|n| *n < 0.2 * facets[0]), "{facets:?}");
    // What a coarser mesh would do is told beforehand, too.
    let scene = scratch.argument("s.toml");
    let (code, said, err) = run(&["plan", &scene]);
    assert!(code == 0 && said.contains("facets a pixel"), "{said}{err}");
    let (_, json, _) = run(&["--json", "plan", &scene]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let coarser = &json["plan"]["coarser"];
    let number = |key: &str| coarser[key].as_f64().unwrap();
    // The site is 2 km wide, the image 1.8 km: most of 1000 facets in 4 pixels.
    assert!((150.0..270.0).contains(&number("facets_a_pixel")), "{coarser}");
    // 16 a pixel.
    assert!((60.0..=72.0).contains(&number("facets")), "{coarser}");
    assert!(number("change") > 0.0 && number("change") < 1.0, "{coarser}");
    assert!(number("cpu_s") < json["plan"]["cpu_s"].as_f64().unwrap(), "{json}");
    // Where pixels are no larger than facets there is nothing to say.
    scratch.write("s.toml", SITE);
    assert!(!run(&["plan", &scene]).1.contains("facets a pixel"));
}

#[test]
fn a_chart_of_the_night_and_of_light_from_mars_alone() {
    let scratch = Scratch::new();
    let night = ("direction = [0.0, 1.0, 0.5]", "direction = [0.0, -1.0, 0.2]");
    // Mars is below the horizon: no reflected light at all.
    let below = ("position_m = [9.4e6, 12000.0, 0.0]", "position_m = [0.0, -9.4e6, 0.0]");
    let files = charted(&scratch, &replaced(SITE, &[SMALL[0], SMALL[1], night, below]));
    nothing_but_the_thesis(&files);
    // Mars at the zenith, between the site and no Sun: its night side is dark, too; so it stands where the Sun lights it from the side.
    let files = charted(
        &scratch,
        &replaced(SITE, &[SMALL[0], SMALL[1], ("direction = [0.0, 1.0, 0.5]", "direction = [-1.0, -0.3, 0.2]")]),
    );
    assert!(column(&files.csv, "lit_pixels").iter().all(|pixels| *pixels < 30.0), "{}", files.csv);
    assert!(column(&files.csv, "all_max").iter().any(|error| *error > 0.0), "Mars lights it: {}", files.csv);
}

#[test]
fn a_chart_of_a_surface_that_sends_nothing() {
    let scratch = Scratch::new();
    let black = [("reflectance = 0.07", "reflectance = 0.0"), ("reflectance = 0.1", "reflectance = 0.0")];
    let text = replaced(SITE, &[SMALL[0], SMALL[1], black[0], black[1]]) + "[thermal]\nmodel = \"off\"\n";
    nothing_but_the_thesis(&charted(&scratch, &text));
}

/// No method sees light, but the thesis's: its Mars and its heat are always there, which is infinitely more.
fn nothing_but_the_thesis(files: &Files) {
    let errors = column(&files.csv, "all_max");
    let models: Vec<&str> = files.csv.lines().filter(|line| !line.starts_with('#')).skip(1).collect();
    assert!(errors.len() == models.len() && errors.len() > 15, "{}", files.csv);
    for (error, row) in errors.iter().zip(models) {
        assert_eq!(*error, if row.starts_with("models,thesis,") { f64::INFINITY } else { 0.0 }, "{row}");
    }
    assert!(files.said.contains("no light at all") && files.page.contains("infinite"), "{}", files.said);
}

#[test]
fn a_chart_of_a_textured_square() {
    let scratch = Scratch::new();
    scratch.write("square.obj", SQUARE_OBJ);
    let texels: Vec<u8> = [200u8, 40, 90, 160].to_vec();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 2, 2);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&texels).unwrap();
    scratch.write("grain.png", &png);
    let texture =
        "reflectance = 0.1\ntexture = { raster = \"grain.png\", quantity = \"factor\", placement = \"atlas\" }";
    let files = charted(&scratch, &replaced(SQUARE, &[("reflectance = 0.1", texture)]));
    // Rays leave textures out, and it is said; the ways that do not are right.
    assert!(files.page.contains("leave textures out"));
    let of = |name: &str| {
        let row = files.csv.lines().find(|line| line.contains(&format!(",{name},"))).unwrap();
        row.split(',').nth(12).unwrap().parse::<f64>().unwrap()
    };
    assert!(of("1024 rays") > 0.1 && of("exact shadows of a point Sun") < 1e-6, "{}", files.csv);
}

#[test]
#[cfg(unix)]
fn a_name_that_is_markup_is_shown_as_it_is() {
    let scratch = Scratch::new();
    let name = "a <b>&amp; \"c\" 'd'\n";
    std::fs::create_dir(scratch.join(name)).unwrap();
    let scene = scratch.write(&format!("{name}/scene.toml"), replaced(SITE, &SMALL));
    let out = scratch.argument("<i>&out");
    let (code, _, err) = run(&["chart", scene.to_str().unwrap(), "-o", &out]);
    assert_eq!(code, 0, "{err}");
    let read = |name: &str| std::fs::read_to_string(scratch.join("<i>&out").join(name)).unwrap();
    for text in [read("chart.html"), read("chart.svg")] {
        assert!(!text.contains("<b>&amp; ") && text.contains("a &lt;b&gt;&amp;amp; "), "{}", &text[..3000]);
    }
    // A very long one does not run out of the picture.
    let long = "x".repeat(200);
    std::fs::create_dir(scratch.join(&long)).unwrap();
    let scene = scratch.write(&format!("{long}/scene.toml"), replaced(SITE, &SMALL));
    assert_eq!(run(&["chart", scene.to_str().unwrap(), "-o", &out, "--force"]).0, 0);
    assert!(read("chart.svg").contains("xx..: 6 x 5 pixels"));
}

#[test]
#[cfg(unix)]
fn a_chart_that_is_killed_or_interrupted_leaves_nothing_under_its_name() {
    let scratch = Scratch::new();
    // Long enough to be met at work.
    let scene =
        scratch.write("s.toml", replaced(SITE, &[("samples = 16", "samples = 64"), ("lines = 16", "lines = 64")]));
    let out = scratch.argument("c");
    let started = || {
        let mut child = mmxrt()
            .args(["--quiet", "chart", scene.to_str().unwrap(), "-o", &out])
            .stderr(std::process::Stdio::null())
            .spawn()
            .unwrap();
        while scratch.names().len() < 2 {
            std::thread::sleep(std::time::Duration::from_millis(2));
            assert!(child.try_wait().unwrap().is_none(), "ended before it could be stopped");
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
        child
    };
    // Ctrl-C: nothing at all is left.
    let mut child = started();
    assert!(std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(scratch.names(), ["s.toml"]);
    // A kill: a hidden folder, which the next run with the same output removes.
    let mut child = started();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!scratch.join("c").exists());
    scratch.write("s.toml", replaced(SITE, &SMALL));
    let (code, _, err) = run(&["chart", scene.to_str().unwrap(), "-o", &out]);
    assert!(code == 0 && err.contains("removed"), "{err}");
    assert_eq!(scratch.names(), ["c", "s.toml"]);
}
