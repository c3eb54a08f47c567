//! Terrain between a facet and Mars.

use super::{EffectKind, Finding, Given};
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "mars-shadows",
    name: "shadows in Mars-light",
    equation: None,
    step: None,
    light: Some(Light::is_lit),
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let missing = match &given.scene.sky.mars {
        Some(_) => "a facet's own horizon cuts Mars, other terrain does not",
        None => "no Mars in the scene",
    };
    Finding {
        missing: Some(missing.into()),
        bound: super::mars_light::bound(given),
        note: "terrain may hide Mars".into(),
        because: "all of the Mars-light".into(),
        ..Finding::default()
    }
}
