//! Rasters: files written byte by byte are read as what they hold, and what is wrong with a file is told at its place.

use std::path::Path;

use mmxrt::Error;
use mmxrt::formats::raster::{self, Raster};

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
    raster::open(path).map(|_| ()).unwrap_err().to_string()
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
            let mut raster = raster::open(&path).unwrap();
            assert_eq!((raster.rows, raster.columns, raster.bands.len()), (2, 3, 2));
            assert_eq!(bands(&mut raster), values(), "type {code}, byte order {order}, {interleave}");
        }
    }
    // By its header; and bands in any order, twice.
    let mut raster = raster::open(&folder.join("a.hdr")).unwrap();
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
    let mut raster = raster::open(&path).unwrap();
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
    let mut raster = raster::open(&path).unwrap();
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
        ("data type = 1\ndata gain values = {1, inf}\n", "data gain values: is no list of 2 finite numbers"),
        ("data type = 1\nreflectance scale factor = 0\n", "reflectance scale factor: is no positive number"),
        ("data type = 1\nfile compression = 1\n", "a compressed ENVI image is not supported"),
        ("data type = 1\nfile type = ENVI Spectral Library\n", "a spectral library as an image"),
        ("data type = 1\ninterleave = tile\n", "a.hdr:6 interleave: \"tile\" is none of bsq, bil, bip"),
    ] {
        folder.write("a.hdr", header(more));
        let error = refused(&path);
        assert!(error.contains(message), "{more}: {error}");
    }
    folder.write("a.hdr", "ENVI\nsamples = 3\nlines = 1\nbands = 2\ndata type = 1\n");
    assert!(refused(&path).contains("its size, bands or type are others"));
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
    let mut raster = raster::open(&path).unwrap();
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
        let read = bands(&mut raster::open(&path).unwrap()).remove(0);
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
fn npy(descr: &str, fortran: bool, shape: &str, bytes: &[u8]) -> Vec<u8> {
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
            let mut raster = raster::open(&path).unwrap();
            assert_eq!((raster.rows, raster.columns, raster.bands.len()), (2, 3, 2));
            assert_eq!(bands(&mut raster), values(), "{descr}, Fortran order {is_fortran}");
        }
    }
    let flat = folder.write("b.npy", npy("|i1", true, "(2, 3)", &[0, 3, 1, 4, 2, 255]));
    assert_eq!(bands(&mut raster::open(&flat).unwrap()), [[0.0, 1.0, 2.0, 3.0, 4.0, -1.0]]);
    let list = folder.write("c.npy", npy("|u1", false, "(3,)", &[1, 2, 3]));
    let mut list = raster::open(&list).unwrap();
    assert_eq!((list.rows, list.columns), (1, 3));
    assert_eq!(bands(&mut list), [[1.0, 2.0, 3.0]]);
}

#[test]
fn an_array_that_cannot_be_is_refused() {
    let folder = Scratch::new();
    for (bytes, message) in [
        (npy("<f8", false, "(2, 3)", &[0; 47]), "x 8 bytes belong"),
        (npy("<f8", false, "(2, 3)", &[0; 49]), "x 8 bytes belong"),
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
        (b"NUMPY".to_vec(), "a.npy: is not a NumPy array"),
        (vec![], "a.npy: is not a NumPy array"),
    ] {
        let path = folder.write("a.npy", bytes);
        let error = refused(&path);
        assert!(error.contains(message), "{message}: {error}");
    }
    assert!(matches!(raster::open(&folder.join("none.npy")), Err(Error::Io { .. })));
}
