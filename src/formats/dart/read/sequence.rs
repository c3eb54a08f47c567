//! Sequences: files that make many simulations of one, by values that some attributes take one after the other.

use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Problem, Result};
use crate::formats::xml::{self, Element};
use crate::report::Report;

use super::super::folder::Folder;
use super::super::{Pinhole, Sequence, SequenceEntry, SequenceGroup, SequenceValues};
use super::reading::{Reading, number};
use super::{Inputs, ReadOptions, camera, directions, maket};

/// No sequence gives more values to its simulations.
const VALUES: usize = 1_000_000;
/// The root section of a sequence's file.
const DESCRIPTOR: &str = "DartSequencerDescriptor";

/// The simulations of a sequence: for each, the value of each entry, in the order of groups and entries.
///
/// The values of a group advance together; groups combine as a product, the last one fastest.
///
/// # Errors
/// [`Error::Invalid`] where the entries of a group differ in their number of values, and for more than a million values
/// in all.
pub fn rows(sequence: &Sequence) -> Result<Vec<Vec<String>>> {
    let count = count(sequence)?;
    let mut rows = vec![Vec::new(); count];
    let mut repeat = count;
    for group in sequence.groups.iter().filter(|g| !g.entries.is_empty()) {
        let length = group.entries[0].values.len().max(1);
        repeat /= length;
        for (i, row) in rows.iter_mut().enumerate() {
            row.extend(group.entries.iter().map(|entry| entry.values.at(i / repeat % length)));
        }
    }
    Ok(rows)
}

/// The number of simulations, if they can be made. Errors as [`rows`].
pub(in crate::formats::dart) fn count(sequence: &Sequence) -> Result<usize> {
    let mut problems = Vec::new();
    let (mut simulations, mut entries) = (Some(1_usize), 0);
    for group in &sequence.groups {
        let Some(first) = group.entries.first() else { continue };
        let length = first.values.len();
        for entry in group.entries.iter().filter(|e| e.values.len() != length) {
            let message = format!(
                "{} values, but the first entry of the group `{}` has {length}: they advance together",
                entry.values.len(),
                group.name
            );
            problems.push(Problem::new(entry.at.clone(), message));
        }
        simulations = simulations.and_then(|n| n.checked_mul(length));
        entries += group.entries.len();
    }
    let simulations = if entries == 0 { Some(0) } else { simulations };
    match simulations.filter(|n| n.checked_mul(entries).is_some_and(|values| values <= VALUES)) {
        Some(n) if problems.is_empty() => return Ok(n),
        Some(_) => {}
        None => problems.push(Problem::new(sequence.at.clone(), format!("makes more than {VALUES} values"))),
    }
    Err(Error::Invalid(problems))
}

impl SequenceValues {
    /// How many they are.
    pub fn len(&self) -> usize {
        match self {
            SequenceValues::Enumerated(values) => values.len(),
            SequenceValues::Linear { count, .. } => *count as usize,
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The i-th, as text; empty beyond the last.
    pub fn at(&self, i: usize) -> String {
        match self {
            SequenceValues::Enumerated(values) => values.get(i).cloned().unwrap_or_default(),
            SequenceValues::Linear { start, step, .. } => format!("{:?}", start + i as f64 * step),
        }
    }
}

/// What of one simulation of a sequence is a matter of flight: the Sun and the cameras, in the site's frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Zenith angle and azimuth of the Sun as seen from the ground, deg.
    pub sun_deg: [f64; 2],
    /// Directions from the scene in which images are asked for: zenith angle and azimuth, deg.
    pub views_deg: Vec<[f64; 2]>,
    /// Cameras.
    pub cameras: Vec<Pinhole>,
}

/// The flight table of a sequence: the Sun and cameras of each of its simulations, and notes on what else it varies.
///
/// `path` is the simulation that it belongs to. Values are put into its inputs as DART puts them, and read from there.
///
/// # Errors
/// As [`rows`] and [`read`](super::read); [`Error::Invalid`] for a property that the inputs do not have.
pub fn flight(path: &Path, sequence: &Sequence, options: &ReadOptions) -> Result<(Vec<Step>, Report)> {
    let folder = options.folder(path);
    let mut inputs = Inputs::read(&folder)?;
    let mut report = Report::default();
    let rows = rows(sequence)?;
    let entries: Vec<&SequenceEntry> = sequence.groups.iter().flat_map(|g| &g.entries).collect();
    let mut problems = Vec::new();
    for entry in &entries {
        if attribute(&mut inputs, &entry.property).is_none() {
            let message = format!("the simulation has no attribute `{}`", entry.property);
            problems.push(Problem::new(entry.at.clone(), message));
        }
        let is_of_flight =
            ["Directions.", "Phase.SensorImageSimulation."].iter().any(|p| entry.property.starts_with(p));
        if !is_of_flight {
            let message =
                format!("`{}` varies along the sequence: a flight table has only the Sun and cameras", entry.property);
            report.note(crate::report::Fate::Dropped, entry.at.clone(), message);
        }
    }
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    let missing = || Error::invalid(sequence.at.clone(), "a section of the simulation is missing");
    let mut steps = Vec::with_capacity(rows.len());
    for (i, row) in rows.iter().enumerate() {
        for (entry, value) in entries.iter().zip(row) {
            if let Some(attribute) = attribute(&mut inputs, &entry.property) {
                attribute.clone_from(value);
            }
        }
        let mut reading = Reading::new(&folder, options);
        let maket = maket::read(inputs.section("Maket").ok_or_else(missing)?, &mut reading);
        let directions = directions::read(inputs.section("Directions").ok_or_else(missing)?, &maket, &mut reading);
        let cameras = camera::read(inputs.section("Phase").ok_or_else(missing)?, &maket, &mut reading);
        let Reading { problems, report: of_step, .. } = reading;
        problems.finish(&folder.input)?;
        if i == 0 {
            report.notes.extend(of_step.notes);
        }
        steps.push(Step { sun_deg: directions.sun_deg, views_deg: directions.views_deg, cameras });
    }
    Ok((steps, report))
}

/// The attribute that a dotted path leads to: `Section.Element[2].Element.attribute`.
fn attribute<'i>(inputs: &'i mut Inputs, property: &str) -> Option<&'i mut String> {
    let mut names = property.split('.');
    let mut element = inputs.section_mut(names.next()?)?;
    let mut names: Vec<&str> = names.collect();
    let last = names.pop()?;
    for step in names {
        let (name, index) = match step.split_once('[') {
            Some((name, index)) => (name, index.strip_suffix(']')?.parse().ok()?),
            None => (step, 0),
        };
        element = element.children.iter_mut().filter(|c| c.name == name).nth(index)?;
    }
    element.attributes.iter_mut().find(|a| a.name == last).map(|a| &mut a.value)
}

/// The sequences that lie beside the input folder or in it.
pub(super) fn read(folder: &Folder, reading: &mut Reading) -> Vec<Sequence> {
    let mut sequences = Vec::new();
    for path in candidates(folder) {
        // Other files are there too; only one that begins as a sequence is looked into.
        let Ok((text, file)) = crate::formats::input::text(&path, xml::LONGEST) else { continue };
        if !text.contains(&format!("<{DESCRIPTOR}")) {
            continue;
        }
        match xml::parse(&text, &path) {
            Ok(root) => {
                reading.inputs.push(file);
                sequences.extend(root.child(DESCRIPTOR).map(|descriptor| sequence(descriptor, reading)));
            }
            Err(Error::Syntax { at, message }) => reading.problem(at, message),
            Err(error) => reading.problem(Location::file(&path), error.to_string()),
        }
    }
    sequences
}

/// XML files, sorted by name, that are not inputs of the simulation itself.
fn candidates(folder: &Folder) -> Vec<PathBuf> {
    let mut paths = Vec::new();
    let mut places = vec![&folder.simulation];
    if folder.input != folder.simulation {
        places.push(&folder.input);
    }
    for place in places {
        let Ok(entries) = std::fs::read_dir(place) else { continue };
        let is_sequence = |path: &PathBuf| {
            let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
            let others = ["log.xml", "triangleFile.xml"];
            name.ends_with(".xml") && !others.contains(&name) && !super::FILES.iter().any(|(file, _, _)| *file == name)
        };
        let mut found: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(is_sequence).collect();
        found.sort();
        paths.extend(found);
    }
    paths
}

fn sequence(descriptor: &Element, reading: &mut Reading) -> Sequence {
    // `sequence;;name` where it was made by the sequencer, a path in old versions.
    let name = descriptor.get("sequenceName").unwrap_or_default();
    let name = name.rsplit([';', '/', '\\']).next().unwrap_or(name).to_owned();
    let groups = match descriptor.descendant("DartSequencerDescriptorEntries") {
        Some(list) => list
            .all("DartSequencerDescriptorGroup")
            .map(|group| SequenceGroup {
                name: group.get("groupName").unwrap_or_default().to_owned(),
                entries: group.all("DartSequencerDescriptorEntry").map(|e| entry(e, reading)).collect(),
            })
            .collect(),
        None => {
            reading.problem(descriptor.at(), "has no `<DartSequencerDescriptorEntries>` within");
            Vec::new()
        }
    };
    Sequence { name, groups, at: descriptor.at() }
}

fn entry(element: &Element, reading: &mut Reading) -> SequenceEntry {
    let property = reading.text(element, "propertyName");
    let args = reading.text(element, "args");
    let arguments: Vec<&str> = args.split(';').map(str::trim).collect();
    let mut values = SequenceValues::Enumerated(Vec::new());
    match element.get("type") {
        Some("enumerate") => {
            // A last `;` ends the list.
            let ended = arguments.strip_suffix(&[""]).unwrap_or(&arguments);
            values = SequenceValues::Enumerated(ended.iter().map(|&a| a.to_owned()).collect());
        }
        Some("linear") => match linear(&arguments) {
            Some(linear) => values = linear,
            None => {
                let message =
                    format!("`{args}`: a start, a step and a whole number of values belong here, e.g. `0;5;7`");
                reading.problem(element.at_attribute("args"), message);
            }
        },
        kind => {
            let message =
                format!("values of the kind `{}`: known are `enumerate` and `linear`", kind.unwrap_or_default());
            reading.problem(element.at_attribute("type"), message);
        }
    }
    SequenceEntry { property, values, at: element.at() }
}

fn linear(arguments: &[&str]) -> Option<SequenceValues> {
    let [start, step, count] = arguments.strip_suffix(&[""]).unwrap_or(arguments) else { return None };
    Some(SequenceValues::Linear { start: number(start)?, step: number(step)?, count: count.parse().ok()? })
}
