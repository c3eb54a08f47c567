//! A cube with its bands and backplanes as named arrays, by the CF conventions ("NetCDF Climate and Forecast Metadata Conventions", version 1.11).

use std::borrow::Cow;

use super::RasterBand;
use super::place::Georeference;
use crate::formats::dataset::{Attributes, Axis, Dataset, Names, Text, Value, Variable};
use crate::formats::number::DataType;
use crate::product::Backplanes;

/// What is said of a cube besides its numbers.
#[derive(Debug, Clone, Default)]
pub(in crate::formats) struct CubeNotes<'a> {
    /// What its numbers are, as a name and in words.
    pub(in crate::formats) quantity: (&'a str, &'a str),
    /// Their unit, if they have one.
    pub(in crate::formats) unit: Option<&'a str>,
    /// The number in the file that stands for no data, of whole numbers; of others that is NaN.
    pub(in crate::formats) no_data: Option<f64>,
    /// What describes all of it.
    pub(in crate::formats) attributes: Attributes,
    pub(in crate::formats) texts: Vec<Text>,
}

/// The axes of a cube in a dataset.
const BAND: usize = 0;
const LINE: usize = 1;
const SAMPLE: usize = 2;

/// A cube of so many lines and samples, whose numbers are to come, and the planes that belong to it.
pub(super) fn of_cube<'a>(
    [lines, samples]: [usize; 2],
    bands: &[RasterBand],
    data_type: DataType,
    planes: Option<&'a Backplanes>,
    place: Option<&Georeference>,
    notes: CubeNotes<'_>,
) -> Dataset<'a> {
    let mut names = Names::default();
    let lies = place.and_then(|place| lying(place, [lines, samples]));
    let (of_lines, of_samples) = lies.as_ref().map_or(("line", "sample"), |[y, x]| (y.0, x.0));
    let axes = [("band", bands.len()), (of_lines, lines), (of_samples, samples)];
    let mut variables = Vec::new();
    let (quantity, words) = notes.quantity;
    let mut attributes: Attributes = vec![("long_name", words.into())];
    attributes.extend(notes.unit.map(|unit| ("units", unit.into())));
    let (name, mut coordinates) = (names.of(quantity), Vec::new());
    let mut of_bands = Vec::new();
    for (called, words, values) in [
        ("wavelength", "centre of the band", bands.iter().map(|b| b.centre_um).collect::<Option<Vec<f64>>>()),
        ("fwhm", "full width of the band at half its maximum", bands.iter().map(|b| b.fwhm_um).collect()),
    ] {
        let Some(values) = values else { continue };
        let name = names.of(called);
        coordinates.push(name.clone());
        let mut attributes: Attributes = vec![("long_name", words.into()), ("units", "um".into())];
        if called == "wavelength" {
            attributes.push(("standard_name", "radiation_wavelength".into()));
        }
        of_bands.push(Variable {
            name,
            axes: vec![BAND],
            data_type: DataType::F64,
            attributes,
            values: Some(Cow::Owned(values)),
        });
    }
    for ((name, standard, unit, values), axis) in lies.into_iter().flatten().zip([LINE, SAMPLE]) {
        of_bands.push(Variable {
            name: names.of(name),
            axes: vec![axis],
            data_type: DataType::F64,
            attributes: vec![("standard_name", standard.into()), ("units", unit.into())],
            values: Some(Cow::Owned(values)),
        });
    }
    let mut of_planes = Vec::new();
    for plane in planes.iter().flat_map(|planes| &planes.planes) {
        let name = names.of(&plane.name);
        let units = match (plane.name.as_str(), plane.unit.as_str()) {
            ("LATITUDE", "deg") => "degrees_north",
            ("LONGITUDE", "deg") => "degrees_east",
            (_, "deg") => "degree",
            (_, "index from 0") => "1",
            (_, unit) => unit,
        };
        if matches!(units, "degrees_north" | "degrees_east") {
            coordinates.push(name.clone());
        }
        let mut attributes: Attributes = vec![("long_name", Value::Text(plane.about())), ("units", units.into())];
        match units {
            "degrees_north" => attributes.push(("standard_name", "latitude".into())),
            "degrees_east" => attributes.push(("standard_name", "longitude".into())),
            _ => {}
        }
        attributes.push(("_FillValue", Value::Sample(f64::NAN)));
        of_planes.push(Variable {
            name,
            axes: vec![LINE, SAMPLE],
            data_type: DataType::F64,
            attributes,
            values: Some(Cow::Borrowed(&plane.values)),
        });
    }
    if !coordinates.is_empty() {
        attributes.push(("coordinates", Value::Text(coordinates.join(" "))));
    }
    if bands.iter().any(|band| !band.name.is_empty()) {
        let all: Vec<&str> = bands.iter().map(|band| band.name.as_str()).collect();
        attributes.push(("band_names", Value::Text(all.join(", "))));
    }
    let bad: Vec<String> = (1..).zip(bands).filter(|(_, band)| band.is_bad).map(|(i, _)| i.to_string()).collect();
    if !bad.is_empty() {
        attributes.push(("bad_bands", Value::Text(bad.join(", "))));
    }
    let no_data = if data_type.is_integer() { notes.no_data } else { Some(f64::NAN) };
    attributes.extend(no_data.map(|number| ("_FillValue", Value::Sample(number))));
    let cube_axes = vec![BAND, LINE, SAMPLE];
    variables.push(Variable { name, axes: cube_axes, data_type, attributes, values: None });
    variables.extend(of_bands);
    variables.extend(of_planes);
    let axes = axes.map(|(name, length)| Axis { name, length }).to_vec();
    Dataset { axes, variables, texts: notes.texts, attributes: notes.attributes }
}

/// A coordinate along an axis: its name, its standard name, its unit, and its values at the middles of pixels.
type Coordinate = (&'static str, &'static str, &'static str, Vec<f64>);

/// Coordinates of lines and samples, of a map that lies somewhere.
fn lying(place: &Georeference, [lines, samples]: [usize; 2]) -> Option<[Coordinate; 2]> {
    let middles = |corner: f64, step: f64, count: usize| (0..count).map(|i| corner + (i as f64 + 0.5) * step).collect();
    match place {
        Georeference::Plane { corner_m: [x, y], along_line_m, line_to_line_m } => Some([
            ("y", "projection_y_coordinate", "m", middles(*y, -line_to_line_m, lines)),
            ("x", "projection_x_coordinate", "m", middles(*x, *along_line_m, samples)),
        ]),
        Georeference::Degrees { corner_deg: [west, north], pixel_deg: [width, height] } => Some([
            ("lat", "latitude", "degrees_north", middles(*north, -height, lines)),
            ("lon", "longitude", "degrees_east", middles(*west, *width, samples)),
        ]),
        Georeference::Turned(_) | Georeference::Other(_) => None,
    }
}
