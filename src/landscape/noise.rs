//! Noise that looks like nothing in particular: gradients on a lattice, and what lies between.

use crate::random::{STEP, mix};

/// Variance of [`gradient_noise`]: gradients are independent with unit variance along each axis, so it is
/// 8 A B with A = int w^2 dt = 181/462 and B = int t^2 w^2 dt = 535/18018 over 0 to 1, w = 1 - t^3 (10 - 15 t + 6 t^2).
pub(super) const VARIANCE: f64 = 193_670.0 / 2_081_079.0;

/// Mean of the noise's absolute value: there is no closed form; of 8e7 random cells and places 0.23834, known to 3e-5.
pub(super) const MEAN_ABSOLUTE: f64 = 0.23834;

/// Noise is no further from 0 than this: a gradient's components are at most sqrt(6), and the weighted sum of |dx| + |dy| over
/// the four corners is at most 1.
#[cfg(test)]
pub(super) const BOUND: f64 = 2.449_489_742_783_178;

/// From 0 to 1 as t does, level at both ends.
pub(super) fn smooth_step(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// Noise on the unit lattice (K. Perlin 2002, "Improving noise", ACM Trans. Graph. 21: quintic weights, twice
/// continuously differentiable), with gradients from a hash instead of a table so that it never repeats. Mean 0.
pub(super) fn gradient_noise(key: u64, u: f64, v: f64) -> f64 {
    let (i, j) = (u.floor(), v.floor());
    let (x, y) = (u - i, v - j);
    #[expect(
        clippy::cast_possible_truncation,
        reason = "whole numbers within 1e8: sites of 100 km at octaves of a millimetre"
    )]
    let (i, j) = (i as i64, j as i64);
    let corner = |di: i64, dj: i64| {
        let [gx, gy] = gradient(key, i.wrapping_add(di), j.wrapping_add(dj));
        gx * (x - di as f64) + gy * (y - dj as f64)
    };
    let fade = |t: f64| t * t * t * (10.0 - t * (15.0 - t * 6.0));
    let (fx, fy) = (fade(x), fade(y));
    let south = corner(0, 0) + fx * (corner(1, 0) - corner(0, 0));
    let north = corner(0, 1) + fx * (corner(1, 1) - corner(0, 1));
    south + fy * (north - south)
}

/// A lattice point's gradient: each component is the sum of two even numbers, scaled to mean 0 and variance 1.
fn gradient(key: u64, i: i64, j: i64) -> [f64; 2] {
    let bits = mix(key ^ mix((i as u64).wrapping_mul(STEP) ^ (j as u64)));
    #[expect(clippy::cast_possible_truncation, reason = "sixteen of the bits")]
    let part = |shift: u32| f64::from((bits >> shift) as u16) + 0.5;
    let component = |a: f64, b: f64| ((a + b) / 65536.0 - 1.0) * 6f64.sqrt();
    [component(part(0), part(16)), component(part(32), part(48))]
}

/// How much of something so wide a grid with this step shows: nothing under two steps, where it would only alias, all of it from four on.
pub(super) fn presence(width_m: f64, step_m: f64) -> f64 {
    (0.5 * width_m / step_m - 1.0).clamp(0.0, 1.0)
}

/// Octaves of noise: each with half the wavelength of the one before, and 2^-hurst of its spread.
#[derive(Debug, Clone)]
pub(super) struct Octaves(Vec<Octave>);

#[derive(Debug, Clone)]
struct Octave {
    key: u64,
    /// Standard deviation, m.
    rms_m: f64,
    wavelength_m: f64,
    /// Lattice coordinates from metres: a rotation over the wavelength.
    cos_per_m: f64,
    sin_per_m: f64,
}

/// How noise becomes height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// As it is: rolling ground.
    Rolling,
    /// Minus its absolute value: crests where it passes 0 (F. K. Musgrave, in Ebert et al. 2003, "Texturing and Modeling", chapter 16).
    Ridged,
}

impl Form {
    /// Of a value of the noise one with mean 0 and variance 1.
    fn normal(self, noise: f64) -> f64 {
        match self {
            Form::Rolling => noise / VARIANCE.sqrt(),
            Form::Ridged => (MEAN_ABSOLUTE - noise.abs()) / (VARIANCE - MEAN_ABSOLUTE * MEAN_ABSOLUTE).sqrt(),
        }
    }
}

impl Octaves {
    /// Octaves from `longest_m` down to `shortest_m`; `key` is that of octave k.
    ///
    /// Octave k has the standard deviation rms sqrt(1 - 4^-hurst) 2^(-k hurst), so that all octaves without end have `rms_m` together. Each lattice is
    /// turned by 36.87 degrees (the angle of the 3-4-5 triangle, no rational part of a turn) against the one before, so that their axes never line up.
    pub(super) fn new(key: impl Fn(u64) -> u64, rms_m: f64, longest_m: f64, hurst: f64, shortest_m: f64) -> Self {
        let mut octaves = Vec::new();
        let mut wavelength_m = longest_m;
        let mut rms_m = rms_m * (1.0 - 4f64.powf(-hurst)).sqrt();
        let (mut cos, mut sin) = (0.8, 0.6);
        while wavelength_m >= shortest_m && rms_m > 0.0 {
            octaves.push(Octave {
                key: key(octaves.len() as u64),
                rms_m,
                wavelength_m,
                cos_per_m: cos / wavelength_m,
                sin_per_m: sin / wavelength_m,
            });
            wavelength_m *= 0.5;
            rms_m *= 2f64.powf(-hurst);
            (cos, sin) = (0.8 * cos - 0.6 * sin, 0.6 * cos + 0.8 * sin);
        }
        Octaves(octaves)
    }

    /// Height at a place of a grid with this step, m: octaves that are too short for the step are left out.
    pub(super) fn height_m(&self, form: Form, x_m: f64, y_m: f64, step_m: f64) -> f64 {
        let mut height_m = 0.0;
        for octave in &self.0 {
            let share = presence(octave.wavelength_m, step_m);
            if share == 0.0 {
                break;
            }
            let u = octave.cos_per_m * x_m - octave.sin_per_m * y_m;
            let v = octave.sin_per_m * x_m + octave.cos_per_m * y_m;
            height_m += share * octave.rms_m * form.normal(gradient_noise(octave.key, u, v));
        }
        height_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octaves(longest_m: f64, shortest_m: f64) -> Octaves {
        Octaves::new(|k| mix(5 + k), 25.0, longest_m, 0.8, shortest_m)
    }

    #[test]
    fn octaves_halve_and_sum_to_the_asked_spread() {
        let Octaves(octaves) = octaves(1000.0, 1e-9);
        assert_eq!(octaves.len(), 40);
        let spread = octaves.iter().map(|o| o.rms_m * o.rms_m).sum::<f64>().sqrt();
        assert!((spread - 25.0).abs() < 1e-9);
        for (k, octave) in octaves.iter().enumerate() {
            let per_m = octave.cos_per_m.hypot(octave.sin_per_m);
            assert!((per_m * 1000.0 / 2f64.powi(k as i32) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_has_the_stated_spread_and_bound() {
        // 200 x 200 cells, 5 x 5 places in each: the mean square of 40,000 nearly independent cells is known to 1 %.
        let octaves = octaves(1000.0, 900.0);
        let rms_m = octaves.0[0].rms_m;
        for form in [Form::Rolling, Form::Ridged] {
            let heights: Vec<f64> = (0..1000 * 1000)
                .map(|i| octaves.height_m(form, 200.0 * f64::from(i % 1000), 200.0 * f64::from(i / 1000), 1.0))
                .collect();
            let mean = heights.iter().sum::<f64>() / heights.len() as f64;
            let mean_square = heights.iter().map(|h| h * h).sum::<f64>() / heights.len() as f64;
            assert!(mean.abs() < 0.02 * rms_m, "{form:?} {mean}");
            assert!((mean_square / (rms_m * rms_m) - 1.0).abs() < 0.03, "{form:?} {mean_square}");
            let farthest = heights.iter().fold(0f64, |m, h| m.max(h.abs()));
            assert!(farthest < BOUND / 0.19 * rms_m && farthest > 2.0 * rms_m, "{form:?} {farthest}");
        }
    }

    #[test]
    fn noise_is_smooth_across_cells() {
        // Value and slope from both sides of a lattice line, at many places along it.
        let h = 1e-6;
        for n in 0..100 {
            let y = 0.137 * f64::from(n);
            let at = |x: f64| gradient_noise(3, x, y);
            let (before, after) = ((at(4.0) - at(4.0 - h)) / h, (at(4.0 + h) - at(4.0)) / h);
            assert!((before - after).abs() < 1e-4, "{before} {after}");
        }
    }

    #[test]
    fn what_is_finer_than_the_grid_is_left_out() {
        assert_eq!([1.0, 2.0, 3.0, 4.0, 9.0].map(|width_m| presence(width_m, 1.0)), [0.0, 0.0, 0.5, 1.0, 1.0]);
        // A wavelength of 1000 m on steps of 500 m and more is nothing, on steps of 250 m and less it is all there.
        let octaves = octaves(1000.0, 900.0);
        let at = |step_m: f64| octaves.height_m(Form::Rolling, 300.0, 400.0, step_m);
        assert!(at(500.0) == 0.0 && at(250.0) == at(1.0) && at(1.0) != 0.0);
        assert!((at(1000.0 / 3.0) / at(1.0) - 0.5).abs() < 1e-12);
    }
}
