//! A scene as a DART simulation, with all the files it names.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::error::{Error, Location, Result};
use crate::geometry::{Direction, Mesh};
use crate::physics::{blackbody, heat, mars, sun};
use crate::report::{Fate, Report};
use crate::scene::{Mars, MarsModel, Material, Photometry, Scene, Sun, Thermal};
use crate::spectral::{Band, Column, SpectralLibrary, Spectrum};

use super::database::Kind;
use super::frame;
use super::inputs::Target;
use super::sidecar::{self, Sidecar};
use super::simulation::{
    Camera, Directions, Group, Links, Maket, Object, OpticalKind, OpticalProperty, Phase, Simulation, SpectralInterval,
    ThermalFunction,
};

/// What a simulation's folder holds.
#[derive(Debug, Clone)]
pub struct Package {
    /// The inputs.
    pub simulation: Simulation,
    /// The meshes that its objects name, in the order of the objects.
    pub surfaces: Vec<Surface>,
    /// Its databases: file name and tables.
    pub databases: Vec<(String, Vec<SpectralLibrary>)>,
    /// The same surface lit by Mars alone, where it is: DART has one parallel source, and light adds.
    pub mars: Option<Simulation>,
    /// What DART has no place for.
    pub sidecar: Option<Sidecar>,
    /// What DART will have to cope with.
    pub size: Size,
}

/// An OBJ file's mesh.
#[derive(Debug, Clone)]
pub struct Surface {
    /// In DART's axes, its own origin.
    pub mesh: Mesh,
    /// Group of each material; empty for one that no facet is made of.
    pub groups: Vec<String>,
}

/// How large a simulation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Triangles.
    pub facets: u64,
    /// Cells along x, y and z.
    pub cells: [u64; 3],
    /// Memory that DART may need: [`Size::of`].
    pub bytes: u64,
}

impl Size {
    /// Memory by a formula that is inferred, not known: a cell 64 bytes; a triangle 256, and 80 for each band (light in ten angular
    /// sectors); a pixel of an image 8 bytes a band.
    pub fn of(simulation: &Simulation, facets: u64, height_m: f64) -> Self {
        let maket = &simulation.maket;
        let count = |extent_m: f64, cell_m: f64| ((extent_m / cell_m - 1e-9).ceil()).max(1.0) as u64;
        let [x, y] = maket.size_m.map(|extent_m| count(extent_m, maket.cell_m[0]));
        let cells = [x, y, count(height_m, maket.cell_m[1])];
        let bands = simulation.phase.bands.len() as u64;
        let of_camera = |c: &Camera| u64::from(c.pixels[0]) * u64::from(c.pixels[1]);
        let views = 1 + simulation.directions.views_deg.len() as u64;
        let product = |factors: &[u64]| factors.iter().fold(1_u64, |n, factor| n.saturating_mul(*factor));
        let pixels =
            simulation.phase.cameras.iter().map(of_camera).fold(product(&[views, x, y]), |n, of| n.saturating_add(of));
        let bytes = [
            product(&[64, cells[0], cells[1], cells[2]]),
            product(&[facets, 256 + 80 * bands]),
            product(&[pixels, bands, 8]),
        ];
        let bytes = bytes.iter().fold(0_u64, |n, of| n.saturating_add(*of));
        Size { facets, cells, bytes }
    }
}

/// What a conversion leaves to its caller.
#[derive(Debug, Clone, PartialEq)]
pub struct WriteOptions {
    /// Version of DART.
    pub target: Target,
    /// Size of a cell, m; `None`: what a pixel of the camera sees.
    pub cell_m: Option<f64>,
    /// Memory that DART may take, bytes.
    pub memory_bytes: u64,
}

impl Default for WriteOptions {
    fn default() -> Self {
        WriteOptions { target: Target::default(), cell_m: None, memory_bytes: 16 << 30 }
    }
}

/// Width of a band that has none, um: narrow beside what spectra do, wide beside the digits of a number.
pub(super) const MONOCHROMATIC_UM: f64 = 1e-3;
/// Databases, in the simulation's own folder.
const DATABASES: [(OpticalKind, &str); 3] = [
    (OpticalKind::Lambertian, "mmxrt_lambertian.db"),
    (OpticalKind::Hapke, "mmxrt_hapke.db"),
    (OpticalKind::Rpv, "mmxrt_rpv.db"),
];
/// The OBJ file, and the object that it is.
const SURFACE: &str = "surface";
/// What stands for the sky where there must be a ground.
const SKY: &str = "space";
/// A camera farther away than this many times the scene's extent sees it as a parallel view does.
const DISTANT: f64 = 5.0;
/// Heat below this share of reflected sunlight is left out of a band, and sunlight below this share of heat.
const NEGLIGIBLE: f64 = 1e-6;

/// The simulation of a scene, and what became of what DART has no exact counterpart for.
///
/// The surface keeps its own origin, turned into the site's axes (South, East, up); its place in DART's frame is that of the
/// scene's corner, with a margin of at most half a cell.
///
/// # Errors
/// [`Error::Invalid`] for a cell that is no length.
pub fn from_scene(scene: &Scene, options: &WriteOptions) -> Result<(Package, Report)> {
    let mut report = Report::default();
    let dart_from_body = frame::dart_from_body(scene.origin_m);
    let mut mesh = scene.mesh.clone();
    mesh.vertices_m.iter_mut().for_each(|v| *v = dart_from_body * *v);
    mesh.face_of_facet = Vec::new();
    let (low_m, high_m) = mesh.bounds_m().unwrap_or_default();
    let size_m = high_m - low_m;
    let cell_m = match options.cell_m {
        Some(cell_m) if cell_m > 0.0 && cell_m.is_finite() => cell_m,
        Some(cell_m) => {
            return Err(Error::invalid(Location::item("cell"), format!("{cell_m} m is no positive length")));
        }
        None => {
            let cell_m = pixel_m(scene, size_m);
            let message = format!("cells of {cell_m} m: about what a pixel of the camera sees");
            report.note(Fate::Defaulted, Location::item("cell"), message);
            cell_m
        }
    };
    // A whole number of cells, and a margin on all sides: nothing lies on the scene's edge or in the ground plane.
    let extent_m = (size_m / cell_m).floor() * cell_m + DVec3::splat(cell_m);
    let origin_in_dart_m = 0.5 * (extent_m - size_m) - low_m;
    let site = Site { scene, dart_from_body, origin_in_dart_m };

    let names = unique_names(scene);
    let links = links(scene, &names);
    let thermal = thermal_functions(scene);
    let surfaces = surfaces(mesh, scene.materials.len());
    let bands = intervals(scene, &thermal);
    let irradiance = sunlight(scene).into_iter().map(|e| (e, 0.0)).collect();
    let camera = site.camera();
    let centre_m = 0.5 * extent_m;
    let towards_camera = camera.position_m - centre_m;
    let is_distant = towards_camera.length() > DISTANT * size_m.length();
    let views_deg = (is_distant && towards_camera.z > 0.0).then(|| frame::angles_deg(towards_camera));
    let mut simulation = Simulation {
        version: options.target.version(),
        maket: Maket {
            size_m: [extent_m.x, extent_m.y],
            cell_m: [cell_m; 2],
            boundary: 0,
            ground: links[scene.materials.len()].clone(),
            ground_enabled: options.target == Target::V5_7_4,
            topography: None,
            latitude_longitude_altitude: latitude_longitude_altitude(scene.origin_m),
            at: Location::item("maket"),
        },
        optical: optical(scene, &names),
        thermal,
        objects: Vec::new(),
        fields: Vec::new(),
        sequences: Vec::new(),
        phase: Phase { bands, irradiance_mode: 1, irradiance, radiance_products: true, cameras: vec![camera] },
        directions: Directions {
            // A Sun without light stands in the zenith.
            sun_deg: sun_deg(scene).unwrap_or_default(),
            views_deg: views_deg.into_iter().collect(),
            at: Location::item("sun"),
        },
    };
    let object = |(i, surface): (usize, &Surface)| site.object(i, &surface.groups, options.target, &links);
    simulation.objects = surfaces.iter().enumerate().map(object).collect();
    let size = Size::of(&simulation, scene.mesh.facets.len() as u64, extent_m.z);
    let sidecar = Sidecar::of(scene, origin_in_dart_m);
    site.notes(&simulation, &size, options, &mut report);
    let mars = site.by_mars(&simulation, &mut report);
    let databases = databases(scene, &names);
    Ok((Package { simulation, surfaces, databases, mars, sidecar: Some(sidecar), size }, report))
}

/// What a pixel of the camera sees of the scene's middle, m, in two digits; between a tenth and a two-thousandth of its extent.
fn pixel_m(scene: &Scene, size_m: DVec3) -> f64 {
    let (low_m, high_m) = scene.mesh.bounds_m().unwrap_or_default();
    let camera = &scene.sensor.camera;
    let extent_m = size_m.max_element();
    let pixel_m = (camera.pitch * (camera.centre_m() - 0.5 * (low_m + high_m)).length())
        .clamp(extent_m / 2000.0, extent_m / 10.0)
        // A point has no extent.
        .max(1e-6);
    let step = 10f64.powf(pixel_m.log10().floor() - 1.0);
    // Division by a power of ten is exact to the digit that multiplication is not.
    if step < 1.0 { (pixel_m / step).round() / (1.0 / step).round() } else { (pixel_m / step).round() * step.round() }
}

/// A camera's line of sight and turn, deg; straight down if it is that within a tenth of a pixel.
pub(super) fn camera_deg(dart_from_sensor: DMat3, pitch: f64) -> ([f64; 2], f64) {
    frame::camera_deg(dart_from_sensor, 0.1 * pitch)
}

/// Planetocentric latitude and longitude (-180 to 180), deg, and no altitude: DART uses them for dates.
pub(super) fn latitude_longitude_altitude(origin_m: DVec3) -> [f64; 3] {
    let latitude = origin_m.z.atan2(origin_m.x.hypot(origin_m.y)).to_degrees();
    [latitude, origin_m.y.atan2(origin_m.x).to_degrees(), 0.0]
}

/// Mean over a band of a product of spectra.
fn band_mean(band: &Band, factors: &[&Spectrum]) -> f64 {
    let mut knots: Vec<f64> = factors.iter().flat_map(|s| s.wavelength_um()).copied().collect();
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    let product = |um| factors.iter().map(|s| s.at(um).unwrap_or(f64::NAN)).product::<f64>();
    band.quadrature(&knots).iter().map(|(um, weight)| weight * product(*um)).sum()
}

/// Zenith angle and azimuth of the Sun in DART's frame, deg; `None` below the horizon of the site, where DART has no Sun.
pub(super) fn sun_deg(scene: &Scene) -> Option<[f64; 2]> {
    let angles_deg = frame::angles_deg(frame::dart_from_body(scene.origin_m) * scene.sun.direction.vec());
    Some(angles_deg).filter(|[zenith_deg, _]| *zenith_deg < 90.0)
}

/// Irradiance of the Sun on a plane normal to its beam, at the body, in each band, W m-2 um-1; none from below the horizon.
fn sunlight(scene: &Scene) -> Vec<f64> {
    match sun_deg(scene) {
        Some(_) => irradiance(&scene.sun, &scene.sensor.bands),
        None => vec![0.0; scene.sensor.bands.len()],
    }
}

/// Irradiance of the Sun on a plane normal to its beam, at the body, in each band, W m-2 um-1.
pub(super) fn irradiance(sun: &Sun, bands: &[Band]) -> Vec<f64> {
    let at_the_body = |e| sun::irradiance_at(e, sun.distance_m);
    bands.iter().map(|band| at_the_body(band_mean(band, &[&sun.irradiance_1au]))).collect()
}

/// A band's full width as DART has it, um.
pub(super) fn width_um(band: &Band) -> f64 {
    band.fwhm_um.unwrap_or(MONOCHROMATIC_UM)
}

/// First and last wavelength that DART looks at, um.
fn reach_um(bands: &[Band]) -> (f64, f64) {
    let ends = bands.iter().map(|band| {
        let ((lo, hi), half) = (band.support_um(), 0.5 * width_um(band));
        (lo.min(band.centre_um - half), hi.max(band.centre_um + half))
    });
    ends.fold((f64::INFINITY, 0.0), |(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
}

/// A table of spectra that covers what the bands reach: all their points, and their end values beyond them.
pub(super) fn tabulated(spectra: &[&Spectrum], (first_um, last_um): (f64, f64)) -> (Vec<f64>, Vec<Vec<f64>>) {
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
fn unique_names(scene: &Scene) -> Vec<(String, String)> {
    let (mut idents, mut models) = (BTreeSet::new(), BTreeSet::new());
    let unused = |taken: &mut BTreeSet<String>, wanted: String| {
        let numbered = (2..).map(|i: u64| format!("{wanted}_{i}"));
        let mut names = std::iter::once(wanted.clone()).chain(numbered);
        names.find(|name| taken.insert(name.clone())).unwrap_or(wanted)
    };
    let names = scene.materials.iter().map(|m| m.name.as_str()).chain([SKY]);
    let both = names.map(|name| {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
        let model = format!("mmxrt_{}", name.chars().map(plain).collect::<String>());
        (unused(&mut idents, name.to_owned()), unused(&mut models, model))
    });
    both.collect()
}

/// The list that a material stands in, and what its table holds.
pub(super) fn spectra(material: &Material) -> (OpticalKind, Vec<&Spectrum>) {
    let kind = match material.photometry {
        Photometry::Lambert => return (OpticalKind::Lambertian, vec![&material.reflectance]),
        Photometry::Hapke(_) => OpticalKind::Hapke,
        Photometry::Rpv(_) => OpticalKind::Rpv,
    };
    (kind, material.photometry.parameters().into_iter().map(|(_, spectrum)| spectrum).collect())
}

/// The database of a kind, and what its columns are called here.
fn database(kind: OpticalKind) -> (&'static str, &'static [&'static str]) {
    let columns = match kind {
        OpticalKind::Lambertian => Kind::Lambertian,
        OpticalKind::Hapke => Kind::Hapke,
        OpticalKind::Rpv => Kind::Rpv,
    };
    (DATABASES.iter().find(|(k, _)| *k == kind).map_or("", |(_, file)| file), columns.columns())
}

/// Optical properties: the materials in the dictionary's order, then the ground's.
fn optical(scene: &Scene, names: &[(String, String)]) -> Vec<OpticalProperty> {
    // Only its transmittances count, which are 0.
    let opaque = (DATABASES[0].1.to_owned(), names[scene.materials.len()].1.clone());
    let entry = |(i, (ident, model)): (usize, &(String, String))| {
        let material = scene.materials.get(i);
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

fn databases(scene: &Scene, names: &[(String, String)]) -> Vec<(String, Vec<SpectralLibrary>)> {
    let reach_um = reach_um(&scene.sensor.bands);
    let black = Spectrum::constant(0.0);
    let sky = (OpticalKind::Lambertian, vec![&black]);
    let all: Vec<_> = scene.materials.iter().map(spectra).chain([sky]).collect();
    let table = |i: usize| {
        let (kind, spectra) = &all[i];
        let (wavelength_um, mut columns) = tabulated(spectra, reach_um);
        let names_of_columns = database(*kind).1;
        // A Lambert surface's transmittances.
        columns.resize(names_of_columns.len(), vec![0.0; wavelength_um.len()]);
        let columns = names_of_columns.iter().zip(columns);
        SpectralLibrary {
            name: names[i].1.clone(),
            comment: match scene.materials.get(i) {
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
fn links(scene: &Scene, names: &[(String, String)]) -> Vec<Links> {
    let kinds: Vec<OpticalKind> =
        scene.materials.iter().map(|m| spectra(m).0).chain([OpticalKind::Lambertian]).collect();
    let one = |(i, (ident, _)): (usize, &(String, String))| Links {
        kind: kinds[i] as u32,
        index: kinds[..i].iter().filter(|k| **k == kinds[i]).count() as u32,
        ident: ident.clone(),
        thermal_index: i as u32,
        thermal_ident: format!("T_{ident}"),
        at: Location::item(if i < scene.materials.len() { "mesh" } else { "ground" }),
    };
    names.iter().enumerate().map(one).collect()
}

/// Temperatures, one for each material and one for the ground: DART makes T^4 linear in sunlight between the two ends, as the
/// equilibrium is. The cold end is a surface without sunlight (that faces up, under Mars), the hot one the facet that faces the Sun most.
pub(super) fn thermal_functions(scene: &Scene) -> Vec<ThermalFunction> {
    let towards = scene.sun.direction.vec();
    let facets = 0..scene.mesh.facets.len();
    let most = match sun_deg(scene) {
        Some(_) => facets.map(|f| scene.mesh.facet(f).normal().dot(towards)).fold(0.0, f64::max).min(1.0),
        None => 0.0,
    };
    let sun_w_m2 = sun::irradiance_at(scene.sun.total_irradiance_1au_w_m2, scene.sun.distance_m);
    let up = Direction::new(scene.origin_m).map_or(DVec3::Z, Direction::vec);
    let from_mars = scene.mars.as_ref().map(|mars| {
        let (distance_m, cos_tilt) = (mars.centre_m.length(), up.dot(mars.centre_m) / mars.centre_m.length());
        let heat = mars.thermal_exitance_w_m2 * mars::uniform_sphere_form_factor(mars.radius_m / distance_m, cos_tilt);
        (mars.bond_albedo * on_facet_from_mars(mars, up, towards) * sun_w_m2, heat)
    });
    let (reflected_w_m2, heat_w_m2) = from_mars.unwrap_or_default();
    let ends_k = |bond_albedo: f64, emissivity: f64| match scene.thermal {
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
        at: Location::item(place),
    };
    let names = unique_names(scene);
    let of_material = |(m, (ident, _)): (&Material, &(String, String))| {
        function(format!("T_{ident}"), ends_k(m.bond_albedo, m.emissivity_bolometric), "thermal")
    };
    let ground = function(format!("T_{}", names[scene.materials.len()].0), (0.0, 0.0), "ground");
    scene.materials.iter().zip(&names).map(of_material).chain([ground]).collect()
}

/// Mars-light on a facet at the origin: E / (reflectance of Mars x solar irradiance normal to the beam).
fn on_facet_from_mars(mars: &Mars, normal: DVec3, towards_sun: DVec3) -> f64 {
    match mars.model {
        MarsModel::NearField => mars::irradiance(mars.centre_m, mars.radius_m, normal, towards_sun),
        MarsModel::Thesis => {
            let distance_m = mars.centre_m.length();
            mars::thesis_irradiance(1.0, 1.0, mars.radius_m / distance_m, normal.dot(mars.centre_m) / distance_m)
        }
    }
}

/// Bands, each with sunlight, heat, or both, as matters at the scene's highest temperature.
pub(super) fn intervals(scene: &Scene, thermal: &[ThermalFunction]) -> Vec<SpectralInterval> {
    let sunlight = sunlight(scene);
    let one = |(i, band): (usize, &Band)| {
        let um = band.centre_um;
        let (mut is_lit, mut glows) = (false, false);
        for (material, function) in scene.materials.iter().zip(thermal) {
            let value = |s: &Spectrum| s.at(um).unwrap_or(0.0);
            let hot_k = function.mean_k + 0.5 * function.range_k;
            let heat = value(&material.emissivity) * blackbody::radiance_w_m2_sr_um(um, hot_k);
            let light = value(&material.reflectance) / PI * sunlight[i];
            is_lit |= light >= NEGLIGIBLE * heat;
            glows |= heat > NEGLIGIBLE * light;
        }
        let mode = match (is_lit, glows) {
            (_, false) => 0,
            (true, true) => 1,
            (false, true) => 2,
        };
        SpectralInterval {
            mean_um: um,
            width_um: width_um(band),
            mode,
            at: Location::item(format!("sensor.bands[{i}]")),
        }
    };
    scene.sensor.bands.iter().enumerate().map(one).collect()
}

/// How far a Lambert surface's emissivity is from 1 - reflectance, at most, in bands that have heat.
fn emissivity_off(scene: &Scene, material: &Material, intervals: &[SpectralInterval]) -> f64 {
    let value = |s: &Spectrum, um: f64| s.at(um).unwrap_or(0.0);
    let off = |band: &Band| {
        let um = band.centre_um;
        (value(&material.emissivity, um) - (1.0 - value(&material.reflectance, um))).abs()
    };
    let bands = scene.sensor.bands.iter().zip(intervals);
    bands
        .filter(|(_, i)| i.mode != 0 && material.photometry == Photometry::Lambert)
        .map(|(b, _)| off(b))
        .fold(0.0, f64::max)
}

/// As many groups of an OBJ file can be told apart.
const GROUPS: usize = 676;

/// The surface as OBJ files, each with a group for each of its materials; one file unless there are more than [`GROUPS`].
fn surfaces(mesh: Mesh, materials: usize) -> Vec<Surface> {
    let mut is_used = vec![false; materials];
    mesh.material.iter().for_each(|m| is_used[m.0 as usize] = true);
    let used: Vec<usize> = (0..materials).filter(|m| is_used[*m]).collect();
    let groups = |batch: &[usize]| {
        let mut groups = vec![String::new(); materials];
        let names = group_names(batch.len()).unwrap_or_default();
        batch.iter().zip(names).for_each(|(material, name)| groups[*material] = name);
        groups
    };
    if used.len() <= GROUPS {
        return vec![Surface { groups: groups(&used), mesh }];
    }
    let part = |batch: &[usize]| {
        let groups = groups(batch);
        Surface { mesh: part(&mesh, |material| !groups[material].is_empty()), groups }
    };
    used.chunks(GROUPS).map(part).collect()
}

/// The facets of some materials, with the vertices that these have.
fn part(mesh: &Mesh, is_of_it: impl Fn(usize) -> bool) -> Mesh {
    let mut part = Mesh::default();
    let mut place = vec![u32::MAX; mesh.vertices_m.len()];
    for (facet, material) in mesh.facets.iter().zip(&mesh.material).filter(|(_, m)| is_of_it(usize::from(m.0))) {
        let corner = |v: u32| {
            let place = &mut place[v as usize];
            if *place == u32::MAX {
                *place = part.vertices_m.len() as u32;
                part.vertices_m.push(mesh.vertices_m[v as usize]);
            }
            *place
        };
        let corners = facet.map(corner);
        part.facets.push(corners);
        part.material.push(*material);
    }
    part
}

/// So many names of groups whose order DART's versions agree about: alphabetical, and that of a Java hash map.
///
/// A map of n names has a table of 16 places, doubled until n fills at most three quarters, and goes through the places h mod size.
/// The hash of two letters, 31 a + b, grows in alphabetical order and stays below 2^16; so names whose hashes lie between
/// two multiples of the table's size are in the same order both ways. `None` where there are not so many.
pub fn group_names(count: usize) -> Option<Vec<String>> {
    let mut places = 16;
    while 4 * count > 3 * places {
        places *= 2;
    }
    let letters = || b'a'..=b'z';
    let pairs: Vec<[u8; 2]> = letters().flat_map(|a| letters().map(move |b| [a, b])).collect();
    let block = |[a, b]: &[u8; 2]| (31 * usize::from(*a) + usize::from(*b)) / places;
    let run = pairs.chunk_by(|x, y| block(x) == block(y)).find(|run| run.len() >= count)?;
    Some(run[..count].iter().map(|[a, b]| [*a as char, *b as char].iter().collect()).collect())
}

/// A scene and its place in DART's frame.
struct Site<'a> {
    scene: &'a Scene,
    dart_from_body: DMat3,
    origin_in_dart_m: DVec3,
}

impl Site<'_> {
    /// The object of the OBJ file with this number, from 0.
    fn object(&self, number: usize, groups: &[String], target: Target, links: &[Links]) -> Object {
        let name = if number == 0 { SURFACE.into() } else { format!("{SURFACE}_{}", number + 1) };
        let used: Vec<usize> = (0..groups.len()).filter(|m| !groups[*m].is_empty()).collect();
        // Of an OBJ with one group 5.7 wants no list; what 5.11 wants is known with a list only.
        let whole = if target == Target::V5_7_4 && used.len() == 1 { Some(links[used[0]].clone()) } else { None };
        let group = |(i, &material): (usize, &usize)| Group {
            number: i as u32 + 1,
            name: groups[material].clone(),
            hidden: false,
            double_face: false,
            links: Some(links[material].clone()),
            back: None,
            at: Location::item("mesh"),
        };
        let groups = if whole.is_some() { Vec::new() } else { used.iter().enumerate().map(group).collect() };
        Object {
            file: format!("obj/{name}.obj"),
            name,
            position_m: self.origin_in_dart_m,
            scale: DVec3::ONE,
            rotation_deg: DVec3::ZERO,
            dem_mode: 2,
            hidden: false,
            repeated_on_border: false,
            double_face: false,
            links: whole,
            back: None,
            groups,
            at: Location::item("mesh"),
        }
    }

    fn camera(&self) -> Camera {
        let camera = &self.scene.sensor.camera;
        let (look_deg, roll_deg) = camera_deg(self.dart_from_body * camera.world_from_sensor.rotation, camera.pitch);
        let angle_deg = |pixels: u32| (2.0 * (0.5 * f64::from(pixels) * camera.pitch).atan()).to_degrees();
        Camera {
            position_m: self.dart_from_body * camera.centre_m() + self.origin_in_dart_m,
            look_deg,
            roll_deg,
            field_of_view_deg: [angle_deg(camera.samples), angle_deg(camera.lines)],
            pixels: [camera.samples, camera.lines],
            at: Location::item("sensor"),
        }
    }

    /// The simulation with Mars in the Sun's place: a beam from its centre, with the irradiance of a facet that faces it.
    fn by_mars(&self, simulation: &Simulation, report: &mut Report) -> Option<Simulation> {
        let mars = self.scene.mars.as_ref()?;
        let mut note = |message: String| report.note(Fate::Carried, Location::item("mars"), message);
        let towards = Direction::new(mars.centre_m)?.vec();
        let mars_deg = frame::angles_deg(self.dart_from_body * towards);
        let share = on_facet_from_mars(mars, towards, self.scene.sun.direction.vec());
        if mars_deg[0] >= 90.0 || share <= 0.0 {
            note("Mars is below the site's horizon, or dark: no simulation has its light".into());
            return None;
        }
        let radius_deg = (mars.radius_m / mars.centre_m.length()).asin().to_degrees();
        note(format!(
            "Mars is {radius_deg:.1} deg in radius; DART has one source, a parallel one: the simulation in `mars` has Mars' \
             light as a beam from its centre, and its radiances are to be added to the Sun's"
        ));
        let sun = &self.scene.sun;
        let irradiance = self.scene.sensor.bands.iter().map(|band| {
            let product = band_mean(band, &[&sun.irradiance_1au, &mars.reflectance]);
            (share * sun::irradiance_at(product, sun.distance_m), 0.0)
        });
        let mut by_mars = simulation.clone();
        by_mars.phase.irradiance = irradiance.collect();
        // Heat is in the other simulation.
        by_mars.phase.bands.iter_mut().for_each(|band| band.mode = 0);
        by_mars.directions.sun_deg = mars_deg;
        by_mars.directions.at = Location::item("mars");
        Some(by_mars)
    }

    /// What became of what DART has no exact counterpart for.
    fn notes(&self, simulation: &Simulation, size: &Size, options: &WriteOptions, report: &mut Report) {
        let scene = self.scene;
        let item = Location::item;
        report.note(
            Fate::Carried,
            item("origin_m"),
            "DART's frame starts at the scene's corner; x is South, y East, z outward",
        );
        report.note(
            Fate::Carried,
            item("sun"),
            format!(
                "distance and spectrum: DART has irradiances at the body, one for each of {} bands",
                scene.sensor.bands.len()
            ),
        );
        if sun_deg(scene).is_none() {
            let towards = self.dart_from_body * scene.sun.direction.vec();
            let message = format!(
                "the Sun stands {:.3} deg below the site's horizon, where DART has none: irradiance 0",
                frame::angles_deg(towards)[0] - 90.0
            );
            report.note(Fate::Approximated, item("sun"), message);
        }
        if scene.thermal != Thermal::Off {
            let message =
                "DART spreads temperatures by sunlight between two ends, which are those of this scene's model";
            report.note(Fate::Carried, item("thermal"), message);
        }
        report.note(
            Fate::Carried,
            item("materials"),
            "Bond albedo, bolometric emissivity and mixtures; DART's emissivity is 1 - reflectance",
        );
        for (material, function) in scene.materials.iter().zip(&simulation.thermal) {
            let off = emissivity_off(scene, material, &simulation.phase.bands);
            if off > 1e-12 && function.mean_k > 0.0 {
                let message = format!("in DART it is 1 - reflectance: up to {off:.4} off in the bands with heat");
                report.note(
                    Fate::Approximated,
                    Location::item(format!("materials.{:?}.emissivity", material.name)),
                    message,
                );
            }
        }
        let monochromatic = scene.sensor.bands.iter().filter(|b| b.fwhm_um.is_none()).count();
        if monochromatic < scene.sensor.bands.len() {
            report.note(
                Fate::Carried,
                item("sensor.bands"),
                "Gaussian responses; DART's are rectangles of the same width",
            );
        }
        if monochromatic > 0 {
            let message = format!("{monochromatic} monochromatic bands are {MONOCHROMATIC_UM} um wide in DART");
            report.note(Fate::Defaulted, item("sensor.bands"), message);
        }
        if simulation.phase.cameras.iter().any(|c| c.roll_deg != 0.0) {
            let message = format!(
                "roll unverified: the camera is turned by {} deg about its line of sight, clockwise as it looks; DART does not \
                 document the sign. Compare an image before you trust it",
                simulation.phase.cameras[0].roll_deg
            );
            report.note(Fate::Defaulted, item("observer"), message);
        }
        let ahead = self.dart_from_body * scene.sensor.camera.world_from_sensor.rotation.z_axis;
        let tilt_rad = crate::geometry::angle_rad(ahead, DVec3::NEG_Z);
        if simulation.phase.cameras.iter().any(|c| c.look_deg[0] == 180.0) && tilt_rad > 0.0 {
            let message = format!(
                "the camera looks straight down but for {tilt_rad:.1e} rad, less than a tenth of a pixel: straight down"
            );
            report.note(Fate::Carried, item("observer"), message);
        }
        let files = simulation.objects.len();
        if files > 1 {
            let message = format!("{files} OBJ files: the groups of one are told apart up to {GROUPS} materials");
            report.note(Fate::Carried, item("mesh"), message);
        }
        match sidecar::runs_of_faces(&scene.mesh) {
            Some(runs) if runs.is_empty() => {}
            Some(_) if files == 1 => report.note(Fate::Carried, item("mesh"), "which face each triangle was cut from"),
            _ => report.note(
                Fate::Dropped,
                item("mesh"),
                "which face each triangle was cut from: their order is not the triangles'",
            ),
        }
        let ground = match options.target {
            Target::V5_7_4 => "DART has a ground plane at z = 0: it is black and at 0 K, below all of the surface",
            Target::V5_11_0 => "DART's ground plane is switched off",
        };
        report.note(Fate::Defaulted, item("ground"), ground);
        let [x, y, z] = size.cells;
        let gib = |bytes: u64| bytes as f64 / (1u64 << 30) as f64;
        let mut message = format!(
            "{} triangles, {x} x {y} x {z} cells of {} m: DART may need {:.1} GiB (64 B a cell, 256 B a triangle and 80 B for each \
             of its bands, 8 B for each band of a pixel; a formula that is inferred, not known)",
            size.facets,
            simulation.maket.cell_m[0],
            gib(size.bytes)
        );
        if size.bytes > options.memory_bytes {
            message.push_str(&match coarser(simulation, size, options.memory_bytes) {
                Some(cell_m) => {
                    format!(", more than {:.1} GiB: cells of {cell_m} m would fit", gib(options.memory_bytes))
                }
                None => format!(
                    ", more than {:.1} GiB whatever the cells: convert fewer bands or facets at a time",
                    gib(options.memory_bytes)
                ),
            });
        }
        report.note(Fate::Defaulted, item("size"), message);
    }
}

/// The least power of two times the cell size that fits, m.
fn coarser(simulation: &Simulation, size: &Size, memory_bytes: u64) -> Option<f64> {
    let mut simulation = simulation.clone();
    let height_m = size.cells[2] as f64 * simulation.maket.cell_m[1];
    loop {
        simulation.maket.cell_m = simulation.maket.cell_m.map(|c| 2.0 * c);
        let coarser = Size::of(&simulation, size.facets, height_m);
        if coarser.bytes <= memory_bytes {
            return Some(simulation.maket.cell_m[0]);
        }
        if coarser.cells == [1; 3] {
            return None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `String.hashCode` and the place in a `HashMap` of Java, written from their documentation.
    fn place(name: &str, places: u32) -> u32 {
        let hash = name.encode_utf16().fold(0u32, |h, c| h.wrapping_mul(31).wrapping_add(u32::from(c)));
        (hash ^ (hash >> 16)) & (places - 1)
    }

    #[test]
    fn groups_are_in_the_same_order_both_ways() {
        for count in 0..=676 {
            let names = group_names(count).unwrap_or_else(|| panic!("{count}"));
            assert_eq!(names.len(), count);
            assert!(names.is_sorted());
            let mut places = 16;
            while f64::from(places) * 0.75 < count as f64 {
                places *= 2;
            }
            assert!(names.windows(2).all(|w| place(&w[0], places) < place(&w[1], places)), "{count}");
        }
        assert!(group_names(677).is_none());
    }
}
