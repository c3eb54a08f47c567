//! Optics of sensors other than frames: of whisk-brooms, and beside smile and keystone.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;
use mmxrt::geometry::{BrownConrady, Lens, MaterialId, Mesh};
use mmxrt::instrument::Optics;
use mmxrt::integrate::Wanted;
use mmxrt::physics::mtf;
use mmxrt::product::{Cube, CubeAxes, Slab};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Mirror, Readout, Scene, Spectrometer, Timing};
use mmxrt::spectral::Spectrum;
use mmxrt::study::{Extremes, Moving, acquire_by_slabs};

use crate::motion::{HEIGHT_M, down, moving_scene, steady, taken};
use crate::scenes::{edited, lambert};
use crate::shapes::*;

const PIXEL_M: f64 = 10.0;
const LINE: Timing = Timing { readout: Readout::Line, period_s: 1.0, exposure_s: 0.0, poses: 1 };
/// Wide of a column: sweeps of samples that are as far apart as pixels are wide.
const ELEMENTS: u32 = 30;

fn sweep(samples: u32, elements: u32) -> Timing {
    let mirror = Mirror { samples, sample_s: 0.05, step_rad: PIXEL_M / HEIGHT_M, elements };
    Timing { readout: Readout::Sample(mirror), period_s: 4.0, exposure_s: 0.02, poses: 1 }
}

fn gaussian(gaussian_px: f64) -> Optics {
    Optics { gaussian_px, ..Optics::default() }
}

/// What a resting sensor sees of ground, through optics and without: samples of all lines, band by band.
fn seen(ground: (Mesh, &[f64]), image: ([u32; 2], &[f64]), sensor: (Timing, &Spectrometer, &Optics)) -> [Vec<f64>; 2] {
    seen_by_lens(0.0, ground, image, sensor)
}

/// The same through a slit's lens of this radial coefficient; without one of 0.
fn seen_by_lens(
    radial: f64,
    (ground, reflectances): (Mesh, &[f64]),
    ([samples, lines], bands): ([u32; 2], &[f64]),
    (timing, spectrometer, optics): (Timing, &Spectrometer, &Optics),
) -> [Vec<f64>; 2] {
    let motion = steady(DVec3::ZERO, 0.0, DVec3::Z, down());
    let mut plain = ground.clone();
    plain.material.fill(MaterialId(0));
    let scene = moving_scene(plain, [samples, lines], PIXEL_M, bands, &motion, timing);
    let scene: Scene = edited(&scene, |parts| {
        parts.surface.mesh = ground;
        let material = |(i, reflectance): (usize, &f64)| lambert(i, &format!("m{i}"), Spectrum::constant(*reflectance));
        parts.surface.materials = reflectances.iter().enumerate().map(material).collect();
        parts.exposure.spectrometer = spectrometer.clone();
        let of = BrownConrady { radial: [radial, 0.0, 0.0], tangential: [0.0; 2] };
        let camera = &mut parts.exposure.camera;
        let (pitch, middle_px) = (camera.pitch, [0.5 * f64::from(samples), 0.5]);
        camera.lens = Lens::brown_conrady(of, pitch, middle_px, [samples, 1]).unwrap().map(Arc::new);
    });
    let mut slabs: Vec<Slab> = Vec::new();
    let mut put = |slab| {
        slabs.push(slab);
        Ok(())
    };
    let moving = Moving { scene: &scene, motion: &motion, timing, optics: Some(optics) };
    acquire_by_slabs(moving, (&Extremes::new(&scene), 1e-9), Wanted::default(), &mut put, &unwatched).unwrap();
    let cubes = [Cube::new(CubeAxes::of(&scene.exposure), slabs).unwrap(), taken(&scene, &motion, timing).0];
    cubes.map(|cube| (0..bands.len()).flat_map(|band| cube.band(band)).collect())
}

/// A strip of ground across x, or across y.
fn strip(from: f64, to: f64, material: u16, is_across_x: bool) -> Mesh {
    let at = |x: f64, y: f64| if is_across_x { [x, y, 0.0] } else { [-y, x, 0.0] };
    of_material(quad(at(from, -500.0), at(to, -500.0), at(to, 500.0), at(from, 500.0)), material)
}

/// Ground that is bright between two places, dark elsewhere.
fn bar(from: f64, to: f64, is_across_x: bool) -> Mesh {
    let strip = |from, to, material| strip(from, to, material, is_across_x);
    joined(&[strip(-500.0, from, 0), strip(from, to, 1), strip(to, 500.0, 0)])
}

/// Each band's edge is blurred where keystone puts it: as ground that is moved instead, and as the integral of a Gaussian.
#[test]
fn an_edge_is_blurred_where_keystone_has_it() {
    let (sigma_px, bands, keystone_px) = (0.45, [1.0, 1.5, 3.0], vec![0.3, -2.5]);
    let optics = gaussian(sigma_px);
    let spectrometer = Spectrometer { keystone_px: keystone_px.clone(), ..Spectrometer::default() };
    // An edge so many pixels from the left end of 20 samples.
    let edge = |px: f64| {
        let at_m = (px - 10.0) * PIXEL_M;
        joined(&[strip(-500.0, at_m, 0, true), strip(at_m, 500.0, 1, true)])
    };
    let through = |px: f64, spectrometer: &Spectrometer| {
        seen((edge(px), &[0.1, 0.5]), ([20, 1], &bands), (LINE, spectrometer, &optics))[0].clone()
    };
    let blurred = through(12.3, &spectrometer);
    for (band, place) in [-1.0, -0.5, 1.0].into_iter().enumerate() {
        let px = 12.3 - (keystone_px[0] + keystone_px[1] * place);
        let moved = through(px, &Spectrometer::default());
        let line = |image: &[f64]| image[band * 20..][..20].to_vec();
        let (dark, bright) = (line(&moved)[0], line(&moved)[0] * 5.0);
        for (sample, (value, moved)) in line(&blurred).into_iter().zip(line(&moved)).enumerate() {
            assert!((value - moved).abs() < 1e-9 * bright, "{band} {sample}: {value} {moved}");
            let expected = dark + (bright - dark) * mtf::gaussian_edge_mean(sample as f64 + 0.5 - px, sigma_px);
            // Of an edge there are waves that quarters of pixels do not hold: some thousandths.
            assert!((value - expected).abs() < 4e-3 * bright, "{band} {sample}: {value} {expected}");
        }
    }
}

/// Light is moved, not made: a bright bar sends as much with optics as without, at every keystone, and even ground stays even.
#[test]
fn keystone_and_smile_lose_no_light() {
    let spectrometer = Spectrometer { keystone_px: vec![0.3, 1.25], smile_um: vec![0.01, 0.02, -0.03] };
    let keystone_alone = Spectrometer { smile_um: vec![], ..spectrometer.clone() };
    let bands = [1.0, 1.5, 3.0];
    let [blurred, sharp] =
        seen((bar(-23.0, 11.0, true), &[0.0, 0.5]), ([30, 1], &bands), (LINE, &keystone_alone, &gaussian(0.6)));
    for (blurred, sharp) in blurred.chunks_exact(30).zip(sharp.chunks_exact(30)) {
        let (with, without): (f64, f64) = (blurred.iter().sum(), sharp.iter().sum());
        assert!(without > 1.0 && (with / without - 1.0).abs() < 1e-12, "{with} {without}");
        assert!(blurred.iter().zip(sharp).any(|(a, b)| (a - b).abs() > 0.01 * without));
    }
    // Through a lens, too, even ground stays even, at keystones beyond the slit's ends.
    let even = |radial: f64| {
        let ground = (strip(-500.0, 500.0, 0, true), &[0.3][..]);
        let [blurred, sharp] = seen_by_lens(radial, ground, ([12, 1], &bands), (LINE, &keystone_alone, &gaussian(0.6)));
        assert!(blurred.iter().zip(&sharp).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{blurred:?} {sharp:?}");
    };
    even(0.0);
    even(-300.0);
    // Smile is the detector's: on even ground it is what it is without optics.
    let [blurred, sharp] =
        seen((strip(-500.0, 500.0, 0, true), &[0.3]), ([12, 2], &bands), (LINE, &spectrometer, &gaussian(0.6)));
    for (a, b) in blurred.iter().zip(&sharp) {
        assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    }
}

/// Ground that is a wave along x: quarters of pixels with its means, of 4 pixels' length.
fn wave() -> (Mesh, Vec<f64>) {
    let step_m = 0.25 * PIXEL_M;
    let quarters: Vec<Mesh> = (-80..80_i32)
        .map(|i| strip(step_m * f64::from(i), step_m * f64::from(i + 1), i.rem_euclid(16) as u16, true))
        .collect();
    let mean = |i: i32| 0.3 + 0.2 * (TAU * (f64::from(i) + 0.5) / 16.0 + 0.7).cos() * mtf::mean(0.25, 0.25);
    (joined(&quarters), (0..16).map(mean).collect())
}

/// What is left of a wave over its amplitude, of pixels whose left border is at x = 0 in the middle of the image.
fn contrast(line: &[f64]) -> f64 {
    let mean = line.iter().sum::<f64>() / line.len() as f64;
    let (mut product, mut square) = (0.0, 0.0);
    for (sample, value) in line.iter().enumerate() {
        let at = (TAU * 0.25 * (sample as f64 + 0.5 - 0.5 * line.len() as f64) + 0.7).cos();
        product += (value / mean - 1.0) * at;
        square += at * at;
    }
    product / square * 0.3 / 0.2
}

/// A wave of a cycle in four pixels passes a Gaussian and the pixel's area as both transfers say, sample by sample of a sweep and along a slit.
#[test]
fn waves_pass_a_sweep_as_transfers_say() {
    let (ground, reflectances) = wave();
    let expected = mtf::mean(0.25, 1.0) * mtf::gaussian(0.25, 0.5);
    let spectrometer = Spectrometer::default();
    for (timing, lines) in [(LINE, 1), (sweep(12, 1), 1)] {
        let [blurred, sharp] =
            seen((ground.clone(), &reflectances), ([12, lines], &[1.0]), (timing, &spectrometer, &gaussian(0.5)));
        let (with, without) = (contrast(&blurred), contrast(&sharp));
        assert!((with - expected).abs() < 1e-3, "{timing:?}: {with} {expected}");
        assert!((without - mtf::mean(0.25, 1.0)).abs() < 1e-3, "{timing:?}: {without}");
    }
}

/// In a column light of a bar is moved, not made, and what is even stays even; light that is scattered is the column's mean.
#[test]
fn a_column_loses_no_light() {
    let ideal = Spectrometer::default();
    let column = ([3, ELEMENTS], &[1.0, 2.0][..]);
    let timing = sweep(3, ELEMENTS);
    let sums = |image: &[f64]| -> Vec<f64> {
        let of = |(band, sample): (usize, usize)| {
            image[band * 3 * ELEMENTS as usize..][..3 * ELEMENTS as usize].iter().skip(sample).step_by(3).sum()
        };
        (0..2).flat_map(|band| (0..3).map(move |sample| (band, sample))).map(of).collect()
    };
    let veiled = Optics { stray: 0.2, ..gaussian(0.6) };
    for optics in [gaussian(0.6), veiled] {
        let [blurred, sharp] = seen((bar(-31.0, 17.0, false), &[0.0, 0.5]), column, (timing, &ideal, &optics));
        for (with, without) in sums(&blurred).into_iter().zip(sums(&sharp)) {
            assert!(without > 1.0 && (with / without - 1.0).abs() < 1e-12, "{with} {without}");
        }
        if optics.stray > 0.0 {
            // The topmost element sees nothing but a fifth of the mean.
            let mean = sums(&sharp)[1] / f64::from(ELEMENTS);
            assert!((blurred[1] / (0.2 * mean) - 1.0).abs() < 1e-9, "{} {mean}", blurred[1]);
        }
    }
    let [blurred, sharp] = seen((strip(-500.0, 500.0, 0, true), &[0.3]), column, (timing, &ideal, &gaussian(0.6)));
    assert!(blurred.iter().zip(&sharp).all(|(a, b)| (a / b - 1.0).abs() < 1e-12));
}
