//! Responses of a sensor's bands, as the filter curves that cameras come with: tables of text.
//!
//! Lines that begin with `#` are comments. The first other line is the header: a wavelength with its unit (`wavelength_nm`, `"Wavelength (um)"`),
//! then a name for each response. Cells are parted by commas, semicolons, tabs or blanks, and may stand in quotation marks. Responses are
//! relative or absolute, in any unit: only their shape counts. An empty cell is not a point of its column; beyond a column's points the
//! response is 0.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number};
use crate::spectral::{Extend, Spectrum};

use super::input::{self, InputFile, Problems};
use super::spectral_heading::of_wavelength;
use super::spectral_table::parted;
use super::table::{doubtful_unit, place};

/// Responses by name, in the file's order, and what is worth knowing of them.
#[derive(Debug, Clone)]
pub struct Responses {
    /// A name, and a response over wavelength, um; not below 0.
    pub columns: Vec<(String, Spectrum)>,
    /// What was not taken literally, as sentences.
    pub notes: Vec<String>,
}

/// Longer files are refused, bytes.
const LIMIT: u64 = 64 << 20;
/// What is below 0 by no more than this share of a response's peak is noise of its measurement, and taken as 0.
const NOISE: f64 = 0.01;
/// A response that ends with more than this share of its peak was perhaps cut off.
const END: f64 = 0.01;

/// Reads a table of responses.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with all cells that cannot be used: no unit of wavelength, no numbers, rows in no order,
/// wavelengths that are there twice with different responses, responses that are negative beyond noise, or nowhere above 0.
pub fn read(path: &Path) -> Result<(Responses, InputFile)> {
    let (text, input) = input::text(path, LIMIT)?;
    Ok((parse(&text, path)?, input))
}

/// Reads the text of a table of responses; `path` is for messages.
///
/// # Errors
/// [`Error::Invalid`], as [`read`].
pub fn parse(text: &str, path: &Path) -> Result<Responses> {
    let lines = text.lines().map(|line| line.trim_start_matches('\u{feff}').trim());
    let mut lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    let header_help = "the first line is `wavelength_nm` or `wavelength_um`, then a name for each response";
    let refused = |at: &str, message: String, help: &str| {
        Err(Error::Invalid(vec![Problem::new(place(path, text, at), message).with_help(help)]))
    };
    let Some(header) = lines.next() else {
        return Err(Error::Invalid(vec![Problem::new(Location::file(path), "is empty").with_help(header_help)]));
    };
    let lines: Vec<&str> = lines.collect();
    let (names, lines) = parted(header, false, &lines);
    let unit = match of_wavelength(names[0]) {
        Ok(Some(unit)) => unit,
        Ok(None) => {
            let message = format!("the header begins with `{}`, which does not state a unit of wavelength", names[0]);
            return refused(names[0], message, header_help);
        }
        Err((message, help)) => return refused(names[0], message, &help),
    };
    if names.len() < 2 {
        return refused(header, "one column: wavelengths and at least one response are needed".into(), header_help);
    }
    let mut problems = Problems::default();
    let mut rows: Vec<(&str, f64, Vec<Option<f64>>)> = Vec::new();
    for cells in lines {
        let line = cells.first().copied().unwrap_or_default();
        if cells.len() != names.len() {
            let message = format!("{} columns where the header has {}", cells.len(), names.len());
            problems.push(|| Problem::new(place(path, text, line), message));
            continue;
        }
        let mut numbers = Vec::with_capacity(cells.len());
        for (i, cell) in cells.iter().enumerate() {
            let is_blank = i > 0 && (cell.is_empty() || cell.eq_ignore_ascii_case("nan"));
            match cell.parse::<f64>() {
                _ if is_blank => numbers.push(None),
                Ok(x) if x.is_finite() && (i > 0 || x > 0.0) => numbers.push(Some(x)),
                _ => {
                    let wanted = if i == 0 { "wavelength" } else { "number" };
                    let at = if cell.is_empty() { line } else { cell };
                    problems.push(|| Problem::new(place(path, text, at), format!("`{cell}` is not a {wanted}")));
                }
            }
        }
        if numbers.len() == cells.len() {
            let wavelength = numbers[0].unwrap_or_default();
            let um = unit.um(wavelength).unwrap_or_default();
            rows.push((cells[0], um, numbers.split_off(1)));
        }
    }
    let mut notes = Vec::new();
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if let (Some((_, first, _)), Some((_, last, _))) = (rows.first(), rows.last())
        && first > last
    {
        rows.reverse();
        notes.push(format!("{name}: rows descend in wavelength: turned"));
    }
    let disorder = rows.windows(2).find(|pair| pair[1].1 < pair[0].1);
    if let Some(pair) = disorder {
        let message = format!("wavelength {} is out of order: rows ascend, or descend", pair[1].0);
        problems.push(|| Problem::new(place(path, text, pair[1].0), message));
    }
    let all_um: Vec<f64> = rows.iter().map(|row| row.1).collect();
    if let Some(doubt) = doubtful_unit(unit, &all_um) {
        notes.push(format!("{name}: {doubt}"));
    }
    let mut columns = Vec::new();
    let mut known = BTreeSet::new();
    for (i, column) in names[1..].iter().enumerate() {
        if column.is_empty() || !known.insert(column.to_ascii_lowercase()) {
            let message =
                if column.is_empty() { "a column has no name".into() } else { format!("`{column}` appears twice") };
            let at = if column.is_empty() { header } else { column };
            problems.push(|| Problem::new(place(path, text, at), message));
            continue;
        }
        let points: Vec<(&str, f64, f64)> =
            rows.iter().filter_map(|(cell, um, values)| Some((*cell, *um, values[i]?))).collect();
        let peak = points.iter().map(|p| p.2).fold(0.0, f64::max);
        if peak <= 0.0 || points.len() < 2 {
            let message = format!("the response `{column}` has nothing above 0: at least two points are needed");
            problems.push(|| Problem::new(place(path, text, column), message));
            continue;
        }
        let (mut um, mut value): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        let (mut noisy, mut least, mut doubled) = (0, 0.0_f64, 0);
        for (cell, at_um, response) in points {
            if response < -NOISE * peak {
                let message = format!("the response `{column}` is {} there, which is negative", number(response));
                let help = "mark what was not measured by an empty cell";
                problems.push(|| Problem::new(place(path, text, cell), message).with_help(help));
                continue;
            }
            noisy += u64::from(response < 0.0);
            least = least.min(response);
            let response = response.max(0.0);
            match um.last() {
                Some(last) if *last == at_um && value.last() == Some(&response) => doubled += 1,
                Some(last) if *last == at_um => {
                    let message = format!("wavelength {cell} appears twice, with different responses `{column}`");
                    problems.push(|| Problem::new(place(path, text, cell), message));
                }
                // Rows out of order are reported already.
                Some(last) if *last > at_um => {}
                _ => {
                    um.push(at_um);
                    value.push(response);
                }
            }
        }
        if noisy > 0 {
            notes.push(format!(
                "{name}, {column}: {noisy} responses below 0, down to {}, are taken as 0",
                number(least)
            ));
        }
        if doubled > 0 {
            notes.push(format!("{name}, {column}: {doubled} rows appear twice"));
        }
        let ends = [value.first(), value.last()].map(|v| v.copied().unwrap_or_default() / peak);
        if ends[0].max(ends[1]) > END && um.len() > 2 {
            notes.push(format!(
                "{name}, {column}: it ends with {:.0} % of its peak, and is 0 beyond: does the table hold all of it?",
                100.0 * ends[0].max(ends[1])
            ));
        }
        if let Some(spectrum) = Spectrum::new(um, value, Extend::Error).filter(|s| s.wavelength_um().len() > 1) {
            columns.push(((*column).to_owned(), spectrum));
        } else {
            let message = format!("the response `{column}` is not a table: at least two wavelengths are needed");
            problems.push(|| Problem::new(place(path, text, column), message));
        }
    }
    problems.finish(path)?;
    Ok(Responses { columns, notes })
}

/// Writes responses as the columns of a table, by their names, or as `band_1`, `band_2` ... where they have none, or one that no header
/// holds, or one twice; a column has no cell where it has no point.
///
/// # Errors
/// Those of the output.
pub fn write(out: &mut impl Write, responses: &[(&str, &Spectrum)]) -> io::Result<()> {
    let mut all_um: Vec<f64> = responses.iter().flat_map(|r| r.1.wavelength_um()).copied().collect();
    all_um.sort_by(f64::total_cmp);
    all_um.dedup();
    let is_plain = |name: &str| {
        !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || "_-. ".contains(c)) && name.trim() == name
    };
    let mut times: BTreeMap<String, usize> = BTreeMap::new();
    responses.iter().for_each(|r| *times.entry(r.0.to_ascii_lowercase()).or_default() += 1);
    // In whatever capitals it is written: names are read as if in one.
    let is_own = |name: &str| {
        let name = name.to_ascii_lowercase();
        times.get(&name) == Some(&1) && !name.starts_with("band_")
    };
    write!(out, "wavelength_um")?;
    for (i, (name, _)) in responses.iter().enumerate() {
        match is_plain(name) && is_own(name) {
            true => write!(out, ",{name}")?,
            false => write!(out, ",band_{}", i + 1)?,
        }
    }
    writeln!(out)?;
    for um in all_um {
        write!(out, "{um:?}")?;
        for (_, response) in responses {
            match response.wavelength_um().binary_search_by(|x| x.total_cmp(&um)) {
                Ok(i) => write!(out, ",{:?}", response.value()[i])?,
                Err(_) => write!(out, ",")?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Responses> {
        parse(text, Path::new("filter.csv"))
    }

    fn told(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    #[test]
    fn tables_as_cameras_come_with_them() {
        let responses =
            read("# made by hand\n\"Wavelength (nm)\";\"Red; wide\";Blue\n700;0.5;\n600;1.0;-0.001\n500;0;2\n")
                .unwrap();
        let names: Vec<&str> = responses.columns.iter().map(|c| c.0.as_str()).collect();
        assert_eq!(names, ["Red; wide", "Blue"]);
        assert_eq!(responses.columns[0].1.wavelength_um(), [0.5, 0.6, 0.7]);
        assert_eq!(responses.columns[1].1.value(), [2.0, 0.0]);
        let notes = responses.notes.join("\n");
        assert!(notes.contains("turned") && notes.contains("below 0") && notes.contains("50 % of its peak"), "{notes}");
        // Angstrom, parted by blanks.
        let blanks = read("Wavelength (Angstrom)   Red  Blue\n5000  0    1\n6000  1  nan\n  7000 0  0\n").unwrap();
        assert_eq!(blanks.columns[0].1.wavelength_um(), [0.5, 0.6, 0.7]);
        assert_eq!((blanks.columns[1].0.as_str(), blanks.columns[1].1.wavelength_um()), ("Blue", &[0.5, 0.7][..]));
        for header in ["wavelength_um", "WAVELENGTH_UM", "lambda [\u{b5}m]", "\u{3bc}m", "Microns"] {
            let text = format!("\u{feff}{header},r\n0.5,0\n0.6,1\n0.7,0\n");
            assert_eq!(read(&text).unwrap().columns[0].1.wavelength_um(), [0.5, 0.6, 0.7], "{header}");
        }
    }

    #[test]
    fn what_is_written_is_read_back_whatever_it_is_called() {
        let text = "wavelength_um;Band_2;F (1);f,2;G;g.\n1;1;2;3;4;5\n2;1;2;3;4;5\n";
        let responses = read(text).unwrap().columns;
        let named: Vec<(&str, &Spectrum)> = responses.iter().map(|(name, table)| (name.as_str(), table)).collect();
        let mut written = Vec::new();
        write(&mut written, &named).unwrap();
        let back = read(std::str::from_utf8(&written).unwrap()).unwrap().columns;
        assert!(back.iter().map(|c| &c.1).eq(responses.iter().map(|c| &c.1)));
        let names: Vec<&str> = back.iter().map(|c| c.0.as_str()).collect();
        assert_eq!(names, ["band_1", "band_2", "band_3", "G", "g."]);
    }

    #[test]
    fn what_is_no_response_is_told_at_its_place() {
        assert!(told("wavelength,r\n1,1\n").contains("unit of wavelength"));
        assert!(told("wavelength_um\n1\n").contains("one column"));
        assert!(told("wavelength_um,r\n1,1\n2,-0.5\n3,1\n").contains("filter.csv:3:1"));
        assert!(told("wavelength_um,r\n1,1\n2,0.5\n2,0.6\n3,1\n").contains("appears twice"));
        assert!(told("wavelength_um,r\n1,1\n3,0.5\n2,0.6\n4,1\n").contains("out of order"));
        assert!(told("wavelength_um,r\n1,0\n3,0\n").contains("nothing above 0"));
        assert!(told("wavelength_um,r,R\n1,1,1\n3,1,1\n").contains("appears twice"));
        // Filters of the far infrared look so too.
        assert!(read("wavelength_um,r\n400,1\n700,1\n").unwrap().notes[0].contains("nanometres"));
        assert!(told("wavelength_um,r\n1,1,2\n3,x\n").lines().count() >= 2);
        assert!(told("").contains("is empty"));
    }
}
