//! ENVI headers as other programs write them.

use mmxrt::formats::envi;
use mmxrt::formats::raster::Raster;
use mmxrt::formats::registry;

use crate::cli::run;
use crate::scratch::Scratch;

const HEAD: &str = "samples = 2\nlines = 1\nbands = 2\ndata type = 4\ninterleave = bsq\nbyte order = 0\n";

/// An image of two bands, 1 and 2, 3 and 4.
fn opened(folder: &Scratch, header: impl AsRef<[u8]>) -> Raster {
    folder.write("a.hdr", header);
    let path = folder.write("a.img", [1_f32, 2.0, 3.0, 4.0].map(f32::to_le_bytes).concat());
    registry::image(&path).unwrap()
}

fn with(more: &str) -> String {
    format!("ENVI\n{HEAD}{more}\n")
}

fn notes(raster: &Raster) -> String {
    raster.report.notes.iter().map(|note| format!("{note}\n")).collect()
}

fn centres(raster: &Raster) -> Vec<Option<f64>> {
    raster.bands.iter().map(|band| band.centre_um).collect()
}

#[test]
fn wavelengths_have_units_in_every_spelling() {
    let folder = Scratch::new();
    for (unit, list) in [
        ("\u{b5}m", "0.5, 0.625"),
        ("\u{3bc}m", "0.5, 0.625"),
        ("MICROMETRES", "0.5, 0.625"),
        ("um", "0.5, 0.625"),
        ("Nanometres", "500, 625"),
        ("nanometre", "500, 625"),
        ("Angstroms", "5000, 6250"),
        ("\u{c5}", "5000, 6250"),
        ("Wavenumber", "20000, 16000"),
        ("cm^-1", "20000, 16000"),
        ("Millimeters", "0.0005, 0.000625"),
    ] {
        let raster = opened(&folder, with(&format!("wavelength units = {unit}\nwavelength = {{{list}}}")));
        assert_eq!(centres(&raster), [Some(0.5), Some(0.625)], "{unit}");
        assert!(raster.report.notes.is_empty(), "{unit}: {}", notes(&raster));
    }
    // Latin-1, in which the sign is one byte that is no UTF-8.
    let text = with("wavelength units = \u{b5}m\nwavelength = {0.5, 0.625}");
    let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
    assert_eq!(centres(&opened(&folder, latin)), [Some(0.5), Some(0.625)]);
    // Metres: 5e-7 m.
    let metres = opened(&folder, with("wavelength units = Meters\nwavelength = {5e-7, 6.25e-7}"));
    assert!(centres(&metres).iter().zip([0.5, 0.625]).all(|(a, b)| (a.unwrap() / b - 1.0).abs() < 1e-15));
    let named = opened(&folder, with("band names = {Band 1 (500 nm), Band 2 (0.625 um)}"));
    assert!(centres(&named) == [Some(0.5), Some(0.625)] && notes(&named).contains("as the names of the bands say"));
    // A name that would say sixty thousand wavelengths says none.
    let endless = opened(&folder, with(&format!("band names = {{{}, 2}}", "500nm".repeat(60_000))));
    assert_eq!(centres(&endless), [None, None]);
    let index = opened(&folder, with("wavelength units = Index\nwavelength = {1, 2}"));
    assert!(centres(&index) == [None, None] && notes(&index).contains("in Index, which is not a unit of wavelength"));
}

#[test]
fn widths_are_in_their_own_unit() {
    let folder = Scratch::new();
    let widths = |more: &str| {
        let raster = opened(&folder, with(more));
        (raster.bands.iter().map(|band| band.fwhm_um).collect::<Vec<_>>(), notes(&raster))
    };
    let nm = "wavelength units = nm\nwavelength = {500, 625}\n";
    assert_eq!(widths(&format!("{nm}fwhm = {{5, 10}}")).0, [Some(0.005), Some(0.01)]);
    // From 9950 to 10050 cm-1 is from 1.00502512563 to 0.99502487562 um.
    let (waves, _) = widths("wavelength units = cm-1\nwavelength = {10000, 5000}\nfwhm = {100, 0}");
    assert!((waves[0].unwrap() - 0.010_000_250_006).abs() < 1e-12 && waves[1].is_none());
    let um = "wavelength units = um\nwavelength = {0.5, 0.625}\n";
    let (mixed, said) = widths(&format!("{um}fwhm = {{5, 10}}"));
    assert!(mixed == [Some(0.005), Some(0.01)] && said.contains("taken as nanometres"), "{said}");
    let (none, said) = widths(&format!("{um}fwhm = {{5000, 10}}"));
    assert!(none == [None, None] && said.contains("widths that are none"), "{said}");
}

#[test]
fn headers_are_read_as_they_are_written() {
    let folder = Scratch::new();
    let lists = "wavelength units = nm\nwavelength = {500, 625}\nband names = {a, b}\n";
    let usual = opened(&folder, with(lists));
    let same = |text: String| {
        let raster = opened(&folder, &text);
        assert_eq!(raster.bands, usual.bands, "{text}");
        let mut values = Vec::new();
        raster.clone().read(1, &mut values).unwrap();
        assert_eq!(values, [3.0, 4.0]);
        notes(&raster)
    };
    assert_eq!(same(format!("\u{feff}ENVI\r\n{}", format!("{HEAD}{lists}").replace('\n', "\r\n"))), "");
    assert_eq!(
        same(with(lists).replace("samples", "Samples").replace("wavelength =", "WAVELENGTH=").replace("bsq", "BSQ")),
        ""
    );
    assert_eq!(same(with(lists).replacen("ENVI", "envi ", 1)), "");
    // As pytools4dart joins them.
    assert_eq!(same(with(&lists.replace("}\n", "}"))), "");
    assert_eq!(same(with(&lists.replace("= {", "=\n{\n").replace(", ", ",\n"))), "");
    assert_eq!(same(with(&lists.replace("500, 625", "500 625")).replace("samples = 2", "samples = 2.0 ; pixels")), "");
    assert_eq!(same(with(&format!("description = {{of {{a}} b = c}}\n; a comment\ndata ignore value =\n{lists}"))), "");
    // One more byte than belongs there.
    folder.write("b.hdr", with(lists));
    let path = folder.write("b.img", [0; 17]);
    assert!(notes(&registry::image(&path).unwrap()).contains("has 17 bytes where 0 + 1 rows"));
    // Names in capitals.
    folder.write("C.HDR", with(lists));
    let path = folder.write("C.IMG", [0; 16]);
    assert!(registry::image(&path).is_ok() && registry::image(&folder.join("C.HDR")).is_ok());
}

#[test]
fn names_with_commas_are_no_other_bands_names() {
    let folder = Scratch::new();
    let names = |list: &str| {
        let raster = opened(&folder, with(&format!("band names = {{{list}}}")));
        (raster.bands.iter().map(|band| band.name.clone()).collect::<Vec<_>>(), notes(&raster))
    };
    let (none, said) = names("Albedo, raw, Slope");
    assert!(none == ["", ""] && said.contains("3 names for 2 bands"), "{said}");
    assert_eq!(names("\n Albedo, raw,\n Slope"), (vec!["Albedo, raw".into(), "Slope".into()], String::new()));
    assert_eq!(names("Albedo, Slope,\n").0, ["Albedo", "Slope"]);
    assert_eq!(names("one").0, ["", ""]);
}

#[test]
fn what_is_misspelt_is_asked_about_and_other_headers_are_named() {
    let folder = Scratch::new();
    let raster = opened(&folder, with("wavelengths = {0.5, 0.6}"));
    let said = notes(&raster);
    assert!(said.contains("a.hdr:8 wavelengths") && said.contains("did you mean `wavelength`?"), "{said}");
    folder.write("a.hdr", with("").replace("data type", "data_type"));
    let error = registry::image(&folder.join("a.img")).unwrap_err().to_string();
    assert!(error.contains("data type: is missing (help: is `data_type` meant for it?)"), "{error}");
    // As GDAL writes beside a .bil.
    let path = folder
        .write("e.hdr", "BYTEORDER      I\nLAYOUT         BIL\nNROWS          1\nNCOLS          2\nNBANDS         2\n");
    folder.write("e.bil", [0; 16]);
    let error = envi::read_header(&path).unwrap_err().to_string();
    assert!(error.contains("a header of ESRI") && error.contains("gdal_translate -of ENVI"), "{error}");
    for name in ["e.hdr", "e.bil"] {
        let (code, _, err) = run(&["inspect", &folder.argument(name)]);
        assert!(code == 1 && err.contains("ESRI"), "{err}");
    }
}

#[test]
fn a_header_costs_no_more_than_its_length() {
    let folder = Scratch::new();
    // What is quadratic in these takes minutes.
    let braces = opened(&folder, with(&format!("description = {{{}}}\nwavelength = {{1, 2}}", "} ".repeat(400_000))));
    assert_eq!(centres(&braces), [Some(1.0), Some(2.0)]);
    // Keys that may be meant for others: each is told once, and no more than a few.
    let keys = opened(&folder, with(&"wavelengt = {1, 2}\n".repeat(20_000)));
    assert_eq!(notes(&keys).matches("did you mean `wavelength`").count(), 1);
    let keys: String = (0..2000).map(|i| format!("{}avelength = 1\n", char::from_u32(0x4e00 + i).unwrap())).collect();
    let told = notes(&opened(&folder, with(&keys))).matches("did you mean `wavelength`").count();
    assert!((1..100).contains(&told), "{told}");
}
