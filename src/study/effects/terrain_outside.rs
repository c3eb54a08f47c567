//! Shadows of terrain that the mesh does not hold.

use super::{Bound, EffectKind, Finding, Given};

pub(super) const KIND: EffectKind = EffectKind {
    key: "terrain-outside",
    name: "terrain outside the mesh",
    equation: None,
    step: None,
    light: None,
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let share = 100.0 * given.extremes.open_to_shadow;
    let nothing = |note: &str| Finding {
        bound: Some(Bound::NOTHING),
        note: note.into(),
        because: "there is nothing that could cast a shadow".into(),
        ..Finding::default()
    };
    match given.extremes.site.up {
        None => nothing("the mesh is a body: there is none"),
        Some(_) if share == 0.0 => {
            nothing("every ray from what the image shows to the Sun leaves the mesh above its highest point")
        }
        Some(_) => Finding {
            missing: Some("the mesh ends at its rim".into()),
            bound: given.error_of_edges(f64::INFINITY),
            note: format!(
                "from {share:.1} % of what the image shows rays to the Sun leave the mesh below its highest point: this might be in shadow"
            ),
            because: "all of the light of such a place".into(),
            ..Finding::default()
        },
    }
}
