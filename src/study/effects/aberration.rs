//! Where things are seen, and where they are.

use super::{Decision, Effect, EffectKind, Finding, Given};
use crate::flight::Correction;

/// Stellar aberration at Mars: its largest orbital speed and Phobos' own, 28.6 km/s, over that of light; rad.
const ABERRATION_RAD: f64 = 9.6e-5;

pub(super) const KIND: EffectKind = EffectKind {
    key: "aberration",
    name: "aberration and light time",
    equation: None,
    step: None,
    light: None,
    switch: None,
    find,
};

/// Says of a scene whose places are from flight dynamics that they are apparent ones, if they are.
pub fn tell_correction(effects: &mut [Effect], correction: Correction) {
    let what = match correction {
        Correction::None => return,
        Correction::LightTime => {
            "bodies are where their light left them; their directions are not turned by the motion of the surface"
        }
        Correction::LightTimeAndAberration => "bodies are where they appear: light time and aberration",
    };
    let Some(effect) = effects.iter_mut().find(|effect| effect.key == KIND.key) else { return };
    effect.decision = Decision::Kept;
    effect.step = Some("flight::Almanac::apparent".to_owned());
    effect.note = what.to_owned();
}

fn find(given: &Given) -> Finding {
    let (ray_m, pixel_m) = (given.throw_m(), given.pixel_m());
    // Of irradiance; and of shadows' edges. Emission follows irradiance by a power that makes it 2 at most, up to 20 um.
    let width_px = 2.0 * ABERRATION_RAD * (1.0 + ray_m / pixel_m);
    Finding {
        missing: Some("directions and distances are taken as given".into()),
        bound: given.error_of_edges(width_px),
        note: "apparent ones of one instant need nothing more".into(),
        because: format!(
            "geometric directions are off by up to 1e-4 rad, a sixtieth of the Sun's disc: the edges of shadows, at most {ray_m:.0} m from \
             what casts them, move by as much, in pixels of {pixel_m:.3} m"
        ),
        ..Finding::default()
    }
}
