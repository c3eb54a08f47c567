//! What each source sends to each facet, and how warm that makes it.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Facet, index_u32};
use crate::physics::mars_light::MarsLight;
use crate::physics::{heat, mars, sun};
use crate::product::{FacetTable, Sees};
use crate::scene::{Mars, MarsModel, Scene, Source, SourceKind, Thermal};
use crate::visibility::Shown;

/// Facets that are looked at together: what is found of them stays at hand.
const CHUNK: usize = 1024;

/// Fills in irradiances and temperatures.
pub(super) fn fill(scene: &Scene, table: &mut FacetTable) {
    let sky = scene.sky.sources();
    let sources: Vec<Prepared> = sky.iter().map(|source| Prepared::new(scene, source)).collect();
    let mut chunks: Vec<Chunk> = (0..table.facets().div_ceil(CHUNK))
        .map(|i| Chunk { first: i * CHUNK, irradiance: vec![], lit_k: &mut [], shaded_k: &mut [] })
        .collect();
    let mut sees = Vec::new();
    for lighting in &mut table.sources {
        sees.push(&lighting.sees);
        let columns = lighting.irradiance.chunks_mut(CHUNK);
        chunks.iter_mut().zip(columns).for_each(|(chunk, column)| chunk.irradiance.push(column));
    }
    let temperatures = table.temperature_lit_k.chunks_mut(CHUNK).zip(table.temperature_shaded_k.chunks_mut(CHUNK));
    chunks
        .iter_mut()
        .zip(temperatures)
        .for_each(|(chunk, (lit, shaded))| (chunk.lit_k, chunk.shaded_k) = (lit, shaded));
    chunks.into_par_iter().for_each_init(Work::default, |work, chunk| chunk.fill(scene, &sources, &sees, work));
}

/// Some facets that follow one another in the mesh.
struct Chunk<'a> {
    first: usize,
    /// By each source.
    irradiance: Vec<&'a mut [f64]>,
    /// Empty without heat.
    lit_k: &'a mut [f64],
    shaded_k: &'a mut [f64],
}

/// What is found of a chunk's facets on the way.
#[derive(Default)]
struct Work {
    facets: Vec<(Facet, DVec3)>,
    /// Sunlight that other bodies reflect, as irradiance, and their own heat, W m-2, each before it is absorbed.
    reflected_w_m2: Vec<f64>,
    heat_w_m2: Vec<f64>,
}

/// A source, and what is the same for all facets.
enum Prepared<'a> {
    /// Towards it.
    Beam {
        towards: DVec3,
        total_w_m2: f64,
    },
    Sphere {
        mars: &'a Mars,
        light: Box<MarsLight>,
        model: MarsModel,
    },
}

impl<'a> Prepared<'a> {
    fn new(scene: &Scene, source: &Source<'a>) -> Self {
        match source.kind {
            SourceKind::Beam(total_w_m2) => Prepared::Beam { towards: source.field.towards(DVec3::ZERO), total_w_m2 },
            SourceKind::Sphere(mars) => {
                let (low_m, high_m) = scene.body.bounds_m().unwrap_or_default();
                let light = MarsLight::new(mars.centre_m, mars.radius_m, scene.sky.sun.direction, low_m, high_m);
                Prepared::Sphere { mars, light: Box::new(light), model: scene.models.mars_light }
            }
        }
    }
}

impl Chunk<'_> {
    fn fill(mut self, scene: &Scene, sources: &[Prepared], sees: &[&Sees], work: &mut Work) {
        let Work { facets, reflected_w_m2, heat_w_m2 } = work;
        let count = self.irradiance.first().map_or(0, |column| column.len());
        facets.clear();
        let facet = |f| scene.body.mesh.facet(f);
        facets.extend((self.first..self.first + count).map(facet).map(|facet| (facet, facet.normal())));
        for sums in [&mut *reflected_w_m2, &mut *heat_w_m2] {
            sums.clear();
            sums.resize(count, 0.0);
        }
        let sun_w_m2 = scene.sky.sun.total_irradiance_w_m2();
        for (i, ((source, sees), column)) in sources.iter().zip(sees).zip(&mut self.irradiance).enumerate() {
            match source {
                Prepared::Beam { towards, total_w_m2 } => {
                    let is_seen = |f: usize| match sees {
                        Sees::Polygons(seen) => seen.shown[f] != Shown::Nothing,
                        Sees::All | Sees::Shares(_) => true,
                    };
                    for (k, ((_, normal), irradiance)) in facets.iter().zip(column.iter_mut()).enumerate() {
                        // Exact predicates found the facet lit; its rounded cosine may still be a hair below 0.
                        let cos = if is_seen(self.first + k) { normal.dot(*towards) } else { 0.0 };
                        *irradiance = sun::irradiance_on_facet(1.0, cos);
                    }
                    // Lit and shaded states are the Sun's; of other beams facets have their share.
                    if i > 0 {
                        for (k, (sum, irradiance)) in reflected_w_m2.iter_mut().zip(column.iter()).enumerate() {
                            if *irradiance > 0.0 {
                                *sum += total_w_m2 * irradiance * share(sees, self.first + k);
                            }
                        }
                    }
                }
                Prepared::Sphere { mars, light, model } => {
                    for (k, ((facet, normal), irradiance)) in facets.iter().zip(column.iter_mut()).enumerate() {
                        let centroid_m = facet.centroid_m();
                        let to_mars_m = mars.centre_m - centroid_m;
                        let distance_m = to_mars_m.length();
                        let (sin_radius, cos_tilt) = (mars.radius_m / distance_m, normal.dot(to_mars_m) / distance_m);
                        *irradiance = match model {
                            MarsModel::NearField => light.irradiance(centroid_m, *normal),
                            MarsModel::Thesis => mars::thesis_irradiance(1.0, 1.0, sin_radius, cos_tilt),
                        };
                        // Sunlight that Mars reflects is taken to be of the Sun's colour.
                        reflected_w_m2[k] += mars.bond_albedo * *irradiance * sun_w_m2;
                        heat_w_m2[k] +=
                            mars.thermal_exitance_w_m2 * mars::uniform_sphere_form_factor(sin_radius, cos_tilt);
                    }
                }
            }
        }
        let Some(sunlight) = self.irradiance.first() else { return };
        match scene.models.thermal {
            Thermal::Off => {}
            Thermal::Thesis => {
                for (k, (lit_k, shaded_k)) in self.lit_k.iter_mut().zip(self.shaded_k).enumerate() {
                    *lit_k = heat::thesis_temperature_k(sunlight[k]);
                    *shaded_k = heat::thesis_temperature_k(0.0);
                }
            }
            Thermal::Equilibrium => {
                for (k, (lit_k, shaded_k)) in self.lit_k.iter_mut().zip(self.shaded_k).enumerate() {
                    let material = scene.body.mesh.material[self.first + k].0 as usize;
                    let material = &scene.body.materials[material];
                    let (absorptance, emissivity) = (1.0 - material.bond_albedo, material.emissivity_bolometric);
                    let shaded = absorptance * reflected_w_m2[k] + emissivity * heat_w_m2[k];
                    let lit = absorptance * sun_w_m2 * sunlight[k] + shaded;
                    *lit_k = heat::equilibrium_temperature_k(lit, emissivity);
                    *shaded_k = heat::equilibrium_temperature_k(shaded, emissivity);
                }
            }
        }
    }
}

/// Share of a facet that a source sees.
fn share(sees: &Sees, facet: usize) -> f64 {
    match sees {
        Sees::All => 1.0,
        Sees::Shares(shares) => shares[facet],
        // A facet's number is below 2^29.
        Sees::Polygons(seen) => seen.fraction(index_u32(facet)),
    }
}
