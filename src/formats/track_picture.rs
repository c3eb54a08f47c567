//! A drawing of what moves or turns: its track on a map of directions, and numbers over time below.

use std::path::Path;

use super::drawing::{Anchor, Colour, Drawing, Mark};
use super::folder::Staged;
use super::quicklook::png_bytes;
use super::spectrum_svg::{range, ticks};
use crate::error::{Error, Location, Problem, Result};

/// Points of a line that may break: where nothing is known.
pub type Broken = Vec<Vec<[f64; 2]>>;

/// What is drawn of one thing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Track {
    /// Its name.
    pub name: String,
    /// Longitudes (or right ascensions), 0 to 360 deg, and latitudes (or declinations).
    pub map: Broken,
    /// Hours after the first moment, and values, for each of the sheet's quantities.
    pub series: Vec<Broken>,
}

/// Tracks that are drawn together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrackSheet {
    /// What it is of.
    pub title: String,
    /// What is across and upwards in the map.
    pub map_labels: [String; 2],
    /// The quantities over time, with their units.
    pub quantities: Vec<String>,
    /// When time begins.
    pub begins: String,
    /// The tracks.
    pub tracks: Vec<Track>,
}

/// Width of all, and of the margins left and right, px.
const WIDTH: f64 = 860.0;
const LEFT: f64 = 84.0;
const RIGHT: f64 = 24.0;
/// Above the map, from one plot to the next, and height of a plot over time, px.
const TOP: f64 = 56.0;
const BETWEEN: f64 = 52.0;
const HEIGHT: f64 = 140.0;
const COLOURS: [Colour; 4] = [[27, 58, 92], [184, 100, 11], [34, 120, 60], [150, 30, 60]];
const GRID: Colour = [221; 3];
const INK: Colour = [40; 3];
/// Pixels of a PNG for a px of the drawing.
const SCALE: f64 = 2.0;

/// Values that differ by less than this share of themselves are drawn as one.
const SAME: f64 = 1e-6;

/// Where values lie in a plot.
struct Plot {
    /// Left, top, right and bottom, px.
    frame: [f64; 4],
    x: (f64, f64),
    y: (f64, f64),
}

impl Plot {
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, top, right, bottom] = self.frame;
        [
            left + (x - self.x.0) / (self.x.1 - self.x.0) * (right - left),
            bottom - (y - self.y.0) / (self.y.1 - self.y.0) * (bottom - top),
        ]
    }

    /// With these ticks across and upwards.
    fn axes(&self, drawing: &mut Drawing, [across, along]: [&[(f64, String)]; 2], labels: [&str; 2]) {
        let [left, top, right, bottom] = self.frame;
        for (x, said) in across {
            let [px, _] = self.at([*x, self.y.0]);
            drawing.line(&[[px, top], [px, bottom]], GRID, 1.0, 1.0);
            drawing.text([px, bottom + 16.0], Anchor::Middle, 12.0, INK, said);
        }
        for (y, said) in along {
            let [_, py] = self.at([self.x.0, *y]);
            drawing.line(&[[left, py], [right, py]], GRID, 1.0, 1.0);
            drawing.text([left - 6.0, py + 4.0], Anchor::End, 12.0, INK, said);
        }
        drawing.line(&[[left, top], [left, bottom], [right, bottom]], INK, 1.0, 1.0);
        drawing.text([0.5 * (left + right), bottom + 34.0], Anchor::Middle, 12.0, INK, labels[0]);
        drawing.text_upwards([20.0, 0.5 * (top + bottom)], 12.0, INK, labels[1]);
    }

    fn lines(&self, drawing: &mut Drawing, lines: &Broken, colour: Colour) {
        for line in lines {
            let points: Vec<[f64; 2]> = line.iter().map(|point| self.at(*point)).collect();
            drawing.line(&points, colour, 1.6, 1.0);
        }
    }
}

/// The range of an axis: of values that are the same but for rounding a tenth around them, which would else fill all of it.
fn values_range(values: &[f64]) -> (f64, f64) {
    let (low, high) = range(values.iter().copied());
    let size = low.abs().max(high.abs());
    if high - low > SAME * size { (low, high) } else { (low - 0.1 * size, high + 0.1 * size) }
}

/// A way over longitudes, broken where it goes over their seam.
pub fn unwrapped(points: impl Iterator<Item = [f64; 2]>) -> Broken {
    let mut lines: Broken = vec![vec![]];
    let mut before: Option<[f64; 2]> = None;
    for point in points {
        if before.is_some_and(|before| (point[0] - before[0]).abs() > 180.0) {
            lines.push(vec![]);
        }
        lines.last_mut().into_iter().for_each(|line| line.push(point));
        before = Some(point);
    }
    lines
}

fn draw(sheet: &TrackSheet) -> Drawing {
    let map_height = 0.5 * (WIDTH - LEFT - RIGHT);
    let height = TOP + map_height + BETWEEN + sheet.quantities.len() as f64 * (HEIGHT + BETWEEN);
    let mut drawing = Drawing::new(WIDTH, height);
    drawing.bold([LEFT, 24.0], Anchor::Start, 15.0, INK, &sheet.title);
    let mut x = LEFT;
    for (i, track) in sheet.tracks.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        drawing.line(&[[x, 41.0], [x + 20.0, 41.0]], colour, 2.0, 1.0);
        drawing.text([x + 26.0, 45.0], Anchor::Start, 12.0, INK, &track.name);
        x += 44.0 + super::drawing::text_width(&track.name, 12.0, false);
    }
    let map = Plot { frame: [LEFT, TOP, WIDTH - RIGHT, TOP + map_height], x: (0.0, 360.0), y: (-90.0, 90.0) };
    let degrees = |from: i32, to: i32, step: i32| -> Vec<(f64, String)> {
        (from..=to).step_by(step.unsigned_abs() as usize).map(|deg| (f64::from(deg), deg.to_string())).collect()
    };
    let labels = [sheet.map_labels[0].as_str(), sheet.map_labels[1].as_str()];
    map.axes(&mut drawing, [&degrees(0, 360, 60), &degrees(-90, 90, 30)], labels);
    for (i, track) in sheet.tracks.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        map.lines(&mut drawing, &track.map, colour);
        if let Some(first) = track.map.first().and_then(|line| line.first()) {
            drawing.mark(map.at(*first), Mark::Disc, 5.0, colour);
        }
    }
    let times = || sheet.tracks.iter().flat_map(|track| track.series.iter().flatten().flatten()).map(|point| point[0]);
    let hours = range(times());
    let from_start = format!("hours after {}", sheet.begins);
    for (k, quantity) in sheet.quantities.iter().enumerate() {
        let top = TOP + map_height + BETWEEN + k as f64 * (HEIGHT + BETWEEN);
        let of = |track: &Track| track.series.get(k).cloned().unwrap_or_default();
        let values: Vec<f64> = sheet.tracks.iter().flat_map(of).flatten().map(|point| point[1]).collect();
        let values = values_range(&values);
        let plot = Plot { frame: [LEFT, top, WIDTH - RIGHT, top + HEIGHT], x: hours, y: values };
        plot.axes(&mut drawing, [&ticks(hours.0, hours.1), &ticks(values.0, values.1)], [&from_start, quantity]);
        for (i, track) in sheet.tracks.iter().enumerate() {
            plot.lines(&mut drawing, &of(track), COLOURS[i % COLOURS.len()]);
        }
    }
    drawing
}

/// Writes the drawing as `.svg` or `.png`, by its name.
///
/// # Errors
/// [`Error::Invalid`] for another ending, or if what it is made from would be replaced; those of [`Staged::file`]; [`Error::Io`].
pub fn write(sheet: &TrackSheet, target: &Path, replace: bool, input: &Path) -> Result<()> {
    let ending = target.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
    let drawing = draw(sheet);
    let bytes = match ending.as_deref() {
        Some("svg") => drawing.svg().into_bytes(),
        Some("png") => {
            let too_large = || Error::invalid(Location::file(target), "the drawing is too large");
            let (rgb, size) = drawing.rgb(SCALE).ok_or_else(too_large)?;
            png_bytes(size, png::ColorType::Rgb, &rgb)
        }
        _ => {
            let problem = Problem::new(Location::file(target), "tracks are drawn as SVG or PNG");
            return Err(Error::Invalid(vec![problem.with_help("give it a name that ends in .svg or .png")]));
        }
    };
    let staged = Staged::file(target, replace)?;
    staged.spares([input])?;
    staged.put(staged.path(), |out| std::io::Write::write_all(out, &bytes))?;
    staged.commit()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_over_the_seam_is_broken_there() {
        let lines = unwrapped([[350.0, 0.0], [358.0, 1.0], [4.0, 2.0], [9.0, 3.0]].into_iter());
        assert_eq!(lines, [vec![[350.0, 0.0], [358.0, 1.0]], vec![[4.0, 2.0], [9.0, 3.0]]]);
    }

    #[test]
    fn a_value_lies_where_its_axes_say() {
        let plot = Plot { frame: [100.0, 50.0, 300.0, 150.0], x: (0.0, 360.0), y: (-90.0, 90.0) };
        assert_eq!(plot.at([180.0, 0.0]), [200.0, 100.0]);
        assert_eq!(plot.at([0.0, 90.0]), [100.0, 50.0]);
        assert_eq!(values_range(&[40.0, 40.0 + 1e-9, 40.0 - 1e-9]).0.round(), 36.0);
        assert_eq!(values_range(&[0.0, 3.0]), (0.0, 3.0));
        // Nothing at all is a drawing too.
        assert!(!draw(&TrackSheet { quantities: vec!["km".into()], ..TrackSheet::default() }).svg().contains("NaN"));
    }
}
