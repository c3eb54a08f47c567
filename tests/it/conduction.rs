//! Ground that stores heat: temperatures over a day, and in shadows that move, against other methods.

use std::f64::consts::PI;

use glam::DVec3;
use mmxrt::geometry::{Direction, Mesh};
use mmxrt::progress::unwatched;
use mmxrt::scene::{Rotation, Scene, SceneParts, Thermal};
use mmxrt::{Error, solve};

use crate::scenes::parts;
use crate::shapes::*;

pub(crate) const DAY_S: f64 = 27_553.843_872;
pub(crate) const SIGMA: f64 = 5.670_374_419e-8;

/// Level ground on the equator, which turns eastwards, towards +x, under a Sun in the plane of the equator; A 0.03, eps 0.95, 1.523679 au.
pub(crate) fn ground(mesh: Mesh, sun_deg_after_noon: f64, thermal_inertia: f64, steps: u32) -> SceneParts {
    let after_noon = sun_deg_after_noon.to_radians();
    let towards = direction([-after_noon.sin(), 0.0, after_noon.cos()]);
    let mut parts = parts(mesh, nadir(1000.0, 10.0, 4), towards);
    parts.sky.sun.distance_m = 1.523_679 * mmxrt::units::AU_M;
    parts.sky.sun.total_irradiance_1au_w_m2 = 1361.0;
    parts.sky.rotation = Some(Rotation { axis: direction([0.0, 1.0, 0.0]), period_s: DAY_S });
    parts.surface.materials[0].bond_albedo = 0.03;
    parts.surface.materials[0].thermal_inertia = thermal_inertia;
    parts.models.thermal = Thermal::Equilibrium;
    parts.models.conduction = Some(steps);
    parts
}

pub(crate) fn temperatures_k(scene: &Scene) -> Vec<f64> {
    let table = solve::solve(scene, &unwatched).unwrap();
    assert_eq!(table.temperature_lit_k, table.temperature_shaded_k);
    table.temperature_lit_k
}

/// Periodic solutions by harmonic balance, computed independently (TSI 1361 W m-2 at 1 au; no Mars).
#[test]
fn a_days_temperatures_are_those_of_harmonic_balance() {
    let mut seen = 0;
    for (inertia, noon_k, sunset_k, midnight_k) in
        [(20.0, 316.876, 175.135, 130.203), (50.0, 311.915, 200.263, 157.109), (200.0, 290.748, 233.529, 199.379)]
    {
        for (after_noon_deg, expected_k) in [(0.0, noon_k), (90.0, sunset_k), (180.0, midnight_k)] {
            let errors: Vec<f64> = [96, 384]
                .map(|steps| {
                    let scene = ground(plane(10.0, 0.0), after_noon_deg, inertia, steps).check().unwrap();
                    temperatures_k(&scene).into_iter().map(|t_k| (t_k - expected_k).abs()).fold(0.0, f64::max)
                })
                .into();
            assert!(errors[0] < 0.7 && errors[1] < 0.1, "{inertia} {after_noon_deg}: {errors:?}");
            seen += 1;
        }
    }
    assert_eq!(seen, 9);
}

/// Another method for the same column: explicit, 2000 steps a day, nodes of a twentieth of the skin depth, 60 days; of what it absorbs by time of day,
/// 0 to 1 from noon.
pub(crate) fn explicit_k(absorbed_w_m2: impl Fn(f64) -> f64, thermal_inertia: f64, at: f64) -> f64 {
    // Depth in units of sqrt(kappa P), where conductivity over that length is the inertia over sqrt(P).
    let (steps, h, nodes) = (4000, 0.0282, 120);
    let step = 1.0 / f64::from(steps);
    let conductance = thermal_inertia / DAY_S.sqrt();
    let mut t_k: Vec<f64> = vec![215.0; nodes];
    let days = 60;
    for i in 0..days * steps + (at * f64::from(steps)).round() as i32 {
        let time = f64::from(i % steps) * step;
        let emitted = 0.95 * SIGMA * t_k[0].powi(4);
        let flux: Vec<f64> = t_k.windows(2).map(|pair| (pair[0] - pair[1]) / h).collect();
        t_k[0] += step / (0.5 * h) * ((absorbed_w_m2(time) - emitted) / conductance - flux[0]);
        for k in 1..nodes - 1 {
            t_k[k] += step / h * (flux[k - 1] - flux[k]);
        }
        t_k[nodes - 1] += step / (0.5 * h) * flux[nodes - 2];
    }
    t_k[0]
}

/// A wall to the West, 3 m high and far longer, takes the afternoon from the ground before it: at x from its foot the Sun is behind it from
/// atan(x / 3) after noon on. In that shadow the ground is still warm.
#[test]
fn a_fresh_shadow_is_warm() {
    let strip = |x: f64| quad([x, -1.0, 0.0], [x + 0.02, -1.0, 0.0], [x + 0.02, 1.0, 0.0], [x, 1.0, 0.0]);
    let wall = cuboid([-1.0, -500.0, -1.0], [0.0, 500.0, 3.0]);
    let mut seen = 0;
    for (x, after_noon_deg) in [(2.0, 45.0), (2.0, 60.0), (5.0, 60.0), (5.0, 70.0)] {
        let mesh = joined(&[strip(x - 0.01), wall.clone()]);
        let scene = ground(mesh, after_noon_deg, 50.0, 480).check().unwrap();
        let t_k = temperatures_k(&scene);
        let noon_w_m2 = 0.97 * 1361.0 / 1.523_679_f64.powi(2);
        let dark_from = (x / 3.0_f64).atan();
        let absorbed = |time: f64| {
            let after_noon = 2.0 * PI * if time > 0.5 { time - 1.0 } else { time };
            if after_noon < dark_from { noon_w_m2 * after_noon.cos().max(0.0) } else { 0.0 }
        };
        let expected_k = explicit_k(absorbed, 50.0, after_noon_deg / 360.0);
        // Equilibrium would be 0 K.
        assert!(expected_k > 180.0, "{expected_k}");
        assert!((t_k[0] - expected_k).abs() < 1.0, "{x} {after_noon_deg}: {} {expected_k}", t_k[0]);
        seen += 1;
    }
    assert_eq!(seen, 4);
}

#[test]
fn what_a_day_needs_is_asked_for() {
    let mut parts = ground(plane(10.0, 0.0), 0.0, 50.0, 96);
    parts.sky.rotation = None;
    let Err(Error::Invalid(problems)) = parts.check() else { panic!("no error") };
    assert!(problems.iter().any(|p| p.to_string().contains("period_s")), "{problems:?}");
    let parts = ground(plane(10.0, 0.0), 0.0, 50.0, 2);
    assert!(parts.check().is_err());
    let mut parts = ground(plane(10.0, 0.0), 0.0, -1.0, 96);
    parts.sky.rotation = Some(Rotation { axis: Direction::Z, period_s: f64::NAN });
    let Err(Error::Invalid(problems)) = parts.check() else { panic!("no error") };
    assert_eq!(problems.len(), 2, "{problems:?}");
    // Ground without inertia stays in equilibrium, its shadows cold.
    let scene = ground(plane(10.0, 0.0), 0.0, 0.0, 8).check().unwrap();
    let table = solve::solve(&scene, &unwatched).unwrap();
    assert!(table.temperature_shaded_k.iter().all(|t_k| *t_k == 0.0) && table.temperature_lit_k[0] > 300.0);
    assert_eq!(scene.sky.ago(DAY_S / 4.0).unwrap().sun.direction.vec().dot(DVec3::X).round(), 1.0);
}
