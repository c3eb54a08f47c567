//! Which numbers belong to what of a landscape.
//!
//! Nothing here depends on the order of calls, so landscapes are the same at any thread count, and a thing keeps its
//! numbers when other things are added.

use crate::random::{STEP, mix};

/// What the numbers are for; each kind has its own.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    Relief = 1,
    Crater = 2,
    Boulder = 3,
    /// Craters of the surroundings.
    CraterAround = 4,
    /// Masks of noise.
    Mask = 5,
    /// Which craters are chosen.
    Choice = 6,
    Texture = 7,
    /// What is painted where a rule holds to a share.
    Paint = 8,
    /// Relief over craters.
    Cover = 9,
}

/// The key of thing number `index` of its kind.
pub(super) fn key(seed: u64, purpose: Purpose, index: u64) -> u64 {
    mix(mix(mix(seed.wrapping_add(STEP)) ^ purpose as u64) ^ index)
}

/// The key of thing number `index` of group number `group`: things of the first group have the numbers that they would have without groups.
pub(super) fn key_in(seed: u64, purpose: Purpose, group: usize, index: u64) -> u64 {
    key(seed, purpose, index.wrapping_add((group as u64) << 40))
}
