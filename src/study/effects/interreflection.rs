//! Light and heat between facets.

use super::given::{emission, white_radiance};
use super::{EffectKind, Finding, Given, left_out};
use crate::physics::bounds;
use crate::scene::Material;
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    name: "interreflection",
    equation: Some("physics::bounds::interreflection"),
    step: None,
    light: None,
    find,
};

fn find(given: &Given) -> Finding {
    let form_factor = bounds::surroundings_form_factor(given.site.cos_steepest);
    let bound = given.reference.cos_incidence.and_then(|cos| {
        let at = |um, light: Light| {
            let largest = |of: &dyn Fn(&Material) -> f64| given.materials.iter().map(|m| of(m)).fold(0.0, f64::max);
            let reflectance = largest(&|m| m.reflectance.at(um).unwrap_or(0.0));
            let heat = if light.glows() { largest(&|m| emission(m, um, given.noon_k)) } else { 0.0 };
            let emitted = heat / white_radiance(given.scene, um)?;
            let bounded = reflectance * form_factor < 1.0;
            bounded.then(|| bounds::interreflection(reflectance, emitted, form_factor, cos))
        };
        given.bands_um.iter().try_fold(0.0, |most, (um, light)| Some(f64::max(most, at(*um, *light)?)))
    });
    let slopes = match given.site.up {
        Some(_) => format!("slopes up to {:.0} deg", given.site.cos_steepest.acos().to_degrees()),
        None => "a body may have any slope".to_owned(),
    };
    let note = format!(
        "the surroundings fill at most {:.0} % of a facet's view ({slopes}), all of them taken as lit at normal incidence and \
         as warm as {:.1} K. On gentle ground the truth is 10 to 100 times less; in shadow it is often the only light",
        100.0 * form_factor,
        given.noon_k,
    );
    left_out(bound, note)
}
