//! DART's optical databases (`.db`): SQLite, one table for each model, one row for each wavelength.
//!
//! Reflectances and transmittances are percent in the file and fractions here; wavelengths are um in both.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result, number};
use crate::report::{Fate, Report};
use crate::spectral::{Column, Extend, SpectralLibrary, Spectrum};
use crate::units::{fraction_from_percent, percent_from_fraction};

use super::super::folder::Staged;
use super::super::format::{Format, Holds};
use super::super::input::{self, Problems};
use super::super::marks;
use super::kind::suspect_fractions;
use super::kind::{DartTable, check_order, distinct_names, is_percent, is_wavelength, outside, range, same};
use super::store::{Store, Table};

pub use super::kind::{TableKind, model_name};

/// A DART optical database.
pub(in crate::formats) static DATABASE: Format = Format {
    name: "db",
    extensions: &["db"],
    reads: "DART optical databases",
    writes: "a new one, or more into one with --append",
    mark: marks::SQLITE,
    told: None,
    holds: Holds::Spectra { read: |path| Database::open(path)?.read_all(), stage, file_of: None },
};

/// A model of a database.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Model {
    /// The table's name: `ModelName` in coeff_diff.xml.
    pub name: String,
    /// What the database says of it.
    pub comment: String,
    /// What it describes.
    pub kind: TableKind,
    /// Its columns in their order, wavelength among them, without the row's number.
    pub columns: Vec<String>,
}

/// An optical database that is open to be read.
pub struct Database {
    path: PathBuf,
    store: Store,
    tables: Vec<Table>,
    /// Models and what is said of them.
    comments: Vec<(String, String)>,
}

/// Longer files are refused, bytes.
const LIMIT: u64 = 512 << 20;
/// Tables with more columns or rows are not spectra.
const MOST_COLUMNS: usize = 64;
const MOST_ROWS: usize = 200_000;

/// The table that says something of each model.
const COMMENTS: &str = "_comments";

fn is_row_number(column: &str) -> bool {
    same(column, "id")
}

impl Database {
    /// Opens a database. The file is read into memory: it may change, or be removed, while this is in use.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Syntax`] for a file that is damaged or no SQLite database; [`Error::Invalid`] for one that
    /// is too long, or that another program is writing; [`Error::Unsupported`] without the feature `sqlite`.
    pub fn open(path: &Path) -> Result<Self> {
        Self::of(bytes(path)?, path)
    }

    /// The database that these bytes of a file are; `path` is for messages.
    ///
    /// # Errors
    /// As [`Database::open`].
    pub fn of(bytes: Vec<u8>, path: &Path) -> Result<Self> {
        let store = Store::open(path, bytes)?;
        let mut tables = store.tables()?;
        let comments = match tables.iter().position(|t| same(&t.name, COMMENTS)) {
            Some(i) if tables.remove(i).columns.len() >= 2 => store.pairs(COMMENTS)?,
            _ => Vec::new(),
        };
        Ok(Database { path: path.to_owned(), store, tables, comments })
    }

    /// Its models, in the order of their tables. Tables without wavelengths are none.
    pub fn models(&self) -> Vec<Model> {
        let spectral = self.tables.iter().filter(|t| t.columns.iter().any(|c| is_wavelength(c)));
        let model = |table: &Table| {
            let columns: Vec<String> = table.columns.iter().filter(|c| !is_row_number(c)).cloned().collect();
            let kind = TableKind::of(columns.iter().map(String::as_str));
            Model { name: table.name.clone(), comment: self.comment(&table.name), kind, columns }
        };
        spectral.map(model).collect()
    }

    fn comment(&self, model: &str) -> String {
        self.comments.iter().find(|c| same(&c.0, model)).map_or_else(String::new, |c| c.1.clone())
    }

    /// Reads all models.
    ///
    /// The report lists tables that are not models, models that are named but missing, and reflectances that look
    /// like fractions.
    ///
    /// # Errors
    /// As [`Database::read`], for the first model that cannot be read.
    pub fn read_all(&self) -> Result<(Vec<SpectralLibrary>, Report)> {
        let mut report = Report::default();
        let mut all = Vec::new();
        for table in &self.tables {
            if table.columns.iter().any(|c| is_wavelength(c)) {
                let (library, notes) = self.read_table(table)?;
                all.push(library);
                report.notes.extend(notes.notes);
            } else {
                report.note(Fate::Dropped, self.at(&table.name), "has no column of wavelengths");
            }
        }
        for (model, _) in &self.comments {
            if !self.tables.iter().any(|t| same(&t.name, model)) {
                let message = format!("names {model:?}, but there is no such table");
                report.note(Fate::Dropped, self.at(COMMENTS), message);
            }
        }
        Ok((all, report))
    }

    /// Reads one model. The report lists reflectances that look like fractions.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no such model; with all rows that cannot be used: what is not a finite number or
    /// outside its range, wavelengths that do not ascend; for columns in another order than DART's.
    /// [`Error::Syntax`] for damage; [`Error::Unsupported`] for more rows or columns than a spectrum has.
    pub fn read(&self, model: &str) -> Result<(SpectralLibrary, Report)> {
        self.read_table(self.table(model)?)
    }

    fn at(&self, table: &str) -> Location {
        Location::file(&self.path).with_item(format!("table {table}"))
    }

    fn table(&self, model: &str) -> Result<&Table> {
        let exact = self.tables.iter().find(|t| t.name == model);
        exact.or_else(|| self.tables.iter().find(|t| same(&t.name, model))).ok_or_else(|| {
            const TOLD: usize = 12;
            let names: Vec<&str> = self.tables.iter().map(|t| t.name.as_str()).take(TOLD).collect();
            let more = if self.tables.len() > TOLD { ", ..." } else { "" };
            let help = format!("its tables are {}{more}", names.join(", "));
            Error::Invalid(vec![Problem::new(self.at(model), "there is no such table").with_help(help)])
        })
    }

    fn read_table(&self, table: &Table) -> Result<(SpectralLibrary, Report)> {
        let at = self.at(&table.name);
        if table.columns.len() > MOST_COLUMNS {
            return Err(Error::Unsupported { at, feature: format!("a table of {} columns", table.columns.len()) });
        }
        let numbered: Vec<(usize, &str)> =
            table.columns.iter().map(String::as_str).enumerate().filter(|(_, c)| !is_row_number(c)).collect();
        let names: Vec<&str> = numbered.iter().map(|c| c.1).collect();
        check_order(&names, &at)?;
        let Some(wavelength) = numbered.iter().find(|(_, c)| is_wavelength(c)) else {
            return Err(Error::invalid(at, "has no column `wavelength`"));
        };
        let values = numbered.iter().filter(|c| c.0 != wavelength.0);
        let columns: Vec<(usize, &str)> = values.copied().collect();
        let mut problems = Problems::default();
        let mut library = SpectralLibrary {
            name: table.name.clone(),
            comment: self.comment(&table.name),
            wavelength_um: Vec::new(),
            columns: columns.iter().map(|c| Column { name: c.1.to_lowercase(), values: Vec::new() }).collect(),
        };
        let mut row = 0;
        self.store.rows(&table.name, |cells| {
            row += 1;
            let mut told = |column: &str, message: String| {
                let item = format!("table {}, row {row}, {column}", table.name);
                problems.push(|| Problem::new(Location::file(&self.path).with_item(item), message));
            };
            match &cells[wavelength.0] {
                Err(what) => told(wavelength.1, what.clone()),
                Ok(um) => match library.wavelength_um.last() {
                    _ if !um.is_finite() || *um <= 0.0 => told(wavelength.1, format!("{um} is not a wavelength")),
                    Some(last) if um == last => told(wavelength.1, format!("{} appears twice", number(*um))),
                    Some(last) if um < last => {
                        told(wavelength.1, format!("{} is less than {} before it", number(*um), number(*last)));
                    }
                    _ => library.wavelength_um.push(*um),
                },
            }
            for (&(i, name), column) in columns.iter().zip(&mut library.columns) {
                let value = match &cells[i] {
                    Ok(value) if value.is_finite() => *value,
                    Ok(value) => {
                        told(name, format!("{value} is not a number"));
                        continue;
                    }
                    Err(what) => {
                        told(name, what.clone());
                        continue;
                    }
                };
                let (least, most) = range(name);
                let (converted, unit) =
                    if is_percent(name) { (fraction_from_percent(value), 100.0) } else { (value, 1.0) };
                if (least..=most).contains(&converted) {
                    column.values.push(converted);
                } else {
                    told(name, format!("{} {}", number(value), outside((least, most), unit)));
                }
            }
            row < MOST_ROWS + 1
        })?;
        if row > MOST_ROWS {
            return Err(Error::Unsupported { at, feature: format!("a table of more than {MOST_ROWS} rows") });
        }
        if row == 0 {
            problems.push(|| Problem::new(at.clone(), "has no rows"));
        }
        problems.finish(&self.path)?;
        let mut report = Report::default();
        suspect_fractions(&library, at, &mut report);
        Ok((library, report))
    }

    /// Reads a model of a known kind.
    fn read_kind(&self, model: &str, kind: TableKind) -> Result<(SpectralLibrary, Report)> {
        let (library, report) = self.read(model)?;
        let lacking: Vec<&str> = kind.columns().iter().copied().filter(|name| library.column(name).is_none()).collect();
        if lacking.is_empty() {
            return Ok((library, report));
        }
        Err(Error::invalid(self.at(model), format!("is not a {kind:?} model: it has no {}", lacking.join(", "))))
    }

    /// The reflectance of a Lambertian model, fractions, unknown beyond its wavelengths.
    ///
    /// The report says whether the material transmits light, which is dropped here.
    ///
    /// # Errors
    /// As [`Database::read`]; [`Error::Invalid`] for a model of another kind.
    pub fn lambertian(&self, model: &str) -> Result<(Spectrum, Report)> {
        let (library, mut report) = self.read_kind(model, TableKind::Lambertian)?;
        for column in &library.columns[1..3] {
            let most = column.values.iter().copied().fold(0.0, f64::max);
            if most > 0.0 {
                let percent = number(percent_from_fraction(most));
                let message = format!("{} of up to {percent} %: taken to be opaque", column.name);
                report.note(Fate::Dropped, self.at(model), message);
            }
        }
        let reflectance = library.spectrum("reflectance", Extend::Error);
        let reflectance = reflectance.ok_or_else(|| Error::invalid(self.at(model), "is not a spectrum"))?;
        Ok((reflectance, report))
    }

    /// A Hapke model: columns w, c1, c2, c3, c4, h1, h2, in this order.
    ///
    /// # Errors
    /// As [`Database::lambertian`].
    pub fn hapke(&self, model: &str) -> Result<(SpectralLibrary, Report)> {
        self.read_kind(model, TableKind::Hapke)
    }

    /// An RPV model: columns reflectance (a fraction), k, g, h, in this order.
    ///
    /// # Errors
    /// As [`Database::lambertian`].
    pub fn rpv(&self, model: &str) -> Result<(SpectralLibrary, Report)> {
        self.read_kind(model, TableKind::Rpv)
    }

    /// First and last wavelength of a model, um: what DART does beyond is not known.
    ///
    /// # Errors
    /// As [`Database::read`].
    pub fn coverage(&self, model: &str) -> Result<(f64, f64)> {
        let (library, _) = self.read(model)?;
        library.coverage_um().ok_or_else(|| Error::invalid(self.at(model), "has no rows"))
    }
}

/// The models of a database; as [`Database::models`].
///
/// # Errors
/// As [`Database::open`].
pub fn models(path: &Path) -> Result<Vec<Model>> {
    Ok(Database::open(path)?.models())
}

/// As [`Database::lambertian`], of one that is not open.
///
/// # Errors
/// As [`Database::open`] and [`Database::lambertian`].
pub fn lambertian(path: &Path, model: &str) -> Result<(Spectrum, Report)> {
    Database::open(path)?.lambertian(model)
}

/// As [`Database::hapke`], of one that is not open.
///
/// # Errors
/// As [`Database::open`] and [`Database::hapke`].
pub fn hapke(path: &Path, model: &str) -> Result<(SpectralLibrary, Report)> {
    Database::open(path)?.hapke(model)
}

/// As [`Database::rpv`], of one that is not open.
///
/// # Errors
/// As [`Database::open`] and [`Database::rpv`].
pub fn rpv(path: &Path, model: &str) -> Result<(SpectralLibrary, Report)> {
    Database::open(path)?.rpv(model)
}

/// As [`Database::coverage`], of one that is not open.
///
/// # Errors
/// As [`Database::open`] and [`Database::coverage`].
pub fn coverage(path: &Path, model: &str) -> Result<(f64, f64)> {
    Database::open(path)?.coverage(model)
}

/// The bytes of a database, none of whose changes are still in another file beside it.
fn bytes(path: &Path) -> Result<Vec<u8>> {
    for ending in ["-journal", "-wal"] {
        let mut beside = path.as_os_str().to_owned();
        beside.push(ending);
        if std::fs::metadata(&beside).is_ok_and(|m| m.len() > 0) {
            let beside = Path::new(&beside).display();
            let message = format!("a program is writing to it, or was stopped while writing: {beside} holds changes");
            let help = "close that program, or open the file with it once more, which mends it";
            return Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]));
        }
    }
    input::bytes(path, LIMIT)
}

/// Writes a database of these models. It appears whole or not at all.
///
/// The report lists names that had to change, transmittances that were taken to be 0, and columns that no kind of table has.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] if the file exists and is not to be replaced, for names that become the same, for
/// values outside their range; [`Error::Unsupported`] without the feature `sqlite`.
pub fn create(path: &Path, models: &[SpectralLibrary], replace: bool) -> Result<Report> {
    let (staged, report) = stage(path, models, replace)?;
    staged.commit()?;
    Ok(report)
}

/// As [`create`], but that it does not take its place yet.
pub(in crate::formats) fn stage(path: &Path, models: &[SpectralLibrary], replace: bool) -> Result<(Staged, Report)> {
    let staged = Staged::file(path, replace)?;
    let store = Store::in_memory(path)?;
    put(path, staged, store, &[], models)
}

/// Adds models to a database: a copy of it takes its place when it is complete.
///
/// # Errors
/// As [`create`] and [`Database::open`]; [`Error::Invalid`] for a model that is there already.
pub fn append(path: &Path, models: &[SpectralLibrary]) -> Result<Report> {
    let (staged, report) = stage_more(path, models)?;
    staged.commit()?;
    Ok(report)
}

/// As [`append`], but that the copy does not take its place yet.
pub(in crate::formats) fn stage_more(path: &Path, models: &[SpectralLibrary]) -> Result<(Staged, Report)> {
    // Read only when no other process can add to it any more.
    let staged = Staged::file(path, true)?;
    let store = Store::copy(path, bytes(path)?)?;
    let tables = store.tables()?;
    put(path, staged, store, &tables, models)
}

/// Puts models into a database that holds `tables`, and that where it is staged.
fn put(
    path: &Path,
    staged: Staged,
    store: Store,
    tables: &[Table],
    models: &[SpectralLibrary],
) -> Result<(Staged, Report)> {
    let mut report = Report::default();
    let at = |name: &str| Location::file(path).with_item(format!("table {name}"));
    let named = distinct_names(models, tables.iter().map(|t| t.name.as_str()), at, &mut report)?;
    store.execute("", "BEGIN")?;
    if !tables.iter().any(|t| same(&t.name, COMMENTS)) {
        store.execute(
            &format!("table {COMMENTS}"),
            "CREATE TABLE _comments (model , Comments);\nCREATE UNIQUE INDEX comments_index on _comments (model);",
        )?;
    }
    for (name, model) in named.iter().zip(models) {
        let item = format!("table {name}");
        let DartTable { names, values, .. } = DartTable::of(model, &at(name), &mut report)?;
        let definition: Vec<String> = names.iter().map(|name| format!("{name} DOUBLE")).collect();
        // Without quotes, as DART's own statements name it: what is a word of SQL fails here, not there.
        let statement =
            format!("CREATE TABLE {name} ( Id INTEGER PRIMARY KEY AUTOINCREMENT, {})", definition.join(", "));
        store.execute(&item, &statement).map_err(|e| match e {
            Error::Syntax { at, message } => {
                let problem = Problem::new(at, format!("cannot be made: {message}"));
                Error::Invalid(vec![problem.with_help("choose other names for the model and its columns")])
            }
            other => other,
        })?;
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        store.insert(name, &names, &values)?;
        let comment = "INSERT OR REPLACE INTO _comments(model,Comments) VALUES(?,?)";
        store.execute_with(&format!("table {COMMENTS}"), comment, [name, &model.comment])?;
    }
    store.execute("", "COMMIT")?;
    let bytes = store.bytes()?;
    staged.put(staged.path(), |out| out.write_all(&bytes))?;
    Ok((staged, report))
}
