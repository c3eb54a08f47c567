//! Terrain between facets and Mars, or another body of the sky: the share of its light that reaches each facet.

use glam::DVec3;
use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::{Direction, index_u32};
use crate::physics::mars_points::{MarsPoint, lit_points};
use crate::physics::sun_disc::DiscRule;
use crate::progress::Watch;
use crate::scene::{Globe, Scene};
use crate::visibility::Seen;

/// Of each facet, the share that terrain leaves of what of a globe's light is above its horizon: seen from the middle of the scene, the globe's parts are
/// in the same directions for all facets.
pub(super) fn shares(scene: &Scene, globe: &Globe, rule: DiscRule, watch: Watch<'_>) -> Result<Vec<f64>> {
    let mesh = &scene.body.mesh;
    let (low_m, high_m) = scene.body.bounds_m().unwrap_or_default();
    let to_centre_m = globe.centre_m - 0.5 * (low_m + high_m);
    // Light that meets each facet: with terrain, and without.
    let mut sums = vec![[0.0; 2]; mesh.facets.len()];
    for MarsPoint { towards, light } in lit_points(to_centre_m, globe.radius_m, scene.sky.sun_on(globe).direction, rule)
    {
        let Some(direction) = Direction::new(towards) else { continue };
        let seen = Seen::from_afar(mesh, scene.body.topology(), direction, "Mars-light", watch)?;
        sums.par_iter_mut().enumerate().with_min_len(4096).for_each(|(facet, [some, all])| {
            let of_part = light * normal(scene, facet).dot(towards).max(0.0);
            *some += of_part * seen.fraction(index_u32(facet)).min(1.0);
            *all += of_part;
        });
    }
    // Below the horizon of all parts there is next to no light.
    Ok(sums.into_iter().map(|[some, all]| if all > 0.0 { some / all } else { 1.0 }).collect())
}

/// The fewest parts of Mars with which no facet that a straight horizon crosses is off by more than `tolerance`, and by how much one may be, relative
/// to a sunlit surface; `mars_light` is the most Mars-light there is, relative to the same. `None` where terrain may as well be left out. Costs nothing.
pub fn mars_parts(mars_light: f64, tolerance: f64) -> (Option<DiscRule>, f64) {
    if mars_light <= tolerance {
        return (None, mars_light);
    }
    let bounds = || DiscRule::ALL.into_iter().map(|rule| (rule, mars_light * rule.share_error()));
    let fewest = bounds().filter(|(_, bound)| *bound <= tolerance).min_by_key(|(rule, _)| rule.count());
    let nearest = || bounds().min_by(|a, b| a.1.total_cmp(&b.1));
    fewest.or_else(nearest).map_or((None, mars_light), |(rule, bound)| (Some(rule), bound))
}

fn normal(scene: &Scene, facet: usize) -> DVec3 {
    scene.body.mesh.facet(facet).cross_m2().normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_follow_from_a_tolerance() {
        assert_eq!(mars_parts(1e-4, 1e-3), (None, 1e-4));
        let (some, bound) = mars_parts(0.03, 0.01);
        assert!(some.is_some_and(|rule| (3..=12).contains(&rule.count())) && bound <= 0.01);
        let (most, bound) = mars_parts(1.0, 1e-9);
        assert!(most.is_some_and(|rule| rule.count() >= 37) && bound > 1e-9 && bound < 0.1);
    }
}
