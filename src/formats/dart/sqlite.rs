//! Tables in a SQLite file: the only module that knows SQLite.
//!
//! A file's bytes are opened in memory: nothing is locked or written beside it, and nothing in it is run. What
//! is written is made in memory in one transaction, so that the same content gives the same bytes.

use std::path::{Path, PathBuf};

use rusqlite::config::DbConfig;
use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, ErrorCode};

use crate::error::{Error, Location, Result};
use crate::formats::marks;

/// A table's name, and its columns in order.
pub(super) struct Table {
    pub(super) name: String,
    pub(super) columns: Vec<String>,
}

/// A SQLite database, held in memory.
pub(super) struct Store {
    connection: Connection,
    path: PathBuf,
}

/// A longer text or blob is refused, bytes.
const LONGEST_VALUE: i32 = 1 << 20;
/// Steps of SQLite's machine after which it is stopped: ten seconds, hundreds of times what the largest file takes.
const STEPS_AT_A_TIME: i32 = 100_000;
const MOST_STEPS: u32 = 10_000;

impl Store {
    /// Opens a file's bytes to read them; `path` is for messages.
    ///
    /// # Errors
    /// [`Error::Syntax`] for what is not a SQLite file, a cut off or a damaged one; [`Error::Unsupported`] for computed columns.
    pub(super) fn open(path: &Path, bytes: Vec<u8>) -> Result<Self> {
        Self::load(path, bytes, true)
    }

    /// Opens a file's bytes to add to them.
    ///
    /// # Errors
    /// As [`Store::open`]; and for damage anywhere in the file.
    pub(super) fn copy(path: &Path, bytes: Vec<u8>) -> Result<Self> {
        let store = Self::load(path, bytes, false)?;
        let verdict: String = store.run("", |c| c.query_row("PRAGMA integrity_check(1)", [], |row| row.get(0)))?;
        match verdict.as_str() {
            "ok" => Ok(store),
            damage => Err(Error::syntax(Location::file(path), format!("is damaged: {damage}"))),
        }
    }

    fn load(path: &Path, mut bytes: Vec<u8>, read_only: bool) -> Result<Self> {
        check_header(path, &bytes)?;
        // 2: changes go to a second file first. There is none, and a file in memory can have none.
        bytes[18..20].iter_mut().filter(|version| **version == 2).for_each(|version| *version = 1);
        let mut store = Self::in_memory(path)?;
        let (length, reader) = (bytes.len(), bytes.as_slice());
        store.connection.deserialize_read_exact("main", reader, length, read_only).map_err(|e| failed(path, "", &e))?;
        // No spectrum is computed by its own table, and what a table computes may take forever.
        let computed = "SELECT name FROM sqlite_master WHERE type = 'table' AND rootpage > 0 \
                        AND EXISTS (SELECT 1 FROM pragma_table_xinfo(sqlite_master.name) WHERE hidden > 1)";
        let computed: Vec<String> =
            store.run("", |c| c.prepare(computed)?.query_map([], |row| row.get(0))?.collect())?;
        if let Some(table) = computed.first() {
            let at = Location::file(path).with_item(item(table));
            return Err(Error::Unsupported { at, feature: "a table with computed columns".into() });
        }
        Ok(store)
    }

    /// An empty database; `path` is for messages.
    ///
    /// # Errors
    /// [`Error::Syntax`] if SQLite cannot be started.
    pub(super) fn in_memory(path: &Path) -> Result<Self> {
        let start = || -> rusqlite::Result<Connection> {
            let mut connection = Connection::open_in_memory()?;
            connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, LONGEST_VALUE)?;
            for off in [
                DbConfig::SQLITE_DBCONFIG_ENABLE_TRIGGER,
                DbConfig::SQLITE_DBCONFIG_ENABLE_VIEW,
                DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA,
                DbConfig::SQLITE_DBCONFIG_DQS_DML,
            ] {
                connection.set_db_config(off, false)?;
            }
            let mut turns = 0;
            let too_long = move || {
                turns += 1;
                turns > MOST_STEPS
            };
            connection.progress_handler(STEPS_AT_A_TIME, Some(too_long))?;
            Ok(connection)
        };
        Ok(Store { connection: start().map_err(|e| failed(path, "", &e))?, path: path.to_owned() })
    }

    fn run<T>(&self, item: &str, question: impl FnOnce(&Connection) -> rusqlite::Result<T>) -> Result<T> {
        question(&self.connection).map_err(|e| failed(&self.path, item, &e))
    }

    /// All tables but SQLite's own, in the order they were made.
    ///
    /// # Errors
    /// [`Error::Syntax`] for a damaged file.
    pub(super) fn tables(&self) -> Result<Vec<Table>> {
        // Views and virtual tables have no page.
        let names = "SELECT name FROM sqlite_master WHERE type = 'table' AND rootpage > 0 ORDER BY rowid";
        let names: Vec<String> = self.run("", |c| c.prepare(names)?.query_map([], |row| row.get(0))?.collect())?;
        let own = |name: &String| name.get(..7).is_some_and(|start| start.eq_ignore_ascii_case("sqlite_"));
        let names = names.into_iter().filter(|name| !own(name));
        let table = |name: String| {
            // Not the names that a statement has: where they are not UTF-8, rusqlite panics.
            let columns = "SELECT name FROM pragma_table_xinfo(?1) ORDER BY cid";
            let columns: Vec<String> =
                self.run(&item(&name), |c| c.prepare(columns)?.query_map([&name], |row| row.get(0))?.collect())?;
            Ok(Table { name, columns })
        };
        names.map(table).collect()
    }

    /// Two columns of text, as they come; what is not text is empty.
    ///
    /// # Errors
    /// [`Error::Syntax`] for a damaged file.
    pub(super) fn pairs(&self, table: &str) -> Result<Vec<(String, String)>> {
        let text = |value: ValueRef<'_>| value.as_str().unwrap_or_default().to_owned();
        self.run(&item(table), |c| {
            let mut statement = c.prepare(&format!("SELECT * FROM {}", quoted(table)))?;
            let pairs = statement.query_map([], |row| Ok((text(row.get_ref(0)?), text(row.get_ref(1)?))))?;
            pairs.collect()
        })
    }

    /// Hands out the rows of a table: numbers, or what stands in place of one. Stops when `each` says no.
    ///
    /// # Errors
    /// [`Error::Syntax`] for a damaged file.
    pub(super) fn rows(
        &self,
        table: &str,
        mut each: impl FnMut(&[std::result::Result<f64, String>]) -> bool,
    ) -> Result<()> {
        self.run(&item(table), |c| {
            let mut statement = c.prepare(&format!("SELECT * FROM {}", quoted(table)))?;
            let count = statement.column_count();
            let mut rows = statement.query([])?;
            let mut cells = Vec::with_capacity(count);
            while let Some(row) = rows.next()? {
                cells.clear();
                for i in 0..count {
                    cells.push(number(row.get_ref(i)?));
                }
                if !each(&cells) {
                    break;
                }
            }
            Ok(())
        })
    }

    /// Runs statements that return nothing.
    ///
    /// # Errors
    /// [`Error::Syntax`] with what SQLite says.
    pub(super) fn execute(&self, item: &str, statements: &str) -> Result<()> {
        self.run(item, |c| c.execute_batch(statements))
    }

    /// Runs a statement with two texts.
    ///
    /// # Errors
    /// As [`Store::execute`].
    pub(super) fn execute_with(&self, item: &str, statement: &str, texts: [&str; 2]) -> Result<()> {
        self.run(item, |c| c.execute(statement, texts).map(|_| ()))
    }

    /// Adds rows to a table: one value of each column, row after row.
    ///
    /// # Errors
    /// As [`Store::execute`].
    pub(super) fn insert(&self, table: &str, names: &[&str], columns: &[Vec<f64>]) -> Result<()> {
        self.run(&item(table), |c| {
            let marks = vec!["?"; columns.len()].join(",");
            let mut statement =
                c.prepare(&format!("INSERT INTO {}({}) VALUES({marks})", quoted(table), names.join(",")))?;
            for i in 0..columns.first().map_or(0, Vec::len) {
                statement.execute(rusqlite::params_from_iter(columns.iter().map(|column| column[i])))?;
            }
            Ok(())
        })
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// [`Error::Syntax`] if there is no memory for them.
    pub(super) fn bytes(mut self) -> Result<Vec<u8>> {
        let bytes = self.connection.serialize("main").map_err(|e| failed(&self.path, "", &e))?;
        Ok(bytes.to_vec())
    }
}

fn check_header(path: &Path, bytes: &[u8]) -> Result<()> {
    let whole = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map_or(0, u32::from_be_bytes);
    let wrong = |message: String| Err(Error::syntax(Location::file(path), message));
    if !bytes.starts_with(marks::SQLITE) {
        return wrong("is not a SQLite database: those begin with \"SQLite format 3\"".into());
    }
    if bytes.len() < 512 {
        return wrong(format!("is cut off: {} bytes hold no SQLite database", bytes.len()));
    }
    let page = match u16::from_be_bytes([bytes[16], bytes[17]]) {
        1 => 65536,
        page => u64::from(page),
    };
    // The number of pages counts if it was written together with the last change.
    let told = page * u64::from(whole(28));
    if whole(24) == whole(92) && told > bytes.len() as u64 {
        return wrong(format!("is cut off: {} of {told} bytes are there", bytes.len()));
    }
    Ok(())
}

fn failed(path: &Path, item: &str, error: &rusqlite::Error) -> Error {
    let message = match error.sqlite_error_code() {
        Some(ErrorCode::OperationInterrupted) => {
            "takes far longer to read than its size explains: it is damaged, or made to do so".to_owned()
        }
        Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => format!("is damaged: {error}"),
        None => format!("is damaged, or no table of spectra: {error}"),
        _ => format!("SQLite says: {error}"),
    };
    Error::syntax(Location::file(path).with_item(item), message)
}

fn item(table: &str) -> String {
    format!("table {table}")
}

/// A name as SQL has it, whatever it is.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

fn number(value: ValueRef<'_>) -> std::result::Result<f64, String> {
    match value {
        ValueRef::Real(x) => Ok(x),
        ValueRef::Integer(i) => Ok(i as f64),
        ValueRef::Null => Err("is empty (NULL)".into()),
        ValueRef::Text(text) => {
            let start: String = String::from_utf8_lossy(text).chars().take(20).collect();
            Err(format!("is the text {start:?}"))
        }
        ValueRef::Blob(blob) => Err(format!("is {} bytes of binary data", blob.len())),
    }
}
