//! Parameters of photometric models as tables of comma-separated values.
//!
//! Lines that begin with `#` are comments. The first other line is the header: its first column is `wavelength_um` or
//! `wavelength_nm`; the parameters are found by their names, in any order, and other columns are ignored. Rows ascend in
//! wavelength.

use std::io::{self, Write};
use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::scene::out_of_parameters;
use crate::spectral::{Extend, Spectrum};
use crate::units::um_from_nm;

use super::input::{self, InputFile, Problems};

/// Longer files are refused, bytes.
const LIMIT: u64 = 64 << 20;

/// Reads the columns of these names, in their order.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with the lines that cannot be used: a header without a wavelength or one of the names, a row
/// of another length, values that are not finite numbers or out of range, wavelengths that do not ascend.
pub fn read<const N: usize>(path: &Path, names: [&str; N], extend: Extend) -> Result<([Spectrum; N], InputFile)> {
    let (text, input) = input::text(path, LIMIT)?;
    Ok((parse(&text, path, names, extend)?, input))
}

/// Reads the text of such a table; `path` is for messages.
///
/// # Errors
/// [`Error::Invalid`], as [`read`].
pub fn parse<const N: usize>(text: &str, path: &Path, names: [&str; N], extend: Extend) -> Result<[Spectrum; N]> {
    let mut problems = Problems::default();
    let mut header: Option<Header<N>> = None;
    let mut wavelength_um: Vec<f64> = Vec::new();
    let mut values: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    for (i, line) in text.lines().enumerate() {
        let row = line.trim();
        if row.is_empty() || row.starts_with('#') {
            continue;
        }
        let at = Location::line(path, i + 1);
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        let Some(header) = &header else {
            match Header::new(&cells, names) {
                Ok(found) => header = Some(found),
                Err(message) => {
                    let expected = names.join(", ");
                    let help = format!("the first line is `wavelength_um` or `wavelength_nm`, then {expected}");
                    return Err(Error::Invalid(vec![Problem::new(at, message).with_help(help)]));
                }
            }
            continue;
        };
        if cells.len() != header.width {
            problems.push(|| Problem::new(at, format!("{} cells, where the header has {}", cells.len(), header.width)));
            continue;
        }
        let number = |cell: &str| cell.parse::<f64>().ok().filter(|x| x.is_finite());
        let wanted = std::iter::once(0).chain(header.columns);
        if let Some(column) = wanted.clone().find(|&c| number(cells[c]).is_none()) {
            problems.push(|| Problem::new(at, format!("`{}` is not a finite number", cells[column])));
            continue;
        }
        let mut numbers = wanted.filter_map(|c| number(cells[c]));
        let wavelength = numbers.next().unwrap_or(0.0);
        let um = if header.in_nanometres { um_from_nm(wavelength) } else { wavelength };
        if um <= wavelength_um.last().copied().unwrap_or(0.0) {
            problems.push(|| Problem::new(at, format!("wavelength {} is not above the one before it, or 0", cells[0])));
            continue;
        }
        let found: Vec<f64> = numbers.collect();
        if let Some(message) = names.iter().zip(&found).find_map(|(name, value)| out_of_parameters(name, *value)) {
            problems.push(|| Problem::new(at, message));
            continue;
        }
        wavelength_um.push(um);
        values.iter_mut().zip(found).for_each(|(column, value)| column.push(value));
    }
    problems.finish(path)?;
    let spectra = values.map(|value| Spectrum::new(wavelength_um.clone(), value, extend));
    if spectra.iter().any(Option::is_none) {
        return Err(Error::invalid(Location::file(path), "no rows: a header, then at least one row"));
    }
    Ok(spectra.map(|spectrum| spectrum.unwrap_or_else(|| Spectrum::constant(0.0))))
}

/// Where things are in a row.
struct Header<const N: usize> {
    in_nanometres: bool,
    columns: [usize; N],
    width: usize,
}

impl<const N: usize> Header<N> {
    fn new(cells: &[&str], names: [&str; N]) -> std::result::Result<Self, String> {
        let in_nanometres = match cells[0] {
            "wavelength_um" => false,
            "wavelength_nm" => true,
            other => return Err(format!("the first column is `{other}`, which is not a wavelength with a unit")),
        };
        let mut columns = [0; N];
        for (column, name) in columns.iter_mut().zip(names) {
            // What optical databases call it.
            let is_it = |cell: &str| cell == name || (name == "rho0" && cell == "reflectance");
            let mut found = (0..cells.len()).filter(|&c| is_it(cells[c]));
            match (found.next(), found.next()) {
                (Some(c), None) => *column = c,
                (None, _) => return Err(format!("there is no column `{name}`")),
                (Some(_), Some(_)) => return Err(format!("there are two columns `{name}`")),
            }
        }
        Ok(Header { in_nanometres, columns, width: cells.len() })
    }
}

/// Writes columns that share their wavelengths, as shortest decimals.
///
/// # Errors
/// What the writer says.
pub fn write(out: &mut impl Write, columns: &[(&str, &Spectrum)]) -> io::Result<()> {
    let Some((_, first)) = columns.first() else { return Ok(()) };
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    writeln!(out, "wavelength_um,{}", names.join(","))?;
    for (i, um) in first.wavelength_um().iter().enumerate() {
        write!(out, "{um}")?;
        for (_, spectrum) in columns {
            write!(out, ",{}", spectrum.value()[i])?;
        }
        writeln!(out)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 2] = ["k", "g"];

    fn parsed(text: &str) -> Result<[Spectrum; 2]> {
        parse(text, Path::new("a.csv"), NAMES, Extend::Error)
    }

    #[test]
    fn columns_are_found_by_name() {
        let [k, g] = parsed("# c\nwavelength_nm, g, note, k\n500, -0.1, 9, 0.8\n1000, -0.2, 9, 0.7\n").unwrap();
        assert_eq!((k.wavelength_um(), k.value()), (&[0.5, 1.0][..], &[0.8, 0.7][..]));
        assert_eq!(g.value(), [-0.1, -0.2]);
        let mut written = Vec::new();
        write(&mut written, &[("k", &k), ("g", &g)]).unwrap();
        assert_eq!(parsed(std::str::from_utf8(&written).unwrap()).unwrap(), [k, g]);
    }

    #[test]
    fn what_cannot_be_used_is_told_with_its_line() {
        for (text, told) in [
            ("um,k,g\n", "a.csv:1: the first column is `um`"),
            ("wavelength_um,k\n1,2\n", "a.csv:1: there is no column `g`"),
            ("wavelength_um,k,g,k\n", "a.csv:1: there are two columns `k`"),
            ("wavelength_um,k,g\n1,2\n", "a.csv:2: 2 cells, where the header has 3"),
            ("wavelength_um,k,g\n1,2,x\n", "a.csv:2: `x` is not a finite number"),
            ("wavelength_um,k,g\n2,2,0.2\n1,2,0.2\n", "a.csv:3: wavelength 1 is not above"),
            ("wavelength_um,k,g\n1,2,0.2\n2,2,1\n", "a.csv:3: g = 1 is out of range"),
            ("wavelength_um,k,g\n", "no rows"),
        ] {
            let error = parsed(text).unwrap_err().to_string();
            assert!(error.contains(told), "{text}: {error}");
        }
    }
}
