//! FITS: the image among its units (see `arrays.rs`), as Wells, Greisen and Harten have it and the standard's version 4.0. Images that are compressed within
//! tables are not read.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::container::Container;
use crate::formats::envi::Scale;
use crate::formats::flat::{AxisOrder, Flat};
use crate::formats::format::{Format, Holds};
use crate::formats::input;
use crate::formats::number::DataType;
use crate::formats::wave_unit::WaveUnit;

use super::arrays::{self, Array, BandAxis, Image, LONGEST};
use super::{BandReader, Raster, Target, check_end};

/// FITS.
pub(in crate::formats) static FITS: Format = Format {
    name: "fits",
    extensions: &["fits", "fit", "fts"],
    reads: "the image of three axes, or all of two that are alike, in any unit; BSCALE, BZERO, BLANK, wavelengths",
    writes: "the image in the first unit, wavelengths in further ones",
    mark: b"SIMPLE  =",
    told: None,
    holds: Holds::Image { kind: "FITS", open, target: Ok(|_| Target::Container(Container::Fits)) },
};

const BLOCK: usize = 2880;
const CARD: usize = 80;
/// A header has fewer blocks, and a file fewer units.
const BLOCKS: usize = 4096;
const UNITS: usize = 4096;

/// A card's keyword and what stands behind its equals sign.
type Cards = Vec<(String, String)>;

/// An image of a file.
struct Unit {
    array: Array,
    cards: Cards,
    /// Lengths of axes, fastest first, without those of 1 behind the third.
    axes: Vec<usize>,
    data_type: DataType,
    start: u64,
}

/// The value of a card: a text without quotes and blanks at its end, or else what stands before a comment.
fn value(card: &str) -> String {
    let text = card.trim_start();
    let Some(quoted) = text.strip_prefix('\'') else {
        return text.split('/').next().unwrap_or_default().trim().to_owned();
    };
    let mut value = String::new();
    let mut rest = quoted.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '\'' if rest.peek() == Some(&'\'') => {
                rest.next();
                value.push('\'');
            }
            '\'' => break,
            other => value.push(other),
        }
    }
    value.trim_end().to_owned()
}

/// Reads the cards of a header, up to END.
fn header(path: &Path, file: &mut File) -> Result<Option<Cards>> {
    let broken = |what: &str| Error::syntax(Location::file(path), format!("not a complete FITS file: {what}"));
    let mut cards: Cards = Vec::new();
    let mut block = [0; BLOCK];
    for number in 0..BLOCKS {
        match file.read_exact(&mut block) {
            // What follows the last unit is no unit.
            Err(e) if e.kind() == std::io::ErrorKind::UnexpectedEof && number == 0 => return Ok(None),
            Err(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
                return Err(broken("a header ends before its END"));
            }
            other => other.map_err(|e| Error::io(path, "reading", e))?,
        }
        if number == 0 && !(block.starts_with(b"SIMPLE") || block.starts_with(b"XTENSION")) {
            return Ok(None);
        }
        for card in block.chunks_exact(CARD) {
            let card = String::from_utf8_lossy(card);
            let (keyword, rest) = (card.get(..8).unwrap_or_default().trim_end(), card.get(8..).unwrap_or_default());
            match keyword {
                "END" => return Ok(Some(cards)),
                // A text that goes on ends with an ampersand.
                "CONTINUE" => {
                    if let Some((_, text)) = cards.last_mut() {
                        text.truncate(text.trim_end_matches('&').len());
                        text.push_str(&value(rest));
                    }
                }
                _ => {
                    if let Some(rest) = rest.strip_prefix("= ") {
                        cards.push((keyword.to_owned(), value(rest)));
                    }
                }
            }
        }
    }
    Err(broken("a header has no end"))
}

fn text<'a>(cards: &'a Cards, keyword: &str) -> Option<&'a str> {
    cards.iter().find(|(key, _)| key == keyword).map(|(_, value)| value.as_str())
}

fn real(cards: &Cards, keyword: &str) -> Option<f64> {
    // Exponents may be written as in Fortran.
    fast_float2::parse(text(cards, keyword)?.replace(['D', 'd'], "E")).ok()
}

fn count(cards: &Cards, keyword: &str) -> Option<u64> {
    text(cards, keyword)?.parse().ok()
}

/// All images, and whether one is compressed.
fn units(path: &Path) -> Result<(Vec<Unit>, bool)> {
    let reading = |e| Error::io(path, "reading", e);
    let broken = |what: String| Error::syntax(Location::file(path), format!("not a complete FITS file: {what}"));
    let mut file = input::open(path).map_err(reading)?;
    let (mut units, mut is_compressed) = (Vec::new(), false);
    for number in 0..UNITS {
        let Some(cards) = header(path, &mut file)? else { break };
        let start = file.stream_position().map_err(reading)?;
        let data_type = match text(&cards, "BITPIX") {
            Some("8") => DataType::U8,
            Some("16") => DataType::I16,
            Some("32") => DataType::I32,
            Some("64") => DataType::I64,
            Some("-32") => DataType::F32,
            Some("-64") => DataType::F64,
            other => return Err(broken(format!("BITPIX is {}", other.unwrap_or("missing")))),
        };
        let of_axes = count(&cards, "NAXIS").filter(|n| *n < 1000).ok_or_else(|| broken("NAXIS is missing".into()))?;
        let axes: Option<Vec<u64>> = (1..=of_axes).map(|i| count(&cards, &format!("NAXIS{i}"))).collect();
        let axes = axes.ok_or_else(|| broken("the length of an axis is missing".into()))?;
        let heap = count(&cards, "PCOUNT").unwrap_or(0);
        let groups = count(&cards, "GCOUNT").unwrap_or(1);
        let numbers =
            if axes.is_empty() { Some(0) } else { axes.iter().try_fold(1u64, |n, axis| n.checked_mul(*axis)) };
        let bytes = numbers
            .and_then(|n| n.checked_add(heap))
            .and_then(|n| n.checked_mul(groups))
            .and_then(|n| n.checked_mul(data_type.bytes() as u64));
        let Some(bytes) = bytes else { return Err(broken("it would be larger than any file".into())) };
        let kind = text(&cards, "XTENSION");
        is_compressed |= text(&cards, "ZIMAGE") == Some("T");
        let mut short: Vec<usize> = axes.iter().map(|axis| usize::try_from(*axis).unwrap_or(usize::MAX)).collect();
        while short.len() > 3 && short.last() == Some(&1) {
            short.pop();
        }
        if bytes > 0 && kind.is_none_or(|kind| kind == "IMAGE") && !short.contains(&0) {
            let name = text(&cards, "EXTNAME").filter(|name| !name.is_empty());
            let name = name.map_or_else(|| format!("unit {number}"), str::to_owned);
            let named = |(i, length): (usize, &usize)| {
                let name = [format!("AXIS{}", i + 1), format!("CTYPE{}", i + 1)];
                let name = name.iter().find_map(|key| text(&cards, key)).map(str::to_lowercase);
                (name.unwrap_or_else(|| format!("axis {}", i + 1)), *length)
            };
            let mut array = Array {
                name,
                axes: short.iter().enumerate().map(named).rev().collect(),
                is_number: true,
                unit: text(&cards, "BUNIT").map(str::to_owned),
                band_names: text(&cards, "BANDNAME").map(str::to_owned),
                ..Array::default()
            };
            if short.len() == 1 && short[0] <= LONGEST {
                let mut raw = vec![0; short[0] * data_type.bytes()];
                file.read_exact(&mut raw).map_err(reading)?;
                let mut values = vec![0.0; short[0]];
                data_type.decode(true, &raw, &mut values);
                array.values = Some(values);
            }
            units.push(Unit { array, cards, axes: short, data_type, start });
        }
        let padded = bytes.checked_next_multiple_of(BLOCK as u64).and_then(|bytes| start.checked_add(bytes));
        let Some(next) = padded else { return Err(broken("it would be larger than any file".into())) };
        file.seek(SeekFrom::Start(next)).map_err(reading)?;
    }
    Ok((units, is_compressed))
}

/// Opens a file.
fn open(path: &Path) -> Result<Raster> {
    let (units, is_compressed) = units(path)?;
    if is_compressed && !units.iter().any(|unit| unit.axes.len() > 1) {
        let feature = "an image that is compressed within a table (`funpack FILE` unpacks it)".to_owned();
        return Err(Error::Unsupported { at: Location::file(path), feature });
    }
    let arrays: Vec<Array> = units.iter().map(|unit| unit.array.clone()).collect();
    let mut image = arrays::image(path, &arrays)?;
    let Image { rows, columns, band_axis, .. } = image;
    let (chosen, bands) = (&image.arrays, &mut image.bands);
    let first = &units[chosen[0]];
    if band_axis == BandAxis::First
        && bands.iter().all(|band| band.centre_um.is_none())
        && let Some(centres_um) = spectral_axis(&first.cards, bands.len())
    {
        bands.iter_mut().zip(centres_um).for_each(|(band, um)| band.centre_um = Some(um));
    }
    let ignore = blank(first);
    if chosen.iter().any(|i| blank(&units[*i]) != ignore) {
        let problem = Problem::new(Location::file(path), "its images have different numbers for no data (BLANK)")
            .with_help("`gdal_translate -of ENVI FITS:\"FILE\":1 OUT.img` takes one of them");
        return Err(Error::Invalid(vec![problem]));
    }
    let planes = if chosen.len() == 1 { bands.len() } else { 1 };
    let order = if band_axis == BandAxis::Last { AxisOrder::RowColumnBand } else { AxisOrder::BandRowColumn };
    let flat = |unit: &Unit| Flat {
        start: unit.start,
        big_endian: true,
        ..Flat::new([rows, columns, planes], unit.data_type, order)
    };
    for unit in chosen.iter().map(|i| &units[*i]) {
        let flat = flat(unit);
        check_end(path, flat.data_bytes().and_then(|bytes| bytes.checked_add(flat.start)), path)?;
    }
    let scales: Vec<Scale> = chosen.iter().map(|i| scale(&units[*i].cards)).collect();
    let is_scaled = scales.iter().any(|scale| scale.gain != 1.0 || scale.offset != 0.0);
    let reader = match chosen[..] {
        [one] => BandReader::Flat(flat(&units[one])),
        _ => BandReader::Flats(chosen.iter().map(|i| flat(&units[*i])).collect()),
    };
    let is_one_type = chosen.iter().all(|i| units[*i].data_type == first.data_type);
    let data_type = if is_scaled || !is_one_type { DataType::F64 } else { first.data_type };
    let of_bands = (0..bands.len()).map(|band| *scales.get(band).unwrap_or(&scales[0]));
    let scale = if is_scaled { of_bands.collect() } else { vec![] };
    Ok(Raster { ignore, scale, ..image.raster(path, data_type, reader) })
}

/// How numbers become values.
fn scale(cards: &Cards) -> Scale {
    Scale { gain: real(cards, "BSCALE").unwrap_or(1.0), offset: real(cards, "BZERO").unwrap_or(0.0), divisor: 1.0 }
}

/// The number that stands for no data: of whole numbers only.
fn blank(unit: &Unit) -> Option<f64> {
    real(&unit.cards, "BLANK").filter(|_| unit.data_type.is_integer())
}

/// Wavelengths, um, of a third axis that is linear in them.
fn spectral_axis(cards: &Cards, bands: usize) -> Option<Vec<f64>> {
    let kind = text(cards, "CTYPE3")?.to_uppercase();
    if !(kind == "WAVE" || kind == "AWAV" || kind.starts_with("WAVELEN")) {
        return None;
    }
    let unit = WaveUnit::of(text(cards, "CUNIT3").unwrap_or("m"))?;
    let step = real(cards, "CDELT3").or_else(|| real(cards, "CD3_3"))?;
    let (value, pixel) = (real(cards, "CRVAL3")?, real(cards, "CRPIX3").unwrap_or(1.0));
    let um: Option<Vec<f64>> = (1..=bands).map(|i| unit.um(value + (i as f64 - pixel) * step)).collect();
    um.filter(|um| um.iter().all(|um| *um > 0.0 && um.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_cards_are_texts_or_stand_before_a_comment() {
        assert_eq!(value("                  -32 / bits"), "-32");
        assert_eq!(value("'it''s / here  '  / a name"), "it's / here");
        assert_eq!(value("'        '"), "");
        assert_eq!(value("T"), "T");
    }

    #[test]
    fn a_spectral_axis_is_linear_from_its_reference() {
        let card = |key: &str, value: &str| (key.to_owned(), value.to_owned());
        let cards = vec![
            card("CTYPE3", "WAVE"),
            card("CUNIT3", "nm"),
            card("CRPIX3", "2"),
            card("CRVAL3", "1.1D3"),
            card("CDELT3", "100"),
        ];
        assert_eq!(spectral_axis(&cards, 3), Some(vec![1.0, 1.1, 1.2]));
    }
}
