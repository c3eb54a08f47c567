//! Radiance of facets that needs no map file: the forms listed in the [module](super) above.

use std::path::Path;

use super::values::FacetTexels;
use crate::error::{Error, Location, Problem, Result};
use crate::formats::input::{self, InputFile, Problems};
use crate::formats::raster::npy::NPZ;
use crate::formats::spectrum_csv::CSV;
use crate::formats::{Format, npz, registry};
use crate::product::{Placement, RadianceMap, SkyShare};
use crate::spectral::Band;

/// Name of the array or columns.
pub(super) const RADIANCE: &str = npz::RADIANCE;
/// No table is longer, bytes.
const LIMIT: u64 = 16 << 30;

/// The format of a file that may be a table of facets.
fn form(path: &Path) -> Option<&'static Format> {
    registry::called(path, |format| [&NPZ, &CSV].contains(&format))
}

/// A table of facets; `None` if it is something else.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with all that is wrong in the table; [`Error::Syntax`] for a damaged `.npz`.
pub(super) fn open(path: &Path, weight: f64) -> Result<Option<(RadianceMap, InputFile)>> {
    let (texels, input) = match form(path) {
        Some(format) if *format == NPZ => {
            if !npz::list(path)?.1.iter().any(|array| array.name == RADIANCE) {
                return Ok(None);
            }
            of_npz(path)?
        }
        Some(_) => {
            let (text, input) = input::text(path, LIMIT)?;
            if !text.lines().next().is_some_and(|line| line.contains(RADIANCE)) {
                return Ok(None);
            }
            (of_csv(path, &text)?, input)
        }
        None => return Ok(None),
    };
    texels.check()?;
    let facets = texels.values.len() / texels.bands.len();
    let map = RadianceMap {
        name: path.display().to_string(),
        placement: Placement::Facets(facets),
        source: Box::new(texels),
        weight,
        light: vec![],
        sky: SkyShare::LeftOut,
        registration: None,
    };
    Ok(Some((map, input)))
}

/// What a file lacks of a table of facets, if it is of a form that one has: which arrays or columns are there instead.
pub(super) fn missing(path: &Path) -> Result<Option<Problem>> {
    let (what, there) = match form(path) {
        Some(format) if *format == NPZ => {
            let named = |array: &npz::ArrayInfo| format!("{} {:?}", array.name, array.shape);
            ("array", npz::list(path)?.1.iter().map(named).collect::<Vec<_>>())
        }
        Some(_) => {
            let (text, _) = input::text(path, LIMIT)?;
            let header = text.lines().next().unwrap_or_default();
            if !header.split(',').next().is_some_and(|name| name.trim().eq_ignore_ascii_case("facet")) {
                return Ok(None);
            }
            ("column", header.split(',').map(|name| name.trim().to_owned()).collect())
        }
        None => return Ok(None),
    };
    let there = if there.is_empty() { "nothing".to_owned() } else { there.join(", ") };
    Ok(Some(Problem::new(Location::file(path), format!("has no {what} `{RADIANCE}`; it has {there}"))))
}

fn of_npz(path: &Path) -> Result<(FacetTexels, InputFile)> {
    let columns = npz::read_f64s(path, &[RADIANCE, "wavelength_um", "fwhm_um"])?;
    let [radiance, wavelength, fwhm] = &columns[..] else {
        return Err(Error::invalid(Location::file(path), "cannot be used"));
    };
    let at = |item: &str| Location::file(path).with_item(item);
    let (Some((shape, values)), Some((_, wavelength_um))) = (radiance, wavelength) else {
        let names: Vec<String> = npz::list(path)?.1.into_iter().map(|array| array.name).collect();
        let message = format!("is missing: the wavelengths of the bands, um; it has {}", names.join(", "));
        return Err(Error::invalid(at("wavelength_um"), message));
    };
    let bands = wavelength_um.len();
    if shape.len() != 2 || shape[1] != bands || bands == 0 {
        let message = format!("has the shape {shape:?}; with {bands} wavelengths it is (facets, {bands})");
        return Err(Error::invalid(at(RADIANCE), message));
    }
    if let Some((_, widths)) = fwhm
        && widths.len() != bands
    {
        return Err(Error::invalid(at("fwhm_um"), format!("{} widths for {bands} bands", widths.len())));
    }
    let width = |i: usize| fwhm.as_ref().map(|(_, w)| w[i]).filter(|w| *w != 0.0);
    let bands = wavelength_um.iter().enumerate().map(|(i, um)| Band::new(*um, width(i))).collect();
    let length = std::fs::metadata(path).map_err(|e| Error::io(path, "reading", e))?.len();
    let input = InputFile::of(path, &input::bytes(path, length)?);
    Ok((FacetTexels { path: path.to_owned(), bands, values: values.clone() }, input))
}

fn of_csv(path: &Path, text: &str) -> Result<FacetTexels> {
    let mut problems = Problems::default();
    let mut bands = Vec::new();
    let mut values = Vec::new();
    let mut start = 0;
    let mut facet = 0_usize;
    for (number, raw) in text.split_inclusive('\n').enumerate() {
        let line = raw.trim();
        let at =
            |message: String| Problem::new(Location::span(path, text, start, start + raw.trim_end().len()), message);
        let mut cells = line.split(',').map(str::trim);
        let first = cells.next().unwrap_or_default();
        if number == 0 {
            if first != "facet" {
                problems.push(|| at(format!("the first column is {first:?}, which should be facet")));
            }
            for cell in cells {
                let um = cell.strip_prefix(RADIANCE).map(str::trim).and_then(|c| c.strip_prefix("at"));
                match um.and_then(|c| c.trim().strip_suffix("um")).and_then(|c| c.trim().parse::<f64>().ok()) {
                    Some(centre_um) => bands.push(Band::new(centre_um, None)),
                    None => problems.push(|| at(format!("the column {cell:?} is not as in \"{RADIANCE} at 0.95 um\""))),
                }
            }
            if bands.is_empty() {
                problems.push(|| at("there is no column of a band".into()));
            }
        } else if !line.is_empty() {
            if first.parse() != Ok(facet) {
                problems.push(|| {
                    at(format!("facet {first:?} where {facet} belongs: one line for each facet, in order, from 0"))
                });
            }
            facet += 1;
            let before = values.len();
            values.extend(
                cells
                    .map(|cell| match cell {
                        "" => Ok(f64::NAN),
                        cell => fast_float2::parse::<f64, _>(cell).map_err(|_| cell.to_owned()),
                    })
                    .filter_map(|value| {
                        value.map_err(|cell| problems.push(|| at(format!("{cell:?} is not a number")))).ok()
                    }),
            );
            if values.len() - before != bands.len() && problems.is_empty() {
                problems.push(|| at(format!("{} values for {} bands", values.len() - before, bands.len())));
            }
        }
        start += raw.len();
    }
    problems.finish(path)?;
    Ok(FacetTexels { path: path.to_owned(), bands, values })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_csv_names_its_bands() {
        let text = "facet,radiance_w_m2_sr_um at 0.95 um,radiance_w_m2_sr_um at 1.5 um\n0,1,2\n1,,4e-3\n";
        let table = of_csv(Path::new("t.csv"), text).unwrap();
        assert_eq!(table.bands.iter().map(|b| b.centre_um).collect::<Vec<_>>(), [0.95, 1.5]);
        assert_eq!((table.values[1], table.values[3], table.values[2].is_nan()), (2.0, 0.004, true));
    }

    #[test]
    fn what_is_wrong_in_a_csv_is_told_at_its_line() {
        let text = "facet,radiance_w_m2_sr_um at 0.95 um,radiance_w_m2_sr_um\n0,1,x\n7,2,3\n";
        let message = of_csv(Path::new("t.csv"), text).unwrap_err().to_string();
        for part in [
            "t.csv:1:1: the column \"radiance_w_m2_sr_um\" is not as in",
            "t.csv:2:1: \"x\" is not a number",
            "t.csv:3:1: facet \"7\" where 1",
        ] {
            assert!(message.contains(part), "{message}");
        }
    }
}
