//! One crater: a parabola up to the rim, ejecta beyond, and what is left of the ground that was there before.

use super::noise::{presence, smooth_step};
use super::recipe::{Craters, Overlap};

/// How far the ejecta reach, in rim radii from the centre.
pub(super) const REACH: f64 = 3.0;

/// What was there before is gone up to the first distance, in rim radii, and all there from the second on.
const ERASED: (f64, f64) = (0.8, 1.2);

/// One crater of the site.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Crater {
    /// Number of its group.
    pub(super) group: usize,
    /// Centre, m.
    pub(super) x_m: f64,
    pub(super) y_m: f64,
    /// Rim-to-rim diameter, m.
    pub(super) diameter_m: f64,
    /// From 0 (now) to 1 (the oldest).
    pub(super) age: f64,
    /// Rim to floor, m.
    pub(super) depth_m: f64,
    /// Rim over the surroundings, m.
    rim_m: f64,
    /// Height over which the rim is rounded, m.
    rounding_m: f64,
    /// The ground that it was dug into: height at its centre, m, and slopes to the east and north; none if it adds to whatever is there.
    pub(super) before: Option<[f64; 3]>,
}

impl Crater {
    /// A crater of a group at a place. What it erases is still a plane at 0.
    pub(super) fn new(craters: &Craters, group: usize, [x_m, y_m]: [f64; 2], diameter_m: f64, age: f64) -> Self {
        let creep = 1.0 + age * (craters.creep_m / diameter_m).powi(2);
        let kept = (1.0 - craters.softness * age.sqrt()) / creep;
        let depth_m = craters.depth * diameter_m * kept;
        Crater {
            group,
            x_m,
            y_m,
            diameter_m,
            age,
            depth_m,
            rim_m: craters.rim * diameter_m * kept,
            rounding_m: (1.0 - kept) * depth_m,
            before: (craters.overlap == Overlap::Erase).then_some([0.0; 3]),
        }
    }

    /// Beyond this distance from the centre the ground is untouched, m.
    pub(super) fn reach_m(&self) -> f64 {
        0.5 * REACH * self.diameter_m
    }

    /// The ground's height at a place once the crater is there, m, if before it was `height_m`; on a grid with this step.
    pub(super) fn dug_m(&self, height_m: f64, x_m: f64, y_m: f64, step_m: f64) -> f64 {
        let (dx_m, dy_m) = (x_m - self.x_m, y_m - self.y_m);
        let r_squared = (dx_m * dx_m + dy_m * dy_m) / (0.25 * self.diameter_m * self.diameter_m);
        if r_squared >= REACH * REACH {
            return height_m;
        }
        let share = presence(self.diameter_m, step_m);
        let erased = match self.before {
            Some([centre_m, east, north]) => {
                let t = ((ERASED.1 - r_squared.sqrt()) / (ERASED.1 - ERASED.0)).clamp(0.0, 1.0);
                smooth_step(t) * (centre_m + east * dx_m + north * dy_m - height_m)
            }
            None => 0.0,
        };
        height_m + share * (erased + self.profile_m(r_squared).0)
    }

    /// Height over the ground that it was dug into, m, at the square of a distance from its centre in rim radii, and its derivative by that square, m.
    ///
    /// With r the distance, the lower of a bowl, rim - depth (1 - r^2), and an apron,
    /// rim ((3 - r) / 2)^3: this is r^-3, the thickness of ejecta (McGetchin, Settle and Head 1973, Earth Planet.
    /// Sci. Lett. 20), at r = 1 and 2, and ends with slope and curvature 0 at r = 3. Where the two differ by less than
    /// the rounding, a parabola joins them and takes a quarter of the rounding off the rim.
    pub(super) fn profile_m(&self, r_squared: f64) -> (f64, f64) {
        if r_squared >= REACH * REACH {
            return (0.0, 0.0);
        }
        let bowl_m = self.rim_m - self.depth_m * (1.0 - r_squared);
        let r = r_squared.sqrt();
        let t = (REACH - r) / (REACH - 1.0);
        let apron_m = self.rim_m * t * t * t;
        // At the centre the apron has a peak, where the bowl is what counts.
        let apron_slope_m = if r > 0.0 { -3.0 * self.rim_m * t * t / (2.0 * r * (REACH - 1.0)) } else { 0.0 };
        let (lower_m, slope_m) = if bowl_m < apron_m { (bowl_m, self.depth_m) } else { (apron_m, apron_slope_m) };
        let apart_m = bowl_m - apron_m;
        let overlap_m = self.rounding_m - apart_m.abs();
        if overlap_m <= 0.0 {
            return (lower_m, slope_m);
        }
        let joined = 0.5 * overlap_m / self.rounding_m;
        let closing_m = -apart_m.signum() * (self.depth_m - apron_slope_m);
        (lower_m - 0.5 * joined * overlap_m, slope_m - joined * closing_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fresh() -> Crater {
        Crater::new(&Craters::default(), 0, [0.0; 2], 100.0, 0.0)
    }

    #[test]
    fn a_fresh_crater_is_a_fifth_as_deep_as_wide() {
        let profile: Vec<f64> = (0..=200).map(|d| fresh().profile_m(f64::from(d * d) / 2500.0).0).collect();
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
        let worn = Crater { rounding_m: 8.0, ..fresh() };
        assert_eq!(worn.profile_m(1.0).0, 4.0 - 2.0);
        // Slopes from both sides of the rim now agree.
        let slope = |from: f64, to: f64| {
            (worn.profile_m(to * to / 2500.0).0 - worn.profile_m(from * from / 2500.0).0) / (to - from)
        };
        assert!((slope(49.9999, 50.0) - slope(50.0, 50.0001)).abs() < 1e-3);
        // Further than the rounding from the rim nothing changes.
        assert_eq!(worn.profile_m(0.16).0, fresh().profile_m(0.16).0);
        // Nor does it leave a step where the ejecta end.
        assert_eq!(worn.profile_m(8.999).0, fresh().profile_m(8.999).0);
    }

    #[test]
    fn slopes_are_those_of_the_heights() {
        for crater in [fresh(), Crater { rounding_m: 8.0, ..fresh() }, Crater { rounding_m: 25.0, ..fresh() }] {
            for k in 1..800 {
                let s = 0.0113 * f64::from(k);
                let h = 1e-6;
                let by_differences = (crater.profile_m(s + h).0 - crater.profile_m(s - h).0) / (2.0 * h);
                let slope = crater.profile_m(s).1;
                // But at a sharp rim.
                assert!(
                    (slope - by_differences).abs() < 1e-4 || (s - 1.0).abs() < 1e-5,
                    "{s}: {slope} {by_differences}"
                );
            }
        }
    }

    #[test]
    fn age_wears_and_creep_wears_small_craters_most() {
        let craters = Craters { softness: 0.0, creep_m: 50.0, ..Craters::default() };
        let depth =
            |diameter_m: f64, age: f64| Crater::new(&craters, 0, [0.0; 2], diameter_m, age).depth_m / diameter_m;
        // The oldest crater of 50 m has lost half, one of 25 m 1 - 1/5, of 100 m a fifth; fresh ones nothing.
        for (diameter_m, age, expected) in
            [(50.0, 1.0, 0.1), (25.0, 1.0, 0.04), (100.0, 1.0, 0.16), (50.0, 0.0, 0.2), (50.0, 0.5, 0.2 / 1.5)]
        {
            assert!((depth(diameter_m, age) - expected).abs() < 1e-12, "{diameter_m} {age}");
        }
        let craters = Craters { softness: 0.8, ..Craters::default() };
        assert!((Crater::new(&craters, 0, [0.0; 2], 10.0, 0.25).depth_m - 2.0 * 0.6).abs() < 1e-12);
    }

    #[test]
    fn a_crater_erases_what_was_within_its_rim_or_adds_to_it() {
        let before = Some([7.0, 0.1, -0.2]);
        let erasing = Crater { before, ..fresh() };
        let adding = Crater { before: None, ..fresh() };
        for (r, shares) in
            [(0.0, (0.0, 1.0)), (0.79, (0.0, 1.0)), (1.0, (0.5, 0.5)), (1.21, (1.0, 0.0)), (3.1, (1.0, 0.0))]
        {
            let (x_m, y_m) = (30.0 * r, 40.0 * r);
            let profile_m = fresh().profile_m(r * r).0;
            let expected_m = shares.0 * 99.0 + shares.1 * (7.0 + 0.1 * x_m - 0.2 * y_m) + profile_m;
            assert!((erasing.dug_m(99.0, x_m, y_m, 1.0) - expected_m).abs() < 1e-9, "{r}");
            assert!((adding.dug_m(99.0, x_m, y_m, 1.0) - 99.0 - profile_m).abs() < 1e-9, "{r}");
        }
        // On steps of half its width it is not there.
        assert_eq!(erasing.dug_m(99.0, 10.0, 0.0, 50.0), 99.0);
    }
}
