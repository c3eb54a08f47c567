//! Any bytes are an optical database or an error.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use mmxrt::formats::dart::database::Database;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(database) = Database::of(bytes.to_vec(), Path::new("fuzz.db")) {
        let _ = database.read_all();
    }
});
