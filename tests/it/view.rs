//! Pages for a browser: they hold the numbers of the files, stay within their budget, load nothing, and no name in a file becomes markup.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::Path;

use serde_json::Value;

use crate::cli::{mmxrt, run};
use crate::scratch::Scratch;

/// A page taken apart.
struct Page {
    html: String,
    about: Value,
}

impl Page {
    fn read(path: &Path) -> Self {
        let html = std::fs::read_to_string(path).unwrap();
        let about = within(&html, "<script type=\"application/json\" id=\"about\">", "</script>");
        Page { about: serde_json::from_str(about).unwrap(), html }
    }

    fn stack(&self, key: &str) -> Option<&Value> {
        self.about["stacks"].as_array().unwrap().iter().find(|stack| stack["key"] == key)
    }

    /// All numbers of a stack: [band, cell].
    fn numbers(&self, key: &str) -> Vec<Vec<f64>> {
        let stack = self.stack(key).unwrap();
        let whole = |key: &str| stack[key].as_u64().unwrap() as usize;
        let cells = whole("columns").div_ceil(whole("side")) * whole("rows").div_ceil(whole("side"));
        let mut bands = Vec::new();
        for (k, size) in stack["bytes"].as_array().unwrap().iter().enumerate() {
            let begin = format!("<script type=\"text/plain\" id=\"block{}\">", whole("first_block") + k);
            let packed = bytes(within(&self.html, &begin, "</script>"));
            let mut mixed = Vec::new();
            flate2::read::ZlibDecoder::new(packed.as_slice()).read_to_end(&mut mixed).unwrap();
            let size = size.as_u64().unwrap() as usize;
            let count = mixed.len() / size;
            let value = |i: usize| {
                let bytes: Vec<u8> = (0..size).map(|k| mixed[k * count + i]).collect();
                match size {
                    4 => f64::from(f32::from_le_bytes(bytes.try_into().unwrap())),
                    _ => f64::from_le_bytes(bytes.try_into().unwrap()),
                }
            };
            let values: Vec<f64> = (0..count).map(value).collect();
            assert_eq!(stack["starts"][k].as_u64().unwrap() as usize, bands.len());
            bands.extend(values.chunks(cells).map(<[f64]>::to_vec));
        }
        bands
    }
}

/// What is between two texts.
fn within<'a>(text: &'a str, begin: &str, end: &str) -> &'a str {
    let text = text.split_once(begin).unwrap_or_else(|| panic!("no {begin}")).1;
    text.split_once(end).unwrap().0
}

/// Of base64.
fn bytes(text: &str) -> Vec<u8> {
    const DIGITS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let of: BTreeMap<char, u32> = DIGITS.chars().zip(0..).collect();
    let digits: Vec<u32> = text.trim_end_matches('=').chars().map(|c| of[&c]).collect();
    let three = |four: &[u32]| {
        let bits = (0..4).fold(0, |bits, i| bits << 6 | four.get(i).copied().unwrap_or(0));
        bits.to_be_bytes()[1..four.len()].to_vec()
    };
    digits.chunks(4).flat_map(three).collect()
}

/// Writes an ENVI image, band by band: f32, or f64.
fn image(scratch: &Scratch, name: &str, [columns, rows]: [usize; 2], bands: &[Vec<f64>], more: &str) {
    let is_double = more.contains("data type = 5");
    let bytes = bands.iter().flatten();
    let bytes: Vec<u8> = match is_double {
        true => bytes.flat_map(|value| value.to_le_bytes()).collect(),
        false => bytes.flat_map(|value| (*value as f32).to_le_bytes()).collect(),
    };
    scratch.write(&format!("{name}.img"), bytes);
    let kind = if is_double { "" } else { "data type = 4\n" };
    let header = format!(
        "ENVI\nsamples = {columns}\nlines = {rows}\nbands = {}\nheader offset = 0\nfile type = ENVI Standard\n{kind}interleave = bsq\nbyte order = 0\n{more}\n",
        bands.len()
    );
    scratch.write(&format!("{name}.hdr"), header);
}

fn folder(scratch: &Scratch, name: &str) {
    std::fs::create_dir_all(scratch.join(name)).unwrap();
}

/// Makes the page of an input.
fn viewed(scratch: &Scratch, name: &str, more: &[&str]) -> Page {
    let (input, page) = (scratch.argument(name), scratch.argument(&format!("{name}.page.html")));
    let mut arguments = vec!["view", &input, "-o", &page];
    arguments.extend(more);
    let (code, _, error) = run(&arguments);
    assert_eq!(code, 0, "{error}");
    let page = Page::read(&scratch.join(&format!("{name}.page.html")));
    loads_nothing(&page.html);
    page
}

/// No element of the page asks for anything from elsewhere, and all elements are those of the page itself.
fn loads_nothing(html: &str) {
    for reference in
        ["src=\"", "href=", "url(", "@import", "fetch(", "XMLHttpRequest", "import(", "WebSocket", "https://"]
    {
        assert!(!html.contains(reference), "{reference}");
    }
    // The one address is the name of SVG's elements.
    for (at, _) in html.match_indices("http://") {
        assert!(html[at..].starts_with("http://www.w3.org/2000/svg\""), "{}", &html[at..at + 40]);
    }
    assert!(html.contains("default-src 'none'"));
}

#[test]
fn the_page_holds_the_numbers_of_the_files() {
    let scratch = Scratch::new();
    folder(&scratch, "p");
    let value = |band: usize, i: usize| ((band * 37 + i * 11) % 101) as f64 / 7.0 - 3.0;
    let bands = |count: usize| (0..count).map(|b| (0..30).map(|i| value(b, i)).collect()).collect::<Vec<Vec<f64>>>();
    let (cube, thermal) = (bands(4), bands(8)[4..].to_vec());
    image(
        &scratch,
        "p/cube",
        [6, 5],
        &cube,
        "wavelength units = Micrometers\nwavelength = {1, 2, 3, 4}\ndata units = W m-2 sr-1 um-1",
    );
    image(&scratch, "p/thermal", [6, 5], &thermal, "");
    // An index beyond the whole numbers of single precision, and no data.
    let planes =
        vec![vec![16_777_217.0; 30], (0..30).map(|i| if i % 4 == 0 { f64::NAN } else { f64::from(i) }).collect()];
    image(&scratch, "p/backplanes", [6, 5], &planes, "data type = 5\nband names = {FACET (index from 0), PHASE (deg)}");
    let page = viewed(&scratch, "p", &[]);
    for (key, bands) in [("cube", &cube), ("thermal", &thermal)] {
        let single: Vec<Vec<f64>> = bands.iter().map(|b| b.iter().map(|v| f64::from(*v as f32)).collect()).collect();
        assert_eq!(page.numbers(key), single);
        assert_eq!(page.stack(key).unwrap()["side"], 1);
    }
    let found = page.numbers("planes");
    assert!(found.iter().flatten().zip(planes.iter().flatten()).all(|(a, b)| a == b || (a.is_nan() && b.is_nan())));
    let about = page.stack("cube").unwrap();
    assert_eq!(about["um"], serde_json::json!([1.0, 2.0, 3.0, 4.0]));
    assert_eq!(about["unit"], "W m-2 sr-1 um-1");
    assert_eq!(about["file"]["interleave"], "bsq");
    assert!(page.about["warnings"][0].as_str().unwrap().contains("report.json is not there"));
    // What the script draws with: viridis from end to end, and what the documentation says of quick looks.
    let (viridis, look) = (page.about["viridis"].as_array().unwrap(), &page.about["look"]);
    assert_eq!((&viridis[0], &viridis[viridis.len() - 1]), (&[68, 1, 84].into(), &[253, 231, 37].into()));
    assert_eq!(look["black_white"], serde_json::json!([0.005, 0.995]));
    assert_eq!(look["least_power"].as_f64(), Some(1.0 / 3.0));
}

#[test]
fn what_is_too_large_is_averaged_within_the_budget() {
    let scratch = Scratch::new();
    folder(&scratch, "p");
    // 1 MB for a cube of 50 x 41 x 300 f32, 2.5 MB, and planes: half is the cube's. Sides of 3: 17 x 14 x 300 x 4 = 285 600; of 2: 630 000.
    let (columns, rows) = (50, 41);
    let value = |band: usize, i: usize| ((band * 7 + i * 13) % 1009) as f64;
    let cube: Vec<Vec<f64>> = (0..300).map(|b| (0..columns * rows).map(|i| value(b, i)).collect()).collect();
    image(&scratch, "p/cube", [columns, rows], &cube, "");
    let page = viewed(&scratch, "p", &["--budget", "1"]);
    assert_eq!(page.stack("cube").unwrap()["side"], 3);
    assert!(page.html.len() < 1_500_000, "{}", page.html.len());
    let found = page.numbers("cube");
    // The first cell, and the last: columns 48 and 49, lines 39 and 40.
    for band in [0, 150, 299] {
        let mean = |ys: std::ops::Range<usize>, xs: std::ops::Range<usize>| {
            let all: Vec<f64> = ys.flat_map(|y| xs.clone().map(move |x| value(band, y * columns + x))).collect();
            f64::from((all.iter().sum::<f64>() / all.len() as f64) as f32)
        };
        assert_eq!(found[band][0], mean(0..3, 0..3));
        assert_eq!(found[band][17 * 14 - 1], mean(39..41, 48..50));
    }
}

/// Backplanes are reduced by themselves: those of this product are, and its cube is not.
#[test]
fn reduced_backplanes_have_the_pixel_in_the_middle_of_each_cell() {
    let scratch = Scratch::new();
    folder(&scratch, "p");
    // Of 1 MB half is for 12 planes: of 201 x 199 f32 they take 1.9 MB, of 101 x 100 485 kB. A quarter is for the cube, 160 kB.
    let plane = |band: usize| (0..201 * 199).map(|i| (i + 100_000 * band) as f64).collect::<Vec<f64>>();
    let planes: Vec<Vec<f64>> = (0..12).map(plane).collect();
    image(&scratch, "p/cube", [201, 199], &planes[..1], "");
    image(&scratch, "p/thermal", [201, 199], &planes[..1], "");
    image(&scratch, "p/backplanes", [201, 199], &planes, "data type = 5");
    let page = viewed(&scratch, "p", &["--budget", "1"]);
    let sides = ["cube", "thermal", "planes"].map(|key| page.stack(key).unwrap()["side"].as_u64());
    assert_eq!(sides, [Some(1), Some(1), Some(2)]);
    let found = page.numbers("planes");
    for (band, cells) in found.iter().enumerate() {
        // Lines 0 and 1, samples 0 and 1: line 1, sample 1. Of sample 200 there is one, and of line 198.
        let [first, right, last] = [202.0, 401.0, 39_998.0].map(|i| i + 1e5 * band as f64);
        assert_eq!((cells.len(), cells[0], cells[100], cells[101 * 100 - 1]), (10_100, first, right, last));
    }
}

#[test]
fn a_thermal_part_of_other_bands_is_not_shown() {
    let scratch = Scratch::new();
    folder(&scratch, "p");
    image(&scratch, "p/cube", [2, 1], &[vec![1.0, 2.0], vec![3.0, 4.0]], "");
    image(&scratch, "p/thermal", [2, 1], &[vec![1.0, 2.0]], "");
    let page = viewed(&scratch, "p", &[]);
    assert!(page.stack("thermal").is_none());
    let warnings = page.about["warnings"].as_array().unwrap();
    assert!(
        warnings.iter().any(|said| said.as_str().unwrap().ends_with("has 1 bands, the cube has 2; it is not shown"))
    );
}

#[test]
fn numbers_that_mean_no_data_are_none_in_whatever_precision() {
    let scratch = Scratch::new();
    // Neither -9999.9 nor the least f32, in so few digits, is an f32.
    for ignored in ["-9999.9", "-3.402823e38", "0.1"] {
        let value: f64 = ignored.parse().unwrap();
        image(&scratch, "flat", [3, 1], &[vec![1.0, value, 2.0]], &format!("data ignore value = {ignored}"));
        let page = scratch.argument("flat.html");
        assert_eq!(run(&["view", &scratch.argument("flat.img"), "-o", &page, "--force"]).0, 0);
        let page = Page::read(&scratch.join("flat.html"));
        let found = page.numbers("cube");
        assert!(found[0][0] == 1.0 && found[0][1].is_nan() && found[0][2] == 2.0, "{ignored}: {found:?}");
        // For the script, which reads the whole file, and rounds it.
        assert_eq!(page.stack("cube").unwrap()["file"]["ignore"].as_f64(), Some(value));
    }
}

#[test]
fn the_budget_holds_for_numbers_of_double_precision() {
    let scratch = Scratch::new();
    // Of 300 x 400, two bands: 0.96 MB in single precision, 1.92 MB in double precision, 0.48 MB of 150 x 200 cells.
    let band = |value: f64| vec![value; 300 * 400];
    let of_pixels = |name: &str| {
        let page = viewed(&scratch, &format!("{name}.img"), &["--budget", "1"]);
        let stack = page.stack("cube").unwrap();
        (stack["side"].as_u64().unwrap(), stack["bytes"].clone(), page.numbers("cube"))
    };
    image(&scratch, "double", [300, 400], &[band(1e-300), band(1e-40)], "data type = 5");
    let (side, bytes, found) = of_pixels("double");
    assert_eq!((side, bytes, found[0].len()), (2, [8].into(), 150 * 200));
    assert!((found[0][0] / 1e-300 - 1.0).abs() < 1e-15 && (found[1][0] / 1e-40 - 1.0).abs() < 1e-15);
    // A thermal part of which single precision lacks much, and its cube: each has a quarter of 1 MB, and cells of one size. Of 120 x 100, five bands: 240 kB.
    folder(&scratch, "p");
    let cube = vec![vec![1.0; 120 * 100]; 5];
    image(&scratch, "p/cube", [120, 100], &cube, "data type = 5");
    image(&scratch, "p/thermal", [120, 100], &vec![vec![1e-60; 120 * 100]; 5], "data type = 5");
    let page = viewed(&scratch, "p", &["--budget", "1"]);
    let of = |key: &str| (page.stack(key).unwrap()["side"].clone(), page.numbers(key)[4].len());
    assert_eq!((of("cube"), of("thermal")), ((2.into(), 60 * 50), (2.into(), 60 * 50)));
    // Subnormal, and still exact in single precision.
    image(&scratch, "single", [300, 400], &[band(2_f64.powi(-149)), band(1.0)], "");
    let (side, bytes, found) = of_pixels("single");
    assert_eq!((side, bytes, found[0][7]), (1, [4].into(), 2_f64.powi(-149)));
}

#[test]
fn odd_images_have_pages() {
    let scratch = Scratch::new();
    for (name, size, bands) in [
        ("pixel", [1, 1], vec![vec![2.5]]),
        ("nothing", [3, 2], vec![vec![f64::NAN; 6]; 2]),
        ("many", [2, 1], (0..5000).map(|b| vec![f64::from(b), -f64::from(b)]).collect()),
        ("dark", [4, 4], vec![vec![0.0; 16]]),
        ("far", [2, 1], vec![vec![f64::INFINITY, f64::NEG_INFINITY]]),
    ] {
        folder(&scratch, name);
        image(&scratch, &format!("{name}/cube"), size, &bands, "");
        // All of it is sky.
        image(
            &scratch,
            &format!("{name}/backplanes"),
            size,
            &[vec![0.0; size[0] * size[1]]],
            "band names = {COVERAGE}",
        );
        let found = viewed(&scratch, name, &[]).numbers("cube");
        assert_eq!(found.len(), bands.len());
        let is_same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
        assert!(found.iter().flatten().zip(bands.iter().flatten()).all(is_same), "{name}");
        // The image alone, too.
        let alone = viewed(&scratch, &format!("{name}/cube.img"), &[]);
        assert_eq!((alone.about["kind"].as_str(), alone.numbers("cube").len()), (Some("image"), bands.len()));
    }
    // Numbers that single precision does not have.
    image(&scratch, "wide", [2, 1], &[vec![1e300, 1e-300]], "data type = 5");
    assert_eq!(viewed(&scratch, "wide.img", &[]).numbers("cube"), [[1e300, 1e-300]]);
}

#[test]
fn no_file_puts_markup_into_the_page() {
    let scratch = Scratch::new();
    let name = "a\"b'<img src=x onerror=alert(1)>&{{script}}";
    folder(&scratch, name);
    let attack = "</script><script>alert(1)</script><!-- \"'";
    image(
        &scratch,
        &format!("{name}/cube"),
        [1, 1],
        &[vec![1.0]],
        &format!("band names = {{{attack}}}\ndata units = {attack}"),
    );
    let report = serde_json::json!({ "warnings": [attack], "orientation": attack, "surfaces": attack, "effects": [attack, 3, null], "inputs": "{{about}} {{script}}" });
    scratch.write(&format!("{name}/report.json"), report.to_string());
    let page = viewed(&scratch, name, &[]);
    let count = |what: &str| page.html.matches(what).count();
    // One block, what is said of it, and the script: each begun once and ended once.
    assert_eq!((count("<script"), count("</script"), count("<img"), count("<!--")), (3, 3, 0, 0));
    assert!(!page.html.contains("<script>alert"));
    assert_eq!(page.about["title"], name);
    assert_eq!(page.about["report"]["warnings"][0], attack);
    // A report that is none is said to be none.
    scratch.write(&format!("{name}/report.json"), "{");
    let (input, again) = (scratch.argument(name), scratch.argument("again.html"));
    assert_eq!(run(&["view", &input, "-o", &again]).0, 0);
    let again = Page::read(&scratch.join("again.html"));
    assert!(again.about["warnings"][0].as_str().unwrap().contains("report.json cannot be read"));
}

#[test]
fn pages_are_beside_what_they_show_and_replace_nothing() {
    let scratch = Scratch::new();
    image(&scratch, "flat", [2, 2], &[vec![1.0; 4]], "");
    let input = scratch.argument("flat.img");
    let output = mmxrt().args(["view", &input, "--json"]).output().unwrap();
    assert!(output.status.success());
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    let page = scratch.join("flat.img.html");
    assert_eq!(said["bytes"].as_u64().unwrap(), page.metadata().unwrap().len());
    assert_eq!((&said["kind"], &said["pixels_of_a_cell"]["cube"]), (&"image".into(), &1.into()));
    let before = std::fs::read(&page).unwrap();
    assert_eq!(run(&["view", &input]).0, 1);
    assert_eq!(run(&["view", &input, "--force", "--threads", "1"]).0, 0);
    assert_eq!(std::fs::read(&page).unwrap(), before);
    // Nor its own input, even when asked.
    let (code, _, error) = run(&["view", &input, "-o", &input, "--force"]);
    assert_eq!(code, 1, "{error}");
    assert_eq!(std::fs::read(scratch.join("flat.img")).unwrap().len(), 16);
}

#[test]
fn folders_and_curves_have_pages_and_the_rest_is_refused() {
    let scratch = Scratch::new();
    scratch.write("grey.csv", "wavelength_um,reflectance\n1,0.1\n2,0.2\n3,0.15\n");
    let page = viewed(&scratch, "grey.csv", &[]);
    assert_eq!(page.about["spectra"][0]["values"], serde_json::json!([0.1, 0.2, 0.15]));
    folder(&scratch, "chart");
    scratch.write("chart/chart.csv", "method,cpu_s\nexact,1\n");
    // A PNG of one black pixel.
    let png = bytes("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNgAAAAAgABSK+kcQAAAABJRU5ErkJggg==");
    scratch.write("chart/chart.png", &png);
    let page = viewed(&scratch, "chart", &[]);
    assert_eq!(bytes(page.about["pictures"][0]["png"].as_str().unwrap()), png);
    assert_eq!(page.about["texts"][0]["text"], "method,cpu_s\nexact,1\n");
    // A table that is too long is left out, and the rest is shown.
    scratch.write("chart/chart.csv", vec![b'1'; (4 << 20) + 1]);
    let page = viewed(&scratch, "chart", &["--force"]);
    assert_eq!(
        (page.about["texts"].as_array().unwrap().len(), page.about["pictures"].as_array().unwrap().len()),
        (0, 1)
    );
    assert!(page.about["warnings"][0].as_str().unwrap().contains("chart.csv: of 4194305 bytes, too large"));
    scratch.write("notes.md", "nothing");
    folder(&scratch, "empty");
    for name in ["notes.md", "empty", "not_there"] {
        let (code, _, error) = run(&["view", &scratch.argument(name)]);
        assert_eq!(code, 1);
        assert!(name == "not_there" || error.contains("can be viewed"), "{error}");
        assert!(!scratch.join(&format!("{name}.html")).exists());
    }
}

#[test]
fn other_containers_have_the_same_numbers() {
    let scratch = Scratch::new();
    folder(&scratch, "p");
    let bands: Vec<Vec<f64>> = (0..3).map(|b| (0..20).map(|i| f64::from(b * 20 + i) / 8.0).collect()).collect();
    let header = "wavelength units = Micrometers\nwavelength = {1, 2, 3}";
    image(&scratch, "p/cube", [5, 4], &bands, header);
    for ending in ["nc", "zarr", "fits"] {
        folder(&scratch, ending);
        let to = scratch.argument(&format!("{ending}/cube.{ending}"));
        let (code, _, error) = run(&["convert", &scratch.argument("p/cube.img"), &to]);
        assert_eq!(code, 0, "{error}");
        let page = viewed(&scratch, ending, &[]);
        assert_eq!((page.numbers("cube"), page.about["kind"].as_str()), (bands.clone(), Some("product")), "{ending}");
    }
}

#[test]
fn nothing_but_a_page_is_replaced() {
    let scratch = Scratch::new();
    let file = scratch.write("two.csv", "wavelength_um,ice\n1,0.1\n2,0.2\n");
    let scene = scratch.write("scene.toml", "mmxrt_scene = 1\n");
    let (code, _, error) = run(&["view", file.to_str().unwrap(), "-o", scene.to_str().unwrap(), "--force"]);
    assert!(code == 1 && error.contains("ends in .html"), "{error}");
    assert_eq!(std::fs::read_to_string(&scene).unwrap(), "mmxrt_scene = 1\n");
}

#[test]
fn a_campaign_that_has_not_ended_says_so() {
    let scratch = Scratch::new();
    folder(&scratch, "c/products");
    folder(&scratch, "c/sights");
    let (code, _, error) = run(&["view", &scratch.argument("c")]);
    assert!(code == 1 && error.contains("has no maps yet"), "{error}");
}
