//! Scene to facet table: what each source sends to each facet, which part of it the source sees, how warm it is. No radiance,
//! except to answer the image's question: what does a facet send [towards an observer](Emission)?

mod emission;
mod irradiance;

use crate::error::Result;
use crate::product::{FacetTable, Lighting, Sees};
use crate::progress::{Watch, tell};
use crate::scene::{Scene, Sky, Source, SourceKind, Thermal};
use crate::visibility::Seen;

pub use emission::{Emission, Fragment, ImagePart, Modulation, interpolation_error};

/// Irradiance, lit polygons and temperature of every facet.
///
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported), as [`Setup::simulable`](crate::scene::Setup::simulable) says;
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn solve(scene: &Scene, watch: Watch<'_>) -> Result<FacetTable> {
    let mut table = lit(scene, watch)?;
    tell(watch, "irradiance", 0, 1)?;
    irradiance::fill(scene, &mut table);
    tell(watch, "irradiance", 1, 1)?;
    Ok(table)
}

/// Where every facet is lit, and nothing else: irradiances and temperatures are 0. That is all that radiance from elsewhere leaves to
/// be asked.
///
/// # Errors
/// As [`solve`].
pub fn lit(scene: &Scene, watch: Watch<'_>) -> Result<FacetTable> {
    scene.simulable()?;
    // Found here at the latest: a stage of its own, and not the first source's work.
    tell(watch, "topology", 0, 1)?;
    let _ = scene.body.topology();
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
    Ok(FacetTable { sources, temperature_lit_k: temperature(), temperature_shaded_k: temperature() })
}

/// What of each facet a source sees.
fn sees(scene: &Scene, source: &Source, watch: Watch<'_>) -> Result<Sees> {
    let (SourceKind::Beam(_), Some(towards)) = (source.kind, source.field.direction()) else { return Ok(Sees::All) };
    let stage = if source.name == Sky::SUN { "sunlight" } else { "beams" };
    let seen = Seen::from_afar(&scene.body.mesh, scene.body.topology(), towards, stage, watch)?;
    Ok(Sees::Polygons(seen))
}
