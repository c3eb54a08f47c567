//! Polynomials.

/// The sum of c_k x^k, lowest order first; 0 without coefficients. Horner's scheme.
pub(crate) fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}
