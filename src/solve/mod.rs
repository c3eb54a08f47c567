//! Scene to facet table: what each source sends to each facet, which part of it the source sees, how warm it is. No radiance,
//! except to answer the image's question: what does a facet send [towards an observer](Emission)?

mod conduction;
mod emission;
mod irradiance;
mod shadows;

use crate::error::Result;
use crate::product::FacetTable;
use crate::progress::{Watch, tell};
use crate::scene::{Scene, Thermal};

pub use emission::{Emission, Fragment, ImagePart, Modulation, interpolation_error};
pub use shadows::lit;

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
    let day = scene.models.conduction.zip(scene.sky.rotation);
    if let Some(day) = day.filter(|_| scene.models.thermal == Thermal::Equilibrium) {
        conduction::fill(scene, &mut table, day, watch)?;
    }
    Ok(table)
}
