//! PNG: grey or colours as shares of the largest number, as they are stored; no gamma is undone. What is transparent means no data.

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

use png::{BitDepth, ColorType, Transformations};

use crate::error::{Error, Location, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::marks;
use crate::formats::number::DataType;
use crate::report::Fate;

use super::mask::Alpha;
use super::{BandReader, Raster, RasterBand, check_size, resize};
use crate::formats::input;

/// A picture.
pub(in crate::formats) static PNG: Format = Format {
    name: "png",
    extensions: &["png"],
    reads: "grey or colours, 0 to 1; transparent means no data",
    writes: "",
    mark: marks::PNG,
    told: None,
    holds: Holds::Image {
        kind: "picture",
        open,
        target: Err("`mmxrt inspect FILE --picture OUT.png` makes one to look at"),
    },
};

/// Opens a picture.
pub(super) fn open(path: &Path) -> Result<Raster> {
    let reader = decoder(path)?;
    let (rows, columns) = (reader.info().height as usize, reader.info().width as usize);
    let (colour, _) = reader.output_color_type();
    let names: &[&str] = match colour {
        ColorType::Grayscale | ColorType::GrayscaleAlpha => &["grey"],
        _ => &["red", "green", "blue"],
    };
    check_size(Location::file(path), rows, columns, names.len())?;
    let bands = names.iter().map(|name| RasterBand { name: (*name).to_owned(), ..RasterBand::default() }).collect();
    let has_alpha = matches!(colour, ColorType::GrayscaleAlpha | ColorType::Rgba);
    let reader_of = BandReader::Png { samples: colour.samples() };
    let mut raster = Raster::of(path, (rows, columns), bands, DataType::F64, reader_of);
    raster.alpha = has_alpha.then_some(Alpha { band: names.len(), whole: 1.0, is_multiplied: false });
    // Fewer bits are spread over eight by then.
    raster.full_scale = Some(if reader.output_color_type().1 == BitDepth::Sixteen { 65535.0 } else { 255.0 });
    let message = "values: shares of the largest number, as stored";
    raster.report.note(Fate::Defaulted, Location::file(path), message);
    Ok(raster)
}

fn decoder(path: &Path) -> Result<png::Reader<BufReader<File>>> {
    let file = input::open(path).map_err(|e| Error::io(path, "reading", e))?;
    let mut decoder = png::Decoder::new(BufReader::new(file));
    // Palettes become colours, and what is said to be transparent becomes alpha.
    decoder.set_transformations(Transformations::EXPAND);
    decoder.read_info().map_err(|e| failed(path, e))
}

fn failed(path: &Path, error: png::DecodingError) -> Error {
    match error {
        png::DecodingError::IoError(e) if e.kind() != std::io::ErrorKind::UnexpectedEof => {
            Error::io(path, "reading", e)
        }
        e => Error::syntax(Location::file(path), format!("not a complete PNG: {e}")),
    }
}

/// Reads some bands, [band, row, column].
pub(super) fn read(path: &Path, bands: Range<usize>, values: &mut [f64]) -> Result<()> {
    let mut reader = decoder(path)?;
    let (colour, depth) = reader.output_color_type();
    let samples = colour.samples();
    let (width, largest) = if depth == BitDepth::Sixteen { (DataType::U16, 65535.0) } else { (DataType::U8, 255.0) };
    let pixels = values.len() / bands.len().max(1);
    let mut bytes = Vec::new();
    let size = pixels * samples * width.bytes();
    bytes.try_reserve_exact(size).map_err(|e| Error::io(path, "reading", e.into()))?;
    bytes.resize(size, 0);
    reader.next_frame(&mut bytes).map_err(|e| failed(path, e))?;
    let mut pixel = Vec::new();
    resize(&mut pixel, samples, path)?;
    for (i, stored) in bytes.chunks_exact(samples * width.bytes()).enumerate() {
        width.decode(true, stored, &mut pixel);
        for (band, values) in bands.clone().zip(values.chunks_exact_mut(pixels)) {
            values[i] = pixel[band] / largest;
        }
    }
    Ok(())
}
