//! What the instrument does to the light.

use super::{Decision, Effect, EffectKind, Finding};
use crate::instrument::Chain;

pub(super) const KIND: EffectKind = EffectKind {
    key: "instrument",
    name: "instrument",
    equation: None,
    step: None,
    light: None,
    switch: None,
    find: |_| Finding {
        missing: Some("the cube is radiance at the aperture".into()),
        note: "no PSF, distortion, smear, stray light or noise".into(),
        because: "it is not part of a scene".into(),
        ..Finding::default()
    },
};

/// Says of a result what of it an instrument made.
pub fn tell_instrument(effects: &mut [Effect], chain: &Chain) {
    let Some(effect) = effects.iter_mut().find(|effect| effect.key == KIND.key) else { return };
    let optics = chain.optics.as_ref().map(|optics| {
        let veil = if optics.stray > 0.0 { " and scatter" } else { "" };
        format!("optics that blur{veil}, on parts of 1/{} of a pixel", optics.subpixels)
    });
    let detector =
        chain.detector.as_ref().map(|detector| format!("a detector of {} bits, seed {}", detector.bits, detector.seed));
    let told: Vec<String> = optics.into_iter().chain(detector).collect();
    effect.decision = Decision::Kept;
    let step = if chain.detector.is_some() { "study::Reader" } else { "instrument::Blur" };
    effect.step = Some(step.to_owned());
    effect.note = told.join("; ");
    effect.because =
        "the scene's sensor has it; how much it changes is not a bound but a noise: `signal` says it".to_owned();
}
