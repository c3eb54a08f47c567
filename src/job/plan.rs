//! By which models a scene is simulated.

use crate::error::Result;
use crate::formats::Subject;
use crate::progress::Watch;
use crate::study::{self, Extremes, Plan, Request};

/// Decides by which models a scene is simulated, gives it these, and warns of what was asked for and does not come about.
pub(super) fn decide(subject: &mut Subject, request: &Request, watch: Watch<'_>) -> Result<(Extremes, Plan)> {
    let (models, extremes, plan) = study::decide(&subject.scene, request, watch)?;
    subject.warnings.extend(study::unheeded(&subject.scene, request, &models, &plan));
    subject.scene = subject.scene.by(models)?;
    Ok((extremes, plan))
}
