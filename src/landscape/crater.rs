//! Bowl craters: a parabola up to the rim, ejecta beyond.

use super::random::{Purpose, key};
use super::recipe::Craters;
use crate::random::Draws;

/// How far the ejecta reach, in rim radii from the centre.
const REACH: f64 = 3.0;

/// One crater of the site.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Crater {
    /// Centre, m.
    pub(super) x_m: f64,
    pub(super) y_m: f64,
    /// Rim-to-rim diameter, m.
    pub(super) diameter_m: f64,
    /// Rim to floor, m.
    depth_m: f64,
    /// Rim over the surroundings, m.
    rim_m: f64,
    /// Height over which the rim is rounded, m.
    rounding_m: f64,
}

/// All craters of a recipe; crater i does not depend on how many there are.
pub(super) fn craters(craters: &Craters, seed: u64, size_m: f64) -> impl Iterator<Item = Crater> {
    (0..craters.count).map(move |i| {
        let mut draws = Draws::new(key(seed, Purpose::Crater, i.into()));
        let half_m = 0.5 * size_m;
        let (x_m, y_m) = (draws.between(-half_m, half_m), draws.between(-half_m, half_m));
        let diameter_m = draws.power_law(craters.min_diameter_m, craters.max_diameter_m, craters.exponent);
        let wear = craters.softness * draws.unit().sqrt();
        let depth_m = craters.depth * diameter_m * (1.0 - wear);
        let rim_m = craters.rim * diameter_m * (1.0 - wear);
        Crater { x_m, y_m, diameter_m, depth_m, rim_m, rounding_m: wear * depth_m }
    })
}

impl Crater {
    /// Beyond this distance from the centre the ground is untouched, m.
    pub(super) fn reach_m(&self) -> f64 {
        0.5 * REACH * self.diameter_m
    }

    /// What the crater adds to the height of the ground, m, at the square of a distance from its centre.
    ///
    /// With r the distance in rim radii, the lower of a bowl, rim - depth (1 - r^2), and an apron,
    /// rim ((3 - r) / 2)^3: this is r^-3, the thickness of ejecta (McGetchin, Settle and Head 1973, Earth Planet.
    /// Sci. Lett. 20), at r = 1 and 2, and ends with slope and curvature 0 at r = 3. Where the two differ by less than
    /// the rounding, a parabola joins them and takes a quarter of the rounding off the rim.
    pub(super) fn height_m(&self, distance_squared_m2: f64) -> f64 {
        let r_squared = distance_squared_m2 / (0.25 * self.diameter_m * self.diameter_m);
        if r_squared >= REACH * REACH {
            return 0.0;
        }
        let bowl_m = self.rim_m - self.depth_m * (1.0 - r_squared);
        let t = (REACH - r_squared.sqrt()) / (REACH - 1.0);
        let apron_m = self.rim_m * t * t * t;
        let overlap_m = (self.rounding_m - (bowl_m - apron_m).abs()).max(0.0);
        let joint_m = if overlap_m > 0.0 { 0.25 * overlap_m * overlap_m / self.rounding_m } else { 0.0 };
        bowl_m.min(apron_m) - joint_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRESH: Crater = Crater { x_m: 0.0, y_m: 0.0, diameter_m: 100.0, depth_m: 20.0, rim_m: 4.0, rounding_m: 0.0 };

    #[test]
    fn a_fresh_crater_is_a_fifth_as_deep_as_wide() {
        let profile: Vec<f64> = (0..=200).map(|d| FRESH.height_m(f64::from(d * d))).collect();
        let (rim, height) = profile.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap();
        assert_eq!((rim, *height), (50, 4.0));
        assert_eq!(profile[0], -16.0);
        assert_eq!(height - profile[0], 0.2 * 100.0);
        // Half way to the rim: 4 - 20 (1 - 1/4).
        assert_eq!(profile[25], -11.0);
        // Ejecta at twice the rim's radius: 4 / 2^3; none from three on.
        assert_eq!(profile[100], 0.5);
        assert!(profile[149] > 0.0);
        assert_eq!(profile[150..], [0.0; 51]);
    }

    #[test]
    fn a_worn_crater_has_a_rounded_rim() {
        let worn = Crater { rounding_m: 8.0, ..FRESH };
        assert_eq!(worn.height_m(2500.0), 4.0 - 2.0);
        // Slopes from both sides of the rim now agree.
        let slope = |from: f64, to: f64| (worn.height_m(to * to) - worn.height_m(from * from)) / (to - from);
        assert!((slope(49.9999, 50.0) - slope(50.0, 50.0001)).abs() < 1e-3);
        // Further than the rounding from the rim nothing changes.
        assert_eq!(worn.height_m(400.0), FRESH.height_m(400.0));
        // Nor does it leave a step where the ejecta end.
        assert_eq!(worn.height_m(149.999 * 149.999), FRESH.height_m(149.999 * 149.999));
    }

    #[test]
    fn more_craters_leave_the_first_where_they_were() {
        let mut recipe = Craters { count: 10, ..Craters::default() };
        let few: Vec<Crater> = craters(&recipe, 3, 2000.0).collect();
        recipe.count = 500;
        let many: Vec<Crater> = craters(&recipe, 3, 2000.0).collect();
        assert_eq!((few.len(), many.len()), (10, 500));
        assert_eq!(few[..], many[..10]);
        assert!(many.iter().all(|c| c.x_m.abs() <= 1000.0 && c.y_m.abs() <= 1000.0));
        // Default wear: 0 to 0.9.
        assert!(many.iter().all(|c| (0.02 - 1e-12..=0.2).contains(&(c.depth_m / c.diameter_m))));
    }
}
