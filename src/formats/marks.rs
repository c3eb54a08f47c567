//! How binary files begin: for their readers, and for the message about a file that is something else.

use super::foreign;

pub(super) const PNG: &[u8] = b"\x89PNG";
pub(super) const JPEG: &[u8] = &[0xff, 0xd8, 0xff];
pub(super) const OPEN_EXR: &[u8] = &[0x76, 0x2f, 0x31, 0x01];
pub(super) const NUMPY: &[u8] = b"\x93NUMPY";
pub(super) const ZIP: &[u8] = b"PK";
pub(super) const SQLITE: &[u8] = b"SQLite format 3\0";
pub(super) const GLB: &[u8] = b"glTF";

/// How names of images end that are read and begin in one of several ways.
pub(super) const ENDINGS: [&str; 11] = ["tif", "tiff", "pgm", "ppm", "pnm", "cub", "nc", "nc4", "cdf", "h5", "hdf5"];

/// What a file is that begins so, whether it is read or not.
pub(super) fn named(beginning: &[u8]) -> Option<&'static str> {
    let begins: [(&[u8], &str); 24] = [
        (PNG, "PNG"),
        (JPEG, "JPEG"),
        (OPEN_EXR, "OpenEXR"),
        (NUMPY, "NumPy"),
        (b"PK\x03\x04", "a Zip archive, as .npz, .xlsx and .ods are"),
        (b"\x1f\x8b", "compressed by gzip"),
        (b"%PDF", "PDF"),
        (SQLITE, "an SQLite database"),
        (b"II*\0", "TIFF"),
        (b"MM\0*", "TIFF"),
        (b"II+\0", "TIFF"),
        (b"MM\0+", "TIFF"),
        (b"P2\n", "PGM"),
        (b"P5\n", "PGM"),
        (b"P3\n", "PPM"),
        (b"P6\n", "PPM"),
        (GLB, "glTF"),
        (b"\x89HDF\r\n\x1a\n", "HDF5 (NetCDF-4)"),
        (b"CDF\x01", "NetCDF"),
        (b"CDF\x02", "NetCDF"),
        (b"CDF\x05", "NetCDF"),
        (b"SIMPLE  =", "FITS"),
        (&[0xff, 0xfe], "text in UTF-16"),
        (&[0xfe, 0xff], "text in UTF-16"),
    ];
    let ours = begins.iter().find(|(bytes, _)| beginning.starts_with(bytes)).map(|(_, name)| *name);
    ours.or_else(|| foreign::named(beginning))
}

/// Bytes that are not text, in words.
pub(super) fn not_text(beginning: &[u8]) -> String {
    match named(beginning) {
        Some("text in UTF-16") => "damaged text in UTF-16: save the file as UTF-8".into(),
        Some(name) => format!("is {name}, but text is needed"),
        None if beginning.contains(&0) => "is not text, but text is needed".into(),
        None => "not UTF-8 text: save the file as UTF-8".into(),
    }
}
