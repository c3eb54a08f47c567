//! The numbers of a model, one by one: what they are called, what they are, and others in their place.

use super::hapke::{Parameters, Roughness};
use super::{PhaseFunction, Shape};

/// A number of a model that is the same at all wavelengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// Asymmetry of the particles' phase function.
    B,
    /// Weight of its two terms.
    C,
    /// Amplitude B0 of the opposition surge by shadows.
    ShadowAmplitude,
    /// Its width h.
    ShadowWidth,
    /// Mean slope theta-bar, deg.
    MeanSlopeDeg,
    /// Minnaert's exponent.
    Exponent,
}

impl Parameter {
    /// Its key in a scene file, below the model's.
    pub fn key(self) -> &'static str {
        match self {
            Parameter::B => "b",
            Parameter::C => "c",
            Parameter::ShadowAmplitude => "shadow_hiding.amplitude",
            Parameter::ShadowWidth => "shadow_hiding.width",
            Parameter::MeanSlopeDeg => "mean_slope_deg",
            Parameter::Exponent => "exponent",
        }
    }

    /// What it is in a model; `None` if that has none.
    pub fn of(self, shape: &Shape) -> Option<f64> {
        let (Shape::LommelSeeliger(phase) | Shape::Hapke(Parameters { phase, .. })) = shape else {
            return match (self, shape) {
                (Parameter::Exponent, Shape::Minnaert(exponent)) => Some(*exponent),
                _ => None,
            };
        };
        match (self, phase, shape) {
            (Parameter::B, PhaseFunction::HenyeyGreenstein { b } | PhaseFunction::TwoTerms { b, .. }, _) => Some(*b),
            (Parameter::C, PhaseFunction::TwoTerms { c, .. }, _) => Some(*c),
            (Parameter::ShadowAmplitude, _, Shape::Hapke(of)) => Some(of.shadow_hiding.amplitude),
            (Parameter::ShadowWidth, _, Shape::Hapke(of)) => Some(of.shadow_hiding.width),
            (Parameter::MeanSlopeDeg, _, Shape::Hapke(of)) => Some(of.roughness.mean_slope_rad().to_degrees()),
            _ => None,
        }
    }

    /// The model with another number in its place; itself if it has none.
    #[must_use]
    pub fn replaced(self, mut shape: Shape, value: f64) -> Shape {
        match (self, &mut shape) {
            (Parameter::Exponent, Shape::Minnaert(exponent)) => *exponent = value,
            (Parameter::ShadowAmplitude, Shape::Hapke(of)) => of.shadow_hiding.amplitude = value,
            (Parameter::ShadowWidth, Shape::Hapke(of)) => of.shadow_hiding.width = value,
            (Parameter::MeanSlopeDeg, Shape::Hapke(of)) => of.roughness = Roughness::of_mean_slope(value.to_radians()),
            (_, Shape::LommelSeeliger(phase) | Shape::Hapke(Parameters { phase, .. })) => match (self, phase) {
                (Parameter::B, PhaseFunction::HenyeyGreenstein { b } | PhaseFunction::TwoTerms { b, .. }) => *b = value,
                (Parameter::C, PhaseFunction::TwoTerms { c, .. }) => *c = value,
                _ => {}
            },
            _ => {}
        }
        shape
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::hapke::Surge;

    #[test]
    fn numbers_are_replaced_one_by_one() {
        let moon = Shape::Hapke(Parameters {
            phase: PhaseFunction::TwoTerms { b: 0.24, c: 0.3 },
            shadow_hiding: Surge { amplitude: 1.8, width: 0.07 },
            ..Parameters::PLAIN
        });
        let all = [
            (Parameter::B, 0.2),
            (Parameter::C, 0.1),
            (Parameter::ShadowAmplitude, 2.0),
            (Parameter::ShadowWidth, 0.05),
            (Parameter::MeanSlopeDeg, 20.0),
        ];
        let replaced = all.into_iter().fold(moon, |shape, (parameter, value)| parameter.replaced(shape, value));
        for (parameter, value) in all {
            assert!((parameter.of(&replaced).unwrap() - value).abs() < 1e-12, "{parameter:?}");
            assert_ne!(parameter.of(&moon), Some(value));
        }
        // What a model has not is not put into it.
        assert_eq!(Parameter::Exponent.of(&moon), None);
        assert_eq!(Parameter::Exponent.replaced(moon, 0.5), moon);
        assert_eq!(Parameter::B.replaced(Shape::Minnaert(0.7), 0.5), Shape::Minnaert(0.7));
        assert_eq!(Parameter::Exponent.replaced(Shape::Minnaert(0.7), 0.5), Shape::Minnaert(0.5));
        let isotropic = Shape::LommelSeeliger(PhaseFunction::Isotropic);
        assert_eq!((Parameter::B.of(&isotropic), Parameter::B.replaced(isotropic, 0.1)), (None, isotropic));
    }
}
