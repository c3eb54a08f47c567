//! Heat conduction in fewer and fewer steps a day.

use std::f64::consts::TAU;

use super::{Hazard, Point, Sweep};
use crate::error::Result;
use crate::physics::conduction::Ground;

/// Phobos: a day, and what a surface at the equator absorbs at noon at 1.52 au.
const PERIOD_S: f64 = 27_553.8;
const NOON_W_M2: f64 = 545.0;
/// Steps of the solution that counts as true: some 7 times nearer than a quarter as many, at sunset, where it is farthest off.
const TRUE_STEPS: usize = 11_520;

fn absorbed_w_m2(steps: usize) -> Vec<f64> {
    (0..steps).map(|i| NOON_W_M2 * (TAU * i as f64 / steps as f64).cos().max(0.0)).collect()
}

pub(super) fn hazard() -> Result<Hazard> {
    let ground = |thermal_inertia: f64| Ground { thermal_inertia, emissivity_bolometric: 0.95, period_s: PERIOD_S };
    let steps = [2880, 1440, 720, 360, 180, 96, 48, 24, 12, 6];
    let sweep = |method, is_ours, then, true_inertia: f64, inertia: f64| {
        let truth = ground(true_inertia).periodic_temperature_k(&absorbed_w_m2(TRUE_STEPS));
        let point = |steps: &usize| {
            let found = ground(inertia).periodic_temperature_k(&absorbed_w_m2(*steps));
            let off = |(i, t_k): (usize, &f64)| (t_k / truth[i * TRUE_STEPS / steps] - 1.0).abs();
            Point { at: *steps as f64, error: found.iter().enumerate().map(off).fold(0.0, f64::max) }
        };
        Sweep { method, is_ours, then, points: steps.iter().map(point).collect() }
    };
    Ok(Hazard {
        name: "steps of heat conduction",
        parameter: "steps a day",
        truth: "Temperature of level ground at Phobos's equator over a day, against 11520 steps; largest relative error (1e-3 is 0.2 to 0.3 K).",
        sweeps: vec![
            sweep(
                "conduction, inertia 50",
                true,
                "Worst at sunset, where errors fall by 2.7 for twice as many steps. Their number is a choice, not a limit.",
                50.0,
                50.0,
            ),
            sweep("conduction, inertia 10", true, "Faster changes at sunset need more steps.", 10.0, 10.0),
            sweep(
                "equilibrium, where inertia is 50",
                false,
                "Nights without stored heat are at 0 K: not an error of steps.",
                50.0,
                0.0,
            ),
        ],
    })
}
