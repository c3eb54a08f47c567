//! Rasters from one format to another: the same numbers, the bytes that other programs expect, and a word for what is lost.

use mmxrt::formats::registry;
use serde_json::Value;

use crate::cli::run;
use crate::scratch::Scratch;

/// Two rows, three columns, two bands of i16 with wavelengths; -9 is no data. Band by band.
const NUMBERS: [[i16; 6]; 2] = [[0, 1, 2, 10, 11, 12], [100, 101, -9, 110, 111, 112]];

fn source(folder: &Scratch) -> String {
    let header = "ENVI\nsamples = 3\nlines = 2\nbands = 2\ndata type = 2\ndata ignore value = -9\nwavelength units = Micrometers\n\
                  wavelength = {1.5, 0.9}\nfwhm = {0.1, 0.2}\nband names = {a, b}\ndata units = W m-2\nmap info = {none, 1, 1}\n";
    folder.write("in.hdr", header);
    folder.write("in.img", NUMBERS.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>());
    folder.argument("in.img")
}

fn converted(folder: &Scratch, from: &str, to: &str, more: &[&str]) -> String {
    let to = folder.argument(to);
    let (code, out, err) = run(&[&["convert", from, &to][..], more].concat());
    assert_eq!(code, 0, "{out}{err}");
    out
}

fn read(folder: &Scratch, name: &str) -> Vec<Vec<f64>> {
    let mut raster = registry::image(&folder.join(name)).unwrap();
    let mut all = vec![Vec::new(); raster.bands.len()];
    all.iter_mut().enumerate().for_each(|(band, values)| raster.read(band, values).unwrap());
    all
}

/// The same numbers, where NaN is NaN.
fn assert_same(found: &[Vec<f64>], expected: &[Vec<f64>]) {
    let shown = |all: &[Vec<f64>]| format!("{all:?}");
    assert_eq!(shown(found), shown(expected));
}

fn expected() -> Vec<Vec<f64>> {
    let value = |v: &i16| if *v == -9 { f64::NAN } else { f64::from(*v) };
    NUMBERS.iter().map(|band| band.iter().map(value).collect()).collect()
}

#[test]
fn envi_keeps_everything_in_another_order() {
    let folder = Scratch::new();
    let input = source(&folder);
    for name in ["pixels.bip", "lines.bil", "out.bsq"] {
        let out = converted(&folder, &input, name, &["--strict", "--force"]);
        assert!(!out.contains("Dropped"), "{out}");
        assert_same(&read(&folder, name), &expected());
    }
    let header = std::fs::read_to_string(folder.join("out.hdr")).unwrap();
    for line in ["data type = 2", "data ignore value = -9", "data units = W m-2", "map info = {none, 1, 1}"] {
        assert!(header.lines().any(|l| l == line), "{line:?} in\n{header}");
    }
    assert_eq!(std::fs::read(folder.join("out.bsq")).unwrap(), std::fs::read(&input).unwrap());
    // Pixel by pixel: the first has 0 and 100.
    assert_eq!(std::fs::read(folder.join("pixels.bip")).unwrap()[..6], [0, 0, 100, 0, 1, 0]);
    let (code, out, _) = run(&["convert", "--diff", &input, &folder.argument("out.bsq")]);
    assert_eq!((code, out.trim_end()), (0, "the same in meaning"));
}

#[test]
fn numpy_holds_the_numbers_and_the_rest_is_told() {
    let folder = Scratch::new();
    let input = source(&folder);
    let out = converted(&folder, &input, "out.npy", &[]);
    for part in [
        "wavelengths:",
        "widths of bands:",
        "names of bands:",
        "unit: W m-2",
        "not carried over: map info",
        "that -9 means no data",
    ] {
        assert!(out.contains(part), "{part:?} in {out}");
    }
    let bytes = std::fs::read(folder.join("out.npy")).unwrap();
    assert_eq!(bytes.len() % 64, 24);
    assert!(
        bytes.starts_with(b"\x93NUMPY\x01\x00\x76\x00{'descr': '<i2', 'fortran_order': False, 'shape': (2, 3, 2), }  ")
    );
    assert_eq!(bytes[128..136], [0, 0, 100, 0, 1, 0, 101, 0]);
    // As f32, what is no data can be said.
    let out = converted(&folder, &input, "f.npy", &["--dtype", "f32", "--band", "2"]);
    assert!(!out.contains("no data"), "{out}");
    assert_same(&read(&folder, "f.npy"), &expected()[1..]);
    let (code, out, _) = run(&["convert", &input, &folder.argument("g.npy"), "--strict"]);
    assert!(code == 3 && out.contains("not written"), "{out}");
    assert_eq!(folder.names(), ["f.npy", "in.hdr", "in.img", "out.npy"]);
}

#[test]
fn numbers_that_do_not_fit_are_counted() {
    let folder = Scratch::new();
    let path = folder.write("in.csv", "0.1,300,nan\n1,2,-1\n");
    let input = path.to_str().unwrap();
    let out = converted(&folder, input, "a.img", &["--dtype", "u8"]);
    // 0.1 becomes 0, 300 becomes 255, -1 becomes 0.
    assert!(out.contains("3 are not exact in u8: up to 4.500e1 off"), "{out}");
    assert!(out.contains("1 pixels without data are 0 in u8"), "{out}");
    assert_eq!(std::fs::read(folder.join("a.img")).unwrap(), [0, 255, 0, 1, 2, 0]);
    let out = converted(&folder, input, "a.exr", &[]);
    assert!(out.contains("1 are not exact in f32"), "{out}");
    assert_same(&read(&folder, "a.exr"), &[vec![f64::from(0.1_f32), 300.0, f64::NAN, 1.0, 2.0, -1.0]]);
    converted(&folder, input, "b.csv", &["--strict"]);
    assert_eq!(std::fs::read_to_string(folder.join("b.csv")).unwrap(), "0.1,300.0,nan\n1.0,2.0,-1.0\n");
}

#[test]
fn openexr_has_a_channel_for_each_wavelength() {
    let folder = Scratch::new();
    let input = source(&folder);
    converted(&folder, &input, "out.exr", &[]);
    // The reader of the crate `exr`, which did not write it; its channels are in the order of their names.
    let image = exr::prelude::read_first_flat_layer_from_file(folder.join("out.exr")).unwrap();
    let channels = &image.layer_data.channel_data.list;
    assert_eq!(
        channels.iter().map(|c| c.name.to_string()).collect::<Vec<_>>(),
        ["S0.0900,000000nm", "S0.1500,000000nm"]
    );
    let exr::prelude::FlatSamples::F32(second) = &channels[1].sample_data else { panic!("not f32") };
    assert_eq!(second[..], [0.0, 1.0, 2.0, 10.0, 11.0, 12.0]);
    let [first, second] = &expected()[..] else { panic!() };
    assert_same(&read(&folder, "out.exr"), &[second.clone(), first.clone()]);
    // Of the same wavelength twice there is no file.
    folder.write("in.hdr", std::fs::read_to_string(folder.join("in.hdr")).unwrap().replace("0.9}", "1.5}"));
    let (code, _, err) = run(&["convert", &input, &folder.argument("twice.exr")]);
    assert!(code == 1 && err.contains("two bands have the wavelength of S0.1500,000000nm"), "{err}");
    assert_eq!(folder.names(), ["in.hdr", "in.img", "out.exr"]);
}

const MPR: &str = "[Ilwis]\nDescription=Raster Map m\nTime=0\nType=BaseMap\n\n[BaseMap]\nCoordSystem=unknown.csy\n\
CoordBounds=0 -3 2 0\nDomain=value.dom\nDomainInfo=value.dom;Long;value;0;-9999999.9:9999999.9:0.1:offset=0;\n\
Range=-1e+300:1e+300:0.000000:offset=0\nType=Map\nMinMax=-1:12.3457\n\n[Map]\nGeoRef=m.grf\nSize=2 3\nType=MapStore\n\n\
[MapStore]\nData=m.mp#\nType=Real\nStructure=Line\nStartOffset=0\nRowLength=3\n";

#[test]
fn an_ilwis_map_is_written_as_dart_writes_it() {
    let folder = Scratch::new();
    let path = folder.write("in.csv", "-1,0.5,12.3456789\n1,2,3\n");
    let out = converted(&folder, path.to_str().unwrap(), "m.mpr", &[]);
    assert!(out.contains("Defaulted") && out.contains("pixels: 1 m"), "{out}");
    assert_eq!(folder.names(), ["in.csv", "m.gr#", "m.grf", "m.mp#", "m.mpr"]);
    assert_eq!(std::fs::read_to_string(folder.join("m.mpr")).unwrap(), MPR);
    let numbers: Vec<u8> = [-1.0_f64, 0.5, 12.3456789, 1.0, 2.0, 3.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    assert_eq!(std::fs::read(folder.join("m.mp#")).unwrap(), numbers);
    let georeference = std::fs::read_to_string(folder.join("m.grf")).unwrap();
    for part in
        ["Range=-2:4:offset=0", "Range=-3:6:offset=0", "MinMax=1:3", "lines=2\ncolumns=3", "Reference Map=m.mpr\n"]
    {
        assert!(georeference.contains(part), "{part}");
    }
    // 128 bytes, and four corners of 28: x, y, row, column, 2.
    let table = std::fs::read(folder.join("m.gr#")).unwrap();
    assert!(table.len() == 240 && table.starts_with(b"ILWIS 2.00 Table\r\n\x1a\0"));
    let last = [&2_f64.to_le_bytes()[..], &3_f64.to_le_bytes(), &[2, 0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0]].concat();
    assert_eq!(table[212..], last);

    // Corners and bounds of a map from elsewhere come back as they were, byte by byte.
    let mut table = table;
    table[128..136].copy_from_slice(&(-0.1_f64).to_le_bytes());
    folder.write("m.gr#", &table);
    folder.write("m.mpr", MPR.replace("0 -3 2 0", "0 -1.5 1 0"));
    std::fs::create_dir(folder.join("again")).unwrap();
    converted(&folder, &folder.argument("m.mp#"), "again/m.mpr", &["--strict"]);
    for name in ["m.mpr", "m.mp#", "m.grf", "m.gr#"] {
        assert_eq!(
            std::fs::read(folder.join(name)).unwrap(),
            std::fs::read(folder.join("again").join(name)).unwrap(),
            "{name}"
        );
    }
    let out = converted(&folder, &folder.argument("m.mpr"), "m.img", &[]);
    assert!(out.contains("georeference"), "{out}");

    let (code, _, err) = run(&["convert", &source(&folder), &folder.argument("n.mpr")]);
    assert!(code == 1 && err.contains("2 bands where such a file holds one") && err.contains("--band 1"), "{err}");
    folder.write("m.gr#", b"ILWIS 2.00 Table");
    let (code, _, err) = run(&["convert", &folder.argument("m.mpr"), &folder.argument("n.img")]);
    assert!(code == 1 && err.contains("m.gr#: not a table of control points"), "{err}");
}

#[test]
fn what_cannot_be_converted_is_refused_and_leaves_nothing() {
    let folder = Scratch::new();
    let input = source(&folder);
    for (output, more, message) in [
        ("out.npy", &["--band", "3"][..], "band 3 is asked for: it has 2"),
        ("out.png", &[], "is a format that is read only"),
        ("out.npz", &[], "is a format that is read only"),
        ("out.hdr", &["--to", "envi"], "name the file of numbers"),
        ("out.obj", &[], "an image as obj: it has neither mesh nor spectra"),
        ("in.hdr", &["--to", "npy"], "exists"),
    ] {
        let (code, _, err) = run(&[&["convert", &input, &folder.argument(output)][..], more].concat());
        assert!(code == 1 && err.contains(message), "{output}: {err}");
    }
    // Cut short while it is converted: nothing is left.
    folder.write("in.img", [0; 23]);
    let (code, _, err) = run(&["convert", &input, &folder.argument("out.npy")]);
    assert!(code == 1 && err.contains("in.img: has 23 bytes"), "{err}");
    assert_eq!(folder.names(), ["in.hdr", "in.img"]);
}

#[test]
fn an_image_is_inspected_and_pictured() {
    let folder = Scratch::new();
    let input = source(&folder);
    let picture = folder.argument("out.png");
    let (code, out, err) = run(&["inspect", &input, "--json", "--picture", &picture]);
    assert_eq!(code, 0, "{err}");
    let facts: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&facts["samples"], &facts["lines"], &facts["bands"]), (&3.into(), &2.into(), &2.into()));
    assert_eq!((&facts["data_type"], &facts["no_data_value"]), (&"i16".into(), &(-9.0).into()));
    let second = &facts["statistics"][1];
    assert_eq!((&second["band"], &second["centre_um"], &second["no_data"]), (&"b".into(), &0.9.into(), &1.into()));
    // (100 + 101 + 110 + 111 + 112) / 5.
    assert_eq!((&second["min"], &second["max"], &second["mean"]), (&100.0.into(), &112.0.into(), &106.8.into()));
    // The second of two bands, grey: no data is black as 100 is, 112 is white.
    // It is enlarged by the largest whole number that leaves 3 pixels within 512.
    let grey = read(&folder, "out.png").remove(0);
    let of = |sample: usize, line: usize| [0, 169].map(|k| grey[(170 * line + k) * 510 + 170 * sample + k]);
    assert_eq!(grey.len(), 510 * 340);
    assert_eq!([of(0, 0), of(2, 0), of(2, 1)], [[0.0; 2], [0.0; 2], [1.0; 2]]);
    // Planes with names of their own are no colours: the first is drawn.
    let planes = "ENVI\nsamples = 2\nlines = 1\nbands = 3\ndata type = 1\ninterleave = bsq\nbyte order = 0\nband names = {SNR_MEAN, SNR_LOWEST, BANDS}\n";
    folder.write("planes.hdr", planes);
    let image = folder.write("planes.img", [1, 9, 8, 2, 5, 5]).display().to_string();
    let drawn = folder.argument("planes.png");
    assert_eq!(run(&["inspect", &image, "--picture", &drawn]).0, 0);
    let bands = read(&folder, "planes.png");
    assert_eq!((bands.len(), bands[0][0], bands[0][511]), (1, 0.0, 1.0));
    folder.write("planes.hdr", planes.replace("SNR_MEAN, SNR_LOWEST, BANDS", "Band 1, Band 2, Band 3"));
    assert_eq!(run(&["inspect", &image, "--picture", &drawn, "--force"]).0, 0);
    assert_eq!(read(&folder, "planes.png").len(), 3);
    let (code, _, err) = run(&["inspect", &input, "--picture", &picture]);
    assert!(code == 1 && err.contains("exists"), "{err}");
    let colours = ["--band", "1", "--band", "2", "--band", "1", "--force"];
    let (code, _, err) = run(&[&["inspect", &input, "--picture", &picture][..], &colours].concat());
    assert_eq!(code, 0, "{err}");
    assert_eq!(read(&folder, "out.png").len(), 3);
    let (code, _, err) = run(&["inspect", &input, "--picture", &picture, "--force", "--band", "9"]);
    assert!(code == 1 && err.contains("band 9 is asked for: it has 2"), "{err}");
}
