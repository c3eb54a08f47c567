//! ISIS cubes: a label, and behind it, or in a file of its own, numbers as bands or tiles.
//!
//! Sources: the description of the cube format by the USGS (isis.astrogeology.usgs.gov, "ISIS Cube Format") and its special pixels
//! (SpecialPixel.h of ISIS 8).

use std::path::Path;

use crate::error::{Error, Location, Problem, Result, number as number_text};
use crate::formats::envi::Scale;
use crate::formats::flat::{AxisOrder, Flat};
use crate::formats::format::{Format, Holds};
use crate::formats::number::DataType;
use crate::report::{Fate, Report};

use super::blocks::Blocks;
use super::lengths::metres;
use super::pds3::file_of;
use super::place::{Georeference, Grid, Unit, turned};
use super::pvl::{self, Block};
use super::special::Special;
use super::{BandReader, Raster, RasterBand, check_end, check_length, check_size};

/// A cube.
pub(in crate::formats) static ISIS: Format = Format {
    name: "isis",
    extensions: &["cub"],
    reads: "ISIS cube, label within or beside: bands or tiles, base and multiplier, special pixels mean no data, map",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| is_cube(beginning).then(|| path.to_owned())),
    holds: Holds::Image {
        kind: "ISIS cube",
        open,
        target: Err("write .img; `gdal_translate -of ISIS3 IN.img OUT.cub` makes one of it"),
    },
};

fn is_cube(beginning: &[u8]) -> bool {
    let text = String::from_utf8_lossy(&beginning[..beginning.len().min(256)]);
    let mut words = text.split(|c: char| c.is_whitespace() || c == '=').filter(|word| !word.is_empty());
    words.next().is_some_and(|word| word.eq_ignore_ascii_case("Object"))
        && words.next().is_some_and(|word| word.eq_ignore_ascii_case("IsisCube"))
}

/// Opens a cube.
fn open(path: &Path) -> Result<Raster> {
    let label = pvl::read(path)?;
    let part = |name: &str| {
        label
            .within(name)
            .ok_or_else(|| Error::invalid(Location::file(path).with_item(name), "is missing in the label"))
    };
    let (core, size, pixels) = (part("CORE")?, part("DIMENSIONS")?, part("PIXELS")?);
    let (rows, columns, bands) =
        (size.count("LINES", None)?, size.count("SAMPLES", None)?, size.count("BANDS", Some(1))?);
    check_size(Location::file(path), rows, columns, bands)?;
    let data_type = data_type(pixels)?;
    let data = match core.word("^CORE") {
        Some(word) => file_of(path, &word.text).map_err(|message| Error::invalid(core.at("^CORE"), message))?,
        None => path.to_owned(),
    };
    let first = core.count("STARTBYTE", Some(1))?;
    let Some(start) = first.checked_sub(1) else {
        return Err(Error::invalid(core.at("STARTBYTE"), "bytes are counted from 1"));
    };
    let flat = Flat {
        rows,
        columns,
        bands,
        start: start as u64,
        data_type,
        big_endian: pixels.text("BYTEORDER").is_some_and(|order| order.starts_with("MSB")),
        order: AxisOrder::BandRowColumn,
        has_heads: false,
    };
    let reader = match core.text("FORMAT").as_deref() {
        None | Some("BANDSEQUENTIAL") => {
            // Tables, history and the original label may stand behind the numbers.
            check_length(&data, &flat, None, path)?;
            BandReader::Flat(flat)
        }
        Some("TILE") => {
            let size = [core.count("TILELINES", None)?, core.count("TILESAMPLES", None)?];
            let at = core.at("TILESAMPLES");
            check_size(at.clone(), size[0], size[1], 1)?;
            let step = (size[0] * size[1] * data_type.bytes()) as u64;
            let blocks = Blocks { flat, size, step, is_line_by_line: false };
            check_end(&data, blocks.end(), path)?;
            BandReader::Blocks(blocks)
        }
        Some(other) => {
            let what = core.word("^CORE").map_or(String::new(), |word| format!(" in {}", word.text));
            let feature = format!(
                "a cube whose numbers are {other}{what} (name that file if it is a GeoTIFF, or `gdal_translate -of ENVI` makes one that is read)"
            );
            return Err(Error::Unsupported { at: core.at("FORMAT"), feature });
        }
    };
    let (gain, offset) = (pixels.number("MULTIPLIER")?.unwrap_or(1.0), pixels.number("BASE")?.unwrap_or(0.0));
    let is_scaled = gain != 1.0 || offset != 0.0;
    let mut report = Report::default();
    let georeference = label.within("MAPPING").and_then(|map| place(map, [rows, columns], &mut report));
    let names = label.within("BANDBIN").and_then(|bin| bin.get("NAME").or_else(|| bin.get("FILTERNAME")));
    let name = |i: usize| names.and_then(|names| names.values.get(i)).map(|word| word.text.clone()).unwrap_or_default();
    let all = (0..bands).map(|i| RasterBand { name: name(i), ..RasterBand::default() }).collect();
    let mut files = vec![path.to_owned()];
    files.extend((data != path).then(|| data.clone()));
    Ok(Raster {
        special: special(data_type),
        scale: if is_scaled { vec![Scale { gain, offset, divisor: 1.0 }; bands] } else { vec![] },
        report,
        georeference,
        files,
        ..Raster::of(&data, (rows, columns), all, if is_scaled { DataType::F64 } else { data_type }, reader)
    })
}

fn data_type(pixels: &Block) -> Result<DataType> {
    Ok(match pixels.text("TYPE").as_deref() {
        Some("UNSIGNEDBYTE") => DataType::U8,
        Some("SIGNEDBYTE") => DataType::I8,
        Some("UNSIGNEDWORD") => DataType::U16,
        Some("SIGNEDWORD") => DataType::I16,
        Some("UNSIGNEDINTEGER") => DataType::U32,
        Some("SIGNEDINTEGER") => DataType::I32,
        Some("REAL") => DataType::F32,
        Some("DOUBLE") => DataType::F64,
        other => {
            let help =
                "known are UnsignedByte, SignedWord, UnsignedWord, SignedInteger, UnsignedInteger, Real and Double";
            let message = format!("{:?} is not a type of pixels", other.unwrap_or("nothing"));
            return Err(Error::Invalid(vec![Problem::new(pixels.at("TYPE"), message).with_help(help)]));
        }
    })
}

/// What is no number of a measurement: Null, and what was too low or too high for the instrument or the representation.
fn special(data_type: DataType) -> Special {
    let valid = match data_type {
        DataType::U8 => Some([1.0, 254.0]),
        DataType::I16 => Some([-32752.0, 32767.0]),
        DataType::U16 => Some([3.0, 65522.0]),
        DataType::U32 => Some([3.0, 4_294_967_282.0]),
        DataType::I32 => Some([-2_147_483_632.0, 2_147_483_647.0]),
        DataType::F32 => Some([f64::from(f32::from_bits(0xff7f_fffa)), f64::INFINITY]),
        DataType::F64 => Some([f64::from_bits(0xffef_ffff_ffff_fffa), f64::INFINITY]),
        _ => None,
    };
    Special { numbers: vec![], valid }
}

/// Where a cube that is a map lies.
fn place(map: &Block, size_px: [usize; 2], report: &mut Report) -> Option<Georeference> {
    let number = |key: &str| map.number(key).ok().flatten().filter(|n| n.is_finite());
    if let Some(by) = number("ROTATION").filter(|deg| deg % 360.0 != 0.0) {
        return Some(turned(format!("the map is turned by {} deg", number_text(by)), map.at("ROTATION"), report).0);
    }
    let Some(size) = number("PIXELRESOLUTION").filter(|size| *size > 0.0) else {
        report.note(Fate::Dropped, map.at("PIXELRESOLUTION"), "the map gives no size of pixels in metres");
        return None;
    };
    let unit = map.word("PIXELRESOLUTION").and_then(|word| word.unit.clone()).unwrap_or_else(|| "meters/pixel".into());
    let unit = unit.split('/').next().unwrap_or_default().trim();
    let scale = match metres(unit) {
        Some(unit_m) => unit_m,
        None => {
            let message = format!("in {unit}, not in metres");
            report.note(Fate::Dropped, map.at("PIXELRESOLUTION"), message.as_str());
            return Some(Georeference::Other(format!("pixels of {}, {message}", number_text(size))));
        }
    };
    let corner = |key: &str| number(key).unwrap_or(0.0);
    let grid = Grid::north_up([corner("UPPERLEFTCORNERX"), corner("UPPERLEFTCORNERY")], [size; 2]);
    Some(grid.upright(Unit::Metres(scale), size_px, (map.at("PIXELRESOLUTION"), report)).0)
}
