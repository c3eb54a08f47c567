//! Albedos and emissivity of any reflectance model, by quadrature over directions.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{Brdf, PhotometricAngles, kirchhoff_emissivity};
use crate::physics::GaussLegendre;

/// One number that is measured of a surface's reflectance: a weighted sum of its BRDF over angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// REFF = pi f at these angles. The normal albedo at [`PhotometricAngles::ZENITH`].
    ReflectanceFactor(PhotometricAngles),
    /// Directional-hemispherical albedo: int f mu dOmega over all emission, of light at this cosine of incidence.
    DirectionalHemispherical {
        /// Cosine of incidence.
        cos_incidence: f64,
    },
    /// Spherical (Bond's, at one wavelength) albedo of a sphere, and bihemispherical of a plane: 2 int A(mu0) mu0 dmu0.
    Spherical,
    /// Geometric albedo of a sphere: brightness at phase 0 over that of a white Lambert disc, 2 pi int f mu^2 dmu.
    Geometric,
    /// The same at another phase angle, which is the geometric albedo times the sphere's phase function: int f mu0 mu dOmega over the part of the
    /// sphere that is lit and visible.
    SphereAtPhase {
        /// Phase angle, rad, 0 to below pi.
        phase_rad: f64,
    },
}

impl Measure {
    /// The angles and the weights of f there, sr.
    ///
    /// Gauss-Legendre nodes, crowded about the direction of the light, where surges peak and rough surfaces have a kink. Relative errors, by
    /// comparison with three times as many nodes: 2e-9 for Hapke's model, with surges as narrow as 0.005; 1e-5 for models with powers of
    /// cosines, which are steep at the horizon (Akimov's, Minnaert's, RPV).
    pub fn points(&self) -> Vec<(PhotometricAngles, f64)> {
        let rule = GaussLegendre::new(POINTS);
        match *self {
            Measure::ReflectanceFactor(angles) => vec![(angles, PI)],
            Measure::DirectionalHemispherical { cos_incidence } => {
                hemisphere(&rule, cos_incidence.clamp(-1.0, 1.0).acos())
            }
            Measure::Spherical => squares(&rule, 0.0, 1.0)
                .flat_map(|(mu0, weight)| {
                    let of_incidence = hemisphere(&rule, mu0.acos());
                    of_incidence.into_iter().map(move |(angles, of_view)| (angles, 2.0 * mu0 * weight * of_view))
                })
                .collect(),
            Measure::Geometric => {
                let at = |(mu, weight): (f64, f64)| {
                    let angle = mu.acos();
                    (PhotometricAngles::of_angles(angle, angle, 0.0), 2.0 * PI * mu * mu * weight)
                };
                squares(&rule, 0.0, 1.0).map(at).collect()
            }
            Measure::SphereAtPhase { phase_rad } => sphere(&rule, phase_rad),
        }
    }

    /// Of a surface.
    pub fn of(&self, brdf: &Brdf) -> f64 {
        self.points().iter().map(|(angles, weight)| weight * brdf.eval(angles)).sum()
    }
}

/// Phase integral q of a sphere: its spherical albedo over its geometric albedo.
pub fn phase_integral(brdf: &Brdf) -> f64 {
    Measure::Spherical.of(brdf) / Measure::Geometric.of(brdf)
}

/// Directional emissivity of an opaque surface towards a cosine of emission, by Kirchhoff's law.
///
/// `None` for a BRDF that is not reciprocal, because there the light reflected from a direction says nothing about emission into it.
pub fn emissivity(brdf: &Brdf, cos_emission: f64) -> Option<f64> {
    let reflected = || Measure::DirectionalHemispherical { cos_incidence: cos_emission }.of(brdf);
    brdf.is_reciprocal().then(|| kirchhoff_emissivity(reflected()))
}

/// Of each piece: angles from 0 to the light's, from there to the horizon, azimuths, incidences.
const POINTS: usize = 40;

/// Angles and weights of f mu over the hemisphere of views.
fn hemisphere(rule: &GaussLegendre, incidence_rad: f64) -> Vec<(PhotometricAngles, f64)> {
    let azimuths: Vec<_> = squares(rule, 0.0, PI).collect();
    let emissions = squares(rule, incidence_rad, 0.0).chain(squares(rule, incidence_rad, FRAC_PI_2));
    emissions
        .flat_map(|(emission, of_emission)| {
            // Both halves of the azimuth.
            let weight = 2.0 * emission.cos() * emission.sin() * of_emission.abs();
            azimuths.iter().map(move |&(azimuth, of_azimuth)| {
                (PhotometricAngles::of_angles(incidence_rad, emission, azimuth), weight * of_azimuth)
            })
        })
        .collect()
}

/// Angles and weights of f on a sphere, in photometric longitude and latitude: mu = cos b cos l, mu0 = cos b cos(l - g).
fn sphere(rule: &GaussLegendre, phase_rad: f64) -> Vec<(PhotometricAngles, f64)> {
    let cos_phase = phase_rad.cos();
    rule.nodes(phase_rad - FRAC_PI_2, FRAC_PI_2)
        .flat_map(|(longitude, of_longitude)| {
            // Both hemispheres.
            rule.nodes(0.0, FRAC_PI_2).map(move |(latitude, of_latitude)| {
                let cos_latitude = latitude.cos();
                let (mu, mu0) = (cos_latitude * longitude.cos(), cos_latitude * (longitude - phase_rad).cos());
                let weight = 2.0 * of_longitude * of_latitude * cos_latitude * mu0 * mu;
                (PhotometricAngles::of_cosines(mu0, mu, cos_phase), weight)
            })
        })
        .collect()
}

/// Nodes and weights from `from` to `to`, crowded at `from`: x = from + (to - from) t^2.
fn squares(rule: &GaussLegendre, from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    rule.nodes(0.0, 1.0).map(move |(t, weight)| (from + (to - from) * t * t, (to - from) * 2.0 * t * weight))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::reflectance::hapke::{HFormula, Parameters, Roughness, Surge};
    use crate::physics::reflectance::{
        Akimov, Axis, Hapke, Lambert, LommelSeeliger, LunarLambert, Minnaert, Partition, PhaseCurve, PhaseFunction,
        Rpv, Table,
    };

    fn directional(brdf: &Brdf, incidence_deg: f64) -> f64 {
        Measure::DirectionalHemispherical { cos_incidence: incidence_deg.to_radians().cos() }.of(brdf)
    }

    fn isotropic(albedo: f64, h: HFormula) -> Brdf {
        Brdf::Hapke(Box::new(Hapke::new(albedo, Parameters { h, ..Parameters::PLAIN })))
    }

    #[track_caller]
    fn assert_close(got: f64, expected: f64, relative: f64) {
        assert!((got / expected - 1.0).abs() < relative, "{got} {expected}: {:e}", got / expected - 1.0);
    }

    #[test]
    fn white_surfaces_lose_nothing() {
        let lambert = Brdf::Lambert(Lambert { reflectance: 1.0 });
        let white = isotropic(1.0, HFormula::Exact);
        for brdf in [&lambert, &white] {
            for incidence_deg in [0.0, 20.0, 60.0, 85.0, 89.9] {
                assert_close(directional(brdf, incidence_deg), 1.0, 1e-6);
            }
            assert_close(Measure::Spherical.of(brdf), 1.0, 1e-6);
        }
        // A white Lambert sphere: 2/3, and 3/2.
        assert_close(Measure::Geometric.of(&lambert), 2.0 / 3.0, 1e-12);
        assert_close(phase_integral(&lambert), 1.5, 1e-9);
        assert!(emissivity(&white, 0.3).unwrap().abs() < 1e-6);
    }

    #[test]
    fn approximate_h_make_or_lose_light() {
        // (1/2) int H(mu0) H(mu) mu / (mu0 + mu) dmu at w = 1, computed independently.
        assert_close(directional(&isotropic(1.0, HFormula::Hapke1981), 0.0), 1.039_720_770_839_917_9, 1e-8);
        assert_close(directional(&isotropic(1.0, HFormula::Hapke2002), 0.0), 0.985_564_542_676_435_9, 1e-8);
        assert_close(directional(&isotropic(1.0, HFormula::Hapke1981), 60.0), 1.0, 1e-8);
    }

    #[test]
    fn isotropic_scatterers_have_closed_forms() {
        // Hapke (2012), ch. 10 and 11: A(i) = 1 - sqrt(1 - w) H(mu0).
        for (w, incidence_deg) in [(0.07, 0.0), (0.5, 60.0), (0.95, 80.0)] {
            let h = HFormula::Exact.function(w).of(f64::to_radians(incidence_deg).cos());
            assert_close(directional(&isotropic(w, HFormula::Exact), incidence_deg), 1.0 - (1.0 - w).sqrt() * h, 1e-8);
        }
        let dark = Brdf::LommelSeeliger(LommelSeeliger { albedo: 0.1, phase: PhaseFunction::Isotropic });
        // In 40 digits; and (w / 2) (1 - mu0 ln(1 + 1 / mu0)).
        let mu0 = 85f64.to_radians().cos();
        let closed = 0.05 * (1.0 - mu0 * mu0.recip().ln_1p());
        assert_close(directional(&dark, 0.0), 0.015_342_640_972_002_735, 1e-9);
        assert_close(directional(&dark, 60.0), 0.022_534_692_783_297_26, 1e-8);
        assert_close(directional(&dark, 85.0), closed, 1e-7);
        assert_close(Measure::Spherical.of(&dark), 0.1 * 0.204_568_546_293_369_8, 1e-7);
        // p = w / 8, q = (16/3) (1 - ln 2).
        assert_close(Measure::Geometric.of(&dark), 0.0125, 1e-11);
        assert_close(phase_integral(&dark), 16.0 / 3.0 * (1.0 - 2f64.ln()), 1e-7);
    }

    #[test]
    fn minnaert_and_lunar_lambert_have_closed_forms() {
        let minnaert = Minnaert { albedo: 0.07, exponent: 0.6 };
        // What the limb's guard takes is beyond 89.8 deg.
        assert_close(directional(&Brdf::Minnaert(minnaert), 0.0), 0.0875, 1e-4);
        assert_close(directional(&Brdf::Minnaert(minnaert), 0.0), minnaert.albedo_without_limb(1.0), 1e-4);
        assert_close(minnaert.albedo_without_limb(minnaert.limb_cosine()), 1.0, 1e-12);
        assert!(directional(&Brdf::Minnaert(minnaert), 89.99) <= 1.0);
        let lunar = LunarLambert { albedo: 0.07, phase: PhaseCurve::FLAT, partition: Partition::Constant(0.7) };
        assert_close(directional(&Brdf::LunarLambert(lunar), 0.0), 0.081_143_152_610_250_72, 1e-9);
    }

    #[test]
    fn models_without_closed_forms() {
        // By a rule of 56 x 56 points in emission and azimuth, computed independently; it is good to 3e-4.
        let phobos = Parameters {
            phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
            shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
            roughness: Roughness::of_mean_slope(24f64.to_radians()),
            ..Parameters::PLAIN
        };
        let phobos = Brdf::Hapke(Box::new(Hapke::new(0.072, phobos)));
        let rpv = Brdf::Rpv(Rpv { amplitude: 0.075, exponent: 0.65, asymmetry: -0.29, hot_spot: 0.075 });
        let akimov = Brdf::Akimov(Akimov { albedo: 0.07, phase: PhaseCurve::FLAT });
        for (brdf, incidence_deg, expected) in [
            (&phobos, 1.0, 0.022_399_046_658_251_5),
            (&phobos, 30.0, 0.022_787_048_614_120_08),
            (&phobos, 60.0, 0.022_309_057_816_163_075),
            (&rpv, 1.0, 0.180_094_840_750_441_38),
            (&rpv, 30.0, 0.181_434_541_354_078_38),
            (&akimov, 1.0, 0.080_453_640_372_889_21),
            (&akimov, 30.0, 0.086_662_289_694_165_09),
            (&akimov, 60.0, 0.104_397_412_620_573_43),
        ] {
            assert_close(directional(brdf, incidence_deg), expected, 4e-4);
        }
        // To 1e-6.
        assert_close(Measure::Geometric.of(&phobos), 0.065_995_053_589_764_08, 1e-5);
    }

    #[test]
    fn spheres_at_any_phase() {
        let lambert = Brdf::Lambert(Lambert { reflectance: 0.3 });
        let dark = Brdf::LommelSeeliger(LommelSeeliger { albedo: 0.1, phase: PhaseFunction::Isotropic });
        for phase_deg in [0.001, 15.0, 90.0, 150.0] {
            let phase_rad = f64::to_radians(phase_deg);
            let at = Measure::SphereAtPhase { phase_rad };
            // 2/3 rho (sin a + (pi - a) cos a) / pi, and w/8 (1 - sin(a/2) tan(a/2) ln cot(a/4)).
            let of_lambert = 0.2 * (phase_rad.sin() + (PI - phase_rad) * phase_rad.cos()) / PI;
            let half = 0.5 * phase_rad;
            let of_dark = 0.0125 * (1.0 - half.sin() * half.tan() * (0.5 * half).tan().recip().ln());
            assert_close(at.of(&lambert), of_lambert, 1e-12);
            assert_close(at.of(&dark), of_dark, 1e-7);
        }
    }

    #[test]
    fn the_spherical_albedo_by_phase_angles_is_that_by_hemispheres() {
        // The spherical albedo is p q = 2 int p Phi(a) sin a da over phase angles.
        let brdf = Brdf::Akimov(Akimov { albedo: 0.1, phase: PhaseCurve { beta: -1.5, gamma: 0.2, delta: 0.0 } });
        let by_spheres = GaussLegendre::new(24)
            .integral(0.0, PI, |phase_rad| 2.0 * Measure::SphereAtPhase { phase_rad }.of(&brdf) * phase_rad.sin());
        assert_close(by_spheres, Measure::Spherical.of(&brdf), 1e-5);
    }

    #[test]
    fn what_is_not_reciprocal_has_no_emissivity() {
        let axis = Axis::new(vec![0.0, 1.0]).unwrap();
        let table = Brdf::Table(Table::by_incidence(axis, vec![0.1, 0.2]).unwrap());
        assert_eq!(emissivity(&table, 0.5), None);
        assert_close(emissivity(&Brdf::Lambert(Lambert { reflectance: 0.07 }), 0.5).unwrap(), 0.93, 1e-12);
    }
}
