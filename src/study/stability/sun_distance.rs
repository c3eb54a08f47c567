//! The Sun brought nearer: the thesis divides its position by 1e5 (its numbers) or 1e7 (its words), so that projections have digits.

use glam::DVec3;

use super::scenes::direction;
use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::physics::thesis_projection::{Precision, SunCamera};

/// Table I of Domagala (2020), m.
const SUN_M: DVec3 = DVec3::new(3.992e10, 2.1812e11, 1.1501e10);
const TARGET_M: DVec3 = DVec3::new(-2743.5946, 11860.036, 0.51269);

/// Half the site, and the height of what casts a shadow at its corner, m.
const HALF_M: f64 = 1000.0;
const HEIGHT_M: f64 = 10.0;

/// Where a point of a site that the Sun at `SUN_M` / `factor` sees lies on the ground behind it, and the true place, along parallel rays; m, from
/// the target. `None` where the way through the camera has no answer.
fn shadow_m(factor: f64, precision: Precision, parallel: bool) -> Result<(Option<DVec3>, DVec3)> {
    let up = direction(TARGET_M)?.vec();
    let (east, north) = direction(TARGET_M)?.frame();
    let towards = direction(SUN_M - TARGET_M)?.vec();
    let top_m = HALF_M * (east + north) + HEIGHT_M * up;
    let truth_m = top_m - towards * (HEIGHT_M / towards.dot(up));
    let ground_m = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)].map(|(x, y)| 2.0 * HALF_M * (x * east + y * north));
    let r = |v: DVec3| precision.round_each(v);
    if parallel {
        // Coordinates along and across the rays, from the target.
        let (h, v) = direction(towards)?.frame();
        let place = |p: DVec3| r(DVec3::new(r(p).dot(r(h)), r(p).dot(r(v)), r(p).dot(r(towards))));
        let [a, b, c] = ground_m.map(place);
        let p = place(top_m);
        let [s, t] = shares([p.x, p.y], [a.x, a.y], [b.x, b.y], [c.x, c.y]);
        let depth = precision.round(a.z + s * (b.z - a.z) + t * (c.z - a.z));
        return Ok((Some(r(h) * p.x + r(v) * p.y + r(towards) * depth), truth_m));
    }
    let Some(camera) = SunCamera::new(SUN_M / factor, TARGET_M, precision) else { return Ok((None, truth_m)) };
    let [a, b, c] = ground_m.map(|p| camera.project(TARGET_M + p));
    let [x, y, z] = camera.project(TARGET_M + top_m);
    if [a[2], b[2], c[2], z].iter().any(|z| *z <= 0.0) {
        return Ok((None, truth_m));
    }
    // On a plane 1 / Z is linear in X and Y.
    let [s, t] = shares([x, y], [a[0], a[1]], [b[0], b[1]], [c[0], c[1]]);
    let per_m = 1.0 / a[2] + s * (1.0 / b[2] - 1.0 / a[2]) + t * (1.0 / c[2] - 1.0 / a[2]);
    let found = camera.point_m([x, y, precision.round(1.0 / per_m)]) - TARGET_M;
    Ok((found.is_finite().then_some(found), truth_m))
}

/// p = a + s (b - a) + t (c - a).
fn shares(p: [f64; 2], a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> [f64; 2] {
    let minus = |p: [f64; 2]| [p[0] - a[0], p[1] - a[1]];
    let (p, b, c) = (minus(p), minus(b), minus(c));
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    [cross(p, c) / cross(b, c), cross(b, p) / cross(b, c)]
}

/// By how much the direction to a Sun at Table I's place divided by `factor` is off at the target, and by how much it differs over the width of the site along
/// the Sun's azimuth, both rad.
pub fn scaled_sun_errors(factor: f64) -> (f64, f64) {
    let (Some(up), Some(towards), Some(scaled)) = (
        crate::geometry::Direction::new(TARGET_M),
        crate::geometry::Direction::new(SUN_M - TARGET_M),
        crate::geometry::Direction::new(SUN_M / factor - TARGET_M),
    ) else {
        return (f64::NAN, f64::NAN);
    };
    let level = (scaled.vec() - scaled.vec().dot(up.vec()) * up.vec()).normalize_or_zero();
    let from = |p_m: DVec3| SUN_M / factor - TARGET_M - p_m;
    let spread = crate::geometry::angle_rad(from(-HALF_M * level), from(HALF_M * level));
    (towards.angle_rad(scaled), spread)
}

pub(super) fn hazard() -> Result<Hazard> {
    let methods: [(&str, bool, Precision, bool, &str); 4] = [
        (
            "parallel rays, f64",
            true,
            Precision::Double,
            true,
            "A direction and metres from the target: the Sun's distance does not enter.",
        ),
        (
            "parallel rays, f32",
            false,
            Precision::Single,
            true,
            "24 bits of a 2 km site are 0.1 mm: enough for shadows.",
        ),
        (
            "Sun as a camera, f64",
            false,
            Precision::Double,
            false,
            "At the true distance it has just enough digits; each division turns shadows, 0.13 deg at 1e5, 24 deg at 1e7, and at 1e8 the Sun is under the ground.",
        ),
        (
            "Sun as a camera, f32",
            false,
            Precision::Single,
            false,
            "At the true distance a step of the coordinates is 16 km: all corners coincide. Where there are digits, the direction is wrong.",
        ),
    ];
    let mut sweeps = Vec::new();
    for (method, is_ours, precision, parallel, then) in methods {
        let mut points = Vec::new();
        for power in 0..=9 {
            let factor = 10f64.powi(power);
            let (found, truth_m) = shadow_m(factor, precision, parallel)?;
            let length_m = HEIGHT_M * direction(SUN_M - TARGET_M)?.vec().cross(direction(TARGET_M)?.vec()).length();
            let error = found.map_or(f64::INFINITY, |found| found.distance(truth_m) / length_m);
            points.push(Point { at: factor, error });
        }
        sweeps.push(Sweep { method, is_ours, then, points });
    }
    Ok(Hazard {
        name: "Sun brought nearer",
        parameter: "the Sun's distance is divided by",
        truth: "Where the shadow of a point 10 m above the corner of a 2 km site falls, in the geometry of the thesis's Table I, against the line through it along the \
                true direction; error over the shadow's length. The thesis prints the numbers of 1e5 and says 1e7.",
        sweeps,
    })
}
