//! Terrain between a facet and Mars.

use super::{EffectKind, Finding, Given, left_out, modelled};
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    name: "shadows in Mars-light",
    equation: None,
    step: Some("solve::lit"),
    light: Some(Light::is_lit),
    find,
};

fn find(given: &Given) -> Finding {
    let bound = match &given.scene.sky.mars {
        Some(_) if given.reference.largest_mars_irradiance == 0.0 => Some(0.0),
        _ => given.mars_light_bound(),
    };
    if let (Some(_), Some(rule)) = (&given.scene.sky.mars, given.scene.models.mars_shadows) {
        let note = format!(
            "each facet has the share of Mars-light that terrain leaves, of {} parts of Mars. The bound is that of a facet which one straight horizon crosses",
            rule.count()
        );
        return modelled(bound.map(|bound| bound * rule.share_error()), note);
    }
    left_out(bound, "a facet's own horizon cuts Mars, other terrain does not: up to all of the Mars-light")
}
