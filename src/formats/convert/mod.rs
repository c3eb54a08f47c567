//! From one format to another, with a report of all that is not carried over as it was.
//!
//! What is read is one of five things: a scene; a surface, which is a mesh with names of materials; a list of spectra; an image, which
//! becomes nothing but an image; or trajectories and orientations, which become nothing else either. A
//! surface becomes a scene by assuming what it does not state; a scene becomes a surface, or spectra, by leaving out the
//! rest; the report says either. Spectra make no scene.

mod compare;
mod dart;
mod repairs;

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::error::{Error, Location, Problem, Result};
use crate::flight::LeapSeconds;
use crate::geometry::{Copies, FrameCamera};
use crate::progress::{Watch, tell};
use crate::report::{Fate, Report};
use crate::scene::{Motion, Photometry, Scene, Timing};
use crate::spectral::{Band, Column, Extend, SpectralLibrary, Spectrum};

use super::blend::{BLEND, Exported, How};
use super::coloured_mesh;
use super::dart::Step;
use super::dart::database::DATABASE;
use super::dart::format::SIMULATION;
use super::envi::{self, DataType};
use super::file_name::shortened;
use super::flight_file::FlightFile;
use super::folder::{FolderKind, Staged, spares};
use super::format::{Format, Holds, ending};
use super::gltf::format::BINARY;
use super::input::InputFile;
use super::mesh_file::{ColouredMesh, NamedPose, Up};
use super::obj::format::OBJ;
use super::raster::headers::ENVI;
use super::raster::text::GRID;
use super::raster::{self, Raster};
use super::scene_toml::format::SCENE as SCENE_FORMAT;
use super::scene_toml::{Axes, Unsaid, WriteOptions};
use super::spectrum_csv::CSV;
use super::{gltf, mtl, obj, registry, scene_toml, spectra, spectrum_csv};

pub use super::coloured_mesh::Placing;
pub use super::dart::{Finding, Severity};
pub use compare::differences;
pub use dart::check;
pub use repairs::Repairs;

use self::dart::Flights;

/// What a conversion leaves to its caller.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// The input's format, if it is not to be recognised.
    pub from: Option<&'static Format>,
    /// The output's format, instead of what its name says.
    pub to: Option<&'static Format>,
    /// Version of DART to write for, as in "5.7.4", which is taken if none is given.
    pub dart_version: Option<String>,
    /// Size of DART's cells, m; what a pixel of the camera sees if none is given.
    pub cell_m: Option<f64>,
    /// A folder of DART databases and other files that a simulation may name, besides its own.
    pub dart_databases: Option<PathBuf>,
    /// Where the middle of a DART scene, or the origin of a mesh, is, body-fixed, m; where the input says if it is not given.
    pub origin_m: Option<DVec3>,
    /// Unit of length of a mesh, m; the format's own, or metres, if not given.
    pub unit_m: Option<f64>,
    /// The axis of a mesh that points up; the format's own, or z, if not given.
    pub up: Option<Up>,
    /// How a mesh stands on the body; with the body's axes if not given.
    pub pose: Option<NamedPose>,
    /// Whether the facets of a mesh are turned over.
    pub flip: bool,
    /// What is mended in a mesh.
    pub repairs: Repairs,
    /// Copies of a repeated DART scene that are taken on each side.
    pub repeat: u32,
    /// The program that reads files of Blender; `blender` if not given.
    pub blender: Option<PathBuf>,
    /// Where folders for a while may be made; beside the input if not given.
    pub scratch: Option<PathBuf>,
    /// Zenith angle and azimuth of the Sun in DART's frame, deg, for simulations that give a date.
    pub sun_deg: Option<[f64; 2]>,
    /// Files that an input names may lie outside its folder.
    pub allow_outside: bool,
    /// What is there may be replaced.
    pub replace: bool,
    /// Spectra are added to the database that is there.
    pub append: bool,
    /// Write nothing if anything is lost.
    pub strict: bool,
    /// Of spectra only those of these names; all if there are none.
    pub models: Vec<String>,
    /// The wavelengths of a text that holds values alone, as libraries of the US Geological Survey do.
    pub wavelengths: Option<PathBuf>,
    /// Bands that spectra are resampled to; as they are if there are none.
    pub bands: Vec<Band>,
    /// Of an image only these bands, from 0; all if there are none.
    pub image_bands: Vec<usize>,
    /// Time between rows of trajectories and orientations, s; the rows that are there if not given.
    pub step_s: Option<f64>,
    /// Type of an image's numbers in ENVI and NumPy; the image's own if not given.
    pub data_type: Option<DataType>,
}

/// What came of a conversion.
#[derive(Debug, Clone)]
pub struct Conversion {
    /// What the input was.
    pub from: &'static Format,
    /// What the output is.
    pub to: &'static Format,
    /// What was not carried over as it was.
    pub report: Report,
    /// Whether the output was written: not where [`Options::strict`] forbids a loss.
    pub written: bool,
    /// What was converted, in a word or two: "20000 facets".
    pub size: String,
}

/// What a file holds.
#[derive(Debug, Clone)]
pub enum Content {
    /// A scene, and what flies over it.
    Scene(Box<Scene>, Flights),
    /// A scene that moves, at the moment of its middle exposure.
    Moving(Box<(Scene, Motion, Timing)>),
    /// A mesh and its materials' names.
    Mesh(ColouredMesh),
    /// Spectra.
    Spectra(Vec<SpectralLibrary>),
    /// An image.
    Raster(Box<Raster>),
    /// Trajectories and orientations.
    Flight(Box<FlightFile>),
}

/// The folder of a scene.
const SCENE: FolderKind = FolderKind { marks: &["scene.toml"], parts: &["scene."], holds: None };

/// Reads `input` and writes `output`.
///
/// # Errors
/// Those of the readers and writers; [`Error::Unsupported`] if one format does not hold what the other needs.
pub fn convert(input: &Path, output: &Path, options: &Options, watch: Watch<'_>) -> Result<Conversion> {
    let to = match options.to {
        Some(to) => to,
        None => registry::of_output(output)?,
    };
    let (from, _) = format_of(input, options)?;
    without_effect(options, from, to)?;
    if let Some(error) = impossible(input, from, output, to) {
        return Err(error);
    }
    if *from == BLEND && *to == SCENE_FORMAT {
        return of_blender(input, output, options, watch);
    }
    let Contents { content, copies, cameras, mut report, sources, .. } = read_all(input, options, watch)?;
    if !matches!(to.holds, Holds::Scene) {
        dart::left_out(&cameras, &mut report);
    }
    tell(watch, "converting", 0, 1)?;
    let mut size = match &content {
        Content::Raster(raster) if !options.image_bands.is_empty() => raster_size(raster, options.image_bands.len()),
        _ => content.size(),
    };
    let (copies, cameras, sources) = (&copies[..], &cameras[..], &sources[..]);
    let (report_of, size_of) = (&mut report, &mut size);
    let job = Job { input, from, output, options, sources, copies, cameras, report: report_of, size: size_of, watch };
    let written = job.write(content, to).map_err(|e| of_input(e, input))?;
    for note in &mut report.notes {
        // What is known without the file is of the input.
        note.at.file.get_or_insert_with(|| input.to_owned());
    }
    Ok(Conversion { from, to, report, written, size })
}

/// The scene of a file of Blender, with all of its files: as they were exported, so that textures and instances stay.
fn of_blender(input: &Path, output: &Path, options: &Options, watch: Watch<'_>) -> Result<Conversion> {
    let is_folder = registry::is_folder(output);
    let stem = match output.file_stem() {
        Some(name) if !is_folder => name.to_string_lossy().into_owned(),
        _ => "scene".into(),
    };
    let mut exported = exported(input, options, &stem, watch)?;
    let read = scene_toml::read(&exported.scene, watch).map_err(|e| in_stead(e, &exported, input))?;
    let report = std::mem::take(&mut exported.report);
    let size = Content::Scene(Box::new(read.scene), Flights::new()).size();
    let written = !(options.strict && report.has_losses());
    if written {
        let mut staged = match is_folder {
            true => Staged::folder_of(&SCENE, output, options.replace)?,
            false => Staged::file(output, options.replace)?,
        };
        for InputFile { path, .. } in &read.inputs {
            let name = path.file_name().unwrap_or_default();
            let to = match is_folder {
                true => staged.path().join(name),
                false if *path == exported.scene => staged.path().to_owned(),
                false => staged.beside(&output.with_file_name(name))?,
            };
            let bytes = std::fs::read(path).map_err(|e| Error::io(path, "reading", e))?;
            staged.put(&to, |out| out.write_all(&bytes))?;
        }
        staged.spares([input])?;
        staged.commit()?;
    }
    Ok(Conversion { from: &BLEND, to: &SCENE_FORMAT, report, written, size })
}

/// A file of Blender as a scene, for as long as the value lives.
fn exported(input: &Path, options: &Options, stem: &str, watch: Watch<'_>) -> Result<Exported> {
    let beside = input.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let blender = options.blender.as_deref().unwrap_or(Path::new("blender"));
    let how = How { blender, scratch: options.scratch.as_deref().unwrap_or(beside), outside: options.allow_outside };
    Exported::new(input, stem, &how, watch)
}

/// An error about the files of a scene that is soon gone: it is the input's.
fn in_stead(error: Error, exported: &Exported, input: &Path) -> Error {
    let folder = exported.scene.parent().unwrap_or(&exported.scene);
    let placed = |at: Location| match &at.file {
        Some(file) if file.starts_with(folder) => {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let item = at.item.map_or(name.to_string(), |item| format!("{name}, {item}"));
            Location::file(input).with_item(item)
        }
        _ => at,
    };
    match error {
        Error::Invalid(problems) => {
            Error::Invalid(problems.into_iter().map(|p| Problem { at: placed(p.at), ..p }).collect())
        }
        Error::Syntax { at, message } => Error::Syntax { at: placed(at), message },
        Error::Unsupported { at, feature } => Error::Unsupported { at: placed(at), feature },
        other => other,
    }
}

/// The format of an input, and its main file or folder.
fn format_of(input: &Path, options: &Options) -> Result<(&'static Format, PathBuf)> {
    match options.from {
        Some(from) => Ok((from, input.to_owned())),
        None => registry::of_input(input),
    }
}

/// Refuses options that would have no effect: a Sun that is not moved, spectra that are not resampled.
fn without_effect(options: &Options, from: &Format, to: &Format) -> Result<()> {
    let mut problems = Vec::new();
    let mut only = |is_given: bool, option: &str, is_of_use: bool, of: &str| {
        if is_given && !is_of_use {
            let (from, to) = (from.name, to.name);
            let message = format!("changes nothing from {from} to {to}: it is for {of}");
            problems.push(Problem::new(Location::item(option), message).with_help("leave it out"));
        }
    };
    only(!options.models.is_empty(), "--model", to.is_spectral(), "spectra as output");
    only(!options.bands.is_empty(), "--bands", to.is_spectral(), "spectra as output");
    only(options.append, "--append", *to == DATABASE, "a database as output");
    only(options.cell_m.is_some(), "--cell-m", *to == SIMULATION, "DART as output");
    only(options.sun_deg.is_some(), "--sun-deg", *from == SIMULATION, "DART as input");
    only(options.dart_databases.is_some(), "--databases", *from == SIMULATION, "DART as input");
    let is_scene = |format: &Format| matches!(format.holds, Holds::Scene | Holds::Blend);
    let has_origin = is_scene(from) || from.is_spectral();
    only(options.blender.is_some(), "--blender", *from == BLEND, "a file of Blender as input");
    only(options.origin_m.is_some(), "--origin-m", !has_origin, "DART or a mesh as input");
    let is_mesh = from.is_mesh();
    only(options.unit_m.is_some(), "--unit-m", is_mesh, "a mesh as input");
    only(options.up.is_some(), "--up", is_mesh, "a mesh as input");
    only(options.flip, "--flip", is_mesh, "a mesh as input");
    only(options.repairs.weld.is_some(), "--weld", is_mesh, "a mesh as input");
    only(options.repairs.t_junctions, "--t-junctions", is_mesh, "a mesh as input");
    only(options.repairs.outward, "--outward", is_mesh, "a mesh as input");
    only(options.repairs.decimate.is_some(), "--decimate", is_mesh, "a mesh as input");
    let is_placed = is_mesh && (is_scene(to) || *to == SIMULATION);
    only(options.pose.is_some(), "--pose", is_placed, "a mesh as input and a scene or DART as output");
    only(options.step_s.is_some(), "--step-s", to.is_flight(), "trajectories and orientations");
    if let Some(unit_m) = options.unit_m.filter(|unit_m| !(*unit_m > 0.0 && unit_m.is_finite())) {
        problems.push(
            Problem::new(Location::item("--unit-m"), format!("{unit_m} is not positive")).with_help("1000 for km"),
        );
    }
    if problems.is_empty() { Ok(()) } else { Err(Error::Invalid(problems)) }
}

/// Why a format cannot become another, whatever the input holds: found out before it is read.
fn impossible(input: &Path, from: &Format, output: &Path, to: &Format) -> Option<Error> {
    let refused = |at: &Path, message: String, help: &str| {
        Some(Error::Invalid(vec![Problem::new(Location::file(at), message).with_help(help)]))
    };
    let not_held = |feature: String| Some(unsupported(input, &feature));
    let name = to.name;
    match (&from.holds, &to.holds) {
        (Holds::Image { .. }, Holds::Image { target: Err(instead), .. }) => {
            refused(output, "is a format that is read only".into(), instead)
        }
        // A name alone does not say what a table should hold.
        (Holds::Image { .. }, Holds::Image { .. }) => None,
        (Holds::Image { .. }, _) if *to == CSV => None,
        (Holds::Image { .. }, _) => not_held(format!("an image as {name}: it has neither mesh nor spectra")),
        (Holds::Flight { .. }, Holds::Flight { write: None, .. }) => {
            Some(Error::invalid(Location::file(output), format!("{name} is read, but not written")))
        }
        (Holds::Flight { .. }, Holds::Flight { .. }) => None,
        (Holds::Flight { .. }, _) => {
            let help =
                format!("end the output's name in {}, or say which with --to", registry::dotted(Format::is_flight));
            refused(input, format!("holds trajectories or orientations: they make no {name}"), &help)
        }
        (holds, Holds::Flight { .. }) => {
            let kind = match holds {
                Holds::Mesh { .. } => "a mesh",
                Holds::Spectra { .. } => "spectra",
                _ => "a scene",
            };
            not_held(format!("{kind} as {name}: nothing moves in it"))
        }
        (_, Holds::Image { .. }) => not_held(format!("anything but an image as {name}")),
        (Holds::Spectra { .. }, Holds::Spectra { .. }) => None,
        (Holds::Spectra { .. }, _) => refused(
            input,
            format!("holds spectra alone: they make no scene, and so no {name}"),
            "end the output's name in .db, .txt, .sli or .csv, or say which with --to",
        ),
        (Holds::Mesh { .. }, Holds::Spectra { .. }) => refused(
            input,
            format!("holds a mesh: it has no spectra for {name}"),
            "convert it to a scene, and give its materials spectra there",
        ),
        _ if to.writes.is_empty() => {
            refused(output, format!("{name} is read, and not written"), "take a name that ends in .obj or .glb")
        }
        _ => None,
    }
}

/// An error about a scene as it was read, whose items are those of the input.
fn of_input(error: Error, input: &Path) -> Error {
    let placed = |mut at: Location| {
        at.file.get_or_insert_with(|| input.to_owned());
        at
    };
    match error {
        Error::Unsupported { at, feature } => Error::Unsupported { at: placed(at), feature },
        Error::Invalid(problems) => {
            Error::Invalid(problems.into_iter().map(|p| Problem { at: placed(p.at), ..p }).collect())
        }
        other => other,
    }
}

/// Reads a file or folder of any format, and reports what is not taken over.
///
/// # Errors
/// Those of the format's reader; [`Error::Invalid`] if the format is not recognised.
pub fn read(input: &Path, options: &Options, watch: Watch<'_>) -> Result<(&'static Format, Content, Report)> {
    let Contents { format, content, cameras, mut report, .. } = read_all(input, options, watch)?;
    dart::left_out(&cameras, &mut report);
    Ok((format, content, report))
}

/// What was read.
struct Contents {
    format: &'static Format,
    content: Content,
    /// Which facets of a scene are copies of a mesh.
    copies: Vec<Copies>,
    /// What looks at a scene besides its own camera.
    cameras: Vec<(FrameCamera, Location)>,
    report: Report,
    /// The files that were read.
    sources: Vec<PathBuf>,
}

/// [`read`], with what a scene's content does not say, and the files that were read.
fn read_all(input: &Path, options: &Options, watch: Watch<'_>) -> Result<Contents> {
    let (format, path) = format_of(input, options)?;
    if options.repeat > 0 && *format != SIMULATION {
        let message = format!("is {}: only the scene of a DART simulation can be repeated (`--repeat`)", format.name);
        return Err(Error::invalid(Location::file(&path), message));
    }
    if options.wavelengths.is_some() && *format != CSV {
        let message = format!("is {}: its wavelengths are its own (`--wavelengths`)", format.name);
        return Err(Error::invalid(Location::file(&path), message));
    }
    let Options { origin_m, unit_m, up, pose, flip, .. } = *options;
    let placing = Placing { origin_m, unit_m, up, pose, flip };
    let mut sources = vec![path.clone()];
    let (mut copies, mut cameras) = (Vec::new(), Vec::new());
    let mut read_from = |inputs: &[InputFile]| sources.extend(inputs.iter().map(|input| input.path.clone()));
    let (content, report) = match format.holds {
        Holds::Scene => {
            let file = scene_toml::read(&path, watch)?;
            read_from(&file.inputs);
            copies = file.copies;
            let mut report = Report::default();
            for default in &file.defaults {
                report.note(Fate::Defaulted, Location::file(&path).with_item(&default.item), &default.value);
            }
            let content = match file.motion {
                Some((motion, timing)) => Content::Moving(Box::new((file.scene, motion, timing))),
                None => Content::Scene(Box::new(file.scene), Flights::new()),
            };
            (content, report)
        }
        Holds::Blend => {
            let mut exported = exported(&path, options, "scene", watch)?;
            let file = scene_toml::read(&exported.scene, watch).map_err(|e| in_stead(e, &exported, &path))?;
            copies = file.copies;
            (Content::Scene(Box::new(file.scene), Flights::new()), std::mem::take(&mut exported.report))
        }
        Holds::Mesh { read } => {
            let mut file = read(&path, options.allow_outside)?;
            read_from(&file.inputs);
            let mut report = Report::default();
            for (word, count) in &file.ignored {
                report.note(Fate::Dropped, Location::file(&path), format!("{count} x `{word}`"));
            }
            for notes in [&mut file.report.notes, &mut file.material_doubts, &mut file.doubts] {
                report.notes.append(notes);
            }
            let mut surface = file.surface.placed(&placing, (file.up, file.unit_m));
            options.repairs.mend(&mut surface.mesh, &path, &mut report)?;
            (Content::Mesh(surface), report)
        }
        Holds::Simulation => {
            let read = dart::read(&path, options, watch)?;
            read_from(&read.inputs);
            cameras = read.cameras;
            (Content::Scene(Box::new(read.scene), read.flights), read.report)
        }
        Holds::Spectra { read, .. } => {
            let (libraries, mut report) = match path.is_dir() {
                true => spectra::read(&path)?,
                false if *format == CSV => spectrum_csv::read_all(&path, options.wavelengths.as_deref())?,
                false => read(&path)?,
            };
            // The header of a library, or its numbers: whichever was not named.
            sources.extend(envi::pair(&path).into_iter().flat_map(|(header, numbers)| [header, numbers]));
            (Content::Spectra(chosen(libraries, options, &path, &mut report)?), report)
        }
        Holds::Image { open, .. } => {
            let mut raster = open(&path)?;
            let report = std::mem::take(&mut raster.report);
            sources.extend_from_slice(raster.files());
            (Content::Raster(Box::new(raster)), report)
        }
        Holds::Flight { read, .. } => {
            let mut file = read(&path, &LeapSeconds::default())?;
            let report = std::mem::take(&mut file.report);
            (Content::Flight(Box::new(file)), report)
        }
    };
    Ok(Contents { format, content, copies, cameras, report, sources })
}

/// What two files or folders differ in, by meaning: one line each.
///
/// # Errors
/// As [`read`].
pub fn diff(a: &Path, b: &Path, options: &Options, watch: Watch<'_>) -> Result<Vec<String>> {
    let is_dart = |path: &Path| {
        options.from == Some(&SIMULATION) || registry::of_input(path).is_ok_and(|(format, _)| *format == SIMULATION)
    };
    if is_dart(a) && is_dart(b) {
        return dart::diff(a, b, options, watch);
    }
    let (_, mut a, _) = read(a, options, watch)?;
    let (_, mut b, _) = read(b, options, watch)?;
    if let (Content::Raster(a), Content::Raster(b)) = (&mut a, &mut b) {
        return raster::differences(a, b, watch);
    }
    Ok(differences(&a, &b))
}

impl Content {
    /// What it is, in words.
    fn kind(&self) -> &'static str {
        match self {
            Content::Scene(..) | Content::Moving(_) => "a scene",
            Content::Mesh(_) => "a mesh",
            Content::Spectra(_) => "spectra",
            Content::Raster(_) => "an image",
            Content::Flight(_) => "trajectories or orientations",
        }
    }

    /// How much it is, in words.
    pub fn size(&self) -> String {
        match self {
            Content::Scene(scene, _) => format!("{} facets", scene.body.mesh.facets.len()),
            Content::Moving(moving) => format!("{} facets", moving.0.body.mesh.facets.len()),
            Content::Mesh(surface) => format!("{} facets", surface.mesh.facets.len()),
            Content::Spectra(libraries) => format!("{} spectra", libraries.len()),
            Content::Raster(raster) => raster_size(raster, raster.bands.len()),
            Content::Flight(file) => file.size(),
        }
    }
}

fn raster_size(raster: &Raster, bands: usize) -> String {
    format!("{} rows x {} columns x {bands} bands", raster.rows, raster.columns)
}

/// The libraries of the names that are asked for, in their order, at the wavelengths that are.
fn chosen(
    libraries: Vec<SpectralLibrary>,
    options: &Options,
    path: &Path,
    report: &mut Report,
) -> Result<Vec<SpectralLibrary>> {
    let find = |name: &String| {
        let found = libraries.iter().find(|library| library.name == *name);
        found.cloned().ok_or_else(|| {
            let known: Vec<&str> = libraries.iter().map(|library| library.name.as_str()).collect();
            Error::invalid(Location::file(path), format!("no spectra {name:?} in it; there are {}", known.join(", ")))
        })
    };
    let libraries = match options.models.is_empty() {
        true => libraries,
        false => options.models.iter().map(find).collect::<Result<_>>()?,
    };
    if options.bands.is_empty() {
        return Ok(libraries);
    }
    let resampled = spectra::resample(&libraries, &options.bands)?;
    for library in &libraries {
        let Some(known_um) = library.coverage_um() else { continue };
        let beyond = |band: &Band| band.share_beyond(known_um);
        let most = options.bands.iter().max_by(|a, b| beyond(a).total_cmp(&beyond(b)));
        if let Some(band) = most.filter(|band| beyond(band) > 0.0) {
            let message = format!(
                "{:.2e} of the response of the band at {} um lies beyond its wavelengths, and is left out",
                beyond(band),
                band.centre_um
            );
            let at = Location::file(path).with_item(format!("spectra of {:?}", library.name));
            report.note(Fate::Approximated, at, message);
        }
    }
    Ok(resampled)
}

fn unsupported(path: &Path, feature: &str) -> Error {
    Error::Unsupported { at: Location::file(path), feature: feature.to_owned() }
}

/// One conversion.
struct Job<'a> {
    input: &'a Path,
    from: &'static Format,
    output: &'a Path,
    options: &'a Options,
    /// Files that were read, none of which is replaced.
    sources: &'a [PathBuf],
    /// Which facets of a scene are copies of a mesh.
    copies: &'a [Copies],
    /// What looks at a scene besides its own camera.
    cameras: &'a [(FrameCamera, Location)],
    report: &'a mut Report,
    /// How much is converted, in words.
    size: &'a mut String,
    watch: Watch<'a>,
}

impl Job<'_> {
    /// Whether a loss forbids to write.
    fn refused(&self) -> bool {
        self.options.strict && self.report.has_losses()
    }

    /// The defaults of a scene that are not written anyway.
    fn forget_defaults(&mut self) {
        self.report.notes.retain(|note| note.fate != Fate::Defaulted);
    }

    /// Writes what is not [`impossible`]; `false` if a loss forbids it.
    fn write(mut self, content: Content, to: &Format) -> Result<bool> {
        match (content, &to.holds) {
            (Content::Raster(mut raster), _) => self.raster(&mut raster, to),
            (Content::Flight(file), _) => self.flight(&file, to),
            (Content::Spectra(libraries), _) => self.spectra(&libraries, to),
            (Content::Moving(moving), Holds::Simulation) => {
                let (scene, motion, timing) = &*moving;
                self.dart(scene, Some((motion, timing)))
            }
            (Content::Moving(moving), _) => {
                let scene = self.at_once(*moving);
                self.write(Content::Scene(Box::new(scene), Flights::new()), to)
            }
            (Content::Scene(scene, flights), Holds::Scene) => {
                let unsaid = self.unsaid();
                self.scene(&scene, &flights, unsaid)
            }
            (Content::Scene(scene, _), Holds::Simulation) => self.dart(&scene, None),
            (Content::Scene(scene, _), Holds::Spectra { .. }) => {
                let message = "mesh, Sun, camera and heat: only the spectra of its materials are written";
                self.report.note(Fate::Dropped, Location::file(self.input), message);
                self.forget_defaults();
                let libraries = chosen(libraries(&scene, self.report), self.options, self.input, self.report)?;
                self.spectra(&libraries, to)
            }
            (Content::Scene(scene, _), _) => {
                self.forget_defaults();
                let surface = ColouredMesh::of_scene(&scene, self.input, self.report);
                self.surface(&surface, to)
            }
            (Content::Mesh(surface), Holds::Scene) => {
                let scene = self.scene_of(surface)?;
                if self.options.pose == Some(NamedPose::Radial) {
                    // Whether its origin has a zenith.
                    coloured_mesh::in_body_axes(scene.clone())?;
                }
                let unsaid = self.unsaid();
                self.scene(&scene, &[], unsaid)
            }
            (Content::Mesh(surface), Holds::Simulation) => {
                let scene = self.scene_of(surface)?;
                let is_radial = self.options.pose == Some(NamedPose::Radial);
                let scene = if is_radial { coloured_mesh::in_body_axes(scene)? } else { scene };
                self.dart(&scene, None)
            }
            (Content::Mesh(surface), _) => self.surface(&surface, to),
        }
    }

    /// A scene to begin with, in the mesh's axes.
    fn scene_of(&mut self, surface: ColouredMesh) -> Result<Scene> {
        let Options { unit_m, up, pose, .. } = *self.options;
        if *self.from == OBJ {
            let (low, high) = surface.mesh.bounds_m().unwrap_or_default();
            let size_m = (high - low).length();
            let mut taken = |is_given: bool, item: &str, what: String| {
                if !is_given {
                    self.report.note(Fate::Defaulted, Location::item(item), what);
                }
            };
            taken(
                unit_m.is_some(),
                "mesh.unit_m",
                format!("1: the mesh is {size_m:.3} m across; --unit-m 1000 for km"),
            );
            taken(up.is_some(), "mesh.up", "z; --up y for files of programs that have y up".into());
        }
        surface.into_scene(self.input, pose, self.report)
    }

    /// What the input did not state, judging by its report.
    fn unsaid(&self) -> Unsaid {
        let defaults = self.report.notes.iter().filter(|note| note.fate == Fate::Defaulted);
        let items = defaults.filter_map(|note| Some((note.at.item.clone()?, note.message.clone())));
        match self.from.holds {
            Holds::Scene => Unsaid::Items(items.map(|(item, _)| item).collect()),
            _ => Unsaid::Defaults(items.collect()),
        }
    }

    fn scene(self, scene: &Scene, flights: &[(String, Vec<Step>)], unsaid: Unsaid) -> Result<bool> {
        let folder = registry::is_folder(self.output);
        // A folder's files appear with it.
        let staged = if folder { Some(Staged::folder_of(&SCENE, self.output, self.options.replace)?) } else { None };
        let path = staged.as_ref().map_or(self.output.to_owned(), |staged| staged.path().join("scene.toml"));
        let named = |e| match &staged {
            Some(staged) => staged.named(e),
            None => e,
        };
        let axes = if self.options.pose == Some(NamedPose::Radial) { Axes::Site } else { Axes::Body };
        let cameras = self.cameras.iter().map(|(camera, _)| camera.clone()).collect();
        let options = WriteOptions { replace: self.options.replace, unsaid, axes, cameras };
        dart::with_cameras(self.cameras, &path, self.report);
        let (mut files, report) = scene_toml::write_with(scene, &path, &options).map_err(named)?;
        self.report.notes.extend(report.notes);
        for texture in &scene.body.textures {
            let name = scene.body.materials.get(texture.material.0 as usize).map_or("", |m| m.name.as_str());
            let at = Location::item(format!("materials.{name:?}.texture"));
            self.report.note(Fate::Dropped, at, "textures are not written: name its raster in the new scene again");
        }
        for (name, steps) in flights {
            let plain = |c: char| if c.is_alphanumeric() { c } else { '_' };
            let plain: String = name.chars().map(plain).collect();
            let suffix = format!("flight.{}.csv", shortened(&plain));
            let file = path.with_extension(suffix);
            let text = dart::flight_csv(steps);
            let written = files.beside(&file).and_then(|path| files.put(&path, |out| out.write_all(text.as_bytes())));
            written.map_err(named)?;
            dart::carried(name, steps.len(), &file_name(&file), Location::file(self.input), self.report);
        }
        if self.refused() {
            return Ok(false);
        }
        let main = staged.as_ref().unwrap_or(&files);
        main.spares(self.sources.iter().map(PathBuf::as_path))?;
        files.commit().map_err(named)?;
        staged.map_or(Ok(()), Staged::commit)?;
        Ok(true)
    }

    /// A scene that moves, as if all of its image were taken at once.
    fn at_once(&mut self, (scene, motion, timing): (Scene, Motion, Timing)) -> Scene {
        let when = motion.start.after_s(timing.middle_s(timing.reference(&scene.exposure)));
        let at = |item: &str| Location::file(self.input).with_item(item);
        let message =
            format!("the scene is that of {when}, with all of the image taken at once: how it moves is not written");
        self.report.note(Fate::Approximated, at("flight"), message);
        if scene.sky.past.is_some() {
            let message = "in the day before, the Sun goes round steadily, and bodies of the sky stay where they are";
            self.report.note(Fate::Approximated, at("thermal"), message);
        }
        scene
    }

    fn dart(self, scene: &Scene, flight: Option<(&Motion, &Timing)>) -> Result<bool> {
        let package = dart::package(scene, flight, self.options, self.copies, self.report)?;
        if self.refused() {
            return Ok(false);
        }
        spares(&[self.output.to_owned()], self.sources.iter().map(PathBuf::as_path))?;
        super::dart::write(&package, self.output, self.options.replace, self.watch)?;
        Ok(true)
    }

    fn surface(self, surface: &ColouredMesh, to: &Format) -> Result<bool> {
        let Job { input, output, options, sources, .. } = self;
        let sources = || sources.iter().map(PathBuf::as_path);
        if surface.sun.is_some() {
            self.report.note(Fate::Dropped, Location::file(input).with_item("sun"), "where the light is");
        }
        if *to == OBJ {
            if surface.origin_m.is_some() {
                self.report.note(Fate::Dropped, Location::file(input).with_item("origin_m"), "OBJ has no place for it");
            }
            let lost = obj::faces_lost(&surface.mesh);
            if lost > 0 {
                let message = format!("{lost} faces of more than three corners become triangles");
                self.report.note(Fate::Dropped, Location::file(input).with_item("mesh"), message);
            }
            if self.refused() {
                return Ok(false);
            }
            let materials = companion(output, "mtl")?;
            let name = file_name(&materials);
            // Without a name there is nothing to look up.
            let has_names = surface.materials.iter().any(|material| !material.name.is_empty());
            let named = has_names.then_some(&*name);
            let write_mtl = |out: &mut BufWriter<File>| mtl::write(out, &surface.materials);
            let write_obj = |out: &mut BufWriter<File>| obj::write(out, &surface.mesh, &surface.materials, named);
            let mut staged = Staged::file(output, options.replace)?;
            staged.put(staged.path(), write_obj)?;
            if has_names {
                let beside = staged.beside(&materials)?;
                staged.put(&beside, write_mtl)?;
            }
            staged.spares(sources())?;
            staged.commit()?;
            return Ok(true);
        }
        let is_cut = surface.mesh.face_of_facet.windows(2).any(|pair| pair[0] == pair[1]);
        if is_cut {
            let message = "faces of more than three corners become triangles";
            self.report.note(Fate::Dropped, Location::file(input).with_item("mesh"), message);
        }
        let encoded = gltf::encode(surface)?;
        if encoded.largest_error_m > 0.0 {
            let message = format!(
                "positions are f32, up to {:.3e} m off; `_POSITION_RESIDUAL` keeps the rest for who knows it",
                encoded.largest_error_m
            );
            self.report.note(Fate::Approximated, Location::file(input).with_item("mesh"), message);
        }
        if encoded.largest_uv_error > 0.0 {
            let message = format!("texture coordinates are f32, up to {:.1e} off", encoded.largest_uv_error);
            self.report.note(Fate::Approximated, Location::file(input).with_item("mesh"), message);
        }
        if self.refused() {
            return Ok(false);
        }
        if *to == BINARY {
            let staged = Staged::file(output, options.replace)?;
            staged.put(staged.path(), |out| out.write_all(&encoded.glb()))?;
            staged.spares(sources())?;
            staged.commit()?;
        } else {
            let buffer = companion(output, "bin")?;
            let (text, bytes) = encoded.gltf(&file_name(&buffer));
            let mut staged = Staged::file(output, options.replace)?;
            staged.put(staged.path(), |out| out.write_all(text.as_bytes()))?;
            let beside = staged.beside(&buffer)?;
            staged.put(&beside, |out| out.write_all(bytes))?;
            staged.spares(sources())?;
            staged.commit()?;
        }
        Ok(true)
    }

    fn raster(self, raster: &mut Raster, to: &Format) -> Result<bool> {
        // A name alone does not say what a table should hold.
        let to = if *to == CSV { &GRID } else { to };
        let Holds::Image { target: Ok(target), .. } = to.holds else {
            return Err(unsupported(self.input, &format!("an image as {}", to.name)));
        };
        let target = target(self.output);
        if *to == ENVI && ending(self.output) == "hdr" {
            let message = "is a header's name: name the file of numbers, e.g. .img";
            return Err(Error::invalid(Location::file(self.output), message));
        }
        let Options { data_type, image_bands, replace, .. } = self.options;
        let options = raster::Options { data_type: *data_type, bands: image_bands.clone(), replace: *replace };
        let files = raster::write(raster, self.output, target, &options, self.report, self.watch)?;
        if self.refused() {
            return Ok(false);
        }
        files.spares(self.sources.iter().map(PathBuf::as_path))?;
        files.commit()?;
        Ok(true)
    }

    fn flight(self, file: &FlightFile, to: &Format) -> Result<bool> {
        let Holds::Flight { write: Some(write), .. } = to.holds else {
            return Err(Error::invalid(Location::file(self.output), format!("{} is read, but not written", to.name)));
        };
        let (text, report) = write(file, &LeapSeconds::default(), self.options.step_s)?;
        self.report.notes.extend(report.notes);
        if self.refused() {
            return Ok(false);
        }
        let staged = Staged::file(self.output, self.options.replace)?;
        staged.put(staged.path(), |out| out.write_all(text.as_bytes()))?;
        staged.spares(self.sources.iter().map(PathBuf::as_path))?;
        staged.commit()?;
        Ok(true)
    }

    fn spectra(self, libraries: &[SpectralLibrary], to: &Format) -> Result<bool> {
        if libraries.is_empty() {
            return Err(Error::invalid(Location::file(self.input), "holds no spectra"));
        }
        *self.size = format!("{} spectra", libraries.len());
        tell(self.watch, "writing the spectra", 0, 1)?;
        let (staged, report) = match self.options.append {
            true => super::dart::database::stage_more(self.output, libraries)?,
            false => spectra::stage(self.output, to, libraries, self.options.replace)?,
        };
        self.report.notes.extend(report.notes);
        if self.refused() {
            return Ok(false);
        }
        staged.spares(self.sources.iter().map(PathBuf::as_path))?;
        staged.commit()?;
        Ok(true)
    }
}

/// The companion file of an output with this extension.
fn companion(output: &Path, extension: &str) -> Result<PathBuf> {
    let path = output.with_extension(extension);
    if path == output {
        let message =
            format!("a file of this name goes with the mesh: end the mesh's name in something else than .{extension}");
        return Err(Error::invalid(Location::file(output), message));
    }
    Ok(path)
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The spectra of a scene's materials, each as the table that its photometry needs.
fn libraries(scene: &Scene, report: &mut Report) -> Vec<SpectralLibrary> {
    let mut libraries = Vec::new();
    for material in &scene.body.materials {
        let at = || Location::item(format!("materials.{:?}", material.name));
        let columns = match &material.photometry {
            Photometry::Lambert => vec![("reflectance", &material.reflectance)],
            Photometry::Model(_) | Photometry::Table(_) => {
                let message = "its hemispherical reflectance: how that depends on directions is not a spectrum";
                report.note(Fate::Approximated, at(), message);
                vec![("reflectance", &material.reflectance)]
            }
            // DART's name of rho0.
            Photometry::Rpv(_) => (material.photometry.parameters().into_iter())
                .map(|(name, column)| (if name == "rho0" { "reflectance" } else { name }, column))
                .collect(),
            Photometry::Hapke(_) => material.photometry.parameters(),
        };
        let wavelength_um = wavelengths(scene, &columns);
        let values =
            |spectrum: &Spectrum| wavelength_um.iter().map(|&um| spectrum.at(um)).collect::<Option<Vec<f64>>>();
        let columns: Option<Vec<Column>> = (columns.iter())
            .map(|(name, spectrum)| Some(Column { name: (*name).to_owned(), values: values(spectrum)? }))
            .collect();
        match columns {
            Some(columns) if !wavelength_um.is_empty() => {
                let (name, comment) = (material.name.clone(), String::new());
                libraries.push(SpectralLibrary { name, comment, wavelength_um, columns });
            }
            _ => report.note(Fate::Dropped, at(), "its parameters are nowhere known together"),
        }
    }
    libraries
}

/// Wavelengths of all columns where all are known; of what is the same everywhere, the ends of what the bands look at.
fn wavelengths(scene: &Scene, columns: &[(&str, &Spectrum)]) -> Vec<f64> {
    let known = columns.iter().map(|(_, s)| s.coverage_um());
    let (first, last) = known.fold((0.0_f64, f64::INFINITY), |(a, b), (low, high)| (a.max(low), b.min(high)));
    let is_table = |s: &&Spectrum| s.wavelength_um().len() > 1 || s.extend() == Extend::Error;
    let tables = columns.iter().map(|(_, s)| *s).filter(is_table);
    let mut all: Vec<f64> = tables.flat_map(|s| s.wavelength_um().iter().copied()).collect();
    if all.is_empty() {
        all = (scene.exposure.bands.iter())
            .flat_map(|band| <[f64; 2]>::from(band.support_within_um(scene.known_um(band.light))))
            .collect();
    }
    all.retain(|um| *um > 0.0 && (first..=last).contains(um));
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}
