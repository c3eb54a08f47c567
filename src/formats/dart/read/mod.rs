//! Reading DART's inputs: what mmxrt understands of a simulation, and what it does not.
//!
//! Simulations of DART 5.4 to 5.11: elements are looked up by name below the section of a file, in any order, since every version moves some of
//! them. Unknown content is ignored and reported.

mod camera;
mod carried;
pub(super) mod coeff_diff;
mod directions;
mod losses;
mod maket;
pub(super) mod object_3d;
mod phase;
mod reading;
mod temperatures;
pub(super) mod sequence;
pub(super) mod unread;

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::ilwis::{self, Raster};
use crate::formats::input::InputFile;
use crate::formats::xml::{self, Element};
use crate::report::{Fate, Report};

use super::folder::Folder;
use super::{Simulation, Topography, Version};
use reading::Reading;

/// What a simulation does not say itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// A folder of databases and other files that inputs may name, besides the simulation's own.
    pub database: Option<PathBuf>,
    /// Inputs may name files anywhere.
    pub allow_outside: bool,
    /// Zenith angle and azimuth of the Sun as seen from the ground, deg, for simulations that give a date.
    pub sun_deg: Option<[f64; 2]>,
}

impl ReadOptions {
    /// The folders of the simulation at `path`.
    pub fn folder(&self, path: &Path) -> Folder {
        Folder::new(path, self.database.as_deref(), self.allow_outside)
    }
}

/// Pixels by which a raster may be larger or smaller than the scene, apart from rounding.
const LENIENT: f64 = 1.001;

/// The input files: their names, the section each holds, and whether a simulation is read without it.
pub(super) const FILES: [(&str, &str, bool); 11] = [
    ("maket.xml", "Maket", true),
    ("coeff_diff.xml", "Coeff_diff", true),
    ("object_3d.xml", "object_3d", false),
    ("phase.xml", "Phase", true),
    ("directions.xml", "Directions", true),
    ("atmosphere.xml", "Atmosphere", false),
    ("plots.xml", "Plots", false),
    ("trees.xml", "Trees", false),
    ("urban.xml", "Urban", false),
    ("water.xml", "Water", false),
    ("inversion.xml", "DartInversion", false),
];

/// The trees of a simulation's input files.
pub(super) struct Inputs {
    /// The root of each of [`FILES`]; `None` for one that may be missing, and is.
    roots: Vec<Option<Element>>,
    pub(super) files: Vec<InputFile>,
}

impl Inputs {
    /// Reads all files that exist. The errors of all of them are reported together.
    pub(super) fn read(folder: &Folder) -> Result<Self> {
        let mut problems = Vec::new();
        let (mut roots, mut files) = (Vec::new(), Vec::new());
        for (name, section, needed) in FILES {
            let path = folder.input.join(name);
            let root = match xml::read(&path) {
                Ok((root, file)) => {
                    files.push(file);
                    root
                }
                Err(Error::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
                    if needed {
                        let message = "is missing: a simulation is a folder whose input/ holds the files of DART";
                        problems.push(Problem::new(Location::file(&path), message));
                    }
                    roots.push(None);
                    continue;
                }
                Err(Error::Syntax { at, message }) => {
                    problems.push(Problem::new(at, message));
                    continue;
                }
                Err(Error::Invalid(more)) => {
                    problems.extend(more);
                    continue;
                }
                Err(other) => return Err(other),
            };
            if root.name != "DartFile" {
                let message = format!("`<{}>` where `<DartFile>` belongs", root.name);
                problems.push(Problem::new(root.at(), message));
            } else if root.child(section).is_none() {
                problems.push(Problem::new(root.at(), format!("has no `<{section}>` within")));
            }
            roots.push(Some(root));
        }
        if problems.is_empty() { Ok(Inputs { roots, files }) } else { Err(Error::Invalid(problems)) }
    }

    /// The section of a file, by its name.
    pub(super) fn section(&self, section: &str) -> Option<&Element> {
        let i = FILES.iter().position(|(_, name, _)| *name == section)?;
        self.roots.get(i)?.as_ref()?.child(section)
    }

    /// The root of the file that a section is in.
    pub(super) fn root(&self, section: &str) -> Option<&Element> {
        let i = FILES.iter().position(|(_, name, _)| *name == section)?;
        self.roots.get(i)?.as_ref()
    }

    /// All roots that are there.
    pub(super) fn roots(&self) -> impl Iterator<Item = &Element> {
        self.roots.iter().flatten()
    }

    /// The same to be changed.
    pub(super) fn section_mut(&mut self, section: &str) -> Option<&mut Element> {
        let i = FILES.iter().position(|(_, name, _)| *name == section)?;
        self.roots.get_mut(i)?.as_mut()?.children.iter_mut().find(|c| c.name == section)
    }
}

/// Reads the inputs of a simulation, from its folder or its `input/`.
///
/// The report lists what is ignored, approximated, or taken by default. OBJ files and
/// databases are not opened: [`Folder::locate`] finds them.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] with everything in the files that cannot be read or used, each at its place:
/// text that is not XML, missing files, elements and attributes, values that are not numbers, paths out of the folder.
pub fn read(path: &Path, options: &ReadOptions) -> Result<(Simulation, Report, Vec<InputFile>)> {
    let folder = options.folder(path);
    let mut inputs = Inputs::read(&folder)?;
    let mut reading = Reading::new(&folder, options);
    reading.inputs = std::mem::take(&mut inputs.files);
    for (name, _, _) in FILES.iter().filter(|(_, section, _)| inputs.section(section).is_none()) {
        let message = "is missing: taken as if nothing of it were in use";
        reading.note(Fate::Defaulted, Location::file(folder.input.join(name)), message);
    }
    losses::tell(&inputs, &mut reading);
    let missing = || Error::invalid(Location::file(&folder.input), "a section is missing");
    let section = |name: &str| inputs.section(name).ok_or_else(missing);
    let maket = maket::read(section("Maket")?, &mut reading);
    let coeff_diff = section("Coeff_diff")?;
    let thermal = coeff_diff::thermal(coeff_diff, &mut reading);
    let phase = phase::read(section("Phase")?, &maket, &thermal, &mut reading);
    let object_3d = inputs.section("object_3d");
    let simulation = Simulation {
        version: version(&inputs, &mut reading),
        optical: coeff_diff::optical(coeff_diff, phase.bands.len(), &mut reading),
        thermal,
        objects: object_3d.map_or_else(Vec::new, |o| object_3d::objects(o, &mut reading)),
        fields: object_3d.map_or_else(Vec::new, |o| object_3d::fields(o, &mut reading)),
        directions: directions::read(section("Directions")?, &maket, &mut reading),
        sequences: sequence::read(&folder, &mut reading),
        maket,
        phase,
    };
    reading.missing(&inputs);
    let Reading { problems, report, inputs, .. } = reading;
    problems.finish(&folder.input)?;
    Ok((simulation, report, inputs))
}

/// The raster of heights that a simulation names, if there is one: the first line is at x = 0, heights in m.
///
/// It spans the scene, with two lines and columns at least. `None` also if it is not there.
///
/// # Errors
/// [`Error::Invalid`] if it holds values that are not heights, or if its header gives it another extent than the scene's, by more than
/// a pixel; and as [`ilwis::read`].
pub fn terrain(simulation: &Simulation, folder: &Folder) -> Result<Option<(Raster, Vec<InputFile>)>> {
    let Some(Topography { file: name, generated: _, at }) = &simulation.maket.topography else { return Ok(None) };
    let found = folder.locate(name, at).map_err(|problem| Error::Invalid(vec![problem]))?;
    let Some(path) = found else { return Ok(None) };
    let (raster, files) = ilwis::read(&path)?;
    let Raster { rows, columns, pixel_m, values } = &raster;
    let mut problems = Vec::new();
    if let Some(first) = values.iter().position(|height| !height.is_finite()) {
        let (row, column) = (first / columns + 1, first % columns + 1);
        let message = format!("holds heights that are not finite numbers, first in row {row}, column {column}");
        problems.push(Problem::new(Location::file(&path), message));
    }
    let header = || Location::file(path.with_extension("mpr"));
    if *rows < 2 || *columns < 2 {
        let message = format!("a terrain of {rows} x {columns} heights: two lines and columns at least belong here");
        problems.push(Problem::new(header(), message));
    }
    if let Some([dx, dy]) = pixel_m {
        let (spans, [x, y]) = ([dx * *rows as f64, dy * *columns as f64], simulation.maket.size_m);
        // Some writers count from the first value to the last one.
        if (spans[0] - x).abs() > *dx * LENIENT || (spans[1] - y).abs() > *dy * LENIENT {
            let [a, b] = spans;
            let message = format!(
                "spans {a} x {b} m by its `CoordBounds`, but the scene is {x} x {y} m (maket.xml, SceneDimensions)"
            );
            problems.push(Problem::new(header(), message).with_help("make one as large as the other"));
        }
    }
    if problems.is_empty() { Ok(Some((raster, files))) } else { Err(Error::Invalid(problems)) }
}

fn version(inputs: &Inputs, reading: &mut Reading) -> Version {
    let Some(root) = inputs.roots().next() else { return Version { version: String::new(), build: String::new() } };
    let version = Version {
        version: reading.text(root, "version"),
        // There was none before 5.7.
        build: root.get("build").unwrap_or_default().to_owned(),
    };
    let numbers: Vec<Option<u32>> = version.version.split('.').map(|n| n.parse().ok()).collect();
    let known = matches!(numbers[..], [Some(5), Some(4..=11), ..]);
    if !known && root.get("version").is_some() {
        let message = format!(
            "version {} of DART is not one that is known (5.4 to 5.11): read by the names of elements",
            version.version
        );
        reading.note(Fate::Approximated, root.at_attribute("version"), message);
    }
    version
}
