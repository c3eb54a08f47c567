//! Tables of points for `locate`: places of an image, or points of the ground, and what is found of them.

use std::fmt::Write as _;
use std::path::Path;

use glam::DVec3;

use super::input::{self, Problems};
use super::table::place;
use crate::error::{Error, Location, Problem, Result};
use crate::flight::Epoch;
use crate::study::locate::{Ground, Place, Seen};

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Asked {
    /// What a place of the image shows.
    Pixel(Place),
    /// Where a point of the ground lies, from the body's centre along its axes, m.
    Ground(DVec3),
}

/// A question, of a band counted from 0; `None`: the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Question {
    /// What is asked.
    pub asked: Asked,
    /// Of which band.
    pub band: Option<usize>,
}

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Found {
    /// Of a place of the image; `None`: it shows no surface.
    Ground(Option<Ground>),
    /// Of a point of the ground; `None`: it is never before the camera.
    Place(Option<Seen>),
}

/// A longer table is refused, bytes.
const LONGEST: u64 = 1 << 31;
/// Columns of questions: places, or points.
const PIXELS: [&str; 2] = ["sample", "line"];
const POINTS: [&str; 3] = ["x_m", "y_m", "z_m"];

/// Reads questions: a header `sample,line` or `x_m,y_m,z_m`, and where it matters `band`, counted from 1; then a row for each.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with every cell that is not a number, and for a header of something else.
pub fn read(path: &Path) -> Result<Vec<Question>> {
    let text = input::text(path, LONGEST)?.0;
    let mut lines = text.lines().filter(|line| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    let Some(header) = lines.next() else {
        return Err(Error::invalid(
            Location::file(path),
            "no rows: a header, `sample,line` or `x_m,y_m,z_m`, then points",
        ));
    };
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let column = |name: &str| names.iter().position(|of| of.eq_ignore_ascii_case(name));
    let all = |wanted: &[&str]| wanted.iter().map(|name| column(name)).collect::<Option<Vec<usize>>>();
    let (columns, is_pixel) = match (all(&PIXELS), all(&POINTS)) {
        (Some(columns), None) => (columns, true),
        (None, Some(columns)) => (columns, false),
        _ => {
            let message = "the header has neither columns sample, line nor columns x_m, y_m, z_m";
            return Err(Error::invalid(place(path, &text, header), message));
        }
    };
    let band = column("band");
    let mut problems = Problems::default();
    let mut questions = Vec::new();
    for line in lines {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let mut number = |i: usize| -> Option<f64> {
            let cell = cells.get(i).copied().unwrap_or("");
            let value = cell.parse::<f64>().ok().filter(|x| x.is_finite());
            if value.is_none() {
                let of = if cell.is_empty() { line } else { cell };
                problems.push(|| {
                    Problem::new(place(path, &text, of), format!("{} is not a finite number: `{cell}`", names[i]))
                });
            }
            value
        };
        let values: Option<Vec<f64>> = columns.iter().map(|i| number(*i)).collect();
        let of_band = match band.map(&mut number) {
            None => Some(None),
            Some(Some(value)) if value >= 1.0 && value.fract() == 0.0 && value < 1e9 => {
                Some(Some(crate::geometry::whole(value) - 1))
            }
            Some(Some(value)) => {
                problems.push(|| Problem::new(place(path, &text, line), format!("band {value}: bands count from 1")));
                None
            }
            Some(None) => None,
        };
        if let (Some(values), Some(band)) = (values, of_band) {
            let asked = match is_pixel {
                true => Asked::Pixel(Place { sample: values[0], line: values[1] }),
                false => Asked::Ground(DVec3::new(values[0], values[1], values[2])),
            };
            questions.push(Question { asked, band });
        }
    }
    problems.finish(path)?;
    Ok(questions)
}

/// Names of the columns of what is found; cells that do not apply are empty.
pub const COLUMNS: &str =
    "sample,line,band,tdb_s,x_m,y_m,z_m,latitude_deg,longitude_deg,range_m,facet,emission_deg,inside,hidden_by,reason";

/// A row of what was found for a question of a band counted from 0.
pub fn row(question: &Question, band: usize, found: &Found) -> String {
    let mut text = String::new();
    let time = |epoch: Option<Epoch>| epoch.map_or(String::new(), |epoch| epoch.tdb_s().to_string());
    let band = band + 1;
    let _ = match (question.asked, found) {
        (Asked::Pixel(Place { sample, line }), Found::Ground(Some(ground))) => {
            let (p, [latitude, longitude]) = (ground.point_m, ground.latitude_longitude_deg());
            let (time, emission) = (time(ground.epoch), ground.local_emission_rad.to_degrees());
            let Ground { range_m, facet, .. } = ground;
            write!(
                text,
                "{sample},{line},{band},{time},{},{},{},{latitude},{longitude},{range_m},{facet},{emission},,,",
                p.x, p.y, p.z
            )
        }
        (Asked::Pixel(Place { sample, line }), _) => {
            write!(text, "{sample},{line},{band},,,,,,,,,,,,outside the image or sky")
        }
        (Asked::Ground(p), Found::Place(Some(seen))) => {
            let Place { sample, line } = seen.place;
            let hidden = seen.hidden_by.map_or(String::new(), |facet| facet.to_string());
            let time = time(seen.epoch);
            let reason = match (seen.inside, seen.hidden_by) {
                (false, _) => "outside the image",
                (true, Some(_)) => "hidden by that facet",
                (true, None) => "",
            };
            write!(
                text,
                "{sample},{line},{band},{time},{},{},{},,,{},,,{},{hidden},{reason}",
                p.x, p.y, p.z, seen.range_m, seen.inside
            )
        }
        (Asked::Ground(p), _) => write!(text, ",,{band},,{},{},{},,,,,,false,,never before the camera", p.x, p.y, p.z),
    };
    text
}
