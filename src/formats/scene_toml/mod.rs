//! `scene.toml`: everything a simulation needs, or where it lies.
//!
//! Reading goes in three steps, and each reports all its problems: the text against the schema
//! ([`located`]); each part against itself and the files it names; the whole, by [`SceneParts::check`].

mod angles;
mod atlas;
mod attitude;
mod bodies;
pub(super) mod chain;
pub(super) mod chain_types;
mod flight;
mod instruments;
pub(super) mod format;
mod grain;
mod lamps;
mod lens;
mod material_map;
mod materials;
mod mesh;
mod rasters;
mod shapes;
mod template;
pub(super) mod types;
mod values;
mod view;
mod write;

use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::error::{Error, Location, Problem, Result, number};
use crate::flight::{Epoch, LeapSeconds, Span};
use crate::geometry::{Copies, Direction, Pose};
use crate::instrument::Chain;
use crate::physics::sun_disc::DiscRule;
use crate::progress::{Progress, Watch};
use crate::scene::{
    Exposure, FARTHEST_M, Fixed, Globe, MARS_ALBEDO, MARS_DAY_NIGHT_K, MarsModel, Models, Motion, Past, Readout,
    Rotation, STEPS_OF_A_DAY, Scene, SceneParts, Sky, Sun, SunModel, Surface, Texture, Thermal, Timing,
};
use crate::spectral::{Extend, Spectrum, SunTotal, solar_e490};
use crate::units::{AU_M, MARS_RADIUS_M, SUN_RADIUS_M, TSI_1AU_W_M2};

use super::dart::database::DATABASE;
use super::input;
use super::located::{self, Document};
use super::registry;
use super::setting;
use super::sli::SLI;
use super::spectra;
use super::spectrum_csv::{NOISE, Quantity};
use super::{Cache, InputFile, Reading};
pub(super) use atlas::Tiling;
pub(super) use lens::{Lens, Optics};
pub(super) use materials::EMISSIVITY_BOLOMETRIC;
pub(super) use template::{Changes, Template, Variant};
pub(super) use types::Coordinates;
pub(super) use view::SENSOR_NAME;
pub(super) use view::USUAL_UM;
pub(super) use view::pitch_of_fov;
pub(super) use view::pitch_of_ifov;
pub use write::{Axes, Unsaid, WriteOptions, path_of_camera, write, write_with};

use types::{Frame, MarsModelToml, MarsToml, ObserverToml, SceneToml, SunToml, ThermalModelToml, ThermalToml, Values};

/// Unit vectors and quaternions have length 1 to within this.
const UNIT_TOLERANCE: f64 = 1e-9;
/// What is farther off than this is not rounding: axes and quaternions of length 1, and shares that add up to 1.
const ROUNDED: f64 = 0.01;

/// A scene and what its report should say about where it came from.
#[derive(Debug, Clone)]
pub struct SceneFile {
    /// The scene, checked.
    pub scene: Scene,
    /// What the file left to this program, and what was taken.
    pub defaults: Vec<Stated>,
    /// What is worth knowing and no error.
    pub notes: Vec<String>,
    /// Every file that was read: the scene file first.
    pub inputs: Vec<InputFile>,
    /// How it moves, and when what of the image is taken; none of a scene that states places and no time.
    pub motion: Option<(Motion, Timing)>,
    /// What the instrument makes of the radiance before it; none: nothing.
    pub chain: Option<Chain>,
    /// Which facets are copies of one mesh: those of meshes with `instances`.
    pub copies: Vec<Copies>,
    /// What of the file was replaced, as it was said.
    pub settings: Vec<String>,
    /// What this version reads and cannot simulate: the first such key, and why.
    unsimulated: Option<(Location, String)>,
}

impl SceneFile {
    /// Whether this version can simulate the scene.
    ///
    /// # Errors
    /// [`Error::Unsupported`] at the key that asks for more, as [`Setup::simulable`](crate::scene::Setup::simulable).
    pub fn simulable(&self) -> Result<()> {
        match self.unsimulated.clone() {
            Some((at, feature)) => Err(Error::Unsupported { at, feature }),
            None => Ok(()),
        }
    }
}

/// A name for what these files hold, of which some items were replaced: the BLAKE3 hash of the files' hashes and of the replacements, 64 hexadecimal digits.
/// Reports and footprints carry it.
pub fn id(inputs: &[InputFile], settings: &[String]) -> String {
    let mut hasher = blake3::Hasher::new();
    inputs.iter().for_each(|input| _ = hasher.update(input.blake3.as_bytes()));
    for setting in settings {
        // None is the beginning of another one.
        hasher.update(&(setting.len() as u64).to_le_bytes());
        hasher.update(setting.as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

/// A value that the file does not state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stated {
    /// The item, as it would be named in the file.
    pub item: String,
    /// What was taken, and why.
    pub value: String,
}

impl std::fmt::Display for Stated {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} = {}", self.item, self.value)
    }
}

/// At most this many problems are reported with their lines.
const PLACED: usize = 1000;
/// Bond albedo of Mars, if none is given.
const MARS_BOND_ALBEDO: f64 = 0.25;
/// Thermal exitance of Mars, if none is given, W m-2.
const MARS_THERMAL_EXITANCE_W_M2: f64 = 110.0;

/// Reads a scene file, the files it names, and makes the meshes of its recipes.
///
/// # Errors
/// [`Error::Io`] if the scene file cannot be read; [`Error::Syntax`] at the first place that is not TOML;
/// [`Error::Invalid`] with all problems of the text, or of the values and the files named, or of the whole;
/// [`Error::Interrupted`] if `watch` asks to stop.
pub fn read(path: &Path, watch: Watch<'_>) -> Result<SceneFile> {
    read_with(path, &Reading::default(), watch)
}

/// The same, with items replaced, or from a cache.
///
/// # Errors
/// As [`read`]; [`Error::Invalid`] for what has no place in the text.
pub fn read_with(path: &Path, reading: &Reading, watch: Watch<'_>) -> Result<SceneFile> {
    Ok(read_for(path, reading, None, watch)?.0)
}

/// The same of a text that is in no file: `path` names it in messages and reports, and paths in it are relative to its folder.
///
/// # Errors
/// As [`read_with`].
pub fn read_text(text: String, path: &Path, reading: &Reading, watch: Watch<'_>) -> Result<SceneFile> {
    let input = InputFile::of(path, text.as_bytes());
    Ok(read_document((Document::parse(text, path)?, input), path, reading, None, watch)?.0)
}

/// As [`read_with`], and what the file says, for a scene that is looked at at other moments too.
fn read_for(
    path: &Path,
    reading: &Reading,
    moments: Option<Moments<'_>>,
    watch: Watch<'_>,
) -> Result<(SceneFile, SceneToml)> {
    read_document(Document::open(path)?, path, reading, moments, watch)
}

/// Reads what an opened file or a text says.
fn read_document(
    (document, input): (Document, InputFile),
    path: &Path,
    reading: &Reading,
    moments: Option<Moments<'_>>,
    watch: Watch<'_>,
) -> Result<(SceneFile, SceneToml)> {
    let document = setting::with(document, &reading.settings)?;
    let toml: SceneToml = document.read()?;
    let mut reader = TomlReader::new(path, document, DVec3::from_array(toml.origin_m), input, watch);
    reader.is_beside_scene = false;
    reader.moments = moments;
    reader.cache = reading.cache.as_ref();
    reader.tell("reading the scene", 0, 1);
    let scene = reader.scene(&toml);
    reader.tell("reading the scene", 1, 1);
    if reader.interrupted {
        return Err(Error::Interrupted);
    }
    reader.tell_link();
    let (Some(scene), true) = (scene, reader.problems.is_empty()) else {
        // No error is without a word.
        if reader.problems.is_empty() {
            reader.problem("", "cannot be used");
        }
        // Those of other files are in order already: a file at a time, and at its end how many more there are.
        let here = |p: &Problem| p.at.file.as_deref() == Some(path);
        reader.problems.sort_by_key(|p| (!here(p), p.at.span.filter(|_| here(p))));
        return Err(Error::Invalid(reader.problems));
    };
    let mut scene = scene.check().map_err(|e| reader.placed(e))?;
    if let Some((motion, timing)) = &reader.motion {
        scene = at_reference(&scene, &scene.exposure, motion, timing).map_err(|e| reader.placed(e))?;
    }
    if let Some(cache) = &reading.cache {
        cache.hang_together(&scene.body, watch)?;
    }
    let mesh = &scene.body.mesh;
    tracing::info!(vertices = mesh.vertices_m.len(), facets = mesh.facets.len(), "read {}", path.display());
    let unsimulated = match scene.simulable() {
        Err(Error::Unsupported { at, feature }) => Some((reader.document.at(&reader.item_of(&at)), feature)),
        _ => None,
    };
    let TomlReader { defaults, notes, inputs, motion, chain, copies, .. } = reader;
    let settings = reading.settings.iter().map(ToString::to_string).collect();
    Ok((SceneFile { scene, defaults, notes, inputs, motion, chain, copies, settings, unsimulated }, toml))
}

/// A moving scene at the reference exposure of an image.
fn at_reference(scene: &Scene, exposure: &Exposure, motion: &Motion, timing: &Timing) -> Result<Scene> {
    // What is not known at the end is better said now than then.
    let last = motion.start.after_s(timing.middle_s(timing.count(exposure).saturating_sub(1)));
    motion.pose(last)?;
    motion.sky(&scene.sky, last)?;
    let middle_s = timing.middle_s(timing.reference(exposure));
    motion.at(scene, exposure.clone(), motion.start.after_s(middle_s))
}

/// An error's problems, each with what to do about it, to be part of a sentence.
fn in_a_line(error: &Error) -> String {
    let Error::Invalid(problems) = error else { return error.to_string() };
    let of = |problem: &Problem| match &problem.help {
        Some(help) => format!("{} ({help})", problem.message),
        None => problem.message.clone(),
    };
    problems.iter().map(of).collect::<Vec<_>>().join("; ")
}

/// The JSON Schema of `scene.toml`.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(SceneToml)
}

/// The span of the moments at which a scene is looked at besides its own, which is given, by leap seconds that its files may have.
pub(super) type Moments<'a> = &'a dyn Fn(Epoch, &LeapSeconds) -> Span;

/// What the parts of a scene file are read with, and of other files that share them.
pub(super) struct TomlReader<'a> {
    folder: PathBuf,
    document: Document,
    origin_m: DVec3,
    problems: Vec<Problem>,
    defaults: Vec<Stated>,
    notes: Vec<String>,
    /// Whether it is not a scene file: its defaults are reported as notes.
    is_beside_scene: bool,
    inputs: Vec<InputFile>,
    motion: Option<(Motion, Timing)>,
    chain: Option<Chain>,
    copies: Vec<Copies>,
    /// Vertices of the surroundings of recipes' sites, ascending: of the mesh that is being made, and of all.
    beyond: Vec<u32>,
    around: Vec<u32>,
    /// What recipes cover their landscapes with.
    grains: Vec<grain::OfRecipe>,
    /// Where prepared bodies are kept.
    cache: Option<&'a Cache>,
    /// When else the scene is looked at, beside its own moment.
    moments: Option<Moments<'a>>,
    /// The item of another file that changes some of the scene, as `acquisitions[2]`: its keys are those of `flight`.
    entry: Option<String>,
    watch: Watch<'a>,
    /// The caller has asked to stop.
    interrupted: bool,
}

impl<'a> TomlReader<'a> {
    /// For another file that is about a scene with this origin.
    pub(super) fn new(path: &Path, document: Document, origin_m: DVec3, input: InputFile, watch: Watch<'a>) -> Self {
        TomlReader {
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            document,
            origin_m,
            problems: Vec::new(),
            defaults: Vec::new(),
            notes: Vec::new(),
            is_beside_scene: true,
            inputs: vec![input],
            motion: None,
            chain: None,
            copies: Vec::new(),
            beyond: Vec::new(),
            around: Vec::new(),
            grains: Vec::new(),
            cache: None,
            moments: None,
            entry: None,
            watch,
            interrupted: false,
        }
    }

    /// The place of an item of the scene, in the file that states it.
    fn place_of(&self, item: &str) -> Location {
        let Some(entry) = &self.entry else { return self.document.at(item) };
        match item.strip_prefix("flight").map(|key| key.trim_start_matches('.')).unwrap_or(item) {
            "" => self.document.at(entry),
            key => self.document.at(&format!("{entry}.{key}")),
        }
    }

    /// What was read and is worth knowing.
    ///
    /// # Errors
    /// [`Error::Invalid`] with all problems, in the order of the text; [`Error::Interrupted`].
    pub(super) fn finish(mut self) -> Result<(Vec<InputFile>, Vec<String>)> {
        if self.interrupted {
            return Err(Error::Interrupted);
        }
        self.tell_link();
        if self.problems.is_empty() {
            return Ok((self.inputs, self.notes));
        }
        self.problems.sort_by_key(|p| p.at.span);
        Err(Error::Invalid(self.problems))
    }

    /// Says that files were not found where the file stands, but where the link leads to that it is.
    fn tell_link(&mut self) {
        let file = self.inputs[0].path.clone();
        if file.is_symlink() && self.inputs[1..].iter().any(|input| !input.path.starts_with(&self.folder)) {
            let real = file.canonicalize().ok().and_then(|real| Some(real.parent()?.display().to_string()));
            let message = format!(
                "{} is a link: files that are not next to it are taken from next to its target, in {}",
                file.display(),
                real.unwrap_or_default()
            );
            self.notes.push(message);
        }
    }

    pub(super) fn origin_m(&self) -> DVec3 {
        self.origin_m
    }
}

impl TomlReader<'_> {
    fn scene(&mut self, toml: &SceneToml) -> Option<SceneParts> {
        let mut dictionary = self.dictionary(&toml.materials);
        let inertia = toml.thermal.as_ref().and_then(|thermal| thermal.inertia).unwrap_or(0.0);
        for (name, material) in dictionary.names.iter().zip(dictionary.materials.iter_mut().flatten()) {
            let own = toml.materials.get(name).and_then(|entry| entry.thermal_inertia);
            material.thermal_inertia = own.unwrap_or(inertia);
            let is_off = toml.thermal.as_ref().and_then(|thermal| thermal.model) == Some(ThermalModelToml::Off);
            if material.temperature_k.is_some() && is_off {
                let item = located::member(&located::member("materials", name), "temperature_k");
                self.note(&item, "counts for nothing: `thermal.model` is \"off\"");
            }
        }
        let mesh = self.meshes(&toml.mesh, &mut dictionary);
        let by_angles = toml.geometry.as_ref().map(|geometry| self.by_angles(geometry)).unwrap_or_default();
        let timing = self.timing(&toml.sensor, toml.flight.is_some());
        let flies = toml.flight.as_ref().map(|flight| {
            let motion = self.motion(flight)?;
            let placed = self.placed_by(&motion, timing?, toml.mars.is_some())?;
            Some((motion, placed))
        });
        let placed = flies.as_ref().map(|known| known.as_ref().map(|(_, placed)| placed));
        let sun = match placed {
            Some(placed) => self.sun_placed(&toml.sun, placed).and_then(|toml| self.sun(&toml, by_angles.sun)),
            None => self.sun(&toml.sun, by_angles.sun),
        };
        let mars = toml.mars.as_ref().map(|mars| self.mars(mars, placed.map(|placed| placed?.mars_m)));
        let mars_light = toml.mars.as_ref().map(|mars| self.mars_light(mars)).unwrap_or_default();
        let thermal = self.thermal(toml.thermal.as_ref());
        let stores_heat = dictionary.materials.iter().flatten().any(|material| material.thermal_inertia > 0.0);
        let flown = flies.as_ref().and_then(|known| known.as_ref().map(|(motion, _)| motion));
        let (rotation, conduction) = self.day(toml.thermal.as_ref(), stores_heat, flown);
        let beams = self.lamps(&toml.lamps);
        let sun_model = self.sun_model(&toml.sun);
        let bodies = self.bodies(&toml.bodies, flies.as_ref().map(|known| known.as_ref().map(|(motion, _)| motion)));
        let eclipses = self.eclipses(toml);
        let mars_heat = toml.mars.as_ref().and_then(|mars| mars.heat);
        let mars_shadows = self.rule("mars.points", toml.mars.as_ref().and_then(|mars| mars.points));
        let by_flight = placed.map(|placed| placed.map(|placed| placed.pose));
        let pose = self.camera_pose(toml.observer.as_ref(), by_angles.camera, by_flight);
        let is_slit = timing.is_some_and(|timing| timing.readout == Readout::Line);
        let exposure = self.exposure(&toml.sensor, pose, is_slit, mesh.as_ref());
        if let (Some(mesh), Some(exposure)) = (&mesh, &exposure) {
            self.suspect_scale(&toml.mesh, mesh, &exposure.camera);
        }
        let textures = self.textures(toml, &dictionary.names, mesh.as_ref());
        self.chain = self.sensor_chain(&toml.sensor, timing);
        self.motion = flies.flatten().map(|(motion, _)| motion).zip(timing);
        let mut sky = Sky {
            sun: sun?,
            mars: match mars {
                Some(mars) => Some(mars?),
                None => None,
            },
            bodies,
            beams,
            rotation,
            past: None,
        };
        if let (Some(motion), Some(_), true) = (&self.motion, rotation, stores_heat) {
            sky.past = Some(Past::new(&motion.0, motion.0.start));
            if let Err(error) = sky.reaches_back(conduction.unwrap_or(STEPS_OF_A_DAY)) {
                let message = format!(
                    "the day before the scene is not known, so the Sun goes round steadily, and bodies of the sky stay where they are: {}",
                    in_a_line(&error)
                );
                self.note("thermal", message);
                sky.past = None;
            }
        }
        Some(SceneParts {
            surface: Surface { origin_m: self.origin_m, mesh: mesh?, materials: dictionary.materials?, textures },
            sky,
            exposure: exposure?,
            models: Models {
                thermal,
                mars_light,
                sun: sun_model,
                eclipses: eclipses.unwrap_or(false),
                mars_shadows,
                mars_heat: mars_heat.unwrap_or(false),
                conduction,
                exchange: None,
                floor_k: toml.thermal.as_ref().and_then(|thermal| thermal.floor_k).unwrap_or(0.0),
                fixed: Fixed {
                    thermal: toml.thermal.as_ref().is_some_and(|thermal| thermal.model.is_some()),
                    mars_light: toml.mars.as_ref().is_some_and(|mars| mars.model.is_some()),
                    sun: toml.sun.points.is_some(),
                    eclipses: eclipses.is_some(),
                    mars_shadows: mars_shadows.is_some(),
                    mars_heat: mars_heat.is_some(),
                },
                ..Models::default()
            },
        })
    }

    /// The textures of materials, in the order of the dictionary; those that cannot be used are problems.
    fn textures(&mut self, toml: &SceneToml, names: &[String], mesh: Option<&crate::geometry::Mesh>) -> Vec<Texture> {
        let Some(mesh) = mesh else { return vec![] };
        let texture = |(id, name): (usize, &String)| {
            let toml = toml.materials.get(name)?.texture.as_ref()?;
            self.texture(name, id, toml, mesh)
        };
        let mut textures = names.iter().enumerate().filter_map(texture).collect();
        self.add_grains(names, mesh, &mut textures);
        textures
    }

    pub(super) fn problem(&mut self, item: &str, message: impl Into<String>) -> &mut Problem {
        // Finding a line means counting from the beginning of the text: beyond this many problems only the item is reported.
        let at = match self.problems.len() {
            0..PLACED => self.place_of(item),
            _ => Location::file(&self.inputs[0].path).with_item(item),
        };
        self.problems.push(Problem::new(at, message));
        self.problems.last_mut().expect("one was pushed")
    }

    /// Reports a problem if none has been.
    pub(super) fn unless_told(&mut self, item: &str, message: &str) {
        if self.problems.is_empty() {
            self.problem(item, message);
        }
    }

    pub(super) fn helped(&mut self, item: &str, message: impl Into<String>, help: impl Into<String>) {
        self.problem(item, message).help = Some(help.into());
    }

    /// Something that is worth knowing.
    pub(super) fn note(&mut self, item: &str, message: impl std::fmt::Display) {
        self.notes.push(format!("{item}: {message}"));
    }

    /// What was taken of a raster that no text states.
    fn taken_of_raster(&mut self, item: &str, value: impl std::fmt::Display) {
        match self.is_beside_scene {
            true => self.note(item, value),
            false => self.stated(item, value.to_string()),
        }
    }

    fn stated(&mut self, item: &str, value: impl Into<String>) {
        self.defaults.push(Stated { item: item.to_owned(), value: value.into() });
    }

    /// A number that the file does not give.
    fn default(&mut self, item: &str, value: f64) -> f64 {
        self.stated(item, value.to_string());
        value
    }

    fn tell(&mut self, stage: &'static str, done: u64, total: u64) {
        self.interrupted |= !(self.watch)(Progress { stage, done, total });
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        let near = self.folder.join(name);
        // As a path is written, not as it is found, so long as that is the same.
        let file = &self.inputs[0].path;
        if near.exists() || !file.is_symlink() { near } else { input::home(file, Path::new(name)).join(name) }
    }

    /// A value, or the problems of the file that was to give it. A file that cannot be read is a problem of the item that names it.
    pub(super) fn taken<T>(&mut self, item: &str, outcome: Result<T>) -> Option<T> {
        match outcome {
            Ok(value) => return Some(value),
            Err(Error::Invalid(problems)) => self.problems.extend(problems),
            Err(Error::Syntax { at, message }) => self.problems.push(Problem::new(at, message)),
            Err(Error::Interrupted) => self.interrupted = true,
            Err(error) => {
                self.problem(item, error.to_string());
            }
        }
        None
    }

    fn spectrum_file(&mut self, item: &str, name: &str, quantity: Quantity, extend: Extend) -> Option<Spectrum> {
        let path = self.path(name);
        if let Some(many) = registry::of_spectra(&path).filter(|format| [&SLI, &DATABASE].contains(format)) {
            let what = if *many == SLI { "a spectral library" } else { "a database of spectra" };
            let help = format!(
                "take a spectrum out of it: mmxrt convert {name} one.csv --model NAME; --list {name} has the names"
            );
            self.helped(item, format!("{name} is {what}"), help);
            return None;
        }
        let read = spectra::read_one(&path, quantity, extend);
        let (spectrum, input, report) = self.taken(item, read)?;
        self.notes.extend(report.notes.iter().map(|note| format!("{item}: {}: {}", note.at, note.message)));
        if !self.inputs.contains(&input) {
            self.inputs.push(input);
        }
        Some(spectrum)
    }

    /// A share of something: a number or a table, 0 to 1.
    fn fraction_spectrum(
        &mut self,
        item: &str,
        values: &Values,
        quantity: Quantity,
        extend: Extend,
    ) -> Option<Spectrum> {
        match values {
            Values::Constant(value) => self.fraction(item, *value).map(Spectrum::constant),
            Values::File(name) => self.spectrum_file(item, name, quantity, extend),
        }
    }

    fn fraction(&mut self, item: &str, value: f64) -> Option<f64> {
        match value {
            0.0..=1.0 => return Some(value),
            _ if (-NOISE..=1.0 + NOISE).contains(&value) => {
                let taken = value.clamp(0.0, 1.0);
                self.note(item, format!("{} is outside 0 to 1: taken as {taken}", number(value)));
                return Some(taken);
            }
            1.0..=100.0 => {
                let help = format!("if this is percent, write {}", value / 100.0);
                self.helped(item, format!("{} is outside 0 to 1", number(value)), help);
            }
            _ => {
                self.problem(item, format!("{} is outside 0 to 1", number(value)));
            }
        }
        None
    }

    fn positive(&mut self, item: &str, value: f64) -> Option<f64> {
        if value > 0.0 {
            return Some(value);
        }
        self.problem(item, format!("{} is not positive", number(value)));
        None
    }

    /// The camera's pose, from the one of two tables that states it.
    fn camera_pose(
        &mut self,
        observer: Option<&ObserverToml>,
        by_angles: Option<Option<Pose>>,
        by_flight: Option<Option<Pose>>,
    ) -> Option<Pose> {
        match (observer, by_angles, by_flight) {
            (Some(observer), None, None) => self.observer(observer),
            (None, Some(pose), None) | (None, None, Some(pose)) => pose,
            (None, None, None) => {
                let help = "or place the camera by angles (`emission_deg` and more in `[geometry]`), or by `[flight]`";
                self.helped("observer", "is missing: where the camera is, and where it looks", help);
                None
            }
            (_, Some(_), Some(_)) => {
                self.problem("geometry", "`flight` places the camera too: leave one of them out");
                None
            }
            (Some(_), Some(_), None) => {
                self.problem("observer", "`geometry.emission_deg` places the camera too: leave one of them out");
                None
            }
            (Some(_), None, Some(_)) => {
                self.problem("observer", "`flight` places the camera too: leave one of them out");
                None
            }
        }
    }

    /// The Sun, in a direction that may be given by angles.
    fn sun(&mut self, toml: &SunToml, by_angles: Option<Option<Direction>>) -> Option<Sun> {
        let body_from_site = match toml.frame {
            Some(Frame::Site) => Some(self.body_from_site("sun.frame", "the frame of a site")?),
            _ => None,
        };
        // How far a lamp in the Sun's stead is does not matter.
        let of_lamp = toml.irradiance.as_ref().filter(|_| toml.position_m.is_none()).map(|_| 1.0);
        // A direction, if there is one, and a distance, m.
        let place = match (toml.position_m, toml.direction, toml.distance_au.or(of_lamp)) {
            (None, None, Some(distance_au)) if by_angles.is_some() => {
                by_angles.flatten().map(|d| (Some(d), distance_au * AU_M))
            }
            (None, None, None) if by_angles.is_some() => {
                self.problem("sun", "`distance_au` is missing: `geometry` says only where the Sun stands");
                None
            }
            _ if by_angles.is_some() => {
                self.problem("sun", "`geometry.incidence_deg` places the Sun: give only `distance_au` beside it");
                None
            }
            (Some(position_m), None, None) => {
                let v = match body_from_site {
                    Some(axes) => axes * DVec3::from_array(position_m),
                    None => DVec3::from_array(position_m) - self.origin_m,
                };
                Some((Direction::new(v), v.length()))
            }
            (None, Some(direction), Some(distance_au)) => {
                // A unit vector is taken as it stands: to divide it by its length once more would move its last digit.
                let direction = DVec3::from_array(direction);
                let direction = body_from_site.map_or(direction, |axes| axes * direction);
                let direction = Direction::from_unit(direction).or_else(|| Direction::new(direction));
                if direction.is_none() {
                    self.problem("sun.direction", "has no length");
                }
                direction.map(|d| (Some(d), distance_au * AU_M))
            }
            _ => {
                let message =
                    "give `position_m`, or `direction` and `distance_au`, or `distance_au` and angles in `[geometry]`";
                self.problem("sun", message);
                None
            }
        };
        let item = if toml.position_m.is_some() { "sun.position_m" } else { "sun.distance_au" };
        let place = place.and_then(|(direction, distance_m)| {
            // As it is given: a distance may be negative.
            let au = toml.distance_au.unwrap_or(distance_m / AU_M);
            let shown = if (0.001..1e5).contains(&au.abs()) { format!("{au:.4}") } else { number(au) };
            let message = format!("the Sun is {shown} au from the origin");
            let metres = toml.distance_au.is_none();
            let help = match (metres, au) {
                (true, ..0.3) => {
                    "positions are in metres, and whole: kilometres, or a position divided by a factor, change the light"
                }
                (true, 40.0..) => "positions are in metres: 1 au is 149597870700 m",
                (false, 40.0..) => "the distance is in au: 1 au is 149597870700 m",
                _ => "Phobos is 1.38 to 1.67 au from the Sun",
            };
            // Nothing is inside the Sun, nor as far as nothing of a scene may be.
            if !(SUN_RADIUS_M..=FARTHEST_M).contains(&(au * AU_M)) {
                let why = match au {
                    ..=0.0 => "distances are positive",
                    _ if au * AU_M < SUN_RADIUS_M => "that is inside the Sun",
                    _ => "that is more than 1e18 m",
                };
                self.helped(item, format!("{message}: {why}"), help);
                return None;
            }
            if !(0.1..=1e5).contains(&au) {
                self.notes.push(format!("{item}: {message}; {help}"));
            } else if !(0.3..=40.0).contains(&au) {
                self.notes.push(format!("{item}: {message}"));
            }
            Some((direction?, distance_m))
        });
        let (spectrum, total) = match &toml.irradiance {
            None => self.sun_spectrum(toml)?,
            Some(_) if toml.spectrum.is_some() => {
                self.problem("sun.spectrum", "`irradiance` says how bright the Sun is: leave one of them out");
                return None;
            }
            Some(values) => {
                let (at_scene, total) = self.stated_irradiance("sun", values, toml.total_irradiance_w_m2)?;
                let at_1_au = (place?.1 / AU_M).powi(2);
                (at_scene.map(|v| v * at_1_au), total * at_1_au)
            }
        };
        let (direction, distance_m) = place?;
        let limb_darkening = toml.limb_darkening.unwrap_or(0.0);
        Some(Sun { direction, distance_m, irradiance_1au: spectrum, total_irradiance_1au_w_m2: total, limb_darkening })
    }

    fn sun_model(&mut self, toml: &SunToml) -> SunModel {
        match self.rule("sun.points", toml.points) {
            None | Some(DiscRule::G1) => SunModel::Point,
            Some(rule) => SunModel::Disc(rule),
        }
    }

    /// Whether bodies of the sky hide the Sun, if the file says so: one choice for all of them.
    fn eclipses(&mut self, toml: &SceneToml) -> Option<bool> {
        let of_mars = toml.mars.iter().map(|mars| ("mars.eclipse".to_owned(), mars.eclipse));
        let of_bodies = toml.bodies.iter().enumerate().map(|(i, body)| (format!("bodies[{i}].eclipse"), body.eclipse));
        let mut said = of_mars.chain(of_bodies).filter_map(|(item, hides)| Some((item, hides?)));
        let (first, hides) = said.next()?;
        if let Some((other, _)) = said.find(|(_, other)| *other != hides) {
            let message = format!("{} here, but {first} = {hides}: it is one choice for all bodies of the sky", !hides);
            self.helped(&other, message, "state it once");
        }
        Some(hides)
    }

    /// The points that stand for a disc; `None` if the file does not say how many.
    fn rule(&mut self, item: &str, points: Option<u32>) -> Option<DiscRule> {
        let points = points?;
        let rule = DiscRule::of_count(points as usize);
        if rule.is_none() {
            let counts: Vec<String> = DiscRule::ALL.iter().map(|rule| rule.count().to_string()).collect();
            self.problem(item, format!("{points} is not one of {}", counts.join(", ")));
        }
        rule
    }

    /// The spectrum at 1 au and its total, W m-2.
    fn sun_spectrum(&mut self, toml: &SunToml) -> Option<(Spectrum, f64)> {
        let e490 = solar_e490();
        let spectrum = match toml.spectrum.as_deref() {
            Some("e490") => e490.clone(),
            Some(name) => self.spectrum_file("sun.spectrum", name, Quantity::Irradiance, Extend::Error)?,
            None => {
                self.stated("sun.spectrum", "ASTM E490-00a, built in");
                e490.clone()
            }
        };
        let SunTotal { table_w_m2, beyond_w_m2, times_e490 } = SunTotal::of(&spectrum);
        let total = table_w_m2 + beyond_w_m2;
        let is_e490 = spectrum == *e490;
        let shown = |w_m2: f64| if w_m2 >= 0.1 { format!("{w_m2:.2}") } else { number(w_m2) };
        let mut parts = match times_e490 {
            _ if is_e490 => "the spectrum as it is, not scaled".to_owned(),
            Some(times) if SunTotal::is_the_suns(times) => format!(
                "{} W m-2 in the table + {} of E490 beyond its ends, scaled by {times:.4} so as to join it",
                shown(table_w_m2),
                shown(beyond_w_m2)
            ),
            _ => format!(
                "{} W m-2 in the table, which is not that of the Sun: nothing is added beyond its ends",
                shown(table_w_m2)
            ),
        };
        if let Some(times) = times_e490.filter(|times| !SunTotal::is_the_suns(*times)) {
            let message = format!(
                "the table has {} times the irradiance of the Sun (E490) at the same wavelengths",
                number(times)
            );
            // A unit that is not the header's is wrong by 10 or more; less may be another star, or somebody's choice.
            let doubt = match times {
                0.1..=10.0 => "",
                _ => ": another star, or none; else check that it is at 1 au, in the unit that its header states",
            };
            let message = message + doubt;
            self.notes.push(format!("sun.spectrum: {message}"));
        }
        let Some(wanted) = toml.total_irradiance_w_m2 else {
            if total <= 0.0 {
                parts.push_str("; the Sun warms nothing");
            }
            self.stated("sun.total_irradiance_w_m2", format!("{}: {parts}", shown(total)));
            return Some((spectrum, total));
        };
        let message = format!("{wanted} W m-2 is not the Sun at 1 au, where it is {TSI_1AU_W_M2}");
        let help = "the distance is taken into account afterwards";
        if !(wanted >= 0.0 && (wanted / total).is_finite()) {
            let why = if wanted < 0.0 { "it is negative" } else { "the spectrum cannot be scaled to it" };
            self.helped("sun.total_irradiance_w_m2", format!("{message}: {why}"), help);
            return None;
        }
        if !(1000.0..=2000.0).contains(&wanted) {
            self.notes.push(format!("sun.total_irradiance_w_m2: {message}; {help}"));
        }
        let by = wanted / total;
        let parts = if is_e490 { String::new() } else { format!(": {} W m-2, {parts}", shown(total)) };
        self.notes.push(format!("sun.total_irradiance_w_m2: the spectrum is scaled by {by:.6}{parts}"));
        Some((spectrum.map(|v| v * (wanted / total)), wanted))
    }

    /// Mars, at a position that flight dynamics may give, if it could be used.
    fn mars(&mut self, toml: &MarsToml, placed: Option<Option<DVec3>>) -> Option<Globe> {
        let radius_m = match toml.radius_m {
            Some(r) => {
                if r > 0.0 && r < 1e5 {
                    let message =
                        format!("mars.radius_m: Mars with a radius of {r} m; if this is km, write 1000 times as much");
                    self.notes.push(message);
                }
                self.positive("mars.radius_m", r)
            }
            None => Some(self.default("mars.radius_m", MARS_RADIUS_M)),
        };
        let reflectance = match &toml.albedo {
            Some(values) => self.fraction_spectrum("mars.albedo", values, Quantity::Albedo, Extend::Error),
            None => {
                self.stated("mars.albedo", format!("{MARS_ALBEDO} at all wavelengths"));
                Some(Spectrum::constant(MARS_ALBEDO))
            }
        };
        let bond_albedo = match toml.bond_albedo {
            Some(value) => self.fraction("mars.bond_albedo", value),
            None => Some(self.default("mars.bond_albedo", MARS_BOND_ALBEDO)),
        };
        let thermal_exitance_w_m2 = match toml.thermal_exitance_w_m2 {
            Some(value) if value >= 0.0 && value.is_finite() => {
                if value > 1000.0 {
                    self.notes.push(format!("mars.thermal_exitance_w_m2: {value} W m-2, more than noon on Mars has"));
                }
                Some(value)
            }
            Some(value) => {
                self.problem("mars.thermal_exitance_w_m2", format!("{value} W m-2 is negative"));
                None
            }
            None => Some(self.default("mars.thermal_exitance_w_m2", MARS_THERMAL_EXITANCE_W_M2)),
        };
        let centre_m = self.place("mars", toml.position_m, placed)? - self.origin_m;
        if centre_m.length() <= radius_m? {
            let message = format!("the origin is {:.0} m from the centre of Mars, inside it", centre_m.length());
            self.helped("mars.position_m", message, "positions are in metres: is this in km?");
            return None;
        }
        Some(Globe {
            name: Sky::MARS.into(),
            centre_m,
            radius_m: radius_m?,
            reflectance: reflectance?,
            bond_albedo: bond_albedo?,
            thermal_exitance_w_m2: thermal_exitance_w_m2?,
            day_night_k: [toml.day_k.unwrap_or(MARS_DAY_NIGHT_K[0]), toml.night_k.unwrap_or(MARS_DAY_NIGHT_K[1])],
        })
    }

    /// Where a body of the sky is, from the body's centre, m: as the scene says, or as flight dynamics does, if it could be used.
    fn place(&mut self, item: &str, stated_m: Option<[f64; 3]>, placed: Option<Option<DVec3>>) -> Option<DVec3> {
        match (stated_m, placed) {
            (Some(stated_m), None) => Some(DVec3::from_array(stated_m)),
            (None, Some(placed_m)) => placed_m,
            (None, None) => {
                self.problem(item, "`position_m` is missing");
                None
            }
            (Some(_), Some(_)) => {
                self.problem(&format!("{item}.position_m"), "`flight` places this body too: leave one of them out");
                None
            }
        }
    }

    fn mars_light(&mut self, toml: &MarsToml) -> MarsModel {
        match toml.model {
            Some(MarsModelToml::Thesis) => MarsModel::Thesis,
            Some(MarsModelToml::NearField) => MarsModel::NearField,
            Some(MarsModelToml::Off) => MarsModel::Off,
            None => {
                self.stated("mars.model", "near_field");
                MarsModel::NearField
            }
        }
    }

    /// How the body turns, and in how many steps of a day heat is conducted, if the scene says that it is, or flight dynamics knows.
    fn day(
        &mut self,
        toml: Option<&ThermalToml>,
        stores_heat: bool,
        flown: Option<&Motion>,
    ) -> (Option<Rotation>, Option<u32>) {
        let nothing = ThermalToml::default();
        let toml = toml.unwrap_or(&nothing);
        let conducts = toml.model == Some(ThermalModelToml::Conduction);
        let axis = toml.axis.map(|axis| Direction::new(DVec3::from_array(axis)));
        if axis == Some(None) {
            self.problem("thermal.axis", "has no length");
        }
        let is_needed = toml.period_s.is_none() && (stores_heat || conducts);
        let flown = flown.filter(|_| is_needed).map(|motion| motion.day(motion.start));
        let unknown = match &flown {
            Some(Err(error)) => format!("; {}", in_a_line(error)),
            Some(Ok(None)) => "; its frame does not turn".to_owned(),
            _ => String::new(),
        };
        let flown = flown.and_then(Result::ok).flatten();
        if let Some(Rotation { period_s, .. }) = flown {
            self.stated("thermal.period_s", format!("{period_s:.2}: from noon to noon, as `flight` has it"));
        } else if toml.period_s.is_none() {
            let needing = [
                ("axis", toml.axis.is_some()),
                ("inertia", toml.inertia.is_some_and(|inertia| inertia > 0.0)),
                ("steps", toml.steps.is_some()),
            ];
            for (key, _) in needing.into_iter().filter(|(_, is_given)| *is_given) {
                let message = format!("counts for nothing without `period_s`, the length of a day{unknown}");
                self.note(&format!("thermal.{key}"), message);
            }
            if conducts {
                self.helped(
                    "thermal.model",
                    format!("heat is conducted over a day, and nothing says how long that is{unknown}"),
                    "give `period_s`: 27553.84 on Phobos",
                );
            }
        }
        if conducts && !stores_heat {
            let message = "heat is conducted, but no material stores any: it is \"equilibrium\" until `thermal.inertia`, or `thermal_inertia` of \
                           materials, says how much";
            self.note("thermal.model", message);
        }
        if let Some(model) = toml.model.filter(|_| toml.steps.is_some() && !conducts) {
            self.note("thermal.steps", format!("counts for nothing: `model` is {model:?}").to_lowercase());
        }
        let stated = toml.period_s.map(|period_s| Rotation { axis: Direction::Z, period_s });
        let rotation = match axis {
            None => stated.or(flown),
            Some(axis) => axis.and_then(|axis| Some(Rotation { axis, ..stated.or(flown)? })),
        };
        // Without a word about the model the steps are those of a plan that conducts.
        let steps = match toml.model {
            Some(ThermalModelToml::Conduction) => Some(toml.steps.unwrap_or(STEPS_OF_A_DAY)),
            None => toml.steps,
            Some(_) => None,
        };
        (rotation, steps.filter(|_| rotation.is_some() && stores_heat))
    }

    fn thermal(&mut self, toml: Option<&ThermalToml>) -> Thermal {
        match toml.and_then(|t| t.model) {
            Some(ThermalModelToml::Equilibrium | ThermalModelToml::Conduction) => Thermal::Equilibrium,
            Some(ThermalModelToml::Thesis) => Thermal::Thesis,
            Some(ThermalModelToml::Off) => Thermal::Off,
            None => {
                self.stated("thermal.model", "equilibrium");
                Thermal::Equilibrium
            }
        }
    }

    /// What was doubtful of the unit of an item's table.
    pub(super) fn doubt(&self, item: &str) -> Option<String> {
        let doubt = |note: &String| Some(note.strip_prefix(item)?.strip_prefix(": ")?.to_owned());
        self.notes.iter().filter_map(doubt).find(|doubt| doubt.contains("look like"))
    }

    /// An item of the scene as the text names it: the scene quotes all names of materials, a text only those that need it.
    fn item_of(&self, at: &Location) -> String {
        let item = at.item.clone().unwrap_or_default();
        let of_material = self.document.keys("materials").into_iter().find_map(|name| {
            let key = item.strip_prefix(&format!("materials.{name:?}"))?;
            Some(located::member("materials", &name) + key)
        });
        of_material.unwrap_or(item)
    }

    /// What [`SceneParts::check`] found, with the places of the items it names.
    fn placed(&self, error: Error) -> Error {
        let Error::Invalid(problems) = error else { return error };
        let placed = problems.into_iter().map(|problem| {
            let item = self.item_of(&problem.at);
            let derived = item.starts_with("materials.") && !self.document.has(&item);
            // A table that does not reach the bands may be in another unit.
            let help = problem.help.clone().or_else(|| self.doubt(&item));
            (derived, Problem { at: self.document.at(&item), help, ..problem })
        });
        // Problems that follow from a material's reflectance (its emissivity, mixtures of it) need not be reported as well.
        let (derived, own): (Vec<_>, Vec<_>) = placed.partition(|(derived, _)| *derived);
        let told = if own.is_empty() { derived } else { own };
        Error::Invalid(told.into_iter().map(|(_, problem)| problem).collect())
    }
}
