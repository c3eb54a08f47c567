//! Mars-light on the many facets of one scene.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::GaussLegendre;
use super::mars::{Wave, common_arcs, irradiance_vector};
use crate::geometry::{Direction, Vectors};

/// E / (rho E_S) of [`mars::irradiance`](super::mars::irradiance) for the facets of one scene, at the cost of a few dozen multiplications.
///
/// Distance D and phase angle are taken at each facet's own place; both vary little over a scene, and how is tabulated:
///
/// - whole disc above the facet: n.V, V by quadratic interpolation in (D, cos phase);
/// - disc cut by the facet's horizon: a table over tau = asin(-(n.c) / q), -pi/2 where the disc has just risen and pi/2 where it
///   has just set, and the cosine of the normal's azimuth about the direction c to Mars, 1 towards the Sun's side;
///   cubic in both, linear in D and half phase;
/// - disc below: 0.
///
/// Error relative to the irradiance on a facet that faces a full Mars: below 1e-5 where the disc is cut, 3e-8 where it is whole,
/// over the whole of Phobos as over a site of 2 km (tested at 9 and 13 phase angles; 6e-6 is the largest seen).
/// One value costs some 40 ns, where the disc is cut 100 to 160 ns; `new` 5 ms.
#[derive(Debug, Clone)]
pub struct MarsLight {
    centre_m: DVec3,
    radius_m: f64,
    sun: DVec3,
    distance_m: Range,
    cos_phase: Range,
    half_phase: Range,
    /// (a, w) of [`irradiance_vector`] at the ends and the middle of the ranges of distance and cos phase.
    vector: [[(f64, f64); 3]; 3],
    /// Irradiance / q^3 at (distance, half phase) = (low, low), (low, high), (high, low), (high, high), for each azimuth and tau.
    horizon: Vec<[f64; 4]>,
}

/// Mars, seen from a facet.
struct Sight {
    to_centre: DVec3,
    distance_m: f64,
    sin_radius: f64,
    cos_tilt: f64,
    cos_phase: f64,
}

/// Intervals of tau.
const TAUS: usize = 48;
/// Intervals of the cosine of azimuth: the irradiance is even in azimuth, so smooth in its cosine.
const AZIMUTHS: usize = 32;

impl MarsLight {
    /// Prepares for facets within the box from `low_m` to `high_m`, in the coordinates of `centre_m`, the centre of Mars.
    ///
    /// Facets outside the box are extrapolated to; a box that reaches into Mars is used as far as it does not.
    pub fn new(centre_m: DVec3, radius_m: f64, sun: Direction, low_m: DVec3, high_m: DVec3) -> Self {
        let middle_m = 0.5 * (low_m + high_m);
        let to_centre_m = centre_m - middle_m;
        let distance_m = to_centre_m.length();
        // A point scene needs ranges too: 1e-6 of the distance.
        let reach_m = (0.5 * (high_m - low_m).length()).max(1e-6 * distance_m);
        let nearest_m = 1.000_001 * radius_m;
        let distance_m = distance_m.max(nearest_m);
        let distance_range = Range::new((distance_m - reach_m).max(nearest_m), distance_m + reach_m);
        let phase_rad = crate::geometry::angle_rad(-to_centre_m, sun.vec());
        let turn_rad = (reach_m / distance_m).min(1.0).asin();
        let (low, high) = ((phase_rad - turn_rad).max(0.0), (phase_rad + turn_rad).min(PI));
        let cos_phase = Range::new(high.cos(), low.cos());
        let vector = distance_range
            .thirds()
            .map(|distance_m| cos_phase.thirds().map(|cos_phase| irradiance_vector(radius_m / distance_m, cos_phase)));
        let mut light = MarsLight {
            centre_m,
            radius_m,
            sun: sun.vec(),
            distance_m: distance_range,
            cos_phase,
            half_phase: Range::new(half_phase(cos_phase.high), half_phase(cos_phase.low)),
            vector,
            horizon: vec![[0.0; 4]; (AZIMUTHS + 1) * (TAUS + 1)],
        };
        light.fill_horizon();
        light
    }

    /// E / (rho E_S) on a facet at `position_m` with unit `normal`.
    pub fn irradiance(&self, position_m: DVec3, normal: DVec3) -> f64 {
        let sight = self.sight(position_m, normal);
        let Sight { to_centre, distance_m, sin_radius, cos_tilt, cos_phase } = sight;
        if cos_tilt <= -sin_radius || sin_radius >= 1.0 {
            return 0.0;
        }
        if cos_tilt >= sin_radius {
            return self.of_whole_disc(&sight, normal);
        }
        let across = self.sun + cos_phase * to_centre;
        // Along the Sun's side, and square to it; both times sin(phase).
        let n_1 = normal.dot(across);
        let n_2 = normal.dot(to_centre.cross(across));
        let tau = (-cos_tilt / sin_radius).asin();
        let corner = corners(self.distance_m.share(distance_m), self.half_phase.share(half_phase(cos_phase)));
        // Facet, Mars and Sun in line: no azimuth differs from another.
        let length = (n_1 * n_1 + n_2 * n_2).sqrt();
        let cos_azimuth = if length > 0.0 { n_1 / length } else { 0.0 };
        self.horizon_at(corner, cos_azimuth, tau) * sin_radius.powi(3)
    }

    /// Writes [`irradiance`](MarsLight::irradiance) on many facets: positions, unit normals and results are of the same number.
    pub fn irradiances(&self, positions_m: &Vectors, normals: &Vectors, irradiance: &mut [f64]) {
        // Where the disc is whole there is nothing to decide, so that several facets are computed at once; the others are marked.
        const OTHER: f64 = -1.0;
        for ((position_m, normal), irradiance) in positions_m.iter().zip(normals.iter()).zip(&mut *irradiance) {
            let sight = self.sight(position_m, normal);
            let of_whole_disc = self.of_whole_disc(&sight, normal);
            let is_whole = (sight.cos_tilt >= sight.sin_radius) & (sight.sin_radius < 1.0);
            *irradiance = if is_whole { of_whole_disc } else { OTHER };
        }
        for (k, irradiance) in irradiance.iter_mut().enumerate().filter(|(_, irradiance)| **irradiance == OTHER) {
            *irradiance = self.irradiance(positions_m.get(k), normals.get(k));
        }
    }

    #[inline(always)]
    fn sight(&self, position_m: DVec3, normal: DVec3) -> Sight {
        let to_centre_m = self.centre_m - position_m;
        let distance_m = to_centre_m.length();
        let per_m = 1.0 / distance_m;
        let to_centre = to_centre_m * per_m;
        Sight {
            to_centre,
            distance_m,
            sin_radius: self.radius_m * per_m,
            cos_tilt: normal.dot(to_centre),
            cos_phase: -self.sun.dot(to_centre),
        }
    }

    #[inline(always)]
    fn of_whole_disc(&self, sight: &Sight, normal: DVec3) -> f64 {
        let (a, w) = self.vector_at(sight.distance_m, sight.cos_phase);
        (a * sight.cos_tilt + w * normal.dot(self.sun)).max(0.0)
    }

    #[inline(always)]
    fn vector_at(&self, distance_m: f64, cos_phase: f64) -> (f64, f64) {
        let along = quadratic(self.distance_m.share(distance_m));
        let across = quadratic(self.cos_phase.share(cos_phase));
        let mut sum = (0.0, 0.0);
        for (row, x) in self.vector.iter().zip(along) {
            for ((a, w), y) in row.iter().zip(across) {
                sum = (sum.0 + x * y * a, sum.1 + x * y * w);
            }
        }
        sum
    }

    fn horizon_at(&self, corner: [f64; 4], cos_azimuth: f64, tau: f64) -> f64 {
        let (first_row, row_weights) = stencil((tau / PI + 0.5) * TAUS as f64, TAUS + 1);
        let (first_column, column_weights) = stencil((0.5 + 0.5 * cos_azimuth) * AZIMUTHS as f64, AZIMUTHS + 1);
        let mut sums = [0.0; 4];
        for (i, x) in column_weights.iter().enumerate() {
            let start = (first_column + i) * (TAUS + 1) + first_row;
            for (values, y) in self.horizon[start..start + 4].iter().zip(&row_weights) {
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum += x * y * value;
                }
            }
        }
        sums.iter().zip(&corner).map(|(sum, c)| sum * c).sum::<f64>().max(0.0)
    }

    /// Fills the table, column by column, from the setting of the disc backwards.
    ///
    /// Let the normal turn by theta in a plane with c, away from Mars. As E is the flux through the plane of the facet,
    /// E'' + E = h(theta), the integral of L cos^2(beta) along the horizon, beta measured from the point of it that is nearest to c
    /// (the rest of the disc moves with the cosine law, whose second derivative is -E). With E = E' = 0 at the set disc:
    /// E(theta) = integral of h(x) sin(x - theta) dx from theta on.
    fn fill_horizon(&mut self) {
        let rule = GaussLegendre::new(2);
        let step = PI / TAUS as f64;
        let places = [self.distance_m.low, self.distance_m.high].map(|distance_m| {
            [self.half_phase.low, self.half_phase.high].map(|half_phase| (distance_m, 2.0 * half_phase.asin()))
        });
        for (corner, &(distance_m, phase_rad)) in places.as_flattened().iter().enumerate() {
            let q = self.radius_m / distance_m;
            for column in 0..=AZIMUTHS {
                let cos_azimuth = 2.0 * column as f64 / AZIMUTHS as f64 - 1.0;
                let slice = Slice::new(q, phase_rad, cos_azimuth);
                // Integrals of h sin(x) dx and h cos(x) dx.
                let (mut by_sin, mut by_cos) = (0.0, 0.0);
                for row in (0..TAUS).rev() {
                    let tau = -FRAC_PI_2 + step * row as f64;
                    for (tau, weight) in rule.nodes(tau, tau + step) {
                        let (sin, cos) = slice.tilt(tau);
                        // dx = (q cos(tau) / sin(x)) dtau
                        let h_dx = slice.horizon_integral(tau) * q * tau.cos() / sin * weight;
                        by_sin += h_dx * sin;
                        by_cos += h_dx * cos;
                    }
                    let (sin, cos) = slice.tilt(tau);
                    self.horizon[column * (TAUS + 1) + row][corner] =
                        (cos * by_sin - sin * by_cos).max(0.0) / q.powi(3);
                }
            }
        }
    }
}

/// The plane through c in which a normal turns, lengths in units of the distance to the centre of Mars.
struct Slice {
    q: f64,
    /// The Sun along c, along the way the normal turns, and along c x that way.
    sun: DVec3,
}

impl Slice {
    fn new(q: f64, phase_rad: f64, cos_azimuth: f64) -> Self {
        let (sin, cos) = phase_rad.sin_cos();
        let sin_azimuth = ((1.0 - cos_azimuth) * (1.0 + cos_azimuth)).sqrt();
        Slice { q, sun: DVec3::new(-cos, sin * cos_azimuth, -sin * sin_azimuth) }
    }

    /// Sine and cosine of the angle between normal and c at tau.
    fn tilt(&self, tau: f64) -> (f64, f64) {
        let cos = -self.q * tau.sin();
        (((1.0 - cos) * (1.0 + cos)).sqrt(), cos)
    }

    /// Integral of (m.s)+ / pi cos^2(beta) dbeta along the facet's horizon, beta from the horizon's point nearest to c.
    ///
    /// The horizon cuts Mars in a circle of radius k = q cos(tau) whose centre is d = sin(theta) away; eta is the angle in it, 0 towards
    /// the facet: seen where cos(eta) > k / d, lit where m.s = mean + amplitude cos(eta - crest) is positive.
    /// With x = d^2 + k^2 - 2 d k cos(eta), the squared distance of the point, and D = d^2 - k^2,
    /// cos^2(beta) dbeta = (D + x)^2 (D - x) / (8 d^2 x^2) deta, whose products with 1, cos(eta), sin(eta) have elementary integrals.
    fn horizon_integral(&self, tau: f64) -> f64 {
        let (d, cos) = self.tilt(tau);
        let k = self.q * tau.cos();
        let towards = d * self.sun.x - cos * self.sun.y;
        let upwards = cos * self.sun.x + d * self.sun.y;
        let lit = Wave {
            mean: -cos * upwards / self.q,
            amplitude: k * towards.hypot(self.sun.z) / self.q,
            crest: self.sun.z.atan2(-towards),
        };
        let (by_cos, by_sin) = (-k * towards / self.q, k * self.sun.z / self.q);
        let (sum, delta, product) = (d * d + k * k, (d - k) * (d + k), 2.0 * d * k);
        let antiderivative = |eta: f64| {
            let (sin_eta, cos_eta) = eta.sin_cos();
            let x = sum - product * cos_eta;
            // Integrals over eta of x^-1, x^-2, x, x^2.
            let inverse = 2.0 / delta * ((d + k) / (d - k) * (0.5 * eta).tan()).atan();
            let inverse_square = (sum * inverse + product * sin_eta / x) / (delta * delta);
            let first = sum * eta - product * sin_eta;
            let second =
                sum * sum * eta - 2.0 * sum * product * sin_eta + 0.5 * product * product * (eta + sin_eta * cos_eta);
            // Of the kernel times 8 d^2, and of x times that.
            let kernel = delta * (delta * (delta * inverse_square + inverse) - eta) - first;
            let x_kernel = delta * (delta * (delta * inverse + eta) - first) - second;
            let cos_kernel = (sum * kernel - x_kernel) / product;
            let sin_kernel = (delta * (delta * (x.ln() - delta / x) - x) - 0.5 * x * x) / product;
            lit.mean * kernel + by_cos * cos_kernel + by_sin * sin_kernel
        };
        let arcs = common_arcs((0.0, (k / d).acos()), (lit.crest, lit.half_arc()));
        let integral: f64 = arcs
            .iter()
            .filter(|(from, to)| to > from)
            .map(|(from, to)| antiderivative(*to) - antiderivative(*from))
            .sum();
        integral / (8.0 * PI * d * d)
    }
}

/// An interval over which something is interpolated.
#[derive(Debug, Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
    /// 1 / (high - low): a division here, not for every facet.
    per_length: f64,
}

impl Range {
    fn new(low: f64, high: f64) -> Self {
        Range { low, high, per_length: 1.0 / (high - low) }
    }

    /// Ends and middle.
    fn thirds(&self) -> [f64; 3] {
        [self.low, 0.5 * (self.low + self.high), self.high]
    }

    /// Where `x` lies: 0 at the low end, 1 at the high end.
    fn share(&self, x: f64) -> f64 {
        (x - self.low) * self.per_length
    }
}

/// Sine of half the phase angle: as good a coordinate as the angle, and cheaper.
fn half_phase(cos_phase: f64) -> f64 {
    (0.5 * (1.0 - cos_phase)).max(0.0).sqrt().min(1.0)
}

/// Lagrange weights on 0, 1/2, 1.
fn quadratic(x: f64) -> [f64; 3] {
    [(2.0 * x - 1.0) * (x - 1.0), 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)]
}

/// Bilinear weights of (0, 0), (0, 1), (1, 0), (1, 1).
fn corners(x: f64, y: f64) -> [f64; 4] {
    [(1.0 - x) * (1.0 - y), (1.0 - x) * y, x * (1.0 - y), x * y]
}

/// First of four neighbouring nodes about `at`, of `count` nodes 0, 1, ..., and Lagrange cubic weights on them.
fn stencil(at: f64, count: usize) -> (usize, [f64; 4]) {
    // NaN becomes node 0, and the weights stay NaN.
    #[expect(clippy::cast_possible_truncation, reason = "`as` takes what is beyond all nodes to an end")]
    let first = (at as usize).saturating_sub(1).min(count - 4);
    let x = at - first as f64;
    let weights = [
        (x - 1.0) * (x - 2.0) * (x - 3.0) * (-1.0 / 6.0),
        x * (x - 2.0) * (x - 3.0) * 0.5,
        x * (x - 1.0) * (x - 3.0) * -0.5,
        x * (x - 1.0) * (x - 2.0) * (1.0 / 6.0),
    ];
    (first, weights)
}

/// Largest error of [`MarsLight`], relative to the light on a facet that faces a full Mars.
pub const MARS_LIGHT_ERROR: f64 = 1e-5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::mars;
    use crate::units::MARS_RADIUS_M;

    const CENTRE_M: DVec3 = DVec3::new(9.376e6, 0.0, 0.0);
    /// On a facet that faces a full Mars.
    const FULL: f64 = 0.108_426;

    /// Points that fill the unit cube evenly: R. Kronecker's sequence.
    fn fill(i: usize) -> DVec3 {
        let i = i as f64 + 0.5;
        DVec3::new((i * 0.819_172_513_4).fract(), (i * 0.671_043_606_7).fract(), (i * 0.549_700_477_9).fract())
    }

    fn sun(phase_deg: f64) -> Direction {
        let (s, c) = f64::to_radians(phase_deg).sin_cos();
        Direction::new(DVec3::new(-c, s * 0.8, s * 0.6)).unwrap()
    }

    /// Largest error of facets cut by their horizon and of those that are not, over a full facing Mars; and how many there were.
    fn worst(phase_deg: f64, half_box_m: f64, offset_m: DVec3) -> ([f64; 2], [usize; 2]) {
        let sun = sun(phase_deg);
        let half = DVec3::splat(half_box_m);
        let light = MarsLight::new(CENTRE_M, MARS_RADIUS_M, sun, offset_m - half, offset_m + half);
        let (mut worst, mut count) = ([0.0f64; 2], [0; 2]);
        for i in 0..3000 {
            let position_m = offset_m + half_box_m * (2.0 * fill(i) - 1.0);
            let to_mars = (CENTRE_M - position_m).normalize();
            let (azimuth, share) = (2.0 * PI * fill(i + 7).x, fill(i + 13).y);
            let c = if i % 4 == 0 { share } else { 0.361 * (2.0 * share - 1.0) };
            let (h, v) = Direction::new(to_mars).unwrap().frame();
            let normal = c * to_mars + (1.0 - c * c).sqrt() * (azimuth.cos() * h + azimuth.sin() * v);
            let expected = mars::irradiance(CENTRE_M - position_m, MARS_RADIUS_M, normal, sun.vec());
            let got = light.irradiance(position_m, normal);
            let whole = usize::from(c >= MARS_RADIUS_M / (CENTRE_M - position_m).length());
            worst[whole] = worst[whole].max((got - expected).abs() / FULL);
            count[whole] += 1;
        }
        (worst, count)
    }

    #[test]
    fn a_site_of_2_km_is_good_to_1e_5() {
        for phase_deg in [0.0, 10.0, 30.0, 60.0, 75.0, 90.0, 100.0, 110.0, 120.0, 135.0, 150.0, 158.0, 180.0] {
            let (worst, count) = worst(phase_deg, 1e3, DVec3::new(9e3, 2e3, -4e3));
            assert!(count[0] > 1500 && count[1] > 400, "{count:?}");
            assert!(worst[0] < 1e-5 && worst[1] < 1e-8, "{phase_deg}: {worst:?}");
        }
    }

    #[test]
    fn the_whole_moon_is_as_good() {
        for phase_deg in [0.0, 0.5, 20.0, 60.0, 90.0, 110.0, 130.0, 157.0, 179.9] {
            let (worst, count) = worst(phase_deg, 13e3, DVec3::ZERO);
            assert!(count[0] > 1500 && count[1] > 400, "{count:?}");
            assert!(worst[0] < 1e-5 && worst[1] < 3e-8, "{phase_deg}: {worst:?}");
        }
    }

    #[test]
    fn a_point_scene_and_one_inside_mars_give_numbers() {
        let light = MarsLight::new(CENTRE_M, MARS_RADIUS_M, sun(0.0), DVec3::ZERO, DVec3::ZERO);
        assert!((light.irradiance(DVec3::ZERO, DVec3::X) / FULL - 1.0).abs() < 1e-5);
        let inside = MarsLight::new(DVec3::ZERO, 1.0, sun(0.0), DVec3::NEG_ONE, DVec3::ONE);
        assert_eq!(inside.irradiance(DVec3::X * 0.5, DVec3::X), 0.0);
        assert!(inside.irradiance(DVec3::X * 2.0, DVec3::NEG_X) >= 0.0);
    }
}
