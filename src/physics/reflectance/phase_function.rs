//! How single particles scatter, by the phase angle.

use super::PhotometricAngles;

/// Single-particle phase function p(g), dimensionless, with a mean of 1 over all directions; g the phase angle, 0 for light sent back.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum PhaseFunction {
    /// p = 1.
    #[default]
    Isotropic,
    /// One term of Henyey & Greenstein (1941), with the sign of Hapke: p = (1 - b^2) / (1 + 2 b cos g + b^2)^(3/2).
    HenyeyGreenstein {
        /// Asymmetry, within -1 and 1; below 0 scatters back.
        b: f64,
    },
    /// Two terms (McGuire & Hapke 1995): (1 + c) / 2 (1 - b^2) / (1 - 2 b cos g + b^2)^(3/2) + the same of -b times (1 - c) / 2.
    TwoTerms {
        /// Width of both lobes, from 0 to below 1.
        b: f64,
        /// Which of them is the stronger: above 0 scatters back.
        c: f64,
    },
    /// Legendre polynomials about the direction to the source, and about that of a mirror, g' (Jacquemoud, Baret & Hanocq 1992):
    /// p = 1 + b1 cos g + b2 (3 cos^2 g - 1) / 2 + c1 cos g' + c2 (3 cos^2 g' - 1) / 2. Limits: may be negative.
    Legendre {
        /// First and second coefficient about the source.
        about_source: [f64; 2],
        /// First and second coefficient about the specular direction.
        about_specular: [f64; 2],
    },
}

impl PhaseFunction {
    /// p at these angles. Reciprocal, as g and g' are.
    #[inline]
    pub fn at(&self, angles: &PhotometricAngles) -> f64 {
        match *self {
            PhaseFunction::Isotropic => 1.0,
            PhaseFunction::HenyeyGreenstein { b } => henyey_greenstein(-b, angles.cos_phase()),
            PhaseFunction::TwoTerms { b, c } => {
                let cos_g = angles.cos_phase();
                0.5 * ((1.0 + c) * henyey_greenstein(b, cos_g) + (1.0 - c) * henyey_greenstein(-b, cos_g))
            }
            PhaseFunction::Legendre { about_source, about_specular } => {
                let cos_g = angles.cos_phase();
                // The mirror's direction is the light's, turned by pi about the normal.
                let cos_mirror = 2.0 * angles.cos_incidence() * angles.cos_emission() - cos_g;
                let terms = |[first, second]: [f64; 2], cos: f64| first * cos + second * (1.5 * cos * cos - 0.5);
                1.0 + terms(about_source, cos_g) + terms(about_specular, cos_mirror)
            }
        }
    }

    /// A lower bound of p over all angles.
    pub fn least(&self) -> f64 {
        match *self {
            PhaseFunction::Isotropic => 1.0,
            PhaseFunction::HenyeyGreenstein { b } => henyey_greenstein(b.abs(), -1.0),
            PhaseFunction::TwoTerms { b, c } => {
                let (low, high) = (henyey_greenstein(b.abs(), -1.0), henyey_greenstein(b.abs(), 1.0));
                let least_of = |share: f64| 0.5 * share * if share < 0.0 { high } else { low };
                least_of(1.0 + c) + least_of(1.0 - c)
            }
            PhaseFunction::Legendre { about_source, about_specular } => {
                let least_of = |[first, second]: [f64; 2]| {
                    let at = |cos: f64| first * cos + second * (1.5 * cos * cos - 0.5);
                    let inner =
                        if second > 0.0 { at((-first / (3.0 * second)).clamp(-1.0, 1.0)) } else { f64::INFINITY };
                    at(-1.0).min(at(1.0)).min(inner)
                };
                1.0 + least_of(about_source) + least_of(about_specular)
            }
        }
    }
}

/// One lobe about the direction to the source if `b` is above 0.
#[inline]
fn henyey_greenstein(b: f64, cos_phase: f64) -> f64 {
    let d = (1.0 - b) * (1.0 - b) + 2.0 * b * (1.0 - cos_phase);
    (1.0 - b * b) / (d * d.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::GaussLegendre;
    use std::f64::consts::PI;

    const ALL: [PhaseFunction; 6] = [
        PhaseFunction::Isotropic,
        PhaseFunction::HenyeyGreenstein { b: -0.25 },
        PhaseFunction::HenyeyGreenstein { b: 0.4 },
        PhaseFunction::TwoTerms { b: 0.24, c: 0.3 },
        PhaseFunction::TwoTerms { b: 0.3, c: 1.4 },
        PhaseFunction::Legendre { about_source: [0.3, 0.2], about_specular: [0.0, 0.0] },
    ];

    fn at_phase(p: &PhaseFunction, phase_rad: f64) -> f64 {
        p.at(&PhotometricAngles::of_angles(0.5 * phase_rad, 0.5 * phase_rad, PI))
    }

    #[test]
    fn the_mean_over_all_directions_is_1() {
        for p in ALL {
            let mean = GaussLegendre::new(64).integral(0.0, PI, |g| 0.5 * at_phase(&p, g) * g.sin());
            assert!((mean - 1.0).abs() < 1e-13, "{p:?}: {mean}");
        }
    }

    #[test]
    fn values_by_hand() {
        // b = -0.25 at phase 0: 0.9375 / 0.75^3 = 20/9; at 180 deg 0.9375 / 1.25^3 = 0.48.
        let back = PhaseFunction::HenyeyGreenstein { b: -0.25 };
        assert!((at_phase(&back, 0.0) - 20.0 / 9.0).abs() < 1e-15);
        assert!((at_phase(&back, PI) - 0.48).abs() < 1e-15);
        // All of it in the lobe that goes back is one term.
        let two = PhaseFunction::TwoTerms { b: 0.25, c: 1.0 };
        assert!((at_phase(&two, 0.7) / at_phase(&back, 0.7) - 1.0).abs() < 1e-15);
        // The specular direction of light at 30 deg, seen at 30 deg from the other side: g = 60 deg, g' = 0.
        let mirror = PhaseFunction::Legendre { about_source: [0.2, 0.4], about_specular: [0.3, 0.5] };
        let angles = PhotometricAngles::of_angles(PI / 6.0, PI / 6.0, PI);
        assert!((mirror.at(&angles) - (1.0 + 0.1 - 0.05 + 0.3 + 0.5)).abs() < 1e-15);
    }

    #[test]
    fn nothing_is_below_the_least() {
        for p in ALL {
            let least = (0..=1000).map(|k| at_phase(&p, PI * f64::from(k) / 1000.0)).fold(f64::INFINITY, f64::min);
            assert!(least >= p.least() - 1e-12, "{p:?}: {least} {}", p.least());
        }
        assert!((PhaseFunction::HenyeyGreenstein { b: -0.25 }.least() - 0.48).abs() < 1e-15);
    }
}
