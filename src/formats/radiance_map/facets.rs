//! Radiance of facets that needs no map file: the forms listed in the [module](super) above.

use std::path::Path;

use glam::DVec3;

use super::values::FacetTexels;
use crate::error::{Error, Location, Problem, Result};
use crate::formats::input::{self, InputFile, Problems};
use crate::formats::raster::npy::NPZ;
use crate::formats::spectrum_csv::CSV;
use crate::formats::{Format, npz, registry};
use crate::geometry::angle_rad;
use crate::product::{Placement, RadianceMap, SkyShare};
use crate::scene::Scene;
use crate::spectral::Band;
use crate::study;

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

/// Directions that differ by no more than this, rad, are one to a surface: its reflectance hardly changes between them.
const SAME_DIRECTION_RAD: f64 = 1e-2;

/// What is doubtful in using radiance of facets that this program wrote for a scene: it is of one observer, and of one light.
///
/// # Errors
/// [`Error::Invalid`] for facets of another mesh; [`Error::Io`]; [`Error::Syntax`] for a damaged `.npz`.
pub(super) fn doubts(path: &Path, scene: &Scene) -> Result<Vec<String>> {
    let header = if form(path) == Some(&NPZ) { npz::list(path)?.0 } else { None };
    let Some(header) = header.filter(|header| header.format == npz::FACET_RADIANCE.0) else { return Ok(vec![]) };
    let name = path.display();
    let Some(npz::FacetsSeen { mesh, at_m, towards }) = &header.seen else {
        return Ok(vec![format!(
            "{name} does not say of which mesh it is, nor towards whom: an older version wrote it"
        )]);
    };
    if *mesh != study::mesh_id(&scene.body) {
        let problem = Problem::new(
            Location::file(path),
            "is radiance of the facets of another mesh, or of one with another `origin_m`",
        );
        let help = "make it for this scene: mmxrt solve SCENE -o TABLE.npz --radiance camera";
        return Err(Error::Invalid(vec![problem.with_help(help)]));
    }
    let mut doubts = Vec::new();
    let solved = header.models.and_then(|models| scene.by(models).ok());
    if solved.is_none_or(|solved| study::table_id(&solved) != header.scene) {
        doubts.push(format!("{name} was solved for another Sun, Mars, lamps or heat than the scene's: the image shows what the file says"));
    }
    let off_rad = off_rad(scene, *at_m, *towards);
    if off_rad.is_none_or(|off_rad| off_rad > SAME_DIRECTION_RAD) {
        let by = off_rad.map_or(String::new(), |off_rad| format!(" by up to {:.1} deg", off_rad.to_degrees()));
        doubts.push(format!(
            "{name} is radiance towards another observer than the scene's camera, off{by}: what a surface sends depends on the direction, and facets that face away \
             from that observer are not known; `mmxrt solve SCENE -o TABLE.npz --radiance camera` makes it for the camera"
        ));
    }
    Ok(doubts)
}

/// The largest angle between an observer, body-fixed, and the camera, seen from the corners of the scene's box; `None` without an observer or a surface.
fn off_rad(scene: &Scene, at_m: Option<[f64; 3]>, towards: Option<[f64; 3]>) -> Option<f64> {
    let (low_m, high_m) = scene.body.bounds_m()?;
    let of_corner = |i: u32| -> Option<f64> {
        let corner_m = DVec3::from_array(std::array::from_fn(|k| if i >> k & 1 == 0 { low_m[k] } else { high_m[k] }));
        let observer = match (at_m, towards) {
            (Some(at_m), _) => DVec3::from_array(at_m) - scene.body.origin_m - corner_m,
            (None, Some(towards)) => DVec3::from_array(towards),
            (None, None) => return None,
        };
        Some(angle_rad(observer, scene.exposure.camera.centre_m() - corner_m))
    };
    (0..8).map(of_corner).try_fold(0.0, |most: f64, of| Some(most.max(of?)))
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
