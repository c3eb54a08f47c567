//! Rasters: files written byte by byte are read as what they hold, and what is wrong with a file is told at its place.

use std::io::Write;
use std::path::Path;

use mmxrt::Error;
use mmxrt::formats::raster::Raster;
use mmxrt::formats::registry;

use crate::scratch::Scratch;

/// Every band.
fn bands(raster: &mut Raster) -> Vec<Vec<f64>> {
    let count = raster.bands.len();
    let read = |band| {
        let mut values = vec![99.0; 7];
        raster.read(band, &mut values).unwrap();
        values
    };
    (0..count).map(read).collect()
}

fn refused(path: &Path) -> String {
    registry::image(path).map(|_| ()).unwrap_err().to_string()
}

/// 2 rows, 3 columns, 2 bands: the value is 100 band + 10 row + column.
const VALUES: [[u8; 6]; 2] = [[0, 1, 2, 10, 11, 12], [100, 101, 102, 110, 111, 112]];
const BSQ: [u8; 12] = [0, 1, 2, 10, 11, 12, 100, 101, 102, 110, 111, 112];
const BIL: [u8; 12] = [0, 1, 2, 100, 101, 102, 10, 11, 12, 110, 111, 112];
const BIP: [u8; 12] = [0, 100, 1, 101, 2, 102, 10, 110, 11, 111, 12, 112];

fn values() -> Vec<Vec<f64>> {
    VALUES.iter().map(|band| band.iter().map(|v| f64::from(*v)).collect()).collect()
}

fn header(more: &str) -> String {
    format!("ENVI\nsamples = 3\nlines = 2\nbands = 2\n{more}")
}

#[test]
fn envi_is_read_in_every_order_type_and_byte_order() {
    let folder = Scratch::new();
    type Bytes = fn(u8) -> Vec<u8>;
    let types: [(u8, u8, Bytes); 17] = [
        (1, 0, |v| vec![v]),
        (2, 0, |v| i16::from(v).to_le_bytes().to_vec()),
        (2, 1, |v| i16::from(v).to_be_bytes().to_vec()),
        (3, 0, |v| i32::from(v).to_le_bytes().to_vec()),
        (3, 1, |v| i32::from(v).to_be_bytes().to_vec()),
        (4, 0, |v| f32::from(v).to_le_bytes().to_vec()),
        (4, 1, |v| f32::from(v).to_be_bytes().to_vec()),
        (5, 0, |v| f64::from(v).to_le_bytes().to_vec()),
        (5, 1, |v| f64::from(v).to_be_bytes().to_vec()),
        (12, 0, |v| u16::from(v).to_le_bytes().to_vec()),
        (12, 1, |v| u16::from(v).to_be_bytes().to_vec()),
        (13, 0, |v| u32::from(v).to_le_bytes().to_vec()),
        (13, 1, |v| u32::from(v).to_be_bytes().to_vec()),
        (14, 0, |v| i64::from(v).to_le_bytes().to_vec()),
        (14, 1, |v| i64::from(v).to_be_bytes().to_vec()),
        (15, 0, |v| u64::from(v).to_le_bytes().to_vec()),
        (15, 1, |v| u64::from(v).to_be_bytes().to_vec()),
    ];
    for (code, order, bytes) in types {
        for (interleave, file) in [("bsq", BSQ), ("bil", BIL), ("BIP", BIP)] {
            folder.write(
                "a.hdr",
                header(&format!(
                    "data type = {code}\nbyte order = {order}\ninterleave = {interleave}\nheader offset = 3\n"
                )),
            );
            let numbers: Vec<u8> = [1, 2, 3].into_iter().chain(file.into_iter().flat_map(bytes)).collect();
            let path = folder.write("a.img", numbers);
            let mut raster = registry::image(&path).unwrap();
            assert_eq!((raster.rows, raster.columns, raster.bands.len()), (2, 3, 2));
            assert_eq!(bands(&mut raster), values(), "type {code}, byte order {order}, {interleave}");
        }
    }
    // By its header; and bands in any order, twice.
    let mut raster = registry::image(&folder.join("a.hdr")).unwrap();
    let mut one = Vec::new();
    for band in [1, 1, 0] {
        raster.read(band, &mut one).unwrap();
        assert_eq!(one, values()[band]);
    }
    let error = raster.read(2, &mut one).unwrap_err().to_string();
    assert!(error.contains("band 3 is asked for") && one.is_empty(), "{error}");
    let inputs = raster.inputs().unwrap();
    assert_eq!(inputs.iter().map(|i| i.bytes).collect::<Vec<_>>(), [102, 99]);
}

#[test]
fn what_an_envi_header_says_of_bands_and_numbers_is_taken() {
    let folder = Scratch::new();
    let more = "data type = 2\ninterleave = bip\ndata ignore value = 11\nwavelength units = Nanometers\n\
                wavelength = {950, 1000.5}\nfwhm = {10, 0}\nband names = {one, two}\ndata units = W/m2\n\
                data gain values = {2, 1}\ndata offset values = {0.5, 0}\nreflectance scale factor = 10\n";
    folder.write("a.hdr", header(more));
    let path = folder.write("a", BIP.map(|v| i16::from(v).to_le_bytes()).concat());
    let mut raster = registry::image(&path).unwrap();
    assert_eq!((raster.unit.as_deref(), raster.ignore), (Some("W/m2"), Some(11.0)));
    assert_eq!((raster.bands[0].name.as_str(), raster.bands[1].name.as_str()), ("one", "two"));
    assert_eq!((raster.bands[0].centre_um, raster.bands[0].fwhm_um), (Some(0.95), Some(0.01)));
    assert_eq!((raster.bands[1].centre_um, raster.bands[1].fwhm_um), (Some(1.0005), None));
    let all = bands(&mut raster);
    // (2 x + 0.5) / 10, and x / 10.
    assert_eq!((all[0][0], all[0][3], all[1][5]), (0.05, 2.05, 11.2));
    assert!(all[0][4].is_nan() && all.iter().flatten().filter(|v| v.is_nan()).count() == 1);

    // A decimal that f32 rounds is still the number that stands for nothing.
    folder.write(
        "b.hdr",
        "ENVI\nsamples = 2\nlines = 1\nbands = 1\ndata type = 4\ndata ignore value = -0.1\nwavelength = {0.9}\n",
    );
    let path = folder.write("b.img", [(-0.1_f32).to_le_bytes(), 1_f32.to_le_bytes()].concat());
    let mut raster = registry::image(&path).unwrap();
    assert!(bands(&mut raster)[0][0].is_nan());
    assert_eq!(raster.bands[0].centre_um, Some(0.9));
    assert!(raster.report.notes[0].to_string().contains("wavelength units: not given: taken as micrometres"));
}

#[test]
fn an_envi_image_that_cannot_be_is_refused_at_its_place() {
    let folder = Scratch::new();
    let path = folder.write("a.img", BSQ);
    assert!(refused(&path).contains("a.img: its header is not beside it"));
    for (more, message) in [
        ("data type = 2\n", "a.img: has 12 bytes where 0 + 2 rows x 3 columns x 2 bands x 2 bytes belong"),
        ("data type = 1\nheader offset = 1\n", "it is cut short, or the header is another file's"),
        ("data type = 6\n", "a.hdr:5 data type: ENVI data type 6 (complex numbers) is not supported"),
        ("data type = 1\nwavelength = {1, nan}\n", "a.hdr:6 wavelength: has items that are not finite numbers"),
        ("data type = 1\nwavelength = {1}\n", "a.hdr:6 wavelength: 1 values for 2 bands"),
        ("data type = 1\nwavelength = {1, 0}\n", "wavelength: that of band 2 is not positive"),
        ("data type = 1\ndata ignore value = none\n", "a.hdr:6 data ignore value: \"none\" is not a number"),
        ("data type = 1\ndata gain values = {1, inf}\n", "data gain values: is not a list of 2 finite numbers"),
        ("data type = 1\nreflectance scale factor = 0\n", "reflectance scale factor: is not a positive number"),
        ("data type = 1\nfile compression = 1\n", "a compressed ENVI image is not supported"),
        ("data type = 1\nfile type = ENVI Spectral Library\n", "a spectral library as an image"),
        ("data type = 1\ninterleave = tile\n", "a.hdr:6 interleave: \"tile\" is not one of bsq, bil, bip"),
    ] {
        folder.write("a.hdr", header(more));
        let error = refused(&path);
        assert!(error.contains(message), "{more}: {error}");
    }
    folder.write("a.hdr", "ENVI\nsamples = 4294967296\nlines = 4294967296\nbands = 4294967296\ndata type = 1\n");
    assert!(refused(&path).contains("more than a file can hold"));
    folder.write("a.hdr", "ENVI\nsamples = 18446744073709551615\nlines = 1\nbands = 1\ndata type = 1\n");
    assert!(refused(&path).contains("a.hdr: 1 rows x 18446744073709551615 columns are more than"));
}

#[cfg(unix)]
#[test]
fn a_size_that_no_memory_holds_is_refused_even_if_the_file_has_it() {
    let folder = Scratch::new();
    let path = folder.join("a.img");
    // A sparse file takes no room.
    std::fs::File::create(&path).unwrap().set_len(1 << 40).unwrap();
    folder.write("a.hdr", "ENVI\nsamples = 1048576\nlines = 1048576\nbands = 1\ndata type = 1\n");
    assert!(refused(&path).contains("more than the 268435456 pixels"), "{}", refused(&path));
    folder.write(
        "a.hdr",
        "ENVI\nsamples = 1\nlines = 1\nbands = 1099511627776\ndata type = 1\nreflectance scale factor = 2\n",
    );
    assert!(refused(&path).contains("bands are more than the 65536"), "{}", refused(&path));
}

fn mpr(type_: &str, more: &str) -> String {
    format!(
        "[Ilwis]\nType=BaseMap\n[BaseMap]\nDomain=value.dom\n{more}[Map]\nSize=2 3\n[MapStore]\nType={type_}\nRowLength=3\n"
    )
}

#[test]
fn ilwis_is_read_in_every_type_and_its_undefined_is_no_data() {
    let folder = Scratch::new();
    let path = folder.write("m.mpr", mpr("Real", "Range=-1e+300:1e+300:0.000000:offset=0\nMinMax=7:8\n"));
    // As they stand but for ILWIS' undefined; DART's -1 is a value.
    let reals = [-1.0, 0.5, -1e308, 1.25, f64::NAN, 3.0];
    folder.write("m.mp#", reals.map(f64::to_le_bytes).concat());
    let mut raster = registry::image(&path).unwrap();
    assert_eq!((raster.rows, raster.columns, raster.bands.len()), (2, 3, 1));
    let read = bands(&mut raster).remove(0);
    assert_eq!((&read[..2], read[3], read[5]), (&[-1.0, 0.5][..], 1.25, 3.0));
    assert!(read[2].is_nan() && read[4].is_nan());

    for (type_, more, bytes) in [
        // Floats, little-endian: 1.5, -1e38 and four zeros.
        ("Float", "", [&[0, 0, 0xc0, 0x3f, 0x99, 0x76, 0x96, 0xfe][..], &[0; 16]].concat()),
        // Bytes are (number - 1) 0.5: 4, undefined and four ones.
        ("Byte", "Range=0:3:0.5:offset=-1\n", vec![4, 0, 1, 1, 1, 1]),
        ("Int", "Range=0:3:0.5:offset=0\n", [&[3, 0, 0x01, 0x80][..], &[0; 8]].concat()),
        ("Long", "Range=0:3:0.5:offset=0\n", [&[3, 0, 0, 0, 0x01, 0, 0, 0x80][..], &[0; 16]].concat()),
    ] {
        folder.write("m.mpr", mpr(type_, more));
        let path = folder.write("m.mp#", bytes);
        let read = bands(&mut registry::image(&path).unwrap()).remove(0);
        assert!(read[0] == 1.5 && read[1].is_nan() && read[2..] == [0.0; 4], "{type_}: {read:?}");
    }
}

#[test]
fn an_ilwis_map_that_cannot_be_is_refused_at_its_place() {
    let folder = Scratch::new();
    let values = folder.write("m.mp#", [0; 48]);
    assert!(refused(&values).contains("m.mp#: has no header beside it"));
    let path = folder.write("m.mpr", mpr("Long", ""));
    assert!(refused(&path).contains("m.mp#: has 48 bytes where 0 + 2 rows x 3 columns x 1 bands x 4 bytes belong"));
    folder.write("m.mpr", mpr("Real", "Range=a\n"));
    assert!(refused(&path).contains("m.mpr:5:1 Range: `a` where least:largest:step:offset=number belongs"));
    folder.write("m.mpr", mpr("Byte", "").replace("value.dom", "landuse.dom"));
    assert!(refused(&path).contains("a map of the domain landuse.dom"), "{}", refused(&path));
    std::fs::remove_file(values).unwrap();
    assert!(refused(&path).contains("m.mpr: has no values beside it"));
}

/// A `.npy` file, version 1.0, by NumPy's NEP 1.
pub(crate) fn npy(descr: &str, fortran: bool, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let length = (text.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes(), bytes].concat()
}

#[test]
fn numpy_arrays_are_read_in_both_orders_and_byte_orders() {
    let folder = Scratch::new();
    let fortran = [0, 10, 1, 11, 2, 12, 100, 110, 101, 111, 102, 112];
    for (descr, bytes) in [
        ("|u1", (|v| vec![v]) as fn(u8) -> Vec<u8>),
        ("<i2", |v| i16::from(v).to_le_bytes().to_vec()),
        (">u4", |v| u32::from(v).to_be_bytes().to_vec()),
        (">f4", |v| f32::from(v).to_be_bytes().to_vec()),
        ("<f8", |v| f64::from(v).to_le_bytes().to_vec()),
    ] {
        for (is_fortran, file) in [(false, BIP), (true, fortran)] {
            let numbers: Vec<u8> = file.into_iter().flat_map(bytes).collect();
            let path = folder.write("a.npy", npy(descr, is_fortran, "(2, 3, 2)", &numbers));
            let mut raster = registry::image(&path).unwrap();
            assert_eq!((raster.rows, raster.columns, raster.bands.len()), (2, 3, 2));
            assert_eq!(bands(&mut raster), values(), "{descr}, Fortran order {is_fortran}");
        }
    }
    let flat = folder.write("b.npy", npy("|i1", true, "(2, 3)", &[0, 3, 1, 4, 2, 255]));
    assert_eq!(bands(&mut registry::image(&flat).unwrap()), [[0.0, 1.0, 2.0, 3.0, 4.0, -1.0]]);
    let list = folder.write("c.npy", npy("|u1", false, "(3,)", &[1, 2, 3]));
    let mut list = registry::image(&list).unwrap();
    assert_eq!((list.rows, list.columns), (1, 3));
    assert_eq!(bands(&mut list), [[1.0, 2.0, 3.0]]);
}

#[test]
fn an_array_that_cannot_be_is_refused() {
    let folder = Scratch::new();
    for (bytes, message) in [
        (npy("<f8", false, "(2, 3)", &[0; 47]), "x 8 bytes belong"),
        (
            npy("<f8", false, "(4294967296, 4294967296, 8)", &[0; 8]),
            "a.npy: 4294967296 rows x 4294967296 columns are more than",
        ),
        (npy("<c8", false, "(1, 1)", &[0; 8]), "an array of type \"<c8\" (save it as f4"),
        (npy("|O", false, "(1, 1)", &[0; 8]), "an array of type \"|O\""),
        (npy("<f8", false, "(1, 1, 1, 1)", &[0; 8]), "has 4 axes (help: save [row, column]"),
        (npy("<f8", false, "()", &[0; 8]), "has 0 axes"),
        (npy("<f8", false, "(0, 4)", &[]), "0 rows x 4 columns x 1 bands hold no pixels"),
        (npy("<f8", false, "(-1, 4)", &[]), "is not understood"),
        (b"\x93NUMPY\x01\x00\xff".to_vec(), "a.npy: is cut short"),
        (b"NUMPY".to_vec(), "a.npy: begins with \"NUMPY\", as no whole .npy file does"),
        (vec![], "a.npy: is empty"),
    ] {
        let path = folder.write("a.npy", bytes);
        let error = refused(&path);
        assert!(error.contains(message), "{message}: {error}");
    }
    assert!(matches!(registry::image(&folder.join("none.npy")), Err(Error::Io { .. })));
}

/// A zip file with one stored member for each array.
fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, bytes) in arrays {
        zip.start_file(format!("{name}.npy"), options).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    npy(
        "<f8",
        false,
        &format!("({},)", values.len()),
        &values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>(),
    )
}

#[test]
fn an_array_of_a_npz_file_is_read_with_its_wavelengths() {
    let folder = Scratch::new();
    let array = || npy("|u1", false, "(2, 3, 2)", &BIP);
    let unit = npy("<U2", false, "()", &[b'K', 0, 0, 0, 0, 0, 0, 0]);
    let path =
        folder.write("a.npz", npz(&[("arr_0", array()), ("wavelength_um", doubles(&[0.9, 1.5])), ("unit", unit)]));
    let mut raster = registry::image(&path).unwrap();
    assert_eq!(bands(&mut raster), values());
    assert_eq!((raster.bands[1].centre_um, raster.unit.as_deref()), (Some(1.5), Some("K")));

    let path = folder.write("a.npz", npz(&[("raster", array()), ("mask", doubles(&[1.0]))]));
    let mut raster = registry::image(&path).unwrap();
    assert_eq!(bands(&mut raster), values());
    assert!(raster.report.notes[0].to_string().contains("mask: an array beside the raster"));
    for (arrays, message) in [
        (vec![("a", array()), ("b", array())], "a.npz: which of its arrays is the raster? [a, b] (help: save one"),
        (vec![], "a.npz: has no array of values"),
        (vec![("a", array()), ("wavelength_um", doubles(&[1.0]))], "wavelength_um: is not a list of 2 numbers"),
        (vec![("a", array()), ("wavelength_um", doubles(&[1.0, f64::NAN]))], "wavelength_um[1]: NaN is not positive"),
        (vec![("a", array()), ("fwhm_um", doubles(&[1.0, -0.5]))], "fwhm_um[1]: -0.5 is not positive"),
        (vec![("a", npy("|u1", false, "(2, 3, 2)", &BIP[1..]))], "a.npz: has"),
        (vec![("a", b"text".to_vec())], "a.npz a: is not a NumPy array"),
    ] {
        let path = folder.write("a.npz", npz(&arrays));
        let error = refused(&path);
        assert!(error.contains(message), "{message}: {error}");
    }
    let whole = npz(&[("a", array())]);
    let path = folder.write("a.npz", &whole[..whole.len() - 30]);
    assert!(refused(&path).contains("not a complete .npz file"));
}

/// An OpenEXR file of uncompressed scan lines, by the file layout of OpenEXR 2: channels are (name, type, sampling).
pub(crate) fn exr(channels: &[(&str, i32, i32)], size: [i32; 2], lines: &[Vec<u8>], unit: Option<&str>) -> Vec<u8> {
    let [columns, rows] = size;
    let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        bytes.extend(
            [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &(value.len() as i32).to_le_bytes(), value].concat(),
        );
    };
    let mut list = Vec::new();
    for (name, kind, sampling) in channels {
        list.extend(
            [name.as_bytes(), b"\0", &kind.to_le_bytes(), &[0; 4], &sampling.to_le_bytes(), &sampling.to_le_bytes()]
                .concat(),
        );
    }
    list.push(0);
    let window: Vec<u8> = [0, 0, columns - 1, rows - 1].iter().flat_map(|v: &i32| v.to_le_bytes()).collect();
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    if let Some(unit) = unit {
        attribute("radianceUnits", "string", unit.as_bytes());
    }
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    bytes.push(0);
    let mut place = bytes.len() + 8 * lines.len();
    for line in lines {
        bytes.extend((place as u64).to_le_bytes());
        place += 8 + line.len();
    }
    for (y, line) in lines.iter().enumerate() {
        bytes.extend([&(y as i32).to_le_bytes(), &(line.len() as i32).to_le_bytes(), &line[..]].concat());
    }
    bytes
}

#[test]
fn openexr_is_read_in_every_type_and_in_the_order_of_wavelength() {
    let folder = Scratch::new();
    // A line: two halves (1.5, -2), two floats, two integers.
    let line = |f: f32, u: u32| {
        [
            &[0x00, 0x3e, 0x00, 0xc0][..],
            &f.to_le_bytes(),
            &0.5_f32.to_le_bytes(),
            &u.to_le_bytes(),
            &7_u32.to_le_bytes(),
        ]
        .concat()
    };
    let lines = [line(0.25, 3), line(f32::NAN, u32::MAX)];
    // By text 1000 nm comes before 900,5 nm.
    let channels = [("S0.1000nm", 1, 1), ("S0.900,5nm", 2, 1), ("T.3um", 0, 1)];
    let path = folder.write("a.exr", exr(&channels[..2], [2, 1], &[line(0.25, 0)[..12].to_vec()], Some("K")));
    let mut raster = registry::image(&path).unwrap();
    assert_eq!((raster.rows, raster.columns, raster.unit.as_deref()), (1, 2, Some("K")));
    assert_eq!([raster.bands[0].centre_um, raster.bands[1].centre_um], [Some(0.9005), Some(1.0)]);
    assert_eq!(bands(&mut raster), [[0.25, 0.5], [1.5, -2.0]]);

    let channels = [("D", 1, 1), ("E", 2, 1), ("F", 0, 1)];
    let path = folder.write("b.exr", exr(&channels, [2, 2], &lines, None));
    let mut raster = registry::image(&path).unwrap();
    assert!(raster.bands.iter().all(|b| b.centre_um.is_none()));
    let all = bands(&mut raster);
    assert_eq!((&all[0][..], &all[2][..]), (&[1.5, -2.0, 1.5, -2.0][..], &[3.0, 7.0, 4294967295.0, 7.0][..]));
    assert!(all[1][2].is_nan() && all[1][3] == 0.5);
}

#[test]
fn an_openexr_file_that_cannot_be_is_refused() {
    let folder = Scratch::new();
    let line = vec![0; 16];
    let two = [("A", 2, 1), ("B", 2, 1)];
    let whole = exr(&two, [2, 2], &[line.clone(), line.clone()], None);
    let mut one = Vec::new();
    for length in 0..whole.len() {
        let path = folder.write("a.exr", &whole[..length]);
        // Refused when it is opened, or when it is read: nowhere else, and never without a word.
        let error = registry::image(&path).and_then(|mut raster| raster.read(0, &mut one)).unwrap_err().to_string();
        assert!(
            error.contains("a.exr: not a complete OpenEXR file")
                || error.contains("cut short")
                || error.contains("is empty"),
            "{length}: {error}"
        );
    }
    for (bytes, message) in [
        (
            exr(&[("A", 2, 1), ("A", 2, 1)], [2, 1], std::slice::from_ref(&line), None),
            "A: a channel of this name appears twice",
        ),
        (exr(&[("A", 2, 2)], [2, 2], &[vec![0; 4]], None), "does not have every pixel"),
        (exr(&[], [2, 1], &[vec![]], None), "a.exr"),
        (exr(&two, [1 << 20, 1 << 20], std::slice::from_ref(&line), None), "are more than the 268435456 pixels"),
        (exr(&two, [1 << 10, 1 << 17], std::slice::from_ref(&line), None), "131072 blocks are promised"),
    ] {
        let path = folder.write("a.exr", bytes);
        let error = refused(&path);
        assert!(error.contains(message), "{message}: {error}");
    }
    // The first line twice, the second never.
    let mut twice = whole.clone();
    let (from, to) = (whole.len() - 48, whole.len() - 24);
    twice.copy_within(from..to, to);
    let path = folder.write("a.exr", twice);
    let error = registry::image(&path).unwrap().read(0, &mut one).unwrap_err().to_string();
    assert!(error.contains("a.exr: lines are missing"), "{error}");
}

/// Two pixels of 16 bits, red, green, blue and alpha: (65535, 13107, 0, 65535), (1, 2, 3, 0). Made with Python's zlib.
const RGBA16: [u8; 85] = [
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00,
    0x02, 0x00, 0x00, 0x00, 0x01, 0x10, 0x06, 0x00, 0x00, 0x00, 0xa4, 0xb2, 0xa3, 0xc9, 0x00, 0x00, 0x00, 0x1c, 0x49,
    0x44, 0x41, 0x54, 0x78, 0x01, 0x01, 0x11, 0x00, 0xee, 0xff, 0x00, 0xff, 0xff, 0x33, 0x33, 0x00, 0x00, 0xff, 0xff,
    0x00, 0x01, 0x00, 0x02, 0x00, 0x03, 0x00, 0x00, 0x37, 0x5a, 0x04, 0x69, 0x63, 0xf0, 0x50, 0x7d, 0x00, 0x00, 0x00,
    0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
];
/// Four grey pixels of 2 bits: 2, 3, 0, 0. Made likewise.
const GREY2: [u8; 70] = [
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00,
    0x04, 0x00, 0x00, 0x00, 0x01, 0x02, 0x00, 0x00, 0x00, 0x00, 0x96, 0xe7, 0x48, 0xb0, 0x00, 0x00, 0x00, 0x0d, 0x49,
    0x44, 0x41, 0x54, 0x78, 0x01, 0x01, 0x02, 0x00, 0xfd, 0xff, 0x00, 0xb0, 0x00, 0xb2, 0x00, 0xb1, 0x60, 0xfd, 0x48,
    0x5a, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
];

#[test]
fn pictures_are_shares_of_the_largest_number_and_nothing_where_transparent() {
    let folder = Scratch::new();
    let path = folder.write("a.png", RGBA16);
    let mut raster = registry::image(&path).unwrap();
    assert_eq!(raster.bands.iter().map(|b| b.name.as_str()).collect::<Vec<_>>(), ["red", "green", "blue"]);
    let all = bands(&mut raster);
    assert_eq!([all[0][0], all[1][0], all[2][0]], [1.0, 0.2, 0.0]);
    assert!(all.iter().all(|band| band[1].is_nan()));
    assert_eq!(raster.coverage().unwrap(), Some(&[1.0, 0.0][..]));
    raster.take_image(Some(&["blue".into(), "Green".into()])).unwrap();
    assert_eq!(bands(&mut raster).iter().map(|band| band[0]).collect::<Vec<_>>(), [0.0, 0.2]);
    let path = folder.write("b.png", GREY2);
    assert_eq!(bands(&mut registry::image(&path).unwrap()), [[2.0 / 3.0, 1.0, 0.0, 0.0]]);
    let mut one = Vec::new();
    for length in 0..GREY2.len() - 16 {
        let path = folder.write("b.png", &GREY2[..length]);
        let error = registry::image(&path).and_then(|mut raster| raster.read(0, &mut one)).unwrap_err().to_string();
        let told = if length == 0 { "b.png: is empty" } else { "b.png: not a complete PNG" };
        assert!(error.contains(told), "{length}: {error}");
    }
}

#[test]
fn text_is_read_with_any_separator_and_told_where_it_is_none() {
    let folder = Scratch::new();
    for text in [
        "1,2.5e1,nan\n-3,4,\n",
        "\u{feff}# a\n1;25;nan\r\n\r\n-3;4;NaN\r\n",
        "1\t25\tNaN\n-3\t4\t\n",
        " 1  25 nan\n-3 4 nan",
    ] {
        let path = folder.write("a.csv", text);
        let mut raster = registry::image(&path).unwrap();
        assert_eq!((raster.rows, raster.columns), (2, 3), "{text:?}");
        let read = bands(&mut raster).remove(0);
        assert_eq!((&read[..2], &read[3..5]), (&[1.0, 25.0][..], &[-3.0, 4.0][..]), "{text:?}");
        assert!(read[2].is_nan() && read[5].is_nan(), "{text:?}");
    }
    let path = folder.write("a.csv", "1,2\n3,x\n4\n");
    let error = refused(&path);
    for part in ["a.csv:2:3: `x` is not a number", "a.csv:3:1: 1 numbers where the first row has 2"] {
        assert!(error.contains(part), "{error}");
    }
    assert!(refused(&folder.write("a.csv", "# nothing\n")).contains("hold no pixels"));
    assert!(refused(&folder.write("a.csv", b"1,2\n\xff,2\n")).contains("a.csv:2:1: not UTF-8"));
}

#[test]
fn what_is_no_raster_is_refused_with_what_to_do() {
    let folder = Scratch::new();
    for (name, bytes, message) in [
        ("a.tif", &b"II*\0rest"[..], "not a complete TIFF: it is cut short"),
        ("a.jp2", b"\0\0\0\x0cjP  rest", "JPEG 2000 (`gdal_translate -of ENVI a.jp2 a_envi.img`"),
        ("a.nc", b"\x89HDF\r\n\x1a\n", "cannot be read as NetCDF or HDF5"),
        ("b.nc", b"not", "cannot be read as NetCDF or HDF5"),
        ("a.fits", b"not", "begins with \"not\", as no whole .fits file does"),
        ("a.bin", b"1234", "its header is not beside it"),
        ("a.hdr", b"ENVI\nsamples = 1\n", "its data file is not beside it"),
        ("a.exr", b"not", "begins with \"not\", as no whole .exr file does"),
        ("a.npz", b"not", "begins with \"not\", as no whole .npz file does"),
    ] {
        let error = refused(&folder.write(name, bytes));
        assert!(error.contains(message), "{name}: {error}");
    }
    assert!(matches!(registry::image(folder.path()), Err(Error::Io { .. })));
}
