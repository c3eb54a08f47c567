//! Images of parallel views: where their texels lie, and the radiance that they hold.
//!
//! Rows run along the azimuth of the direction to the viewer, columns along that plus 90 deg, as one sees it from above: the
//! image lies in the plane that faces the viewer, so that on the ground a row is pixel / cos(zenith angle) and a column is a
//! pixel. A point at height z above the scene's bottom appears where its line of sight meets the ground: z tan(zenith angle)
//! away from the viewer.

use std::path::{Path, PathBuf};

use glam::{DMat2, DVec2, DVec3};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::ilwis;
use crate::geometry::{Camera, Direction, ParallelCamera, Pose, Projection};
use crate::physics::{blackbody, reflectance};
use crate::product::{Placement, RadianceMap, Registration, TexelSource, ViewImage};
use crate::progress::Watch;
use crate::scene::Scene;
use crate::spectral::{Band, KnownLight};

use super::georef::{self, Corners};
use super::properties::Properties;
use super::register::{self, Found};
use super::{ImageQuantity, OutputMapOptions, OutputView, RegistrationMode, frame};

/// Angles have six digits behind the point in `simulation.properties.txt`, one in names, deg.
pub(super) const PROPERTY_ROUNDING_DEG: f64 = 0.5e-6;
pub(super) const NAME_ROUNDING_DEG: f64 = 0.05;
/// Corners that are farther than this share of a pixel from where size and direction put them, beyond rounding, are not those
/// of the image.
const CORNER_TOLERANCE: f64 = 0.01;
/// The number that means "no value".
const NOTHING: f64 = -1.0;

/// Zenith angle and azimuth of a name's `VZ=022_4_VA=090_0`, deg.
pub(super) fn angles_of_name(angles: &str) -> Option<[f64; 2]> {
    let (zenith, azimuth) = angles.strip_prefix("VZ=")?.split_once("_VA=")?;
    let number = |text: &str| {
        let is_plain = text.bytes().all(|b| b.is_ascii_digit() || b == b'_');
        text.replacen('_', ".", 1).parse::<f64>().ok().filter(|_| is_plain)
    };
    Some([number(zenith)?, number(azimuth)?])
}

/// A view as a map of a scene in whose frame DART's is at `pose`.
pub(super) fn map(
    view: &OutputView,
    properties: &Properties,
    pose: Result<Pose>,
    scene: &Scene,
    options: &OutputMapOptions,
    watch: Watch<'_>,
) -> Result<(RadianceMap, Option<String>)> {
    let mut problems = Vec::new();
    let pose = keep(pose, &mut problems)?;
    let image = keep(Image::read(view, properties), &mut problems)?;
    let units = keep(units(view, properties, options.irradiance_w_m2_um.as_deref()), &mut problems)?;
    let (Some(pose), Some(image), Some(units)) = (pose, image, units) else { return Err(Error::Invalid(problems)) };
    let [Ok(lines), Ok(samples)] = image.size.map(u32::try_from) else {
        let message = format!("{} x {} pixels are too many in a line", image.size[1], image.size[0]);
        return Err(Error::invalid(Location::file(&view.bands[0].path), message));
    };
    let at = |shift_texels| {
        let camera = Camera::Parallel(image.camera(&pose, view.towards(&pose), [lines, samples], shift_texels));
        ViewImage { camera, occlusion: true }
    };
    let mut source = ImageTexels {
        bands: view.bands.iter().map(|b| b.band.clone()).collect(),
        images: view.bands.iter().map(|b| b.path.clone()).zip(units).collect(),
        texels: image.size.iter().product(),
    };
    let name = format!("DART {} ({} {})", view.name, view.quantity.name(), view.iteration);
    let (shift_texels, registration, note) = match options.placing {
        RegistrationMode::Shifted(shift_texels) => (shift_texels, None, None),
        RegistrationMode::Outline | RegistrationMode::Forced => {
            let mut values = Vec::new();
            source.read(0, &mut values)?;
            let valid: Vec<bool> = values.iter().map(|value| !value.is_nan()).collect();
            match register::register(&at([0.0; 2]), &valid, scene, watch)? {
                Found::Nothing(why) => {
                    ([0.0; 2], None, Some(format!("{name}: {why}: it lies where its printed corners put it")))
                }
                Found::Place(found) => {
                    // Where all texels have values, they may be of what lies around the scene: there is no outline that could be another's.
                    let is_full = !valid.contains(&false);
                    let is_misfit = found.overlap[1] < LEAST_OVERLAP;
                    if options.placing == RegistrationMode::Outline && is_misfit && !is_full {
                        return Err(misfit(&found, &view.bands[0].path));
                    }
                    let moved = (found.shift_texels != [0.0; 2] || is_misfit && !is_full).then(|| told(&name, &found));
                    // Images from the zenith have always been found where their corners are.
                    let is_oblique = view.towards_deg[0] != 0.0;
                    let is_open = found.unverified_m != [0.0; 2] && (is_oblique || moved.is_some() || is_misfit);
                    let open = is_open.then(|| unverified(&name, &found, is_misfit));
                    let note = [moved, open].into_iter().flatten().reduce(|a, b| format!("{a}; {b}"));
                    (found.shift_texels, Some(found), note)
                }
            }
        }
    };
    let view_image = at(shift_texels);
    overlaps(&view_image.camera.projection(), image.size, scene, &view.bands[0].path)?;
    let map = RadianceMap {
        name,
        placement: Placement::View(Box::new(view_image)),
        source: Box::new(source),
        weight: 1.0,
        light: view.bands.iter().map(|band| light(view.quantity, properties.light(band.number))).collect(),
        sky: options.sky,
        registration,
    };
    Ok((map, note))
}

/// An apparent temperature is of heat, whatever the mode.
fn light(quantity: ImageQuantity, of_mode: KnownLight) -> KnownLight {
    match quantity {
        ImageQuantity::Tapp => KnownLight { heat: Some(true), ..of_mode },
        ImageQuantity::Brf | ImageQuantity::Radiance => of_mode,
    }
}

/// An image whose outline has less than this in common with the scene's, after the best shift, is not one of this scene.
const LEAST_OVERLAP: f64 = 0.95;

/// Where an image was found to lie, in words.
fn told(name: &str, found: &Registration) -> String {
    // Not "-0.00".
    let hundredths = |x: f64| (100.0 * x).round() / 100.0 + 0.0;
    let ([columns, rows], [x_m, y_m]) = (found.shift_texels.map(hundredths), found.shift_m.map(hundredths));
    let [printed, shifted] = found.overlap;
    format!(
        "{name}: by its outline, what it shows lies {columns:.2} columns and {rows:.2} rows ({x_m:.2} m and {y_m:.2} m) beyond its printed \
         corners, and is moved there: {:.1} % of its outline fit the scene's, {:.1} % as printed",
        100.0 * shifted,
        100.0 * printed
    )
}

/// The note that an image's outline does not determine where it lies.
fn unverified(name: &str, found: &Registration, is_misfit: bool) -> String {
    let axes = found.unverified_m.iter().zip(["columns", "rows"]).filter(|(far_m, _)| **far_m > 0.0);
    let far: Vec<String> = axes.map(|(far_m, axis)| format!("{far_m:.2} m along its {axis}")).collect();
    let much = if is_misfit {
        let beside = 100.0 * (1.0 - found.overlap[1]);
        format!(", and {beside:.1} % of its texels have values although they lie outside the scene")
    } else {
        String::new()
    };
    format!(
        "{name}: its position is not verified: no outline shows it{much}; it may be off by up to {} (oblique images of DART-FT 5.7.4 lay up to \
         {KNOWN_ERROR_M} m beside their printed corners); `shift_texels` in a map file places it",
        far.join(" and ")
    )
}

/// The distance from their printed corners at which oblique images have been found, m.
const KNOWN_ERROR_M: f64 = 3.6;

fn misfit(found: &Registration, path: &Path) -> Error {
    let Registration { shift_texels: [columns, rows], overlap: [printed, shifted], .. } = found;
    let message = format!(
        "its outline has {:.1} % in common with the scene's where its corners put it, and {:.1} % at best, {columns:.2} columns and {rows:.2} rows \
         beyond: below {:.0} % it is not an image of this scene",
        100.0 * printed,
        100.0 * shifted,
        100.0 * LEAST_OVERLAP
    );
    let problem = Problem::new(Location::file(path), message).with_help(
        "give the scene that the simulation was made of, all of it; else say in a map file `registration = \"printed\"` (as its corners say), \
         `registration = \"forced\"` (as it fits best), or the shift, `shift_texels = [columns, rows]`",
    );
    Error::Invalid(vec![problem])
}

/// The value, if there is one; problems are collected.
fn keep<T>(found: Result<T>, problems: &mut Vec<Problem>) -> Result<Option<T>> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(Error::Invalid(more)) => {
            problems.extend(more);
            Ok(None)
        }
        Err(other) => Err(other),
    }
}

/// Where an image lies in DART's frame.
struct Image {
    /// Rows and columns.
    size: [usize; 2],
    corners: Corners,
    /// From the scene to the viewer.
    towards: DVec3,
    /// Height of the plane that the corners lie in, m.
    bottom_m: f64,
}

impl Image {
    fn read(view: &OutputView, properties: &Properties) -> Result<Self> {
        let mut problems = Vec::new();
        let mut headers = Vec::new();
        for band in &view.bands {
            match ilwis::read_header(&band.path) {
                Ok(header) => headers.push((header, &band.path)),
                Err(error) => problems.extend(error.problems()),
            }
        }
        for (header, path) in headers.iter().skip(1) {
            let ([rows, columns], [r, c]) = (headers[0].0.size(), header.size());
            if [rows, columns] != [r, c] {
                let message = format!("{r} rows of {c} columns, but {rows} of {columns} in {}", headers[0].1.display());
                problems.push(Problem::new(Location::file(path), message));
            }
        }
        let bottom_m = properties.bottom_m().map_err(|p| problems.push(p)).unwrap_or_default();
        let Some((header, path)) = headers.first() else { return Err(Error::Invalid(problems)) };
        let size = header.size();
        let Some(pixel_m) = header.pixel_m() else {
            let message = "says no `CoordBounds=`: the size of a pixel is not known";
            problems.push(Problem::new(Location::file(path), message));
            return Err(Error::Invalid(problems));
        };
        match georef::read(path, view.number, size) {
            Ok((corners, at)) => {
                problems.extend(disagreement(view, size, pixel_m, &corners, at));
                let image = Image { size, corners, towards: frame::vector(view.towards_deg), bottom_m };
                if problems.is_empty() { Ok(image) } else { Err(Error::Invalid(problems)) }
            }
            Err(error) => {
                problems.extend(error.problems());
                Err(Error::Invalid(problems))
            }
        }
    }

    /// The camera that took it, seen `towards` which it looks back, the scene's frame being at `pose`.
    fn camera(
        &self,
        pose: &Pose,
        towards: Direction,
        [lines, samples]: [u32; 2],
        shift_texels: [f64; 2],
    ) -> ParallelCamera {
        let [rows, columns] = self.size.map(|n| n as f64);
        let [origin, end_of_rows, _, end_of_columns] = self.corners.xy_m;
        // From row and column to the ground, and back.
        let ground = DMat2::from_cols((end_of_rows - origin) / rows, (end_of_columns - origin) / columns);
        let texels = ground.inverse().transpose();
        let displacement = self.towards.truncate() / self.towards.z;
        let step = |per_m: DVec2| pose.vector(per_m.extend(-per_m.dot(displacement)));
        let origin_m = pose.point(origin.extend(self.bottom_m));
        ParallelCamera {
            towards,
            samples,
            lines,
            sample_per_m: step(texels.y_axis),
            line_per_m: step(texels.x_axis),
            origin_m,
            origin_px: shift_texels,
        }
    }
}

/// What is wrong with an image's corners, if they are not where its size, its pixel and the direction put them.
fn disagreement(
    view: &OutputView,
    size: [usize; 2],
    pixel_m: [f64; 2],
    corners: &Corners,
    at: Location,
) -> Option<Problem> {
    let towards = frame::vector(view.towards_deg);
    let down = frame::horizontal(view.towards_deg[1]);
    let along = [size[0] as f64 * pixel_m[0] / towards.z, size[1] as f64 * pixel_m[1]];
    let (rows, columns) = (along[0] * down, along[1] * down.perp());
    let origin = corners.xy_m[0];
    let expected = [origin, origin + rows, origin + rows + columns, origin + columns];
    let rounding_rad = view.rounding_deg.to_radians();
    let tilt = towards.x.hypot(towards.y) / towards.z;
    let tolerance_m = CORNER_TOLERANCE * pixel_m[0].min(pixel_m[1])
        + rounding_rad * (along[0] * (1.0 + tilt) + along[1])
        + 4.0 * corners.rounding_m;
    let off = |other: [DVec2; 4]| corners.xy_m.iter().zip(other).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
    let worst_m = off(expected);
    if worst_m <= tolerance_m {
        return None;
    }
    let [a, b, _, d] = corners.xy_m;
    let message = format!(
        "the corners span {:.6} m by {:.6} m, {:.3} m from where {} rows and {} columns of {} m, seen from zenith angle {} and azimuth {} deg, put them \
         ({:.6} m by {:.6} m)",
        a.distance(b),
        a.distance(d),
        worst_m,
        size[0],
        size[1],
        pixel_m[0],
        view.towards_deg[0],
        view.towards_deg[1],
        along[0],
        along[1],
    );
    let [p, q, r, s] = expected;
    let help = if off([p, s, r, q]) <= tolerance_m {
        "rows and columns are swapped: an image's `Size` is rows, then columns"
    } else {
        "images must lie in the plane that faces the viewer: sensorPlaneprojection = 1, without orthoprojection"
    };
    Some(Problem::new(at, message).with_help(help))
}

/// Tells if no texel of an image is where the scene is.
fn overlaps(projection: &Projection, size: [usize; 2], scene: &Scene, path: &Path) -> Result<()> {
    let Some((low_m, high_m)) = scene.body.mesh.bounds_m() else { return Ok(()) };
    let corner = |i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { low_m[axis] } else { high_m[axis] };
        projection.at(DVec3::new(pick(0), pick(1), pick(2)))
    };
    let [columns, rows] = [0, 1].map(|k| {
        let of = |i: usize| corner(i)[k];
        (0..8).map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)))
    });
    let is_apart = |(lo, hi): (f64, f64), count: usize| hi <= 0.0 || count as f64 <= lo;
    if is_apart(columns, size[1]) || is_apart(rows, size[0]) {
        let message = format!(
            "the image does not overlap the scene, which would be in its rows {:.1} to {:.1} of {}, columns {:.1} to {:.1} of {}",
            rows.0, rows.1, size[0], columns.0, columns.1, size[1]
        );
        let help = "give the scene that the simulation was made of or into, or the right placement `scene_from_dart`";
        return Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]));
    }
    Ok(())
}

/// What a band's values become radiance by.
#[derive(Debug, Clone, Copy)]
enum Unit {
    /// Reflectance factors of this irradiance, W m-2 um-1.
    Brf(f64),
    /// Temperatures of a black body at this wavelength, um.
    Tapp(f64),
    Radiance,
}

impl Unit {
    /// W m-2 sr-1 um-1.
    fn radiance(self, value: f64) -> f64 {
        match self {
            Unit::Brf(irradiance) => reflectance::radiance_of_reflectance_factor(value, irradiance),
            Unit::Tapp(um) => blackbody::radiance_w_m2_sr_um(um, value),
            Unit::Radiance => value,
        }
    }
}

fn units(view: &OutputView, properties: &Properties, irradiance_w_m2_um: Option<&[f64]>) -> Result<Vec<Unit>> {
    let (mut problems, mut missing) = (Vec::new(), Vec::new());
    let count = view.bands.len();
    if let Some(given) = irradiance_w_m2_um.filter(|_| view.quantity == ImageQuantity::Brf) {
        if given.len() != count || given.iter().any(|e| !(e.is_finite() && *e >= 0.0)) {
            let message =
                format!("{given:?} where {count} irradiances belong, one for each band of {}, not negative", view.name);
            return Err(Error::invalid(Location::item("irradiance_w_m2_um"), message));
        }
        return Ok(given.iter().map(|e| Unit::Brf(*e)).collect());
    }
    let mut all = Vec::new();
    for band in &view.bands {
        let unit = match view.quantity {
            ImageQuantity::Radiance => Ok(Some(Unit::Radiance)),
            ImageQuantity::Tapp => properties.equivalent_um(band.number, &band.band).map(|um| Some(Unit::Tapp(um))),
            ImageQuantity::Brf => properties.irradiance_w_m2_um(band.number).map(|e| e.map(Unit::Brf)),
        };
        match unit {
            Ok(Some(unit)) => all.push(unit),
            Ok(None) => missing.push(band.number.to_string()),
            Err(problem) => problems.push(problem),
        }
    }
    if !missing.is_empty() {
        let message =
            format!("has no `dart.band<n>.BOA.irradiance` of bands {}, which their BRF refers to", missing.join(", "));
        let help = "give `irradiance_w_m2_um` for each band of the view, or take the simulation's radiances";
        problems.push(Problem::new(Location::file(&properties.path), message).with_help(help));
    }
    if problems.is_empty() { Ok(all) } else { Err(Error::Invalid(problems)) }
}

/// The images of a view, read one by one.
struct ImageTexels {
    bands: Vec<Band>,
    images: Vec<(PathBuf, Unit)>,
    texels: usize,
}

impl TexelSource for ImageTexels {
    fn bands(&self) -> &[Band] {
        &self.bands
    }

    fn read(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()> {
        values.clear();
        let (path, unit) = &self.images[band];
        let (raster, _) = ilwis::read(path)?;
        if raster.values.len() != self.texels {
            let message =
                format!("holds {} values where there were {} before: did it change?", raster.values.len(), self.texels);
            return Err(Error::invalid(Location::file(path), message));
        }
        let is_nothing = |v: f64| v.is_nan() || v == NOTHING;
        let is_value = |v: f64| v >= 0.0 && v.is_finite();
        let is_bad = |v: f64| !(is_value(v) || is_nothing(v));
        if let Some(i) = raster.values.iter().position(|v| is_bad(*v)) {
            let count = raster.values.iter().filter(|v| is_bad(**v)).count();
            let at = Location::file(path.with_extension("mp#")).with_item(format!(
                "row {}, column {}",
                i / raster.columns,
                i % raster.columns
            ));
            let message = format!(
                "{} is not a value of an image (one of {count}): those are 0 or above and finite, {NOTHING} or NaN where there is none",
                raster.values[i]
            );
            return Err(Error::invalid(at, message));
        }
        values.extend(raster.values.iter().map(|v| if is_nothing(*v) { f64::NAN } else { unit.radiance(*v) }));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_in_the_name() {
        assert_eq!(angles_of_name("VZ=022_4_VA=090_0"), Some([22.4, 90.0]));
        for bad in ["", "VZ=022_4", "VZ=a_VA=090_0", "VZ=022_4_VA=-90_0", "VZ=1_2_3_VA=0_0", "VZ=_VA="] {
            assert_eq!(angles_of_name(bad), None, "{bad}");
        }
    }
}
