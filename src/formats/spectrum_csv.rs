//! Spectra as text tables: those of a scene's materials and Sun, and those that `convert` reads and writes.
//!
//! Lines that begin with `#` are comments. The first other line is the header: its first column is `wavelength_um` or
//! `wavelength_nm`; its second names the quantity and its unit: `reflectance`, `emissivity` or `albedo` (fractions), the
//! same with `_percent`, `irradiance_w_m2_um` or `irradiance_w_m2_nm`. Further columns (an uncertainty, say) are passed
//! over by [`read`], which a scene's materials use. Tables as others write them are read as well: `spectral_table.rs` has the layouts.
//!
//! [`read_all`] takes every column, as a spectrum of that name: several quantities of one material (`reflectance,k,g,h`), or
//! of several (`basalt,olivine:reflectance_percent,olivine:emissivity`; a name alone means reflectance).

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number};
use crate::report::{Fate, Report};
use crate::spectral::{Column, Extend, SpectralLibrary, Spectrum};
use crate::units::fraction_from_percent;

use super::dart::kind::{TableKind, outside, range};
use super::dart::text_spectra;
use super::folder::Staged;
use super::format::{Format, Holds};
use super::input::{self, InputFile, Problems};
use super::spectral_heading::{ALBEDO, EMISSIVITY, IRRADIANCE, LOG, REFLECTANCE, THROUGHPUT, Unit, quantities};
use super::spectral_table::{self, SpectralTable, TableColumn};
use super::table::{self, Labelled, Places, doubtful_unit, gathered, is_plain, labelled, parts, place};

/// Tables of spectra, as text: with a header that states units, and as others write them.
pub(super) static CSV: Format = Format {
    name: "csv",
    extensions: &["csv"],
    reads: "spectra: tables, ECOSTRESS, USGS splib07, RELAB (.txt, .tab, .dat too)",
    writes: "a table with a header that states units",
    mark: &[],
    told: Some(|path, beginning| {
        let is_other = |text| text_spectra::begins(path, text);
        table::beginning(path, beginning).filter(|text| !is_other(text)).map(|_| path.to_owned())
    }),
    holds: Holds::Spectra {
        read: |path| read_all(path, None),
        stage,
        file_of: Some(|material| format!("{material}.csv")),
    },
};

/// What a table must hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Reflectance, 0 to 1.
    Reflectance,
    /// Emissivity, 0 to 1.
    Emissivity,
    /// Albedo, 0 to 1: of a Lambert surface, its reflectance.
    Albedo,
    /// Electrons per photon that enters an instrument, 0 to 1.
    Throughput,
    /// Spectral irradiance, W m-2 um-1.
    Irradiance,
}

impl Quantity {
    /// What it is called in a header.
    pub fn name(self) -> &'static str {
        self.names()[0]
    }

    /// The names of columns that hold it, the best first.
    fn names(self) -> &'static [&'static str] {
        match self {
            Quantity::Reflectance => &[REFLECTANCE, ALBEDO],
            Quantity::Emissivity => &[EMISSIVITY],
            Quantity::Albedo => &[ALBEDO, REFLECTANCE],
            Quantity::Throughput => &[THROUGHPUT],
            Quantity::Irradiance => &[IRRADIANCE],
        }
    }

    /// What to do with a table of another quantity.
    fn help(self, found: &str) -> String {
        match (self, found) {
            (Quantity::Reflectance | Quantity::Albedo, EMISSIVITY) => {
                "of an opaque surface reflectance is 1 - emissivity (Kirchhoff): write that into a column `reflectance`".to_owned()
            }
            (Quantity::Emissivity, REFLECTANCE | ALBEDO) => {
                "of an opaque surface emissivity is 1 - reflectance (Kirchhoff), which it is if `emissivity` is left out".to_owned()
            }
            (_, LOG) => "reflectance is 10^-x of it: write that into a column `reflectance`".to_owned(),
            (Quantity::Irradiance, _) => "a Sun has a column `irradiance_w_m2_um` or `irradiance_w_m2_nm`".to_owned(),
            _ => format!("give a table with a column `{}`, or `{}_percent`", self.name(), self.name()),
        }
    }
}

/// Longer files are refused, bytes.
const LIMIT: u64 = 64 << 20;

/// Reads a spectrum, in um and fractions or W m-2 um-1. The report lists what was taken that the table does not say.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with the lines that cannot be used: no header that states both units, fewer
/// columns than two, cells that are not numbers, wavelengths that appear twice, fractions outside 0 to 1.
pub fn read(path: &Path, quantity: Quantity, extend: Extend) -> Result<(Spectrum, InputFile, Report)> {
    let (text, input) = input::text(path, LIMIT)?;
    let (spectrum, report) = parse(&text, path, quantity, extend)?;
    Ok((spectrum, input, report))
}

/// Reads the text of a spectrum; `path` is for messages.
///
/// # Errors
/// [`Error::Invalid`], as [`read`].
pub fn parse(text: &str, path: &Path, quantity: Quantity, extend: Extend) -> Result<(Spectrum, Report)> {
    let mut table = spectral_table::parse(text, path, None)?;
    let mut report = std::mem::take(&mut table.report);
    let column = chosen(&table, text, path, quantity, &mut report)?;
    let (mut wavelength_um, mut value) = (Vec::new(), Vec::new());
    let mut problems = Problems::default();
    let limits = if quantity == Quantity::Irradiance { (0.0, f64::INFINITY) } else { (0.0, 1.0) };
    let largest =
        column.values.iter().flatten().map(|(written, _)| converted(&column.unit, *written)).fold(0.0, f64::max);
    let noise = if quantity == Quantity::Irradiance { NOISE * largest } else { NOISE };
    tell_outside(column, &table, quantity.name(), limits, noise, |cell| place(path, text, cell), &mut problems);
    for (um, cell) in table.wavelength_um.iter().zip(&column.values) {
        let Some((written, _)) = cell else { continue };
        wavelength_um.push(*um);
        value.push(converted(&column.unit, *written));
    }
    let at = || place(path, text, column.cell);
    clip(&mut value, noise, limits.1, at(), &mut report);
    tell_unit(column, at, &mut report);
    tell_gaps(&table.wavelength_um, &wavelength_um, at(), &mut report);
    if column.unit == Unit::Percent {
        tell_doubtful_percent(&value, at(), &mut report);
    }
    tell_like_dart(&table, column, at, &mut report);
    tell_doubtful_unit(&table, &wavelength_um, place(path, text, table.header), &mut report);
    problems.finish(path)?;
    let spectrum = Spectrum::new(wavelength_um, value, extend)
        .ok_or_else(|| Error::invalid(Location::file(path), "no rows: all of its values are gaps"))?;
    Ok((spectrum, report))
}

/// Reads the spectrum of the first quantity that a table has a column of; of reflectances if it names none.
///
/// # Errors
/// As [`read`].
pub fn read_any(path: &Path, extend: Extend) -> Result<(Quantity, Spectrum, Report)> {
    let (text, _) = input::text(path, LIMIT)?;
    let table = spectral_table::parse(&text, path, None)?;
    let all =
        [Quantity::Reflectance, Quantity::Emissivity, Quantity::Albedo, Quantity::Throughput, Quantity::Irradiance];
    let has = |quantity: &Quantity| table.columns.iter().any(|column| column.name == quantity.name());
    let quantity = all.into_iter().find(has).unwrap_or(Quantity::Reflectance);
    let (spectrum, report) = parse(&text, path, quantity, extend)?;
    Ok((quantity, spectrum, report))
}

/// The column that holds a quantity.
fn chosen<'t, 'a>(
    table: &'t SpectralTable<'a>,
    text: &str,
    path: &Path,
    quantity: Quantity,
    report: &mut Report,
) -> Result<&'t TableColumn<'a>> {
    let columns = &table.columns;
    let refused = |cell: &str, message: String, help: String| {
        Err(Error::Invalid(vec![Problem::new(place(path, text, cell), message).with_help(help)]))
    };
    for name in quantity.names() {
        let mut found = columns.iter().filter(|column| column.name == *name);
        let Some(column) = found.next() else { continue };
        if let Some(second) = found.next() {
            return Err(Error::invalid(place(path, text, second.cell), format!("`{name}` appears twice")));
        }
        if let Unit::Unread(message, help) = &column.unit {
            return refused(column.cell, message.clone(), help.clone());
        }
        if *name != quantity.name() {
            let message = format!("`{name}` is taken as {}: that of a Lambert surface", quantity.name());
            report.note(Fate::Defaulted, place(path, text, column.cell), message);
        }
        return Ok(column);
    }
    let first = &columns[0];
    let wanted = quantity.name();
    // Of other quantities, and of light, nothing is a share of it.
    let others: Vec<&str> = columns
        .iter()
        .flat_map(|column| match column.unit {
            Unit::Irradiance(..) => vec![IRRADIANCE],
            _ => quantities(column.cell),
        })
        .filter(|other| !quantity.names().contains(other))
        .collect();
    if let Some(other) = others.first().filter(|_| table.has_header) {
        let names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).take(8).collect();
        let message = format!("holds {}, but no {wanted}", names.join(", "));
        return refused(first.cell, message, quantity.help(other));
    }
    if quantity == Quantity::Irradiance {
        let help = "the first line is `wavelength_um` or `wavelength_nm`, then `irradiance_w_m2_um` or `irradiance_w_m2_nm`; as in \
                    `wavelength_um,irradiance_w_m2_um`";
        let message = match table.has_header {
            true => format!("the header `{},{}` names no irradiance", table.header, first.cell),
            false => format!("no header: it begins with `{}`", table.header),
        };
        return refused(table.header, message, help.to_owned());
    }
    if columns.len() > 1 && table.has_header {
        let names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).take(8).collect();
        let message = format!("holds {} spectra: {}", columns.len(), names.join(", "));
        let mut help = format!("take one: mmxrt convert {} {}.csv --model {}", path.display(), names[0], names[0]);
        if columns.iter().all(|c| is_response(&c.values.iter().flatten().map(|v| v.0).collect::<Vec<f64>>())) {
            help.push_str("; or are they responses of bands, `response` in `[sensor.bands]`?");
        }
        return refused(first.cell, message, help);
    }
    let what = if table.has_header { format!("`{}` is", first.name) } else { "no header says what it is:".into() };
    report.note(
        Fate::Defaulted,
        place(path, text, first.cell),
        format!("{what} taken as a fraction, 0 to 1: {wanted}"),
    );
    Ok(first)
}

/// Whether values rise from next to nothing and fall to it again, as the response of a filter does.
fn is_response(values: &[f64]) -> bool {
    /// Of the largest value.
    const LITTLE: f64 = 0.05;
    let largest = values.iter().copied().fold(0.0, f64::max);
    let is_little = |value: Option<&f64>| value.is_some_and(|value| *value <= LITTLE * largest);
    largest > 0.0 && is_little(values.first()) && is_little(values.last())
}

/// Whether the spectra of a table that does not say what they are look like responses of bands, not reflectances.
pub fn are_responses(spectra: &[SpectralLibrary]) -> bool {
    let is_alone = |library: &SpectralLibrary| library.columns.len() == 1;
    spectra.len() > 1 && spectra.iter().all(|l| is_alone(l) && is_response(&l.columns[0].values))
}

/// What a fraction of something is called.
const FRACTIONS: [&str; 3] = [REFLECTANCE, EMISSIVITY, ALBEDO];

fn converted(unit: &Unit, written: f64) -> f64 {
    match unit {
        Unit::Percent => fraction_from_percent(written),
        Unit::Irradiance(times, _) => times * written,
        Unit::Plain | Unit::Doubtful(_) | Unit::Unread(..) => written,
    }
}

/// Tells the numbers of a column that its quantity cannot have: once those that are too large, and once those that are negative.
fn tell_outside<'a>(
    column: &TableColumn<'a>,
    table: &SpectralTable<'a>,
    quantity: &str,
    limits: (f64, f64),
    noise: f64,
    mut at: impl FnMut(&'a str) -> Location,
    problems: &mut Problems,
) {
    let unit = if column.unit == Unit::Percent { 100.0 } else { 1.0 };
    let too_large = |value: f64| value > limits.1 + noise;
    let too_small = |value: f64| value < limits.0 - noise;
    let is_plain = !matches!(column.unit, Unit::Percent | Unit::Irradiance(..));
    for (is_bad, help) in
        [(&too_large as &dyn Fn(f64) -> bool, is_plain.then_some(table.percent_help)), (&too_small, None)]
    {
        let mut bad = column.values.iter().flatten().filter(|(written, _)| is_bad(converted(&column.unit, *written)));
        let Some((_, cell)) = bad.next() else { continue };
        let more = match bad.count() {
            0 => String::new(),
            n => format!(", as are {n} more values"),
        };
        let message = format!("{quantity} {cell} {}{more}", outside(limits, unit));
        problems.push(|| Problem { at: at(cell), message, help: help.map(str::to_owned) });
    }
}

/// Reports what was taken as a unit other than our own, and what is perhaps not a unit.
fn tell_unit(column: &TableColumn<'_>, at: impl FnOnce() -> Location, report: &mut Report) {
    let message = match &column.unit {
        Unit::Doubtful(said) => format!("`{said}` is not a known unit: taken as fractions, 0 to 1"),
        Unit::Irradiance(times, spelt) if !["w_m2_um", "w_m2_nm"].contains(&spelt.to_lowercase().as_str()) => {
            format!("read as irradiance in {spelt}, which is {} W m-2 um-1", number(*times))
        }
        _ => return,
    };
    report.note(Fate::Defaulted, at(), message);
}

/// Tells fractions whose header is as DART's would begin, where they would be percent.
fn tell_like_dart(
    table: &SpectralTable<'_>,
    column: &TableColumn<'_>,
    at: impl FnOnce() -> Location,
    report: &mut Report,
) {
    let is_like_dart = ["wavelength", "lambda"].contains(&table.header.to_lowercase().as_str())
        && column.cell.eq_ignore_ascii_case(REFLECTANCE)
        && table.has_header;
    if is_like_dart {
        let message = "taken as fractions, 0 to 1: a text of DART, in percent, has the columns \
                       wavelength;reflectance;direct_transmittance;diffuse_transmittance, or is called 2D-LAM_*.txt";
        report.note(Fate::Defaulted, at(), message);
    }
}

/// Tells of rows without a value: between their neighbours a spectrum is linear.
fn tell_gaps(all_um: &[f64], known_um: &[f64], at: Location, report: &mut Report) {
    let gaps = all_um.len() - known_um.len();
    if gaps > 0 {
        // What is known is some of all, in the same order.
        let is_gap = |(i, um): &(usize, &f64)| known_um.get(*i) != Some(um);
        let first = all_um.iter().enumerate().find(is_gap).map_or(0.0, |(_, um)| *um);
        let message = format!("{gaps} rows have no value, the first at {} um: linear across gaps", number(first));
        report.note(Fate::Approximated, at, message);
    }
}

/// Tells of percent that are rather fractions.
fn tell_doubtful_percent(fractions: &[f64], at: Location, report: &mut Report) {
    let most = fractions.iter().copied().fold(0.0, f64::max);
    if most > 0.0 && most <= 0.01 {
        let message = "no value is above 1: probably fractions where the header says percent; taken as percent";
        report.note(Fate::Defaulted, at, message);
    }
}

/// Measured fractions go this far beyond 0 and 1, against a standard, and irradiances below 0 by this share of the largest.
pub(super) const NOISE: f64 = 0.05;

/// Numbers that noise has left beyond 0 and `most`, by `noise` at most, become these.
fn clip(values: &mut [f64], noise: f64, most: f64, at: Location, report: &mut Report) {
    let beyond = |v: f64| (v - most).max(-v);
    let noisy = |v: &&mut f64| beyond(**v) > 0.0 && beyond(**v) <= noise;
    let (mut count, mut farthest) = (0, 0.0_f64);
    for value in values.iter_mut().filter(noisy) {
        (count, farthest) = (count + 1, farthest.max(beyond(*value)));
        *value = value.clamp(0.0, most);
    }
    if count > 0 {
        let (place, limits) = if most.is_finite() { ("outside 0 to 1", "0 or 1") } else { ("below 0", "0") };
        let farthest = number(format!("{farthest:.3e}").parse().unwrap_or(farthest));
        let values = if count == 1 { "1 value is".to_owned() } else { format!("{count} values are") };
        let message = format!("{values} {place} by up to {farthest}, as noise leaves them: taken as {limits}");
        report.note(Fate::Approximated, at, message);
    }
}

fn tell_doubtful_unit(table: &SpectralTable<'_>, wavelength_um: &[f64], header_at: Location, report: &mut Report) {
    if let Some(doubt) = doubtful_unit(table.wave_unit, wavelength_um) {
        report.note(Fate::Defaulted, header_at, doubt);
    }
}

/// Reads all spectra of a table. Those of one material are named by the table or else the file. The report lists gaps, and what was
/// taken that the table does not say.
///
/// `wavelengths`: the file with the wavelengths of a text that holds values alone, as libraries of the US Geological Survey do.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with all cells that cannot be used, as [`read`].
pub fn read_all(path: &Path, wavelengths: Option<&Path>) -> Result<(Vec<SpectralLibrary>, Report)> {
    let (text, _) = input::text(path, LIMIT)?;
    let given_um = match wavelengths {
        Some(file) => Some(spectral_table::wavelengths(&input::text(file, LIMIT)?.0, file)?),
        None => None,
    };
    parse_all(&text, path, given_um.as_deref())
}

/// Reads the text of a table with any number of spectra; `path` names them if they are of one material, and is for messages.
///
/// # Errors
/// [`Error::Invalid`], as [`read_all`].
pub fn parse_all(text: &str, path: &Path, given_um: Option<&[f64]>) -> Result<(Vec<SpectralLibrary>, Report)> {
    let mut table = spectral_table::parse(text, path, given_um)?;
    let mut report = std::mem::take(&mut table.report);
    let is_headless = !table.has_header;
    if is_headless {
        let first = &mut table.columns[0];
        let at = place(path, text, first.cell);
        first.name = "reflectance".to_owned();
        report.note(Fate::Defaulted, at.clone(), "no header: the second column is taken as reflectance, 0 to 1");
        if table.columns.len() > 1 {
            let message = format!("{} more columns, which no header names", table.columns.len() - 1);
            report.note(Fate::Dropped, at, message);
            table.columns.truncate(1);
        }
    }
    let mut known = BTreeSet::new();
    for column in &mut table.columns {
        if let Unit::Unread(message, help) = &column.unit {
            let problem = Problem::new(place(path, text, column.cell), message.clone()).with_help(help.clone());
            return Err(Error::Invalid(vec![problem]));
        }
        if column.name == IRRADIANCE {
            column.name = IRRADIANCE_W_M2_UM.to_owned();
        }
        if column.name.is_empty() || !known.insert(column.name.to_lowercase()) {
            let message = match column.name.as_str() {
                "" => "a column has no name".into(),
                name => format!("`{name}` appears twice"),
            };
            return Err(Error::invalid(place(path, text, column.cell), message));
        }
    }
    let one = of_one_material(table.columns.iter().map(|c| c.name.as_str()));
    let mut problems = Problems::default();
    let mut places = Places::of(path, text);
    for column in &table.columns {
        let quantity = if one { column.name.as_str() } else { parts(&column.name).1 };
        let limits = if quantity == IRRADIANCE_W_M2_UM { (0.0, f64::INFINITY) } else { range(quantity) };
        tell_outside(column, &table, quantity, limits, 0.0, |cell| places.place(cell), &mut problems);
        tell_unit(column, || places.place(column.cell), &mut report);
        tell_like_dart(&table, column, || places.place(column.cell), &mut report);
        if column.unit == Unit::Percent {
            let fractions: Vec<f64> = column.values.iter().flatten().map(|v| fraction_from_percent(v.0)).collect();
            tell_doubtful_percent(&fractions, places.place(column.cell), &mut report);
        }
    }
    tell_doubtful_unit(&table, &table.wavelength_um, place(path, text, table.header), &mut report);
    problems.finish(path)?;
    let value =
        |column: &TableColumn<'_>, i: usize| column.values[i].map(|(written, _)| converted(&column.unit, written));
    if one {
        // Quantities of one material are known where all of them are.
        let rows: Vec<usize> = (0..table.wavelength_um.len())
            .filter(|i| table.columns.iter().all(|column| column.values[*i].is_some()))
            .collect();
        let wavelength_um: Vec<f64> = rows.iter().map(|i| table.wavelength_um[*i]).collect();
        tell_gaps(&table.wavelength_um, &wavelength_um, Location::file(path), &mut report);
        if rows.is_empty() {
            return Err(Error::invalid(Location::file(path), "no rows: all of its values are gaps"));
        }
        let columns = table.columns.iter().map(|column| Column {
            name: column.name.clone(),
            values: rows.iter().filter_map(|i| value(column, *i)).collect(),
        });
        let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let library = SpectralLibrary {
            name: table.name.map_or_else(stem, str::to_owned),
            comment: table.comment.join("\n"),
            wavelength_um,
            columns: columns.collect(),
        };
        return Ok((vec![library], report));
    }
    let mut labelled = Vec::new();
    let mut places = Places::of(path, text);
    for column in &table.columns {
        let (um, values): (Vec<f64>, Vec<f64>) =
            table.wavelength_um.iter().enumerate().filter_map(|(i, um)| Some((*um, value(column, i)?))).unzip();
        let at = places.place(column.cell);
        match um.is_empty() {
            true => report.note(Fate::Dropped, at, format!("{:?} has no values", column.name)),
            false => {
                tell_gaps(&table.wavelength_um, &um, at, &mut report);
                labelled.push((column.name.clone(), um, values));
            }
        }
    }
    if labelled.is_empty() {
        return Err(Error::invalid(Location::file(path), "no rows: all of its values are gaps"));
    }
    Ok((gathered(labelled), report))
}

/// What a column of irradiances is called.
const IRRADIANCE_W_M2_UM: &str = "irradiance_w_m2_um";

/// Whether columns are quantities of one material, not names of several.
fn of_one_material<'a>(names: impl Iterator<Item = &'a str> + Clone) -> bool {
    let is_quantity = |name: &str| name == IRRADIANCE_W_M2_UM || FRACTIONS.contains(&name);
    TableKind::of(names.clone()) != TableKind::Other || names.clone().any(is_quantity)
}

/// A column's name without what says that it is in percent.
fn in_percent(cell: &str) -> (&str, bool) {
    match cell.strip_suffix("_percent") {
        Some(name) => (name, true),
        None => (cell, false),
    }
}

/// Writes spectra as one table, in um and fractions: those of one material, or of several, with `nan` where one has no value.
///
/// The report lists comments shared by several materials, which cannot be kept.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] if the file exists and is not to be replaced, for names that a header cannot hold.
pub fn write(path: &Path, spectra: &[SpectralLibrary], replace: bool) -> Result<Report> {
    let (staged, report) = stage(path, spectra, replace)?;
    staged.commit()?;
    Ok(report)
}

/// As [`write`], but that it does not take its place yet.
pub(super) fn stage(path: &Path, spectra: &[SpectralLibrary], replace: bool) -> Result<(Staged, Report)> {
    let mut report = Report::default();
    let mut text = String::new();
    let (wavelength_um, columns): (Vec<f64>, Vec<(String, Vec<f64>)>) = match spectra {
        [one] => {
            one.check()?;
            text.extend(one.comment.lines().map(|line| format!("# {line}\n")));
            let columns = one.columns.iter().map(|c| (c.name.clone(), c.values.clone())).collect();
            (one.wavelength_um.clone(), columns)
        }
        several => {
            for library in several.iter().filter(|library| !library.comment.is_empty()) {
                let at = Location::file(path).with_item(format!("spectra of {:?}", library.name));
                report.note(Fate::Dropped, at, "a table of several materials has no place for comments");
            }
            on_all_wavelengths(several, labelled(path, several)?)
        }
    };
    let names: Vec<&str> = columns.iter().map(|c| c.0.as_str()).collect();
    // What parts the columns of a table is looked for in its header.
    let is_written = |name: &str| is_plain(name) && !in_percent(name).1 && !name.contains([';', '\t']);
    if let Some(name) = names.iter().find(|name| !is_written(name)) {
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
    staged.put(staged.path(), |out| out.write_all(text.as_bytes()))?;
    Ok((staged, report))
}

/// Labelled values on the wavelengths of all spectra: NaN where one has none.
fn on_all_wavelengths(spectra: &[SpectralLibrary], labelled: Vec<Labelled<'_>>) -> (Vec<f64>, Vec<(String, Vec<f64>)>) {
    let mut all_um: Vec<f64> = spectra.iter().flat_map(|s| &s.wavelength_um).copied().collect();
    all_um.sort_by(f64::total_cmp);
    all_um.dedup();
    let columns = labelled.into_iter().map(|(label, um, values)| {
        let mut known = um.iter().zip(values).peekable();
        let value = |all: &f64| known.next_if(|(um, _)| *um == all).map_or(f64::NAN, |(_, value)| *value);
        (label, all_um.iter().map(value).collect())
    });
    let columns = columns.collect();
    (all_um, columns)
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
            let (s, report) = parse(text, Path::new("a.csv"), Quantity::Reflectance, Extend::Error).unwrap();
            assert!(report.notes.is_empty(), "{report:?}");
            assert_eq!((s.wavelength_um(), s.value()), (&[0.5, 1.0][..], &[0.05, 0.125][..]));
        }
        let (s, _) =
            parse("wavelength_nm,irradiance_w_m2_nm\n500,2\n", Path::new("a"), Quantity::Irradiance, Extend::Hold)
                .unwrap();
        assert_eq!((s.wavelength_um(), s.value()), (&[0.5][..], &[2000.0][..]));
    }

    #[test]
    fn every_bad_row_is_told_with_its_place() {
        // What is not a table, then what is not a spectrum.
        for (text, expected) in [
            (
                "wavelength_um,reflectance\n1,0.1\n2, x\n3\n4,inf\n1,0.2\n-1,0.1\n0,4,0,05\n6,1,\n",
                &[
                    "a.csv:3:4: `x` is not a finite number",
                    "a.csv:4:1: one column",
                    "a.csv:5:3: `inf` is not",
                    "a.csv:7:1: wavelength -1 is not positive",
                    "a.csv:8:1: 4 columns where the header has 2 (help: is the decimal sign a comma",
                    "a.csv:9:1: 3 columns where the header has 2",
                    "a.csv:6:1: wavelength 1 appears twice",
                ][..],
            ),
            (
                "wavelength_um,reflectance\n4,7\n5,-0.1\n",
                &[
                    "a.csv:2:3: reflectance 7 is outside 0 to 1 (help: if these are percent",
                    "a.csv:3:3: reflectance -0.1 is outside 0 to 1",
                ],
            ),
        ] {
            let told = told(text, Quantity::Reflectance);
            assert_eq!(told.lines().count(), expected.len(), "{told}");
            for (line, expected) in told.lines().zip(expected) {
                assert!(line.starts_with(expected), "{line}");
            }
        }
    }

    #[test]
    fn a_header_without_units_is_refused() {
        assert!(
            told("wavelength_um,irradiance_w_m2_um\n1,2\n", Quantity::Reflectance)
                .contains("a.csv:1:15: holds irradiance, but no reflectance")
        );
        // Neither um nor nm, whatever they are.
        for text in ["wavelength,a\n120,0.1\n", "120,0.1\n", "lambda,red\n90,0.1\n200,0.1\n"] {
            assert!(told(text, Quantity::Reflectance).contains("does not state the unit"), "{text}");
        }
        assert!(told("wavelength_um,reflectance\n1,0.1\n", Quantity::Irradiance).contains("irradiance_w_m2_nm"));
        assert!(told("# nothing\n", Quantity::Reflectance).contains("no rows"));
        assert!(told("wavelength\n", Quantity::Reflectance).contains("one column"));
    }

    #[test]
    fn nanometres_that_are_called_micrometres_are_suspected() {
        for (text, doubt) in [
            ("wavelength_um,reflectance\n400,0.1\n2500,0.1\n", "nanometres"),
            ("wavelength_nm,reflectance\n0.4,0.1\n2.5,0.1\n", "micrometres"),
        ] {
            let (_, report) = parse(text, Path::new("a.csv"), Quantity::Reflectance, Extend::Error).unwrap();
            assert!(report.notes[0].message.contains(doubt), "{report:?}");
        }
    }
}
