//! Any header and any numbers are a spectral library or an error. A byte 0 parts them.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use mmxrt::formats::{envi, sli};

fuzz_target!(|bytes: &[u8]| {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let (header, numbers) = bytes.split_at(end);
    let header = String::from_utf8_lossy(header);
    if let Ok(header) = envi::parse_header(Path::new("fuzz.hdr"), &header) {
        let _ = sli::parse(&header, numbers, Path::new("fuzz.sli"));
    }
});
