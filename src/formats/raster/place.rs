//! Where a raster lies, as its header says it.

use super::lengths::metres;
use crate::error::{Location, number};
use crate::formats::envi::Header;
use crate::report::{Fate, Report};

/// What an image may be turned by over all of it and still count as upright, in pixels: f64 has no more to say after a few conversions.
const STRAIGHT: f64 = 1e-3;

/// A raster whose lines are read from the North to the South, each from the West to the East.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Georeference {
    /// On a plane, in metres to the East and the North.
    Plane {
        /// The outer corner of the first pixel of the first line, m.
        corner_m: [f64; 2],
        /// From a pixel to the next in its line, to the East, m.
        along_line_m: f64,
        /// From a line to the next, to the South, m.
        line_to_line_m: f64,
    },
    /// On a body, in longitudes to the East and latitudes.
    Degrees {
        /// The outer corner of the first pixel of the first line: longitude and latitude, deg.
        corner_deg: [f64; 2],
        /// Width and height of a pixel, deg.
        pixel_deg: [f64; 2],
    },
    /// Lines that do not run from the West to the East, or may not follow one another to the South: a sentence on that.
    Turned(String),
    /// In another way: why it is not taken.
    Other(String),
}

/// What coordinates of a map are in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unit {
    /// Of so many metres.
    Metres(f64),
    /// Longitudes to the East and latitudes.
    Degrees,
}

/// Where the pixels of a file are, in the order of the file: (column, row) is at corner + column `along` + row `across`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    /// To the East and the North, or longitude and latitude.
    pub(super) corner: [f64; 2],
    pub(super) along: [f64; 2],
    pub(super) across: [f64; 2],
}

impl Grid {
    /// With lines that run to the East and follow one another to the South.
    pub(super) fn north_up(corner: [f64; 2], [width, height]: [f64; 2]) -> Self {
        Grid { corner, along: [width, 0.0], across: [0.0, -height] }
    }

    /// Where it lies once its lines are read from the North to the South, each from the West to the East; and whether the order of
    /// lines, and that within lines, is changed for that, which is told.
    pub(super) fn upright(
        self,
        unit: Unit,
        [rows, columns]: [usize; 2],
        (at, report): (Location, &mut Report),
    ) -> (Georeference, [bool; 2]) {
        let Grid { corner: [x, y], along: [a, c], across: [b, d] } = self;
        let as_stored = [false; 2];
        if ![x, y, a, b, c, d].iter().all(|n| n.is_finite()) {
            return (Georeference::Other("places that are no numbers".into()), as_stored);
        }
        let [of_lines, of_rows] = [(c, d, columns), (b, a, rows)].map(|(off, step, n)| (off * n as f64, step));
        if [of_lines, of_rows].iter().any(|(off, step)| off.abs() > STRAIGHT * step.abs()) {
            let [a, b, c, d] = [a, b, c, d].map(number);
            return turned(
                format!("lines are turned: a pixel is ({a}, {c}) from the one before it, a line ({b}, {d})"),
                at,
                report,
            );
        }
        if a == 0.0 || d == 0.0 {
            return (Georeference::Other("pixels without a size".into()), as_stored);
        }
        let mirrored = [d > 0.0, a < 0.0];
        let told = match mirrored {
            [true, true] => "the first pixel is in the South-East: read from the North-West",
            [true, false] => "the first line is the southernmost: read from the North",
            [false, true] => "the first pixel of a line is the easternmost: read from the West",
            [false, false] => "",
        };
        if !told.is_empty() {
            report.note(Fate::Defaulted, at, told);
        }
        let corner = [if a < 0.0 { x + a * columns as f64 } else { x }, if d > 0.0 { y + d * rows as f64 } else { y }];
        let size = [a.abs(), d.abs()];
        let place = match unit {
            Unit::Metres(scale) => Georeference::Plane {
                corner_m: corner.map(|c| scale * c),
                along_line_m: scale * size[0],
                line_to_line_m: scale * size[1],
            },
            Unit::Degrees => Georeference::Degrees { corner_deg: corner, pixel_deg: size },
        };
        (place, mirrored)
    }
}

/// Lines that do not run as they should, which is told.
pub(super) fn turned(how: String, at: Location, report: &mut Report) -> (Georeference, [bool; 2]) {
    report.note(Fate::Dropped, at, how.as_str());
    (Georeference::Turned(how), [false; 2])
}

impl Georeference {
    /// Size of a pixel on the ground, m: along a line, and from line to line.
    pub(super) fn spacing_m(&self) -> Option<[f64; 2]> {
        match self {
            Georeference::Plane { along_line_m, line_to_line_m, .. } => Some([*along_line_m, *line_to_line_m]),
            _ => None,
        }
    }

    /// Why it is no place on a plane.
    pub(crate) fn why_no_plane(&self) -> Option<String> {
        match self {
            Georeference::Plane { .. } => None,
            Georeference::Degrees { pixel_deg: [width, height], .. } => Some(format!(
                "pixels of {} x {} deg, not of metres: give `plane` instead, or project the image first (`gdalwarp -t_srs` with metres about the site)",
                number(*width),
                number(*height)
            )),
            Georeference::Turned(how) => {
                Some(format!("{how}: give `plane` instead, or `gdalwarp IN.tif OUT.tif` turns the image"))
            }
            Georeference::Other(why) => Some(why.clone()),
        }
    }

    /// Of `map info = {projection, x, y, easting, northing, pixel width, pixel height, .., units=.., rotation=..}`: pixel coordinates are 1 at
    /// the outer corner of the first pixel.
    pub(super) fn of_envi(header: &Header, (at, report): (Location, &mut Report)) -> Option<(Self, [bool; 2])> {
        let text = header.field("map info")?;
        let items: Vec<&str> = text.split(',').map(str::trim).collect();
        let option = |key: &str| {
            items.iter().find_map(|item| {
                let (name, value) = item.split_once('=')?;
                name.trim().eq_ignore_ascii_case(key).then(|| value.trim().to_lowercase())
            })
        };
        let other = |why: String| Some((Georeference::Other(format!("`map info` {why}")), [false; 2]));
        let numbers: Option<Vec<f64>> = items
            .get(1..7)
            .and_then(|six| six.iter().map(|t| t.parse().ok().filter(|v: &f64| v.is_finite())).collect());
        let Some(&[x, y, east, north, width, height]) = numbers.as_deref() else {
            return other("has no six numbers".into());
        };
        let projection = items[0].to_lowercase();
        let unit = option("units")
            .unwrap_or_else(|| if projection.contains("geographic") { "degrees".into() } else { "meters".into() });
        let unit = match (metres(&unit), unit.as_str()) {
            (Some(unit_m), _) => Unit::Metres(unit_m),
            (None, "degrees" | "degree" | "deg") => Unit::Degrees,
            (None, other_unit) => {
                return other(format!(
                    "is in {other_unit}, not in metres: give `plane` instead, or project the image first (`gdalwarp -t_srs` with metres about the site)"
                ));
            }
        };
        if let Some(rotation) = option("rotation")
            && rotation.parse() != Ok(0.0)
        {
            return Some(turned(format!("`map info` is turned by {rotation} deg"), at, report));
        }
        if !(width > 0.0 && height > 0.0) {
            return other(format!("has pixels of {width} x {height}"));
        }
        let corner = [east - (x - 1.0) * width, north + (y - 1.0) * height];
        let size = [header.lines, header.samples];
        Some(Grid::north_up(corner, [width, height]).upright(unit, size, (at, report)))
    }
}
