//! DART's optical databases, text spectra and spectral libraries: read, written, and refused.

use mmxrt::formats::dart::database;
use mmxrt::formats::spectra;
use mmxrt::spectral::{Column, SpectralLibrary};

use crate::scratch::Scratch;

fn library(name: &str, wavelength_um: &[f64], columns: &[(&str, &[f64])]) -> SpectralLibrary {
    let columns = columns.iter().map(|(name, values)| Column { name: (*name).into(), values: values.to_vec() });
    SpectralLibrary {
        name: name.into(),
        comment: String::new(),
        wavelength_um: wavelength_um.to_vec(),
        columns: columns.collect(),
    }
}

#[test]
fn a_database_comes_back_as_it_was() {
    let scratch = Scratch::new();
    let path = scratch.path().join("a.db");
    let mut paint = library(
        "inner_paint",
        &[0.4, 0.7, 1.0],
        &[
            ("reflectance", &[0.41, 0.525, 0.07]),
            ("direct_transmittance", &[0.0; 3]),
            ("diffuse_transmittance", &[0.0, 0.01, 0.02]),
        ],
    );
    paint.comment = "demo spectrum\nPERCENT".into();
    let report = database::create(&path, std::slice::from_ref(&paint), false).unwrap();
    assert!(report.notes.is_empty(), "{report:?}");
    let (back, report) = spectra::read(&path).unwrap();
    assert_eq!(back, [paint]);
    assert!(report.notes.is_empty(), "{report:?}");
    let (reflectance, report) = database::lambertian(&path, "Inner_Paint").unwrap();
    assert_eq!(reflectance.value(), [0.41, 0.525, 0.07]);
    assert_eq!(report.notes.len(), 1, "{report:?}");
    assert!(report.notes[0].to_string().contains("table Inner_Paint: diffuse_transmittance of up to 2 %"));
}
