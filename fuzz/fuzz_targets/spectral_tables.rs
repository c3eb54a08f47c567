//! Any text is a spectral table of whatever layout, or an error; what is written of it is read back.
//!
//! Behind a byte 0 are the wavelengths of a text of values alone.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::spectrum_csv::{self, Quantity};
use mmxrt::spectral::{Extend, solar_mean};

mod files;

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| files::scratch("spectral_tables"));

fuzz_target!(|bytes: &[u8]| {
    let end = bytes.iter().position(|b| *b == 0);
    let (table, wavelengths) = (FOLDER.join("fuzz.txt"), FOLDER.join("wavelengths.txt"));
    std::fs::write(&table, &bytes[..end.unwrap_or(bytes.len())]).unwrap();
    if let Some(end) = end {
        std::fs::write(&wavelengths, &bytes[end + 1..]).unwrap();
    }
    for quantity in [Quantity::Reflectance, Quantity::Irradiance] {
        if let Some((spectrum, ..)) = told(spectrum_csv::read(&table, quantity, Extend::Hold)) {
            assert!(spectrum.wavelength_um().windows(2).all(|w| w[0] < w[1]));
            let _ = solar_mean(&spectrum);
        }
    }
    let Some((libraries, _)) = told(spectrum_csv::read_all(&table, end.map(|_| wavelengths.as_path()))) else { return };
    let again = FOLDER.join("again.csv");
    if told(spectrum_csv::write(&again, &libraries, true)).is_some() {
        let (back, _) = spectrum_csv::read_all(&again, None).unwrap();
        assert_eq!(back[0].wavelength_um, libraries[0].wavelength_um);
    }
});
