//! Shadows of terrain that the mesh does not hold.

use super::{EffectKind, Finding, Given, left_out};

pub(super) const KIND: EffectKind =
    EffectKind { name: "terrain outside the mesh", equation: None, step: None, light: None, find };

fn find(given: &Given) -> Finding {
    let share = 100.0 * given.open_to_shadow;
    let (bound, note) = match given.site.up {
        None => (Some(0.0), "the mesh is a body: there is none".to_owned()),
        Some(_) if share == 0.0 => {
            (Some(0.0), "every ray to the Sun leaves the site above its highest point".to_owned())
        }
        Some(_) => (
            given.all_light(),
            format!(
                "from {share:.1} % of the site's area rays to the Sun leave it below its highest point: these might be in shadow"
            ),
        ),
    };
    left_out(bound, note)
}
