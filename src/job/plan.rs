//! By which models a scene is simulated.

use crate::error::Result;
use crate::progress::{Watch, tell};
use crate::scene::Scene;
use crate::study::{self, Extremes, Plan, Request};

/// Decides by which models a scene is simulated, and gives it these.
pub(super) fn decide(scene: &mut Scene, request: &Request, watch: Watch<'_>) -> Result<(Extremes, Plan)> {
    scene.body.topology_watched(watch)?;
    tell(watch, "plan", 0, 1)?;
    let (models, extremes, plan) = study::decide(scene, request, watch)?;
    *scene = scene.by(models)?;
    tell(watch, "plan", 1, 1)?;
    Ok((extremes, plan))
}
