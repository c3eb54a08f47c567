//! Where a raster lies, as its header says it.

use crate::error::number;
use crate::formats::envi::Header;

/// A raster on a plane, in coordinates to the East and the North.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Georeference {
    /// In metres, with the North on top.
    Plane {
        /// The outer corner of the first pixel of the first line, m.
        corner_m: [f64; 2],
        /// From a pixel to the next in its line, to the East, m.
        along_line_m: f64,
        /// From a line to the next, to the South, m.
        line_to_line_m: f64,
    },
    /// In another way: why it is not taken.
    Other(String),
}

/// Pixels whose sides are angles, deg: what that is on the ground the file does not say.
pub(super) fn in_degrees([width, height]: [f64; 2]) -> Georeference {
    Georeference::Other(format!(
        "pixels of {} x {} deg, not of metres: give `plane` instead, or project the image first (`gdalwarp -t_srs` with metres about the site)",
        number(width),
        number(height)
    ))
}

impl Georeference {
    /// Size of a pixel on the ground, m: along a line, and from line to line.
    pub(super) fn spacing_m(&self) -> Option<[f64; 2]> {
        match self {
            Georeference::Plane { along_line_m, line_to_line_m, .. } => Some([*along_line_m, *line_to_line_m]),
            Georeference::Other(_) => None,
        }
    }

    /// Of `map info = {projection, x, y, easting, northing, pixel width, pixel height, .., units=.., rotation=..}`: pixel coordinates are 1 at
    /// the outer corner of the first pixel.
    pub(super) fn of_envi(header: &Header) -> Option<Self> {
        let text = header.field("map info")?;
        let items: Vec<&str> = text.split(',').map(str::trim).collect();
        let option = |key: &str| {
            items.iter().find_map(|item| {
                let (name, value) = item.split_once('=')?;
                name.trim().eq_ignore_ascii_case(key).then(|| value.trim().to_lowercase())
            })
        };
        let other = |why: String| Some(Georeference::Other(format!("`map info` {why}")));
        let numbers: Option<Vec<f64>> = items
            .get(1..7)
            .and_then(|six| six.iter().map(|t| t.parse().ok().filter(|v: &f64| v.is_finite())).collect());
        let Some(&[x, y, east, north, width, height]) = numbers.as_deref() else {
            return other("has no six numbers".into());
        };
        let projection = items[0].to_lowercase();
        let unit = option("units")
            .unwrap_or_else(|| if projection.contains("geographic") { "degrees".into() } else { "meters".into() });
        let scale = match unit.as_str() {
            "meters" | "meter" | "metres" | "metre" | "m" => 1.0,
            "km" | "kilometers" | "kilometer" | "kilometres" | "kilometre" => 1e3,
            other_unit => {
                return other(format!(
                    "is in {other_unit}, not in metres: give `plane` instead, or project the image first (`gdalwarp -t_srs` with metres about the site)"
                ));
            }
        };
        if let Some(rotation) = option("rotation")
            && rotation.parse() != Ok(0.0)
        {
            return other(format!("is turned by {rotation} deg: the North is not on top"));
        }
        if !(width > 0.0 && height > 0.0) {
            return other(format!("has pixels of {width} x {height}"));
        }
        Some(Georeference::Plane {
            corner_m: [scale * (east - (x - 1.0) * width), scale * (north + (y - 1.0) * height)],
            along_line_m: scale * width,
            line_to_line_m: scale * height,
        })
    }
}
