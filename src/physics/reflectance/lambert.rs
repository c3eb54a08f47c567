//! Lambert's surface: the same radiance in every direction.

use std::f64::consts::PI;

/// f = rho / pi. Source: Lambert (1760). Reciprocal. Limits: none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lambert {
    /// Reflectance factor, which here is also the hemispherical reflectance, 0 to 1.
    pub reflectance: f64,
}

impl Lambert {
    /// The BRDF, 1/sr: the same at all angles.
    pub fn brdf(&self) -> f64 {
        self.reflectance / PI
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::GaussLegendre;
    use crate::physics::reflectance::kirchhoff_emissivity;

    #[test]
    fn it_reflects_its_reflectance() {
        // Integral of f cos(e) over the hemisphere.
        let f = Lambert { reflectance: 0.07 }.brdf();
        let reflected = GaussLegendre::new(4).integral(0.0, 1.0, |mu| 2.0 * PI * mu * f);
        assert!((reflected - 0.07).abs() < 1e-16);
        assert!((reflected + kirchhoff_emissivity(0.07) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn radiance_of_the_flat_plane_of_the_thesis() {
        // E490 at 1 um 747.9 W m-2 um-1, 1.484252531442686 au, incidence 23.573397908631627 deg: computed independently.
        let normal = crate::physics::sun::irradiance_at(747.9, 1.484_252_531_442_686 * crate::units::AU_M);
        let irradiance =
            crate::physics::sun::irradiance_on_facet(normal, 23.573_397_908_631_627_f64.to_radians().cos());
        let radiance = Lambert { reflectance: 0.07 }.brdf() * irradiance;
        assert!((radiance / 6.933_165_382_333_749 - 1.0).abs() < 1e-13);
    }
}
