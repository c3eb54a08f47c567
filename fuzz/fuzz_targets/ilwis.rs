//! Any header is refused or says how many values there are, and any values fit it or are refused. A byte 0 parts them.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::ilwis;

mod files;

static HEADER: LazyLock<PathBuf> = LazyLock::new(|| files::scratch("ilwis").join("a.mpr"));

fuzz_target!(|bytes: &[u8]| {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let (text, values) = (&bytes[..end], bytes.get(end + 1..).unwrap_or_default());
    let values_path = HEADER.with_extension("mp#");
    let mut parsed = None;
    if let Ok(text) = std::str::from_utf8(text)
        && let Some(header) = told(ilwis::parse_header(text, &HEADER))
        && let Some(raster) = told(header.raster(values, &values_path))
    {
        assert_eq!(raster.values.len(), raster.rows * raster.columns);
        parsed = Some(raster.values.len());
    }
    std::fs::write(&*HEADER, text).unwrap();
    std::fs::write(&values_path, values).unwrap();
    let read = told(ilwis::read(&values_path)).map(|(raster, _)| raster.values.len());
    // A byte order mark is passed over in a file only.
    assert!(read == parsed || text.starts_with("\u{feff}".as_bytes()));
});
