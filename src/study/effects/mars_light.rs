//! Sunlight that Mars reflects.

use glam::DVec3;

use super::{EffectKind, Finding, Given, left_out, mars_seen, modelled};
use crate::physics::mars::middle_above_horizon;
use crate::physics::mars_light::MARS_LIGHT_ERROR;
use crate::physics::reflectance::{Brdf, PhotometricAngles};
use crate::scene::{MARS_ALBEDO, MarsModel};
use crate::spectral::Light;

pub(super) const KIND: EffectKind = EffectKind {
    name: "Mars-light",
    equation: Some("physics::mars_light::MarsLight"),
    step: Some("solve::irradiance"),
    light: Some(Light::is_lit),
    find,
};

fn find(given: &Given) -> Finding {
    let bound = given.mars_light_bound();
    match given.scene.sky.mars.as_ref().map(|_| given.scene.models.mars_light) {
        Some(MarsModel::NearField) => modelled(
            bound.map(|b| b * (MARS_LIGHT_ERROR + spread(given))),
            "a Lambert sphere in the near field, with phase, tilt and each facet's horizon; uniform and without an atmosphere: the albedo is an input. \
             Surfaces with a model reflect it as if it came from the middle of what of Mars is above their horizon",
        ),
        Some(MarsModel::Thesis) => modelled(
            bound.map(|b| 2.0 * b),
            "Domagala (2020), equations (4) to (8) as printed: no phase, no horizon; 2.4 times the light of a full Lambert sphere",
        ),
        None => left_out(
            bound,
            format!(
                "no Mars in the scene: the bound is that of a full Mars of albedo {MARS_ALBEDO} over Phobos. It is the main light in shadows that face Mars"
            ),
        ),
    }
}

/// By how much the light of all of a full Mars is reflected otherwise than if it came from one point: the most over a surface's models, and over
/// heights of Mars and directions of view, relative; 0 for Lambert surfaces.
fn spread(given: &Given) -> f64 {
    let (sin_radius, _) = mars_seen(given.scene, given.site);
    let Some(um) = given.lit_um().next() else { return 0.0 };
    let models: Vec<Brdf> = given.materials.iter().filter_map(|material| material.photometry.brdf(um)).collect();
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
