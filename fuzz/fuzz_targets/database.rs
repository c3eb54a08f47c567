//! Any bytes are an optical database or an error. What does not begin as one is SQL that makes one: so the schema, names and
//! values are anything in a file that SQLite finds in order.
#![no_main]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::dart::database::{self, Database};
use mmxrt::formats::{convert, registry, spectra};
use rusqlite::Connection;
use rusqlite::limits::Limit;

mod files;

static FILE: LazyLock<PathBuf> = LazyLock::new(|| files::scratch("database").join("fuzz.db"));

fuzz_target!(|bytes: &[u8]| {
    let made = match bytes.starts_with(b"SQLite format 3\0") {
        true => Some(bytes.to_vec()),
        false => std::str::from_utf8(bytes).ok().and_then(made),
    };
    let Some(bytes) = made else { return };
    let Some(database) = told(Database::of(bytes.clone(), Path::new("fuzz.db"))) else { return };
    let all = told(database.read_all());
    for model in database.models() {
        told(database.coverage(&model.name));
        told(database.lambertian(&model.name));
        told(database.hapke(&model.name));
        told(database.rpv(&model.name));
    }
    std::fs::write(&*FILE, bytes).unwrap();
    told(convert::check(&FILE, &convert::Options { from: registry::named("db"), ..Default::default() }));
    if let Some((libraries, _)) = all {
        told(database::append(&FILE, &libraries[..libraries.len().min(1)]));
        let _ = spectra::resample(&libraries, &[]);
        if told(database::create(&FILE, &libraries, true)).is_some() {
            told(database::models(&FILE));
        }
    }
});

/// The file that statements make, those that fail left out.
fn made(sql: &str) -> Option<Vec<u8>> {
    let mut connection = Connection::open_in_memory().ok()?;
    // No other file is touched, and nothing takes long.
    connection.set_limit(Limit::SQLITE_LIMIT_ATTACHED, 0).ok()?;
    connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, 1 << 16).ok()?;
    let mut turns = 0;
    let too_long = move || {
        turns += 1;
        turns > 100
    };
    connection.progress_handler(1000, Some(too_long)).ok()?;
    connection.execute_batch("PRAGMA page_size = 512").ok()?;
    for statement in sql.split(';') {
        let _ = connection.execute_batch(statement);
    }
    Some(connection.serialize("main").ok()?.to_vec())
}
