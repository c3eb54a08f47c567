//! Rasters of numbers with a header beside them: ENVI and ILWIS.

use std::path::Path;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::envi::{self, Interleave, Scale};
use crate::formats::format::{Format, Holds, ending};
use crate::formats::ilwis;
use crate::formats::number::DataType;
use crate::report::{Fate, Report};

use super::names;
use super::place::Georeference;
use super::{BandReader, Raster, RasterBand, Target, check_length, check_size};
use crate::formats::flat::{AxisOrder, Flat};

/// An ENVI image: numbers, with a header beside them.
pub(in crate::formats) static ENVI: Format = Format {
    name: "envi",
    extensions: &envi::ENDINGS,
    reads: "images with .hdr: real numbers in any order",
    writes: "the same; .bil and .bip interleave bands so",
    mark: &[],
    told: Some(|path, beginning| is_envi(path, beginning).then(|| path.to_owned())),
    holds: Holds::Image {
        kind: "ENVI image",
        open: open_envi,
        target: Ok(|path| {
            Target::Envi(match ending(path).as_str() {
                "bil" => Interleave::Bil,
                "bip" => Interleave::Bip,
                _ => Interleave::Bsq,
            })
        }),
    },
};

/// An ILWIS 2 map, as DART writes images.
pub(in crate::formats) static ILWIS: Format = Format {
    name: "ilwis",
    extensions: &["mpr", "mp#"],
    reads: "maps of values",
    writes: "one band as DART writes it, with .grf",
    mark: &[],
    told: None,
    holds: Holds::Image { kind: "ILWIS map", open: open_ilwis, target: Ok(|_| Target::Ilwis) },
};

/// Whether a file is an image's: its numbers, called so, with a header beside them; or that header, which may be named like a library.
fn is_envi(path: &Path, beginning: &[u8]) -> bool {
    match ending(path).as_str() {
        "hdr" | "sli" => {
            let text = String::from_utf8_lossy(beginning).to_lowercase();
            let is_header = text.trim_start_matches('\u{feff}').starts_with("envi");
            is_header && !text.contains(&envi::SPECTRAL_LIBRARY.to_lowercase())
        }
        other => envi::ENDINGS.contains(&other) && envi::pair(path).is_ok(),
    }
}

/// Opens an ENVI image by its header or its data file.
pub(super) fn open_envi(path: &Path) -> Result<Raster> {
    let (header_path, data) = envi::pair(path)?;
    let header = envi::read_header(&header_path)?;
    let at = |key: &str| Location::file(&header_path).with_item(key);
    let unsupported = |key: &str, feature: &str| Err(Error::Unsupported { at: at(key), feature: feature.to_owned() });
    if header.is_library() {
        return unsupported("file type", "a spectral library as an image");
    }
    if header.field("file compression").is_some_and(|v| v.trim() != "0") {
        return unsupported("file compression", "a compressed ENVI image");
    }
    check_size(Location::file(&header_path), header.lines, header.samples, header.bands)?;
    let mut report = header.report.clone();
    let mut problems = Vec::new();
    let centres_um = match header.um(&header.wavelength) {
        Some((centres_um, taken)) => {
            if let Some(taken) = taken.filter(|_| !centres_um.is_empty()) {
                report.note(Fate::Defaulted, at("wavelength units"), format!("not given: taken as {taken}"));
            }
            centres_um
        }
        None => {
            let unit = header.field("wavelength units").unwrap_or_default();
            report.note(Fate::Dropped, at("wavelength"), format!("in {unit}, which is not a unit of wavelength"));
            Vec::new()
        }
    };
    // Names may say what the list of wavelengths does not.
    let of_names: Option<Vec<f64>> =
        header.band_names.iter().map(|name| Some(names::wavelength(name)?.centre_um)).collect();
    let centres_um = match of_names {
        Some(of_names) if centres_um.is_empty() && !of_names.is_empty() => {
            report.note(Fate::Defaulted, at("wavelength"), "not given: taken as the names of the bands say");
            of_names
        }
        _ => centres_um,
    };
    let fwhms_um = header.fwhm_um(&centres_um, &mut report).unwrap_or_default();
    let good = header.good(header.bands)?;
    // A band that is no part of the spectrum has none.
    let is_known = |i: usize| good[i] || centres_um[i] != 0.0;
    if let Some(i) =
        (0..centres_um.len()).position(|i| is_known(i) && !(centres_um[i] > 0.0 && centres_um[i].is_finite()))
    {
        problems.push(Problem::new(at("wavelength"), format!("that of band {} is not positive", i + 1)));
    }
    let scale = header.scales(header.bands, &mut problems);
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    let flat = Flat {
        rows: header.lines,
        columns: header.samples,
        bands: header.bands,
        start: header.header_offset,
        data_type: header.data_type,
        big_endian: header.big_endian,
        order: AxisOrder::from(header.interleave),
        has_heads: false,
    };
    if let Some(surplus) = check_length(&data, &flat, None, &header_path)? {
        report.note(Fate::Dropped, Location::file(&data), surplus);
    }
    let band = |i: usize| RasterBand {
        name: header.band_names.get(i).cloned().unwrap_or_default(),
        centre_um: centres_um.get(i).copied().filter(|_| is_known(i)),
        fwhm_um: fwhms_um.get(i).copied().filter(|um| *um > 0.0),
        is_bad: !good[i],
    };
    let data_type = if scale.is_empty() { header.data_type } else { DataType::F64 };
    let (georeference, mirrored) = Georeference::of_envi(&header, (at("map info"), &mut report)).unzip();
    let extra = header.fields.iter().filter(|(key, _)| !envi::KEYS.contains(&key.as_str())).cloned().collect();
    let bands = (0..header.bands).map(band).collect();
    Ok(Raster {
        unit: header.field("data units").map(str::to_owned).filter(|unit| !unit.is_empty()),
        ignore: header.ignore,
        report,
        scale,
        extra,
        georeference,
        mirrored: mirrored.unwrap_or_default(),
        files: vec![header_path, data.clone()],
        ..Raster::of(&data, (header.lines, header.samples), bands, data_type, BandReader::Flat(flat))
    })
}

/// Opens an ILWIS map by its header or its values.
pub(super) fn open_ilwis(path: &Path) -> Result<Raster> {
    let (header, header_path, values_path) = ilwis::open(path)?;
    let [rows, columns] = header.size();
    let store = header.store();
    check_size(Location::file(&header_path), rows, columns, 1)?;
    let flat = Flat {
        rows,
        columns,
        bands: 1,
        start: 0,
        data_type: store.data_type,
        big_endian: false,
        order: AxisOrder::BandRowColumn,
        has_heads: false,
    };
    if let Some(surplus) = check_length(&values_path, &flat, None, &header_path)? {
        let help = "its size, bands or type are others, or the header is another file's";
        let problem = Problem::new(Location::file(&values_path), surplus).with_help(help);
        return Err(Error::Invalid(vec![problem]));
    }
    let data_type = if store.scale.is_none() { store.data_type } else { DataType::F64 };
    let bands = vec![RasterBand::default()];
    let mut report = Report::default();
    let no_data = match store.data_type {
        DataType::F64 if store.scale.is_none() => ilwis::no_data_of_dart(&values_path)?,
        _ => None,
    };
    if let Some(no_data) = no_data {
        let message = format!("nothing is below {no_data}: taken for no data, as in images of DART");
        report.note(Fate::Defaulted, Location::file(&values_path), message);
    }
    Ok(Raster {
        ignore: no_data.or(store.undefined),
        report,
        scale: store
            .scale
            .map(|[step, offset]| Scale { gain: step, offset: offset * step, divisor: 1.0 })
            .into_iter()
            .collect(),
        place: ilwis::place(&header, &values_path)?,
        files: vec![header_path, values_path.clone()],
        ..Raster::of(&values_path, (rows, columns), bands, data_type, BandReader::Flat(flat))
    })
}
