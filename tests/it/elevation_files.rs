//! Elevation models and other rasters that other programs wrote (`referees/rasters.py`): all numbers, where there are none, and the size of a pixel.

use std::path::{Path, PathBuf};

use mmxrt::formats::raster::{DataType, Raster};
use mmxrt::formats::registry;

use crate::cli::run;
use crate::scratch::Scratch;

const ROWS: usize = 16;
const COLUMNS: usize = 24;

pub(crate) fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/rasters").join(name)
}

pub(crate) fn open(path: &Path) -> Raster {
    registry::image(path).unwrap_or_else(|e| panic!("{e}"))
}

pub(crate) fn refused(path: &Path) -> String {
    registry::image(path).map(|_| ()).unwrap_err().to_string()
}

/// The heights that the script makes, in quarters of a metre.
pub(crate) fn quarters(row: usize, column: usize) -> f64 {
    let (row, column) = (row as i64, column as i64);
    let from_centre = (row - 8).pow(2) + (column - 12).pow(2);
    let bowl = if from_centre < 36 { 4 * (from_centre - 36) } else { 0 };
    (3 * column - 2 * row + bowl + row * column % 5) as f64
}

pub(crate) fn has_none(row: usize, column: usize) -> bool {
    row == 2 && (5..8).contains(&column)
}

/// The value of each pixel must be this one; NaN where there is none.
pub(crate) fn assert_band(raster: &mut Raster, band: usize, value: impl Fn(usize, usize) -> f64) {
    assert_eq!((raster.rows, raster.columns), (ROWS, COLUMNS));
    let mut values = Vec::new();
    raster.read(band, &mut values).unwrap_or_else(|e| panic!("{e}"));
    for (i, found) in values.iter().enumerate() {
        let (row, column) = (i / COLUMNS, i % COLUMNS);
        let expected = value(row, column);
        let same = *found == expected || found.is_nan() && expected.is_nan();
        assert!(same, "{}: row {row}, column {column}: {found}, not {expected}", raster.path.display());
    }
}

/// Quarters of a metre, with the hole.
fn heights(row: usize, column: usize) -> f64 {
    if has_none(row, column) { f64::NAN } else { 0.25 * quarters(row, column) }
}

pub(crate) fn said(raster: &Raster) -> String {
    raster.report.notes.iter().map(|note| format!("{note}\n")).collect()
}

#[test]
fn elevation_models_have_the_heights_and_holes_that_other_programs_wrote() {
    for name in ["tiles.tif", "strips.tif", "pds4.xml", "pds4.img", "bands.lbl", "tiled.lbl"] {
        let mut raster = open(&path(name));
        assert_eq!(raster.bands.len(), 1, "{name}");
        assert_band(&mut raster, 0, heights);
        assert_eq!(raster.spacing_m(), Some([50.0, 50.0]), "{name}");
    }
    let mut asc = open(&path("square.asc"));
    assert_band(&mut asc, 0, |row, column| 4.0 * heights(row, column));
    assert_eq!((asc.spacing_m(), said(&asc).as_str()), (Some([50.0, 50.0]), ""));
    // Without a projection beside it.
    let mut asc = open(&path("wide.asc"));
    let text = std::fs::read_to_string(path("wide.asc")).unwrap();
    let decimals = |row, column| (heights(row, column) * 100.0).round() / 100.0;
    assert_band(&mut asc, 0, decimals);
    assert!(text.contains("dy ") && said(&asc).contains("its unit is not stated: taken as m"), "{}", said(&asc));
    assert_eq!(asc.spacing_m(), Some([50.0, 25.0]));
    let mut pds3 = open(&path("pds3.img"));
    let stored = |row, column| if has_none(row, column) { -9999.0 } else { quarters(row, column) };
    assert_band(&mut pds3, 0, stored);
    assert_eq!((pds3.data_type, pds3.spacing_m()), (DataType::I16, None));
    assert_eq!(open(&path("pds4.xml")).unit.as_deref(), Some("m"));
}

#[test]
fn tiff_is_read_in_every_layout_that_gdal_wrote() {
    let mut planes = open(&path("planes.tif"));
    let names: Vec<&str> = planes.bands.iter().map(|band| band.name.as_str()).collect();
    assert_eq!((names, planes.data_type), (vec!["red", "green", "blue"], DataType::U8));
    assert_band(&mut planes, 0, |row, column| ((quarters(row, column) + 200.0) / 2.0).floor());
    assert_band(&mut planes, 2, |_, column| 9.0 * column as f64);
    assert_band(&mut planes, 1, |row, _| 10.0 * row as f64);
    assert_eq!(planes.spacing_m(), None);
    for name in ["pixels.tif", "interleaved.xml"] {
        let mut three = open(&path(name));
        assert_eq!((three.bands.len(), three.data_type), (3, DataType::U32), "{name}");
        assert_band(&mut three, 0, |row, column| quarters(row, column) + 1000.0);
        assert_band(&mut three, 1, |row, _| 100_000.0 * row as f64);
        assert_band(&mut three, 2, |_, column| 90_000.0 * column as f64);
    }
    let mut doubles = open(&path("doubles.tif"));
    assert_band(&mut doubles, 0, |row, column| quarters(row, column) / 3.0);
    assert_eq!(doubles.spacing_m(), Some([50.0, 50.0]));
    let mut degrees = open(&path("degrees.tif"));
    let positive = |row, column| if has_none(row, column) { f64::NAN } else { quarters(row, column) + 1000.0 };
    assert_band(&mut degrees, 0, positive);
    assert_eq!(degrees.spacing_m(), None);
    let [west, south, east, north] = degrees.extent_deg().unwrap();
    assert!(
        west == 10.0 && north == 5.0 && (south - 3.4).abs() < 1e-12 && (east - 12.4).abs() < 1e-12,
        "{south} {east}"
    );
    // Of four tiles one is there.
    let mut sparse = open(&path("sparse.tif"));
    let corner = |row, column| if row < 8 && column < 8 { quarters(row, column) } else { f64::NAN };
    assert_band(&mut sparse, 0, corner);
}

#[test]
fn pictures_are_shares_of_the_largest_number_which_they_tell() {
    for (name, largest) in [("grey.pgm", 65535.0), ("grey16.png", 65535.0), ("colours.ppm", 255.0)] {
        let mut raster = open(&path(name));
        assert_eq!(raster.full_scale, Some(largest), "{name}");
        let count = |row, column| match name {
            "colours.ppm" => ((quarters(row, column) + 200.0) / 2.0).floor(),
            _ if has_none(row, column) => 0.0,
            _ => quarters(row, column) + 1000.0,
        };
        assert_band(&mut raster, 0, |row, column| count(row, column) / largest);
    }
    let mut ppm = open(&path("colours.ppm"));
    assert_band(&mut ppm, 1, |row, _| 10.0 * row as f64 / 255.0);
    assert_band(&mut ppm, 2, |_, column| 9.0 * column as f64 / 255.0);
    // As text, with comments in the head.
    let folder = Scratch::new();
    let path = folder.write("a.ppm", "P3 # a comment\n2\n# another 7\n1 10\n1 2 3\n 4\t5 # six\n10\n");
    let mut raster = open(&path);
    let mut values = Vec::new();
    raster.read(2, &mut values).unwrap();
    assert_eq!((values.as_slice(), raster.full_scale), (&[0.3, 1.0][..], Some(10.0)));
    for (text, message) in [
        ("P2\n2 2\n9\n1 2 3\n", "3 of 4 numbers"),
        ("P2\n2 2\n9\n1 2\n3 x\n", ":5: `x` is not a number"),
        ("P5\n2 2\n9\n123", "has 12 bytes where 9 + 2 rows"),
        ("P5\n2 2\n0\n1234", "the largest number is 0"),
        ("P5\n2", "its height is missing"),
        ("P2\n99999 999\n9\n1", "cannot hold that many"),
    ] {
        let error = refused(&folder.write("a.pgm", text));
        assert!(error.contains(message), "{text:?}: {error}");
    }
}

/// A label of PDS3 with the numbers of one that another program wrote: 24 samples of 16 lines, big end first, from byte 529 on.
fn pds3(folder: &Scratch, label: &str, prefix: usize, suffix: usize) -> PathBuf {
    let bytes = std::fs::read(path("pds3.img")).unwrap();
    let lines = bytes[528..].chunks(2 * COLUMNS).flat_map(|line| [&vec![1; prefix], line, &vec![2; suffix]].concat());
    folder.write("A.IMG", lines.collect::<Vec<u8>>());
    folder.write("a.lbl", label)
}

const LABEL: &str = "PDS_VERSION_ID = PDS3\r\nRECORD_BYTES = 48\r\n^IMAGE = \"a.img\" /* called A.IMG here */\r\nOBJECT = IMAGE\r\n\
    LINES = 16\r\nLINE_SAMPLES = 24\r\nSAMPLE_TYPE = SUN_INTEGER\r\nSAMPLE_BITS = 16\r\nEND_OBJECT\r\n";

#[test]
fn what_a_label_of_pds3_says_is_taken() {
    let folder = Scratch::new();
    let more = "MISSING_CONSTANT = 16#D8F1#\r\nSCALING_FACTOR = 0.25\r\nOFFSET = 1000.\r\nUNIT = METER\r\n\
                LINE_PREFIX_BYTES = 3\r\nLINE_SUFFIX_BYTES = 5\r\nEND_OBJECT\r\n\
                OBJECT = IMAGE_MAP_PROJECTION\r\nMAP_SCALE = 0.05 <KM/PIXEL>\r\nEND_OBJECT\r\nEND\r\n";
    let full = LABEL.replace("END_OBJECT\r\n", more);
    let label = pds3(&folder, &full, 3, 5);
    let mut raster = open(&label);
    assert_band(&mut raster, 0, |row, column| heights(row, column) + 1000.0);
    assert_eq!((raster.spacing_m(), raster.unit.as_deref()), (Some([50.0, 50.0]), Some("METER")));
    assert_eq!(raster.files().len(), 2);
    // By the file of its numbers; and from below, from the right.
    folder.write("A.lbl", &full);
    assert_band(&mut open(&folder.join("A.IMG")), 0, |row, column| heights(row, column) + 1000.0);
    let turned = full.replace("UNIT", "LINE_DISPLAY_DIRECTION = UP\r\nSAMPLE_DISPLAY_DIRECTION = LEFT\r\nUNIT");
    let label = pds3(&folder, &turned, 3, 5);
    assert_band(&mut open(&label), 0, |row, column| heights(ROWS - 1 - row, COLUMNS - 1 - column) + 1000.0);

    for (from, to, message) in [
        ("LINES = 16", "LINES = 17", "A.IMG: has 896 bytes"),
        ("LINES = 16", "LINES = x", "a.lbl:5 LINES: \"x\" is not a count"),
        ("SUN_INTEGER", "VAX_REAL", "a.lbl:7 SAMPLE_TYPE: samples of VAX_REAL"),
        ("a.img", "b.img", "a.lbl:3 ^IMAGE: \"b.img\", which it names, is not beside it"),
        ("a.img", "../a.img", "leads out of the folder"),
        ("\"a.img\"", "(\"a.img\", 0)", "a.lbl:3 ^IMAGE: is not where an image can be"),
        ("OBJECT = IMAGE\r\n", "OBJECT = TABLE\r\n", "without an IMAGE"),
        ("LINE_PREFIX_BYTES = 3", "LINE_PREFIX_BYTES = 18446744073709551615", "longer than any file"),
        ("OFFSET = 1000.", "OFFSET = much", "a.lbl:11 OFFSET: \"much\" is not a number"),
        ("END\r\n", "", "no END"),
    ] {
        let text = full.replace(from, to);
        let error = refused(&folder.write("a.lbl", &text));
        assert!(error.contains(message), "{to:?}: {error}");
    }
}

#[test]
fn a_cube_of_isis_with_its_label_within_and_special_pixels() {
    let folder = Scratch::new();
    let label = std::fs::read_to_string(path("bands.lbl")).unwrap();
    let inside = label.replace("StartByte = 1\n    ^Core     = bands.cub", "StartByte = 4097");
    assert!(inside.len() < 4096 && inside != label);
    let mut bytes = inside.into_bytes();
    bytes.resize(4096, 0);
    let numbers = std::fs::read(path("bands.cub")).unwrap();
    let cube = folder.write("a.cub", [bytes, numbers].concat());
    assert_band(&mut open(&cube), 0, heights);
    // Null, and what was too low or too high: SpecialPixel.h.
    let start = inside_of(&cube);
    let mut bytes = std::fs::read(&cube).unwrap();
    for (i, bits) in
        [0xff7f_fffb_u32, 0xff7f_fffc, 0xff7f_fffd, 0xff7f_fffe, 0xff7f_ffff, 0xff7f_fffa].into_iter().enumerate()
    {
        bytes[start + 4 * i..][..4].copy_from_slice(&bits.to_le_bytes());
    }
    let mut values = Vec::new();
    open(&folder.write("a.cub", &bytes)).read(0, &mut values).unwrap();
    assert!(values[..5].iter().all(|v| v.is_nan()) && values[5] == f64::from(f32::from_bits(0xff7f_fffa)));
    let error = refused(&folder.write("a.cub", &bytes[..bytes.len() - 1]));
    assert!(error.contains("has 5631 bytes where 4096 + 16 rows"), "{error}");
}

/// The first byte of the numbers of a cube, which the label counts from 1.
fn inside_of(cube: &Path) -> usize {
    let text = String::from_utf8_lossy(&std::fs::read(cube).unwrap()).into_owned();
    let behind = text.split("StartByte = ").nth(1).unwrap();
    behind.split_whitespace().next().unwrap().parse::<usize>().unwrap() - 1
}

#[test]
fn grids_of_text_tell_where_they_are_wrong() {
    let folder = Scratch::new();
    let head = "NCOLS 2\nnrows 2\nxllcenter 5\nyllcenter 5\ncellsize 10\nnodata_value -1\n";
    let mut raster = open(&folder.write("a.asc", format!("{head}1 2\n-1 4\n")));
    let mut values = Vec::new();
    raster.read(0, &mut values).unwrap();
    assert!(values[..2] == [1.0, 2.0] && values[2].is_nan() && values[3] == 4.0);
    assert_eq!(raster.spacing_m(), Some([10.0, 10.0]));
    for (text, message) in [
        (format!("{head}1 2\n3 x\n"), ":8:3: `x` is not a number"),
        (format!("{head}1 2\n3\n"), "3 numbers where the head says 2 x 2"),
        (format!("{head}1 2 3 4\n5\n"), ":8: a number beyond the 2 x 2"),
        (head.replace("cellsize", "size"), ":5 size: is not known"),
        (head.replace("nrows 2", "nrows"), ":2 nrows: a number must follow"),
        (head.replace("nrows 2", "nrows 99999"), "cannot hold 2 x 99999 numbers"),
        (head.replace("nrows 2", "nrows 2.5"), "2.5 is not a count"),
    ] {
        let error = refused(&folder.write("a.asc", text));
        assert!(error.contains(message), "{message}: {error}");
    }
    // Angles; feet.
    let grid = format!("{head}1 2\n3 4\n");
    folder.write("a.prj", "GEOGCS[\"x\",UNIT[\"Degree\",0.0174532925199433]]");
    assert_eq!(open(&folder.write("a.asc", &grid)).spacing_m(), None);
    folder.write("a.prj", "PROJCS[\"x\",GEOGCS[\"x\",UNIT[\"Degree\",0.017]],UNIT[\"Foot\",0.3048]]");
    assert_eq!(open(&folder.write("a.asc", &grid)).spacing_m(), Some([3.048, 3.048]));
}

/// Bytes changed, and files cut short, are read or refused: nothing panics, and nothing takes memory that the file does not explain.
#[test]
fn damaged_files_are_refused_or_read() {
    let folder = Scratch::new();
    let names = [
        "tiles.tif",
        "strips.tif",
        "pixels.tif",
        "planes.tif",
        "sparse.tif",
        "tiled.lbl",
        "pds4.xml",
        "pds3.img",
        "grey.pgm",
        "square.asc",
    ];
    for data in ["tiled.cub", "pds4.img"] {
        folder.write(data, std::fs::read(path(data)).unwrap());
    }
    let is_heavy = std::env::var_os("MMXRT_HEAVY").is_some();
    let (mut values, mut refused) = (Vec::new(), 0);
    for name in names {
        let good = std::fs::read(path(name)).unwrap();
        let mut random = 1_u64;
        for i in 0..if is_heavy { 5000 } else { 45 } {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let mut bytes = good.clone();
            let at = (random >> 33) as usize % bytes.len();
            match i % 3 {
                0 => bytes.truncate(at),
                1 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff, b'9'][(random >> 20) as usize % 6],
                _ => {
                    let end = bytes.len().min(at + 4);
                    bytes[at..end].fill(0xff);
                }
            }
            match registry::image(&folder.write(name, bytes)) {
                Ok(mut raster) if raster.pixels() < 1 << 16 => {
                    refused += usize::from(raster.read(raster.bands.len() - 1, &mut values).is_err());
                }
                Ok(_) => {}
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused > 45, "{refused}");
}

#[test]
fn elevation_models_are_inspected_and_converted_and_others_name_their_line() {
    let folder = Scratch::new();
    let (source, target) = (path("tiles.tif").to_string_lossy().into_owned(), folder.argument("a.npy"));
    let (code, out, err) = run(&["convert", &source, &target]);
    assert_eq!(code, 0, "{out}{err}");
    assert_band(&mut open(&folder.join("a.npy")), 0, heights);
    let (code, out, err) = run(&["--json", "inspect", &source]);
    assert_eq!(code, 0, "{err}");
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["spacing_m"], serde_json::json!([50.0, 50.0]));
    for (name, bytes) in
        [("a.jp2", &b"\0\0\0\x0cjP  \r\n\x87\n"[..]), ("a.hdf", b"\x0e\x03\x13\x01"), ("a.nitf", b"NITF02.10")]
    {
        let error = refused(&folder.write(name, bytes));
        assert!(error.contains("gdal_translate -of ENVI"), "{error}");
    }
}
