//! Boulders: where they lie, what they look like, and how they rest on the ground.

mod rest;
mod shape;

use super::check::{self, FARTHEST};
use super::power_law::PowerLaw;
use super::random::{Purpose, key_in};
use super::recipe::{Recipe, Shape};
use crate::error::Problem;
use crate::geometry::whole;
use crate::random::Draws;

pub(super) use rest::rest;
pub(super) use shape::Ball;

/// So many places are tried in vain for the first boulder, and a hundred more for each that has found one.
const TRIES: u64 = 100_000;

/// One boulder of the site, still without a height.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Boulder {
    /// Number of its group.
    pub(super) group: usize,
    /// Where it lies, m.
    pub(super) x_m: f64,
    pub(super) y_m: f64,
    /// Longest axis, m.
    pub(super) diameter_m: f64,
    /// Share of its height that is below the ground.
    pub(super) buried: f64,
    shape: Shape,
    key: u64,
}

/// All boulders of a recipe, group after group; boulder i of a group does not depend on how many there are. `share` says how much of what would lie at a
/// place there is, by the group's number and the place in m.
///
/// # Errors
/// If there is next to no place for them.
pub(super) fn all(recipe: &Recipe, share: &dyn Fn(usize, f64, f64) -> f64) -> Result<Vec<Boulder>, Problem> {
    let mut all = Vec::new();
    for (g, boulders) in recipe.boulders.iter().enumerate() {
        let [least, most] = boulders.buried.ends();
        let boulder = |x_m: f64, y_m: f64, diameter_m: f64, i: u64| {
            let key = key_in(recipe.seed, Purpose::Boulder, g, i);
            // Not of those that say where it lies.
            let buried = Draws::new(key.rotate_left(32)).between(least, most);
            Boulder { group: g, x_m, y_m, diameter_m, buried, shape: boulders.shape, key }
        };
        let number = whole(boulders.number(recipe.area_km2())) as u64;
        let law = PowerLaw::new(boulders.min_diameter_m, boulders.max_diameter_m, boulders.exponent);
        let mut tries = 0;
        for i in 0..number {
            let mut draws = Draws::new(key_in(recipe.seed, Purpose::Boulder, g, i));
            let diameter_m = law.size(draws.unit());
            // None sticks out over the border.
            let half_m = 0.5 * recipe.size_m - FARTHEST * diameter_m;
            let [x_m, y_m] = loop {
                let [x_m, y_m] = [draws.between(-half_m, half_m), draws.between(-half_m, half_m)];
                let share = if boulders.area.is_some() { share(g, x_m, y_m) } else { 1.0 };
                // Where all is there nothing more is drawn: without an area boulders lie where they always did.
                if share >= 1.0 || (share > 0.0 && draws.unit() < share) {
                    break [x_m, y_m];
                }
                tries += 1;
                if tries > TRIES + 100 * i {
                    let message = format!("leaves almost no room: {i} of {} places tried were taken", tries + i);
                    return Err(check::at(&format!("boulders[{g}].where"), message));
                }
            };
            all.push(boulder(x_m, y_m, diameter_m, i));
        }
        let placed = boulders.placed.iter().zip(number..);
        all.extend(placed.map(|(p, i)| boulder(p.x_m, p.y_m, p.diameter_m, i)));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_boulders_leave_the_first_where_they_were_and_areas_choose() {
        let mut recipe = Recipe { craters: vec![], ..Recipe::new(9) };
        let many = all(&recipe, &|_, _, _| unreachable!()).unwrap();
        recipe.boulders[0].count = 50;
        let few = all(&recipe, &|_, _, _| unreachable!()).unwrap();
        assert_eq!((many.len(), few.len()), (3000, 50));
        assert_eq!(few[..], many[..50]);
        assert!(many.iter().all(|b| (2.0..=12.0).contains(&b.diameter_m)));
        assert!(many.iter().all(|b| b.x_m.abs().max(b.y_m.abs()) + 0.65 * b.diameter_m <= 1000.0));

        // All in the east, and of the north three times as many as of the south.
        recipe.boulders[0].count = 2000;
        recipe.boulders[0].area = Some(Default::default());
        let share = |_: usize, x_m: f64, y_m: f64| {
            if x_m < 0.0 {
                0.0
            } else if y_m < 0.0 {
                0.25
            } else {
                0.75
            }
        };
        let chosen = all(&recipe, &share).unwrap();
        assert!(chosen.iter().all(|b| b.x_m >= 0.0));
        let north = chosen.iter().filter(|b| b.y_m >= 0.0).count() as f64;
        assert!((north - 1500.0).abs() < 4.0 * (2000.0f64 * 0.75 * 0.25).sqrt(), "{north}");

        let problem = all(&recipe, &|_, _, _| 0.0).unwrap_err();
        assert!(problem.to_string().starts_with("recipe.boulders[0].where: leaves almost no room"), "{problem}");
    }
}
