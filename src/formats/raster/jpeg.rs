//! JPEG: grey or colours as shares of 255, as they are stored; no gamma is undone.

use std::path::Path;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::error::{Error, Location, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::input;
use crate::formats::marks;
use crate::formats::number::DataType;
use crate::report::Fate;

use super::{BandReader, MOST_PIXELS, Raster, RasterBand, check_size, resize};

/// A photograph.
pub(in crate::formats) static JPEG: Format = Format {
    name: "jpeg",
    extensions: &["jpg", "jpeg"],
    reads: "grey or colours, 0 to 1",
    writes: "",
    mark: marks::JPEG,
    told: None,
    holds: Holds::Image {
        kind: "picture",
        open,
        target: Err("`mmxrt inspect FILE --picture OUT.png` makes one to look at"),
    },
};

/// Longer files are refused, bytes.
const LIMIT: u64 = 1 << 30;
/// A byte stands for no more pixels: a block takes a bit at least, and in the thinnest of samplings, four blocks of one colour in a row and
/// four of another in a column, eight blocks are 32 x 32 pixels.
const MOST_COMPRESSED: u64 = 32 * 32;

/// Opens a photograph. Its blocks hold all colours: it is decoded here, once.
pub(super) fn open(path: &Path) -> Result<Raster> {
    let bytes = input::bytes(path, LIMIT)?;
    let at = || Location::file(path);
    let damaged = |e: zune_jpeg::errors::DecodeErrors| Error::syntax(at(), format!("not a complete JPEG: {e:?}"));
    let most = usize::try_from(MOST_PIXELS).unwrap_or(usize::MAX);
    // What is cut short would have grey where nothing is known: an end must follow the last begin of a scan. Neither occurs in its numbers.
    let last = |mark: u8| bytes.windows(2).rposition(|pair| pair == [0xff, mark]);
    let (scan, end) = (last(0xda), last(0xd9));
    if scan.is_none() || end < scan {
        return Err(Error::syntax(at(), "not a complete JPEG: it is cut short"));
    }
    let options = DecoderOptions::default().set_strict_mode(true).set_max_width(most).set_max_height(most);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(&bytes), options);
    decoder.decode_headers().map_err(damaged)?;
    let unknown = || Error::syntax(at(), "not a complete JPEG: without a size");
    let (columns, rows) = decoder.dimensions().ok_or_else(unknown)?;
    let (space, names): (ColorSpace, &[&str]) = match decoder.input_colorspace().ok_or_else(unknown)? {
        ColorSpace::Luma => (ColorSpace::Luma, &["grey"]),
        ColorSpace::YCbCr | ColorSpace::RGB => (ColorSpace::RGB, &["red", "green", "blue"]),
        other => {
            let feature =
                format!("JPEG in the colours of print, {other:?} (`magick IN OUT.png` makes a picture that is read)");
            return Err(Error::Unsupported { at: at(), feature });
        }
    };
    check_size(at(), rows, columns, names.len())?;
    if (rows * columns) as u64 > MOST_COMPRESSED * bytes.len() as u64 {
        let message = format!("not a complete JPEG: {} bytes cannot hold {columns} x {rows} pixels", bytes.len());
        return Err(Error::syntax(at(), message));
    }
    decoder.set_options(options.jpeg_set_out_colorspace(space));
    let stored = decoder.decode().map_err(damaged)?;
    let orientation = decoder.exif().and_then(|exif| orientation(exif)).unwrap_or(1);
    let pixels = rows * columns;
    if stored.len() != pixels * names.len() {
        return Err(Error::syntax(at(), "not a complete JPEG"));
    }
    let mut values = Vec::new();
    resize(&mut values, stored.len(), path)?;
    for (band, plane) in values.chunks_exact_mut(pixels).enumerate() {
        plane.iter_mut().zip(stored[band..].iter().step_by(names.len())).for_each(|(v, s)| *v = f64::from(*s) / 255.0);
    }
    let bands = names.iter().map(|name| RasterBand { name: (*name).to_owned(), ..RasterBand::default() }).collect();
    let mut raster = Raster::of(path, (rows, columns), bands, DataType::F64, BandReader::Held(values));
    raster.full_scale = Some(255.0);
    raster.report.note(Fate::Defaulted, at(), "values: shares of the largest number, as stored");
    if orientation != 1 {
        let message = format!(
            "orientation {orientation} of EXIF, by which viewers turn the picture: lines and columns are those of the file \
             (`magick IN -auto-orient OUT.png` turns them)"
        );
        raster.report.note(Fate::Dropped, at().with_item("orientation"), message);
    }
    Ok(raster)
}

/// The tag 0x0112 of an EXIF block, a TIFF file (TIFF 6.0, section 2; 1 is as stored).
fn orientation(exif: &[u8]) -> Option<u16> {
    let exif = exif.strip_prefix(b"Exif\0\0").unwrap_or(exif);
    let is_big = match exif.get(..2)? {
        b"MM" => true,
        b"II" => false,
        _ => return None,
    };
    let u16_at = |at: usize| {
        let bytes: [u8; 2] = exif.get(at..at.checked_add(2)?)?.try_into().ok()?;
        Some(if is_big { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
    };
    let u32_at = |at: usize| {
        let bytes: [u8; 4] = exif.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(if is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    };
    let first = u32_at(4)? as usize;
    let entries = usize::from(u16_at(first)?);
    let entry = |i: usize| first.checked_add(2 + 12 * i);
    let place = (0..entries).filter_map(entry).find(|at| u16_at(*at) == Some(0x0112))?;
    u16_at(place.checked_add(8)?)
}
