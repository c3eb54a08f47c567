//! Whether a mesh is far finer than an image's pixels, and what a coarser one would change and cost: an estimate, before anything is solved.
//! `mmxrt chart` measures it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::cost::{self, Workload};
use super::extremes::Extremes;
use crate::geometry::{Camera, whole, whole_u32};
use crate::scene::Scene;

/// Facets that a pixel shows, where a mesh is far finer than that.
const FAR_FINER: f64 = 64.0;
/// Facets a pixel of the coarser mesh: edges of about a third of a pixel.
const ENOUGH: f64 = 16.0;
/// Pixels along a side of the image that are looked at, at most.
const LOOKS: u32 = 64;
/// Error of a sunlit pixel over the spread of brightness among its quarters, of all but 1 % of the pixels each. Measured with the shipped site, 48 facets a pixel cut to 14,
/// with the Sun at 24 and at 85 deg, at 1 and 3.6 um: 0.15 to 0.33.
const SHARE: f64 = 0.25;
/// Errors are relative to at least this share of the mean brightness.
const FLOOR: f64 = 0.01;

/// A mesh that would do, where the scene's is far finer than pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Coarser {
    /// Facets of the scene's mesh.
    pub facets_of_scene: u64,
    /// Of those a pixel shows so many, on average.
    pub facets_a_pixel: f64,
    /// Facets of a mesh with edges of about a third of a pixel.
    pub facets: u64,
    /// By about how much that would change sunlit pixels, all but 1 % of them; a guess from how sunlight varies within pixels. At the edges of shadows it is more.
    pub change: f64,
    /// About the CPU time that a simulation would take then, s, on a machine of 2022.
    pub cpu_s: f64,
}

/// Of a mesh that is far finer than the pixels that show it; `effects_s`: CPU time that effects take with it, s.
pub(super) fn coarser(scene: &Scene, extremes: &Extremes, effects_s: f64) -> Option<Coarser> {
    let workload = Workload::of(scene, extremes);
    let camera = &scene.exposure.camera;
    let shown = workload.filled * f64::from(camera.samples) * f64::from(camera.lines);
    let facets_a_pixel = workload.facets_in_frame as f64 / shown;
    if !(facets_a_pixel > FAR_FINER && facets_a_pixel.is_finite()) {
        return None;
    }
    let share = ENOUGH / facets_a_pixel;
    let facets = share * scene.body.mesh.facets.len() as f64;
    // Effects take time by facets.
    let cpu_s = cost::cpu_s_with(scene, &workload, facets) + share * effects_s;
    Some(Coarser {
        facets_of_scene: scene.body.mesh.facets.len() as u64,
        facets_a_pixel,
        facets: whole(facets.round()) as u64,
        change: SHARE * spread_in_pixels(scene),
        cpu_s,
    })
}

/// How much sunlight differs among the quarters of a pixel, root mean square over its mean: all but 1 % of the pixels have less.
fn spread_in_pixels(scene: &Scene) -> f64 {
    let camera = &scene.exposure.camera.drawn().pinhole;
    let (eye_m, towards_sun) = (camera.centre_m(), scene.sky.sun.direction.vec());
    let projection = Camera::Frame(camera.clone()).projection();
    let sizes = [camera.samples, camera.lines];
    let counts = sizes.map(|size| size.min(LOOKS));
    // Of the quarters of each pixel that is looked at: area as seen, and that times the cosine of incidence.
    let mut quarters = vec![[[0.0_f64; 2]; 4]; (counts[0] * counts[1]) as usize];
    for facet in 0..scene.body.mesh.facets.len() {
        let facet = scene.body.mesh.facet(facet);
        let (cross_m2, centroid_m) = (facet.cross_m2(), facet.centroid_m());
        let to_eye = eye_m - centroid_m;
        let seen = cross_m2.dot(to_eye) / to_eye.length().powi(3);
        // What is behind the camera is not in the image.
        let is_ahead = camera.world_from_sensor.rotation.z_axis.dot(to_eye) < 0.0;
        if seen.is_nan() || seen <= 0.0 || !is_ahead {
            continue;
        }
        let at = projection.at(centroid_m);
        let Some([x, y]) = looked_at(at, sizes, counts) else { continue };
        let [right, low] = at.map(|px| usize::from(px.fract() >= 0.5));
        let quarter = &mut quarters[(y * counts[0] + x) as usize][2 * low + right];
        quarter[0] += seen;
        quarter[1] += seen * cross_m2.normalize_or_zero().dot(towards_sun).max(0.0);
    }
    let whole_pixels = quarters.iter().filter(|quarters| quarters.iter().all(|[seen, _]| *seen > 0.0));
    let bright: Vec<[f64; 4]> = whole_pixels.map(|quarters| quarters.map(|[seen, light]| light / seen)).collect();
    let mean = |quarters: &[f64; 4]| 0.25 * quarters.iter().sum::<f64>();
    let of_all = bright.iter().map(mean).sum::<f64>() / bright.len().max(1) as f64;
    let spread = |quarters: &[f64; 4]| {
        let mean = mean(quarters);
        let square = 0.25 * quarters.iter().map(|b| (b - mean) * (b - mean)).sum::<f64>();
        if square == 0.0 { 0.0 } else { square.sqrt() / mean.max(FLOOR * of_all) }
    };
    let mut spreads: Vec<f64> = bright.iter().map(spread).collect();
    spreads.sort_by(f64::total_cmp);
    let last = whole((0.99 * spreads.len() as f64).ceil());
    spreads.get(last.saturating_sub(1)).copied().unwrap_or(0.0)
}

/// Which of the pixels that are looked at, spread evenly over the image, a place is in; `None` if in no such.
fn looked_at(at: [f64; 2], sizes: [u32; 2], counts: [u32; 2]) -> Option<[u32; 2]> {
    let mut place = [0; 2];
    for k in 0..2 {
        if !(at[k] >= 0.0 && at[k] < f64::from(sizes[k])) {
            return None;
        }
        let pixel = whole_u32(at[k]);
        let step = sizes[k] / counts[k];
        place[k] = pixel / step;
        if !pixel.is_multiple_of(step) || place[k] >= counts[k] {
            return None;
        }
    }
    Some(place)
}
