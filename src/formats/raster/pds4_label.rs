//! A label of PDS4 beside the numbers of an ENVI image, so that both say what they are.
//!
//! Source: PDS4 Information Model 1.16.0.0 (Product_Observational, Array_3D_Spectrum, Band_Bin). What an archive asks for beyond the image
//! itself (mission, target, references) the program does not know: the label says so, and is to be completed before it is archived.

use std::path::Path;

use super::headers;
use crate::error::{Error, Result};
use crate::formats::envi::{self, Interleave};
use crate::formats::number::DataType;
use crate::formats::xml::Element;

const NAMESPACE: &str = "http://pds.nasa.gov/pds4/pds/v1";
const SCHEMA: &str = "http://pds.nasa.gov/pds4/pds/v1 https://pds.nasa.gov/pds4/pds/v1/PDS4_PDS_1G00.xsd";
const MODEL: &str = "1.16.0.0";
/// So many digits of a scene's hash are in an identifier, of which no two are the same in an archive.
const SCENE: usize = 16;
/// What stands where an archive's own words belong.
const UNKNOWN: &str = "not stated";

/// Writes the label of an image of ENVI, under its name with `.xml`; `title` says what it is, and the scene's name, a hash, makes its identifier another
/// one than those of other scenes.
///
/// # Errors
/// [`Error::Io`], and those of reading the header.
pub(in crate::formats) fn write(image: &Path, title: &str, scene: Option<&str>) -> Result<()> {
    let (header_path, data) = envi::pair(image)?;
    let header = envi::read_header(&header_path)?;
    let bands = headers::open_envi(image)?.bands;
    let name = data.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = data.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_plain = |c: &char| c.is_ascii_alphanumeric() || ['-', '.', '_'].contains(c);
    let scene = scene.and_then(|hash| hash.get(..SCENE)).map_or(String::new(), |hash| format!("{hash}-"));
    let id: String = scene.chars().chain(stem.chars()).filter(is_plain).collect();
    let axis = |name: &str, elements: usize, number: usize| {
        Element::new("Axis_Array")
            .and(text("axis_name", name))
            .and(text("elements", elements))
            .and(text("sequence_number", number))
    };
    let band_axis = |number| {
        let widths: Option<Vec<(f64, f64)>> = bands.iter().map(|band| band.centre_um.zip(band.fwhm_um)).collect();
        let bin = |(i, (centre_um, fwhm_um)): (usize, (f64, f64))| {
            Element::new("Band_Bin")
                .and(text("band_number", i + 1))
                .and(text("band_width", fwhm_um).with("unit", "micrometer"))
                .and(text("center_wavelength", centre_um).with("unit", "micrometer"))
        };
        let set = |bins: Vec<(f64, f64)>| Element::new("Band_Bin_Set").and_all(bins.into_iter().enumerate().map(bin));
        axis("Band", header.bands, number).and_all(widths.map(set))
    };
    let axes = match header.interleave {
        Interleave::Bsq => [band_axis(1), axis("Line", header.lines, 2), axis("Sample", header.samples, 3)],
        Interleave::Bil => [axis("Line", header.lines, 1), band_axis(2), axis("Sample", header.samples, 3)],
        Interleave::Bip => [axis("Line", header.lines, 1), axis("Sample", header.samples, 2), band_axis(3)],
    };
    let unit = header.field("data units").map(|unit| text("unit", unit));
    let constants = header.ignore.filter(|number| number.is_finite());
    let array = Element::new("Array_3D_Spectrum")
        .and(text("local_identifier", "image"))
        .and(text("offset", header.header_offset).with("unit", "byte"))
        .and(text("axes", 3))
        .and(text("axis_index_order", "Last Index Fastest"))
        .and(
            Element::new("Element_Array")
                .and(text("data_type", type_name(header.data_type, header.big_endian)))
                .and_all(unit),
        )
        .and_all(axes)
        .and_all(constants.map(|number| Element::new("Special_Constants").and(text("missing_constant", number))));
    let label = Element::new("Product_Observational")
        .with("xmlns", NAMESPACE)
        .with("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance")
        .with("xsi:schemaLocation", SCHEMA)
        .and(
            Element::new("Identification_Area")
                .and(text("logical_identifier", format!("urn:nasa:pds:simulated:images:{id}")))
                .and(text("version_id", "1.0"))
                .and(text("title", title))
                .and(text("information_model_version", MODEL))
                .and(text("product_class", "Product_Observational")),
        )
        .and(observation(title))
        .and(Element::new("File_Area_Observational").and(Element::new("File").and(text("file_name", name))).and(array));
    let path = data.with_extension("xml");
    std::fs::write(&path, label.write()).map_err(|e| Error::io(&path, "writing", e))
}

fn text(name: &str, value: impl ToString) -> Element {
    let value = value.to_string();
    Element::new(name).holding(value.as_str())
}

/// What an archive wants to know of an observation, as far as it goes.
fn observation(title: &str) -> Element {
    let unknown = |name: &str| Element::new(name).with("xsi:nil", "true").with("nilReason", "inapplicable");
    let reference = |to: &str, kind: &str| {
        Element::new("Internal_Reference")
            .and(text("lid_reference", format!("urn:nasa:pds:context:{to}")))
            .and(text("reference_type", kind))
    };
    let described = |name: &str, kind: &str| Element::new(name).and(text("name", UNKNOWN)).and(text("type", kind));
    let component =
        described("Observing_System_Component", "Instrument").and(text("description", format!("simulated: {title}")));
    Element::new("Observation_Area")
        .and(Element::new("Time_Coordinates").and(unknown("start_date_time")).and(unknown("stop_date_time")))
        .and(
            described("Investigation_Area", "Other Investigation")
                .and(reference("investigation:other_investigation.not_stated", "data_to_investigation")),
        )
        .and(Element::new("Observing_System").and(component))
        .and(
            described("Target_Identification", "Satellite")
                .and(reference("target:satellite.not_stated", "data_to_target")),
        )
}

/// A type of numbers by PDS4's name.
fn type_name(data_type: DataType, big_endian: bool) -> String {
    let order = if big_endian { "MSB" } else { "LSB" };
    match data_type {
        DataType::U8 => "UnsignedByte".to_owned(),
        DataType::I8 => "SignedByte".to_owned(),
        DataType::U16 => format!("Unsigned{order}2"),
        DataType::U32 => format!("Unsigned{order}4"),
        DataType::U64 => format!("Unsigned{order}8"),
        DataType::I16 => format!("Signed{order}2"),
        DataType::I32 => format!("Signed{order}4"),
        DataType::I64 => format!("Signed{order}8"),
        DataType::F32 => format!("IEEE754{order}Single"),
        DataType::F64 => format!("IEEE754{order}Double"),
    }
}
