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
}

/// The key of thing number `index` of its kind.
pub(super) fn key(seed: u64, purpose: Purpose, index: u64) -> u64 {
    mix(mix(mix(seed.wrapping_add(STEP)) ^ purpose as u64) ^ index)
}
