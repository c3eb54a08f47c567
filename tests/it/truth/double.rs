//! Numbers of 106 bits: the sum of two f64, of which the second is below the rounding of the first.
//!
//! Source: Joldes, Muller & Popescu (2017), ACM Trans. Math. Softw. 44, 15: relative errors of a few 2^-106.

use std::ops::{Add, Div, Mul, Neg, Sub};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Double(f64, f64);

pub(super) const ZERO: Double = Double(0.0, 0.0);
pub(super) const ONE: Double = Double(1.0, 0.0);

fn two_sum(a: f64, b: f64) -> Double {
    let s = a + b;
    let t = s - a;
    Double(s, (a - (s - t)) + (b - t))
}

fn quick_two_sum(a: f64, b: f64) -> Double {
    let s = a + b;
    Double(s, b - (s - a))
}

impl From<f64> for Double {
    fn from(x: f64) -> Self {
        Double(x, 0.0)
    }
}

impl Add for Double {
    type Output = Double;
    fn add(self, o: Double) -> Double {
        let s = two_sum(self.0, o.0);
        let t = two_sum(self.1, o.1);
        let v = quick_two_sum(s.0, s.1 + t.0);
        quick_two_sum(v.0, t.1 + v.1)
    }
}

impl Neg for Double {
    type Output = Double;
    fn neg(self) -> Double {
        Double(-self.0, -self.1)
    }
}

impl Sub for Double {
    type Output = Double;
    fn sub(self, o: Double) -> Double {
        self + -o
    }
}

impl Mul for Double {
    type Output = Double;
    fn mul(self, o: Double) -> Double {
        let p = self.0 * o.0;
        let e = self.0.mul_add(o.0, -p);
        quick_two_sum(p, e + (self.0 * o.1 + self.1 * o.0))
    }
}

impl Div for Double {
    type Output = Double;
    fn div(self, o: Double) -> Double {
        let first = self.0 / o.0;
        let rest = self - o * Double::from(first);
        let second = rest.0 / o.0;
        let rest = rest - o * Double::from(second);
        quick_two_sum(first, second) + Double::from(rest.0 / o.0)
    }
}

impl Double {
    /// Rounded.
    pub(super) fn f64(self) -> f64 {
        self.0 + self.1
    }

    /// The number without its sign, rounded.
    pub(super) fn size(self) -> f64 {
        self.0.abs()
    }

    /// The same number with the sign of another.
    pub(super) fn signed(self, by: Double) -> Double {
        if by.0 < 0.0 { -self } else { self }
    }
}

pub(super) type Vector = [Double; 3];

pub(super) fn vector(v: glam::DVec3) -> Vector {
    v.to_array().map(Double::from)
}

pub(super) fn minus(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|k| a[k] - b[k])
}

pub(super) fn times(a: Vector, by: Double) -> Vector {
    a.map(|x| x * by)
}

pub(super) fn dot(a: Vector, b: Vector) -> Double {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Sum of the sizes of components: what a length is compared with.
pub(super) fn size(a: Vector) -> f64 {
    a.iter().map(|x| x.size()).sum()
}

#[test]
fn a_third_is_known_to_31_digits() {
    let third = ONE / Double::from(3.0);
    let rest = ONE - third * Double::from(3.0);
    assert!(rest.size() < 1e-31 && third.1 != 0.0, "{rest:?}");
    // (1 + 2^-60) (1 - 2^-60) = 1 - 2^-120, and 2^-60 alone is kept beside 1.
    let tiny = Double::from(0.5_f64.powi(60));
    assert_eq!((ONE + tiny) - ONE, tiny);
    assert!(((ONE + tiny) * (ONE - tiny) - ONE).size() < 1e-31);
}
