//! A reflectance model apart from its albedo, the one parameter that is a spectrum.

use std::ops::RangeInclusive;

use super::albedo::Measure;
use super::hapke::{AlbedoNodes, Inverse, NoAlbedo, Parameters, node_count};
use super::{
    Akimov, Brdf, Hapke, LommelSeeliger, LunarLambert, Minnaert, Partition, PhaseCurve, PhaseFunction,
    PhotometricAngles, Rpv,
};

/// A model, and all its parameters but the albedo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// [`LommelSeeliger`], by w.
    LommelSeeliger(PhaseFunction),
    /// [`LunarLambert`], by its normal albedo.
    LunarLambert(PhaseCurve, Partition),
    /// [`Minnaert`], by its normal albedo; the exponent.
    Minnaert(f64),
    /// [`Akimov`], by its normal albedo.
    Akimov(PhaseCurve),
    /// [`Hapke`], by w.
    Hapke(Parameters),
    /// [`Rpv`], by its amplitude.
    Rpv {
        /// Exponent k.
        exponent: f64,
        /// Asymmetry.
        asymmetry: f64,
        /// Of the hot spot.
        hot_spot: f64,
    },
}

impl Shape {
    /// The surface of an albedo.
    pub fn brdf(&self, albedo: f64) -> Brdf {
        match *self {
            Shape::LommelSeeliger(phase) => Brdf::LommelSeeliger(LommelSeeliger { albedo, phase }),
            Shape::LunarLambert(phase, partition) => Brdf::LunarLambert(LunarLambert { albedo, phase, partition }),
            Shape::Minnaert(exponent) => Brdf::Minnaert(Minnaert { albedo, exponent }),
            Shape::Akimov(phase) => Brdf::Akimov(Akimov { albedo, phase }),
            Shape::Hapke(parameters) => Brdf::Hapke(Box::new(Hapke::new(albedo, parameters))),
            Shape::Rpv { exponent, asymmetry, hot_spot } => {
                Brdf::Rpv(Rpv { amplitude: albedo, exponent, asymmetry, hot_spot })
            }
        }
    }

    /// The model's name, as a scene file has it.
    pub fn key(&self) -> &'static str {
        match self {
            Shape::LommelSeeliger(_) => "lommel_seeliger",
            Shape::LunarLambert(..) => "lunar_lambert",
            Shape::Minnaert(_) => "minnaert",
            Shape::Akimov(_) => "akimov",
            Shape::Hapke(_) => "hapke",
            Shape::Rpv { .. } => "rpv",
        }
    }

    /// The largest albedo there is.
    pub fn most(&self) -> f64 {
        if matches!(self, Shape::LommelSeeliger(_) | Shape::Hapke(_)) { 1.0 } else { f64::INFINITY }
    }
}

/// Products that a model's BRDF is the sum of: each of what angles give (a weight) and what the albedo gives (a row).
///
/// Models that are proportional to their albedo are one product. Minnaert's limb depends on the albedo; here it is that of the brightest.
#[derive(Debug, Clone, PartialEq)]
pub enum Separated {
    /// The surface of an albedo, to which others are proportional.
    Factor(Box<Brdf>, f64),
    /// Hapke's, by some albedos.
    Nodes(AlbedoNodes),
}

impl Separated {
    /// For albedos within this range, to a relative tolerance.
    pub fn new(shape: &Shape, albedos: &RangeInclusive<f64>, tolerance: f64) -> Self {
        if let Shape::Hapke(parameters) = shape {
            let count = node_count(albedos, parameters.phase.least(), tolerance);
            return Separated::Nodes(AlbedoNodes::new(*parameters, albedos, count));
        }
        let brightest = if *albedos.end() > 0.0 { *albedos.end() } else { 1.0 };
        Separated::Factor(Box::new(shape.brdf(brightest)), brightest)
    }

    /// How many products.
    pub fn terms(&self) -> usize {
        match self {
            Separated::Factor(..) => 1,
            Separated::Nodes(nodes) => nodes.count(),
        }
    }

    /// Each product's weight at these angles, 1/sr.
    #[inline]
    pub fn weights(&self, angles: &PhotometricAngles, mut put: impl FnMut(usize, f64)) {
        match self {
            Separated::Factor(brdf, albedo) => put(0, brdf.eval(angles) / albedo),
            Separated::Nodes(nodes) => nodes.weights(angles).enumerate().for_each(|(k, weight)| put(k, weight)),
        }
    }

    /// Each product's other factor, of an albedo within the range.
    pub fn rows(&self, albedo: f64) -> Vec<f64> {
        match self {
            Separated::Factor(..) => vec![albedo],
            Separated::Nodes(nodes) => nodes.rows(albedo).collect(),
        }
    }

    /// As the weights, of a measured reflectance. Times rows, it is that of any albedo.
    pub fn measured(&self, measure: &Measure) -> Vec<f64> {
        match self {
            Separated::Factor(brdf, albedo) => vec![measure.of(brdf) / albedo],
            Separated::Nodes(nodes) => nodes.measured(measure),
        }
    }
}

/// Finds albedos from measured reflectances.
#[derive(Debug, Clone)]
pub enum Albedos {
    /// Proportional to them: what is measured at an albedo of 1, and the largest albedo.
    Factor(f64, f64),
    /// Hapke's.
    Hapke(Box<Inverse>),
}

impl Albedos {
    /// For this kind of measurement, whose largest result is `brightest`.
    pub fn new(shape: &Shape, measure: &Measure, brightest: f64) -> Self {
        if let Shape::Hapke(parameters) = shape {
            return Albedos::Hapke(Box::new(Inverse::new(parameters, measure)));
        }
        let of_unit = |albedo: f64| measure.of(&shape.brdf(albedo)) / albedo;
        let mut unit = of_unit(1.0);
        if matches!(shape, Shape::Minnaert(_)) && brightest > 0.0 {
            // Its limb is that of the albedo that is looked for.
            for _ in 0..MOST_STEPS {
                let before = unit;
                unit = of_unit(brightest / before);
                if (unit - before).abs() <= ROUNDING * unit {
                    break;
                }
            }
        }
        Albedos::Factor(unit, shape.most())
    }

    /// The albedo of a measured reflectance.
    ///
    /// # Errors
    /// [`NoAlbedo`] if none has it.
    pub fn of(&self, reflectance: f64) -> Result<f64, NoAlbedo> {
        match self {
            Albedos::Hapke(inverse) => inverse.albedo(reflectance),
            Albedos::Factor(unit, largest) => {
                let albedo = reflectance / unit;
                let exists = albedo >= 0.0 && albedo.is_finite() && albedo <= *largest;
                if exists { Ok(albedo) } else { Err(NoAlbedo { reflectance, most: unit * largest }) }
            }
        }
    }
}

/// A few are common.
const MOST_STEPS: usize = 30;
/// Steps that are no longer change nothing.
const ROUNDING: f64 = 1e-15;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::hapke::{Roughness, Surge};

    const ANGLES: (f64, f64, f64) = (0.9, 0.5, 2.0);

    fn shapes() -> [Shape; 6] {
        let curve = PhaseCurve { beta: -1.0, gamma: 0.1, delta: 0.0 };
        let hapke = Parameters {
            phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
            shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
            roughness: Roughness::of_mean_slope(0.4),
            ..Parameters::PLAIN
        };
        [
            Shape::LommelSeeliger(PhaseFunction::HenyeyGreenstein { b: -0.2 }),
            Shape::LunarLambert(curve, Partition::Moon),
            Shape::Minnaert(0.6),
            Shape::Akimov(curve),
            Shape::Hapke(hapke),
            Shape::Rpv { exponent: 0.65, asymmetry: -0.29, hot_spot: 0.075 },
        ]
    }

    #[test]
    fn products_add_up_to_the_model() {
        let angles = PhotometricAngles::of_angles(ANGLES.0, ANGLES.1, ANGLES.2);
        for shape in shapes() {
            let separated = Separated::new(&shape, &(0.02..=0.3), 1e-9);
            assert!(separated.terms() <= 9, "{shape:?} {}", separated.terms());
            for albedo in [0.02, 0.0713, 0.3] {
                let rows = separated.rows(albedo);
                let mut sum = 0.0;
                separated.weights(&angles, |k, weight| sum += weight * rows[k]);
                let expected = shape.brdf(albedo).eval(&angles);
                assert!((sum / expected - 1.0).abs() < 1e-9, "{shape:?}: {sum} {expected}");
            }
        }
    }

    #[test]
    fn albedos_give_back_what_was_measured() {
        let angles = PhotometricAngles::of_angles(ANGLES.0, ANGLES.1, ANGLES.2);
        for shape in shapes() {
            for measure in [Measure::ReflectanceFactor(angles), Measure::Spherical] {
                let albedo = Albedos::new(&shape, &measure, 0.03).of(0.03).unwrap();
                let got = measure.of(&shape.brdf(albedo));
                assert!((got / 0.03 - 1.0).abs() < 1e-12, "{shape:?}: {got}");
            }
        }
        let bright = Albedos::new(&shapes()[0], &Measure::Spherical, 0.5).of(0.5);
        assert!(bright.unwrap_err().most < 0.5);
    }
}
