//! Thermal radiation of a black body.

use std::f64::consts::PI;

use crate::units::{BOLTZMANN_J_K, LIGHT_SPEED_M_S, PLANCK_J_S, STEFAN_BOLTZMANN_W_M2_K4};

/// First radiation constant for radiance, 2 h c^2, W m-2 sr-1 um^4.
pub const C1_W_M2_SR_UM4: f64 = 2.0 * PLANCK_J_S * LIGHT_SPEED_M_S * LIGHT_SPEED_M_S * 1e24;
/// Second radiation constant, h c / k, um K.
pub const C2_UM_K: f64 = PLANCK_J_S * LIGHT_SPEED_M_S / BOLTZMANN_J_K * 1e6;

/// Spectral radiance of a black body, W m-2 sr-1 um-1.
///
/// L = C1 lambda^-5 / (exp(C2 / (lambda T)) - 1), by `expm1`, which keeps the digits where lambda T is large.
/// Source: Planck; equation (10) of Domagala (2020) without its emissivity.
/// Limits: 0 at T = 0 and, by underflow, where C2 / (lambda T) > 709; both arguments must be >= 0.
pub fn radiance_w_m2_sr_um(lambda_um: f64, t_k: f64) -> f64 {
    let exponential = (C2_UM_K / (lambda_um * t_k)).exp_m1();
    // Also where lambda = 0, at which lambda^-5 is infinite.
    if exponential == f64::INFINITY {
        return 0.0;
    }
    C1_W_M2_SR_UM4 / (lambda_um.powi(5) * exponential)
}

/// Temperature of the black body that has this radiance, K: [`radiance_w_m2_sr_um`] solved for T.
///
/// Limits: 0 for no radiance.
pub fn temperature_k(lambda_um: f64, radiance_w_m2_sr_um: f64) -> f64 {
    C2_UM_K / (lambda_um * (C1_W_M2_SR_UM4 / (lambda_um.powi(5) * radiance_w_m2_sr_um)).ln_1p())
}

/// Radiance of a black body between two wavelengths, W m-2 sr-1.
///
/// L = (15 sigma T^4 / pi^5) (G(x1) - G(x2)), x = C2 / (lambda T), G(x) = integral of t^3 / (e^t - 1) from x to infinity.
/// Source: Chang & Rhee (1984), Int. Comm. Heat Mass Transfer 11, 451, the two series of which meet at x = 1.5.
/// Limits: error about 1e-15 of the larger G, so a narrow band of relative width w is good to 1e-15 / w.
pub fn band_radiance_w_m2_sr(from_um: f64, to_um: f64, t_k: f64) -> f64 {
    if t_k == 0.0 {
        return 0.0;
    }
    let (x_long, x_short) = (C2_UM_K / (to_um * t_k), C2_UM_K / (from_um * t_k));
    // Both on the long-wave side: the constant pi^4 / 15 would only cost digits.
    let difference = if x_long < X_SERIES && x_short < X_SERIES {
        head(x_short) - head(x_long)
    } else {
        tail(x_long) - tail(x_short)
    };
    15.0 * STEFAN_BOLTZMANN_W_M2_K4 / PI.powi(5) * t_k.powi(4) * difference
}

/// Below this x the power series converges faster, above it the exponential one.
const X_SERIES: f64 = 1.5;

/// Integral of t^3 / (e^t - 1) from x to infinity: sum of e^(-nx) (x^3/n + 3 x^2/n^2 + 6 x/n^3 + 6/n^4), or pi^4/15 less the `head`.
fn tail(x: f64) -> f64 {
    if x < X_SERIES {
        return PI.powi(4) / 15.0 - head(x);
    }
    if x == f64::INFINITY {
        return 0.0;
    }
    #[expect(clippy::cast_possible_truncation, reason = "40 / X_SERIES at the most")]
    let terms = (40.0 / x).ceil().max(2.0) as u32;
    // Smallest terms first.
    (1..=terms)
        .rev()
        .map(|n| {
            let n = f64::from(n);
            (-n * x).exp() * (x * x * x + (3.0 * x * x + (6.0 * x + 6.0 / n) / n) / n) / n
        })
        .sum()
}

/// Integral of t^3 / (e^t - 1) from 0 to x < 2 pi: x^3 (1/3 - x/8 + sum of B_2k x^2k / ((2k + 3) (2k)!)), B the Bernoulli numbers.
fn head(x: f64) -> f64 {
    const COEFFICIENTS: [f64; 10] = [
        1.0 / 60.0,
        -1.0 / 5_040.0,
        1.0 / 272_160.0,
        -1.0 / 13_305_600.0,
        1.0 / 622_702_080.0,
        -691.0 / 19_615_115_520_000.0,
        1.0 / 1_270_312_243_200.0,
        -3_617.0 / 202_741_834_014_720_000.0,
        43_867.0 / 107_290_978_560_589_824_000.0,
        -174_611.0 / 18_465_726_242_060_697_600_000.0,
    ];
    let y = x * x;
    let sum = COEFFICIENTS.iter().rev().fold(0.0, |sum, c| sum * y + c);
    x * y * (1.0 / 3.0 - x / 8.0 + y * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiation_constants_are_those_of_codata() {
        // CODATA 2018: 1.191042972...e-16 W m^2 sr-1, 1.438776877...e-2 m K.
        assert!((C1_W_M2_SR_UM4 / 1.191_042_972e8 - 1.0).abs() < 1e-9);
        assert!((C2_UM_K / 1.438_776_877e4 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn nothing_shines_at_absolute_zero_and_nothing_is_nan() {
        assert_eq!(radiance_w_m2_sr_um(3.0, 0.0), 0.0);
        assert_eq!(radiance_w_m2_sr_um(0.0, 300.0), 0.0);
        assert_eq!(radiance_w_m2_sr_um(0.0, 0.0), 0.0);
        assert_eq!(radiance_w_m2_sr_um(0.9, 10.0), 0.0);
        assert_eq!(band_radiance_w_m2_sr(1.0, 2.0, 0.0), 0.0);
        assert_eq!(band_radiance_w_m2_sr(0.0, 1e-3, 300.0), 0.0);
    }

    #[test]
    fn long_waves_obey_rayleigh_and_jeans() {
        // 2 c k T / lambda^4, less x / 2 of it; at 1 m, per um.
        let (um, t_k) = (1e6, 300.0);
        let x = C2_UM_K / (um * t_k);
        let expected = 2.0 * LIGHT_SPEED_M_S * BOLTZMANN_J_K * t_k * 1e-6 * (1.0 - x / 2.0);
        assert!((radiance_w_m2_sr_um(um, t_k) / expected - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_whole_spectrum_obeys_stefan_and_boltzmann() {
        for t_k in [30.0, 300.0, 3000.0] {
            let expected = STEFAN_BOLTZMANN_W_M2_K4 * f64::powi(t_k, 4) / PI;
            let got = band_radiance_w_m2_sr(0.0, f64::INFINITY, t_k);
            assert!((got / expected - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_two_series_agree_where_they_meet() {
        let below = PI.powi(4) / 15.0 - head(X_SERIES);
        assert!((tail(X_SERIES) / below - 1.0).abs() < 1e-14, "{} {below}", tail(X_SERIES));
    }

    #[test]
    fn a_band_is_the_integral_of_the_radiance() {
        let mut seen = 0;
        for (a, b) in [(0.9, 3.6), (8.0, 12.0), (20.0, 60.0), (100.0, 101.0), (200.0, 1000.0)] {
            for t_k in [150.0, 300.0, 500.0] {
                let rule = crate::physics::GaussLegendre::new(48);
                let (mut sum, steps) = (0.0, 8);
                for i in 0..steps {
                    let at = |i| a + (b - a) * f64::from(i) / f64::from(steps);
                    sum += rule.integral(at(i), at(i + 1), |um| radiance_w_m2_sr_um(um, t_k));
                }
                let got = band_radiance_w_m2_sr(a, b, t_k);
                assert!((got / sum - 1.0).abs() < 1e-11, "{a} {b} {t_k}: {got} {sum}");
                seen += 1;
            }
        }
        assert_eq!(seen, 15);
    }
}
