//! Surfaces by name: published numbers where there are, and the rest assumed, and said to be; what the uncertain ones are worth.

use super::albedo::Measure;
use super::hapke::{Parameters, Roughness, Surge};
use super::{Albedos, Brdf, Lambert, Parameter, PhaseFunction, PhotometricAngles, Shape};

/// A surface with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// Phobos.
    PhobosAssumed,
    /// Deimos.
    DeimosAssumed,
    /// The Moon.
    Moon,
    /// Mars, as a source of light for its moons.
    Mars,
    /// Phobos as Domagala (2020) has it: Lambert's surface.
    Thesis,
}

/// What is known of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// At which wavelength, um; `None` if it is for all.
    pub wavelength_um: Option<f64>,
    /// The model and its numbers; `None`: Lambert's.
    pub shape: Option<Shape>,
    /// Its albedo there: single-scattering, normal, or Lambert's reflectance.
    pub albedo: KnownNumber,
    /// Each number of the model, and how far it may be off.
    pub numbers: Vec<(Parameter, KnownNumber)>,
    /// What else is taken for granted.
    pub assumed: &'static str,
}

/// A number, and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownNumber {
    /// The number.
    pub value: f64,
    /// One standard deviation; 0 where none is known.
    pub sigma: f64,
    /// Whether it was published for this surface; if not, it is assumed.
    pub is_published: bool,
    /// Where, or why.
    pub source: &'static str,
    /// The wavelengths, um, within which this does not count; the number is as uncertain as this outside them only.
    pub certain_um: Option<[f64; 2]>,
}

const fn published(value: f64, sigma: f64, source: &'static str) -> KnownNumber {
    KnownNumber { value, sigma, is_published: true, source, certain_um: None }
}

const fn assumed(value: f64, sigma: f64, source: &'static str) -> KnownNumber {
    KnownNumber { value, sigma, is_published: false, source, certain_um: None }
}

impl Preset {
    /// All of them.
    pub const ALL: [Preset; 5] =
        [Preset::PhobosAssumed, Preset::DeimosAssumed, Preset::Moon, Preset::Mars, Preset::Thesis];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Preset::PhobosAssumed => "phobos_assumed",
            Preset::DeimosAssumed => "deimos_assumed",
            Preset::Moon => "moon",
            Preset::Mars => "mars",
            Preset::Thesis => "thesis",
        }
    }

    /// The one of a name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// What is known of it.
    pub fn known(self) -> Known {
        match self {
            Preset::PhobosAssumed => phobos(),
            Preset::DeimosAssumed => deimos(),
            Preset::Moon => moon(),
            Preset::Mars => mars(),
            Preset::Thesis => Known {
                wavelength_um: None,
                shape: None,
                albedo: published(0.07, 0.0, "Domagala (2020), of all of Phobos"),
                numbers: vec![],
                assumed: "Lambert's surface, the same at all wavelengths",
            },
        }
    }

    /// The surface, with the albedo at its wavelength.
    pub fn brdf(self) -> Brdf {
        let Known { shape, albedo, .. } = self.known();
        let lambert = || Brdf::Lambert(Lambert { reflectance: albedo.value });
        shape.map_or_else(lambert, |shape| shape.brdf(albedo.value))
    }

    /// What each uncertain number of this surface is worth in what is measured of a model with this albedo: the relative change if it is one standard
    /// deviation off, the larger of both ways. Numbers that the model has otherwise do not count.
    ///
    /// Meanwhile the normal reflectance stays: it is what is published of small bodies, and what their spectra are scaled to.
    pub fn worth(self, shape: &Shape, albedo: f64, um: f64, measure: &Measure) -> Vec<(Parameter, KnownNumber, f64)> {
        let normal = Measure::ReflectanceFactor(PhotometricAngles::ZENITH);
        let brdf = shape.brdf(albedo);
        let (kept, before) = (normal.of(&brdf), measure.of(&brdf));
        let change = |parameter: Parameter, value: f64| {
            let other = parameter.replaced(*shape, value);
            let albedo = Albedos::new(&other, &normal, kept).of(kept).unwrap_or(other.most());
            (measure.of(&other.brdf(albedo)) / before - 1.0).abs()
        };
        let counts = |(parameter, known): &(Parameter, KnownNumber)| {
            let is_outside = known.certain_um.is_none_or(|[low, high]| !(low..=high).contains(&um));
            known.sigma > 0.0 && is_outside && parameter.of(shape).is_some_and(|value| known.is(value))
        };
        let worth = |(parameter, known): (Parameter, KnownNumber)| {
            let both = [known.value - known.sigma, known.value + known.sigma].map(|value| change(parameter, value));
            (parameter, known, both[0].max(both[1]))
        };
        self.known().numbers.into_iter().filter(counts).map(worth).collect()
    }
}

impl KnownNumber {
    /// Whether a model's number is this one, but for a conversion of units.
    pub fn is(&self, value: f64) -> bool {
        (value - self.value).abs() <= SAME * self.value.abs()
    }
}

/// Numbers that differ by no more, relatively, are the same.
const SAME: f64 = 1e-12;

fn hapke(phase: PhaseFunction, shadow_hiding: Surge, mean_slope_deg: f64) -> Option<Shape> {
    let roughness = Roughness::of_mean_slope(mean_slope_deg.to_radians());
    Some(Shape::Hapke(Parameters { phase, shadow_hiding, roughness, ..Parameters::PLAIN }))
}

const REST: &str = "no coherent backscatter, porosity factor 1, Chandrasekhar's H";

/// In green light, after Fornasier et al. (2024).
fn phobos() -> Known {
    const SOURCE: &str = "Fornasier et al. (2024), A&A 686, A203, HRSC green filter";
    let b = assumed(-0.2587, 0.03, "gives their geometric albedo of 0.068; Deimos has -0.29 in Thomas et al. (1996)");
    Known {
        wavelength_um: Some(0.538),
        shape: hapke(PhaseFunction::HenyeyGreenstein { b: b.value }, Surge { amplitude: 2.28, width: 0.0573 }, 24.0),
        albedo: published(0.072, 0.0, SOURCE),
        numbers: vec![
            (Parameter::ShadowAmplitude, published(2.28, 0.03, SOURCE)),
            (Parameter::ShadowWidth, published(0.0573, 0.0001, SOURCE)),
            (Parameter::B, b),
            (
                Parameter::MeanSlopeDeg,
                assumed(
                    24.0,
                    5.0,
                    "older fits have 22 (Simonelli et al. 1998) and, of Deimos, 16 (Thomas et al. 1996)",
                ),
            ),
            (
                Parameter::B,
                KnownNumber {
                    certain_um: Some([0.4, 1.0]),
                    ..assumed(b.value, 0.06, "the phase curve in the infrared is taken to be that in green light")
                },
            ),
        ],
        assumed: REST,
    }
}

/// In green light, after Wargnier et al. (2025).
fn deimos() -> Known {
    const SOURCE: &str = "Wargnier et al. (2025)";
    let b = assumed(-0.29, 0.03, "Thomas et al. (1996)");
    Known {
        wavelength_um: Some(0.54),
        shape: hapke(PhaseFunction::HenyeyGreenstein { b: b.value }, Surge { amplitude: 2.14, width: 0.065 }, 16.0),
        albedo: published(0.0715, 0.0035, "Wargnier et al. (2025): 0.068 to 0.075"),
        numbers: vec![
            (Parameter::ShadowAmplitude, published(2.14, 0.14, SOURCE)),
            (Parameter::ShadowWidth, published(0.065, 0.004, SOURCE)),
            (Parameter::B, b),
            (Parameter::MeanSlopeDeg, assumed(16.0, 5.0, "Thomas et al. (1996)")),
            (
                Parameter::B,
                KnownNumber {
                    certain_um: Some([0.4, 1.0]),
                    ..assumed(b.value, 0.06, "the phase curve in the infrared is taken to be that in green light")
                },
            ),
        ],
        assumed: REST,
    }
}

/// In red light, in the style of Sato et al. (2014).
fn moon() -> Known {
    const SOURCE: &str = "typical of the maps of Sato et al. (2014), between maria and highlands";
    Known {
        wavelength_um: Some(0.643),
        shape: hapke(PhaseFunction::TwoTerms { b: 0.24, c: 0.3 }, Surge { amplitude: 1.8, width: 0.07 }, 23.4),
        albedo: assumed(0.33, 0.05, SOURCE),
        numbers: vec![
            (Parameter::ShadowAmplitude, assumed(1.8, 0.2, SOURCE)),
            (Parameter::ShadowWidth, assumed(0.07, 0.01, SOURCE)),
            (Parameter::B, assumed(0.24, 0.03, SOURCE)),
            (Parameter::C, assumed(0.3, 0.2, SOURCE)),
            (Parameter::MeanSlopeDeg, published(23.4, 0.0, "Sato et al. (2014), the same everywhere")),
        ],
        assumed: REST,
    }
}

/// In red light.
fn mars() -> Known {
    Known {
        wavelength_um: Some(0.7),
        shape: Some(Shape::Minnaert(0.7)),
        albedo: assumed(0.336, 0.08, "with that exponent gives a geometric albedo of 0.28"),
        numbers: vec![(Parameter::Exponent, assumed(0.7, 0.05, "usual in red and near infrared light"))],
        assumed: "no surge, no atmosphere",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::albedo::phase_integral;

    #[test]
    fn phobos_has_its_geometric_albedo() {
        // As published; its spherical albedo 0.0227 and phase integral 0.334 were computed independently.
        let phobos = Preset::PhobosAssumed.brdf();
        assert!((Measure::Geometric.of(&phobos) - 0.068).abs() < 5e-5, "{}", Measure::Geometric.of(&phobos));
        assert!((Measure::Spherical.of(&phobos) - 0.0227).abs() < 5e-5, "{}", Measure::Spherical.of(&phobos));
        assert!((phase_integral(&phobos) - 0.334).abs() < 5e-4);
    }

    #[test]
    fn mars_has_its_geometric_albedo() {
        // 2 A / (2 k + 1) of Minnaert's sphere, but for its limb.
        let p = Measure::Geometric.of(&Preset::Mars.brdf());
        assert!((p - 0.28).abs() < 5e-5, "{p}");
    }

    #[test]
    fn all_are_dark_enough_and_their_numbers_are_those_of_their_models() {
        for preset in Preset::ALL {
            let bond = Measure::Spherical.of(&preset.brdf());
            assert!(bond > 0.01 && bond < 0.5, "{preset:?}: {bond}");
            assert_eq!(Preset::of_name(preset.name()), Some(preset));
            let known = preset.known();
            for (parameter, number) in known.numbers {
                let of_model = parameter.of(&known.shape.unwrap()).unwrap();
                assert!(number.is(of_model), "{preset:?} {parameter:?}: {of_model}");
            }
        }
        assert_eq!(Preset::of_name("pluto"), None);
    }

    #[test]
    fn what_an_asymmetry_is_worth() {
        // Nearly all is scattered once: f / f(0) is p(g) / p(0) times what does not depend on b.
        let p = |b: f64, deg: f64| (1.0 - b * b) / (1.0 + 2.0 * b * f64::to_radians(deg).cos() + b * b).powf(1.5);
        let known = Preset::PhobosAssumed.known();
        let at = |um: f64| {
            let angles = PhotometricAngles::of_angles(30f64.to_radians(), 0.0, 0.0);
            let measure = Measure::ReflectanceFactor(angles);
            let all = Preset::PhobosAssumed.worth(&known.shape.unwrap(), 0.072, um, &measure);
            all.into_iter().filter(|(parameter, ..)| *parameter == Parameter::B).collect::<Vec<_>>()
        };
        let change = |b: f64| (p(b, 30.0) / p(b, 0.0) / (p(-0.2587, 30.0) / p(-0.2587, 0.0)) - 1.0).abs();
        let green = at(0.538);
        assert_eq!((green.len(), at(2.0).len()), (1, 2));
        assert!((green[0].2 / change(-0.2887).max(change(-0.2287)) - 1.0).abs() < 0.05, "{}", green[0].2);
        // Another number in its place is not the preset's to doubt.
        let other = Parameter::B.replaced(known.shape.unwrap(), -0.1);
        let all = Preset::PhobosAssumed.worth(&other, 0.072, 2.0, &Measure::Geometric);
        assert!(all.len() == 3 && all.iter().all(|(parameter, ..)| *parameter != Parameter::B));
    }
}
