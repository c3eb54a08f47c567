//! The radiative budget of triangles: `triangles.txt`, which is binary, gives their positions, `RadiativeBudgetFigures.txt` of
//! each band what they send out.
//!
//! DART cuts what it reads into triangles of its own: a facet and a triangle that lie in one plane share what they have in
//! common.

use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::error::{Error, Location, Problem, Result};
use crate::formats::input;
use crate::geometry::coplanar::{self, Overlaps};
use crate::geometry::{Facet, Pose, index_u32};
use crate::physics::reflectance;
use crate::product::{Patches, Placement, RadianceMap, SkyShare, TexelSource};
use crate::scene::Scene;
use crate::spectral::Band;

use super::properties::Properties;
use super::{OutputBand, OutputMapOptions};

/// The file of triangles, in `output/`.
pub(super) const TRIANGLES: &str = "triangles.txt";
/// The folder of a band that holds it, iteration by iteration.
pub(super) const FOLDER: &str = "RADIATIVE_BUDGET";
/// The file of what they send out, in a band's folder.
pub(super) const FIGURES: &str = "RadiativeBudgetFigures.txt";
/// Longer files are refused, bytes.
const LIMIT: u64 = 1 << 36;
/// A triangle: 1 if it is a parallelogram, nine f64 for three corners, then 29 bytes of materials.
const RECORD: usize = 102;
/// DART's inputs went through f32: coordinates are known to this share of the largest one.
const TOLERANCE: f64 = 4.0 / (1u64 << 24) as f64;
/// A facet that triangles cover more often than once, by more than this share of it, is refused.
const DOUBLED: f64 = 1e-3;

/// What of two surfaces does not lie on the other one, m2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mismatch {
    /// Area of the scene's facets without a triangle: their radiance is not known.
    pub facets_m2: f64,
    /// Area of all of them.
    pub all_facets_m2: f64,
    /// Area of DART's triangles without a facet: left out.
    pub triangles_m2: f64,
    /// Area of all of them.
    pub all_triangles_m2: f64,
}

/// The unit of a band's figures: `dart.products.RadiativeBudget.units`.
#[derive(Debug, Clone, Copy)]
enum Unit {
    /// Over the irradiance of the scene, W m-2 um-1, which it is multiplied by.
    Relative(f64),
    /// W um-1 m-2 of the triangle.
    Density,
    /// W um-1 of all of the triangle.
    Power,
}

pub(super) fn map(
    folder: &Path,
    bands: &[OutputBand],
    properties: &Properties,
    pose: Pose,
    scene: &Scene,
    options: &OutputMapOptions,
) -> Result<(RadianceMap, Mismatch)> {
    let mut problems = Vec::new();
    let mut columns = Vec::new();
    for (i, band) in bands.iter().enumerate() {
        match unit(band.number, i, bands.len(), properties, options) {
            Ok(unit) => columns.push((band.path.clone(), unit, properties.emits(band.number))),
            Err(problem) if problems.contains(&problem) => {}
            Err(problem) => problems.push(problem),
        }
    }
    let path = folder.join(TRIANGLES);
    let triangles = match triangles(&path, properties) {
        Ok(triangles) => triangles,
        Err(Error::Invalid(more)) => {
            problems.extend(more);
            return Err(Error::Invalid(problems));
        }
        Err(other) => return Err(other),
    };
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    let (patches, mismatch) = place(&triangles, &pose, scene, &path)?;
    let source = BudgetTexels {
        bands: bands.iter().map(|b| b.band.clone()).collect(),
        figures: columns,
        area_m2: triangles.area_m2(),
    };
    let map = RadianceMap {
        name: "DART radiative budget".into(),
        placement: Placement::Patches(patches),
        source: Box::new(source),
        weight: 1.0,
        light: bands.iter().map(|band| properties.light(band.number)).collect(),
        sky: SkyShare::LeftOut,
        registration: None,
    };
    Ok((map, mismatch))
}

fn unit(
    number: usize,
    place: usize,
    count: usize,
    properties: &Properties,
    options: &OutputMapOptions,
) -> std::result::Result<Unit, Problem> {
    let key = "dart.products.RadiativeBudget.units";
    let irradiance = || match &options.irradiance_w_m2_um {
        Some(given) if given.len() == count && given[place].is_finite() && given[place] >= 0.0 => Ok(given[place]),
        Some(given) => {
            let message = format!("{given:?} where {count} irradiances belong, one for each band, not negative");
            Err(Problem::new(Location::item("irradiance_w_m2_um"), message))
        }
        None => properties.irradiance_w_m2_um(number)?.ok_or_else(|| {
            let message = format!("has no `dart.band{number}.BOA.irradiance`, which the budget refers to");
            Problem::new(Location::file(&properties.path), message).with_help("give `irradiance_w_m2_um` for each band")
        }),
    };
    match properties.text(key) {
        Some("0") => Ok(Unit::Relative(irradiance()?)),
        Some("1") => Ok(Unit::Density),
        Some("2") => Ok(Unit::Power),
        Some(other) => {
            let message = format!("`{other}` is not a known unit of a budget: 0 (relative), 1 (W/m2/um), 2 (W/um)");
            Err(Problem::new(properties.at(key), message))
        }
        None => Err(Problem::new(properties.at(key), "the unit of the radiative budget is not said")),
    }
}

/// DART's triangles, in its own frame.
struct Triangles {
    facets: Vec<Facet>,
    /// The record of each: parallelograms are two.
    record: Vec<u32>,
    records: usize,
}

impl Triangles {
    /// Of each record.
    fn area_m2(&self) -> Vec<f64> {
        let mut area_m2 = vec![0.0; self.records];
        self.facets.iter().zip(&self.record).for_each(|(f, r)| area_m2[*r as usize] += f.area_m2());
        area_m2
    }
}

fn triangles(path: &Path, properties: &Properties) -> Result<Triangles> {
    let bytes = input::bytes(path, LIMIT)?;
    let invalid = |message: String| Error::invalid(Location::file(path), message);
    let records = bytes.len() / RECORD;
    if bytes.len() % RECORD != 0 || records == 0 {
        return Err(invalid(format!("holds {} bytes, no whole number of triangles of {RECORD} bytes", bytes.len())));
    }
    let told = properties.number("maket.nbOfTriangles").map_err(|p| Error::Invalid(vec![p]))?;
    if let Some(told) = told.filter(|told| *told != records as f64) {
        return Err(invalid(format!("holds {records} triangles, {} says {told}", properties.path.display())));
    }
    let mut all = Triangles { facets: Vec::with_capacity(records), record: Vec::with_capacity(records), records };
    for (i, record) in bytes.chunks_exact(RECORD).enumerate() {
        let number = |k: usize| f64::from_le_bytes(std::array::from_fn(|b| record[1 + 8 * k + b]));
        let [a, b, c] = std::array::from_fn(|k| DVec3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2)));
        if record[0] > 1 || ![a, b, c].iter().all(|p| p.is_finite()) {
            return Err(invalid(format!("triangle {i} (from 0): no corners that are finite numbers behind a 0 or 1")));
        }
        all.facets.push(Facet { corners_m: [a, b, c] });
        all.record.push(index_u32(i));
        if record[0] == 1 {
            all.facets.push(Facet { corners_m: [a, c, a + c - b] });
            all.record.push(index_u32(i));
        }
    }
    Ok(all)
}

/// The parts of facets that each triangle is.
fn place(triangles: &Triangles, pose: &Pose, scene: &Scene, path: &Path) -> Result<(Patches, Mismatch)> {
    let mesh = &scene.body.mesh;
    let of_dart = || triangles.facets.iter().flat_map(|f| f.corners_m);
    let largest = |m: f64, p: DVec3| m.max(p.abs().max_element());
    let tolerance_m = TOLERANCE * mesh.used_vertices_m().chain(of_dart()).fold(0.0, largest);
    let facets: Vec<Facet> =
        triangles.facets.iter().map(|f| Facet { corners_m: f.corners_m.map(|p| pose.point(p)) }).collect();
    let overlaps = coplanar::overlaps(mesh, &facets, tolerance_m);
    let (of_facet, of_triangle) = coplanar::areas_m2(mesh, facets.len(), &overlaps);
    let help = "give the scene that the simulation was made of or into, or the right placement `scene_from_dart`";
    if overlaps.polygon_facet.is_empty() {
        let message = "no triangle lies on a facet of the scene: they do not overlap";
        return Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]));
    }
    let perimeter_m = |f: &Facet| (0..3).map(|i| f.corners_m[i].distance(f.corners_m[(i + 1) % 3])).sum::<f64>();
    let is_doubled = |f: &usize| {
        let facet = mesh.facet(*f);
        let area_m2 = facet.area_m2();
        of_facet[*f] - area_m2 > (DOUBLED * area_m2).max(tolerance_m * perimeter_m(&facet))
    };
    let doubled: Vec<usize> = (0..mesh.facets.len()).filter(is_doubled).collect();
    if let Some(first) = doubled.first() {
        let message = format!(
            "{} facets of the scene are covered more often than once, as facet {first}: which triangle is seen is not known",
            doubled.len()
        );
        return Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help("take images instead")]));
    }
    let rest = |all: &mut dyn Iterator<Item = f64>, found: &[f64]| {
        all.zip(found).fold((0.0, 0.0), |(rest, sum), (a, b)| (rest + (a - b).max(0.0), sum + a))
    };
    let (facets_m2, all_facets_m2) = rest(&mut (0..mesh.facets.len()).map(|f| mesh.facet(f).area_m2()), &of_facet);
    let (triangles_m2, all_triangles_m2) = rest(&mut facets.iter().map(Facet::area_m2), &of_triangle);
    let Overlaps { polygon_facet, polygon_triangle, polygon_start, uv } = overlaps;
    let polygon_texel = polygon_triangle.into_iter().map(|t| triangles.record[t as usize]).collect();
    let patches = Patches { texels: triangles.records, polygon_facet, polygon_texel, polygon_start, uv };
    Ok((patches, Mismatch { facets_m2, all_facets_m2, triangles_m2, all_triangles_m2 }))
}

/// Figures of bands, read one by one.
struct BudgetTexels {
    bands: Vec<Band>,
    /// File, unit, and whether emission counts.
    figures: Vec<(PathBuf, Unit, bool)>,
    /// Of each triangle.
    area_m2: Vec<f64>,
}

impl TexelSource for BudgetTexels {
    fn bands(&self) -> &[Band] {
        &self.bands
    }

    fn read(&mut self, band: usize, values: &mut Vec<f64>) -> Result<()> {
        values.clear();
        let (path, unit, emits) = &self.figures[band];
        let bytes = input::bytes(path, LIMIT)?;
        let mut problems = input::Problems::default();
        let text = String::from_utf8_lossy(&bytes);
        let mut columns = Columns::default();
        for (i, line) in text.lines().enumerate() {
            let at = || Location::line(path, i + 1);
            if line.starts_with("ObjectName") {
                let feature = "a budget that is grouped by objects (DART-Lux)".into();
                return Err(Error::Unsupported { at: at(), feature });
            }
            if let Some(header) = line.strip_prefix('*') {
                columns = Columns::of(header);
                continue;
            }
            if line.trim().is_empty() {
                continue;
            }
            let Some(scattered) = columns.scattered else {
                return Err(Error::invalid(at(), "no line `* ... Scattered ...` before that names the columns"));
            };
            let Some(emitted) = columns.emitted.map(Some).or((!emits).then_some(None)) else {
                return Err(Error::invalid(
                    at(),
                    "no column Emitted, in a band with heat: ask DART for all components of elements",
                ));
            };
            let words: Vec<&str> = line.split(SEPARATORS).filter(|w| !w.is_empty()).collect();
            let number = |column: usize| words.get(column)?.parse::<f64>().ok().filter(|x| *x >= 0.0 && x.is_finite());
            let sent =
                number(scattered).zip(emitted.map_or(Some(0.0), number)).filter(|_| words.len() == columns.count);
            match (sent, self.area_m2.get(values.len())) {
                (Some((scattered, emitted)), Some(area_m2)) => {
                    let exitance = match unit {
                        Unit::Relative(irradiance) => (scattered + emitted) * irradiance,
                        Unit::Density => scattered + emitted,
                        Unit::Power => (scattered + emitted) / area_m2,
                    };
                    // A triangle without area sends nothing anywhere.
                    values.push(if exitance.is_finite() { reflectance::lambert_radiance(exitance) } else { f64::NAN });
                }
                (None, _) => {
                    let message = format!("{} numbers, not negative, belong here", columns.count);
                    problems.push(|| Problem::new(at(), message));
                    values.push(f64::NAN);
                }
                (Some(_), None) => values.push(f64::NAN),
            }
        }
        if values.len() != self.area_m2.len() {
            let message = format!("holds {} triangles, {TRIANGLES} has {}", values.len(), self.area_m2.len());
            problems.push(|| Problem::new(Location::file(path), message));
        }
        problems.finish(path)
    }
}

/// What stands between columns.
const SEPARATORS: [char; 4] = ['\t', ' ', ';', '\r'];

/// Where a line has what; of a triangle with two faces the first.
#[derive(Default)]
struct Columns {
    scattered: Option<usize>,
    emitted: Option<usize>,
    count: usize,
}

impl Columns {
    fn of(header: &str) -> Self {
        let names: Vec<String> = header.split(SEPARATORS).filter(|w| !w.is_empty()).map(str::to_lowercase).collect();
        let place = |name: &str| names.iter().position(|n| n.starts_with(name));
        Columns { scattered: place("scattered"), emitted: place("emitted"), count: names.len() }
    }
}
