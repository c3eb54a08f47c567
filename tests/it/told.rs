//! What is said of a result that is not wrong, but not what somebody may think.

use crate::cli::run;
use crate::scenes::SITE;
use crate::scratch::Scratch;

/// The site with Mars straight above, so many metres from the body's centre.
fn with_mars_at(y_m: &str) -> String {
    SITE.replace("[9.4e6, 12000.0, 0.0]", &format!("[0.0, {y_m}, 0.0]"))
}

fn warned(mars_m: &str, target_m: &str) -> String {
    let scratch = Scratch::new();
    let text = with_mars_at(mars_m).replace("target_m = [0.0, 12000.0", &format!("target_m = [0.0, {target_m}"));
    let scene = scratch.write("s.toml", text);
    let (code, _, err) = run(&["simulate", scene.to_str().unwrap(), "-o", &scratch.argument("p")]);
    assert_eq!(code, 0, "{err}");
    err
}

#[test]
fn mars_in_view_is_told() {
    // Away from the site, towards a Mars that fills the field of view: 256 pixels.
    let err = warned("9.4e6", "1e6");
    assert!(err.contains("Mars is in view and is not drawn: 256 pixels of it are black"), "{err}");
    // Beside the boresight, which is at the left edge of the image: Mars is 50 deg to the right, and 42 deg across.
    let scratch = Scratch::new();
    let (sin, cos) = 50f64.to_radians().sin_cos();
    let observer = format!("u = [{}, {cos}, 0]\nh = [{cos}, {sin}, 0]\nv = [0, 0, -1]\n", -sin);
    let text = with_mars_at("9.376e6");
    let (from, to) = (text.find("target_m").unwrap(), text.find("[sensor]").unwrap());
    let text = format!("{}{observer}{}", &text[..from], &text[to..]);
    for (boresight, is_seen) in [("0.0", true), ("200.0", false)] {
        let lens = format!("samples = 200\nlines = 100\nfocal_px = 100\nboresight_px = [{boresight}, 50.0]\n");
        let from = text.find("samples").unwrap();
        let end = text.find("bands").unwrap();
        let scene = scratch.write("s.toml", format!("{}{lens}{}", &text[..from], &text[end..]));
        let (code, _, err) = run(&["simulate", scene.to_str().unwrap(), "-o", &scratch.argument("p"), "--force"]);
        assert!(code == 0 && err.contains("Mars is in view") == is_seen, "{err}");
    }
    // Behind the camera.
    let err = warned("9.4e6", "12000.0");
    assert!(!err.contains("Mars is in view"), "{err}");
}

#[test]
fn more_than_all_the_light_is_told() {
    let scratch = Scratch::new();
    for (emissivity, is_told) in [("0.9", false), ("0.95", true)] {
        let scene = scratch.write("s.toml", SITE.replace("0.1 }", &format!("0.1, emissivity = {emissivity} }}")));
        let (code, out, err) = run(&["inspect", scene.to_str().unwrap()]);
        assert_eq!(code, 0, "{err}");
        assert_eq!(out.contains("reflectance and emissivity add up to 1.050"), is_told, "{out}");
    }
}

#[test]
fn defaults_take_one_line_and_all_are_said_on_request() {
    let scratch = Scratch::new();
    let scene = scratch.write("s.toml", SITE);
    let table = scratch.argument("t.npz");
    let lines = |more: &[&str]| {
        let arguments = [&["solve", scene.to_str().unwrap(), "-o", &table, "--force"], more].concat();
        let (code, _, err) = run(&arguments);
        assert_eq!(code, 0, "{err}");
        err.lines().filter(|line| line.starts_with("default")).count()
    };
    // Two materials and Mars: five values.
    assert_eq!((lines(&[]), lines(&["--verbose"]), lines(&["--quiet"])), (1, 5, 0));
}

#[test]
fn a_landscape_in_another_format_is_refused() {
    let scratch = Scratch::new();
    let recipe = scratch.write("r.toml", "version = 1\nseed = 7\nfacets = 1000\n");
    for name in ["x.stl", "x.ply"] {
        let (code, _, err) = run(&["landscape", recipe.to_str().unwrap(), "-o", &scratch.argument(name)]);
        assert!(code == 1 && err.contains("is written as OBJ"), "{err}");
    }
    assert_eq!(run(&["-q", "landscape", recipe.to_str().unwrap(), "-o", &scratch.argument("site.v2")]).0, 0);
    assert_eq!(scratch.names(), ["r.toml", "site.v2"]);
    let (code, _, err) = run(&["inspect", &scratch.argument("nope")]);
    assert!(code == 1 && err.contains("nope: there is no such file or folder"), "{err}");
}
