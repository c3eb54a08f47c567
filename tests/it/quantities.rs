//! Cubes of other quantities than radiance: what their numbers are, and where they say so.

use std::f64::consts::PI;

use serde_json::Value;

use crate::cli::run;
use crate::scratch::Scratch;

/// A square of 10 m, reflectance 0.2, 330 K warm, under a Sun of 40 pi W m-2 um-1 at 60 deg from its zenith: 4 W m-2 sr-1 um-1 are reflected.
fn folder(origin: &str, light: &str) -> Scratch {
    let folder = Scratch::new();
    folder.write("square.obj", "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nf 1 2 3 4\n");
    folder.write("sun.csv", format!("wavelength_um,irradiance_w_m2_um\n0.3,{0}\n20,{0}\n", 40.0 * PI));
    folder.write(
        "scene.toml",
        format!(
            "mmxrt_scene = 1\norigin_m = {origin}\n[[mesh]]\nobj = \"square.obj\"\nmaterial = \"ground\"\n\
             [materials]\nground = {{ reflectance = 0.2, emissivity = 0.8 }}\n[thermal]\nmodel = \"thesis\"\n\
             [sun]\ndirection = [0.8660254037844386, 0, 0.5]\ndistance_au = 1\nspectrum = \"sun.csv\"\n\
             [observer]\nframe = \"site\"\nposition_m = [0, 0, 1000]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]\n\
             [sensor]\nsamples = 4\nlines = 3\nifov_mrad = 1.0\nbands = {light}\n"
        ),
    );
    folder
}

const BOTH: &str = "{ centres_um = [1.0, 10.0], fwhm_um = 0.5 }";
const ORIGIN: &str = "[0, 0, 11000]";

/// The pixel in the middle of an image of f64, [band, line, sample], and its header.
fn simulated(folder: &Scratch, quantity: &str) -> (Vec<f64>, String, Value) {
    let out = folder.argument("out");
    let (code, told, err) = run(&[
        "simulate",
        &folder.argument("scene.toml"),
        "-o",
        &out,
        "--dtype",
        "f64",
        "--exr",
        "--force",
        "--quantity",
        quantity,
    ]);
    assert_eq!(code, 0, "{told}{err}");
    let bytes = std::fs::read(folder.join("out/cube.img")).unwrap();
    let numbers: Vec<f64> = bytes.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let header = std::fs::read_to_string(folder.join("out/cube.hdr")).unwrap();
    let report = serde_json::from_slice(&std::fs::read(folder.join("out/report.json")).unwrap()).unwrap();
    (vec![numbers[5], numbers[12 + 5]], header, report)
}

#[test]
fn each_is_what_it_says() {
    let folder = folder(ORIGIN, BOTH);
    let (radiance, header, _) = simulated(&folder, "radiance");
    assert!(header.contains("W m-2 sr-1 um-1"));
    // Heat of 240 K (150 K + 180 K cos i), and reflected light, of which there is as much in both bands.
    let planck = |um: f64, t_k: f64| 1.191_042_972e8 / um.powi(5) / ((14_387.768_775 / (um * t_k)).exp() - 1.0);
    assert!((radiance[0] / 4.0 - 1.0).abs() < 1e-9, "{radiance:?}");
    assert!((radiance[1] / (4.0 + 0.8 * planck(10.0, 240.0)) - 1.0).abs() < 1e-3, "{radiance:?}");
    for (quantity, unit, of) in [
        ("band_radiance", "W m-2 sr-1", Box::new(|l: f64| 0.5 * l) as Box<dyn Fn(f64) -> f64>),
        // pi L / E_S; of the reflected light alone 0.2 cos 60 deg.
        ("radiance_factor", "1", Box::new(|l: f64| l / 40.0)),
        // 0.2, of the reflected light alone.
        ("reflectance_factor", "1", Box::new(|l: f64| l / 20.0)),
    ] {
        let (got, header, report) = simulated(&folder, quantity);
        for (got, radiance) in got.iter().zip(&radiance) {
            assert!((got / of(*radiance) - 1.0).abs() < 1e-9, "{quantity}: {got} {radiance}");
        }
        assert!(
            header.contains(&format!("data units = {{{unit}}}")) || header.contains(&format!("data units = {unit}")),
            "{header}"
        );
        assert_eq!(
            (report["image"]["quantity"].as_str(), report["image"]["unit"].as_str()),
            (Some(quantity), Some(unit))
        );
        assert!(report["statistics"][0]["name"].as_str().unwrap().starts_with(&format!("{quantity} at 1 um")));
        let exr = std::fs::read(folder.join("out/cube.exr")).unwrap();
        let written = if quantity == "band_radiance" { "W.m^-2.sr^-1" } else { unit };
        assert!(exr.windows(written.len()).any(|w| w == written.as_bytes()), "{quantity}");
        let (code, _, err) = run(&["inspect", &folder.argument("out"), "--pixel", "1,1"]);
        assert!(code == 1 && err.contains("shown of radiance"), "{err}");
    }
}

#[test]
fn brightness_temperatures_are_those_of_black_bodies_in_the_band() {
    // Heat alone, of 240 K, by a black surface.
    let folder = folder(ORIGIN, "{ centres_um = [8.0, 10.0], fwhm_um = 1.0, light = \"heat\" }");
    folder.edit("scene.toml", "reflectance = 0.2, emissivity = 0.8", "reflectance = 0.2, emissivity = 1.0");
    let (got, header, report) = simulated(&folder, "brightness_temperature");
    assert!(got.iter().all(|t_k| (t_k - 240.0).abs() < 1e-5), "{got:?}");
    assert!(header.contains('K') && report["image"]["unit"] == "K");
    // The sky is not warm.
    let sky = folder.argument("scene.toml");
    folder.edit("scene.toml", "ifov_mrad = 1.0", "ifov_mrad = 20.0");
    let (code, _, err) = run(&[
        "simulate",
        &sky,
        "-o",
        &folder.argument("out"),
        "--quantity",
        "brightness_temperature",
        "--split",
        "--force",
    ]);
    assert!(code == 1 && err.contains("temperatures of parts of the light do not add up"), "{err}");
    let (_, _, report) = simulated(&folder, "brightness_temperature");
    assert!(report["statistics"][0]["min"].as_f64().unwrap() > 0.0);
}

#[test]
fn what_a_scene_has_not() {
    for (origin, bands, quantity, told) in [
        (ORIGIN, "{ centres_um = [1.0, 2.0] }", "band_radiance", "sensor.bands[1]: at 2 um has no width"),
        ("[0, 0, -11000]", BOTH, "reflectance_factor", "quantity: the Sun is below level ground"),
    ] {
        let folder = folder(origin, bands);
        let scene = folder.argument("scene.toml");
        let (code, _, err) = run(&["simulate", &scene, "-o", &folder.argument("out"), "--quantity", quantity]);
        assert!(code == 1 && err.contains(told), "{quantity}: {err}");
        assert!(!folder.join("out").exists());
    }
}
