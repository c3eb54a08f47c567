//! Any text is a spectrum of DART or of a table, or an error; what is written of it is read back.
#![no_main]

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::dart::text_spectra;
use mmxrt::formats::{photometry_csv, spectrum_csv};
use mmxrt::scene::{Hapke, Rpv};
use mmxrt::spectral::Extend;

mod files;

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| files::scratch("text_spectra"));

fuzz_target!(|text: &str| {
    let path = Path::new("2D-LAM_fuzz.txt");
    if let Some((library, _)) = told(text_spectra::parse(text, path)) {
        let path = FOLDER.join(path);
        if told(text_spectra::write(&path, &library, true)).is_some() {
            let (back, _) = text_spectra::read(&path).unwrap();
            assert_eq!(back.wavelength_um, library.wavelength_um);
        }
    }
    let path = Path::new("fuzz.csv");
    if let Some((libraries, _)) = told(spectrum_csv::parse_all(text, path, None)) {
        let path = FOLDER.join(path);
        if told(spectrum_csv::write(&path, &libraries, true)).is_some() {
            let (back, _) = spectrum_csv::read_all(&path, None).unwrap();
            assert_eq!(back[0].wavelength_um, libraries[0].wavelength_um);
        }
    }
    for quantity in
        [spectrum_csv::Quantity::Reflectance, spectrum_csv::Quantity::Emissivity, spectrum_csv::Quantity::Irradiance]
    {
        told(spectrum_csv::parse(text, path, quantity, Extend::Error));
    }
    told(photometry_csv::parse(text, path, Hapke::NAMES, Extend::Hold));
    told(photometry_csv::parse(text, path, Rpv::NAMES, Extend::Hold));
});
