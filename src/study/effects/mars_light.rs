//! Sunlight that Mars reflects.

use glam::DVec3;

use super::by_others::Brought;
use super::given::{Place, Wavelength, reflectance};
use super::{Bound, EffectKind, Finding, Given, Switch, by_others};
use crate::physics::mars_directions::{Directions, SphereSeen};
use crate::physics::mars_light::MARS_LIGHT_ERROR;
use crate::physics::reflectance::Brdf;
use crate::scene::{Globe, MARS_ALBEDO, MarsModel, Material};
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    key: "mars-light",
    name: "Mars-light",
    equation: Some("physics::mars_light::MarsLight"),
    step: Some("solve::irradiance"),
    light: Some(Light::is_lit),
    switch: Some(Switch {
        add: |models, stated, _, _| models.mars_light = stated.mars_light,
        remove: |models| models.mars_light = MarsModel::Off,
        stated: |fixed| fixed.mars_light.then_some("mars.model"),
        cost_s: |given, _| {
            let of_models = given.scene.sky.mars.as_ref().map_or(0.0, |mars| given.directions_s(mars));
            FACET_S * given.scene.body.mesh.facets.len() as f64 + of_models
        },
        own: None,
        drops_by_own: false,
    }),
    find,
};

/// CPU time that Mars-light takes for a facet, s.
const FACET_S: f64 = 8e-8;

fn find(given: &Given) -> Finding {
    let bound = bound(given);
    let because = match &given.scene.sky.mars {
        Some(_) => "a facet gets no more than all light of Mars that reaches a facet square to it, by the cosine of the part of its disc that is nearest to the \
                    facet's normal".to_owned(),
        None => format!("the light of a full Mars of albedo {MARS_ALBEDO} over Phobos"),
    };
    let found = |modelled, missing: Option<&str>, remaining, note: &str| Finding {
        modelled,
        missing: missing.map(str::to_owned),
        bound,
        remaining,
        note: note.into(),
        because,
    };
    match given.scene.sky.mars.as_ref().map(|mars| (given.models.mars_light, mars)) {
        Some((MarsModel::NearField, mars)) => found(
            true,
            None,
            bound.map(|bound| bound.times(MARS_LIGHT_ERROR + of_directions(given, mars, true))),
            "a Lambert sphere in the near field, with phase, tilt and each facet's horizon; uniform and without an atmosphere: the albedo is an input. \
             Surfaces with a model reflect it from a few directions of what of its day is above their horizon",
        ),
        Some((MarsModel::Thesis, _)) => found(
            true,
            None,
            bound.map(|bound| bound.times(8.0)),
            "Domagala (2020), equations (4) to (8) as printed: no phase, no horizon; 2.4 times the light of a full Lambert sphere",
        ),
        Some((MarsModel::Off, _)) => found(false, None, None, "off: Mars reflects no light"),
        None => found(false, Some("no Mars in the scene"), None, "it is the main light in shadows that face Mars"),
    }
}

/// What Mars-light changes at most.
pub(super) fn bound(given: &Given) -> Option<Bound> {
    let mars = given.scene.sky.mars.as_ref();
    if given.models.mars_light == MarsModel::Thesis {
        return given.error_without(|&Place { at, material, .. }| {
            let albedo = mars.map_or(MARS_ALBEDO, |mars| mars.reflectance.at(at.um).unwrap_or(f64::NAN));
            // Twice as much as all of Mars under the Sun at its zenith.
            reflectance(material, at.um) * at.white * albedo * 2.0 * given.most_of_mars()
        });
    }
    given.error_without(|place| {
        let Place { at, material, class, .. } = *place;
        let by_mars = if mars.is_some() { class.most_by_mars } else { given.most_of_mars() };
        sent(given, at, material, by_mars) + by_others::sent(given, place, brought(given, at))
    })
}

/// What facets that face all of Mars have of its light; how it warms them is another effect.
pub(super) fn brought(given: &Given, at: &Wavelength) -> Brought {
    let mars = given.scene.sky.mars.as_ref();
    let albedo = mars.map_or(MARS_ALBEDO, |mars| mars.reflectance.at(at.um).unwrap_or(f64::NAN));
    let white = if at.light.is_lit() { at.white * albedo * given.most_of_mars() } else { 0.0 };
    Brought { white, all_w_m2: 0.0 }
}

/// Radiance of a facet in Mars-light, W m-2 sr-1 um-1, that a Mars of reflectance 1 makes as bright as this.
pub(super) fn sent(given: &Given, at: &Wavelength, material: &Material, by_mars: f64) -> f64 {
    let albedo =
        given.scene.sky.mars.as_ref().map_or(MARS_ALBEDO, |mars| mars.reflectance.at(at.um).unwrap_or(f64::NAN));
    if at.light.is_lit() { reflectance(material, at.um) * at.white * albedo * by_mars } else { 0.0 }
}

/// The largest error of what surfaces with a model send of a globe's light, or of its heat, by the few directions that stand for it, relative; 0 for Lambert's.
pub(super) fn of_directions(given: &Given, globe: &Globe, is_lit: bool) -> f64 {
    let (low_m, high_m) = given.scene.body.bounds_m().unwrap_or_default();
    let middle_m = 0.5 * (low_m + high_m);
    let sun = is_lit.then(|| given.scene.sky.sun_on(globe).direction.vec());
    let to_centre_m = globe.centre_m - middle_m;
    let seen = SphereSeen { to_centre_m, radius_m: globe.radius_m, normal: DVec3::Z, sun };
    let directions =
        Directions::for_size(globe.radius_m / (globe.centre_m - globe.centre_m.clamp(low_m, high_m)).length());
    let views = given.views();
    let of = |(_, brdf): (f64, Brdf)| {
        views.iter().map(|view| directions.largest_error(&brdf, &seen, *view)).fold(0.0, f64::max)
    };
    let brdfs = given.materials.iter().flat_map(|(_, material)| given.brdfs(material));
    brdfs.map(of).fold(0.0, f64::max)
}
