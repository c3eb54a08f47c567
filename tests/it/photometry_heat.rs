//! Heat of surfaces with a model: what they do not reflect from a direction they emit there, and what they do not reflect of sunlight warms them.

use mmxrt::physics::blackbody;
use mmxrt::physics::reflectance::albedo::Measure;
use mmxrt::physics::reflectance::hapke::{Parameters, Roughness, Surge};
use mmxrt::physics::reflectance::{PhaseFunction, Shape};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Beam, Globe, Model, Photometry, Scene, Thermal};
use mmxrt::spectral::{Band, Extend, Light, Spectrum};
use mmxrt::study;

use crate::scenes::{edited, mars, scene};
use crate::shapes::*;

const DARK: Shape = Shape::LommelSeeliger(PhaseFunction::Isotropic);
const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// A warm plane, lit from this incidence and seen from this emission, deg, in bands of heat alone.
fn warm(shape: Shape, albedo: &Spectrum, [incidence, emission]: [f64; 2], bands_um: &[f64]) -> Scene {
    let (sin, cos) = emission.to_radians().sin_cos();
    let view = camera([1000.0 * sin + 0.3, 0.1, 1000.0 * cos], [0.3, 0.1, 0.0], [0.1, 0.9, 0.2], 1, 1e-6);
    let (sin, cos) = incidence.to_radians().sin_cos();
    edited(&scene(plane(50.0, 0.0), view, [0.0, sin, cos]), |parts| {
        let model = Model { shape, albedo: albedo.clone(), preset: None };
        let material = &mut parts.surface.materials[0];
        material.reflectance = model.hemispherical();
        material.emissivity = material.reflectance.map(|r| 1.0 - r);
        material.bond_albedo = material.reflectance.value()[0];
        material.photometry = Photometry::Model(Box::new(model));
        parts.models.thermal = Thermal::Equilibrium;
        parts.exposure.bands = bands_um.iter().map(|um| Band { light: Light::Heat, ..Band::new(*um, None) }).collect();
    })
}

fn close(got: f64, expected: f64, relative: f64) {
    assert!((got / expected - 1.0).abs() < relative, "{got} {expected}: {:e}", got / expected - 1.0);
}

/// Directional albedo of Lommel and Seeliger's surface: (w / 2) (1 - mu ln(1 + 1 / mu)).
fn dark_albedo(w: f64, mu: f64) -> f64 {
    0.5 * w * (1.0 - mu * f64::ln_1p(1.0 / mu))
}

#[test]
fn sunlight_is_absorbed_by_incidence() {
    for incidence in [0.0, 60.0, 85.0f64] {
        let lit = warm(DARK, &Spectrum::constant(0.8), [incidence, 20.0], &[10.0]);
        // The spherical albedo is 0.2046 w.
        close(lit.body.materials[0].bond_albedo, 0.8 * 0.204_568_546_293_369_8, 1e-7);
        let (table, _) = study::simulate(&lit, &unwatched).unwrap();
        let mu0 = incidence.to_radians().cos();
        let absorbed = (1.0 - dark_albedo(0.8, mu0)) * 1361.0 / 2.25 * mu0;
        close(table.temperature_lit_k[0], (absorbed / (0.95 * STEFAN_BOLTZMANN)).powf(0.25), 1e-6);
    }
}

#[test]
fn other_light_is_absorbed_by_its_incidence_too() {
    // The Sun is below the horizon, and there is no heat from Mars.
    let night = warm(DARK, &Spectrum::constant(0.8), [120.0, 20.0], &[10.0]);
    let (sin, cos) = 70f64.to_radians().sin_cos();
    let beam = edited(&night, |parts| {
        parts.sky.beams = vec![Beam {
            name: "second".into(),
            direction: direction([sin, 0.0, cos]),
            irradiance: Spectrum::constant(1.0),
            total_irradiance_w_m2: 300.0,
        }];
    });
    let t_k = |scene: &Scene| study::simulate(scene, &unwatched).unwrap().0.temperature_shaded_k[0];
    let absorbed = (1.0 - dark_albedo(0.8, cos)) * 300.0 * cos;
    close(t_k(&beam), (absorbed / (0.95 * STEFAN_BOLTZMANN)).powf(0.25), 1e-6);
    // Mars, all of it above the horizon, its middle 50 deg from the zenith.
    let (sin, cos) = 50f64.to_radians().sin_cos();
    let by_mars = |scene: &Scene| {
        t_k(&edited(scene, |parts| {
            let centre_m = 9.4e6 * glam::DVec3::new(sin, 0.0, cos);
            parts.sky.mars = Some(Globe { thermal_exitance_w_m2: 0.0, ..mars(centre_m) });
        }))
    };
    let lambert = edited(&night, |parts| parts.surface.materials[0].photometry = Photometry::Lambert);
    let centre_m = 9.4e6 * glam::DVec3::new(sin, 0.0, cos);
    let sun = Some(night.sky.sun.direction.vec());
    let absorbed = |direction: glam::DVec3| 1.0 - dark_albedo(0.8, direction.z);
    let (light, sum) = crate::mars_models::over_sphere(centre_m, 3_389_500.0, glam::DVec3::Z, sun, absorbed);
    let expected = sum / light / (1.0 - night.body.materials[0].bond_albedo);
    close((by_mars(&night) / by_mars(&lambert)).powi(4), expected, 3e-3);
}

#[test]
fn heat_is_emitted_by_direction() {
    let rising = Spectrum::new(vec![5.0, 20.0], vec![0.5, 0.9], Extend::Error).unwrap();
    // One band has a row; ten share temperatures.
    let many: Vec<f64> = (0..10).map(|i| 6.0 + f64::from(i)).collect();
    for bands in [&[8.0][..], &many] {
        for emission in [0.0, 50.0, 80.0f64] {
            let lit = warm(DARK, &rising, [30.0, emission], bands);
            let (table, seen) = study::simulate(&lit, &unwatched).unwrap();
            let t_k = table.temperature_lit_k[0];
            for (band, um) in bands.iter().enumerate() {
                let w = 0.5 + 0.4 * (um - 5.0) / 15.0;
                let emissivity = 1.0 - dark_albedo(w, emission.to_radians().cos());
                close(seen.cube.band(band)[0], emissivity * blackbody::radiance_w_m2_sr_um(*um, t_k), 1e-6);
            }
        }
    }
}

#[test]
fn a_rough_surface_emits_what_it_does_not_reflect() {
    let shape = Shape::Hapke(Parameters {
        phase: PhaseFunction::HenyeyGreenstein { b: -0.25 },
        shadow_hiding: Surge { amplitude: 2.28, width: 0.0573 },
        roughness: Roughness::of_mean_slope(24f64.to_radians()),
        ..Parameters::PLAIN
    });
    let rising = Spectrum::new(vec![5.0, 20.0], vec![0.1, 0.6], Extend::Error).unwrap();
    let bands = [6.0, 7.0, 8.0, 9.0, 11.0, 12.0, 13.0];
    let lit = warm(shape, &rising, [30.0, 65.0], &bands);
    let (table, seen) = study::simulate(&lit, &unwatched).unwrap();
    for (band, um) in bands.into_iter().enumerate() {
        let measure = Measure::DirectionalHemispherical { cos_incidence: 65f64.to_radians().cos() };
        let emissivity = 1.0 - measure.of(&shape.brdf(rising.at(um).unwrap()));
        let black = blackbody::radiance_w_m2_sr_um(um, table.temperature_lit_k[0]);
        close(seen.cube.band(band)[0], emissivity * black, 3e-5);
    }
}

#[test]
fn an_emissivity_that_is_given_holds_in_all_directions() {
    let lit = warm(DARK, &Spectrum::constant(0.8), [30.0, 80.0], &[10.0]);
    let given = edited(&lit, |parts| parts.surface.materials[0].emissivity = Spectrum::constant(0.9));
    let (table, seen) = study::simulate(&given, &unwatched).unwrap();
    close(seen.cube.band(0)[0], 0.9 * blackbody::radiance_w_m2_sr_um(10.0, table.temperature_lit_k[0]), 1e-9);
}
