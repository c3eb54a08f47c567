//! What is unusual and defined is computed, with a warning: its values are those of closed forms.

use std::f64::consts::PI;

use mmxrt::formats::scene_toml;
use mmxrt::progress::unwatched;
use mmxrt::study;

use crate::scenes::replaced;
use crate::scratch::Scratch;

/// A square of 2 m from 10 m above, under a Sun in the zenith at 1 au that sends 1000 W m-2 um-1 at all wavelengths.
const SCENE: &str = "mmxrt_scene = 1\norigin_m = [0, 0, 0]\n[[mesh]]\nobj = \"m.obj\"\n[materials]\ng = { reflectance = 0.1 }\n\
    [sun]\ndirection = [0, 0, 1]\ndistance_au = 1.0\nspectrum = \"sun.csv\"\n[thermal]\nmodel = \"off\"\n\
    [observer]\nposition_m = [0, 0, 10]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]\n\
    [sensor]\nsamples = 1\nlines = 1\nfov_deg = 1\nbands = { centres_um = [1.0] }\n";
const FLAT_SUN: &str = "wavelength_um,irradiance_w_m2_um\n0.01,1000\n5000,1000\n";

/// The radiance of the one pixel in each band, W m-2 sr-1 um-1, and what is said beside it.
fn seen(edits: &[(&str, &str)], files: &[(&str, &str)]) -> (Vec<f64>, String) {
    let scratch = Scratch::new();
    scratch.write("m.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl g\nf 1 2 3 4\n");
    scratch.write("sun.csv", FLAT_SUN);
    files.iter().for_each(|(name, text)| _ = scratch.write(name, text));
    let file = scene_toml::read(&scratch.write("s.toml", replaced(SCENE, edits)), &unwatched)
        .unwrap_or_else(|e| panic!("{edits:?}: {e}"));
    let (_, observation) = study::simulate(&file.scene, &unwatched).unwrap();
    let cube = observation.cube.to_array();
    (cube.iter().copied().collect(), file.notes.join("\n"))
}

fn is_near(found: f64, expected: f64, within: f64) -> bool {
    (found / expected - 1.0).abs() < within
}

/// Planck's law, W m-2 sr-1 um-1, by the constants of CODATA 2018.
fn planck(um: f64, t_k: f64) -> f64 {
    let m = um * 1e-6;
    2.0 * 6.626_070_15e-34 * 299_792_458.0_f64.powi(2)
        / m.powi(5)
        / (6.626_070_15e-34 * 299_792_458.0 / (m * 1.380_649e-23 * t_k)).exp_m1()
        * 1e-6
}

#[test]
fn what_noise_leaves_beyond_0_and_1_is_0_or_1() {
    // L = reflectance E / pi.
    let white = 1000.0 / PI;
    let table = |text: &'static str| seen(&[("reflectance = 0.1", "reflectance = \"r.csv\"")], &[("r.csv", text)]);
    let (found, said) = table("wavelength_um,reflectance\n0.5,1.003\n2,1.003\n");
    assert!(is_near(found[0], white, 1e-12) && said.contains("2 values are outside 0 to 1 by up to 0.003"), "{said}");
    let (found, said) = table("wavelength_um,reflectance_percent\n0.5,-0.2\n1.5,100.2\n");
    // In the middle between 0 and 1.
    assert!(is_near(found[0], 0.5 * white, 1e-12) && said.contains("taken as 0 or 1"), "{found:?} {said}");
    let (found, said) = seen(&[("reflectance = 0.1", "reflectance = 1.0001")], &[]);
    assert!(is_near(found[0], white, 1e-12) && said.contains("1.0001 is outside 0 to 1: taken as 1"), "{said}");
    let sun = "wavelength_um,irradiance_w_m2_um\n0.5,-2\n0.75,0\n1,1000\n2,1000\n";
    let (found, said) = seen(&[], &[("sun.csv", sun)]);
    assert!(is_near(found[0], 0.1 * white, 1e-12) && said.contains("1 value is below 0 by up to 2"), "{said}");
}

#[test]
fn rows_that_are_there_twice_count_once() {
    let rows = "wavelength_um,reflectance\n0.5,0.2\n0.5,0.2\n1.5,0.4\n";
    let (found, said) = seen(&[("reflectance = 0.1", "reflectance = \"r.csv\"")], &[("r.csv", rows)]);
    assert!(is_near(found[0], 0.3 * 1000.0 / PI, 1e-12) && said.contains("1 rows appear twice"), "{found:?} {said}");
}

#[test]
fn tables_and_bands_far_from_the_visible_are_computed() {
    let with = |um: &str, more: &str| format!("centres_um = [{um}]{more}");
    // Far infrared and extreme ultraviolet: the unit is doubted, and taken as it stands.
    for (rows, um, doubt) in [
        ("wavelength_um,reflectance\n150,0.2\n400,0.2\n", "200", "look like nanometres"),
        ("wavelength_nm,reflectance\n30,0.2\n90,0.2\n", "0.05", "look like micrometres"),
    ] {
        let edits = [
            ("reflectance = 0.1", "reflectance = \"r.csv\", bond_albedo = 0.2"),
            ("centres_um = [1.0]", &with(um, "")),
        ];
        let (found, said) = seen(&edits, &[("r.csv", rows)]);
        assert!(is_near(found[0], 0.2 * 1000.0 / PI, 1e-12) && said.contains(doubt), "{found:?} {said}");
    }
    // Heat at 1.5 mm; (1 - 0.1) E = 0.95 sigma T^4 with the total that is asked for.
    let edits = [
        ("model = \"off\"", "model = \"equilibrium\""),
        ("spectrum = \"sun.csv\"", "total_irradiance_w_m2 = 1361"),
        ("centres_um = [1.0]", &with("1500", ", light = \"heat\"")),
    ];
    let (found, said) = seen(&edits, &[]);
    let t_k = (0.9_f64 * 1361.0 / (0.95 * 5.670_374_419e-8)).powf(0.25);
    assert!(
        is_near(found[0], 0.9 * planck(1500.0, t_k), 1e-6) && said.contains("if this is nanometres"),
        "{found:?} {said}"
    );
}

#[test]
fn bands_may_descend_and_be_of_no_width() {
    let sun = "wavelength_um,irradiance_w_m2_um\n0.5,500\n3,3000\n";
    let bands = |text: &str| seen(&[("centres_um = [1.0]", text)], &[("sun.csv", sun)]);
    let (found, _) = bands("start_um = 2.0, stop_um = 1.0, count = 3");
    let expected = [2000.0, 1500.0, 1000.0].map(|e| 0.1 * e / PI);
    assert!(found.iter().zip(expected).all(|(f, e)| is_near(*f, e, 1e-12)) && found.len() == 3, "{found:?}");
    let (found, _) = bands("centres_um = [2.0, 1.0, 1.0]");
    assert!(is_near(found[0], 200.0 / PI, 1e-12) && is_near(found[1], 100.0 / PI, 1e-12) && found[1] == found[2]);
    assert!(is_near(bands("centres_um = [1.0], fwhm_um = 0").0[0], 100.0 / PI, 1e-12));
    let (found, said) = bands("centres_um = [1.0], fwhm_um = 1e-12");
    assert!(is_near(found[0], 100.0 / PI, 1e-12) && said.contains("taken as monochromatic"), "{said}");
}

#[test]
fn a_surface_that_hardly_emits_is_hot_and_a_sun_may_be_dark() {
    let material = |entry: &str| {
        let edits = [
            ("reflectance = 0.1", entry),
            ("model = \"off\"", "model = \"equilibrium\""),
            ("spectrum = \"sun.csv\"", "total_irradiance_w_m2 = 1361"),
            ("centres_um = [1.0]", "centres_um = [10.0], light = \"heat\""),
        ];
        seen(&edits, &[])
    };
    let (found, said) = material("reflectance = 0.1, emissivity_bolometric = 0.0005");
    let t_k = (0.9_f64 * 1361.0 / (0.0005 * 5.670_374_419e-8)).powf(0.25);
    assert!(
        is_near(found[0], 0.9 * planck(10.0, t_k), 1e-6) && said.contains("next to nothing cools"),
        "{found:?} {said}"
    );
    assert!((t_k - 2564.0).abs() < 2.0, "{t_k}");
    let dark = [("spectrum = \"sun.csv\"", "total_irradiance_w_m2 = 0")];
    let (found, said) = seen(&dark, &[]);
    assert!(found == [0.0] && said.contains("is not the Sun at 1 au"), "{found:?} {said}");
}

#[test]
fn an_up_that_nearly_is_the_line_of_sight_still_gives_the_image_a_top() {
    // A step in reflectance along y is seen as one from line to line, whatever y's share of up.
    let halves =
        "v -1 -1 0\nv 1 -1 0\nv 1 0 0\nv -1 0 0\nv 1 1 0\nv -1 1 0\nusemtl g\nf 1 2 3 4\nusemtl h\nf 4 3 5 6\n";
    for up in ["[0, 1, 0]", "[0, 1e-10, 1]", "[0, 1e-13, 1]"] {
        let edits = [
            ("up = [0, 1, 0]", format!("up = {up}")),
            ("g = { reflectance = 0.1 }", "g = { reflectance = 0.1 }\nh = { reflectance = 0.3 }".into()),
            ("samples = 1\nlines = 1", "samples = 1\nlines = 2".into()),
        ];
        let edits: Vec<(&str, &str)> = edits.iter().map(|(a, b)| (*a, b.as_str())).collect();
        let (found, said) = seen(&edits, &[("m.obj", halves)]);
        assert!(is_near(found[0], 300.0 / PI, 1e-9) && is_near(found[1], 100.0 / PI, 1e-9), "{up}: {found:?}");
        assert_eq!(said.contains("off the line of sight"), up.contains('e'), "{up}: {said}");
    }
}

#[test]
fn sizes_and_shapes_of_images_and_bodies_do_not_matter() {
    let expected = 100.0 / PI;
    for size in ["1e-6", "1e7"] {
        let mesh = format!(
            "v -{size} -{size} 0\nv {size} -{size} 0\nv {size} {size} 0\nv -{size} {size} 0\nusemtl g\nf 1 2 3 4\n"
        );
        let away: f64 = 10.0 * size.parse::<f64>().unwrap();
        let (found, _) =
            seen(&[("position_m = [0, 0, 10]", &format!("position_m = [0, 0, {away:e}]"))], &[("m.obj", &mesh)]);
        assert!(is_near(found[0], expected, 1e-12), "{size}: {found:?}");
    }
    let (found, _) = seen(&[("samples = 1", "samples = 4096")], &[]);
    assert!(found.len() == 4096 && found.iter().all(|l| is_near(*l, expected, 1e-12)));
    // One facet, vertices that no facet has, and facets without area or there twice.
    let odd = "v -9 -9 0\nv 9 -9 0\nv 0 9 0\nv 5 5 1e7\nv 0 -9 0\nusemtl g\nf 1 2 3\nf 1 5 2\nf 1 1 2\nf 1 2 3\n";
    let (found, _) = seen(&[], &[("m.obj", odd)]);
    assert!(is_near(found[0], expected, 1e-12), "{found:?}");
    // As far as nearly nothing, and as near as the Sun's own surface: 1 / distance^2.
    for (au, tolerance) in [("0.01", 1e-12), ("40", 1e-12), ("1e6", 1e-12)] {
        let (found, _) = seen(&[("distance_au = 1.0", &format!("distance_au = {au}"))], &[]);
        let distance: f64 = au.parse().unwrap();
        assert!(is_near(found[0], expected / distance.powi(2), tolerance), "{au}: {found:?}");
    }
}
