//! Errors of a pixel by Monte Carlo: states that may be believed, drawn at random, and where each leads.

use glam::{DMat3, DVec3};

use super::{Asked, Deviation, Knowledge};
use crate::geometry::whole;
use crate::random::{Draws, mix};

/// Errors that came out of draws, along east, north and up at the true point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampled {
    /// Draws whose ray meets the believed surface.
    pub met: usize,
    /// Draws whose ray does not.
    pub missed: usize,
    /// Their mean, m.
    pub mean_m: DVec3,
    /// Their covariance, m^2, without the bias of small numbers; 0 of one alone.
    pub covariance_m2: DMat3,
    /// 95 of 100 are off by less along the ground, m.
    pub level_p95_m: f64,
}

/// The states of a study: the same for all of its pixels, as those of one image are.
pub(super) fn draws(knowledge: &Knowledge, asked: Asked) -> Vec<Deviation> {
    let mut draws = Draws::new(mix(asked.seed));
    (0..asked.draws).map(|_| knowledge.drawn(&mut draws)).collect()
}

/// The value that a share of sorted numbers does not pass.
pub(super) fn nearest_rank(sorted: &[f64], share: f64) -> Option<f64> {
    let rank = (share * sorted.len() as f64).ceil().max(1.0);
    sorted.get(whole(rank) - 1).copied()
}

/// What errors, m, of some draws have in common.
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
