//! NetCDF, Zarr and FITS: what other programs wrote is read (`data/containers/make.py`), and what is written is as the formats have it, byte by byte, and read again.

use std::path::{Path, PathBuf};

use mmxrt::formats::raster::Raster;
use mmxrt::formats::registry;
use serde_json::Value;

use crate::cli::run;
use crate::scratch::Scratch;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/containers").join(name)
}

fn open(path: &Path) -> Raster {
    registry::image(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn refused(path: &Path) -> String {
    registry::image(path).map(|_| ()).unwrap_err().to_string()
}

/// Bands, rows and columns of what the script makes, and its numbers.
const SIZE: [usize; 3] = [4, 5, 7];

fn number(band: usize, row: usize, column: usize) -> f64 {
    (100 * band + 10 * row + column) as f64
}

fn assert_numbers(raster: &mut Raster, band: usize, value: impl Fn(usize, usize) -> f64) {
    let mut values = Vec::new();
    raster.read(band, &mut values).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(values.len(), SIZE[1] * SIZE[2]);
    for (i, found) in values.iter().enumerate() {
        let (row, column) = (i / SIZE[2], i % SIZE[2]);
        let wanted = value(row, column);
        let same = *found == wanted || found.is_nan() && wanted.is_nan();
        assert!(same, "{}: band {band}, row {row}, column {column}: {found}, not {wanted}", raster.path.display());
    }
}

fn centres_um(raster: &Raster) -> Vec<f64> {
    raster.bands.iter().map(|band| (1e4 * band.centre_um.unwrap_or(f64::NAN)).round() / 1e4).collect()
}

#[test]
fn netcdf_4_is_unpacked_and_knows_its_wavelengths() {
    let mut raster = open(&data("packed.nc"));
    assert_eq!([raster.bands.len(), raster.rows, raster.columns], SIZE);
    assert_eq!(centres_um(&raster), [1.0, 1.1, 1.2, 1.3]);
    assert_eq!(raster.unit.as_deref(), Some("W m-2 sr-1 um-1"));
    assert!(raster.report.notes.iter().any(|note| note.to_string().contains("angle")));
    // Backwards, too, where bands come in passes.
    for band in [0, 1, 2, 3, 1] {
        assert_numbers(&mut raster, band, |row, column| match (band, row, column) {
            (2, 1, 3) => f64::NAN,
            _ => 0.5 * number(band, row, column),
        });
    }
}

#[test]
fn bands_in_the_last_axis_have_their_wavelengths_in_a_group() {
    let mut raster = open(&data("groups.nc"));
    assert_eq!([raster.bands.len(), raster.rows, raster.columns], SIZE);
    assert_eq!(centres_um(&raster), [0.9, 1.0, 1.1, 1.2]);
    assert!((raster.bands[3].fwhm_um.unwrap() - 0.02).abs() < 1e-8);
    for band in [3, 0, 2] {
        assert_numbers(&mut raster, band, |row, column| number(band, row, column));
    }
}

#[test]
fn netcdf_3_of_records_is_turned_upright() {
    let mut raster = open(&data("classic.nc"));
    let names: Vec<&str> = raster.bands.iter().map(|band| band.name.as_str()).collect();
    assert_eq!(names, ["height", "other"]);
    // From the South to the North in the file.
    assert_numbers(&mut raster, 0, |row, column| number(1, SIZE[1] - 1 - row, column));
    assert_numbers(&mut raster, 1, |row, column| number(2, SIZE[1] - 1 - row, column));
    assert_eq!(raster.extent_deg(), Some([9.5, -2.5, 16.5, 2.5]));
}

#[test]
fn fits_is_scaled_and_knows_a_linear_axis_of_wavelengths() {
    let mut raster = open(&data("cube.fits"));
    assert_eq!([raster.bands.len(), raster.rows, raster.columns], SIZE);
    assert_eq!((centres_um(&raster), raster.unit.as_deref()), (vec![1.0, 1.1, 1.2, 1.3], Some("DN")));
    for band in [0, 3] {
        assert_numbers(&mut raster, band, |row, column| number(band, row, column));
    }
    let mut raster = open(&data("extensions.fits"));
    assert_eq!(raster.bands.iter().map(|band| band.name.as_str()).collect::<Vec<_>>(), ["REAL", "SCALED"]);
    assert_numbers(&mut raster, 0, |row, column| number(0, row, column));
    assert_numbers(&mut raster, 1, |row, column| 0.5 * number(1, row, column) + 3.0);
    let error = refused(&data("compressed.fits"));
    assert!(error.contains("funpack"), "{error}");
}

#[test]
fn zarr_in_chunks_and_shards_is_read_and_other_compression_named() {
    let mut raster = open(&data("chunks.zarr"));
    assert_eq!([raster.bands.len(), raster.rows, raster.columns], SIZE);
    assert_eq!((centres_um(&raster), raster.unit.as_deref()), (vec![1.0, 1.1, 1.2, 1.3], Some("DN")));
    for band in [3, 0, 2, 1] {
        assert_numbers(&mut raster, band, |row, column| number(band, row, column));
    }
    let mut raster = open(&data("shards.zarr"));
    // Of the last two bands nothing has been written.
    for band in [0, 3, 1] {
        assert_numbers(&mut raster, band, |row, column| if band < 2 { number(band, row, column) } else { -5.0 });
    }
    let error = refused(&data("zstd.zarr"));
    assert!(error.contains("zstd") && error.contains("compressors=None"), "{error}");
}

#[test]
fn files_that_are_cut_short_or_damaged_are_errors() {
    let scratch = Scratch::new();
    let mut tried = 0;
    for name in ["packed.nc", "groups.nc", "classic.nc", "cube.fits"] {
        let whole = std::fs::read(data(name)).unwrap();
        for length in (8..whole.len()).step_by(whole.len() / 23) {
            let path = scratch.write(name, &whole[..length]);
            if let Ok(mut raster) = registry::image(&path) {
                let bands = raster.bands.len();
                let read = (0..bands).try_for_each(|band| raster.read(band, &mut Vec::new()));
                // Where the numbers end that are read: of FITS the rest is another image, of NetCDF other arrays.
                let end = if name == "cube.fits" { 2880 + 2 * 4 * 5 * 7 } else { whole.len() / 2 };
                assert!(read.is_err() || length >= end, "{name} of {length} bytes is read");
            }
            tried += 1;
        }
        // Every byte of the head turned over: an error, or numbers, but no panic that comes through.
        for at in (0..whole.len().min(3000)).step_by(7) {
            let mut damaged = whole.clone();
            damaged[at] ^= 0xff;
            let path = scratch.write(name, &damaged);
            if let Ok(mut raster) = registry::image(&path) {
                let bands = raster.bands.len().min(8);
                let _ = (0..bands).try_for_each(|band| raster.read(band, &mut Vec::new()));
            }
            tried += 1;
        }
    }
    assert!(tried > 1000, "{tried}");
}

/// A product of all formats: of 4 x 3 pixels, 2 bands, f32.
fn product(scratch: &Scratch, formats: &str) -> PathBuf {
    scratch.write("square.obj", "v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nf 1 2 3 4\n");
    scratch.write(
        "scene.toml",
        "mmxrt_scene = 1\norigin_m = [0, 0, 11000]\n[[mesh]]\nobj = \"square.obj\"\nmaterial = \"ground\"\n\
         [materials]\nground = { reflectance = 0.2, emissivity = 0.8 }\n\
         [sun]\ndirection = [0.8660254037844386, 0, 0.5]\ndistance_au = 1\n\
         [observer]\nframe = \"site\"\nposition_m = [0, 0, 1000]\ntarget_m = [0.4, 0, 0]\nup = [0, 1, 0]\n\
         [sensor]\nsamples = 4\nlines = 3\nifov_mrad = 3.0\nbands = { centres_um = [1.0, 3.0], fwhm_um = 0.5 }\n",
    );
    let out = scratch.join("out");
    let (code, told, err) = run(&[
        "simulate",
        &scratch.argument("scene.toml"),
        "-o",
        &scratch.argument("out"),
        "--format",
        formats,
        "--split",
        "--force",
    ]);
    assert_eq!(code, 0, "{told}{err}");
    out
}

fn cube(path: &Path) -> Vec<Vec<f64>> {
    let mut raster = open(path);
    (0..raster.bands.len())
        .map(|band| {
            let mut values = Vec::new();
            raster.read(band, &mut values).unwrap();
            values
        })
        .collect()
}

#[test]
fn a_product_is_the_same_in_all_formats() {
    let scratch = Scratch::new();
    let out = product(&scratch, "envi,netcdf,zarr,fits");
    let envi = cube(&out.join("cube.img"));
    assert!(envi[0].iter().any(|value| *value > 0.0) && envi[0] != envi[1]);
    let thermal = cube(&out.join("thermal.img"));
    for ending in ["nc", "zarr", "fits"] {
        let path = out.join(format!("cube.{ending}"));
        assert_eq!(cube(&path), envi, "{ending}");
        assert_eq!(cube(&out.join(format!("thermal.{ending}"))), thermal, "{ending}");
        let raster = open(&path);
        assert_eq!(centres_um(&raster), [1.0, 3.0], "{ending}");
        assert_eq!(raster.bands[1].fwhm_um, Some(0.5), "{ending}");
        assert_eq!(raster.unit.as_deref(), Some("W m-2 sr-1 um-1"), "{ending}");
    }
    // Without ENVI its files are not there, and what looks at products finds the cube.
    let before = run(&["inspect", &scratch.argument("out"), "--pixel", "1,1", "--json"]);
    for format in ["netcdf", "zarr", "fits"] {
        let out = product(&scratch, format);
        assert!(
            !out.join("cube.img").exists() && !out.join("thermal.hdr").exists() && out.join("backplanes.img").exists()
        );
        assert_eq!(run(&["inspect", &scratch.argument("out"), "--pixel", "1,1", "--json"]), before, "{format}");
    }
    assert_eq!(before.0, 0);
}

/// A NetCDF classic file as its specification reads it: versions 2 and 5, of variables without records. Names, values as numbers or text.
struct Classic<'a> {
    bytes: &'a [u8],
    at: usize,
    wide: bool,
}

impl Classic<'_> {
    fn u32(&mut self) -> u32 {
        self.at += 4;
        u32::from_be_bytes(self.bytes[self.at - 4..self.at].try_into().unwrap())
    }

    fn count(&mut self) -> usize {
        if !self.wide {
            return self.u32() as usize;
        }
        self.at += 8;
        u64::from_be_bytes(self.bytes[self.at - 8..self.at].try_into().unwrap()) as usize
    }

    fn padded(&mut self, length: usize) -> Vec<u8> {
        let bytes = self.bytes[self.at..][..length].to_vec();
        assert!(self.bytes[self.at + length..self.at + length.next_multiple_of(4)].iter().all(|b| *b == 0));
        self.at += length.next_multiple_of(4);
        bytes
    }

    fn name(&mut self) -> String {
        let length = self.count();
        String::from_utf8(self.padded(length)).unwrap()
    }

    fn list(&mut self, tag: u32) -> usize {
        let found = self.u32();
        let length = self.count();
        assert!(found == tag && length > 0 || found == 0 && length == 0);
        length
    }

    fn attributes(&mut self) -> Vec<(String, String)> {
        (0..self.list(12))
            .map(|_| {
                let name = self.name();
                let (kind, length) = (self.u32(), self.count());
                let bytes = self.padded(length * [0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8][kind as usize]);
                (name, if kind == 2 { String::from_utf8(bytes).unwrap() } else { format!("type {kind}") })
            })
            .collect()
    }
}

#[test]
fn netcdf_is_written_as_its_specification_has_it() {
    let scratch = Scratch::new();
    let out = product(&scratch, "envi,netcdf");
    let bytes = std::fs::read(out.join("cube.nc")).unwrap();
    assert_eq!(&bytes[..4], b"CDF\x02", "64-bit offsets: no type needs more");
    let mut file = Classic { bytes: &bytes, at: 4, wide: false };
    assert_eq!(file.count(), 0, "no records");
    let dimensions: Vec<(String, usize)> = (0..file.list(10)).map(|_| (file.name(), file.count())).collect();
    let report = std::fs::read(out.join("report.json")).unwrap();
    let expected = [("band", 2), ("line", 3), ("sample", 4), ("report_length", report.len())];
    assert_eq!(dimensions, expected.map(|(name, length)| (name.to_owned(), length)));
    let global = file.attributes();
    assert!(global.contains(&("Conventions".into(), "CF-1.11".into())), "{global:?}");
    let scene: Value = serde_json::from_slice(&report).unwrap();
    assert!(global.contains(&("scene".into(), scene["scene"].as_str().unwrap().into())));
    let planes = std::fs::read(out.join("backplanes.img")).unwrap();
    let mut found = Vec::new();
    for _ in 0..file.list(11) {
        let name = file.name();
        let axes: Vec<usize> = (0..file.count()).map(|_| file.count()).collect();
        let attributes = file.attributes();
        let (kind, size) = (file.u32(), file.count());
        file.at += 8;
        let start = u64::from_be_bytes(bytes[file.at - 8..file.at].try_into().unwrap()) as usize;
        let numbers: usize = axes.iter().map(|axis| dimensions[*axis].1).product();
        let width = [0, 1, 1, 2, 4, 4, 8][kind as usize];
        assert_eq!(size, (numbers * width).next_multiple_of(4), "{name}");
        assert!(start >= file.at && start + numbers * width <= bytes.len(), "{name}");
        found.push((name, axes, attributes, kind, bytes[start..start + numbers * width].to_vec()));
    }
    let of = |name: &str| found.iter().find(|of| of.0 == name).unwrap_or_else(|| panic!("{name} is missing"));
    let (_, axes, attributes, kind, numbers) = of("radiance");
    assert_eq!((&axes[..], *kind), (&[0, 1, 2][..], 5));
    let text = |key: &str| attributes.iter().find(|(name, _)| name == key).map(|(_, text)| text.as_str());
    assert_eq!(text("units"), Some("W m-2 sr-1 um-1"));
    assert_eq!(text("coordinates"), Some("wavelength fwhm LATITUDE LONGITUDE"));
    assert_eq!(text("_FillValue"), Some("type 5"));
    let cube = std::fs::read(out.join("cube.img")).unwrap();
    let turned: Vec<u8> = cube.chunks(4).flat_map(|number| number.iter().rev().copied()).collect();
    assert_eq!(*numbers, turned);
    let wavelength = [1.0_f64, 3.0].map(f64::to_be_bytes).concat();
    assert_eq!((&of("wavelength").1[..], &of("wavelength").4), (&[0][..], &wavelength));
    assert_eq!((&of("report").1[..], &of("report").4), (&[3][..], &report));
    // The first plane, and one with a unit of its own.
    let first: Vec<u8> = planes[..8 * 12].chunks(8).flat_map(|number| number.iter().rev().copied()).collect();
    assert_eq!((&of("COVERAGE").1[..], &of("COVERAGE").4), (&[1, 2][..], &first));
    assert!(of("LATITUDE").2.contains(&("units".into(), "degrees_north".into())));
}

#[test]
fn fits_is_written_in_blocks_and_cards() {
    let scratch = Scratch::new();
    let out = product(&scratch, "envi,fits");
    let bytes = std::fs::read(out.join("cube.fits")).unwrap();
    assert_eq!(bytes.len() % 2880, 0);
    let cards = |start: usize| -> Vec<String> {
        let all = bytes[start..].chunks(80).map(|card| String::from_utf8(card.to_vec()).unwrap());
        all.take_while(|card| card.trim_end() != "END").collect()
    };
    let primary = cards(0);
    assert_eq!(primary[0], format!("{:80}", "SIMPLE  =                    T"));
    assert_eq!(primary[1], format!("{:80}", "BITPIX  =                  -32"));
    for (i, (axis, length)) in [("NAXIS", 3), ("NAXIS1", 4), ("NAXIS2", 3), ("NAXIS3", 2)].iter().enumerate() {
        assert_eq!(primary[2 + i], format!("{:80}", format!("{axis:8}= {length:>20}")));
    }
    assert!(primary.contains(&format!("{:80}", "BUNIT   = 'W m-2 sr-1 um-1'")), "{primary:?}");
    let start = (80 * (primary.len() + 1)).next_multiple_of(2880);
    let cube = std::fs::read(out.join("cube.img")).unwrap();
    let turned: Vec<u8> = cube.chunks(4).flat_map(|number| number.iter().rev().copied()).collect();
    assert_eq!(bytes[start..start + turned.len()], turned);
    // The next unit is in the next block.
    let next = cards(start + turned.len().next_multiple_of(2880));
    assert_eq!(next[0], format!("{:80}", "XTENSION= 'IMAGE   '"));
    assert!(next.contains(&format!("{:80}", "EXTNAME = 'WAVELENGTH'")), "{next:?}");
}

#[test]
fn images_are_converted_there_and_back() {
    let scratch = Scratch::new();
    let mut raster = open(&data("packed.nc"));
    for (first, last) in [("a.nc", "a.npy"), ("a.zarr", "b.nc"), ("a.fits", "b.zarr"), ("b.img", "b.fits")] {
        let (first, last) = (scratch.argument(first), scratch.argument(last));
        for (from, to) in [(data("packed.nc").display().to_string(), &first), (first.clone(), &last)] {
            let (code, told, err) = run(&["convert", &from, to]);
            assert_eq!(code, 0, "{from} {to}: {told}{err}");
        }
        let mut back = open(Path::new(&last));
        if !last.ends_with("npy") {
            assert_eq!(centres_um(&back), [1.0, 1.1, 1.2, 1.3], "{last}");
            assert_eq!(back.unit.as_deref(), Some("W m-2 sr-1 um-1"), "{last}");
        }
        for band in 0..SIZE[0] {
            let mut values = Vec::new();
            raster.read(band, &mut values).unwrap();
            assert_numbers(&mut back, band, |row, column| values[row * SIZE[2] + column]);
        }
    }
    // What lies somewhere lies there again.
    let out = scratch.argument("map.nc");
    assert_eq!(run(&["convert", &data("classic.nc").display().to_string(), &out]).0, 0);
    assert_eq!(open(Path::new(&out)).extent_deg(), Some([9.5, -2.5, 16.5, 2.5]));
    // A folder of Zarr is replaced only if it is one.
    let zarr = scratch.argument("b.zarr");
    let input = data("packed.nc").display().to_string();
    assert_eq!(run(&["convert", &input, &zarr]).0, 1);
    assert_eq!(run(&["convert", &input, &zarr, "--force"]).0, 0);
    scratch.write("b.zarr/notes.txt", "mine");
    let (code, _, err) = run(&["convert", &input, &zarr, "--force"]);
    assert!(code == 1 && err.contains("notes.txt"), "{err}");
}

#[test]
fn whole_numbers_keep_what_stands_for_no_data() {
    let scratch = Scratch::new();
    scratch.write("a.img", [7_i16, -32768, 9, 10, 11, -5].map(i16::to_le_bytes).concat());
    let header = "ENVI\nsamples = 3\nlines = 2\nbands = 1\ndata type = 2\nbyte order = 0\ninterleave = bsq\ndata ignore value = -5\n";
    scratch.write("a.hdr", header);
    for ending in ["nc", "zarr", "fits"] {
        let out = scratch.argument(&format!("a.{ending}"));
        let (code, told, err) = run(&["convert", &scratch.argument("a.img"), &out]);
        assert_eq!(code, 0, "{told}{err}");
        let values = &cube(Path::new(&out))[0];
        assert_eq!(values[..5], [7.0, -32768.0, 9.0, 10.0, 11.0], "{ending}");
        assert!(values[5].is_nan(), "{ending}: {values:?}");
    }
}

/// Numbers of all types at the ends of what they hold, in images of a pixel and of a few, with and without one that stands for no data, come back as they were.
#[test]
fn numbers_of_all_types_come_back_from_the_ends_of_what_they_hold() {
    let scratch = Scratch::new();
    let most = (1_i64 << 53) as f64;
    let mut tried = 0;
    for (code, data_type, ends) in [
        (1, "u8", [0.0, 255.0]),
        (2, "i16", [-32768.0, 32767.0]),
        (3, "i32", [-2147483648.0, 2147483647.0]),
        (4, "f32", [f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX)]),
        (5, "f64", [f64::MIN, f64::NAN]),
        (12, "u16", [0.0, 65535.0]),
        (13, "u32", [0.0, 4294967295.0]),
        (14, "i64", [-most, most]),
        (15, "u64", [0.0, most]),
    ] {
        for (size, no_data) in [([1, 1, 1], false), ([2, 1, 3], false), ([3, 2, 1], true)] {
            let [bands, lines, samples]: [usize; 3] = size;
            let values: Vec<f64> = (0..bands * lines * samples).map(|i| [ends[0], 7.0, ends[1]][i % 3]).collect();
            let bytes: Vec<u8> = values
                .iter()
                .flat_map(|v| match data_type {
                    "u8" => vec![*v as u8],
                    "i16" => (*v as i16).to_le_bytes().to_vec(),
                    "i32" => (*v as i32).to_le_bytes().to_vec(),
                    "f32" => (*v as f32).to_le_bytes().to_vec(),
                    "u16" => (*v as u16).to_le_bytes().to_vec(),
                    "u32" => (*v as u32).to_le_bytes().to_vec(),
                    "i64" => (*v as i64).to_le_bytes().to_vec(),
                    "u64" => (*v as u64).to_le_bytes().to_vec(),
                    _ => v.to_le_bytes().to_vec(),
                })
                .collect();
            scratch.write("a.img", bytes);
            let ignore = if no_data { "data ignore value = 7\n" } else { "" };
            let names = (0..bands)
                .map(|b| format!("it's 'band' {b} of a name that no card of FITS holds at once"))
                .collect::<Vec<_>>();
            scratch.write(
                "a.hdr",
                format!(
                    "ENVI\nsamples = {samples}\nlines = {lines}\nbands = {bands}\ndata type = {code}\nbyte order = 0\ninterleave = bsq\n\
                     band names = {{{}}}\n{ignore}",
                    names.join(", ")
                ),
            );
            for ending in ["nc", "zarr", "fits"] {
                let out = scratch.argument(&format!("b.{ending}"));
                let (code, told, err) = run(&["convert", &scratch.argument("a.img"), &out, "--force"]);
                assert_eq!(code, 0, "{told}{err}");
                let found: Vec<f64> = cube(Path::new(&out)).concat();
                let is_same = |(found, value): (&f64, &f64)| match no_data && *value == 7.0 {
                    true => found.is_nan(),
                    false => found == value || found.is_nan() && value.is_nan(),
                };
                assert!(
                    found.len() == values.len() && found.iter().zip(&values).all(is_same),
                    "{data_type} {ending}: {found:?}"
                );
                assert!(open(Path::new(&out)).bands.iter().map(|band| &band.name).eq(&names), "{data_type} {ending}");
                tried += 1;
            }
        }
    }
    assert_eq!(tried, 81);
}

#[test]
fn a_byte_that_is_another_is_not_read_where_there_is_a_checksum() {
    // Of zarr-python: packed chunks with a checksum each; of shards their list of chunks alone has one.
    for (name, file, covered) in [("chunks.zarr", "rad/c/1/1/1", usize::MAX), ("shards.zarr", "c/0/1/0", 16 * 8 + 4)] {
        let scratch = Scratch::new();
        copy(&data(name), &scratch.join(name));
        let file = scratch.join(name).join(file);
        let whole = std::fs::read(&file).unwrap();
        let from = whole.len().saturating_sub(covered);
        let mut tried = 0;
        for at in from..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << (at % 8);
            std::fs::write(&file, bytes).unwrap();
            let mut values = Vec::new();
            let read = registry::image(&scratch.join(name))
                .and_then(|mut raster| (0..raster.bands.len()).try_for_each(|band| raster.read(band, &mut values)));
            let error = read.expect_err(&format!("{name}: byte {at}")).to_string();
            assert!(error.contains("checksum"), "{name}: byte {at}: {error}");
            tried += 1;
        }
        assert!(tried > 40, "{name}: {tried}");
    }
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in from.read_dir().unwrap() {
        let entry = entry.unwrap().path();
        let target = to.join(entry.file_name().unwrap());
        if entry.is_dir() { copy(&entry, &target) } else { _ = std::fs::copy(&entry, &target).unwrap() }
    }
}
