//! Where each source lights what of each facet, and where it leaves a shadow: what it does not see, by `visibility::Seen`.
//!
//! Of a source as wide as the Sun's disc each part sees by itself: what they see is put together, with the share of the light on the facet
//! that each part has.

use glam::DVec3;
use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::Direction;
use crate::physics::sun_disc::SubSun;
use crate::product::{FacetTable, Lighting, Sees};
use crate::progress::Watch;
use crate::scene::{Scene, Sky, Source, SourceKind, SunModel, Thermal};
use crate::visibility::{Seen, Shown};

use super::eclipse::Eclipse;
use super::mars_shadows;
use super::terrain::Terrain;

/// Where every facet is lit, and nothing else: irradiances and temperatures are 0. That is all that radiance from elsewhere leaves to
/// be asked.
///
/// # Errors
/// As [`solve`](super::solve).
pub fn lit(scene: &Scene, watch: Watch<'_>) -> Result<FacetTable> {
    scene.simulable()?;
    scene.body.topology_watched(watch)?;
    lit_as(scene, (None, &Terrain::of(scene)), watch)
}

/// The same, with what hides light from facets; what the Sun sees of each is found, unless it is given.
pub(super) fn lit_as(
    scene: &Scene,
    (sunlit, terrain): (Option<Seen>, &Terrain<'_>),
    watch: Watch<'_>,
) -> Result<FacetTable> {
    scene.simulable()?;
    let mut sunlit = sunlit;
    let facets = scene.body.mesh.facets.len();
    let mut sources: Vec<Lighting> = Vec::new();
    for source in scene.sources() {
        let of_same = match source.kind {
            SourceKind::Glow(globe) => sources.iter().find(|other| other.source == globe.name),
            _ => None,
        };
        let sees = match (sunlit.take_if(|_| source.name == Sky::SUN), of_same) {
            (Some(sunlit), _) => Sees::Polygons(sunlit),
            // Terrain is taken to hide as much of a globe's heat as of its light.
            (None, Some(light)) => light.sees.clone(),
            _ => sees(scene, terrain, &source, watch)?,
        };
        let irradiance = vec![0.0; facets];
        sources.push(Lighting { source: source.name.into_owned(), field: source.field, irradiance, sees });
    }
    let temperature = || vec![0.0; if scene.models.thermal == Thermal::Off { 0 } else { facets }];
    Ok(FacetTable {
        sources,
        temperature_lit_k: temperature(),
        temperature_shaded_k: temperature(),
        reflected: vec![],
        sampling: None,
        models: scene.models,
    })
}

/// What of each facet a source sees.
fn sees(scene: &Scene, terrain: &Terrain<'_>, source: &Source, watch: Watch<'_>) -> Result<Sees> {
    if let (SourceKind::Sphere(globe), Some(rule)) = (source.kind, scene.models.mars_shadows) {
        return Ok(Sees::Shares(mars_shadows::shares(scene, terrain, (globe, rule), watch)?));
    }
    let (SourceKind::Beam(_), Some(towards)) = (source.kind, source.field.direction()) else { return Ok(Sees::All) };
    let stage = if source.name == Sky::SUN { "sunlight" } else { "beams" };
    let seen = |towards| terrain.seen(towards, stage, watch);
    match scene.models.sun {
        SunModel::Disc(rule) if source.name == Sky::SUN => {
            let sub_suns = scene.sky.sun.sub_suns(rule);
            let directions = sub_suns.iter().map(|sub_sun| Direction::new(sub_sun.towards).unwrap_or(towards));
            let eyes = directions.map(seen).collect::<Result<Vec<Seen>>>()?;
            let eclipse = Eclipse::of(scene);
            let shares = |facet: u32, shares: &mut [f64]| {
                let facet = scene.body.mesh.facet(facet as usize);
                let normal = facet.cross_m2().normalize_or_zero();
                let (mut above, mut all) = (0.0, 0.0);
                for (share, sub_sun) in shares.iter_mut().zip(&sub_suns) {
                    *share = sub_sun.irradiance_on_facet(normal);
                    above += *share;
                    // What a body hides has no part in the light that is left.
                    if eclipse.as_ref().is_some_and(|bodies| bodies.hides(facet.centroid_m(), sub_sun.towards)) {
                        *share = 0.0;
                    }
                    all += *share;
                }
                // Between points light may be left: it is taken to come from all of the disc.
                if all == 0.0 && above > 0.0 {
                    shares.iter_mut().zip(&sub_suns).for_each(|(share, sub)| *share = sub.irradiance_on_facet(normal));
                    all = above;
                }
                // Below the horizon of all of them they are 0.
                shares.iter_mut().for_each(|share| *share /= if all > 0.0 { all } else { 1.0 });
            };
            let mut seen = Seen::together(&eyes, shares);
            light_by_limb(scene, &sub_suns, &mut seen);
            Ok(Sees::Polygons(seen))
        }
        _ => Ok(Sees::Polygons(seen(towards)?)),
    }
}

/// Lights facets that all points of the disc are below the horizon of, but not its limb: nobody has seen whether terrain hides that, which on flat and
/// on convex ground it does not.
fn light_by_limb(scene: &Scene, sub_suns: &[SubSun], seen: &mut Seen) {
    let (sun, mesh) = (&scene.sky.sun, &scene.body.mesh);
    let (middle, sin_radius) = (sun.direction.vec(), sun.sin_radius());
    seen.shown.par_iter_mut().enumerate().with_min_len(4096).filter(|(_, shown)| **shown == Shown::Nothing).for_each(
        |(facet, shown)| {
            let normal = mesh.facet(facet).cross_m2().normalize_or_zero();
            let is_near = normal != DVec3::ZERO && normal.dot(middle).abs() < sin_radius;
            if is_near && sub_suns.iter().all(|sub_sun| sub_sun.irradiance_on_facet(normal) == 0.0) {
                *shown = Shown::Whole;
            }
        },
    );
}
