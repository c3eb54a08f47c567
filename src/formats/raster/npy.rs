//! NumPy: one array in `.npy`, or one among those of a `.npz`. [row, column] or [row, column, band].

use std::io::{Cursor, Read};
use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::format::{Format, Holds};
use crate::formats::marks;
use crate::formats::npy::{Preamble, preamble};
use crate::formats::npz::{self, Member};
use crate::formats::number::DataType;
use crate::report::Fate;

use super::{BandReader, Raster, RasterBand, Target, check_length, check_size};
use crate::formats::flat::{AxisOrder, Flat};
use crate::formats::input;

/// A NumPy array.
pub(in crate::formats) static NPY: Format = Format {
    name: "npy",
    extensions: &["npy"],
    reads: "[row, column] or [row, column, band]",
    writes: "the same",
    mark: marks::NUMPY,
    told: None,
    holds: Holds::Image { kind: "NumPy array", open, target: Ok(|_| Target::Npy) },
};

/// NumPy arrays in a Zip archive; other archives hold no `.npy` first.
pub(in crate::formats) static NPZ: Format = Format {
    name: "npz",
    extensions: &["npz"],
    reads: "the array in it, or that named raster; wavelength_um",
    writes: "",
    mark: marks::ZIP,
    told: Some(|path, beginning| holds_arrays(beginning).then(|| path.to_owned())),
    holds: Holds::Image { kind: "NumPy arrays", open: open_npz, target: Err("write .npy") },
};

/// Whether the first file in an archive is an array, by its local header (APPNOTE.TXT 4.3.7): the length of its name is at byte 26, the name
/// from byte 30 on.
fn holds_arrays(archive: &[u8]) -> bool {
    let length = archive.get(26..28).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]])));
    length.and_then(|length| archive.get(30..30 + length)).is_some_and(|name| name.ends_with(b".npy"))
}

/// Preambles end before this, bytes.
const PREAMBLE: u64 = 1 << 16;

/// Opens a `.npy` file.
pub(super) fn open(path: &Path) -> Result<Raster> {
    let reading = |e| Error::io(path, "reading", e);
    let mut beginning = Vec::new();
    input::open(path).and_then(|file| file.take(PREAMBLE).read_to_end(&mut beginning)).map_err(reading)?;
    let flat = flat(&beginning, 0, Location::file(path))?;
    let surplus = check_length(path, &flat, None, path)?;
    let mut raster = raster(path, flat);
    if let Some(surplus) = surplus {
        raster.report.note(Fate::Dropped, Location::file(path), surplus);
    }
    Ok(raster)
}

fn raster(path: &Path, flat: Flat) -> Raster {
    let bands = vec![RasterBand::default(); flat.bands];
    Raster::of(path, (flat.rows, flat.columns), bands, flat.data_type, BandReader::Flat(flat))
}

/// How the numbers of an array lie that begins at byte `start` of a file.
fn flat(beginning: &[u8], start: u64, at: Location) -> Result<Flat> {
    let array = preamble(beginning).map_err(|message| Error::syntax(at.clone(), message))?;
    let Preamble { descr, shape, fortran_order, start: behind } = array;
    let data_type = match descr.get(1..) {
        Some("u1" | "b1") => DataType::U8,
        Some("i1") => DataType::I8,
        Some("u2") => DataType::U16,
        Some("i2") => DataType::I16,
        Some("u4") => DataType::U32,
        Some("i4") => DataType::I32,
        Some("u8") => DataType::U64,
        Some("i8") => DataType::I64,
        Some("f4") => DataType::F32,
        Some("f8") => DataType::F64,
        _ => {
            let feature = format!("an array of type {descr:?} (save it as f4, f8 or integers: `a.astype(\"f8\")`)");
            return Err(Error::Unsupported { at, feature });
        }
    };
    let (rows, columns, bands) = match shape[..] {
        [columns] => (1, columns, 1),
        [rows, columns] => (rows, columns, 1),
        [rows, columns, bands] => (rows, columns, bands),
        _ => {
            let help = "save [row, column] or [row, column, band]; `np.moveaxis(a, 0, -1)` puts the first axis last";
            let problem = Problem::new(at, format!("has {} axes", shape.len())).with_help(help);
            return Err(Error::Invalid(vec![problem]));
        }
    };
    check_size(at, rows, columns, bands)?;
    let order = match (fortran_order, bands) {
        (true, _) => AxisOrder::BandColumnRow,
        (false, 1) => AxisOrder::BandRowColumn,
        (false, _) => AxisOrder::RowColumnBand,
    };
    Ok(Flat {
        rows,
        columns,
        bands,
        start: start + behind as u64,
        data_type,
        big_endian: descr.starts_with('>'),
        order,
        has_heads: false,
    })
}

/// Length of a list.
fn length(path: &Path, member: &Member, at: &impl Fn(&str) -> Location) -> Result<usize> {
    let flat = flat(&npz::beginning(path, member, PREAMBLE)?, member.start, at(&member.name))?;
    Ok(flat.rows * flat.columns * flat.bands)
}

/// Opens a `.npz` file: the array of numbers in it, or the one named `raster`. `wavelength_um`, `fwhm_um` and `unit` beside it
/// say what its bands are.
pub(super) fn open_npz(path: &Path) -> Result<Raster> {
    let at = |name: &str| Location::file(path).with_item(name);
    let mut members = npz::members(path)?;
    let mut beside = |name: &str| members.iter().position(|m| m.name == name).map(|i| members.remove(i));
    let [wavelength_um, fwhm_um, unit] = ["wavelength_um", "fwhm_um", "unit"].map(&mut beside);
    let named = members.iter().position(|m| m.name == "raster");
    let array = match (named, &members[..]) {
        (Some(i), _) => &members[i],
        (None, [one]) => one,
        (None, others) => {
            let names: Vec<&str> = others.iter().map(|m| m.name.as_str()).collect();
            let message = match names.is_empty() {
                true => "has no array of values".to_owned(),
                false => format!("which of its arrays is the raster? [{}]", names.join(", ")),
            };
            let problem = Problem::new(Location::file(path), message)
                .with_help("save one array, or name it: `np.savez(path, raster=a, wavelength_um=w)`");
            return Err(Error::Invalid(vec![problem]));
        }
    };
    let beginning = npz::beginning(path, array, PREAMBLE)?;
    let mut flat = flat(&beginning, array.start, at(&array.name))?;
    let mut notes = Vec::new();
    notes.extend(check_length(path, &flat, Some(array.start + array.bytes), path)?);
    // How many bands there are is how many wavelengths there are: of a table of [facet, band], and of [band, row, column].
    if let Some(count) = wavelength_um.as_ref().map(|member| length(path, member, &at)).transpose()? {
        let (rows, columns, bands) = (flat.rows, flat.columns, flat.bands);
        match flat.order {
            AxisOrder::BandRowColumn | AxisOrder::BandColumnRow if bands == 1 && columns == count && count > 1 => {
                flat.order = if flat.order == AxisOrder::BandRowColumn {
                    AxisOrder::RowColumnBand
                } else {
                    AxisOrder::BandRowColumn
                };
                // In Fortran's order a column, which is a band, is in one piece.
                (flat.columns, flat.bands) = (1, columns);
            }
            AxisOrder::RowColumnBand if bands != count && rows == count => {
                (flat.rows, flat.columns, flat.bands) = (columns, bands, rows);
                flat.order = AxisOrder::BandRowColumn;
                notes.push(format!(
                    "{}: as many wavelengths as its first axis is long: taken as [band, row, column]",
                    array.name
                ));
            }
            _ => {}
        }
        check_size(at(&array.name), flat.rows, flat.columns, flat.bands)?;
    }
    let mut raster = raster(path, flat.clone());
    if array.is_packed {
        raster.reader = BandReader::Unpacked(flat, beginning.into());
    }
    notes.into_iter().for_each(|note| raster.report.note(Fate::Defaulted, Location::file(path), note));
    for other in members.iter().filter(|m| m.name != array.name) {
        raster.report.note(Fate::Dropped, at(&other.name), "an array beside the raster");
    }
    let mut problems = Vec::new();
    let mut list = |member: Option<Member>| -> Result<Option<Vec<f64>>> {
        let Some(member) = member else { return Ok(None) };
        let beginning = npz::beginning(path, &member, PREAMBLE)?;
        let of_list = self::flat(&beginning, member.start, at(&member.name))?;
        check_length(path, &of_list, Some(member.start + member.bytes), path)?;
        if of_list.bands != 1
            || of_list.rows.min(of_list.columns) != 1
            || of_list.rows * of_list.columns != raster.bands.len()
        {
            let message = format!("is not a list of {} numbers, one for each band", raster.bands.len());
            problems.push(Problem::new(at(&member.name), message));
            return Ok(None);
        }
        let mut numbers = vec![0.0; raster.bands.len()];
        match member.is_packed {
            true => of_list
                .read_from(Cursor::new(&beginning), 0..1, &mut numbers)
                .map_err(|e| Error::io(path, "reading", e))?,
            false => of_list.read(path, 0..1, &mut numbers)?,
        }
        if let Some(i) = numbers.iter().position(|v| !(*v > 0.0 && v.is_finite())) {
            problems
                .push(Problem::new(at(&format!("{}[{i}]", member.name)), format!("{} is not positive", numbers[i])));
        }
        Ok(Some(numbers))
    };
    let (centres_um, fwhms_um) = (list(wavelength_um)?, list(fwhm_um)?);
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    for (i, band) in raster.bands.iter_mut().enumerate() {
        band.centre_um = centres_um.as_ref().map(|all| all[i]);
        band.fwhm_um = fwhms_um.as_ref().map(|all| all[i]);
    }
    raster.unit = match unit {
        Some(member) => npz::text(path, &member)?,
        None => None,
    };
    Ok(raster)
}
