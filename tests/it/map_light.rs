//! What light radiance maps hold, and what of it bands get that have sunlight alone, or heat alone; what maps know in each band; units
//! and widths that a map file says, or should.

use crate::map_files::Bench;
use crate::scenes::SQUARE;

/// Two bands of one place, 1 um wide at 10 um: `light` is what the map file says of them.
fn two_bands(bench: &Bench, light: &str) {
    let map = format!(
        "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W m-2 sr-1 um-1\"\nplacement = \"facets\"\n\
         bands = {{ centres_um = [10.0, 10.0], fwhm_um = 1{light} }}\n"
    );
    of_two(bench, "m", ["1\n1\n", "20\n20\n"], &map);
}

/// A map of two rasters, a band each, with a number for each of the two facets.
fn of_two(bench: &Bench, name: &str, numbers: [&str; 2], map: &str) {
    bench.0.write("first.csv", numbers[0]);
    bench.0.write("second.csv", numbers[1]);
    let rasters = "mmxrt_map = 1\nraster = [\"first.csv\", \"second.csv\"]";
    bench.0.write(&format!("{name}.map.toml"), map.replace("mmxrt_map = 1", rasters));
}

/// Whether the report of a product that a map makes says something.
fn said(bench: &Bench, path: &str, needle: &str) -> bool {
    bench.integrate(&["--radiance", path]);
    std::fs::read_to_string(bench.0.join("out/report.json")).unwrap().contains(needle)
}

fn sensor(bench: &Bench, bands: &str) {
    bench.0.write("scene.toml", SQUARE.replace("centres_um = [1.0]", bands));
}

fn refused(bench: &Bench, path: &str, message: &str) {
    let (code, err) = bench.try_to(&["--radiance", path]);
    assert!(code == 1 && err.contains(message), "{err}");
}

#[test]
fn bands_of_one_place_are_told_apart_by_their_light() {
    let bench = Bench::new();
    let apart = "centres_um = [10.0, 10.0]\nfwhm_um = 1\nlight = [\"sunlight\", \"heat\"]";
    sensor(&bench, apart);
    two_bands(&bench, ", light = [\"sunlight\", \"heat\"]");
    let image = bench.integrate(&["--radiance", "{}m.map.toml"]);
    assert!((image[0] - 1.0).abs() < 1e-12 && (image[4] - 20.0).abs() < 1e-12, "{image:?}");
    // In the other order, and the heat among both.
    two_bands(&bench, ", light = [\"heat\", \"sunlight\"]");
    let image = bench.integrate(&["--radiance", "{}m.map.toml"]);
    assert!((image[0] - 20.0).abs() < 1e-12 && (image[4] - 1.0).abs() < 1e-12, "{image:?}");
    two_bands(&bench, ", light = [\"heat\", \"both\"]");
    refused(&bench, "{}m.map.toml", "has sunlight alone, and the map's there also holds other light");
    sensor(&bench, "centres_um = [10.0, 10.0]\nfwhm_um = 1\nlight = [\"both\", \"heat\"]");
    let image = bench.integrate(&["--radiance", "{}m.map.toml"]);
    assert!((image[0] - 20.0).abs() < 1e-12 && (image[4] - 1.0).abs() < 1e-12, "{image:?}");
    // Both are their sum, of which no band of the map is.
    two_bands(&bench, ", light = [\"heat\", \"sunlight\"]");
    refused(&bench, "{}m.map.toml", "could be several of the map's that are the same but for their light");
    // Of which nobody knows which is which.
    sensor(&bench, apart);
    two_bands(&bench, "");
    refused(&bench, "{}m.map.toml", "say what light each has");
}

#[test]
fn a_band_of_sunlight_gets_no_heat() {
    let bench = Bench::new();
    let map = |quantity: &str, unit: &str, more: &str| {
        bench.0.write("t.csv", "290\n290\n");
        bench.0.write(
            "t.map.toml",
            format!(
                "mmxrt_map = 1\nquantity = \"{quantity}\"\nunit = \"{unit}\"\nplacement = \"facets\"\n{more}\
                 bands = {{ centres_um = [10.0], fwhm_um = 1 }}\n"
            ),
        );
    };
    let with = |light: &str| sensor(&bench, &format!("centres_um = [10.0]\nfwhm_um = 1\nlight = \"{light}\""));
    with("sunlight");
    map("brightness_temperature", "K", "");
    refused(&bench, "{}t.csv", "band 1 of the sensor, 1 um wide at 10 um, has sunlight alone");
    map("radiance", "W/m2/sr/um", "heat = true\n");
    refused(&bench, "{}t.csv", "band 1 of the sensor, 1 um wide at 10 um, has sunlight alone");
    let said = |needle: &str| said(&bench, "{}t.csv", needle);
    // Of a radiance nobody knows: it is taken, and told where heat may be.
    map("radiance", "W/m2/sr/um", "");
    assert!((bench.integrate(&["--radiance", "{}t.csv"])[0] - 290.0).abs() < 1e-9);
    assert!(said("holds heat there, too, nobody says"));
    map("radiance", "W/m2/sr/um", "heat = false\n");
    assert!(!said("nobody says"));
    with("heat");
    refused(&bench, "{}t.csv", "has heat alone");
    map("brightness_temperature", "K", "");
    assert!(said("holds sunlight there, too, nobody says"));
    with("both");
    assert!(!said("nobody says"));
    // Short of 2.5 um nothing glows.
    bench.0.write("t.map.toml", std::fs::read_to_string(bench.0.join("t.map.toml")).unwrap().replace("10.0", "2.0"));
    sensor(&bench, "centres_um = [2.0]\nfwhm_um = 1\nlight = \"sunlight\"");
    refused(&bench, "{}t.csv", "has sunlight alone");
    map("radiance", "W/m2/sr/um", "");
    bench.0.write("t.map.toml", std::fs::read_to_string(bench.0.join("t.map.toml")).unwrap().replace("10.0", "2.0"));
    assert!(!said("nobody says"));
    map("radiance", "W/m2/sr/um", "heat = true\n");
    let text = std::fs::read_to_string(bench.0.join("t.map.toml")).unwrap();
    bench.0.write("t.map.toml", text.replace("fwhm_um = 1", "fwhm_um = 1, light = \"heat\""));
    refused(&bench, "{}t.csv", "is in `light` of `bands` already");
}

#[test]
fn what_one_band_knows_all_must_know() {
    let bench = Bench::new();
    let map = "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W/m2/sr/um\"\nplacement = \"facets\"\n\
               bands = { centres_um = [1.0, 2.0] }\n";
    sensor(&bench, "centres_um = [1.0, 2.0]");
    for (numbers, place) in [
        (["nan\n2\n", "1\n3\n"], "texel 0 (counted from 0) has a value here, and none in band 1"),
        (["1\n2\n", "nan\n3\n"], "has no value"),
    ] {
        of_two(&bench, "k", numbers, map);
        let (code, err) = bench.try_to(&["--radiance", "{}k.map.toml", "--unknown", "7"]);
        assert!(code == 1 && err.contains(place) && err.contains("band 2"), "{err}");
        assert!(err.contains("must be the same in all of its bands"), "{err}");
    }
    // Facet 0 is what lies below the diagonal: all of the pixel at sample 1, line 1.
    of_two(&bench, "k", ["nan\n2\n", "nan\n3\n"], map);
    assert!((bench.integrate(&["--radiance", "{}k.map.toml", "--unknown", "7"])[3] - 7.0).abs() < 1e-9);
}

#[test]
fn units_are_taken_in_all_their_spellings_and_told_if_they_are_none() {
    let bench = Bench::new();
    sensor(&bench, "centres_um = [10.0]");
    bench.0.write("u.csv", "3\n3\n");
    let with = |unit: &str| {
        let map = format!(
            "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"{unit}\"\nplacement = \"facets\"\nbands = {{ centres_um = [10.0] }}\n"
        );
        bench.0.write("u.map.toml", map);
    };
    // At 10 um a wavenumber, cm-1, is 10^2 / 10^4 um = 0.01 um wide.
    for (unit, times) in [
        ("W/m2/sr/um", 1.0),
        ("W m^-2 sr^-1 nm^-1", 1e3),
        ("mW/(m2 sr cm-1)", 0.1),
        ("W/m2/sr/cm-1", 100.0),
        ("0.1 W/m2/sr/um", 0.1),
    ] {
        with(unit);
        let image = bench.integrate(&["--radiance", "{}u.csv"]);
        assert!((image[0] / (3.0 * times) - 1.0).abs() < 1e-12, "{unit}: {image:?}");
    }
    for unit in ["W/m2/sr/um*10", "W/m2/sr/um-1", "Jy/sr"] {
        with(unit);
        refused(&bench, "{}u.csv", "is not understood");
        refused(&bench, "{}u.csv", "mW/(m2 sr cm-1)");
    }
    with("K");
    refused(&bench, "{}u.csv", "must be one of spectral radiance");
}

#[test]
fn bands_without_widths_are_points_and_wavelengths_in_nm_are_noticed() {
    let bench = Bench::new();
    let with = |bands: &str| {
        let map = format!(
            "mmxrt_map = 1\nquantity = \"radiance\"\nunit = \"W/m2/sr/um\"\nplacement = \"facets\"\nbands = {{ {bands} }}\n"
        );
        of_two(&bench, "w", ["1\n1\n", "2\n2\n"], &map);
    };
    sensor(&bench, "centres_um = [0.55, 0.70]\nfwhm_um = 0.06");
    with("centres_um = [0.55, 0.70]");
    refused(&bench, "{}w.map.toml", "they have no widths, which `fwhm_um` says");
    with("centres_um = [550.0, 700.0]");
    refused(&bench, "{}w.map.toml", "if these are nm, write thousandths");
    with("centres_um = [0.55, 0.70], fwhm_um = 0.06");
    let image = bench.integrate(&["--radiance", "{}w.map.toml"]);
    assert!((image[0] - 1.0).abs() < 1e-12 && (image[4] - 2.0).abs() < 1e-12, "{image:?}");
    // A band of 0.02 um amid points that are 0.15 um apart: 1 + 0.07 / 0.15, and told.
    sensor(&bench, "centres_um = [0.62]\nfwhm_um = 0.02");
    with("centres_um = [0.55, 0.70]");
    assert!(said(&bench, "{}w.map.toml", "are taken as points of a spectrum"));
    assert!((bench.integrate(&["--radiance", "{}w.map.toml"])[0] - (1.0 + 0.07 / 0.15)).abs() < 1e-9);
}

#[test]
fn our_own_image_is_a_map_of_the_same_bands() {
    // Bands as wide as the Sun's lines are deep: were they points, they would be averaged again.
    let bench = Bench::new();
    sensor(&bench, "centres_um = [0.40, 0.43, 0.46]\nfwhm_um = 0.03");
    let (scene, out) = (bench.0.argument("scene.toml"), bench.0.argument("first"));
    let (code, _, err) = crate::cli::run(&["simulate", &scene, "-o", &out, "--exr", "--dtype", "f64"]);
    assert_eq!(code, 0, "{err}");
    let bytes = std::fs::read(bench.0.join("first/cube.img")).unwrap();
    let expected: Vec<f64> = bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    bench.0.write(
        "own.map.toml",
        "mmxrt_map = 1\nraster = \"first/cube.exr\"\nquantity = \"radiance\"\nplacement = \"camera\"\nscene = \"scene.toml\"\n",
    );
    let image = bench.integrate(&["--radiance", "{}own.map.toml"]);
    assert_eq!(image.len(), 12);
    assert!(image.iter().zip(&expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-6), "{image:?} {expected:?}");
}
