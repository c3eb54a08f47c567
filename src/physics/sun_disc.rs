//! The Sun as a disc: the share of it that is visible beyond an edge, and quadrature rules on it. Lengths are in radii of the disc.
//!
//! Limits: a disc so small that it is flat; 5 mrad are flat to 1e-5.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::GaussLegendre;
use super::mars::uniform_sphere_form_factor;
use crate::geometry::{Direction, angle_rad};

/// Share of a disc's light that is visible beyond a straight edge; `x` is the distance of its centre from the edge, -1 (hidden) to 1 (visible).
///
/// 1/2 + (x sqrt(1 - x^2) + asin x) / pi of a uniform disc. With limb darkening 1 - u (1 - sqrt(1 - r^2)) a chord at y gives
/// 2 (1 - u) sqrt(1 - y^2) + u (pi / 2) (1 - y^2). Source: the integral of these.
pub fn share_beyond_edge(x: f64, limb_darkening: f64) -> f64 {
    let (x, u) = (x.clamp(-1.0, 1.0), limb_darkening);
    let uniform = FRAC_PI_2 + x * ((1.0 - x) * (1.0 + x)).sqrt() + x.asin();
    // (1 + x)^2 (2 - x) / 3 is the integral of 1 - y^2, without cancellation at -1.
    let darkened = FRAC_PI_2 * (1.0 + x) * (1.0 + x) * (2.0 - x) / 3.0;
    ((1.0 - u) * uniform + u * darkened) / (PI * (1.0 - u / 3.0))
}

/// The most that this share changes with the place of the edge, whatever its form, per radius of the disc: light on the diameter over that of the disc.
///
/// A diameter has 2 (1 - u) + u pi / 2, the disc pi (1 - u / 3). Source: as [`share_beyond_edge`].
pub fn steepest_share(limb_darkening: f64) -> f64 {
    let u = limb_darkening;
    (2.0 * (1.0 - u) + u * FRAC_PI_2) / (PI * (1.0 - u / 3.0))
}

/// Irradiance by the Sun's disc on a facet whose own horizon cuts it, over that normal to the beam: the sine of elevation where all of the
/// disc is up, and 0 where none is; `sin_radius` is the sine of its angular radius.
///
/// A uniform disc is a sphere of uniform radiance: at the horizon it gives 2 s / (3 pi). What limb darkening leaves, sqrt(1 - r^2) of it, gives
/// sin_radius (1 + x)^3 (3 - x) / 16 with x = sin(elevation) / sin_radius: the integral of its [`share_beyond_edge`]. Limits of that: the horizon
/// is straight across the disc, so 3 parts in 1e6 for a radius of 3 mrad.
pub fn irradiance_on_facet(sin_elevation: f64, sin_radius: f64, limb_darkening: f64) -> f64 {
    if sin_elevation >= sin_radius {
        return sin_elevation;
    }
    let (x, u) = ((sin_elevation / sin_radius).max(-1.0), limb_darkening);
    let uniform = uniform_sphere_form_factor(sin_radius, sin_elevation) / (sin_radius * sin_radius);
    let darkened = sin_radius * (1.0 + x).powi(3) * (3.0 - x) / 16.0;
    (((1.0 - u) * uniform + 2.0 / 3.0 * u * darkened) / (1.0 - u / 3.0)).max(0.0)
}

/// A point that stands for a part of the Sun's disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubSun {
    /// Towards it, of such a length that its component towards the middle of the disc is 1: then the sum of shares times these is
    /// the direction of the middle, and facets above whose horizon all of the disc is have the irradiance of a point Sun.
    pub towards: DVec3,
    /// Its share of the Sun's irradiance.
    pub share: f64,
}

impl SubSun {
    /// Its irradiance on a facet, over that of the whole Sun normal to the beam; `normal` is the facet's, of unit length.
    #[inline]
    pub fn irradiance_on_facet(&self, normal: DVec3) -> f64 {
        self.share * normal.dot(self.towards).max(0.0)
    }
}

/// The points of a rule on a Sun in this direction: `sin_radius` is the sine of its angular radius.
pub fn sub_suns(middle: Direction, sin_radius: f64, limb_darkening: f64, rule: DiscRule) -> Vec<SubSun> {
    let (u, (h, v)) = (middle.vec(), middle.frame());
    let sub_sun = |[x, y, share]: [f64; 3]| {
        let (x, y) = (sin_radius * x, sin_radius * y);
        let cos = (1.0 - x * x - y * y).max(0.0).sqrt();
        SubSun { towards: u + (x * h + y * v) / cos, share }
    };
    rule.darkened_points(limb_darkening).into_iter().map(sub_sun).collect()
}

/// Share of a disc's light that is visible beside another disc of this radius, whose centre is at this distance.
///
/// Of a uniform disc two segments of circles make a lens. With limb darkening 1 - u (1 - m), m = sqrt(1 - r^2), a ring r is hidden over the angle
/// 2 h, cos h = (d^2 + r^2 - R^2) / (2 d r): what is darkened keeps 3 times the integral of m^2 (1 - h / pi) over m. Source: set up here, from the
/// circles' law of cosines. Limits: radius above 0, distance from 0.
pub fn share_beside_disc(radius: f64, distance: f64, limb_darkening: f64) -> f64 {
    let (uniform, u) = (uniform_beside_disc(radius, distance), limb_darkening);
    if u == 0.0 || uniform == 0.0 || uniform == 1.0 {
        return uniform;
    }
    // Rings begin to be cut where the other's border is nearest, and may end where it is farthest.
    let height = |r: f64| ((1.0 - r) * (1.0 + r)).max(0.0).sqrt();
    let near = (distance - radius).abs();
    let (cut_to, cut_from) = (height(near.min(1.0)), height((distance + radius).min(1.0)));
    let is_amid = distance > radius;
    let rule = GaussLegendre::new(16);
    let shown = |m: f64| {
        let r = height(m);
        let cos = ((distance - radius) * (distance + radius) + r * r) / (2.0 * distance * r);
        1.0 - cos.clamp(-1.0, 1.0).acos() / PI
    };
    // In an angle the roots at both ends are smooth.
    let middle = 0.5 * (cut_to + cut_from);
    let half = 0.5 * (cut_to - cut_from);
    let of_angle = |t: f64| {
        let m = middle - half * t.cos();
        m * m * shown(m) * half * t.sin()
    };
    let cut = if half > 0.0 { rule.integral(0.0, PI, of_angle) } else { 0.0 };
    // Inner rings are whole if the other's border passes between them and its centre, else hidden; outer ones are whole.
    let inner = if is_amid { (1.0 - cut_to.powi(3)) / 3.0 } else { 0.0 };
    let darkened = 3.0 * (cut + inner + cut_from.powi(3) / 3.0);
    ((1.0 - u) * uniform + 2.0 / 3.0 * u * darkened) / (1.0 - u / 3.0)
}

/// Share of the Sun's light that a sphere leaves: the Sun in the direction `towards`, with a disc whose radius has the sine `sin_radius`, seen beside
/// a sphere of this radius, m, whose centre is `to_centre_m` away.
///
/// The sphere's limb is a small circle of radius alpha, which near the Sun curves as a plane one of radius tan(alpha) does. Limits: a body without air; the
/// Sun's disc is flat.
pub fn share_beside_sphere(
    towards: DVec3,
    sin_radius: f64,
    limb_darkening: f64,
    to_centre_m: DVec3,
    radius_m: f64,
) -> f64 {
    let (sun_rad, alpha) = (sin_radius.asin(), (radius_m / to_centre_m.length()).min(1.0).asin());
    let beyond = (angle_rad(towards, to_centre_m) - alpha) / sun_rad;
    let radius = alpha.tan() / sun_rad;
    if beyond >= 1.0 { 1.0 } else { share_beside_disc(radius, (beyond + radius).max(0.0), limb_darkening) }
}

fn uniform_beside_disc(radius: f64, distance: f64) -> f64 {
    if distance >= 1.0 + radius {
        return 1.0;
    }
    if distance <= (1.0 - radius).abs() {
        return if radius < 1.0 { 1.0 - radius * radius } else { 0.0 };
    }
    // Half of the common chord, and how far it is from each centre.
    let (d, sum, difference) = (distance, 1.0 + radius, (1.0 - radius).abs());
    let half_chord = ((sum - d) * (sum + d) * (d - difference) * (d + difference)).sqrt() / (2.0 * d);
    let from_other = 0.5 * (d + (radius - 1.0) * (radius + 1.0) / d);
    let segment = |radius: f64, from_centre: f64| {
        let half_angle = half_chord.atan2(from_centre);
        radius * radius * half_angle - half_chord * from_centre
    };
    1.0 - (segment(1.0, d - from_other) + segment(radius, from_other)) / PI
}

/// Quadrature rules on the disc: points and their shares of its light.
///
/// All but the centre are exact for polynomials of degree 2. Rings set for the least [`edge_error`](DiscRule::edge_error) alone halve it, but where pixels are
/// much wider than penumbrae their images are 8 times as far off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum DiscRule {
    /// The centre.
    G1,
    /// Exact for polynomials of degree 2.
    G3,
    /// Degree 3.
    G4,
    /// Degree 5.
    G7,
    /// Degree 7.
    G12,
    /// Equal shares: the centre, and rings of 6 and 12.
    E19,
    /// Degree 9.
    G21,
    /// Equal shares: the centre, and rings of 6, 12 and 18.
    E37,
}

impl DiscRule {
    /// All of them, from few points to many.
    pub const ALL: [DiscRule; 8] = [
        DiscRule::G1,
        DiscRule::G3,
        DiscRule::G4,
        DiscRule::G7,
        DiscRule::G12,
        DiscRule::E19,
        DiscRule::G21,
        DiscRule::E37,
    ];

    /// The one with this number of points.
    pub fn of_count(points: usize) -> Option<Self> {
        DiscRule::ALL.into_iter().find(|rule| rule.count() == points)
    }

    /// The rule of the fewest points, more than one, whose error is within a tolerance; the most exact one if none is.
    pub fn fewest(error: impl Fn(DiscRule) -> f64, tolerance: f64) -> DiscRule {
        let enough = DiscRule::ALL.into_iter().filter(|rule| *rule != DiscRule::G1 && error(*rule) <= tolerance);
        enough.min_by_key(|rule| rule.count()).unwrap_or(DiscRule::E37)
    }

    /// Number of points.
    pub fn count(self) -> usize {
        match self {
            DiscRule::G1 => 1,
            DiscRule::G3 => 3,
            DiscRule::G4 => 4,
            DiscRule::G7 => 7,
            DiscRule::G12 => 12,
            DiscRule::E19 => 19,
            DiscRule::G21 => 21,
            DiscRule::E37 => 37,
        }
    }

    /// \[x, y, share\] of each point; shares sum to 1.
    ///
    /// Source: Stroud (1971), *Approximate Calculation of Multiple Integrals*, S2; equal shares: each ring at the radius that halves its area.
    pub fn points(self) -> Vec<[f64; 3]> {
        let ring = |radius: f64, count: u32, turn: f64, share: f64| {
            (0..count).map(move |k| {
                let (sin, cos) = (2.0 * PI * (f64::from(k) + turn) / f64::from(count)).sin_cos();
                [radius * cos, radius * sin, share]
            })
        };
        // Turned against one another, so that an edge passes as few points as possible at once.
        let equal = |rings: &[(u32, f64)]| {
            let all: u32 = rings.iter().map(|(count, _)| count).sum();
            let share = 1.0 / f64::from(all);
            let mut inside = 0.0;
            let mut points = Vec::new();
            for &(count, turn) in rings {
                let radius = if count == 1 { 0.0 } else { ((inside + 0.5 * f64::from(count)) * share).sqrt() };
                points.extend(ring(radius, count, turn, share));
                inside += f64::from(count);
            }
            points
        };
        match self {
            DiscRule::G1 => ring(0.0, 1, 0.0, 1.0).collect(),
            DiscRule::G3 => ring(0.5f64.sqrt(), 3, 0.0, 1.0 / 3.0).collect(),
            DiscRule::G4 => ring(0.5f64.sqrt(), 4, 0.0, 0.25).collect(),
            DiscRule::G7 => ring(0.0, 1, 0.0, 0.25).chain(ring((2.0f64 / 3.0).sqrt(), 6, 0.0, 0.125)).collect(),
            DiscRule::G12 => {
                let root = 29f64.sqrt();
                let diagonal = |sign: f64| {
                    let radius = ((27.0 - sign * 3.0 * root) / 52.0).sqrt();
                    ring(radius, 4, 0.5, (551.0 + sign * 41.0 * root) / 6264.0)
                };
                ring(0.75f64.sqrt(), 4, 0.0, 2.0 / 27.0).chain(diagonal(1.0)).chain(diagonal(-1.0)).collect()
            }
            DiscRule::E19 => equal(&[(1, 0.0), (6, 0.7243), (12, 0.9501)]),
            DiscRule::G21 => {
                let root = 6f64.sqrt();
                let of = |sign: f64| ring(((6.0 - sign * root) / 10.0).sqrt(), 10, 0.0, (16.0 + sign * root) / 360.0);
                ring(0.0, 1, 0.0, 1.0 / 9.0).chain(of(1.0)).chain(of(-1.0)).collect()
            }
            DiscRule::E37 => equal(&[(1, 0.0), (6, 0.5746), (12, 0.1148), (18, 0.1691)]),
        }
    }

    /// The same of a disc with limb darkening 1 - u (1 - sqrt(1 - r^2)), u from 0 to 1.
    pub fn darkened_points(self, limb_darkening: f64) -> Vec<[f64; 3]> {
        let mut points = self.points();
        for [x, y, share] in &mut points {
            *share *= 1.0 - limb_darkening * (1.0 - (1.0 - *x * *x - *y * *y).max(0.0).sqrt());
        }
        let all: f64 = points.iter().map(|point| point[2]).sum();
        points.iter_mut().for_each(|point| point[2] /= all);
        points
    }

    /// The largest error of the visible share of a uniform disc beyond a straight edge, over all edges.
    pub fn share_error(self) -> f64 {
        const TURNS: u32 = 180;
        let points = self.points();
        let mut worst = 0.0_f64;
        for turn in 0..TURNS {
            let (sin, cos) = (PI * f64::from(turn) / f64::from(TURNS)).sin_cos();
            let mut along: Vec<(f64, f64)> = points.iter().map(|[x, y, share]| (x * cos + y * sin, *share)).collect();
            along.sort_by(|a, b| a.0.total_cmp(&b.0));
            // The sum steps at each point; between them the share grows.
            let mut below = 0.0;
            for (x, share) in along {
                let exact = share_beyond_edge(x, 0.0);
                worst = worst.max((exact - below).abs()).max((exact - below - share).abs());
                below += share;
            }
        }
        worst
    }

    /// Irradiance by the limb that is above all points, in radii of the disc times that at normal incidence: the most that a facet has whose horizon
    /// all points are below. Of one point [2 / (3 pi)](super::bounds::terminator).
    pub fn limb_error(self) -> f64 {
        const TURNS: u32 = 360;
        // So small that the disc is flat.
        const RADIUS: f64 = 1e-3;
        let points = self.points();
        let highest = |turn: u32| {
            let (sin, cos) = (2.0 * PI * f64::from(turn) / f64::from(TURNS)).sin_cos();
            points.iter().map(|[x, y, _]| x * cos + y * sin).fold(f64::NEG_INFINITY, f64::max)
        };
        let lowest = (0..TURNS).map(highest).fold(f64::INFINITY, f64::min);
        irradiance_on_facet(-lowest * RADIUS, RADIUS, 0.0) / RADIUS
    }

    /// c, the largest error behind a straight edge: of the visible share, integrated across the penumbra over any interval, in radii of the disc.
    ///
    /// With a Sun of angular radius s and an edge at distance d, a pixel of size p is off by at most sqrt(2) c s d / p of its sunlit radiance.
    /// This is the worst over all directions of the edge and all intervals; over those that reach beyond the penumbra it is 0.5 to 1 times as large.
    pub fn edge_error(self) -> f64 {
        match self {
            DiscRule::G1 => 0.2123,
            DiscRule::G3 => 0.1202,
            DiscRule::G4 => 0.0779,
            DiscRule::G7 => 0.0498,
            DiscRule::G12 => 0.0245,
            DiscRule::E19 => 0.0096,
            DiscRule::G21 => 0.0165,
            DiscRule::E37 => 0.0045,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_share_changes_more_than_the_steepest() {
        // Of a uniform disc 2 / pi.
        assert!((steepest_share(0.0) - 0.636_619_772_367_581_3).abs() < 1e-15);
        for u in [0.0, 0.3, 0.6, 1.0] {
            let across = (share_beyond_edge(1e-4, u) - share_beyond_edge(-1e-4, u)) / 2e-4;
            assert!((across / steepest_share(u) - 1.0).abs() < 1e-6, "{u}: {across}");
            for radius in [0.3, 1.0, 2.0, 100.0] {
                let near = radius - 1.0_f64;
                for k in 0..400 {
                    let distance = near.abs() + 2.0 * f64::from(k) / 400.0;
                    let step = share_beside_disc(radius, distance + 1e-3, u) - share_beside_disc(radius, distance, u);
                    // Shares are sums, good to some 1e-6.
                    assert!(step.abs() <= 1.005 * 1e-3 * steepest_share(u), "{u} {radius} {distance}: {step}");
                }
            }
        }
    }

    #[test]
    fn behind_a_straight_edge() {
        // (x, u, share), computed independently.
        for (x, u, expected) in [
            (-1.0, 0.0, 0.0),
            (-0.5, 0.0, 0.195_501_109_477_885_32),
            (0.0, 0.0, 0.5),
            (0.25, 0.0, 0.657_481_178_762_853_7),
            (-0.5, 0.6, 0.175_875_554_738_942_65),
            (0.5, 0.6, 0.824_124_445_261_057_3),
            (-0.5, 0.15, 0.191_369_413_743_371_08),
            (1.0, 0.6, 1.0),
        ] {
            assert!((share_beyond_edge(x, u) - expected).abs() < 1e-15, "{x} {u}");
        }
        assert_eq!((share_beyond_edge(-3.0, 0.3), share_beyond_edge(3.0, 0.0)), (0.0, 1.0));
    }

    #[test]
    fn over_a_flat_horizon() {
        // Elevation in radii, over the irradiance at normal incidence, at 1.523679 au: computed independently as F(s, theta) / sin^2 s.
        let s = crate::units::SUN_RADIUS_M / (1.523_679 * crate::units::AU_M);
        for (radii, expected) in [
            (-1.0, 0.0),
            (-0.5, 0.000_122_335_022_110_294_4),
            (0.0, 0.000_647_684_033_820_351_6),
            (1.0, 0.003_052_130_574_065_901),
            (3.0, 0.009_156_277_993_695_54),
        ] {
            let sin_elevation = (radii * s.asin()).sin();
            assert!((irradiance_on_facet(sin_elevation, s, 0.0) - expected).abs() < 1e-11, "{radii}");
        }
        // The integral of the share beyond an edge, by the midpoint rule.
        for u in [0.0, 0.3, 1.0] {
            for x in [-1.0, -0.9, -0.3, 0.2, 0.99, 1.0] {
                let n = 4000;
                let step = (x + 1.0) / f64::from(n);
                let at = |i: i32| share_beyond_edge(-1.0 + step * (f64::from(i) + 0.5), u);
                let expected = s * step * (0..n).map(at).sum::<f64>();
                assert!((irradiance_on_facet(x * s, s, u) - expected).abs() < 5e-6 * s, "{u} {x}");
            }
        }
        assert_eq!(irradiance_on_facet(-0.1, s, 0.5), 0.0);
    }

    #[test]
    fn a_disc_that_is_up_is_a_point() {
        let middle = Direction::new(DVec3::new(0.3, -0.5, 0.8)).unwrap();
        for rule in DiscRule::ALL {
            let sum = sub_suns(middle, 3e-3, 0.4, rule).iter().map(|sub| sub.share * sub.towards).sum::<DVec3>();
            assert!((sum - middle.vec()).length() < 1e-14, "{rule:?}");
            let farthest = |sub: &SubSun| Direction::new(sub.towards).unwrap().angle_rad(middle);
            assert!(sub_suns(middle, 3e-3, 0.4, rule).iter().all(|sub| farthest(sub) <= 3e-3));
        }
    }

    #[test]
    fn behind_a_disc() {
        // (radius, distance, share), computed independently.
        for (radius, distance, expected) in [
            (1.0, 1.0, 0.608_997_781_044_229_4),
            (2.0, 2.5, 0.833_708_771_420_076_9),
            (70.0, 70.3, 0.689_392_768_539_050_1),
            (2.0, 3.0, 1.0),
            (2.0, 1.0, 0.0),
            (0.5, 0.5, 0.75),
            (0.5, 0.0, 0.75),
        ] {
            assert!((share_beside_disc(radius, distance, 0.0) - expected).abs() < 1e-12, "{radius} {distance}");
        }
        // A disc of endless radius is a straight edge.
        assert!((share_beside_disc(1e6, 1e6 + 0.25, 0.0) - share_beyond_edge(0.25, 0.0)).abs() < 1e-6);
        for (u, x) in [(0.3, -0.9), (0.6, -0.5), (0.6, 0.5), (1.0, 0.25), (0.6, 1.0), (0.6, -1.0)] {
            assert!((share_beside_disc(1e7, 1e7 + x, u) - share_beyond_edge(x, u)).abs() < 2e-6, "{u} {x}");
        }
        // Small, large, inside and across: by rings and sectors of equal light.
        for (radius, distance) in
            [(0.3_f64, 0.5_f64), (0.3, 0.0), (0.3, 0.1), (0.5, 0.8), (2.0, 1.5), (2.0, 2.4), (1.0, 1e-3), (0.999, 0.01)]
        {
            let (rings, sectors, u) = (400, 800, 0.7);
            let (mut all, mut shown) = (0.0, 0.0);
            for i in 0..rings {
                let r = (f64::from(i) + 0.5) / f64::from(rings);
                let light = r * (1.0 - u * (1.0 - (1.0 - r * r).sqrt()));
                for k in 0..sectors {
                    let (sin, cos) = (2.0 * PI * (f64::from(k) + 0.5) / f64::from(sectors)).sin_cos();
                    all += light;
                    shown += if (r * cos - distance).hypot(r * sin) > radius { light } else { 0.0 };
                }
            }
            let got = share_beside_disc(radius, distance, u);
            assert!((got - shown / all).abs() < 2e-3, "{radius} {distance}: {got} {}", shown / all);
        }
    }

    #[test]
    fn beside_a_sphere_the_sun_is_cut_by_its_limb() {
        let (r, d) = (3_389.5, 9_376.0);
        let (alpha, s) = (f64::asin(r / d), 3.05e-3_f64);
        let towards = |beyond: f64| {
            let (sin, cos) = (alpha + beyond * s.asin()).sin_cos();
            DVec3::new(sin, 0.0, cos)
        };
        let share = |beyond: f64, u: f64| share_beside_sphere(towards(beyond), s, u, d * DVec3::Z, r);
        assert_eq!(
            [share(1.01, 0.4), share(-1.01, 0.4), share_beside_sphere(DVec3::NEG_Z, s, 0.0, d * DVec3::Z, r)],
            [1.0, 0.0, 1.0]
        );
        // Points of the disc whose rays miss the sphere.
        let sun = |beyond: f64| Direction::new(towards(beyond)).unwrap();
        for (beyond, u) in [(0.0, 0.0), (0.5, 0.0), (-0.3, 0.6), (-0.9, 0.6)] {
            let (middle, (h, v)) = (sun(beyond).vec(), sun(beyond).frame());
            let (mut all, mut shown) = (0.0, 0.0);
            for i in 0..300 {
                let ring = (f64::from(i) + 0.5) / 300.0;
                let light = ring * (1.0 - u * (1.0 - (1.0 - ring * ring).sqrt()));
                for k in 0..600 {
                    let (sin, cos) = (2.0 * PI * f64::from(k) / 600.0).sin_cos();
                    let ray = (middle + s * ring * (cos * h + sin * v)).normalize();
                    all += light;
                    shown += if ray.cross(d * DVec3::Z).length() > r { light } else { 0.0 };
                }
            }
            assert!(
                (share(beyond, u) - shown / all).abs() < 2e-3,
                "{beyond} {u}: {} {}",
                share(beyond, u),
                shown / all
            );
        }
    }

    #[test]
    fn rules_integrate_polynomials() {
        // Mean of x^(2a) y^(2b) over the unit disc: (2a - 1)!! (2b - 1)!! / (2^(a + b) (a + b + 1)!).
        let odd = |n: i32| (1..=n).map(|k| f64::from(2 * k - 1)).product::<f64>();
        let mean =
            |a: i32, b: i32| odd(a) * odd(b) / (2f64.powi(a + b) * (1..=a + b + 1).map(f64::from).product::<f64>());
        let degrees = [1, 2, 3, 5, 7, 1, 9, 1];
        for (rule, degree) in DiscRule::ALL.into_iter().zip(degrees) {
            let points = rule.points();
            assert!(points.iter().all(|[x, y, share]| x.hypot(*y) < 1.0 && *share > 0.0), "{rule:?}");
            for i in 0..=degree {
                for j in 0..=degree - i {
                    let sum: f64 = points.iter().map(|[x, y, share]| share * x.powi(i) * y.powi(j)).sum();
                    let expected = if i % 2 == 0 && j % 2 == 0 { mean(i / 2, j / 2) } else { 0.0 };
                    assert!((sum - expected).abs() < 1e-15, "{rule:?} {i} {j}: {sum} {expected}");
                }
            }
        }
        assert_eq!(DiscRule::ALL.map(|rule| rule.points().len()), DiscRule::ALL.map(DiscRule::count));
    }

    #[test]
    fn darkened_points_are_brightest_amid_the_disc() {
        for rule in DiscRule::ALL {
            let points = rule.darkened_points(0.6);
            assert!((points.iter().map(|p| p[2]).sum::<f64>() - 1.0).abs() < 1e-14);
            assert_eq!(rule.darkened_points(0.0).len(), points.len());
        }
        // Of the whole light of a disc with u = 0.6, the inner half of the area sends 0.5708: (1 - u (1 - 2/3 (1 - 2^(-3/2)) 2)) / 2 over 1 - u / 3.
        let inner: f64 =
            DiscRule::E37.darkened_points(0.6).iter().filter(|p| p[0] * p[0] + p[1] * p[1] < 0.5).map(|p| p[2]).sum();
        let exact = (0.4 * 0.5 + 0.6 * 2.0 / 3.0 * (1.0 - 0.5f64.powf(1.5))) / 0.8;
        assert!((inner - exact).abs() < 0.03, "{inner} {exact}");
    }

    /// Integral of the uniform share from -1 to x.
    fn light_up_to(x: f64) -> f64 {
        let root = ((1.0 - x) * (1.0 + x)).max(0.0).sqrt();
        0.5 * (x + 1.0) + (x * x.asin() + root - root.powi(3) / 3.0) / PI - 0.5
    }

    #[test]
    fn no_edge_is_off_by_more_than_its_bound() {
        assert!((light_up_to(1.0) - 1.0).abs() < 1e-15 && light_up_to(-1.0).abs() < 1e-15);
        for rule in DiscRule::ALL {
            let mut worst = 0.0_f64;
            for turn in 0..720 {
                let (sin, cos) = (PI * f64::from(turn) / 720.0).sin_cos();
                let points: Vec<_> = rule.points().iter().map(|[x, y, share]| (x * cos + y * sin, *share)).collect();
                let off =
                    |x: f64| points.iter().map(|(p, share)| share * (x - p).max(0.0)).sum::<f64>() - light_up_to(x);
                let offs: Vec<f64> = (-500..=500).map(|k| off(f64::from(k) / 500.0)).collect();
                let (low, high) = offs.iter().fold((0.0_f64, 0.0_f64), |(low, high), &v| (low.min(v), high.max(v)));
                worst = worst.max(high - low);
            }
            assert!(worst <= rule.edge_error() && worst > 0.95 * rule.edge_error(), "{rule:?}: {worst}");
        }
        // 2 / (3 pi); four points leave what is above half of the radius.
        let [one, four] = [DiscRule::G1, DiscRule::G4].map(DiscRule::limb_error);
        assert!((one - 2.0 / (3.0 * PI)).abs() < 1e-5 && (four - light_up_to(-0.5)).abs() < 2e-4, "{one} {four}");
        // All of the light at once is half of it off; of many points a few at a time.
        let [one, seven, many] = [DiscRule::G1, DiscRule::G7, DiscRule::E37].map(DiscRule::share_error);
        assert!(one == 0.5 && seven < 0.3 && many < 0.5 * seven, "{one} {seven} {many}");
        // A point Sun: 2 / (3 pi).
        assert!((DiscRule::G1.edge_error() - 2.0 / (3.0 * PI)).abs() < 1e-3);
    }
}
