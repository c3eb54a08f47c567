//! ESRI ASCII grids: a head of names and numbers, and then rows from the North to the South.
//!
//! Source: the description of the format by ESRI ("ASCII raster file format"); `dx` and `dy` instead of `cellsize` are GDAL's.

use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::input::{self, Problems};
use crate::formats::number::DataType;
use crate::report::{Fate, Report};

use super::place::{Georeference, Grid, Unit};
use super::{BandReader, Raster, RasterBand, check_size};

/// A grid.
pub(in crate::formats) static ESRI: Format = Format {
    name: "asc",
    extensions: &["asc"],
    reads: "ESRI ASCII grid: one band, NODATA_value, cell size",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| is_grid(beginning).then(|| path.to_owned())),
    holds: Holds::Image {
        kind: "ESRI ASCII grid",
        open,
        target: Err("write .img; `gdal_translate -of AAIGrid IN.img OUT.asc` makes one of it"),
    },
};

/// What stands for no data where a grid does not say what does.
const NO_DATA: f64 = -9999.0;
/// Longer files are refused, bytes.
const LIMIT: u64 = 8 << 30;
/// A projection's text is shorter, bytes.
const PROJECTION: usize = 1 << 16;
const KEYS: [&str; 10] =
    ["ncols", "nrows", "cellsize", "dx", "dy", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "nodata_value"];

fn is_grid(beginning: &[u8]) -> bool {
    let first = beginning.split(|b| b.is_ascii_whitespace()).next().unwrap_or_default();
    first.eq_ignore_ascii_case(b"ncols") || first.eq_ignore_ascii_case(b"nrows")
}

/// Reads a grid.
fn open(path: &Path) -> Result<Raster> {
    let bytes = input::bytes(path, LIMIT)?;
    let Ok(text) = std::str::from_utf8(&bytes) else {
        return Err(Error::syntax(Location::file(path), "not UTF-8 text"));
    };
    let mut lines = text.lines().enumerate().peekable();
    let mut head: [Option<f64>; KEYS.len()] = [None; KEYS.len()];
    while let Some((i, line)) = lines.peek() {
        let mut words = line.split_whitespace();
        let first = words.next().unwrap_or_default().to_lowercase();
        if first.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.')) || first == "nan" {
            break;
        }
        if !first.is_empty() {
            let at = || Location::line(path, i + 1).with_item(&first);
            let Some(k) = KEYS.iter().position(|key| *key == first) else {
                let help = format!("the head of a grid has {}", KEYS.join(", "));
                return Err(Error::Invalid(vec![Problem::new(at(), "is not known").with_help(help)]));
            };
            let number = words.next().and_then(|word| fast_float2::parse(word).ok());
            head[k] = Some(number.ok_or_else(|| Error::invalid(at(), "a number must follow"))?);
        }
        lines.next();
    }
    let said = |key: &str| KEYS.iter().position(|k| *k == key).and_then(|k| head[k]);
    #[expect(clippy::cast_possible_truncation, reason = "a whole number in range")]
    let count = |key: &str| match said(key) {
        Some(n) if n >= 1.0 && n.fract() == 0.0 && n < 1e15 => Ok(n as usize),
        Some(n) => Err(Error::invalid(Location::file(path).with_item(key), format!("{n} is not a count"))),
        None => Err(Error::invalid(Location::file(path).with_item(key), "is missing")),
    };
    let (rows, columns) = (count("nrows")?, count("ncols")?);
    check_size(Location::file(path), rows, columns, 1)?;
    let wanted = rows * columns;
    // A digit and a blank at least.
    if bytes.len() / 2 + 1 < wanted {
        let message = format!("{} bytes cannot hold {columns} x {rows} numbers: it is cut short", bytes.len());
        return Err(Error::invalid(Location::file(path), message));
    }
    let (mut values, mut problems) = (Vec::with_capacity(wanted), Problems::default());
    // How many numbers a line has does not count.
    for (i, line) in lines {
        for word in line.split_whitespace() {
            let value = fast_float2::parse(word).ok();
            if value.is_none() {
                let column = (word.as_ptr() as usize).saturating_sub(line.as_ptr() as usize) + 1;
                let at = Location { column: Some(column), ..Location::line(path, i + 1) };
                let shown: String = word.chars().take(40).collect();
                problems.push(|| Problem::new(at, format!("`{shown}` is not a number")));
            }
            if values.len() < wanted {
                values.push(value.unwrap_or(f64::NAN));
            } else {
                let at = Location::line(path, i + 1);
                problems.push(|| Problem::new(at, format!("a number beyond the {columns} x {rows} of the head")));
            }
        }
    }
    if values.len() < wanted {
        let message = format!("{} numbers where the head says {columns} x {rows}: it is cut short", values.len());
        problems.push(|| Problem::new(Location::file(path), message));
    }
    problems.finish(path)?;
    let mut report = Report::default();
    let size = |key: &str| said("cellsize").or_else(|| said(key)).filter(|size| *size > 0.0 && size.is_finite());
    let georeference = match (size("dx"), size("dy")) {
        (Some(width), Some(height)) => Some(place(path, said, [width, height], [rows, columns], &mut report)),
        _ => None,
    };
    let taken = match said("nodata_value") {
        None => values.iter().filter(|value| **value == NO_DATA).count(),
        Some(_) => 0,
    };
    let raster =
        Raster::of(path, (rows, columns), vec![RasterBand::default()], DataType::F64, BandReader::Held(values));
    if taken > 0 {
        let message = format!("not given: {NO_DATA}, as the format has it, which {taken} pixels have");
        report.note(Fate::Defaulted, Location::file(path).with_item("NODATA_value"), message);
    }
    Ok(Raster { ignore: said("nodata_value").or(Some(NO_DATA)), georeference, report, ..raster })
}

/// Where the grid lies: in metres, unless the `.prj` beside it has another unit, or angles.
fn place(
    path: &Path,
    said: impl Fn(&str) -> Option<f64>,
    [width, height]: [f64; 2],
    [rows, columns]: [usize; 2],
    report: &mut Report,
) -> Georeference {
    let projection = input::beginning(&path.with_extension("prj"), PROJECTION).unwrap_or_default();
    let projection = String::from_utf8_lossy(&projection).trim_start().to_uppercase();
    // Of a projection the last unit is that of its metres.
    let unit = projection.rsplit_once("UNIT[").and_then(|(_, unit)| unit.split([',', ']']).nth(1)?.trim().parse().ok());
    let scale = unit.filter(|m: &f64| *m > 0.0 && m.is_finite()).unwrap_or(1.0);
    let is_geographic = projection.starts_with("GEOGCS") || projection.starts_with("GEOGCRS");
    let unit = if is_geographic { Unit::Degrees } else { Unit::Metres(scale) };
    if projection.is_empty() {
        report.note(Fate::Defaulted, Location::file(path).with_item("cellsize"), "its unit is not stated: taken as m");
    }
    let corner = |axis: &str, half: f64| {
        said(&format!("{axis}llcorner")).or_else(|| said(&format!("{axis}llcenter")).map(|centre| centre - half))
    };
    let corner = [corner("x", 0.5 * width), corner("y", 0.5 * height)].map(|c| c.unwrap_or(0.0));
    let grid = Grid::north_up([corner[0], corner[1] + rows as f64 * height], [width, height]);
    grid.upright(unit, [rows, columns], (Location::file(path), report)).0
}
