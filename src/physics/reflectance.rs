//! How a surface reflects.
//!
//! Three quantities go by the name of reflectance (Hapke, *Theory of Reflectance and Emittance Spectroscopy*, 2012, ch. 10):
//!
//! - **BRDF** f, 1/sr: L = f E with E the irradiance **on the surface**, the cosine already in it;
//! - **reflectance factor** REFF = pi f: against a perfect Lambert surface lit alike (the thesis's rho_l, equation (2));
//! - **radiance factor** RADF = I/F = pi f mu0: against a perfect Lambert surface lit at normal incidence.
//!
//! Two sources need two evaluations, each at its own angles: L = sum over sources of f(source -> view) E_source.

use std::f64::consts::PI;

/// What is reflected and let through of light is all of it within this: more makes energy.
pub const ALL_LIGHT: f64 = 1.0 + 1e-9;

/// Angles of light and view at a surface point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotometricAngles {
    /// Cosine of incidence, mu0.
    pub cos_incidence: f64,
    /// Cosine of emission, mu.
    pub cos_emission: f64,
    /// Phase angle between the directions to source and observer, rad.
    pub phase_rad: f64,
}

/// A bidirectional reflectance distribution function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Brdf {
    /// Lambert: the same radiance in every direction.
    Lambert {
        /// Reflectance factor, which here is also the hemispherical reflectance, 0 to 1.
        reflectance: f64,
    },
}

impl Brdf {
    /// The BRDF, 1/sr, without any cosine. Lambert: f = rho / pi.
    ///
    /// Limits: for cosines above 0; on the dark side irradiance is 0 and in back view nothing asks.
    pub fn eval(&self, _angles: &PhotometricAngles) -> f64 {
        match *self {
            Brdf::Lambert { reflectance } => reflectance / PI,
        }
    }
}

/// Radiance of a surface with this reflectance factor towards the viewer, in the irradiance's unit sr-1: L = REFF E / pi.
///
/// Source: Nicodemus et al. (1977). E is the irradiance that the factor was measured against, the cosine already in it.
pub fn radiance_of_reflectance_factor(reflectance_factor: f64, irradiance: f64) -> f64 {
    reflectance_factor * irradiance / PI
}

/// Radiance of a Lambert surface that sends out this exitance, in its unit sr-1: L = M / pi.
///
/// Source: Lambert's cosine law, integrated over the hemisphere.
pub fn lambert_radiance(exitance: f64) -> f64 {
    exitance / PI
}

/// Directional emissivity of an opaque surface, 1 - rho: what it does not reflect, it absorbs, and what it absorbs, it can emit.
///
/// Source: Kirchhoff's law. Limits: rho is the hemispherical reflectance for light from that direction; a Lambert surface's own.
pub fn kirchhoff_emissivity(hemispherical_reflectance: f64) -> f64 {
    1.0 - hemispherical_reflectance
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::GaussLegendre;

    const ANGLES: PhotometricAngles = PhotometricAngles { cos_incidence: 0.5, cos_emission: 0.8, phase_rad: 0.3 };

    #[test]
    fn a_lambert_surface_reflects_its_reflectance() {
        // Integral of f cos(e) over the hemisphere.
        let brdf = Brdf::Lambert { reflectance: 0.07 };
        let reflected = GaussLegendre::new(4)
            .integral(0.0, 1.0, |mu| 2.0 * PI * mu * brdf.eval(&PhotometricAngles { cos_emission: mu, ..ANGLES }));
        assert!((reflected - 0.07).abs() < 1e-16);
        assert!((reflected + kirchhoff_emissivity(0.07) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_white_lambert_surface_sends_out_what_it_gets() {
        // Its factor is 1: radiance times pi is the irradiance, which is also its exitance.
        assert_eq!(radiance_of_reflectance_factor(1.0, PI), 1.0);
        assert_eq!(radiance_of_reflectance_factor(0.5, 2.0), lambert_radiance(1.0));
        let exitance = GaussLegendre::new(4).integral(0.0, 1.0, |mu| 2.0 * PI * mu * lambert_radiance(3.0));
        assert!((exitance - 3.0).abs() < 1e-15);
    }

    #[test]
    fn radiance_of_the_flat_plane_of_the_thesis() {
        // E490 at 1 um 747.9 W m-2 um-1, 1.484252531442686 au, incidence 23.573397908631627 deg: computed independently.
        let normal = crate::physics::sun::irradiance_at(747.9, 1.484_252_531_442_686 * crate::units::AU_M);
        let irradiance =
            crate::physics::sun::irradiance_on_facet(normal, 23.573_397_908_631_627_f64.to_radians().cos());
        let radiance = Brdf::Lambert { reflectance: 0.07 }.eval(&ANGLES) * irradiance;
        assert!((radiance / 6.933_165_382_333_749 - 1.0).abs() < 1e-13);
    }
}
