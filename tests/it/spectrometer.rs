//! Push-brooms with smile, keystone and distortion.

use std::sync::Arc;

use glam::DVec3;
use mmxrt::geometry::{BrownConrady, Lens};
use mmxrt::scene::{Readout, Scene, Spectrometer, Timing};
use mmxrt::study::locate::{Locator, Place};

use crate::motion::{HEIGHT_M, ORIGIN_M, down, moving_scene, steady, taken};
use crate::scenes::edited;
use crate::shapes::*;

const PIXEL_M: f64 = 10.0;
const TIMING: Timing = Timing { readout: Readout::Line, period_s: 1.0, exposure_s: 0.0, poses: 1 };

fn strip(from: f64, to: f64, material: u16) -> mmxrt::geometry::Mesh {
    of_material(quad([from, -500.0, 0.0], [to, -500.0, 0.0], [to, 500.0, 0.0], [from, 500.0, 0.0]), material)
}

/// Radiance of each band of a line of 20 samples, with an edge this many pixels from its left end: dark left, bright right.
fn line(edge_px: f64, bands: &[f64], spectrometer: &Spectrometer) -> Vec<Vec<f64>> {
    let motion = steady(DVec3::ZERO, 0.0, DVec3::Z, down());
    let edge_m = (edge_px - 10.0) * PIXEL_M;
    let scene = moving_scene(
        joined(&[strip(-500.0, edge_m, 0), strip(edge_m, 500.0, 1)]),
        [20, 2],
        PIXEL_M,
        bands,
        &motion,
        TIMING,
    );
    let scene = edited(&scene, |parts| parts.exposure.spectrometer = spectrometer.clone());
    let (cube, _) = taken(&scene, &motion, TIMING);
    (0..bands.len()).map(|band| cube.band(band)[..20].to_vec()).collect()
}

/// A band that looks k pixels farther to the right has in each pixel what lies there.
#[test]
fn keystone_shifts_each_band_by_its_own() {
    let all = |bands: &[f64], keystone_px: Vec<f64>, off: f64| {
        let shifted = Spectrometer { keystone_px: keystone_px.clone(), ..Spectrometer::default() };
        let (low, high) = (bands[0], bands[bands.len() - 1]);
        for (band, line) in line(12.3, bands, &shifted).iter().enumerate() {
            let place = 2.0 * (bands[band] - low) / (high - low) - 1.0;
            let k = keystone_px[0] + keystone_px[1] * place;
            let (dark, bright) = (line[0], line[19]);
            for (sample, value) in line.iter().enumerate() {
                let expected = (sample as f64 + k + 1.0 - 12.3).clamp(0.0, 1.0);
                let share = (value - dark) / (bright - dark);
                assert!((share - expected).abs() <= off, "{band} {sample}: {share} {expected}");
            }
        }
    };
    all(&[1.0, 1.5, 3.0], vec![0.2, -0.45], 1e-9);
    // Of more bands it is interpolated between looks 1/32 of a pixel apart: a quarter of that at an edge.
    let many: Vec<f64> = (0..40).map(|i| 1.0 + 0.05 * f64::from(i)).collect();
    all(&many, vec![0.0, 0.7], 1.0 / 128.0 + 1e-9);
}

/// Under even light the bright strip's radiance is as its reflectance, which is linear: 0.3 at 0.5 um to 0.6 at 5 um.
#[test]
fn smile_shifts_the_centres_of_bands() {
    let bands = [1.0, 2.0];
    let plain = line(-20.0, &bands, &Spectrometer::default());
    let smiling = Spectrometer { smile_um: vec![0.01, 0.1, -0.2], ..Spectrometer::default() };
    let smiled = line(-20.0, &bands, &smiling);
    let reflectance = |um: f64| 0.3 + 0.3 * (um - 0.5) / 4.5;
    for (band, um) in bands.iter().enumerate() {
        for sample in 0..20 {
            let u = (2.0 * sample as f64 + 1.0) / 20.0 - 1.0;
            let expected = reflectance(um + 0.01 + 0.1 * u - 0.2 * u * u) / reflectance(*um);
            let ratio = smiled[band][sample] / plain[band][sample];
            assert!((ratio - expected).abs() < 1e-12, "{band} {sample}: {ratio} {expected}");
        }
    }
    // With keystone, too: where all is even, that changes nothing.
    let both = line(-20.0, &bands, &Spectrometer { keystone_px: vec![0.1, 0.3], ..smiling });
    assert!(both.iter().flatten().zip(smiled.iter().flatten()).all(|(a, b)| (a / b - 1.0).abs() < 1e-12));
}

/// A slit behind a lens: samples look where the formula has them, and locate finds them.
#[test]
fn a_slit_is_distorted_as_a_frame_is() {
    let motion = steady(DVec3::NEG_Y * 8.0, 1.5, DVec3::Z, down());
    let scene = moving_scene(plane(500.0, 0.0), [20, 4], PIXEL_M, &[1.0], &motion, TIMING);
    let of = BrownConrady { radial: [-3000.0, 0.0, 0.0], tangential: [0.02, 0.0] };
    let pitch = scene.exposure.camera.pitch;
    let lens = Lens::brown_conrady(of, pitch, [10.0, 0.5], [20, 1]).unwrap().map(Arc::new);
    let scene: Scene = edited(&scene, |parts| parts.exposure.camera.lens = lens);
    let (_, observation) = taken(&scene, &motion, TIMING);
    let x = &observation.backplanes.plane("BODYFIXEDX").unwrap().values;
    let y = &observation.backplanes.plane("BODYFIXEDY").unwrap().values;
    for pixel in 0..80 {
        // Forward: the tangents of what the centre sees are imaged in the middle of the sample, and of the slit.
        let at_y = -8.0 * ((pixel / 20) as f64 - 1.5);
        let [u, v] = [x[pixel] / HEIGHT_M, -(y[pixel] - at_y) / HEIGHT_M];
        let r2 = u * u + v * v;
        let imaged = [u * (1.0 - 3000.0 * r2) + 0.04 * u * v, v * (1.0 - 3000.0 * r2) + 0.02 * (r2 + 2.0 * v * v)];
        let sample = imaged[0] / pitch[0] + 10.0;
        assert!(
            (sample - (pixel % 20) as f64 - 0.5).abs() < 1e-7 && imaged[1].abs() < 1e-7 * pitch[1],
            "{pixel}: {sample}"
        );
    }
    let locator = Locator::new(&scene, Some((&motion, TIMING)));
    for (sample, line) in [(0.0, 0.0), (20.0, 4.0), (3.3, 1.7), (0.0, 4.0), (17.0, 0.2)] {
        let ground = locator.ground(Place { sample, line }, 0).unwrap().unwrap();
        let seen = locator.place(ground.point_m, 0).unwrap().unwrap();
        assert!((seen.place.sample - sample).hypot(seen.place.line - line) < 1e-6, "{:?}", seen.place);
        assert!((ground.point_m - ORIGIN_M).z.abs() < 1e-6);
    }
}
