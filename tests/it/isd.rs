//! Image support data for CSM: what `usgscsm` would make of them, by its equations written down again, is what we say.

use glam::{DQuat, DVec3};
use mmxrt::flight::{Pointing, Scan};
use mmxrt::formats::isd_json::isd;
use mmxrt::scene::{Mirror, Readout, Timing};
use mmxrt::study::locate::Locator;
use serde_json::Value;

use crate::cli::run;
use crate::motion::{ORIGIN_M, down, moving_scene, steady};
use crate::scratch::Scratch;
use crate::shapes::grid;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// Sample and line of a body-fixed point from a position and a quaternion (x, y, z, w): the collinearity equations, x = f u / w, then focal2pixel and the detector's centre.
fn projected(isd: &Value, position_m: &[f64], quaternion: &[f64], point_m: DVec3) -> [f64; 2] {
    let q = DQuat::from_xyzw(quaternion[0], quaternion[1], quaternion[2], quaternion[3]).normalize();
    let seen = q.inverse() * (point_m - DVec3::from_slice(position_m));
    let f = number(&isd["focal_length_model"]["focal_length"]);
    let (x, y) = (f * seen.x / seen.z, f * seen.y / seen.z);
    ["sample", "line"].map(|axis| {
        let c = numbers(&isd[format!("focal2pixel_{axis}s")]);
        c[0] + c[1] * x + c[2] * y + number(&isd["detector_center"][axis])
            - number(&isd[format!("starting_detector_{axis}")])
    })
}

/// Lagrange's interpolation among the eight rows around a moment.
fn between(rows: &Value, at: f64) -> Vec<f64> {
    let rows: Vec<Vec<f64>> = rows.as_array().unwrap().iter().map(numbers).collect();
    let first = (at.floor() as isize - 3).clamp(0, rows.len() as isize - 8) as usize;
    let mut sum = vec![0.0; rows[0].len()];
    for i in first..first + 8 {
        let others = (first..first + 8).filter(|j| *j != i);
        let weight: f64 = others.map(|j| (at - j as f64) / (i as f64 - j as f64)).product();
        sum.iter_mut().zip(&rows[i]).for_each(|(sum, x)| *sum += weight * x);
    }
    sum
}

fn relief() -> mmxrt::geometry::Mesh {
    grid(900.0, 30, |x, y| 15.0 * (0.02 * x).sin() * (0.03 * y).cos())
}

#[test]
fn a_frame_camera_projects_as_the_frame_model_does() {
    for (readout, band) in [(Readout::Frame, 0), (Readout::Band, 2)] {
        let timing = Timing { readout, period_s: 1.5, exposure_s: 1.0, poses: 1 };
        let motion = steady(DVec3::new(3.0, -4.0, 0.5), 8.0, DVec3::new(1.0, 0.5, 2.0), down());
        let mut scene = moving_scene(relief(), [40, 24], 10.0, &[1.0, 1.5, 2.0], &motion, timing);
        scene = crate::scenes::edited(&scene, |parts| {
            parts.exposure.camera.pitch[1] *= 1.25;
            parts.exposure.camera.boresight_px = [18.5, 13.25];
        });
        let isd = isd(&scene, Some((&motion, timing)), band).unwrap();
        assert_eq!(isd["name_model"], "USGS_ASTRO_FRAME_SENSOR_MODEL");
        let middle_s = if band == 2 { 3.5 } else { 0.5 };
        assert_eq!(number(&isd["center_ephemeris_time"]), middle_s);
        let locator = Locator::new(&scene, Some((&motion, timing)));
        for offset in [DVec3::ZERO, DVec3::new(70.0, -30.0, 5.0), DVec3::new(-130.0, 90.0, -8.0)] {
            let point_m = ORIGIN_M + offset;
            let ours = locator.place(point_m, band).unwrap().unwrap().place;
            let (positions, quaternions) = (
                numbers(&isd["sensor_position"]["positions"][0]),
                numbers(&isd["sensor_orientation"]["quaternions"][0]),
            );
            let [sample, line] = projected(&isd, &positions, &quaternions, point_m);
            assert!((sample - ours.sample).abs() < 1e-7 && (line - ours.line).abs() < 1e-7, "{sample} {line} {ours:?}");
        }
    }
}

#[test]
fn a_push_broom_projects_as_the_line_scanner_model_does() {
    let timing = Timing { readout: Readout::Line, period_s: 1.7, exposure_s: 1.0, poses: 1 };
    let scan = Scan { axis: DVec3::X, start_rad: 0.002, rate_rad_s: -1e-4 };
    let motion = steady(DVec3::new(0.4, -4.0, 0.1), 20.0, DVec3::Z, Pointing { scan: Some(scan), ..down() });
    let scene = moving_scene(relief(), [40, 24], 10.0, &[1.0], &motion, timing);
    let isd = isd(&scene, Some((&motion, timing)), 0).unwrap();
    assert_eq!(isd["name_model"], "USGS_ASTRO_LINE_SCANNER_SENSOR_MODEL");
    let locator = Locator::new(&scene, Some((&motion, timing)));
    let rate = numbers(&isd["line_scan_rate"][0]);
    let mut seen = 0;
    for place in [(20.0, 12.0), (3.25, 1.0), (38.0, 22.5)] {
        let place = mmxrt::study::locate::Place { sample: place.0, line: place.1 };
        let point_m = locator.ground(place, 0).unwrap().unwrap().point_m;
        // At the line that the point is in, it is drawn in the middle of the detector's one line.
        // Half a line is added to when the line begins: `getImageTime` of usgscsm.
        let s = rate[1] + (place.line - rate[0] + 0.5) * rate[2];
        let at = |kind: &str| (s - number(&isd[format!("t0_{kind}")])) / number(&isd[format!("dt_{kind}")]);
        let position_m = between(&isd["sensor_position"]["positions"], at("ephemeris"));
        let quaternion = between(&isd["sensor_orientation"]["quaternions"], at("quaternion"));
        let [sample, line] = projected(&isd, &position_m, &quaternion, point_m);
        assert!((sample - place.sample).abs() < 1e-6 && (line - 0.5).abs() < 1e-6, "{sample} {line} {place:?}");
        seen += 1;
    }
    assert_eq!(seen, 3);
    // The first line is exposed from 0 to 1 s, and its time is 1.7 s.
    assert!((number(&isd["starting_ephemeris_time"]) - (0.5 - 0.85)).abs() < 1e-12);
}

/// Of the shipped kind of scene, which states places and no time.
#[test]
fn the_command_writes_what_the_model_needs() {
    let scratch = Scratch::new();
    scratch.write("scene.toml", crate::scenes::SITE);
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument("isd.json"));
    let (code, _, err) = run(&["locate", &scene, "--isd", &out]);
    assert_eq!(code, 0, "{err}");
    let isd: Value = serde_json::from_slice(&std::fs::read(scratch.join("isd.json")).unwrap()).unwrap();
    // The keys that usgscsm asks a frame camera's ISD for.
    for key in [
        "name_model",
        "name_platform",
        "name_sensor",
        "image_identifier",
        "image_lines",
        "image_samples",
        "detector_center",
        "detector_sample_summing",
        "detector_line_summing",
        "starting_detector_line",
        "starting_detector_sample",
        "focal2pixel_lines",
        "focal2pixel_samples",
        "focal_length_model",
        "optical_distortion",
        "radii",
        "reference_height",
        "center_ephemeris_time",
        "sensor_position",
        "sensor_orientation",
        "sun_position",
    ] {
        assert!(!isd[key].is_null(), "no {key}");
    }
    let centre = projected(
        &isd,
        &numbers(&isd["sensor_position"]["positions"][0]),
        &numbers(&isd["sensor_orientation"]["quaternions"][0]),
        DVec3::new(0.0, 12000.0, 0.0),
    );
    assert!((centre[0] - 8.0).abs() < 1e-9 && (centre[1] - 8.0).abs() < 1e-9, "{centre:?}");
    assert_eq!(run(&["locate", &scene, "--isd", &out]).0, 1, "replaced");
    assert_eq!(run(&["locate", &scene, "--isd", &out, "--force"]).0, 0);
    let (code, _, err) = run(&["locate", &scene, "--isd", &out, "--force", "--band", "9"]);
    assert!(code == 1 && err.contains("band 9"), "{err}");
}

/// What the models have no place for is refused.
#[test]
fn a_whisk_broom_has_no_model() {
    let mirror = Mirror { samples: 8, sample_s: 0.01, step_rad: 5e-4, elements: 1 };
    let timing = Timing { readout: Readout::Sample(mirror), period_s: 1.0, exposure_s: 0.0, poses: 1 };
    let motion = steady(DVec3::new(0.0, -10.0, 0.0), 3.0, DVec3::Z, down());
    let scene = moving_scene(relief(), [8, 6], 10.0, &[1.0], &motion, timing);
    let error = isd(&scene, Some((&motion, timing)), 0).unwrap_err().to_string();
    assert!(error.contains("whisk-broom") && error.contains("not supported"), "{error}");
}
