//! What Mars emits, reflected by the surface.

use super::by_others::Brought;
use super::given::{Place, Wavelength, reflectance};
use super::{Bound, EffectKind, Finding, Given, Switch, by_others, mars_light};
use crate::physics::blackbody;
use crate::scene::{MARS_DAY_NIGHT_K, Material};
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "mars-glow",
    name: "heat of Mars as light",
    equation: Some("physics::mars::uniform_sphere_form_factor, physics::blackbody"),
    step: Some("solve::irradiance"),
    light: Some(Light::glows),
    switch: Some(Switch {
        add: |models, _, given, _| models.mars_heat = given.scene.sky.mars.is_some(),
        remove: |models| models.mars_heat = false,
        stated: |fixed| fixed.mars_heat.then_some("mars.heat"),
        cost_s: |given, models| {
            let of_models = || given.scene.sky.mars.as_ref().map_or(0.0, |mars| given.directions_s(mars));
            if models.mars_heat { FACET_S * given.scene.body.mesh.facets.len() as f64 + of_models() } else { 0.0 }
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
        modelled: mars.is_some() && given.models.mars_heat,
        missing: mars.is_none().then(|| "no Mars in the scene".into()),
        bound: bound(given),
        remaining: mars.and_then(|mars| Some(bound(given)?.times(mars_light::of_directions(given, mars, false)))),
        note: format!("day and night side at {day_k} and {night_k} K, which are inputs"),
        because: format!(
            "Mars by a facet's form factor, as warm as {night_k} K, and {day_k} K where its day may be in view"
        ),
    }
}

/// What that light changes at most.
pub(super) fn bound(given: &Given) -> Option<Bound> {
    let has_mars = given.scene.sky.mars.is_some();
    given.error_without(|place| {
        let Place { at, material, class, .. } = *place;
        let of_mars = if has_mars { [class.most_by_mars, class.most_of_mars] } else { [given.most_of_mars(); 2] };
        sent(given, at, material, of_mars) + by_others::sent(given, place, brought(given, at))
    })
}

/// What facets that face all of Mars have of that light.
pub(super) fn brought(given: &Given, at: &Wavelength) -> Brought {
    let kelvins = given.scene.sky.mars.as_ref().map_or(MARS_DAY_NIGHT_K, |mars| mars.day_night_k);
    let radiance = |t_k| if at.light.glows() { blackbody::radiance_w_m2_sr_um(at.um, t_k) } else { 0.0 };
    let [day, night] = kelvins.map(radiance);
    Brought { white: day.max(night) * given.most_of_mars(), all_w_m2: 0.0 }
}

/// Radiance of a facet in that light, W m-2 sr-1 um-1, that Mars makes as bright as this, and that has this form factor of it.
pub(super) fn sent(given: &Given, at: &Wavelength, material: &Material, [by_mars, of_mars]: [f64; 2]) -> f64 {
    let [day_k, night_k] = given.scene.sky.mars.as_ref().map_or(MARS_DAY_NIGHT_K, |mars| mars.day_night_k);
    // A model may send more of light from one direction than of light from all.
    let gain = if of_mars > 0.0 { (by_mars / of_mars).max(1.0) } else { 1.0 };
    if !at.light.glows() {
        return 0.0;
    }
    let [day, night] = [day_k, night_k].map(|t_k| blackbody::radiance_w_m2_sr_um(at.um, t_k));
    // All of it is as warm as its night, and as much of it as may be in view is day.
    let more = (day - night).max(0.0) * of_mars.min(given.extremes.most_of_day);
    reflectance(material, at.um) * (night * of_mars + more) * gain
}
