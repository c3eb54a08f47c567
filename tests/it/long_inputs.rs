//! Inputs of a megabyte or two that cost far more than their length would, if anything in them were looked at as often as there are others.
//!
//! Each is read in a second or two; where the cost goes with the square of the length, it is minutes, or memory that no machine has.

use std::path::Path;
use std::time::{Duration, Instant};

use mmxrt::formats::{envi, gltf, mtl, obj, registry, response_csv, spectrum_csv};

use crate::scratch::Scratch;

/// What a reader makes of something, in time.
fn soon<T>(read: impl FnOnce() -> T) -> T {
    let began = Instant::now();
    let read = read();
    assert!(began.elapsed() < Duration::from_secs(40), "{:?}", began.elapsed());
    read
}

const ENVI: &str = "ENVI\nsamples = 1\nlines = 1\nbands = 1\ndata type = 4\n";

#[test]
fn braces_in_a_text_of_an_envi_header() {
    let text = format!("{ENVI}description = {{{}\n}}\n", "}x".repeat(1_000_000));
    let header = soon(|| envi::parse_header(Path::new("a.hdr"), &text)).unwrap();
    assert_eq!(header.field("description").map(str::len), Some(2_000_000));
    // The end of a list is still found behind them.
    let text = format!("{ENVI}band names = {{a }} b}} c}} fwhm = {{0.5}}\n");
    let header = envi::parse_header(Path::new("a.hdr"), &text).unwrap();
    assert_eq!((header.band_names.as_slice(), header.fwhm.as_slice()), (&["a } b} c".to_owned()][..], &[0.5][..]));
}

#[test]
fn a_text_that_stands_where_a_band_has_its_name() {
    let scratch = Scratch::new();
    let image = scratch.write("a.img", [0; 4]);
    for name in ["500nm.".repeat(100_000) + "500nm", "1.".repeat(1_000_000) + "1nm"] {
        scratch.write("a.hdr", format!("{ENVI}band names = {{{name}}}\n"));
        let raster = soon(|| registry::image(&image)).unwrap();
        assert_eq!((raster.bands[0].name.len(), raster.bands[0].centre_um), (name.len(), None));
    }
}

#[test]
fn a_spectrum_whose_last_row_is_a_gap() {
    let rows: String = (0..100_000).map(|i| format!("{},0.1,0.2\n", 500 + i)).collect();
    let text = format!("wavelength_nm,reflectance,emissivity\n{rows}100500,0.1,\n");
    let (_, report) = soon(|| spectrum_csv::parse_all(&text, Path::new("a.csv"), None)).unwrap();
    assert!(report.notes[0].message.contains("1 rows have no value, the first at 100.5 um"), "{report:?}");
}

#[test]
fn a_hundred_thousand_columns() {
    let names: Vec<String> = (0..100_000).map(|i| format!("m{i}")).collect();
    let row = |first: &str, cell: &str| format!("{first}{}\n", format!(",{cell}").repeat(names.len()));
    let (header, first) = (format!("wavelength_um,{}\n", names.join(",")), row("0.5", "0.25"));
    let text = header.clone() + &first + &row("0.6", "");
    let (libraries, report) = soon(|| spectrum_csv::parse_all(&text, Path::new("a.csv"), None)).unwrap();
    assert_eq!((libraries.len(), report.notes.len()), (100_000, 100_000));
    // "wavelength_um," and ten names of two, ninety of three letters with their commas, then `m100`.
    let at = &report.notes[100].at;
    assert_eq!((at.line, at.column, at.span), (Some(1), Some(405), Some((404, 408))));
    let text = header + &first + &row("0.6", "0.5");
    let responses = soon(|| response_csv::parse(&text, Path::new("a.csv"))).unwrap();
    assert_eq!(responses.columns.len(), 100_000);
}

#[test]
fn a_hundred_thousand_materials_that_lose_something() {
    let text: String = (0..100_000).map(|i| format!("newmtl a{i}\nTr 1\nKe 1 1 1\nTr 0.5\n")).collect();
    let file = soon(|| mtl::parse_all(text.as_bytes(), Path::new("a.mtl"))).unwrap();
    assert_eq!((file.materials.len(), file.losses.len()), (100_000, 200_000));
}

#[test]
fn a_library_that_is_named_before_every_object_is_read_once() {
    let text = "mtllib a.mtl\n".repeat(1000) + "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib b.mtl\nusemtl b\nf 1 2 3\n";
    let mut loaded = Vec::new();
    let file = obj::parse(&mut text.as_bytes(), Path::new("a.obj"), &mut |name| {
        loaded.push(name.to_owned());
        mtl::parse(b"newmtl b\nKd 0.5 0.25 0.125\n", Path::new(name))
    });
    assert_eq!(file.unwrap().materials[0].kd, Some([0.5, 0.25, 0.125]));
    assert_eq!(loaded, ["a.mtl", "b.mtl"]);
}

/// A triangle of glTF, a strip of `count` corners that are all the same, and more nodes and other parts.
fn gltf(count: usize, more: &str, nodes: &str) -> Vec<u8> {
    let corners: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let binary: Vec<u8> =
        corners.iter().flat_map(|x| x.to_le_bytes()).chain(vec![0; count.next_multiple_of(4)]).collect();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},{more}"nodes":[{{"mesh":0}}{nodes}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}},
        {{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":5}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,
        "type":"VEC3"}},{{"bufferView":1,"componentType":5121,"count":{count},"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":36}},
        {{"buffer":0,"byteOffset":36,"byteLength":{count}}}],"buffers":[{{"byteLength":{}}}]}}"#,
        binary.len()
    );
    let mut glb =
        [b"glTF".as_slice(), &2_u32.to_le_bytes(), &(28 + json.len() as u32 + binary.len() as u32).to_le_bytes()]
            .concat();
    for (kind, chunk) in [(b"JSON", json.as_bytes()), (b"BIN\0", &binary)] {
        glb.extend([&(chunk.len() as u32).to_le_bytes()[..], kind, chunk].concat());
    }
    glb
}

#[test]
fn thousands_of_nodes_with_one_mesh_and_of_lamps() {
    let path = Path::new("a.glb");
    let instances = r#",{"mesh":1}"#.repeat(2000);
    let (surface, report, _) = soon(|| gltf::parse(&gltf(200_000, "", &instances), path, false)).unwrap();
    assert_eq!((surface.mesh.facets.len(), surface.mesh.vertices_m.len()), (1, 3 * 2001));
    assert!(report.notes.iter().any(|note| note.message.contains("2001 objects")), "{report:?}");
    let lights = [r#"{"type":"point"}"#; 5000].join(",");
    let lights = format!(r#""extensions":{{"KHR_lights_punctual":{{"lights":[{lights}]}}}},"#);
    let nodes: String =
        (0..5000).map(|i| format!(r#",{{"extensions":{{"KHR_lights_punctual":{{"light":{i}}}}}}}"#)).collect();
    let (surface, report, _) = soon(|| gltf::parse(&gltf(4, &lights, &nodes), path, false)).unwrap();
    assert_eq!((surface.mesh.facets.len(), surface.sun), (1, None));
    assert_eq!(report.notes.iter().filter(|note| note.message.contains("only the Sun and Mars")).count(), 5000);
}

/// A tiled OpenEXR file of one tile, 1 x 2^29 pixels, for an image of one pixel.
fn tall() -> Vec<u8> {
    let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 2, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        let length = (value.len() as i32).to_le_bytes();
        bytes.extend([name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &length, value].concat());
    };
    let numbers = |all: &[i32]| all.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    let channel = |i: i32| [format!("c{i:03}\0").into_bytes(), numbers(&[2, 0, 1, 1])].concat();
    let channels: Vec<u8> = (0..500).flat_map(channel).chain([0]).collect();
    let last = (1 << 29) - 1;
    attribute("channels", "chlist", &channels);
    attribute("compression", "compression", &[3]);
    attribute("dataWindow", "box2i", &numbers(&[0, 0, 0, last]));
    attribute("displayWindow", "box2i", &numbers(&[0; 4]));
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    attribute("tiles", "tiledesc", &[numbers(&[1, last + 1]), vec![0]].concat());
    bytes.push(0);
    let start = bytes.len() as u64 + 8;
    bytes.extend(start.to_le_bytes());
    bytes.extend([numbers(&[0, 0, 0, 0, 4]), vec![0; 4]].concat());
    bytes
}

#[test]
fn an_image_of_one_pixel_in_a_tile_as_tall_as_a_mountain() {
    let scratch = Scratch::new();
    let path = scratch.write("a.exr", tall());
    let mut raster = registry::image(&path).unwrap();
    assert_eq!((raster.rows, raster.columns, raster.bands.len()), (1, 1, 500));
    let error = soon(|| raster.read(0, &mut Vec::new())).unwrap_err().to_string();
    assert!(error.contains("a.exr"), "{error}");
}

#[test]
fn a_photograph_of_a_few_bytes_holds_no_image_of_gigabytes() {
    let scratch = Scratch::new();
    let mut bytes = std::fs::read("tests/data/pictures/two_greys.jpg").unwrap();
    // Of the frame's header: a marker, a length of two bytes, a number of bits, then lines and columns.
    let frame = bytes.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    bytes[frame + 5..frame + 9].copy_from_slice(&[0x3f, 0xff, 0x3f, 0xff]);
    let error = registry::image(&scratch.write("a.jpg", &bytes)).unwrap_err().to_string();
    assert!(error.contains("163 bytes cannot hold 16383 x 16383 pixels"), "{error}");
}

/// A `.npy` file of bytes, all 0.
fn zeros(shape: &str, bytes: usize) -> Vec<u8> {
    let mut text = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': {shape}, }}").into_bytes();
    text.resize(117, b' ');
    text.push(b'\n');
    [b"\x93NUMPY\x01\x00".as_slice(), &118_u16.to_le_bytes(), &text, &vec![0; bytes]].concat()
}

#[test]
fn a_million_wavelengths_are_not_a_million_bands() {
    let scratch = Scratch::new();
    let path = scratch.join("a.npz");
    let mut archive = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
    for (name, shape) in [("raster.npy", "(1000000, 1, 2)"), ("wavelength_um.npy", "(1000000,)")] {
        let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
        archive.start_file(name, options).unwrap();
        std::io::Write::write_all(
            &mut archive,
            &zeros(shape, if name == "raster.npy" { 2_000_000 } else { 1_000_000 }),
        )
        .unwrap();
    }
    archive.finish().unwrap();
    assert!(std::fs::metadata(&path).unwrap().len() < 10_000);
    let error = registry::image(&path).unwrap_err().to_string();
    assert!(error.contains("1000000 bands are more than the 65536 that are read"), "{error}");
}
