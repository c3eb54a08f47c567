//! A campaign file: many acquisitions of one scene at different epochs, optionally with other orbits, pointings and
//! sensors.
//!
//! The scene's surface is read once and shared.

mod moments;
mod types;

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::located::Document;
use super::product_cubes::{CubeFormat, CubeFormats};
use super::product_folder::ProductOptions;
use super::scene_toml::{Changes, Template, Variant, id};
use super::{InputFile, Reading, Subject};
use crate::error::{Error, Location, Problem, Result};
use crate::flight::{Epoch, LeapSeconds, Span};
use crate::product::CoverageRule;
use crate::progress::Watch;
use crate::scene::Body;
use crate::study::locate::outermost_at;
use crate::study::{Choice, Request, TOLERANCE};

pub use moments::Acquisition;
use moments::{Told, acquisitions};
use types::{AcquisitionToml, CampaignToml, CoverageToml, OutputToml};

/// Flight variants cached at a time: each may hold kernels.
const VARIANTS: usize = 4;
/// Keys of an entry that change the scene, in hashing order.
const CHANGES: [&str; 6] = ["files", "orbit", "orbit_epoch", "pointing", "sensor", "spacecraft"];

/// A campaign, with its scene.
#[derive(Debug)]
pub struct Campaign {
    /// All acquisitions, in the order of the file.
    pub acquisitions: Vec<Acquisition>,
    /// The folder that the file names, if it does.
    pub folder: Option<PathBuf>,
    /// Output options.
    pub options: ProductOptions,
    /// Models and tolerance.
    pub request: Request,
    /// Coverage rule.
    pub rule: CoverageRule,
    /// The campaign file.
    pub input: InputFile,
    document: Document,
    template: Template,
    entries: Vec<Entry>,
    /// Flight variants, most recent last, with the changes that made them.
    variants: Vec<(String, Variant)>,
}

/// What an entry changes for all its acquisitions.
#[derive(Debug)]
struct Entry {
    toml: AcquisitionToml,
    /// Its changes as text, in the order of [`CHANGES`]: part of the ids.
    changes: String,
    target_m: Option<DVec3>,
}

/// One acquisition, ready to be made.
#[derive(Debug, Clone)]
pub struct Look {
    /// Id of everything its sightings depend on: BLAKE3, 64 hexadecimal digits.
    pub sights_id: String,
    /// Id of everything its product depends on.
    pub product_id: String,
    variant: Variant,
}

impl Campaign {
    /// Reads a campaign file, and its scene.
    ///
    /// # Errors
    /// Those of [`scene_toml::read`](super::scene_toml::read), for both files; [`Error::Invalid`] with all that is wrong with moments, names and targets.
    pub fn open(path: &Path, watch: Watch<'_>) -> Result<Self> {
        Self::open_with(path, &Reading::default(), watch)
    }

    /// The same, with items of the scene file replaced, or from a cache.
    ///
    /// # Errors
    /// As [`open`](Campaign::open).
    pub fn open_with(path: &Path, reading: &Reading, watch: Watch<'_>) -> Result<Self> {
        let (document, input) = Document::open(path)?;
        let CampaignToml { scene, acquisitions: entries, output, coverage, .. } = document.read()?;
        let beside = |name: &str| super::staging::folder_of(path).join(name);
        let moments = |start: Epoch, leap: &LeapSeconds| {
            let mut told = Told { document: &document, problems: vec![] };
            span(&acquisitions(&entries, start, leap, &mut told), start)
        };
        let scene = beside(&scene);
        let template = match scene.is_file() {
            true => Template::open(&scene, reading, Some(&moments), watch)?,
            false => {
                let why = if scene.exists() { "is a folder: name its scene file" } else { "there is no such file" };
                return Err(Error::invalid(document.at("scene"), format!("{}: {why}", scene.display())));
            }
        };
        let mut told = Told { document: &document, problems: vec![] };
        let all = match &template.file.motion {
            Some((motion, _)) => acquisitions(&entries, motion.start, &motion.almanac.leap, &mut told),
            None => vec![],
        };
        let request = request(&output, &mut told);
        let rule = rule(&coverage, &mut told);
        let body = &template.file.scene.body;
        if let Some(cache) = reading.cache.as_ref().filter(|_| entries.iter().any(|entry| entry.latitude_deg.is_some()))
        {
            cache.plant(body);
        }
        let of = |(i, toml): (usize, AcquisitionToml)| {
            let target_m = target(&toml, &format!("acquisitions[{i}]"), body, &mut told);
            let keys = document.element("acquisitions", i);
            let changes: Vec<_> = CHANGES.iter().filter_map(|key| Some((*key, keys?.get(*key)?))).collect();
            Entry { toml, changes: format!("{changes:?}"), target_m }
        };
        let entries: Vec<Entry> = entries.into_iter().enumerate().map(of).collect();
        let mut problems = told.problems;
        if !problems.is_empty() {
            problems.sort_by_key(|problem| problem.at.span);
            return Err(Error::Invalid(problems));
        }
        let folder = output.folder.as_deref().map(beside);
        let options = options(&output);
        Ok(Campaign {
            acquisitions: all,
            folder,
            options,
            request,
            rule,
            input,
            document,
            template,
            entries,
            variants: vec![],
        })
    }

    /// The target body.
    pub fn body(&self) -> &Body {
        &self.template.file.scene.body
    }

    /// Leap seconds, as the scene's files have them.
    pub fn leap(&self) -> LeapSeconds {
        let motion = self.template.file.motion.as_ref();
        motion.map_or_else(LeapSeconds::default, |(motion, _)| motion.almanac.leap.clone())
    }

    /// The files that all acquisitions depend on, the scene file first. The campaign file is not among them.
    pub fn inputs(&self) -> &[InputFile] {
        &self.template.file.inputs
    }

    /// What of the scene file was replaced, as it was said.
    fn settings(&self) -> &[String] {
        &self.template.file.settings
    }

    /// The place of an item in the file.
    pub fn at(&self, item: &str) -> Location {
        self.document.at(item)
    }

    /// Id of an acquisition's request, without the contents of the files that its entry names.
    pub fn entry_id(&self, acquisition: &Acquisition) -> String {
        let mut hasher = blake3::Hasher::new();
        let mut put = |bytes: &[u8]| {
            hasher.update(&(bytes.len() as u64).to_le_bytes());
            hasher.update(bytes);
        };
        put(b"mmxrt campaign 1");
        put(env!("CARGO_PKG_VERSION").as_bytes());
        put(id(self.inputs(), self.settings()).as_bytes());
        put(&acquisition.epoch.tdb_s().to_le_bytes());
        if let Some(Entry { changes, target_m, .. }) = self.entries.get(acquisition.entry) {
            put(changes.as_bytes());
            target_m.iter().for_each(|target_m| target_m.to_array().iter().for_each(|x| put(&x.to_le_bytes())));
        }
        hasher.finalize().to_hex().to_string()
    }

    /// An acquisition, with its ids.
    ///
    /// # Errors
    /// [`Error::Invalid`] with what is wrong with the entry's changes, at its place in the file; [`Error::Io`].
    pub fn look(&mut self, acquisition: &Acquisition) -> Result<Look> {
        let mut variant = self.variant(acquisition.entry)?;
        variant.motion.start = acquisition.epoch;
        let named = |parts: &[&str]| blake3::hash(parts.join("\n").as_bytes()).to_hex().to_string();
        let sights_id = named(&[&self.entry_id(acquisition), &id(&variant.inputs, self.settings())]);
        let Request { choice, tolerance } = &self.request;
        let options = format!("{:?} {choice} {:016x}", self.options, tolerance.to_bits());
        let product_id = named(&[&sights_id, &options]);
        Ok(Look { sights_id, product_id, variant })
    }

    /// The scene of an acquisition; its id is the product's.
    ///
    /// # Errors
    /// [`Error::Invalid`] at the place in the file that states its moment, if where something is, is not known then; and for what cannot be seen so.
    pub fn subject(&self, acquisition: &Acquisition, look: Look) -> Result<Subject> {
        let Look { product_id, variant, .. } = look;
        let scene = self.template.scene(&variant).map_err(|error| self.placed(acquisition, error))?;
        let Variant { motion, timing, chain, inputs, defaults, notes, .. } = variant;
        let motion = Some((motion, timing));
        Ok(Subject {
            scene,
            motion,
            chain,
            id: product_id,
            inputs,
            settings: self.settings().to_vec(),
            defaults,
            warnings: notes,
        })
    }

    /// What is wrong with an acquisition, at its place in the file.
    fn placed(&self, acquisition: &Acquisition, error: Error) -> Error {
        let at = || self.document.at(&acquisition.item);
        match error {
            Error::Invalid(problems) => {
                let here = |problem: Problem| match (&problem.at.file, problem.at.item.as_deref()) {
                    (Some(_), _) => problem,
                    (None, Some(item)) if !item.starts_with("flight") => {
                        Problem { message: format!("{item}: {}", problem.message), at: at(), ..problem }
                    }
                    _ => Problem { at: at(), ..problem },
                };
                Error::Invalid(problems.into_iter().map(here).collect())
            }
            // A file says better where than the entry that needs it.
            Error::Unsupported { at: inside, feature } if inside.file.is_none() => {
                Error::Unsupported { at: at(), feature }
            }
            other => other,
        }
    }

    /// The flight variant of an entry.
    fn variant(&mut self, entry: usize) -> Result<Variant> {
        let missing = || Error::invalid(self.document.at("acquisitions"), format!("has no entry {entry}"));
        let Entry { toml, changes, target_m } = self.entries.get(entry).ok_or_else(missing)?;
        let kept = self.variants.iter().position(|(of, _)| of == changes);
        let variant = match kept {
            Some(place) => self.variants[place].1.clone(),
            None => {
                let all = &self.acquisitions;
                let moments = |start: Epoch, _: &LeapSeconds| span(all, start);
                let said = Changes {
                    files: toml.files.as_deref(),
                    spacecraft: toml.spacecraft.as_deref(),
                    orbit: toml.orbit.as_deref(),
                    orbit_epoch: toml.orbit_epoch.as_deref(),
                    pointing: toml.pointing.as_ref(),
                    sensor: toml.sensor.as_ref(),
                };
                let item = format!("acquisitions[{entry}]");
                let variant = self.template.changed(said, (&self.document, &self.input), &item, Some(&moments))?;
                if self.variants.len() >= VARIANTS {
                    self.variants.remove(0);
                }
                self.variants.push((changes.clone(), variant.clone()));
                variant
            }
        };
        Ok(target_m.map_or(variant.clone(), |target_m| variant.aimed_at(target_m)))
    }
}

/// The JSON Schema of a campaign file.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(CampaignToml)
}

/// From the first to the last moment.
fn span(acquisitions: &[Acquisition], start: Epoch) -> Span {
    let around = Span { start, end: start };
    acquisitions.iter().fold(around, |around, Acquisition { epoch, .. }| Span {
        start: if *epoch < around.start { *epoch } else { around.start },
        end: if around.end < *epoch { *epoch } else { around.end },
    })
}

fn options(toml: &OutputToml) -> ProductOptions {
    let by_default = ProductOptions::default();
    let formats = toml.formats.as_deref();
    ProductOptions {
        interleave: toml.interleave.map_or(by_default.interleave, Into::into),
        precision: toml.dtype.map_or(by_default.precision, Into::into),
        formats: formats.map_or(by_default.formats, CubeFormats::from),
        exr: toml.exr || formats.is_some_and(|formats| formats.contains(&CubeFormat::Exr)),
        footprints: toml.footprints,
        table: toml.table,
        split: toml.split,
        quantity: toml.quantity.map_or(by_default.quantity, Into::into),
        ..by_default
    }
}

fn request(toml: &OutputToml, told: &mut Told<'_>) -> Request {
    let choice = toml.model.as_deref().map(Choice::parse).unwrap_or(Ok(Choice::Auto));
    let choice = choice.unwrap_or_else(|why| {
        told.tell("output.model", why, "");
        Choice::Auto
    });
    Request { choice, tolerance: toml.tolerance.unwrap_or(TOLERANCE) }
}

fn rule(toml: &CoverageToml, told: &mut Told<'_>) -> CoverageRule {
    let by_default = CoverageRule::default();
    let in_sunlight = toml.in_sunlight.unwrap_or(by_default.in_sunlight);
    let within_m = toml.within_m.clone().unwrap_or(by_default.within_m);
    if let Some(k) = (0..within_m.len()).find(|k| within_m[*k] <= 0.0 || (*k > 0 && within_m[*k] <= within_m[*k - 1])) {
        told.tell(&format!("coverage.within_m[{k}]"), "must be positive and ascending", "sort them, without repeats");
    }
    CoverageRule {
        in_sunlight,
        most_emission_deg: toml.most_emission_deg.unwrap_or(by_default.most_emission_deg),
        most_incidence_deg: toml.most_incidence_deg.unwrap_or(if in_sunlight { 90.0 } else { 180.0 }),
        within_m,
    }
}

/// The target of an entry, if it has one, from the body's centre in body axes, m.
fn target(toml: &AcquisitionToml, item: &str, body: &Body, told: &mut Told<'_>) -> Option<DVec3> {
    let target_m = match (toml.target_m, toml.latitude_deg, toml.longitude_deg) {
        (None, None, None) => return None,
        (Some(target_m), None, None) => Some(DVec3::from_array(target_m)),
        (None, Some(latitude_deg), Some(longitude_deg)) => {
            let found = outermost_at(body, [latitude_deg, longitude_deg]).map(|(_, point_m)| point_m);
            if found.is_none() {
                let message = format!("no surface at latitude {latitude_deg} deg, longitude {longitude_deg} deg");
                let help = "longitudes are east, 0 to 360 or -180 to 180: is the place on the scene's mesh?";
                told.tell(&format!("{item}.latitude_deg"), message, help);
            }
            found
        }
        _ => {
            let help = "give `target_m`, or `latitude_deg` and `longitude_deg`, or none of them";
            told.tell(item, "must give its target in exactly one way", help);
            None
        }
    };
    let other =
        toml.pointing.as_ref().filter(|of| of.target_m.is_some() || of.frame.is_some() || of.fixed_in.is_some());
    if other.is_some() {
        let message = "conflicts with the target: both say where to look; leave one out";
        told.tell(&format!("{item}.pointing"), message, "");
    }
    target_m
}
