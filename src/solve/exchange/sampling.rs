//! How far what facets receive may be off, since there are no more lines: by how much two halves of them differ.

use rayon::prelude::*;

use crate::geometry::{Mesh, whole};
use crate::product::SamplingError;

/// Edge of a patch, over that of a square as large as the mean facet: a pixel's worth of facets.
const EDGE: f64 = 2.0;
/// Patches with less surface, over the square of their edge, are corners of what others have.
const FULL: f64 = 0.25;

/// What of a patch is known.
#[derive(Debug, Clone, Copy, Default)]
struct Patch {
    area_m2: f64,
    sunlight: f64,
    received: f64,
    /// The one half of the lines less the other, so that both together are `received`.
    difference: f64,
}

/// Where the Sun shines and where it does not, of some facets' `[sunlight, received light, difference of halves]`.
pub(super) fn sampling(
    mesh: &Mesh,
    areas_m2: &[f64],
    is_meant: impl Fn(usize) -> bool + Sync,
    of: impl Fn(usize) -> [f64; 3] + Sync,
) -> [Option<SamplingError>; 2] {
    let (low_m, _) = mesh.bounds_m().unwrap_or_default();
    let meant: Vec<usize> = (0..areas_m2.len()).filter(|f| is_meant(*f)).collect();
    let area_m2: f64 = meant.iter().map(|f| areas_m2[*f]).sum();
    let edge_m = EDGE * (area_m2 / meant.len().max(1) as f64).sqrt().max(f64::MIN_POSITIVE);
    let place = |f: usize| {
        let at = (mesh.facet(f).centroid_m() - low_m) / edge_m;
        (at.to_array().map(whole), f)
    };
    let mut places: Vec<([usize; 3], usize)> = meant.into_par_iter().map(place).collect();
    places.par_sort_unstable();
    let patch = |facets: &[([usize; 3], usize)]| {
        facets.iter().fold(Patch::default(), |mut sum, (_, f)| {
            let (area_m2, [sunlight, received, difference]) = (areas_m2[*f], of(*f));
            sum.area_m2 += area_m2;
            sum.sunlight += area_m2 * sunlight;
            sum.received += area_m2 * received;
            sum.difference += area_m2 * difference;
            sum
        })
    };
    let patches: Vec<Patch> = places
        .chunk_by(|a, b| a.0 == b.0)
        .map(patch)
        .filter(|patch| patch.area_m2 >= FULL * edge_m * edge_m && patch.received > 0.0)
        .collect();
    let error = |is_lit: bool| error(patches.iter().filter(|patch| (patch.sunlight > 0.0) == is_lit));
    [true, false].map(error)
}

/// The whole's error is half the difference of what halves by themselves would say: each is off by sqrt(2) as much as the whole, if not by more, as with few
/// directions, and independently.
fn error<'a>(patches: impl Iterator<Item = &'a Patch>) -> Option<SamplingError> {
    let (mut of_each, mut off, mut all) = (vec![], 0.0, 0.0);
    for patch in patches {
        let (mean, error) = (patch.received / patch.area_m2, patch.difference / patch.area_m2);
        of_each.push((error / mean).abs());
        off += error * error;
        all += mean * mean;
    }
    of_each.sort_by(f64::total_cmp);
    Some(SamplingError { p50: *of_each.get(of_each.len() / 2)?, rms: (off / all).sqrt() })
}
