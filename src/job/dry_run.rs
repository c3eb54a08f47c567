//! What can be said about simulating a scene on this machine before doing it.

use std::path::Path;

use crate::error::{Error, Result};
use crate::formats::scene_toml::{self, SceneFile};
use crate::formats::{Reading, Subject, machine};
use crate::progress::Watch;
use crate::study::{self, DryRun, Extremes, Moving, Plan, Request};

/// What can be said about a simulation before it is run.
#[derive(Debug)]
pub struct Outlook {
    /// The scene.
    pub subject: Subject,
    /// What it will take.
    pub dry_run: DryRun,
    /// Free memory now, bytes, where the system reports it.
    pub free_memory_bytes: Option<u64>,
    /// Free space on the current folder's disk, bytes, where the system reports it: the product's folder is not known yet.
    pub free_disk_bytes: Option<u64>,
    /// Warnings that the product will carry, and resources that may run short.
    pub warnings: Vec<String>,
    /// Why it cannot begin, if it cannot.
    pub error: Option<Error>,
}

/// Reads a scene file and estimates what simulating it would take, with its warnings.
///
/// # Errors
/// Those of [`scene_toml::read`](crate::formats::scene_toml::read).
pub fn dry_run(path: &Path, watch: Watch<'_>) -> Result<Outlook> {
    dry_run_with(path, &Reading::default(), watch)
}

/// The same, with items of the file replaced, or from a cache.
///
/// # Errors
/// Those of [`scene_toml::read_with`](crate::formats::scene_toml::read_with).
pub fn dry_run_with(path: &Path, reading: &Reading, watch: Watch<'_>) -> Result<Outlook> {
    Ok(plan(path, reading, &Request::default(), watch)?.0)
}

/// As [`dry_run_with`], for a scene that is simulated as it is requested; and by which models that would be.
///
/// # Errors
/// Those of [`scene_toml::read`](crate::formats::scene_toml::read) and of [`study::plan`].
pub fn plan(path: &Path, reading: &Reading, request: &Request, watch: Watch<'_>) -> Result<(Outlook, Plan)> {
    plan_of(scene_toml::read_with(path, reading, watch)?, request, watch)
}

/// As [`plan`], for a scene that has been read.
///
/// # Errors
/// Those of [`study::plan`].
pub fn plan_of(file: SceneFile, request: &Request, watch: Watch<'_>) -> Result<(Outlook, Plan)> {
    let simulable = file.simulable();
    let mut subject = Subject::from(file);
    let (extremes, plan) = super::plan::decide(&mut subject, request, watch)?;
    Ok((outlook(subject, &extremes, &plan, simulable), plan))
}

/// What simulating a scene would take; `simulable` says whether this version can.
fn outlook(subject: Subject, extremes: &Extremes, plan: &Plan, simulable: Result<()>) -> Outlook {
    let moving = subject.motion.as_ref().map(|(motion, timing)| Moving {
        scene: &subject.scene,
        motion,
        timing: *timing,
        optics: None,
    });
    let dry_run = study::dry_run(&subject.scene, moving, extremes, plan);
    let has_room = study::has_room(&subject.scene, false, machine::memory_bytes());
    let mut errors: Vec<Error> = [simulable, has_room].into_iter().filter_map(Result::err).collect();
    let error = match errors.len() {
        0 | 1 => errors.pop(),
        _ => Some(Error::Invalid(errors.iter().flat_map(Error::problems).collect())),
    };
    let free_memory_bytes = machine::free_memory_bytes();
    let free_disk_bytes = machine::free_disk_bytes(Path::new("."));
    // It stops nothing: memory may be given back, and products may go to another disk.
    let tight = |what: &str, wanted: u64, free: Option<u64>| {
        let free = free.filter(|free| *free < wanted)?;
        let [wanted, free] = [wanted, free].map(|bytes| machine::size(bytes, 1));
        Some(format!("it takes about {wanted} of {what}, but only {free} are free now"))
    };
    let shortages = [
        tight("memory", dry_run.memory_bytes, free_memory_bytes),
        tight("the disk of the current folder", dry_run.product_bytes, free_disk_bytes),
    ];
    let told = subject.warnings.iter().chain(&plan.moving).chain(&dry_run.warnings).cloned();
    let warnings = told.chain(shortages.into_iter().flatten()).collect();
    Outlook { subject, dry_run, free_memory_bytes, free_disk_bytes, warnings, error }
}
