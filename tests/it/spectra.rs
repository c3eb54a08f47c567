//! Spectra in text and in ENVI's spectral libraries: read, written, converted, and refused.

use std::path::{Path, PathBuf};

use mmxrt::formats::dart::text_spectra;
use mmxrt::formats::{Format, registry, spectra};
use mmxrt::formats::{sli, spectrum_csv};
use mmxrt::report::Fate;
use mmxrt::spectral::{Band, Column, SpectralLibrary};

use crate::scratch::Scratch;

/// The format of a name.
pub(crate) fn called(name: &str) -> &'static Format {
    registry::named(name).unwrap()
}

/// Spectra of one material.
pub(crate) fn library(name: &str, wavelength_um: &[f64], columns: &[(&str, &[f64])]) -> SpectralLibrary {
    let columns = columns.iter().map(|(name, values)| Column { name: (*name).into(), values: values.to_vec() });
    SpectralLibrary {
        name: name.into(),
        comment: String::new(),
        wavelength_um: wavelength_um.to_vec(),
        columns: columns.collect(),
    }
}

/// A Lambertian material with numbers that binary fractions cannot hold.
pub(crate) fn paint() -> SpectralLibrary {
    let mut paint = library(
        "inner_paint",
        &[0.4, 0.7, 1.0, 12.0],
        &[
            ("reflectance", &[0.41, 0.525, 0.07, 0.029582]),
            ("direct_transmittance", &[0.0; 4]),
            ("diffuse_transmittance", &[0.0, 0.01, 0.02, 0.026215]),
        ],
    );
    paint.comment = "demo spectrum\nPERCENT".into();
    paint
}

fn notes(report: &mmxrt::report::Report, fate: Fate) -> Vec<String> {
    report.notes.iter().filter(|n| n.fate == fate).map(ToString::to_string).collect()
}

#[test]
fn darts_text_comes_back_as_it_was() {
    let scratch = Scratch::new();
    let path = scratch.path().join(text_spectra::file_name("inner_paint"));
    let report = spectra::write(&path, called("dart-text"), &[paint()], false).unwrap();
    assert!(report.notes.is_empty(), "{report:?}");
    let text = std::fs::read_to_string(&path).unwrap();
    let expected = "# demo spectrum\n# PERCENT\nwavelength;reflectance;direct_transmittance;diffuse_transmittance\n\
                    0.4;41;0;0\n0.7;52.5;0;1\n1;7;0;2\n12;2.9582;0;2.6215\n";
    assert_eq!(text, expected);
    let (back, report) = spectra::read(&path).unwrap();
    assert_eq!(back, [paint()]);
    assert!(report.notes.is_empty(), "{report:?}");
    assert!(text_spectra::write(&path, &paint(), false).unwrap_err().to_string().contains("exists"));
}

#[test]
fn darts_text_is_checked_cell_by_cell() {
    let header = "wavelength;reflectance;direct_transmittance;diffuse_transmittance";
    let told = |text: &str| text_spectra::parse(text, Path::new("2D-LAM_a.txt")).unwrap_err().to_string();
    let cases = [
        ("", "no header"),
        ("# only a comment\n", "no header"),
        (header, "no rows"),
        (
            "wavelength;direct_transmittance;reflectance;diffuse_transmittance\n1;2;3;4\n",
            "take one for another in silence",
        ),
        ("reflectance;wavelength\n1;2\n", "take one for another in silence"),
        ("0.4;41;0;0\n", "no column `wavelength` among 0.4, 41, 0, 0"),
        (&format!("{header}\n1;2;3\n"), "2D-LAM_a.txt:2:1: 3 columns where the header has 4"),
        (&format!("{header}\n1;2;3;4;\n"), "5 columns where the header has 4"),
        (&format!("{header}\n0,4;2;3;4\n"), "2D-LAM_a.txt:2:1: `0,4` is not a finite number"),
        (&format!("# c\n{header}\n1; 2;x;4\n"), "2D-LAM_a.txt:3:6: `x` is not a finite number"),
        (&format!("{header}\n1;nan;0;0\n"), "`nan` is not a finite number"),
        (&format!("{header}\n1;-2;0;0\n"), "2:3: reflectance -2 is outside 0 to 100"),
        (&format!("{header}\n1;101;0;0\n"), "reflectance 101 is outside 0 to 100"),
        (&format!("{header}\n1;2;0;0\n1;2;0;0\n"), "3:1: wavelength 1 appears twice"),
        (&format!("{header}\n1;2;0;0\n0.5;2;0;0\n"), "wavelength 0.5 is less than the one before"),
        (&format!("{header}\n-1;2;0;0\n"), "wavelength -1 is not positive"),
    ];
    for (text, expected) in cases {
        let told = told(text);
        assert!(told.contains(expected), "{text}\n{told}");
    }
    let fractions = format!("{header}\n1;0.4;0;0\n2;1;0;0\n");
    let (_, report) = text_spectra::parse(&fractions, Path::new("a.txt")).unwrap();
    assert!(notes(&report, Fate::Defaulted)[0].contains("probably fractions"), "{report:?}");
}

const OLD: &str = "*Name: Litter\r\nType: leaves - mostly\r\n*\r\n\r\n\
    *Number of Lambda pertinent values : *  3\r\n*Lambda_min - Lambda_max : *  0.354 0.356\r\n\
    *Hapke parameters : Bo - h - b1 - c1 - b2 - c2 *  1 1 1 1 1 1\r\n\
    *Lambda - Ro - Refraction index - A - Alpha - w_Hapke - A_Hapke_spec - Alpha_Hapke_spec - T_Direct - T_Diffus*\r\n\
    0.354\t2.6131\t1.4\t1000\t0.2\t30\t1000\t0.2\t0\t0\r\n\
    0.355\t2.6216\t1.4\t1000\t0.2\t30\t1000\t0.2\t0\t1.5\r\n\
    0.356\t7\t1.4\t1000\t0.2\t30\t1000\t0.2\t0\t0\r\n";

#[test]
fn the_old_format_gives_its_lambertian_columns() {
    let (read, report) = text_spectra::parse(OLD, Path::new("2D_litter.txt")).unwrap();
    let mut expected = library(
        "litter",
        &[0.354, 0.355, 0.356],
        &[
            ("reflectance", &[0.026131, 0.026216, 0.07]),
            ("direct_transmittance", &[0.0; 3]),
            ("diffuse_transmittance", &[0.0, 0.015, 0.0]),
        ],
    );
    expected.comment = "Name: Litter\nType: leaves - mostly".into();
    assert_eq!(read, expected);
    let dropped = notes(&report, Fate::Dropped);
    assert!(dropped.len() == 1 && dropped[0].contains("Refraction index, A, Alpha, w_Hapke"), "{dropped:?}");

    let told = |text: &str| text_spectra::parse(text, Path::new("2D_litter.txt")).unwrap_err().to_string();
    let cut = &OLD[..OLD.find("0.356\t7").unwrap()];
    assert!(told(cut).contains("2 rows, where the file says that it has 3"), "{}", told(cut));
    assert!(told(&OLD[..10]).contains("2D_litter.txt:1:1: the comment that begins here"));
    assert!(told(&OLD.replace(" - Ro - ", " - Upper reflectance - ")).contains("not supported"));
    assert!(
        told(&OLD.replace("2.6216\t", "")).contains("2D_litter.txt:10:1: 9 columns"),
        "{}",
        told(&OLD.replace("2.6216\t", ""))
    );
    assert!(told("*a*").contains("not supported"));
    assert!(told("**").contains("not supported"));
}

/// A library of two spectra in three channels, made by hand.
fn by_hand(scratch: &Scratch, name: &str, fields: &str, bytes: &[u8]) -> PathBuf {
    let header = format!("ENVI\nsamples = 3\nlines = 2\nbands = 1\nfile type = ENVI Spectral Library\n{fields}");
    scratch.write(&format!("{name}.hdr"), &header);
    let path = scratch.path().join(format!("{name}.sli"));
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn libraries_are_read_in_both_byte_orders() {
    let scratch = Scratch::new();
    let names = "spectra names = { basalt, olivine }\nwavelength units = Micrometers\nwavelength = {0.5, 1.0, 2.5}\n";
    // 0.5, 0.25, 0.125, 0, 1, 0.75 as IEEE 754 in hexadecimal.
    let single = "3f0000003e8000003e000000000000003f8000003f400000";
    let double = "3fe00000000000003fd00000000000003fc000000000000000000000000000003ff00000000000003fe8000000000000";
    let hex = |text: &str| -> Vec<u8> {
        (0..text.len() / 2).map(|i| u8::from_str_radix(&text[2 * i..2 * i + 2], 16).unwrap()).collect()
    };
    let expected = [
        library("basalt", &[0.5, 1.0, 2.5], &[("reflectance", &[0.5, 0.25, 0.125])]),
        library("olivine", &[0.5, 1.0, 2.5], &[("reflectance", &[0.0, 1.0, 0.75])]),
    ];
    for (code, text, size) in [(4, single, 4), (5, double, 8)] {
        let big = hex(text);
        let little: Vec<u8> = big.chunks(size).flat_map(|n| n.iter().rev().copied()).collect();
        for (order, bytes) in [(1, &big), (0, &little)] {
            let mut offset = vec![7; 16];
            offset.extend(bytes);
            let fields = format!("header offset = 16\ndata type = {code}\nbyte order = {order}\n{names}");
            let path = by_hand(&scratch, "a", &fields, &offset);
            let (read, report) = spectra::read(&path).unwrap();
            assert_eq!(read, expected, "{code} {order}");
            assert!(report.notes.is_empty(), "{report:?}");
            assert_eq!(sli::read(&path.with_extension("hdr")).unwrap().0, expected);
        }
    }
}

#[test]
fn libraries_say_their_units_gaps_and_names() {
    let scratch = Scratch::new();
    let bytes = |values: [f64; 6]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    // Nanometres that descend, ten-thousandths, a number that stands for none, and a bad channel.
    let fields = "data type = 5\nspectra names = {a, b:emissivity}\nwavelength units = Nanometers\nwavelength = {2500, 1000, 500}\n\
                  reflectance scale factor = 10000\ndata ignore value = -1\n";
    let path = by_hand(&scratch, "a", fields, &bytes([700.0, 2500.0, -1.0, 9000.0, 9500.0, 10000.0]));
    let (read, report) = sli::read(&path).unwrap();
    let expected = [
        library("a", &[1.0, 2.5], &[("reflectance", &[0.25, 0.07])]),
        library("b", &[0.5, 1.0, 2.5], &[("emissivity", &[1.0, 0.95, 0.9])]),
    ];
    assert_eq!(read, expected);
    assert!(notes(&report, Fate::Dropped)[0].contains("1 numbers are not there"), "{report:?}");

    // No unit, no names, a deleted channel, a bad channel, a spectrum in percent.
    let fields = "data type = 5\nwavelength = {400, 500, 600}\nbbl = {1, 1, 0}\n";
    let path = by_hand(&scratch, "b", fields, &bytes([0.1, -1.23e34, 0.2, 10.0, 20.0, 30.0]));
    let (read, report) = sli::read(&path).unwrap();
    assert_eq!(read, [library("spectrum_1", &[0.4], &[("reflectance", &[0.1])])]);
    let defaulted = notes(&report, Fate::Defaulted);
    assert!(defaulted[0].contains("taken as nanometres") && defaulted[1].contains("numbers"), "{defaulted:?}");
    let dropped = notes(&report, Fate::Dropped);
    assert!(dropped[0].contains("spectrum 2 \"spectrum_2\": left out: 10 is outside 0 to 1"), "{dropped:?}");
    assert!(dropped[1].contains("3 numbers are not there"), "{dropped:?}");
}

#[test]
fn libraries_that_cannot_be_used_are_refused() {
    let scratch = Scratch::new();
    let good = "data type = 5\nwavelength units = um\nwavelength = {1, 2, 3}\n";
    let bytes = [0; 48];
    let cases: [(&str, &[u8], &str); 12] = [
        (good, &bytes[..47], "47 bytes, but its header asks for 2 spectra of 3 numbers"),
        ("data type = 5\nheader offset = 1\nwavelength = {1, 2, 3}\n", &bytes, "of 8 bytes after 1"),
        (
            "data type = 5\nheader offset = 18446744073709551615\nwavelength = {1, 2, 3}\n",
            &bytes,
            "its header asks for",
        ),
        ("data type = 5\n", &bytes, "0 wavelengths for spectra of 3"),
        ("data type = 5\nwavelength = {1, 2}\n", &bytes, "2 values for 3 samples"),
        ("data type = 5\nwavelength = {0, 1, 2}\n", &bytes, "must be positive numbers"),
        ("data type = 5\nwavelength = {1, 2, nan}\n", &bytes, "items that are not finite numbers"),
        ("data type = 5\nwavelength = {1, 2, 3}\nwavelength units = Index\n", &bytes, "index is not supported"),
        ("data type = 6\nwavelength = {1, 2, 3}\n", &bytes, "data type 6 (complex numbers) is not supported"),
        ("data type = 5\nwavelength = {1, 2, 3}\nbbl = {1, x, 1}\n", &bytes, "not a list of 3 numbers"),
        ("data type = 5\nwavelength = {1, 2, 3}\nreflectance scale factor = 0\n", &bytes, "not a positive number"),
        ("data type = 5\nwavelength = {1, 2, 3}\ndata ignore value = 0\n", &bytes, "no spectrum can be used"),
    ];
    for (fields, bytes, expected) in cases {
        let told = sli::read(&by_hand(&scratch, "a", fields, bytes)).unwrap_err().to_string();
        assert!(told.contains(expected), "{fields}\n{told}");
    }
    // A promise of more than any memory holds, and more spectra than one band.
    let huge = "ENVI\nsamples = 3\nlines = 99999999999\nbands = 1\ndata type = 5\nfile type = ENVI Spectral Library\n\
                wavelength = {1, 2, 3}\n";
    scratch.write("a.hdr", huge);
    assert!(sli::read(&scratch.path().join("a.sli")).unwrap_err().to_string().contains("its header asks for"));
    scratch.write("a.hdr", huge.replace("bands = 1", "bands = 2"));
    assert!(sli::read(&scratch.path().join("a.sli")).unwrap_err().to_string().contains("2 bands"));
    std::fs::remove_file(scratch.path().join("a.hdr")).unwrap();
    assert!(sli::read(&scratch.path().join("a.sli")).unwrap_err().to_string().contains("header is not beside it"));
}

#[test]
fn many_materials_pass_through_libraries_tables_and_folders() {
    let scratch = Scratch::new();
    let mut opaque = library("basalt", &[0.4, 0.7, 1.0, 12.0], &[("reflectance", &[0.1, 1.0 / 3.0, 1e-7, 0.3])]);
    opaque.columns.push(Column { name: "emissivity".into(), values: vec![0.9; 4] });
    let mut plain = paint();
    plain.comment.clear();
    plain.columns.remove(1); // opaque: left out of tables of many
    let all = [plain, opaque];
    for (name, format) in [("a.sli", called("sli")), ("a.csv", called("csv")), ("tables", called("csv"))] {
        let path = scratch.path().join(name);
        let report = spectra::write(&path, format, &all, false).unwrap();
        assert!(report.notes.is_empty(), "{name} {report:?}");
        let (mut back, report) = spectra::read(&path).unwrap();
        back.sort_by(|a, b| b.name.cmp(&a.name));
        assert_eq!(back, all, "{name}");
        assert!(report.notes.is_empty(), "{name} {report:?}");
        assert!(spectra::write(&path, format, &all, false).is_err(), "{name} is not replaced");
    }
    let csv = std::fs::read_to_string(scratch.path().join("a.csv")).unwrap();
    assert!(
        csv.starts_with(
            "wavelength_um,inner_paint,inner_paint:diffuse_transmittance,basalt,basalt:emissivity\n0.4,0.41,0,0.1,0.9\n"
        ),
        "{csv}"
    );

    // What materials in scenes read is what is written.
    let one = scratch.path().join("basalt.csv");
    assert!(spectra::write(&one, called("csv"), &all[1..], false).unwrap().notes.is_empty());
    let (reflectance, _) =
        spectrum_csv::read(&one, spectrum_csv::Quantity::Reflectance, mmxrt::spectral::Extend::Error)
            .map(|r| (r.0, r.1))
            .unwrap();
    assert_eq!(reflectance.value(), all[1].columns[0].values);

    // Texts: one material in a file, Lambertian ones only; nothing half done is left.
    let told = |path: &str, spectra: &[SpectralLibrary]| {
        spectra::write(&scratch.path().join(path), called("dart-text"), spectra, false).unwrap_err().to_string()
    };
    assert!(told("b.txt", &all).contains("name a folder"));
    let hapke = library("h", &[1.0], &["w", "c1", "c2", "c3", "c4", "h1", "h2"].map(|n| (n, &[0.5][..])));
    let refused = told("texts", &[paint(), hapke]);
    assert!(refused.contains("texts/2D-LAM_h.txt") && refused.contains("not supported"), "{refused}");
    assert!(!scratch.path().join("texts").exists());
    let report = spectra::write(&scratch.path().join("texts"), called("dart-text"), &[paint()], false).unwrap();
    assert!(report.notes.is_empty(), "{report:?}");
    assert_eq!(spectra::read(&scratch.path().join("texts")).unwrap().0, [paint()]);
}

#[test]
fn what_a_format_cannot_hold_is_told() {
    let scratch = Scratch::new();
    let a = library("a", &[1.0, 2.0], &[("reflectance", &[0.1, 0.2])]);
    let told = |name: &str, format: &Format, spectra: &[SpectralLibrary]| {
        spectra::write(&scratch.path().join(name), format, spectra, false).unwrap_err().to_string()
    };
    let other = library("b", &[1.0, 3.0], &[("reflectance", &[0.1, 0.2])]);
    assert!(
        told("a.sli", called("sli"), &[a.clone(), other.clone()])
            .contains("its wavelengths are not those of the first")
    );
    // A table has gaps where one of its spectra has no value, and reads them as such.
    let gappy = scratch.path().join("gaps.csv");
    assert!(spectra::write(&gappy, called("csv"), &[a.clone(), other.clone()], false).unwrap().notes.is_empty());
    assert_eq!(std::fs::read_to_string(&gappy).unwrap(), "wavelength_um,a,b\n1,0.1,0.1\n2,0.2,NaN\n3,NaN,0.2\n");
    let (back, report) = spectra::read(&gappy).unwrap();
    assert_eq!((back, report.notes.len()), (vec![a.clone(), other], 2));
    assert!(told("a.sli", called("sli"), &[]).contains("no spectra to write"));
    assert!(
        told("a.sli", called("sli"), &[library("x, y", &[1.0], &[("reflectance", &[0.1])])]).contains("such a name")
    );
    assert!(
        told("a.sli", called("sli"), &[library("x", &[1.0], &[("speed", &[0.1])])]).contains("speed cannot be written")
    );
    assert!(
        told("a.csv", called("csv"), &[library("x", &[1.0], &[("speed", &[0.1])])]).contains("none of its columns")
    );
    assert!(
        told("a.csv", called("csv"), &[library("x", &[1.0], &[("reflectance_percent", &[0.1])])])
            .contains("name of a column")
    );
    // A header with one of these is parted there, whatever else parts it.
    for name in ["sand; wet", "sand\twet"] {
        let wet = library(name, &[1.0, 2.0], &[("reflectance", &[0.1, 0.2])]);
        assert!(told("a.csv", called("csv"), &[a.clone(), wet]).contains("cannot be the name of a column"), "{name}");
    }
    assert!(
        told("a.sli", called("sli"), &[library("x", &[1.0], &[("reflectance", &[f64::NAN])])])
            .contains("not all values")
    );
    // Named by the file, comments for several.
    let report = spectra::write(&scratch.path().join("b.csv"), called("csv"), std::slice::from_ref(&a), false).unwrap();
    assert!(notes(&report, Fate::Approximated)[0].contains("the name \"a\" is not kept"), "{report:?}");
    let mut said = library("c", &[1.0, 2.0], &[("reflectance", &[0.1, 0.2])]);
    said.comment = "measured".into();
    let report = spectra::write(&scratch.path().join("c.sli"), called("sli"), &[a, said], false).unwrap();
    assert!(notes(&report, Fate::Dropped)[0].contains("no place for comments"), "{report:?}");
    // Names of files.
    assert!(matches!(spectra::read(&scratch.path().join("none.sli")), Err(mmxrt::Error::Invalid(_))));
    assert!(matches!(spectra::read(&scratch.path().join("none")), Err(mmxrt::Error::Io { .. })));
    let readme = scratch.write("README.md", "spectra");
    assert!(matches!(spectra::read(&readme), Err(mmxrt::Error::Unsupported { .. })));
    assert!(spectra::read(scratch.path()).is_ok());
}

#[test]
fn tables_of_many_spectra_are_checked_cell_by_cell() {
    let told = |text: &str| spectrum_csv::parse_all(text, Path::new("a.csv"), None).unwrap_err().to_string();
    let cases = [
        ("", "no header"),
        ("lambda,a\n120,0.1\n", "does not state the unit"),
        ("wavelength_um\n1\n", "one column"),
        ("no,wavelength_um\n1,0.5\n2,0.6\n", "1:4: one column"),
        ("##\u{8}#\n,a\u{30a}\n##sun \n3 02", "2:2: one column"),
        ("wavelength_um,a,A\n1,0,0\n", "a.csv:1:17: `A` appears twice"),
        ("wavelength_um,a,\n1,0,0\n", "has no name"),
        ("wavelength_um,a\n", "no rows"),
        ("wavelength_um,a\n1,7\n", "a.csv:2:3: reflectance 7 is outside 0 to 1"),
        ("wavelength_um,a_percent\n1,101\n", "outside 0 to 100"),
        ("wavelength_um,a,b\n1,0.1\n", "a.csv:2:1: 2 columns where the header has 3"),
        ("wavelength_um,a\n1,0.1\n1,0.2\n", "a.csv:3:1: wavelength 1 appears twice, with different values"),
    ];
    for (text, expected) in cases {
        assert!(told(text).contains(expected), "{text}\n{}", told(text));
    }
    let rpv = spectrum_csv::parse_all(
        "# site 3\nwavelength_nm,reflectance_percent,k,g,h\n400,7,0.8,-0.1,0.05\n",
        Path::new("pad.csv"),
        None,
    );
    let mut expected =
        library("pad", &[0.4], &[("reflectance", &[0.07]), ("k", &[0.8]), ("g", &[-0.1]), ("h", &[0.05])]);
    expected.comment = "site 3".into();
    assert_eq!(rpv.unwrap().0, [expected]);
}

#[test]
fn resampled_spectra_have_the_bands_wavelengths() {
    let bands = [0.5, 0.6, 0.9].map(|centre_um| Band::new(centre_um, Some(0.02)));
    let seen = spectra::resample(&[paint()], &bands).unwrap();
    assert_eq!(seen[0].wavelength_um, [0.5, 0.6, 0.9]);
    // Linear within each band.
    let expected = [0.41 + 0.115 / 3.0, 0.41 + 0.23 / 3.0, 0.525 - 0.455 * 2.0 / 3.0];
    for (value, expected) in seen[0].column("reflectance").unwrap().iter().zip(expected) {
        assert!((value - expected).abs() < 1e-12, "{value} {expected}");
    }
    let beyond = spectra::resample(&[paint()], &[Band::new(0.4, Some(0.02))]);
    assert!(beyond.unwrap_err().to_string().contains("inner_paint"));
}

#[cfg(not(feature = "sqlite"))]
#[test]
fn without_sqlite_databases_are_not_supported() {
    let scratch = Scratch::new();
    let path = scratch.write("a.db", "SQLite format 3\0");
    let told = spectra::read(&path).unwrap_err().to_string();
    assert!(
        told.contains("a.db: a SQLite database (mmxrt was built without its feature `sqlite`) is not supported"),
        "{told}"
    );
    assert!(spectra::write(&path, called("db"), &[paint()], true).unwrap_err().to_string().contains("not supported"));
    assert!(matches!(spectra::read(&scratch.path().join("b.db")), Err(mmxrt::Error::Io { .. })));
}
