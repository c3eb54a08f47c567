//! PGM and PPM, of 8 or 16 bits, as text or not: grey or colours as shares of the largest number, as in PNG.
//!
//! Source: the formats' descriptions by netpbm, pgm(5) and ppm(5).

use std::path::Path;

use crate::error::{Error, Location, Result};
use crate::formats::envi::Scale;
use crate::formats::flat::{AxisOrder, Flat};
use crate::formats::format::{Format, Holds};
use crate::formats::input;
use crate::formats::number::DataType;
use crate::report::Fate;

use super::{BandReader, Raster, RasterBand, check_length, check_size, resize};

/// A picture.
pub(in crate::formats) static PNM: Format = Format {
    name: "pnm",
    extensions: &["pgm", "ppm", "pnm"],
    reads: "PGM and PPM: grey or colours, 0 to 1",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| kind(beginning).map(|_| path.to_owned())),
    holds: Holds::Image {
        kind: "picture",
        open,
        target: Err("`mmxrt inspect FILE --picture OUT.png` makes one to look at"),
    },
};

/// Heads end before this, bytes: a comment or two.
const HEAD: usize = 1 << 16;
/// Longer texts are refused, bytes.
const LIMIT: u64 = 8 << 30;

/// Number of colours, and whether the numbers are text.
fn kind(beginning: &[u8]) -> Option<(usize, bool)> {
    let is_parted = beginning.get(2).is_some_and(u8::is_ascii_whitespace);
    match beginning.get(..2).filter(|_| is_parted)? {
        b"P2" => Some((1, true)),
        b"P3" => Some((3, true)),
        b"P5" => Some((1, false)),
        b"P6" => Some((3, false)),
        _ => None,
    }
}

/// Opens a picture.
fn open(path: &Path) -> Result<Raster> {
    let head = input::beginning(path, HEAD)?;
    let at = || Location::file(path);
    let broken = |what: &str| Error::syntax(at(), format!("not a complete PGM or PPM: {what}"));
    let (colours, is_text) = kind(&head).ok_or_else(|| broken("it does not begin with P2, P3, P5 or P6"))?;
    let mut words = Words { bytes: &head, at: 2 };
    let mut count = |what: &str| words.next().and_then(|word| word.parse().ok()).ok_or_else(|| broken(what));
    let (columns, rows): (usize, usize) = (count("its width is missing")?, count("its height is missing")?);
    let largest = count("its largest number is missing")?;
    if !(1..=65535).contains(&largest) {
        return Err(Error::invalid(at(), format!("the largest number is {largest}, not 1 to 65535")));
    }
    check_size(at(), rows, columns, colours)?;
    // One blank parts the head from the numbers.
    let start = words.at + 1;
    let flat = Flat {
        rows,
        columns,
        bands: colours,
        start: start as u64,
        data_type: if largest > 255 { DataType::U16 } else { DataType::U8 },
        big_endian: true,
        order: AxisOrder::RowColumnBand,
        has_heads: false,
    };
    let (mut surplus, reader) = (
        None,
        match is_text {
            true => BandReader::Held(text_numbers(path, start, &flat)?),
            false => BandReader::Flat(flat.clone()),
        },
    );
    if !is_text {
        surplus = check_length(path, &flat, None, path)?;
    }
    let names: &[&str] = if colours == 1 { &["grey"] } else { &["red", "green", "blue"] };
    let bands = names.iter().map(|name| RasterBand { name: (*name).to_owned(), ..RasterBand::default() }).collect();
    let largest = largest as f64;
    let mut raster = Raster {
        scale: vec![Scale { gain: 1.0, offset: 0.0, divisor: largest }; colours],
        full_scale: Some(largest),
        ..Raster::of(path, (rows, columns), bands, DataType::F64, reader)
    };
    let message = format!("values: shares of the largest number, {largest}, as stored");
    raster.report.note(Fate::Defaulted, at(), message);
    if let Some(surplus) = surplus {
        raster.report.note(Fate::Dropped, at(), surplus);
    }
    Ok(raster)
}

/// Words of a head, and of numbers as text; `#` begins a comment.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        loop {
            match self.bytes.get(self.at)? {
                b'#' => self.at += self.bytes[self.at..].iter().take_while(|b| !matches!(b, b'\n' | b'\r')).count(),
                byte if byte.is_ascii_whitespace() => self.at += 1,
                _ => break,
            }
        }
        let word = &self.bytes[self.at..];
        let length = word.iter().take_while(|b| !b.is_ascii_whitespace() && **b != b'#').count();
        self.at += length;
        std::str::from_utf8(&word[..length]).ok()
    }
}

/// Numbers as text, [band, row, column].
fn text_numbers(path: &Path, start: usize, flat: &Flat) -> Result<Vec<f64>> {
    let bytes = input::bytes(path, LIMIT)?;
    let (pixels, wanted) = (flat.rows * flat.columns, flat.rows * flat.columns * flat.bands);
    let short = |there: String| {
        Error::syntax(Location::file(path), format!("not a complete PGM or PPM: {there} of {wanted} numbers"))
    };
    // A digit and a blank at least.
    if bytes.len().saturating_sub(start) / 2 + 1 < wanted {
        return Err(short(format!("{} bytes cannot hold that many: there must be", bytes.len())));
    }
    let mut values = Vec::new();
    resize(&mut values, wanted, path)?;
    let mut words = Words { bytes: &bytes, at: start.min(bytes.len()) };
    for i in 0..wanted {
        let word = words.next().ok_or_else(|| short(format!("{i}")))?;
        let number: u16 = word.parse().map_err(|_| {
            let line = 1 + bytes[..words.at].iter().filter(|b| **b == b'\n').count();
            let shown: String = word.chars().take(40).collect();
            Error::syntax(Location::line(path, line), format!("`{shown}` is not a number from 0 to 65535"))
        })?;
        values[i % flat.bands * pixels + i / flat.bands] = f64::from(number);
    }
    Ok(values)
}
