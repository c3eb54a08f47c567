//! The heat of Mars as light on the surface: the form factor of a uniform sphere, and black bodies.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::progress::unwatched;
use mmxrt::scene::{MarsModel, Scene, Thermal};
use mmxrt::spectral::{Band, Light, Spectrum};
use mmxrt::study;

use crate::scenes::{edited, mars, scene};
use crate::shapes::{nadir, plane};

/// Level ground below Mars, which is black, at this tilt from the zenith; the Sun is behind Mars, or behind the ground.
fn ground(tilt_deg: f64, is_day: bool) -> Scene {
    let (sin, cos) = tilt_deg.to_radians().sin_cos();
    let towards = DVec3::new(sin, 0.0, cos);
    let sun = if is_day { -towards } else { towards };
    let bare = scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 2), sun.to_array());
    edited(&bare, |parts| {
        let mut mars = mars(9_376_000.0 * towards);
        mars.reflectance = Spectrum::constant(0.0);
        parts.sky.mars = Some(mars);
        // The Sun is dark, too.
        parts.sky.sun.irradiance_1au = Spectrum::constant(0.0);
        parts.exposure.bands = [2.0, 3.6, 5.0].map(|um| Band::new(um, None)).to_vec();
        parts.models.thermal = Thermal::Off;
        parts.models.mars_heat = true;
    })
}

/// Planck's radiance, W m-2 sr-1 um-1, written out.
fn planck(um: f64, t_k: f64) -> f64 {
    1.191_042_972e8 / um.powi(5) / (1.438_776_877e4 / (um * t_k)).exp_m1()
}

fn cube(scene: &Scene) -> Vec<f64> {
    let (_, seen) = study::simulate(scene, &unwatched).unwrap();
    (0..scene.exposure.bands.len()).map(|band| seen.cube.band(band)[0]).collect()
}

#[test]
fn ground_reflects_the_heat_of_mars() {
    // Form factors of a sphere of R = 3389.5 at D = 9376: computed independently.
    for (tilt_deg, form_factor) in
        [(0.0, 0.130_688_110_561), (60.0, 0.065_344_055_280), (80.0, 0.024_998_656_879), (105.0, 0.000_546_496_153)]
    {
        for (is_day, t_k) in [(true, 270.0), (false, 200.0)] {
            let lit = ground(tilt_deg, is_day);
            for (band, got) in lit.exposure.bands.iter().zip(cube(&lit)) {
                let expected = 0.07 / PI * PI * form_factor * planck(band.centre_um, t_k);
                assert!(
                    (got / expected - 1.0).abs() < 3e-6,
                    "{tilt_deg} {is_day} {}: {got} {expected}",
                    band.centre_um
                );
            }
        }
    }
    // Stated temperatures; half a Mars has both.
    let warm = edited(&ground(0.0, true), |parts| parts.sky.mars.as_mut().unwrap().day_night_k = [300.0, 100.0]);
    assert!((cube(&warm)[1] / (0.07 * 0.130_688_110_561 * planck(3.6, 300.0)) - 1.0).abs() < 3e-6);
    let half = edited(&warm, |parts| parts.sky.sun.direction = crate::shapes::direction([1.0, 0.0, 0.0]));
    let share = cube(&half)[1] / cube(&warm)[1];
    // Seen from near at hand, the terminator of a half Mars is beyond the middle of its disc.
    assert!(share > 0.3 && share < 0.5, "{share}");
}

#[test]
fn it_is_only_in_bands_of_heat_and_sunlight_and_only_if_asked_for() {
    let lit = ground(0.0, true);
    let without = edited(&lit, |parts| parts.models.mars_heat = false);
    assert_eq!(cube(&without), [0.0; 3]);
    let sunlight = edited(&lit, |parts| parts.exposure.bands[1].light = Light::Sunlight);
    let (got, all) = (cube(&sunlight), cube(&lit));
    assert!(got[1] == 0.0 && got[0] == all[0] && got[2] == all[2]);
    assert_ne!(study::table_id(&lit), study::table_id(&without));
    // A table without it is told.
    let (table, _) = study::simulate(&without, &unwatched).unwrap();
    let error = study::observe(&lit, &table, Default::default(), &unwatched).unwrap_err().to_string();
    assert!(error.contains("mars-heat_irradiance: has 0 values"), "{error}");
    let thesis = edited(&lit, |parts| parts.models.mars_light = MarsModel::Thesis);
    assert_eq!(cube(&thesis), all);
}
