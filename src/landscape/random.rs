//! Numbers that look random and are a pure function of a seed and of what they are for.
//!
//! Nothing here depends on the order of calls, so landscapes are the same at any thread count, and a thing keeps its
//! numbers when other things are added.

/// What the numbers are for; each kind has its own.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    Relief = 1,
    Crater = 2,
    Boulder = 3,
}

/// Weyl increment of SplitMix64: 2^64 over the golden ratio, made odd.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators",
/// OOPSLA; constants of Stafford's mix 13): a bijection in which every input bit moves about half of the output bits.
pub(super) fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The key of thing number `index` of its kind.
pub(super) fn key(seed: u64, purpose: Purpose, index: u64) -> u64 {
    mix(mix(mix(seed.wrapping_add(STEP)) ^ purpose as u64) ^ index)
}

/// SplitMix64: the numbers of one thing, in the order in which they are drawn.
#[derive(Debug, Clone)]
pub(super) struct Draws(u64);

impl Draws {
    /// The numbers that belong to a [`key`].
    pub(super) fn new(key: u64) -> Self {
        Draws(key)
    }

    /// Even over 0 to 1, 1 excluded.
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(STEP);
        (mix(self.0) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Even over `lo` to `hi`.
    pub(super) fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    /// A size from `lo` to `hi` out of a population in which the number larger than D goes as D^-exponent.
    ///
    /// Inverse of the truncated power law's distribution function, taken relative to `lo` so that no power overflows.
    pub(super) fn power_law(&mut self, lo: f64, hi: f64, exponent: f64) -> f64 {
        let largest = (hi / lo).powf(-exponent);
        let share = 1.0 - self.unit() * (1.0 - largest);
        (lo * share.powf(-1.0 / exponent)).clamp(lo, hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_splitmix64() {
        // First outputs for seed 1234567, as published with the reference code (https://prng.di.unimi.it/splitmix64.c)
        // and listed at https://rosettacode.org/wiki/Pseudo-random_numbers/Splitmix64.
        let published = [6457827717110365317_u64, 3203168211198807973, 9817491932198370423];
        let mut draws = Draws::new(1234567);
        for value in published {
            assert_eq!(draws.unit(), (value >> 11) as f64 / (1u64 << 53) as f64);
        }
    }

    #[test]
    fn sizes_follow_the_power_law() {
        let mut draws = Draws::new(7);
        let sizes: Vec<f64> = (0..100_000).map(|_| draws.power_law(2.0, 200.0, 2.0)).collect();
        assert!(sizes.iter().all(|d| (2.0..=200.0).contains(d)));
        // N(>4)/N(>2) = 1/4 and N(>20)/N(>2) = 1/100, less the cut at 200 (1e-4); 4 sigma of counting.
        for (size, share) in [(4.0, 0.25), (20.0, 0.01)] {
            let expected = 1e5 * (share - 1e-4) / (1.0 - 1e-4);
            let counted = sizes.iter().filter(|d| **d > size).count() as f64;
            assert!((counted - expected).abs() < 4.0 * expected.sqrt(), "{counted} above {size}, expected {expected}");
        }
    }
}
