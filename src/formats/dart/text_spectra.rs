//! DART's spectra in text: what its database manager imports (`2D-LAM_<name>.txt`), and what versions before 5.7 read themselves.
//!
//! The former has `#` comments, a header, and columns parted by `;`. The latter has comments between asterisks, the last
//! of which names the columns, and columns separated by blanks. Both are in um and percent.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number};
use crate::report::{Fate, Report};
use crate::spectral::{Column, SpectralLibrary};
use crate::units::fraction_from_percent;

use super::super::folder::Staged;
use super::super::format::{Format, Holds};
use super::super::input;
use super::super::table::{self, Reading, Row, place};
use super::kind::{DartTable, TableKind, check_order, is_percent, is_wavelength, suspect_fractions};

/// DART's spectra as text: one material in a file.
pub(in crate::formats) static TEXT: Format = Format {
    name: "dart-text",
    extensions: &["txt"],
    reads: "DART spectra",
    writes: "the same",
    mark: &[],
    told: Some(|path, beginning| {
        table::beginning(path, beginning).filter(|text| begins(path, text)).map(|_| path.to_owned())
    }),
    holds: Holds::Spectra {
        read: |path| read(path).map(|(library, report)| (vec![library], report)),
        stage: |path, spectra, replace| match spectra {
            [one] => stage(path, one, replace),
            _ => {
                let message = format!("cannot hold {} materials: name a folder", spectra.len());
                let help = "a name without an ending, and --to dart-text; or take one of them with --model";
                Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
            }
        },
        file_of: Some(file_name),
    },
};

/// Longer files are refused, bytes.
const LIMIT: u64 = 64 << 20;
/// What the names of files with a Lambertian material begin with.
pub(crate) const PREFIX: &str = "2D-LAM_";
/// The same in version 5.4.
const PREFIX_5_4: &str = "2D_";

/// Whether a text is one of DART's: it begins with a comment between asterisks, or has all columns of a kind of table by DART's names and
/// separator, or fewer and is called as DART calls them. What says `wavelength;reflectance` alone is anybody's, and in fractions.
pub(crate) fn begins(path: &Path, text: &str) -> bool {
    let header = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    let cells: Vec<&str> = header.unwrap_or_default().split(';').map(str::trim).collect();
    let is_named = || path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PREFIX));
    // Sunlight has a single column, which states no unit.
    let is_kind = || ![TableKind::Other, TableKind::SolarIrradiance].contains(&TableKind::of(cells.iter().copied()));
    text.trim_start().starts_with('*')
        || (cells.len() > 1 && cells.iter().any(|cell| is_wavelength(cell)) && (is_kind() || is_named()))
}

/// The name of the file that DART's database manager imports as this model.
pub fn file_name(model: &str) -> String {
    format!("{}{model}.txt", PREFIX)
}

/// Reads a spectrum in either format; it is named by its file.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] for invalid UTF-8, or a comment without an end; [`Error::Invalid`] with all cells
/// that cannot be used, for columns in another order than DART's, for less rows than the file says it has;
/// [`Error::Unsupported`] for version 5.4's leaves, which have two faces.
pub fn read(path: &Path) -> Result<(SpectralLibrary, Report)> {
    let (text, _) = input::text(path, LIMIT)?;
    parse(&text, path)
}

/// Reads the text of a spectrum; `path` names it, and is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, path: &Path) -> Result<(SpectralLibrary, Report)> {
    let mut report = Report::default();
    let mut library = match text.trim_start().starts_with('*') {
        true => parse_5_4(text, path, &mut report)?,
        false => parse_table(text, path)?,
    };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = [PREFIX, PREFIX_5_4].iter().find_map(|prefix| stem.strip_prefix(*prefix)).unwrap_or(&stem);
    library.name = name.to_owned();
    suspect_fractions(&library, Location::file(path), &mut report);
    if let (Some(first), Some(last)) = (library.wavelength_um.first(), library.wavelength_um.last())
        && (*first > 100.0 || *last < 0.1)
    {
        let message =
            format!("wavelengths from {} to {}: taken as um, which DART's are", number(*first), number(*last));
        report.note(Fate::Defaulted, Location::file(path), message);
    }
    Ok((library, report))
}

fn parse_table(text: &str, path: &Path) -> Result<SpectralLibrary> {
    let mut comment = Vec::new();
    let mut header: Option<Vec<&str>> = None;
    let mut rows = Vec::new();
    for line in text.lines().map(str::trim) {
        let cells = || line.split(';').map(str::trim).collect();
        match line.strip_prefix('#') {
            Some(said) => comment.push(said.strip_prefix(' ').unwrap_or(said)),
            None if line.is_empty() => {}
            None if header.is_none() => header = Some(cells()),
            None => rows.push(Row { cells: cells() }),
        }
    }
    let header = header.ok_or_else(|| {
        let help = format!("the first line is wavelength;{}", TableKind::Lambertian.columns().join(";"));
        table::no_header(path, &help)
    })?;
    let at = place(path, text, header[0]);
    check_order(&header, &at)?;
    if !is_wavelength(header[0]) {
        return Err(Error::invalid(at, "the first column is not `wavelength`"));
    }
    let wavelength_um = table::numbers(path, text, &rows, &readings(&header))?;
    Ok(of_columns(&header, wavelength_um, comment.join("\n")))
}

/// How DART's columns are read.
fn readings(names: &[&str]) -> Vec<Reading> {
    let reading = |name: &&str| match is_percent(name) {
        true => Reading { name: name.to_lowercase(), convert: fraction_from_percent, unit: 100.0 },
        false => Reading { name: name.to_lowercase(), convert: |x| x, unit: 1.0 },
    };
    names.iter().map(reading).collect()
}

/// Spectra of columns, the first of which is wavelength.
fn of_columns(names: &[&str], values: Vec<Vec<f64>>, comment: String) -> SpectralLibrary {
    let mut columns =
        names.iter().zip(values).map(|(name, values)| Column { name: name.to_lowercase(), values }).collect::<Vec<_>>();
    let wavelength_um = columns.remove(0).values;
    SpectralLibrary { name: String::new(), comment, wavelength_um, columns }
}

/// What version 5.4 calls the columns of a Lambertian material, in our terms.
fn column_5_4(name: &str) -> Option<&'static str> {
    match name.to_lowercase().as_str() {
        "lambda" => Some("wavelength"),
        "ro" => Some("reflectance"),
        "t_direct" => Some("direct_transmittance"),
        "t_diffus" => Some("diffuse_transmittance"),
        _ => None,
    }
}

fn parse_5_4(text: &str, path: &Path, report: &mut Report) -> Result<SpectralLibrary> {
    // Between asterisks, and what follows up to the next ones.
    let mut said: Vec<(&str, &str)> = Vec::new();
    let mut rest = text.trim_start();
    while let Some(inner) = rest.strip_prefix('*') {
        let Some((comment, after)) = inner.split_once('*') else {
            return Err(Error::syntax(place(path, text, rest), "the comment that begins here with * does not end"));
        };
        let end = after.find('*').unwrap_or(after.len());
        said.push((comment, after[..end].trim()));
        rest = &after[end..];
    }
    let Some((header, body)) = said.last().copied() else {
        return Err(table::no_header(path, "the last comment between asterisks names the columns"));
    };
    let names: Vec<&str> = header.split(" - ").map(str::trim).collect();
    let at = place(path, text, header);
    if !names.iter().any(|name| column_5_4(name) == Some("reflectance")) {
        let feature =
            format!("a table of {} (only Lambertian materials, with a column Ro, are read)", names.join(", "));
        return Err(Error::Unsupported { at, feature });
    }
    let lines = body.lines().map(str::trim).filter(|line| !line.is_empty());
    let rows: Vec<Row<'_>> = lines.map(|line| Row { cells: line.split_whitespace().collect() }).collect();
    if column_5_4(names[0]) != Some("wavelength") {
        return Err(Error::invalid(at, "the first column is not Lambda"));
    }
    let ours: Vec<&str> = names.iter().map(|name| column_5_4(name).unwrap_or("")).collect();
    let values = table::numbers(path, text, &rows, &readings(&ours))?;
    let told = said.iter().find(|s| s.0.to_lowercase().contains("number of lambda")).map(|s| s.1);
    if let Some(told) = told.filter(|told| told.parse() != Ok(rows.len())) {
        let message = format!("{} rows, where the file says that it has {told}", rows.len());
        return Err(Error::Invalid(vec![Problem::new(at, message).with_help("is it cut off?")]));
    }
    let dropped: Vec<&str> = names.iter().copied().filter(|name| column_5_4(name).is_none()).collect();
    if !dropped.is_empty() {
        let message = format!("columns {}: only what a Lambertian material needs is read", dropped.join(", "));
        report.note(Fate::Dropped, at, message);
    }
    let (kept, values) =
        ours.iter().copied().zip(values).filter(|(name, _)| !name.is_empty()).unzip::<_, _, Vec<_>, Vec<_>>();
    let comment = said[0].0.trim().lines().map(str::trim_end).collect::<Vec<_>>().join("\n");
    Ok(of_columns(&kept, values, if said.len() > 1 { comment } else { String::new() }))
}

/// Writes a Lambertian material as DART's database manager imports it. Its name is the file's: see [`file_name`].
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] if the file exists and is not to be replaced, and for values outside their range;
/// [`Error::Unsupported`] for other kinds: how DART names their files is not known.
pub fn write(path: &Path, library: &SpectralLibrary, replace: bool) -> Result<Report> {
    let (staged, report) = stage(path, library, replace)?;
    staged.commit()?;
    Ok(report)
}

/// As [`write`], but that it does not take its place yet.
pub(in crate::formats) fn stage(path: &Path, library: &SpectralLibrary, replace: bool) -> Result<(Staged, Report)> {
    let at = Location::file(path);
    let mut report = Report::default();
    let table = DartTable::of(library, &at, &mut report)?;
    if table.kind != TableKind::Lambertian {
        let names = table.names.join(", ");
        let feature =
            format!("writing {names} as DART's text (only Lambertian materials; a database, .db, holds others)");
        return Err(Error::Unsupported { at, feature });
    }
    let mut text: String = library.comment.lines().map(|line| format!("# {line}\n")).collect();
    let _ = writeln!(text, "{}", table.names.join(";"));
    for i in 0..library.wavelength_um.len() {
        let row: Vec<String> = table.values.iter().map(|column| number(column[i])).collect();
        let _ = writeln!(text, "{}", row.join(";"));
    }
    let staged = Staged::file(path, replace)?;
    staged.put(staged.path(), |out| out.write_all(text.as_bytes()))?;
    Ok((staged, report))
}
