//! By which models a scene is simulated.

use crate::error::Result;
use crate::progress::Watch;
use crate::scene::Scene;
use crate::study::{self, Extremes, Plan, Request};

/// Decides by which models a scene is simulated, and gives it these.
pub(super) fn decide(scene: &mut Scene, request: &Request, watch: Watch<'_>) -> Result<(Extremes, Plan)> {
    let (models, extremes, plan) = study::decide(scene, request, watch)?;
    *scene = scene.by(models)?;
    Ok((extremes, plan))
}
