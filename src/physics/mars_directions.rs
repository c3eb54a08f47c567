//! Directions that stand for the light of Mars, or of another near sphere, above a facet's horizon: for surfaces that do not reflect alike from everywhere.

use std::f64::consts::PI;

use glam::DVec3;

use super::GaussLegendre;
use super::mars::{Wave, common_arcs, middle_above_horizon};
use super::reflectance::{Brdf, PhotometricAngles};
use crate::geometry::Direction;

/// A sphere as a facet sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereSeen {
    /// From the facet to its centre, m.
    pub to_centre_m: DVec3,
    /// Its radius, m.
    pub radius_m: f64,
    /// The facet's normal, of unit length.
    pub normal: DVec3,
    /// Towards the Sun that lights it, of unit length; `None`: its radiance is the same everywhere.
    pub sun: Option<DVec3>,
}

/// A direction that stands for a part of a sphere's light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Towards {
    /// Of unit length.
    pub direction: DVec3,
    /// Its part of the irradiance; all parts sum to 1.
    pub share: f64,
}

/// A quadrature over what of a sphere's light is above a facet's horizon.
///
/// With m the normal of a patch of the sphere, q = R / D, c towards the centre and X = c / q + m towards the patch, the irradiance is the integral of
/// (m.s)+ (-m.X)+ (n.X)+ / |X|^4 over the sphere: where the Sun is up, where the facet can see it, above the horizon. Each is a cap of the sphere, so on
/// circles about any axis an arc, whose ends have a closed form. The axis is the normal where the horizon cuts the disc, so that the horizon itself is a circle; else
/// one square to c, and to the Sun. At the borders there is no light: Lobatto's points are taken, whose ends count for nothing. Models have a cusp at phase
/// angle 0: where the observer's own direction meets the sphere, circles and arcs are cut.
///
/// Shares are normalized, so that a Lambert surface has the whole irradiance, which others know exactly. Source: set up here.
/// Limits: [`Directions::largest_error`], of what a model reflects.
#[derive(Debug, Clone)]
pub struct Directions {
    /// Points and weights on (-1, 1) where both ends are dark, and where they are not.
    dark_ends: Vec<(f64, f64)>,
    any_ends: Vec<(f64, f64)>,
}

impl Directions {
    /// So many circles, and points on each: as many again where they are cut.
    pub fn new(order: usize) -> Self {
        Directions {
            dark_ends: GaussLegendre::inside_lobatto(order),
            any_ends: GaussLegendre::new(order).nodes(-1.0, 1.0).collect(),
        }
    }

    /// As many as a sphere of this angular radius takes.
    pub fn for_size(sin_radius: f64) -> Self {
        Directions::new(match sin_radius {
            small if small < 0.01 => 1,
            medium if medium < 0.1 => 2,
            _ => ORDER,
        })
    }

    /// How many there are of a sphere that is whole and up.
    pub fn count(&self) -> usize {
        self.any_ends.len() * self.any_ends.len()
    }

    /// The directions for a facet; `to_viewer` leads to who looks at it, of unit length, if it matters. Where nothing is lit: one, to the middle of what is up.
    pub fn of(&self, seen: &SphereSeen, to_viewer: Option<DVec3>) -> Vec<Towards> {
        let mut all = Vec::new();
        if let Some(sphere) = Sphere::new(seen) {
            self.fill(&sphere, to_viewer, &mut all);
        }
        let total: f64 = all.iter().map(|towards: &Towards| towards.share).sum();
        if total > 0.0 {
            all.iter_mut().for_each(|towards| towards.share /= total);
            return all;
        }
        let direction = middle_above_horizon(seen.normal, seen.to_centre_m, seen.radius_m);
        vec![Towards { direction, share: 1.0 }]
    }

    /// The largest relative error of what surfaces send towards the observer in the light of a sphere, over all facets that face him and have some of it above
    /// their horizon.
    pub fn largest_error(&self, brdf: &Brdf, seen: &SphereSeen, to_viewer: Direction) -> f64 {
        let fine = Directions::new(FINE_ORDER);
        let (viewer, (e1, e2)) = (to_viewer.vec(), to_viewer.frame());
        let of = |k: u32| {
            // Even over the hemisphere: heights in steps, turned by the golden angle.
            let height = (f64::from(k) + 0.5) / f64::from(NORMALS);
            let (sin, cos) = (f64::from(k) * PI * (3.0 - 5f64.sqrt())).sin_cos();
            let normal = height * viewer + ((1.0 - height) * (1.0 + height)).sqrt() * (cos * e1 + sin * e2);
            let seen = SphereSeen { normal, ..*seen };
            if normal.dot(seen.to_centre_m) <= -seen.radius_m {
                return 0.0;
            }
            let sent = |directions: &Directions| {
                let of = |Towards { direction, share }| {
                    share * brdf.eval(&PhotometricAngles::of_directions(normal, direction, viewer))
                };
                directions.of(&seen, Some(viewer)).into_iter().map(of).sum::<f64>()
            };
            let truth = sent(&fine);
            if truth > 0.0 { (sent(self) / truth - 1.0).abs() } else { 0.0 }
        };
        BETWEEN * (0..NORMALS).map(of).fold(0.0, f64::max)
    }

    /// Directions and their irradiances.
    fn fill(&self, sphere: &Sphere, to_viewer: Option<DVec3>, all: &mut Vec<Towards>) {
        let Sphere { q, centre, normal, sun, axis } = *sphere;
        let Some((low, high)) = sphere.extent() else { return };
        let (from, to) = (high.acos(), low.acos());
        let (e1, e2) = (axis.any_orthonormal_vector(), axis.cross(axis.any_orthonormal_vector()));
        // The part of a vector across the axis: how long, and where on a circle.
        let across = |a: DVec3| (a.dot(e1).hypot(a.dot(e2)), a.dot(e2).atan2(a.dot(e1)));
        let ([(seen_length, seen_crest), lit_across], mark) =
            ([-centre, sun.unwrap_or_default()].map(across), to_viewer.and_then(|ray| sphere.met_by(ray)));
        let mark = mark.map(|m| (m.dot(axis).clamp(-1.0, 1.0).acos(), across(m).1));
        for (psi, of_circle) in self.nodes((from, to), mark.map(|(psi, _)| psi)) {
            let (sin, cos) = psi.sin_cos();
            let seen = Wave { mean: -cos * centre.dot(axis) - q, amplitude: sin * seen_length, crest: seen_crest };
            let lit = match sun {
                Some(sun) => Wave { mean: cos * sun.dot(axis), amplitude: sin * lit_across.0, crest: lit_across.1 },
                None => Wave { mean: 1.0, amplitude: 0.0, crest: seen_crest },
            };
            let arcs = common_arcs((seen.crest, seen.half_arc()), (lit.crest, lit.half_arc()));
            for (start, end) in arcs.into_iter().filter(|(start, end)| end > start) {
                // On this arc's turn.
                let mark = mark.map(|(_, azimuth)| start + (azimuth - start).rem_euclid(2.0 * PI));
                for (azimuth, of_arc) in self.nodes((start, end), mark) {
                    let (sin_azimuth, cos_azimuth) = azimuth.sin_cos();
                    let m = cos * axis + sin * (cos_azimuth * e1 + sin_azimuth * e2);
                    let x = centre / q + m;
                    let square = x.length_squared();
                    let light = sun.map_or(1.0, |sun| m.dot(sun)) * -m.dot(x) * normal.dot(x) / (square * square);
                    if light > 0.0 {
                        let share = light * sin * of_circle * of_arc;
                        all.push(Towards { direction: x / square.sqrt(), share });
                    }
                }
            }
        }
    }

    /// Points and weights from `a` to `b`, on both sides of a mark between them.
    fn nodes(&self, (a, b): (f64, f64), mark: Option<f64>) -> impl Iterator<Item = (f64, f64)> {
        let mark = mark.filter(|x| *x > a && *x < b);
        let (points, middle) = if mark.is_some() { (&self.any_ends, mark) } else { (&self.dark_ends, None) };
        let pieces = match middle {
            Some(x) => [(a, x), (x, b)],
            None => [(a, b), (b, b)],
        };
        pieces.into_iter().filter(|(a, b)| b > a).flat_map(move |(a, b)| {
            points.iter().map(move |(x, weight)| (0.5 * (a + b) + 0.5 * (b - a) * x, 0.5 * (b - a) * weight))
        })
    }
}

/// Circles, and points on each, for Mars over Phobos: 16 directions, 64 where the observer stands before it.
const ORDER: usize = 4;

/// Relative error of two circles, of surges as narrow as that of Phobos (tested).
pub const OF_TWO_CIRCLES: f64 = 0.25;
/// Those that are taken for the truth: their error is a tenth of that of [`ORDER`].
const FINE_ORDER: usize = 8;
/// Facets of all directions, for the largest error.
const NORMALS: u32 = 256;
/// What is between them may be worse by so much (tested).
const BETWEEN: f64 = 1.5;

/// A sphere of radius 1 that the facet is outside of.
#[derive(Clone, Copy)]
struct Sphere {
    /// Sine of the angular radius.
    q: f64,
    /// Towards its centre, of unit length.
    centre: DVec3,
    normal: DVec3,
    sun: Option<DVec3>,
    /// Of the circles.
    axis: DVec3,
}

impl Sphere {
    fn new(seen: &SphereSeen) -> Option<Self> {
        let SphereSeen { to_centre_m, radius_m, normal, sun } = *seen;
        let distance_m = to_centre_m.length();
        let q = radius_m / distance_m;
        if !(q > 0.0 && q < 1.0) {
            return None;
        }
        let centre = to_centre_m / distance_m;
        let axis = if normal.dot(centre) < q {
            normal
        } else {
            let sideways = sun.unwrap_or_default().cross(centre).normalize_or_zero();
            if sideways == DVec3::ZERO { centre.any_orthonormal_vector() } else { sideways }
        };
        Some(Sphere { q, centre, normal, sun, axis })
    }

    /// Cosines of the angles from the axis between which there is light; `None` if there is none.
    fn extent(&self) -> Option<(f64, f64)> {
        let Sphere { q, centre, normal, sun, axis } = *self;
        let is_lit = |m: &DVec3| sun.is_none_or(|sun| m.dot(sun) > 0.0);
        let is_seen = |m: &DVec3| -m.dot(centre) > q;
        // The highest and the lowest point of a circle of the sphere.
        let ends = |about: DVec3, height: f64| {
            let along = (axis - axis.dot(about) * about).normalize_or_zero();
            let radius = ((1.0 - height) * (1.0 + height)).max(0.0).sqrt();
            [height * about + radius * along, height * about - radius * along]
        };
        // Extremes are at the poles, on the limb, on the terminator, or where these two cross.
        let mut cosines = Vec::with_capacity(8);
        let mut add = |m: DVec3| cosines.push(m.dot(axis).clamp(-1.0, 1.0));
        [axis, -axis].into_iter().filter(|m| is_lit(m) && is_seen(m)).for_each(&mut add);
        ends(-centre, q).into_iter().filter(is_lit).for_each(&mut add);
        if let Some(sun) = sun {
            ends(sun, 0.0).into_iter().filter(is_seen).for_each(&mut add);
            let inwards = centre.dot(sun) * sun - centre;
            let middle = q / inwards.length_squared() * inwards;
            let half_square = 1.0 - middle.length_squared();
            if half_square > 0.0 {
                let half = half_square.sqrt() * sun.cross(inwards).normalize_or_zero();
                [middle + half, middle - half].into_iter().for_each(&mut add);
            }
        }
        let high = cosines.iter().copied().reduce(f64::max)?;
        let low = cosines.into_iter().reduce(f64::min)?;
        // About the normal the horizon is a circle, too.
        let low = if axis == normal { low.max(-normal.dot(centre) / q) } else { low };
        (low < high).then_some((low, high))
    }

    /// Normal of the patch that a ray meets, if it is lit.
    fn met_by(&self, ray: DVec3) -> Option<DVec3> {
        let Sphere { q, centre, sun, .. } = *self;
        let along = ray.dot(centre) / q;
        let square = along * along - (1.0 - q) * (1.0 + q) / (q * q);
        if !(along > 0.0 && square >= 0.0) {
            return None;
        }
        let met = (along - square.sqrt()) * ray - centre / q;
        sun.is_none_or(|sun| met.dot(sun) > 0.0).then_some(met)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::hapke::{Hapke, Parameters, Roughness, Surge};
    use crate::physics::reflectance::{Lambert, LommelSeeliger, PhaseFunction};

    const R_M: f64 = 3_389_500.0;
    const D_M: f64 = 9_376_000.0;

    fn polar(angle_deg: f64, azimuth_deg: f64) -> DVec3 {
        let ((s, c), (sa, ca)) = (angle_deg.to_radians().sin_cos(), azimuth_deg.to_radians().sin_cos());
        DVec3::new(s * ca, s * sa, c)
    }

    fn phobos() -> Brdf {
        let parameters = Parameters {
            phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
            shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
            roughness: Roughness::of_mean_slope(24f64.to_radians()),
            ..Parameters::PLAIN
        };
        Brdf::Hapke(Box::new(Hapke::new(0.07, parameters)))
    }

    fn models() -> [Brdf; 3] {
        let lommel_seeliger = LommelSeeliger { albedo: 0.1, phase: PhaseFunction::Isotropic };
        [Brdf::Lambert(Lambert { reflectance: 0.07 }), Brdf::LommelSeeliger(lommel_seeliger), phobos()]
    }

    /// What a facet sends in a sphere's light over what it would if f were 1: patches of the sphere, summed up.
    fn by_patches(seen: &SphereSeen, to_viewer: DVec3, brdf: &Brdf) -> f64 {
        const RINGS: u32 = 300;
        let centre_m = seen.to_centre_m;
        let towards = centre_m.normalize();
        let (e1, e2) = Direction::new(towards).unwrap().frame();
        let (mut light, mut sent) = (0.0, 0.0);
        for i in 0..RINGS {
            // From the point that is nearest to the limb, rings of the same area.
            let mu = 1.0 - (f64::from(i) + 0.5) / f64::from(RINGS) * (1.0 - seen.radius_m / centre_m.length());
            for j in 0..2 * RINGS {
                let (sin, cos) = (PI * (f64::from(j) + 0.5) / f64::from(RINGS)).sin_cos();
                let m = -mu * towards + (1.0 - mu * mu).sqrt() * (cos * e1 + sin * e2);
                let p_m = centre_m + seen.radius_m * m;
                let to_patch = p_m.normalize();
                let day = seen.sun.map_or(1.0, |sun| m.dot(sun).max(0.0));
                let cosines = day * (-m.dot(to_patch)).max(0.0) * seen.normal.dot(to_patch).max(0.0);
                let irradiance = cosines / p_m.length_squared();
                if irradiance > 0.0 {
                    light += irradiance;
                    sent += irradiance * brdf.eval(&PhotometricAngles::of_directions(seen.normal, to_patch, to_viewer));
                }
            }
        }
        sent / light
    }

    fn by_directions(directions: &Directions, seen: &SphereSeen, to_viewer: DVec3, brdf: &Brdf) -> f64 {
        let all = directions.of(seen, Some(to_viewer));
        assert!((all.iter().map(|towards| towards.share).sum::<f64>() - 1.0).abs() < 1e-14);
        let of = |towards: &Towards| {
            assert!(towards.share > 0.0 && seen.normal.dot(towards.direction) > 0.0, "{seen:?}");
            towards.share * brdf.eval(&PhotometricAngles::of_directions(seen.normal, towards.direction, to_viewer))
        };
        all.iter().map(of).sum()
    }

    /// Mars at a phase angle, its bright limb at this azimuth, over a facet whose normal is z; `None`: its heat.
    fn mars(zenith_deg: f64, phase: Option<(f64, f64)>) -> SphereSeen {
        let centre = polar(zenith_deg, 0.0);
        let sun = phase.map(|(phase_deg, azimuth_deg): (f64, f64)| {
            let ((s, c), (sa, ca)) = (phase_deg.to_radians().sin_cos(), azimuth_deg.to_radians().sin_cos());
            -c * centre + s * (ca * DVec3::Y + sa * centre.cross(DVec3::Y))
        });
        SphereSeen { to_centre_m: D_M * centre, radius_m: R_M, normal: DVec3::Z, sun }
    }

    #[test]
    fn models_reflect_what_all_patches_of_mars_send() {
        let directions = Directions::for_size(R_M / D_M);
        let fine = Directions::new(FINE_ORDER);
        // Whole and cut by the horizon, half of it set, next to all; full, half, crescents, and its heat.
        for zenith_deg in [0.0, 35.0, 65.0, 80.0, 90.0, 100.0] {
            for phase in [None, Some((0.0, 0.0)), Some((83.0, 70.0)), Some((90.0, 200.0)), Some((150.0, 90.0))] {
                let seen = mars(zenith_deg, phase);
                for view in [polar(0.0, 0.0), polar(40.0, 160.0), polar(70.0, 20.0)] {
                    for (brdf, [good, best]) in models().iter().zip([[1e-11; 2], [0.01, 1e-3], [0.02, 3e-3]]) {
                        let expected = by_patches(&seen, view, brdf);
                        if expected.is_nan() {
                            continue;
                        }
                        for (rule, tolerance) in [(&directions, good), (&fine, best)] {
                            let got = by_directions(rule, &seen, view, brdf);
                            let error = (got / expected - 1.0).abs();
                            assert!(error < tolerance, "{zenith_deg} {phase:?} {view} {brdf:?}: {error}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn no_error_is_above_the_bound() {
        let directions = Directions::for_size(R_M / D_M);
        for (brdf, least, most) in [(&models()[1], 1e-4, 0.15), (&phobos(), 2e-3, 0.2)] {
            // The observer before Mars, beside it, and behind the moon.
            for (view, phase) in [
                (polar(8.0, 40.0), Some((83.0, 70.0))),
                (polar(100.0, 10.0), Some((40.0, 0.0))),
                (polar(150.0, 0.0), Some((140.0, 0.0))),
                (polar(20.0, 0.0), None),
            ] {
                let seen = mars(0.0, phase);
                let bound = directions.largest_error(brdf, &seen, Direction::new(view).unwrap());
                assert!(bound > least && bound < most, "{bound}");
                for k in 0..150 {
                    // R. Kronecker's sequence.
                    let k = f64::from(k) + 0.5;
                    let (z, azimuth) =
                        (2.0 * (k * 0.754_877_666_2).fract() - 1.0, 2.0 * PI * (k * 0.569_840_291).fract());
                    let level = (1.0 - z * z).sqrt();
                    let seen =
                        SphereSeen { normal: DVec3::new(level * azimuth.cos(), level * azimuth.sin(), z), ..seen };
                    // Of what is lower patches are too coarse.
                    if seen.normal.dot(view) < 0.01 || z < -0.3 {
                        continue;
                    }
                    let expected = by_patches(&seen, view, brdf);
                    let got = by_directions(&directions, &seen, view, brdf);
                    let error = if expected.is_nan() { 0.0 } else { (got / expected - 1.0).abs() };
                    assert!(error <= bound, "{brdf:?} {view} {phase:?} {:?}: {error} {bound}", seen.normal);
                    let of_two = by_directions(&Directions::new(2), &seen, view, brdf);
                    assert!(
                        expected.is_nan() || expected <= (1.0 + OF_TWO_CIRCLES) * of_two,
                        "{brdf:?} {view} {phase:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn nothing_lit_and_nothing_there() {
        let directions = Directions::new(3);
        let alone = |seen: SphereSeen| {
            let all = directions.of(&seen, Some(DVec3::Z));
            assert_eq!((all.len(), all[0].share), (1, 1.0), "{seen:?}");
            all[0].direction
        };
        // A new Mars, one that has set, and one whose bright limb has set.
        assert!((alone(mars(30.0, Some((180.0, 0.0)))) - polar(30.0, 0.0)).length() < 1e-15);
        assert!(alone(mars(112.0, None)).z.abs() < 1e-15);
        alone(SphereSeen { sun: Some(DVec3::NEG_Z), ..mars(90.0, Some((90.0, 0.0))) });
        // Inside of it; without a size, a place, a direction.
        alone(SphereSeen { radius_m: 2.0 * D_M, ..mars(0.0, None) });
        alone(SphereSeen { radius_m: 0.0, ..mars(0.0, None) });
        alone(SphereSeen { to_centre_m: DVec3::ZERO, ..mars(0.0, None) });
        alone(SphereSeen { normal: DVec3::ZERO, ..mars(0.0, None) });
        alone(SphereSeen { to_centre_m: DVec3::NAN, ..mars(0.0, None) });
        // Far away one is enough.
        let far = SphereSeen { to_centre_m: DVec3::new(0.0, 0.0, 1e4 * D_M), ..mars(0.0, Some((0.0, 0.0))) };
        assert_eq!(Directions::for_size(R_M / (1e4 * D_M)).of(&far, None).len(), 1);
    }
}
