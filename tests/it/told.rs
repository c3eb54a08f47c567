//! What is said of a result that is not wrong, but not what somebody may think.

use crate::cli::run;
use crate::scenes::SITE;
use crate::scratch::Scratch;

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
