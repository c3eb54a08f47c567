//! Scene to facet table: what each source sends to each facet, where it is lit, how warm it is. Not radiance,
//! but for the question that the image asks: what does a facet send [towards an observer](Emission)?

mod emission;
mod temperature_grid;

use glam::DVec3;
use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::Direction;
use crate::physics::mars_light::MarsLight;
use crate::physics::{heat, mars, sun};
use crate::product::FacetTable;
use crate::progress::{Watch, tell};
use crate::scene::{Mars, MarsModel, Scene, Thermal};
use crate::visibility::{Seen, Shown};

pub use emission::Emission;
pub use temperature_grid::interpolation_error;

/// Irradiance, sunlit polygons and temperature of every facet.
///
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported), as [`Scene::simulable`] says;
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn solve(scene: &Scene, watch: Watch<'_>) -> Result<FacetTable> {
    scene.simulable()?;
    let sunlit = sunlit(scene, watch)?;
    tell(watch, "irradiance", 0, 1)?;
    let light = FacetLight::new(scene);
    let solve = |f: usize| light.on(f, sunlit.shown[f] != Shown::Nothing);
    let facets = (0..scene.body.mesh.facets.len()).into_par_iter().with_min_len(4096);
    let ((sun_irradiance, mut mars_irradiance), (mut temperature_lit_k, mut temperature_shaded_k)) =
        facets.map(solve).unzip();
    if scene.sky.mars.is_none() {
        mars_irradiance = vec![];
    }
    if scene.models.thermal == Thermal::Off {
        (temperature_lit_k, temperature_shaded_k) = (vec![], vec![]);
    }
    tell(watch, "irradiance", 1, 1)?;
    Ok(FacetTable {
        sun_direction: scene.sky.sun.direction,
        sun_irradiance,
        sunlit,
        mars_direction: scene.sky.mars.as_ref().and_then(|m| Direction::new(m.centre_m)),
        mars_irradiance,
        temperature_lit_k,
        temperature_shaded_k,
    })
}

/// Where every facet is lit, and nothing else: irradiances and temperatures are 0. That is what radiance from elsewhere leaves to
/// be asked.
///
/// # Errors
/// As [`solve`].
pub fn lit(scene: &Scene, watch: Watch<'_>) -> Result<FacetTable> {
    scene.simulable()?;
    let nothing = |is_wanted: bool| vec![0.0; if is_wanted { scene.body.mesh.facets.len() } else { 0 }];
    let has_heat = scene.models.thermal != Thermal::Off;
    Ok(FacetTable {
        sun_direction: scene.sky.sun.direction,
        sun_irradiance: nothing(true),
        sunlit: sunlit(scene, watch)?,
        mars_direction: scene.sky.mars.as_ref().and_then(|m| Direction::new(m.centre_m)),
        mars_irradiance: nothing(scene.sky.mars.is_some()),
        temperature_lit_k: nothing(has_heat),
        temperature_shaded_k: nothing(has_heat),
    })
}

fn sunlit(scene: &Scene, watch: Watch<'_>) -> Result<Seen> {
    Seen::from_afar(&scene.body.mesh, scene.body.topology(), scene.sky.sun.direction, "sunlight", watch)
}

/// What the sources of a scene send to a facet.
struct FacetLight<'a> {
    scene: &'a Scene,
    towards_sun: DVec3,
    /// Sunlight normal to the beam, over all wavelengths.
    sun_w_m2: f64,
    mars: Option<(&'a Mars, MarsLight)>,
}

/// Irradiance by the Sun and by Mars, and temperature of the lit and of the shaded part, K; each as [`FacetTable`] has it.
type Solved = ((f64, f64), (f64, f64));

impl<'a> FacetLight<'a> {
    fn new(scene: &'a Scene) -> Self {
        let (low_m, high_m) = scene.body.mesh.bounds_m().unwrap_or_default();
        let direction = scene.sky.sun.direction;
        let light = |mars: &'a Mars| (mars, MarsLight::new(mars.centre_m, mars.radius_m, direction, low_m, high_m));
        FacetLight {
            scene,
            towards_sun: direction.vec(),
            sun_w_m2: sun::irradiance_at(scene.sky.sun.total_irradiance_1au_w_m2, scene.sky.sun.distance_m),
            mars: scene.sky.mars.as_ref().map(light),
        }
    }

    /// On facet `f`, which sees the Sun or not.
    fn on(&self, f: usize, sees_sun: bool) -> Solved {
        let facet = self.scene.body.mesh.facet(f);
        let normal = facet.normal();
        // Exact predicates found the facet lit; its rounded cosine may still be a hair below 0.
        let sun = if sees_sun { sun::irradiance_on_facet(1.0, normal.dot(self.towards_sun)) } else { 0.0 };
        let mars = self.mars.as_ref().map_or(FromMars::default(), |(mars, light)| {
            let centroid_m = facet.centroid_m();
            let to_mars_m = mars.centre_m - centroid_m;
            let distance_m = to_mars_m.length();
            let (sin_radius, cos_tilt) = (mars.radius_m / distance_m, normal.dot(to_mars_m) / distance_m);
            FromMars {
                irradiance: match self.scene.models.mars_light {
                    MarsModel::NearField => light.irradiance(centroid_m, normal),
                    MarsModel::Thesis => mars::thesis_irradiance(1.0, 1.0, sin_radius, cos_tilt),
                },
                heat_w_m2: mars.thermal_exitance_w_m2 * mars::uniform_sphere_form_factor(sin_radius, cos_tilt),
            }
        });
        ((sun, mars.irradiance), self.temperatures_k(f, sun, &mars))
    }

    fn temperatures_k(&self, f: usize, sun: f64, mars: &FromMars) -> (f64, f64) {
        match self.scene.models.thermal {
            Thermal::Off => (0.0, 0.0),
            Thermal::Thesis => (heat::thesis_temperature_k(sun), heat::thesis_temperature_k(0.0)),
            Thermal::Equilibrium => {
                let material = &self.scene.body.materials[self.scene.body.mesh.material[f].0 as usize];
                let (absorptance, emissivity) = (1.0 - material.bond_albedo, material.emissivity_bolometric);
                // Sunlight that Mars reflects, taken to be of the Sun's colour, and its own heat.
                let bond_albedo = self.scene.sky.mars.as_ref().map_or(0.0, |m| m.bond_albedo);
                let reflected = bond_albedo * mars.irradiance * self.sun_w_m2;
                let shaded = absorptance * reflected + emissivity * mars.heat_w_m2;
                let lit = absorptance * self.sun_w_m2 * sun + shaded;
                (heat::equilibrium_temperature_k(lit, emissivity), heat::equilibrium_temperature_k(shaded, emissivity))
            }
        }
    }
}

/// What Mars sends to a facet.
#[derive(Default)]
struct FromMars {
    /// Over Mars' reflectance times the solar irradiance normal to the beam.
    irradiance: f64,
    heat_w_m2: f64,
}
