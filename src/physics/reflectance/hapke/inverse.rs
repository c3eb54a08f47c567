//! The single-scattering albedo of a surface whose reflectance is known.

use super::{AlbedoNodes, Parameters};
use crate::error::number;
use crate::physics::reflectance::albedo::Measure;

/// Finds w from a measured reflectance, at any number of wavelengths.
#[derive(Debug, Clone)]
pub struct Inverse {
    nodes: AlbedoNodes,
    /// What is measured at each node, over its w.
    measured: Vec<f64>,
    most: f64,
}

/// For w from 0 to 1 they interpolate the model to 1e-14.
const NODES: usize = 28;

/// No albedo that a model may have gives this.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("no albedo gives a reflectance of {}: with these parameters it is from 0 to {}", number(*.reflectance), number(*.most))]
pub struct NoAlbedo {
    /// What was asked for.
    pub reflectance: f64,
    /// The most there is.
    pub most: f64,
}

impl Inverse {
    /// For a surface with these parameters, and this kind of measurement.
    pub fn new(parameters: &Parameters, measure: &Measure) -> Self {
        let nodes = AlbedoNodes::new(*parameters, &(0.0..=1.0), NODES);
        let measured = nodes.measured(measure);
        let mut inverse = Inverse { nodes, measured, most: 0.0 };
        inverse.most = inverse.reflectance(0.0);
        inverse
    }

    /// What is measured where sqrt(1 - w) is gamma.
    fn reflectance(&self, gamma: f64) -> f64 {
        self.nodes.rows(1.0 - gamma * gamma).zip(&self.measured).map(|(row, of_node)| row * of_node).sum()
    }

    /// w from the reflectance that was measured.
    ///
    /// Reflectance rises with w and is smooth in gamma = sqrt(1 - w), so there is one root between black and white; it stays bracketed
    /// (Illinois method, Dowell & Jarratt 1971).
    ///
    /// # Errors
    /// [`NoAlbedo`] if it is negative, no number, or above that of w = 1.
    pub fn albedo(&self, reflectance: f64) -> Result<f64, NoAlbedo> {
        if !(0.0..=self.most).contains(&reflectance) {
            return Err(NoAlbedo { reflectance, most: self.most });
        }
        if reflectance == 0.0 {
            return Ok(0.0);
        }
        // Each end: gamma, and the reflectance there less the one asked for.
        let (mut dark, mut bright) = ((1.0, -reflectance), (0.0, self.most - reflectance));
        let (mut gamma, mut was_dark) = (f64::NAN, None);
        for _ in 0..MOST_STEPS {
            let before = gamma;
            gamma = (dark.0 * bright.1 - bright.0 * dark.1) / (bright.1 - dark.1);
            let miss = self.reflectance(gamma) - reflectance;
            if miss == 0.0 || (gamma - before).abs() <= ROUNDING {
                break;
            }
            let is_dark = miss < 0.0;
            let (moved, kept) = if is_dark { (&mut dark, &mut bright) } else { (&mut bright, &mut dark) };
            *moved = (gamma, miss);
            // An end that stays in place twice has its value halved, or the steps would shrink towards it slowly.
            if was_dark == Some(is_dark) {
                kept.1 *= 0.5;
            }
            was_dark = Some(is_dark);
        }
        Ok(1.0 - gamma * gamma)
    }
}

/// Ten are common; the rest is for rounding that never settles.
const MOST_STEPS: usize = 60;
/// Steps of gamma no longer than this move nothing that was measured.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::hapke::{HFormula, Hapke, Roughness, Surge};
    use crate::physics::reflectance::{Brdf, PhaseFunction, PhotometricAngles};

    fn phobos(h: HFormula) -> Parameters {
        Parameters {
            phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
            shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
            roughness: Roughness::of_mean_slope(24f64.to_radians()),
            h,
            ..Parameters::PLAIN
        }
    }

    #[test]
    fn a_known_albedo_is_found_again() {
        let angles = PhotometricAngles::of_angles(0.5, 0.3, 1.0);
        for measure in [
            Measure::ReflectanceFactor(PhotometricAngles::ZENITH),
            Measure::ReflectanceFactor(angles),
            Measure::DirectionalHemispherical { cos_incidence: 0.6 },
            Measure::Geometric,
        ] {
            for h in [HFormula::Exact, HFormula::Hapke2002] {
                let inverse = Inverse::new(&phobos(h), &measure);
                for w in [0.0, 1e-6, 0.072, 0.5, 0.97, 1.0] {
                    let measured = measure.of(&Brdf::Hapke(Box::new(Hapke::new(w, phobos(h)))));
                    let found = inverse.albedo(measured).unwrap_or(1.0);
                    assert!((found - w).abs() < 1e-9, "{measure:?} {h:?} {w}: {found}");
                }
            }
        }
    }

    #[test]
    fn phobos_by_its_reflectance() {
        // REFF = pi f at incidence 30 deg, emission 0 with w = 0.072, computed independently with the H of 2002.
        let angles = PhotometricAngles::of_angles(std::f64::consts::FRAC_PI_6, 0.0, 0.0);
        let inverse = Inverse::new(&phobos(HFormula::Hapke2002), &Measure::ReflectanceFactor(angles));
        let w = inverse.albedo(std::f64::consts::PI * 0.008_221_149_356_839_853).unwrap();
        assert!((w - 0.072).abs() < 1e-13, "{w}");
    }

    #[test]
    fn what_no_albedo_gives() {
        let inverse = Inverse::new(&Parameters::PLAIN, &Measure::DirectionalHemispherical { cos_incidence: 0.6 });
        for reflectance in [-0.1, 1.01, f64::NAN] {
            let error = inverse.albedo(reflectance).unwrap_err();
            assert!((error.most - 1.0).abs() < 1e-8, "{error}");
            assert!(error.to_string().contains("from 0 to "), "{error}");
        }
        assert_eq!(inverse.albedo(0.0), Ok(0.0));
    }
}
