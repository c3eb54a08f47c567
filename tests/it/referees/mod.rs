//! Other programs as referees: what they make of the same scene, from formulas that are not ours.
//!
//! They run where they are there (`MMXRT_TEST_PYTHON` names an interpreter that has Mitsuba, heat1d, spiceypy or oem), and say SKIPPED where they are not.

mod columns;
mod ephemerides;
mod kernels;
mod plans;
mod renders;

use std::path::Path;
use std::process::Command;

use mmxrt::scene::{Photometry, Scene};
use serde_json::json;

use crate::scratch::Scratch;

/// Whether Mitsuba is there, and LLVM (Debian: libllvm19), with which it compiles: older ones know no minimum and end the process.
const MITSUBA: &str = "import mitsuba as mi; mi.set_variant('llvm_ad_mono'); import drjit as dr; dr.eval(dr.minimum(mi.Float([1.0, 2.0]), 1.5))";
const HEAT1D: &str = "import importlib.util as u, sys; sys.exit(u.find_spec('heat1d') is None)";

/// An interpreter that runs this, if there is one.
fn python_with(needed: &str) -> Option<String> {
    let python = std::env::var("MMXRT_TEST_PYTHON").unwrap_or_else(|_| "python3".into());
    let there = Command::new(&python).args(["-c", needed]).output().is_ok_and(|output| output.status.success());
    if !there {
        println!("SKIPPED: {python} cannot: {needed}");
    }
    there.then_some(python)
}

/// Runs one of the scripts beside this file in a folder, and reads the numbers that it leaves there.
fn answer(python: &str, script: &str, scratch: &Scratch, numbers: &str) -> Vec<f64> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/referees").join(script);
    let made = Command::new(python).arg(script).arg(scratch.path()).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let bytes = std::fs::read(scratch.join(numbers)).unwrap();
    bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
}

/// How Mitsuba is to sample.
#[derive(Clone, Copy)]
struct Sampling {
    /// Surfaces on the longest way of light, and one: 2 is sunlight alone.
    max_depth: u32,
    rays: u32,
    /// Independent images, of which the spread is the noise.
    seeds: usize,
}

/// What Mitsuba sees of a scene in its first band, under some parallel lights: the mean of its images, and the standard error of that.
fn rendered(python: &str, scene: &Scene, lights: &[([f64; 3], f64)], sampling: Sampling) -> Vec<(f64, f64)> {
    let um = scene.exposure.bands[0].centre_um;
    let mesh = &scene.body.mesh;
    let camera = &scene.exposure.camera;
    let axes = camera.world_from_sensor.rotation;
    let surface = |photometry: &Photometry, reflectance: f64| match photometry {
        Photometry::Lambert => json!({ "lambert": reflectance }),
        Photometry::Model(model) => json!({ "hapke": renders::hapke_json(&model.shape, model.albedo.at(um).unwrap()) }),
        other => panic!("{other:?}"),
    };
    let materials = scene.body.materials.iter().enumerate().map(|(i, material)| {
        let facets = mesh.facets.iter().zip(&mesh.material).filter(|(_, of)| of.0 as usize == i);
        let mut of = surface(&material.photometry, material.reflectance.at(um).unwrap());
        of["facets"] = json!(facets.map(|(facet, _)| *facet).collect::<Vec<_>>());
        of
    });
    let text = json!({
        "materials": materials.collect::<Vec<_>>(),
        "vertices_m": mesh.vertices_m.iter().map(|v| v.to_array()).collect::<Vec<_>>(),
        "lights": lights,
        "camera": {
            "position_m": camera.centre_m().to_array(), "range_m": camera.centre_m().length(), "pitch": camera.pitch[0],
            "h": axes.x_axis.to_array(), "v": axes.y_axis.to_array(), "u": axes.z_axis.to_array(),
            "samples": camera.samples, "lines": camera.lines,
        },
        "max_depth": sampling.max_depth, "rays": sampling.rays, "seeds": sampling.seeds,
    });
    let scratch = Scratch::new();
    scratch.write("scene.json", text.to_string());
    let images = answer(python, "render.py", &scratch, "images.f64");
    let pixels = (camera.samples * camera.lines) as usize;
    assert_eq!(images.len(), sampling.seeds * pixels);
    let count = sampling.seeds as f64;
    (0..pixels)
        .map(|p| {
            let of = || images.iter().skip(p).step_by(pixels);
            let mean = of().sum::<f64>() / count;
            let variance = of().map(|l| (l - mean).powi(2)).sum::<f64>() / (count - 1.0);
            (mean, (variance / count).sqrt())
        })
        .collect()
}
