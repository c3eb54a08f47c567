//! Bodies of the sky besides Mars: what they send is that of a Lambert sphere under its own Sun, and plans drop those that send nothing.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Globe, Scene, Thermal};
use mmxrt::spectral::{Band, Spectrum};
use mmxrt::study::{self, Choice, Decision, Extremes, Request};
use mmxrt::units::AU_M;

use crate::scenes::{edited, mars, scene};
use crate::shapes::{nadir, plane};

const EARTH_M: f64 = 6_371_000.0;

fn body(name: &str, centre_m: DVec3, radius_m: f64) -> Globe {
    let albedo = Spectrum::constant(0.3);
    Globe {
        name: name.into(),
        centre_m,
        radius_m,
        reflectance: albedo,
        bond_albedo: 0.3,
        thermal_exitance_w_m2: 0.0,
        day_night_k: [0.0; 2],
    }
}

/// Level ground under a Sun below its horizon, 1.5 au away in this direction.
fn ground(towards_sun: DVec3) -> Scene {
    scene(plane(5.0, 0.0), nadir(1000.0, 8.0, 2), towards_sun.to_array())
}

fn radiance(scene: &Scene) -> f64 {
    study::simulate(scene, &unwatched).unwrap().1.cube.band(0)[0]
}

#[test]
fn another_body_in_the_place_of_mars_does_the_same() {
    for [x, y, z] in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.99, 0.0, 0.1], [0.0, 1.0, -0.1]] {
        let globe = mars(9_376_000.0 * DVec3::new(x, y, z).normalize());
        let base = edited(&ground(DVec3::new(0.5, 0.5, -0.7)), |parts| {
            parts.exposure.bands = [1.0, 4.0].map(|um| Band::new(um, None)).to_vec();
            parts.models.thermal = Thermal::Equilibrium;
            parts.models.mars_heat = true;
        });
        let as_mars = edited(&base, |parts| parts.sky.mars = Some(globe.clone()));
        let as_body = edited(&base, |parts| parts.sky.bodies = vec![Globe { name: "ares".into(), ..globe }]);
        let [a, b] = [&as_mars, &as_body].map(|scene| study::simulate(scene, &unwatched).unwrap().1);
        for band in 0..2 {
            let (a, b) = (a.cube.band(band)[0], b.cube.band(band)[0]);
            assert!(a > 0.0 && (b / a - 1.0).abs() < 1e-12, "{x} {y} {z}: {a} {b}");
        }
    }
}

#[test]
fn a_distant_body_has_its_own_sunlight() {
    // The Sun 1.5 au below the ground's horizon; the Earth 1 au from it, and some 1.8 au from the scene, above.
    let to_sun = DVec3::new(0.95, 0.0, -0.31).normalize();
    let sun_m = 1.5 * AU_M * to_sun;
    for off in [DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 0.6, 0.8)] {
        let centre_m = sun_m + 1.0 * AU_M * off;
        let distance_m = centre_m.length();
        let globe = body("earth", centre_m, 1e-5 * distance_m);
        let lit = edited(&ground(to_sun), |parts| parts.sky.bodies = vec![globe]);
        // Lambert sphere: 2/3 of the geometric cross section, times its phase law; the Sun 2.25 times as strong as at the scene.
        let cos_phase = off.dot(centre_m) / distance_m;
        let phase = cos_phase.clamp(-1.0, 1.0).acos();
        let law = (phase.sin() + (PI - phase) * phase.cos()) / PI;
        let cos = centre_m.z / distance_m;
        assert!(cos > 0.05);
        let sunlight = 700.0;
        let expected = 0.07 / PI * sunlight * 0.3 * 2.0 / 3.0 * 1e-10 * law * cos;
        let got = radiance(&lit);
        // The middle of its light is off its centre by less than its radius of 1e-5.
        assert!((got / expected - 1.0).abs() < 2e-4, "{off}: {got} {expected}");
    }
}

#[test]
fn a_plan_keeps_a_moon_near_at_hand_and_drops_the_earth() {
    let planned = |bodies: Vec<Globe>, tolerance: f64| {
        let base = edited(&ground(DVec3::new(0.6, 0.0, 0.8)), |parts| parts.sky.bodies = bodies);
        let extremes = Extremes::new(&base);
        let (models, plan) = study::plan(&base, &extremes, &Request { choice: Choice::Auto, tolerance }).unwrap();
        let row = plan.effects.iter().find(|effect| effect.key == "bodies").unwrap().clone();
        (base.by(models).unwrap(), row)
    };
    let earth = || body("earth", DVec3::new(0.3, 0.0, 1.2) * AU_M, EARTH_M);
    let (alone, row) = planned(vec![earth()], 1e-3);
    assert_eq!(row.decision, Decision::Dropped);
    assert!(row.bound.unwrap().most() < 1e-6 && alone.lighting_bodies().is_empty(), "{row:?}");
    // As large in the sky as Mars is, and then one that is smaller.
    let moon = |sin_radius: f64| body("moon", DVec3::new(0.0, 0.0, 1e6), sin_radius * 1e6);
    let (both, row) = planned(vec![earth(), moon(0.3)], 1e-3);
    assert_eq!(row.decision, Decision::Kept);
    assert_eq!(both.lighting_bodies().iter().map(|globe| globe.name.as_str()).collect::<Vec<_>>(), ["moon"]);
    assert!(row.remaining.unwrap().most() < 1e-3 && row.because.contains("earth"), "{row:?}");
    let (none, row) = planned(vec![earth(), moon(0.003)], 1e-2);
    assert!(none.lighting_bodies().is_empty() && row.decision == Decision::Dropped, "{row:?}");
    let (_, row) = planned(vec![], 1e-3);
    assert_eq!((row.decision, row.bound.unwrap().most()), (Decision::Dropped, 0.0));
}

#[test]
fn names_of_bodies_are_their_own() {
    let refused = |bodies: Vec<Globe>| {
        let mut parts = ground(DVec3::Z).into_parts();
        parts.sky.bodies = bodies;
        parts.check().unwrap_err().to_string()
    };
    let at = DVec3::new(0.0, 0.0, 1e9);
    for names in [&["sun"][..], &["mars"], &["mars-heat"], &["a", "a"], &["a", "a-heat"], &["a b"], &[""]] {
        let message = refused(names.iter().map(|name| body(name, at, 1e6)).collect());
        assert!(message.contains("name"), "{names:?}: {message}");
    }
    assert!(refused(vec![body("a", at, 1e9)]).contains("the scene lies inside a"));
    assert!(refused(vec![body("a", at, -1.0)]).contains("not a positive length"));
}

#[test]
fn any_body_may_hide_the_sun() {
    let to_sun = DVec3::new(0.0, 0.0, 1.0);
    // Half the Sun: a body with a straight edge through its middle, black.
    let radius_m = 1e6;
    let at = DVec3::new(radius_m, 0.0, 1e8);
    let dark = Globe { reflectance: Spectrum::constant(0.0), ..body("moon", at, radius_m) };
    let free = ground(to_sun);
    let hidden = edited(&free, |parts| {
        parts.sky.bodies = vec![dark];
        parts.models.eclipses = true;
    });
    let share = radiance(&hidden) / radiance(&free);
    // A body three times as wide as the Sun: less than half is hidden, by a segment of known area.
    assert!(share > 0.5 && share < 0.6, "{share}");
    let away = edited(&hidden, |parts| parts.sky.bodies[0].centre_m.x *= 2.0);
    assert_eq!(radiance(&away), radiance(&free));
    // One beyond the Sun does not.
    let beyond = edited(&hidden, |parts| {
        parts.sky.bodies[0].centre_m = DVec3::new(0.0, 0.0, 3.0 * AU_M);
        parts.sky.bodies[0].radius_m = 1e10;
    });
    assert_eq!(radiance(&beyond), radiance(&free));
}
