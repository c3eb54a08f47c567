//! By which models a scene is simulated.

use crate::error::Result;
use crate::formats::Subject;
use crate::progress::Watch;
use crate::study::{self, Extremes, Moving, Plan, Request};

/// Decides by which models a scene is simulated, gives it these, and warns of what was asked for and does not come about.
///
/// # Errors
/// Those of [`study::decide`] and of [`Scene::by`](crate::scene::Scene::by).
pub fn decide(subject: &mut Subject, request: &Request, watch: Watch<'_>) -> Result<(Extremes, Plan)> {
    let (models, extremes, mut plan) = study::decide(&subject.scene, request, watch)?;
    if let Some((motion, timing)) = &mut subject.motion {
        if timing.poses == 0 {
            let moving = Moving { scene: &subject.scene, motion, timing: *timing, optics: None };
            timing.poses = if request.choice.has_smear() { study::poses(moving, request.tolerance) } else { 1 };
        }
        study::tell_correction(&mut plan.effects, motion.correction);
        let moving = Moving { scene: &subject.scene, motion, timing: *timing, optics: None };
        plan.moving = study::foreseen(moving, request.tolerance);
    }
    if let Some(chain) = &subject.chain {
        study::tell_instrument(&mut plan.effects, chain);
    }
    subject.warnings.extend(study::unheeded(&subject.scene, request, &models, &plan));
    subject.scene = subject.scene.by(models)?;
    let optics = subject.chain.as_ref().and_then(|chain| chain.optics.as_ref());
    let timing = subject.motion.as_ref().map(|(_, timing)| *timing);
    plan.cpu_s += study::looks_s(&subject.scene, &extremes, study::Looks::of(&subject.scene, timing, optics));
    Ok((extremes, plan))
}
