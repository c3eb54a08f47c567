//! `exposures.csv`: when and from where each part of a cube was taken.

use std::fmt::Write as _;
use std::path::Path;

use glam::DQuat;

use crate::error::{Error, Result};
use crate::flight::{LeapSeconds, Scale};
use crate::product::Exposures;

/// Names of the columns. Positions are from the body's centre along its axes; the quaternion carries sensor axes (x sample, y line, z
/// boresight) into those of the body.
const COLUMNS: &str = "first_line,last_line,first_band,last_band,middle_tdb,middle_tdb_s,x_m,y_m,z_m,body_from_sensor_x,body_from_sensor_y,body_from_sensor_z,body_from_sensor_w,to_sun_x,to_sun_y,to_sun_z,sun_distance_m";

/// Writes a row for each part; lines and bands, and of a whisk-broom the sample, count from 1.
///
/// # Errors
/// [`Error::Io`].
pub fn write(path: &Path, exposures: &Exposures) -> Result<()> {
    let leap = LeapSeconds::default();
    // Of a whisk-broom each part is a sample.
    let by_sample = exposures.taken.iter().any(|part| part.take.mirror.is_some());
    let mut text = format!("{COLUMNS}{}\n", if by_sample { ",sample" } else { "" });
    for part in &exposures.taken {
        let (lines, bands) = (&part.take.lines, &part.take.bands);
        let position_m = part.camera.centre_m() + exposures.origin_m;
        let q = DQuat::from_mat3(&part.camera.world_from_sensor.rotation);
        let sun = part.to_sun.vec();
        let time = part.epoch.to_text(Scale::Tdb, 6, &leap);
        let ends = [lines.start + 1, lines.end, bands.start + 1, bands.end];
        let numbers = [
            part.epoch.tdb_s(),
            position_m.x,
            position_m.y,
            position_m.z,
            q.x,
            q.y,
            q.z,
            q.w,
            sun.x,
            sun.y,
            sun.z,
            part.sun_m,
        ];
        let _ = write!(text, "{},{},{},{},{time}", ends[0], ends[1], ends[2], ends[3]);
        numbers.iter().for_each(|number| _ = write!(text, ",{number}"));
        if by_sample {
            let _ = write!(text, ",{}", part.take.samples.start + 1);
        }
        text.push('\n');
    }
    std::fs::write(path, text).map_err(|e| Error::io(path, "writing", e))
}
