//! Products on the disk: byte layouts known from the formats, what is read back, and what happens to damaged files.

use std::path::Path;

use crate::scratch::Scratch;
use crate::shapes::Random;
use glam::DVec3;
use mmxrt::Error;
use mmxrt::formats::envi::{self, Interleave, Precision};
use mmxrt::formats::{exr_cube, npz, quicklook, report_json};
use mmxrt::geometry::Direction;
use mmxrt::product::{
    Added, Backplanes, Cube, CubeAxes, FacetTable, Footprints, Lighting, Plane, Quantity, Sees, ShownBands, Slab,
};
use mmxrt::progress::unwatched;
use mmxrt::scene::DirectionField;
use mmxrt::spectral::Band;
use mmxrt::visibility::{Seen, Shown};

/// 2 samples x 2 lines x 2 bands; pixel p has radiance p + 1 in band 0 and 10 (p + 1) in band 1.
fn small_cube() -> Cube {
    let slab = Slab {
        lines: 0..2,
        bands: 0..2,
        row_start: vec![0, 1, 2, 3, 4],
        row: vec![0; 4],
        weight: vec![1.0, 2.0, 3.0, 4.0],
        spectra: vec![1.0, 10.0],
        first_thermal_row: 0,
        added: Added::default(),
    };
    let bands = vec![Band::new(0.95, None), Band::new(3.6, None)];
    Cube::new(CubeAxes { samples: 2, lines: 2, bands, quantity: Quantity::Radiance }, vec![slab]).unwrap()
}

/// A cube of several rows a pixel, of numbers without a pattern.
fn random_cube(samples: usize, lines: usize, bands: usize, rows: usize, rows_per_pixel: usize) -> Cube {
    let mut random = Random(1);
    let pixels = samples * lines;
    let slab = Slab {
        lines: 0..lines,
        bands: 0..bands,
        row_start: (0..=pixels).map(|p| p * rows_per_pixel).collect(),
        row: (0..pixels * rows_per_pixel).map(|_| (random.share() * rows as f64) as u32).collect(),
        weight: (0..pixels * rows_per_pixel).map(|_| random.share()).collect(),
        spectra: (0..rows * bands).map(|_| random.share()).collect(),
        first_thermal_row: 0,
        added: Added::default(),
    };
    let bands = (0..bands).map(|i| Band::new(0.95 + 0.01 * i as f64, Some(0.01))).collect();
    Cube::new(CubeAxes { samples, lines, bands, quantity: Quantity::Radiance }, vec![slab]).unwrap()
}

/// All bands of a cube.
fn shown(cube: &Cube) -> ShownBands {
    let mut shown = ShownBands::new(cube.axes.clone(), 0..cube.axes.bands.len());
    cube.slabs().iter().for_each(|slab| shown.take(slab).unwrap());
    shown
}

fn f32s(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
}

fn f64s(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

#[test]
fn envi_interleaves_are_in_the_order_of_their_names() {
    let scratch = Scratch::new();
    let path = scratch.join("cube.img");
    for (interleave, expected) in [
        (Interleave::Bsq, [1.0, 2.0, 3.0, 4.0, 10.0, 20.0, 30.0, 40.0]),
        (Interleave::Bil, [1.0, 2.0, 10.0, 20.0, 3.0, 4.0, 30.0, 40.0]),
        (Interleave::Bip, [1.0, 10.0, 2.0, 20.0, 3.0, 30.0, 4.0, 40.0]),
    ] {
        envi::write_cube(&path, &small_cube(), interleave, Precision::F32, "x", &unwatched).unwrap();
        assert_eq!(f32s(&std::fs::read(&path).unwrap()), expected.map(|v| v as f32));
        envi::write_cube(&path, &small_cube(), interleave, Precision::F64, "x", &unwatched).unwrap();
        assert_eq!(f64s(&std::fs::read(&path).unwrap()), expected);

        let (header, data) = envi::pair(&path).unwrap();
        let header = envi::read_header(&header).unwrap();
        assert_eq!((header.interleave, header.wavelength.as_slice()), (interleave, [0.95, 3.6].as_slice()));
        let statistics = envi::statistics(&header, &data).unwrap();
        let [first, second] = statistics[..] else { panic!("{statistics:?}") };
        assert_eq!((first.count, first.min, first.max, first.mean), (4, 1.0, 4.0, 2.5));
        assert_eq!((second.count, second.min, second.max, second.mean), (4, 10.0, 40.0, 25.0));
    }
}

#[test]
fn envi_header_says_what_readers_need() {
    let scratch = Scratch::new();
    let path = scratch.join("cube.img");
    let mut cube = random_cube(2, 1, 3, 1, 1);
    cube.axes.bands[1].fwhm_um = None;
    envi::write_cube(&path, &cube, Interleave::Bil, Precision::F64, "a {strange}\ntitle", &unwatched).unwrap();
    let text = std::fs::read_to_string(scratch.join("cube.hdr")).unwrap();
    assert_eq!(
        text,
        "ENVI\ndescription = {a  strange  title}\nsamples = 2\nlines = 1\nbands = 3\nheader offset = 0\n\
         file type = ENVI Standard\ndata type = 5\ninterleave = bil\nbyte order = 0\n\
         data units = W m-2 sr-1 um-1\nwavelength units = Micrometers\n\
         wavelength = {\n 0.95, 0.96, 0.97}\nfwhm = {\n 0.01, 0, 0.01}\ndefault bands = {\n 3, 2, 1}\n"
    );
    envi::write_cube(&path, &small_cube(), Interleave::Bsq, Precision::F32, "", &unwatched).unwrap();
    assert!(!std::fs::read_to_string(scratch.join("cube.hdr")).unwrap().contains("fwhm"));
}

#[test]
fn cubes_are_the_same_bytes_at_any_thread_count_and_the_numbers_of_the_cube() {
    let scratch = Scratch::new();
    // More pixels than a block, bands that leave a remainder, lines that are no multiple of what is done at a time.
    let cube = random_cube(61, 37, 39, 11, 5);
    let array = cube.to_array();
    for interleave in [Interleave::Bsq, Interleave::Bil, Interleave::Bip] {
        let written: Vec<Vec<u8>> = [1, 2, 4]
            .map(|threads| {
                let path = scratch.join("cube.img");
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| envi::write_cube(&path, &cube, interleave, Precision::F64, "x", &unwatched)).unwrap();
                std::fs::read(&path).unwrap()
            })
            .into();
        assert!(written[0] == written[1] && written[0] == written[2], "{interleave:?}");
        let values = f64s(&written[0]);
        assert_eq!(values.len(), 61 * 37 * 39);
        for ((line, sample, band), expected) in array.indexed_iter() {
            let index = match interleave {
                Interleave::Bsq => (band * 37 + line) * 61 + sample,
                Interleave::Bil => (line * 39 + band) * 61 + sample,
                Interleave::Bip => (line * 61 + sample) * 39 + band,
            };
            assert_eq!(values[index].to_bits(), expected.to_bits());
        }
    }
}

#[test]
fn backplanes_keep_their_names_units_and_holes() {
    let scratch = Scratch::new();
    let path = scratch.join("backplanes.img");
    let plane = |name: &str, unit: &str, values| Plane { name: name.into(), unit: unit.into(), values };
    let planes = Backplanes {
        samples: 2,
        lines: 1,
        planes: vec![plane("PHASE", "deg", vec![30.0, f64::NAN]), plane("COVERAGE", "1", vec![0.25, 0.0])],
    };
    envi::write_backplanes(&path, &planes, Precision::F64, "x").unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(bytes[..8], 30_f64.to_le_bytes());
    assert!(f64s(&bytes)[1].is_nan());
    assert_eq!(f64s(&bytes)[2..], [0.25, 0.0]);
    let header = envi::read_header(&scratch.join("backplanes.hdr")).unwrap();
    assert_eq!(header.band_names, ["PHASE (deg)", "COVERAGE"]);
    assert_eq!(header.field("data ignore value"), Some("nan"));
    let statistics = envi::statistics(&header, &path).unwrap();
    assert_eq!((statistics[0].count, statistics[0].mean, statistics[1].count), (1, 30.0, 2));

    let short = Backplanes { planes: vec![plane("X", "m", vec![1.0])], ..planes };
    assert!(matches!(envi::write_backplanes(&path, &short, Precision::F64, "x"), Err(Error::Invalid(_))));
}

#[test]
fn envi_files_of_others_are_understood() {
    let scratch = Scratch::new();
    let header = |data_type: u8, order: u8, extra: &str| {
        format!(
            "ENVI\n; a comment\nSamples = 2\nlines   = 1\nbands=2\n\nheader offset = 3\ndata type = {data_type}\n\
             interleave = BIP\nbyte order = {order}\n{extra}"
        )
    };
    // Two pixels of two bands, each with -2 or the type's number for 254, 1; 7, 1.
    type Case<'a> = (u8, u8, &'a [u8], f64);
    let cases: [Case<'_>; 6] = [
        (1, 0, &[254, 1, 7, 1], 254.0),
        (2, 1, &[0xff, 0xfe, 0, 1, 0, 7, 0, 1], -2.0),
        (3, 0, &[0xfe, 0xff, 0xff, 0xff, 1, 0, 0, 0, 7, 0, 0, 0, 1, 0, 0, 0], -2.0),
        (4, 1, &[0xc0, 0, 0, 0, 0x3f, 0x80, 0, 0, 0x40, 0xe0, 0, 0, 0x3f, 0x80, 0, 0], -2.0),
        (12, 0, &[0xfe, 0xff, 1, 0, 7, 0, 1, 0], 65534.0),
        (5, 0, &[-2_f64, 1.0, 7.0, 1.0].map(f64::to_le_bytes).concat(), -2.0),
    ];
    for (data_type, order, bytes, first) in cases {
        let extra = "wavelength = { 0.5,\n 0.6 }\ndata ignore value = 7\nband names = {red,\nblue}\n";
        scratch.write("x.hdr", header(data_type, order, extra));
        scratch.write("x.dat", [b"abc", bytes].concat());
        let (h, data) = envi::pair(&scratch.join("x.hdr")).unwrap();
        assert_eq!(envi::pair(&data).unwrap().0, h);
        let header = envi::read_header(&h).unwrap();
        assert_eq!((header.band_names.len(), header.wavelength.as_slice()), (2, [0.5, 0.6].as_slice()));
        let statistics = envi::statistics(&header, &data).unwrap();
        assert_eq!((statistics[0].count, statistics[0].min), (1, first), "data type {data_type}");
        assert_eq!((statistics[1].count, statistics[1].mean), (2, 1.0), "data type {data_type}");
    }
}

#[test]
fn damaged_envi_files_are_located() {
    let scratch = Scratch::new();
    let path = scratch.join("x.hdr");
    let good = "ENVI\nsamples = 2\nlines = 2\nbands = 2\ndata type = 4\ninterleave = bsq\nbyte order = 0\n";
    let cases = [
        ("ENVY\n", "x.hdr:1: an ENVI header begins"),
        ("ENVI\nsamples 2\n", "x.hdr:2: expected `key = value`"),
        ("ENVI\nsamples = 2\nband names = {a,\nb\n", "x.hdr:3 band names: the list that begins here"),
        (
            &good.replace("order = 0", "order = 2"),
            "x.hdr:7 byte order: 2 is neither 0, the least significant byte first, nor 1",
        ),
        ("ENVI\nsamples = -2\nbands = 2\ninterleave = bsr\n", "x.hdr:2 samples: \"-2\" is not a whole number from 1"),
        ("ENVI\nsamples = -2\nbands = 2\ninterleave = bsr\n", "x.hdr lines: is missing"),
        ("ENVI\nsamples = -2\nbands = 2\ninterleave = bsr\n", "x.hdr:4 interleave: \"bsr\" is not one of"),
        (
            &good.replace("type = 4", "type = 6"),
            "x.hdr:5 data type: ENVI data type 6 (complex numbers) is not supported",
        ),
        (&good.replace('2', "18446744073709551615"), "x.hdr:2 samples: samples x lines x bands is more"),
        (&format!("{good}wavelength = {{1, 2, 3}}\n"), "x.hdr:8 wavelength: 3 values for 2 bands"),
        (&format!("{good}wavelength = {{1, b}}\n"), "x.hdr:8 wavelength: has items that are not finite numbers"),
    ];
    for (text, expected) in cases {
        std::fs::write(&path, text).unwrap();
        let error = envi::read_header(&path).unwrap_err().to_string();
        assert!(error.contains(expected), "{error:?} does not say {expected:?}");
    }
    std::fs::write(&path, good.replace("lines = 2", "lines = 1000000000000")).unwrap();
    assert!(envi::pair(&path).unwrap_err().to_string().contains("data file is not beside it"));
    scratch.write("x.img", [0; 31]);
    let header = envi::read_header(&path).unwrap();
    assert!(envi::statistics(&header, &scratch.join("x.img")).unwrap_err().to_string().contains("31 bytes"));
    assert!(matches!(envi::read_header(&scratch.join("none.hdr")), Err(Error::Io { .. })));
}

#[test]
fn interruption_stops_a_cube() {
    let scratch = Scratch::new();
    let stop = |_| false;
    let path = scratch.join("cube.img");
    for interleave in [Interleave::Bsq, Interleave::Bip] {
        let result = envi::write_cube(&path, &small_cube(), interleave, Precision::F32, "", &stop);
        assert!(matches!(result, Err(Error::Interrupted)));
    }
    assert!(matches!(exr_cube::write(&path, &small_cube(), "", &stop), Err(Error::Interrupted)));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_an_error_that_names_the_file() {
    let scratch = Scratch::new();
    let path = scratch.join("x.img");
    std::os::unix::fs::symlink("/dev/full", &path).unwrap();
    let cube = random_cube(64, 64, 3, 2, 1);
    let planes = Backplanes {
        samples: 1,
        lines: 1,
        planes: vec![Plane { name: "X".into(), unit: "m".into(), values: vec![1.0] }],
    };
    let image = report_json::ImageEntry {
        quantity: "radiance".into(),
        unit: "W m-2 sr-1 um-1".into(),
        samples: 1,
        lines: 1,
        bands: 1,
        first_band_um: 1.0,
        last_band_um: 1.0,
        quicklook_band: 1,
        quicklook_rgb_bands: [1, 1, 1],
    };
    let results = [
        envi::write_cube(&path, &cube, Interleave::Bsq, Precision::F32, "", &unwatched),
        envi::write_cube(&path, &cube, Interleave::Bil, Precision::F32, "", &unwatched),
        envi::write_backplanes(&path, &planes, Precision::F32, ""),
        exr_cube::write(&path, &cube, "", &unwatched),
        npz::write_table(&path, &table(), "scene"),
        npz::write_footprints(&path, &Footprints { row_start: vec![0], ..Default::default() }, "scene"),
        quicklook::write_grey(&path, &shown(&cube), 0, &[1.0; 64 * 64], None),
        quicklook::write_colour(&path, &shown(&cube), [0, 1, 2], &[1.0; 64 * 64], None),
        report_json::write(&path, &image),
    ];
    for (i, result) in results.into_iter().enumerate() {
        match result {
            Err(Error::Io { path: at, source, .. }) => {
                assert_eq!(at, path);
                assert_eq!(source.kind(), std::io::ErrorKind::StorageFull, "writer {i}");
            }
            other => panic!("writer {i}: {other:?}"),
        }
    }
}

#[test]
fn open_exr_reads_back_in_the_order_of_wavelength() {
    use exr::prelude::*;
    let scratch = Scratch::new();
    let path = scratch.join("cube.exr");
    // Descending, and across the change from three to four digits of nm.
    let mut cube = random_cube(5, 19, 3, 4, 2);
    for (band, um) in cube.axes.bands.iter_mut().zip([1.05, 0.9999995, 0.45]) {
        band.centre_um = um;
    }
    exr_cube::write(&path, &cube, "what it is", &unwatched).unwrap();
    let image = read_first_flat_layer_from_file(&path).unwrap();
    let channels = &image.layer_data.channel_data.list;
    let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
    assert_eq!(names, ["S0.0450,000000nm", "S0.0999,999500nm", "S0.1050,000000nm"]);
    for (channel, band) in channels.iter().zip([2, 1, 0]) {
        let values: Vec<f32> = channel.sample_data.values_as_f32().collect();
        assert_eq!(values, cube.band(band).iter().map(|v| *v as f32).collect::<Vec<f32>>());
        assert_eq!(values.len(), 5 * 19);
    }
    let text = |name: &str| image.layer_data.attributes.other.get(&Text::from(name)).map(|v| format!("{v:?}"));
    assert!(text("spectralLayoutVersion").unwrap().contains("1.0"));
    assert!(text("emissiveUnits").unwrap().contains("W.m^-2.sr^-1"));
    assert!(text("radianceUnits").unwrap().contains("um^-1"));
    let info = exr_cube::read_info(&path).unwrap();
    assert_eq!((info.samples, info.lines, info.channels), (5, 19, names));
    assert!(info.attributes.contains(&("emissiveUnits".to_owned(), "W.m^-2.sr^-1".to_owned())));
    scratch.write("bad.exr", "v/1\x01");
    assert!(exr_cube::read_info(&scratch.join("bad.exr")).is_err());

    cube.axes.bands[1] = cube.axes.bands[0].clone();
    assert!(matches!(exr_cube::write(&path, &cube, "", &unwatched), Err(mmxrt::Error::Invalid(_))));
}

/// Four facets: dark, lit, and two lit in part.
fn table() -> FacetTable {
    let direction = |x, y, z| Direction::new(DVec3::new(x, y, z)).unwrap();
    let sunlit = Seen {
        shown: vec![Shown::Nothing, Shown::Whole, Shown::Part, Shown::Part],
        polygon_facet: vec![2, 2, 3],
        polygon_start: vec![0, 3, 7, 10],
        uv: (0..10).map(|i| [f64::from(i) / 9.0, -0.0]).collect(),
        polygon_share: vec![],
    };
    let lighting = |source: &str, field, irradiance: [f64; 4], sees| Lighting {
        source: source.into(),
        field,
        irradiance: irradiance.to_vec(),
        sees,
    };
    let mars_m = DVec3::new(0.3e6, -0.2e6, 9e6 + 0.1);
    FacetTable {
        sources: vec![
            lighting(
                "sun",
                DirectionField::Afar(direction(1.0, -2.0, 3.0)),
                [0.0, 1.0 / 3.0, 0.1, f64::MIN_POSITIVE],
                Sees::Polygons(sunlit.clone()),
            ),
            lighting("mars", DirectionField::Near(mars_m), [0.25, 0.0, 1e-300, 0.1 + 0.2], Sees::All),
            lighting(
                "lamp",
                DirectionField::Afar(direction(0.0, 0.6, 0.8)),
                [0.5, 0.0, 1.0, 0.1],
                Sees::Polygons(sunlit),
            ),
            lighting(
                "far-star",
                DirectionField::Afar(direction(1.0, 0.0, 0.0)),
                [0.1; 4],
                Sees::Shares(vec![0.0, 1.0, 0.25, 0.1]),
            ),
        ],
        temperature_lit_k: vec![300.1, 0.0, 1.0, 2.0],
        temperature_shaded_k: vec![100.1, 0.0, 1.0, 2.0],
        ..FacetTable::default()
    }
}

#[test]
fn facet_tables_come_back_bit_for_bit() {
    let scratch = Scratch::new();
    let path = scratch.join("table.npz");
    let sun = table().sources.remove(0);
    let bare = FacetTable {
        sources: vec![sun],
        temperature_lit_k: vec![],
        temperature_shaded_k: vec![],
        ..FacetTable::default()
    };
    for table in [table(), bare] {
        npz::write_table(&path, &table, "a scene \u{3bb}").unwrap();
        let (read, header) = npz::read_table(&path).unwrap();
        // Debug tells -0 from 0 and prints every bit of a number.
        assert_eq!(format!("{read:?}"), format!("{table:?}"));
        assert_eq!(header.scene, "a scene \u{3bb}");
        assert_eq!(header.fields["sun_irradiance"].unit, "1");
        assert_eq!((header.format_version, header.sources.len()), (2, table.sources.len()));
        let (header, arrays) = npz::list(&path).unwrap();
        assert_eq!(header.unwrap().fields.len(), arrays.len());
        let uv = arrays.iter().find(|a| a.name == "sun_polygon_uv").unwrap();
        assert_eq!((uv.descr.as_str(), uv.shape.as_slice()), ("<f8", [10, 2].as_slice()));
    }
}

/// The bytes of an array in a zip file, as NumPy's format 1.0 has them.
fn member(path: &Path, name: &str) -> Vec<u8> {
    let mut zip = zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap();
    let mut bytes = Vec::new();
    std::io::Read::read_to_end(&mut zip.by_name(name).unwrap(), &mut bytes).unwrap();
    bytes
}

/// Replaces that array.
fn replace_member(path: &Path, name: &str, bytes: &[u8]) {
    let mut old = zip::ZipArchive::new(std::io::Cursor::new(std::fs::read(path).unwrap())).unwrap();
    let mut new = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
    for i in 0..old.len() {
        let file = old.by_index_raw(i).unwrap();
        if file.name().unwrap() != name {
            new.raw_copy_file(file).unwrap();
        }
    }
    new.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
    std::io::Write::write_all(&mut new, bytes).unwrap();
    new.finish().unwrap();
}

#[test]
fn ends_of_64_bits_are_read_and_are_written_where_32_do_not_hold_them() {
    let scratch = Scratch::new();
    let path = scratch.join("table.npz");
    let name = "sun_polygon_start.npy";
    npz::write_table(&path, &table(), "s").unwrap();
    let (good, _) = npz::read_table(&path).unwrap();
    let short = member(&path, name);
    assert_eq!((&short[10..25], short.len()), (&b"{'descr': '<u4'"[..], 128 + 4 * 4));
    let mut long = short[..128].to_vec();
    long[22..24].copy_from_slice(b"u8");
    long.extend([0u64, 3, 7, 10].iter().flat_map(|end| end.to_le_bytes()));
    replace_member(&path, name, &long);
    assert_eq!(npz::read_table(&path).unwrap().0, good);

    // In 32 bits it would be the right end.
    let mut far = table();
    let Sees::Polygons(sunlit) = &mut far.sources[0].sees else { panic!() };
    sunlit.polygon_start[3] += 1 << 32;
    npz::write_table(&path, &far, "s").unwrap();
    let written = member(&path, name);
    assert_eq!(&written[10..25], b"{'descr': '<u8'");
    assert_eq!(written[128..], [0u64, 3, 7, (1 << 32) + 10].map(u64::to_le_bytes).concat());
    let error = npz::read_table(&path).unwrap_err().to_string();
    assert!(error.contains("sun_polygon_start: polygon starts are not an ascending list from 0"), "{error}");

    let footprints = Footprints { row_start: vec![0, 1 << 32], ..Footprints::default() };
    npz::write_footprints(&path, &footprints, "s").unwrap();
    let (_, arrays) = npz::list(&path).unwrap();
    assert_eq!((arrays[0].name.as_str(), arrays[0].descr.as_str()), ("row_start", "<u8"));
}

#[test]
fn facet_tables_are_stored_zips_of_numpy_arrays() {
    let scratch = Scratch::new();
    let path = scratch.join("table.npz");
    npz::write_table(&path, &table(), "s").unwrap();
    let bytes = std::fs::read(&path).unwrap();
    // Zip local header (APPNOTE 4.3.7): signature, method 0 at 8, lengths of name and extra field at 26, name at 30.
    assert_eq!((&bytes[..4], &bytes[8..10], &bytes[30..40]), (&b"PK\x03\x04"[..], &[0, 0][..], &b"header.npy"[..]));
    let find = |what: &[u8]| bytes.windows(what.len()).position(|w| w == what).unwrap();
    let member = find(b"sun_irradiance.npy");
    let start = member + 18 + usize::from(u16::from_le_bytes([bytes[member - 2], bytes[member - 1]]));
    // NumPy format 1.0: magic, version, length of the preamble; data after a multiple of 64 bytes.
    assert_eq!(bytes[start..start + 8], *b"\x93NUMPY\x01\x00");
    let length = usize::from(u16::from_le_bytes([bytes[start + 8], bytes[start + 9]]));
    let preamble = std::str::from_utf8(&bytes[start + 10..start + 10 + length]).unwrap();
    assert_eq!(preamble.trim_end(), "{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }");
    assert!(preamble.ends_with('\n') && (10 + length).is_multiple_of(64));
    assert_eq!(f64s(&bytes[start + 10 + length..][..32]), table().sources[0].irradiance);
}

#[test]
fn footprints_are_written() {
    let scratch = Scratch::new();
    let path = scratch.join("footprints.npz");
    let footprints = Footprints {
        row_start: vec![0, 2],
        facet: vec![4, 9],
        fraction: vec![0.25, 0.5],
        lit_fraction: vec![0.0, 0.5],
    };
    npz::write_footprints(&path, &footprints, "s").unwrap();
    let (header, arrays) = npz::list(&path).unwrap();
    assert_eq!(header.unwrap().format, "mmxrt footprints");
    let shapes: Vec<(&str, &[usize])> = arrays.iter().map(|a| (a.name.as_str(), a.shape.as_slice())).collect();
    assert_eq!(shapes, [("row_start", &[2][..]), ("facet", &[2]), ("fraction", &[2]), ("lit_fraction", &[2])]);
    let error = npz::read_table(&path).unwrap_err().to_string();
    assert!(error.contains("footprints.npz header: says \"mmxrt footprints\""), "{error}");
}

#[test]
fn damaged_tables_are_errors_never_other_numbers() {
    let scratch = Scratch::new();
    let path = scratch.join("table.npz");
    npz::write_table(&path, &table(), "s").unwrap();
    let (good, good_header) = npz::read_table(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let mut refused = 0;
    for i in (0..bytes.len()).step_by(3) {
        let mut damaged = bytes.clone();
        damaged[i] ^= 0x55;
        // Some disks are slow to replace what a file holds.
        std::fs::remove_file(&path).unwrap();
        std::fs::write(&path, &damaged).unwrap();
        match npz::read_table(&path) {
            Err(error) => {
                assert!(error.to_string().contains("table.npz"), "byte {i}: {error}");
                refused += 1;
            }
            // A byte that nobody needs: a date, a permission.
            Ok((table, header)) => assert_eq!((table, header), (good.clone(), good_header.clone()), "byte {i}"),
        }
        let _ = npz::list(&path);
    }
    assert!(refused > bytes.len() / 6, "{refused} of {} damaged bytes were noticed", bytes.len());
    for length in (0..bytes.len()).step_by(7) {
        std::fs::remove_file(&path).unwrap();
        std::fs::write(&path, &bytes[..length]).unwrap();
        assert!(npz::read_table(&path).is_err(), "cut to {length} bytes");
    }
}

#[test]
fn tables_that_do_not_fit_together_are_refused_with_all_that_is_wrong() {
    let scratch = Scratch::new();
    let path = scratch.join("table.npz");
    let mut bad = table();
    let [sun, mars, _, star] = &mut bad.sources[..] else { panic!() };
    sun.irradiance[1] = f64::NAN;
    mars.irradiance.pop();
    bad.temperature_lit_k[2] = -1.0;
    let Sees::Polygons(sunlit) = &mut sun.sees else { panic!() };
    sunlit.polygon_facet[0] = 0;
    star.sees = Sees::Shares(vec![0.5, 0.5, 1.5, 0.5]);
    npz::write_table(&path, &bad, "s").unwrap();
    let Err(Error::Invalid(problems)) = npz::read_table(&path) else { panic!("accepted") };
    let items: Vec<&str> = problems.iter().filter_map(|p| p.at.item.as_deref()).collect();
    assert_eq!(
        items,
        ["mars_irradiance", "sun_irradiance[1]", "temperature_lit_k[2]", "far-star_share[2]", "sun_polygon_start"]
    );
}

/// Kind, bytes and description of a PNG.
fn decode(path: &Path) -> (png::ColorType, Vec<u8>, String) {
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    let [text] = &reader.info().uncompressed_latin1_text[..] else { panic!("not one text") };
    assert_eq!(text.keyword, "Description");
    (reader.info().color_type, pixels, text.text.clone())
}

#[test]
fn quick_looks_are_pictures_of_the_cube_and_say_how_they_are_stretched() {
    let scratch = Scratch::new();
    let (grey, colour) = (scratch.join("grey.png"), scratch.join("colour.png"));
    let coverage = [1.0, 1.0, 0.5, 0.0];
    quicklook::write_grey(&grey, &shown(&small_cube()), 1, &coverage, None).unwrap();
    let (kind, pixels, text) = decode(&grey);
    assert_eq!((kind, pixels), (png::ColorType::Grayscale, vec![0, 128, 255, 0]));
    let [long, short] = ["3.6 um, black 1.0000e1, white 3.0000e1", "0.95 um, black 1.0000e0, white 3.0000e0"]
        .map(|text| format!("{text} W m-2 sr-1 um-1, power 1.000"));
    assert_eq!(text, long);
    quicklook::write_colour(&colour, &shown(&small_cube()), [1, 0, 0], &coverage, None).unwrap();
    assert_eq!([&grey, &colour].map(|p| quicklook::read_info(p).unwrap()), [(2, 2, false), (2, 2, true)]);
    assert!(matches!(quicklook::read_info(&scratch.join("none.png")), Err(Error::Io { .. })));
    let (kind, pixels, text) = decode(&colour);
    assert_eq!((kind, pixels), (png::ColorType::Rgb, vec![0, 0, 0, 128, 128, 128, 255, 255, 255, 0, 0, 0]));
    assert_eq!(text, format!("red: {long}; green: {short}; blue: {short}"));
}

#[test]
fn reports_come_back_and_their_errors_are_located() {
    let scratch = Scratch::new();
    let path = scratch.join("run.json");
    let run = report_json::Run {
        format_version: 1,
        mmxrt: "0.1.0".into(),
        command: "simulate".into(),
        date: "2026-11-22T03:04:05Z".into(),
        threads: 2,
        host_cores: 2,
        wall_s: 0.1 + 0.2,
        cpu_s: Some(0.5),
        stages: vec![report_json::Stage { name: "sunlight".into(), wall_s: 0.25, cpu_s: 0.4 }],
        costs: vec![],
        files: std::collections::BTreeMap::new(),
    };
    report_json::write(&path, &run).unwrap();
    assert_eq!(report_json::read::<report_json::Run>(&path).unwrap(), run);
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("\"threads\": 2", "\"threads\": \"two\"")).unwrap();
    let error = report_json::read::<report_json::Run>(&path).unwrap_err().to_string();
    assert!(error.contains("run.json:6:") && error.contains("expected u64"), "{error}");
    assert!(!error.contains("at line"), "{error}");
}

#[test]
fn arrays_that_are_the_same_bytes_over_and_over_are_refused() {
    let scratch = Scratch::new();
    let path = scratch.join("table.npz");
    let mut table = table();
    table.sources.truncate(2);
    table.sources[0].irradiance = vec![0.5; 1000];
    let all = Seen { shown: vec![Shown::Whole; 1000], polygon_start: vec![0], ..Default::default() };
    table.sources[0].sees = Sees::Polygons(all);
    npz::write_table(&path, &table, "s").unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let u16_at = |bytes: &[u8], at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let end = bytes.len() - 22;
    let directory = u16_at(&bytes, end + 16) + (u16_at(&bytes, end + 18) << 16);
    let mut entries = vec![directory];
    for i in 1..u16_at(&bytes, end + 10) {
        let at = entries[i - 1];
        entries.push(at + 46 + u16_at(&bytes, at + 28) + u16_at(&bytes, at + 30) + u16_at(&bytes, at + 32));
    }
    // Sum, sizes and offset of all members become those of the largest.
    let largest = entries.iter().copied().max_by_key(|at| u16_at(&bytes, at + 24)).unwrap();
    for at in entries {
        bytes.copy_within(largest + 16..largest + 28, at + 16);
        bytes.copy_within(largest + 42..largest + 46, at + 42);
    }
    std::fs::write(&path, &bytes).unwrap();
    let error = npz::list(&path).unwrap_err().to_string();
    assert!(error.contains("claims 8128 bytes, and with the arrays before it"), "{error}");
}
