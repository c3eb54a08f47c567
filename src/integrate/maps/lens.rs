//! Maps that a lens distorts: parts of a facet's image so small that over each the lens is an affine map, as good as exact.

use crate::geometry::polygon::{Point, Rect, clip_to_rect};
use crate::geometry::{Camera, Chart, FrameCamera};

/// What an affine map may be off by, texels: as much of a texel's border at most goes to its neighbour.
const FLAT: f64 = 1e-3;
/// A part is quartered at most this often.
const DEEPEST: u32 = 10;

/// A convex part of a facet's image, and how it leads to texels; without a chart it is nowhere in the map.
pub(super) type FlatPart = (Option<Chart>, Vec<Point>);

/// The camera of a map, whose lens distorts.
#[derive(Debug)]
pub(super) struct MapLens<'a> {
    camera: &'a FrameCamera,
    /// Bounds of its pixels in the image of its pinhole, pixels.
    frame: Rect,
}

impl<'a> MapLens<'a> {
    /// `None` if there is nothing to a camera's lens.
    pub(super) fn of(camera: &'a Camera) -> Option<Self> {
        let Camera::Frame(camera) = camera else { return None };
        let drawn = camera.drawn();
        let of_cells =
            |[x, y]: Point| [0, 1].map(|k| [x, y][k] + camera.boresight_px[k] - drawn.pinhole.boresight_px[k]);
        let size = [drawn.pinhole.samples, drawn.pinhole.lines].map(f64::from);
        drawn.is_distorted().then(|| MapLens { camera, frame: Rect { min: of_cells([0.0; 2]), max: of_cells(size) } })
    }

    /// Divides a convex part of a facet's image, counter-clockwise, that `chart` leads to the image of the camera's pinhole.
    pub(super) fn flat_parts(&self, chart: &Chart, part: &[Point]) -> Vec<FlatPart> {
        let mut parts = Vec::new();
        divide(self, chart, part, 0, &mut parts);
        parts
    }
}

fn divide(lens: &MapLens, chart: &Chart, part: &[Point], depth: u32, parts: &mut Vec<FlatPart>) {
    if part.len() < 3 {
        return;
    }
    let bounds = Rect::of(part);
    let places: Option<Vec<Point>> = part.iter().map(|p| chart.at(*p)).collect();
    // What is beside all of the image is nowhere in it.
    if places.as_ref().is_some_and(|places| !Rect::of(places).overlaps(&lens.frame)) {
        parts.push((None, part.to_vec()));
        return;
    }
    if let Some(flat) = places.and_then(|places| flattened(lens.camera, chart, part, &places)) {
        parts.push((Some(flat), part.to_vec()));
    } else if depth == DEEPEST {
        parts.push((None, part.to_vec()));
    } else {
        let mut spare = Vec::new();
        for quarter in bounds.quarters() {
            let mut clipped = Vec::new();
            clip_to_rect(part, &quarter, &mut clipped, &mut spare);
            divide(lens, chart, &clipped, depth + 1, parts);
        }
    }
}

/// The chart that is right in the middle of a part, and to its first derivatives; `None` where it is not flat at the corners.
fn flattened(camera: &FrameCamera, chart: &Chart, part: &[Point], places: &[Point]) -> Option<Chart> {
    let share = 1.0 / places.len() as f64;
    let middle = [0, 1].map(|k| share * places.iter().map(|at| at[k]).sum::<f64>());
    let (at, [x, y]) = camera.lensed(middle)?;
    // at + J (p - middle), times w.
    let affine = |k: usize, [by_s, by_t]: [f64; 2]| {
        let constant = at[k] - by_s * middle[0] - by_t * middle[1];
        [0, 1, 2].map(|i| by_s * chart.s[i] + by_t * chart.t[i] + constant * chart.w[i])
    };
    let flat = Chart { s: affine(0, x), t: affine(1, y), w: chart.w };
    let is_near = |(p, place): (&Point, &Point)| {
        let (Some((exact, _)), Some(near)) = (camera.lensed(*place), flat.at(*p)) else { return false };
        (0..2).all(|k| (exact[k] - near[k]).abs() <= FLAT)
    };
    part.iter().zip(places).all(is_near).then_some(flat)
}
