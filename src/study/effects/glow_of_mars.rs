//! What Mars emits, reflected by the surface.

use super::given::reflectance;
use super::{Bound, EffectKind, Finding, Given, Switch};
use crate::physics::blackbody;
use crate::scene::MARS_DAY_NIGHT_K;
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "mars-glow",
    name: "heat of Mars as light",
    equation: Some("physics::bounds::mars_heat"),
    step: Some("solve::irradiance"),
    light: Some(Light::glows),
    switch: Some(Switch {
        add: |models, _, given, _| models.mars_heat = given.scene.sky.mars.is_some(),
        remove: |models| models.mars_heat = false,
        cost_s: |given, models| {
            if models.mars_heat { FACET_S * given.scene.body.mesh.facets.len() as f64 } else { 0.0 }
        },
        own: None,
        drops_by_own: false,
    }),
    find,
};

/// CPU time that a facet's form factor takes, s.
const FACET_S: f64 = 5e-8;

fn find(given: &Given) -> Finding {
    let mars = given.scene.sky.mars.as_ref();
    let [day_k, night_k] = mars.map_or(MARS_DAY_NIGHT_K, |mars| mars.day_night_k);
    Finding {
        modelled: mars.is_some() && given.scene.models.mars_heat,
        missing: mars.is_none().then(|| "no Mars in the scene".into()),
        bound: bound(given),
        note: format!("day and night side at {day_k} and {night_k} K, which are inputs"),
        because: format!("all of Mars at {} K, a facet's form factor of it", day_k.max(night_k)),
        ..Finding::default()
    }
}

/// What that light changes at most.
pub(super) fn bound(given: &Given) -> Option<Bound> {
    let mars = given.scene.sky.mars.as_ref();
    let [day_k, night_k] = mars.map_or(MARS_DAY_NIGHT_K, |mars| mars.day_night_k);
    let warmest_k = day_k.max(night_k);
    given.error(|at, material, class, _| {
        let of_mars = if mars.is_some() { class.most_of_mars } else { given.most_from_mars() };
        // A model may send more of light from one direction than of light from all.
        let gain = if class.most_of_mars > 0.0 { (class.most_by_mars / class.most_of_mars).max(1.0) } else { 1.0 };
        let emitted = if at.light.glows() { blackbody::radiance_w_m2_sr_um(at.um, warmest_k) } else { 0.0 };
        reflectance(material, at.um) * emitted * of_mars * gain
    })
}
