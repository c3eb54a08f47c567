//! Tables of wavelengths and values in text, as people have them: where the header is, what parts the columns, which units it states.
//!
//! - Our own: `wavelength_um,reflectance_percent`; also quoted, in capitals, with units in brackets, with columns parted by
//!   semicolons, tabs or blanks, with the header in a comment, or without one.
//! - ECOSTRESS and ASTER: some twenty lines `Name: value`, among them `X Units` and `Y Units`, then two columns.
//! - The US Geological Survey's splib07: a title with `Record=`, then a value on each line; wavelengths are another such file.
//! - RELAB: columns without a header, or below a title.
//!
//! Rows may ascend, descend, or step back where detectors overlap. NaN, an empty cell, and numbers below -1e30 are gaps.

use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number};
use crate::report::{Fate, Report};

use super::input::Problems;
use super::spectral_heading::{Unit, WAVE_UNITS, is_of_wavelength, of_column, of_wavelength};
use super::table::place;
use super::wave_unit::{self, WaveUnit};

/// Numbers below this are not there: the library of the US Geological Survey has -1.23e34 in deleted channels.
pub(super) const DELETED_BELOW: f64 = -1e30;
/// Without a unit, wavelengths that all lie in the first range are um, in the second nm.
const UM: std::ops::RangeInclusive<f64> = 0.05..=100.0;
const NM: std::ops::RangeInclusive<f64> = 150.0..=100_000.0;

/// A number, and the cell that it is written in; none is a gap.
type Cell<'a> = Option<(f64, &'a str)>;

/// A column of values.
#[derive(Debug)]
pub(super) struct TableColumn<'a> {
    /// Its name without its unit; empty if there is no header.
    pub(super) name: String,
    /// The cell that names it, or the first row.
    pub(super) cell: &'a str,
    pub(super) unit: Unit,
    /// What is written, as number and cell, by ascending wavelength; `None` is a gap.
    pub(super) values: Vec<Cell<'a>>,
}

/// A table in any of the layouts that are read.
#[derive(Debug)]
pub(super) struct SpectralTable<'a> {
    /// What it is called in itself.
    pub(super) name: Option<&'a str>,
    pub(super) comment: Vec<&'a str>,
    pub(super) has_header: bool,
    /// The header, or the first row.
    pub(super) header: &'a str,
    /// Ascending, um.
    pub(super) wavelength_um: Vec<f64>,
    pub(super) columns: Vec<TableColumn<'a>>,
    /// The unit of wavelengths that it states, or that was taken.
    pub(super) wave_unit: WaveUnit,
    /// How its layout says percent.
    pub(super) percent_help: &'static str,
    /// What was taken that the text does not say.
    pub(super) report: Report,
}

/// Reads a table. `given_um`: the wavelengths of the rows, for a text that holds values alone.
///
/// # Errors
/// [`Error::Invalid`] with the cells that are not numbers, rows of another length than the header, wavelengths that are there twice, and
/// for units that are neither stated nor plain from the numbers.
pub(super) fn parse<'a>(text: &'a str, path: &Path, given_um: Option<&[f64]>) -> Result<SpectralTable<'a>> {
    let lines = Lines::of(text);
    let mut table = lines.clone();
    match () {
        () if lines.is_ecostress() => table.ecostress(text, path),
        () if lines.is_usgs() => values_alone(&lines, text, path, given_um),
        () => table.columns(text, path),
    }
}

/// Reads the wavelengths of a text of values alone, um.
///
/// # Errors
/// As [`parse`]; for a text that is not a list of wavelengths.
pub(super) fn wavelengths(text: &str, path: &Path) -> Result<Vec<f64>> {
    let lines = Lines::of(text);
    let (title, values) = one_column(&lines, text, path)?;
    let values: Vec<f64> = values.iter().map(|v| v.map_or(f64::NAN, |v| v.0)).collect();
    let words = wave_unit::words(title);
    let stated = words.iter().filter(|word| word.len() > 1).find_map(|word| WaveUnit::of(word));
    let stated = stated.or_else(|| plain_unit(&values));
    let Some(unit) = stated else {
        return Err(Error::invalid(place(path, text, title), "does not state the unit of its wavelengths"));
    };
    Ok(values.into_iter().map(|written| unit.um(written).unwrap_or(f64::NAN)).collect())
}

/// The unit that numbers have if they are wavelengths of light.
fn plain_unit(values: &[f64]) -> Option<WaveUnit> {
    let all_in = |range: std::ops::RangeInclusive<f64>| values.iter().all(|v| range.contains(v));
    match () {
        () if all_in(UM) => Some(WaveUnit::MICROMETRES),
        () if all_in(NM) => Some(WaveUnit::NANOMETRES),
        () => None,
    }
}

/// Whether a line, or its first cell, names wavelengths.
fn names_wavelength(text: &str) -> bool {
    is_of_wavelength(text) || wave_unit::words(text).iter().any(|word| word.starts_with("wavelen"))
}

/// Puts the column that names wavelengths first, wherever it stands, and takes out those that number the rows before it.
fn wavelength_first(cells: &mut Vec<&str>, rows: &mut [Vec<&str>]) {
    const NUMBERS: [&str; 8] = ["", "#", "no", "nr", "index", "band", "bands", "channel"];
    if cells.first().is_none_or(|cell| names_wavelength(cell)) {
        return;
    }
    let Some(mut at) = cells.iter().position(|cell| is_of_wavelength(cell)) else { return };
    while at > 0 && NUMBERS.contains(&cells[0].to_lowercase().trim_end_matches('.')) {
        cells.remove(0);
        rows.iter_mut().filter(|row| row.len() > 1).for_each(|row| _ = row.remove(0));
        at -= 1;
    }
    cells[..=at].rotate_right(1);
    rows.iter_mut().filter(|row| row.len() > at).for_each(|row| row[..=at].rotate_right(1));
}

/// The lines of a text that hold something.
#[derive(Clone)]
struct Lines<'a> {
    all: Vec<&'a str>,
}

/// What parts the cells of a line.
#[derive(Clone, Copy, PartialEq)]
enum Separator {
    Char(char),
    Blanks,
}

impl Separator {
    fn of(line: &str) -> Self {
        [';', '\t', ','].into_iter().find(|c| line.contains(*c)).map_or(Separator::Blanks, Separator::Char)
    }

    /// The cells of a line, without the blanks and quotes around them. A separator within quotes parts nothing.
    fn cells(self, line: &str) -> Vec<&str> {
        let Separator::Char(separator) = self else { return line.split_whitespace().map(unquoted).collect() };
        let mut is_quoted = false;
        let parts = line.split(move |c| {
            is_quoted ^= c == '"';
            c == separator && !is_quoted
        });
        parts.map(unquoted).collect()
    }
}

fn unquoted(cell: &str) -> &str {
    let cell = cell.trim();
    ['"', '\''].into_iter().find_map(|q| cell.strip_prefix(q)?.strip_suffix(q)).map_or(cell, str::trim)
}

fn is_number(cell: &str) -> bool {
    cell.parse::<f64>().is_ok()
}

impl<'a> Lines<'a> {
    fn of(text: &'a str) -> Self {
        Lines { all: text.lines().map(str::trim).filter(|line| !line.is_empty()).collect() }
    }

    fn is_ecostress(&self) -> bool {
        let starts = |line: &str, with: &str| line.get(..with.len()).is_some_and(|s| s.eq_ignore_ascii_case(with));
        self.all.first().is_some_and(|line| starts(line, "name:"))
            && self.all.iter().take(100).any(|line| starts(line, "x units:"))
    }

    fn is_usgs(&self) -> bool {
        self.all.first().is_some_and(|line| line.contains("Record="))
            && self.all.get(1).is_some_and(|line| is_number(line))
    }

    fn ecostress(&mut self, text: &'a str, path: &Path) -> Result<SpectralTable<'a>> {
        let is_row = |line: &str| line.split([' ', '\t', ',']).all(|c| c.is_empty() || is_number(c));
        let rows_at = self.all.iter().position(|line| is_row(line)).unwrap_or(self.all.len());
        let head = &self.all[..rows_at];
        let said = |key: &str| {
            head.iter().find_map(|line| {
                let (name, value) = line.split_once(':')?;
                name.trim().eq_ignore_ascii_case(key).then_some(value.trim())
            })
        };
        let (x, y) = (said("x units").unwrap_or_default(), said("y units").unwrap_or_default());
        let Some(unit) = of_wavelength(x).unwrap_or_default() else {
            let message = format!("X Units are {x:?}: {WAVE_UNITS} are read");
            return Err(Error::invalid(place(path, text, self.all[0]), message));
        };
        let rows: Vec<Vec<&str>> = self.all[rows_at..]
            .iter()
            .map(|line| line.split([' ', '\t', ',']).filter(|cell| !cell.is_empty()).collect())
            .collect();
        let name = said("name").filter(|name| !name.is_empty());
        let mut table = assembled(text, path, self.all[0], unit, &[("X", ""), (y, y)], &rows, Report::default())?;
        table.name = name;
        table.comment = head.to_vec();
        table.percent_help = "if these are percent, the line `Y Units` says so: `Y Units: Reflectance (percent)`";
        Ok(table)
    }

    fn columns(&mut self, text: &'a str, path: &Path) -> Result<SpectralTable<'a>> {
        let is_comment = |line: &&&str| line.starts_with('#');
        let body: Vec<&str> = self.all.iter().filter(|line| !is_comment(line)).copied().collect();
        let mut comment: Vec<&str> =
            self.all.iter().filter(is_comment).map(|line| line[1..].strip_prefix(' ').unwrap_or(&line[1..])).collect();
        let Some(&first) = body.first() else {
            let help = "the first line is `wavelength_um,reflectance`, or more columns";
            return Err(Error::Invalid(vec![
                Problem::new(Location::file(path), "no header, and no rows").with_help(help),
            ]));
        };
        // The header is the last line before numbers: what is above it is a title.
        let begins_with_number = |line: &&str| Separator::of(line).cells(line).first().is_some_and(|c| is_number(c));
        let rows_at = body.iter().position(begins_with_number).unwrap_or(body.len());
        let titles = body.iter().take(rows_at.saturating_sub(1));
        let mut report = Report::default();
        // Lines that are not numbers below a header that is one are rows with a fault, not titles.
        let header_at = match rows_at {
            0 => None,
            _ if names_wavelength(Separator::of(first).cells(first)[0]) => Some(0),
            n if n < body.len() => Some(n - 1),
            _ => Some(0),
        };
        if header_at.is_some_and(|at| at > 0) {
            comment.extend(titles);
        }
        let in_comment =
            header_at.is_none().then(|| comment.iter().rev().find(|line| names_wavelength(line)).copied()).flatten();
        let (header_line, rows) = match (header_at, in_comment) {
            (Some(at), _) => (Some(body[at]), &body[at + 1..]),
            (None, Some(said)) => (Some(said), &body[..]),
            (None, None) => (None, &body[..]),
        };
        let Some(header) = header_line else {
            return Self::without_header(text, path, first, rows, comment);
        };
        let (mut cells, mut rows) = parted(header, in_comment.is_some(), rows);
        if in_comment.is_none() {
            wavelength_first(&mut cells, &mut rows);
        }
        // Numbers of rows are not values.
        if cells.len() < 2 {
            let message = "one column: a wavelength and a value, parted by a comma, are needed";
            return Err(Error::invalid(place(path, text, cells.first().copied().unwrap_or(header)), message));
        }
        let unit = match of_wavelength(cells[0]) {
            Ok(Some(unit)) => unit,
            Ok(None) => guessed(text, path, cells[0], &rows, &mut report)?,
            Err((message, help)) => {
                let problem = Problem::new(place(path, text, cells[0]), message);
                return Err(Error::Invalid(vec![problem.with_help(help)]));
            }
        };
        let columns: Vec<(&str, &str)> = cells.iter().map(|cell| (*cell, *cell)).collect();
        let mut table = assembled(text, path, cells[0], unit, &columns, &rows, report)?;
        table.comment = comment.into_iter().filter(|line| Some(*line) != in_comment).collect();
        Ok(table)
    }

    fn without_header(
        text: &'a str,
        path: &Path,
        first: &'a str,
        rows: &[&'a str],
        comment: Vec<&'a str>,
    ) -> Result<SpectralTable<'a>> {
        let mut report = Report::default();
        let separator = Separator::of(first);
        let rows: Vec<Vec<&str>> = rows.iter().map(|row| separator.cells(row)).collect();
        let unit = guessed(text, path, first, &rows, &mut report)?;
        let count = rows[0].len();
        if count < 2 {
            let message = "one column: a wavelength and a value, parted by a comma, are needed";
            return Err(Error::invalid(place(path, text, first), message));
        }
        let columns = vec![("", first); count];
        let mut table = assembled(text, path, first, unit, &columns, &rows, report)?;
        table.comment = comment;
        table.has_header = false;
        table.percent_help =
            "put a header above it, e.g. `wavelength_nm,reflectance_percent`, or `wavelength_um,irradiance_w_m2_um`";
        Ok(table)
    }
}

/// The cells of a header and of the rows below it. A header in a comment may use another separator than the rows.
pub(super) fn parted<'a>(header: &'a str, is_comment: bool, rows: &[&'a str]) -> (Vec<&'a str>, Vec<Vec<&'a str>>) {
    let separator = match (is_comment, rows.first()) {
        (false, _) => Separator::of(header),
        (true, row) => row.map_or(Separator::Blanks, |row| Separator::of(row)),
    };
    let rows_separator = match rows.first() {
        // `Wavelength (um), Reflectance` above columns of blanks.
        Some(row) if separator != Separator::Blanks && separator.cells(row).len() < 2 => Separator::of(row),
        _ => separator,
    };
    let mut rows: Vec<Vec<&str>> = rows.iter().map(|row| rows_separator.cells(row)).collect();
    let count = rows.first().map_or(2, Vec::len);
    let mut cells = match is_comment {
        true if !header.contains([',', ';', '\t']) => headings(header, count),
        true => Separator::of(header).cells(header),
        false if separator == Separator::Blanks => headings(header, count),
        false => separator.cells(header),
    };
    if rows_separator != separator && cells.len() != rows.first().map_or(0, Vec::len) {
        cells = headings(header, count);
    }
    // A separator at the end of each line.
    if cells.len() > 1
        && cells.last() == Some(&"")
        && rows.iter().all(|row| row.len() == cells.len() && row.last() == Some(&""))
    {
        cells.pop();
        rows.iter_mut().for_each(|row| row.truncate(cells.len()));
    }
    (cells, rows)
}

/// Headings separated by blanks only, one for each column; units in brackets belong to the word before them.
fn headings(line: &str, count: usize) -> Vec<&str> {
    let mut cells: Vec<&str> = Vec::new();
    let mut depth = 0usize;
    let mut start = None;
    for (i, c) in line.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if c.is_whitespace() && depth == 0 {
            // `Wavelength (um)`: a bracket after blanks goes on with the word.
            if line[i..].trim_start().starts_with(['(', '[']) {
                continue;
            }
            if let Some(from) = start.take() {
                cells.push(line[from..i].trim());
            }
        } else if start.is_none() {
            start = Some(i);
        }
    }
    cells.extend(start.map(|from| line[from..].trim()));
    // More words than columns: the last column has the rest.
    if cells.len() > count && count >= 2 {
        let from = cells[count - 1].as_ptr() as usize - line.as_ptr() as usize;
        cells.truncate(count - 1);
        cells.push(line[from..].trim());
    }
    cells
}

/// The unit of wavelengths given without one, guessed from their size; this is reported.
fn guessed(text: &str, path: &Path, cell: &str, rows: &[Vec<&str>], report: &mut Report) -> Result<WaveUnit> {
    let at = place(path, text, cell);
    let values: Vec<f64> = rows.iter().filter_map(|row| row.first()?.parse().ok()).collect();
    let Some(unit) = plain_unit(&values).filter(|_| !values.is_empty()) else {
        let message = format!("the header begins with `{cell}`, which does not state the unit");
        let help = "begin it with `wavelength_um` or `wavelength_nm`";
        return Err(Error::Invalid(vec![Problem::new(at, message).with_help(help)]));
    };
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let message = format!(
        "no unit of wavelengths is stated; from {} to {} they are taken as {}",
        number(low),
        number(high),
        if unit == WaveUnit::MICROMETRES { "um" } else { "nm" }
    );
    report.note(Fate::Defaulted, at, message);
    Ok(unit)
}

/// A title and the numbers below it; below [`DELETED_BELOW`] is a gap.
fn one_column<'a>(lines: &Lines<'a>, text: &str, path: &Path) -> Result<(&'a str, Vec<Cell<'a>>)> {
    let mut problems = Problems::default();
    let title = lines.all.first().copied().unwrap_or("");
    let values = lines.all.iter().skip(1).map(|cell| {
        let value = cell.parse::<f64>().ok();
        if value.is_none() {
            problems.push(|| Problem::new(place(path, text, cell), format!("`{cell}` is not a number")));
        }
        value.filter(|v| v.is_finite() && *v > DELETED_BELOW).map(|v| (v, *cell))
    });
    let values = values.collect();
    problems.finish(path)?;
    Ok((title, values))
}

fn values_alone<'a>(
    lines: &Lines<'a>,
    text: &'a str,
    path: &Path,
    given_um: Option<&[f64]>,
) -> Result<SpectralTable<'a>> {
    let (title, values) = one_column(lines, text, path)?;
    let at = || place(path, text, title);
    let Some(um) = given_um else {
        let message = "holds values alone: their wavelengths are another file of the same library";
        let help = "mmxrt convert THIS OUT.csv --wavelengths FILE";
        return Err(Error::Invalid(vec![Problem::new(at(), message).with_help(help)]));
    };
    if um.len() != values.len() {
        let message =
            format!("{} values for {} wavelengths: they belong to another instrument", values.len(), um.len());
        return Err(Error::invalid(at(), message));
    }
    let mut report = Report::default();
    let mut rows: Vec<(f64, Cell<'_>)> = um.iter().copied().zip(values).filter(|(um, _)| um.is_finite()).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let before = rows.len();
    rows.dedup_by(|b, a| a.0 == b.0);
    if rows.len() < before {
        report.note(
            Fate::Dropped,
            at(),
            format!("{} wavelengths that appear twice: the first is kept", before - rows.len()),
        );
    }
    let name = title.split_once(':').map_or(title, |(_, name)| name).trim();
    let (wavelength_um, values): (Vec<f64>, Vec<_>) = rows.into_iter().unzip();
    let column = TableColumn { name: "reflectance".to_owned(), cell: title, unit: Unit::Plain, values };
    Ok(SpectralTable {
        name: Some(name),
        comment: vec![title],
        has_header: true,
        header: title,
        wavelength_um,
        columns: vec![column],
        wave_unit: WaveUnit::MICROMETRES,
        percent_help: "divide them by 100 if these are percent",
        report,
    })
}

/// A table of named columns, the first of which is wavelength, and rows of cells.
fn assembled<'a>(
    text: &'a str,
    path: &Path,
    header: &'a str,
    unit: WaveUnit,
    columns: &[(&'a str, &'a str)],
    rows: &[Vec<&'a str>],
    mut report: Report,
) -> Result<SpectralTable<'a>> {
    let mut problems = Problems::default();
    let mut read: Vec<(f64, Vec<Cell<'_>>, &str)> = Vec::with_capacity(rows.len());
    for row in rows {
        let first = row.first().copied().unwrap_or_default();
        if row.len() != columns.len() {
            problems.push(|| {
                let message = match row.len() {
                    1 => "one column: a wavelength and a value, parted by a comma, are needed".to_owned(),
                    n => format!("{n} columns where the header has {}", columns.len()),
                };
                let problem = Problem::new(place(path, text, first), message);
                match row.len() == 2 * columns.len() {
                    true => problem.with_help("is the decimal sign a comma? write a point"),
                    false => problem,
                }
            });
            continue;
        }
        let mut refused = |cell: &str| {
            problems.push(|| {
                let problem = Problem::new(place(path, text, cell), format!("`{cell}` is not a finite number"));
                let has_decimal_comma = cell.matches(',').count() == 1 && is_number(&cell.replace(',', "."));
                if has_decimal_comma { problem.with_help("the decimal sign is a point") } else { problem }
            });
        };
        let wavelength = first.parse::<f64>().ok().filter(|w| w.is_finite());
        if wavelength.is_none() {
            refused(first);
        }
        let values: Vec<_> = row[1..]
            .iter()
            .map(|cell| match cell.parse::<f64>() {
                _ if cell.is_empty() => None,
                Ok(value) if value.is_nan() || value < DELETED_BELOW => None,
                Ok(value) if value.is_finite() => Some((value, *cell)),
                _ => {
                    refused(cell);
                    None
                }
            })
            .collect();
        match wavelength.map(|written| unit.um(written).filter(|um| *um > 0.0)) {
            Some(Some(um)) => read.push((um, values, first)),
            Some(None) => {
                problems.push(|| Problem::new(place(path, text, first), format!("wavelength {first} is not positive")))
            }
            None => {}
        }
    }
    let steps_back = read.windows(2).filter(|w| w[1].0 < w[0].0).count();
    let descends = steps_back > 0 && steps_back + 1 >= read.len();
    if steps_back > 0 && !descends {
        let message = format!("wavelengths step back {steps_back} times: the rows are sorted");
        report.note(Fate::Approximated, place(path, text, header), message);
    }
    read.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rows = read.len();
    let number_of = |value: &Option<(f64, &str)>| value.map(|(number, _)| number);
    read.dedup_by(|next, row| next.0 == row.0 && next.1.iter().map(number_of).eq(row.1.iter().map(number_of)));
    if read.len() < rows {
        let message = format!("{} rows appear twice, wavelength and values: one of each is taken", rows - read.len());
        report.note(Fate::Dropped, place(path, text, header), message);
    }
    for twice in read.windows(2).filter(|w| w[0].0 == w[1].0) {
        let message = format!("wavelength {} appears twice, with different values", twice[1].2);
        problems.push(|| Problem::new(place(path, text, twice[1].2), message).with_help("keep one of the rows"));
    }
    problems.finish(path)?;
    if read.is_empty() {
        let message = "no rows: a header that states units, then at least one row";
        return Err(Error::invalid(Location::file(path), message));
    }
    let table_columns = columns.iter().enumerate().skip(1).map(|(i, (name, cell))| {
        let (name, unit) = of_column(name);
        TableColumn { name, cell, unit, values: read.iter().map(|row| row.1[i - 1]).collect() }
    });
    Ok(SpectralTable {
        name: None,
        comment: vec![],
        has_header: true,
        header,
        columns: table_columns.collect(),
        wave_unit: unit,
        percent_help: "if these are percent, say so in the header: `reflectance_percent`",
        wavelength_um: read.iter().map(|row| row.0).collect(),
        report,
    })
}
