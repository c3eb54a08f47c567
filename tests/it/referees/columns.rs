//! Temperatures of ground that stores heat: by heat1d, and by Crank and Nicolson's method where shadows move.

use std::f64::consts::{PI, TAU};

use mmxrt::geometry::Mesh;
use mmxrt::scene::{Rotation, SceneParts};
use serde_json::json;

use super::{HEAT1D, answer, python_with};
use crate::conduction::{DAY_S, SIGMA, ground, temperatures_k};
use crate::scratch::{Scratch, is_heavy};
use crate::shapes::*;

/// Sunlight normal to its beam, W m-2, where [`ground`] is.
fn sunlight_w_m2() -> f64 {
    1361.0 / 1.523_679_f64.powi(2)
}

/// Level ground at a latitude, under a Sun at a declination, so many degrees of rotation after noon.
fn at_latitude(latitude_deg: f64, declination_deg: f64, after_noon_deg: f64, inertia: f64, steps: u32) -> SceneParts {
    let [latitude, declination, hour] = [latitude_deg, declination_deg, after_noon_deg].map(f64::to_radians);
    let (axis, south) = ([0.0, latitude.cos(), latitude.sin()], [0.0, -latitude.sin(), latitude.cos()]);
    let towards: [f64; 3] = std::array::from_fn(|k| {
        let west = [-1.0, 0.0, 0.0][k];
        declination.cos() * (hour.cos() * south[k] + hour.sin() * west) + declination.sin() * axis[k]
    });
    let mut parts = ground(plane(10.0, 0.0), 0.0, inertia, steps);
    parts.sky.sun.direction = direction(towards);
    parts.sky.rotation = Some(Rotation { axis: direction(axis), period_s: DAY_S });
    parts
}

/// heat1d steps explicitly, by half of what is stable, on layers that we tell it to make equal: its flux into the ground is by a formula for equal ones.
#[test]
fn heat1d_has_the_same_days() {
    let Some(python) = python_with(HEAT1D) else { return };
    let (layers, days) = if is_heavy() { (20, 60) } else { (10, 40) };
    let hours = [0.0, 3.0, 6.0, 9.0, 12.0, 15.0, 18.0, 21.0];
    let mut cases = vec![];
    for (latitude, declination) in [(0.0, 0.0), (45.0, 0.0), (45.0, 20.0)] {
        cases.extend([20.0, 50.0, 200.0].map(|inertia| (latitude, declination, inertia)));
    }
    let told = |(latitude, declination, inertia): &(f64, f64, f64)| {
        json!({
            "inertia": inertia, "latitude_deg": latitude, "declination_deg": declination, "irradiance_w_m2": sunlight_w_m2(),
            "albedo": 0.03, "emissivity": 0.95, "period_s": DAY_S, "layers": layers, "growth": 1e9, "depths": 6, "days": days, "hours": hours,
        })
    };
    let scratch = Scratch::new();
    scratch.write("column.json", json!(cases.iter().map(told).collect::<Vec<_>>()).to_string());
    let theirs = answer(&python, "column.py", &scratch, "temperatures.f64");
    assert_eq!(theirs.len(), cases.len() * hours.len());
    for ((latitude, declination, inertia), theirs) in cases.into_iter().zip(theirs.chunks(hours.len())) {
        let off = hours.iter().zip(theirs).map(|(hour, theirs)| {
            let scene = at_latitude(latitude, declination, 15.0 * hour, inertia, 480).check().unwrap();
            temperatures_k(&scene)[0] - theirs
        });
        let off: Vec<f64> = off.collect();
        println!("latitude {latitude}, Sun at {declination}, inertia {inertia}: {off:.3?} K of {theirs:.1?}");
        let most = off.iter().fold(0.0, |most, off| f64::max(most, off.abs()));
        assert!(most < if is_heavy() { 0.15 } else { 0.4 }, "{latitude} {declination} {inertia}: {off:?}");
    }
}

/// A day by Crank and Nicolson's method on equal layers; of what is absorbed at an angle after noon, -pi to pi; the surface's temperature at one.
fn crank_nicolson_k(absorbed_w_m2: impl Fn(f64) -> f64, inertia: f64, at: f64) -> f64 {
    // Depth in units of sqrt(k / (omega rho c)), time in radians of rotation.
    let (steps, h, nodes, days) = if is_heavy() { (14_400, 0.025, 320, 40) } else { (3600, 0.04, 200, 25) };
    let dt = TAU / f64::from(steps);
    let conductance = inertia * (TAU / DAY_S).sqrt();
    let r = 0.5 * dt / (h * h);
    let wrapped = |time: f64| if time > PI { time - TAU } else { time };
    let mean = (0..steps).map(|i| absorbed_w_m2(wrapped(f64::from(i) * dt))).sum::<f64>() / f64::from(steps);
    let mut t = vec![0.95 * (mean / (0.95 * SIGMA)).sqrt().sqrt(); nodes];
    // The elimination of all but the surface is the same at every step: from the bottom, t[k] = a[k] t[k - 1] + b[k].
    let mut a = vec![0.0; nodes];
    a[nodes - 1] = 2.0 * r / (1.0 + 2.0 * r);
    (1..nodes - 1).rev().for_each(|k| a[k] = r / (1.0 + 2.0 * r - r * a[k + 1]));
    let mut b = vec![0.0; nodes];
    let net = |absorbed: f64, t: f64| (absorbed - 0.95 * SIGMA * t.powi(4)) / conductance;
    let last = days * steps + (at.rem_euclid(TAU) / dt).round() as i32;
    let mut before = absorbed_w_m2(0.0);
    for i in 1..=last {
        let now = absorbed_w_m2(wrapped(f64::from(i % steps) * dt));
        let below = |k: usize| if k + 1 < nodes { t[k + 1] } else { t[k - 1] };
        b[nodes - 1] = (t[nodes - 1] + r * (t[nodes - 2] - 2.0 * t[nodes - 1] + below(nodes - 1))) / (1.0 + 2.0 * r);
        for k in (1..nodes - 1).rev() {
            let right = t[k] + r * (t[k - 1] - 2.0 * t[k] + t[k + 1]);
            b[k] = (right + r * b[k + 1]) / (1.0 + 2.0 * r - r * a[k + 1]);
        }
        // The surface's half layer, by Newton's method.
        let right = t[0] + 2.0 * r * (t[1] - t[0]) + dt / h * net(before, t[0]);
        let mut x = t[0];
        for _ in 0..8 {
            let value = x - 2.0 * r * (a[1] * x + b[1] - x) - dt / h * net(now, x) - right;
            x -= value / (1.0 + 2.0 * r * (1.0 - a[1]) + dt / h * 4.0 * 0.95 * SIGMA * x.powi(3) / conductance);
        }
        t[0] = x;
        (1..nodes).for_each(|k| t[k] = a[k] * t[k - 1] + b[k]);
        before = now;
    }
    t[0]
}

/// A long beam overhead, or a wall in the East or West: at x the Sun is hidden while its tangent after noon is within limits.
#[test]
fn shadows_that_move_leave_what_crank_and_nicolson_say() {
    let strip = |x: f64| quad([x - 0.01, -1.0, 0.0], [x + 0.01, -1.0, 0.0], [x + 0.01, 1.0, 0.0], [x - 0.01, 1.0, 0.0]);
    let long = |low: [f64; 2], high: [f64; 2]| cuboid([low[0], -500.0, low[1]], [high[0], 500.0, high[1]]);
    // The Sun is towards (-tan, 1) in (x, z): a point (x', z') hides it at (x - x') / z'.
    let cases: [(&str, Mesh, f64, [f64; 2]); 4] = [
        ("a wall in the West", long([-1.0, -1.0], [0.0, 3.0]), 2.0, [2.0 / 3.0, f64::INFINITY]),
        ("a wall in the East", long([0.0, -1.0], [1.0, 3.0]), -2.0, [f64::NEG_INFINITY, -2.0 / 3.0]),
        ("a beam, past", long([-1.0, 3.0], [1.0, 4.0]), 2.0, [0.25, 1.0]),
        ("a beam at noon", long([-1.0, 3.0], [1.0, 4.0]), 0.0, [-1.0 / 3.0, 1.0 / 3.0]),
    ];
    let mut most = [0.0_f64; 2];
    for (name, body, x, [from, to]) in cases {
        for (inertia, after_noon_deg) in [(20.0, 50.0), (50.0, 10.0), (50.0, 200.0), (200.0, -50.0)] {
            let absorbed = |time: f64| {
                let is_hidden = time.abs() >= 0.5 * PI || (from..=to).contains(&time.tan());
                if is_hidden { 0.0 } else { 0.97 * sunlight_w_m2() * time.cos() }
            };
            let expected_k = crank_nicolson_k(absorbed, inertia, f64::to_radians(after_noon_deg));
            let off = [240, 960].map(|steps| {
                let scene = ground(joined(&[strip(x), body.clone()]), after_noon_deg, inertia, steps).check().unwrap();
                temperatures_k(&scene)[0] - expected_k
            });
            println!("{name}, inertia {inertia}, {after_noon_deg} deg: {off:.3?} K of {expected_k:.2}");
            (0..2).for_each(|i| most[i] = most[i].max(off[i].abs()));
        }
    }
    // Not of second order as the rest: a shadow's edge falls on a step. It is worst where one has just passed.
    assert!(most[0] < 1.2 && most[1] < 0.4 && most[1] < 0.5 * most[0], "{most:?}");
}
