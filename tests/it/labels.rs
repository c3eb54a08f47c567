//! What goes with the numbers of an image: labels of PDS4, bad bands, coordinate systems; and the formats of all commands that write cubes.

use std::path::Path;

use mmxrt::formats::raster::Raster;
use mmxrt::formats::registry;

use crate::cli::run;
use crate::instrument::DETECTOR;
use crate::scratch::Scratch;

/// Level ground of 10 m from 1 km above, two bands.
const SCENE: &str = "mmxrt_scene = 1\norigin_m = [0, 0, 11000]\n[[mesh]]\nobj = \"square.obj\"\nmaterial = \"grey\"\n\
     [materials]\ngrey = { reflectance = 0.2 }\n[sun]\ndirection = [0.8660254037844386, 0, 0.5]\ndistance_au = 1\n\
     [observer]\nframe = \"site\"\nposition_m = [0, 0, 1000]\ntarget_m = [0, 0, 0]\nup = [0, 1, 0]\n\
     [sensor]\nsamples = 4\nlines = 3\nifov_mrad = 1.0\nbands = { start_um = 1.0, stop_um = 1.5, count = 2, fwhm_um = 0.02 }\n";

fn folder() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("square.obj", "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nf 1 2 3 4\n");
    scratch.write("scene.toml", SCENE);
    scratch
}

fn simulate(scratch: &Scratch, out: &str, more: &[&str]) {
    let (scene, out) = (scratch.argument("scene.toml"), scratch.argument(out));
    let (code, _, err) = run(&[&["simulate", &scene, "-o", &out, "--model", "sunlight", "--quiet"][..], more].concat());
    assert_eq!((code, err.as_str()), (0, ""));
}

fn open(path: &Path) -> Raster {
    registry::image(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn all_values(raster: &mut Raster) -> Vec<f64> {
    let mut all = Vec::new();
    let mut band = Vec::new();
    for i in 0..raster.bands.len() {
        raster.read(i, &mut band).unwrap();
        all.extend_from_slice(&band);
    }
    all
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
}

#[test]
fn a_label_says_of_the_numbers_what_the_header_does() {
    let scratch = folder();
    for (interleave, dtype, axes) in [
        ("bsq", "f32", ["Band", "Line", "Sample"]),
        ("bil", "f64", ["Line", "Band", "Sample"]),
        ("bip", "f32", ["Line", "Sample", "Band"]),
    ] {
        let out = format!("out_{interleave}");
        simulate(&scratch, &out, &["--format", "pds4", "--interleave", interleave, "--dtype", dtype]);
        let path = |name: &str| scratch.join(&out).join(name);
        // The header alone, without a label beside its numbers.
        let mut envi = open(&path("cube.hdr"));
        let mut labelled = open(&path("cube.xml"));
        assert_eq!([labelled.rows, labelled.columns, labelled.bands.len()], [3, 4, 2], "{interleave}");
        assert!(same(&all_values(&mut labelled), &all_values(&mut envi)), "{interleave}");
        assert_eq!(labelled.unit.as_deref(), Some("W m-2 sr-1 um-1"));
        let of_bands: Vec<_> = labelled.bands.iter().map(|band| (band.centre_um, band.fwhm_um)).collect();
        assert_eq!(of_bands, [(Some(1.0), Some(0.02)), (Some(1.5), Some(0.02))]);
        let label = std::fs::read_to_string(path("cube.xml")).unwrap();
        let names: Vec<&str> = label.split("<axis_name>").skip(1).map(|rest| rest.split('<').next().unwrap()).collect();
        assert_eq!(names, axes, "slowest first");
        let single = if dtype == "f32" { "IEEE754LSBSingle" } else { "IEEE754LSBDouble" };
        assert!(label.contains(&format!("<data_type>{single}</data_type>")), "{label}");
        assert!(label.contains("<file_name>cube.img</file_name>") && label.contains("<elements>3</elements>"));
    }
}

/// In an archive no two products have one identifier.
#[test]
fn labels_of_two_scenes_have_two_identifiers() {
    let scratch = folder();
    let mut found = Vec::new();
    for (out, more) in [("one", "sensor.samples=2"), ("other", "sensor.samples=3"), ("same", "sensor.samples=2")] {
        simulate(&scratch, out, &["--format", "pds4", "--set", more]);
        let text = std::fs::read_to_string(scratch.join(out).join("cube.xml")).unwrap();
        let (_, rest) = text.split_once("<logical_identifier>").unwrap();
        found.push(rest.split_once('<').unwrap().0.to_owned());
    }
    assert!(found[0] != found[1] && found[0] == found[2] && found[0].starts_with("urn:nasa:pds:"), "{found:?}");
}

#[test]
fn a_label_may_name_bands_that_are_not_there() {
    let scratch = folder();
    simulate(&scratch, "out", &["--format", "pds4"]);
    let label = scratch.join("out/cube.xml");
    let text = std::fs::read_to_string(&label).unwrap();
    std::fs::write(&label, text.replace("<band_number>2</band_number>", "<band_number>3</band_number>")).unwrap();
    let raster = open(&label);
    assert_eq!((raster.bands[0].centre_um, raster.bands[1].centre_um), (Some(1.0), None));
    assert!(raster.report.notes.iter().any(|note| note.to_string().contains("of band 3: there are 2")));
    std::fs::write(&label, text.replace("unit=\"micrometer\">1.5<", "unit=\"nm\">1500<")).unwrap();
    assert_eq!(open(&label).bands[1].centre_um, Some(1.5));
    std::fs::write(&label, text.replace("unit=\"micrometer\">1.5<", "unit=\"nm\">many<")).unwrap();
    let error = registry::image(&label).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("cube.xml") && error.contains("many"), "{error}");
}

#[test]
fn bad_bands_stay_bad() {
    let scratch = Scratch::new();
    scratch.write("in.img", [1u8, 2, 3, 4].map(f32::from).map(f32::to_le_bytes).concat());
    let header = |bbl: &str, wavelength: &str| {
        format!(
            "ENVI\nsamples = 1\nlines = 1\nbands = 4\ndata type = 4\ninterleave = bsq\nbyte order = 0\n\
             wavelength units = Nanometers\nwavelength = {{{wavelength}}}\nbbl = {{{bbl}}}\n"
        )
    };
    scratch.write("in.hdr", header("1, 0, 1, 0", "900, 1000, 1100, 0"));
    let raster = open(&scratch.join("in.img"));
    assert_eq!(raster.bands.iter().map(|band| band.is_bad).collect::<Vec<_>>(), [false, true, false, true]);
    assert_eq!(
        raster.bands.iter().map(|band| band.centre_um).collect::<Vec<_>>(),
        [Some(0.9), Some(1.0), Some(1.1), None]
    );
    let converted = |to: &str, more: &[&str]| {
        let (from, to) = (scratch.argument("in.img"), scratch.argument(to));
        let (code, _, err) = run(&[&["convert", &from, &to, "--quiet"][..], more].concat());
        assert_eq!(code, 0, "{err}");
    };
    converted("all.img", &[]);
    let text = std::fs::read_to_string(scratch.join("all.hdr")).unwrap();
    assert!(text.contains("bbl = {\n 1, 0, 1, 0}") && text.contains("wavelength = {\n 0.9, 1, 1.1, 0}"), "{text}");
    // Of some bands those that were chosen.
    converted("some.img", &["--band", "2", "--band", "3"]);
    let some = open(&scratch.join("some.img"));
    assert_eq!(
        some.bands.iter().map(|band| (band.centre_um, band.is_bad)).collect::<Vec<_>>(),
        [(Some(1.0), true), (Some(1.1), false)]
    );
    // A good band has a wavelength, and a list is as long as there are bands.
    for (bbl, wavelength, says) in [
        ("1, 0, 1, 1", "900, 1000, 1100, 0", "that of band 4 is not positive"),
        ("1, 0, 1", "900, 1000, 1100, 1200", "is not a list of 4 numbers"),
    ] {
        scratch.write("in.hdr", header(bbl, wavelength));
        let error = registry::image(&scratch.join("in.img")).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn a_map_knows_its_wavelengths_and_its_body() {
    let scratch = folder();
    simulate(&scratch, "out", &[]);
    let (product, map) = (scratch.argument("out"), scratch.argument("map"));
    let mapped = |projection: &str| {
        let (code, _, err) = run(&["locate", &product, "--ortho", projection, "-o", &map, "--force", "--quiet"]);
        assert_eq!(code, 0, "{err}");
        (open(&scratch.join("map/ortho.img")), std::fs::read_to_string(scratch.join("map/ortho.hdr")).unwrap())
    };
    let (raster, text) = mapped("plate-carree:0.001");
    let of_bands: Vec<_> = raster.bands.iter().map(|band| (band.centre_um, band.is_bad)).collect();
    assert_eq!(of_bands, [(None, true), (Some(1.0), false), (Some(1.5), false)], "coverage is no part of the spectrum");
    assert!(text.contains("default bands = {2}"), "{text}");
    // The corners of the square are sqrt(11000^2 + 50) m from the centre.
    let radius_m = (11_000.0f64.powi(2) + 50.0).sqrt();
    assert!(text.contains(&format!("SPHEROID[\"sphere\",{radius_m:.3},0.0]")), "{text}");
    let (_, text) = mapped("tangent:1");
    assert!(text.contains("coordinate system string = {LOCAL_CS[") && text.contains("UNIT[\"Meter\",1.0]"), "{text}");
}

#[test]
fn an_instrument_writes_every_format() {
    let scratch = folder();
    simulate(&scratch, "out", &[]);
    scratch.write("camera.toml", format!("mmxrt_instrument = 1\n{}", DETECTOR.replace("[sensor.", "[")));
    let (cube, camera, out) =
        (scratch.argument("out/cube.img"), scratch.argument("camera.toml"), scratch.argument("dn"));
    let (code, _, err) = run(&[
        "instrument",
        &cube,
        "--instrument",
        &camera,
        "-o",
        &out,
        "--quiet",
        "--format",
        "netcdf,zarr,fits,exr,pds4",
    ]);
    assert_eq!(code, 0, "{err}");
    let mut names: Vec<String> = std::fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    for name in [
        "cube.nc",
        "cube.zarr",
        "cube.fits",
        "cube.exr",
        "cube.xml",
        "cube.img",
        "dn.nc",
        "dn.zarr",
        "dn.fits",
        "dn.xml",
        "dn.img",
    ] {
        assert!(names.iter().any(|of| of == name), "{name}: {names:?}");
    }
    for stem in ["cube", "dn"] {
        let truth = all_values(&mut open(&scratch.join(&format!("dn/{stem}.hdr"))));
        for ending in ["nc", "zarr", "fits", "xml"] {
            let path = scratch.join(&format!("dn/{stem}.{ending}"));
            assert!(same(&all_values(&mut open(&path)), &truth), "{}", path.display());
        }
    }
    // And takes every one.
    let truth = all_values(&mut open(&scratch.join("dn/dn.hdr")));
    for ending in ["nc", "zarr", "fits", "xml", "exr"] {
        let (cube, out) = (scratch.argument(&format!("dn/cube.{ending}")), scratch.argument(&format!("of_{ending}")));
        let (code, _, err) = run(&["instrument", &cube, "--instrument", &camera, "-o", &out, "--quiet"]);
        assert_eq!(code, 0, "{ending}: {err}");
        let of = |folder: &str| all_values(&mut open(&scratch.join(&format!("{folder}/cube.hdr"))));
        assert!(of(&format!("of_{ending}")) == of("of_nc"), "{ending}");
    }
    // In another unit it is the same, but for rounding.
    let (nm, out) = (scratch.argument("per_nm.img"), scratch.argument("per_nm"));
    let cube = std::fs::read(scratch.join("dn/cube.img")).unwrap();
    let values = cube.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()) / 1000.0);
    std::fs::write(&nm, values.flat_map(f32::to_le_bytes).collect::<Vec<u8>>()).unwrap();
    let header = std::fs::read_to_string(scratch.join("dn/cube.hdr")).unwrap();
    assert!(header.contains("W m-2 sr-1 um-1"), "{header}");
    scratch.write("per_nm.hdr", header.replace("W m-2 sr-1 um-1", "W.m^-2.sr^-1.nm^-1"));
    let (code, _, err) = run(&["instrument", &nm, "--instrument", &camera, "-o", &out, "--quiet"]);
    assert_eq!(code, 0, "{err}");
    let again = all_values(&mut open(&scratch.join("per_nm/dn.hdr")));
    let counts = |folder: &str| all_values(&mut open(&scratch.join(&format!("{folder}/dn.hdr"))));
    assert_eq!(again.len(), truth.len());
    for (a, b) in again.iter().zip(&counts("of_nc")) {
        assert!((a - b).abs() <= 1.0 || a.is_nan() && b.is_nan(), "{a} {b}");
    }
}
