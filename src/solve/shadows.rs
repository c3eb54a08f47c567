//! Where each source lights what of each facet, and where it leaves a shadow: what it does not see, by `visibility::Seen`.
//!
//! Of a source as wide as the Sun's disc each part sees by itself: penumbra is several sources where now there is one.

use crate::error::Result;
use crate::product::{FacetTable, Lighting, Sees};
use crate::progress::Watch;
use crate::scene::{Scene, Sky, Source, SourceKind, Thermal};
use crate::visibility::Seen;

/// Where every facet is lit, and nothing else: irradiances and temperatures are 0. That is all that radiance from elsewhere leaves to
/// be asked.
///
/// # Errors
/// As [`solve`](super::solve).
pub fn lit(scene: &Scene, watch: Watch<'_>) -> Result<FacetTable> {
    scene.simulable()?;
    scene.body.topology_watched(watch)?;
    let facets = scene.body.mesh.facets.len();
    let lighting = |source: Source| {
        Ok(Lighting {
            source: source.name.to_owned(),
            field: source.field,
            irradiance: vec![0.0; facets],
            sees: sees(scene, &source, watch)?,
        })
    };
    let sources = scene.sky.sources().into_iter().map(lighting).collect::<Result<_>>()?;
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
    let seen = Seen::from_afar(&scene.body.mesh, scene.body.topology(), towards, stage, watch)?;
    Ok(Sees::Polygons(seen))
}
