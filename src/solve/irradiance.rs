//! What each source sends to each facet, and how warm that makes it.

use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Vectors, index_u32};
use crate::physics::mars_directions::{Directions, SphereSeen, Towards};
use crate::physics::mars_light::MarsLight;
use crate::physics::reflectance::DirectionalAlbedos;
use crate::physics::{heat, mars, sun, sun_disc};
use crate::product::{FacetTable, Sees};
use crate::scene::{Globe, MarsModel, Scene, Sky, Source, SourceKind, SunModel, Thermal};
use crate::visibility::Shown;

use super::eclipse::Eclipse;

/// Facets that are looked at together: what is found of them stays at hand.
const CHUNK: usize = 1024;

/// Fills in irradiances and temperatures.
pub(super) fn fill(scene: &Scene, table: &mut FacetTable) {
    let sky = scene.sources();
    let sources: Vec<Prepared> = sky.iter().map(|source| Prepared::new(scene, source)).collect();
    let mut chunks: Vec<Chunk> = (0..table.facets().div_ceil(CHUNK))
        .map(|i| Chunk { first: i * CHUNK, irradiance: vec![], lit_k: &mut [], shaded_k: &mut [] })
        .collect();
    // In equilibrium a surface with a model absorbs light by its incidence.
    let is_warm = scene.models.thermal == Thermal::Equilibrium;
    let plain = vec![None; scene.body.materials.len()];
    let albedos = if is_warm { scene.body.absorbing() } else { &plain };
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
    let eclipse = Eclipse::of(scene);
    let shared = Shared { scene, sources: &sources, sees: &sees, albedos, eclipse: eclipse.as_ref() };
    chunks.into_par_iter().for_each_init(Work::default, |work, chunk| chunk.fill(&shared, work));
}

/// What all chunks need.
struct Shared<'a> {
    scene: &'a Scene,
    sources: &'a [Prepared<'a>],
    sees: &'a [&'a Sees],
    albedos: &'a [Option<(DirectionalAlbedos, f64)>],
    eclipse: Option<&'a Eclipse<'a>>,
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

/// What is found of a chunk's facets on the way, a column each: loops over columns compute several facets at once.
#[derive(Default)]
struct Work {
    centroids_m: Vectors,
    normals: Vectors,
    /// Sunlight that other bodies reflect, as irradiance, of surfaces with a model times what they absorb of it over what they absorb on average; and
    /// other bodies' own heat; W m-2, each before it is absorbed.
    reflected_w_m2: Vec<f64>,
    heat_w_m2: Vec<f64>,
    absorptance: Vec<f64>,
    sun_absorptance: Vec<f64>,
    emissivity: Vec<f64>,
}

/// A source, and what is the same for all facets.
enum Prepared<'a> {
    /// Towards it.
    Beam {
        towards: DVec3,
        total_w_m2: f64,
    },
    /// The Sun as a disc: towards its middle.
    Disc {
        towards: DVec3,
        sin_radius: f64,
        limb_darkening: f64,
    },
    Glow(&'a Globe),
    Sphere {
        globe: &'a Globe,
        /// Sunlight on it over that at the scene.
        sun_strength: f64,
        /// From there to the Sun.
        sun: DVec3,
        light: Box<MarsLight>,
        model: MarsModel,
    },
}

impl<'a> Prepared<'a> {
    fn new(scene: &Scene, source: &Source<'a>) -> Self {
        match source.kind {
            SourceKind::Beam(_) if source.name == Sky::SUN && scene.models.sun != SunModel::Point => {
                let sun = &scene.sky.sun;
                Prepared::Disc {
                    towards: sun.direction.vec(),
                    sin_radius: sun.sin_radius(),
                    limb_darkening: sun.limb_darkening,
                }
            }
            SourceKind::Beam(total_w_m2) => Prepared::Beam { towards: source.field.towards(DVec3::ZERO), total_w_m2 },
            SourceKind::Glow(globe) => Prepared::Glow(globe),
            SourceKind::Sphere(globe) => {
                let (low_m, high_m) = scene.body.bounds_m().unwrap_or_default();
                let sun = scene.sky.sun_on(globe);
                let light = MarsLight::new(globe.centre_m, globe.radius_m, sun.direction, low_m, high_m);
                // What the thesis has is of Mars.
                let model = if globe.name == Sky::MARS { scene.models.mars_light } else { MarsModel::NearField };
                Prepared::Sphere {
                    globe,
                    sun_strength: sun.strength,
                    sun: sun.direction.vec(),
                    light: Box::new(light),
                    model,
                }
            }
        }
    }
}

impl Chunk<'_> {
    fn fill(mut self, shared: &Shared, work: &mut Work) {
        let Shared { scene, sources, sees, albedos, eclipse } = *shared;
        let Work { centroids_m, normals, reflected_w_m2, heat_w_m2, absorptance, sun_absorptance, emissivity } = work;
        let mesh = &scene.body.mesh;
        let chunk = self.first..self.first + self.irradiance.first().map_or(0, |column| column.len());
        centroids_m.set(chunk.clone().map(|f| mesh.facet(f).centroid_m()));
        normals.set(chunk.clone().map(|f| mesh.facet(f).cross_m2()));
        normals.normalize_or_zero();
        for sums in [&mut *reflected_w_m2, &mut *heat_w_m2] {
            sums.clear();
            sums.resize(chunk.len(), 0.0);
        }
        let sun_w_m2 = scene.sky.sun.total_irradiance_w_m2();
        // Of light at this cosine of incidence a facet absorbs so many times what 1 - its Bond albedo is.
        let (has_models, directions) = (albedos.iter().any(Option::is_some), Directions::new(2));
        let absorbed_more = |f: usize, cos_incidence: f64| {
            let material = mesh.material[f].0 as usize;
            let plain = 1.0 - scene.body.materials[material].bond_albedo;
            match &albedos[material] {
                Some((table, factor)) if plain > 0.0 => {
                    let mut absorbed = plain;
                    table.weights(cos_incidence, |_, weight| absorbed = (1.0 - factor * weight).max(0.0));
                    absorbed / plain
                }
                _ => 1.0,
            }
        };
        for (i, ((source, sees), column)) in sources.iter().zip(sees).zip(&mut self.irradiance).enumerate() {
            match source {
                Prepared::Beam { towards, total_w_m2 } => {
                    // Exact predicates found the facet lit; its rounded cosine may still be a hair below 0.
                    let on_facet = |normal: DVec3| sun::irradiance_on_facet(1.0, normal.dot(*towards));
                    let rows = column.iter_mut().zip(normals.iter());
                    match sees {
                        Sees::Polygons(seen) => {
                            rows.zip(&seen.shown[chunk.clone()]).for_each(|((irradiance, normal), shown)| {
                                *irradiance = if *shown != Shown::Nothing { on_facet(normal) } else { 0.0 };
                            });
                        }
                        Sees::All | Sees::Shares(_) => {
                            rows.for_each(|(irradiance, normal)| *irradiance = on_facet(normal))
                        }
                    }
                    // Lit and shaded states are the Sun's; of other beams facets have their share.
                    if i > 0 {
                        for ((sum, irradiance), f) in reflected_w_m2.iter_mut().zip(column.iter()).zip(chunk.clone()) {
                            if *irradiance > 0.0 {
                                let more = if has_models { absorbed_more(f, *irradiance) } else { 1.0 };
                                *sum += more * (total_w_m2 * irradiance * share(sees, f));
                            }
                        }
                    }
                }
                Prepared::Disc { towards, sin_radius, limb_darkening } => {
                    for ((irradiance, normal), f) in column.iter_mut().zip(normals.iter()).zip(chunk.clone()) {
                        let is_dark = matches!(sees, Sees::Polygons(seen) if seen.shown[f] == Shown::Nothing);
                        let of_disc =
                            || sun_disc::irradiance_on_facet(normal.dot(*towards), *sin_radius, *limb_darkening);
                        *irradiance = if is_dark { 0.0 } else { of_disc() };
                    }
                }
                Prepared::Glow(globe) => {
                    for ((irradiance, centroid_m), normal) in
                        column.iter_mut().zip(centroids_m.iter()).zip(normals.iter())
                    {
                        let to_centre_m = globe.centre_m - centroid_m;
                        let distance_m = to_centre_m.length();
                        let (sin_radius, cos_tilt) =
                            (globe.radius_m / distance_m, normal.dot(to_centre_m) / distance_m);
                        *irradiance = mars::uniform_sphere_form_factor(sin_radius, cos_tilt).max(0.0);
                    }
                }
                Prepared::Sphere { globe, sun_strength, sun, light, model } => {
                    // What it sends warms, whether or not it is to be seen.
                    let warms = scene.models.thermal == Thermal::Equilibrium;
                    if *model == MarsModel::NearField || (*model == MarsModel::Off && warms) {
                        light.irradiances(centroids_m, normals, column);
                    }
                    let vectors = centroids_m.iter().zip(normals.iter());
                    let sums = reflected_w_m2.iter_mut().zip(heat_w_m2.iter_mut());
                    for ((((centroid_m, normal), irradiance), (reflected, heat)), f) in
                        vectors.zip(column.iter_mut()).zip(sums).zip(chunk.clone())
                    {
                        let to_centre_m = globe.centre_m - centroid_m;
                        let distance_m = to_centre_m.length();
                        let (sin_radius, cos_tilt) =
                            (globe.radius_m / distance_m, normal.dot(to_centre_m) / distance_m);
                        if *model == MarsModel::Thesis {
                            *irradiance = mars::thesis_irradiance(1.0, 1.0, sin_radius, cos_tilt);
                        }
                        // Sunlight that a globe reflects is taken to be of the Sun's colour, and terrain to hide as much of its heat.
                        let share = share(sees, f);
                        let form_factor = mars::uniform_sphere_form_factor(sin_radius, cos_tilt);
                        let more = if has_models && *irradiance > 0.0 {
                            let sun = (*model != MarsModel::Thesis).then_some(*sun);
                            let seen = SphereSeen { to_centre_m, radius_m: globe.radius_m, normal, sun };
                            let of = |Towards { direction, share }| share * absorbed_more(f, normal.dot(direction));
                            directions.of(&seen, None).into_iter().map(of).sum()
                        } else {
                            1.0
                        };
                        let sunlight_w_m2 = sun_w_m2 * sun_strength;
                        *reflected += more * (globe.bond_albedo * *irradiance * sunlight_w_m2 * share);
                        *heat += globe.thermal_exitance_w_m2 * form_factor * share;
                    }
                    if *model == MarsModel::Off {
                        column.fill(0.0);
                    }
                }
            }
        }
        let Some(sunlight) = self.irradiance.first_mut() else { return };
        // What is absorbed of it goes by its incidence; so it is looked up before an eclipse takes its part.
        let materials = || mesh.material[chunk.clone()].iter().map(|m| &scene.body.materials[m.0 as usize]);
        if scene.models.thermal == Thermal::Equilibrium {
            absorptance.clear();
            absorptance.extend(materials().map(|material| 1.0 - material.bond_albedo));
            sun_absorptance.clone_from(absorptance);
            if albedos.iter().any(Option::is_some) {
                let facets = mesh.material[chunk.clone()].iter().zip(sunlight.iter()).zip(&mut *sun_absorptance);
                for ((material, cos_incidence), absorptance) in facets {
                    if let Some((table, factor)) = &albedos[material.0 as usize] {
                        table.weights(*cos_incidence, |_, weight| *absorptance = (1.0 - factor * weight).max(0.0));
                    }
                }
            }
        }
        if let Some(eclipse) = eclipse {
            for (irradiance, centroid_m) in sunlight.iter_mut().zip(centroids_m.iter()) {
                *irradiance *= eclipse.share(centroid_m);
            }
        }
        let (lit_column, shaded_column) = (self.lit_k, self.shaded_k);
        let temperatures = lit_column.iter_mut().zip(shaded_column.iter_mut()).zip(sunlight.iter());
        match scene.models.thermal {
            Thermal::Off => {}
            Thermal::Thesis => {
                for ((lit_k, shaded_k), sunlight) in temperatures {
                    *lit_k = heat::thesis_temperature_k(*sunlight);
                    *shaded_k = heat::thesis_temperature_k(0.0);
                }
            }
            Thermal::Equilibrium => {
                emissivity.clear();
                emissivity.extend(materials().map(|material| material.emissivity_bolometric));
                let others = reflected_w_m2.iter().zip(heat_w_m2.iter());
                let surface = absorptance.iter().zip(sun_absorptance.iter()).zip(emissivity.iter());
                for ((((lit_k, shaded_k), sunlight), (reflected, heat)), ((absorptance, of_sun), emissivity)) in
                    temperatures.zip(others).zip(surface)
                {
                    let shaded = absorptance * reflected + emissivity * heat;
                    let lit = of_sun * sun_w_m2 * sunlight + shaded;
                    *lit_k = heat::equilibrium_temperature_k(lit, *emissivity);
                    *shaded_k = heat::equilibrium_temperature_k(shaded, *emissivity);
                }
            }
        }
        if scene.body.materials.iter().any(|material| material.temperature_k.is_some()) {
            for ((lit_k, shaded_k), material) in lit_column.iter_mut().zip(shaded_column).zip(materials()) {
                if let Some(held_k) = material.temperature_k {
                    (*lit_k, *shaded_k) = (held_k, held_k);
                }
            }
        }
    }
}

/// Share of a facet that a source sees.
pub(super) fn share(sees: &Sees, facet: usize) -> f64 {
    match sees {
        Sees::All => 1.0,
        Sees::Shares(shares) => shares[facet],
        // A facet's number is below 2^29.
        Sees::Polygons(seen) => seen.fraction(index_u32(facet)),
    }
}
