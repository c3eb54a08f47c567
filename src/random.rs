//! Numbers that look random and are a pure function of a seed and of the order in which they are drawn: SplitMix64 (Steele, Lea and Flood 2014, "Fast
//! splittable pseudorandom number generators", OOPSLA; constants of Stafford's mix 13).

use std::f64::consts::TAU;

/// Weyl increment of SplitMix64: 2^64 over the golden ratio, made odd.
pub const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// Fewer counts than this are counted one by one.
const FEW: f64 = 10.0;
/// More are not counted.
const MOST_COUNTED: f64 = 1e15;

/// The finaliser: a bijection in which every input bit moves about half of the output bits.
pub fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The numbers of one thing, in the order in which they are drawn.
#[derive(Debug, Clone)]
pub struct Draws(u64);

impl Draws {
    /// Of a seed, or of a key that is [mixed](mix) from one and from what the numbers are for.
    pub fn new(key: u64) -> Self {
        Draws(key)
    }

    /// Even over 0 to 1, 1 excluded.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(STEP);
        (mix(self.0) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Even over `lo` to `hi`.
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    /// Normal, of mean 0 and variance 1 (Box and Muller 1958; of the two numbers of a pair one, so that each draw takes as many).
    pub fn normal(&mut self) -> f64 {
        // 1 - unit is never 0.
        (-2.0 * (1.0 - self.unit()).ln()).sqrt() * (TAU * self.unit()).cos()
    }

    /// A count of which so many are expected (Poisson).
    ///
    /// Few: products of even numbers until they fall below e^-mean. Many: transformed rejection (Hörmann 1993, "The transformed rejection method for generating
    /// Poisson random variables", Insurance: Mathematics and Economics 12, algorithm PTRS). Limits: 0 for what is no positive number; above 1e15, where counts are
    /// no whole numbers of an f64 any more, the mean.
    pub fn count(&mut self, mean: f64) -> f64 {
        if mean.is_nan() || mean <= 0.0 {
            return 0.0;
        }
        if mean > MOST_COUNTED {
            return mean;
        }
        if mean < FEW {
            let (least, mut product, mut count) = ((-mean).exp(), self.unit(), 0.0);
            while product > least {
                product *= self.unit();
                count += 1.0;
            }
            return count;
        }
        let ln_mean = mean.ln();
        let b = 0.931 + 2.53 * mean.sqrt();
        let a = 0.02483 * b - 0.059;
        let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
        let inside = 0.9277 - 3.6224 / (b - 2.0);
        loop {
            let (u, v) = (self.unit() - 0.5, self.unit());
            let from_end = 0.5 - u.abs();
            let count = ((2.0 * a / from_end + b) * u + mean + 0.43).floor();
            if from_end >= 0.07 && v <= inside {
                return count;
            }
            if count < 0.0 || (from_end < 0.013 && v > from_end) {
                continue;
            }
            let accepted = (v * inverse_alpha / (a / (from_end * from_end) + b)).ln();
            if accepted <= count * ln_mean - mean - libm::lgamma(count + 1.0) {
                return count;
            }
        }
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

    /// Mean and variance of a Poisson distribution are both its mean m, its third central moment too, and 0 has the probability e^-m.
    #[test]
    fn counts_are_poissons() {
        for (mean, n) in [(0.3, 100_000), (9.9, 100_000), (10.1, 100_000), (4e3, 50_000), (1e9, 20_000)] {
            let mut draws = Draws::new(11);
            let counts: Vec<f64> = (0..n).map(|_| draws.count(mean)).collect();
            assert!(counts.iter().all(|c| *c >= 0.0 && c.fract() == 0.0));
            let n = f64::from(n);
            let central = |k: i32| counts.iter().map(|c| (c - mean).powi(k)).sum::<f64>() / n;
            // Variances of these means: m, 2 m^2 + m, and 15 m^3 + 25 m^2 + m.
            for (k, expected, variance) in [
                (1, 0.0, mean),
                (2, mean, 2.0 * mean * mean + mean),
                (3, mean, 15.0 * mean.powi(3) + 25.0 * mean * mean + mean),
            ] {
                let off = (central(k) - expected).abs() / (variance / n).sqrt();
                assert!(off < 4.5, "{mean}: moment {k} is {off} sigma off");
            }
            let none = counts.iter().filter(|c| **c == 0.0).count() as f64 / n;
            assert!((none - (-mean).exp()).abs() <= 4.5 * ((-mean).exp() / n).sqrt(), "{mean}: {none}");
        }
        let mut draws = Draws::new(1);
        assert_eq!([0.0, -1.0, f64::NAN, 1e16].map(|mean| draws.count(mean)), [0.0, 0.0, 0.0, 1e16]);
    }

    /// Moments of the normal distribution: 0, 1, 0, 3, and 4.55 % beyond two sigma; within 4 sigma of what so many draws leave open.
    #[test]
    fn normal_numbers_are_normal() {
        let (mut draws, n) = (Draws::new(3), 200_000);
        let (mut sums, mut beyond) = ([0.0; 4], 0.0);
        for _ in 0..n {
            let x = draws.normal();
            (1..=4).for_each(|k| sums[k - 1] += x.powi(k as i32) / f64::from(n));
            beyond += f64::from(x.abs() > 2.0) / f64::from(n);
        }
        // Variances of x, x^2, x^3, x^4: 1, 2, 15, 96.
        for ((sum, expected), variance) in sums.into_iter().zip([0.0, 1.0, 0.0, 3.0]).zip([1.0, 2.0, 15.0, 96.0]) {
            assert!((sum - expected).abs() < 4.0 * f64::sqrt(variance / f64::from(n)), "{sum} {expected}");
        }
        assert!((beyond - 0.0455).abs() < 4.0 * f64::sqrt(0.0455 / f64::from(n)), "{beyond}");
    }
}
