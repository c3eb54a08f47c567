//! Heat stored in the ground by day and released at night: one-dimensional conduction with constant properties.
//!
//! With tau = omega t and zeta = z sqrt(omega rho c / k) the equation is dT/dtau = d2T/dzeta2, and at the surface the ground enters only by its thermal
//! inertia I = sqrt(k rho c): absorbed + I sqrt(omega) dT/dzeta = eps sigma T^4.

use std::f64::consts::PI;

use super::heat::{emitted_w_m2, equilibrium_temperature_k};

/// Thermal inertia, J m-2 K-1 s-1/2, from cal cm-2 K-1 s-1/2: times 41840 (the thermochemical calorie is 4.184 J).
pub fn thermal_inertia_from_cgs(cal_cm2_k_s_half: f64) -> f64 {
    41_840.0 * cal_cm2_k_s_half
}

/// Depth at which a temperature wave of this period has 1/e of its surface amplitude, m: l = sqrt(kappa P / pi), kappa the diffusivity, m2 s-1.
///
/// Source: Carslaw & Jaeger (1959), sec. 2.6. At this depth it lags by 1 rad.
pub fn skin_depth_m(diffusivity_m2_s: f64, period_s: f64) -> f64 {
    (diffusivity_m2_s * period_s / PI).sqrt()
}

/// A temperature wave at a depth: its amplitude over that at the surface, exp(-z / l), and its lag, z / l rad.
pub fn wave_at_depth(depth_m: f64, diffusivity_m2_s: f64, period_s: f64) -> (f64, f64) {
    let depth = depth_m / skin_depth_m(diffusivity_m2_s, period_s);
    ((-depth).exp(), depth)
}

/// Rise of the surface temperature after a time of constant flux into the ground, K: 2 F sqrt(t / pi) / I. Source: Carslaw & Jaeger (1959), sec. 2.9.
pub fn rise_by_constant_flux_k(thermal_inertia: f64, flux_w_m2: f64, time_s: f64) -> f64 {
    2.0 * flux_w_m2 * (time_s / PI).sqrt() / thermal_inertia
}

/// Ground under a surface that radiates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Thermal inertia, J m-2 K-1 s-1/2; from 0, which is local equilibrium.
    pub thermal_inertia: f64,
    /// Emissivity over all wavelengths, above 0 to 1.
    pub emissivity_bolometric: f64,
    /// Period of the insolation, s.
    pub period_s: f64,
}

/// Layers' thickness at the surface, and from each to the next.
const FIRST_LAYER: f64 = 0.02;
const GROWTH: f64 = 1.1;
/// Depth of the ground, where a daily wave is exp(-10) of what it is at the surface.
const DEEPEST: f64 = 14.2;
/// Days until one is like the day before: some ten.
const MOST_DAYS: usize = 200;
const SETTLED_K: f64 = 1e-7;

impl Ground {
    /// Surface temperature, K, at even times of a period, of what the surface absorbs then, W m-2: sunlight and heat.
    ///
    /// The steps in time are those of the argument: for Phobos 48 are good to 1 K, 360 to 0.02 K (at sunset, which is worst). Second order in time
    /// (BDF2, which damps what it cannot resolve) and in depth, and conserves energy. Because properties are constant, the mean temperature over a
    /// day is the same at all depths; and what is emitted in a day is what is absorbed. The ground is corrected by both after each day, so that ten
    /// days do instead of hundreds.
    /// Source: Spencer, Lebofsky & Sykes (1989) for the equations. Limits: no heat from the deep; fewer than 3 times are equilibrium.
    pub fn periodic_temperature_k(&self, absorbed_w_m2: &[f64]) -> Vec<f64> {
        let one: Vec<[f64; 1]> = absorbed_w_m2.iter().map(|&q| [q]).collect();
        self.periodic_temperatures_k(&one).into_iter().map(|[t_k]| t_k).collect()
    }

    /// The same of N places at once, as fast as a processor computes so many numbers together.
    pub fn periodic_temperatures_k<const N: usize>(&self, absorbed_w_m2: &[[f64; N]]) -> Vec<[f64; N]> {
        let steps = absorbed_w_m2.len();
        let eps = self.emissivity_bolometric;
        let equilibrium = |q: &[f64; N]| q.map(|q| equilibrium_temperature_k(q, eps));
        let conductance = self.thermal_inertia * (2.0 * PI / self.period_s).sqrt();
        if steps < 3 || conductance <= 0.0 {
            return absorbed_w_m2.iter().map(equilibrium).collect();
        }
        let layers = Layers::new(2.0 * PI / steps as f64);
        let each = |of: &dyn Fn(usize) -> f64| -> [f64; N] { std::array::from_fn(of) };
        let mean_w_m2 = each(&|n| absorbed_w_m2.iter().map(|q| q[n]).sum::<f64>() / steps as f64);
        let start_k = equilibrium(&mean_w_m2);
        let mut now = vec![start_k; layers.count()];
        let mut before = now.clone();
        let mut next = now.clone();
        let mut mean = now.clone();
        let mut day = vec![start_k; steps];
        let radiated = emitted_w_m2(1.0, eps) / conductance;
        for _ in 0..MOST_DAYS {
            mean.fill([0.0; N]);
            let mut moved = 0.0_f64;
            for (last, absorbed) in day.iter_mut().zip(absorbed_w_m2) {
                layers.step((&now, &before), &mut next, &absorbed.map(|q| q / conductance), radiated);
                std::mem::swap(&mut before, &mut now);
                std::mem::swap(&mut now, &mut next);
                moved = (0..N).fold(moved, |moved, n| moved.max((now[0][n] - last[n]).abs()));
                *last = now[0];
                for (sum, t) in mean.iter_mut().zip(&now) {
                    for n in 0..N {
                        sum[n] += t[n] / steps as f64;
                    }
                }
            }
            if moved < SETTLED_K {
                break;
            }
            let warmer_k = each(&|n| {
                let emitted = day.iter().map(|t| emitted_w_m2(t[n], eps)).sum::<f64>() / steps as f64;
                if emitted > 0.0 { 0.25 * (mean_w_m2[n] / emitted - 1.0) * mean[0][n] } else { 0.0 }
            });
            for k in (0..layers.count()).rev() {
                for n in 0..N {
                    let set_k = mean[0][n] - mean[k][n] + warmer_k[n];
                    now[k][n] += set_k;
                    before[k][n] += set_k;
                }
            }
        }
        day
    }
}

/// Nodes in depth zeta, each with the ground half way to its neighbours, and one step in time, solved once for all steps.
struct Layers {
    /// Ground of each node, over 2/3 of a step.
    volume: Vec<f64>,
    /// 1 / distance to the node above; none of the first.
    up: Vec<f64>,
    /// Of each node: what remains on the diagonal when those below are eliminated.
    pivot: Vec<f64>,
}

impl Layers {
    fn new(step: f64) -> Self {
        let mut distances = vec![FIRST_LAYER];
        while distances.iter().sum::<f64>() < DEEPEST {
            distances.push(distances[distances.len() - 1] * GROWTH);
        }
        let count = distances.len() + 1;
        let distance = |k: usize| distances.get(k).copied().unwrap_or(0.0);
        let above = |k: usize| if k == 0 { 0.0 } else { distance(k - 1) };
        let volume: Vec<f64> = (0..count).map(|k| 0.5 * (above(k) + distance(k)) * 1.5 / step).collect();
        let up: Vec<f64> = (0..count).map(|k| if k == 0 { 0.0 } else { 1.0 / above(k) }).collect();
        let mut pivot = vec![0.0; count];
        for k in (0..count).rev() {
            let below = if k + 1 < count { up[k + 1] * (1.0 - up[k + 1] / pivot[k + 1]) } else { 0.0 };
            pivot[k] = volume[k] + up[k] + below;
        }
        Layers { volume, up, pivot }
    }

    fn count(&self) -> usize {
        self.volume.len()
    }

    /// Temperatures after a step, from those of the two times before it. Absorbed flux, and `radiated` T^4, in units of the conductance.
    fn step<const N: usize>(
        &self,
        (now, before): (&[[f64; N]], &[[f64; N]]),
        next: &mut [[f64; N]],
        absorbed: &[f64; N],
        radiated: f64,
    ) {
        let count = self.count();
        // First the right sides, from below upwards; then temperatures, downwards.
        let mut below = [0.0; N];
        for k in (0..count).rev() {
            let (volume, up) = (self.volume[k], self.up[k] / self.pivot[k]);
            for n in 0..N {
                let right = volume * (4.0 * now[k][n] - before[k][n]) / 3.0 + below[n];
                next[k][n] = right;
                below[n] = up * right;
            }
        }
        for n in 0..N {
            let right = next[0][n] + absorbed[n];
            next[0][n] = surface_temperature_k(self.pivot[0], radiated, right, now[0][n]);
        }
        for k in 1..count {
            let (up, pivot, above) = (self.up[k], self.pivot[k], next[k - 1]);
            for n in 0..N {
                next[k][n] = (next[k][n] + up * above[n]) / pivot;
            }
        }
    }
}

/// T from 0 of a T + b T^4 = c: Newton's method, which comes down to the root, as the left side is convex.
fn surface_temperature_k(a: f64, b: f64, c: f64, start_k: f64) -> f64 {
    if c <= 0.0 {
        return 0.0;
    }
    let mut t = start_k;
    for _ in 0..50 {
        let cube = b * t * t * t;
        let next = (c + 3.0 * cube * t) / (a + 4.0 * cube);
        if (next - t).abs() <= 1e-13 * next {
            return next;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{AU_M, TSI_1AU_W_M2};

    const PHOBOS_S: f64 = 27_553.843_872;

    /// What the equator of Phobos absorbs, noon first, W m-2.
    fn absorbed(steps: usize) -> Vec<f64> {
        let noon = 0.97 * crate::physics::sun::irradiance_at(TSI_1AU_W_M2, 1.523_679 * AU_M);
        (0..steps).map(|k| noon * (2.0 * PI * k as f64 / steps as f64).cos().max(0.0)).collect()
    }

    fn phobos(thermal_inertia: f64) -> Ground {
        Ground { thermal_inertia, emissivity_bolometric: 0.95, period_s: PHOBOS_S }
    }

    #[test]
    fn a_day_on_phobos() {
        // By harmonics, computed independently: inertia; noon, sunset, midnight, least, mean, K.
        for (inertia, expected) in [
            (20.0, [316.876_409, 175.134_716, 130.203_140, 120.135_149, 203.100_435]),
            (50.0, [311.915, 200.263, 157.109, 146.071, 215.130]),
            (200.0, [290.747_564, 233.529_272, 199.379_229, 188.598_391, 231.658_984]),
        ] {
            let day = phobos(inertia).periodic_temperature_k(&absorbed(720));
            let least = day.iter().copied().fold(f64::INFINITY, f64::min);
            let mean = day.iter().sum::<f64>() / 720.0;
            let got = [day[0], day[180], day[360], least, mean];
            for (got, expected) in got.into_iter().zip(expected) {
                assert!((got - expected).abs() < 0.05, "{inertia}: {got} {expected}");
            }
        }
    }

    #[test]
    fn what_is_absorbed_is_emitted() {
        let steps = 360;
        let day = phobos(50.0).periodic_temperature_k(&absorbed(steps));
        let emitted: f64 = day.iter().map(|&t| emitted_w_m2(t, 0.95)).sum();
        let all: f64 = absorbed(steps).iter().sum();
        assert!((emitted / all - 1.0).abs() < 1e-6, "{emitted} {all}");
    }

    #[test]
    fn small_waves_are_as_in_closed_form_and_errors_fall_with_the_square_of_the_step() {
        // T = T0 + Re(a exp(i w t) / (4 eps sigma T0^3 + I sqrt(w) exp(i pi / 4))).
        let (ground, t0, a) = (phobos(100.0), 250.0, 0.01);
        let mean = emitted_w_m2(t0, 0.95);
        let conductance = 100.0 * (2.0 * PI / PHOBOS_S).sqrt();
        let (re, im) = (4.0 * mean / t0 + conductance * 0.5f64.sqrt(), conductance * 0.5f64.sqrt());
        let worst = |steps: usize| {
            let phase = |k: usize| 2.0 * PI * k as f64 / steps as f64;
            let flux: Vec<f64> = (0..steps).map(|k| mean + a * phase(k).cos()).collect();
            let day = ground.periodic_temperature_k(&flux);
            let amplitude = a / re.hypot(im);
            let wave = |k: usize| t0 + amplitude * (phase(k) - im.atan2(re)).cos();
            day.iter().enumerate().map(|(k, t)| (t - wave(k)).abs() / amplitude).fold(0.0, f64::max)
        };
        let (coarse, fine) = (worst(24), worst(96));
        assert!(fine < 2e-3 && coarse / fine > 8.0, "{coarse} {fine}");
        assert!(worst(720) < 3e-4, "{}", worst(720));
    }

    #[test]
    fn no_inertia_is_equilibrium_and_much_is_one_temperature() {
        let flux = absorbed(48);
        let day = phobos(0.0).periodic_temperature_k(&flux);
        assert_eq!(day[0], equilibrium_temperature_k(flux[0], 0.95));
        assert_eq!(day[24], 0.0);
        let day = phobos(1e6).periodic_temperature_k(&flux);
        let one = equilibrium_temperature_k(flux.iter().sum::<f64>() / 48.0, 0.95);
        assert!(day.iter().all(|t| (t / one - 1.0).abs() < 1e-3), "{day:?} {one}");
        assert!(phobos(50.0).periodic_temperature_k(&[]).is_empty());
        assert_eq!(phobos(50.0).periodic_temperature_k(&[0.0; 10]), [0.0; 10]);
    }

    #[test]
    fn closed_forms() {
        // Independently computed: z 5 mm, diffusivity 1e-8 m2 s-1, period of Phobos.
        let (ratio, lag_rad) = wave_at_depth(0.005, 1e-8, PHOBOS_S);
        assert!((ratio / 0.586_318_260_872_736_5 - 1.0).abs() < 1e-13);
        assert!((lag_rad / 0.533_892_529_543_152_6 - 1.0).abs() < 1e-13);
        assert!((rise_by_constant_flux_k(50.0, 10.0, 600.0) / 5.527_906_391_541_368 - 1.0).abs() < 1e-14);
        assert!((thermal_inertia_from_cgs(0.0016) - 66.944).abs() < 1e-12);
    }
}
