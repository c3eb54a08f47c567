//! Chebyshev series by intervals of time, as SPICE kernels hold them.

/// Records of equal length, consecutive in time; each holds a series for some components.
#[derive(Debug, Clone, PartialEq)]
pub struct Chebyshev {
    /// Where the first interval starts, s of TDB since J2000.
    pub start_s: f64,
    /// Length of an interval, s.
    pub interval_s: f64,
    /// Coefficients of one series.
    pub terms: usize,
    /// Series per record: 3, or 6 with those of the derivatives.
    pub series: usize,
    /// For each record its midpoint and half length, s, then its series.
    pub records: Vec<f64>,
}

impl Chebyshev {
    /// Whether counts and lengths are consistent.
    pub fn is_sound(&self) -> bool {
        let size = self.record();
        self.terms > 0
            && [3, 6].contains(&self.series)
            && self.interval_s > 0.0
            && self.start_s.is_finite()
            && !self.records.is_empty()
            && self.records.len().is_multiple_of(size)
            && self.records.iter().all(|v| v.is_finite())
            && self.records.chunks_exact(size).all(|record| record[1] > 0.0)
    }

    fn record(&self) -> usize {
        2 + self.terms * self.series
    }

    /// The first three series and their derivatives per s (stored ones, if any) at a time, s; outside, those of the
    /// nearest record.
    pub fn at(&self, tdb_s: f64) -> [[f64; 3]; 2] {
        let count = self.records.len() / self.record();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped by the saturating cast, and below"
        )]
        let index = (((tdb_s - self.start_s) / self.interval_s).floor() as usize).min(count.saturating_sub(1));
        let record = &self.records[index * self.record()..][..self.record()];
        let (half_s, x) = (record[1], (tdb_s - record[0]) / record[1]);
        let series = |i: usize| &record[2 + i * self.terms..][..self.terms];
        let first: [(f64, f64); 3] = std::array::from_fn(|i| sum(series(i), x));
        let slopes = match self.series {
            6 => std::array::from_fn(|i| sum(series(3 + i), x).0),
            _ => first.map(|(_, slope)| slope / half_s),
        };
        [first.map(|(value, _)| value), slopes]
    }
}

/// Sum of c_k T_k(x), and its derivative by x: Clenshaw's recurrence.
fn sum(coefficients: &[f64], x: f64) -> (f64, f64) {
    let (mut b1, mut b2, mut d1, mut d2) = (0.0, 0.0, 0.0, 0.0);
    for c in coefficients.iter().skip(1).rev() {
        (d1, d2) = (2.0 * b1 + 2.0 * x * d1 - d2, d1);
        (b1, b2) = (c + 2.0 * x * b1 - b2, b1);
    }
    let first = coefficients.first().copied().unwrap_or(0.0);
    (first + x * b1 - b2, b1 + x * d1 - d2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_the_sum_of_its_polynomials() {
        // T0 = 1, T1 = x, T2 = 2 x^2 - 1, T3 = 4 x^3 - 3 x.
        let c = [0.5, -2.0, 3.0, 0.25];
        for x in [-1.0, -0.3, 0.0, 0.7, 1.0] {
            let value = 0.5 - 2.0 * x + 3.0 * (2.0 * x * x - 1.0) + 0.25 * (4.0 * x * x * x - 3.0 * x);
            let slope = -2.0 + 12.0 * x + 0.25 * (12.0 * x * x - 3.0);
            let got = sum(&c, x);
            assert!((got.0 - value).abs() < 1e-14 && (got.1 - slope).abs() < 1e-14, "{got:?} at {x}");
        }
        assert_eq!(sum(&[], 0.3), (0.0, 0.0));
        assert_eq!(sum(&[4.0], 0.3), (4.0, 0.0));
    }

    #[test]
    fn the_record_of_the_moment_is_taken() {
        // Two intervals of 10 s: x(t) = t - 5 in the first, 7 in the second; derivatives are per s.
        let mut records = vec![5.0, 5.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0];
        records.extend([15.0, 5.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let series = Chebyshev { start_s: 0.0, interval_s: 10.0, terms: 2, series: 3, records };
        assert!(series.is_sound());
        assert_eq!(series.at(7.0), [[2.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
        assert_eq!(series.at(10.0), [[7.0, 0.0, 0.0], [0.0; 3]]);
        assert_eq!(series.at(20.0), [[7.0, 0.0, 0.0], [0.0; 3]], "the end belongs to the last record");
    }
}
