//! A band as text: a line for each row, numbers with commas, semicolons, tabs or blanks between them.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::format::{Format, Holds, ending};
use crate::formats::input::{self, Problems};
use crate::formats::number::DataType;

use super::{BandReader, MOST_PIXELS, Raster, RasterBand, Target, check_size};

/// A band as comma-separated values.
pub(in crate::formats) static GRID: Format = Format {
    name: "grid",
    extensions: &["csv"],
    reads: "CSV of numbers alone: one band",
    writes: "the same",
    mark: &[],
    told: Some(|path, beginning| (ending(path) == "csv" && is_grid(beginning)).then(|| path.to_owned())),
    holds: Holds::Image { kind: "CSV of numbers", open, target: Ok(|_| Target::Csv) },
};

/// Longer files are refused, bytes.
const LIMIT: u64 = 8 << 30;

/// What stands between the cells of a line; `None` for blanks.
fn separator(line: &str) -> Option<char> {
    [';', ',', '\t'].into_iter().find(|c| line.contains(*c))
}

fn cells(line: &str, separator: Option<char>) -> impl Iterator<Item = &str> {
    let by_blanks = separator.is_none().then(|| line.split_ascii_whitespace());
    let by_mark = separator.map(|c| line.split(c).map(str::trim));
    by_blanks.into_iter().flatten().chain(by_mark.into_iter().flatten())
}

/// A number; `nan`, or nothing between two commas, means no data.
fn number(cell: &str) -> Option<f64> {
    if cell.is_empty() { Some(f64::NAN) } else { fast_float2::parse(cell).ok() }
}

fn is_left_out(line: &str) -> bool {
    line.is_empty() || line.starts_with('#')
}

/// Whether a text is a table of nothing but numbers, by its first row.
fn is_grid(beginning: &[u8]) -> bool {
    let text = String::from_utf8_lossy(beginning);
    let text = text.trim_start_matches('\u{feff}');
    let first = text.lines().find(|line| !is_left_out(line.trim())).unwrap_or_default();
    let mut cells = cells(first, separator(first)).filter(|cell| !cell.is_empty()).peekable();
    // A few are enough, and the last may be cut off.
    cells.peek().is_some() && cells.take(16).all(|cell| number(cell).is_some())
}

/// Reads a text.
pub(super) fn open(path: &Path) -> Result<Raster> {
    let reading = |e| Error::io(path, "reading", e);
    let file = input::open(path).map_err(reading)?;
    if file.metadata().map_err(reading)?.len() > LIMIT {
        return Err(Error::invalid(Location::file(path), format!("is longer than the {LIMIT} bytes that are read")));
    }
    let mut file = BufReader::with_capacity(1 << 20, file.take(LIMIT));
    let mut problems = Problems::default();
    let (mut bytes, mut values) = (Vec::new(), Vec::new());
    let (mut rows, mut columns, mut between, mut line_number) = (0, 0, None, 0);
    loop {
        bytes.clear();
        if file.read_until(b'\n', &mut bytes).map_err(reading)? == 0 {
            break;
        }
        line_number += 1;
        let at = |column| Location { column: Some(column), ..Location::line(path, line_number) };
        let Ok(text) = std::str::from_utf8(&bytes) else {
            return Err(Error::syntax(at(1), "not UTF-8 text: save the file as UTF-8"));
        };
        // A tab at the end stands before a cell that is empty.
        let line = text.trim_start_matches('\u{feff}').trim_end_matches(['\r', '\n']);
        if is_left_out(line.trim()) {
            continue;
        }
        if rows == 0 {
            between = separator(line);
        }
        let before = values.len();
        for cell in cells(line, between) {
            let value = number(cell);
            values.push(value.unwrap_or(f64::NAN));
            if value.is_none() {
                let column = (cell.as_ptr() as usize).saturating_sub(text.as_ptr() as usize) + 1;
                let shown: String = cell.chars().take(40).collect();
                problems.push(|| Problem::new(at(column), format!("`{shown}` is not a number")));
            }
        }
        let found = values.len() - before;
        if rows == 0 {
            columns = found;
        } else if found != columns {
            problems.push(|| Problem::new(at(1), format!("{found} numbers where the first row has {columns}")));
        }
        rows += 1;
        if values.len() as u64 > MOST_PIXELS {
            check_size(Location::file(path), values.len(), 1, 1)?;
        }
    }
    problems.finish(path)?;
    check_size(Location::file(path), rows, columns, 1)?;
    Ok(Raster::of(path, (rows, columns), vec![RasterBand::default()], DataType::F64, BandReader::Held(values)))
}
