//! The single-scattering albedo of a surface whose reflectance is known.

use super::{AtAngles, HFormula, Parameters};
use crate::error::number;
use crate::physics::reflectance::albedo::Measure;

/// Finds w of what was measured.
#[derive(Debug, Clone)]
pub struct Inverse {
    formula: HFormula,
    /// What depends on angles alone, and its weight in what was measured.
    points: Vec<(AtAngles, f64)>,
    most: f64,
}

/// No single-scattering albedo from 0 to 1 gives this.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("no single-scattering albedo gives a reflectance of {}: with these parameters it is from 0 to {}", number(*.reflectance), number(*.most))]
pub struct NoAlbedo {
    /// What was asked for.
    pub reflectance: f64,
    /// The most there is, at w = 1.
    pub most: f64,
}

impl Inverse {
    /// Of a surface with these parameters, by this measure.
    pub fn new(parameters: &Parameters, measure: &Measure) -> Self {
        let points = measure.points().into_iter().map(|(angles, weight)| (parameters.at(&angles), weight)).collect();
        let mut inverse = Inverse { formula: parameters.h, points, most: 0.0 };
        inverse.most = inverse.reflectance(0.0);
        inverse
    }

    /// What is measured where sqrt(1 - w) is gamma.
    fn reflectance(&self, gamma: f64) -> f64 {
        let albedo = 1.0 - gamma * gamma;
        // A table of H costs as much as some hundred of its values.
        let few = self.points.len() < 100;
        let h = if few { self.formula.function_for_few(albedo) } else { self.formula.function(albedo) };
        albedo * self.points.iter().map(|(at, weight)| weight * at.per_albedo(&h)).sum::<f64>()
    }

    /// w from the reflectance that was measured.
    ///
    /// Reflectance rises with w, and is smooth in gamma = sqrt(1 - w): between black and white there is one root, kept between two ends
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
            // An end that stays twice is drawn towards the root, lest it stay for ever.
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
    use crate::physics::reflectance::hapke::{Hapke, Roughness, Surge};
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
