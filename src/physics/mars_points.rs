//! Points that stand for the lit part of Mars' disc, as terrain before it hides some of them.

use glam::DVec3;

use super::sun_disc::DiscRule;
use crate::geometry::Direction;

/// A part of Mars' disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MarsPoint {
    /// Towards the middle of its light, of unit length.
    pub towards: DVec3,
    /// Its light on a facet that faces it, over that of all parts.
    pub light: f64,
}

/// Rings of the lattice whose light is summed up: 1 + 6 + 12 + ... points.
const RINGS: u32 = 24;

/// The parts that are nearest to each point of a rule on the disc, those that are lit: a Lambert sphere whose centre is `to_centre_m` away.
///
/// With q = R / D a point at r of the disc's radius is seen at sin(theta) = q r, where the sphere's normal is m; a solid angle of
/// q^2 dx dy / cos(theta) has the radiance (m.s)+. Of a crescent only the parts where it is are left, each at the middle of its light.
/// Source: Lambert's law. Limits: as [`irradiance`](super::mars::irradiance), outside the sphere.
pub fn lit_points(to_centre_m: DVec3, radius_m: f64, sun: Direction, rule: DiscRule) -> Vec<MarsPoint> {
    let (Some(middle), q) = (Direction::new(to_centre_m), radius_m / to_centre_m.length()) else { return vec![] };
    let (c, (h, v)) = (middle.vec(), middle.frame());
    let centres = rule.points();
    let mut sums = vec![DVec3::ZERO; centres.len()];
    let mut all = 0.0;
    for (x, y) in lattice() {
        let r2 = x * x + y * y;
        let cos = (1.0 - q * q * r2).max(0.0).sqrt();
        let towards = cos * c + q * (x * h + y * v);
        // Lengths in distances to the centre: where the ray meets the sphere, and its normal there.
        let along = cos - q * (1.0 - r2).max(0.0).sqrt();
        let light = ((along * towards - c) / q).dot(sun.vec()).max(0.0) / cos;
        let near = |[px, py, _]: &[f64; 3]| (px - x).hypot(py - y);
        let nearest = (0..centres.len()).min_by(|a, b| near(&centres[*a]).total_cmp(&near(&centres[*b])));
        if let Some(part) = nearest.filter(|_| light > 0.0) {
            sums[part] += light * towards;
            all += light;
        }
    }
    let part = |sum: DVec3| Some(MarsPoint { towards: Direction::new(sum)?.vec(), light: sum.length() / all });
    sums.into_iter().filter_map(part).collect()
}

/// Share of Mars' disc, by the light that a facet facing it would have of a uniform one, on which the Sun is up: to a hundredth.
pub fn day_share(to_centre_m: DVec3, radius_m: f64, sun: Direction) -> f64 {
    let (Some(middle), q) = (Direction::new(to_centre_m), radius_m / to_centre_m.length()) else { return 0.0 };
    let (c, (h, v)) = (middle.vec(), middle.frame());
    let (mut day, mut all) = (0.0, 0.0);
    for (x, y) in lattice() {
        let r2 = x * x + y * y;
        let towards = (1.0 - q * q * r2).max(0.0).sqrt() * c + q * (x * h + y * v);
        let along = towards.dot(c) - q * (1.0 - r2).max(0.0).sqrt();
        day += if (along * towards - c).dot(sun.vec()) > 0.0 { 1.0 } else { 0.0 };
        all += 1.0;
    }
    day / all
}

/// Points that fill the unit disc evenly.
fn lattice() -> impl Iterator<Item = (f64, f64)> {
    let total = f64::from(1 + 3 * RINGS * (RINGS + 1));
    (0..=RINGS).flat_map(move |ring| {
        let count = (6 * ring).max(1);
        // Each ring at the radius that halves its area.
        let inside = if ring == 0 { 0.0 } else { f64::from(1 + 3 * ring * (ring - 1)) };
        let radius = if ring == 0 { 0.0 } else { ((inside + 0.5 * f64::from(count)) / total).sqrt() };
        (0..count).map(move |k| {
            let (sin, cos) = (2.0 * std::f64::consts::PI * f64::from(k) / f64::from(count)).sin_cos();
            (radius * cos, radius * sin)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::mars;

    #[test]
    fn parts_have_the_light_of_the_whole() {
        let (radius_m, to_centre_m) = (3_389_500.0, DVec3::new(0.0, 0.0, 9_376_000.0));
        for phase_deg in [0.0, 60.0, 90.0, 130.0] {
            let (sin, cos) = f64::to_radians(phase_deg).sin_cos();
            let sun = Direction::new(DVec3::new(sin, 0.0, -cos)).unwrap();
            let of_facet = |normal: DVec3| mars::irradiance(to_centre_m, radius_m, normal, sun.vec());
            for rule in DiscRule::ALL {
                let points = lit_points(to_centre_m, radius_m, sun, rule);
                assert!(!points.is_empty() && points.len() <= rule.count());
                // The vector sum of light is that of a facet's irradiance, whatever its direction: all of Mars is above these.
                let sum = |normal: DVec3| points.iter().map(|p| p.light * p.towards.dot(normal)).sum::<f64>();
                let tilted = DVec3::new(0.4, 0.3, 0.866);
                let expected = of_facet(tilted.normalize()) / of_facet(DVec3::Z);
                let got = sum(tilted.normalize()) / sum(DVec3::Z);
                assert!((got / expected - 1.0).abs() < 0.01, "{phase_deg} {rule:?}: {got} {expected}");
            }
        }
        // The terminator of a half Mars passes through the middle of what is seen; near at hand less of the far side is.
        let half = day_share(1e6 * to_centre_m, radius_m, Direction::new(DVec3::X).unwrap());
        assert!((half - 0.5).abs() < 0.02, "{half}");
        let of = |z: f64| day_share(to_centre_m, radius_m, Direction::new(DVec3::new(0.0, 0.0, z)).unwrap());
        assert_eq!((of(-1.0), of(1.0)), (1.0, 0.0));
        let behind = Direction::new(DVec3::Z).unwrap();
        assert!(lit_points(to_centre_m, radius_m, behind, DiscRule::G7).is_empty());
    }
}
