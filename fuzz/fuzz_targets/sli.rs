//! Any header and any numbers are a spectral library, or an image whose bands have a mean, or an error. A byte 0 parts them.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::{envi, sli};

mod files;

static DATA: LazyLock<PathBuf> = LazyLock::new(|| files::scratch("sli").join("fuzz.sli"));

fuzz_target!(|bytes: &[u8]| {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    let (header, numbers) = bytes.split_at(end);
    let header = String::from_utf8_lossy(header);
    if let Some(header) = told(envi::parse_header(&DATA.with_extension("hdr"), &header)) {
        let library = told(sli::parse(&header, numbers, &DATA));
        std::fs::write(&*DATA, numbers).unwrap();
        if let Some(bands) = told(envi::statistics(&header, &DATA)) {
            assert_eq!(bands.len(), header.bands);
        }
        if let Some((library, _)) = library
            && told(sli::write(&DATA, &library, true)).is_some()
        {
            // What is written holds the same spectra, those of one material perhaps put together.
            let (back, _) = sli::read(&DATA).unwrap();
            let count = |all: &[mmxrt::spectral::SpectralLibrary]| all.iter().map(|l| l.columns.len()).sum::<usize>();
            assert!(count(&back) <= count(&library));
        }
    }
});
