//! Sunlight that Mars reflects.

use glam::DVec3;

use super::given::{Place, Wavelength, reflectance};
use super::{Bound, EffectKind, Finding, Given, Switch, mars_seen};
use crate::physics::mars::middle_above_horizon;
use crate::physics::mars_light::MARS_LIGHT_ERROR;
use crate::physics::reflectance::{Brdf, PhotometricAngles};
use crate::scene::{MARS_ALBEDO, MarsModel, Material};
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
        cost_s: |given, _| FACET_S * given.scene.body.mesh.facets.len() as f64,
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
    match given.scene.sky.mars.as_ref().map(|_| given.models.mars_light) {
        Some(MarsModel::NearField) => found(
            true,
            None,
            bound.map(|bound| bound.times(MARS_LIGHT_ERROR + spread(given, mars_seen(given.scene, given.extremes).0))),
            "a Lambert sphere in the near field, with phase, tilt and each facet's horizon; uniform and without an atmosphere: the albedo is an input. \
             Surfaces with a model reflect it as if it came from the middle of what of Mars is above their horizon",
        ),
        Some(MarsModel::Thesis) => found(
            true,
            None,
            bound.map(|bound| bound.times(8.0)),
            "Domagala (2020), equations (4) to (8) as printed: no phase, no horizon; 2.4 times the light of a full Lambert sphere",
        ),
        Some(MarsModel::Off) => found(false, None, None, "off: Mars reflects no light"),
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
    given.error_without(|&Place { at, material, class, .. }| {
        let by_mars = if mars.is_some() { class.most_by_mars } else { given.most_of_mars() };
        sent(given, at, material, by_mars)
    })
}

/// Radiance of a facet in Mars-light, W m-2 sr-1 um-1, that a Mars of reflectance 1 makes as bright as this.
pub(super) fn sent(given: &Given, at: &Wavelength, material: &Material, by_mars: f64) -> f64 {
    let albedo =
        given.scene.sky.mars.as_ref().map_or(MARS_ALBEDO, |mars| mars.reflectance.at(at.um).unwrap_or(f64::NAN));
    if at.light.is_lit() { reflectance(material, at.um) * at.white * albedo * by_mars } else { 0.0 }
}

/// By how much the light of all of a disc is reflected otherwise than if it came from one point: the most over a surface's models, and over
/// heights of the disc and directions of view, relative; 0 for Lambert surfaces.
pub(super) fn spread(given: &Given, sin_radius: f64) -> f64 {
    let Some(um) = given.wavelengths.iter().find(|at| at.light.is_lit()).map(|at| at.um) else { return 0.0 };
    let models: Vec<Brdf> = given.materials.iter().filter_map(|(_, material)| material.photometry.brdf(um)).collect();
    let direction = |zenith_deg: f64, azimuth_deg: f64| {
        let [zenith, azimuth] = [zenith_deg, azimuth_deg].map(f64::to_radians);
        DVec3::new(zenith.sin() * azimuth.cos(), zenith.sin() * azimuth.sin(), zenith.cos())
    };
    let mut most = 0.0_f64;
    for centre in [0.0, 15.0, 30.0, 45.0, 60.0, 75.0].map(|zenith_deg| direction(zenith_deg, 0.0)) {
        let (h, v) = (DVec3::Y, centre.cross(DVec3::Y));
        // Six points on each of three rings of the disc of the same area.
        let disc: Vec<DVec3> = [1.0, 3.0, 5.0]
            .iter()
            .flat_map(|ring: &f64| {
                let sin = sin_radius * (ring / 6.0).sqrt();
                (0..6).map(move |k| {
                    let (s, c) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
                    (1.0 - sin * sin).max(0.0).sqrt() * centre + sin * (c * h + s * v)
                })
            })
            .filter(|towards| towards.z > 0.0)
            .collect();
        let middle = middle_above_horizon(DVec3::Z, centre, sin_radius);
        for emission_deg in [0.0, 30.0, 60.0] {
            for azimuth_deg in [0.0, 60.0, 120.0, 180.0] {
                let view = direction(emission_deg, azimuth_deg);
                for brdf in &models {
                    let f = |towards: DVec3| brdf.eval(&PhotometricAngles::of_directions(DVec3::Z, towards, view));
                    let (sum, light) = disc.iter().fold((0.0, 0.0), |(sum, light), d| (sum + d.z * f(*d), light + d.z));
                    most = most.max((sum / light / f(middle) - 1.0).abs());
                }
            }
        }
    }
    most
}
