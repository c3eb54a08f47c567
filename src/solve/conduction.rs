//! Temperatures of ground that stores heat: each facet's own column, under the Sun of a day that repeats, shadows moving with it, and bodies of the sky where they then were.

use rayon::prelude::*;

use super::irradiance::share;
use crate::error::Result;
use crate::physics::conduction::Ground;
use crate::physics::heat::emitted_w_m2;
use crate::product::FacetTable;
use crate::progress::{Watch, tell};
use crate::scene::{Models, Rotation, Scene};

/// Columns that are computed together.
const TOGETHER: usize = 8;

/// Replaces equilibrium by conduction, with so many steps of a day, the last of which is now.
///
/// Of each step the scene is solved in equilibrium: what a facet absorbs is what it then emits, of its lit and shaded parts by their shares. One temperature
/// serves a facet, wherever the Sun is now: a shadow's edge has passed over all of it. Facets whose material stores no heat stay in equilibrium.
pub(super) fn fill(
    scene: &Scene,
    table: &mut FacetTable,
    (steps, rotation): (u32, Rotation),
    watch: Watch<'_>,
) -> Result<()> {
    const STAGE: &str = "a day's sunlight";
    let facets = scene.body.mesh.facets.len();
    // Of other times light between facets need not be as good.
    let exchange = scene.models.exchange.map(|of| of.for_share(0.125));
    let models = Models { conduction: None, exchange, floor_k: 0.0, ..scene.models };
    // [step, facet]; seven digits are more than the steps are good for.
    let mut absorbed_w_m2: Vec<f32> = Vec::with_capacity(facets * steps as usize);
    for step in 1..steps {
        tell(watch, STAGE, u64::from(step), u64::from(steps))?;
        let ago_s = rotation.period_s * f64::from(steps - step) / f64::from(steps);
        let then = scene.under(scene.sky.ago(ago_s)?)?.by(models)?;
        // Its own stages are of no interest.
        let within =
            |_| watch(crate::progress::Progress { stage: STAGE, done: u64::from(step), total: u64::from(steps) });
        absorbed_w_m2.extend(absorbed(scene, &super::solve(&then, &within)?));
    }
    absorbed_w_m2.extend(absorbed(scene, table));
    tell(watch, STAGE, u64::from(steps), u64::from(steps))?;
    let mut by_material: Vec<Vec<usize>> = vec![vec![]; scene.body.materials.len()];
    scene
        .body
        .mesh
        .material
        .iter()
        .enumerate()
        .for_each(|(facet, material)| by_material[material.0 as usize].push(facet));
    tell(watch, "conduction", 0, 1)?;
    for (material, facets_of) in scene.body.materials.iter().zip(&by_material) {
        if material.thermal_inertia <= 0.0 || material.temperature_k.is_some() {
            continue;
        }
        let ground = Ground {
            thermal_inertia: material.thermal_inertia,
            emissivity_bolometric: material.emissivity_bolometric,
            period_s: rotation.period_s,
        };
        let of_chunk = |chunk: &[usize]| {
            let of_step = |step: usize| -> [f64; TOGETHER] {
                // The last chunk may have places to spare.
                std::array::from_fn(|n| chunk.get(n).map_or(0.0, |f| f64::from(absorbed_w_m2[step * facets + f])))
            };
            let day: Vec<[f64; TOGETHER]> = (0..steps as usize).map(of_step).collect();
            ground.periodic_temperatures_k(&day).last().copied().unwrap_or_default()
        };
        let now_k: Vec<[f64; TOGETHER]> = facets_of.par_chunks(TOGETHER).map(of_chunk).collect();
        for (facet, t_k) in facets_of.iter().zip(now_k.as_flattened()) {
            table.temperature_lit_k[*facet] = *t_k;
            table.temperature_shaded_k[*facet] = *t_k;
        }
    }
    tell(watch, "conduction", 1, 1)
}

/// What each facet absorbs, W m-2: in equilibrium, what it emits.
fn absorbed(scene: &Scene, table: &FacetTable) -> Vec<f32> {
    let of = |facet: usize| {
        let material = &scene.body.materials[scene.body.mesh.material[facet].0 as usize];
        let lit = table.sources.first().map_or(0.0, |sun| share(&sun.sees, facet).min(1.0));
        let of_part = |t_k: f64| emitted_w_m2(t_k, material.emissivity_bolometric);
        let emitted =
            lit * of_part(table.temperature_lit_k[facet]) + (1.0 - lit) * of_part(table.temperature_shaded_k[facet]);
        #[expect(clippy::cast_possible_truncation, reason = "seven digits are enough")]
        let rounded = emitted as f32;
        rounded
    };
    (0..table.facets()).into_par_iter().map(of).collect()
}
