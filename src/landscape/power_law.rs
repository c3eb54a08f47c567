//! Sizes of which the number larger than D goes as D^-exponent, between a smallest and a largest one.

/// A population. All is relative to the smallest size, so that no power overflows.
#[derive(Debug, Clone, Copy)]
pub(super) struct PowerLaw {
    least: f64,
    most: f64,
    exponent: f64,
    /// Those larger than the largest, of those larger than the smallest, if the law went on.
    beyond: f64,
}

impl PowerLaw {
    /// Sizes from `least` to `most`; if they are equal, of that one size.
    pub(super) fn new(least: f64, most: f64, exponent: f64) -> Self {
        PowerLaw { least, most, exponent, beyond: (most / least).powf(-exponent) }
    }

    /// The size above which all are but this share: the inverse of the distribution function.
    pub(super) fn size(&self, below: f64) -> f64 {
        let larger = 1.0 - below * (1.0 - self.beyond);
        (self.least * larger.powf(-1.0 / self.exponent)).clamp(self.least, self.most)
    }

    /// The share that is larger than a size of the population.
    pub(super) fn larger(&self, size: f64) -> f64 {
        if self.least == self.most {
            return 0.0;
        }
        ((size / self.least).powf(-self.exponent) - self.beyond) / (1.0 - self.beyond)
    }

    /// How many there are for each that would be larger than the smallest, if the law went on beyond the largest. Of one size all are.
    pub(super) fn share_within(&self) -> f64 {
        if self.least == self.most { 1.0 } else { 1.0 - self.beyond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Draws;

    #[test]
    fn sizes_follow_the_law() {
        let law = PowerLaw::new(2.0, 200.0, 2.0);
        let mut draws = Draws::new(7);
        let sizes: Vec<f64> = (0..100_000).map(|_| law.size(draws.unit())).collect();
        assert!(sizes.iter().all(|d| (2.0..=200.0).contains(d)));
        // N(>4)/N(>2) = 1/4 and N(>20)/N(>2) = 1/100, less the cut at 200 (1e-4); 4 sigma of counting.
        for (size, share) in [(4.0, 0.25), (20.0, 0.01)] {
            let expected = 1e5 * (share - 1e-4) / (1.0 - 1e-4);
            assert!((law.larger(size) * 1e5 - expected).abs() < 1e-6);
            let counted = sizes.iter().filter(|d| **d > size).count() as f64;
            assert!((counted - expected).abs() < 4.0 * expected.sqrt(), "{counted} above {size}, expected {expected}");
        }
    }

    #[test]
    fn one_size_and_extremes() {
        let one = PowerLaw::new(5.0, 5.0, 1.8);
        assert_eq!([one.size(0.0), one.size(1.0), one.larger(5.0), one.share_within()], [5.0, 5.0, 0.0, 1.0]);
        let wide = PowerLaw::new(1e-300, 1e300, 10.0);
        assert!(wide.size(0.5) < 1.1e-300 && wide.larger(1.0) == 0.0 && wide.share_within() == 1.0);
        let law = PowerLaw::new(8.0, 500.0, 1.8);
        assert!((law.larger(law.size(0.3)) - 0.7).abs() < 1e-12);
        assert!((law.share_within() - (1.0 - (8.0f64 / 500.0).powf(1.8))).abs() < 1e-15);
    }
}
