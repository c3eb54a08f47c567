//! Thermal emission as weights on a few fixed temperatures.

use crate::geometry::whole;
use crate::physics::blackbody;

/// Temperatures in geometric progression; values between are interpolated from the six nearest.
///
/// B(l, T) is smooth in ln T: its sixth derivative is about x^6 B with x = h c / (l k T), so the error of six-point
/// interpolation in steps d of ln T is at most 0.0049 (x d)^6 B (225/64 / 6! in the middle interval).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TemperatureGrid {
    first: f64,
    count: usize,
}

/// Step in ln T: 2 K at 300 K.
const STEP: f64 = 1.0 / 150.0;
/// Largest relative error of the interpolated radiance: 0.0049 (x d)^6, times exp(3 x d) for its growth
/// over the six points; x = h c / (l k T).
pub fn interpolation_error(lambda_um: f64, temperature_k: f64) -> f64 {
    let xd = blackbody::C2_UM_K / (lambda_um * temperature_k) * STEP;
    0.0049 * xd.powi(6) * (3.0 * xd).exp()
}

/// Points used for one temperature.
pub(super) const POINTS: usize = 6;
/// Below this nothing is emitted: at 10 um and 5 K, h c / (l k T) = 288.
const COLDEST_K: f64 = 5.0;

impl TemperatureGrid {
    /// A grid that holds all these temperatures; those below 5 K emit nothing.
    pub(super) fn new(temperatures_k: impl Iterator<Item = f64>) -> Self {
        let range = temperatures_k
            .filter(|t| *t >= COLDEST_K)
            .fold(None, |r: Option<(f64, f64)>, t| Some(r.map_or((t, t), |(lo, hi)| (lo.min(t), hi.max(t)))));
        let Some((lo, hi)) = range else { return TemperatureGrid { first: 0.0, count: 0 } };
        let first = (lo.ln() / STEP).floor() - 2.0;
        let last = (hi.ln() / STEP).floor() + 3.0;
        TemperatureGrid { first, count: whole(last - first) + 1 }
    }

    /// The temperatures, K.
    pub(super) fn temperatures_k(&self) -> impl Iterator<Item = f64> {
        (0..self.count).map(|i| ((self.first + i as f64) * STEP).exp())
    }

    /// Number of temperatures.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// First of the six points for a temperature, and their weights (sum 1); `None` if it emits nothing.
    pub(super) fn weights(&self, temperature_k: f64) -> Option<(usize, [f64; POINTS])> {
        let emits = temperature_k >= COLDEST_K && self.count >= POINTS;
        if !emits {
            return None;
        }
        let x = temperature_k.ln() / STEP - self.first;
        let i = whole(x).clamp(2, self.count - 4);
        // Lagrange polynomials on the points -2 .. 3.
        let t = x - i as f64;
        let (a, b, c, d, e, f) = (t + 2.0, t + 1.0, t, t - 1.0, t - 2.0, t - 3.0);
        let (ab, cd, ef) = (a * b, c * d, e * f);
        let (abcd, abef, cdef) = (ab * cd, ab * ef, cd * ef);
        let weights = [
            -1.0 / 120.0 * b * cdef,
            1.0 / 24.0 * a * cdef,
            -1.0 / 12.0 * d * abef,
            1.0 / 12.0 * c * abef,
            -1.0 / 24.0 * abcd * f,
            1.0 / 120.0 * abcd * e,
        ];
        Some((i - 2, weights))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn emission_between_the_points_stays_within_its_bound() {
        let grid = TemperatureGrid::new([100.0, 400.0].into_iter());
        let points: Vec<f64> = grid.temperatures_k().collect();
        let mut seen = 0;
        for um in [0.95, 2.0, 3.0, 3.6, 10.0] {
            for i in 0..=600 {
                let t = 100.0 + 0.5 * f64::from(i);
                let (first, weights) = grid.weights(t).unwrap();
                let parts = weights.iter().enumerate();
                let got: f64 = parts.map(|(k, w)| w * blackbody::radiance_w_m2_sr_um(um, points[first + k])).sum();
                let exact = blackbody::radiance_w_m2_sr_um(um, t);
                assert!((got / exact - 1.0).abs() <= interpolation_error(um, t) + 1e-12, "{um} um, {t} K");
                seen += 1;
            }
        }
        assert_eq!(seen, 5 * 601);
        // What it comes to where thermal emission matters.
        assert!(interpolation_error(3.0, 300.0) < 1e-8);
    }

    #[test]
    fn absolute_cold_emits_nothing() {
        let grid = TemperatureGrid::new([0.0, 300.0].into_iter());
        assert_eq!(grid.len(), 6);
        assert!(grid.weights(0.0).is_none());
        assert!(TemperatureGrid::new([0.0].into_iter()).weights(0.0).is_none());
    }
}
