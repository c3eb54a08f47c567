//! Surfaces with a model in the light of discs: against sums over all patches of Mars, and over the Sun's disc.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::physics::reflectance::hapke::{Parameters, Roughness, Surge};
use mmxrt::physics::reflectance::{Brdf, PhaseFunction, PhotometricAngles, Shape};
use mmxrt::physics::sun_disc::DiscRule;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Model, Photometry, Rpv, Scene, SunModel};
use mmxrt::solve::{self, FacetRadiance, Observer};
use mmxrt::spectral::{Band, Extend, Spectrum};
use mmxrt::study::{self, Bound, Choice, Extremes, Request};
use mmxrt::units::{AU_M, SUN_RADIUS_M};

use crate::scenes::{edited, mars, scene};
use crate::shapes::{camera, plane};

const DARK: Shape = Shape::LommelSeeliger(PhaseFunction::Isotropic);

/// Sums over the patches of a sphere that a facet at the origin sees: of irradiance over reflectance and sunlight, and of that times a function of the direction.
/// Without a Sun its radiance is 1 / pi everywhere.
pub(crate) fn over_sphere(
    centre_m: DVec3,
    radius_m: f64,
    normal: DVec3,
    sun: Option<DVec3>,
    of: impl Fn(DVec3) -> f64,
) -> (f64, f64) {
    const RINGS: u32 = 500;
    let (distance_m, towards) = (centre_m.length(), centre_m.normalize());
    let e1 = towards.any_orthonormal_vector();
    let e2 = towards.cross(e1);
    let least = radius_m / distance_m;
    let patch_m2 = PI * radius_m * radius_m * (1.0 - least) / f64::from(RINGS * RINGS);
    let (mut light, mut sum) = (0.0, 0.0);
    for i in 0..RINGS {
        let mu = 1.0 - (f64::from(i) + 0.5) / f64::from(RINGS) * (1.0 - least);
        for j in 0..2 * RINGS {
            let (sin, cos) = (PI * (f64::from(j) + 0.5) / f64::from(RINGS)).sin_cos();
            let m = -mu * towards + (1.0 - mu * mu).sqrt() * (cos * e1 + sin * e2);
            let p_m = centre_m + radius_m * m;
            let to_patch = p_m.normalize();
            let day = sun.map_or(1.0, |sun| m.dot(sun).max(0.0));
            let cosines = day * (-m.dot(to_patch)).max(0.0) * normal.dot(to_patch).max(0.0);
            let irradiance = cosines / PI * patch_m2 / p_m.length_squared();
            if irradiance > 0.0 {
                light += irradiance;
                sum += irradiance * of(to_patch);
            }
        }
    }
    (light, sum)
}

fn towards(zenith_deg: f64, azimuth_deg: f64) -> DVec3 {
    let (zenith, azimuth) = (zenith_deg.to_radians(), azimuth_deg.to_radians());
    DVec3::new(zenith.sin() * azimuth.cos(), zenith.sin() * azimuth.sin(), zenith.cos())
}

/// A plane seen by one small pixel from afar, under a Sun in this direction.
fn ground(sun: DVec3, view: DVec3) -> Scene {
    let at = [0.3, 0.1, 0.0];
    let from = DVec3::from(at) + 1000.0 * view;
    scene(plane(50.0, 0.0), camera(from.to_array(), at, [0.1, 0.9, 0.2], 1, 1e-6), sun.to_array())
}

fn of_model(scene: &Scene, shape: Shape) -> Scene {
    edited(scene, |parts| {
        let model = Model { shape, albedo: Spectrum::constant(0.1), preset: None };
        let material = &mut parts.surface.materials[0];
        material.reflectance = model.hemispherical();
        material.photometry = Photometry::Model(Box::new(model));
    })
}

fn phobos() -> Shape {
    Shape::Hapke(Parameters {
        phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
        shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
        roughness: Roughness::of_mean_slope(24f64.to_radians()),
        ..Parameters::PLAIN
    })
}

fn f(brdf: &Brdf, source: DVec3, view: DVec3) -> f64 {
    brdf.eval(&PhotometricAngles::of_directions(DVec3::Z, source, view))
}

#[test]
fn a_model_reflects_all_of_mars() {
    let view = towards(40.0, 90.0);
    // Mars whole, half set, next to all of it set; seen before the camera's own direction.
    for (mars_deg, azimuth_deg) in [(50.0, 0.0), (90.0, 30.0), (103.0, 200.0), (35.0, 80.0)] {
        // The Sun is below the horizon: beside Mars, before it, and behind it for the most part.
        for sun in [towards(120.0, 0.0), towards(150.0, 130.0), towards(95.0, 200.0)] {
            let centre_m = 9_376_000.0 * towards(mars_deg, azimuth_deg);
            let night = edited(&ground(sun, view), |parts| parts.sky.mars = Some(mars(centre_m)));
            for (shape, tolerance) in [(DARK, 0.01), (phobos(), 0.02)] {
                let brdf = shape.brdf(0.1);
                let of = |direction: DVec3| f(&brdf, direction, view);
                let (light, sum) = over_sphere(centre_m, 3_389_500.0, DVec3::Z, Some(sun), of);
                if light < 1e-5 {
                    continue;
                }
                let expected = 0.25 * 700.0 / 2.25 * sum;
                let lit = of_model(&night, shape);
                let (_, seen) = study::simulate(&lit, &unwatched).unwrap();
                let table = solve::solve(&lit, &unwatched).unwrap();
                let towards_eye = Observer::At(DVec3::new(0.3, 0.1, 0.0) + 1e6 * view);
                let of_facet = FacetRadiance::new(&lit, &table, towards_eye).unwrap().radiance(0..1)[0];
                for got in [seen.cube.band(0)[0], of_facet] {
                    let error = (got / expected - 1.0).abs();
                    assert!(error < tolerance, "{mars_deg} {sun} {shape:?}: {got} {expected}");
                }
            }
        }
    }
}

/// What a plan of everything says of the Sun's disc that it keeps.
fn left_of_the_sun(scene: &Scene) -> Bound {
    let extremes = Extremes::new(scene);
    let (_, plan) = study::plan(scene, &extremes, &Request { choice: Choice::Full, tolerance: 1e-3 }).unwrap();
    plan.effects.iter().find(|effect| effect.key == "sun-disc").unwrap().remaining.unwrap()
}

/// At grazing light, in bands of which one has a surface that reflects there as it stands and another one that is much brighter at the limb.
#[test]
fn no_model_errs_more_on_the_suns_disc_than_is_told() {
    let view = towards(50.0, 60.0);
    let (um, exponents) = ([1.0, 2.0], [1.0, 0.5]);
    let sun_rad = (SUN_RADIUS_M / (1.5 * AU_M)).asin();
    for radii in [0.1_f64, 0.5, 1.2, 4.0, 60.0] {
        let elevation_rad = radii * sun_rad;
        let sun = DVec3::new(elevation_rad.cos(), 0.0, elevation_rad.sin());
        let lit = edited(&ground(sun, view), |parts| {
            parts.exposure.bands = um.map(|um| Band::new(um, None)).to_vec();
            parts.models.sun = SunModel::Disc(DiscRule::G7);
            let k = Spectrum::new(vec![0.9, 1.1, 1.9, 2.1], vec![1.0, 1.0, 0.5, 0.5], Extend::Error).unwrap();
            let [rho0, g, h] = [0.05, 0.0, 1.0].map(Spectrum::constant);
            parts.surface.materials[0].photometry = Photometry::Rpv(Box::new(Rpv::from([rho0, k, g, h])));
        });
        let (_, seen) = study::simulate(&lit, &unwatched).unwrap();
        let bound = left_of_the_sun(&lit);
        for (band, exponent) in exponents.into_iter().enumerate() {
            let brdf = Shape::Rpv { exponent, asymmetry: 0.0, hot_spot: 1.0 }.brdf(0.05);
            let of = |direction: DVec3| f(&brdf, direction, view);
            let (_, sum) = over_sphere(1.5 * AU_M * sun, SUN_RADIUS_M, DVec3::Z, None, of);
            let expected = sum / sun_rad.sin().powi(2) * 700.0 / 2.25;
            let error = (seen.cube.band(band)[0] / expected - 1.0).abs();
            assert!(error <= bound.most().max(1e-5), "{radii} {exponent}: {error} {bound:?}");
            if exponent == 0.5 && radii < 1.0 {
                assert!(error > 1e-3, "{radii}: {error} shows nothing");
            }
        }
        assert!(radii < 50.0 || bound.lit < 1e-3, "{radii}: {bound:?}");
    }
}
