//! A simulation with several cameras: a scene file for each.

use std::path::Path;

use mmxrt::formats::scene_toml;
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;

use crate::cli::run;
use crate::dart_write::{options, tetrahedron, written};
use crate::scratch::Scratch;

fn scene_of(path: &Path) -> Scene {
    scene_toml::read(path, &unwatched).unwrap_or_else(|e| panic!("{e}")).scene
}

/// The simulation of the tetrahedron, which looks from 100 m East and 100 m up, with a second camera 40 m higher and a third one
/// with another image.
fn three(scratch: &Scratch) -> String {
    written(&tetrahedron(), &options(Default::default()), &scratch.join("sim"));
    let path = scratch.join("sim/input/phase.xml");
    let text = std::fs::read_to_string(&path).unwrap();
    let (start, end) = (text.find("<Pinhole").unwrap(), text.find("</Pinhole>").unwrap() + "</Pinhole>".len());
    let first = &text[start..end];
    let value = |name: &str| {
        let rest = &first[first.find(&format!("{name}=\"")).unwrap() + name.len() + 2..];
        rest[..rest.find('"').unwrap()].to_owned()
    };
    let up: f64 = value("sensorPosZ").parse().unwrap();
    let second =
        first.replace(&format!("sensorPosZ=\"{}\"", value("sensorPosZ")), &format!("sensorPosZ=\"{}\"", up + 40.0));
    let third = first.replace("nbPixelsX=\"300\"", "nbPixelsX=\"30\"").replace("nbPixelsY=\"200\"", "nbPixelsY=\"20\"");
    assert!(second != first && third != first);
    std::fs::write(&path, format!("{}{first}{second}{third}{}", &text[..start], &text[end..])).unwrap();
    scratch.argument("sim")
}

#[test]
fn each_camera_gets_a_scene_of_its_own() {
    let scratch = Scratch::new();
    let sim = three(&scratch);
    let (code, said, err) = run(&["convert", &sim, &scratch.argument("out/scene.toml")]);
    assert!(code == 0, "{said}{err}");
    assert!(
        said.contains("camera 2, is scene.camera_2.toml") && said.contains("camera 3, is scene.camera_3.toml"),
        "{said}"
    );
    assert!(!said.contains("not the first"), "{said}");
    let names = |end: &str| {
        let entries = scratch.join("out").read_dir().unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        entries.filter(|name| name.ends_with(end)).count()
    };
    // Three scenes of one mesh.
    assert_eq!([names(".toml"), names(".obj"), names(".mtl")], [3, 1, 1]);
    let [first, second, third] = ["scene.toml", "scene.camera_2.toml", "scene.camera_3.toml"]
        .map(|name| scene_of(&scratch.join("out").join(name)));
    for other in [&second, &third] {
        assert_eq!(first.body.mesh, other.body.mesh);
        assert_eq!(first.body.materials, other.body.materials);
        assert_eq!(first.exposure.bands, other.exposure.bands);
    }
    let [a, b, c] = [&first, &second, &third].map(|scene| &scene.exposure.camera);
    // Up is +y of the body.
    let step = b.centre_m() - a.centre_m();
    assert!((step - glam::DVec3::new(0.0, 40.0, 0.0)).length() < 1e-6, "{step}");
    assert_eq!(a.world_from_sensor.rotation, b.world_from_sensor.rotation);
    assert_eq!([a.samples, a.lines, c.samples, c.lines], [300, 200, 30, 20]);
    // The field of view is the same, on a tenth of the pixels.
    assert!((c.pitch[0] / a.pitch[0] - 10.0).abs() < 1e-9 && c.centre_m() == a.centre_m());
}

#[test]
fn what_has_no_place_for_cameras_says_so() {
    let scratch = Scratch::new();
    let sim = three(&scratch);
    let (code, said, err) = run(&["convert", &sim, &scratch.argument("mesh.obj")]);
    assert!(code == 0 && said.matches("this is not the first").count() == 2, "{said}{err}");
    let (_, said, err) = run(&["convert", "--strict", &sim, &scratch.argument("again")]);
    assert!(said.matches("this is not the first").count() == 2 && !scratch.join("again").exists(), "{said}{err}");
    let (code, said, err) = run(&["convert", &sim, &scratch.argument("one.toml")]);
    assert!(code == 0 && scratch.join("one.camera_2.toml").is_file(), "{said}{err}");
    // What is there is not replaced, be it the scene of another camera.
    let before = std::fs::read(scratch.join("one.camera_3.toml")).unwrap();
    for name in scratch.names().iter().filter(|name| name.starts_with("one.") && !name.contains("camera")) {
        std::fs::remove_file(scratch.join(name)).unwrap();
    }
    let (code, _, err) = run(&["convert", &sim, &scratch.argument("one.toml")]);
    assert!(code != 0 && err.contains("one.camera_2.toml"), "{err}");
    assert!(!scratch.join("one.toml").exists() && std::fs::read(scratch.join("one.camera_3.toml")).unwrap() == before);
}

/// Only what could be simulated becomes a scene file.
#[test]
fn a_camera_within_the_body_becomes_no_scene() {
    let scratch = Scratch::new();
    let sim = three(&scratch);
    let path = scratch.join("sim/input/phase.xml");
    let text = std::fs::read_to_string(&path).unwrap();
    // The third one goes 103 m West and 95 m down: into the tetrahedron.
    let moved = [("sensorPosY", -103.0), ("sensorPosZ", -95.0)].iter().fold(text, |text, (name, by_m)| {
        let at = text.rfind(&format!("{name}=\"")).unwrap() + name.len() + 2;
        let end = at + text[at..].find('"').unwrap();
        let value: f64 = text[at..end].parse().unwrap();
        format!("{}{}{}", &text[..at], value + by_m, &text[end..])
    });
    std::fs::write(&path, moved).unwrap();
    let (code, said, err) = run(&["convert", &sim, &scratch.argument("out/scene.toml")]);
    assert!(code == 0 && said.contains("Dropped") && said.contains("a camera:"), "{said}{err}");
    let is_there = ["scene.toml", "scene.camera_2.toml", "scene.camera_3.toml"]
        .map(|name| scratch.join("out").join(name).is_file());
    assert_eq!(is_there, [true, true, false], "{said}");
    let (code, _, _) = run(&["convert", "--strict", &sim, &scratch.argument("strict/scene.toml")]);
    assert_eq!(code, 3);
}
