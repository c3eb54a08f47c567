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
    /// Longitudes (or right ascensions), 0 to 360 deg, and latitudes (or declinations), of each time that is known.
    pub map: Broken,
    /// Hours after the first moment, and values, for each of the sheet's quantities.
    pub series: Vec<Broken>,
}

/// What is drawn over time.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Quantity {
    /// Its name, with its unit.
    pub label: String,
    /// Said in its place where no track has any.
    pub unknown: &'static str,
}

/// Tracks that are drawn together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrackSheet {
    /// What it is of.
    pub title: String,
    /// What is across and upwards in the map.
    pub map_labels: [String; 2],
    /// The quantities over time.
    pub quantities: Vec<Quantity>,
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

/// What is less wide than this is drawn this wide, deg.
const NARROWEST: f64 = 0.1;
/// A map that would be wider than this is one of all directions, deg.
const WIDEST: f64 = 180.0;
/// How much wider a map is than what it shows.
const AROUND: f64 = 1.25;
/// Times at which nothing is known are drawn this wide, px, if they are longer than this share of all that are known.
const CUT: f64 = 54.0;
const LONG: f64 = 0.5;
/// More cuts would leave no room.
const MOST_CUTS: usize = 4;

/// An axis in pieces: where each begins and ends, and its px.
struct Axis(Vec<([f64; 2], [f64; 2])>);

impl Axis {
    fn whole(values: (f64, f64), px: [f64; 2]) -> Self {
        Axis(vec![([values.0, values.1], px)])
    }

    /// One of these pieces, as wide as they are long.
    fn cut(pieces: &[[f64; 2]], [from, to]: [f64; 2]) -> Self {
        let known: f64 = pieces.iter().map(|[start, end]| end - start).sum();
        let px = (to - from - CUT * (pieces.len() as f64 - 1.0)) / known;
        let mut at = from;
        let place = |piece: &[f64; 2]| {
            let right = at + px * (piece[1] - piece[0]);
            let placed = (*piece, [at, right]);
            at = right + CUT;
            placed
        };
        Axis(pieces.iter().map(place).collect())
    }

    fn at(&self, value: f64) -> f64 {
        let after = self.0.partition_point(|([start, _], _)| *start <= value).max(1);
        let Some(([start, end], [from, to])) = self.0.get(after - 1) else { return value };
        from + (value - start) / (end - start) * (to - from)
    }

    /// Round numbers in all pieces, as many as can be read beside each other.
    fn ticks(&self) -> Vec<(f64, String)> {
        let mut all: Vec<(f64, String)> = self.0.iter().flat_map(|([start, end], _)| ticks(*start, *end)).collect();
        let mut free = f64::NEG_INFINITY;
        all.retain(|(value, said)| {
            let (at, half) = (self.at(*value), 0.5 * super::drawing::text_width(said, 12.0, false));
            let fits = at - half >= free;
            free = if fits { at + half + 6.0 } else { free };
            fits
        });
        all
    }
}

/// Where values lie in a plot.
struct Plot<'a> {
    /// Left, top, right and bottom, px.
    frame: [f64; 4],
    x: &'a Axis,
    y: (f64, f64),
}

impl Plot<'_> {
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [_, top, _, bottom] = self.frame;
        [self.x.at(x), bottom - (y - self.y.0) / (self.y.1 - self.y.0) * (bottom - top)]
    }

    /// With these ticks across and upwards.
    fn axes(&self, drawing: &mut Drawing, [across, along]: [&[(f64, String)]; 2], labels: [&str; 2]) {
        let [left, top, right, bottom] = self.frame;
        for (x, said) in across {
            let px = self.x.at(*x);
            drawing.line(&[[px, top], [px, bottom]], GRID, 1.0, 1.0);
            drawing.text([px, bottom + 16.0], Anchor::Middle, 12.0, INK, said);
        }
        for (y, said) in along {
            let [_, py] = self.at([0.0, *y]);
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

/// A way over longitudes from `west` on, broken where it goes over that seam.
fn unwrapped(points: &[[f64; 2]], west: f64) -> Broken {
    let mut lines: Broken = vec![vec![]];
    let mut before: Option<f64> = None;
    for [longitude, latitude] in points {
        let longitude = west + (longitude - west).rem_euclid(360.0);
        if before.is_some_and(|before| (longitude - before).abs() > 180.0) {
            lines.push(vec![]);
        }
        lines.last_mut().into_iter().for_each(|line| line.push([longitude, *latitude]));
        before = Some(longitude);
    }
    lines
}

/// From where to where longitudes and latitudes of a map go that shows these points: all directions, or those around the points if these are close together.
fn window(points: &[[f64; 2]]) -> [(f64, f64); 2] {
    let all = [(0.0, 360.0), (-90.0, 90.0)];
    let points: Vec<[f64; 2]> = points.iter().copied().filter(|point| point.iter().all(|x| x.is_finite())).collect();
    let mut longitudes: Vec<f64> = points.iter().map(|point| point[0].rem_euclid(360.0)).collect();
    longitudes.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (longitudes.first(), longitudes.last()) else { return all };
    // What is shown is all but the widest gap.
    let seam = (first + 360.0 - last, *first);
    let (gap, east_of_it) = longitudes
        .windows(2)
        .map(|two| (two[1] - two[0], two[1]))
        .fold(seam, |widest, gap| if gap.0 > widest.0 { gap } else { widest });
    let wide = 360.0 - gap;
    let (south, north) = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(south, north), point| (south.min(point[1]), north.max(point[1])));
    let width = (AROUND * wide.max(2.0 * (north - south))).max(NARROWEST);
    // Maps are twice as wide as high. What is not a number is none of these.
    if width.is_nan() || width >= WIDEST {
        return all;
    }
    let west = east_of_it + 0.5 * (wide - width);
    let bottom = (0.5 * (south + north) - 0.25 * width).clamp(-90.0, 90.0 - 0.5 * width);
    [(west, west + width), (bottom, bottom + 0.5 * width)]
}

/// Times at which something is known, in their order, those together between which no long time is.
fn pieces(mut spans: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut joined: Vec<[f64; 2]> = Vec::new();
    let join = |all: &mut Vec<[f64; 2]>, span: [f64; 2], most: f64| match all.last_mut() {
        Some(last) if span[0] - last[1] <= most => last[1] = last[1].max(span[1]),
        _ => all.push(span),
    };
    spans.into_iter().for_each(|span| join(&mut joined, span, 0.0));
    let known: f64 = joined.iter().map(|[start, end]| end - start).sum();
    let mut pieces = Vec::new();
    joined.iter().for_each(|span| join(&mut pieces, *span, LONG * known));
    // What is only a moment has no width.
    if (2..=MOST_CUTS + 1).contains(&pieces.len()) && pieces.iter().all(|[start, end]| end > start) {
        return pieces;
    }
    let (start, end) = range(joined.into_iter().flatten());
    vec![[start, end]]
}

/// What time is counted in over so many hours: its name, and how many of it are an hour.
fn unit_of_time(hours: f64) -> (&'static str, f64) {
    match hours {
        h if h < 0.1 => ("seconds", 3600.0),
        h if h < 3.0 => ("minutes", 60.0),
        h if h < 240.0 => ("hours", 1.0),
        _ => ("days", 1.0 / 24.0),
    }
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
    drawing.mark([x + 5.0, 41.0], Mark::Disc, 5.0, INK);
    drawing.text([x + 16.0, 45.0], Anchor::Start, 12.0, INK, "begins");
    draw_map(sheet, &mut drawing, [LEFT, TOP, WIDTH - RIGHT, TOP + map_height]);
    // Of one unit for all of it.
    let spans = || {
        let ends = |line: &Vec<[f64; 2]>| Some([line.first()?[0], line.last()?[0]]);
        sheet.tracks.iter().flat_map(|track| track.series.iter().flatten()).filter_map(ends).collect::<Vec<_>>()
    };
    let cuts = pieces(spans());
    let (unit, per_hour) = unit_of_time(cuts.iter().map(|[start, end]| end - start).sum());
    let known: Vec<[f64; 2]> = cuts.iter().map(|piece| piece.map(|hours| hours * per_hour)).collect();
    let times = Axis::cut(&known, [LEFT, WIDTH - RIGHT]);
    let from_start = format!("{unit} after {}", sheet.begins);
    for (k, quantity) in sheet.quantities.iter().enumerate() {
        let top = TOP + map_height + BETWEEN + k as f64 * (HEIGHT + BETWEEN);
        let of = |track: &Track| -> Broken {
            let lines = track.series.get(k).cloned().unwrap_or_default();
            lines.into_iter().map(|line| line.into_iter().map(|[h, value]| [h * per_hour, value]).collect()).collect()
        };
        let values: Vec<f64> = sheet.tracks.iter().flat_map(of).flatten().map(|point| point[1]).collect();
        let is_known = !values.is_empty();
        let values = values_range(&values);
        let plot = Plot { frame: [LEFT, top, WIDTH - RIGHT, top + HEIGHT], x: &times, y: values };
        let upwards = if is_known { ticks(values.0, values.1) } else { vec![] };
        plot.axes(&mut drawing, [&times.ticks(), &upwards], [&from_start, &quantity.label]);
        for (two, placed) in cuts.windows(2).zip(times.0.windows(2)) {
            let (hours, [from, to]) = (two[1][0] - two[0][1], [placed[0].1[1], placed[1].1[0]]);
            let (unit, per_hour) = unit_of_time(hours);
            drawing.rectangle([from, top], [to, top + HEIGHT], GRID, 1.0);
            let said = [format!("{:.0}", hours * per_hour), unit.to_owned()];
            for (line, said) in said.iter().enumerate() {
                drawing.text(
                    [0.5 * (from + to), top + 0.5 * HEIGHT + 14.0 * line as f64],
                    Anchor::Middle,
                    11.0,
                    INK,
                    said,
                );
            }
        }
        if !is_known {
            let middle = [0.5 * (LEFT + WIDTH - RIGHT), top + 0.5 * HEIGHT];
            drawing.text(middle, Anchor::Middle, 12.0, INK, quantity.unknown);
        }
        for (i, track) in sheet.tracks.iter().enumerate() {
            plot.lines(&mut drawing, &of(track), COLOURS[i % COLOURS.len()]);
        }
    }
    drawing
}

fn draw_map(sheet: &TrackSheet, drawing: &mut Drawing, frame: [f64; 4]) {
    let points: Vec<[f64; 2]> = sheet.tracks.iter().flat_map(|track| track.map.iter().flatten().copied()).collect();
    let [longitudes, latitudes] = window(&points);
    let across = Axis::whole(longitudes, [frame[0], frame[2]]);
    let map = Plot { frame, x: &across, y: latitudes };
    let degrees = |from: i32, to: i32, step: i32| -> Vec<(f64, String)> {
        (from..=to).step_by(step.unsigned_abs() as usize).map(|deg| (f64::from(deg), deg.to_string())).collect()
    };
    let is_whole = longitudes.1 - longitudes.0 == 360.0;
    let [along, upwards] = match is_whole {
        true => [degrees(0, 360, 60), degrees(-90, 90, 30)],
        false => [
            ticks(longitudes.0, longitudes.1).into_iter().map(within_a_turn).collect(),
            ticks(latitudes.0, latitudes.1),
        ],
    };
    map.axes(drawing, [&along, &upwards], [sheet.map_labels[0].as_str(), sheet.map_labels[1].as_str()]);
    for (i, track) in sheet.tracks.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let lines: Vec<Broken> = track.map.iter().map(|span| unwrapped(span, longitudes.0)).collect();
        lines.iter().for_each(|lines| map.lines(drawing, lines, colour));
        if let Some(first) = lines.first().and_then(|lines| lines.first()?.first()) {
            drawing.mark(map.at(*first), Mark::Disc, 5.0, colour);
        }
    }
}

/// A longitude's tick, called what it is from 0 to 360.
fn within_a_turn((deg, said): (f64, String)) -> (f64, String) {
    let decimals = said.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    (deg, format!("{:.*}", decimals, deg.rem_euclid(360.0)))
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
        let way = [[350.0, 0.0], [358.0, 1.0], [4.0, 2.0], [9.0, 3.0]];
        assert_eq!(unwrapped(&way, 0.0), [vec![[350.0, 0.0], [358.0, 1.0]], vec![[4.0, 2.0], [9.0, 3.0]]]);
        assert_eq!(unwrapped(&way, 340.0), [vec![[350.0, 0.0], [358.0, 1.0], [364.0, 2.0], [369.0, 3.0]]]);
    }

    #[test]
    fn a_map_shows_what_is_there() {
        let all = [(0.0, 360.0), (-90.0, 90.0)];
        assert_eq!(window(&[]), all);
        assert_eq!(window(&[[0.0, 80.0], [120.0, 80.0], [240.0, 80.0]]), all);
        assert_eq!(window(&[[f64::NAN, 0.0], [1.0, f64::NAN]]), all);
        // 20 deg over the seam are 25 with what is around them, and half as many upwards.
        let near = |found: [(f64, f64); 2], expected: [f64; 4]| {
            let found = [found[0].0, found[0].1, found[1].0, found[1].1];
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        };
        near(window(&[[350.0, 10.0], [10.0, 12.0], [355.0, 11.0]]), [347.5, 372.5, 4.75, 17.25]);
        // 20 deg upwards make 50 across.
        near(window(&[[100.0, -10.0], [102.0, 10.0]]), [76.0, 126.0, -12.5, 12.5]);
        // What stands still, and what is at a pole.
        near(window(&[[30.0, 0.0]; 2]), [29.95, 30.05, -0.025, 0.025]);
        near(window(&[[30.0, 90.0]]), [29.95, 30.05, 89.95, 90.0]);
        assert_eq!(within_a_turn((365.0, "365.00".into())).1, "5.00");
    }

    #[test]
    fn long_times_without_data_are_cut_out() {
        assert_eq!(pieces(vec![[250.0, 251.0], [0.0, 2.0]]), [[0.0, 2.0], [250.0, 251.0]]);
        assert_eq!(pieces(vec![[0.0, 2.0], [1.0, 3.0], [4.4, 5.0]]), [[0.0, 5.0]]);
        // A moment alone has no width, and of many pieces none would have any.
        assert_eq!(pieces(vec![[0.0, 1.0], [90.0, 90.0]]), [[0.0, 90.0]]);
        assert_eq!(
            pieces((0..9).map(|i| [100.0 * f64::from(i), 100.0 * f64::from(i) + 1.0]).collect()),
            [[0.0, 801.0]]
        );
        assert_eq!(pieces(vec![]), [[0.0, 1.0]]);
        // What has no room between its neighbours is not labelled.
        let narrow = Axis::cut(&[[0.0, 1.6], [14969.0, 15000.0]], [0.0, 752.0]).ticks();
        assert!(narrow.iter().filter(|(minutes, _)| *minutes < 2.0).count() <= 2, "{narrow:?}");
        // A third of what the cut leaves of the axis is the second piece.
        let axis = Axis::cut(&[[0.0, 2.0], [250.0, 251.0]], [0.0, 300.0 + CUT]);
        assert_eq!([0.0, 1.0, 2.0, 250.0, 251.0].map(|x| axis.at(x)), [0.0, 100.0, 200.0, 200.0 + CUT, 300.0 + CUT]);
        assert_eq!([0.05, 0.15, 5.0, 300.0].map(|h| unit_of_time(h).0), ["seconds", "minutes", "hours", "days"]);
    }

    #[test]
    fn a_value_lies_where_its_axes_say() {
        let across = Axis::whole((0.0, 360.0), [100.0, 300.0]);
        let plot = Plot { frame: [100.0, 50.0, 300.0, 150.0], x: &across, y: (-90.0, 90.0) };
        assert_eq!(plot.at([180.0, 0.0]), [200.0, 100.0]);
        assert_eq!(plot.at([0.0, 90.0]), [100.0, 50.0]);
        assert_eq!(values_range(&[40.0, 40.0 + 1e-9, 40.0 - 1e-9]).0.round(), 36.0);
        assert_eq!(values_range(&[0.0, 3.0]), (0.0, 3.0));
        // Nothing at all is a drawing too, which says so.
        let quantities = vec![Quantity { label: "km".into(), unknown: "not known" }];
        let svg = draw(&TrackSheet { quantities, ..TrackSheet::default() }).svg();
        assert!(svg.contains("not known") && !svg.contains("NaN"));
    }
}
