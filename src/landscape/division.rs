//! How the facets of a recipe are spent.

use super::boulder::Boulder;
use super::layout::{Grading, Layout};
use super::recipe::Recipe;
use crate::error::Problem;
use crate::geometry::{whole, whole_u32};

/// Largest [`Ball`](super::boulder::Ball) a boulder is cut from: 320 facets.
pub(super) const FINEST: u32 = 4;

/// Boulders smaller than this many grid steps are left out: a facet of the ground would swallow them.
const SMALLEST_STEPS: f64 = 0.25;

/// Halvings after which a step is known to the last digit.
const HALVINGS: usize = 60;

/// Rows and columns that the grid may have more or less, to come closer to the facets asked for.
const SPARE: usize = 4;

/// Steps that are tried to either side of the one found, 0.5 % apart.
const STEPS_ASIDE: u32 = 20;

/// What the ground and the boulders get.
#[derive(Debug, Clone)]
pub(super) struct Division {
    pub(super) grading: Grading,
    pub(super) layout: Layout,
    /// Frequency of each boulder's ball; 0 if it is left out.
    pub(super) frequencies: Vec<u32>,
}

/// Distributes the facets.
///
/// A boulder's facets are about as large as the ground's around it, 20 at least and 320 at most. Where boulders would take more
/// than half of all facets, the large ones get fewer.
///
/// # Errors
/// If even 20 facets for each boulder are more than half of all.
pub(super) fn divide(recipe: &Recipe, boulders: &[Boulder]) -> Result<Division, Problem> {
    let all = u64::from(recipe.facets);
    let grading = graded(recipe, |grading| spent(boulders, grading, all).unwrap_or(0));
    let Some(finest) = finest(boulders, &grading, all) else {
        let kept = frequencies(boulders, &grading, 1).filter(|f| *f > 0).count();
        let message = format!(
            "{kept} boulders of 20 facets each need {} facets, more than half of recipe.facets = {all}",
            20 * kept
        );
        let largest = recipe.boulders.iter().enumerate().max_by_key(|(_, b)| b.count).map_or(0, |(i, _)| i);
        return Err(super::check::at(&format!("boulders[{largest}].count"), message)
            .with_help("ask for fewer boulders or for more facets"));
    };
    let frequencies: Vec<u32> = frequencies(boulders, &grading, finest).collect();
    let boulders: u64 = frequencies.iter().map(|f| 20 * u64::from(*f).pow(2)).sum();
    // Boulders become finer by leaps: what a leap leaves is the ground's.
    let grading = graded(recipe, |_| boulders);
    // Rings come and go by leaps, too, which a few facets in all cannot make up for: then steps a little off do.
    let tried = (0..=STEPS_ASIDE).flat_map(|i| [1.0 + 0.005 * f64::from(i), 1.0 - 0.005 * f64::from(i)]);
    let mut best: Option<(u64, Grading, [usize; 2])> = None;
    for aside in tried {
        let grading = grading.with_step_m(grading.step_m * aside);
        let (off, grid) = nearest_grid(&grading, boulders, all);
        if best.as_ref().is_none_or(|(least, ..)| off < *least) {
            best = Some((off, grading, grid));
        }
        if off <= all / 1000 {
            break;
        }
    }
    let (grading, [columns, rows]) = best.map_or((grading, [1, 1]), |(_, grading, grid)| (grading, grid));
    Ok(Division { layout: grading.layout(columns, rows), grading, frequencies })
}

/// The grid with which the facets come closest to those asked for, and by how many they are off, 1 per mille being as good as none.
fn nearest_grid(grading: &Grading, boulders: u64, all: u64) -> (u64, [usize; 2]) {
    // Of the grids near the one that the step gives, the one that comes closest, and of those the one nearest to square cells.
    let cells = whole((2.0 * grading.core_m / grading.step_m).round());
    let spare = SPARE.max(cells / 10);
    let near = cells.saturating_sub(spare).max(1)..=cells + spare;
    // Of the strips only the first depends on the grid: it has a facet for each cell of its border.
    let around = grading.layout(1, 1);
    let (strips, each) = if around.rings.len() > 1 { (around.strip_facets() as u64 - 4, 2) } else { (0, 0) };
    let facets = |columns: usize, rows: usize| {
        boulders + strips + 2 * (columns as u64) * (rows as u64) + each * (columns + rows) as u64
    };
    let grids = near.clone().flat_map(|columns| near.clone().map(move |rows| (columns, rows)));
    // 1 per mille off is as good as none.
    let off = |columns: usize, rows: usize| facets(columns, rows).abs_diff(all).max(all / 1000);
    let best = grids.min_by_key(|&(columns, rows)| (off(columns, rows), columns.abs_diff(rows), columns));
    let (columns, rows) = best.unwrap_or((cells, cells));
    (off(columns, rows), [columns, rows])
}

/// The grading whose facets, with those that something else takes, are as many as asked for.
fn graded(recipe: &Recipe, taken: impl Fn(&Grading) -> u64) -> Grading {
    // Wider steps need fewer facets; between these two lies what is asked for.
    let (mut fine_m, mut coarse_m) = (1e-3 * recipe.size_m / f64::from(recipe.facets).sqrt(), recipe.size_m);
    for _ in 0..HALVINGS {
        let step_m = (fine_m * coarse_m).sqrt();
        let grading = Grading::new(recipe, step_m);
        let is_fine = ground(&grading) + taken(&grading) as f64 > f64::from(recipe.facets);
        *(if is_fine { &mut fine_m } else { &mut coarse_m }) = step_m;
    }
    Grading::new(recipe, coarse_m)
}

/// Facets of the ground, with shares of cells.
fn ground(grading: &Grading) -> f64 {
    let cells = 2.0 * grading.core_m / grading.step_m;
    let side = whole(cells).max(1);
    2.0 * cells * cells + grading.layout(side, side).strip_facets() as f64
}

/// The frequency of each boulder's ball, if no more than `finest`.
fn frequencies(boulders: &[Boulder], grading: &Grading, finest: u32) -> impl Iterator<Item = u32> {
    boulders.iter().map(move |boulder| {
        let steps = boulder.diameter_m / grading.step_at_m(boulder.x_m, boulder.y_m);
        if steps < SMALLEST_STEPS { 0 } else { whole_u32(steps.ceil()).clamp(1, finest) }
    })
}

/// The finest balls that leave the ground half of all facets.
fn finest(boulders: &[Boulder], grading: &Grading, all: u64) -> Option<u32> {
    let spent = |finest: u32| frequencies(boulders, grading, finest).map(|f| 20 * u64::from(f).pow(2)).sum::<u64>();
    (1..=FINEST).rev().find(|&finest| spent(finest) <= all / 2)
}

/// Facets of the boulders; none if they are more than half of all.
fn spent(boulders: &[Boulder], grading: &Grading, all: u64) -> Option<u64> {
    let finest = finest(boulders, grading, all)?;
    Some(frequencies(boulders, grading, finest).map(|f| 20 * u64::from(f).pow(2)).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::recipe::{Detail, Surroundings};

    fn boulders(count: u32) -> Vec<Boulder> {
        let recipe = Recipe::new(1);
        let mut all = crate::landscape::boulder::all(&recipe, &|_, _, _| 1.0).unwrap();
        all.truncate(count as usize);
        all
    }

    #[test]
    fn the_facets_asked_for_are_met() {
        let detail = Some(Detail { x_m: 100.0, y_m: -300.0, size_m: 500.0, growth: 0.1 });
        let surroundings = Some(Surroundings { reach_m: 5000.0, growth: 0.15 });
        let boulders = boulders(3000);
        let mut seen = 0;
        for facets in [1000, 1001, 1111, 5000, 9999, 10_001, 123_457, 200_000, 1_000_000, 2_000_000, 4_000_000] {
            for (detail, surroundings) in
                [(&None, &None), (&detail, &None), (&None, &surroundings), (&detail, &surroundings)]
            {
                let recipe =
                    Recipe { facets, detail: detail.clone(), surroundings: surroundings.clone(), ..Recipe::new(1) };
                let division = divide(&recipe, &boulders).unwrap();
                let spent: u32 = division.frequencies.iter().map(|f| 20 * f * f).sum();
                let made = f64::from(spent) + division.layout.facets() as f64;
                assert!((made / f64::from(facets) - 1.0).abs() < 0.01, "{facets} {detail:?} {surroundings:?}: {made}");
                assert!(spent <= facets / 2);
                seen += 1;
            }
        }
        assert_eq!(seen, 44);
        // The fewest that there can be, one by one.
        for facets in 1000..1500 {
            for (detail, surroundings) in [(&detail, &None), (&None, &surroundings), (&detail, &surroundings)] {
                let recipe =
                    Recipe { facets, detail: detail.clone(), surroundings: surroundings.clone(), ..Recipe::new(1) };
                let made = divide(&recipe, &[]).unwrap().layout.facets() as f64;
                assert!((made / f64::from(facets) - 1.0).abs() < 0.01, "{facets} {detail:?} {surroundings:?}: {made}");
            }
        }
    }

    #[test]
    fn boulders_of_one_size_leap_and_the_facets_asked_for_are_met() {
        let mut all = boulders(400);
        all.iter_mut().for_each(|b| b.diameter_m = 8.0);
        for facets in (17_000..200_000).step_by(1777) {
            let division = divide(&Recipe { facets, ..Recipe::new(1) }, &all).unwrap();
            let spent: u32 = division.frequencies.iter().map(|f| 20 * f * f).sum();
            let made = f64::from(spent) + division.layout.facets() as f64;
            assert!((made / f64::from(facets) - 1.0).abs() < 0.01, "{facets}: {made}");
        }
    }

    #[test]
    fn boulders_are_dropped_and_coarsened_with_the_grid() {
        let boulders = boulders(3000);
        let recipe = |facets| Recipe { facets, ..Recipe::new(1) };
        // Grid steps of 89, 6.3 and 2 m against boulders of 2 to 12 m.
        let [coarse, middle, fine] =
            [1000, 200_000, 2_000_000].map(|facets| divide(&recipe(facets), &boulders).unwrap().frequencies);
        let kept = |frequencies: &[u32]| frequencies.iter().filter(|f| **f > 0).count();
        assert_eq!((kept(&coarse), kept(&fine)), (0, 3000));
        let finest = |frequencies: &[u32]| frequencies.iter().copied().max().unwrap();
        assert_eq!((finest(&middle), finest(&fine)), (2, 4));
        assert!(middle.iter().zip(&fine).all(|(a, b)| a <= b));
    }
}
