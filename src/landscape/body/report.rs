//! What a wrap does to a site, in numbers.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::Wrap;

/// Places along a side of the site at which areas are compared.
const SIDE: i32 = 65;

/// What a wrap does to a site.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct WrapReport {
    /// The target's distance from the body's centre, less that of the ground below it, m.
    pub target_above_m: f64,
    /// The same for the surface that the site lies on: smooth where the body's own is of facets, m.
    pub target_above_smooth_m: f64,
    /// Upright of the site, body axes.
    pub up: DVec3,
    /// Radii of the base's curvature at the target along the site's x and y, m; positive where it is convex.
    pub curvature_m: [f64; 2],
    /// Area on the base over area on the map: least, mean and most over the site.
    pub area: [f64; 3],
    /// Angle between the site's upright and the base's normal: most over the site, deg.
    pub tilt_deg: f64,
    /// How far the base lies below (or, negative, above) the plane that touches it at the target: least and most over the site, m.
    pub below_m: [f64; 2],
    /// Share of the site's relief that is left where the mesh ends: 0 if its end lies on the body.
    pub relief_at_end: f64,
    /// The seam: how far the mesh's end lies off the body, at its vertices or half way between them, m, at most.
    pub seam_m: f64,
}

/// Measures a wrap.
pub(super) fn report(wrap: &Wrap, target_m: DVec3, ground_m: DVec3, smooth_m: DVec3) -> WrapReport {
    let up = wrap.projection.up;
    let foot = |x_m: f64, y_m: f64| wrap.foot(x_m, y_m);
    let step_m = wrap.site_m * 2.0 / f64::from(SIDE - 1);
    let (middle_m, _) = foot(0.0, 0.0);
    // Over a tenth of the site: the second difference of heights, over the square of the distance.
    let reach_m = 0.1 * wrap.site_m;
    let curvature_m = [[1.0, 0.0], [0.0, 1.0]].map(|[x, y]| {
        let [ahead_m, behind_m] = [1.0, -1.0].map(|sign| foot(sign * x * reach_m, sign * y * reach_m).0 - middle_m);
        let drop_m = -(ahead_m + behind_m).dot(up);
        let across_m = 0.5 * ((ahead_m - behind_m) - (ahead_m - behind_m).dot(up) * up).length();
        across_m * across_m / drop_m
    });
    let (mut least, mut most, mut sum, mut count) = (f64::MAX, 0.0f64, 0.0, 0.0);
    let (mut tilt, mut lowest_m, mut highest_m) = (1.0f64, f64::MAX, f64::MIN);
    for i in 0..SIDE {
        for j in 0..SIDE {
            let (x_m, y_m) = (f64::from(i) * step_m - wrap.site_m, f64::from(j) * step_m - wrap.site_m);
            let h_m = 0.5 * step_m;
            let by_x = (foot(x_m + h_m, y_m).0 - foot(x_m - h_m, y_m).0) / (2.0 * h_m);
            let by_y = (foot(x_m, y_m + h_m).0 - foot(x_m, y_m - h_m).0) / (2.0 * h_m);
            let area = by_x.cross(by_y).length();
            (least, most, sum, count) = (least.min(area), most.max(area), sum + area, count + 1.0);
            let (foot_m, normal) = foot(x_m, y_m);
            tilt = tilt.min(normal.dot(up));
            let below_m = -(foot_m - middle_m).dot(up);
            (lowest_m, highest_m) = (lowest_m.min(below_m), highest_m.max(below_m));
        }
    }
    WrapReport {
        target_above_m: target_m.length() - ground_m.length(),
        target_above_smooth_m: (target_m - smooth_m).dot(target_m.normalize_or_zero()),
        up,
        curvature_m,
        area: [least, sum / count, most],
        tilt_deg: tilt.clamp(-1.0, 1.0).acos().to_degrees(),
        below_m: [lowest_m, highest_m],
        relief_at_end: wrap.relief(wrap.end_m, 0.0),
        seam_m: 0.0,
    }
}
