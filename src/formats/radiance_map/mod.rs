//! Radiance maps from elsewhere: a raster or a table of facets, and a map file that says what its numbers are and where they lie.
//!
//! A map file is TOML: it is named itself, or lies next to the raster, as `x.map.toml` next to `x.img`. Its JSON Schema is in
//! `schemas/`. Tables of facets that say all of it themselves need none:
//!
//! - `.npz`: `radiance_w_m2_sr_um` \[facet, band\], `wavelength_um` \[band\], and if bands have a width `fwhm_um` \[band\];
//! - `.csv`: a header `facet,radiance_w_m2_sr_um at 0.95 um,..` with a column for each band, then a line for each facet, in order,
//!   counted from 0.

mod facets;
mod sum;
mod types;
pub(in crate::formats) mod unit;
mod values;

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::dart::{self, output as dart_output, output::RegistrationMode};
use super::input;
use super::located::Document;
use super::product_image::product_image;
use super::raster::Raster;
use super::raster::headers::ILWIS;
use super::registry;
use super::scene_toml::{self, Lens, Optics, Tiling, TomlReader};
use super::{Format, InputFile};
use crate::error::{Error, Location, Problem, Result, number};
use crate::geometry::{Camera, Direction, FrameCamera, Pose};
use crate::product::{Placement, Quantity, RadianceMap, SkyShare, TexelSource, ViewImage};
use crate::progress::Watch;
use crate::scene::Scene;
use crate::spectral::{Band, KnownLight, Light};

pub(crate) use sum::counts_once;
pub use sum::{Sum, Summand, open_sum, summands};
use types::{DartMapToml, MapToml, NegativeToml, NumbersToml, PlacementToml, QuantityToml, RegistrationToml, SkyToml};
pub(super) use unit::Unit;

use values::{RasterTexels, TiledTexels, ToRadiance};

/// How many W m-2 sr-1 um-1 one of a unit is, however a file spells it; `None` for units of other things.
pub fn radiance_scale(unit: &str) -> Option<f64> {
    Unit::of(unit)?.over(&Unit::of(Quantity::Radiance.unit())?)
}

/// A repeated image has no more texels: as f64 they take 2 GiB.
const MOST_TEXELS: usize = 1 << 28;
/// Width over height of pixels is the same within this: OpenEXR has it as f32.
const SAME_ASPECT: f64 = 1e-6;

/// The maps that were found at a path: one, or one for each direction of view.
#[derive(Debug)]
pub struct Opened {
    /// The maps.
    pub maps: Vec<RadianceMap>,
    /// Every file that was read: headers and map files; rasters are read later, band by band.
    pub inputs: Vec<InputFile>,
    /// What is worth knowing.
    pub notes: Vec<String>,
}

/// The JSON Schema of a map file.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(MapToml)
}

/// The JSON Schema of a map file that names an output of DART.
pub fn dart_schema() -> schemars::Schema {
    schemars::schema_for!(DartMapToml)
}

/// Opens a path as maps of a scene; `weight` multiplies their radiance.
///
/// | at the path | |
/// |---|---|
/// | a map file (`.toml`), or a raster with one next to it | as it says |
/// | `.npz`, `.csv` with radiance and wavelengths of facets | see above |
/// | a DART simulation, its `output/`, a folder of images, an image, `RADIATIVE_BUDGET` | its views, or triangles: see [`dart::output`] |
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`]; [`Error::Invalid`] with all that is wrong in the map file, with the rasters it names, and
/// with both together; [`Error::Unsupported`] for rasters that are not read.
pub fn open(path: &Path, scene: &Scene, weight: f64, watch: Watch<'_>) -> Result<Opened> {
    if let Some(file) = map_file(path) {
        return read(&file, path, scene, weight, watch);
    }
    if let Some((map, input)) = facets::open(path, weight)? {
        let notes = facets::doubts(path, scene)?;
        return Ok(Opened { maps: vec![map], inputs: vec![input], notes });
    }
    if path.join("report.json").is_file() && product_image(path, "cube").exists() {
        let problem = Problem::new(Location::file(path), "is a product: a map is one of its images");
        let help = format!(
            "name {0}/cube.img, and say in {0}/cube.map.toml what its numbers are and where they lie: `quantity`, `unit` and `placement`",
            path.display()
        );
        return Err(Error::Invalid(vec![problem.with_help(help)]));
    }
    if path.is_dir() || registry::called(path, Format::is_image) == Some(&ILWIS) {
        return of_dart(path, scene, weight, &dart_output::OutputMapOptions::default(), watch);
    }
    if let Some(problem) = facets::missing(path)? {
        let help = format!(
            "a table of facets has `{}` besides `wavelength_um`; for an image say in {} what it is: `quantity`, `unit` and `placement`",
            facets::RADIANCE,
            beside(path).display()
        );
        return Err(Error::Invalid(vec![problem.with_help(help)]));
    }
    // A file that is not a raster either is reported as such.
    let raster = registry::image(path)?;
    let message = format!(
        "is a raster of {} x {} pixels and {} bands, but what its numbers are, and where they lie, is not known",
        raster.columns,
        raster.rows,
        raster.bands.len()
    );
    let help = format!("say it in {}: `quantity`, `unit` and `placement`", beside(path).display());
    Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
}

/// The map file next to a raster.
fn beside(path: &Path) -> PathBuf {
    path.with_extension("map.toml")
}

/// The map file that belongs to a path, if there is one.
fn map_file(path: &Path) -> Option<PathBuf> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
        return Some(path.to_owned());
    }
    let mut appended = path.as_os_str().to_owned();
    appended.push(".map.toml");
    let near = [beside(path), PathBuf::from(appended)].into_iter().find(|p| p.is_file());
    // Of a link, where it leads to.
    let target = || path.canonicalize().ok().filter(|_| path.is_symlink());
    near.or_else(|| target().map(|target| beside(&target)).filter(|p| p.is_file()))
}

/// The number of facets and the bands of a table of facets; `None` if the file is something else.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with all that is wrong in the table; [`Error::Syntax`] for a damaged `.npz`.
pub fn facets_of(path: &Path) -> Result<Option<(usize, Vec<Band>)>> {
    let Some((map, _)) = facets::open(path, 1.0)? else { return Ok(None) };
    let facets = match map.placement {
        Placement::Facets(facets) => facets,
        _ => 0,
    };
    Ok(Some((facets, map.source.bands().to_vec())))
}

/// Whether a TOML document is a map file.
pub fn is_map(document: &Document) -> bool {
    document.has("mmxrt_map")
}

/// What a map file says, for people: keys and their texts, in its order.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`]; [`Error::Invalid`] with all keys that are unknown or missing, and values of another kind.
pub fn describe(path: &Path) -> Result<Vec<(String, String)>> {
    let (document, _) = Document::open(path)?;
    if document.has("dart") {
        document.read::<DartMapToml>()?;
    } else {
        document.read::<MapToml>()?;
    }
    let value = |key: String| {
        let text = document.at(&key).span.and_then(|(a, b)| document.text().get(a..b)).unwrap_or_default().to_owned();
        (key, text)
    };
    Ok(document.keys("").into_iter().map(value).collect())
}

fn sky(toml: Option<SkyToml>) -> SkyShare {
    match toml {
        None => SkyShare::Guessed,
        Some(SkyToml::Included) => SkyShare::Included,
        Some(SkyToml::LeftOut) => SkyShare::LeftOut,
    }
}

/// All views of a DART output, in one quantity; without any, the radiative budget of its triangles.
fn of_dart(
    path: &Path,
    scene: &Scene,
    weight: f64,
    options: &dart_output::OutputMapOptions,
    watch: Watch<'_>,
) -> Result<Opened> {
    use dart_output::ImageQuantity::{Brf, Radiance, Tapp};
    let output = dart_output::open(path)?;
    let mut notes = Vec::new();
    let mut maps = Vec::new();
    let has = |quantity| output.views().iter().any(|view| view.quantity == quantity);
    // The same images in several quantities are one map: that which is nearest to radiance.
    let Some(taken) = [Radiance, Brf, Tapp].into_iter().find(|quantity| has(*quantity)) else {
        let (map, mismatch) = output.budget_map(scene, options)?;
        notes.push(format!(
            "{}: {:.6} of {:.6} m2 of the scene's facets have no triangle, {:.6} of {:.6} m2 of the triangles no facet",
            map.name, mismatch.facets_m2, mismatch.all_facets_m2, mismatch.triangles_m2, mismatch.all_triangles_m2
        ));
        return Ok(Opened { maps: vec![RadianceMap { weight: map.weight * weight, ..map }], inputs: vec![], notes });
    };
    for (i, view) in output.views().iter().enumerate() {
        if view.quantity == taken {
            let (map, note) = output.view_map(i, scene, options, watch)?;
            notes.extend(note);
            maps.push(RadianceMap { weight: map.weight * weight, ..map });
        }
    }
    let others = [Brf, Tapp].into_iter().filter(|other| *other != taken && has(*other));
    for other in others {
        notes.push(format!(
            "{}: images of {} are ignored: those of {} are taken",
            path.display(),
            other.name(),
            taken.name()
        ));
    }
    Ok(Opened { maps, inputs: vec![], notes })
}

/// Reads a map file; `asked` is the path that it was found by.
fn read(file: &Path, asked: &Path, scene: &Scene, weight: f64, watch: Watch<'_>) -> Result<Opened> {
    let (document, input) = Document::open(file)?;
    if document.has("dart") {
        let toml: DartMapToml = document.read()?;
        let scene_from_dart =
            toml.origin_in_dart_m.map(|origin| dart::placed(scene.body.origin_m, DVec3::from_array(origin)));
        let irradiance_w_m2_um = toml.irradiance_w_m2_um;
        let placing = match (toml.shift_texels, toml.registration) {
            (Some(_), Some(_)) => {
                let message = "does not go with `shift_texels`, which says where the image lies";
                return Err(Error::Invalid(vec![Problem::new(document.at("registration"), message)]));
            }
            (Some(shift_texels), None) => RegistrationMode::Shifted(shift_texels),
            (None, Some(RegistrationToml::Printed)) => RegistrationMode::Shifted([0.0; 2]),
            (None, Some(RegistrationToml::Forced)) => RegistrationMode::Forced,
            (None, Some(RegistrationToml::Outline) | None) => RegistrationMode::Outline,
        };
        let options =
            dart_output::OutputMapOptions { scene_from_dart, irradiance_w_m2_um, placing, sky: sky(toml.sky) };
        let path = input::home(file, Path::new(&toml.dart)).join(toml.dart);
        let mut opened = of_dart(&path, scene, weight, &options, watch)?;
        opened.inputs.push(input);
        return Ok(opened);
    }
    let toml: MapToml = document.read()?;
    let mut reader = TomlReader::new(file, document, scene.body.origin_m, input, watch);
    let rasters = match &toml.raster {
        Some(named) => reader.rasters("raster", named, toml.channels.as_deref()),
        None if asked != file => reader.opened("raster", vec![asked.to_owned()], toml.channels.as_deref()),
        None => {
            reader.problem("raster", "is missing: this file does not say which raster it belongs to");
            None
        }
    };
    let map = rasters.and_then(|rasters| {
        let name = rasters[0].path.display().to_string();
        let (placement, source) = map(&mut reader, &toml, rasters, scene, watch)?;
        let light = light(&mut reader, &toml, source.bands())?;
        let sky = sky(toml.sky);
        Some(RadianceMap { name, placement, source, weight, light, sky, registration: None })
    });
    let (inputs, notes) = reader.finish()?;
    match map {
        Some(map) => Ok(Opened { maps: vec![map], inputs, notes }),
        None => Err(Error::invalid(Location::file(file), "cannot be used")),
    }
}

/// What light bands hold, as the map file says.
fn light(reader: &mut TomlReader<'_>, toml: &MapToml, bands: &[Band]) -> Option<Vec<KnownLight>> {
    let is_said = toml.bands.as_ref().is_some_and(|bands| bands.light.is_some());
    let of_all = match toml.heat {
        Some(_) if is_said => {
            reader.problem("heat", "is in `light` of `bands` already: leave one of them out");
            return None;
        }
        Some(false) => KnownLight::from(Light::Sunlight),
        Some(true) => KnownLight::HEAT,
        None if is_said => return Some(bands.iter().map(|band| band.light.into()).collect()),
        None if toml.quantity == QuantityToml::BrightnessTemperature => KnownLight::HEAT,
        None => KnownLight::default(),
    };
    Some(vec![of_all; bands.len()])
}

fn map(
    reader: &mut TomlReader<'_>,
    toml: &MapToml,
    mut rasters: Vec<Raster>,
    scene: &Scene,
    watch: Watch<'_>,
) -> Option<(Placement, Box<dyn TexelSource>)> {
    let facets = scene.body.mesh.facets.len();
    if toml.placement == PlacementToml::Facets {
        // A table of [facet, band], which a reader of images takes for one band.
        rasters = rasters.into_iter().map(|r| if r.pixels() == facets { r } else { r.columns_as_bands() }).collect();
    }
    let bands = reader.raster_bands("bands", toml.bands.as_ref(), &rasters);
    let placement = placement(reader, toml, &rasters, scene, watch);
    let bands = bands?;
    let unit = unit(reader, toml, &rasters)?;
    rasters.iter_mut().for_each(|raster| raster.set_no_data(toml.no_data));
    let irradiance = |band: usize| match &toml.irradiance_w_m2_um {
        None => None,
        Some(NumbersToml::All(value)) => Some(*value),
        Some(NumbersToml::Each(values)) => values.get(band).copied(),
    };
    if let Some(NumbersToml::Each(values)) = &toml.irradiance_w_m2_um
        && values.len() != bands.len()
    {
        reader.problem("irradiance_w_m2_um", format!("{} numbers for {} bands", values.len(), bands.len()));
        return None;
    }
    match &toml.irradiance_w_m2_um {
        Some(_) if toml.quantity != QuantityToml::ReflectanceFactor => {
            reader
                .problem("irradiance_w_m2_um", "does not go with this quantity: only reflectance factors refer to one");
        }
        Some(given) => {
            let values = match given {
                NumbersToml::All(value) => std::slice::from_ref(value),
                NumbersToml::Each(values) => values,
            };
            if let Some(value) = values.iter().find(|v| **v < 0.0) {
                reader.problem("irradiance_w_m2_um", format!("{} is negative", number(*value)));
            }
        }
        None => {}
    }
    let convert = |(i, band): (usize, &Band)| ToRadiance::new(toml.quantity, &unit, band, irradiance(i));
    match bands.iter().enumerate().map(convert).collect() {
        Ok(conversion) => {
            let (placement, tiling) = placement?;
            let clips = toml.negative == Some(NegativeToml::Clip);
            let texels = RasterTexels { rasters, bands, conversion, clips };
            Some((
                placement,
                match tiling {
                    Some(tiling) => Box::new(TiledTexels { texels, tiling, image: vec![] }),
                    None => Box::new(texels),
                },
            ))
        }
        Err(message) => {
            reader.problem("unit", message);
            None
        }
    }
}

/// The unit of a map's numbers: that which its file gives, compared with what the rasters state; or theirs.
fn unit(reader: &mut TomlReader<'_>, toml: &MapToml, rasters: &[Raster]) -> Option<Unit> {
    let unit = stated_unit(reader, toml, rasters)?;
    if unit.over(&Unit::ONE) == Some(0.01)
        && let Some(message) = rasters.iter().find_map(Raster::percent_of_fractions)
    {
        reader.note("unit", message);
    }
    Some(unit)
}

fn stated_unit(reader: &mut TomlReader<'_>, toml: &MapToml, rasters: &[Raster]) -> Option<Unit> {
    let stated: Vec<(&str, Unit)> =
        rasters.iter().filter_map(|r| r.stated_unit()).filter_map(|text| Some((text, Unit::of(text)?))).collect();
    let Some(given) = &toml.unit else {
        return match (&stated[..], rasters.iter().find_map(Raster::stated_unit)) {
            ([(_, unit), rest @ ..], _) if stated.len() == rasters.len() && rest.iter().all(|(_, u)| u == unit) => {
                Some(unit.clone())
            }
            ([], Some(text)) => {
                let message = format!("is missing, and {text:?}, as the raster states it, is not understood");
                reader.helped("unit", message, unit::KNOWN);
                None
            }
            _ => {
                reader.problem("unit", "is missing, and the raster states none");
                None
            }
        };
    };
    let Some(unit) = Unit::of(given) else {
        reader.helped("unit", format!("{given:?} is not understood"), unit::KNOWN);
        return None;
    };
    if let Some((text, of_raster)) = stated.into_iter().find(|(_, stated)| stated.over(&unit) != Some(1.0)) {
        let factor =
            of_raster.over(&unit).map_or_else(String::new, |times| format!(", {} times as much", number(times)));
        reader.note("unit", format!("the raster states {text:?}{factor}: {given:?} is taken, as it says here"));
    }
    Some(unit)
}

fn placement(
    reader: &mut TomlReader<'_>,
    toml: &MapToml,
    rasters: &[Raster],
    scene: &Scene,
    watch: Watch<'_>,
) -> Option<(Placement, Option<Tiling>)> {
    let (rows, columns) = (rasters[0].rows, rasters[0].columns);
    let occlusion = toml.occlusion.unwrap_or(true);
    let wanted = match toml.placement {
        PlacementToml::Camera => ["observer", "sensor", "scene", "occlusion", "sky"].as_slice(),
        PlacementToml::Plane => &["plane", "occlusion", "sky"],
        PlacementToml::Atlas => &["wrap"],
        PlacementToml::LonLat => &["west_deg"],
        PlacementToml::Facets => &[],
    };
    let given = [
        ("observer", toml.observer.is_some()),
        ("sensor", toml.sensor.is_some()),
        ("scene", toml.scene.is_some()),
        ("plane", toml.plane.is_some()),
        ("occlusion", toml.occlusion.is_some()),
        ("sky", toml.sky.is_some()),
        ("wrap", toml.wrap.is_some()),
        ("west_deg", toml.west_deg.is_some()),
    ];
    for (key, _) in given.into_iter().filter(|(key, is_given)| *is_given && !wanted.contains(key)) {
        reader.problem(key, "does not go with this placement");
    }
    match toml.placement {
        PlacementToml::Facets => Some((Placement::Facets(rows * columns), None)),
        PlacementToml::Atlas => {
            if scene.body.mesh.uv.is_empty() {
                reader.helped(
                    "placement",
                    "the scene's meshes have no texture coordinates",
                    "an OBJ has them as `vt` lines, and its faces as `f 1/1 2/2 3/3`",
                );
                return None;
            }
            let (atlas, tiling) =
                reader.atlas("placement", scene.body.mesh.uv.clone(), [rows, columns], toml.wrap, MOST_TEXELS)?;
            Some((Placement::Atlas(atlas), tiling))
        }
        PlacementToml::LonLat => {
            let (map, tiling) = reader.lon_lat("west_deg", toml.west_deg, rasters, MOST_TEXELS)?;
            Some((Placement::LonLat(map), Some(tiling)))
        }
        PlacementToml::Camera => {
            let camera = camera(reader, toml, rows, columns, watch)?;
            let [own, given] = [rasters[0].pixel_aspect, camera.pitch[0] / camera.pitch[1]];
            // Square is also what rasters say that do not know.
            if (own - 1.0).abs() > SAME_ASPECT && (own / given - 1.0).abs() > SAME_ASPECT {
                let [own, given] = [own, given].map(number);
                let message = format!("its pixels are {own} times as wide as high, those of the camera {given} times");
                reader.helped(
                    "raster",
                    message,
                    "`pixel_aspect` of the sensor says how many times as high as wide they are",
                );
                return None;
            }
            let view = ViewImage { camera: Camera::Frame(camera), occlusion };
            Some((Placement::View(Box::new(view)), None))
        }
        PlacementToml::Plane => {
            let camera = reader.raster_plane("plane", toml.plane.as_ref(), &rasters[0])?;
            let is_given = toml.plane.as_ref().is_some_and(|plane| plane.towards.is_some());
            if !is_given && !seen_from(scene, camera.towards) {
                let opposite = (-camera.towards.vec()).to_array().map(|x| x + 0.0);
                reader.helped(
                    "plane",
                    "no facet's outer side is seen from its side: lines run to the right and follow one another downwards as seen from there",
                    format!(
                        "if lines run from the South to the North, say from where the image is seen: `towards = {opposite:?}` in `plane`"
                    ),
                );
                return None;
            }
            let camera = Camera::Parallel(camera);
            Some((Placement::View(Box::new(ViewImage { camera, occlusion })), None))
        }
    }
}

/// Whether the outer side of any facet is seen from a direction.
fn seen_from(scene: &Scene, towards: Direction) -> bool {
    (0..scene.body.mesh.facets.len()).any(|facet| scene.body.mesh.facet(facet).cross_m2().dot(towards.vec()) > 0.0)
}

/// The camera that an image was taken by, local to the scene.
fn camera(
    reader: &mut TomlReader<'_>,
    toml: &MapToml,
    rows: usize,
    columns: usize,
    watch: Watch<'_>,
) -> Option<FrameCamera> {
    let (Ok(samples), Ok(lines)) = (u32::try_from(columns), u32::try_from(rows)) else { return None };
    match (&toml.scene, &toml.observer, &toml.sensor) {
        (Some(name), None, None) => {
            let path = reader.path(name);
            let other = reader.taken("scene", scene_toml::read(&path, watch))?;
            let mut camera = other.scene.exposure.camera.clone();
            if (camera.samples, camera.lines) != (samples, lines) {
                let message = format!(
                    "{name} has a camera of {} x {} pixels, but the raster has {samples} x {lines}",
                    camera.samples, camera.lines
                );
                reader.problem("scene", message);
                return None;
            }
            let moved_m = other.scene.body.origin_m - reader.origin_m();
            camera.world_from_sensor.translation_m += moved_m;
            Some(camera)
        }
        (None, Some(observer), Some(sensor)) => {
            let pose: Option<Pose> = reader.observer(observer);
            let Optics { pitch, boresight_px, lens } =
                reader.optics(&Lens::from(sensor), [samples, lines], false, None)?;
            Some(FrameCamera { world_from_sensor: pose?, samples, lines, pitch, boresight_px, lens })
        }
        _ => {
            reader.problem("placement", "a camera needs `observer` and `sensor`, or a `scene` that has them");
            None
        }
    }
}
