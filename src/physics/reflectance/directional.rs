//! Directional-hemispherical albedos at any angle, from a table.

use std::f64::consts::PI;

use super::Separated;
use super::albedo::Measure;

/// Directional-hemispherical albedo A of each product of a separated model, by the cosine of incidence; by reciprocity also by that of
/// emission, so that an emissivity is 1 - A.
///
/// Interpolated in the root of the cosine between Chebyshev's points. Limits: cosines below [`FLATTEST`] count as that; relative error 1e-4
/// (tested), which is that of the quadrature's kinks for rough surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectionalAlbedos {
    /// Root of each cosine, and its barycentric weight.
    points: Vec<(f64, f64)>,
    /// [point, product].
    values: Vec<f64>,
}

/// The flattest light that has an albedo of its own, 88.9 deg: some models would reflect more than arrives where it is flatter.
pub const FLATTEST: f64 = 0.02;

const POINTS: usize = 20;

impl DirectionalAlbedos {
    /// Of a model.
    pub fn new(model: &Separated) -> Self {
        let low = FLATTEST.sqrt();
        let point = |k: usize| {
            let angle = PI * (k as f64 + 0.5) / POINTS as f64;
            let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            (0.5 * (1.0 + low) + 0.5 * (1.0 - low) * angle.cos(), sign * angle.sin())
        };
        let points: Vec<(f64, f64)> = (0..POINTS).map(point).collect();
        let of =
            |(root, _): &(f64, f64)| model.measured(&Measure::DirectionalHemispherical { cos_incidence: root * root });
        let values = points.iter().flat_map(of).collect();
        DirectionalAlbedos { points, values }
    }

    /// Each product's weight at a cosine of incidence: times rows, it is the albedo.
    pub fn weights(&self, cosine: f64, mut put: impl FnMut(usize, f64)) {
        let root = cosine.clamp(FLATTEST, 1.0).sqrt();
        let terms = self.values.len() / POINTS;
        let at = |k: usize| &self.values[k * terms..(k + 1) * terms];
        if let Some(k) = self.points.iter().position(|(x, _)| *x == root) {
            return at(k).iter().enumerate().for_each(|(term, value)| put(term, *value));
        }
        // In place: this is asked for each fragment, and each facet.
        let mut shares = [0.0; POINTS];
        shares.iter_mut().zip(&self.points).for_each(|(share, (x, weight))| *share = weight / (root - x));
        let total: f64 = shares.iter().sum();
        for term in 0..terms {
            let sum: f64 = shares.iter().enumerate().map(|(k, share)| share * at(k)[term]).sum();
            put(term, sum / total);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::hapke::{Parameters, Roughness, Surge};
    use crate::physics::reflectance::{PhaseCurve, PhaseFunction, Shape};

    #[test]
    fn albedos_between_points() {
        let hapke = Parameters {
            phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
            shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
            roughness: Roughness::of_mean_slope(24f64.to_radians()),
            ..Parameters::PLAIN
        };
        for (shape, tolerance) in [
            (Shape::LommelSeeliger(PhaseFunction::Isotropic), 1e-7),
            (Shape::Minnaert(0.6), 1e-4),
            (Shape::Akimov(PhaseCurve::FLAT), 1e-4),
            (Shape::Hapke(Parameters { roughness: Roughness::SMOOTH, ..hapke }), 1e-5),
            (Shape::Hapke(hapke), 1e-4),
            (Shape::Rpv { exponent: 0.65, asymmetry: -0.29, hot_spot: 0.075 }, 1e-4),
        ] {
            let separated = Separated::new(&shape, &(0.05..=0.1), 1e-6);
            let table = DirectionalAlbedos::new(&separated);
            let rows = separated.rows(0.07);
            for cos_incidence in [0.02, 0.05, 0.123, 0.31, 0.5, 0.77, 1.0] {
                let mut got = 0.0;
                table.weights(cos_incidence, |term, weight| got += weight * rows[term]);
                let expected = Measure::DirectionalHemispherical { cos_incidence }.of(&shape.brdf(0.07));
                assert!((got / expected - 1.0).abs() < tolerance, "{shape:?} {cos_incidence}: {got} {expected}");
            }
        }
    }

    #[test]
    fn the_closed_form_of_lommel_and_seeliger() {
        // (w / 2) (1 - mu0 ln(1 + 1 / mu0)).
        let separated = Separated::new(&Shape::LommelSeeliger(PhaseFunction::Isotropic), &(0.1..=0.1), 1e-6);
        let table = DirectionalAlbedos::new(&separated);
        for mu0 in [0.02, 0.3, 0.9] {
            let expected = 0.05 * (1.0 - mu0 * f64::ln_1p(1.0 / mu0));
            table.weights(mu0, |_, weight| assert!((0.1 * weight / expected - 1.0).abs() < 1e-6, "{mu0}"));
        }
    }
}
