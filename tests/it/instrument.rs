//! What optics and a detector make of a scene: against integrals of Gaussians, and against what noise must be on average.

use mmxrt::formats::scene_toml;
use mmxrt::physics::mtf;
use mmxrt::progress::unwatched;
use mmxrt::spectral::{Band, Extend, Response, Spectrum};
use serde_json::Value;

use crate::cli::run;
use crate::scenes::replaced;
use crate::scratch::Scratch;

/// A plane 40 x 40 m, dark for x < 0.3 and bright beyond, below a camera 1 km above it, whose pixels are 1 m and whose columns go to the east.
const PLANE: &str = "mtllib plane.mtl\nv -20 -20 0\nv 0.3 -20 0\nv 20 -20 0\nv -20 20 0\nv 0.3 20 0\nv 20 20 0\n\
    usemtl dark\nf 1 2 5 4\nusemtl bright\nf 2 3 6 5\n";
const MTL: &str = "newmtl dark\nnewmtl bright\n";
const SCENE: &str = r#"mmxrt_scene = 1
origin_m = [0.0, 0.0, 1000.0]
[[mesh]]
file = "plane.obj"
[materials]
dark = { reflectance = 0.1 }
bright = { reflectance = 0.5 }
[sun]
direction = [0.0, 0.0, 1.0]
distance_au = 1.5
[thermal]
model = "off"
[observer]
position_m = [0.0, 0.0, 2000.0]
target_m = [0.0, 0.0, 1000.0]
up = [0.0, 1.0, 0.0]
[sensor]
samples = 16
lines = 12
focal_px = 1000.0
bands = { centres_um = [1.0, 2.0], fwhm_um = 0.01 }
"#;

fn scratch(sensor: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("plane.obj", PLANE);
    scratch.write("plane.mtl", MTL);
    scratch.write("scene.toml", format!("{SCENE}{sensor}"));
    scratch
}

/// A cube of f64, band by band.
fn simulate(scratch: &Scratch, output: &str, more: &[&str]) -> Vec<f64> {
    let output = scratch.argument(output);
    let scene = scratch.argument("scene.toml");
    let arguments = ["simulate", scene.as_str(), "-o", output.as_str(), "--dtype", "f64", "--model", "sunlight"];
    let (code, _, err) = run(&[&arguments[..], more].concat());
    assert_eq!(code, 0, "{err}");
    let bytes = std::fs::read(format!("{output}/cube.img")).unwrap();
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

fn report(scratch: &Scratch, product: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(scratch.join(&format!("{product}/report.json"))).unwrap()).unwrap()
}

#[test]
fn a_border_is_blurred_as_the_integral_of_a_gaussian_says() {
    let sigma_px = 0.45;
    let scratch = scratch(&format!("[sensor.optics]\ngaussian_px = {sigma_px}\n"));
    let ideal = simulate(&scratch, "ideal", &["--ideal"]);
    let cube = simulate(&scratch, "blurred", &[]);
    assert_eq!(cube.len(), 16 * 12 * 2);
    for (band, cube) in cube.chunks_exact(16 * 12).enumerate() {
        let ideal = &ideal[band * 16 * 12..];
        // Column 0 is dark, column 15 bright; the border is at 8.3.
        let (dark, bright) = (ideal[0], ideal[15]);
        assert!((bright / dark - 5.0).abs() < 1e-9);
        for (pixel, value) in cube.iter().enumerate() {
            let centre = (pixel % 16) as f64 + 0.5;
            let expected = dark + (bright - dark) * mtf::gaussian_edge_mean(centre - 8.3, sigma_px);
            // The border lies within a part of a pixel, which its mean stands for: a tenth of a part of it.
            assert!((value - expected).abs() < 2e-3 * bright, "{pixel}: {value} {expected}");
        }
    }
    // Light that leaves the image is as much as comes into it from around, where the ground goes on.
    let sum = |cube: &[f64]| cube[..16 * 12].iter().sum::<f64>();
    let moved: f64 = (0..16).map(|x| mtf::gaussian_edge_mean(f64::from(x) + 0.5 - 8.3, sigma_px)).sum::<f64>() - 7.7;
    assert!(moved.abs() < 1e-9);
    assert!((sum(&cube) / sum(&ideal) - 1.0).abs() < 1e-9, "{} {}", sum(&cube), sum(&ideal));
}

#[test]
fn scattered_light_is_the_mean_of_the_image() {
    let scratch = scratch("[sensor.optics]\nstray = 0.25\n");
    let ideal = simulate(&scratch, "ideal", &["--ideal"]);
    let cube = simulate(&scratch, "veiled", &[]);
    let mean = ideal[..192].iter().sum::<f64>() / 192.0;
    for (value, ideal) in cube[..192].iter().zip(&ideal) {
        assert!((value - (0.75 * ideal + 0.25 * mean)).abs() < 1e-12 * mean, "{value} {ideal}");
    }
}

/// Area under a Gaussian of height 1, over its full width at half maximum: sqrt(pi / (4 ln 2)).
const GAUSSIAN: f64 = 1.064_467_019_431_226_2;

/// F/4, 30 um, 0.3, 0.05 s: electrons as worked out by hand for 1 um.
pub(crate) const DETECTOR: &str = "f_number = 4.0\npixel_um = 30.0\nexposure_s = 0.05\n[sensor.detector]\nthroughput = 0.3\nread_e = 100\ndark_e_s = 1e4\ngain_e_dn = 50\noffset_dn = 300\n";

#[test]
fn a_detector_counts_what_it_should_and_as_noisily() {
    let scratch = scratch(DETECTOR);
    let ideal = simulate(&scratch, "ideal", &["--ideal"]);
    let cube = simulate(&scratch, "read", &[]);
    // pi (30e-6)^2 / 65 m2 sr x 0.01 um x 0.3 x 0.05 s / (h c / 1 um).
    let per_radiance = std::f64::consts::PI * 9e-10 / 65.0 * (0.01 * GAUSSIAN) * 0.3 * 0.05 * 1e-6
        / (6.626_070_15e-34 * 299_792_458.0);
    let mut squares = 0.0;
    for (value, ideal) in cube[..192].iter().zip(&ideal[..192]) {
        let signal_e = ideal * per_radiance;
        let noise_e = (signal_e + 500.0 + 1e4 + 2500.0 / 12.0).sqrt();
        let off = (value - ideal) * per_radiance / noise_e;
        assert!(off.abs() < 4.5, "{off} sigma");
        squares += off * off;
    }
    // 192 squares of normal numbers: 192 +- sqrt(384).
    assert!((squares - 192.0).abs() < 4.0 * 384.0_f64.sqrt(), "{squares}");
    // The numbers that are sent are the radiance, and nothing else.
    let bytes = std::fs::read(scratch.join("read/dn.img")).unwrap();
    let sent: Vec<f64> = bytes.chunks_exact(2).map(|b| f64::from(u16::from_le_bytes(b.try_into().unwrap()))).collect();
    assert_eq!(sent.len(), cube.len());
    for (sent, value) in sent.iter().zip(&cube[..192]) {
        let expected = ((sent - 300.0) * 50.0 - 500.0) / per_radiance;
        assert!((value - expected).abs() < 1e-9 * expected, "{value} {expected}");
    }
    // What is told of signal and noise.
    let report = report(&scratch, "read");
    let band = &report["signal"]["bands"][0];
    let number = |key: &str| band[key].as_f64().unwrap();
    let mean = ideal[..192].iter().sum::<f64>() / 192.0;
    assert!((number("mean") / mean - 1.0).abs() < 1e-9);
    assert!((number("highest") / number("lowest") - 5.0).abs() < 1e-9);
    let signal_e = mean * per_radiance;
    assert!((number("snr_mean") / (signal_e / (signal_e + 1.05e4 + 2500.0 / 12.0).sqrt()) - 1.0).abs() < 1e-9);
    assert_eq!((band["pixels"].as_u64(), band["saturated"].as_u64()), (Some(192), Some(0)));
    let instrument = report["effects"].as_array().unwrap().iter().find(|e| e["key"] == "instrument").unwrap();
    assert_eq!(instrument["decision"], "kept");
}

#[test]
fn noise_is_the_same_bytes_at_any_thread_count_and_another_with_another_seed() {
    let scratch = scratch(&format!(
        "{DETECTOR}dead_fraction = 0.1\nprnu = 0.01\n[sensor.optics]\ngaussian_px = 0.3\njitter_px = 0.1\n"
    ));
    let one = simulate(&scratch, "one", &["--threads", "1"]);
    let two = simulate(&scratch, "two", &["--threads", "2"]);
    assert_eq!(one, two);
    // A tenth of 192 elements, in the same places in both bands.
    let dead = |band: usize| (0..192).filter(|i| one[band * 192 + i] == 0.0).collect::<Vec<_>>();
    assert_eq!(dead(0), dead(1));
    assert!((8..=32).contains(&dead(0).len()), "{}", dead(0).len());
    assert_eq!(report(&scratch, "one")["signal"]["dead_elements"].as_u64(), Some(dead(0).len() as u64));
    scratch.edit("scene.toml", "dead_fraction = 0.1", "dead_fraction = 0.1\nseed = 7");
    assert_ne!(simulate(&scratch, "other", &[]), one);
}

#[test]
fn presets_have_optics_and_a_detector_unless_ideal() {
    let own = "samples = 16\nlines = 12\nfocal_px = 1000.0\nbands = { centres_um = [1.0, 2.0], fwhm_um = 0.01 }";
    let read = |sensor: &str| {
        let scratch = scratch("");
        scratch.write("scene.toml", replaced(SCENE, &[(own, sensor)]));
        scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap()
    };
    for preset in ["preset = \"macromega\"", "preset = \"mirs\"\nlines = 4\nexposure_s = 1.0"] {
        let chain = read(preset).chain.unwrap();
        // A perfect lens at 3 um, f/4 and 30 um passes 0.75 at Nyquist, the pixel 0.64: what is published for MIRS is more than 0.08.
        let optics = chain.optics.unwrap();
        let passes = optics.transfer([0.5, 0.0], 3.0).re * mtf::mean(0.5, 1.0);
        assert!(passes > 0.08 && passes < 0.5, "{passes}");
        assert!(chain.detector.is_some());
        assert!(read(&format!("{preset}\nideal = true")).chain.is_none());
    }
    // Published: signal over noise of at least 100 from 2.7 to 3.2 um in 2 s, at 1.5 au and an incidence of 30 deg: Lambert ground of 0.07 in sunlight.
    let file = read("preset = \"mirs\"\nlines = 4\nexposure_s = 2.0");
    let detector = file.chain.unwrap().detector.unwrap();
    for band in file.scene.exposure.bands.iter().filter(|b| (2.7..=3.2).contains(&b.centre_um)) {
        let irradiance = mmxrt::spectral::solar_e490().at(band.centre_um).unwrap() / 2.25;
        let radiance = 0.07 / std::f64::consts::PI * irradiance * 0.75_f64.sqrt();
        assert!(detector.counting(band).unwrap().snr(radiance) > 100.0, "{}", band.centre_um);
    }
}

#[test]
fn what_is_wrong_is_said_where_it_is() {
    for (sensor, item, words) in [
        ("[sensor.detector]\nthroughput = 0.3\ngain_e_dn = 5\n", "sensor.detector", "f_number"),
        (
            "f_number = 4\npixel_um = 30\n[sensor.detector]\nthroughput = 0.3\ngain_e_dn = 5\n",
            "sensor.detector",
            "exposure_s",
        ),
        (
            "f_number = 4\npixel_um = 30\nexposure_s = 1\n[sensor.detector]\ngain_e_dn = 5\n",
            "sensor.detector",
            "throughput",
        ),
        (
            "f_number = 4\npixel_um = 30\nexposure_s = 1\n[sensor.detector]\nthroughput = 30\ngain_e_dn = 5\n",
            "sensor.detector.throughput",
            "0.3",
        ),
        ("[sensor.optics]\ngaussian_px = 0.2\ngaussian_mtf_nyquist = 0.5\n", "gaussian_mtf_nyquist", "one of them"),
        ("[sensor.optics]\ngaussian_px = -1\n", "sensor.optics.gaussian_px", "-1"),
        ("[sensor.optics]\nstray = 1.0\n", "sensor.optics.stray", "1"),
        ("[sensor.optics]\ndiffraction = true\n", "sensor.optics.diffraction", "f_number"),
        ("[sensor.optics]\nsmear_px = [30.0, 0.0]\n", "sensor.optics.smear_px", "16"),
        ("[sensor.optics]\npoint_spread = { file = \"none.png\", step_px = 0.5 }\n", "point_spread", "none.png"),
        ("[sensor.optics]\nsubpixel = 3\n", "subpixel", "subpixels"),
    ] {
        let scratch = scratch(sensor);
        let (code, _, err) = run(&["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument("out")]);
        assert!(code != 0 && err.contains(item) && err.contains(words), "{sensor}: {err}");
        assert!(!scratch.join("out").exists());
    }
    // Bands without a width have no electrons; parts of what is read have no light of their own.
    let scratch = scratch(DETECTOR);
    scratch.edit("scene.toml", ", fwhm_um = 0.01", "");
    let (code, _, err) = run(&["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument("out")]);
    assert!(code != 0 && err.contains("width_um"), "{err}");
    scratch.edit("scene.toml", "gain_e_dn = 50", "gain_e_dn = 50\nwidth_um = 0.02");
    let out = scratch.argument("out");
    let (code, _, err) = run(&["simulate", &scratch.argument("scene.toml"), "-o", &out, "--split"]);
    assert!(code != 0 && err.contains("--ideal"), "{err}");
    let (code, _, err) = run(&["simulate", &scratch.argument("scene.toml"), "-o", &out, "--split", "--ideal"]);
    assert_eq!(code, 0, "{err}");
}

/// What passes an instrument is a table: electrons go by it, and bands that it does not cover have none that are known.
#[test]
fn throughput_covers_the_bands_it_is_asked_for() {
    let scratch = scratch(&DETECTOR.replace("0.3", "\"throughput.csv\""));
    let simulated = |table: &str| {
        scratch.write("throughput.csv", table);
        let (code, _, err) =
            run(&["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument("out"), "--force"]);
        (code, err, scratch.join("out").exists().then(|| report(&scratch, "out")))
    };
    let (code, err, known) = simulated("wavelength_um,throughput\n0.9,0.2\n4.0,0.2\n");
    assert_eq!(code, 0, "{err}");
    let (_, _, half) = simulated("wavelength_nm,throughput_percent\n900,10\n4000,10\n");
    let electrons = |report: &serde_json::Value| report["signal"]["bands"][0]["signal_e"].as_f64().unwrap();
    let (known, half) = (electrons(&known.unwrap()), electrons(&half.unwrap()));
    assert!(known > 0.0 && (known / half - 2.0).abs() < 1e-12, "{known} {half}");
    // From beyond the first band on.
    let (code, err, _) = simulated("wavelength_um,throughput\n1.5,0.2\n4.0,0.2\n");
    assert!(code != 0 && err.contains("sensor.detector.throughput") && err.contains("band 1"), "{err}");
    let (code, err, _) = simulated("wavelength_um,reflectance\n0.9,0.2\n4.0,0.2\n");
    assert!(code != 0 && err.contains("a column `throughput`"), "{err}");
    // A cube is asked the same.
    let ideal = self::scratch("");
    simulate(&ideal, "ideal", &[]);
    let (cube, file, out) =
        (ideal.argument("ideal/cube.img"), ideal.argument("instrument.toml"), ideal.argument("out"));
    let detector = DETECTOR.replace("[sensor.", "[").replace("0.3", "\"throughput.csv\"");
    ideal.write("instrument.toml", format!("mmxrt_instrument = 1\n{detector}"));
    ideal.write("throughput.csv", "wavelength_um,throughput\n1.5,0.2\n4.0,0.2\n");
    let (code, _, err) = run(&["instrument", &cube, "--instrument", &file, "-o", &out]);
    assert!(code != 0 && err.contains("throughput") && !ideal.join("out").exists(), "{err}");
}

/// The same response as a shape and as a table counts the same electrons.
#[test]
fn electrons_go_by_the_area_of_a_response() {
    let scratch = scratch(DETECTOR);
    let file = scene_toml::read(&scratch.join("scene.toml"), &unwatched).unwrap();
    let detector = file.chain.unwrap().detector.unwrap();
    let um: Vec<f64> = (0..=4000).map(|i| 1.8 + 1e-4 * f64::from(i)).collect();
    let null_um = 0.02 / 0.885_892_941_378_904_7;
    let gaussian = |l: f64| (-4.0 * std::f64::consts::LN_2 * ((l - 2.0) / 0.02).powi(2)).exp();
    let sinc2 = |l: f64| match std::f64::consts::PI * (l - 2.0) / null_um {
        0.0 => 1.0,
        x => (x.sin() / x).powi(2),
    };
    let shapes: [(Response, &dyn Fn(f64) -> f64, f64); 2] =
        [(Response::Gaussian, &gaussian, 1e-6), (Response::Sinc2, &sinc2, 6e-3)];
    for (response, curve, within) in shapes {
        let values = um.iter().map(|l| curve(*l)).collect();
        let table = Band::tabulated(&Spectrum::new(um.clone(), values, Extend::Error).unwrap()).unwrap();
        let shape = Band { response, ..Band::new(2.0, Some(0.02)) };
        let [of_shape, of_table] = [shape, table].map(|band| detector.counting(&band).unwrap().electrons_per_radiance);
        // What of a squared sinc is beyond the table is the difference.
        assert!((of_shape / of_table - 1.0).abs() < within, "{of_shape} {of_table}");
    }
}

/// What is too bright is no radiance, and said not to be; numbers are calibrated by what the report says.
#[test]
fn saturated_values_are_told_and_have_no_signal() {
    let scratch = scratch(DETECTOR);
    let cube = simulate(&scratch, "read", &[]);
    let radiance = simulate(&scratch, "ideal", &["--ideal"]);
    let of_band = |name: &str| report(&scratch, name)["signal"]["bands"][0].clone();
    let number = |band: &Value, key: &str| band[key].as_f64().unwrap_or_else(|| panic!("{key}: {band}"));
    let band = of_band("read");
    let bytes = std::fs::read(scratch.join("read/dn.img")).unwrap();
    let sent = bytes.chunks_exact(2).map(|b| f64::from(u16::from_le_bytes(b.try_into().unwrap())));
    for (dn, value) in sent.zip(&cube[..192]) {
        let by_report = number(&band, "radiance_per_dn") * (dn - number(&band, "zero_dn"));
        assert!((by_report - value).abs() <= 1e-7 * value.abs().max(1e-3), "{by_report} {value}");
    }
    assert!(!report(&scratch, "read")["warnings"].to_string().contains("saturated"));
    // A well that the bright half overflows, and the dark half does not.
    let full_e = 2.0 * number(&band, "signal_e");
    let [dark, bright] = [radiance[0], radiance[191]];
    assert!(bright > 4.0 * dark);
    scratch.edit("scene.toml", "read_e = 100", &format!("read_e = 100\nfull_well_e = {:.0}", 0.5 * full_e));
    let (code, _, err) = run(&["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument("full")]);
    assert!(code == 0 && err.contains("saturated"), "{err}");
    let told = report(&scratch, "full")["warnings"].to_string();
    assert!(told.contains("1 of 2 bands") || told.contains("2 of 2 bands"), "{told}");
    let bytes = std::fs::read(scratch.join("full/snr.img")).unwrap();
    let snr: Vec<f32> = bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    assert!(snr[192] > 10.0 && snr[192 + 191] == 0.0, "{} {}", snr[192], snr[192 + 191]);
    // Numbers that begin beyond the last one.
    scratch.edit("scene.toml", "offset_dn = 300", "offset_dn = 65535");
    let (code, _, err) = run(&["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument("none")]);
    assert!(code != 0 && err.contains("offset_dn") && !scratch.join("none").exists(), "{err}");
}

/// The sensitivities of elements, which calibration does not know, are noise of an image: measured over even ground, and reported.
#[test]
fn reported_noise_is_what_an_even_image_shows() {
    let scratch = scratch(&DETECTOR.replace("read_e = 100", "read_e = 100\nprnu = 0.02"));
    scratch.edit("plane.obj", "v 0.3 -20 0", "v -19 -20 0");
    scratch.edit("plane.obj", "v 0.3 20 0", "v -19 20 0");
    let cube = simulate(&scratch, "read", &[]);
    for band in 0..2 {
        let values = &cube[192 * band..192 * (band + 1)];
        let mean = values.iter().sum::<f64>() / 192.0;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 191.0;
        let told = report(&scratch, "read")["signal"]["bands"][band]["snr_mean"].as_f64().unwrap();
        // Of 192 values a standard deviation is known to 5 %.
        assert!((mean / variance.sqrt() / told - 1.0).abs() < 0.2, "{} {told}", mean / variance.sqrt());
        assert!(told < 50.0, "{told}");
    }
}

#[test]
fn a_cube_is_read_as_its_scene_would_be() {
    let scratch = scratch("");
    let ideal = simulate(&scratch, "ideal", &[]);
    let (cube, file, out) =
        (scratch.argument("ideal/cube.img"), scratch.argument("instrument.toml"), scratch.argument("out"));
    scratch.write("instrument.toml", format!("mmxrt_instrument = 1\n{}", DETECTOR.replace("[sensor.", "[")));
    let read = |more: &[&str]| {
        run(&[&["instrument", cube.as_str(), "--instrument", file.as_str(), "-o", out.as_str()], more].concat())
    };
    let (code, _, err) = read(&[]);
    assert_eq!(code, 0, "{err}");
    // The same detector in the scene sends the same numbers: noise belongs to places.
    let in_scene = self::scratch(DETECTOR);
    simulate(&in_scene, "out", &[]);
    let sent = |scratch: &Scratch| std::fs::read(scratch.join("out/dn.img")).unwrap();
    assert_eq!(sent(&scratch), sent(&in_scene));
    let (code, said, err) = run(&["inspect", &out]);
    assert!(code == 0 && said.contains("snr_mean"), "{said}{err}");
    // Optics blur means of pixels if that is said to be good enough.
    scratch.write("instrument.toml", "mmxrt_instrument = 1\n[optics]\ngaussian_px = 0.45\n");
    let (code, _, err) = read(&["--force"]);
    assert!(code != 0 && err.contains("--approximate"), "{err}");
    let (code, _, err) = read(&["--force", "--approximate"]);
    assert!(code == 0 && err.contains("approximation"), "{err}");
    let bytes = std::fs::read(scratch.join("out/cube.img")).unwrap();
    let blurred: Vec<f64> =
        bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect();
    assert!(!scratch.join("out/dn.img").exists());
    let sum = |cube: &[f64]| cube[..192].iter().sum::<f64>();
    assert!((sum(&blurred) / sum(&ideal) - 1.0).abs() < 1e-6);
    // What has no wavelengths, is no radiance, or says nothing.
    for (text, words) in [
        ("mmxrt_instrument = 1\n", "optics"),
        ("mmxrt_instrument = 1\npreset = \"mirs\"\n", "exposure_s"),
        ("mmxrt_instrument = 2\n", "mmxrt_instrument"),
        ("mmxrt_instrument = 1\n[detector]\nthroughput = 0.5\n", "f_number"),
    ] {
        scratch.write("instrument.toml", text);
        let (code, _, err) = read(&["--force", "--approximate"]);
        assert!(code != 0 && err.contains(words), "{text}: {err}");
    }
    scratch.write("instrument.toml", "mmxrt_instrument = 1\npreset = \"macromega\"\n");
    let planes = scratch.argument("ideal/backplanes.img");
    let (code, _, err) = run(&["instrument", &planes, "--instrument", &file, "-o", &out, "--force", "--approximate"]);
    assert!(code != 0 && err.contains("wavelength"), "{err}");
}

/// A push-broom without motion along its way takes the same line again and again; through optics, and without, what it takes is the frame's.
#[test]
fn a_push_broom_sees_through_optics_what_a_frame_does() {
    let scene = |sensor: &str| {
        let text = replaced(
            crate::flight_scene::FLYING,
            &[("samples = 8\nlines = 8\nifov_mrad = 1.0\nbands = { centres_um = [1.0, 2.0, 3.0] }", sensor)],
        );
        let scratch = Scratch::new();
        scratch.write("scene.toml", text);
        scratch
    };
    let optics = "[sensor.optics]\ngaussian_px = 0.6\n";
    let sensor = "samples = 9\nlines = 1\nifov_mrad = 4.0\nbands = { centres_um = [1.0, 2.0] }\n";
    let frame = scene(&format!("{sensor}exposure_s = 1.0\n{optics}"));
    let broom = scene(&format!("{sensor}kind = \"push_broom\"\nperiod_s = 1.0\n{optics}"));
    let (frame, broom) = (simulate(&frame, "out", &[]), simulate(&broom, "out", &[]));
    assert_eq!(frame.len(), 18);
    for (a, b) in frame.iter().zip(&broom) {
        assert!((a - b).abs() <= 1e-9 * a.abs(), "{a} {b}");
    }
}
