//! Phobos as far as it is known by a few numbers: an ellipsoid, Stickney, and craters of the measured population in places of their own.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::ellipsoid::Ellipsoid;
use crate::geometry::{direction_of_deg, whole};
use crate::landscape::crater::Crater;
use crate::landscape::power_law::PowerLaw;
use crate::landscape::random::{Purpose, key};
use crate::landscape::recipe::{Craters, Overlap};
use crate::random::Draws;

/// Axes of the ellipsoid that fits Phobos best, m (Ernst et al. 2023, Earth Planets Space 75, 103).
const AXES_M: [f64; 3] = [12_950.0, 11_300.0, 9160.0];

/// Stickney: longitude east, latitude, deg, diameter, m (the IAU's gazetteer: 9 km), and depth in diameters when it was fresh. Worn, its floor lies 1 km below the
/// ellipsoid, as the deepest ground there does on the shape of Ernst et al. (1.1 km, some degrees away), and its depth is 0.14 D.
const STICKNEY: [f64; 4] = [308.0, 0.0, 9000.0, 0.2];

/// Craters over 400 m: of Phobos' 1300 over 200 m, by the exponent 1.815 that 70 over 1 km leave (Basilevsky et al. 2014, Planet. Space Sci. 102, 95).
const CRATERS: u64 = 370;
const SMALLEST_M: f64 = 400.0;
const LARGEST_M: f64 = 5000.0;
const EXPONENT: f64 = 1.815;

/// The places of its craters depend on this alone: the same Phobos for all recipes.
const SEED: u64 = 1877;

/// Rows and columns of directions in which craters are looked up.
const ROWS: usize = 48;
const COLUMNS: usize = 96;

/// After so many steps a root is known to the last digit, or will not be.
const STEPS: usize = 60;

/// A crater on the body: how its shape goes with the square of the chord between directions.
#[derive(Debug, Clone)]
struct OnBody {
    middle: DVec3,
    /// Rim radius over the body's there, squared.
    rim_squared: f64,
    crater: Crater,
}

/// The built-in body.
#[derive(Debug, Clone)]
pub(super) struct Phobos {
    ellipsoid: Ellipsoid,
    middle_m: DVec3,
    craters: Vec<OnBody>,
    /// Numbers of craters by the cells of directions that they reach.
    cells: Vec<Vec<u32>>,
}

impl Phobos {
    pub(super) fn new(middle_m: DVec3) -> Self {
        let ellipsoid = Ellipsoid::new(AXES_M, DVec3::ZERO);
        let mut phobos = Phobos { ellipsoid, middle_m, craters: Vec::new(), cells: vec![Vec::new(); ROWS * COLUMNS] };
        let [longitude_deg, latitude_deg, diameter_m, depth] = STICKNEY;
        let group =
            |depth: f64, softness: f64| Craters { depth, softness, overlap: Overlap::Add, ..Craters::default() };
        let towards = |longitude: f64, z: f64| {
            let (sin, cos) = longitude.sin_cos();
            let flat = (1.0 - z * z).sqrt();
            DVec3::new(flat * cos, flat * sin, z)
        };
        phobos.add(
            towards(longitude_deg.to_radians(), latitude_deg.to_radians().sin()),
            &group(depth, 0.5),
            diameter_m,
            0.36,
        );
        let law = PowerLaw::new(SMALLEST_M, LARGEST_M, EXPONENT);
        for i in 0..CRATERS {
            let mut draws = Draws::new(key(SEED, Purpose::Crater, i));
            let middle = towards(draws.between(0.0, TAU), draws.between(-1.0, 1.0));
            let diameter_m = law.size(draws.unit());
            phobos.add(middle, &group(0.15, 0.85), diameter_m, draws.unit());
        }
        phobos
    }

    fn add(&mut self, middle: DVec3, craters: &Craters, diameter_m: f64, age: f64) {
        let crater = Crater::new(craters, 0, [0.0; 2], diameter_m, age);
        let radius_m = self.radius(middle).0;
        let number = u32::try_from(self.craters.len()).unwrap_or(u32::MAX);
        let reach = 2.0 * (0.5 * crater.reach_m() / radius_m).min(1.0).asin();
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                // A cell's directions are no farther from its middle than its own half diagonal.
                let middle_deg = |cell: usize, count: usize, all_deg: f64| (cell as f64 + 0.5) / count as f64 * all_deg;
                let at = direction_of_deg([middle_deg(row, ROWS, 180.0) - 90.0, middle_deg(column, COLUMNS, 360.0)]);
                let half = 0.5 * (PI / ROWS as f64).hypot(TAU / COLUMNS as f64);
                if at.dot(middle).clamp(-1.0, 1.0).acos() <= reach + half {
                    self.cells[row * COLUMNS + column].push(number);
                }
            }
        }
        let rim_squared = (0.5 * diameter_m / radius_m).powi(2);
        self.craters.push(OnBody { middle, rim_squared, crater });
    }

    /// Distance of the surface from the body's middle in a direction, m, and its gradient by the direction, m.
    fn radius(&self, d: DVec3) -> (f64, DVec3) {
        let scaled = d / self.ellipsoid.axes_m;
        let smooth_m = 1.0 / scaled.length();
        let (mut radius_m, mut gradient_m) = (smooth_m, -smooth_m.powi(3) * scaled / self.ellipsoid.axes_m);
        let cell = |share: f64, count: usize| whole(share * count as f64).min(count - 1);
        let row = cell(d.z.clamp(-1.0, 1.0).asin() / PI + 0.5, ROWS);
        let column = cell(d.y.atan2(d.x).rem_euclid(TAU) / TAU, COLUMNS);
        for &number in &self.cells[row * COLUMNS + column] {
            let OnBody { middle, rim_squared, crater } = &self.craters[number as usize];
            let (height_m, slope_m) = crater.profile_m((d - *middle).length_squared() / rim_squared);
            radius_m += height_m;
            gradient_m += slope_m * 2.0 * (d - *middle) / *rim_squared;
        }
        (radius_m, gradient_m)
    }

    /// How far a point is above the surface on the line from the body's middle, m, and the outward unit normal of the surface through it.
    fn above(&self, from_middle_m: DVec3) -> (f64, DVec3, f64) {
        let distance_m = from_middle_m.length();
        let d = from_middle_m / distance_m;
        let (radius_m, gradient_m) = self.radius(d);
        let gradient = d - (gradient_m - gradient_m.dot(d) * d) / distance_m;
        let length = gradient.length();
        (distance_m - radius_m, gradient / length, length)
    }

    /// Where a ray from a point within it leaves it, m, and the outward unit normal there; none from a point outside.
    pub(super) fn hit(&self, from_m: DVec3, direction: DVec3) -> Option<(DVec3, DVec3)> {
        let from_m = from_m - self.middle_m;
        if direction == DVec3::ZERO || (from_m != DVec3::ZERO && self.above(from_m).0 >= 0.0) {
            return None;
        }
        // Newton's steps, kept between a point within and one outside.
        let (mut inside_m, mut outside_m) = (0.0, 2.0 * AXES_M[0] + from_m.length());
        let start = self.ellipsoid.hit(from_m, direction).map_or(0.5 * outside_m, |(p, _)| (p - from_m).length());
        let mut t_m = start.clamp(inside_m, outside_m);
        for _ in 0..STEPS {
            let (above_m, normal, length) = self.above(from_m + t_m * direction);
            if above_m > 0.0 {
                outside_m = t_m
            } else {
                inside_m = t_m
            }
            let next_m = t_m - above_m / (length * normal.dot(direction));
            let next_m = if next_m > inside_m && next_m < outside_m { next_m } else { 0.5 * (inside_m + outside_m) };
            if (next_m - t_m).abs() <= 2.0 * f64::EPSILON * outside_m {
                break;
            }
            t_m = next_m;
        }
        let point_m = from_m + t_m * direction;
        Some((point_m + self.middle_m, self.above(point_m).1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_surface_is_where_it_says_and_normals_are_its_own() {
        let phobos = Phobos::new(DVec3::new(100.0, -50.0, 20.0));
        let mut seen = 0;
        for k in 0..400 {
            let mut draws = Draws::new(k);
            let mut unit = || DVec3::from_array(std::array::from_fn(|_| draws.normal())).normalize();
            let (from_m, towards) = (1500.0 * unit(), unit());
            let (p, n) = phobos.hit(from_m, towards).unwrap();
            let q = p - phobos.middle_m;
            assert!((q.length() - phobos.radius(q.normalize()).0).abs() < 1e-8, "{q}");
            assert!((p - from_m).normalize().dot(towards) > 1.0 - 1e-14);
            // The normal by differences: points of the surface around it, of which none is far off the plane.
            let side = n.any_orthonormal_vector();
            for axis in [side, n.cross(side)] {
                let on = |s: f64| {
                    let d = (q + s * axis).normalize();
                    d * phobos.radius(d).0
                };
                let tangent = (on(0.01) - on(-0.01)).normalize();
                // Where rims and the ends of ejecta are, slopes have steps.
                seen += i32::from(tangent.dot(n).abs() < 1e-5);
            }
        }
        assert!(seen > 780, "{seen} of 800");
    }

    #[test]
    fn stickney_is_there_and_the_size_is_that_of_phobos() {
        let phobos = Phobos::new(DVec3::ZERO);
        let towards = |longitude_deg: f64| {
            let (sin, cos) = longitude_deg.to_radians().sin_cos();
            DVec3::new(cos, sin, 0.0)
        };
        let below_m = |d: DVec3| 1.0 / (d / DVec3::from_array(AXES_M)).length() - phobos.radius(d).0;
        // On the shape of Ernst et al. (2023) 1.1 km below the ellipsoid; other craters add to it.
        assert!((850.0..1350.0).contains(&below_m(towards(308.0))), "{}", below_m(towards(308.0)));
        // Volume by directions that are even over the sphere: Phobos has 5692 to 5740 km3, its ellipsoid 5615.
        let n = 40_000;
        let volume_km3 = (0..n)
            .map(|i| {
                let z = 1.0 - (2 * i + 1) as f64 / f64::from(n);
                let (sin, cos) = (i as f64 * 2.399_963_229_728_653).sin_cos();
                let flat = (1.0 - z * z).sqrt();
                phobos.radius(DVec3::new(flat * cos, flat * sin, z)).0.powi(3)
            })
            .sum::<f64>()
            / f64::from(n)
            * 4.0
            / 3.0
            * PI
            * 1e-9;
        assert!((volume_km3 / 5615.0 - 1.0).abs() < 0.03, "{volume_km3}");
    }
}
