//! Spectra as other people write them: what is read, what is told, and what cannot be known.

use std::path::Path;

use mmxrt::formats::spectrum_csv::{self, Quantity};
use mmxrt::formats::{registry, spectra};
use mmxrt::spectral::{Extend, Spectrum};

use crate::cli::run;
use crate::scratch::Scratch;

/// Wavelengths and values of a spectrum, and what was told of it.
fn fraction(text: &str) -> (Vec<(f64, f64)>, Vec<String>) {
    read(text, Quantity::Reflectance)
}

fn read(text: &str, quantity: Quantity) -> (Vec<(f64, f64)>, Vec<String>) {
    let (spectrum, report) = spectrum_csv::parse(text, Path::new("a.txt"), quantity, Extend::Error)
        .unwrap_or_else(|e| panic!("{e}\n{text}"));
    (points(&spectrum), report.notes.iter().map(|note| note.message.clone()).collect())
}

fn points(spectrum: &Spectrum) -> Vec<(f64, f64)> {
    spectrum.wavelength_um().iter().copied().zip(spectrum.value().iter().copied()).collect()
}

fn refused(text: &str, quantity: Quantity) -> String {
    spectrum_csv::parse(text, Path::new("a.txt"), quantity, Extend::Error).unwrap_err().to_string()
}

#[test]
fn separators_quotes_capitals_and_brackets_say_the_same() {
    let expected = vec![(0.5, 0.05), (1.0, 0.125)];
    for text in [
        "wavelength_um,reflectance\n0.5,0.05\n1.0,0.125\n",
        "wavelength_um;reflectance\n0.5;0.05\n1.0;0.125\n",
        "wavelength_um\treflectance\n0.5\t0.05\n1.0\t0.125\n",
        "wavelength_um reflectance\n0.5 0.05\n1.0   0.125\n",
        "\"Wavelength_um\",\"Reflectance\"\n\"0.5\",\"0.05\"\n1.0,0.125\n",
        "WAVELENGTH_NM,REFLECTANCE_PERCENT\n500,5\n1000,12.5\n",
        "Wavelength (nm), Reflectance (%)\n500, 5\n1000, 12.5\n",
        "Wavelength [µm];Reflectance\n1.0;0.125\n0.5;0.05\n",
        "wavelength(μm)\tReflectance (percent)\n0.5\t5\n1\t12.5\n",
        "# wavelength[um] reflectance\n0.5  0.05\n1.0  0.125\n",
        "Wavelength (micrometers)   Reflectance\n0.5 0.05\n1.0 0.125\n",
        "Some Lab Spectrum XX-YYY\nWavelength(micron)\tReflectance\n0.5\t0.05\n1.0\t0.125\n",
        "wavelength_angstrom,reflectance\n5000,0.05\n10000,0.125\n",
        "wavelength_um,reflectance,\n0.5,0.05,\n1,0.125,\n",
    ] {
        assert_eq!(fraction(text), (expected.clone(), vec![]), "{text}");
    }
}

#[test]
fn what_a_table_does_not_say_is_taken_and_told() {
    // Three columns of a laboratory, without a header: nanometres, reflectance, its deviation.
    let (read, told) = fraction("  400.0\t0.07\t0.001\n  800.0\t0.09\t0.001\n");
    assert_eq!(read, [(0.4, 0.07), (0.8, 0.09)]);
    assert!(told[0].contains("from 400 to 800 they are taken as nm") && told[1].contains("no header"), "{told:?}");
    let (read, told) = fraction("wavelength,red\n0.5,0.1\n");
    assert_eq!(read, [(0.5, 0.1)]);
    assert!(told[0].contains("taken as um") && told[1].contains("`red` is taken as a fraction"), "{told:?}");
    // Where detectors overlap, wavelengths step back.
    let (read, told) = fraction("wavelength_nm,reflectance\n400,0.1\n900,0.2\n880,0.3\n1000,0.4\n");
    assert_eq!(read, [(0.4, 0.1), (0.88, 0.3), (0.9, 0.2), (1.0, 0.4)]);
    assert!(told.len() == 1 && told[0].contains("step back 1 times"), "{told:?}");
    // Gaps of three kinds.
    let (read, told) = fraction("wavelength_um;reflectance\n1;0.1\n2;nan\n3;\n4;-1.23e34\n5;0.2\n");
    assert_eq!(read, [(1.0, 0.1), (5.0, 0.2)]);
    assert!(told.len() == 1 && told[0].contains("3 rows have no value, the first at 2 um"), "{told:?}");
    // Fractions that are called percent.
    let (read, told) = fraction("wavelength_um,reflectance_percent\n1,0.5\n2,0.75\n");
    assert_eq!(read, [(1.0, 0.005), (2.0, 0.0075)]);
    assert!(told.len() == 1 && told[0].contains("probably fractions"), "{told:?}");
}

#[test]
fn sunlight_says_per_what() {
    for (text, factor) in [
        ("Wavelength(nm)  Irradiance(W m-2 nm-1)\n500\t1.5\n1000\t0.7\n", 1000.0),
        ("wavelength (nm),solar spectral irradiance (W/m2/nm)\n500,1.5\n1000,0.7\n", 1000.0),
        ("wavelength_um,irradiance_w_m2_um\n0.5,1500\n1,700\n", 1.0),
    ] {
        let (read, told) = read(text, Quantity::Irradiance);
        let scale = 1000.0 / factor;
        let expected = [(0.5, 1.5 * scale * factor), (1.0, 0.7 * scale * factor)];
        for ((um, value), (expected_um, expected)) in read.iter().zip(expected) {
            assert!((um - expected_um).abs() < 1e-15 && (value - expected).abs() < 1e-9, "{text}: {read:?}");
        }
        // Our own spelling says itself what it is.
        let is_told = told.len() == 1 && told[0].contains(&format!("which is {factor} W m-2 um-1"));
        assert!(read.len() == 2 && (told.is_empty() || is_told), "{text}: {told:?}");
    }
    // The unit stands behind the wrong comma.
    let (sun, told) = read("# Wavelength, microns E-490 W/m2/micron\n0.5 1500\n1.0 700\n", Quantity::Irradiance);
    assert_eq!(sun, [(0.5, 1500.0), (1.0, 700.0)]);
    assert!(told.len() == 2 && told[0].contains("taken as um") && told[1].contains("W/m2/micron"), "{told:?}");
    for text in ["0.4 1400\n0.6 1700\n", "wavelength, spectral irradiance\n0.4, 1400\n0.6, 1700\n"] {
        let told = refused(text, Quantity::Irradiance);
        assert!(told.contains("irradiance_w_m2_um"), "{told}");
    }
}

#[test]
fn decimal_commas_and_ragged_rows_are_errors() {
    let told = refused("wavelength_um,reflectance\n0,4,0,05\n1,0,0,07\n", Quantity::Reflectance);
    assert!(told.contains("a.txt:2:1: 4 columns where the header has 2 (help: is the decimal sign a comma"), "{told}");
    let told = refused("wavelength_um;reflectance\n0,4;0,05\n", Quantity::Reflectance);
    assert!(told.contains("`0,4` is not a finite number (help: the decimal sign is a point)"), "{told}");
    let told = refused("wavelength_um,reflectance\n0.4,0.05,x\n1,0.06\n4,0.1,1,2\n", Quantity::Reflectance);
    assert_eq!(told.matches("columns where the header has 2").count(), 2, "{told}");
    // A separator at the end of each line parts nothing.
    for text in ["lambda,\n2.5,\n", "wavelength_um,\n"] {
        for quantity in [Quantity::Reflectance, Quantity::Irradiance] {
            let told = refused(text, quantity);
            assert!(told.contains("a.txt:1:1: one column: a wavelength and a value"), "{told}");
        }
        assert!(
            spectrum_csv::parse_all(text, Path::new("a.txt"), None).unwrap_err().to_string().contains("one column")
        );
    }
}

/// Forty lines of made-up rock: twenty of words, percent that descend.
fn ecostress() -> String {
    let head = "Name: Made-up rock\r\nType: Rock\r\nX Units: Wavelength (micrometers)\r\nY Units: Reflectance (percent)\r\n\
                First X Value: 2.0\r\nAdditional Information: none\r\n\r\n";
    format!("{head} 2.0000\t12.5\r\n 1.0000\t10.0\r\n 0.5000\t7.5\r\n")
}

#[test]
fn libraries_of_spectra_in_text_are_read_by_what_they_say() {
    let scratch = Scratch::new();
    let rock = scratch.write("rock.spectrum.txt", ecostress());
    assert_eq!(registry::of_spectra(&rock), registry::named("csv"));
    let (read, report) = spectra::read(&rock).unwrap();
    assert_eq!((read[0].name.as_str(), read[0].wavelength_um.as_slice()), ("Made-up rock", &[0.5, 1.0, 2.0][..]));
    assert_eq!(read[0].column("reflectance"), Some(&[0.075, 0.1, 0.125][..]));
    assert!(report.notes.is_empty() && read[0].comment.contains("Type: Rock"), "{report:?}");
    assert_eq!(fraction(&ecostress()).0, [(0.5, 0.075), (1.0, 0.1), (2.0, 0.125)]);
    let told = refused(&ecostress().replace("(micrometers)", "(wavenumber)"), Quantity::Reflectance);
    assert!(told.contains("um, nm, angstrom, pm, mm, cm, m, cm-1"), "{told}");

    // Values and wavelengths in two files, a deleted channel.
    let values = scratch.argument("values.txt");
    scratch
        .write("values.txt", " splib07a Record=999: Made-up mineral ASDFRa AREF\n 6.0e-002\n -1.23e+034\n 8.0e-002\n");
    scratch.write("um.txt", " splib07a Record=1: Wavelengths 0.5-1.5 microns\n 5.0e-001\n 1.0e+000\n 1.5e+000\n");
    let (um, out) = (scratch.argument("um.txt"), scratch.argument("mineral.csv"));
    let (code, _, err) = run(&["convert", &values, &out]);
    assert!(code == 1 && err.contains("--wavelengths FILE"), "{err}");
    let (code, said, err) = run(&["convert", &values, &out, "--wavelengths", &um]);
    assert!(code == 0 && said.contains("1 rows have no value"), "{said}{err}");
    let table = std::fs::read_to_string(&out).unwrap();
    assert!(table.ends_with("wavelength_um,reflectance\n0.5,0.06\n1.5,0.08\n"), "{table}");
    scratch.write("um.txt", " splib07a Record=1: Wavelengths 0.5-1.5 microns\n 5.0e-001\n");
    let (code, _, err) = run(&["convert", &values, &out, "--wavelengths", &um, "--force"]);
    assert!(code == 1 && err.contains("3 values for 1 wavelengths"), "{err}");

    // Several materials with gaps: one of them by its name.
    let library = scratch.argument("library.csv");
    scratch.write("library.csv", "wavelength_nm,regolith,boulder\n500,0.07,0.12\n600,nan,0.13\n700,0.08,\n");
    let out = scratch.argument("boulder.csv");
    assert_eq!(run(&["convert", &library, &out, "--model", "boulder"]).0, 0);
    let table = std::fs::read_to_string(&out).unwrap();
    assert!(table.ends_with("wavelength_um,reflectance\n0.5,0.12\n0.6,0.13\n"), "{table}");
    let told = refused("wavelength_nm,regolith,boulder\n500,0.07,0.12\n", Quantity::Reflectance);
    assert!(told.contains("holds 2 spectra: regolith, boulder") && told.contains("--model regolith"), "{told}");

    // Tables by other endings, and sunlight as a spectrum.
    for (name, text, column) in [
        ("lab.tab", "400\t0.07\t0.001\n800\t0.09\t0.001\n", "reflectance"),
        ("two.dat", "# wavelength[um] reflectance\n2.5 0.07\n2.0 0.08\n", "reflectance"),
        ("sun.txt", "Wavelength(nm)  Irradiance(W m-2 nm-1)\n500\t1.5\n1000\t0.7\n", "irradiance_w_m2_um"),
    ] {
        let path = scratch.argument(name);
        scratch.write(name, text);
        let out = scratch.argument(&format!("{name}.csv"));
        let (code, _, err) = run(&["convert", &path, &out]);
        assert_eq!(code, 0, "{name}: {err}");
        let table = std::fs::read_to_string(&out).unwrap();
        assert!(table.contains(&format!("wavelength_um,{column}\n")), "{name}: {table}");
        // What was written is read back as it was.
        assert_eq!(
            spectra::read(Path::new(&out)).unwrap().0[0].columns,
            spectra::read(Path::new(&path)).unwrap().0[0].columns
        );
        assert_eq!(run(&["inspect", &path]).0, 0, "{name}");
    }
    scratch.write("sun.dat", "0.4 1400\n0.6 1700\n");
    let (code, _, err) = run(&["convert", &scratch.argument("sun.dat"), &scratch.argument("sun.csv")]);
    assert!(code == 1 && err.contains("put a header above it"), "{err}");
}

#[test]
fn a_library_of_an_instrument_with_overlapping_detectors_is_sorted() {
    let scratch = Scratch::new();
    let header = |names: &str| {
        format!(
            "ENVI\nsamples = 4\nlines = 2\nbands = 1\nfile type = ENVI Spectral Library\ndata type = 5\nbyte order = 0\n\
             wavelength units = Nanometers\nwavelength = {{400, 900, 880, 900}}\nspectra names = {{{names}}}\n"
        )
    };
    let values: Vec<u8> = [0.1f64, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8].iter().flat_map(|v| v.to_le_bytes()).collect();
    let path = scratch.write("a.sli", values);
    scratch.write("a.hdr", header("a, a"));
    let (read, report) = spectra::read(&path).unwrap();
    let told: String = report.notes.iter().map(|note| format!("{}\n", note.message)).collect();
    assert!(told.contains("step back 1 times") && told.contains("1 that appear twice the first is kept"), "{told}");
    assert!(told.contains("1 names appear twice"), "{told}");
    assert_eq!(read[0].wavelength_um, [0.4, 0.88, 0.9]);
    assert_eq!(read[0].column("reflectance"), Some(&[0.1, 0.3, 0.2][..]));
    assert_eq!((read[1].name.as_str(), read[1].column("reflectance")), ("a_2", Some(&[0.5, 0.7, 0.6][..])));
    // A name with a comma in it.
    scratch.write("a.hdr", header("Albedo, raw, Slope"));
    let (read, report) = spectra::read(&path).unwrap();
    assert_eq!(read[0].name, "spectrum_1");
    assert!(report.notes.iter().any(|note| note.message.contains("3 names for 2 spectra")), "{report:?}");
}

#[test]
fn a_scene_says_how_a_library_is_taken_apart() {
    let scratch = Scratch::new();
    scratch.write("lib.sli", [0u8; 16]);
    scratch.write("lib.hdr", "ENVI\n");
    scratch.write("square.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    scratch.write(
        "scene.toml",
        "mmxrt_scene = 1\norigin_m = [0, 0, 0]\n[[mesh]]\nobj = \"square.obj\"\nmaterial = \"a\"\n[materials]\na = { reflectance = \"lib.sli\" }\n\
         [sun]\ndirection = [0, 0, 1]\ndistance_au = 1\n[observer]\nposition_m = [0, 0, 10]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]\n\
         [sensor]\nsamples = 2\nlines = 2\nifov_mrad = 1\nbands = { centres_um = [1] }\n",
    );
    let (code, _, err) = run(&["inspect", &scratch.argument("scene.toml")]);
    assert!(code == 1 && err.contains("mmxrt convert lib.sli one.csv --model NAME"), "{err}");
}
