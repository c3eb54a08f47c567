//! How the facets of a recipe are spent.

use super::boulder::{Boulder, boulders};
use super::recipe::Recipe;
use crate::error::{Location, Problem};
use crate::geometry::{whole, whole_u32};

/// Largest [`Ball`](super::boulder::Ball) a boulder is cut from: 320 facets.
pub(super) const FINEST: u32 = 4;

/// Boulders smaller than this many grid steps are left out: a facet of the ground would swallow them.
const SMALLEST_STEPS: f64 = 0.25;

/// What the ground and the boulders get.
#[derive(Debug, Clone)]
pub(super) struct Division {
    /// Grid cells of the ground, west to east and south to north; two facets each.
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// The boulders that are kept, each with the frequency of its ball.
    pub(super) boulders: Vec<(Boulder, u32)>,
}

/// Spacing of the grid if there were no boulders, m: what decides how fine anything is made.
pub(super) fn step_m(recipe: &Recipe) -> f64 {
    recipe.size_m / (0.5 * f64::from(recipe.facets)).sqrt()
}

/// Distributes the facets, or reports everything that is wrong with the recipe.
///
/// A boulder's facets are about as large as the ground's, 20 at least and 320 at most. Where boulders would take more
/// than half of all facets, the large ones get fewer.
pub(super) fn divide(recipe: &Recipe) -> Result<Division, Vec<Problem>> {
    let problems = recipe.out_of_range();
    if !problems.is_empty() {
        return Err(problems);
    }
    let step_m = step_m(recipe);
    let all = u64::from(recipe.facets);
    let kept: Vec<Boulder> = boulders(&recipe.boulders, recipe.seed, recipe.size_m)
        .filter(|boulder| boulder.diameter_m >= SMALLEST_STEPS * step_m)
        .collect();
    let frequency = |boulder: &Boulder, finest: u32| whole_u32((boulder.diameter_m / step_m).ceil()).clamp(1, finest);
    let spent = |finest: u32| kept.iter().map(|b| 20 * u64::from(frequency(b, finest)).pow(2)).sum::<u64>();
    let Some(finest) = (1..=FINEST).rev().find(|&finest| spent(finest) <= all / 2) else {
        let message = format!(
            "{} boulders of 20 facets each need {} facets, more than half of recipe.facets = {all}",
            kept.len(),
            spent(1)
        );
        let problem = Problem::new(Location::item("recipe.boulders.count"), message);
        return Err(vec![problem.with_help("ask for fewer boulders or for more facets")]);
    };
    // Rows and columns may differ by a few, to come closer to the facets asked for.
    let cells = (all - spent(finest)) / 2;
    let rows = (cells as f64).sqrt().floor();
    let columns = (cells as f64 / rows).round();
    let frequencies: Vec<u32> = kept.iter().map(|boulder| frequency(boulder, finest)).collect();
    let boulders = kept.into_iter().zip(frequencies).collect();
    Ok(Division { columns: whole(columns), rows: whole(rows), boulders })
}

impl Recipe {
    /// Everything that [`generate`](super::generate) would refuse, each problem at `recipe.key`.
    pub fn check(&self) -> Vec<Problem> {
        divide(self).err().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_facets_asked_for_are_met() {
        let mut seen = 0;
        for facets in [1000, 1001, 1111, 5000, 9999, 10_001, 123_457, 200_000, 1_000_000, 2_000_000, 4_000_000] {
            let division = divide(&Recipe { facets, ..Recipe::new(1) }).unwrap();
            let boulders: u32 = division.boulders.iter().map(|(_, frequency)| 20 * frequency * frequency).sum();
            let made = f64::from(boulders) + 2.0 * (division.rows * division.columns) as f64;
            let tolerance = if facets < 10_000 { 0.03 } else { 0.01 };
            assert!((made / f64::from(facets) - 1.0).abs() < tolerance, "{facets}: {made}");
            assert!(made <= 4.003e6 && division.columns.abs_diff(division.rows) <= 3);
            assert!(boulders <= facets / 2);
            seen += 1;
        }
        assert_eq!(seen, 11);
    }

    #[test]
    fn boulders_are_dropped_and_coarsened_with_the_grid() {
        let recipe = |facets| Recipe { facets, ..Recipe::new(1) };
        // Grid steps of 89, 6.3 and 2 m against boulders of 2 to 12 m.
        let [coarse, middle, fine] = [1000, 200_000, 2_000_000].map(|facets| divide(&recipe(facets)).unwrap().boulders);
        assert_eq!((coarse.len(), middle.len(), fine.len()), (0, 3000, 3000));
        let finest = |boulders: &[(Boulder, u32)]| boulders.iter().map(|b| b.1).max().unwrap();
        assert_eq!((finest(&middle), finest(&fine)), (2, 4));
        for (a, b) in middle.iter().zip(&fine) {
            assert_eq!((a.0.x_m, a.0.y_m, a.0.diameter_m), (b.0.x_m, b.0.y_m, b.0.diameter_m));
            assert!(a.1 <= b.1);
        }
    }
}
