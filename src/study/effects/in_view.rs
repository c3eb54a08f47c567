//! Bodies of the sky in the camera's field.

use super::{Bound, EffectKind, Finding, Given};

pub(super) const KIND: EffectKind = EffectKind {
    key: "in-view",
    name: "bodies in view",
    equation: Some("geometry::sphere_image::SphereImage"),
    step: Some("integrate::globes"),
    light: None,
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let names: Vec<&str> = given.scene.globes_in_view().into_iter().map(|(globe, _)| globe.name.as_str()).collect();
    match names.is_empty() {
        true => Finding {
            bound: Some(Bound::NOTHING),
            note: "no body of the sky is in the camera's field".into(),
            because: "it changes nothing".into(),
            ..Finding::default()
        },
        false => Finding {
            modelled: true,
            // Its outline and its terminator are exact.
            remaining: Some(Bound::NOTHING),
            note: format!(
                "{}: drawn with phase and its own heat, hiding what is behind it: a uniform Lambert sphere without an atmosphere",
                names.join(", ")
            ),
            because: "without it the sky would be black there: relative to that there is no bound".into(),
            ..Finding::default()
        },
    }
}
