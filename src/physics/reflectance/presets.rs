//! Surfaces of bodies: published numbers where there are, and the rest assumed, and said to be.

use super::hapke::{Parameters, Roughness, Surge};
use super::{Brdf, Hapke, Minnaert, PhaseFunction};

/// A surface with where its numbers come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preset {
    /// What it is called.
    pub name: &'static str,
    /// At which wavelength, um.
    pub wavelength_um: f64,
    /// The model and its numbers.
    pub model: PresetModel,
    /// What is published, and where.
    pub source: &'static str,
    /// What is not from there.
    pub assumed: &'static str,
}

/// The model of a preset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PresetModel {
    /// Hapke's.
    Hapke {
        /// Single-scattering albedo w at the preset's wavelength.
        albedo: f64,
        /// The rest.
        parameters: Parameters,
    },
    /// Minnaert's.
    Minnaert(Minnaert),
}

impl Preset {
    /// The surface at the preset's wavelength.
    pub fn brdf(&self) -> Brdf {
        match self.model {
            PresetModel::Hapke { albedo, parameters } => Brdf::Hapke(Box::new(Hapke::new(albedo, parameters))),
            PresetModel::Minnaert(minnaert) => Brdf::Minnaert(minnaert),
        }
    }

    /// All of them.
    pub fn all() -> [Preset; 4] {
        [phobos_assumed(), deimos_assumed(), moon(), mars()]
    }
}

fn hapke(albedo: f64, phase: PhaseFunction, shadows: [f64; 2], mean_slope_deg: f64) -> PresetModel {
    let shadow_hiding = Surge { amplitude: shadows[0], width: shadows[1] };
    let roughness = Roughness::of_mean_slope(mean_slope_deg.to_radians());
    PresetModel::Hapke { albedo, parameters: Parameters { phase, shadow_hiding, roughness, ..Parameters::PLAIN } }
}

/// Phobos in green light.
pub fn phobos_assumed() -> Preset {
    Preset {
        name: "phobos_assumed",
        wavelength_um: 0.538,
        model: hapke(0.072, PhaseFunction::HenyeyGreenstein { b: -0.2587 }, [2.28, 0.0573], 24.0),
        source: "Fornasier et al. (2024), A&A 686, A203: w 0.072, B0 2.28, h 0.0573, geometric albedo 0.068",
        assumed: "mean slope 24 deg; b -0.2587, which gives that geometric albedo with it; no coherent backscatter, K = 1",
    }
}

/// Deimos in green light.
pub fn deimos_assumed() -> Preset {
    Preset {
        name: "deimos_assumed",
        wavelength_um: 0.54,
        model: hapke(0.0715, PhaseFunction::HenyeyGreenstein { b: -0.29 }, [2.14, 0.065], 16.0),
        source: "Wargnier et al. (2025): w 0.068 to 0.075 (their middle), B0 2.14, h 0.065",
        assumed: "b -0.29 and mean slope 16 deg, as an older fit has them (Thomas et al. 1996); no coherent backscatter, K = 1",
    }
}

/// The Moon in red light.
pub fn moon() -> Preset {
    Preset {
        name: "moon",
        wavelength_um: 0.643,
        model: hapke(0.33, PhaseFunction::TwoTerms { b: 0.24, c: 0.3 }, [1.8, 0.07], 23.4),
        source: "in the style of Sato et al. (2014): typical numbers of their maps, mean slope 23.4 deg as theirs",
        assumed: "w 0.33 between their maria and highlands, b 0.24, c 0.3, B0 1.8, h 0.07; no coherent backscatter, K = 1",
    }
}

/// Mars in red light, as a source of light for its moons.
pub fn mars() -> Preset {
    Preset {
        name: "mars",
        wavelength_um: 0.7,
        model: PresetModel::Minnaert(Minnaert { albedo: 0.336, exponent: 0.7 }),
        source: "none that was at hand",
        assumed: "exponent 0.7, as is usual in red light; normal albedo 0.336, which with it gives a geometric albedo of 0.28",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::albedo::{Measure, phase_integral};

    #[test]
    fn phobos_has_its_geometric_albedo() {
        // As published; its spherical albedo 0.0227 and phase integral 0.334 were computed independently.
        let phobos = phobos_assumed().brdf();
        assert!((Measure::Geometric.of(&phobos) - 0.068).abs() < 5e-5, "{}", Measure::Geometric.of(&phobos));
        assert!((Measure::Spherical.of(&phobos) - 0.0227).abs() < 5e-5, "{}", Measure::Spherical.of(&phobos));
        assert!((phase_integral(&phobos) - 0.334).abs() < 5e-4);
    }

    #[test]
    fn mars_has_its_geometric_albedo() {
        // 2 A / (2 k + 1) of Minnaert's sphere, but for its limb.
        let p = Measure::Geometric.of(&mars().brdf());
        assert!((p - 0.28).abs() < 5e-5, "{p}");
    }

    #[test]
    fn all_are_dark_enough_and_have_names_of_their_own() {
        let all = Preset::all();
        for (i, preset) in all.iter().enumerate() {
            let bond = Measure::Spherical.of(&preset.brdf());
            assert!(bond > 0.01 && bond < 0.5, "{}: {bond}", preset.name);
            assert!(all[..i].iter().all(|other| other.name != preset.name));
        }
    }
}
