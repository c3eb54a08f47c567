//! Responses and lights of bands: closed forms, files that cameras come with, and the way to DART and back.

use std::f64::consts::PI;

use mmxrt::formats::{response_csv, scene_toml};
use mmxrt::physics::blackbody;
use mmxrt::progress::unwatched;
use mmxrt::scene::Scene;
use mmxrt::spectral::{ALL_UM, Band, Extend, Light, MOST_BEYOND, Response, Spectrum};
use mmxrt::study;

use crate::cli::run;
use crate::scratch::Scratch;

fn table(um: &[f64], value: &[f64]) -> Spectrum {
    Spectrum::new(um.to_vec(), value.to_vec(), Extend::Error).unwrap()
}

fn mean(band: &Band, knots: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    band.quadrature(knots, ALL_UM).iter().map(|(um, weight)| weight * f(*um)).sum()
}

/// A level plate of reflectance 0.1 with the Sun in the zenith at 1 au, seen from above.
fn plate(bands: &str, more: &str) -> String {
    format!(
        "mmxrt_scene = 1\norigin_m = [0, 0, 10000]\n[[mesh]]\nobj = \"plate.obj\"\n[materials]\nground = {{ reflectance = \"ground.csv\" }}\n\
         [sun]\ndirection = [0, 0, 1]\ndistance_au = 1.0\nspectrum = \"sun.csv\"\n[thermal]\nmodel = \"off\"\n\
         [observer]\nposition_m = [0, 0, 10100]\ntarget_m = [0, 0, 10000]\nup = [0, 1, 0]\n\
         [sensor]\nsamples = 3\nlines = 3\nfov_deg = 0.5\nbands = {{ {bands} }}\n{more}"
    )
}

fn prepared() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("plate.obj", "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nusemtl ground\nf 1 2 3 4\n");
    scratch.write("ground.csv", "wavelength_um,reflectance\n0.3,0.1\n2.5,0.1\n");
    // E = 1000 (um - 0.2), W m-2 um-1.
    scratch.write("sun.csv", "wavelength_um,irradiance_w_m2_um\n0.2,0\n3.2,3000\n");
    scratch
}

fn centre_pixel(scene: &Scene) -> (Vec<f64>, Vec<String>) {
    let observation = study::simulate(scene, &unwatched).unwrap().1;
    let bands = scene.exposure.bands.len();
    ((0..bands).map(|b| observation.cube.band(b)[4]).collect(), observation.warnings)
}

#[test]
fn a_box_over_a_line_is_the_value_at_its_centre_and_over_a_parabola_a_twelfth_of_its_width_squared_more() {
    let band = Band::boxed(2.0, 1.2);
    assert!((mean(&band, &[], |um| 3.0 * um - 1.0) - 5.0).abs() < 1e-12);
    assert!((mean(&band, &[], |um| um * um) - (4.0 + 1.2 * 1.2 / 12.0)).abs() < 1e-12);
    // With a corner inside: the mean of |um - 1.9| from 1.4 to 2.6.
    let expected = (0.5 * 0.5 + 0.7 * 0.7) / 2.0 / 1.2;
    assert!((mean(&band, &[1.9], |um| (um - 1.9).abs()) - expected).abs() < 1e-12);
}

#[test]
fn a_triangle_has_its_centroid_its_half_base_and_its_variance() {
    // Corners a, b, c: mean (a + b + c) / 3, variance (a^2 + b^2 + c^2 - ab - ac - bc) / 18; the equivalent width is half the base.
    let (a, b, c) = (0.5, 0.6, 0.9);
    let band = Band::tabulated(&table(&[a, b, c], &[0.0, 7.0, 0.0])).unwrap();
    assert!((band.centre_um - (a + b + c) / 3.0).abs() < 1e-12);
    assert!((band.fwhm_um.unwrap() - 0.5 * (c - a)).abs() < 1e-12);
    let variance = (a * a + b * b + c * c - a * b - a * c - b * c) / 18.0;
    let centre = band.centre_um;
    assert!((mean(&band, &[], |um| (um - centre).powi(2)) - variance).abs() < 1e-15);
    assert!((mean(&band, &[0.55, 0.7], |um| um * um) - (centre * centre + variance)).abs() < 1e-12);
    let zeros = Band::tabulated(&table(&[0.1, 0.4, a, b, c, 1.2, 2.0], &[0.0, 0.0, 0.0, 7.0, 0.0, 0.0, 0.0])).unwrap();
    assert_eq!(zeros, band, "zeros at the ends say nothing");
}

#[test]
fn a_box_over_a_black_body_is_its_band_integral() {
    for (from, to, t_k) in [(8.0, 12.0, 300.0), (3.0, 5.0, 150.0), (0.5, 20.0, 330.0), (8.0, 14.0, 60.0)] {
        let band = Band::boxed(0.5 * (from + to), to - from);
        let found = mean(&band, &[], |um| blackbody::radiance_w_m2_sr_um(um, t_k)) * (to - from);
        let exact = blackbody::band_radiance_w_m2_sr(from, to, t_k);
        assert!((found / exact - 1.0).abs() < 1e-8, "{from} to {to} um, {t_k} K: {}", found / exact - 1.0);
    }
}

#[test]
fn shares_beyond_what_is_known_are_those_of_the_response() {
    // Of a Gaussian 0.119 516 lie beyond a half-maximum: erfc(sqrt(ln 2)) / 2.
    let gaussian = Band::new(1.0, Some(0.1));
    assert!((gaussian.share_beyond((0.95, 9.0)) - 0.119_515_9).abs() < 1e-6);
    assert_eq!(gaussian.share_beyond((0.7, 9.0)), 0.0);
    assert!((Band::boxed(1.0, 0.4).share_beyond((0.9, 1.1)) - 0.5).abs() < 1e-12);
    assert!((Band::boxed(1.0, 2.5).share_beyond(ALL_UM) - 0.1).abs() < 1e-12);
    // A triangle from 1 to 2 to 3: an eighth lies below 1.5.
    let triangle = Band::tabulated(&table(&[1.0, 2.0, 3.0], &[0.0, 1.0, 0.0])).unwrap();
    assert!((triangle.share_beyond((1.5, 9.0)) - 0.125).abs() < 1e-12);
    assert_eq!([0.5, 1.5].map(|um| Band::new(um, None).share_beyond((1.0, 2.0))), [1.0, 0.0]);
    assert!(gaussian.share_beyond((2.0, 3.0)) == 1.0 && MOST_BEYOND < 0.125);
}

#[test]
fn a_wide_gaussian_ends_where_spectra_do_and_says_so() {
    let scratch = prepared();
    // Known from 0.3 to 2.5 um. A Gaussian at 0.6 um of standard deviation 0.4 / 2.3548 = 0.169 864: below 0.3 um there is
    // Phi(-0.3 / 0.169 864) = 0.038 688 of it; E pi L = 0.1 x 1000 (mean - 0.2), and the mean of a Gaussian cut at -z is s phi(z) / (1 - Phi(-z)) more.
    let scene = scratch.scene(&plate("centres_um = [0.6], fwhm_um = 0.4", ""));
    let (radiance, warnings) = centre_pixel(&scene);
    let s: f64 = 0.4 / 2.354_820_045_030_949;
    let z = 0.3 / s;
    let beyond = 0.038_688_3;
    let moved = s * (-0.5 * z * z).exp() / (2.0 * PI).sqrt() / (1.0 - beyond);
    let expected = 0.1 / PI * 1000.0 * (0.6 + moved - 0.2);
    assert!((radiance[0] / expected - 1.0).abs() < 2e-5, "{} {expected}", radiance[0]);
    assert!(warnings.iter().any(|w| w.contains("3.9 % of the response of band 1 at 0.6 um")), "{warnings:?}");
    // So much that half of its width is not known: an error, at the table that is too short.
    let path = scratch.write("scene.toml", plate("centres_um = [0.4], fwhm_um = 0.3", ""));
    let told = scene_toml::read(&path, &unwatched).unwrap_err().to_string();
    assert!(
        told.contains("reflectance is known from 0.3 to 2.5 um") && told.contains("% of its response lies beyond"),
        "{told}"
    );
    // Narrow ones have nothing to be told of.
    assert_eq!(scratch.scene(&plate("centres_um = [1.0], fwhm_um = 0.1", "")).remarks(), [""; 0]);
}

#[test]
fn boxes_and_tables_of_scene_files_are_what_they_say() {
    let scratch = prepared();
    scratch.write("filters.csv", "Wavelength (nm);red;blue\n700;0;\n600;50;0\n500;0;30\n400;;0\n");
    // Means of 1000 (um - 0.2) over symmetric responses are those of their centres.
    let reflected = |um: f64| 0.1 / PI * 1000.0 * (um - 0.2);
    for (bands, centres, widths) in [
        ("centres_um = [1.0, 1.4], fwhm_um = 0.4, shape = \"box\"", [1.0, 1.4], [0.4, 0.4]),
        ("response = \"filters.csv\"", [0.6, 0.5], [0.1, 0.1]),
        ("response = \"filters.csv\", columns = [\"blue\", \"red\"]", [0.5, 0.6], [0.1, 0.1]),
        (
            "centres_um = [0.8, 9.0], fwhm_um = [0.1, 1.0], shape = [\"box\", \"table\"], response = \"filters.csv\", columns = [\"red\"]",
            [0.8, 0.6],
            [0.1, 0.1],
        ),
    ] {
        let scene = scratch.scene(&plate(bands, ""));
        let (radiance, _) = centre_pixel(&scene);
        assert_eq!(radiance.len(), 2, "{bands}");
        for i in 0..2 {
            let band = &scene.exposure.bands[i];
            assert!((band.centre_um - centres[i]).abs() < 1e-12, "{bands}: {band:?}");
            assert!((band.fwhm_um.unwrap() - widths[i]).abs() < 1e-12, "{bands}: {band:?}");
            assert!((radiance[i] / reflected(centres[i]) - 1.0).abs() < 1e-12, "{bands}: {}", radiance[i]);
        }
    }
    for (bands, words) in [
        ("response = \"filters.csv\", fwhm_um = 0.1", "from which it follows"),
        ("response = \"filters.csv\", columns = [\"green\"]", "they are red, blue"),
        ("response = \"none.csv\"", "none.csv"),
        ("centres_um = [1.0], columns = [\"red\"]", "`response`, which is missing"),
        ("centres_um = [1.0], shape = \"box\"", "a box needs its width"),
        ("centres_um = [1.0], fwhm_um = 0.1, shape = [\"box\", \"box\"]", "2 shapes for 1 bands"),
        ("centres_um = [1.0], light = [\"heat\", \"heat\"]", "2 lights for 1 bands"),
        ("centres_um = [1.0], fwhm_um = 0.1, shape = \"table\"", "0 responses for 1 bands"),
    ] {
        let path = scratch.write("scene.toml", plate(bands, ""));
        let told = scene_toml::read(&path, &unwatched).unwrap_err().to_string();
        assert!(told.contains(words), "{bands}: {told}");
    }
}

#[test]
fn written_scenes_have_the_same_responses_and_lights() {
    let scratch = prepared();
    scratch.write("filters.csv", "wavelength_nm,red,blue\n400,,0\n500,0,30\n600,50,0\n700,0,\n");
    for bands in [
        "response = \"filters.csv\"",
        "centres_um = [1.0, 1.4, 1.5], fwhm_um = [0.4, 0.2, 0.0], shape = [\"box\", \"gaussian\", \"box\"], light = [\"heat\", \"sunlight\", \"both\"]",
        "centres_um = [0.8, 9.0], fwhm_um = [0.1, 1.0], shape = [\"box\", \"table\"], response = \"filters.csv\", columns = [\"red\"], light = \"sunlight\"",
    ] {
        let scene = scratch.scene(&plate(bands, ""));
        let (files, _) = scene_toml::write(&scene, &scratch.join("again.toml"), true).unwrap();
        files.commit().unwrap();
        let again = scene_toml::read(&scratch.join("again.toml"), &unwatched).unwrap().scene;
        let pairs = || again.exposure.bands.iter().zip(&scene.exposure.bands);
        assert!(
            pairs().all(|(a, b)| a.fwhm_um.is_none() || a == b),
            "{:?}\n{:?}",
            again.exposure.bands,
            scene.exposure.bands
        );
        assert!(pairs().all(|(a, b)| (a.centre_um, a.fwhm_um, a.light) == (b.centre_um, b.fwhm_um, b.light)));
    }
    // What differs is told.
    let paths =
        ["light = \"heat\"", "light = \"both\"", "fwhm_um = 0.1, shape = \"box\"", "fwhm_um = 0.1"].map(|more| {
            let name = format!("{}.toml", more.replace([' ', '"', '=', ','], ""));
            scratch.write(&name, plate(&format!("centres_um = [1.0], {more}"), ""));
            scratch.argument(&name)
        });
    let (code, out, _) = run(&["convert", "--diff", &paths[0], &paths[1]]);
    assert!(code == 1 && out.contains("light: heat, both"), "{out}");
    let (code, out, _) = run(&["convert", "--diff", &paths[2], &paths[3]]);
    assert!(code == 1 && out.contains("response: box, gaussian"), "{out}");
}

#[test]
fn a_band_has_the_light_that_it_is_given() {
    let scratch = prepared();
    let heat = |light: &str, count: usize| {
        let centres: Vec<f64> = (0..count).map(|i| 2.0 + 0.01 * i as f64).collect();
        let text = plate(&format!("centres_um = {centres:?}, light = {light}"), "");
        scratch.scene(&text.replace("model = \"off\"", "model = \"thesis\""))
    };
    // Equation (9) of the thesis gives 330 K under the Sun at its zenith; few bands are summed, more are rows of temperatures.
    for count in [3, 12] {
        let all = |light: &str| centre_pixel(&heat(light, count)).0;
        let (both, sun, heat_only) = (all("\"both\""), all("\"sunlight\""), all("\"heat\""));
        for i in 0..count {
            let um = 2.0 + 0.01 * i as f64;
            let planck = 0.9 * blackbody::radiance_w_m2_sr_um(um, 330.0);
            assert!((heat_only[i] / planck - 1.0).abs() < 1e-6, "{um}: {} {planck}", heat_only[i]);
            assert!((sun[i] / (0.1 / PI * 1000.0 * (um - 0.2)) - 1.0).abs() < 1e-12);
            assert!((both[i] / (sun[i] + heat_only[i]) - 1.0).abs() < 1e-12);
        }
    }
    // Where no sunlight is known, a band without it can be.
    let far = plate("centres_um = [8.0], light = \"heat\"", "").replace("\"ground.csv\"", "0.1");
    assert_eq!(scratch.scene(&far.replace("\"off\"", "\"thesis\"")).exposure.bands[0].light, Light::Heat);
}

#[test]
fn the_report_lists_bands_that_are_not_as_most_are() {
    let scratch = prepared();
    let report = |bands: &str| {
        scratch.write("scene.toml", plate(bands, ""));
        let (code, _, err) =
            run(&["simulate", &scratch.argument("scene.toml"), "-o", &scratch.argument("out"), "--force"]);
        assert_eq!(code, 0, "{err}");
        std::fs::read_to_string(scratch.join("out/report.json")).unwrap()
    };
    let told =
        report("centres_um = [1.0, 2.4], fwhm_um = [0.1, 0.2], shape = \"box\", light = [\"both\", \"sunlight\"]");
    assert!(told.contains("\"response\": \"box\"") && told.contains("\"light\": \"sunlight\""), "{told}");
    let header = std::fs::read_to_string(scratch.join("out/cube.hdr")).unwrap();
    assert!(header.contains("fwhm = {\n 0.1, 0.2}"), "{header}");
    assert!(!report("centres_um = [1.0], fwhm_um = 0.1").contains("\"response\""));
}

#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn bands_go_to_dart_and_come_back() {
    let scratch = prepared();
    scratch.write("filter.csv", "wavelength_nm,red\n500,0\n600,50\n700,0\n");
    let text = plate(
        "centres_um = [1.0, 1.4, 9.0, 2.0], fwhm_um = [0.4, 0.2, 1.0, 0.0], shape = [\"box\", \"gaussian\", \"table\", \"gaussian\"], response = \"filter.csv\", light = [\"heat\", \"sunlight\", \"both\", \"sunlight\"]",
        "",
    );
    let scene = scratch.scene(&text);
    for keeps in [true, false] {
        let folder = scratch.argument(if keeps { "dart" } else { "bare" });
        let (code, _, err) = run(&["convert", &scratch.argument("scene.toml"), &folder]);
        assert_eq!(code, 0, "{err}");
        let phase = std::fs::read_to_string(std::path::Path::new(&folder).join("input/phase.xml")).unwrap();
        let modes: Vec<&str> = phase.split("spectralDartMode=\"").skip(1).map(|rest| &rest[..1]).collect();
        assert_eq!(modes, ["2", "0", "0", "0"]);
        if !keeps {
            std::fs::remove_file(std::path::Path::new(&folder).join("mmxrt.toml")).unwrap();
        }
        let back = scratch.argument(if keeps { "dart.toml" } else { "bare.toml" });
        let (code, out, err) = run(&["convert", &folder, &back]);
        assert_eq!(code, 0, "{out}{err}");
        let bands = scene_toml::read(std::path::Path::new(&back), &unwatched).unwrap().scene.exposure.bands.clone();
        let lights: Vec<Light> = bands.iter().map(|b| b.light).collect();
        if keeps {
            assert_eq!(bands, scene.exposure.bands);
        } else {
            // DART's bands are rectangles, and what had both has what matters of it.
            assert!(bands.iter().all(|b| b.response == Response::Box), "{bands:?}");
            assert_eq!(lights, [Light::Heat, Light::Sunlight, Light::Sunlight, Light::Sunlight]);
            assert_eq!((bands[0].centre_um, bands[0].fwhm_um), (1.0, Some(0.4)));
        }
    }
}

#[test]
fn responses_that_are_written_are_read_as_they_were() {
    let scratch = Scratch::new();
    let spectra = [table(&[0.1 + 0.2, 0.7], &[1.0, 1.0 / 3.0]), table(&[0.5, 0.6, 0.7], &[0.0, 1.0, 0.0])];
    let mut text = Vec::new();
    response_csv::write(&mut text, &spectra.iter().map(|s| ("", s)).collect::<Vec<_>>()).unwrap();
    let read = response_csv::read(&scratch.write("r.csv", text)).unwrap().0;
    assert_eq!(read.columns.iter().map(|c| c.1.clone()).collect::<Vec<_>>(), spectra);
}

#[test]
fn filters_are_called_what_their_table_calls_them() {
    let scratch = prepared();
    scratch.write("filters.csv", "wavelength_nm,b,v\n430,0,\n480,50,\n530,0,0\n555,,100\n580,,0\n");
    scratch.write("scene.toml", plate("response = \"filters.csv\"", ""));
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("out"));
    let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--exr"]);
    assert_eq!(code, 0, "{err}");
    // Triangles about 0.48 and 0.555 um, 0.05 and 0.025 um wide.
    let header = std::fs::read_to_string(scratch.join("out/cube.hdr")).unwrap();
    assert!(header.contains("band names = {\n b, v}") && header.contains("wavelength = {\n 0.48, 0.555}"), "{header}");
    assert!(header.contains("fwhm = {\n 0.05, 0.025}"), "{header}");
    let report = std::fs::read_to_string(scratch.join("out/report.json")).unwrap();
    assert!(report.contains("\"name\": \"b\"") && report.contains("radiance at 0.48 um (b)"), "{report}");
    let (code, text, err) = run(&["inspect", &out, "--pixel", "0,0"]);
    assert!(code == 0 && text.contains("\nband,wavelength_um,") && text.contains("\nv,0.555,"), "{text}{err}");
    // The image in OpenEXR says names and widths, and so does what `convert` makes of the one in ENVI.
    let again = scratch.argument("again.exr");
    let (code, text, err) = run(&["convert", &scratch.argument("out/cube.img"), &again]);
    assert_eq!(code, 0, "{text}{err}");
    for path in ["out/cube.exr", "again.exr"] {
        let attributes = mmxrt::formats::exr_cube::read_info(&scratch.join(path)).unwrap().attributes;
        for (name, text) in [("bandNames", "b, v"), ("bandWidths", "0.05 0.025")] {
            assert!(attributes.contains(&(name.to_owned(), text.to_owned())), "{path}: {attributes:?}");
        }
        let bands = mmxrt::formats::registry::image(&scratch.join(path)).unwrap().bands;
        assert_eq!(bands.iter().map(|b| b.fwhm_um).collect::<Vec<_>>(), [Some(0.05), Some(0.025)]);
    }
}
