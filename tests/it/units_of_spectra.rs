//! What spectra are of and in: quantities, units and scales, by hand.

use std::path::Path;

use mmxrt::formats::spectrum_csv::{self, Quantity};
use mmxrt::formats::{scene_toml, sli, spectra};
use mmxrt::progress::unwatched;
use mmxrt::spectral::Extend;

use crate::cli::run;
use crate::scratch::Scratch;

/// Wavelengths, um, and values of a table, and what was told of it.
fn read(text: &str, quantity: Quantity) -> (Vec<(f64, f64)>, Vec<String>) {
    let (spectrum, report) = spectrum_csv::parse(text, Path::new("a.csv"), quantity, Extend::Error)
        .unwrap_or_else(|e| panic!("{e}\n{text}"));
    let points = spectrum.wavelength_um().iter().copied().zip(spectrum.value().iter().copied()).collect();
    (points, report.notes.iter().map(|note| note.message.clone()).collect())
}

fn refused(text: &str, quantity: Quantity) -> String {
    match spectrum_csv::parse(text, Path::new("a.csv"), quantity, Extend::Error) {
        Ok((spectrum, _)) => panic!("{spectrum:?}\n{text}"),
        Err(error) => error.to_string(),
    }
}

/// A plate under the Sun, with materials, a table `[sun]` and a band at 10 um.
fn scene(materials: &str, sun: &str) -> String {
    format!(
        "mmxrt_scene = 1\norigin_m = [0, 0, 10000]\n[[mesh]]\nobj = \"plate.obj\"\n[materials]\n{materials}\n\
         [sun]\ndirection = [0, 0, 1]\ndistance_au = 1.0\n{sun}\n\
         [observer]\nposition_m = [0, 0, 10100]\ntarget_m = [0, 0, 10000]\nup = [0, 1, 0]\n\
         [sensor]\nsamples = 3\nlines = 3\nfov_deg = 0.5\nbands = {{ centres_um = [10.0] }}\n"
    )
}

fn prepared() -> Scratch {
    let scratch = Scratch::new();
    scratch.write(
        "plate.obj",
        "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl ground\nf 1/1 2/2 3/3 4/4\n",
    );
    scratch
}

fn opened(scratch: &Scratch, materials: &str, sun: &str) -> scene_toml::SceneFile {
    let path = scratch.write("scene.toml", scene(materials, sun));
    scene_toml::read(&path, &unwatched).unwrap_or_else(|e| panic!("{e}"))
}

fn defaults(opened: &scene_toml::SceneFile) -> String {
    opened.defaults.iter().map(|stated| format!("{} = {}\n", stated.item, stated.value)).collect()
}

#[test]
fn a_mixture_emits_what_its_parts_emit() {
    let scratch = prepared();
    let materials = "metal = { reflectance = 0.5, emissivity = 0.2 }\ndust = { reflectance = 0.1 }\n\
                     inner = { mixture = { metal = 0.5, dust = 0.5 } }\nground = { mixture = { metal = 0.25, dust = 0.75 } }\n\
                     outer = { mixture = { inner = 0.5, metal = 0.5 } }\nstated = { mixture = { metal = 1.0 }, emissivity = 0.6 }\n\
                     plain = { mixture = { dust = 1.0 } }";
    let opened = opened(&scratch, materials, "");
    let emissivity = |name: &str| {
        let material = opened.scene.body.materials.iter().find(|m| m.name == name).unwrap();
        material.emissivity.at(10.0).unwrap()
    };
    // 0.25 x 0.2 + 0.75 x 0.9; 0.5 x 0.55 + 0.5 x 0.2.
    for (name, expected) in
        [("ground", 0.725), ("inner", 0.55), ("outer", 0.375), ("stated", 0.6), ("plain", 0.9), ("metal", 0.2)]
    {
        assert!((emissivity(name) - expected).abs() < 1e-15, "{name}: {}", emissivity(name));
    }
    let told = defaults(&opened);
    assert!(told.contains("ground.emissivity = that of its parts"), "{told}");
    assert!(told.contains("plain.emissivity = 1 - reflectance"), "{told}");
}

#[test]
fn a_bond_albedo_from_little_sunlight_is_warned_of() {
    let scratch = prepared();
    let warned = |ends: [f64; 2]| {
        scratch.write("ground.csv", format!("wavelength_um,reflectance\n{},0.02\n{},0.02\n", ends[0], ends[1]));
        let opened = opened(&scratch, "ground = { reflectance = \"ground.csv\" }", "");
        opened.notes.join("\n")
    };
    // E490: 2.016 W m-2 from 7 to 14 um, of 1366.09.
    assert!(warned([7.0, 14.0]).contains("0.0200 is the mean over 0.1 % of sunlight only"), "{}", warned([7.0, 14.0]));
    assert!(!warned([0.2, 14.0]).contains("sunlight"), "{}", warned([0.2, 14.0]));
}

#[test]
fn the_total_says_what_is_of_the_table_and_what_is_beyond() {
    let scratch = prepared();
    // E = 20 (um - 0.2): 20 x 13 x 13 / 2.
    scratch.write("sun.csv", "wavelength_um,irradiance_w_m2_um\n0.2,0\n13.2,260\n");
    let told = defaults(&opened(&scratch, "ground = { reflectance = 0.1 }", "spectrum = \"sun.csv\""));
    assert!(told.contains("1690.00 W m-2 in the table + ") && told.contains("of E490 beyond its ends"), "{told}");
    let told = defaults(&opened(&scratch, "ground = { reflectance = 0.1 }", ""));
    assert!(told.contains("1366.09: the spectrum as it is, not scaled") && !told.contains("beyond its ends"), "{told}");
}

#[test]
fn a_librarys_gains_offsets_and_scale_all_count() {
    let scratch = Scratch::new();
    let values: Vec<u8> = [1.0f64, 2.0, 3.0, 4.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let path = scratch.write("a.sli", values);
    let read = |more: &str| {
        scratch.write(
            "a.hdr",
            format!(
                "ENVI\nsamples = 2\nlines = 2\nbands = 1\nfile type = ENVI Spectral Library\ndata type = 5\nbyte order = 0\n\
                 wavelength units = Micrometers\nwavelength = {{1, 0.5}}\nspectra names = {{a, b}}\n{more}"
            ),
        );
        sli::read(&path).map(|(spectra, _)| spectra)
    };
    // One for all: (1 x 0.25 + 0.5) / 2 and so on. Wavelengths descend in the file.
    let spectra =
        read("data gain values = {0.25}\ndata offset values = {0.5}\nreflectance scale factor = 2\n").unwrap();
    assert_eq!(spectra[0].column("reflectance"), Some(&[0.5, 0.375][..]));
    assert_eq!(spectra[1].column("reflectance"), Some(&[0.75, 0.625][..]));
    // One for each channel.
    let spectra = read("data gain values = {0.25, 0.125}\n").unwrap();
    assert_eq!(spectra[0].column("reflectance"), Some(&[0.25, 0.25][..]));
    assert_eq!(spectra[1].column("reflectance"), Some(&[0.5, 0.75][..]));
    let told = read("data gain values = {0.25, 0.125, 1}\n").unwrap_err().to_string();
    assert!(told.contains("data gain values") && told.contains("one for each channel, or a single one"), "{told}");
}

#[test]
fn percent_of_what_a_header_made_fractions_is_told() {
    let scratch = prepared();
    scratch.write("t.img", 50.0f64.to_le_bytes());
    let header = "ENVI\nsamples = 1\nlines = 1\nbands = 1\ndata type = 5\nbyte order = 0\ninterleave = bsq\n";
    let warned = |more: &str, unit: &str| {
        scratch.write("t.hdr", format!("{header}{more}"));
        let texture =
            format!("{{ raster = \"t.img\", quantity = \"reflectance\", placement = \"atlas\", unit = \"{unit}\" }}");
        opened(&scratch, &format!("ground = {{ reflectance = 0.5, texture = {texture} }}"), "").notes.join("\n")
    };
    assert!(warned("reflectance scale factor = 100\n", "%").contains("divides by 100 once more"));
    assert!(!warned("reflectance scale factor = 100\n", "1").contains("once more"));
    assert!(!warned("", "%").contains("once more"));
}

#[test]
fn the_column_is_that_of_the_quantity_that_is_asked_for() {
    let both = "wavelength_um,emissivity,reflectance\n10,0.95,0.05\n";
    assert_eq!(read(both, Quantity::Reflectance), (vec![(10.0, 0.05)], vec![]));
    assert_eq!(read(both, Quantity::Emissivity), (vec![(10.0, 0.95)], vec![]));
    let (points, told) = read("wavelength_um,albedo,sigma\n1,0.1,0.2\n", Quantity::Reflectance);
    assert!(
        points == [(1.0, 0.1)] && told.len() == 1 && told[0].contains("`albedo` is taken as reflectance"),
        "{told:?}"
    );
    for (heading, asked, help) in [
        ("emissivity", Quantity::Reflectance, "1 - emissivity (Kirchhoff)"),
        ("Emissivity (percent)", Quantity::Reflectance, "1 - emissivity (Kirchhoff)"),
        ("reflectance", Quantity::Emissivity, "1 - reflectance (Kirchhoff)"),
        ("emissivity", Quantity::Albedo, "1 - emissivity (Kirchhoff)"),
        ("transmittance", Quantity::Reflectance, "a column `reflectance`"),
        ("Absorbance", Quantity::Reflectance, "a column `reflectance`"),
        ("log(1/R)", Quantity::Reflectance, "10^-x"),
        ("irradiance_w_m2_um", Quantity::Reflectance, "a column `reflectance`"),
        ("reflectance", Quantity::Irradiance, "irradiance_w_m2_um"),
        ("emissivity,sigma", Quantity::Reflectance, "1 - emissivity (Kirchhoff)"),
    ] {
        let more = if heading.contains(',') { ",0.1" } else { "" };
        let told = refused(&format!("wavelength_um,{heading}\n1,0.5{more}\n"), asked);
        assert!(told.contains(", but no ") && told.contains(help), "{heading}: {told}");
    }
    let ecostress = "Name: a\nX Units: Wavelength (micrometers)\nY Units: Emissivity (percent)\n\n1.0 95\n2.0 96\n";
    assert!(refused(ecostress, Quantity::Reflectance).contains("(Kirchhoff)"));
    assert_eq!(read(ecostress, Quantity::Emissivity).0, [(1.0, 0.95), (2.0, 0.96)]);
    assert!(
        refused("wavelength_um,reflectance,Reflectance\n1,0.1,0.2\n", Quantity::Reflectance).contains("appears twice")
    );
}

#[test]
fn a_unit_of_wavelengths_that_is_stated_is_taken() {
    // 1e4 / 1000 cm-1; 299.792458 um THz; h c = 1.239841984 um eV.
    for (heading, written, um) in [
        ("wavenumber_cm-1", "1000", 10.0),
        ("Wavenumber (cm-1)", "1000", 10.0),
        ("cm-1", "1000", 10.0),
        ("wavenumber [1/cm]", "1000", 10.0),
        ("frequency_THz", "100", 2.99792458),
        ("Frequency (GHz)", "100000", 2.99792458),
        ("frequency_Hz", "1e14", 2.99792458),
        ("wavelength (A)", "5000", 0.5),
        ("wavelength [A]", "5000", 0.5),
        ("wavelength_angstrom", "5000", 0.5),
        ("wavelength_mm", "0.01", 10.0),
        ("Wavelength (m)", "1e-5", 10.0),
        ("energy_eV", "0.5", 2.479683968),
        ("wavelength/nm", "500", 0.5),
        ("Wavelength in vacuum, nm", "500", 0.5),
    ] {
        let (points, told) = read(&format!("{heading};reflectance\n{written};0.1\n"), Quantity::Reflectance);
        assert!((points[0].0 / um - 1.0).abs() < 1e-9, "{heading}: {points:?}");
        assert!(told.is_empty(), "{heading}: {told:?}");
    }
    // Ascending in cm-1 is descending in um.
    let (points, _) = read("cm-1,reflectance\n1000,0.1\n2000,0.2\n", Quantity::Reflectance);
    assert_eq!(points, [(5.0, 0.2), (10.0, 0.1)]);
    for heading in ["wavenumber", "frequency", "energy", "wavelength (furlong)", "wavelength_furlong", "energy_kcal"] {
        let told = refused(&format!("{heading},reflectance\n10,0.1\n"), Quantity::Reflectance);
        assert!(told.contains("um, nm, angstrom") && told.contains("a.csv:1:1"), "{heading}: {told}");
    }
    assert!(refused("cm-1,reflectance\n0,0.1\n", Quantity::Reflectance).contains("wavelength 0 is not positive"));
}

#[test]
fn irradiance_is_converted_from_the_unit_that_is_stated() {
    // Powers of ten: m W, u W and k W; 1e4 cm2 and 1e3 nm in a m2 and a um.
    for (unit, times) in [
        ("W m-2 um-1", 1.0),
        ("W m-2 nm-1", 1e3),
        ("mW m-2 nm-1", 1.0),
        ("uW cm-2 nm-1", 10.0),
        ("W cm-2 um-1", 1e4),
        ("kW m-2 um-1", 1e3),
        ("W/m2/nm", 1e3),
        ("W/m^2/nm", 1e3),
        ("W m2 nm", 1e3),
        ("W m\u{207b}\u{b2} nm\u{207b}\u{b9}", 1e3),
        ("mW/cm2/um", 10.0),
    ] {
        let text = format!("wavelength_um;spectral irradiance ({unit})\n1;2\n");
        let (points, told) = read(&text, Quantity::Irradiance);
        assert!((points[0].1 / (2.0 * times) - 1.0).abs() < 1e-12, "{unit}: {points:?}");
        assert!(told.len() == 1 && told[0].contains(unit), "{unit}: {told:?}");
        let (all, _) = spectrum_csv::parse_all(&text, Path::new("a.csv"), None).unwrap();
        assert_eq!(all[0].column("irradiance_w_m2_um"), Some(&[points[0].1][..]), "{unit}");
    }
    for (heading, says) in [
        ("irradiance", "does not state its unit"),
        ("irradiance (photons s-1 m-2 nm-1)", "not a known unit of spectral irradiance"),
        ("irradiance (W m-2 sr-1 nm-1)", "not a known unit of spectral irradiance"),
        ("irradiance (furlong)", "not a known unit of spectral irradiance"),
        ("irradiance_w_m2", "not a known unit of spectral irradiance"),
        ("irradiance (W m-2 (cm-1)-1)", "1e4 / (wavelength in um)^2"),
        ("irradiance (W/m2/cm-1)", "1e4 / (wavelength in um)^2"),
    ] {
        let text = format!("wavelength_um,{heading}\n1,2\n");
        let told = refused(&text, Quantity::Irradiance);
        assert!(told.contains(says) && told.contains("irradiance_w_m2_um"), "{heading}: {told}");
        let told = spectrum_csv::parse_all(&text, Path::new("a.csv"), None).unwrap_err().to_string();
        assert!(told.contains(says), "{heading}: {told}");
    }
}

#[test]
fn percent_is_percent_in_every_spelling() {
    for unit in ["percent", "percentage", "Percentage", "per cent", "pct", "0-100", "%"] {
        let (points, told) = read(&format!("wavelength_um,reflectance ({unit})\n1,12.5\n"), Quantity::Reflectance);
        assert!(points == [(1.0, 0.125)] && told.is_empty(), "{unit}: {points:?} {told:?}");
        let text = format!("Name: a\nX Units: Wavelength (micrometers)\nY Units: Reflectance ({unit})\n\n1.0 12.5\n");
        assert_eq!(read(&text, Quantity::Reflectance).0, [(1.0, 0.125)], "{unit}");
    }
    let (points, told) = read("wavelength_um,reflectance (sample 3)\n1,0.5\n", Quantity::Reflectance);
    assert!(points == [(1.0, 0.5)] && told[0].contains("`sample 3` is not a known unit"), "{told:?}");
    for unit in ["x10000", "ppm", "W m-2"] {
        let told = refused(&format!("wavelength_um,reflectance ({unit})\n1,0.5\n"), Quantity::Reflectance);
        assert!(told.contains("not a known unit of a fraction"), "{unit}: {told}");
    }
    // Fifteen rows, one error, with what the layout has for percent.
    let rows: String = (1..=15).map(|i| format!("{i}.0 {}\n", 10 + i)).collect();
    for (header, help) in [
        ("wavelength_um reflectance\n", "`reflectance_percent`"),
        ("Name: a\nX Units: Wavelength (micrometers)\nY Units: Reflectance\n\n", "`Y Units: Reflectance (percent)`"),
        ("", "put a header above it"),
    ] {
        let told = refused(&format!("{header}{rows}"), Quantity::Reflectance);
        assert!(told.lines().count() == 1 && told.contains("as are 14 more values") && told.contains(help), "{told}");
    }
}

#[test]
fn a_text_means_the_same_to_a_scene_and_to_convert() {
    let scratch = prepared();
    let lambertian = "wavelength;reflectance;direct_transmittance;diffuse_transmittance\n0.5;20;0;0\n";
    for (name, text, um, value, says) in [
        ("plain.txt", "wavelength;reflectance\n0.5;0.2\n", 0.5, 0.2, "taken as fractions"),
        ("2D-LAM_a.txt", "wavelength;reflectance\n0.5;20\n", 0.5, 0.2, "percent"),
        ("dart.txt", lambertian, 0.5, 0.2, "percent"),
    ] {
        let path = scratch.write(name, text);
        let (one, _, report) = spectra::read_one(&path, Quantity::Reflectance, Extend::Error).unwrap();
        assert_eq!((one.wavelength_um(), one.value()), (&[um][..], &[value][..]), "{name}");
        assert!(report.notes.iter().any(|note| note.message.contains(says)), "{name}: {report:?}");
        let (all, _) = spectra::read(&path).unwrap();
        assert_eq!(all[0].column("reflectance"), Some(&[value][..]), "{name}");
    }
    // DART's texts are in um, whatever the numbers.
    let path = scratch.write("2D-LAM_b.txt", "wavelength;reflectance\n500;20\n");
    let (_, report) = spectra::read(&path).unwrap();
    assert!(report.notes.iter().any(|note| note.message.contains("500: taken as um")), "{report:?}");
    let path = scratch.argument("plain.txt");
    let (code, said, err) = run(&["convert", &path, &scratch.argument("out.csv")]);
    assert!(code == 0 && said.contains("taken as fractions"), "{said}{err}");
}
