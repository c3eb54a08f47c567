//! The squared sinc sin^2(pi x) / (pi x)^2: the response of a filter that tunes by sound, and of a spectrometer that a mirror of finite travel makes.
//!
//! x counts from zero to zero; the integral over all x is 1.

use std::f64::consts::PI;

/// The x at which it is 1/2, by 40 digits of arithmetic: its full width at half maximum is twice that.
pub const HALF_WIDTH: f64 = 0.442_946_470_689_452_4;

/// Responses are cut at so many zeros: 1 / (pi^2 N) = 0.6 % of all that passes is beyond.
pub const CUT_NULLS: u32 = 16;

/// Its value.
pub fn at(x: f64) -> f64 {
    let y = PI * x;
    if y == 0.0 { 1.0 } else { (y.sin() / y).powi(2) }
}

/// What is left of the contrast of a cosine with so many cycles in a unit of x: its Fourier transform, a triangle.
pub fn contrast(cycles: f64) -> f64 {
    (1.0 - cycles.abs()).max(0.0)
}

/// Share of all that passes within N zeros of the centre.
///
/// Simpson's rule with 128 intervals from zero to zero: an error of 1e-10.
pub fn energy_within(nulls: u32) -> f64 {
    let steps = 128 * nulls;
    let term = |i: u32| {
        let simpson = if i == 0 || i == steps {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        };
        simpson * at(f64::from(i) / 128.0)
    };
    2.0 * (0..=steps).map(term).sum::<f64>() / (3.0 * 128.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_what_tables_of_the_sine_integral_say() {
        assert!((at(HALF_WIDTH) - 0.5).abs() < 1e-15);
        // (2 / pi) Si(2 pi): Si(2 pi) = 1.418 151 576 131 (Abramowitz & Stegun, table 5.1 and 5.2.14).
        assert!((energy_within(1) - 2.0 / PI * 1.418_151_576_132_628).abs() < 1e-9);
        assert!((1.0 - energy_within(CUT_NULLS)) * PI * PI * f64::from(CUT_NULLS) - 1.0 < 1e-2);
        assert_eq!([contrast(0.0), contrast(0.25), contrast(-2.0)], [1.0, 0.75, 0.0]);
    }
}
