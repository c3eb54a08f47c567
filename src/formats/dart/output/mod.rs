//! What a DART simulation computed, as radiance maps of a scene: images of parallel views, and the radiative budget of
//! triangles.
//!
//! `output/BANDn/{BRF,Tapp,Radiance}/ITERn/IMAGES_DART/*.mpr` are the images, and the same in `output/2_Ground` and the like those of one
//! type of objects; `simulation.properties.txt` gives their
//! directions, bands and irradiances. Axes and angles of DART end here: maps lie in the scene's local frame.

mod budget;
mod georef;
mod images;
mod others;
mod properties;
mod register;

use std::path::{Component, Path, PathBuf};

use glam::DVec3;

use crate::error::{Error, Location, Problem, Result};
use crate::geometry::{Direction, Pose};
use crate::product::{RadianceMap, SkyShare};
use crate::progress::Watch;
use crate::scene::Scene;
use crate::spectral::Band;

use super::frame;
use super::place::scene_from_dart;
use super::read::{self, ReadOptions};
pub use budget::Mismatch;
use properties::{Properties, Told};

/// The quantity of DART's images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ImageQuantity {
    /// Reflectance factor: pi times radiance over the irradiance of a horizontal plane.
    Brf,
    /// Apparent temperature: that of a black body of the same radiance, K.
    Tapp,
    /// Radiance, W m-2 sr-1 um-1.
    Radiance,
}

impl ImageQuantity {
    const ALL: [ImageQuantity; 3] = [ImageQuantity::Brf, ImageQuantity::Tapp, ImageQuantity::Radiance];

    /// The name of its folders.
    pub fn name(self) -> &'static str {
        match self {
            ImageQuantity::Brf => "BRF",
            ImageQuantity::Tapp => "Tapp",
            ImageQuantity::Radiance => "Radiance",
        }
    }
}

/// A band of a view.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputBand {
    /// DART's number of it, from 0.
    pub number: usize,
    /// Middle and full width of the wavelengths it reaches over.
    pub band: Band,
    /// The image's header, `.mpr`.
    pub path: PathBuf,
}

/// An image by parallel projection, in some bands.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputView {
    /// The images' common name, as in `ima03_VZ=022_4_VA=090_0`.
    pub name: String,
    /// What they hold.
    pub quantity: ImageQuantity,
    /// The folder of the iteration that they are of, as in `ITER3`; `ITERX` is extrapolated to all iterations.
    pub iteration: String,
    /// Zenith angle and azimuth of the direction from the scene to the viewer, deg, in DART's frame: azimuths from x (down the
    /// image, South) to y (right, East).
    pub towards_deg: [f64; 2],
    /// To what these angles are known, deg.
    rounding_deg: f64,
    /// The number in the name.
    number: u32,
    /// Bands that there are images of, ascending.
    pub bands: Vec<OutputBand>,
}

impl OutputView {
    /// The direction towards the viewer in the scene's local frame.
    pub fn towards(&self, scene_from_dart: &Pose) -> Direction {
        // A vector made of angles has a length.
        Direction::new(scene_from_dart.vector(frame::vector(self.towards_deg)))
            .unwrap_or_else(|| Direction::new(DVec3::Z).expect("z has a direction"))
    }
}

/// What a DART simulation computed that can be a radiance map of a scene.
#[derive(Debug, Clone)]
pub struct Output {
    /// The folder `output`.
    folder: PathBuf,
    /// The folder of one type of objects in it, as in `2_Ground`, if that is what is asked for: its images have no values (-1) where
    /// others are seen.
    of_type: Option<String>,
    properties: Properties,
    views: Vec<OutputView>,
    budget: Vec<OutputBand>,
    passed_over: Vec<String>,
}

/// What a map needs that the simulation's folder may not say.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OutputMapOptions {
    /// DART's frame in that of the scene; `None`: by the simulation's inputs, which the scene was made of or into.
    pub scene_from_dart: Option<Pose>,
    /// Irradiance of a horizontal plane under the atmosphere that reflectance factors refer to, W m-2 um-1, for each band of
    /// the map; `None`: as in `simulation.properties.txt`.
    pub irradiance_w_m2_um: Option<Vec<f64>>,
    /// How an image's place is found.
    pub placing: RegistrationMode,
    /// What texels at the scene's rim hold.
    pub sky: SkyShare,
}

/// How an image's position is found: DART-FT prints the corners of oblique images off from where they lie.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum RegistrationMode {
    /// By the outline of texels with a value against the scene's own; if they do not fit, it is an error. Images of one type of objects, which have
    /// another outline, lie where their corners put them.
    #[default]
    Outline,
    /// As above, but what fits best is taken, however bad it is.
    Forced,
    /// What it shows lies this many columns and rows beyond where its corners put it.
    Shifted([f64; 2]),
}

/// Finds what a simulation computed, at the path of its folder, of its `output/`, of a folder in it (a band, an iteration,
/// `IMAGES_DART`), or of one image: what lies there.
///
/// Of several iterations that lie there `ITERX` is taken, or that with the highest number. Values are not read.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with all that is wrong: nothing there, a band that lacks the iteration that others have,
/// names and properties that do not say a direction or a band.
pub fn open(path: &Path) -> Result<Output> {
    if !path.exists() {
        return Err(Error::io(path, "reading", std::io::ErrorKind::NotFound.into()));
    }
    let folder = root(path)?;
    let properties = Properties::read(&folder.join(properties::FILE))?;
    let of_type = type_of(&folder, path);
    let (views, budget, passed_over) = (Vec::new(), Vec::new(), Vec::new());
    let mut output = Output { folder, of_type, properties, views, budget, passed_over };
    output.find(path)?;
    Ok(output)
}

/// Whether a path is, holds or lies in what a simulation computed.
pub fn is_within(path: &Path) -> bool {
    root(path).is_ok()
}

/// The folder of `simulation.properties.txt`: `output/` within, this one, or one around.
fn root(path: &Path) -> Result<PathBuf> {
    let holds = |folder: &Path| folder.join(properties::FILE).is_file();
    let within = path.join("output");
    if holds(&within) {
        return Ok(within);
    }
    // IMAGES_DART is five folders below, one more if it is of a type of objects.
    let around = path.ancestors().filter(|folder| !folder.as_os_str().is_empty()).take(7);
    let here = Path::new(".");
    match around.chain((!path.has_root()).then_some(here)).find(|folder| holds(folder)) {
        Some(folder) => Ok(folder.to_owned()),
        None => {
            let message = format!(
                "is not an output of DART: neither it, nor `output` in it, nor a folder around it holds {}",
                properties::FILE
            );
            let help = "copy that file with the images: it tells bands, directions and irradiances";
            Err(Error::Invalid(vec![Problem::new(Location::file(path), message).with_help(help)]))
        }
    }
}

/// The folder of a type of objects, `101_NAME`, that a path lies in or is.
fn type_of(output: &Path, path: &Path) -> Option<String> {
    let (output, path) = (plain(output), plain(path));
    let name = path.strip_prefix(output).ok()?.components().next()?.as_os_str().to_str()?.to_owned();
    let (number, _) = name.split_once('_')?;
    (!number.is_empty() && number.bytes().all(|b| b.is_ascii_digit())).then_some(name)
}

/// Folders and files in a folder, sorted; none if it is not there.
fn names(folder: &Path) -> Result<Vec<String>> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let io = |e| Error::io(folder, "reading", e);
    let mut names = Vec::new();
    for entry in folder.read_dir().map_err(io)? {
        names.push(entry.map_err(io)?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}

/// The number of a band's folder, `BANDn`.
fn band_number(name: &str) -> Option<usize> {
    name.strip_prefix("BAND")?.parse().ok()
}

/// The place of an iteration's folder among others: the last is taken.
fn iteration_rank(name: &str) -> Option<u32> {
    let number = name.strip_prefix("ITER")?;
    if number == "X" { Some(u32::MAX) } else { number.parse().ok().filter(|n| *n < u32::MAX) }
}

/// The last iteration that any band has of a quantity: its name, and for each band that has it the band's number and the path
/// of `item` therein.
fn last_iteration(
    bands: &[(usize, PathBuf)],
    quantity: &str,
    item: &str,
    is_wanted: &dyn Fn(&Path) -> bool,
    problems: &mut Vec<Problem>,
) -> Result<Vec<(String, usize, PathBuf)>> {
    let mut found = Vec::new();
    for (number, folder) in bands {
        let folder = folder.join(quantity);
        let mut iterations = names(&folder)?;
        iterations.retain(|name| {
            let path = folder.join(name).join(item);
            iteration_rank(name).is_some() && is_wanted(&path) && path.exists()
        });
        if !iterations.is_empty() {
            found.push((*number, folder, iterations));
        }
    }
    let last = found.iter().flat_map(|(.., iterations)| iterations).max_by_key(|name| iteration_rank(name)).cloned();
    let Some(last) = last else { return Ok(Vec::new()) };
    let (mut paths, mut missing) = (Vec::new(), Vec::new());
    for (number, folder, iterations) in found {
        match iterations.contains(&last) {
            true => paths.push((last.clone(), number, folder.join(&last).join(item))),
            false => missing.push(folder),
        }
    }
    let message = format!("has no {last}, which other bands have: was the simulation interrupted?");
    problems.extend(missing.into_iter().map(|folder| Problem::new(Location::file(folder), message.clone())));
    Ok(paths)
}

/// A path without what names the same place twice.
fn plain(path: &Path) -> PathBuf {
    path.components().filter(|c| !matches!(c, Component::CurDir)).collect()
}

impl Output {
    /// All views there are.
    pub fn views(&self) -> &[OutputView] {
        &self.views
    }

    /// All bands of views and of the budget, each once, ascending.
    pub fn bands(&self) -> Vec<&OutputBand> {
        let mut bands: Vec<&OutputBand> = self.views.iter().flat_map(|view| &view.bands).chain(&self.budget).collect();
        bands.sort_by_key(|band| band.number);
        bands.dedup_by_key(|band| band.number);
        bands
    }

    /// The folder of the one type of objects that is asked for, as in `2_Ground`; `None` if images are of all types.
    pub fn of_type(&self) -> Option<&str> {
        self.of_type.as_deref()
    }

    /// Names of images that are not parallel views: a camera's; then what else lies there that is not read.
    pub fn passed_over(&self) -> &[String] {
        &self.passed_over
    }

    /// A view as a map of a scene: an image of it, each texel at what is seen there; and what is worth knowing about its position.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Invalid`] with all that is wrong: images that are cut short, of different sizes or without
    /// corners; corners that do not go with the size, the pixel and the direction; irradiances that are missing; a placement
    /// that is not known; a map that does not overlap the scene, or has another outline. [`Error::Interrupted`] if `watch` asks to stop.
    pub fn view_map(
        &self,
        view: usize,
        scene: &Scene,
        options: &OutputMapOptions,
        watch: Watch<'_>,
    ) -> Result<(RadianceMap, Option<String>)> {
        let Some(view) = self.views.get(view) else {
            let message = format!("there is no view {view}: there are {}, counted from 0", self.views.len());
            return Err(Error::invalid(Location::file(&self.folder), message));
        };
        let pose = self.scene_from_dart(scene, options);
        let is_outlined = options.placing == RegistrationMode::Outline;
        let Some(of_type) = self.of_type.as_ref().filter(|_| is_outlined) else {
            return images::map(view, &self.properties, pose, scene, options, watch);
        };
        let printed = OutputMapOptions { placing: RegistrationMode::Shifted([0.0; 2]), ..options.clone() };
        let (map, _) = images::map(view, &self.properties, pose, scene, &printed, watch)?;
        let note = format!(
            "{}: images of {of_type} alone do not have the scene's outline: it lies where its printed corners put it",
            map.name
        );
        Ok((map, Some(note)))
    }

    /// Bands with a radiative budget for each triangle, ascending.
    pub fn budget(&self) -> &[OutputBand] {
        &self.budget
    }

    /// The radiative budget of triangles as a map of a scene: what they scatter and emit, over pi, as Lambert surfaces send it
    /// out. A texel is a triangle, on every facet that it overlaps in the same plane.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Invalid`] with all that is wrong: no budget, a number of triangles that is not the same
    /// everywhere, a unit or irradiance that is not known; a placement that is not known; triangles that do not overlap the
    /// scene, or one another.
    pub fn budget_map(&self, scene: &Scene, options: &OutputMapOptions) -> Result<(RadianceMap, Mismatch)> {
        if self.budget.is_empty() {
            let message = format!(
                "holds no radiative budget of triangles: that is BANDn/RADIATIVE_BUDGET/ITERn/{}",
                budget::FIGURES
            );
            return Err(Error::invalid(Location::file(&self.folder), message));
        }
        let pose = self.scene_from_dart(scene, options)?;
        budget::map(&self.folder, &self.budget, &self.properties, pose, scene, options)
    }

    /// DART's frame in the scene's.
    fn scene_from_dart(&self, scene: &Scene, options: &OutputMapOptions) -> Result<Pose> {
        if let Some(pose) = options.scene_from_dart {
            return Ok(pose);
        }
        let simulation = match self.folder.parent() {
            Some(around) if !around.as_os_str().is_empty() => around.to_owned(),
            _ => self.folder.join(".."),
        };
        let reading = ReadOptions::default();
        let folder = reading.folder(&simulation);
        if !folder.input.join("maket.xml").is_file() {
            let message = "the position of DART's scene in this one is not known: the simulation's `input` is not next to its `output`";
            let help = "copy it there, or say in a map file where the scene's origin is: `dart = \"output\"`, `origin_in_dart_m = [6, 8, 0]`";
            return Err(Error::Invalid(vec![Problem::new(Location::file(&self.folder), message).with_help(help)]));
        }
        // Files that inputs name are not opened, so that it does not matter where they are.
        let (simulation, _, _) = read::read(&simulation, &ReadOptions { allow_outside: true, ..reading })?;
        scene_from_dart(&simulation, &folder, scene)
    }

    fn find(&mut self, path: &Path) -> Result<()> {
        let wanted = plain(path);
        // What is asked for lies in, or around, a folder or file.
        let is_wanted = |at: &Path| {
            let at = plain(at);
            at.starts_with(&wanted) || wanted.starts_with(&at)
        };
        let mut problems = Vec::new();
        let base = self.of_type.as_ref().map_or(self.folder.clone(), |name| self.folder.join(name));
        let mut bands: Vec<(usize, PathBuf)> = names(&base)?
            .iter()
            .filter_map(|name| Some((band_number(name)?, base.join(name))))
            .filter(|(_, folder)| is_wanted(folder))
            .collect();
        bands.sort();
        for quantity in ImageQuantity::ALL {
            let last = last_iteration(&bands, quantity.name(), "IMAGES_DART", &is_wanted, &mut problems)?;
            for (iteration, number, images) in last {
                let Some(band) = self.band(number, &mut problems) else { continue };
                for name in names(&images)? {
                    let path = images.join(&name);
                    // An image's values stand for it as well.
                    let is_asked = is_wanted(&path) || is_wanted(&path.with_extension("mp#"));
                    if let Some(name) = name.strip_suffix(".mpr").filter(|_| is_asked) {
                        let band = OutputBand { number, band: band.clone(), path };
                        if let Err(problem) = self.add(name, quantity, &iteration, band) {
                            problems.push(problem);
                        }
                    }
                }
            }
        }
        for (_, number, path) in last_iteration(&bands, budget::FOLDER, budget::FIGURES, &is_wanted, &mut problems)? {
            let Some(band) = self.band(number, &mut problems) else { continue };
            self.budget.push(OutputBand { number, band, path });
        }
        let is_part = self.of_type.is_some() || !plain(&self.folder).starts_with(&wanted);
        let is_empty = self.views.is_empty() && self.passed_over.is_empty() && self.budget.is_empty();
        if problems.is_empty() && is_part && is_empty {
            let message = "holds no images: they are BANDn/{BRF,Tapp,Radiance}/ITERn/IMAGES_DART/*.mpr of the simulation's `output`";
            problems.push(Problem::new(Location::file(path), message));
        }
        let bands = self.views.iter().flat_map(|view| &view.bands).chain(&self.budget);
        let mut read: Vec<PathBuf> = bands.map(|band| band.path.clone()).collect();
        if !self.budget.is_empty() {
            read.push(self.folder.join(budget::TRIANGLES));
        }
        self.passed_over.extend(others::passed_over(&base, &read, &is_wanted)?);
        if problems.is_empty() { Ok(()) } else { Err(Error::Invalid(problems)) }
    }

    fn band(&self, number: usize, problems: &mut Vec<Problem>) -> Option<Band> {
        match self.properties.band(number) {
            Ok(band) => return Some(band),
            Err(problem) if problems.contains(&problem) => {}
            Err(problem) => problems.push(problem),
        }
        None
    }

    /// Adds a band's image to its view, or passes it over.
    fn add(&mut self, name: &str, quantity: ImageQuantity, iteration: &str, band: OutputBand) -> Told<()> {
        if let Some(view) = self.views.iter_mut().find(|v| v.name == name && v.quantity == quantity) {
            view.bands.push(band);
            return Ok(());
        }
        let (prefix, angles) = name.split_once('_').unwrap_or((name, ""));
        let known = self.properties.image(prefix)?;
        let number = prefix.strip_prefix("ima").and_then(|n| n.parse().ok());
        let Some(number) = number.filter(|_| known.as_ref().is_none_or(|image| !image.is_sensor)) else {
            if !self.passed_over.iter().any(|other| other == name) {
                self.passed_over.push(name.to_owned());
            }
            return Ok(());
        };
        let (towards_deg, rounding_deg) = match known {
            Some(image) => (image.towards_deg, images::PROPERTY_ROUNDING_DEG),
            None => (images::angles_of_name(angles).ok_or_else(|| {
                let message = format!(
                    "from where it was seen is not known: {} has no imageNamePrefix:{prefix}, and no _VZ=..._VA=... is in the name",
                    self.properties.path.display()
                );
                Problem::new(Location::file(&band.path), message)
            })?, images::NAME_ROUNDING_DEG),
        };
        if !(0.0..90.0).contains(&towards_deg[0]) {
            let message = format!(
                "a view from a zenith angle of {} deg: parallel views are from above, below 90 deg",
                towards_deg[0]
            );
            return Err(Problem::new(Location::file(&band.path), message));
        }
        let (name, iteration) = (name.to_owned(), iteration.to_owned());
        self.views.push(OutputView { name, quantity, iteration, towards_deg, rounding_deg, number, bands: vec![band] });
        Ok(())
    }
}
