//! Any text is a table of responses, or an error; what is written of it is read back.
#![no_main]

use std::path::Path;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::response_csv;
use mmxrt::spectral::{Band, Spectrum};

mod files;

fuzz_target!(|text: &str| {
    let path = Path::new("fuzz.csv");
    let Some(read) = told(response_csv::parse(text, path)) else { return };
    let responses: Vec<(&str, &Spectrum)> = read.columns.iter().map(|(name, table)| (name.as_str(), table)).collect();
    let mut written = Vec::new();
    response_csv::write(&mut written, &responses).unwrap();
    let back = response_csv::parse(std::str::from_utf8(&written).unwrap(), path).unwrap();
    assert!(back.columns.iter().map(|c| &c.1).eq(responses.iter().map(|r| r.1)));
    for (_, response) in responses {
        let band = Band::tabulated(response);
        assert!(band.is_none_or(|band| band.centre_um > 0.0));
    }
});
