//! Models other than Lambert in the image: every pixel has the closed form at its own angles.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::geometry::{MaterialId, Mesh, Texels};
use mmxrt::physics::reflectance::albedo::Measure;
use mmxrt::physics::reflectance::hapke::{HFormula, Parameters, Roughness, Surge};
use mmxrt::physics::reflectance::{Partition, PhaseCurve, PhaseFunction, PhotometricAngles, Shape};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Beam, Hapke, Model, Photometry, Rpv, Scene, Texture, TextureKind};
use mmxrt::spectral::{Band, Extend, Spectrum};
use mmxrt::{Error, solve, study};

use crate::scenes::{edited, mars, scene};
use crate::shapes::*;

/// Sunlight at the scene on a plane normal to the beam.
const E: f64 = 700.0 / 2.25;

const ISOTROPIC: PhaseFunction = PhaseFunction::Isotropic;
const DARK: Shape = Shape::LommelSeeliger(ISOTROPIC);

fn phobos(h: HFormula) -> Shape {
    Shape::Hapke(Parameters {
        phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
        shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
        roughness: Roughness::of_mean_slope(24f64.to_radians()),
        h,
        ..Parameters::PLAIN
    })
}

/// The scene with a model for its material.
fn of_model(scene: &Scene, shape: Shape, albedo: Spectrum) -> Scene {
    edited(scene, |parts| {
        let model = Model { shape, albedo, preset: None };
        let material = &mut parts.surface.materials[0];
        material.reflectance = model.hemispherical();
        material.emissivity = material.reflectance.map(|r| 1.0 - r);
        material.photometry = Photometry::Model(Box::new(model));
    })
}

fn radiance(scene: &Scene) -> Vec<f64> {
    study::simulate(scene, &unwatched).unwrap().1.cube.band(0)
}

/// Towards incidence or emission (deg from the vertical) at an azimuth.
fn towards(zenith_deg: f64, azimuth_deg: f64) -> [f64; 3] {
    let (zenith, azimuth) = (zenith_deg.to_radians(), azimuth_deg.to_radians());
    [zenith.sin() * azimuth.cos(), zenith.sin() * azimuth.sin(), zenith.cos()]
}

/// A plane seen by one small pixel from afar, lit and seen at these angles, deg.
fn plane_at(incidence: f64, emission: f64, azimuth: f64) -> Scene {
    let at = [0.3, 0.1, 0.0];
    let from = DVec3::from(at) + 1000.0 * DVec3::from(towards(emission, azimuth));
    scene(plane(50.0, 0.0), camera(from.to_array(), at, [0.1, 0.9, 0.2], 1, 1e-6), towards(incidence, 0.0))
}

fn close(got: f64, expected: f64, relative: f64) {
    assert!((got / expected - 1.0).abs() < relative, "{got} {expected}: {:e}", got / expected - 1.0);
}

#[test]
fn radiance_at_given_angles() {
    // (incidence, emission, azimuth; BRDF), computed independently in 40 digits.
    type Row = (f64, f64, f64, f64);
    let flat = PhaseCurve::FLAT;
    let expected: [(Shape, f64, &[Row]); 6] = [
        (DARK, 0.1, &[(0.0, 0.0, 0.0, 0.003_978_873_577_297_383_5), (60.0, 40.0, 90.0, 0.006_285_519_594_391_465)]),
        (
            Shape::LunarLambert(flat, Partition::Constant(0.7)),
            0.07,
            &[(30.0, 0.0, 0.0, 0.023_401_519_491_234_306), (80.0, 75.0, 170.0, 0.078_815_682_421_785_76)],
        ),
        (
            Shape::Minnaert(0.6),
            0.07,
            &[(20.0, 70.0, 135.0, 0.035_085_944_081_819_56), (60.0, 40.0, 45.0, 0.032_708_345_679_563_704)],
        ),
        (
            Shape::Akimov(flat),
            0.07,
            &[(60.0, 40.0, 90.0, 0.029_789_390_485_296_174), (80.0, 75.0, 170.0, 0.067_893_031_532_555_74)],
        ),
        (
            phobos(HFormula::Hapke2002),
            0.072,
            &[
                // The Sun is behind the camera.
                (0.0, 0.0, 0.0, 0.021_021_228_757_924_24),
                (0.0, 30.0, 0.0, 0.008_221_149_356_839_853),
                (60.0, 40.0, 90.0, 0.005_613_527_003_819_967),
                (80.0, 75.0, 170.0, 0.001_228_718_687_374_490_8),
            ],
        ),
        (
            Shape::Rpv { exponent: 0.65, asymmetry: -0.29, hot_spot: 0.075 },
            0.075,
            &[(60.0, 40.0, 45.0, 0.078_465_321_478_665_36), (80.0, 75.0, 170.0, 0.046_678_083_858_870_2)],
        ),
    ];
    for (shape, albedo, rows) in expected {
        for &(i, e, azimuth, brdf) in rows {
            let scene = of_model(&plane_at(i, e, azimuth), shape, Spectrum::constant(albedo));
            // A surge rises by 1e-4 of itself within a pixel.
            close(radiance(&scene)[0], E * i.to_radians().cos() * brdf, if e == 0.0 { 1e-5 } else { 1e-8 });
        }
    }
}

#[test]
fn each_pixel_has_its_own_angles() {
    let triangle = mesh(&[[-100.0, -100.0, 0.0], [200.0, -100.0, 0.0], [-100.0, 200.0, 0.0]], &[[0, 1, 2]]);
    let view = camera([0.0, 0.0, 10.0], [0.0; 3], [0.0, 1.0, 0.0], 16, 0.1);
    let sun = towards(40.0, 30.0);
    let ground = scene(triangle, view.clone(), sun);
    let dark = radiance(&of_model(&ground, DARK, Spectrum::constant(0.1)));
    let minnaert = radiance(&of_model(&ground, Shape::Minnaert(0.6), Spectrum::constant(0.07)));
    let mu0 = 40f64.to_radians().cos();
    for (pixel, (dark, minnaert)) in dark.iter().zip(&minnaert).enumerate() {
        // The mean over a pixel of 6 deg.
        let mean = |f: &dyn Fn(f64) -> f64| {
            let at = |k: usize| (k as f64 + 0.5) / 20.0;
            let ray = |i: usize| view.ray((pixel % 16) as f64 + at(i % 20), (pixel / 16) as f64 + at(i / 20));
            (0..400).map(|i| f(-ray(i).normalize().z)).sum::<f64>() / 400.0
        };
        close(*dark, mean(&|mu| E * mu0 * 0.1 / (4.0 * PI * (mu0 + mu))), 3e-5);
        close(*minnaert, mean(&|mu| E * mu0 * 0.07 / PI * (mu0 * mu).powf(-0.4)), 3e-5);
    }
    assert!(dark[0] > 1.1 * dark[8 * 16 + 8]);
}

#[test]
fn light_at_the_horizon() {
    let i = 89.9f64;
    for (shape, expected) in [
        (DARK, 0.1 / (4.0 * PI * (i.to_radians().cos() + 0.5))),
        (Shape::Minnaert(0.6), 0.1 / PI * (i.to_radians().cos() * 0.5).powf(-0.4)),
    ] {
        let scene = of_model(&plane_at(i, 60.0, 100.0), shape, Spectrum::constant(0.1));
        // Minnaert's limb begins at 0.125^2.5 = 0.0055, 89.68 deg.
        let expected = if shape == DARK { expected } else { 0.1 / PI * (0.125f64.powf(2.5) * 0.5).powf(-0.4) };
        close(radiance(&scene)[0], E * i.to_radians().cos() * expected, 1e-8);
    }
}

#[test]
fn light_and_view_change_places() {
    for shape in [phobos(HFormula::Exact), Shape::Akimov(PhaseCurve { beta: -1.0, gamma: 0.0, delta: 0.0 })] {
        let at = |i: f64, e: f64| {
            let scene = of_model(&plane_at(i, e, 70.0), shape, Spectrum::constant(0.1));
            radiance(&scene)[0] / i.to_radians().cos()
        };
        close(at(35.0, 62.0), at(62.0, 35.0), 1e-8);
    }
}

#[test]
fn hundreds_of_bands_by_a_few_rows() {
    let spectrum = |most: f64| Spectrum::new(vec![0.5, 1.0, 3.5], vec![0.02, most, 0.1], Extend::Error).unwrap();
    for (most, rows) in [(0.3, 8), (0.97, 32)] {
        let albedo = spectrum(most);
        let bands: Vec<f64> = (0..300).map(|i| 0.5 + 0.01 * f64::from(i)).collect();
        let plain = edited(&plane_at(50.0, 30.0, 100.0), |parts| {
            parts.exposure.bands = bands.iter().map(|um| Band::new(*um, None)).collect();
        });
        let shape = phobos(HFormula::Exact);
        let scene = of_model(&plain, shape, albedo.clone());
        let table = solve::solve(&scene, &unwatched).unwrap();
        let emission = solve::Emission::new(&scene, &table);
        assert!(emission.rows() > 2 && emission.rows() <= rows, "{}", emission.rows());
        let cube = study::simulate(&scene, &unwatched).unwrap().1.cube;
        let angles = PhotometricAngles::of_angles(50f64.to_radians(), 30f64.to_radians(), 100f64.to_radians());
        for (band, um) in bands.iter().enumerate() {
            let brdf = shape.brdf(albedo.at(*um).unwrap()).eval(&angles);
            close(cube.band(band)[0], E * 50f64.to_radians().cos() * brdf, 1e-8);
        }
        // The angles of a pixel are good to 1e-9; between bands that drops out.
        let ratio = |um: f64| shape.brdf(albedo.at(um).unwrap()).eval(&angles);
        for (band, um) in bands.iter().enumerate() {
            close(cube.band(band)[0] / cube.band(0)[0], ratio(*um) / ratio(0.5), 2e-9);
        }
    }
}

#[test]
fn a_sphere_has_its_integral_phase_function() {
    let shape = phobos(HFormula::Exact);
    for phase_deg in [0.0, 60.0, 110.0] {
        let pitch = 2.2 / 48.0 / 1e4;
        let view = camera([0.0, 0.0, 1e4], [0.0; 3], [0.0, 1.0, 0.0], 48, pitch);
        let ball = edited(&scene(sphere([0.0; 3], 1.0, 5), view, towards(phase_deg, 0.0)), |parts| {
            parts.surface.origin_m = DVec3::ZERO;
        });
        let sum: f64 = radiance(&of_model(&ball, shape, Spectrum::constant(0.072))).iter().sum();
        let phase_rad = f64::to_radians(phase_deg);
        let expected = Measure::SphereAtPhase { phase_rad }.of(&shape.brdf(0.072));
        // Facets of 2 deg.
        close(sum * pitch * pitch * 1e8 / E, expected, 3e-3);
    }
}

#[test]
fn a_facet_in_half_shadow_is_seen_at_the_angles_of_its_lit_part() {
    // A pixel of 20 m from 10 m above; a wall of 5 m beside it keeps the Sun, at 45 deg, from a quarter of that.
    let ground = mesh(&[[-300.0, -300.0, 0.0], [900.0, -300.0, 0.0], [-300.0, 900.0, 0.0]], &[[0, 1, 2]]);
    let wall = cuboid([-11.0, -100.0, 0.0], [-10.0, 100.0, 5.0]);
    let view = camera([0.0, 0.0, 10.0], [0.0; 3], [0.0, 1.0, 0.0], 1, 2.0);
    let lit = scene(joined(&[ground, wall]), view, [-1.0, 0.0, 1.0]);
    let got = radiance(&of_model(&lit, DARK, Spectrum::constant(0.1)))[0];
    // The lit part is from x = -5 to 10 m: the mean over it.
    let mu0 = 0.5f64.sqrt();
    let f = |i: i32| {
        let [x, y] = [i % 300, i / 300].map(|k| (f64::from(k) + 0.5) / 300.0);
        let mu = 10.0 / (100.0 + (15.0 * x - 5.0).powi(2) + (20.0 * y - 10.0).powi(2)).sqrt();
        0.1 / (4.0 * PI * (mu0 + mu))
    };
    close(got, 0.75 * E * mu0 * (0..90_000).map(f).sum::<f64>() / 90_000.0, 1e-4);
}

#[test]
fn each_source_has_its_own_angles() {
    let second = |scene: &Scene| {
        edited(scene, |parts| {
            parts.sky.beams = vec![Beam {
                name: "second".into(),
                direction: direction(towards(70.0, 180.0)),
                irradiance: Spectrum::constant(100.0),
                total_irradiance_w_m2: 0.0,
            }];
        })
    };
    let (mu0, other, mu) = (60f64.to_radians().cos(), 70f64.to_radians().cos(), 40f64.to_radians().cos());
    let both = second(&of_model(&plane_at(60.0, 40.0, 90.0), DARK, Spectrum::constant(0.1)));
    let of = |irradiance: f64, mu0: f64| irradiance * mu0 * 0.1 / (4.0 * PI * (mu0 + mu));
    close(radiance(&both)[0], of(E, mu0) + of(100.0, other), 1e-8);
    // Of all of Mars. The Sun is below the horizon.
    let night = |shape: Option<Shape>| {
        let dark = edited(&plane_at(120.0, 40.0, 90.0), |parts| {
            parts.sky.mars = Some(mars(9.4e6 * DVec3::from(towards(50.0, 0.0))));
        });
        radiance(&shape.map_or(dark.clone(), |shape| of_model(&dark, shape, Spectrum::constant(0.1))))[0]
    };
    let lambert = night(None);
    assert!(lambert > 0.0);
    let (centre_m, sun) = (9.4e6 * DVec3::from(towards(50.0, 0.0)), DVec3::from(towards(120.0, 0.0)));
    let f = |direction: DVec3| 0.1 / (4.0 * PI * (direction.z + mu));
    let (light, sum) = crate::mars_models::over_sphere(centre_m, 3_389_500.0, DVec3::Z, Some(sun), f);
    close(night(Some(DARK)) / lambert, sum / light / (0.07 / PI), 1e-3);
}

/// Four texels on the square of half width 50 m, each of these values.
fn texture(mesh: &Mesh, kind: TextureKind, value: f64) -> Texture {
    let texel = |p: DVec3| [(p.x + 50.0) / 50.0, (50.0 - p.y) / 50.0];
    Texture {
        material: MaterialId(0),
        kind,
        corners: (0..mesh.facets.len()).map(|f| mesh.facet(f).corners_m.map(texel)).collect(),
        rows: 2,
        columns: 2,
        wavelength_um: vec![],
        values: vec![value; 4],
        texels: Texels::Nearest,
        lon_lat: None,
    }
}

#[test]
fn textures_multiply_every_model() {
    let plain = plane_at(50.0, 30.0, 100.0);
    let with = |scene: &Scene, kind: TextureKind, value: f64| {
        edited(scene, |parts| parts.surface.textures = vec![texture(&parts.surface.mesh, kind, value)])
    };
    let table = |name: usize| Photometry::Hapke(Box::new(hapke_table(name)));
    let by_table = edited(&plain, |parts| parts.surface.materials[0].photometry = table(1));
    let hapke = of_model(&plain, phobos(HFormula::Exact), Spectrum::constant(0.1));
    let minnaert = of_model(&plain, Shape::Minnaert(0.6), Spectrum::constant(0.07));
    for scene in [&hapke, &minnaert, &by_table] {
        close(radiance(&with(scene, TextureKind::Factor, 0.5))[0], 0.5 * radiance(scene)[0], 1e-12);
    }
    let hemispherical = minnaert.body.materials[0].reflectance.value()[0];
    let replaced = with(&minnaert, TextureKind::Reflectance, 2.0 * hemispherical);
    close(radiance(&replaced)[0], 2.0 * radiance(&minnaert)[0], 1e-12);
    for scene in [&hapke, &by_table] {
        let refused = solve::solve(&with(scene, TextureKind::Reflectance, 0.1), &unwatched).unwrap_err();
        assert!(matches!(refused, Error::Unsupported { .. }) && refused.to_string().contains("texture"), "{refused}");
    }
}

/// Parameters of which w, and this one, depend on wavelength.
fn hapke_table(varying: usize) -> Hapke {
    let mut columns = [0.3, 0.2, 0.1, 0.05, 0.02, 1.2, 0.1].map(Spectrum::constant);
    for i in [0, varying] {
        let value = columns[i].value()[0];
        columns[i] = Spectrum::new(vec![0.5, 3.5], vec![value, 1.4 * value], Extend::Error).unwrap();
    }
    Hapke::from(columns)
}

#[test]
fn tables_of_parameters_are_taken_at_each_wavelength() {
    let um = [1.0, 2.0, 3.0];
    let plain = edited(&plane_at(60.0, 0.0, 0.0), |parts| {
        parts.exposure.bands = um.iter().map(|um| Band::new(*um, None)).collect();
    });
    for varying in [0, 1, 6] {
        let table = hapke_table(varying);
        let scene = edited(&plain, |parts| {
            parts.surface.materials[0].photometry = Photometry::Hapke(Box::new(table.clone()));
        });
        let cube = study::simulate(&scene, &unwatched).unwrap().1.cube;
        for (band, um) in um.into_iter().enumerate() {
            let [w, c1, c2, c3, c4, h1, h2] =
                [&table.w, &table.c1, &table.c2, &table.c3, &table.c4, &table.h1, &table.h2].map(|s| s.at(um).unwrap());
            // SOILSPECT: g = 60 deg; the mirror's direction is 60 deg from the view, too.
            let legendre = |a: f64, b: f64| a * 0.5 + b * (0.75 - 1.0) / 2.0;
            let p = 1.0 + legendre(c1, c2) + legendre(c3, c4);
            let b = h1 / (1.0 + (PI / 6.0).tan() / h2);
            let h = |x: f64| (1.0 + 2.0 * x) / (1.0 + 2.0 * x * (1.0 - w).sqrt());
            let factor = w / 4.0 / 1.5 * ((1.0 + b) * p + h(0.5) * h(1.0) - 1.0);
            close(cube.band(band)[0], factor / PI * E * 0.5, 1e-6);
        }
    }
    let mut rpv = [0.075, 0.65, -0.29, 0.075].map(Spectrum::constant);
    rpv[1] = Spectrum::new(vec![0.5, 1.0, 3.5], vec![0.9, 0.65, 0.4], Extend::Error).unwrap();
    let scene = edited(&plane_at(60.0, 40.0, 45.0), |parts| {
        parts.surface.materials[0].photometry = Photometry::Rpv(Box::new(Rpv::from(rpv)));
    });
    close(radiance(&scene)[0], E * 0.5 * 0.078_465_321_478_665_36, 1e-8);
}

#[test]
fn what_maps_do_not_know_is_by_the_model() {
    let lit = of_model(&plane_at(60.0, 40.0, 45.0), phobos(HFormula::Exact), Spectrum::constant(0.072));
    let facets = lit.body.mesh.facets.len();
    let map = crate::maps::map(mmxrt::product::Placement::Facets(facets), vec![f64::NAN; facets]);
    let options = study::MapOptions { fill: study::Fill::Solved, ..study::MapOptions::default() };
    let (filled, _) = crate::maps::observe(&lit, vec![vec![map]], &options).unwrap();
    close(filled.cube.band(0)[0], radiance(&lit)[0], 1e-12);
}
