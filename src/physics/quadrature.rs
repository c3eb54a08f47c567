//! Gauss-Legendre quadrature.

use std::f64::consts::PI;

/// Nodes and weights on (-1, 1): exact for polynomials of degree 2n - 1.
#[derive(Debug, Clone)]
pub(crate) struct GaussLegendre(Vec<(f64, f64)>);

impl GaussLegendre {
    /// Roots of the Legendre polynomial of degree `n` by Newton's method; weights 2 / ((1 - x^2) P_n'(x)^2).
    pub(crate) fn new(n: usize) -> Self {
        let node = |i: usize| {
            let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            // From this start Newton's method has converged after five steps for every n.
            for _ in 0..6 {
                let (mut p, mut before) = (1.0, 0.0);
                for k in 0..n {
                    let k = k as f64;
                    (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
                }
                slope = n as f64 * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        };
        GaussLegendre((0..n).map(node).collect())
    }

    /// Nodes and weights on (-1, 1) of Lobatto's rule without its two ends, for what is 0 there: exact up to degree 2n + 1.
    ///
    /// Nodes are the roots of P_m', m = n + 1, the extremes of P_m, by Newton's method; weights 2 / (m (m + 1) P_m(x)^2).
    pub(crate) fn inside_lobatto(n: usize) -> Vec<(f64, f64)> {
        let degree = (n + 1) as f64;
        let node = |i: usize| {
            let mut x = (PI * i as f64 / degree).cos();
            let mut value = 1.0;
            // P_m'' follows from Legendre's equation. From this start as many steps are enough for every n.
            for _ in 0..12 {
                let mut before = 0.0;
                value = 1.0;
                for k in 0..=n {
                    let k = k as f64;
                    (value, before) = (((2.0 * k + 1.0) * x * value - k * before) / (k + 1.0), value);
                }
                let slope = degree * (x * value - before) / (x * x - 1.0);
                let bend = (2.0 * x * slope - degree * (degree + 1.0) * value) / (1.0 - x * x);
                x -= slope / bend;
            }
            (x, 2.0 / (degree * (degree + 1.0) * value * value))
        };
        (1..=n).map(node).collect()
    }

    /// Nodes and weights on (a, b).
    pub(crate) fn nodes(&self, a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        self.0.iter().map(move |(x, weight)| (middle + half * x, half * weight))
    }

    /// Integral of `f` from `a` to `b`.
    pub(crate) fn integral(&self, a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
        self.nodes(a, b).map(|(x, weight)| weight * f(x)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_up_to_degree_2n_minus_1_are_exact() {
        for n in [1, 2, 5, 24] {
            let rule = GaussLegendre::new(n);
            for degree in 0..2 * n as i32 {
                let expected = (3f64.powi(degree + 1) - 1.0) / f64::from(degree + 1);
                let got = rule.integral(1.0, 3.0, |x| x.powi(degree));
                assert!((got / expected - 1.0).abs() < 2e-14, "{n} {degree}: {got} {expected}");
            }
        }
    }

    #[test]
    fn polynomials_that_vanish_at_both_ends() {
        // Integral of (1 - x^2) x^(2k): 2 / (2k + 1) - 2 / (2k + 3).
        for n in [1, 2, 3, 8, 24] {
            for k in 0..n as i32 {
                let expected = 2.0 / f64::from(2 * k + 1) - 2.0 / f64::from(2 * k + 3);
                let of = |(x, weight): (f64, f64)| weight * (1.0 - x * x) * x.powi(2 * k);
                let got: f64 = GaussLegendre::inside_lobatto(n).into_iter().map(of).sum();
                assert!((got / expected - 1.0).abs() < 1e-13, "{n} {k}: {got} {expected}");
            }
        }
    }

    #[test]
    fn an_exponential_is_exact_to_rounding() {
        let got = GaussLegendre::new(16).integral(0.0, 1.0, f64::exp);
        assert!((got - (std::f64::consts::E - 1.0)).abs() < 1e-15);
    }
}
