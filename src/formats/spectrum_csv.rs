//! Spectra as tables of comma-separated values.
//!
//! Lines that begin with `#` are comments. The first other line is the header: its first column is `wavelength_um` or
//! `wavelength_nm`; its second names the quantity and its unit: `reflectance`, `emissivity` or `albedo` (fractions), the
//! same with `_percent`, `irradiance_w_m2_um` or `irradiance_w_m2_nm`. Further columns (an uncertainty, say) are passed
//! over by [`read`], which a scene's materials use. Rows ascend in wavelength.
//!
//! [`read_all`] takes every column, as a spectrum of that name: several quantities of one material (`reflectance,k,g,h`), or
//! of several (`basalt,olivine:reflectance_percent,olivine:emissivity`; a name alone stands for reflectance).

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number};
use crate::report::{Fate, Report};
use crate::spectral::{Column, Extend, SpectralLibrary, Spectrum};
use crate::units::{fraction_from_percent, um_from_nm};

use super::dart::kind::Kind;
use super::folder::Staged;
use super::input::{self, InputFile, Problems};
use super::table::{self, Reading, Row, flat, gathered, is_plain, parts, place};

/// What a table must hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Reflectance, emissivity or albedo, 0 to 1.
    Fraction,
    /// Spectral irradiance, W m-2 um-1.
    Irradiance,
}

/// Longer files are refused, bytes.
const LIMIT: u64 = 64 << 20;

/// Reads a spectrum, in um and fractions or W m-2 um-1.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with the lines that cannot be used: no header that states both units, fewer
/// columns than two, what is no finite number, wavelengths that do not ascend, fractions outside 0 to 1.
pub fn read(path: &Path, quantity: Quantity, extend: Extend) -> Result<(Spectrum, InputFile)> {
    let (text, input) = input::text(path, LIMIT)?;
    Ok((parse(&text, path, quantity, extend)?, input))
}

/// Reads the text of a spectrum; `path` is for messages.
///
/// # Errors
/// [`Error::Invalid`], as [`read`].
pub fn parse(text: &str, path: &Path, quantity: Quantity, extend: Extend) -> Result<Spectrum> {
    let mut problems = Problems::default();
    let mut table: Option<Table> = None;
    let mut header_at = Location::file(path);
    for (i, line) in text.lines().enumerate() {
        let at = |cell: &str| {
            let start = cell.as_ptr() as usize - text.as_ptr() as usize;
            let column = cell.as_ptr() as usize - line.as_ptr() as usize;
            let column = line.get(..column).map(|before| before.chars().count() + 1);
            Location { column, span: Some((start, start + cell.len())), ..Location::line(path, i + 1) }
        };
        let row = line.trim();
        if row.is_empty() || row.starts_with('#') {
            continue;
        }
        let mut cells = row.split(',').map(str::trim);
        let (Some(first), Some(second)) = (cells.next(), cells.next()) else {
            problems
                .push(|| Problem::new(at(row), "one column: a wavelength and a value, parted by a comma, are needed"));
            if table.is_none() {
                break;
            }
            continue;
        };
        let Some(table) = &mut table else {
            table = Table::from_header(first, second, quantity);
            if table.is_some() {
                header_at = at(first);
                continue;
            }
            problems.push(|| {
                let expected = match quantity {
                    Quantity::Fraction => "`reflectance` or `reflectance_percent` (emissivity and albedo likewise)",
                    Quantity::Irradiance => "`irradiance_w_m2_um` or `irradiance_w_m2_nm`",
                };
                let message = format!("the header `{first},{second}` does not state the units");
                let help = format!("the first line is `wavelength_um` or `wavelength_nm`, then {expected}");
                Problem::new(at(row), message).with_help(help)
            });
            break;
        };
        if let Err(Refused { cell, message, help }) = table.row(first, second) {
            problems.push(|| Problem { at: at(cell), message, help: help.map(str::to_owned) });
        }
    }
    let (wavelength_um, value) = table.map(|table| (table.wavelength_um, table.value)).unwrap_or_default();
    if let Some(problem) = suspect_unit(&wavelength_um, header_at) {
        problems.push(|| problem);
    }
    problems.finish(path)?;
    Spectrum::new(wavelength_um, value, extend).ok_or_else(|| {
        Error::invalid(Location::file(path), "no rows: a header that states units, then at least one row")
    })
}

/// The rows so far, and their units.
struct Table {
    quantity: Quantity,
    /// Wavelengths are nm, not um.
    in_nanometres: bool,
    /// What makes values fractions or W m-2 um-1.
    unit: f64,
    wavelength_um: Vec<f64>,
    value: Vec<f64>,
    /// The wavelength of the last row, also if its value was refused.
    last_um: f64,
}

/// A cell that cannot be used, and why.
struct Refused<'a> {
    cell: &'a str,
    message: String,
    help: Option<&'static str>,
}

impl Table {
    fn from_header(first: &str, second: &str, quantity: Quantity) -> Option<Self> {
        let in_nanometres = match first {
            "wavelength_um" => false,
            "wavelength_nm" => true,
            _ => return None,
        };
        let fraction = |name: &str| ["reflectance", "emissivity", "albedo"].contains(&name);
        let unit = match quantity {
            Quantity::Fraction if fraction(second) => 1.0,
            Quantity::Fraction if second.strip_suffix("_percent").is_some_and(fraction) => 0.01,
            Quantity::Irradiance if second == "irradiance_w_m2_um" => 1.0,
            Quantity::Irradiance if second == "irradiance_w_m2_nm" => 1000.0,
            _ => return None,
        };
        Some(Table { quantity, in_nanometres, unit, wavelength_um: vec![], value: vec![], last_um: 0.0 })
    }

    fn row<'a>(&mut self, first: &'a str, second: &'a str) -> std::result::Result<(), Refused<'a>> {
        let refused = |cell, message| Refused { cell, message, help: None };
        let number = |cell: &'a str| match cell.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(refused(cell, format!("`{cell}` is not a finite number"))),
        };
        let (wavelength, value) = (number(first)?, number(second)? * self.unit);
        let um = if self.in_nanometres { um_from_nm(wavelength) } else { wavelength };
        if um <= self.last_um {
            let message = match um {
                _ if um <= 0.0 => format!("wavelength {first} is not positive"),
                _ if um == self.last_um => format!("wavelength {first} is there twice"),
                _ => format!("wavelength {first} is less than the one before it: sort the rows"),
            };
            return Err(refused(first, message));
        }
        self.last_um = um;
        match self.quantity {
            Quantity::Fraction if !(0.0..=1.0).contains(&value) => {
                let message = format!("{second} is outside 0 to {}", 1.0 / self.unit);
                let is_percent = self.unit == 1.0 && value > 1.0;
                let help = "if these are percent, say so in the header: `reflectance_percent`";
                Err(Refused { cell: second, message, help: is_percent.then_some(help) })
            }
            Quantity::Irradiance if value < 0.0 => Err(refused(second, format!("irradiance {second} is negative"))),
            _ => {
                self.wavelength_um.push(um);
                self.value.push(value);
                Ok(())
            }
        }
    }
}

/// A table that has no wavelength between 0.1 and 100 um is in another unit than its header says.
fn suspect_unit(wavelength_um: &[f64], header_at: Location) -> Option<Problem> {
    let (first_um, last_um) = (*wavelength_um.first()?, *wavelength_um.last()?);
    let help = if first_um > 100.0 {
        "these look like nanometres: is the header `wavelength_nm`?"
    } else if last_um < 0.1 {
        "these look like micrometres: is the header `wavelength_um`?"
    } else {
        return None;
    };
    let message = format!("wavelengths from {} to {} um", number(first_um), number(last_um));
    Some(Problem::new(header_at, message).with_help(help))
}

/// Reads all spectra of a table. Those of one material are named by the file.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with all cells that cannot be used, as [`read`].
pub fn read_all(path: &Path) -> Result<Vec<SpectralLibrary>> {
    let (text, _) = input::text(path, LIMIT)?;
    parse_all(&text, path)
}

/// Reads the text of a table with any number of spectra; `path` names them if they are of one material, and is for messages.
///
/// # Errors
/// [`Error::Invalid`], as [`read_all`].
pub fn parse_all(text: &str, path: &Path) -> Result<Vec<SpectralLibrary>> {
    let mut comment = Vec::new();
    let mut lines = Vec::new();
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
        match line.strip_prefix('#') {
            Some(said) => comment.push(said.strip_prefix(' ').unwrap_or(said)),
            None => lines.push(Row { cells: line.split(',').map(str::trim).collect() }),
        }
    }
    let Some((header, rows)) = lines.split_first() else {
        return Err(table::no_header(path, "the first line is `wavelength_um,reflectance`, or more columns"));
    };
    let first = header.cells[0];
    let convert = match first {
        "wavelength_um" => |um| um,
        "wavelength_nm" => um_from_nm,
        _ => {
            let message = format!("the header begins with `{first}`, which does not state the unit");
            let problem = Problem::new(place(path, text, first), message);
            return Err(Error::Invalid(vec![problem.with_help("begin it with `wavelength_um` or `wavelength_nm`")]));
        }
    };
    let mut readings = vec![Reading { name: "wavelength".into(), convert, unit: 1.0 }];
    // One material's quantities, or labels of many.
    let labelled: Vec<(&str, bool)> = header.cells[1..].iter().map(|cell| in_percent(cell)).collect();
    let one = of_one_material(labelled.iter().map(|l| l.0));
    for (label, percent) in &labelled {
        let name = if one { label } else { parts(label).1 }.to_owned();
        readings.push(match percent {
            true => Reading { name, convert: fraction_from_percent, unit: 100.0 },
            false => Reading { name, convert: |x| x, unit: 1.0 },
        });
    }
    if labelled.is_empty() {
        return Err(Error::invalid(
            place(path, text, first),
            "one column: a wavelength and values, parted by commas, are needed",
        ));
    }
    let mut known = BTreeSet::new();
    for (i, (label, _)) in labelled.iter().enumerate() {
        if label.is_empty() || !known.insert(label.to_ascii_lowercase()) {
            let message =
                if label.is_empty() { "a column has no name".into() } else { format!("`{label}` is there twice") };
            return Err(Error::invalid(place(path, text, header.cells[i + 1]), message));
        }
    }
    let mut values = table::numbers(path, text, rows, &readings)?;
    let wavelength_um = values.remove(0);
    if let Some(problem) = suspect_unit(&wavelength_um, place(path, text, first)) {
        return Err(Error::Invalid(vec![problem]));
    }
    if one {
        let columns = labelled.iter().zip(values).map(|(l, values)| Column { name: l.0.to_owned(), values });
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        return Ok(vec![SpectralLibrary {
            name,
            comment: comment.join("\n"),
            wavelength_um,
            columns: columns.collect(),
        }]);
    }
    let labels = labelled.iter().zip(values);
    Ok(gathered(labels.map(|(l, values)| (l.0.to_owned(), wavelength_um.clone(), values)).collect()))
}

/// Whether columns are quantities of one material, not names of several.
fn of_one_material<'a>(names: impl Iterator<Item = &'a str> + Clone) -> bool {
    const QUANTITIES: [&str; 3] = ["reflectance", "emissivity", "albedo"];
    Kind::of(names.clone()) != Kind::Other || names.clone().any(|name| QUANTITIES.contains(&name))
}

/// A column's name without what says that it is in percent.
fn in_percent(cell: &str) -> (&str, bool) {
    match cell.strip_suffix("_percent") {
        Some(name) => (name, true),
        None => (cell, false),
    }
}

/// Writes spectra as one table, in um and fractions: those of one material, or of several with the same wavelengths.
///
/// The report tells comments that several materials have, for which there is no place.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] if the file exists and is not to be replaced, for spectra whose wavelengths differ, for
/// names that a header cannot hold.
pub fn write(path: &Path, spectra: &[SpectralLibrary], replace: bool) -> Result<Report> {
    let mut report = Report::default();
    let mut text = String::new();
    let (wavelength_um, columns) = match spectra {
        [one] => {
            one.check()?;
            text.extend(one.comment.lines().map(|line| format!("# {line}\n")));
            let columns = one.columns.iter().map(|c| (c.name.clone(), c.values.as_slice())).collect();
            (one.wavelength_um.as_slice(), columns)
        }
        several => {
            for library in several.iter().filter(|library| !library.comment.is_empty()) {
                let at = Location::file(path).with_item(format!("spectra of {:?}", library.name));
                report.note(Fate::Dropped, at, "a table of several materials has no place for comments");
            }
            flat(path, several)?
        }
    };
    let names: Vec<&str> = columns.iter().map(|c| c.0.as_str()).collect();
    if let Some(name) = names.iter().find(|name| !is_plain(name) || in_percent(name).1) {
        return Err(Error::invalid(Location::file(path), format!("{name:?} cannot be the name of a column")));
    }
    let one = of_one_material(names.iter().copied());
    if one != (spectra.len() == 1) {
        let message = match one {
            true => "these names would be read as quantities of one material",
            false => "none of its columns says what is known of the material, as `reflectance` does",
        };
        return Err(Error::invalid(Location::file(path), format!("{}: {message}", names.join(", "))));
    }
    let _ = writeln!(text, "wavelength_um,{}", names.join(","));
    for (i, um) in wavelength_um.iter().enumerate() {
        let _ = write!(text, "{}", number(*um));
        columns.iter().for_each(|(_, values)| text.push_str(&format!(",{}", number(values[i]))));
        text.push('\n');
    }
    let staged = Staged::file(path, replace)?;
    std::fs::write(staged.path(), text).map_err(|e| staged.named(Error::io(staged.path(), "writing", e)))?;
    staged.commit()?;
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str, quantity: Quantity) -> String {
        parse(text, Path::new("a.csv"), quantity, Extend::Error).unwrap_err().to_string()
    }

    #[test]
    fn units_are_those_of_the_header() {
        let a = "# assumed\nwavelength_um,reflectance,sigma\n0.5,0.05,0.01\n\n1.0,0.125,0.01\n";
        let b = "wavelength_nm, reflectance_percent\r\n500,5\r\n1000,12.5\r\n";
        for text in [a, b] {
            let s = parse(text, Path::new("a.csv"), Quantity::Fraction, Extend::Error).unwrap();
            assert_eq!((s.wavelength_um(), s.value()), (&[0.5, 1.0][..], &[0.05, 0.125][..]));
        }
        let s = parse("wavelength_nm,irradiance_w_m2_nm\n500,2\n", Path::new("a"), Quantity::Irradiance, Extend::Hold)
            .unwrap();
        assert_eq!((s.wavelength_um(), s.value()), (&[0.5][..], &[2000.0][..]));
    }

    #[test]
    fn every_bad_row_is_told_with_its_place() {
        let text = "wavelength_um,reflectance\n1,0.1\n2, x\n3\n2.5,nan\n0.5,0.1\n1,0.1\n4,7\n-1,0.1\n5,-0.1\n";
        let told = told(text, Quantity::Fraction);
        let expected = [
            "a.csv:3:4: `x` is not a finite number",
            "a.csv:4:1: one column",
            "a.csv:5:5: `nan` is not",
            "a.csv:6:1: wavelength 0.5 is less than",
            "a.csv:7:1: wavelength 1 is there twice",
            "a.csv:8:3: 7 is outside 0 to 1 (help: if these are percent",
            "a.csv:9:1: wavelength -1 is not positive",
            "a.csv:10:3: -0.1 is outside 0 to 1",
        ];
        assert_eq!(told.lines().count(), expected.len(), "{told}");
        for (line, expected) in told.lines().zip(expected) {
            assert!(line.starts_with(expected), "{line}");
        }
    }

    #[test]
    fn a_header_without_units_is_refused() {
        for text in ["0.5,0.1\n1,0.1\n", "lambda,red\n1,2\n", "wavelength_um,irradiance_w_m2_um\n1,2\n"] {
            assert!(told(text, Quantity::Fraction).contains("a.csv:1:1: the header"), "{text}");
        }
        assert!(told("wavelength_um,reflectance\n1,0.1\n", Quantity::Irradiance).contains("irradiance_w_m2_nm"));
        assert!(told("# nothing\n", Quantity::Fraction).contains("no rows"));
        assert!(told("wavelength\n", Quantity::Fraction).contains("one column"));
    }

    #[test]
    fn nanometres_that_are_called_micrometres_are_suspected() {
        assert!(told("wavelength_um,reflectance\n400,0.1\n2500,0.1\n", Quantity::Fraction).contains("nanometres"));
        assert!(told("wavelength_nm,reflectance\n0.4,0.1\n2.5,0.1\n", Quantity::Fraction).contains("micrometres"));
    }
}
