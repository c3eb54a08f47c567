//! Heights from a raster: cropped, resampled, amplified, and repeated at a smaller scale.

use crate::error::number;
use crate::geometry::{whole, whole_u32};
use crate::landscape::recipe::Relief;
use crate::landscape::sources::Sources;

/// Heights of a raster on the ground. Beyond its border it goes on as in a mirror, so that there is no step.
#[derive(Debug, Clone)]
pub(in crate::landscape) struct Elevation {
    /// Halved again and again, for steps that are wider than pixels: each is the mean of four pixels of the one before.
    levels: Vec<Level>,
    /// Pixels from metres.
    per_m: f64,
    /// East and north in the raster's axes: cosine and sine of its turn.
    turn: [f64; 2],
    /// How many times it is there, each time `ratio` smaller and its heights smaller by `shrink`.
    times: u32,
    ratio: f64,
    shrink: f64,
}

/// Heights at the middles of pixels, m, with the mean 0.
#[derive(Debug, Clone)]
struct Level {
    columns: usize,
    rows: usize,
    heights_m: Vec<f64>,
}

impl Elevation {
    /// # Errors
    /// The key that cannot be used, and why.
    pub(in crate::landscape) fn new(
        relief: &Relief,
        size_m: f64,
        sources: &Sources,
    ) -> Result<Self, (&'static str, String)> {
        let Relief::Elevation { file, crop, pixel_m, width_m, height_m, amplify, repeat, ratio, hurst, turn_deg } =
            relief
        else {
            return Err(("kind", "is not an elevation model".into()));
        };
        let Some(source) = sources.rasters.get(file) else { return Err(("file", format!("{file} has not been read"))) };
        let [first_column, first_row, columns, rows] =
            crop.unwrap_or([0, 0, whole_u32(source.columns as f64), whole_u32(source.rows as f64)]).map(|n| n as usize);
        if columns < 2 || rows < 2 || first_column + columns > source.columns || first_row + rows > source.rows {
            let message = format!(
                "{columns} x {rows} pixels from column {first_column}, line {first_row}: the file has {} x {}, and at least 2 x 2 are needed",
                source.columns, source.rows
            );
            return Err((if crop.is_some() { "crop" } else { "file" }, message));
        }
        let mut heights = Vec::with_capacity(columns * rows);
        for row in first_row..first_row + rows {
            heights.extend_from_slice(&source.values[row * source.columns + first_column..][..columns]);
        }
        if let Some(hole) = heights.iter().position(|h| !h.is_finite()) {
            let holes = heights.iter().filter(|h| !h.is_finite()).count();
            let message = format!(
                "{holes} of {} pixels of {file} have no height, the first in column {}, line {} (counted from 0): crop a part without holes, or fill them",
                heights.len(),
                first_column + hole % columns,
                first_row + hole / columns
            );
            return Err((if crop.is_some() { "crop" } else { "file" }, message));
        }
        let (lowest, highest) = heights.iter().fold((f64::MAX, f64::MIN), |(lo, hi), h| (lo.min(*h), hi.max(*h)));
        let in_field_m = match (pixel_m, source.pixel_m) {
            (Some(pixel_m), _) => Some([*pixel_m; 2]),
            (None, found) => found,
        };
        // Pixels that are not square are taken as they lie.
        if let Some([x_m, y_m]) = in_field_m
            && !(0.999..1.001).contains(&(x_m / y_m))
        {
            return Err((
                "file",
                format!("its pixels are {x_m} x {y_m} m: resample it to square ones, or give pixel_m"),
            ));
        }
        let width_m = width_m.unwrap_or(size_m);
        let scale = match (height_m, in_field_m) {
            (Some(_), _) if highest == lowest => 0.0,
            (Some(height_m), _) => height_m / (highest - lowest),
            (None, Some([pixel_m, _])) => width_m / (columns as f64 * pixel_m),
            (None, None) => {
                let size = match source.pixel_deg {
                    Some([width, height]) => format!(
                        "has pixels of {} x {} deg, and does not say how wide those are",
                        number(width),
                        number(height)
                    ),
                    None => "does not say how wide its pixels are".into(),
                };
                let message = format!("{file} {size}: give `pixel_m`, or the range of heights as `height_m`");
                return Err(("file", message));
            }
        };
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        for height in &mut heights {
            *height = amplify * scale * (*height - mean);
        }
        let mut levels = vec![Level { columns, rows, heights_m: heights }];
        while let Some(half) = levels.last().and_then(Level::halved) {
            levels.push(half);
        }
        let (sin, cos) = turn_deg.to_radians().sin_cos();
        Ok(Elevation {
            levels,
            per_m: columns as f64 / width_m,
            turn: [cos, sin],
            times: 1 + repeat,
            ratio: *ratio,
            shrink: ratio.powf(-hurst),
        })
    }

    /// Height, m.
    pub(in crate::landscape) fn height_m(&self, x_m: f64, y_m: f64, step_m: f64) -> f64 {
        let [cos, sin] = self.turn;
        let (east_m, north_m) = (cos * x_m + sin * y_m, cos * y_m - sin * x_m);
        let (mut per_m, mut share, mut height_m) = (self.per_m, 1.0, 0.0);
        for _ in 0..self.times {
            // The level whose pixels are about as wide as a step.
            let level = (per_m * step_m).log2().round().max(0.0);
            let level = &self.levels[whole(level).min(self.levels.len() - 1)];
            let scale = |count: usize, of: usize| per_m * count as f64 / of as f64;
            let (across, down) = (scale(level.columns, self.levels[0].columns), scale(level.rows, self.levels[0].rows));
            height_m += share * level.height_m(east_m * across, -north_m * down);
            per_m *= self.ratio;
            share *= self.shrink;
        }
        height_m
    }
}

impl Level {
    /// The same with half as many pixels each way, of which each is the mean of what it covers; none if that leaves fewer than four.
    fn halved(&self) -> Option<Level> {
        let (columns, rows) = (self.columns / 2, self.rows / 2);
        if columns < 4 || rows < 4 {
            return None;
        }
        let lines = shrunk(&self.heights_m, self.columns, columns, |i, j| j * self.columns + i, self.rows);
        let heights_m = shrunk(&lines, self.rows, rows, |j, i| j * columns + i, columns);
        // The second pass went column by column.
        let heights_m =
            (0..rows).flat_map(|j| (0..columns).map(move |i| i * rows + j)).map(|at| heights_m[at]).collect();
        Some(Level { columns, rows, heights_m })
    }

    /// Height so many pixels east and south of the middle: cubic between the middles of pixels (R. Keys 1981, "Cubic convolution interpolation for digital
    /// image processing", IEEE Trans. ASSP 29: a = -1/2), which is smooth and keeps the pixels' own heights.
    fn height_m(&self, east: f64, south: f64) -> f64 {
        let (x, y) = (east + 0.5 * self.columns as f64 - 0.5, south + 0.5 * self.rows as f64 - 0.5);
        let (i, j) = (x.floor(), y.floor());
        let (wx, wy) = (weights(x - i), weights(y - j));
        let columns = [-1.0, 0.0, 1.0, 2.0].map(|d| mirrored(i + d, self.columns));
        let row = |d: f64| {
            let row = mirrored(j + d, self.rows) * self.columns;
            columns.iter().zip(wx).map(|(column, w)| w * self.heights_m[row + column]).sum::<f64>()
        };
        wy[0] * row(-1.0) + wy[1] * row(0.0) + wy[2] * row(1.0) + wy[3] * row(2.0)
    }
}

/// Rows of `from` values, each shrunk to `to` means over equal parts; value i of row j is at `at(i, j)`, results row by row.
fn shrunk(values: &[f64], from: usize, to: usize, at: impl Fn(usize, usize) -> usize, rows: usize) -> Vec<f64> {
    let part = from as f64 / to as f64;
    let mut means = Vec::with_capacity(rows * to);
    for j in 0..rows {
        for i in 0..to {
            let (begin, end) = (part * i as f64, part * (i + 1) as f64);
            let covered = |k: usize| ((k + 1) as f64).min(end) - (k as f64).max(begin);
            let sum: f64 = (whole(begin)..from.min(whole(end.ceil()))).map(|k| covered(k) * values[at(k, j)]).sum();
            means.push(sum / part);
        }
    }
    means
}

/// Weights of the four pixels around a place, at `t` between the middle two.
fn weights(t: f64) -> [f64; 4] {
    [
        -0.5 * t * (1.0 - t) * (1.0 - t),
        1.0 + t * t * (1.5 * t - 2.5),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        -0.5 * t * t * (1.0 - t),
    ]
}

/// The pixel that number `n` is, if the row goes on as in a mirror at both ends.
fn mirrored(n: f64, count: usize) -> usize {
    let period = 2.0 * count as f64;
    let place = n.rem_euclid(period);
    whole(if place < count as f64 { place } else { period - 1.0 - place }).min(count - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::sources::Source;

    fn sources(columns: usize, rows: usize, height: impl Fn(f64, f64) -> f64, pixel_m: Option<[f64; 2]>) -> Sources {
        let values = (0..rows).flat_map(|j| (0..columns).map(move |i| (i as f64, j as f64))).map(|(i, j)| height(i, j));
        let source = Source { columns, rows, values: values.collect(), pixel_m, pixel_deg: None, full_scale: None };
        Sources { rasters: [("dem".to_owned(), source)].into(), ..Sources::default() }
    }

    fn sources_of_slope() -> Sources {
        sources(101, 51, |i, j| 0.3 * i - 0.7 * j, Some([1.0, 1.0]))
    }

    fn relief(text: &str) -> Relief {
        toml::from_str(&format!("kind = \"elevation\"\nfile = \"dem\"\n{text}")).unwrap()
    }

    #[test]
    fn a_slope_stays_a_slope_wherever_it_is_put() {
        // 100 x 60 pixels of 50 m that rise by 10 m a pixel to the east and by 5 m to the south: 0.2 and 0.1.
        let sources = sources(100, 60, |i, j| 10.0 * i + 5.0 * j, Some([50.0, 50.0]));
        for (text, factor) in [("", 1.0), ("amplify = 3.0", 3.0), ("width_m = 500.0", 1.0), ("height_m = 642.5", 0.5)] {
            let dem = Elevation::new(&relief(text), 5000.0, &sources).unwrap();
            let at = |x_m: f64, y_m: f64| dem.height_m(x_m, y_m, 0.5);
            assert!(at(0.0, 0.0).abs() < 1e-9, "{text}");
            // Cubic convolution is exact on planes.
            assert!((at(100.0, 0.0) - factor * 20.0).abs() < 1e-9, "{text} {}", at(100.0, 0.0));
            assert!((at(0.0, 70.0) + factor * 7.0).abs() < 1e-9, "{text}");
        }
        // Turned by a quarter: what rose to the east rises to the north.
        let dem = Elevation::new(&relief("turn_deg = 90.0"), 5000.0, &sources).unwrap();
        assert!((dem.height_m(0.0, 100.0, 0.5) - 20.0).abs() < 1e-9);
        // Half of the columns, on all of the site: heights shrink or grow with the width.
        let dem = Elevation::new(&relief("crop = [50, 0, 50, 60]"), 5000.0, &sources).unwrap();
        assert!((dem.height_m(100.0, 0.0, 0.5) - 20.0).abs() < 1e-9);
    }

    #[test]
    fn beyond_its_border_it_is_mirrored_and_repeats_are_smaller() {
        let sources = sources(64, 64, |i, j| (0.3 * i).sin() * 9.0 + (0.2 * j).cos() * 4.0, Some([1.0, 1.0]));
        let once = Elevation::new(&relief(""), 64.0, &sources).unwrap();
        for (x_m, y_m) in [(3.0, 5.0), (31.0, -30.5), (-12.25, 17.0)] {
            assert!((once.height_m(64.0 - x_m, y_m, 0.1) - once.height_m(x_m, y_m, 0.1)).abs() < 1e-9);
            assert!((once.height_m(x_m, -64.0 - y_m, 0.1) - once.height_m(x_m, y_m, 0.1)).abs() < 1e-9);
        }
        let twice = Elevation::new(&relief("repeat = 1\nratio = 4.0\nhurst = 0.5"), 64.0, &sources).unwrap();
        let (x_m, y_m) = (3.0, 5.0);
        let expected_m = once.height_m(x_m, y_m, 0.1) + 0.5 * once.height_m(4.0 * x_m, 4.0 * y_m, 0.1);
        assert!((twice.height_m(x_m, y_m, 0.1) - expected_m).abs() < 1e-9);
    }

    #[test]
    fn coarse_grids_see_means() {
        // Pixels +1 and -1 by turns: on steps of two pixels and more nothing is left.
        let sources = sources(64, 64, |i, _| if i % 2.0 == 0.0 { 1.0 } else { -1.0 }, Some([1.0, 1.0]));
        let dem = Elevation::new(&relief(""), 64.0, &sources).unwrap();
        assert!((dem.height_m(0.5, 0.5, 0.5).abs() - 1.0).abs() < 1e-9);
        assert!(dem.height_m(0.5, 0.5, 2.0).abs() < 1e-12);
        // Odd numbers of pixels: parts hold shares of pixels, so that a slope of 0.3 and 0.7 a pixel comes back to an eighth of a pixel.
        let odd = sources_of_slope();
        let dem = Elevation::new(&relief(""), 101.0, &odd).unwrap();
        assert!((dem.height_m(20.0, 10.0, 2.0) - dem.height_m(20.0, 10.0, 0.5)).abs() < 0.125);
    }

    #[test]
    fn holes_and_what_is_not_known_are_told() {
        let holed = sources(10, 10, |i, j| if (i, j) == (7.0, 3.0) { f64::NAN } else { i }, Some([1.0, 1.0]));
        let (key, message) = Elevation::new(&relief(""), 10.0, &holed).unwrap_err();
        assert!(
            key == "file" && message.contains("1 of 100 pixels") && message.contains("column 7, line 3"),
            "{message}"
        );
        assert!(Elevation::new(&relief("crop = [0, 0, 7, 10]"), 10.0, &holed).is_ok());
        let (key, _) = Elevation::new(&relief("crop = [4, 0, 7, 10]"), 10.0, &holed).unwrap_err();
        assert_eq!(key, "crop");
        let unknown = sources(10, 10, |i, _| i, None);
        let (_, message) = Elevation::new(&relief(""), 10.0, &unknown).unwrap_err();
        assert!(message.contains("pixel_m") && message.contains("height_m"), "{message}");
        assert!(Elevation::new(&relief("height_m = 3.0"), 10.0, &unknown).is_ok());
        assert!(Elevation::new(&relief(""), 10.0, &sources(10, 10, |i, _| i, Some([1.0, 2.0]))).is_err());
    }
}
