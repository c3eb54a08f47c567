//! Map of facets in longitude and latitude.

use rayon::prelude::*;

use super::locate::outermost_at;
use crate::geometry::planetocentric_deg;
use crate::geometry::{whole, whole_u32};
use crate::scene::Body;

/// About the number of pixels of a map, and the largest and smallest side.
const PIXELS: f64 = 720.0 * 360.0;
const SIDES: [f64; 2] = [120.0, 1440.0];
/// Longitude gap beyond which a body counts as a part of one, deg.
const GAP_DEG: f64 = 90.0;
/// Margin around a part of a body, relative to its size.
const AROUND: f64 = 0.02;

/// A map in longitude and latitude (plate carree): planetocentric, longitude east to the right, north up.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceMap {
    /// Longitudes of the left and right side, deg; the first is within 0 to 360.
    pub longitude_deg: [f64; 2],
    /// Latitudes of the lower and upper side, deg.
    pub latitude_deg: [f64; 2],
    /// Pixels in a line.
    pub samples: usize,
    /// Lines.
    pub lines: usize,
    /// The outermost facet in the middle of each pixel, line by line from the top; none where there is no surface.
    pub facet: Vec<Option<u32>>,
}

impl SurfaceMap {
    /// Of a whole body, or of what there is of it.
    pub fn new(body: &Body) -> Self {
        let (longitude_deg, latitude_deg) = window(body);
        let [width, height] = [longitude_deg, latitude_deg].map(|[first, last]| last - first);
        let per_deg = (PIXELS / (width * height)).sqrt();
        let [samples, lines] = [width, height].map(|deg| whole((deg * per_deg).round().clamp(SIDES[0], SIDES[1])));
        // Made before threads ask for it.
        body.ray_tree();
        let at = |ends: [f64; 2], share: f64| ends[0] + (ends[1] - ends[0]) * share;
        let share = |i: usize, n: usize| (f64::from(whole_u32(i as f64)) + 0.5) / n as f64;
        let facet = (0..samples * lines)
            .into_par_iter()
            .map(|pixel| {
                let (line, sample) = (pixel / samples, pixel % samples);
                let latitude = at([latitude_deg[1], latitude_deg[0]], share(line, lines));
                let longitude = at(longitude_deg, share(sample, samples));
                outermost_at(body, [latitude, longitude]).map(|(facet, _)| facet)
            })
            .collect();
        SurfaceMap { longitude_deg, latitude_deg, samples, lines, facet }
    }
}

/// Extent of a body's surface in longitude and latitude, deg.
fn window(body: &Body) -> ([f64; 2], [f64; 2]) {
    const ALL: ([f64; 2], [f64; 2]) = ([0.0, 360.0], [-90.0, 90.0]);
    let mut longitudes = Vec::new();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for vertex_m in body.mesh.used_vertices_m() {
        let [latitude, longitude] = planetocentric_deg(vertex_m + body.origin_m);
        (low, high) = (low.min(latitude), high.max(latitude));
        longitudes.push(longitude);
    }
    longitudes.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (longitudes.first(), longitudes.last()) else { return ALL };
    // The widest gap between neighbours: from its end to its beginning lies all there is.
    let across = (*last, first + 360.0);
    let gaps = longitudes.windows(2).map(|two| (two[0], two[1]));
    let (from, to) = gaps.fold(across, |widest, gap| if gap.1 - gap.0 > widest.1 - widest.0 { gap } else { widest });
    if to - from <= GAP_DEG {
        return ALL;
    }
    let left = to.rem_euclid(360.0);
    let around = |[first, last]: [f64; 2]| {
        let by = if last > first { AROUND * (last - first) } else { 0.5 };
        [first - by, last + by]
    };
    let [south, north] = around([low, high]);
    (around([left, left + 360.0 - (to - from)]), [south.max(-90.0), north.min(90.0)])
}
