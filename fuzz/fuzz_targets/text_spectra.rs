//! Any text is a spectrum of DART or of a table, or an error.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use mmxrt::formats::dart::text_spectra;
use mmxrt::formats::spectrum_csv;

fuzz_target!(|text: &str| {
    let _ = text_spectra::parse(text, Path::new("2D-LAM_fuzz.txt"));
    let _ = spectrum_csv::parse_all(text, Path::new("fuzz.csv"));
});
