//! Rolling ground: a sum of gradient noises, each with half the wavelength of the one before.

use super::random::{Purpose, key};
use super::recipe::Relief;
use crate::random::{STEP, mix};

/// Variance of [`gradient_noise`]: gradients are independent with unit variance along each axis, so it is
/// 8 A B with A = int w^2 dt = 181/462 and B = int t^2 w^2 dt = 535/18018 over 0 to 1, w = 1 - t^3 (10 - 15 t + 6 t^2).
const NOISE_VARIANCE: f64 = 193_670.0 / 2_081_079.0;

/// One wavelength's share of the relief.
#[derive(Debug, Clone)]
pub(super) struct Octave {
    key: u64,
    /// Standard deviation, m.
    rms_m: f64,
    /// Lattice coordinates from metres: a rotation over the wavelength.
    cos_per_m: f64,
    sin_per_m: f64,
}

/// The octaves of a relief with wavelengths of at least `shortest_m`.
///
/// Octave k has the standard deviation rms sqrt(1 - 4^-hurst) 2^(-k hurst), so that all octaves without end have
/// `rms_m` together. Each lattice is turned by 36.87 degrees (the angle of the 3-4-5 triangle, no rational part of a
/// turn) against the one before, so that their axes never line up.
pub(super) fn octaves(relief: &Relief, seed: u64, shortest_m: f64) -> Vec<Octave> {
    let mut octaves = Vec::new();
    let mut wavelength_m = relief.longest_m;
    let mut rms_m = relief.rms_m * (1.0 - 4f64.powf(-relief.hurst)).sqrt();
    let (mut cos, mut sin) = (0.8, 0.6);
    while wavelength_m >= shortest_m && rms_m > 0.0 {
        octaves.push(Octave {
            key: key(seed, Purpose::Relief, octaves.len() as u64),
            rms_m,
            cos_per_m: cos / wavelength_m,
            sin_per_m: sin / wavelength_m,
        });
        wavelength_m *= 0.5;
        rms_m *= 2f64.powf(-relief.hurst);
        (cos, sin) = (0.8 * cos - 0.6 * sin, 0.6 * cos + 0.8 * sin);
    }
    octaves
}

impl Octave {
    /// Height at a place, m.
    pub(super) fn height_m(&self, x_m: f64, y_m: f64) -> f64 {
        let u = self.cos_per_m * x_m - self.sin_per_m * y_m;
        let v = self.sin_per_m * x_m + self.cos_per_m * y_m;
        self.rms_m / NOISE_VARIANCE.sqrt() * gradient_noise(self.key, u, v)
    }

    /// No height is further from 0 than this, m: see [`gradient_noise`].
    #[cfg(test)]
    pub(super) fn bound_m(&self) -> f64 {
        self.rms_m / NOISE_VARIANCE.sqrt() * 6f64.sqrt()
    }
}

/// Noise on the unit lattice (K. Perlin 2002, "Improving noise", ACM Trans. Graph. 21: quintic weights, twice
/// continuously differentiable), with gradients from a hash instead of a table so that it never repeats.
///
/// Mean 0. |noise| <= sqrt(6): a gradient's components are at most sqrt(6), and the weighted sum of |dx| + |dy| over
/// the four corners is at most 1.
fn gradient_noise(key: u64, u: f64, v: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn relief() -> Relief {
        Relief { rms_m: 25.0, longest_m: 1000.0, hurst: 0.8 }
    }

    #[test]
    fn octaves_halve_and_sum_to_the_asked_spread() {
        let octaves = octaves(&relief(), 1, 1e-9);
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
        let octave = &octaves(&relief(), 5, 900.0)[0];
        let step_m = 1000.0 / 5.0;
        let heights: Vec<f64> = (0..1000 * 1000)
            .map(|i| octave.height_m(step_m * f64::from(i % 1000), step_m * f64::from(i / 1000)))
            .collect();
        let mean_square = heights.iter().map(|h| h * h).sum::<f64>() / heights.len() as f64;
        assert!((mean_square / (octave.rms_m * octave.rms_m) - 1.0).abs() < 0.03, "{mean_square}");
        let highest = heights.iter().fold(0f64, |m, h| m.max(h.abs()));
        assert!(highest < octave.bound_m() && highest > 2.0 * octave.rms_m);
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
}
