//! Folders to begin with: each runs as it is, and nothing is ever replaced.

use crate::cli::{mmxrt, run};
use crate::scratch::Scratch;

/// Makes a template's folder, and gives the words of what it says is to be run next.
fn made(scratch: &Scratch, template: &str) -> Vec<String> {
    let (code, out, err) = run(&["new", &scratch.argument(template), "--template", template]);
    assert_eq!(code, 0, "{err}");
    let next = out.lines().last().unwrap().split("&& mmxrt ").nth(1).unwrap_or_else(|| panic!("{out}"));
    next.split_whitespace().map(str::to_owned).collect()
}

#[test]
fn each_template_runs_as_it_is() {
    let scratch = Scratch::new();
    for (template, more, makes) in [
        (
            "site",
            &["--model", "sunlight", "--set", "sensor.samples=32", "--set", "sensor.lines=32"][..],
            "out/cube.img",
        ),
        ("body", &["--model", "sunlight,heat"], "out/quicklook.png"),
        ("dart", &[], "dart_site/input/maket.xml"),
        ("map", &[], "out/cube.img"),
        ("campaign", &[], "looks/manifest.json"),
    ] {
        let mut next = made(&scratch, template);
        next.extend(more.iter().map(|word| (*word).to_owned()));
        let output = mmxrt().current_dir(scratch.join(template)).args(&next).output().unwrap();
        assert!(output.status.success(), "{template}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(scratch.join(template).join(makes).is_file(), "{template}");
        // The scene as it stands, too, without a warning of what it leaves out of itself.
        let checked = mmxrt().current_dir(scratch.join(template)).args(["inspect", "scene.toml"]).output().unwrap();
        assert!(checked.status.success(), "{template}: {}", String::from_utf8_lossy(&checked.stderr));
    }
    // The checkerboard is 0 and 1 in texels of 100 m, 10 pixels each: half of it is 1, and every pixel is one or the other.
    let cube = std::fs::read(scratch.join("map/out/cube.img")).unwrap();
    let values: Vec<f32> = cube.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    assert_eq!(values.len(), 10_000);
    let mean = values.iter().sum::<f32>() / 10_000.0;
    assert!((mean - 0.5).abs() < 0.02, "{mean}");
}

#[test]
fn the_body_is_phobos() {
    let scratch = Scratch::new();
    made(&scratch, "body");
    let (code, out, err) = run(&["inspect", &scratch.argument("body/body.obj"), "--json"]);
    assert_eq!(code, 0, "{err}");
    let facts: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(facts["facets"], 20 * 32 * 32, "{facts}");
    // 5742 km3 by Ernst et al. (2023); the ellipsoid has 5615, craters take some.
    let text = std::fs::read_to_string(scratch.join("body/body.obj")).unwrap();
    let vertices: Vec<[f64; 3]> = text
        .lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|v| {
            let v: Vec<f64> = v.split(' ').map(|x| x.parse().unwrap()).collect();
            [v[0], v[1], v[2]]
        })
        .collect();
    assert_eq!(vertices.len(), 10 * 32 * 32 + 2);
    for (axis, half_m) in [12_950.0, 11_300.0, 9_160.0].into_iter().enumerate() {
        let most = vertices.iter().map(|v| v[axis].abs()).fold(0.0, f64::max);
        assert!((most / half_m - 1.0).abs() < 0.05, "axis {axis}: {most}");
    }
}

#[test]
fn nothing_is_replaced() {
    let scratch = Scratch::new();
    made(&scratch, "site");
    let (code, _, err) = run(&["new", &scratch.argument("site"), "--template", "map"]);
    assert!(code == 1 && err.contains("exists"), "{err}");
    let (code, _, err) = run(&["new", &scratch.argument("a"), "--template", "moon"]);
    assert!(code == 2 && err.contains("campaign"), "{err}");
}
