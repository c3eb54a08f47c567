//! The recipe for Mitsuba in `adapters/renderers/README.md`, run as it stands where Mitsuba is there.

use std::path::Path;
use std::process::Command;

use crate::cli::run;
use crate::scratch::Scratch;

/// The first block of Python in the recipes.
fn recipe() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("adapters/renderers/README.md");
    let text = std::fs::read_to_string(path).unwrap();
    let (_, rest) = text.split_once("```python\n").unwrap();
    rest.split_once("```").unwrap().0.to_owned()
}

const SCENE: &str = "mmxrt_scene = 1\norigin_m = [0, 0, 11000]\n[[mesh]]\nobj = \"site.obj\"\n[materials.default]\nreflectance = 0.3\n\
    [sun]\ndirection = [0.6, 0, 0.8]\ndistance_au = 1.0\n[thermal]\nmodel = \"off\"\n\
    [observer]\nposition_m = [-20, -30, 11070]\ntarget_m = [0, 0, 11000]\nup = [0, 0, 1]\n\
    [sensor]\nsamples = 24\nlines = 16\nfov_deg = 14\nbands = { centres_um = [1.0] }\n";

#[test]
#[allow(clippy::print_stdout, reason = "that it was skipped is to be seen, and counted")]
fn mitsubas_image_becomes_ours() {
    // Another interpreter than the first on the path: MMXRT_TEST_PYTHON.
    let python = std::env::var("MMXRT_TEST_PYTHON").unwrap_or_else(|_| "python3".into());
    let there = Command::new(&python).args(["-c", "import mitsuba"]).output().is_ok_and(|o| o.status.success());
    if !there {
        println!("SKIPPED: {python} has no mitsuba");
        return;
    }
    let scratch = Scratch::new();
    // One tilted facet pair: nothing shadows or lights itself, so that the renderer's answer is the closed form.
    scratch.write("site.obj", "v -4 -3 0\nv 4 -3 1\nv 4 3 1\nv -4 3 0\nf 1 2 3 4\n");
    scratch.write("scene.toml", SCENE);
    scratch.write("recipe.py", recipe());
    let made = Command::new(&python).arg("recipe.py").current_dir(scratch.join("")).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let irradiance = mmxrt::spectral::solar_e490().at(1.0).unwrap();
    let image = format!("{}*{}", scratch.argument("image.exr"), irradiance / 1000.0);
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let options = ["--dtype", "f64", "--quiet", "--unknown", "nan"];
    let (code, _, err) = run(&[&["integrate", &scene, "--radiance", &image, "-o", &out][..], &options].concat());
    assert_eq!(code, 0, "{err}");
    let own = scratch.argument("own");
    let (code, _, err) = run(&["simulate", &scene, "-o", &own, "--dtype", "f64", "--quiet"]);
    assert_eq!(code, 0, "{err}");
    let read = |name: &str| -> Vec<f64> {
        let bytes = std::fs::read(scratch.join(name)).unwrap();
        bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect()
    };
    let (theirs, ours) = (read("out/cube.img"), read("own/cube.img"));
    // The facet's normal is (-1, 0, 8) / sqrt 65: 0.3 / pi E (0.8 x 8 - 0.6) / sqrt 65.
    let lambert = 0.3 / std::f64::consts::PI * irradiance * (6.4 - 0.6) / 65f64.sqrt();
    let largest = ours.iter().copied().fold(0.0, f64::max);
    assert!((largest / lambert - 1.0).abs() < 1e-12, "{largest} {lambert}");
    let whole: Vec<usize> = (0..ours.len()).filter(|i| ours[*i] > 0.999_999 * lambert).collect();
    assert!(whole.len() > 40, "{}", whole.len());
    // Away from the rim there is no noise in it: a lit plane has one radiance. Single precision, and its own rounding.
    let inner = whole.iter().filter(|i| (theirs[**i] / lambert - 1.0).abs() < 1e-5).count();
    assert!(inner * 10 >= whole.len() * 8, "{inner} of {}", whole.len());
    // At the rim, 256 samples in a texel: all together it is the same light.
    let [a, b] = [&theirs, &ours].map(|image| image.iter().filter(|l| !l.is_nan()).sum::<f64>());
    assert!((a / b - 1.0).abs() < 5e-3, "{a} {b}");
}
