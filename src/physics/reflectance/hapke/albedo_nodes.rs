//! Hapke's model at all wavelengths by its values at a few single-scattering albedos.
//!
//! At fixed angles f / w is a smooth function of gamma = sqrt(1 - w), close to a polynomial: f(w) = sum over nodes of
//! (f_k / w_k) w L_k(gamma), with Lagrange polynomials L_k. The first factor is geometry, a weight; the rest is a spectrum, a row.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use super::{H, Parameters};
use crate::physics::reflectance::PhotometricAngles;
use crate::physics::reflectance::albedo::Measure;

/// With so many the error is below 1e-12 for w from 0 to 1.
const MOST_NODES: usize = 32;

/// Values of w at which the model is evaluated: Chebyshev's points in gamma over a material's own range of w.
#[derive(Debug, Clone, PartialEq)]
pub struct AlbedoNodes {
    parameters: Parameters,
    gamma: Vec<f64>,
    h: Vec<H>,
}

impl AlbedoNodes {
    /// `count` nodes, 1 at least, for albedos w within this range, itself within 0 and 1.
    pub fn new(parameters: Parameters, albedos: &RangeInclusive<f64>, count: usize) -> Self {
        let (middle, half) = gammas(albedos);
        let step = PI / count as f64;
        let gamma: Vec<f64> = (0..count).map(|k| middle + half * (step * (k as f64 + 0.5)).cos()).collect();
        let h = gamma.iter().map(|g| parameters.h.function(1.0 - g * g)).collect();
        AlbedoNodes { parameters, gamma, h }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.gamma.len()
    }

    /// f / w at each node, 1/sr: the weights of the rows for a fragment seen at these angles.
    pub fn weights<'a>(&'a self, angles: &PhotometricAngles) -> impl Iterator<Item = f64> + 'a {
        let at = self.parameters.at(angles);
        let places = at.places(self.parameters.h);
        self.h.iter().map(move |h| at.per_albedo_at(h, &places))
    }

    /// The same of a measured reflectance, such as an albedo: what it is over w at each node. Times rows, it is that reflectance at any wavelength.
    pub fn measured(&self, measure: &Measure) -> Vec<f64> {
        let mut sums = vec![0.0; self.count()];
        for (angles, weight) in measure.points() {
            sums.iter_mut().zip(self.weights(&angles)).for_each(|(sum, of_node)| *sum += weight * of_node);
        }
        sums
    }

    /// w L_k(gamma) of each node: the rows at a wavelength where the albedo is w, within the range.
    pub fn rows(&self, albedo: f64) -> impl Iterator<Item = f64> + '_ {
        let gamma = (1.0 - albedo).max(0.0).sqrt();
        (0..self.count()).map(move |k| {
            let others = (0..self.count()).filter(|&j| j != k);
            albedo * others.map(|j| (gamma - self.gamma[j]) / (self.gamma[k] - self.gamma[j])).product::<f64>()
        })
    }
}

/// Middle and half width of a range of albedos in gamma = sqrt(1 - w).
fn gammas(albedos: &RangeInclusive<f64>) -> (f64, f64) {
    let gamma = |w: f64| (1.0 - w).max(0.0).sqrt();
    let (high, low) = (gamma(*albedos.start()), gamma(*albedos.end()));
    (0.5 * (high + low), 0.5 * (high - low))
}

/// A bound of the relative error of f that `count` nodes leave over a range of albedos.
///
/// `least_single` is the least of p(g) (1 + B_S), as [`PhaseFunction::least`](crate::physics::reflectance::PhaseFunction::least) of the
/// first factor: f is w (single + H H - 1), and only H H is interpolated. (1 + (z + 1) n z' ) / T_n(z), z' = (z^2 - 1)^(-1/2), over
/// the lesser of 1 and that; z is where the nearest pole of H H is, gamma = -1/2, if -1 to 1 is the range.
/// Source: the interpolation of 1 / (z - t)^2 at the zeros of T_n, whose remainder is known exactly; it is H H of 1981 at x = x0 = 1, and
/// other arguments and the other two H are smoother (tested). Limits: infinite for phase functions that reach 0.
pub fn interpolation_error(albedos: &RangeInclusive<f64>, count: usize, least_single: f64) -> f64 {
    let (middle, half) = gammas(albedos);
    if half <= 0.0 {
        return 0.0;
    }
    let (z, n) = ((middle + 0.5) / half, count as f64);
    let of_h = (1.0 + (z + 1.0) * n / (z * z - 1.0).sqrt()) / (n * z.acosh()).cosh();
    of_h / least_single.clamp(0.0, 1.0)
}

/// The least number of nodes whose error is below a relative tolerance by [`interpolation_error`]; at most 32.
pub fn node_count(albedos: &RangeInclusive<f64>, least_single: f64, tolerance: f64) -> usize {
    (1..MOST_NODES).find(|&n| interpolation_error(albedos, n, least_single) <= tolerance).unwrap_or(MOST_NODES)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::hapke::{HFormula, Hapke, Roughness, Surge};
    use crate::physics::reflectance::{Brdf, PhaseFunction};

    fn parameters(h: HFormula) -> Parameters {
        Parameters {
            phase: PhaseFunction::HenyeyGreenstein { b: -0.27 },
            shadow_hiding: Surge { amplitude: 2.28, width: 0.057 },
            roughness: Roughness::of_mean_slope(0.3),
            h,
            ..Parameters::PLAIN
        }
    }

    /// Largest relative error of f over angles and albedos of the range.
    fn worst(nodes: &AlbedoNodes, albedos: &RangeInclusive<f64>) -> f64 {
        let mut worst = 0.0_f64;
        for step in 0..=24 {
            let w = albedos.start() + (albedos.end() - albedos.start()) * f64::from(step) / 24.0;
            let rows: Vec<f64> = nodes.rows(w).collect();
            let exact = Hapke::new(w, nodes.parameters);
            for k in 0..200 {
                // Angles from the zenith to the horizon, in squares, of light and view apart.
                let at = |k: i32, n: i32| 0.5 * PI * (1.0 - (f64::from(k % n) / f64::from(n - 1)).powi(2));
                let angles = PhotometricAngles::of_angles(at(k, 14), at(k / 14, 15), PI * f64::from(k % 5) / 4.0);
                let sum: f64 = nodes.weights(&angles).zip(&rows).map(|(weight, row)| weight * row).sum();
                worst = worst.max((sum / exact.brdf(&angles) - 1.0).abs());
            }
        }
        worst
    }

    #[test]
    fn no_error_is_above_its_bound() {
        for h in [HFormula::Exact, HFormula::Hapke1981, HFormula::Hapke2002] {
            let parameters = parameters(h);
            for albedos in [0.03..=0.12, 0.02..=0.3, 0.02..=0.6, 0.02..=0.95, 0.3..=1.0] {
                for count in [1, 2, 3, 4, 5, 6, 8, 12] {
                    let error = worst(&AlbedoNodes::new(parameters, &albedos, count), &albedos);
                    let bound = interpolation_error(&albedos, count, parameters.phase.least());
                    // The table of H has its own error.
                    assert!(error <= bound.max(1e-10), "{h:?} {albedos:?} {count}: {error:e} {bound:e}");
                }
            }
        }
    }

    #[test]
    fn albedos_of_a_spectrum_from_a_few_nodes() {
        let (parameters, albedos) = (parameters(HFormula::Exact), 0.03..=0.12);
        let nodes = AlbedoNodes::new(parameters, &albedos, 4);
        let measure = Measure::DirectionalHemispherical { cos_incidence: 0.7 };
        let at_nodes = nodes.measured(&measure);
        for w in [0.03, 0.0571, 0.12] {
            let by_nodes: f64 = at_nodes.iter().zip(nodes.rows(w)).map(|(of_node, row)| of_node * row).sum();
            let exact = measure.of(&Brdf::Hapke(Box::new(Hapke::new(w, parameters))));
            assert!((by_nodes / exact - 1.0).abs() < 1e-7, "{w}: {by_nodes} {exact}");
        }
    }

    #[test]
    fn the_number_of_nodes_follows_from_the_tolerance() {
        let least = PhaseFunction::HenyeyGreenstein { b: -0.27 }.least();
        for (albedos, tolerance) in [(0.03..=0.12, 1e-3), (0.03..=0.12, 1e-6), (0.02..=0.6, 1e-3), (0.02..=0.95, 1e-6)]
        {
            let count = node_count(&albedos, least, tolerance);
            assert!(interpolation_error(&albedos, count, least) <= tolerance);
            assert!(interpolation_error(&albedos, count - 1, least) > tolerance);
            let nodes = AlbedoNodes::new(parameters(HFormula::Exact), &albedos, count);
            assert!(worst(&nodes, &albedos) <= tolerance);
        }
        // An albedo that does not change needs one node, which is exact.
        assert_eq!(node_count(&(0.07..=0.07), least, 1e-9), 1);
        let one = AlbedoNodes::new(parameters(HFormula::Exact), &(0.07..=0.07), 1);
        assert!(worst(&one, &(0.07..=0.07)) < 1e-14);
        assert_eq!(node_count(&(0.0..=1.0), 0.0, 1e-9), MOST_NODES);
    }
}
