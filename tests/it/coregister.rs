//! Can the bands of a moving camera be laid on each other to half a pixel? A plain matcher, against what is true.

use std::borrow::Cow;
use std::f64::consts::TAU;

use glam::DVec3;
use mmxrt::flight::{Aim, Jitter, Pointing, Up};
use mmxrt::formats::envi::{self, Precision};
use mmxrt::product::Plane;
use mmxrt::random::Draws;
use mmxrt::scene::{Readout, Timing};
use mmxrt::study::coregister::{Image, Quality, Truth, Windows, quality, tried};

use crate::cli::run;
use crate::motion::{ORIGIN_M, down, moving_scene, steady, taken};
use crate::scratch::{Scratch, is_heavy};
use crate::shapes::{grid, sun};

const PIXEL_M: f64 = 10.0;

/// What a pair of images is taken of, and how.
#[derive(Debug, Clone, Copy)]
struct Case {
    incidence_deg: f64,
    /// Root mean square of heights, m, at wavelengths of 3 to 40 pixels.
    relief_m: f64,
    /// Root mean square of jitter about x and y, pixels.
    jitter_px: f64,
    /// Mean over noise; infinite: none.
    snr: f64,
    pixels: u32,
}

const USUAL: Case = Case { incidence_deg: 60.0, relief_m: 10.0, jitter_px: 0.0, snr: 100.0, pixels: 96 };

/// Two bands of a camera that holds a point in its view while it goes 2 km at a height of 20 km: relief is seen from directions 5.7 deg apart.
fn quality_of(case: Case) -> Quality {
    let mut draws = Draws::new(11);
    let waves: Vec<[f64; 4]> = (0..48)
        .map(|_| {
            let (length_m, azimuth) = (30.0 * (400.0_f64 / 30.0).powf(draws.unit()), TAU * draws.unit());
            [TAU / length_m * azimuth.cos(), TAU / length_m * azimuth.sin(), TAU * draws.unit(), length_m]
        })
        .collect();
    // The longer the higher: slopes are alike at all lengths.
    let rms = (waves.iter().map(|wave| 0.5 * wave[3] * wave[3]).sum::<f64>()).sqrt();
    let height = |x: f64, y: f64| {
        case.relief_m / rms * waves.iter().map(|[u, v, phase, size]| size * (u * x + v * y + phase).cos()).sum::<f64>()
    };
    let r_m = 0.65 * PIXEL_M * f64::from(case.pixels);
    let mesh = grid(r_m, (2.0 * r_m / 7.0).ceil() as u32, height);
    let timing = Timing { readout: Readout::Band, period_s: 20.0, exposure_s: 1.0, poses: 1 };
    let rms_rad = DVec3::new(1.0, 1.0, 0.0) * (case.jitter_px * PIXEL_M / crate::motion::HEIGHT_M);
    let jitter = (case.jitter_px > 0.0).then_some(Jitter { seed: 5, rms_rad, band_hz: [0.05, 1.0] });
    let law = Pointing { aim: Aim::Target(ORIGIN_M), up: Up::Vector(DVec3::Y), jitter, ..down() };
    let motion = steady(DVec3::new(60.0, -80.0, 0.0), 13.0, sun(case.incidence_deg, 30.0).vec(), law);
    let scene = moving_scene(mesh, [case.pixels; 2], PIXEL_M, &[1.0, 1.0], &motion, timing);
    let (cube, observation) = taken(&scene, &motion, timing);
    let exposures = observation.exposures.unwrap();
    let mut noisy = |band: usize| {
        let mut values = cube.band(band);
        let sigma = values.iter().sum::<f64>() / values.len() as f64 / case.snr;
        values.iter_mut().for_each(|value| *value += sigma * draws.normal());
        values
    };
    let bands = [noisy(0), noisy(1)];
    let moved: Vec<Vec<f64>> =
        (0..4).map(|i| exposures.displacement(&observation.backplanes, i / 2, i % 2).unwrap().values).collect();
    let side = case.pixels as usize;
    let image = |values| Image { values, samples: side, lines: side };
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| image(&moved[i]));
    // The second band is the reference.
    let windows = Windows { half: 7, search: 5, step: if case.pixels < 64 { 2 } else { 8 } };
    quality(&tried(image(&bands[1]), image(&bands[0]), Truth { from: [c, d], to: [a, b] }, windows))
}

/// Low relief under a low Sun and little noise is what a matcher is made for; noise makes it worse, and is what it is judged by.
#[test]
fn a_plain_matcher_does_well_where_it_should() {
    let easy = Case { incidence_deg: 60.0, relief_m: 4.0, snr: f64::INFINITY, pixels: 40, ..USUAL };
    let found = quality_of(easy);
    assert!(found.windows >= 36 && found.matched * 3 >= found.windows * 2, "{found:?}");
    assert!(found.within_half >= 0.95 && found.median_px < 0.15, "{found:?}");
    let noisy = quality_of(Case { snr: 20.0, ..easy });
    assert!(noisy.median_px > found.median_px, "{noisy:?} {found:?}");
}

/// The table of CONVENTIONS: one thing changed at a time. `MMXRT_HEAVY=1 cargo test --profile quick --test it coregister -- --nocapture`.
#[test]
fn a_table_of_what_makes_matching_hard() {
    if !is_heavy() {
        return;
    }
    let cases = [
        USUAL,
        Case { incidence_deg: 20.0, ..USUAL },
        Case { incidence_deg: 40.0, ..USUAL },
        Case { incidence_deg: 75.0, ..USUAL },
        Case { relief_m: 2.0, ..USUAL },
        Case { relief_m: 20.0, ..USUAL },
        Case { relief_m: 40.0, ..USUAL },
        Case { jitter_px: 0.5, ..USUAL },
        Case { jitter_px: 2.0, ..USUAL },
        Case { snr: f64::INFINITY, ..USUAL },
        Case { snr: 30.0, ..USUAL },
        Case { snr: 10.0, ..USUAL },
    ];
    println!(
        "| incidence, deg | relief, m rms | jitter, px | SNR | matched | median, px | p95, px | within 0.5 px |\n|---|---|---|---|---|---|---|---|"
    );
    let found: Vec<Quality> = cases
        .into_iter()
        .map(|case| {
            let of = quality_of(case);
            let percent = |share: f64| format!("{:.0} %", 100.0 * share);
            println!(
                "| {} | {} | {} | {} | {} | {:.3} | {:.3} | {} |",
                case.incidence_deg,
                case.relief_m,
                case.jitter_px,
                case.snr,
                percent(of.matched as f64 / of.windows as f64),
                of.median_px,
                of.p95_px,
                percent(of.within_half)
            );
            of
        })
        .collect();
    // Jitter between exposures is a shift of the whole image, which is what a matcher finds.
    assert!((found[7].median_px - found[0].median_px).abs() < 0.05, "{:?} {:?}", found[7], found[0]);
    assert!(found[11].median_px > found[9].median_px);
}

#[test]
fn the_command_matches_bands_of_a_product() {
    let scratch = Scratch::new();
    let folder = scratch.join("product");
    std::fs::create_dir(&folder).unwrap();
    let side = 48;
    let mut draws = Draws::new(4);
    let waves: Vec<[f64; 3]> =
        (0..40).map(|_| [draws.between(-0.2, 0.2), draws.between(-0.2, 0.2), draws.unit()]).collect();
    let plane = |name: &str, of: &dyn Fn(f64, f64) -> f64| Plane {
        name: name.into(),
        unit: String::new(),
        values: (0..side * side).map(|k| of((k % side) as f64, (k / side) as f64)).collect(),
    };
    let value = |x: f64, y: f64| 80.0 + waves.iter().map(|[u, v, p]| (TAU * (u * x + v * y + p)).cos()).sum::<f64>();
    let write = |name: &str, planes: &[Plane]| {
        let all = planes.iter().map(Cow::Borrowed);
        envi::write_planes(&folder.join(name), [side, side], all, Precision::F64, "of a test").unwrap();
    };
    write("cube.img", &[plane("1", &value), plane("2", &|x, y| value(x - 1.25, y + 0.5))]);
    let product = scratch.argument("product");
    let (code, _, err) = run(&["coregister", &product, "--bands", "1,2"]);
    assert!(code == 1 && err.contains("tunable_filter"), "{err}");
    let nothing = plane("0", &|_, _| 0.0);
    let moved = [plane("x", &|_, _| 1.25), plane("y", &|_, _| -0.5)];
    write("displacement.img", &[nothing.clone(), nothing, moved[0].clone(), moved[1].clone()]);
    let table = scratch.argument("matches.csv");
    let (code, out, err) = run(&["coregister", &product, "--bands", "1,2", "--step", "8", "-o", &table, "--json"]);
    assert_eq!(code, 0, "{err}");
    let found: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert!(found["matched"].as_u64().unwrap() >= 9 && found["p95_px"].as_f64().unwrap() < 0.05, "{out}");
    let rows = std::fs::read_to_string(scratch.join("matches.csv")).unwrap();
    assert!(rows.lines().all(|row| row.split(',').count() == 8), "{rows}");
    assert_eq!(rows.lines().count() - 1, found["windows"].as_u64().unwrap() as usize);
    let (code, _, err) = run(&["coregister", &product, "--bands", "1,3"]);
    assert!(code == 1 && err.contains("band 3"), "{err}");
    let (code, _, err) = run(&["coregister", &product, "--bands", "0,1"]);
    assert!(code == 2 && err.contains("counted from 1"), "{err}");
}
