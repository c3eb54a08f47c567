//! By which models a scene is simulated.

use crate::error::Result;
use crate::formats::Subject;
use crate::progress::Watch;
use crate::scene::Readout;
use crate::study::{self, Extremes, Moving, Plan, Request};

/// Decides by which models a scene is simulated, gives it these, and warns of what was asked for and does not come about.
pub(super) fn decide(subject: &mut Subject, request: &Request, watch: Watch<'_>) -> Result<(Extremes, Plan)> {
    let (models, extremes, mut plan) = study::decide(&subject.scene, request, watch)?;
    // Each band of a filter is an image; what effects cost is found much more rarely.
    if let Some((_, timing)) = subject.motion.as_ref().filter(|(_, timing)| timing.readout == Readout::Band) {
        let more = timing.count(&subject.scene.exposure).saturating_sub(1);
        plan.cpu_s += (plan.cpu_s - plan.cost_s()).max(0.0) * more as f64;
    }
    if let Some((motion, timing)) = &subject.motion {
        study::tell_correction(&mut plan.effects, motion.correction);
        let moving = Moving { scene: &subject.scene, motion, timing: *timing, optics: None };
        plan.moving = study::foreseen(moving, request.tolerance);
    }
    if let Some(chain) = &subject.chain {
        study::tell_instrument(&mut plan.effects, chain);
    }
    subject.warnings.extend(study::unheeded(&subject.scene, request, &models, &plan));
    subject.scene = subject.scene.by(models)?;
    Ok((extremes, plan))
}
