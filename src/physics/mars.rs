//! Mars as a second source: a sphere near at hand.
//!
//! q = R / D is the sine of its angular radius alpha. Seen from Phobos alpha is 21.2 deg, so a facet tilted by up to
//! 111.2 deg from Mars still sees some of it, and only the cap within acos(q) = 68.8 deg of the point under Phobos is seen.

use std::f64::consts::PI;

use glam::DVec3;

use super::GaussLegendre;

/// Form factor of a facet to a sphere of uniform radiance L, above the facet's own horizon (dimensionless): E = pi L F.
///
/// With q = sin(alpha), c = cos(theta), theta the tilt between the normal and the sphere's centre, g = sqrt(1 - q^2), k = sqrt(q^2 - c^2):
/// F = q^2 c where c >= q (all of it up); 0 where c <= -q (all of it set); between,
/// F = \[atan2(k, g) + q^2 c atan2(k, -g c) - g k\] / pi.
/// Source: Naraghi (1988), J. Thermophysics 2, 373, and Howell's catalogue, their arc cosines rewritten as arc tangents,
/// which keep their digits where the sphere rises and sets. Limits: q < 1; an isothermal Mars, or an upper bound of a lit one.
pub fn uniform_sphere_form_factor(sin_angular_radius: f64, cos_tilt: f64) -> f64 {
    let (q, c) = (sin_angular_radius, cos_tilt);
    if c >= q {
        return q * q * c;
    }
    if c <= -q {
        return 0.0;
    }
    let g = ((1.0 - q) * (1.0 + q)).sqrt();
    let k = ((q - c) * (q + c)).sqrt();
    (k.atan2(g) + q * q * c * k.atan2(-g * c) - g * k) / PI
}

/// Mars-light on a facet as in the thesis, in the unit of the Sun's irradiance: E = 2 rho (R/D)^2 E_S max(0, cos theta_m).
///
/// `solar_irradiance` is normal to the beam, at Mars; `cos_tilt` the cosine between the normal and the centre of Mars.
/// Source: equations (4), (6), (7) and (8) of Domagala (2020), as printed.
/// Limits: no phase, no horizon, and Mars taken to intercept 2 pi R^2 of sunlight: 2.4 times the light of a full
/// Lambert sphere of the same reflectance, 8 times the mean.
pub fn thesis_irradiance(solar_irradiance: f64, reflectance: f64, sin_angular_radius: f64, cos_tilt: f64) -> f64 {
    2.0 * reflectance * sin_angular_radius * sin_angular_radius * solar_irradiance * cos_tilt.max(0.0)
}

/// Mars-light on a facet: E / (rho E_S), dimensionless, of a Lambert sphere lit by the Sun and cut by the facet's horizon.
///
/// `to_centre_m` leads from the facet to the centre of Mars; `normal` and `sun` are unit vectors; E_S is the Sun's irradiance
/// at Mars normal to the beam, rho the Lambert reflectance of Mars. 0 inside the sphere.
///
/// E / (rho E_S) = (q^2 / pi) integral over the cap of (m.s)+ (mu - q)+ (n.c + q n.m)+ / (1 + q^2 - 2 q mu)^2 dmu dphi,
/// m the normal of a patch of Mars, mu = -m.c, c towards the centre. At a given mu both clipped cosines are a + b cos(phi - phi0):
/// the inner integral is exact between their zeros. The outer is Gauss-Legendre between the angles where these zeros appear,
/// vanish or cross. Source: Lambert's law; integral set up here.
/// Limits: within 1e-9 of an adaptive quadrature; a smooth, airless, uniform Mars.
pub fn irradiance(to_centre_m: DVec3, radius_m: f64, normal: DVec3, sun: DVec3) -> f64 {
    let Some(cap) = Cap::new(to_centre_m, radius_m, sun) else { return 0.0 };
    let q = cap.q;
    // The normal in the frame (c, e1, e2): azimuths are about c from the Sun's side.
    let (n_c, n_1) = (normal.dot(cap.to_centre), normal.dot(cap.sunward));
    let n_2 = normal.dot(cap.to_centre.cross(cap.sunward));
    if n_c <= -q {
        return 0.0;
    }
    let n_t = n_1.hypot(n_2);
    let tilt_azimuth = n_2.atan2(n_1);
    let tilt = n_t.atan2(n_c);
    let mut breaks = cap.terminator_breaks();
    if n_c < q {
        // The horizon touches circles of constant mu where q cos(psi -+ tilt) = n.c, ...
        let beta = (n_c / q).acos();
        breaks.extend([(beta - tilt).abs(), beta + tilt, 2.0 * PI - beta - tilt]);
        // ... and crosses the terminator at patches with m.s = 0 and q m.n = -n.c.
        let sun_n = sun.dot(normal);
        let b = -n_c / q / (1.0 - sun_n * sun_n);
        let out_of_plane = 1.0 - b * b * (1.0 - sun_n * sun_n);
        if out_of_plane > 0.0 {
            let in_plane = b * (normal - sun_n * sun);
            let across = sun.cross(normal).normalize_or_zero() * out_of_plane.sqrt();
            breaks.extend([in_plane + across, in_plane - across].map(|m| (-m.dot(cap.to_centre)).acos()));
        }
    }
    cap.integral(breaks, |mu, sigma| {
        let lit = Wave { mean: mu * cap.cos_phase, amplitude: sigma * cap.sin_phase, crest: 0.0 };
        let seen = Wave { mean: n_c * (1.0 - q * mu), amplitude: q * sigma * n_t, crest: tilt_azimuth };
        lit.product_over_common_arcs(&seen)
    })
}

/// The irradiance vector V / (rho E_S) of Mars-light (dimensionless), in the plane of the two arguments: a facet that has
/// the whole disc above its horizon receives n.V.
///
/// Given as (a, w): V = a c + w s, with c the direction to the centre of Mars and s that to the Sun.
/// `sin_angular_radius` is q, `cos_phase` the cosine of the angle at Mars between facet and Sun, -c.s.
/// Source and limits: as [`irradiance`], without the horizon.
pub fn irradiance_vector(sin_angular_radius: f64, cos_phase: f64) -> (f64, f64) {
    let q = sin_angular_radius;
    // w is the sunward component over sin(phase): a limit at 0 and pi, which this distance from them does not change.
    let cos_phase = cos_phase.clamp(-1.0 + 1e-9, 1.0 - 1e-9);
    let sin_phase = ((1.0 - cos_phase) * (1.0 + cos_phase)).sqrt();
    let cap = Cap { q, cos_phase, sin_phase, to_centre: DVec3::Z, sunward: DVec3::X };
    let lit = |mu, sigma| Wave { mean: mu * cos_phase, amplitude: sigma * sin_phase, crest: 0.0 };
    let towards = cap.integral(cap.terminator_breaks(), |mu, sigma| {
        let all = Wave { mean: 1.0 - q * mu, amplitude: 0.0, crest: 0.0 };
        lit(mu, sigma).product_over_common_arcs(&all)
    });
    let sunward = cap.integral(cap.terminator_breaks(), |mu, sigma| {
        let wave = lit(mu, sigma);
        let half = wave.half_arc();
        2.0 * q * sigma * (wave.mean * half.sin() + wave.amplitude * 0.5 * (half + half.sin() * half.cos()))
    });
    // sin(phase) e1 = s + cos(phase) c.
    let w = sunward / sin_phase;
    (towards + w * cos_phase, w)
}

/// The part of the sphere that the facet's place can see, and the Sun about it.
struct Cap {
    q: f64,
    cos_phase: f64,
    sin_phase: f64,
    to_centre: DVec3,
    /// Unit vector across `to_centre`, on the Sun's side.
    sunward: DVec3,
}

impl Cap {
    fn new(to_centre_m: DVec3, radius_m: f64, sun: DVec3) -> Option<Self> {
        let distance_m = to_centre_m.length();
        let q = radius_m / distance_m;
        if !(q > 0.0 && q < 1.0) {
            return None;
        }
        let to_centre = to_centre_m / distance_m;
        let cos_phase = -sun.dot(to_centre);
        let across = sun + cos_phase * to_centre;
        let sin_phase = across.length();
        // Sun, Mars and facet in line: any azimuth is the Sun's side.
        let sunward = if sin_phase > 0.0 { across / sin_phase } else { to_centre.any_orthonormal_vector() };
        Some(Cap { q, cos_phase, sin_phase, to_centre, sunward })
    }

    /// The angle psi at which the terminator touches a circle of constant psi.
    fn terminator_breaks(&self) -> Vec<f64> {
        vec![self.cos_phase.atan2(self.sin_phase).abs()]
    }

    /// (q^2 / pi) integral of `azimuths`(mu, sqrt(1 - mu^2)) (mu - q) / (1 + q^2 - 2 q mu)^2 dmu over the cap.
    ///
    /// mu = cos(psi). Within a piece psi = a + (b - a) t^2 (3 - 2t), which smooths the powers 3/2 that arcs leave where they open and close.
    fn integral(&self, mut breaks: Vec<f64>, azimuths: impl Fn(f64, f64) -> f64) -> f64 {
        let q = self.q;
        let rim = q.acos();
        breaks.retain(|psi| *psi > 0.0 && *psi < rim);
        breaks.push(rim);
        breaks.sort_by(f64::total_cmp);
        let rule = GaussLegendre::new(NODES);
        let mut sum = 0.0;
        let mut a = 0.0;
        for b in breaks {
            sum += rule.integral(0.0, 1.0, |t| {
                let psi = a + (b - a) * t * t * (3.0 - 2.0 * t);
                let (sigma, mu) = psi.sin_cos();
                let r2 = 1.0 + q * q - 2.0 * q * mu;
                azimuths(mu, sigma) * (mu - q) / (r2 * r2) * sigma * (b - a) * 6.0 * t * (1.0 - t)
            });
            a = b;
        }
        q * q / PI * sum
    }
}

/// Nodes of the outer quadrature in each piece.
const NODES: usize = 24;

/// mean + amplitude cos(x - crest), amplitude >= 0: a cosine along a circle of patches.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wave {
    pub(super) mean: f64,
    pub(super) amplitude: f64,
    pub(super) crest: f64,
}

impl Wave {
    /// The wave is positive within this angle of its crest: 0 to pi.
    pub(super) fn half_arc(&self) -> f64 {
        if self.mean >= self.amplitude {
            PI
        } else if self.mean <= -self.amplitude {
            0.0
        } else {
            (-self.mean / self.amplitude).acos()
        }
    }

    /// Where this wave and another are both positive: at most two arcs, empty ones as (0, 0).
    fn common_arcs(&self, other: &Wave) -> [(f64, f64); 3] {
        common_arcs((self.crest, self.half_arc()), (other.crest, other.half_arc()))
    }

    /// Integral of the product of two waves over where both are positive; this one's crest is at 0.
    fn product_over_common_arcs(&self, other: &Wave) -> f64 {
        let (a, b) = (self.mean, self.amplitude);
        let (sin_crest, cos_crest) = other.crest.sin_cos();
        let (c, e, f) = (other.mean, other.amplitude * cos_crest, other.amplitude * sin_crest);
        let antiderivative = |x: f64| {
            let (sin, cos) = x.sin_cos();
            (a * c + 0.5 * b * e) * x + (a * e + b * c + 0.5 * b * e * cos) * sin + (0.5 * b * f * sin) * sin
                - a * f * cos
        };
        let arcs = self.common_arcs(other);
        arcs.iter().filter(|(from, to)| to > from).map(|(from, to)| antiderivative(*to) - antiderivative(*from)).sum()
    }
}

/// The intersection of two arcs, each (middle, half width <= pi), as intervals of angle; empty ones as (0, 0).
pub(super) fn common_arcs((middle_a, half_a): (f64, f64), (middle_b, half_b): (f64, f64)) -> [(f64, f64); 3] {
    [-1.0, 0.0, 1.0].map(|turn| {
        let middle_b = middle_b + 2.0 * PI * turn;
        let (from, to) = ((middle_a - half_a).max(middle_b - half_b), (middle_a + half_a).min(middle_b + half_b));
        if to > from { (from, to) } else { (0.0, 0.0) }
    })
}

/// Unit vector towards the middle of what of a sphere is above a surface's horizon: its centre, or, where the horizon cuts it, halfway from
/// there to its upper edge. `normal` is of unit length.
pub fn middle_above_horizon(normal: DVec3, to_centre_m: DVec3, radius_m: f64) -> DVec3 {
    let distance_m = to_centre_m.length();
    let centre = to_centre_m / distance_m;
    let sin_elevation = normal.dot(centre).clamp(-1.0, 1.0);
    let (elevation, radius) = (sin_elevation.asin(), (radius_m / distance_m).min(1.0).asin());
    if elevation >= radius {
        return centre;
    }
    let middle = 0.5 * (elevation + radius).max(0.0);
    (centre - sin_elevation * normal).normalize_or_zero() * middle.cos() + normal * middle.sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_what_is_up() {
        let towards = |elevation_deg: f64| {
            let (sin, cos) = f64::to_radians(elevation_deg).sin_cos();
            7.0 * DVec3::new(cos, 0.0, sin)
        };
        let radius = 7.0 * f64::to_radians(20.0).sin();
        // Whole; half; a third of its height; nothing.
        for (elevation_deg, expected_deg) in [(30.0, 30.0), (20.0, 20.0), (0.0, 10.0), (-10.0, 5.0), (-25.0, 0.0)] {
            let middle = middle_above_horizon(DVec3::Z, towards(elevation_deg), radius);
            assert!((middle - towards(expected_deg) / 7.0).length() < 1e-15, "{elevation_deg}: {middle}");
        }
    }

    const R: f64 = 3_389.5;
    const D: f64 = 9_376.0;

    fn polar(angle_deg: f64, azimuth_deg: f64) -> DVec3 {
        let (s, c) = angle_deg.to_radians().sin_cos();
        let (sa, ca) = azimuth_deg.to_radians().sin_cos();
        DVec3::new(s * ca, s * sa, c)
    }

    /// Facet at the origin, Mars towards +Z, the Sun in the XZ plane: at Mars the facet is towards -Z.
    fn at(phase_deg: f64, tilt_deg: f64, azimuth_deg: f64) -> f64 {
        irradiance(DVec3::Z * D, R, polar(tilt_deg, azimuth_deg), polar(180.0 - phase_deg, 0.0))
    }

    /// Patches of the sphere, as coarse as it gets: agrees to 1 part in 1e4 or so.
    fn patches(phase_deg: f64, tilt_deg: f64, azimuth_deg: f64) -> f64 {
        let (normal, sun) = (polar(tilt_deg, azimuth_deg), polar(180.0 - phase_deg, 0.0));
        let (rings, sectors) = (600, 600);
        let mut sum = 0.0;
        for i in 0..rings {
            let mu = 1.0 - (f64::from(i) + 0.5) / f64::from(rings) * (1.0 - R / D);
            for j in 0..sectors {
                let m = polar(180.0 - mu.acos().to_degrees(), (f64::from(j) + 0.5) / f64::from(sectors) * 360.0);
                let p = DVec3::Z * D + m * R;
                let r = p.length();
                let cosines = (m.dot(sun)).max(0.0) * (-m.dot(p) / r).max(0.0) * (normal.dot(p) / r).max(0.0);
                sum += cosines / (r * r);
            }
        }
        sum * R * R * (1.0 - R / D) * 2.0 * PI / f64::from(rings * sectors) / PI
    }

    #[test]
    fn facing_facets_have_the_known_values() {
        // E / (rho E_S) by adaptive quadrature in mpmath, good to 1e-9 or better.
        for (phase_deg, expected) in [
            (0.0, 0.108_426_075_539_469_58),
            (15.0, 0.104_731_546_606_743_12),
            (60.0, 0.057_303_110_538_694_61),
            (90.0, 0.020_713_211_977_271_29),
            (135.0, 0.000_587_055_738_291_115_5),
            (165.0, 0.0),
        ] {
            let got = at(phase_deg, 0.0, 0.0);
            assert!((got - expected).abs() < 1e-9, "{phase_deg}: {got} {expected}");
        }
    }

    #[test]
    fn tilted_facets_have_the_known_values() {
        for (phase_deg, tilt_deg, azimuth_deg, expected) in [
            (0.0, 30.0, 0.0, 0.093_899_735_849_831_25),
            (60.0, 90.0, 0.0, 0.008_183_995_631_803_106),
            (60.0, 90.0, 180.0, 0.000_990_255_306_852_640_3),
            (90.0, 100.0, 0.0, 0.001_417_830_992_448_829),
            (120.0, 60.0, 180.0, 0.000_692_837_199_350_380_2),
        ] {
            let got = at(phase_deg, tilt_deg, azimuth_deg);
            assert!((got - expected).abs() < 1e-9, "{phase_deg} {tilt_deg} {azimuth_deg}: {got} {expected}");
        }
    }

    #[test]
    fn any_azimuth_agrees_with_a_sum_over_patches() {
        let mut seen = 0;
        for (phase_deg, tilt_deg, azimuth_deg) in [
            (0.0, 85.0, 70.0),
            (40.0, 95.0, 130.0),
            (75.0, 80.0, 60.0),
            (100.0, 90.0, 45.0),
            (130.0, 100.0, 20.0),
            (30.0, 40.0, 200.0),
        ] {
            let (got, rough) = (at(phase_deg, tilt_deg, azimuth_deg), patches(phase_deg, tilt_deg, azimuth_deg));
            assert!((got - rough).abs() < 3e-6, "{phase_deg} {tilt_deg} {azimuth_deg}: {got} {rough}");
            seen += usize::from(got > 1e-4);
        }
        assert!(seen >= 5);
    }

    #[test]
    fn the_vector_serves_every_facet_that_sees_the_whole_disc() {
        for phase_deg in [0.0, 10.0, 80.0, 140.0, 180.0] {
            let sun = polar(180.0 - phase_deg, 0.0);
            let (a, w) = irradiance_vector(R / D, -sun.z);
            let v = a * DVec3::Z + w * sun;
            for (tilt_deg, azimuth_deg) in [(0.0, 0.0), (30.0, 77.0), (68.0, 180.0), (68.8, 0.0)] {
                let (got, expected) = (v.dot(polar(tilt_deg, azimuth_deg)), at(phase_deg, tilt_deg, azimuth_deg));
                assert!((got - expected).abs() < 2e-10, "{phase_deg} {tilt_deg}: {got} {expected}");
            }
        }
    }

    #[test]
    fn what_is_below_the_horizon_or_inside_sends_nothing() {
        assert_eq!(at(0.0, 111.3, 0.0), 0.0);
        assert!(at(0.0, 111.0, 0.0) > 0.0);
        assert_eq!(irradiance(DVec3::Z, 2.0, DVec3::Z, DVec3::Z), 0.0);
        assert_eq!(irradiance(DVec3::ZERO, 2.0, DVec3::Z, DVec3::Z), 0.0);
    }

    #[test]
    fn a_uniform_sphere_has_the_known_form_factors() {
        // Howell's closed form in 40 digits.
        for (tilt_deg, expected) in [
            (0.0, 0.130_688_110_561),
            (60.0, 0.065_344_055_280),
            (70.0, 0.044_707_227_241),
            (90.0, 0.010_448_823_528),
            (105.0, 0.000_546_496_153),
            (110.0, 0.000_009_260_937),
            (111.0, 0.000_000_098_099),
            (112.0, 0.0),
        ] {
            let got = uniform_sphere_form_factor(R / D, f64::to_radians(tilt_deg).cos());
            assert!((got - expected).abs() < 1e-12, "{tilt_deg}: {got} {expected}");
        }
        let q = R / D;
        for c in [q, -q] {
            let (inside, outside) =
                (uniform_sphere_form_factor(q, c * (1.0 - 1e-12)), uniform_sphere_form_factor(q, c));
            assert!((inside - outside).abs() < 1e-12);
        }
    }

    #[test]
    fn the_thesis_prints_6_5_percent() {
        let got = thesis_irradiance(1.0, 0.25, 3_389.5 / 9_389.0, 1.0);
        assert!((got - 0.065_163_229_93).abs() < 1e-11);
        assert_eq!(thesis_irradiance(1.0, 0.25, 0.36, -0.1), 0.0);
    }
}
