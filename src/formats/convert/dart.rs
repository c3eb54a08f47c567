//! DART simulations and databases for `convert`: reading, checking and writing each in one call.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::dart::{self, Finding, Severity, SimulationOptions, Step, TableSummary, database::Database};
use crate::formats::dart::{SceneOptions, TargetVersion};
use crate::formats::input::InputFile;
use crate::formats::scene_toml;
use crate::geometry::{Copies, FrameCamera};
use crate::physics::reflectance::ALL_LIGHT;
use crate::progress::{Watch, unwatched};
use crate::report::{Fate, Report};
use crate::scene::{Motion, Scene, Timing};
use crate::spectral::SpectralLibrary;

use super::{Content, DATABASE, Options, SIMULATION, differences, format_of, unsupported};

/// The Sun and cameras of a sequence's simulations, by its name.
pub(super) type Flown = (String, Vec<Step>);
pub(super) type Flights = Vec<Flown>;

fn reading(options: &Options) -> Result<dart::ReadOptions> {
    if let Some(folder) = options.dart_databases.as_ref().filter(|folder| !folder.is_dir()) {
        return Err(Error::invalid(Location::file(folder).with_item("--databases"), "is not a folder"));
    }
    if let Some([zenith, _]) = options.sun_deg.filter(|[zenith, _]| !(0.0..90.0).contains(zenith)) {
        let message = format!("a zenith angle of {zenith} deg: the Sun stands above the ground, from 0 to 90 deg");
        return Err(Error::invalid(Location::item("--sun-deg"), message));
    }
    Ok(dart::ReadOptions {
        database: options.dart_databases.clone(),
        allow_outside: options.allow_outside,
        sun_deg: options.sun_deg,
    })
}

/// What a simulation is here.
pub(super) struct Read {
    /// As the first camera sees it.
    pub(super) scene: Scene,
    pub(super) flights: Flights,
    /// What else looks at it.
    pub(super) cameras: Vec<(FrameCamera, Location)>,
    pub(super) report: Report,
    pub(super) inputs: Vec<InputFile>,
}

/// The scene of a simulation, and what flies over it.
pub(super) fn read(path: &Path, options: &Options, watch: Watch<'_>) -> Result<Read> {
    let reading = reading(options)?;
    let (simulation, mut report, mut inputs) = dart::read(path, &reading)?;
    let to_scene = SceneOptions { origin_m: options.origin_m, repeat: options.repeat };
    let converted = dart::to_scene(&simulation, &reading.folder(path), &to_scene, watch)?;
    report.notes.extend(converted.report.notes);
    inputs.extend(converted.inputs);
    let mut flights = Vec::new();
    for sequence in &simulation.sequences {
        let (steps, more) = dart::flight(path, sequence, &reading)?;
        report.notes.extend(more.notes);
        flights.push((sequence.name.clone(), steps));
    }
    let dart::Converted { scene, cameras, .. } = converted;
    Ok(Read { scene, flights, cameras, report, inputs })
}

/// The simulation of a scene, not written yet.
pub(super) fn package(
    scene: &Scene,
    flight: Option<(&Motion, &Timing)>,
    options: &Options,
    copies: &[Copies],
    report: &mut Report,
) -> Result<dart::Package> {
    let target = match options.dart_version.as_deref() {
        None | Some("5.7.4") => TargetVersion::V5_7_4,
        Some("5.11.0") => TargetVersion::V5_11_0,
        Some(other) => {
            let feature = format!("writing DART {other} (5.7.4 and 5.11.0 are)");
            return Err(Error::Unsupported { at: Location::item("dart_version"), feature });
        }
    };
    let (cell_m, copies) = (options.cell_m, copies.to_vec());
    let options = SimulationOptions { target, cell_m, copies, ..SimulationOptions::default() };
    let (mut package, mut more) = dart::from_scene(scene, &options)?;
    if let Some(flight) = flight {
        dart::add_flight(&mut package, scene, flight, &mut more)?;
    }
    if !scene.body.mesh.uv.is_empty() {
        let message = "DART's objects have no texture coordinates";
        report.note(Fate::Dropped, Location::item("mesh"), message);
    }
    for texture in &scene.body.textures {
        let name = scene.body.materials.get(texture.material.0 as usize).map_or("", |m| m.name.as_str());
        let at = Location::item(format!("materials.{name:?}.texture"));
        report.note(Fate::Dropped, at, "DART has no textures: the material's own reflectance stays");
    }
    report.notes.extend(more.notes);
    Ok(package)
}

/// What two simulations differ in: in their inputs, those lit by Mars too, then in the scenes that these and the files they name make.
pub(super) fn diff(a: &Path, b: &Path, options: &Options, watch: Watch<'_>) -> Result<Vec<String>> {
    let reading = reading(options)?;
    let mut lines = dart::differences(a, b, &reading)?;
    let content = |path: &Path| -> Result<Content> {
        let Read { scene, flights, .. } = read(path, options, watch)?;
        Ok(Content::Scene(Box::new(scene), flights))
    };
    match (content(a), content(b)) {
        (Ok(a), Ok(b)) => lines.extend(differences(&a, &b)),
        (Err(Error::Interrupted), _) | (_, Err(Error::Interrupted)) => return Err(Error::Interrupted),
        (Err(error), _) | (_, Err(error)) => lines.push(format!("the scenes cannot be compared: {error}")),
    }
    Ok(lines)
}

/// What may be wrong with a simulation or an optical database.
///
/// # Errors
/// [`Error::Unsupported`] for other formats; [`Error::Io`] if there is nothing.
pub fn check(input: &Path, options: &Options) -> Result<Vec<Finding>> {
    let (format, path) = format_of(input, options)?;
    match format {
        of if *of == SIMULATION => {
            let reading = reading(options)?;
            let databases = RefCell::new(Databases::default());
            let of =
                |path: &Path| dart::check(path, &reading, &|path, model| databases.borrow_mut().summary(path, model));
            let mut findings = of(&path);
            let simulation = reading.folder(&path).simulation;
            let by_mars = simulation.join(dart::MARS);
            if by_mars.join("input").is_dir() {
                findings.extend(of(&by_mars));
            }
            findings.extend(mars(&path, options));
            for error in databases.into_inner().refused {
                findings.extend(refused(error)?);
            }
            Ok(findings)
        }
        of if *of == DATABASE => check_database(&path),
        other => Err(unsupported(input, &format!("checking {}", other.name))),
    }
}

/// What keeps a Mars that was written next to a simulation from being read back.
fn mars(path: &Path, options: &Options) -> Vec<Finding> {
    let has_mars = reading(options).is_ok_and(|reading| {
        let folder = reading.folder(path);
        dart::has_mars(&folder) || folder.simulation.join(dart::MARS).join("input").is_dir()
    });
    // Problems in the other parts are reported when those are read.
    let Some(read) = has_mars.then(|| read(path, options, &unwatched).ok()).flatten() else {
        return Vec::new();
    };
    let of_mars = read.report.notes.into_iter().filter(|note| note.at.item.as_deref() == Some("mars"));
    let finding = |note: crate::report::Note| Finding {
        severity: Severity::Warning,
        at: Location::file(path.join(dart::MARS)),
        what: note.message,
        effect: String::new(),
        fix: String::new(),
    };
    of_mars.map(finding).collect()
}

/// Databases that a check has asked; they stay open, because many tables are asked for.
#[derive(Default)]
struct Databases {
    open: BTreeMap<PathBuf, Option<Database>>,
    /// What could not be read.
    refused: Vec<Error>,
}

impl Databases {
    /// What a table covers.
    fn summary(&mut self, path: &Path, model: &str) -> Option<TableSummary> {
        let Databases { open, refused } = self;
        if model.is_empty() {
            return match dart::text_spectra::read(path) {
                Ok((library, _)) => summary(&library),
                Err(error) => {
                    refused.push(error);
                    None
                }
            };
        }
        let database = open.entry(path.to_owned()).or_insert_with(|| match Database::open(path) {
            Ok(database) => Some(database),
            // Built without SQLite: the rest is checked all the same.
            Err(Error::Unsupported { .. }) => None,
            Err(error) => {
                refused.push(error);
                None
            }
        });
        let library = match database.as_ref()?.read(model) {
            Ok((library, _)) => library,
            Err(error) => {
                refused.push(error);
                return None;
            }
        };
        summary(&library)
    }
}

fn summary(library: &SpectralLibrary) -> Option<TableSummary> {
    Some(TableSummary { range_um: library.coverage_um()?, shares: shares(library) })
}

/// Reflectance, direct and diffuse transmittance of a Lambertian table, for each wavelength; nothing of another.
fn shares(library: &SpectralLibrary) -> Vec<[f64; 3]> {
    let of = |name: &str, i: usize| library.column(name).and_then(|values| values.get(i)).copied().unwrap_or(0.0);
    let is_rpv = library.column("k").is_some();
    let count = if is_rpv { 0 } else { library.column("reflectance").map_or(0, <[f64]>::len) };
    let names = ["reflectance", "direct_transmittance", "diffuse_transmittance"];
    (0..count).map(|i| names.map(|name| of(name, i))).collect()
}

/// What is refused of a database, as findings; other errors end the check.
fn refused(error: Error) -> Result<Vec<Finding>> {
    let problems: Vec<Problem> = match error {
        Error::Invalid(problems) => problems,
        Error::Syntax { at, message } => vec![Problem::new(at, message)],
        other => return Err(other),
    };
    let finding = |p: Problem| Finding {
        severity: Severity::Error,
        at: p.at,
        what: p.message,
        effect: "DART does not check this".into(),
        fix: p.help.unwrap_or_else(|| "write the table again".into()),
    };
    Ok(problems.into_iter().map(finding).collect())
}

/// Reads every model of a database; refusals become errors, notes become warnings.
fn check_database(path: &Path) -> Result<Vec<Finding>> {
    let mut findings = Vec::new();
    let database = match Database::open(path) {
        Ok(database) => database,
        Err(error) => return refused(error),
    };
    let mut notes = Vec::new();
    for model in database.models() {
        match database.read(&model.name) {
            Ok((library, report)) => {
                notes.extend(report.notes);
                let most = shares(&library).iter().map(|row| row.iter().sum::<f64>()).fold(0.0, f64::max);
                if most > ALL_LIGHT {
                    findings.push(Finding {
                        severity: Severity::Error,
                        at: Location::file(path).with_item(format!("table {}", model.name)),
                        what: format!("reflects and lets through up to {} % of the light", 100.0 * most),
                        effect: "DART does not check this".into(),
                        fix: "lower one of them to 100 % in all".into(),
                    });
                }
            }
            Err(error) => findings.extend(refused(error)?),
        }
    }
    findings.extend(notes.into_iter().map(|note| Finding {
        severity: Severity::Warning,
        at: note.at,
        what: note.message,
        effect: "DART takes the numbers as they are".into(),
        fix: "see whether this is meant".into(),
    }));
    Ok(findings)
}

/// A flight table: a row for each camera of each step, or one without a camera. Angles in degrees and metres in DART's frame.
pub(super) fn flight_csv(steps: &[Step]) -> String {
    let mut text = String::from(
        "# DART's frame: x South, y East, z up, from the corner of the scene; zenith angles, azimuths counter-clockwise from x\n\
         step,sun_zenith_deg,sun_azimuth_deg,camera,x_m,y_m,z_m,look_zenith_deg,look_azimuth_deg,roll_deg,fov_across_deg,fov_down_deg,samples,lines\n",
    );
    for (i, step) in steps.iter().enumerate() {
        let [zenith, azimuth] = step.sun_deg;
        // Writing to a string does not fail.
        if step.cameras.is_empty() {
            let _ = writeln!(text, "{i},{zenith},{azimuth},,,,,,,,,,,");
        }
        for (c, camera) in step.cameras.iter().enumerate() {
            let ([x, y, z], [look_zenith, look_azimuth]) = (camera.position_m.to_array(), camera.look_deg);
            let ([across, down], [samples, lines]) = (camera.field_of_view_deg, camera.pixels);
            let roll = camera.roll_deg;
            let _ = writeln!(
                text,
                "{i},{zenith},{azimuth},{c},{x},{y},{z},{look_zenith},{look_azimuth},{roll},{across},{down},{samples},{lines}"
            );
        }
    }
    text
}

/// Says where a sequence went.
pub(super) fn carried(name: &str, steps: usize, file: &str, at: Location, report: &mut Report) {
    let message = format!("sequence {name:?}: the Sun and cameras of its {steps} simulations are in {file}");
    report.note(Fate::Carried, at, message);
}

/// Says that a scene has no place for these cameras.
pub(super) fn left_out(cameras: &[(FrameCamera, Location)], report: &mut Report) {
    for (_, at) in cameras {
        report.note(Fate::Dropped, at.clone(), "a scene has one camera: this is not the first");
    }
}

/// Says which scene file further cameras have.
pub(super) fn with_cameras(cameras: &[(FrameCamera, Location)], path: &Path, report: &mut Report) {
    for (i, (_, at)) in cameras.iter().enumerate() {
        let file = super::file_name(&scene_toml::path_of_camera(path, i + 2));
        let message = format!("a scene has one camera: that of this one, camera {}, is {file}", i + 2);
        report.note(Fate::Carried, at.clone(), message);
    }
}
