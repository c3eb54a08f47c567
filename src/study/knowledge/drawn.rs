//! Errors of a pixel by Monte Carlo.

use glam::{DMat3, DVec3};

use super::{Asked, Deviation, Knowledge};
use crate::geometry::whole;
use crate::random::{Draws, mix};

/// Sampled errors, along east, north and up at the true point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampled {
    /// Draws whose ray hits the believed surface.
    pub met: usize,
    /// Draws whose ray misses it.
    pub missed: usize,
    /// Their mean, m.
    pub mean_m: DVec3,
    /// Their unbiased covariance, m^2; 0 for a single draw.
    pub covariance_m2: DMat3,
    /// 95th percentile of the horizontal error, m.
    pub level_p95_m: f64,
}

/// The drawn states: shared by all pixels, as within one image.
pub(super) fn draws(knowledge: &Knowledge, asked: Asked) -> Vec<Deviation> {
    let mut draws = Draws::new(mix(asked.seed));
    (0..asked.draws).map(|_| knowledge.drawn(&mut draws)).collect()
}

/// Percentile of sorted numbers.
pub(super) fn nearest_rank(sorted: &[f64], share: f64) -> Option<f64> {
    let rank = (share * sorted.len() as f64).ceil().max(1.0);
    sorted.get(whole(rank) - 1).copied()
}

/// Statistics of errors, m.
pub(super) fn sampled(errors_m: &[DVec3], drawn: usize) -> Sampled {
    let n = errors_m.len() as f64;
    let mean_m = errors_m.iter().sum::<DVec3>() / n.max(1.0);
    let square = |error_m: &DVec3| {
        let off = *error_m - mean_m;
        DMat3::from_cols(off * off.x, off * off.y, off * off.z)
    };
    let squares = errors_m.iter().map(square).fold(DMat3::ZERO, |sum, square| sum + square);
    let mut level_m: Vec<f64> = errors_m.iter().map(|error_m| error_m.truncate().length()).collect();
    level_m.sort_unstable_by(f64::total_cmp);
    Sampled {
        met: errors_m.len(),
        missed: drawn - errors_m.len(),
        mean_m,
        covariance_m2: squares * (1.0 / (n - 1.0).max(1.0)),
        level_p95_m: nearest_rank(&level_m, 0.95).unwrap_or(f64::NAN),
    }
}
