//! What the instrument does to the light.

use super::{EffectKind, left_out};

pub(super) const KIND: EffectKind = EffectKind {
    name: "instrument",
    equation: None,
    step: None,
    light: None,
    find: |_| left_out(None, "the cube is radiance at the aperture: no PSF, distortion, smear, stray light or noise"),
};
