//! PDS4: the first image that a label (`.xml`) describes.
//!
//! Source: PDS4 Information Model (Array, Special_Constants, Element_Array; types of numbers in its chapter on data types), and the
//! dictionaries of cartography (`cart`) and display (`disp`). Prefixes of names differ between labels, so that they are not compared.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Result};
use crate::formats::envi::Scale;
use crate::formats::flat::{AxisOrder, Flat};
use crate::formats::format::{Format, Holds, ending};
use crate::formats::input;
use crate::formats::number::DataType;
use crate::formats::wave_unit::WaveUnit;
use crate::formats::xml::{self, Element};
use crate::report::{Fate, Report};

use super::lengths::metres;
use super::pds3::file_of;
use super::place::{Georeference, Grid, Unit, turned};
use super::special::{Special, stored};
use super::{BandReader, Raster, RasterBand, check_length, check_size};

/// An image of PDS4.
pub(in crate::formats) static PDS4: Format = Format {
    name: "pds4",
    extensions: &["xml"],
    reads: "the first Array_2D or Array_3D of a label: types, scaling, Special_Constants, cartography",
    writes: "",
    mark: &[],
    told: Some(|path, beginning| if is_label(beginning) { Some(path.to_owned()) } else { label_beside(path) }),
    holds: Holds::Image {
        kind: "PDS4 image",
        open,
        target: Err("write .img; `gdal_translate -of PDS4 IN.img OUT.xml` makes one of it"),
    },
};

/// So much of a file tells whether it is a label, bytes.
const BEGINNING: usize = 4096;

fn is_label(beginning: &[u8]) -> bool {
    let text = String::from_utf8_lossy(&beginning[..beginning.len().min(BEGINNING)]);
    let is_xml = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
    is_xml && ["<Product_Observational", ":Product_Observational"].iter().any(|root| text.contains(root))
}

/// The label of an image that is named itself.
fn label_beside(path: &Path) -> Option<PathBuf> {
    if !["img", "dat", "raw"].contains(&ending(path).as_str()) {
        return None;
    }
    let label = ["xml", "XML"].map(|ending| path.with_extension(ending)).into_iter().find(|label| label.is_file())?;
    is_label(&input::beginning(&label, BEGINNING).ok()?).then_some(label)
}

/// A name without its prefix.
fn local(element: &Element) -> &str {
    element.name.rsplit(':').next().unwrap_or(&element.name)
}

fn child<'a>(of: &'a Element, name: &str) -> Option<&'a Element> {
    of.children.iter().find(|element| local(element) == name)
}

fn within<'a>(of: &'a Element, is_it: &dyn Fn(&str) -> bool) -> Option<&'a Element> {
    of.children.iter().find_map(|element| if is_it(local(element)) { Some(element) } else { within(element, is_it) })
}

fn needed<'a>(of: &'a Element, name: &str) -> Result<&'a Element> {
    child(of, name).ok_or_else(|| Error::invalid(of.at(), format!("{name} is missing in it")))
}

fn number<T: std::str::FromStr>(of: &Element) -> Result<T> {
    let shown: String = of.text.chars().take(40).collect();
    of.text
        .trim()
        .parse()
        .map_err(|_| Error::invalid(of.at(), format!("{shown:?} is not such a number as belongs here")))
}

/// Opens an image by its label, or by its own name if the label lies beside it.
fn open(path: &Path) -> Result<Raster> {
    let label_path = match is_label(&input::beginning(path, BEGINNING)?) {
        true => path.to_owned(),
        false => label_beside(path).ok_or_else(|| Error::syntax(Location::file(path), "is no label of PDS4"))?,
    };
    let (root, _) = xml::read(&label_path)?;
    let is_array = |name: &str| name == "Array" || name.starts_with("Array_2D") || name.starts_with("Array_3D");
    let areas: Vec<&Element> =
        root.children.iter().filter(|e| local(e).starts_with("File_Area_Observational")).collect();
    let found = areas.iter().find_map(|area| Some((*area, area.children.iter().find(|e| is_array(local(e)))?)));
    let Some((area, array)) = found else {
        let feature = "a label of PDS4 without an array of two or three axes".to_owned();
        return Err(Error::Unsupported { at: Location::file(&label_path), feature });
    };
    let mut report = Report::default();
    let all = areas.iter().flat_map(|area| &area.children).filter(|e| is_array(local(e))).count();
    if all > 1 {
        report.note(Fate::Dropped, array.at(), format!("{} further arrays: this is the first", all - 1));
    }
    let name = needed(needed(area, "File")?, "file_name")?;
    let data = file_of(&label_path, &name.text).map_err(|message| Error::invalid(name.at(), message))?;
    let offset = needed(array, "offset")?;
    let element = needed(array, "Element_Array")?;
    let (data_type, big_endian) = data_type(needed(element, "data_type")?)?;
    if let Some(order) = child(array, "axis_index_order").filter(|o| !o.text.eq_ignore_ascii_case("Last Index Fastest"))
    {
        let feature = format!("an array whose {} index is fastest", order.text);
        return Err(Error::Unsupported { at: order.at(), feature });
    }
    let (sizes, order) = axes(array)?;
    let [rows, columns, bands] = sizes;
    check_size(array.at(), rows, columns, bands)?;
    let start = number(offset)?;
    let flat = Flat { rows, columns, bands, start, data_type, big_endian, order, has_heads: false };
    // Other objects of the label may share the file.
    check_length(&data, &flat, None, &label_path)?;
    let special = special(array, data_type, &mut report);
    let of_bands = band_bins(array, bands, &mut report)?;
    let scale_of = |name: &str, default: f64| child(element, name).map_or(Ok(default), number);
    let (gain, offset) = (scale_of("scaling_factor", 1.0)?, scale_of("value_offset", 0.0)?);
    let is_scaled = gain != 1.0 || offset != 0.0;
    let direction = |name: &str| within(&root, &|n| n == name).map(|e| e.text.to_lowercase()).unwrap_or_default();
    Ok(Raster {
        unit: child(element, "unit").map(|unit| unit.text.clone()).filter(|unit| !unit.is_empty()),
        ignore: special.numbers.first().copied(),
        special,
        scale: if is_scaled { vec![Scale { gain, offset, divisor: 1.0 }; bands] } else { vec![] },
        georeference: place(&root, [rows, columns], &mut report),
        mirrored: [
            direction("vertical_display_direction").starts_with("bottom"),
            direction("horizontal_display_direction").starts_with("right"),
        ],
        report,
        files: vec![label_path, data.clone()],
        ..Raster::of(
            &data,
            (rows, columns),
            of_bands,
            if is_scaled { DataType::F64 } else { data_type },
            BandReader::Flat(flat),
        )
    })
}

/// Rows, columns and bands, and their order, slowest first.
fn axes(array: &Element) -> Result<([usize; 3], AxisOrder)> {
    let mut axes = Vec::new();
    for axis in array.children.iter().filter(|e| local(e) == "Axis_Array") {
        let name = child(axis, "axis_name").map(|name| name.text.to_lowercase()).unwrap_or_default();
        axes.push((
            number::<usize>(needed(axis, "sequence_number")?)?,
            name,
            number::<usize>(needed(axis, "elements")?)?,
        ));
    }
    axes.sort();
    let names: Vec<&str> = axes.iter().map(|axis| axis.1.as_str()).collect();
    let n = |i: usize| axes[i].2;
    match names[..] {
        [_, _] => Ok(([n(0), n(1), 1], AxisOrder::BandRowColumn)),
        ["line", "band", "sample"] => Ok(([n(0), n(2), n(1)], AxisOrder::RowBandColumn)),
        ["line", "sample", "band"] => Ok(([n(0), n(1), n(2)], AxisOrder::RowColumnBand)),
        // Bands, or moments of a film.
        [_, _, _] => Ok(([n(1), n(2), n(0)], AxisOrder::BandRowColumn)),
        _ => {
            let feature = format!("an array of {} axes", names.len());
            Err(Error::Unsupported { at: array.at(), feature })
        }
    }
}

/// What the label says of each band.
fn band_bins(array: &Element, count: usize, report: &mut Report) -> Result<Vec<RasterBand>> {
    let mut bands = vec![RasterBand::default(); count];
    let Some(set) = within(array, &|name| name == "Band_Bin_Set") else { return Ok(bands) };
    for bin in set.children.iter().filter(|e| local(e) == "Band_Bin") {
        let band_number: usize = number(needed(bin, "band_number")?)?;
        let Some(band) = band_number.checked_sub(1).and_then(|i| bands.get_mut(i)) else {
            let message = format!("of band {band_number}: there are {count}");
            report.note(Fate::Dropped, bin.at(), message);
            continue;
        };
        let um = |name: &str| -> Result<Option<f64>> {
            let Some(of) = child(bin, name) else { return Ok(None) };
            let unit = of.get("unit").and_then(WaveUnit::of).unwrap_or(WaveUnit::MICROMETRES);
            let value: f64 = number(of)?;
            Ok(unit.um(value).filter(|um| *um > 0.0 && um.is_finite()))
        };
        (band.centre_um, band.fwhm_um) = (um("center_wavelength")?, um("band_width")?);
    }
    Ok(bands)
}

/// How a number is stored, and whether its first byte counts most.
fn data_type(of: &Element) -> Result<(DataType, bool)> {
    // The byte order stands in the middle of the name.
    let data_type = match of.text.replace("LSB", "").replace("MSB", "").as_str() {
        "UnsignedByte" => DataType::U8,
        "SignedByte" => DataType::I8,
        "Unsigned2" => DataType::U16,
        "Unsigned4" => DataType::U32,
        "Unsigned8" => DataType::U64,
        "Signed2" => DataType::I16,
        "Signed4" => DataType::I32,
        "Signed8" => DataType::I64,
        "IEEE754Single" => DataType::F32,
        "IEEE754Double" => DataType::F64,
        _ => {
            let shown: String = of.text.chars().take(40).collect();
            return Err(Error::Unsupported { at: of.at(), feature: format!("numbers of type {shown:?}") });
        }
    };
    Ok((data_type, of.text.contains("MSB")))
}

/// What the label says means nothing here: all its constants, and what is not valid.
fn special(array: &Element, data_type: DataType, report: &mut Report) -> Special {
    let mut special = Special::default();
    let Some(constants) = child(array, "Special_Constants") else { return special };
    let mut valid = [f64::NEG_INFINITY, f64::INFINITY];
    for constant in &constants.children {
        match (local(constant), stored(&constant.text, data_type)) {
            (_, None) => {
                let message = format!("{:?} is not a number", constant.text.chars().take(40).collect::<String>());
                report.note(Fate::Dropped, constant.at(), message);
            }
            ("valid_minimum", Some(low)) => valid[0] = low,
            ("valid_maximum", Some(high)) => valid[1] = high,
            (_, Some(number)) => special.numbers.push(number),
        }
    }
    special.valid = (valid != [f64::NEG_INFINITY, f64::INFINITY]).then_some(valid);
    special
}

/// Where a map lies.
fn place(root: &Element, size_px: [usize; 2], report: &mut Report) -> Option<Georeference> {
    let text = |of: &Element| of.text.trim().to_lowercase();
    if let Some(axis) = within(root, &|name| name == "vertical_display_axis").filter(|axis| text(axis) == "sample") {
        return Some(turned("lines follow one another to the side".into(), axis.at(), report).0);
    }
    let cartography = within(root, &|name| name == "Cartography")?;
    let find = |name: &str| within(cartography, &|n| n == name);
    let number = |of: &Element| of.text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
    if let Some(rotation) =
        find("map_projection_rotation").filter(|of| number(of).is_some_and(|deg| deg % 360.0 != 0.0))
    {
        return Some(turned(format!("the map is turned by {} deg", rotation.text.trim()), rotation.at(), report).0);
    }
    let size = |axis: &str| {
        let of = find(&format!("pixel_resolution_{axis}"))?;
        let size = of.text.trim().parse().ok().filter(|size: &f64| *size > 0.0 && size.is_finite())?;
        Some((size, of.get("unit").unwrap_or_default().to_lowercase()))
    };
    let (Some((width, unit)), Some((height, _))) = (size("x"), size("y")) else {
        report.note(Fate::Dropped, cartography.at(), "the cartography gives no size of pixels");
        return None;
    };
    let unit = unit.split('/').next().unwrap_or_default().trim();
    let scale = match metres(unit) {
        Some(unit_m) => unit_m,
        None => {
            let why = format!("pixels of {width} x {height} {unit}, not of metres");
            let corner = ["west", "north"].map(|side| number(find(&format!("{side}_bounding_coordinate"))?));
            let is_west = find("longitude_direction").is_some_and(|of| text(of).contains("west"));
            let ([Some(west), Some(north)], "deg", false) = (corner, unit, is_west) else {
                report.note(Fate::Dropped, cartography.at(), why.as_str());
                return Some(Georeference::Other(why));
            };
            let grid = Grid::north_up([west, north], [width, height]);
            return Some(grid.upright(Unit::Degrees, size_px, (cartography.at(), report)).0);
        }
    };
    let corner = |axis: &str| {
        let of = find(&format!("upperleft_corner_{axis}"));
        let scale = of.and_then(|of| metres(of.get("unit")?)).unwrap_or(1.0);
        of.and_then(|of| of.text.trim().parse().ok())
            .filter(|at: &f64| at.is_finite())
            .map_or(0.0, |at: f64| scale * at)
    };
    // Corners are in metres by now.
    let grid = Grid::north_up([corner("x"), corner("y")], [scale * width, scale * height]);
    Some(grid.upright(Unit::Metres(1.0), size_px, (cartography.at(), report)).0)
}
