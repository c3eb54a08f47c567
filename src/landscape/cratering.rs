//! All craters of a site, in the order in which they were dug, and the ground that they leave.

use super::crater::Crater;
use super::lookup::Lookup;
use super::power_law::PowerLaw;
use super::random::{Purpose, key_in};
use super::recipe::{Craters, Recipe};
use super::relief::Layer;
use crate::geometry::{index_u32, whole};
use crate::random::Draws;

/// The ground that a crater is dug into is looked at on steps of this share of its diameter: what is finer is gone with it.
const LOOK: f64 = 0.125;

/// Craters of the production that lie on the site: those of group g, one after the other; crater i of a group does not depend on how many there are.
pub(super) fn produced(recipe: &Recipe) -> Vec<Crater> {
    let half_m = 0.5 * recipe.size_m;
    let mut all = Vec::new();
    for (g, craters) in recipe.craters.iter().enumerate() {
        let (number, law) = (whole(craters.number(recipe.area_km2())) as u64, craters.law());
        all.extend((0..number).map(|i| {
            let mut draws = Draws::new(key_in(recipe.seed, Purpose::Crater, g, i));
            let place = [draws.between(-half_m, half_m), draws.between(-half_m, half_m)];
            let diameter_m = law.size(draws.unit());
            Crater::new(craters, g, place, diameter_m, draws.unit())
        }));
        all.extend(craters.placed.iter().map(|p| Crater::new(craters, g, [p.x_m, p.y_m], p.diameter_m, p.age)));
    }
    all
}

/// Craters of one size around a site.
struct Class {
    group: usize,
    number: u64,
    /// Their diameters are from the first to the second, m.
    diameters_m: [f64; 2],
    /// They lie within this distance of the site's middle, east, north, west and south, m.
    half_m: f64,
    /// How many are expected.
    expected: f64,
}

/// The sizes of craters around a site: of each size as far out as facets that grow by this share, however many there are, can show it.
fn classes(recipe: &Recipe) -> Vec<Class> {
    let Some(surroundings) = &recipe.surroundings else { return Vec::new() };
    let site_m = 0.5 * recipe.size_m;
    let mut classes = Vec::new();
    for (group, craters) in recipe.craters.iter().enumerate() {
        let Craters { min_diameter_m, max_diameter_m, .. } = *craters;
        let law = craters.law();
        let (mut lo_m, mut above) = (min_diameter_m, 1.0);
        for number in 0.. {
            let hi_m = (2.0 * lo_m).min(max_diameter_m);
            let half_m = site_m + (0.5 * hi_m / surroundings.growth).min(surroundings.reach_m);
            let times = (half_m / site_m).powi(2) - 1.0;
            let expected = craters.number(recipe.area_km2()) * (above - law.larger(hi_m)) * times;
            classes.push(Class { group, number, diameters_m: [lo_m, hi_m], half_m, expected });
            (lo_m, above) = (hi_m, law.larger(hi_m));
            if hi_m >= max_diameter_m {
                break;
            }
        }
    }
    classes
}

/// How many craters are expected around a site.
pub(super) fn expected_around(recipe: &Recipe) -> f64 {
    classes(recipe).iter().map(|class| class.expected).sum()
}

/// Craters around the site, of the same population.
pub(super) fn around(recipe: &Recipe) -> Vec<Crater> {
    let site_m = 0.5 * recipe.size_m;
    let mut all = Vec::new();
    for Class { group, number, diameters_m: [lo_m, hi_m], half_m, expected } in classes(recipe) {
        let craters = &recipe.craters[group];
        let mut draws = Draws::new(key_in(recipe.seed, Purpose::CraterAround, group, number));
        let law = PowerLaw::new(lo_m, hi_m, craters.exponent);
        let mut left = draws.count(expected);
        while left >= 1.0 {
            let place = [draws.between(-half_m, half_m), draws.between(-half_m, half_m)];
            if place.iter().all(|x| x.abs() <= site_m) {
                continue;
            }
            let diameter_m = law.size(draws.unit());
            all.push(Crater::new(craters, group, place, diameter_m, draws.unit()));
            left -= 1.0;
        }
    }
    all
}

/// Relief with its craters and its cover: the height at any place.
#[derive(Debug, Clone)]
pub(super) struct Ground {
    layers: Vec<Layer>,
    /// What lies over relief and craters.
    cover: Vec<Layer>,
    /// From the oldest to the youngest.
    pub(super) craters: Vec<Crater>,
    /// Which craters may reach a place: on the site, and all over.
    site: Lookup,
    all: Lookup,
}

impl Ground {
    /// Digs the craters, the oldest first: each sees the ground that those before it have left.
    pub(super) fn new(
        layers: Vec<Layer>,
        mut craters: Vec<Crater>,
        cover: Vec<Layer>,
        site_m: f64,
        all_m: f64,
    ) -> Self {
        craters.sort_by(|a, b| b.age.total_cmp(&a.age));
        let mut ground = Ground {
            layers,
            cover: Vec::new(),
            craters: Vec::with_capacity(craters.len()),
            site: Lookup::new(site_m),
            all: Lookup::new(all_m.max(site_m)),
        };
        for mut crater in craters {
            if crater.before.is_some() {
                crater.before = Some(ground.plane_under(&crater));
            }
            let number = index_u32(ground.craters.len());
            for lookup in [&mut ground.site, &mut ground.all] {
                lookup.insert([crater.x_m, crater.y_m], crater.reach_m(), number);
            }
            ground.craters.push(crater);
        }
        // Craters do not see it.
        ground.cover = cover;
        ground
    }

    /// The plane that fits the ground best at the centre of a crater, half way to its rim, and at its rim, eight places each.
    fn plane_under(&self, crater: &Crater) -> [f64; 3] {
        const RING: usize = 8;
        let step_m = LOOK * crater.diameter_m;
        let at = |dx_m: f64, dy_m: f64| self.height_m(crater.x_m + dx_m, crater.y_m + dy_m, step_m);
        let (mut sum_m, mut east_m2, mut north_m2, mut squares_m2) = (at(0.0, 0.0), 0.0, 0.0, 0.0);
        for k in 0..2 * RING {
            let radius_m = 0.25 * crater.diameter_m * (1 + k / RING) as f64;
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / RING as f64).sin_cos();
            let (dx_m, dy_m) = (radius_m * cos, radius_m * sin);
            let height_m = at(dx_m, dy_m);
            sum_m += height_m;
            east_m2 += height_m * dx_m;
            north_m2 += height_m * dy_m;
            squares_m2 += dx_m * dx_m;
        }
        [sum_m / (2 * RING + 1) as f64, east_m2 / squares_m2, north_m2 / squares_m2]
    }

    /// Height at a place of a grid with this step, m.
    pub(super) fn height_m(&self, x_m: f64, y_m: f64, step_m: f64) -> f64 {
        let sum_m = |layers: &[Layer]| layers.iter().map(|layer| layer.height_m(x_m, y_m, step_m)).sum::<f64>();
        let relief_m = sum_m(&self.layers);
        let numbers = self.site.at(x_m, y_m).or_else(|| self.all.at(x_m, y_m)).unwrap_or(&[]);
        let dug_m = |height_m, &number: &u32| self.craters[number as usize].dug_m(height_m, x_m, y_m, step_m);
        numbers.iter().fold(relief_m, dug_m) + sum_m(&self.cover)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::recipe::Overlap;

    fn recipe(count: u32) -> Recipe {
        Recipe { craters: vec![Craters { count, ..Craters::default() }], ..Recipe::plane(3) }
    }

    #[test]
    fn more_craters_leave_the_first_where_they_were() {
        let (few, many) = (produced(&recipe(10)), produced(&recipe(500)));
        assert_eq!((few.len(), many.len()), (10, 500));
        assert_eq!(few[..], many[..10]);
        assert!(many.iter().all(|c| c.x_m.abs() <= 1000.0 && c.y_m.abs() <= 1000.0));
        // Default wear: 0 to 0.9.
        assert!(many.iter().all(|c| (0.02 - 1e-12..=0.2).contains(&(c.depth_m / c.diameter_m))));
        // A second group has others, and leaves those of the first alone.
        let mut two = recipe(500);
        two.craters.push(two.craters[0].clone());
        let two = produced(&two);
        assert_eq!(two[..500], many[..]);
        assert!(two[500..].iter().zip(&many).all(|(a, b)| a.x_m != b.x_m));
    }

    #[test]
    fn lookups_find_every_crater_that_reaches_a_place() {
        let craters = produced(&recipe(300));
        let mut adding = craters;
        adding.iter_mut().for_each(|c| c.before = None);
        let ground = Ground::new(Vec::new(), adding.clone(), Vec::new(), 1000.0, 3000.0);
        adding.sort_by(|a, b| b.age.total_cmp(&a.age));
        for i in 0..2000 {
            let (x_m, y_m) = (f64::from(i % 50) * 48.7 - 1180.0, f64::from(i / 50) * 59.3 - 1170.0);
            let expected_m: f64 = adding.iter().fold(0.0, |h, c| c.dug_m(h, x_m, y_m, 0.01));
            assert!((ground.height_m(x_m, y_m, 0.01) - expected_m).abs() < 1e-9);
        }
    }

    #[test]
    fn the_younger_crater_erases_the_older() {
        let craters = Craters { softness: 0.0, overlap: Overlap::Erase, ..Craters::default() };
        let old = Crater::new(&craters, 0, [30.0, 0.0], 60.0, 0.9);
        let young = Crater::new(&craters, 0, [0.0, 0.0], 100.0, 0.1);
        let ground = Ground::new(Vec::new(), vec![young.clone(), old.clone()], Vec::new(), 500.0, 500.0);
        assert_eq!(ground.craters[0].diameter_m, 60.0);
        // Within the younger one's 0.8 radii nothing but its own bowl is left: a parabola on a plane.
        let [centre_m, east, north] = ground.craters[1].before.unwrap();
        assert!(north.abs() < 1e-12 && east < -0.01, "the old one has lowered the east: {east}");
        for (x_m, y_m) in [(0.0, 0.0), (30.0, 0.0), (35.0, 10.0), (-20.0, 30.0)] {
            let r_squared = (x_m * x_m + y_m * y_m) / 2500.0;
            let expected_m = centre_m + east * x_m + 4.0 - 20.0 * (1.0 - r_squared);
            assert!((ground.height_m(x_m, y_m, 0.1) - expected_m).abs() < 1e-9);
        }
        // In the other order the small one is all there.
        let last = Crater::new(&craters, 0, [30.0, 0.0], 60.0, 0.0);
        let ground = Ground::new(Vec::new(), vec![last, young], Vec::new(), 500.0, 500.0);
        let bowl_m = ground.height_m(30.0, 0.0, 0.1) - ground.height_m(30.0, 24.0, 0.1);
        assert!((bowl_m + 12.0 * 0.64).abs() < 0.5, "{bowl_m}");
    }
}
