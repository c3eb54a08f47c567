//! Scene to facet table: what each source sends to each facet, which part of it the source sees, how warm it is. No radiance,
//! except to answer the image's question: what does a facet send [towards an observer](Emission)?

mod between;
mod conduction;
mod eclipse;
mod emission;
mod exchange;
mod facet_radiance;
mod irradiance;
mod mars_shadows;
mod shadows;
mod terrain;

use crate::error::Result;
use crate::product::FacetTable;
use crate::progress::{Watch, tell};
use crate::scene::{Models, Scene, Surface, Thermal};
use crate::visibility::Seen;

pub use between::between;
pub use eclipse::is_eclipsed;
pub use emission::{Emission, Fragment, ImagePart, Modulation, Observer, interpolation_error};
pub use exchange::spectra_error;
pub use facet_radiance::FacetRadiance;
pub use shadows::lit;
pub use terrain::Terrain;

/// Irradiance, lit polygons and temperature of every facet.
///
/// # Errors
/// [`Error::Unsupported`](crate::Error::Unsupported), as [`Setup::simulable`](crate::scene::Setup::simulable) says;
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn solve(scene: &Scene, watch: Watch<'_>) -> Result<FacetTable> {
    filled(scene, lit(scene, watch)?, watch)
}

/// The same with what the Sun sees of each facet as it is given, by coarser means than exact ones.
///
/// # Errors
/// As [`solve`].
pub fn solve_sunlit(scene: &Scene, sunlit: Seen, watch: Watch<'_>) -> Result<FacetTable> {
    filled(scene, shadows::lit_as(scene, (Some(sunlit), &Terrain::of(scene)), watch)?, watch)
}

/// The same of a scene whose body is a part of another, which stands in its light. What facets send each other, and what they store, asks for all of them:
/// there is none of it here.
///
/// # Errors
/// As [`solve`].
pub fn solve_part(scene: &Scene, terrain: &Terrain<'_>, watch: Watch<'_>) -> Result<FacetTable> {
    let mut table = shadows::lit_as(scene, (None, terrain), watch)?;
    irradiance::fill(scene, &mut table);
    keep_floor(scene, &mut table);
    Ok(table)
}

/// Whether a facet's radiance follows from the light on it alone, so that a [part](solve_part) may stand for itself.
pub fn is_local(models: &Models) -> bool {
    models.exchange.is_none() && models.conduction.is_none()
}

fn filled(scene: &Scene, mut table: FacetTable, watch: Watch<'_>) -> Result<FacetTable> {
    tell(watch, "irradiance", 0, 1)?;
    irradiance::fill(scene, &mut table);
    tell(watch, "irradiance", 1, 1)?;
    if let Some(of) = scene.models.exchange {
        exchange::add(scene, &mut table, of, watch)?;
    }
    let day = scene.models.conduction.zip(scene.sky.rotation);
    if let Some(day) = day.filter(|_| scene.models.thermal == Thermal::Equilibrium) {
        conduction::fill(scene, &mut table, day, watch)?;
    }
    keep_floor(scene, &mut table);
    Ok(table)
}

/// The last of all: what keeps a floor up is not what facets send each other, or store. What is held at a temperature has none.
fn keep_floor(scene: &Scene, table: &mut FacetTable) {
    if scene.models.floor_k > 0.0 {
        let Surface { mesh, materials, .. } = &*scene.body;
        for temperatures_k in [&mut table.temperature_lit_k, &mut table.temperature_shaded_k] {
            for (t_k, material) in temperatures_k.iter_mut().zip(&mesh.material) {
                if materials[material.0 as usize].temperature_k.is_none() {
                    *t_k = t_k.max(scene.models.floor_k);
                }
            }
        }
    }
}
