//! PDS3: an image behind its label, or beside it.
//!
//! Source: PDS Standards Reference 3.8, appendices A.20 (IMAGE) and C (types of samples), and the Planetary Science Data Dictionary.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result, number};
use crate::formats::envi::Scale;
use crate::formats::flat::{AxisOrder, Flat};
use crate::formats::format::{Format, Holds, ending};
use crate::formats::input;
use crate::formats::number::DataType;
use crate::report::{Fate, Report};

use super::blocks::Blocks;
use super::lengths::metres;
use super::place::turned;
use super::pvl::{self, Block};
use super::special::Special;
use super::{BandReader, Raster, RasterBand, check_end, check_length, check_size};

/// An image of PDS3.
pub(in crate::formats) static PDS3: Format = Format {
    name: "pds3",
    extensions: &["lbl"],
    reads: "IMAGE of a label, in the file or beside it: types but VAX reals, scaling, constants for no data, MAP_SCALE",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| if is_label(beginning) { Some(path.to_owned()) } else { label_beside(path) }),
    holds: Holds::Image { kind: "PDS3 image", open, target: Err("write .img; no tool of today writes PDS3") },
};

/// So much of a file tells whether it is a label, bytes.
const BEGINNING: usize = 1024;

fn is_label(beginning: &[u8]) -> bool {
    let text = String::from_utf8_lossy(&beginning[..beginning.len().min(BEGINNING)]);
    text.starts_with("CCSD3ZF") || ["PDS_VERSION_ID", "ODL_VERSION_ID"].iter().any(|key| text.contains(key))
}

/// The label of an image that is named itself.
fn label_beside(path: &Path) -> Option<PathBuf> {
    if !["img", "dat", "raw"].contains(&ending(path).as_str()) {
        return None;
    }
    let label = ["lbl", "LBL"].map(|ending| path.with_extension(ending)).into_iter().find(|label| label.is_file())?;
    is_label(&input::beginning(&label, BEGINNING).ok()?).then_some(label)
}

/// Constants of no data of IMAGE.
const CONSTANTS: [&str; 12] = [
    "MISSING_CONSTANT",
    "INVALID_CONSTANT",
    "UNKNOWN_CONSTANT",
    "NOT_APPLICABLE_CONSTANT",
    "NULL_CONSTANT",
    "NULL",
    "MISSING",
    "INVALID",
    "LOW_REPR_SATURATION",
    "LOW_INSTR_SATURATION",
    "HIGH_REPR_SATURATION",
    "HIGH_INSTR_SATURATION",
];

/// Opens an image by its label, or by its own name if the label lies beside it.
fn open(path: &Path) -> Result<Raster> {
    let label_path = match is_label(&input::beginning(path, BEGINNING)?) {
        true => path.to_owned(),
        false => label_beside(path).ok_or_else(|| Error::syntax(Location::file(path), "is no label of PDS3"))?,
    };
    let label = pvl::read(&label_path)?;
    let Some(image) = label.within("IMAGE") else {
        let others: Vec<&str> = label.keys().filter(|key| key.starts_with('^')).collect();
        let feature = format!(
            "a label of PDS3 without an IMAGE: it has {} (`gdal_translate -of ENVI {} OUT.img` makes a file that is read)",
            if others.is_empty() { "no pointer".into() } else { others.join(", ") },
            label_path.file_name().unwrap_or_default().to_string_lossy()
        );
        return Err(Error::Unsupported { at: Location::file(&label_path), feature });
    };
    if let Some(encoding) = image.text("ENCODING_TYPE").filter(|e| !["N/A", "NONE"].contains(&e.as_str())) {
        let feature =
            format!("an image of PDS3 compressed as {encoding} (`gdal_translate -of ENVI` makes a file that is read)");
        return Err(Error::Unsupported { at: image.at("ENCODING_TYPE"), feature });
    }
    let (data, start) = pointer(&label, &label_path)?;
    let mut report = Report::default();
    let (rows, columns, bands) =
        (image.count("LINES", None)?, image.count("LINE_SAMPLES", None)?, image.count("BANDS", Some(1))?);
    check_size(Location::file(&label_path), rows, columns, bands)?;
    let (data_type, big_endian) = sample_type(image)?;
    let order = match image.text("BAND_STORAGE_TYPE").as_deref() {
        _ if bands == 1 => AxisOrder::BandRowColumn,
        None | Some("BAND_SEQUENTIAL") => AxisOrder::BandRowColumn,
        Some("LINE_INTERLEAVED") => AxisOrder::RowBandColumn,
        Some("SAMPLE_INTERLEAVED") => AxisOrder::RowColumnBand,
        Some(other) => {
            let at = image.at("BAND_STORAGE_TYPE");
            return Err(Error::Unsupported { at, feature: format!("bands in the order {other}") });
        }
    };
    let (before, behind) = (image.count("LINE_PREFIX_BYTES", Some(0))?, image.count("LINE_SUFFIX_BYTES", Some(0))?);
    let flat = Flat { rows, columns, bands, start, data_type, big_endian, order, has_heads: false };
    let reader = if before == 0 && behind == 0 {
        if let Some(surplus) = check_length(&data, &flat, None, &label_path)? {
            // Labels, histograms and tables share the file.
            if label.keys().filter(|key| key.starts_with('^')).count() < 2 && data != label_path {
                report.note(Fate::Dropped, Location::file(&data), surplus);
            }
        }
        BandReader::Flat(flat)
    } else {
        if order == AxisOrder::RowColumnBand {
            let feature = "lines with prefixes whose samples are interleaved".to_owned();
            return Err(Error::Unsupported { at: image.at("BAND_STORAGE_TYPE"), feature });
        }
        let too_long = || Error::invalid(image.at("LINE_PREFIX_BYTES"), "lines are longer than any file");
        let line = columns.checked_mul(data_type.bytes()).and_then(|n| n.checked_add(before)?.checked_add(behind));
        let blocks = Blocks {
            flat: Flat { start: start.checked_add(before as u64).ok_or_else(too_long)?, ..flat },
            size: [1, columns],
            step: line.ok_or_else(too_long)? as u64,
            is_line_by_line: order == AxisOrder::RowBandColumn,
        };
        check_end(&data, blocks.end(), &label_path)?;
        BandReader::Blocks(blocks)
    };
    let mut special = Special::default();
    let mut ignore = None;
    for key in CONSTANTS {
        if let Some(word) = image.word(key).filter(|word| !["N/A", "UNK", "NULL"].contains(&word.text.as_str())) {
            match special.add(&word.text, data_type) {
                Some(number) => ignore = ignore.or(Some(number)),
                None => report.note(Fate::Dropped, image.at(key), format!("{:?} is not a number", word.text)),
            }
        }
    }
    let (gain, offset) = (image.number("SCALING_FACTOR")?.unwrap_or(1.0), image.number("OFFSET")?.unwrap_or(0.0));
    let is_scaled = gain != 1.0 || offset != 0.0;
    let scale = if is_scaled { vec![Scale { gain, offset, divisor: 1.0 }; bands] } else { vec![] };
    let is_up = image.text("LINE_DISPLAY_DIRECTION").as_deref() == Some("UP");
    let is_left = image.text("SAMPLE_DISPLAY_DIRECTION").as_deref() == Some("LEFT");
    let unit =
        image.word("UNIT").map(|word| word.text.clone()).filter(|unit| !["N/A", "NONE"].contains(&unit.as_str()));
    let map = label.within("IMAGE_MAP_PROJECTION");
    let georeference = how_turned(image, map).map(|(how, at)| turned(how, at, &mut report).0);
    let spacing_m = map.filter(|_| georeference.is_none()).and_then(|map| spacing_m(map, &mut report));
    let mut files = vec![label_path.clone()];
    files.extend((data != label_path).then(|| data.clone()));
    Ok(Raster {
        unit,
        ignore,
        special,
        scale,
        report,
        spacing_m,
        georeference,
        mirrored: [is_up, is_left],
        files,
        ..Raster::of(
            &data,
            (rows, columns),
            vec![RasterBand::default(); bands],
            if is_scaled { DataType::F64 } else { data_type },
            reader,
        )
    })
}

/// The file of the image, and its first byte in it, of `^IMAGE = 12`, `= 900 <BYTES>`, `= "A.IMG"`, `= ("A.IMG", 12)`.
fn pointer(label: &Block, label_path: &Path) -> Result<(PathBuf, u64)> {
    let at = || label.at("^IMAGE");
    let Some(pointer) = label.get("^IMAGE") else {
        return Err(Error::invalid(at(), "^IMAGE is missing: it says where the image is"));
    };
    let wrong = || {
        let help = "^IMAGE is a record, or a file, or both: (\"A.IMG\", 3)";
        Error::Invalid(vec![Problem::new(at(), "is not where an image can be").with_help(help)])
    };
    let (name, place) = match &pointer.values[..] {
        [one] if one.text.parse::<u64>().is_ok() => (None, Some(one)),
        [name] => (Some(&name.text), None),
        [name, place] => (Some(&name.text), Some(place)),
        _ => return Err(wrong()),
    };
    let start = match place {
        None => 0,
        Some(place) => {
            let first: u64 = place.text.parse().map_err(|_| wrong())?;
            let record =
                if place.unit.as_deref() == Some("bytes") { 1 } else { label.count("RECORD_BYTES", None)? as u64 };
            first.checked_sub(1).and_then(|n| n.checked_mul(record)).ok_or_else(wrong)?
        }
    };
    match name {
        None => Ok((label_path.to_owned(), start)),
        Some(name) => Ok((file_of(label_path, name).map_err(|message| Error::invalid(at(), message))?, start)),
    }
}

/// The file that a label names, which must lie beside it; capitals do not count, as archives were copied between systems.
pub(super) fn file_of(label_path: &Path, name: &str) -> std::result::Result<PathBuf, String> {
    let path = input::beside(label_path, name, false)?;
    if path.is_file() {
        return Ok(path);
    }
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut entries: Vec<PathBuf> =
        folder.read_dir().map(|all| all.filter_map(|entry| Some(entry.ok()?.path())).collect()).unwrap_or_default();
    entries.sort();
    let is_it = |other: &PathBuf| match (other.file_name(), path.file_name()) {
        (Some(a), Some(b)) => a.eq_ignore_ascii_case(b) && other.is_file(),
        _ => false,
    };
    entries.into_iter().find(is_it).ok_or_else(|| format!("{name:?}, which it names, is not beside it"))
}

/// How a sample is stored, and whether its first byte counts most.
fn sample_type(image: &Block) -> Result<(DataType, bool)> {
    let bits = image.count("SAMPLE_BITS", None)?;
    let text = image.text("SAMPLE_TYPE").unwrap_or_else(|| "UNSIGNED_INTEGER".into());
    let is_little = ["LSB", "PC", "VAX"].iter().any(|of| text.starts_with(of));
    let is_real = ["REAL", "FLOAT"].iter().any(|of| text.contains(of));
    let data_type = match (is_real, text.contains("UNSIGNED"), text.contains("INTEGER"), bits) {
        (true, _, _, 32) => DataType::F32,
        (true, _, _, 64) => DataType::F64,
        (false, true, _, 8) => DataType::U8,
        (false, true, _, 16) => DataType::U16,
        (false, true, _, 32) => DataType::U32,
        (false, false, true, 8) => DataType::I8,
        (false, false, true, 16) => DataType::I16,
        (false, false, true, 32) => DataType::I32,
        _ => return Err(not_read(image, &text, bits)),
    };
    if is_real && text.starts_with("VAX") {
        return Err(not_read(image, &text, bits));
    }
    Ok((data_type, !is_little))
}

fn not_read(image: &Block, text: &str, bits: usize) -> Error {
    let feature = format!(
        "samples of {text} with {bits} bits (`gdal_translate -of ENVI IN.lbl OUT.img` makes a file that is read)"
    );
    Error::Unsupported { at: image.at("SAMPLE_TYPE"), feature }
}

/// How lines run if not from the left to the right and from the West to the East, and where the label says it.
fn how_turned(image: &Block, map: Option<&Block>) -> Option<(String, Location)> {
    let key = "LINE_DISPLAY_DIRECTION";
    if let Some(direction) = image.text(key).filter(|direction| ["LEFT", "RIGHT"].contains(&direction.as_str())) {
        return Some((format!("lines follow one another to the {}", direction.to_lowercase()), image.at(key)));
    }
    let (map, key) = (map?, "MAP_PROJECTION_ROTATION");
    let by = map.number(key).ok().flatten().filter(|deg| deg % 360.0 != 0.0)?;
    Some((format!("the map is turned by {} deg", number(by)), map.at(key)))
}

/// The size of a pixel that a map projection states, m.
fn spacing_m(map: &Block, report: &mut Report) -> Option<[f64; 2]> {
    let at = || map.at("MAP_SCALE");
    let Some(scale) = map.number("MAP_SCALE").ok().flatten().filter(|s| *s > 0.0 && s.is_finite()) else {
        report.note(Fate::Dropped, at(), "the map projection gives no size of pixels in metres");
        return None;
    };
    let unit = map.word("MAP_SCALE").and_then(|word| word.unit.clone());
    let unit_m = match unit.as_deref().map(|unit| unit.split('/').next().unwrap_or_default().trim().to_owned()) {
        None => {
            report.note(
                Fate::Defaulted,
                at(),
                "its unit is not stated: taken as km/pixel, as the data dictionary has it",
            );
            1e3
        }
        Some(unit) => match metres(&unit) {
            Some(unit_m) => unit_m,
            None => {
                report.note(Fate::Dropped, at(), format!("in {unit}, not in metres"));
                return None;
            }
        },
    };
    Some([scale * unit_m; 2])
}
