//! Any bytes are one of the products that are read back, or an error. The first byte says which.
//!
//! An `.npz` is also made of arrays, pieces of `files`, so that its sums are right whatever the arrays hold.
#![no_main]

use std::io::{Cursor, Write};
use std::path::PathBuf;
use std::sync::LazyLock;

use files::told;
use libfuzzer_sys::fuzz_target;
use mmxrt::formats::report_json::{ProductReport, Run};
use mmxrt::formats::{exr_cube, npz, quicklook, report_json};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

mod files;

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| files::scratch("products"));

/// Arrays of a facet table.
const NAMES: [&str; 12] = [
    "header",
    "sun_direction",
    "sun_irradiance",
    "sun_lit",
    "sun_polygon_facet",
    "sun_polygon_start",
    "sun_polygon_uv",
    "mars_direction",
    "mars_irradiance",
    "mars_position_m",
    "temperature_lit_k",
    "temperature_shaded_k",
];

fuzz_target!(|data: &[u8]| {
    let Some((which, bytes)) = data.split_first() else { return };
    let path = FOLDER.join("fuzz");
    let write = |bytes: &[u8]| std::fs::write(&path, bytes).unwrap();
    match which % 6 {
        0 => {
            write(&archive(bytes, CompressionMethod::Stored));
            tables(&path);
        }
        1 => {
            write(bytes);
            tables(&path);
        }
        2 => {
            write(bytes);
            told(quicklook::read_info(&path));
        }
        3 => {
            write(bytes);
            told(exr_cube::read_info(&path));
        }
        4 => {
            write(bytes);
            told(report_json::read::<serde_json::Value>(&path));
            told(report_json::read::<ProductReport>(&path));
            told(report_json::read::<Run>(&path));
        }
        _ => {
            write(&archive(bytes, CompressionMethod::Deflated));
            tables(&path);
        }
    }
});

fn tables(path: &PathBuf) {
    told(npz::list(path));
    if let Some((table, header)) = told(npz::read_table(path)) {
        npz::write_table(path, &table, &header.scene).unwrap();
        assert_eq!(npz::read_table(path).unwrap().0, table);
    }
}

fn archive(data: &[u8], method: CompressionMethod) -> Vec<u8> {
    let options = SimpleFileOptions::default().compression_method(method);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (which, array) in files::pieces(data) {
        // An array that is there already is refused.
        if zip.start_file(format!("{}.npy", NAMES[which % NAMES.len()]), options).is_ok() {
            zip.write_all(array).unwrap();
        }
    }
    zip.finish().unwrap().into_inner()
}
