//! How far off pixels are placed: on flat ground every source has a closed form, and draws say what is carried on linearly.

use glam::{DMat3, DVec3};
use mmxrt::flight::{Aim, Jitter, Pointing};
use mmxrt::geometry::{Mesh, body_from_site};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Mirror, Motion, Readout, Scene, Timing};
use mmxrt::study::knowledge::{
    Asked, Budget, Deviation, Knowledge, Part, PixelBudget, PositionAxes, Scatter, Source, budget, summary,
};
use mmxrt::study::locate::Locator;

use crate::cli::run;
use crate::motion::{HEIGHT_M, down, moving_scene, steady};
use crate::scratch::Scratch;
use crate::shapes::{grid, plane};

const E: f64 = std::f64::consts::FRAC_PI_6;
/// Of the spacecraft, along -y.
const SPEED_M_S: f64 = 400.0;

fn timing(readout: Readout) -> Timing {
    Timing { readout, period_s: 0.1, exposure_s: 1.0, poses: 1 }
}

/// Looking at the origin from +y at an emission of 30 deg while going along -y: the middle pixel of five by five is there when the exposure is half over.
fn oblique(mesh: Mesh) -> (Scene, Motion) {
    let (sin, cos) = E.sin_cos();
    let sensor = DMat3::from_cols(DVec3::X, DVec3::new(0.0, -cos, sin), DVec3::new(0.0, -sin, -cos));
    let law = Pointing { aim: Aim::Fixed("IAU_ROCK".into(), sensor), ..down() };
    let over_s = 0.5 + HEIGHT_M * E.tan() / SPEED_M_S;
    let motion = steady(DVec3::new(0.0, -SPEED_M_S, 0.0), over_s, DVec3::Z, law);
    (moving_scene(mesh, [5, 5], 10.0, &[1.0], &motion, timing(Readout::Frame)), motion)
}

fn asked(every: u32, draws: u32) -> Asked {
    Asked { band: 0, every, draws, seed: 1 }
}

fn budget_of((scene, motion): &(Scene, Motion), readout: Readout, knowledge: &Knowledge, asked: Asked) -> Budget {
    budget(&Locator::new(scene, Some((motion, timing(readout)))), knowledge, asked, &unwatched).unwrap()
}

/// The middle pixel's, and the axes east, north and up at its true point, which is at the pole but for rounding: any direction may be east.
fn middle(scene: &(Scene, Motion), knowledge: &Knowledge) -> (PixelBudget, DMat3) {
    let pixel = budget_of(scene, Readout::Frame, knowledge, asked(5, 0)).pixels[0].clone().unwrap();
    let locator = Locator::new(&scene.0, Some((&scene.1, timing(Readout::Frame))));
    let truth = locator.ground(pixel.place, 0).unwrap().unwrap();
    (pixel, body_from_site(truth.point_m).unwrap())
}

fn biased(bias: Deviation) -> Knowledge {
    Knowledge { bias, axes: PositionAxes::Body, ..Knowledge::default() }
}

#[test]
fn single_biases_are_closed_forms_on_flat_ground() {
    let scene = oblique(plane(3e4, 0.0));
    let (range_m, d, nothing) = (HEIGHT_M / E.cos(), 1e-4, Deviation::default());
    let turn = |x: f64, y: f64, z: f64| biased(Deviation { attitude_rad: DVec3::new(x, y, z), ..nothing });
    let moved = |x: f64, y: f64, z: f64| biased(Deviation { position_m: DVec3::new(x, y, z), ..nothing });
    let in_plane_m = HEIGHT_M * (E.tan() - (E - d).tan());
    for (knowledge, source, expected_m) in [
        // About +x the view goes up the image, here towards the camera: range x angle / cos e, and exactly the difference of two tangents.
        (turn(d, 0.0, 0.0), Source::Attitude, DVec3::Y * in_plane_m),
        (turn(0.0, d, 0.0), Source::Attitude, DVec3::X * range_m * d.tan()),
        (turn(0.0, 0.0, d), Source::Attitude, DVec3::ZERO),
        (moved(3.0, 0.0, 0.0), Source::Position, DVec3::X * 3.0),
        (moved(0.0, 0.0, 2.0), Source::Position, DVec3::NEG_Y * 2.0 * E.tan()),
        (biased(Deviation { clock_s: 0.25, ..nothing }), Source::Clock, DVec3::NEG_Y * SPEED_M_S * 0.25),
        (biased(Deviation { focal_length: 0.01, ..nothing }), Source::FocalLength, DVec3::ZERO),
        (biased(Deviation { height_m: 5.0, ..nothing }), Source::Height, DVec3::new(0.0, 5.0 * E.tan(), 5.0)),
        (
            Knowledge { mesh: Some(plane(3e4, -4.0)), ..Knowledge::default() },
            Source::Mesh,
            DVec3::new(0.0, -4.0 * E.tan(), -4.0),
        ),
    ] {
        let (pixel, axes) = middle(&scene, &knowledge);
        assert_eq!(knowledge.sources(), [source]);
        let bias_m = pixel.sources[0].unwrap().bias_m;
        assert!((axes * bias_m - expected_m).length() < 1e-7, "{source:?}: {bias_m:?}, expected {expected_m:?}");
        assert_eq!(pixel.total.unwrap().bias_m, bias_m);
        assert!((pixel.pixel_m / (range_m * 10.0 / HEIGHT_M) - 1.0).abs() < 1e-12);
    }
    assert!((in_plane_m / (range_m * d / E.cos()) - 1.0).abs() < 1e-4, "the formula of the table");
}

/// Along the way, across it and outwards: the camera is at (0, H tan e, 11 km + H), and goes along -y.
#[test]
fn positions_are_along_across_and_outwards() {
    let scene = oblique(plane(3e4, 0.0));
    let radial = DVec3::new(0.0, HEIGHT_M * E.tan(), 11_000.0 + HEIGHT_M).normalize();
    let along = DVec3::new(0.0, -radial.z, radial.y);
    for (k, axis) in [along, DVec3::X, radial].into_iter().enumerate() {
        let position_m = DVec3::from_array(std::array::from_fn(|i| if i == k { 2.0 } else { 0.0 }));
        let knowledge = Knowledge { bias: Deviation { position_m, ..Deviation::default() }, ..Knowledge::default() };
        let expected_m = 2.0 * (axis - axis.z * DVec3::new(0.0, E.tan(), 1.0));
        let (pixel, axes) = middle(&scene, &knowledge);
        let bias_m = pixel.sources[0].unwrap().bias_m;
        assert!((axes * bias_m - expected_m).length() < 1e-7, "{k}: {bias_m:?} {expected_m:?}");
    }
}

/// Straight down, 20 m to the right: a focal length that is believed 1 % longer leads to 20 / 1.01.
#[test]
fn a_focal_length_scales_the_way_from_the_boresight() {
    let motion = steady(DVec3::ZERO, 0.0, DVec3::Z, down());
    let scene = moving_scene(plane(900.0, 0.0), [5, 5], 10.0, &[1.0], &motion, timing(Readout::Frame));
    let knowledge = biased(Deviation { focal_length: 0.01, ..Deviation::default() });
    let found = budget_of(&(scene, motion), Readout::Frame, &knowledge, asked(1, 0));
    assert_eq!(found.size, [5, 5]);
    let pixel = found.pixels[14].as_ref().unwrap();
    assert_eq!((pixel.place.sample, pixel.place.line), (4.5, 2.5));
    // Along the plane; the horizon at that pixel is tilted by 20 m / 11 km.
    let expected_m = 20.0 / 1.01 - 20.0;
    assert!((pixel.sources[0].unwrap().bias_m.length() + expected_m).abs() < 1e-9);
}

fn scattered() -> Knowledge {
    // A covariance with correlations, by its factor.
    let attitude_rad = DMat3::from_cols(DVec3::new(2e-4, 1e-4, 0.0), DVec3::new(0.0, 1.5e-4, 0.0), DVec3::Z * 3e-4);
    Knowledge {
        bias: Deviation { clock_s: 0.02, height_m: -2.0, ..Deviation::default() },
        scatter: Scatter {
            attitude_rad,
            position_m: DMat3::from_diagonal(DVec3::new(2.0, 1.0, 3.0)),
            clock_s: 0.01,
            focal_length: 1e-3,
            height_m: 1.5,
        },
        ..Knowledge::default()
    }
}

/// Of the middle pixel by hand: e.g. the clock's standard deviation is 400 m/s x 0.01 s.
#[test]
fn scatter_is_carried_on_by_the_same_closed_forms() {
    let (pixel, axes) = middle(&oblique(plane(3e4, 0.0)), &scattered());
    let sd_m = |k: usize| {
        let covariance_m2 = axes * pixel.sources[k].unwrap().covariance_m2 * axes.transpose();
        let part = Part { bias_m: DVec3::ZERO, covariance_m2 };
        part.sd_m()
    };
    // From the mean belief, which has the ground 2 m lower.
    let range_m = (HEIGHT_M + 2.0) / E.cos();
    // Variances about x and y: 2e-4^2, and 1e-4^2 + 1.5e-4^2.
    let attitude_m = DVec3::new(range_m * 1e-4_f64.hypot(1.5e-4), range_m * 2e-4 / E.cos(), 0.0);
    assert!(
        (sd_m(0) / attitude_m.max(DVec3::splat(1e-9)) - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-6,
        "{:?}",
        sd_m(0)
    );
    assert!((sd_m(2) - DVec3::Y * 4.0).length() < 1e-6 && sd_m(3).length() < 1e-9);
    assert!((sd_m(4) - DVec3::new(0.0, 1.5 * E.tan(), 1.5)).length() < 1e-9);
    let total = pixel.total.unwrap();
    let sum: f64 = (0..5).map(|k| sd_m(k).length_squared()).sum();
    assert!((total.sd_m().length_squared() / sum - 1.0).abs() < 1e-12);
    assert!((axes * total.bias_m - DVec3::new(0.0, -8.0 - 2.0 * E.tan(), -2.0)).length() < 1e-6);
}

/// Within three of the draws' own standard errors: of a mean sd / sqrt(n), of a standard deviation sd / sqrt(2 n).
#[test]
fn draws_agree_with_what_is_carried_on_linearly() {
    let found = budget_of(&oblique(plane(3e4, 0.0)), Readout::Frame, &scattered(), asked(4, 10_000));
    let mut count = 0;
    for pixel in found.pixels.iter().flatten() {
        let (total, sampled) = (pixel.total.unwrap(), pixel.sampled.unwrap());
        assert_eq!((sampled.met, sampled.missed), (10_000, 0));
        let drawn = Part { bias_m: sampled.mean_m, covariance_m2: sampled.covariance_m2 };
        let off = ((total.bias_m - drawn.bias_m) / total.sd_m()).abs().max_element();
        let wide = (drawn.sd_m() / total.sd_m() - 1.0).abs().max_element();
        assert!(off < 3.0 / 100.0 && wide < 3.0 / 20_000_f64.sqrt(), "{off} {wide}");
        // Of the sizes of errors 95 of 100 are below; never below their mean square's root.
        assert!(sampled.level_p95_m > drawn.level_m());
        count += 1;
    }
    assert_eq!(count, 4);
    let rows = summary(&found);
    let row = |name: &str| rows.iter().find(|row| row.source == name).unwrap();
    assert!((row("total").level_m.rms / row("monte_carlo").level_m.rms - 1.0).abs() < 0.03);
    assert_eq!(rows.len(), 8);
}

/// A push-broom that shakes, over relief: the same numbers at any number of threads, and a clock's error is not that of its neighbours' lines.
#[test]
fn numbers_do_not_depend_on_threads() {
    let jitter = Jitter { seed: 3, rms_rad: DVec3::splat(2e-5), band_hz: [0.01, 0.05] };
    let motion = steady(DVec3::new(0.0, -5.0, 0.0), 1.0, DVec3::Z, Pointing { jitter: Some(jitter), ..down() });
    let relief = grid(900.0, 30, |x, y| 15.0 * (0.02 * x).sin() * (0.03 * y).cos());
    let scene = moving_scene(relief, [8, 8], 10.0, &[1.0], &motion, timing(Readout::Line));
    let scene = (scene, motion);
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| budget_of(&scene, Readout::Line, &scattered(), asked(3, 50)))
    };
    let one = of(1);
    assert_eq!(one, of(3));
    assert_eq!(one.pixels.iter().flatten().count(), 9);
}

/// Over a mirror each sample has its own moment and camera: the way of the ground by the clock's error is still the carrier's.
#[test]
fn a_whisk_brooms_clock_moves_all_samples_alike() {
    let mirror = Mirror { samples: 8, sample_s: 0.01, step_rad: 5e-4, elements: 2 };
    let timing = Timing { readout: Readout::Sample(mirror), period_s: 4.0, exposure_s: 0.0, poses: 1 };
    let motion = steady(DVec3::NEG_Y * 5.0, 5.0, DVec3::Z, down());
    let scene = moving_scene(plane(900.0, 0.0), [8, 6], 10.0, &[1.0], &motion, timing);
    let knowledge = biased(Deviation { clock_s: 0.5, ..Deviation::default() });
    let found = budget(&Locator::new(&scene, Some((&motion, timing))), &knowledge, asked(1, 0), &unwatched).unwrap();
    assert_eq!(found.pixels.iter().flatten().count(), 48);
    let off = |pixel: &PixelBudget| (pixel.total.unwrap().bias_m.length() - 2.5).abs();
    assert!(found.pixels.iter().flatten().all(|pixel| off(pixel) < 1e-6));
}

#[test]
fn what_meets_nothing_is_counted_and_not_made_up() {
    // Half of the ground is there; the other half is what a mesh is believed to be.
    let scene = oblique(plane(3e4, 0.0));
    let away = Knowledge {
        mesh: Some(plane(1.0, 0.0)),
        bias: Deviation { clock_s: 1.0, ..Deviation::default() },
        ..Knowledge::default()
    };
    let found = budget_of(&scene, Readout::Frame, &away, asked(1, 3));
    assert!(found.pixels.iter().flatten().all(|pixel| pixel.total.is_none() && pixel.sampled.unwrap().missed == 3));
    let rows = summary(&found);
    // The clock alone leads somewhere, but how far it scatters on the believed surface is not known.
    assert!(rows.iter().all(|row| row.source != "total" && row.source != "monte_carlo"), "{rows:?}");
    let nothing = oblique(grid(1.0, 1, |_, _| 0.0));
    let found = budget_of(&nothing, Readout::Frame, &scattered(), asked(5, 0));
    assert_eq!(found.pixels.len(), 1);
}

const KNOWN: &str = "mmxrt_knowledge = 1\n[attitude]\nbias_arcsec = [10, 0, 0]\nsd_mrad = [0.1, 0.1, 0.5]\n[position]\naxes = \"body\"\ncovariance_m2 = [[4, 1, 0], [1, 9, 0], [0, 0, 1]]\n[shape]\nheight_sd_m = 3.0\n[monte_carlo]\ndraws = 100\n";

#[test]
fn the_command_writes_table_images_and_numbers() {
    let scratch = Scratch::new();
    scratch.write("scene.toml", crate::scenes::SITE);
    scratch.write("known.toml", KNOWN);
    let (scene, known, folder) =
        (scratch.argument("scene.toml"), scratch.argument("known.toml"), scratch.argument("errors"));
    let (code, out, err) = run(&["locate", &scene, "--knowledge", &known, "--every", "2"]);
    assert_eq!(code, 0, "{err}");
    for name in ["attitude", "position", "height", "rss", "total", "monte_carlo"] {
        assert!(out.lines().any(|line| line.starts_with(name)), "{name}: {out}");
    }
    let (code, _, err) = run(&["locate", &scene, "--knowledge", &known, "-o", &folder]);
    assert_eq!(code, 0, "{err}");
    let table = std::fs::read_to_string(scratch.join("errors/errors.csv")).unwrap();
    let columns = table.lines().next().unwrap().split(',').count();
    assert!(table.lines().all(|line| line.split(',').count() == columns), "{table}");
    let numbers: serde_json::Value =
        serde_json::from_slice(&std::fs::read(scratch.join("errors/errors.json")).unwrap()).unwrap();
    assert_eq!(numbers["draws"], 100);
    assert_eq!(numbers["sources"][0]["source"], "attitude");
    let (code, _, err) = run(&["inspect", &scratch.argument("errors/errors.hdr")]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(run(&["locate", &scene, "--knowledge", &known, "-o", &folder]).0, 1, "replaced");
    assert_eq!(run(&["locate", &scene, "--knowledge", &known, "-o", &folder, "--force"]).0, 0);
}

#[test]
fn what_is_wrong_with_a_file_is_said_at_its_place() {
    let scratch = Scratch::new();
    scratch.write("scene.toml", crate::scenes::SITE);
    let scene = scratch.argument("scene.toml");
    for (text, at, what) in [
        ("[attitude]\nsd_mrad = [0.1, 0.1, 0.1]\nsd_rad = [1, 1, 1]", ":3", "only one of"),
        ("[attitude]\nsd_mrad = [0.1, -0.1, 0.1]", ":3", "must not be negative"),
        ("[attitude]\ncovariance_mrad2 = [[1, 2, 0], [2, 1, 0], [0, 0, 1]]", ":3", "positive semidefinite"),
        ("[position]\nsd_m = [1, 1, 1]\ncovariance_m2 = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]", ":4", "`sd_m`"),
        ("[position]\nbias_m = [1, 0, 0]", ":2", "axes = \"body\""),
        ("[clock]\nbias_s = 1", ":2", "[flight]"),
        ("[clock]\nsd_ms = 1", ":3", "sd_s"),
        ("[focal_length]\nbias = -1", ":3", "-1"),
        ("[shape]\nunit_m = 1000", ":3", "needs `mesh`"),
        ("[shape]\nmesh = \"gone.obj\"", "gone.obj", "no such file"),
        ("[monte_carlo]\ndraws = 10", "known.toml", "states no uncertainty"),
        ("[attitude]\nsd_mrad = [nan, 0, 0]", ":3", ""),
    ] {
        let known = scratch.write("known.toml", format!("mmxrt_knowledge = 1\n{text}\n"));
        let (code, _, err) = run(&["locate", &scene, "--knowledge", known.to_str().unwrap()]);
        assert!(code == 1 && err.contains(at) && err.contains(what), "{text}: {err}");
    }
    let (code, _, err) = run(&["simulate", &scratch.argument("known.toml"), "-o", &scratch.argument("out")]);
    assert!(code == 1 && err.contains("--knowledge"), "{err}");
}
