//! Which of the named arrays of a file are an image, and what the others say of it: its wavelengths, and where it lies.
//!
//! NetCDF, Zarr and FITS hold any number of arrays. An image is one of three axes or, if there is none, all of two axes that are alike. An axis is one of
//! bands if it is called so, or if wavelengths belong to it; otherwise it is the first of three.

use std::path::Path;

use super::place::{Georeference, Grid, Unit};
use super::{BandReader, Raster, RasterBand, check_size, lengths};
use crate::error::{Error, Location, Problem, Result};
use crate::formats::number::DataType;
use crate::formats::wave_unit::WaveUnit;
use crate::report::{Fate, Report};

/// Arrays of one axis are read up to this length, to learn what belongs to that axis.
pub(super) const LONGEST: usize = 1 << 20;
/// What an axis of bands is called.
const BANDS: [&str; 9] =
    ["band", "bands", "wavelength", "wavelengths", "wl", "channel", "channels", "spectral", "wave"];
/// By how much of a step coordinates may be uneven, and still count as even: those of single precision are rounded.
const UNEVEN: f64 = 0.01;

/// An array of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Array {
    pub(super) name: String,
    /// Names and lengths of its axes, slowest first.
    pub(super) axes: Vec<(String, usize)>,
    /// Whether it holds numbers.
    pub(super) is_number: bool,
    pub(super) unit: Option<String>,
    pub(super) standard_name: Option<String>,
    /// Names of arrays that are its coordinates, besides those of its axes.
    pub(super) coordinates: Vec<String>,
    /// Names of its bands, parted by commas.
    pub(super) band_names: Option<String>,
    /// Its numbers, if it has one axis and is no longer than [`LONGEST`].
    pub(super) values: Option<Vec<f64>>,
}

/// Which axis is that of bands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BandAxis {
    /// Each array is a band.
    None,
    First,
    Last,
}

/// An image among the arrays.
#[derive(Debug)]
pub(super) struct Image {
    /// One array, or one for each band.
    pub(super) arrays: Vec<usize>,
    pub(super) band_axis: BandAxis,
    /// Axes before those of the image, of length 1.
    pub(super) before: usize,
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) bands: Vec<RasterBand>,
    pub(super) unit: Option<String>,
    pub(super) place: Option<(Georeference, [bool; 2])>,
    pub(super) report: Report,
}

/// The image that the arrays hold.
///
/// # Errors
/// [`Error::Invalid`] if there is none, or if it is larger than any that is read.
pub(super) fn image(path: &Path, arrays: &[Array]) -> Result<Image> {
    let of_image = |array: &Array| match array.axes[..] {
        [] | [_] => None,
        [_, _] | [_, _, _] => Some(0),
        ref more => {
            let before = more.len() - 3;
            more[..before].iter().all(|(_, length)| *length == 1).then_some(before)
        }
    };
    let is_coordinate = |array: &Array| {
        let name = array.name.to_lowercase();
        let is_named = arrays.iter().any(|other| other.name != array.name && other.coordinates.contains(&array.name));
        is_named || name.ends_with("_bnds") || ["lat", "lon", "latitude", "longitude"].contains(&name.as_str())
    };
    let mut candidates: Vec<usize> =
        (0..arrays.len()).filter(|i| arrays[*i].is_number && of_image(&arrays[*i]).is_some()).collect();
    let shown: Vec<usize> = candidates.iter().copied().filter(|i| !is_coordinate(&arrays[*i])).collect();
    if !shown.is_empty() {
        candidates = shown;
    }
    let depth = |i: usize| match arrays[i].axes.len() {
        2 => 1,
        axes => arrays[i].axes[axes - 3..].iter().map(|(_, length)| *length).min().unwrap_or(1),
    };
    // Of one band, an image of three axes comes before those of two, whatever the order.
    let has_three = |i: usize| arrays[i].axes.len() > 2;
    let of_rank =
        |rank: usize| candidates.iter().find(|i| usize::from(depth(**i) > 1) + usize::from(has_three(**i)) >= rank);
    let Some(&first) = of_rank(2).or_else(|| of_rank(1)).or(candidates.first()) else {
        let all: Vec<String> = arrays
            .iter()
            .take(20)
            .map(|array| {
                let lengths: Vec<String> = array.axes.iter().map(|(_, length)| length.to_string()).collect();
                format!("{} [{}]", array.name, lengths.join(", "))
            })
            .collect();
        let problem = Problem::new(Location::file(path), "holds no array of numbers with two or three axes")
            .with_help(format!("it holds {}", if all.is_empty() { "nothing".to_owned() } else { all.join(", ") }));
        return Err(Error::Invalid(vec![problem]));
    };
    let mut report = Report::default();
    let before = of_image(&arrays[first]).unwrap_or(0);
    let axes = &arrays[first].axes[before..];
    let (band_axis, chosen) = match axes.len() {
        2 => (BandAxis::None, candidates.iter().copied().filter(|i| arrays[*i].axes == arrays[first].axes).collect()),
        _ => (band_axis(arrays, axes), vec![first]),
    };
    let left: Vec<&str> = candidates.iter().filter(|i| !chosen.contains(i)).map(|i| arrays[*i].name.as_str()).collect();
    if !left.is_empty() {
        let more = if left.len() > 8 { ", ..." } else { "" };
        let message = format!("arrays beside {}: {}{more}", arrays[first].name, left[..left.len().min(8)].join(", "));
        report.note(Fate::Dropped, Location::file(path), message);
    }
    let [of_bands, of_rows, of_columns] = match (band_axis, axes) {
        (BandAxis::First, [b, r, c]) | (BandAxis::Last, [r, c, b]) => [Some(b), Some(r), Some(c)],
        (_, [r, c, ..]) => [None, Some(r), Some(c)],
        _ => [None; 3],
    };
    // Before anything is as long as a file says.
    let length = |axis: Option<&(String, usize)>| axis.map_or(0, |(_, length)| *length);
    let count = if of_bands.is_some() { length(of_bands) } else { chosen.len() };
    check_size(Location::file(path), length(of_rows), length(of_columns), count)?;
    let bands = match of_bands {
        Some(axis) => bands(path, arrays, (axis, arrays[first].band_names.as_deref()), &mut report),
        None => {
            let name = |i: &usize| if chosen.len() == 1 { String::new() } else { arrays[*i].name.clone() };
            chosen.iter().map(|i| RasterBand { name: name(i), ..RasterBand::default() }).collect()
        }
    };
    let unit = arrays[first].unit.clone().filter(|_| chosen.iter().all(|i| arrays[*i].unit == arrays[first].unit));
    let place = of_rows.zip(of_columns).and_then(|axes| place(path, arrays, axes, &mut report));
    Ok(Image {
        arrays: chosen,
        band_axis,
        before,
        rows: length(of_rows),
        columns: length(of_columns),
        bands,
        unit: unit.filter(|unit| !unit.trim().is_empty()),
        place,
        report,
    })
}

impl Image {
    /// The raster of a file whose numbers are read like this.
    pub(super) fn raster(self, path: &Path, data_type: DataType, reader: BandReader) -> Raster {
        let (georeference, mirrored) = self.place.unzip();
        Raster {
            unit: self.unit,
            georeference,
            mirrored: mirrored.unwrap_or_default(),
            report: self.report,
            ..Raster::of(path, (self.rows, self.columns), self.bands, data_type, reader)
        }
    }
}

/// Whether the first or the last of three axes is that of bands.
fn band_axis(arrays: &[Array], axes: &[(String, usize)]) -> BandAxis {
    let is_of_bands = |axis: &(String, usize)| {
        BANDS.contains(&axis.0.to_lowercase().as_str()) || of_axis(arrays, axis).any(is_wavelength)
    };
    match axes {
        [first, _, last] if is_of_bands(last) && !is_of_bands(first) => BandAxis::Last,
        _ => BandAxis::First,
    }
}

/// Arrays that have this axis alone.
fn of_axis<'a>(arrays: &'a [Array], axis: &'a (String, usize)) -> impl Iterator<Item = &'a Array> {
    arrays.iter().filter(move |array| array.axes.len() == 1 && array.axes[0] == *axis && array.values.is_some())
}

fn is_wavelength(array: &Array) -> bool {
    let name = array.name.to_lowercase();
    array.standard_name.as_deref() == Some("radiation_wavelength")
        || name.contains("wavelength")
        || ["wl", "wave", "lambda", "band_center", "centre", "center"].contains(&name.as_str())
}

/// What the bands are called, and where in the spectrum they are.
fn bands(
    path: &Path,
    arrays: &[Array],
    (axis, names): (&(String, usize), Option<&str>),
    report: &mut Report,
) -> Vec<RasterBand> {
    let mut bands = vec![RasterBand::default(); axis.1];
    let names: Vec<&str> = names.iter().flat_map(|names| names.split(',').map(str::trim)).collect();
    if names.len() == bands.len() {
        bands.iter_mut().zip(names).for_each(|(band, name)| band.name = name.to_owned());
    }
    let um = |array: &Array, report: &mut Report| {
        let at = Location::file(path).with_item(&array.name);
        let unit = array.unit.as_deref().unwrap_or_default();
        let Some(unit) = WaveUnit::of(unit) else {
            report.note(Fate::Dropped, at, format!("in {unit:?}, which is not a unit of wavelength"));
            return None;
        };
        let values: Option<Vec<f64>> = array.values.iter().flatten().map(|value| unit.um(*value)).collect();
        values.filter(|values| values.iter().all(|um| *um > 0.0 && um.is_finite())).map(|values| (unit, values))
    };
    let centres = of_axis(arrays, axis).find(|array| is_wavelength(array)).and_then(|array| um(array, report));
    if let Some((_, centres)) = centres {
        bands.iter_mut().zip(centres).for_each(|(band, um)| band.centre_um = Some(um));
    }
    let is_width = |array: &&Array| {
        let name = array.name.to_lowercase();
        name.contains("fwhm") || name.contains("bandwidth")
    };
    // A width in waves is another one for each wavelength.
    let of_length = |unit: WaveUnit| matches!(unit, WaveUnit::Um(_) | WaveUnit::PerUm(_));
    let widths = of_axis(arrays, axis).find(is_width).and_then(|array| um(array, report));
    if let Some((_, widths)) = widths.filter(|(unit, _)| of_length(*unit)) {
        bands.iter_mut().zip(widths).for_each(|(band, um)| band.fwhm_um = Some(um));
    }
    bands
}

/// Where rows and columns lie, by the arrays that are called like their axes.
fn place(
    path: &Path,
    arrays: &[Array],
    (rows, columns): (&(String, usize), &(String, usize)),
    report: &mut Report,
) -> Option<(Georeference, [bool; 2])> {
    let coordinates = |axis: &(String, usize)| {
        let array = of_axis(arrays, axis).find(|array| array.name == axis.0)?;
        let unit = array.unit.as_deref().unwrap_or_default().trim().to_lowercase();
        let unit = match unit.as_str() {
            "degrees_north" | "degree_north" | "degrees_n" | "degrees_east" | "degree_east" | "degrees_e"
            | "degrees" | "degree" | "deg" => Unit::Degrees,
            other => Unit::Metres(lengths::metres(other)?),
        };
        let values = array.values.as_ref()?;
        let (first, last) = (*values.first()?, *values.last()?);
        let step = (last - first) / (values.len().checked_sub(1).filter(|n| *n > 0)? as f64);
        let is_even = |(i, value): (usize, &f64)| (value - (first + i as f64 * step)).abs() <= UNEVEN * step.abs();
        (step != 0.0 && step.is_finite() && values.iter().enumerate().all(is_even)).then_some((unit, first, step))
    };
    let ((of_rows, y, down), (unit, x, along)) = (coordinates(rows)?, coordinates(columns)?);
    if of_rows != unit {
        return None;
    }
    let grid = Grid { corner: [x - 0.5 * along, y - 0.5 * down], along: [along, 0.0], across: [0.0, down] };
    Some(grid.upright(unit, [rows.1, columns.1], (Location::file(path).with_item(&rows.0), report)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(name: &str, axes: &[(&str, usize)], unit: &str, values: Option<Vec<f64>>) -> Array {
        Array {
            name: name.to_owned(),
            axes: axes.iter().map(|(name, length)| ((*name).to_owned(), *length)).collect(),
            is_number: true,
            unit: Some(unit.to_owned()),
            values,
            ..Array::default()
        }
    }

    #[test]
    fn the_image_is_the_array_of_three_axes() {
        let arrays = [
            array("RANGE", &[("line", 2), ("sample", 3)], "m", None),
            array("radiance", &[("band", 4), ("line", 2), ("sample", 3)], "W", None),
            array("wavelength", &[("band", 4)], "nm", Some(vec![1000.0, 1100.0, 1200.0, 1300.0])),
            array("fwhm", &[("band", 4)], "nm", Some(vec![10.0; 4])),
        ];
        let found = image(Path::new("a"), &arrays).unwrap();
        assert_eq!((&found.arrays[..], found.band_axis, found.rows, found.columns), (&[1][..], BandAxis::First, 2, 3));
        assert_eq!((found.bands[3].centre_um, found.bands[3].fwhm_um), (Some(1.3), Some(0.01)));
        assert_eq!(found.report.notes.len(), 1);
    }

    #[test]
    fn bands_may_be_the_last_axis_and_axes_before_them_of_one() {
        let arrays = [
            array("rad", &[("t", 1), ("y", 2), ("x", 3), ("bands", 4)], "", None),
            array("lat", &[("y", 2), ("x", 3)], "deg", None),
        ];
        let found = image(Path::new("a"), &arrays).unwrap();
        assert_eq!((found.band_axis, found.before, found.rows, found.columns), (BandAxis::Last, 1, 2, 3));
        assert_eq!((found.bands.len(), found.unit), (4, None));
    }

    #[test]
    fn arrays_of_two_axes_are_bands_and_lie_where_their_coordinates_say() {
        let arrays = [
            array("height", &[("lat", 3), ("lon", 4)], "m", None),
            array("slope", &[("lat", 3), ("lon", 4)], "m", None),
            array("lat", &[("lat", 3)], "degrees_north", Some(vec![-10.0, 0.0, 10.0])),
            array("lon", &[("lon", 4)], "degrees_east", Some(vec![0.0, 90.0, 180.0, 270.0])),
        ];
        let found = image(Path::new("a"), &arrays).unwrap();
        assert_eq!((&found.arrays[..], found.band_axis), (&[0, 1][..], BandAxis::None));
        assert_eq!(found.bands[1].name, "slope");
        let (place, mirrored) = found.place.unwrap();
        // Rows go to the North in the file: the first is the last.
        assert_eq!(mirrored, [true, false]);
        assert_eq!(place, Georeference::Degrees { corner_deg: [-45.0, 15.0], pixel_deg: [90.0, 10.0] });
    }

    #[test]
    fn what_no_memory_holds_is_refused_before_it_is_asked_for() {
        for axes in [[usize::MAX / 2, 2, 2], [2, usize::MAX / 2, 2], [2, 2, usize::MAX / 2], [1 << 17, 1, 1]] {
            let arrays = [array("a", &[("band", axes[0]), ("y", axes[1]), ("x", axes[2])], "", None)];
            let error = image(Path::new("a"), &arrays).unwrap_err().to_string();
            assert!(error.contains("are more than"), "{error}");
        }
    }

    #[test]
    fn nothing_of_two_axes_is_no_image() {
        let error = image(Path::new("a"), &[array("t", &[("t", 3)], "s", None)]).unwrap_err().to_string();
        assert!(error.contains("holds no array") && error.contains("t [3]"), "{error}");
    }
}
