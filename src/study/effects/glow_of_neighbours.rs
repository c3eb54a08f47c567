//! What facets emit, reflected by others into the image.

use super::given::{Place, emission, reflectance};
use super::{Bound, EffectKind, Finding, Given};
use crate::physics::bounds;
use crate::scene::{Material, Thermal};
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "neighbours-glow",
    name: "heat of neighbours as light",
    equation: Some("physics::bounds::neighbours_heat"),
    step: None,
    light: Some(Light::glows),
    switch: None,
    find,
};

fn find(given: &Given) -> Finding {
    let form_factor = given.most_around();
    let most = |of: &dyn Fn(&Material) -> f64| given.materials.iter().map(|(_, m)| of(m)).fold(0.0, f64::max);
    let is_nothing = form_factor == 0.0 || given.models.thermal == Thermal::Off;
    let arriving = |um: f64| {
        bounds::neighbours_heat(most(&|m| emission(m, um, given.noon_k)), most(&|m| reflectance(m, um)), form_factor)
    };
    let at_um: Vec<(f64, f64)> =
        given.wavelengths.iter().filter(|at| at.light.glows()).map(|at| (at.um, arriving(at.um))).collect();
    let bound = match is_nothing {
        true => Some(Bound::NOTHING),
        false => given.error_without(|&Place { at, material, .. }| {
            let of = at_um.iter().find(|(um, _)| at.light.glows() && *um == at.um);
            of.map_or(0.0, |(_, arriving)| reflectance(material, at.um) * arriving)
        }),
    };
    Finding {
        missing: (!is_nothing).then(|| "nothing models it".into()),
        bound,
        note: "facets warm each other; what one reflects of the other's heat is not in the image: in shadows, beyond 3 um, as much as their light".into(),
        because: format!(
            "surroundings of {:.0} % of a facet's view, all of them as warm as {:.1} K, reflected",
            100.0 * form_factor,
            given.noon_k
        ),
        ..Finding::default()
    }
}
