//! What a simulation would model, and by what, before it is done.

use super::dry_run::{Outlook, outlook};
use crate::error::Result;
use crate::formats::{Subject, scene_toml};
use crate::progress::{Watch, tell};
use crate::scene::Scene;
use crate::study::{self, Plan, Request, Extremes};
use std::path::Path;

/// Reads a scene file, and decides by which models it would be simulated.
///
/// # Errors
/// Those of [`scene_toml::read`] and of [`study::plan`].
pub fn plan(path: &Path, request: &Request, watch: Watch<'_>) -> Result<(Outlook, Plan)> {
    let file = scene_toml::read(path, watch)?;
    let simulable = file.simulable();
    let mut subject = Subject::from(file);
    let (extremes, plan) = decide(&mut subject.scene, request, watch)?;
    Ok((outlook(subject, &extremes, &plan, simulable), plan))
}

/// Decides by which models a scene is simulated, and gives it these.
pub(super) fn decide(scene: &mut Scene, request: &Request, watch: Watch<'_>) -> Result<(Extremes, Plan)> {
    scene.body.topology_watched(watch)?;
    tell(watch, "plan", 0, 1)?;
    let extremes = Extremes::new(scene);
    let (models, plan) = study::plan(scene, &extremes, request)?;
    *scene = scene.by(models)?;
    tell(watch, "plan", 1, 1)?;
    Ok((extremes, plan))
}
