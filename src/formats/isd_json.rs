//! Image support data (ISD) for the community sensor model (CSM), as `usgscsm` reads them: a frame camera or a line scanner, as JSON.
//!
//! Image coordinates are ours: pixels from the outer corner of the first pixel, (0.5, 0.5) in its middle. Positions are from the body's centre along its axes; quaternions
//! (x, y, z, w) carry the sensor's axes (x sample, y line, z boresight) into those. Of the lens only the width of a pixel over the focal length is known: the latter is taken
//! to be 100 mm, and pixels follow.

use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use crate::error::{Error, Location, Result};
use crate::flight::{Epoch, radii_m};
use crate::geometry::FrameCamera;
use crate::scene::{Motion, Readout, Scene, Timing};

/// Assumed focal length, mm.
const FOCAL_MM: f64 = 100.0;
/// Rows of positions and attitudes of a line scanner: at least, and per line. The model interpolates between eight.
const LEAST_ROWS: usize = 17;
const ROWS_PER_LINE: usize = 2;

/// The state of a sensor at an epoch.
struct Row {
    position_m: DVec3,
    velocity_m_s: DVec3,
    body_from_sensor: DQuat,
    sun_m: DVec3,
}

/// The ISD of a scene's image, for a tunable filter in a band, from 0.
///
/// # Errors
/// [`Error::Unsupported`] for lenses that distort and whisk-brooms; [`Error::Invalid`] where something is, is not known at a moment.
pub fn isd(scene: &Scene, motion: Option<(&Motion, Timing)>, band: usize) -> Result<Value> {
    let camera = &scene.exposure.camera;
    let refused = |feature: &str| Err(Error::Unsupported { at: Location::item("--isd"), feature: feature.to_owned() });
    if camera.lens.is_some() {
        return refused("a lens that distorts, in image support data");
    }
    let mut isd = common(scene, motion.map(|(motion, _)| motion));
    let Some((motion, timing)) = motion else {
        let row = Row {
            position_m: camera.centre_m() + scene.body.origin_m,
            velocity_m_s: DVec3::ZERO,
            body_from_sensor: DQuat::from_mat3(&camera.world_from_sensor.rotation),
            sun_m: scene.body.origin_m + scene.sky.sun.direction.vec() * scene.sky.sun.distance_m,
        };
        frame(&mut isd, camera, 0.0, &row);
        return Ok(isd);
    };
    match timing.readout {
        Readout::Frame | Readout::Band => {
            let part = if timing.readout == Readout::Band { band } else { 0 };
            let epoch = motion.start.after_s(timing.middle_s(part));
            frame(&mut isd, camera, epoch.tdb_s(), &row(motion, epoch)?);
        }
        Readout::Line => lines(&mut isd, camera, motion, timing)?,
        Readout::Sample(_) => return refused("a whisk-broom, for which usgscsm has no model, in image support data"),
    }
    Ok(isd)
}

fn row(motion: &Motion, epoch: Epoch) -> Result<Row> {
    let (pose, position_m) = (motion.pose(epoch)?, motion.position_m(epoch)?);
    Ok(Row {
        position_m,
        velocity_m_s: motion.velocity_m_s(epoch, position_m)?,
        body_from_sensor: DQuat::from_mat3(&pose.rotation),
        sun_m: motion.seen_m("SUN", epoch)?,
    })
}

/// What frame cameras and line scanners share.
fn common(scene: &Scene, motion: Option<&Motion>) -> Value {
    let camera = &scene.exposure.camera;
    // Of a body without a known size that of its mesh.
    let from_centre_m: Vec<f64> =
        scene.body.mesh.vertices_m.iter().map(|vertex_m| (*vertex_m + scene.body.origin_m).length()).collect();
    let [low_m, high_m] = [f64::min, f64::max].map(|of| from_centre_m.iter().copied().reduce(of).unwrap_or(0.0));
    let [major_m, minor_m] =
        match motion.and_then(|motion| motion.almanac.radii_m(&motion.body).or_else(|| radii_m(&motion.body))) {
            Some(radii) => [radii.max_element(), radii.min_element()],
            None => [high_m; 2],
        };
    let per_mm = camera.pitch.map(|pitch| 1.0 / (pitch * FOCAL_MM));
    json!({
        "name_platform": motion.map_or("SPACECRAFT", |motion| motion.spacecraft.as_str()),
        "name_sensor": scene.exposure.instrument,
        "image_identifier": scene.exposure.instrument,
        "image_samples": camera.samples,
        "image_lines": camera.lines,
        "radii": { "semimajor": major_m, "semiminor": minor_m, "unit": "m" },
        "reference_height": { "minheight": low_m - major_m, "maxheight": high_m - minor_m, "unit": "m" },
        "focal_length_model": { "focal_length": FOCAL_MM },
        "focal2pixel_samples": [0.0, per_mm[0], 0.0],
        "focal2pixel_lines": [0.0, 0.0, per_mm[1]],
        "detector_sample_summing": 1,
        "detector_line_summing": 1,
        "starting_detector_sample": 0,
        "starting_detector_line": 0,
        "optical_distortion": { "radial": { "coefficients": [0.0, 0.0, 0.0] } },
        "interpolation_method": "lagrange",
    })
}

fn frame(isd: &mut Value, camera: &FrameCamera, tdb_s: f64, row: &Row) {
    let [sample, line] = camera.boresight_px;
    isd["name_model"] = json!("USGS_ASTRO_FRAME_SENSOR_MODEL");
    isd["detector_center"] = json!({ "sample": sample, "line": line });
    isd["center_ephemeris_time"] = json!(tdb_s);
    put_rows(isd, std::slice::from_ref(row));
}

fn lines(isd: &mut Value, camera: &FrameCamera, motion: &Motion, timing: Timing) -> Result<()> {
    let count = camera.lines as usize;
    let (first_s, last_s) = (timing.middle_s(0), timing.middle_s(count.saturating_sub(1)));
    let rows = LEAST_ROWS.max(ROWS_PER_LINE * count + 1);
    // Half a line beyond both ends, where edges of the image are sought; not beyond the data.
    let known = |from_s: f64| row(motion, motion.start.after_s(from_s)).is_ok();
    let beyond_s = 0.5 * timing.period_s;
    let begin_s = if known(first_s - beyond_s) { first_s - beyond_s } else { first_s };
    let end_s = if known(last_s + beyond_s) { last_s + beyond_s } else { last_s };
    let step_s = (end_s - begin_s) / (rows - 1) as f64;
    if step_s.is_nan() || step_s <= 0.0 {
        let message = "a line scanner needs at least two lines";
        return Err(Error::invalid(Location::item("sensor.lines"), message));
    }
    let mut all: Vec<Row> = Vec::with_capacity(rows);
    for i in 0..rows {
        let mut next = row(motion, motion.start.after_s(begin_s + i as f64 * step_s))?;
        // q and -q are the same rotation: keep the sign that interpolates.
        if all.last().is_some_and(|before| before.body_from_sensor.dot(next.body_from_sensor) < 0.0) {
            next.body_from_sensor = -next.body_from_sensor;
        }
        all.push(next);
    }
    let middle_s = 0.5 * (first_s + last_s);
    isd["name_model"] = json!("USGS_ASTRO_LINE_SCANNER_SENSOR_MODEL");
    // The slit is where the boresight is; of the detector's one line that is the middle.
    isd["detector_center"] = json!({ "sample": camera.boresight_px[0], "line": 0.5 });
    isd["center_ephemeris_time"] = json!(motion.start.after_s(middle_s).tdb_s());
    let start_s = first_s - 0.5 * timing.period_s;
    isd["starting_ephemeris_time"] = json!(motion.start.after_s(start_s).tdb_s());
    // The middle of the first line, when it begins, from the central time, and how long a line is: usgscsm adds half a line (`getImageTime`).
    isd["line_scan_rate"] = json!([[0.5, start_s - middle_s, timing.period_s]]);
    for kind in ["ephemeris", "quaternion"] {
        isd[format!("t0_{kind}")] = json!(begin_s - middle_s);
        isd[format!("dt_{kind}")] = json!(step_s);
    }
    put_rows(isd, &all);
    Ok(())
}

fn put_rows(isd: &mut Value, rows: &[Row]) {
    let of = |vector: fn(&Row) -> DVec3| rows.iter().map(|row| vector(row).to_array()).collect::<Vec<_>>();
    isd["sensor_position"] =
        json!({ "unit": "m", "positions": of(|row| row.position_m), "velocities": of(|row| row.velocity_m_s) });
    let quaternions: Vec<[f64; 4]> = rows.iter().map(|row| row.body_from_sensor.to_array()).collect();
    isd["sensor_orientation"] = json!({ "quaternions": quaternions });
    let still = vec![[0.0; 3]; rows.len()];
    isd["sun_position"] = json!({ "unit": "m", "positions": of(|row| row.sun_m), "velocities": still });
}
