//! How a surface reflects.
//!
//! Three quantities go by the name of reflectance (Hapke, *Theory of Reflectance and Emittance Spectroscopy*, 2012, ch. 10):
//!
//! - **BRDF** f, 1/sr: L = f E with E the irradiance **on the surface**, the cosine already in it;
//! - **reflectance factor** REFF = pi f: against a perfect Lambert surface lit alike (the thesis's rho_l, equation (2));
//! - **radiance factor** RADF = I/F = pi f mu0: against a perfect Lambert surface lit at normal incidence.
//!
//! Every model gives f, and says where it is defined and whether it is reciprocal: f(i, e) = f(e, i).
//! Two sources need two evaluations, each at its own angles: L = sum over sources of f(source -> view) E_source.

mod akimov;
pub mod albedo;
mod angles;
mod directional;
pub mod hapke;
mod lambert;
mod lommel_seeliger;
mod lunar_lambert;
mod minnaert;
mod parameter;
mod phase_curve;
mod phase_function;
mod presets;
mod rpv;
mod shape;
mod table;

use std::f64::consts::PI;

pub use akimov::Akimov;
pub use angles::{LEAST_COSINE, PhotometricAngles};
pub use directional::{DirectionalAlbedos, FLATTEST};
pub use hapke::Hapke;
pub use lambert::Lambert;
pub use lommel_seeliger::LommelSeeliger;
pub use lunar_lambert::{LunarLambert, Partition};
pub use minnaert::Minnaert;
pub use parameter::Parameter;
pub use phase_curve::PhaseCurve;
pub use phase_function::PhaseFunction;
pub use presets::{Known, KnownNumber, Preset};
pub use rpv::Rpv;
pub use shape::{Albedos, Separated, Shape};
pub use table::{Axis, Table};

/// What is reflected and let through of light is all of it within this: more makes energy.
pub const ALL_LIGHT: f64 = 1.0 + 1e-9;

/// A bidirectional reflectance distribution function.
#[derive(Debug, Clone, PartialEq)]
pub enum Brdf {
    /// The same radiance in every direction.
    Lambert(Lambert),
    /// Light scattered once by a dark, deep layer.
    LommelSeeliger(LommelSeeliger),
    /// McEwen's mixture of the two above.
    LunarLambert(LunarLambert),
    /// Minnaert's powers of the cosines.
    Minnaert(Minnaert),
    /// Akimov's disc function of a very rough surface.
    Akimov(Akimov),
    /// Hapke's.
    Hapke(Box<Hapke>),
    /// That of Rahman, Pinty and Verstraete.
    Rpv(Rpv),
    /// A table of measurements.
    Table(Table),
}

impl Brdf {
    /// The BRDF, 1/sr, without any cosine.
    ///
    /// Limits: defined above the horizon. Cosines below [`LEAST_COSINE`], as rounding makes them at the limb, are raised to it; on the dark
    /// side the irradiance is 0 anyway.
    pub fn eval(&self, angles: &PhotometricAngles) -> f64 {
        match self {
            Brdf::Lambert(model) => model.brdf(),
            Brdf::LommelSeeliger(model) => model.brdf(angles),
            Brdf::LunarLambert(model) => model.brdf(angles),
            Brdf::Minnaert(model) => model.brdf(angles),
            Brdf::Akimov(model) => model.brdf(angles),
            Brdf::Hapke(model) => model.brdf(angles),
            Brdf::Rpv(model) => model.brdf(angles),
            Brdf::Table(model) => model.brdf(angles),
        }
    }

    /// Reflectance factor REFF = pi f.
    pub fn reflectance_factor(&self, angles: &PhotometricAngles) -> f64 {
        PI * self.eval(angles)
    }

    /// Radiance factor RADF = I/F = pi f mu0.
    pub fn radiance_factor(&self, angles: &PhotometricAngles) -> f64 {
        PI * self.eval(angles) * angles.cos_incidence()
    }

    /// Whether f is the same with the directions of light and view exchanged. A real surface's is (Helmholtz); a table's may not be.
    pub fn is_reciprocal(&self) -> bool {
        match self {
            Brdf::Table(table) => table.is_reciprocal(),
            Brdf::Lambert(_)
            | Brdf::LommelSeeliger(_)
            | Brdf::LunarLambert(_)
            | Brdf::Minnaert(_)
            | Brdf::Akimov(_)
            | Brdf::Hapke(_)
            | Brdf::Rpv(_) => true,
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
    use super::hapke::{HFormula, Parameters, Roughness, Surge};
    use super::*;
    use crate::physics::GaussLegendre;
    use crate::random::Draws;
    use glam::DVec3;

    fn lommel_seeliger(albedo: f64) -> Brdf {
        Brdf::LommelSeeliger(LommelSeeliger { albedo, phase: PhaseFunction::Isotropic })
    }

    fn lunar_lambert(albedo: f64, share: f64) -> Brdf {
        Brdf::LunarLambert(LunarLambert { albedo, phase: PhaseCurve::FLAT, partition: Partition::Constant(share) })
    }

    fn minnaert(albedo: f64, exponent: f64) -> Brdf {
        Brdf::Minnaert(Minnaert { albedo, exponent })
    }

    fn akimov(albedo: f64) -> Brdf {
        Brdf::Akimov(Akimov { albedo, phase: PhaseCurve::FLAT })
    }

    fn rpv() -> Brdf {
        Brdf::Rpv(Rpv { amplitude: 0.075, exponent: 0.65, asymmetry: -0.29, hot_spot: 0.075 })
    }

    fn hapke(albedo: f64, parameters: Parameters) -> Brdf {
        Brdf::Hapke(Box::new(Hapke::new(albedo, parameters)))
    }

    fn smooth(h: HFormula) -> Brdf {
        let phase = PhaseFunction::HenyeyGreenstein { b: -0.25 };
        let shadow_hiding = Surge { amplitude: 1.0, width: 0.05 };
        hapke(0.2, Parameters { phase, shadow_hiding, h, ..Parameters::PLAIN })
    }

    fn phobos(porosity_factor: f64) -> Brdf {
        let parameters = Parameters {
            phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
            shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
            roughness: Roughness::of_mean_slope(24f64.to_radians()),
            porosity_factor,
            h: HFormula::Hapke2002,
            ..Parameters::PLAIN
        };
        hapke(0.072, parameters)
    }

    fn moon() -> Brdf {
        let parameters = Parameters {
            phase: PhaseFunction::TwoTerms { b: 0.24, c: 0.3 },
            shadow_hiding: Surge { amplitude: 1.8, width: 0.07 },
            roughness: Roughness::of_mean_slope(23.4f64.to_radians()),
            h: HFormula::Hapke2002,
            ..Parameters::PLAIN
        };
        hapke(0.33, parameters)
    }

    /// One with everything, and a phase function that knows the mirror's direction.
    fn exact() -> Brdf {
        let parameters = Parameters {
            phase: PhaseFunction::Legendre { about_source: [0.3, 0.1], about_specular: [0.2, 0.1] },
            shadow_hiding: Surge { amplitude: 1.5, width: 0.06 },
            coherent: Surge { amplitude: 0.4, width: 0.01 },
            roughness: Roughness::of_mean_slope(0.3),
            porosity_factor: 1.3,
            h: HFormula::Exact,
        };
        hapke(0.6, parameters)
    }

    fn table() -> Brdf {
        let axis = || Axis::new(vec![0.0, 0.7, 1.4]).unwrap();
        let factors = vec![0.1, 0.2, 0.4, 0.2, 0.5, 0.6, 0.4, 0.6, 0.7];
        Brdf::Table(Table::by_incidence_and_emission(axis(), axis(), factors).unwrap())
    }

    fn all() -> Vec<Brdf> {
        let lambert = Brdf::Lambert(Lambert { reflectance: 0.07 });
        let darkening = PhaseCurve { beta: -1.3, gamma: 0.1, delta: 0.0 };
        vec![
            lambert,
            lommel_seeliger(0.1),
            Brdf::LunarLambert(LunarLambert { albedo: 0.1, phase: darkening, partition: Partition::Moon }),
            lunar_lambert(0.07, 0.7),
            minnaert(0.07, 0.6),
            akimov(0.07),
            Brdf::Akimov(Akimov { albedo: 0.07, phase: darkening }),
            smooth(HFormula::Hapke1981),
            smooth(HFormula::Hapke2002),
            phobos(1.0),
            phobos(1.2),
            moon(),
            exact(),
            rpv(),
            table(),
        ]
    }

    /// Even over the upper hemisphere.
    fn direction(draws: &mut Draws) -> DVec3 {
        let (z, azimuth) = (draws.unit(), 2.0 * PI * draws.unit());
        let level = (1.0 - z * z).sqrt();
        DVec3::new(level * azimuth.cos(), level * azimuth.sin(), z)
    }

    #[test]
    fn values_at_given_angles() {
        // (incidence, emission, azimuth, deg; BRDF), computed independently in 40 digits. Hapke's H where nothing is said is that of 2002.
        type Row = (f64, f64, f64, f64);
        let expected: [(Brdf, &[Row]); 10] = [
            (
                lommel_seeliger(0.1),
                &[
                    (0.0, 0.0, 0.0, 0.003_978_873_577_297_383_5),
                    (0.0, 30.0, 0.0, 0.004_264_543_847_289_465),
                    (60.0, 40.0, 90.0, 0.006_285_519_594_391_465),
                    (60.0, 40.0, 45.0, 0.006_285_519_594_391_465),
                ],
            ),
            (
                lunar_lambert(0.07, 0.7),
                &[
                    (0.0, 0.0, 0.0, 0.022_281_692_032_865_348),
                    (30.0, 0.0, 0.0, 0.023_401_519_491_234_306),
                    (0.0, 30.0, 0.0, 0.023_401_519_491_234_306),
                    (60.0, 40.0, 90.0, 0.031_323_744_419_874_14),
                    (60.0, 40.0, 45.0, 0.031_323_744_419_874_14),
                    (70.0, 20.0, 135.0, 0.031_022_541_621_430_012),
                    (80.0, 75.0, 170.0, 0.078_815_682_421_785_76),
                    (45.0, 45.0, 1.0, 0.028_742_257_355_708_702),
                ],
            ),
            (
                minnaert(0.07, 0.6),
                &[
                    (30.0, 0.0, 0.0, 0.023_601_299_420_118_352),
                    (0.0, 30.0, 0.0, 0.023_601_299_420_118_352),
                    (30.0, 30.0, 180.0, 0.024_999_059_025_520_864),
                    (60.0, 40.0, 90.0, 0.032_708_345_679_563_704),
                    (60.0, 40.0, 45.0, 0.032_708_345_679_563_704),
                    (20.0, 70.0, 135.0, 0.035_085_944_081_819_56),
                    (80.0, 75.0, 170.0, 0.077_069_329_931_127_2),
                    (45.0, 45.0, 1.0, 0.029_400_868_902_771_198),
                ],
            ),
            (
                akimov(0.07),
                &[
                    (0.0, 0.0, 0.0, 0.022_281_692_032_865_348),
                    (30.0, 0.0, 0.0, 0.023_635_654_844_198_48),
                    (30.0, 30.0, 0.0, 0.025_728_681_786_350_297),
                    (60.0, 40.0, 90.0, 0.029_789_390_485_296_174),
                    (60.0, 40.0, 45.0, 0.030_998_699_629_138_395),
                    (70.0, 20.0, 135.0, 0.030_551_908_624_902_476),
                    (80.0, 75.0, 170.0, 0.067_893_031_532_555_74),
                    (45.0, 45.0, 1.0, 0.031_468_032_560_314_003),
                ],
            ),
            (
                smooth(HFormula::Hapke1981),
                &[
                    (0.0, 0.0, 0.0, 0.036_618_349_963_197_54),
                    (30.0, 0.0, 0.0, 0.019_831_652_022_813_992),
                    (0.0, 30.0, 0.0, 0.019_831_652_022_813_992),
                    (60.0, 40.0, 45.0, 0.025_527_780_869_997_407),
                    (20.0, 70.0, 135.0, 0.013_485_998_954_735_385),
                    (80.0, 75.0, 10.0, 0.109_615_382_649_928_22),
                    (80.0, 75.0, 170.0, 0.021_285_742_237_115_126),
                    (45.0, 45.0, 1.0, 0.048_798_019_625_830_49),
                ],
            ),
            (
                smooth(HFormula::Hapke2002),
                &[
                    (0.0, 0.0, 0.0, 0.036_665_141_026_038_01),
                    (30.0, 0.0, 0.0, 0.019_886_120_255_407_57),
                    (30.0, 30.0, 0.0, 0.042_268_012_766_665_78),
                    (30.0, 30.0, 180.0, 0.014_128_695_673_953_95),
                    (60.0, 40.0, 90.0, 0.017_233_069_392_971_73),
                    (70.0, 20.0, 135.0, 0.013_610_757_896_684_277),
                    (80.0, 75.0, 170.0, 0.021_854_883_060_570_113),
                    (45.0, 45.0, 1.0, 0.048_892_551_697_675_74),
                ],
            ),
            (
                phobos(1.0),
                &[
                    (0.0, 0.0, 0.0, 0.021_021_228_757_924_24),
                    (0.0, 30.0, 0.0, 0.008_221_149_356_839_853),
                    (60.0, 40.0, 90.0, 0.005_613_527_003_819_967),
                    (70.0, 20.0, 135.0, 0.003_979_407_658_701_506),
                    (80.0, 75.0, 170.0, 0.001_228_718_687_374_490_8),
                    (45.0, 45.0, 1.0, 0.027_686_719_404_236_036),
                ],
            ),
            (
                phobos(1.2),
                &[
                    (0.0, 0.0, 0.0, 0.025_215_176_612_383_75),
                    (30.0, 30.0, 0.0, 0.029_106_500_009_150_4),
                    (30.0, 30.0, 180.0, 0.006_286_397_103_136_408),
                    (60.0, 40.0, 90.0, 0.006_721_518_778_578_46),
                    (20.0, 70.0, 135.0, 0.004_761_851_214_724_161),
                    (80.0, 75.0, 170.0, 0.001_467_798_265_746_562),
                    (45.0, 45.0, 1.0, 0.033_209_151_072_053_27),
                ],
            ),
            (
                moon(),
                &[
                    (0.0, 0.0, 0.0, 0.061_334_460_570_533_67),
                    (30.0, 30.0, 0.0, 0.070_585_794_982_281_62),
                    (30.0, 30.0, 180.0, 0.023_014_218_525_869_917),
                    (60.0, 40.0, 45.0, 0.036_710_538_289_641_78),
                    (70.0, 20.0, 135.0, 0.021_096_509_053_347_406),
                    (20.0, 70.0, 135.0, 0.021_096_509_053_347_406),
                    (80.0, 75.0, 170.0, 0.012_467_404_358_212_171),
                    (45.0, 45.0, 1.0, 0.081_810_738_992_617_86),
                ],
            ),
            (
                rpv(),
                &[
                    (0.0, 0.0, 0.0, 0.092_268_750_387_302_56),
                    (0.0, 30.0, 0.0, 0.066_077_875_329_868_22),
                    (60.0, 40.0, 90.0, 0.046_334_246_083_091_46),
                    (60.0, 40.0, 45.0, 0.078_465_321_478_665_36),
                    (70.0, 20.0, 135.0, 0.035_127_959_414_846_52),
                    (80.0, 75.0, 170.0, 0.046_678_083_858_870_2),
                    (45.0, 45.0, 1.0, 0.131_656_930_416_282_1),
                ],
            ),
        ];
        for (brdf, values) in expected {
            for (i_deg, e_deg, azimuth_deg, f) in values {
                let [i, e, azimuth] = [i_deg, e_deg, azimuth_deg].map(|deg| deg.to_radians());
                let got = brdf.eval(&PhotometricAngles::of_angles(i, e, azimuth));
                assert!((got / f - 1.0).abs() < 1e-12, "{brdf:?} {i_deg} {e_deg} {azimuth_deg}: {got} {f}");
                let cosines = PhotometricAngles::of_cosines(
                    i.cos(),
                    e.cos(),
                    i.cos() * e.cos() + i.sin() * e.sin() * azimuth.cos(),
                );
                assert!((brdf.eval(&cosines) / f - 1.0).abs() < 1e-6, "{brdf:?} by cosines");
            }
        }
    }

    #[test]
    fn radiance_factors_of_phobos_and_of_lambert() {
        // Computed independently, at incidence 60, emission 30, azimuth 90 deg.
        let angles = PhotometricAngles::of_angles(PI / 3.0, PI / 6.0, PI / 2.0);
        assert!((phobos(1.0).radiance_factor(&angles) / 0.008_825_149_547_288_974 - 1.0).abs() < 1e-12);
        let lambert = Brdf::Lambert(Lambert { reflectance: 0.07 });
        assert!((lambert.radiance_factor(&angles) - 0.035).abs() < 1e-16);
        assert!((lambert.reflectance_factor(&angles) - 0.07).abs() < 1e-16);
    }

    #[test]
    fn light_and_view_change_places() {
        let mut draws = Draws::new(1);
        let angles: Vec<_> = (0..100_000)
            .map(|_| {
                let (source, observer) = (direction(&mut draws), direction(&mut draws));
                [
                    PhotometricAngles::of_directions(DVec3::Z, source, observer),
                    PhotometricAngles::of_directions(DVec3::Z, observer, source),
                ]
            })
            .collect();
        for brdf in all() {
            assert!(brdf.is_reciprocal(), "{brdf:?}");
            for [there, back] in &angles {
                let (f, of_swapped) = (brdf.eval(there), brdf.eval(back));
                assert!(f >= 0.0 && (f - of_swapped).abs() <= 1e-13 * f, "{brdf:?} {there:?}: {f} {of_swapped}");
            }
        }
        let by_incidence = Table::by_incidence(Axis::new(vec![0.0, 1.0]).unwrap(), vec![0.1, 0.2]).unwrap();
        assert!(!Brdf::Table(by_incidence).is_reciprocal());
    }

    #[test]
    fn extreme_angles_have_values() {
        let ends = [0.0, 1e-9, 1e-6, 0.5, PI / 4.0, PI / 2.0 - 1e-9, PI / 2.0, PI / 2.0 + 1e-9, 2.0];
        for brdf in all() {
            for i in ends {
                for e in ends {
                    for azimuth in [0.0, 1e-9, 1.0, PI - 1e-9, PI] {
                        let angles = PhotometricAngles::of_angles(i, e, azimuth);
                        let by_cosines = PhotometricAngles::of_cosines(i.cos(), e.cos(), angles.cos_phase());
                        for f in [brdf.eval(&angles), brdf.eval(&by_cosines)] {
                            assert!(f.is_finite() && f >= 0.0, "{brdf:?} {i} {e} {azimuth}: {f}");
                        }
                    }
                }
            }
            // Exactly opposite, one and the same, and beyond by rounding.
            for (source, observer) in [
                (DVec3::X, DVec3::NEG_X),
                (DVec3::X, DVec3::X),
                (DVec3::Z, DVec3::Z),
                (DVec3::Z, DVec3::NEG_Z),
                (DVec3::Z * (1.0 + 1e-15), DVec3::Z * (1.0 + 1e-15)),
            ] {
                let f = brdf.eval(&PhotometricAngles::of_directions(DVec3::Z, source, observer));
                assert!(f.is_finite() && f >= 0.0, "{brdf:?} {source} {observer}: {f}");
            }
            // Nowhere: no panic.
            let _ = brdf.eval(&PhotometricAngles::of_cosines(f64::NAN, 0.5, f64::NAN));
            let _ = brdf.eval(&PhotometricAngles::of_directions(DVec3::NAN, DVec3::ZERO, DVec3::X));
        }
    }

    #[test]
    fn nothing_jumps_where_the_azimuth_is_lost() {
        for brdf in all() {
            for (e, azimuth) in [(0.5, 0.0), (0.5, 2.0), (1.4, PI), (0.0, 1.0)] {
                let at = |i: f64| brdf.eval(&PhotometricAngles::of_angles(i, e, azimuth));
                let relative = (at(1e-9) / at(0.0) - 1.0).abs();
                assert!(relative < 1e-6, "{brdf:?} {e} {azimuth}: {relative}");
            }
        }
    }

    #[test]
    fn a_white_lambert_surface_sends_out_what_it_gets() {
        // Its factor is 1: radiance times pi is the irradiance, which is also its exitance.
        assert_eq!(radiance_of_reflectance_factor(1.0, PI), 1.0);
        assert_eq!(radiance_of_reflectance_factor(0.5, 2.0), lambert_radiance(1.0));
        let exitance = GaussLegendre::new(4).integral(0.0, 1.0, |mu| 2.0 * PI * mu * lambert_radiance(3.0));
        assert!((exitance - 3.0).abs() < 1e-15);
    }
}
