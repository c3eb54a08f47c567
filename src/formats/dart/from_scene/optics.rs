//! Materials, bands, sunlight and temperatures in DART's terms: what its databases and lists hold.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use glam::DVec3;

use crate::error::Location;
use crate::geometry::{Direction, index_u32};
use crate::physics::{blackbody, heat, mars, sun};
use crate::scene::{Globe, MarsModel, Material, Photometry, Scene, Setup, Sun, Thermal};
use crate::spectral::{ALL_UM, Band, Column, Light, SpectralLibrary, Spectrum};

use super::super::database::TableKind;
use super::super::frame;
use super::super::simulation::{Links, OpticalKind, OpticalProperty, SpectralInterval, ThermalFunction};

/// Width of a band that has none, um: narrow beside what spectra do, wide beside the digits of a number.
pub(super) const MONOCHROMATIC_UM: f64 = 1e-3;
/// Databases, in the simulation's own folder.
const DATABASES: [(OpticalKind, &str); 3] = [
    (OpticalKind::Lambertian, "mmxrt_lambertian.db"),
    (OpticalKind::Hapke, "mmxrt_hapke.db"),
    (OpticalKind::Rpv, "mmxrt_rpv.db"),
];
/// The material of the ground that replaces the sky where DART requires one.
const SKY: &str = "space";
/// Heat below this share of reflected sunlight is left out of a band, and sunlight below this share of heat.
const NEGLIGIBLE: f64 = 1e-6;

/// Mean over a band of a product of spectra.
pub(super) fn band_mean(band: &Band, factors: &[&Spectrum]) -> f64 {
    let mut knots: Vec<f64> = factors.iter().flat_map(|s| s.wavelength_um()).copied().collect();
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    let product = |um| factors.iter().map(|s| s.at(um).unwrap_or(f64::NAN)).product::<f64>();
    let known = factors.iter().map(|s| s.coverage_um());
    let known_um = known.fold(ALL_UM, |(a, b), (first, last)| (a.max(first), b.min(last)));
    band.quadrature(&knots, known_um).iter().map(|(um, weight)| weight * product(*um)).sum()
}

/// Irradiance of the Sun on a plane normal to its beam, at the body, in each band, W m-2 um-1; none from below the horizon.
pub(super) fn sunlight(scene: &Setup) -> Vec<f64> {
    match frame::sun_deg(scene.body.origin_m, scene.sky.sun.direction) {
        Some(_) => irradiance(&scene.sky.sun, &scene.exposure.bands),
        None => vec![0.0; scene.exposure.bands.len()],
    }
}

/// Irradiance of the Sun on a plane normal to its beam, at the body, in each band, W m-2 um-1.
pub(in super::super) fn irradiance(sun: &Sun, bands: &[Band]) -> Vec<f64> {
    let at_the_body = |e| sun::irradiance_at(e, sun.distance_m);
    let mean = |band: &Band| at_the_body(band_mean(band, &[&sun.irradiance_1au]));
    // A band without sunlight may lie where that is not known.
    let counts = |band: &Band, mean: f64| band.light.is_lit() || mean.is_finite();
    bands.iter().map(|band| Some(mean(band)).filter(|e| counts(band, *e)).unwrap_or(0.0)).collect()
}

/// A band's full width as DART has it, um.
pub(in super::super) fn width_um(band: &Band) -> f64 {
    band.fwhm_um.unwrap_or(MONOCHROMATIC_UM)
}

/// First and last wavelength that DART looks at, um.
fn reach_um(scene: &Scene) -> (f64, f64) {
    let ends = scene.exposure.bands.iter().map(|band| {
        let (lo, hi) = band.support_within_um(scene.known_um(band.light));
        let half = 0.5 * width_um(band);
        (lo.min(band.centre_um - half), hi.max(band.centre_um + half))
    });
    ends.fold((f64::INFINITY, 0.0), |(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
}

/// A table of spectra that covers what the bands reach: all their points, and their end values beyond them.
pub(in super::super) fn tabulated(spectra: &[&Spectrum], (first_um, last_um): (f64, f64)) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut points: Vec<f64> = spectra.iter().flat_map(|s| s.wavelength_um()).copied().collect();
    points.sort_by(f64::total_cmp);
    points.dedup();
    if points.first().is_some_and(|first| first_um < *first) {
        points.insert(0, first_um);
    }
    if points.last().is_some_and(|last| last_um > *last) {
        points.push(last_um);
    }
    let column = |s: &&Spectrum| {
        let (um, value) = (s.wavelength_um(), s.value());
        points.iter().map(|x| s.at(x.clamp(um[0], um[um.len() - 1])).unwrap_or(value[0])).collect()
    };
    (points.clone(), spectra.iter().map(column).collect())
}

/// Names of the materials, then of the ground: for people, and of a table. No two are the same, whatever their case; the prefix keeps
/// tables apart from words of SQL.
pub(super) fn unique_names(scene: &Setup) -> Vec<(String, String)> {
    let (mut idents, mut models) = (BTreeSet::new(), BTreeSet::new());
    let unused = |taken: &mut BTreeSet<String>, wanted: String| {
        let numbered = (2..).map(|i: u64| format!("{wanted}_{i}"));
        let mut names = std::iter::once(wanted.clone()).chain(numbered);
        names.find(|name| taken.insert(name.clone())).unwrap_or(wanted)
    };
    let names = scene.body.materials.iter().map(|m| m.name.as_str()).chain([SKY]);
    let both = names.map(|name| {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
        let model = format!("mmxrt_{}", name.chars().map(plain).collect::<String>());
        (unused(&mut idents, name.to_owned()), unused(&mut models, model))
    });
    both.collect()
}

/// The list that a material stands in, and what its table holds.
pub(in super::super) fn spectra(material: &Material) -> (OpticalKind, Vec<&Spectrum>) {
    let kind = match material.photometry {
        Photometry::Lambert | Photometry::Model(_) | Photometry::Table(_) => {
            return (OpticalKind::Lambertian, vec![&material.reflectance]);
        }
        Photometry::Hapke(_) => OpticalKind::Hapke,
        Photometry::Rpv(_) => OpticalKind::Rpv,
    };
    (kind, material.photometry.parameters().into_iter().map(|(_, spectrum)| spectrum).collect())
}

/// The database of a kind, and what its columns are called here.
fn database(kind: OpticalKind) -> (&'static str, &'static [&'static str]) {
    let columns = match kind {
        OpticalKind::Lambertian => TableKind::Lambertian,
        OpticalKind::Hapke => TableKind::Hapke,
        OpticalKind::Rpv => TableKind::Rpv,
    };
    (DATABASES.iter().find(|(k, _)| *k == kind).map_or("", |(_, file)| file), columns.columns())
}

/// Optical properties: the materials in the dictionary's order, then the ground's.
pub(super) fn optical(scene: &Scene, names: &[(String, String)]) -> Vec<OpticalProperty> {
    // Only its transmittances count, which are 0.
    let opaque = (DATABASES[0].1.to_owned(), names[scene.body.materials.len()].1.clone());
    let entry = |(i, (ident, model)): (usize, &(String, String))| {
        let material = scene.body.materials.get(i);
        let kind = material.map_or(OpticalKind::Lambertian, |m| spectra(m).0);
        OpticalProperty {
            kind,
            ident: ident.clone(),
            database: database(kind).0.into(),
            model: model.clone(),
            transmittance: (kind != OpticalKind::Lambertian).then(|| opaque.clone()),
            factors: Vec::new(),
            at: Location::item(material.map_or("ground".into(), |m| format!("materials.{:?}", m.name))),
        }
    };
    names.iter().enumerate().map(entry).collect()
}

pub(super) fn databases(scene: &Scene, names: &[(String, String)]) -> Vec<(String, Vec<SpectralLibrary>)> {
    let reach_um = reach_um(scene);
    let black = Spectrum::constant(0.0);
    let sky = (OpticalKind::Lambertian, vec![&black]);
    let all: Vec<_> = scene.body.materials.iter().map(spectra).chain([sky]).collect();
    let table = |i: usize| {
        let (kind, spectra) = &all[i];
        let (wavelength_um, mut columns) = tabulated(spectra, reach_um);
        let names_of_columns = database(*kind).1;
        // A Lambert surface's transmittances.
        columns.resize(names_of_columns.len(), vec![0.0; wavelength_um.len()]);
        let columns = names_of_columns.iter().zip(columns);
        SpectralLibrary {
            name: names[i].1.clone(),
            comment: match scene.body.materials.get(i) {
                Some(material) => format!("{}: written by mmxrt, reflectance in percent", material.name),
                None => "a black ground that stands for the sky: written by mmxrt".into(),
            },
            columns: columns.map(|(name, values)| Column { name: (*name).into(), values }).collect(),
            wavelength_um,
        }
    };
    let of_kind = |kind| (0..all.len()).filter(|i| all[*i].0 == kind).map(table).collect::<Vec<_>>();
    let files = DATABASES.iter().map(|(kind, file)| ((*file).to_owned(), of_kind(*kind)));
    files.filter(|(_, tables)| !tables.is_empty()).collect()
}

/// The links of each material, then of the ground, which neither reflects nor glows.
pub(super) fn links(scene: &Scene, names: &[(String, String)]) -> Vec<Links> {
    let kinds: Vec<OpticalKind> =
        scene.body.materials.iter().map(|m| spectra(m).0).chain([OpticalKind::Lambertian]).collect();
    let one = |(i, (ident, _)): (usize, &(String, String))| Links {
        kind: kinds[i] as u32,
        index: index_u32(kinds[..i].iter().filter(|k| **k == kinds[i]).count()),
        ident: ident.clone(),
        thermal_index: index_u32(i),
        thermal_ident: format!("T_{ident}"),
        at: Location::item(if i < scene.body.materials.len() { "mesh" } else { "ground" }),
    };
    names.iter().enumerate().map(one).collect()
}

/// Temperatures, one for each material and one for the ground: DART makes T^4 linear in sunlight between the two ends, as the
/// equilibrium is; both are one of what is held at a temperature. The cold end is a surface without sunlight (that faces up, under Mars), the hot one the facet that faces the Sun most.
pub(in super::super) fn thermal_functions(scene: &Setup) -> Vec<ThermalFunction> {
    let towards = scene.sky.sun.direction.vec();
    let facets = 0..scene.body.mesh.facets.len();
    let most = match frame::sun_deg(scene.body.origin_m, scene.sky.sun.direction) {
        Some(_) => facets.map(|f| scene.body.mesh.facet(f).normal().dot(towards)).fold(0.0, f64::max).min(1.0),
        None => 0.0,
    };
    let sun_w_m2 = scene.sky.sun.total_irradiance_w_m2();
    let up = Direction::new(scene.body.origin_m).map_or(DVec3::Z, Direction::vec);
    let from_mars = scene.sky.mars.as_ref().map(|mars| {
        let (distance_m, cos_tilt) = (mars.centre_m.length(), up.dot(mars.centre_m) / mars.centre_m.length());
        let heat = mars.thermal_exitance_w_m2 * mars::uniform_sphere_form_factor(mars.radius_m / distance_m, cos_tilt);
        (mars.bond_albedo * on_facet_from_mars(mars, scene.models.mars_light, up, towards) * sun_w_m2, heat)
    });
    let (reflected_w_m2, heat_w_m2) = from_mars.unwrap_or_default();
    let ends_k = |bond_albedo: f64, emissivity: f64| match scene.models.thermal {
        Thermal::Off => (0.0, 0.0),
        Thermal::Thesis => (heat::thesis_temperature_k(0.0), heat::thesis_temperature_k(most)),
        Thermal::Equilibrium => {
            let shaded = (1.0 - bond_albedo) * reflected_w_m2 + emissivity * heat_w_m2;
            let lit = (1.0 - bond_albedo) * sun_w_m2 * most + shaded;
            (heat::equilibrium_temperature_k(shaded, emissivity), heat::equilibrium_temperature_k(lit, emissivity))
        }
    };
    let function = |ident: String, (cold_k, hot_k): (f64, f64), place: &str| ThermalFunction {
        ident,
        mean_k: 0.5 * (cold_k + hot_k),
        range_k: hot_k - cold_k,
        overrides_cells: false,
        at: Location::item(place),
    };
    let names = unique_names(scene);
    let of_material = |(m, (ident, _)): (&Material, &(String, String))| {
        let ends_k = match m.temperature_k.filter(|_| scene.models.thermal != Thermal::Off) {
            Some(held_k) => (held_k, held_k),
            None => ends_k(m.bond_albedo, m.emissivity_bolometric),
        };
        function(format!("T_{ident}"), ends_k, "thermal")
    };
    let ground = function(format!("T_{}", names[scene.body.materials.len()].0), (0.0, 0.0), "ground");
    scene.body.materials.iter().zip(&names).map(of_material).chain([ground]).collect()
}

/// Mars-light on a facet at the origin: E / (reflectance of Mars x solar irradiance normal to the beam).
pub(super) fn on_facet_from_mars(mars: &Globe, model: MarsModel, normal: DVec3, towards_sun: DVec3) -> f64 {
    match model {
        MarsModel::NearField => mars::irradiance(mars.centre_m, mars.radius_m, normal, towards_sun),
        MarsModel::Thesis => {
            let distance_m = mars.centre_m.length();
            mars::thesis_irradiance(1.0, 1.0, mars.radius_m / distance_m, normal.dot(mars.centre_m) / distance_m)
        }
        MarsModel::Off => 0.0,
    }
}

/// Bands, each with sunlight, heat, or both; where a band has both, as matters at the scene's highest temperature.
pub(in super::super) fn intervals(scene: &Setup, thermal: &[ThermalFunction]) -> Vec<SpectralInterval> {
    let sunlight = sunlight(scene);
    let one = |(i, band): (usize, &Band)| {
        let um = band.centre_um;
        let (mut is_lit, mut glows) = (false, false);
        // Heat rises, and light falls, from one end of a band to the other.
        let (first_um, last_um) = scene.known_um(band.light);
        let half_um = 0.5 * width_um(band);
        let points_um = [(um - half_um).max(first_um), um, (um + half_um).min(last_um)];
        for (material, function) in scene.body.materials.iter().zip(thermal) {
            let hot_k = function.mean_k + 0.5 * function.range_k;
            let at = |um: f64| {
                let value = |s: &Spectrum| s.at(um).unwrap_or(0.0);
                let heat = value(&material.emissivity) * blackbody::radiance_w_m2_sr_um(um, hot_k);
                (heat, value(&material.reflectance) / PI * sunlight[i])
            };
            let all = points_um.map(at);
            let of = |pick: fn(f64, f64) -> f64| {
                all.into_iter().reduce(|a, b| (pick(a.0, b.0), pick(a.1, b.1))).unwrap_or_default()
            };
            let ((least_heat, least_light), (most_heat, most_light)) = (of(f64::min), of(f64::max));
            is_lit |= most_light >= NEGLIGIBLE * least_heat;
            glows |= most_heat > NEGLIGIBLE * least_light;
        }
        let mode = match (band.light, is_lit, glows) {
            (Light::Sunlight, ..) | (Light::Both, _, false) => 0,
            (Light::Both, true, true) => 1,
            (Light::Heat, ..) | (Light::Both, false, true) => 2,
        };
        SpectralInterval {
            mean_um: um,
            width_um: width_um(band),
            mode,
            at: Location::item(format!("sensor.bands[{i}]")),
        }
    };
    scene.exposure.bands.iter().enumerate().map(one).collect()
}

/// How far what is reflected in a band is off if its response is a rectangle in DART, at most of all materials, relative: the
/// irradiance is that of the response, reflectances are DART's own.
pub(super) fn rectangle_off(scene: &Scene, band: &Band) -> f64 {
    let rectangle = Band::boxed(band.centre_um, width_um(band));
    let sun = &scene.sky.sun.irradiance_1au;
    let off = |m: &Material| {
        let as_in_dart = band_mean(band, &[sun]) * band_mean(&rectangle, &[&m.reflectance]);
        (as_in_dart / band_mean(band, &[sun, &m.reflectance]) - 1.0).abs()
    };
    // Where nothing is known, or nothing is reflected, nothing can be said.
    scene.body.materials.iter().map(off).filter(|off| off.is_finite()).fold(0.0, f64::max)
}

/// How far a Lambert surface's emissivity is from 1 - reflectance, at most, in bands that have heat.
pub(super) fn emissivity_off(scene: &Scene, material: &Material, intervals: &[SpectralInterval]) -> f64 {
    let value = |s: &Spectrum, um: f64| s.at(um).unwrap_or(0.0);
    let off = |band: &Band| {
        let um = band.centre_um;
        (value(&material.emissivity, um) - (1.0 - value(&material.reflectance, um))).abs()
    };
    let bands = scene.exposure.bands.iter().zip(intervals);
    bands
        .filter(|(_, i)| i.mode != 0 && material.photometry == Photometry::Lambert)
        .map(|(b, _)| off(b))
        .fold(0.0, f64::max)
}
