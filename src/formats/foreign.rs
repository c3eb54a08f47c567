//! Image formats that are not read: each is recognised by how its files begin, and the error gives the command that converts it.

use std::path::Path;

use crate::error::{Error, Location};

/// What a file is, if it is of one of them.
///
/// Sources: the magic numbers in the formats' own specifications.
pub(super) fn named(beginning: &[u8]) -> Option<&'static str> {
    let is = |bytes: &[u8]| beginning.starts_with(bytes);
    let at = |offset: usize, bytes: &[u8]| beginning.get(offset..).is_some_and(|rest| rest.starts_with(bytes));
    // Labels are text.
    let text = String::from_utf8_lossy(&beginning[..beginning.len().min(1024)]);
    Some(match () {
        () if is(&[0x0e, 0x03, 0x13, 0x01]) => "HDF4",
        () if is(b"\0\0\0\x0cjP  ") || is(&[0xff, 0x4f, 0xff, 0x51]) => "JPEG 2000",
        () if is(b"\0\0\0\x0cJXL ") || is(&[0xff, 0x0a]) => "JPEG XL",
        () if is(b"EHFA_HEADER_TAG") => "ERDAS Imagine (HFA)",
        () if is(b"LBLSIZE=") => "VICAR",
        () if is(b"NITF") || is(b"NSIF") => "NITF",
        () if is(b"GRIB") => "GRIB",
        () if is(b"RIFF") && at(8, b"WEBP") => "WebP",
        () if is(b"GIF87a") || is(b"GIF89a") => "GIF",
        () if is(b"BM") && at(6, &[0; 4]) => "BMP",
        () if is(b"8BPS") => "Photoshop (PSD)",
        () if is(b"DDS ") => "DDS",
        () if is(b"\xabKTX ") => "KTX",
        () if at(4, b"ftypheic") || at(4, b"ftypavif") || at(4, b"ftypmif1") => "HEIF or AVIF",
        () if is(b"#?RADIANCE") || is(b"#?RGBE") => "Radiance HDR",
        () if is(b"PF\n") || is(b"Pf\n") => "PFM",
        () if ["P1", "P4", "P7"]
            .iter()
            .any(|p| text.starts_with(&format!("{p}\n")) || text.starts_with(&format!("{p} "))) =>
        {
            "PBM or PAM"
        }
        () if is(b"MATLAB 5.0 MAT-file") => "a MATLAB file",
        () if is(b"DSAA") || is(b"DSBB") || is(b"DSRB") => "a Surfer grid",
        () => return None,
    })
}

/// That a file is of a format that is not read, and the line that makes one that is; `None` if it is none of those.
pub(super) fn refused(path: &Path, beginning: &[u8]) -> Option<Error> {
    let name = named(beginning)?;
    let from = path.file_name().unwrap_or_default().to_string_lossy();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let with_gdal = format!("`gdal_translate -of ENVI {from} {stem}_envi.img`");
    let line = match name {
        "Radiance HDR" => format!("`oiiotool {from} -o {stem}.exr`"),
        "Photoshop (PSD)" | "DDS" | "KTX" | "HEIF or AVIF" | "JPEG XL" | "WebP" | "GIF" | "BMP" | "PBM or PAM" => {
            format!("`magick {from} {stem}.png`, or {with_gdal}")
        }
        "PFM" => format!("`oiiotool {from} -o {stem}.exr`"),
        "a MATLAB file" => "in Python: `numpy.save(OUT, scipy.io.loadmat(IN)[NAME])`".into(),
        "HDF4" => {
            format!("`gdalinfo {from}` lists what is in it; then `gdal_translate -of ENVI` with the name of one")
        }
        _ => with_gdal,
    };
    Some(Error::Unsupported { at: Location::file(path), feature: format!("{name} ({line} makes a file that is read)") })
}

/// How names of meshes end that are not read.
pub(super) const MESHES: [&str; 2] = ["fbx", "dae"];
/// How names of images end that begin with a mark and are not read.
pub(super) const ENDINGS: [&str; 6] = ["gif", "bmp", "webp", "jp2", "hdf", "heic"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_how_they_begin() {
        for (bytes, name) in [
            (&b"\x0e\x03\x13\x01\0"[..], "HDF4"),
            (b"\0\0\0\x0cjP  \r\n\x87\n", "JPEG 2000"),
            (b"EHFA_HEADER_TAG\0", "ERDAS Imagine (HFA)"),
            (b"RIFF\x10\0\0\0WEBPVP8 ", "WebP"),
            (b"BM\x36\0\0\0\0\0\0\0\x36\0\0\0", "BMP"),
            (b"#?RADIANCE\n", "Radiance HDR"),
            (b"P4\n2 2\n", "PBM or PAM"),
        ] {
            assert_eq!(named(bytes), Some(name));
            let error = refused(Path::new("a b/c.x"), bytes).unwrap().to_string();
            assert!(error.contains(name) && error.contains('`'), "{error}");
        }
        for bytes in [&b""[..], b"ENVI\n", b"BMW,1,2", b"v 1 2 3\n", b"\x89PNG", b"P1,2"] {
            assert_eq!(named(bytes), None);
        }
    }
}
