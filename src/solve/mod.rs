//! Scene to facet table: what each source sends to each facet, where it is lit, how warm it is. Not radiance,
//! but for the question that the image asks: what does a facet send [towards an observer](Emission)?

mod emission;
mod sunlit;
mod temperature_grid;

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::Direction;
use crate::physics::mars_light::MarsLight;
use crate::physics::{heat, mars, sun};
use crate::product::{FacetTable, Lit};
use crate::progress::{Watch, tell};
use crate::scene::{Mars, MarsModel, Scene, Thermal};
use crate::visibility::Topology;

pub use emission::Emission;
pub use sunlit::sunlit;
pub use temperature_grid::interpolation_error;

/// Irradiance, sunlit polygons and temperature of every facet.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn solve(scene: &Scene, topology: &Topology, watch: Watch<'_>) -> Result<FacetTable> {
    let sunlit = sunlit(&scene.mesh, topology, scene.sun.direction, watch)?;
    tell(watch, "irradiance", 0, 1)?;
    let towards_sun = scene.sun.direction.vec();
    let sun_irradiance: Vec<f64> = (0..scene.mesh.facets.len())
        .into_par_iter()
        .with_min_len(4096)
        .map(|f| match sunlit.lit[f] {
            Lit::Dark => 0.0,
            // Exact predicates found the facet lit; its rounded cosine may still be a hair below 0.
            _ => sun::irradiance_on_facet(1.0, scene.mesh.facet(f).normal().dot(towards_sun)),
        })
        .collect();
    let mars_irradiance = scene.mars.as_ref().map(|m| mars_irradiance(scene, m)).unwrap_or_default();
    let (temperature_lit_k, temperature_shaded_k) = temperatures(scene, &sun_irradiance, &mars_irradiance);
    tell(watch, "irradiance", 1, 1)?;
    Ok(FacetTable {
        sun_direction: scene.sun.direction,
        sun_irradiance,
        sunlit,
        mars_direction: scene.mars.as_ref().and_then(|m| Direction::new(m.centre_m)),
        mars_irradiance,
        temperature_lit_k,
        temperature_shaded_k,
    })
}

/// Irradiance by Mars on each facet over Mars' reflectance times the solar irradiance normal to the beam.
fn mars_irradiance(scene: &Scene, mars: &Mars) -> Vec<f64> {
    let mesh = &scene.mesh;
    let (low_m, high_m) = mesh.bounds_m().unwrap_or_default();
    let light = MarsLight::new(mars.centre_m, mars.radius_m, scene.sun.direction, low_m, high_m);
    (0..mesh.facets.len())
        .into_par_iter()
        .with_min_len(4096)
        .map(|f| {
            let facet = mesh.facet(f);
            let normal = facet.normal();
            match mars.model {
                MarsModel::NearField => light.irradiance(facet.centroid_m(), normal),
                MarsModel::Thesis => {
                    let to_mars_m = mars.centre_m - facet.centroid_m();
                    let distance_m = to_mars_m.length();
                    mars::thesis_irradiance(1.0, 1.0, mars.radius_m / distance_m, normal.dot(to_mars_m) / distance_m)
                }
            }
        })
        .collect()
}

/// Temperatures of the lit and of the shaded part of each facet, K; empty without thermal emission.
fn temperatures(scene: &Scene, sun_irradiance: &[f64], mars_irradiance: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mesh = &scene.mesh;
    let total_w_m2 = sun::irradiance_at(scene.sun.total_irradiance_1au_w_m2, scene.sun.distance_m);
    // What Mars sends: sunlight that it reflects, of the Sun's colour, and its own heat.
    let background_w_m2 = |f: usize, absorptance: f64, emissivity: f64| {
        let Some(mars) = &scene.mars else { return 0.0 };
        let facet = mesh.facet(f);
        let to_mars_m = mars.centre_m - facet.centroid_m();
        let distance_m = to_mars_m.length();
        let cos_tilt = facet.normal().dot(to_mars_m) / distance_m;
        let form_factor = mars::uniform_sphere_form_factor(mars.radius_m / distance_m, cos_tilt);
        absorptance * mars.bond_albedo * mars_irradiance[f] * total_w_m2
            + emissivity * mars.thermal_exitance_w_m2 * form_factor
    };
    let of = |f: usize| {
        let material = &scene.materials[mesh.material[f].0 as usize];
        match scene.thermal {
            Thermal::Thesis => (heat::thesis_temperature_k(sun_irradiance[f]), heat::thesis_temperature_k(0.0)),
            _ => {
                let (absorptance, emissivity) = (1.0 - material.bond_albedo, material.emissivity_bolometric);
                let background = background_w_m2(f, absorptance, emissivity);
                let sunlight = absorptance * total_w_m2 * sun_irradiance[f];
                (
                    heat::equilibrium_temperature_k(sunlight + background, emissivity),
                    heat::equilibrium_temperature_k(background, emissivity),
                )
            }
        }
    };
    if scene.thermal == Thermal::Off {
        return (vec![], vec![]);
    }
    (0..mesh.facets.len()).into_par_iter().with_min_len(4096).map(of).unzip()
}
