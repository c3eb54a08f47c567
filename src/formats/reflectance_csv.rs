//! Reflectance factors by angles as tables of comma-separated values.
//!
//! Lines that begin with `#` are comments. The first other line is the header: `reflectance_factor`, `incidence_deg`, and where they count
//! `emission_deg`, `azimuth_deg` (of the view from the light's, 0 to 180: 0 where both are on one side) and `wavelength_um` or `wavelength_nm`, in
//! any order. Each further line is one factor; together they fill a grid of all angles and wavelengths that occur, in any order.

use std::io::{self, Write};
use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number};
use crate::physics::reflectance::{Axis, Table};
use crate::scene::Tabulated;
use crate::spectral::Extend;
use crate::units::um_from_nm;

use super::input::{self, InputFile, Problems};

/// Longer files are refused, bytes.
const LIMIT: u64 = 256 << 20;

/// The coordinates of a factor, in the order in which tables have them: the wavelength, then angles.
const COORDINATES: [&str; 4] = ["wavelength_um", "incidence_deg", "emission_deg", "azimuth_deg"];
/// Largest angles of each.
const MOST_DEG: [f64; 4] = [f64::INFINITY, 90.0, 90.0, 180.0];
const FACTOR: &str = "reflectance_factor";
/// None is larger: they are of order 1.
const MOST_FACTOR: f64 = 1e12;

/// Reads a table.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with the lines that cannot be used, and with what the grid lacks.
pub fn read(path: &Path, extend: Extend) -> Result<(Tabulated, InputFile)> {
    let (text, input) = input::text(path, LIMIT)?;
    Ok((parse(&text, path, extend)?, input))
}

/// Reads the text of such a table; `path` is for messages.
///
/// # Errors
/// [`Error::Invalid`], as [`read`].
pub fn parse(text: &str, path: &Path, extend: Extend) -> Result<Tabulated> {
    let mut problems = Problems::default();
    let mut header: Option<Header> = None;
    // Line, coordinates, factor.
    let mut rows: Vec<(usize, [f64; 4], f64)> = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let row = line.trim();
        if row.is_empty() || row.starts_with('#') {
            continue;
        }
        let at = Location::line(path, i + 1);
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        let Some(header) = &header else {
            let message = match Header::new(&cells) {
                Ok(found) => {
                    header = Some(found);
                    continue;
                }
                Err(message) => message,
            };
            let help = "columns are incidence_deg, reflectance_factor, and where they count emission_deg, azimuth_deg, wavelength_um";
            return Err(Error::Invalid(vec![Problem::new(at, message).with_help(help)]));
        };
        match header.row(&cells) {
            Ok((coordinates, factor)) => rows.push((i + 1, coordinates, factor)),
            Err(message) => problems.push(|| Problem::new(at, message)),
        }
    }
    problems.finish(path)?;
    if rows.is_empty() {
        let last = Location::line(path, text.lines().count().max(1));
        return Err(Error::invalid(last, "no rows: a header, then a line for each factor"));
    }
    let axes: [Vec<f64>; 4] = std::array::from_fn(|k| {
        let mut values: Vec<f64> = rows.iter().map(|(_, coordinates, _)| coordinates[k]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    });
    let factors = fill(&axes, &rows, path)?;
    let [um, angles_deg @ ..] = axes;
    let per_table = factors.len() / um.len();
    let tables: Option<Vec<Table>> = factors
        .chunks(per_table)
        .map(|factors| {
            let [incidence, emission, azimuth] =
                angles_deg.clone().map(|angles_deg| Axis::new(angles_deg.into_iter().map(f64::to_radians).collect()));
            Table::bidirectional(incidence?, emission?, azimuth?, factors.to_vec())
        })
        .collect();
    tables
        .and_then(|tables| Tabulated::new(um, tables, extend))
        .ok_or_else(|| Error::invalid(Location::line(path, rows[0].0), "is not a table of reflectance factors"))
}

/// The factors in the order of the axes.
fn fill(axes: &[Vec<f64>; 4], rows: &[(usize, [f64; 4], f64)], path: &Path) -> Result<Vec<f64>> {
    let count = axes.iter().try_fold(1_usize, |count, axis| count.checked_mul(axis.len()));
    // A grid of which most is missing is not a grid: say so before it takes memory.
    let count = count.filter(|count| *count / 2 <= rows.len());
    let Some(count) = count else {
        let sizes: Vec<String> = axes.iter().map(|axis| axis.len().to_string()).collect();
        let message = format!(
            "{} factors do not fill a grid: there are {} wavelengths, incidences, emissions and azimuths",
            rows.len(),
            sizes.join(" x ")
        );
        let first = rows.first().map_or(1, |(line, ..)| *line);
        return Err(Error::invalid(Location::line(path, first), message));
    };
    let mut problems = Problems::default();
    let mut found: Vec<Option<(usize, f64)>> = vec![None; count];
    for (line, coordinates, factor) in rows {
        let place = coordinates
            .iter()
            .zip(axes)
            .fold(0, |place, (value, axis)| place * axis.len() + axis.partition_point(|other| other < value));
        if let Some((before, _)) = found[place] {
            let message = format!("the same angles and wavelength as in line {before}");
            problems.push(|| Problem::new(Location::line(path, *line), message));
        }
        found[place] = Some((*line, *factor));
    }
    problems.finish(path)?;
    let missing = found.iter().filter(|factor| factor.is_none()).count();
    if let Some(first) = found.iter().position(Option::is_none) {
        let mut place = first;
        let mut said: Vec<String> = Vec::new();
        for (axis, name) in axes.iter().zip(COORDINATES).rev() {
            if axis.len() > 1 {
                said.insert(0, format!("{name} {}", number(axis[place % axis.len()])));
            }
            place /= axis.len();
        }
        // It is missing after the one before it in the grid, wherever that is in the file.
        let before = found[..first].iter().rev().chain(&found[first..]).flatten().next().map_or(1, |(line, _)| *line);
        let message = format!("{missing} factors of the grid are missing: the first is that at {}", said.join(", "));
        return Err(Error::invalid(Location::line(path, before), message));
    }
    Ok(found.into_iter().flatten().map(|(_, factor)| factor).collect())
}

/// Where things are in a row.
struct Header {
    in_nanometres: bool,
    /// Of each coordinate, if it is there.
    columns: [Option<usize>; 4],
    factor: usize,
    width: usize,
}

impl Header {
    fn new(cells: &[&str]) -> std::result::Result<Self, String> {
        let mut header = Header { in_nanometres: false, columns: [None; 4], factor: usize::MAX, width: cells.len() };
        for (i, cell) in cells.iter().enumerate() {
            let name = if *cell == "wavelength_nm" { "wavelength_um" } else { cell };
            header.in_nanometres |= *cell == "wavelength_nm";
            let is_twice = match COORDINATES.iter().position(|coordinate| *coordinate == name) {
                Some(k) => header.columns[k].replace(i).is_some(),
                None if name == FACTOR => std::mem::replace(&mut header.factor, i) != usize::MAX,
                None => return Err(format!("`{cell}` is not a column of a table of reflectance factors")),
            };
            if is_twice {
                return Err(format!("there are two columns `{name}`"));
            }
        }
        match (header.columns[1], header.factor) {
            (None, _) => Err("there is no column `incidence_deg`".into()),
            (_, usize::MAX) => Err(format!("there is no column `{FACTOR}`")),
            _ => Ok(header),
        }
    }

    /// Coordinates and factor of a row; coordinates without a column are one value.
    fn row(&self, cells: &[&str]) -> std::result::Result<([f64; 4], f64), String> {
        if cells.len() != self.width {
            return Err(format!("{} cells, where the header has {}", cells.len(), self.width));
        }
        let number_in = |column: usize| {
            let number = cells[column].parse::<f64>().ok().filter(|x| x.is_finite());
            number.ok_or_else(|| format!("`{}` is not a finite number", cells[column]))
        };
        let mut coordinates = [1.0, 0.0, 0.0, 0.0];
        for (k, column) in self.columns.iter().enumerate() {
            let Some(column) = column else { continue };
            let value = number_in(*column)?;
            let least_is_right = if k == 0 { value > 0.0 } else { value >= 0.0 };
            // Nanometres of next to nothing are not micrometres at all.
            let least_is_right = least_is_right && (k != 0 || um_from_nm(value) > 0.0);
            if !least_is_right || value > MOST_DEG[k] {
                let range = if k == 0 { "above 0".to_owned() } else { format!("from 0 to {}", MOST_DEG[k]) };
                return Err(format!("{} {} is out of range, which is {range}", COORDINATES[k], cells[*column]));
            }
            // No -0: it would be an angle of its own.
            coordinates[k] = if k == 0 && self.in_nanometres { um_from_nm(value) } else { value + 0.0 };
        }
        let factor = number_in(self.factor)?;
        if factor < 0.0 {
            return Err(format!("{FACTOR} {} is below 0", cells[self.factor]));
        }
        if factor > MOST_FACTOR {
            return Err(format!("{FACTOR} {} is out of range, which is up to {MOST_FACTOR:e}", cells[self.factor]));
        }
        Ok((coordinates, factor + 0.0))
    }
}

/// Writes a table, as shortest decimals; columns with one value are left out, but for the incidence.
///
/// # Errors
/// What the writer says.
pub fn write(out: &mut impl Write, surface: &Tabulated) -> io::Result<()> {
    let axes =
        |table: &Table| [table.incidence(), table.emission(), table.azimuth()].map(|axis| axis.angles_rad().to_vec());
    let Some(first) = surface.tables().first().map(axes) else { return Ok(()) };
    let is_written = [surface.tables().len() > 1, true, first[1].len() > 1, first[2].len() > 1];
    let names = COORDINATES.iter().zip(is_written).filter(|(_, is_written)| *is_written).map(|(name, _)| *name);
    writeln!(out, "{}", names.chain([FACTOR]).collect::<Vec<_>>().join(","))?;
    let degrees = |rad: f64| super::number::exact(rad.to_degrees(), f64::to_radians, rad);
    for (table, um) in surface.tables().iter().zip(surface.wavelength_um()) {
        let mut factors = table.factors().iter();
        for incidence in &first[0] {
            for emission in &first[1] {
                for azimuth in &first[2] {
                    let angles = [*um, degrees(*incidence), degrees(*emission), degrees(*azimuth)];
                    for (value, _) in angles.iter().zip(is_written).filter(|(_, is_written)| *is_written) {
                        write!(out, "{value},")?;
                    }
                    writeln!(out, "{}", factors.next().copied().unwrap_or(0.0))?;
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Tabulated> {
        parse(text, Path::new("a.csv"), Extend::Error)
    }

    #[test]
    fn rows_come_in_any_order_and_are_written_in_theirs() {
        let text = "# c\nreflectance_factor, emission_deg, incidence_deg, wavelength_nm\n\
                    0.4,60,30,1000\n0.1,0,0,1000\n0.2,60,0,1000\n0.3,0,30,1000\n\
                    0.8,60,30,2000\n0.5,0,0,2000\n0.6,60,0,2000\n0.7,0,30,2000\n";
        let surface = parsed(text).unwrap();
        assert_eq!(surface.wavelength_um(), [1.0, 2.0]);
        assert_eq!(surface.tables()[0].factors(), [0.1, 0.2, 0.3, 0.4]);
        let mut written = Vec::new();
        write(&mut written, &surface).unwrap();
        let written = String::from_utf8(written).unwrap();
        assert!(
            written.starts_with("wavelength_um,incidence_deg,emission_deg,reflectance_factor\n1,0,0,0.1\n"),
            "{written}"
        );
        assert_eq!(parsed(&written).unwrap(), surface);
    }

    #[test]
    fn what_cannot_be_used_is_told_with_its_line() {
        for (text, told) in [
            ("emission_deg,reflectance_factor\n", "a.csv:1: there is no column `incidence_deg`"),
            ("incidence_deg,brf\n", "a.csv:1: `brf` is not a column"),
            ("incidence_deg,incidence_deg,reflectance_factor\n", "a.csv:1: there are two columns `incidence_deg`"),
            ("incidence_deg\n", "a.csv:1: there is no column `reflectance_factor`"),
            ("incidence_deg,reflectance_factor\n", "a.csv:1: no rows"),
            ("incidence_deg,reflectance_factor\n1\n", "a.csv:2: 1 cells, where the header has 2"),
            ("incidence_deg,reflectance_factor\n1,x\n", "a.csv:2: `x` is not a finite number"),
            ("incidence_deg,reflectance_factor\n1,1e308\n", "a.csv:2: reflectance_factor 1e308 is out of range"),
            ("incidence_deg,reflectance_factor\n1,-1\n", "a.csv:2: reflectance_factor -1 is below 0"),
            (
                "incidence_deg,reflectance_factor\n91,1\n",
                "a.csv:2: incidence_deg 91 is out of range, which is from 0 to 90",
            ),
            ("incidence_deg,reflectance_factor\n3,1\n3,1\n", "a.csv:3: the same angles and wavelength as in line 2"),
            (
                "incidence_deg,emission_deg,reflectance_factor\n0,0,1\n0,60,1\n30,0,1\n",
                "a.csv:4: 1 factors of the grid are missing: the first is that at incidence_deg 30, emission_deg 60",
            ),
            (
                "incidence_deg,emission_deg,reflectance_factor\n0,0,1\n1,1,1\n2,2,1\n3,3,1\n4,4,1\n5,5,1\n",
                "a.csv:2: 6 factors do not fill a grid",
            ),
        ] {
            let error = parsed(text).unwrap_err().to_string();
            assert!(error.contains(told), "{text}: {error}");
        }
    }
}
