//! Where each source lights what of each facet, and where it leaves a shadow: what it does not see, by `visibility::Seen`.
//!
//! Of a source as wide as the Sun's disc each part sees by itself: what they see is put together, with the share of the light on the facet
//! that each part has.

use crate::error::Result;
use crate::geometry::Direction;
use crate::product::{FacetTable, Lighting, Sees};
use crate::progress::Watch;
use crate::scene::{Scene, Sky, Source, SourceKind, SunModel, Thermal};
use crate::visibility::Seen;

/// Where every facet is lit, and nothing else: irradiances and temperatures are 0. That is all that radiance from elsewhere leaves to
/// be asked.
///
/// # Errors
/// As [`solve`](super::solve).
pub fn lit(scene: &Scene, watch: Watch<'_>) -> Result<FacetTable> {
    lit_as(scene, None, watch)
}

/// The same; what the Sun sees of each facet is found, unless it is given.
pub(super) fn lit_as(scene: &Scene, sunlit: Option<Seen>, watch: Watch<'_>) -> Result<FacetTable> {
    scene.simulable()?;
    if sunlit.is_none() {
        scene.body.topology_watched(watch)?;
    }
    let mut sunlit = sunlit;
    let facets = scene.body.mesh.facets.len();
    let mut lighting = |source: Source| {
        let sees = match sunlit.take_if(|_| source.name == Sky::SUN) {
            Some(sunlit) => Sees::Polygons(sunlit),
            None => sees(scene, &source, watch)?,
        };
        Ok(Lighting { source: source.name.to_owned(), field: source.field, irradiance: vec![0.0; facets], sees })
    };
    let sources = scene.sky.sources().into_iter().map(&mut lighting).collect::<Result<_>>()?;
    let temperature = || vec![0.0; if scene.models.thermal == Thermal::Off { 0 } else { facets }];
    Ok(FacetTable {
        sources,
        temperature_lit_k: temperature(),
        temperature_shaded_k: temperature(),
        models: scene.models,
    })
}

/// What of each facet a source sees.
fn sees(scene: &Scene, source: &Source, watch: Watch<'_>) -> Result<Sees> {
    let (SourceKind::Beam(_), Some(towards)) = (source.kind, source.field.direction()) else { return Ok(Sees::All) };
    let stage = if source.name == Sky::SUN { "sunlight" } else { "beams" };
    let seen = |towards| Seen::from_afar(&scene.body.mesh, scene.body.topology(), towards, stage, watch);
    match scene.models.sun {
        SunModel::Disc(rule) if source.name == Sky::SUN => {
            let sub_suns = scene.sky.sun.sub_suns(rule);
            let directions = sub_suns.iter().map(|sub_sun| Direction::new(sub_sun.towards).unwrap_or(towards));
            let eyes = directions.map(seen).collect::<Result<Vec<Seen>>>()?;
            let shares = |facet: u32, shares: &mut [f64]| {
                let normal = scene.body.mesh.facet(facet as usize).cross_m2().normalize_or_zero();
                let mut all = 0.0;
                for (share, sub_sun) in shares.iter_mut().zip(&sub_suns) {
                    *share = sub_sun.irradiance_on_facet(normal);
                    all += *share;
                }
                // Below the horizon of all of them they are 0.
                shares.iter_mut().for_each(|share| *share /= if all > 0.0 { all } else { 1.0 });
            };
            Ok(Sees::Polygons(Seen::together(&eyes, shares)))
        }
        _ => Ok(Sees::Polygons(seen(towards)?)),
    }
}
