//! Polynomials through the nodes about a moment: Lagrange through values, Hermite through values and derivatives.

use std::ops::Range;

use glam::{DVec3, DVec4};

/// What can be interpolated: vectors and quaternions.
pub trait Value:
    Copy + std::ops::Add<Output = Self> + std::ops::Sub<Output = Self> + std::ops::Mul<f64, Output = Self>
{
    /// Nothing.
    const ZERO: Self;
}

impl Value for DVec3 {
    const ZERO: Self = DVec3::ZERO;
}

impl Value for DVec4 {
    const ZERO: Self = DVec4::ZERO;
}

/// Degree of polynomials where a file does not say it.
pub const DEFAULT_DEGREE: usize = 7;
/// Nodes of a Hermite polynomial of this degree, which has two numbers of each: two at least.
pub fn hermite_nodes(degree: usize) -> usize {
    (degree.saturating_add(2) / 2).max(2)
}
/// The degree of a polynomial through so many nodes with so many numbers of each: 1 at least.
pub(super) fn degree(nodes: usize, numbers: usize) -> usize {
    nodes.saturating_mul(numbers).saturating_sub(1).max(1)
}

/// Most nodes of one polynomial: beyond, equal steps lose all digits (Runge).
pub const MOST_NODES: usize = 28;

/// The nodes to interpolate between: as many as asked for, centred on `x` as far as the ends of the data allow. `xs`
/// ascend, and are not empty.
///
/// An even number has as many before as after; an odd number is centred on the nearest node, the later of two. SPICE
/// chooses the same.
pub fn window(xs: &[f64], x: f64, nodes: usize) -> Range<usize> {
    let nodes = nodes.clamp(1, xs.len());
    // The last node at or before x.
    let before = xs.partition_point(|node| *node <= x).saturating_sub(1);
    let first = match nodes % 2 {
        0 => (before + 1).saturating_sub(nodes / 2),
        _ => {
            let next = (before + 1).min(xs.len() - 1);
            let nearest = if xs[next] - x <= x - xs[before] { next } else { before };
            nearest.saturating_sub(nodes / 2)
        }
    };
    let first = first.min(xs.len() - nodes);
    first..first + nodes
}

/// Value and derivative at `x` of the polynomial through `values` at `xs`, which differ; empty ones give zero.
pub fn lagrange<V: Value>(x: f64, xs: &[f64], values: &[V]) -> (V, V) {
    let xs = &xs[..xs.len().min(values.len())];
    let nodes: Vec<f64> = xs.iter().map(|node| node - x).collect();
    newton_at_zero(&nodes, values[..nodes.len()].to_vec(), &[])
}

/// Value and derivative at `x` of the polynomial that has `values` and `slopes` at `xs`, which differ; empty ones give zero.
pub fn hermite<V: Value>(x: f64, xs: &[f64], values: &[V], slopes: &[V]) -> (V, V) {
    let count = xs.len().min(values.len()).min(slopes.len());
    let nodes: Vec<f64> = xs[..count].iter().flat_map(|node| [node - x; 2]).collect();
    let values: Vec<V> = values[..count].iter().flat_map(|value| [*value; 2]).collect();
    newton_at_zero(&nodes, values, &slopes[..count])
}

/// Newton's form through nodes, of which a pair that repeats takes its slope from `slopes`, and its derivative, at 0.
fn newton_at_zero<V: Value>(nodes: &[f64], mut differences: Vec<V>, slopes: &[V]) -> (V, V) {
    let count = nodes.len();
    // Divided differences, in place.
    for order in 1..count {
        for i in (order..count).rev() {
            let step = nodes[i] - nodes[i - order];
            differences[i] = if step == 0.0 {
                slopes.get(i / 2).copied().unwrap_or(V::ZERO)
            } else {
                (differences[i] - differences[i - 1]) * step.recip()
            };
        }
    }
    let (mut value, mut slope) = (V::ZERO, V::ZERO);
    for (difference, node) in differences.iter().zip(nodes).rev() {
        slope = value - slope * *node;
        value = *difference - value * *node;
    }
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial of degree 7, and its derivative.
    fn seventh(x: f64) -> (DVec3, DVec3) {
        let p = |c: f64| 1.0 + x * (c + x * x * (2.0 - c * x.powi(4)));
        let d = |c: f64| c + 6.0 * x * x - 7.0 * c * x.powi(6);
        (DVec3::new(p(0.5), p(-1.0), p(3.0)), DVec3::new(d(0.5), d(-1.0), d(3.0)))
    }

    #[test]
    fn polynomials_of_their_degree_are_met() {
        let xs = [-1.5, -0.4, 0.3, 1.1, 1.2, 1.9, 2.0, 2.6];
        let values = xs.map(|x| seventh(x).0);
        let slopes = xs.map(|x| seventh(x).1);
        for x in [-1.5, -0.9, 0.3, 0.31, 1.7, 2.6] {
            let (value, slope) = seventh(x);
            let scale = 1.0 + value.length() + slope.length();
            for (got, by) in [lagrange(x, &xs, &values), hermite(x, &xs[1..5], &values[1..5], &slopes[1..5])]
                .into_iter()
                .zip(["Lagrange", "Hermite"])
            {
                assert!((got.0 - value).length() < 1e-11 * scale, "{by} at {x}: {:?} for {value:?}", got.0);
                assert!((got.1 - slope).length() < 1e-10 * scale, "{by} at {x}: {:?} for {slope:?}", got.1);
            }
        }
    }

    #[test]
    fn windows_are_about_the_moment_and_end_with_the_data() {
        let xs = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        assert_eq!(window(&xs, 2.4, 4), 1..5);
        assert_eq!(window(&xs, 2.0, 2), 2..4, "on a node, from there on");
        assert_eq!(window(&xs, 2.4, 3), 1..4, "2 is nearest");
        assert_eq!(window(&xs, 2.6, 3), 2..5, "3 is nearest");
        assert_eq!(window(&xs, 2.5, 3), 2..5, "of two, the later");
        assert_eq!(window(&xs, 0.1, 4), 0..4);
        assert_eq!(window(&xs, 5.0, 4), 2..6);
        assert_eq!(window(&xs, -1.0, 2), 0..2);
        assert_eq!(window(&xs, 2.5, 99), 0..6);
        assert_eq!(window(&xs[..1], 7.0, 4), 0..1);
    }
}
