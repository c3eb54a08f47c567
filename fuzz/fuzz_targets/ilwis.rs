//! Any header is refused or says how many values there are, and any values fit it or are refused.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use mmxrt::formats::ilwis;

fuzz_target!(|data: (&str, &[u8])| {
    let (text, bytes) = data;
    if let Ok(header) = ilwis::parse_header(text, Path::new("a.mpr"))
        && let Ok(raster) = header.raster(bytes, Path::new("a.mp#"))
    {
        assert_eq!(raster.values.len(), raster.rows * raster.columns);
    }
});
