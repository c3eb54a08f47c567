//! Terrain between facets and Mars, or another body of the sky: the share of its light that reaches each facet.

use glam::DVec3;
use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::{Direction, index_u32};
use crate::physics::mars_points::{MarsPoint, lit_points};
use crate::physics::sun_disc::DiscRule;
use crate::progress::Watch;
use crate::scene::{Globe, Scene};

use super::terrain::Terrain;

/// Of each facet, the share that terrain leaves of what of a globe's light is above its horizon: seen from the middle of the scene, the globe's parts are
/// in the same directions for all facets.
pub(super) fn shares(
    scene: &Scene,
    terrain: &Terrain<'_>,
    (globe, rule): (&Globe, DiscRule),
    watch: Watch<'_>,
) -> Result<Vec<f64>> {
    let mesh = &scene.body.mesh;
    let (low_m, high_m) = terrain.body().bounds_m().unwrap_or_default();
    let to_centre_m = globe.centre_m - 0.5 * (low_m + high_m);
    // Light that meets each facet: with terrain, and without.
    let mut sums = vec![[0.0; 2]; mesh.facets.len()];
    for MarsPoint { towards, light } in lit_points(to_centre_m, globe.radius_m, scene.sky.sun_on(globe).direction, rule)
    {
        let Some(direction) = Direction::new(towards) else { continue };
        let seen = terrain.seen(direction, "Mars-light", watch)?;
        sums.par_iter_mut().enumerate().with_min_len(4096).for_each(|(facet, [some, all])| {
            let of_part = light * normal(scene, facet).dot(towards).max(0.0);
            *some += of_part * seen.fraction(index_u32(facet)).min(1.0);
            *all += of_part;
        });
    }
    // Below the horizon of all parts there is next to no light.
    Ok(sums.into_iter().map(|[some, all]| if all > 0.0 { some / all } else { 1.0 }).collect())
}

fn normal(scene: &Scene, facet: usize) -> DVec3 {
    scene.body.mesh.facet(facet).cross_m2().normalize_or_zero()
}
