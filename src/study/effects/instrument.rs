//! What the instrument does to the light.

use super::{EffectKind, Finding};

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
