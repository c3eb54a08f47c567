//! Whisk-brooms: a mirror sweeps a column of elements across the way, each sample at its own moment.

use glam::DVec3;
use mmxrt::flight::Epoch;
use mmxrt::scene::{Mirror, Readout, Timing};
use mmxrt::study::locate::{Locator, Place};

use crate::cli::run;
use crate::flight_scene::FLYING;
use crate::motion::{HEIGHT_M, ORIGIN_M, down, moving_scene, steady, taken};
use crate::scratch::Scratch;
use crate::shapes::*;

const SAMPLES: u32 = 20;
const ELEMENTS: u32 = 2;
const LINES: u32 = 6;
const PIXEL_M: f64 = 10.0;
/// From the left border of a sweep to the right one, rad.
const FIELD_RAD: f64 = 0.06;

fn timing() -> Timing {
    let mirror =
        Mirror { samples: SAMPLES, sample_s: 0.05, step_rad: FIELD_RAD / f64::from(SAMPLES), elements: ELEMENTS };
    Timing { readout: Readout::Sample(mirror), period_s: 4.0, exposure_s: 0.02, poses: 1 }
}

/// Angle of the middle of a sample, rad; moment of it in a sweep, s.
fn angle_rad(sample: f64) -> f64 {
    (sample - 10.0) * 0.003
}

fn moment_s(sweep: f64, sample: f64) -> f64 {
    4.0 * sweep + 0.05 * (sample - 0.5) + 0.01
}

/// Each sample looks along the tangent of its angle, each line of a sweep farther aside with the slant of the way, wherever the carrier is then.
#[test]
fn samples_lie_where_mirror_and_carrier_have_them() {
    for velocity in [DVec3::ZERO, DVec3::new(0.7, -5.0, 0.0)] {
        let motion = steady(velocity, 4.5, DVec3::Z, down());
        let scene = moving_scene(plane(3000.0, 0.0), [SAMPLES, LINES], PIXEL_M, &[1.0], &motion, timing());
        let (cube, observation) = taken(&scene, &motion, timing());
        let of = |name: &str| observation.backplanes.plane(name).unwrap().values.clone();
        let (x, y, coverage) = (of("BODYFIXEDX"), of("BODYFIXEDY"), of("COVERAGE"));
        for pixel in 0..(SAMPLES * LINES) as usize {
            let (sample, line) = ((pixel as u32 % SAMPLES), pixel as u32 / SAMPLES);
            let (sweep, row) = (line / ELEMENTS, line % ELEMENTS);
            let angle = angle_rad(f64::from(sample) + 0.5);
            let at = velocity * (moment_s(f64::from(sweep), f64::from(sample) + 0.5) - 4.5);
            let aside_m = (f64::from(row) + 0.5 - 1.0) * PIXEL_M / angle.cos();
            let expected = at + DVec3::new(HEIGHT_M * angle.tan(), -aside_m, 0.0);
            assert!((x[pixel] - expected.x).abs() < 1e-8 && (y[pixel] - expected.y).abs() < 1e-8, "{pixel}");
            assert!((coverage[pixel] - 1.0).abs() < 1e-12);
        }
        // Even ground is as bright everywhere.
        let radiance = cube.band(0);
        assert!(radiance[0] > 1.0 && radiance.iter().all(|l| (l / radiance[0] - 1.0).abs() < 1e-12));
        let exposures = observation.exposures.unwrap();
        assert_eq!(exposures.taken.len(), (SAMPLES * LINES / ELEMENTS) as usize);
        let since_s = exposures.taken[27].epoch.since_s(motion.start);
        assert!((since_s - moment_s(1.0, 7.5)).abs() < 1e-6 && motion.start == Epoch::J2000);
    }
}

/// Ground that is dark on one side of x = 40 m and bright on the other: the cube has each sample's own.
#[test]
fn samples_of_a_line_have_their_own_spectra() {
    let motion = steady(DVec3::ZERO, 4.5, DVec3::Z, down());
    let half = |from: f64, to: f64| quad([from, -900.0, 0.0], [to, -900.0, 0.0], [to, 900.0, 0.0], [from, 900.0, 0.0]);
    let ground = joined(&[half(-900.0, 40.0), of_material(half(40.0, 900.0), 1)]);
    let scene = moving_scene(ground, [SAMPLES, LINES], PIXEL_M, &[0.5, 5.0], &motion, timing());
    let (cube, observation) = taken(&scene, &motion, timing());
    let bright = &observation.backplanes.plane("ABUNDANCE bright").unwrap().values;
    let first = [cube.band(0), cube.band(1)];
    for pixel in 0..(SAMPLES * LINES) as usize {
        let angle = angle_rad((pixel as u32 % SAMPLES) as f64 + 0.5);
        // A pixel on the ground: 10 m over the square of the angle's cosine, and a bit.
        let at = HEIGHT_M * angle.tan();
        if (at - 40.0).abs() > 8.0 / angle.cos().powi(2) {
            assert_eq!(bright[pixel].round(), if at > 40.0 { 1.0 } else { 0.0 });
            // 0.3 and 0.6 to 0.05, under the same light.
            let expected = if at > 40.0 { [6.0, 12.0] } else { [1.0, 1.0] };
            for band in 0..2 {
                let ratio = first[band][pixel] / first[band][0];
                assert!((ratio - expected[band]).abs() < 1e-9, "{pixel} {band}: {ratio}");
            }
        }
    }
}

#[test]
fn locate_goes_both_ways() {
    let motion = steady(DVec3::new(0.7, -5.0, 0.2), 4.5, DVec3::Z, down());
    let relief = grid(900.0, 40, |x, y| 9.0 * (0.02 * x).sin() * (0.03 * y).cos());
    let scene = moving_scene(relief, [SAMPLES, LINES], PIXEL_M, &[1.0], &motion, timing());
    let locator = Locator::new(&scene, Some((&motion, timing())));
    let mut random = Random(4);
    let ends = [(0.0, 0.0), (20.0, 6.0), (0.0, 6.0), (20.0, 0.0), (10.0, 2.5)];
    let others: Vec<(f64, f64)> = (0..60).map(|_| (20.0 * random.share(), 6.0 * random.share())).collect();
    for (sample, line) in ends.into_iter().chain(others) {
        let ground = locator.ground(Place { sample, line }, 0).unwrap().unwrap();
        let seen = locator.place(ground.point_m, 0).unwrap().unwrap();
        let off = (seen.place.sample - sample).hypot(seen.place.line - line);
        assert!(off < 1e-6, "{sample} {line}: {:?}", seen.place);
        assert_eq!(seen.hidden_by, None);
    }
    // Between sweeps, which lie 20 m apart and see 20 m in the middle: before all of them.
    let before = locator.place(ORIGIN_M + DVec3::new(0.0, 400.0, 0.0), 0).unwrap().unwrap();
    assert!(!before.inside && before.place.line < 0.0, "{before:?}");
}

#[test]
fn a_scene_file_says_how_its_mirror_sweeps() {
    let scratch = Scratch::new();
    let simulated = |text: String| {
        let (scene, out) = (scratch.write("scene.toml", text), scratch.argument("out"));
        let scene = scene.to_string_lossy().into_owned();
        let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--quiet", "--force"]);
        if code == 0 { Ok(()) } else { Err(err) }
    };
    let keys = "kind = \"whisk_broom\"\nmirror = { field_deg = 1.0, active = 0.5, elements = 2 }\nperiod_s = 0.4\nsamples = 8\nlines = 4\n";
    let with = |from: &str, to: &str| {
        let text = FLYING.replace("samples = 8\nlines = 8\n", keys);
        assert!(from.is_empty() || text.contains(from), "{from}");
        if from.is_empty() { text } else { text.replace(from, to) }
    };
    simulated(with("", "")).unwrap();
    let table = std::fs::read_to_string(scratch.join("out/exposures.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    // Two sweeps of eight samples, each of two lines; a sample takes half of 0.4 s over 8.
    assert!(rows.len() == 17 && rows[0].last() == Some(&"sample"));
    assert_eq!((rows[1][..2].to_vec(), rows[16][..2].to_vec()), (vec!["1", "2"], vec!["3", "4"]));
    assert_eq!((rows[1].last(), rows[16].last()), (Some(&"1"), Some(&"8")));
    let since_s = |row: usize| rows[row][5].parse::<f64>().unwrap() - rows[1][5].parse::<f64>().unwrap();
    assert!((since_s(2) - 0.025).abs() < 1e-6 && (since_s(9) - 0.4).abs() < 1e-6);
    for (from, to, message) in [
        ("lines = 4", "lines = 5", "not a whole number of sweeps"),
        ("period_s = 0.4\n", "", "needs `mirror`, and `period_s`"),
        ("field_deg = 1.0", "field_deg = 0.0", "must not be 0"),
        ("period_s = 0.4", "period_s = 0.4\ndistortion = { k1 = 0.1 }", "cannot be combined with a whisk-broom"),
        ("period_s = 0.4", "period_s = 0.4\nsmile_um = [0.1]", "goes with `kind` = \"push_broom\""),
        ("\"whisk_broom\"", "\"push_broom\"", "needs `kind` = \"whisk_broom\""),
    ] {
        let error = simulated(with(from, to)).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
}
