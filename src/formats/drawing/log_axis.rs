//! An axis of powers of ten.

/// Where numbers lie along an axis, by their logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogAxis {
    /// Powers of ten at its ends.
    pub powers: [i32; 2],
    /// Where the ends are, px.
    pub ends: [f64; 2],
}

impl LogAxis {
    /// Whole powers of ten around all positive numbers, at least one, within some limits.
    pub fn around(values: impl Iterator<Item = f64>, limits: [i32; 2], ends: [f64; 2]) -> Self {
        let positive = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) = positive.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let whole = |x: f64, otherwise: i32| {
            #[expect(clippy::cast_possible_truncation, reason = "a power of ten of an f64 is within 400 of 0")]
            let power = x as i32;
            if x.is_finite() { power } else { otherwise }
        };
        let low = whole(low.floor(), limits[0]).clamp(limits[0], limits[1] - 1);
        let high = whole(high.ceil(), limits[1]).clamp(low + 1, limits[1]);
        LogAxis { powers: [low, high], ends }
    }

    /// Where a number lies; beyond the ends, at the end.
    pub fn at(&self, value: f64) -> f64 {
        let [low, high] = self.powers.map(f64::from);
        let share = if value > 0.0 { ((value.log10() - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    /// The powers of ten along it.
    pub fn ticks(&self) -> impl Iterator<Item = i32> {
        self.powers[0]..=self.powers[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lie_where_their_logarithms_do() {
        let axis = LogAxis::around([0.0, 0.02, 30.0].into_iter(), [-8, 3], [0.0, 400.0]);
        assert_eq!(axis.powers, [-2, 2]);
        assert_eq!([0.01, 1.0, 100.0, 1e9, 0.0].map(|x| axis.at(x)), [0.0, 200.0, 400.0, 400.0, 0.0]);
        assert_eq!(LogAxis::around([].into_iter(), [-8, 3], [0.0, 1.0]).powers, [-8, 3]);
    }
}
