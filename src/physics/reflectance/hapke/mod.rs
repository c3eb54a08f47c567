//! Hapke's model of a deep layer of particles.
//!
//! f = K w / (4 pi) mu0e / (mu0e + mue) {p(g) (1 + B_S) + H(mu0e / K) H(mue / K) - 1} (1 + B_C) S / mu0
//!
//! Source: Hapke (1981, 1984, 1986, 2002, 2008); *Theory of Reflectance and Emittance Spectroscopy* (2012). Reciprocal.
//! Only the factor w and the two H depend on the single-scattering albedo w, and so on wavelength. [`Parameters::at`] computes the rest, which
//! depends on the angles alone; [`AlbedoNodes`] turns both into weights and rows.

mod albedo_nodes;
mod h_function;
mod inverse;
mod roughness;

use std::f64::consts::PI;

pub use albedo_nodes::{AlbedoNodes, interpolation_error, node_count};
pub use h_function::{H, HFormula, HPlace};
pub use inverse::{Inverse, NoAlbedo};
pub use roughness::Roughness;

use super::{PhaseFunction, PhotometricAngles};

/// A surface at one wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct Hapke {
    albedo: f64,
    parameters: Parameters,
    h: H,
}

/// All of Hapke's parameters but w.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Phase function p(g) of the particles.
    pub phase: PhaseFunction,
    /// Opposition effect by shadow hiding, of light scattered once: B_S = B0 / (1 + tan(g / 2) / h). B0 may be above 1, as it is in fits.
    pub shadow_hiding: Surge,
    /// Opposition effect by coherent backscatter, of all light: B_C = B0 (1 + (1 - exp(-x)) / x) / (2 (1 + x)^2), x = tan(g / 2) / h.
    pub coherent: Surge,
    /// Roughness at scales that the mesh does not resolve.
    pub roughness: Roughness,
    /// K, from 1: by how much close packing brightens the layer ([`porosity_factor`]).
    pub porosity_factor: f64,
    /// Which H.
    pub h: HFormula,
}

/// A peak of brightness about phase 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surge {
    /// Height B0, from 0; 0 is not a peak.
    pub amplitude: f64,
    /// Width h: half of the height at tan(g / 2) = h, for shadows. Above 0.
    pub width: f64,
}

impl Surge {
    /// No peak.
    pub const NONE: Surge = Surge { amplitude: 0.0, width: 1.0 };

    /// B_S of shadows at tan(g / 2).
    pub fn of_shadows(&self, tan_half_phase: f64) -> f64 {
        self.amplitude / (1.0 + tan_half_phase / self.width)
    }

    /// B_C of interference at tan(g / 2). Source: Akkermans et al. (1988); Hapke (2002).
    pub fn of_interference(&self, tan_half_phase: f64) -> f64 {
        let x = tan_half_phase / self.width;
        // (1 - exp(-x)) / x, which is 1 at 0.
        let mean = if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 };
        self.amplitude * 0.5 * (1.0 + mean) / ((1.0 + x) * (1.0 + x))
    }
}

/// The part of f that depends on angles alone: f = w amplitude (single + H(x0) H(x) - 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtAngles {
    /// All factors but w: K / (4 pi), the shading, and 1 + B_C; 1/sr.
    pub amplitude: f64,
    /// p(g) (1 + B_S).
    pub single: f64,
    /// Arguments of the two H, the larger one first.
    pub x: [f64; 2],
}

impl AtAngles {
    /// f / w, 1/sr, with the H of that w.
    #[inline]
    pub fn per_albedo(&self, h: &H) -> f64 {
        self.per_albedo_at(h, &self.places(h.formula()))
    }

    /// The arguments prepared for H, which is the same work for all w.
    #[inline]
    fn places(&self, formula: HFormula) -> [HPlace; 2] {
        self.x.map(|x| formula.place(x))
    }

    #[inline]
    fn per_albedo_at(&self, h: &H, places: &[HPlace; 2]) -> f64 {
        self.amplitude * (self.single + (h.at(&places[0]) * h.at(&places[1]) - 1.0))
    }
}

impl Parameters {
    /// Isotropic particles, smooth, without opposition effects, in a thin cloud.
    pub const PLAIN: Parameters = Parameters {
        phase: PhaseFunction::Isotropic,
        shadow_hiding: Surge::NONE,
        coherent: Surge::NONE,
        roughness: Roughness::SMOOTH,
        porosity_factor: 1.0,
        h: HFormula::Exact,
    };

    /// The part of f that depends on these angles.
    pub fn at(&self, angles: &PhotometricAngles) -> AtAngles {
        let tan_half_phase = angles.tan_half_phase();
        let single = self.phase.at(angles) * (1.0 + self.shadow_hiding.of_shadows(tan_half_phase));
        let seen = self.roughness.at(angles);
        let all = 1.0 + self.coherent.of_interference(tan_half_phase);
        let k = self.porosity_factor;
        AtAngles { amplitude: k / (4.0 * PI) * seen.shading * all, single, x: seen.cosines.map(|mu| mu / k) }
    }
}

/// K of a layer with this share of its volume filled by particles: -ln(1 - 1.209 q) / (1.209 q), q = share^(2/3). Source: Hapke (2008).
///
/// Limits: shares from 0 to below 0.752, where K is infinite.
pub fn porosity_factor(filled_share: f64) -> f64 {
    let shadowed = 1.209 * filled_share.cbrt().powi(2);
    if shadowed > 0.0 { -(-shadowed).ln_1p() / shadowed } else { 1.0 }
}

impl Hapke {
    /// A surface of this single-scattering albedo w, 0 to 1.
    pub fn new(albedo: f64, parameters: Parameters) -> Self {
        Hapke { albedo, parameters, h: parameters.h.function(albedo) }
    }

    /// The BRDF, 1/sr.
    pub fn brdf(&self, angles: &PhotometricAngles) -> f64 {
        self.albedo * self.parameters.at(angles).per_albedo(&self.h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surges_have_their_height_and_width() {
        let surge = Surge { amplitude: 2.0, width: 0.05 };
        assert_eq!((surge.of_shadows(0.0), surge.of_shadows(0.05), surge.of_shadows(f64::INFINITY)), (2.0, 1.0, 0.0));
        // At x = 1: (1 + 1 - 1/e) / 8 of the height.
        assert_eq!(surge.of_interference(0.0), 2.0);
        assert!((surge.of_interference(0.05) - 2.0 * (2.0 - (-1f64).exp()) / 8.0).abs() < 1e-15);
        assert_eq!(surge.of_interference(f64::INFINITY), 0.0);
        assert_eq!(Surge::NONE.of_interference(0.0), 0.0);
    }

    #[test]
    fn closer_particles_scatter_more() {
        // Hapke (2008): K = 1 in a thin cloud; 13 % filled: q = 1.209 0.13^(2/3) = 0.310248, -ln(1 - q) / q = 1.19724.
        assert_eq!(porosity_factor(0.0), 1.0);
        assert!((porosity_factor(0.13) - 1.197).abs() < 5e-4, "{}", porosity_factor(0.13));
        assert!((porosity_factor(1e-9) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn what_soils_are_fitted_with() {
        // SOILSPECT by hand, at i 60, e 0 deg, w 0.5, B0 1, h 0.2, b 0.3, c 0.1, H of 1981:
        // R = w / 4 / (mu0 + mu) [(1 + B) P + H H - 1].
        let parameters = Parameters {
            phase: PhaseFunction::Legendre { about_source: [0.3, 0.1], about_specular: [0.0, 0.0] },
            shadow_hiding: Surge { amplitude: 1.0, width: 0.2 },
            h: HFormula::Hapke1981,
            ..Parameters::PLAIN
        };
        let b = 1.0 / (1.0 + (PI / 6.0).tan() / 0.2);
        let p = 1.0 + 0.3 * 0.5 + 0.1 * (0.75 - 1.0) / 2.0;
        let h = |x: f64| (1.0 + 2.0 * x) / (1.0 + 2.0 * x * 0.5f64.sqrt());
        let expected = 0.5 / 4.0 / 1.5 * ((1.0 + b) * p + h(0.5) * h(1.0) - 1.0);
        let got = PI * Hapke::new(0.5, parameters).brdf(&PhotometricAngles::of_angles(PI / 3.0, 0.0, 0.0));
        assert!((got / expected - 1.0).abs() < 1e-14, "{got} {expected}");
    }
}
