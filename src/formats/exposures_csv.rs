//! `exposures.csv`: epoch and camera pose of each part of a cube.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use glam::{DQuat, DVec3};

use super::input::{self, Problems};
use super::table::Places;
use crate::error::{Error, Location, Problem, Result};
use crate::flight::{LeapSeconds, Scale};
use crate::product::Exposures;

/// Names of the columns. Positions are from the body's centre along its axes; the quaternion carries sensor axes (x sample, y line, z
/// boresight) into those of the body.
pub const COLUMNS: &str = "first_line,last_line,first_band,last_band,middle_tdb,middle_tdb_s,x_m,y_m,z_m,body_from_sensor_x,body_from_sensor_y,body_from_sensor_z,body_from_sensor_w,to_sun_x,to_sun_y,to_sun_z,sun_distance_m";

/// Writes a row for each part; lines and bands, and of a whisk-broom the sample, count from 1.
///
/// # Errors
/// [`Error::Io`].
pub fn write(path: &Path, exposures: &Exposures) -> Result<()> {
    let leap = LeapSeconds::default();
    // For a whisk-broom each part is a sample.
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

/// A part of a cube, as its row has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Its lines, from 0.
    pub lines: Range<usize>,
    /// Its bands, from 0.
    pub bands: Range<usize>,
    /// For a whisk-broom its sample, from 0.
    pub sample: Option<usize>,
    /// The middle of its exposure, TDB, as it is written.
    pub middle: String,
    /// The same, s from J2000.
    pub tdb_s: f64,
    /// Where the camera is, from the body's centre along its axes, m.
    pub position_m: DVec3,
    /// Rotation from sensor axes to body axes.
    pub body_from_sensor: DQuat,
}

/// A longer table is refused, bytes.
const LONGEST: u64 = 1 << 31;
/// Index of the text column: the epoch.
const TEXT: usize = 4;
/// Tolerance of a quaternion's length, for rounding in the text.
const UNIT: f64 = 1e-6;

/// Whether a file has this table's header.
///
/// # Errors
/// [`Error::Io`].
pub fn is_one(path: &Path) -> Result<bool> {
    Ok(input::beginning(path, COLUMNS.len())? == COLUMNS.as_bytes())
}

/// Reads what [`write()`] has written.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with every cell that is not what its column says, and moments that do not ascend; for no rows.
pub fn read(path: &Path) -> Result<Vec<Row>> {
    let text = input::text(path, LONGEST)?.0;
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let names: Vec<&str> = header.split(',').collect();
    let by_sample = match header.strip_prefix(COLUMNS) {
        Some("") => false,
        Some(",sample") => true,
        _ => {
            let message = format!("the header is not that of a product's exposures: {COLUMNS}");
            return Err(Error::invalid(Location::line(path, 1), message));
        }
    };
    let mut places = Places::of(path, &text);
    let mut problems = Problems::default();
    let mut rows: Vec<Row> = Vec::new();
    for line in lines.filter(|line| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != names.len() {
            let at = places.place(line);
            problems.push(|| Problem::new(at, format!("{} cells of {}", cells.len(), names.len())));
            continue;
        }
        let mut wrong: Vec<(&str, String)> = Vec::new();
        let mut counted = |column: usize| {
            let number = cells[column].parse::<usize>().ok().filter(|number| *number > 0);
            if number.is_none() {
                wrong.push((cells[column], format!("{} counts from 1: {:?}", names[column], cells[column])));
            }
            number
        };
        let ends = [0, 1, 2, 3].map(&mut counted);
        let sample = if by_sample { counted(names.len() - 1) } else { None };
        let numbers: Vec<f64> = (TEXT + 1..TEXT + 13)
            .map(|column| {
                let number = cells[column].parse::<f64>().ok().filter(|number| number.is_finite());
                if number.is_none() {
                    wrong.push((
                        cells[column],
                        format!("{} is not a finite number: {:?}", names[column], cells[column]),
                    ));
                }
                number.unwrap_or(0.0)
            })
            .collect();
        let [Some(first_line), Some(last_line), Some(first_band), Some(last_band)] = ends else {
            tell(&mut problems, &mut places, wrong);
            continue;
        };
        for (first, last, cell) in [(first_line, last_line, cells[1]), (first_band, last_band, cells[3])] {
            if last < first {
                wrong.push((cell, format!("ends at {last}, before it begins at {first}")));
            }
        }
        let tdb_s = numbers[0];
        let after = rows.last().map(|row| row.tdb_s).filter(|before| *before >= tdb_s);
        if let Some(before) = after.filter(|_| wrong.is_empty()) {
            wrong.push((cells[TEXT + 1], format!("times must ascend: {tdb_s} s comes after {before} s")));
        }
        let body_from_sensor = DQuat::from_slice(&numbers[4..8]);
        if wrong.is_empty() && (body_from_sensor.length() - 1.0).abs() > UNIT {
            wrong.push((cells[TEXT + 5], "the quaternion must have length 1".to_owned()));
        }
        if !wrong.is_empty() {
            tell(&mut problems, &mut places, wrong);
            continue;
        }
        rows.push(Row {
            lines: first_line - 1..last_line,
            bands: first_band - 1..last_band,
            sample: sample.map(|sample| sample - 1),
            middle: cells[TEXT].to_owned(),
            tdb_s,
            position_m: DVec3::from_slice(&numbers[1..4]),
            body_from_sensor,
        });
    }
    problems.finish(path)?;
    if rows.is_empty() { Err(Error::invalid(Location::file(path), "has no rows")) } else { Ok(rows) }
}

/// Adds problems with cells of a row, in order.
fn tell(problems: &mut Problems, places: &mut Places<'_>, mut wrong: Vec<(&str, String)>) {
    wrong.sort_by_key(|(cell, _)| cell.as_ptr() as usize);
    for (cell, message) in wrong {
        let at = places.place(cell);
        problems.push(|| Problem::new(at, message));
    }
}
