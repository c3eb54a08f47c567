//! Facts of a product's table of exposures: epochs, gaps, and how fast the image drifted.

use std::path::Path;

use super::flight_facts::{Steps, median};
use crate::error::{Error, Location, Result};
use crate::formats::exposures_csv::{self, Row};
use crate::formats::raster::Raster;
use crate::formats::registry;
use crate::geometry::turn_rad;

/// What an exposure takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// The whole image.
    All,
    /// A band.
    Band,
    /// A line.
    Line,
    /// A sample.
    Sample,
}

impl Takes {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Takes::All => "all",
            Takes::Band => "a band",
            Takes::Line => "a line",
            Takes::Sample => "a sample",
        }
    }
}

/// Facts of such a table.
#[derive(Debug, Clone, PartialEq)]
pub struct ExposureFacts {
    /// What each exposure takes.
    pub takes: Takes,
    /// How many there are.
    pub exposures: usize,
    /// Middles of the first and of the last, TDB.
    pub ends: [String; 2],
    /// Between those, s.
    pub span_s: f64,
    /// Steps between exposures, if there are two; for a whisk-broom within a sweep.
    pub steps: Option<Steps>,
    /// For a whisk-broom: steps from the end of a sweep to the start of the next.
    pub between_sweeps: Option<Steps>,
    /// Gaps: after which exposure, from 0, and how long, s.
    pub gaps: Vec<(usize, f64)>,
    /// How fast the camera goes in the frame of the body, m/s, and turns in it, rad/s: medians over steps.
    pub moves: Option<[f64; 2]>,
    /// Drift of the image, samples and lines per second, if files beside the table give it.
    pub drift_px_s: Option<Drift>,
}

/// Drift of an image, pixels per second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Samples, and lines: from the first exposure to the last.
    pub mean: [f64; 2],
    /// The most from one exposure to the next, in either direction.
    pub most: f64,
}

/// A gap: longer than GAP times the (lower) median step.
const GAP: f64 = 1.5;

/// What a table of exposures says; `displacement.img` and `backplanes.img` beside it tell the drift.
///
/// # Errors
/// Those of its reader; [`Error::Invalid`] if an image beside it is not one of these exposures.
pub fn exposure_facts(path: &Path) -> Result<ExposureFacts> {
    let rows = exposures_csv::read(path)?;
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return Err(Error::invalid(Location::file(path), "has no rows"));
    };
    let takes = takes(&rows);
    let begins_sweep = |two: &[Row]| two[1].sample.is_some() && two[1].lines != two[0].lines;
    let (mut steps, mut between) = (Vec::new(), Vec::new());
    for (i, two) in rows.windows(2).enumerate() {
        let to = if begins_sweep(two) { &mut between } else { &mut steps };
        to.push((i, two[1].tdb_s - two[0].tdb_s));
    }
    let mut gaps: Vec<(usize, f64)> = [&steps, &between]
        .into_iter()
        .flat_map(|steps| {
            let mut sorted: Vec<f64> = steps.iter().map(|(_, s)| *s).collect();
            sorted.sort_by(f64::total_cmp);
            let usual_s = sorted.get(sorted.len().saturating_sub(1) / 2).copied().unwrap_or(0.0);
            steps.iter().copied().filter(move |(_, s)| *s > GAP * usual_s)
        })
        .collect();
    gaps.sort_by_key(|(i, _)| *i);
    let folder = path.parent().unwrap_or(Path::new(""));
    let drift_px_s = match takes {
        Takes::Band => of_bands(&folder.join("displacement.img"), &rows)?,
        Takes::Line => of_lines(&folder.join("backplanes.img"), &rows)?,
        Takes::All | Takes::Sample => None,
    };
    Ok(ExposureFacts {
        takes,
        exposures: rows.len(),
        ends: [first.middle.clone(), last.middle.clone()],
        span_s: last.tdb_s - first.tdb_s,
        steps: of_steps(&steps),
        between_sweeps: of_steps(&between),
        gaps,
        moves: moves(&rows),
        drift_px_s,
    })
}

fn takes(rows: &[Row]) -> Takes {
    let differ = |by: fn(&Row) -> &std::ops::Range<usize>| rows.iter().any(|row| by(row) != by(&rows[0]));
    if rows[0].sample.is_some() {
        Takes::Sample
    } else if differ(|row| &row.bands) {
        Takes::Band
    } else if differ(|row| &row.lines) {
        Takes::Line
    } else {
        Takes::All
    }
}

fn of_steps(steps: &[(usize, f64)]) -> Option<Steps> {
    Steps::of(steps.iter().map(|(_, s)| *s).collect())
}

fn moves(rows: &[Row]) -> Option<[f64; 2]> {
    let rates = |by: &dyn Fn(&Row, &Row) -> f64| {
        median(rows.windows(2).map(|two| by(&two[0], &two[1]) / (two[1].tdb_s - two[0].tdb_s)).collect())
    };
    Some([
        rates(&|a, b| (b.position_m - a.position_m).length())?,
        rates(&|a, b| turn_rad(a.body_from_sensor, b.body_from_sensor))?,
    ])
}

/// An image beside the table, if it is there.
fn beside(path: &Path) -> Result<Option<Raster>> {
    if path.is_file() { registry::image(path).map(Some) } else { Ok(None) }
}

/// For a filter: differences of the band displacements, averaged over pixels that both show.
fn of_bands(path: &Path, rows: &[Row]) -> Result<Option<Drift>> {
    let Some(mut image) = beside(path)? else { return Ok(None) };
    if image.bands.len() != 2 * rows.len() {
        let message = format!(
            "has {} planes but exposures.csv has {} exposures: two planes each are expected",
            image.bands.len(),
            rows.len()
        );
        return Err(Error::invalid(Location::file(path), message));
    }
    let mut read = |exposure: usize| -> Result<[Vec<f64>; 2]> {
        let mut planes: [Vec<f64>; 2] = Default::default();
        for (axis, plane) in planes.iter_mut().enumerate() {
            image.read(2 * exposure + axis, plane)?;
        }
        Ok(planes)
    };
    let first = read(0)?;
    let mut before = first.clone();
    let (mut whole, mut most) = (None, None::<f64>);
    for (i, two) in rows.windows(2).enumerate() {
        let now = read(i + 1)?;
        if let Some(rate) = rate(&before, &now, two[1].tdb_s - two[0].tdb_s) {
            most = Some(rate[0].hypot(rate[1]).max(most.unwrap_or(0.0)));
        }
        whole = rate(&first, &now, two[1].tdb_s - rows[0].tdb_s);
        before = now;
    }
    Ok(whole.zip(most).map(|(mean, most)| Drift { mean, most }))
}

/// The mean difference of displacements over a time, pixels a second; `None` if there is no pixel that has both.
fn rate(from: &[Vec<f64>; 2], to: &[Vec<f64>; 2], s: f64) -> Option<[f64; 2]> {
    let along = |axis: usize| {
        let both = from[axis].iter().zip(&to[axis]).map(|(from, to)| to - from).filter(|moved| moved.is_finite());
        let (sum, count) = both.fold((0.0, 0.0), |(sum, count), moved| (sum + moved, count + 1.0));
        (count > 0.0).then(|| sum / count / s)
    };
    Some([along(0)?, along(1)?])
}

/// For a push-broom: how far the ground in the middle of each line lies from that in the line before, over how far it is from line to line at one moment. Which way
/// that is nothing tells; along a slit it does not go if lines are to make an image.
fn of_lines(path: &Path, rows: &[Row]) -> Result<Option<Drift>> {
    let Some(mut image) = beside(path)? else { return Ok(None) };
    if image.rows != rows.len() {
        let message = format!("has {} lines but exposures.csv has {} exposures", image.rows, rows.len());
        return Err(Error::invalid(Location::file(path), message));
    }
    let named = |name: &str| image.bands.iter().position(|band| band.name.split_whitespace().next() == Some(name));
    let planes: Option<Vec<usize>> =
        ["BODYFIXEDX", "BODYFIXEDY", "BODYFIXEDZ", "GSD_LINE"].into_iter().map(named).collect();
    let Some(planes) = planes else { return Ok(None) };
    let middle = image.columns / 2;
    let mut values: [Vec<f64>; 4] = Default::default();
    for (plane, values) in planes.into_iter().zip(&mut values) {
        let mut all = Vec::new();
        image.read(plane, &mut all)?;
        values.extend(all.chunks_exact(image.columns).map(|line| line[middle]));
    }
    let [x, y, z, gsd_m] = &values;
    // Lines that show no ground in their middle have zeros, or no numbers.
    let shows = |line: usize| gsd_m[line] > 0.0 && [x, y, z].iter().all(|axis| axis[line].is_finite());
    let moved_px = |a: usize, b: usize| {
        let way_m = [x, y, z].iter().map(|axis| (axis[b] - axis[a]).powi(2)).sum::<f64>().sqrt();
        way_m / f64::midpoint(gsd_m[a], gsd_m[b])
    };
    let seen: Vec<usize> = (0..rows.len()).filter(|line| shows(*line)).collect();
    let rates: Vec<f64> =
        seen.windows(2).map(|two| moved_px(two[0], two[1]) / (rows[two[1]].tdb_s - rows[two[0]].tdb_s)).collect();
    let (Some(first), Some(last)) = (seen.first(), seen.last()) else { return Ok(None) };
    let most = rates.iter().copied().reduce(f64::max);
    Ok(most.map(|most| {
        let way_px: f64 = seen.windows(2).map(|two| moved_px(two[0], two[1])).sum();
        Drift { mean: [0.0, way_px / (rows[*last].tdb_s - rows[*first].tdb_s)], most }
    }))
}
