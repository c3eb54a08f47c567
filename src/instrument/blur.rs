//! Optics on a grid finer than pixels, and the means of pixels: by Fourier transforms.
//!
//! The kernel's DFT is the optical transfer function on a window of `reach_px` pixels to each side; light that would
//! leave the window wraps into it, so none is lost. Frequencies above the grid's Nyquist frequency are cut off.

use std::cmp::Ordering;
use std::f64::consts::TAU;
use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::Optics;

/// Relative to the brightest part of an image: smaller values are rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Blurs images of one size at one wavelength.
pub struct Blur {
    fine: Plane,
    coarse: Plane,
    /// Transfer of each wave of the fine grid, including the pixel mean; columns first.
    transfer: Vec<Complex<f64>>,
    subpixels: usize,
    reach: usize,
    pixels: [usize; 2],
}

/// Transforms of an image of one size.
struct Plane {
    size: [usize; 2],
    along: [Arc<dyn Fft<f64>>; 2],
}

impl Plane {
    fn new(size: [usize; 2], planner: &mut FftPlanner<f64>, forward: bool) -> Self {
        let mut plan = |n| if forward { planner.plan_fft_forward(n) } else { planner.plan_fft_inverse(n) };
        Plane { size, along: size.map(&mut plan) }
    }

    /// Forward transform of lines to columns of waves.
    fn forward(&self, mut lines: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
        self.along[0].process(&mut lines);
        let mut columns = transposed(&lines, self.size);
        self.along[1].process(&mut columns);
        columns
    }

    /// Inverse transform of columns of waves to lines.
    fn inverse(&self, mut columns: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
        let [width, height] = self.size;
        self.along[1].process(&mut columns);
        let mut lines = transposed(&columns, [height, width]);
        self.along[0].process(&mut lines);
        lines
    }
}

/// An image of this width and height, line by line, column by column.
fn transposed(lines: &[Complex<f64>], [width, height]: [usize; 2]) -> Vec<Complex<f64>> {
    let mut columns = vec![Complex::ZERO; lines.len()];
    transpose::transpose(lines, &mut columns, width, height);
    columns
}

impl Blur {
    /// For an image of so many samples and lines of pixels, at a wavelength.
    pub fn new(optics: &Optics, lambda_um: f64, pixels: [usize; 2]) -> Self {
        let (subpixels, reach) = (optics.subpixels as usize, optics.reach_px as usize);
        let mut planner = FftPlanner::new();
        // Padding to lengths without large prime factors, which are fast.
        let coarse = pixels.map(|n| smooth(n + 2 * reach));
        let size = coarse.map(|n| n * subpixels);
        let fine = Plane::new(size, &mut planner, true);
        // The kernel about (0, 0), which wraps around as the transform does.
        let window = 2 * reach * subpixels;
        let wave = |i: usize| {
            let i = if 2 * i < window { i as f64 } else { i as f64 - window as f64 };
            i / (2 * reach) as f64
        };
        let of_window = (0..window * window)
            .map(|i| optics.transfer([wave(i / window), wave(i % window)], lambda_um) / (window * window) as f64);
        let of_window = Plane::new([window; 2], &mut planner, false).inverse(of_window.collect());
        let mut kernel = vec![Complex::ZERO; size[0] * size[1]];
        // Symmetric weight for the sample equally far on both sides.
        let places = |i: usize, n: usize| match (2 * i).cmp(&window) {
            Ordering::Less => [i, i],
            Ordering::Equal => [i, n - i],
            Ordering::Greater => [n + i - window; 2],
        };
        for (i, value) in of_window.into_iter().enumerate() {
            for y in places(i / window, size[1]) {
                for x in places(i % window, size[0]) {
                    // A point spread is real: the Nyquist wave has no conjugate partner.
                    kernel[y * size[0] + x] += 0.25 * value.re;
                }
            }
        }
        let mut transfer = fine.forward(kernel);
        // The mean of a pixel's parts, and the place of its first, as a sum of waves.
        let mean = |i: usize, n: usize| {
            let of = |j: usize| Complex::cis(TAU * (i * j) as f64 / n as f64);
            (0..subpixels).map(of).sum::<Complex<f64>>() / subpixels as f64
        };
        let [along, across] = [0, 1].map(|k| (0..size[k]).map(|i| mean(i, size[k])).collect::<Vec<_>>());
        let all = (size[0] * size[1]) as f64;
        for (column, along) in transfer.chunks_exact_mut(size[1]).zip(&along) {
            column.iter_mut().zip(&across).for_each(|(value, across)| *value *= along * across / all);
        }
        let coarse = Plane::new(coarse, &mut planner, false);
        Blur { fine, coarse, transfer, subpixels, reach, pixels }
    }

    /// Samples and lines of the fine image that it takes: of the pixels, and of [`Optics::reach_px`] more on each side.
    pub fn fine_size(&self) -> [usize; 2] {
        self.pixels.map(|n| (n + 2 * self.reach) * self.subpixels)
    }

    /// Means of pixels, line by line, of what a fine image becomes, which is given line by line.
    pub fn pixels(&self, fine: &[f64]) -> Vec<f64> {
        let [width, height] = self.fine.size;
        let [fine_width, _] = self.fine_size();
        let mut waves = vec![Complex::ZERO; width * height];
        for (to, from) in waves.chunks_exact_mut(width).zip(fine.chunks_exact(fine_width)) {
            to.iter_mut().zip(from).for_each(|(to, from)| *to = (*from).into());
        }
        let mut waves = self.fine.forward(waves);
        waves.iter_mut().zip(&self.transfer).for_each(|(wave, transfer)| *wave *= transfer);
        // Decimation by n adds up the waves that alias onto each other.
        let [coarse_width, coarse_height] = self.coarse.size;
        let mut folded = vec![Complex::ZERO; coarse_width * coarse_height];
        for (i, column) in waves.chunks_exact(height).enumerate() {
            let to = &mut folded[i % coarse_width * coarse_height..][..coarse_height];
            for part in column.chunks_exact(coarse_height) {
                to.iter_mut().zip(part).for_each(|(sum, wave)| *sum += wave);
            }
        }
        let image = self.coarse.inverse(folded);
        // Rounding of the transforms where there is no light is set to 0.
        let rounding = ROUNDING * fine.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let ([samples, lines], reach) = (self.pixels, self.reach);
        let line = |y: usize| image[(reach + y) * coarse_width + reach..][..samples].iter().map(|value| value.re);
        let line = |y: usize| line(y).map(|value| if value.abs() > rounding { value } else { 0.0 });
        (0..lines).flat_map(line).collect()
    }
}

/// The smallest number from this one on without prime factors above 5.
fn smooth(n: usize) -> usize {
    let is_smooth = |n: &usize| {
        let mut rest = *n;
        for factor in [2, 3, 5] {
            while rest.is_multiple_of(factor) {
                rest /= factor;
            }
        }
        rest == 1
    };
    (n.max(1)..).find(is_smooth).unwrap_or(n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::Lens;
    use crate::physics::mtf;

    const PIXELS: [usize; 2] = [24, 16];

    /// An image of parts of pixels: means of a function of place, pixels from the image's corner, over each.
    fn fine(blur: &Blur, mean: impl Fn([f64; 2], f64) -> f64) -> Vec<f64> {
        let [width, height] = blur.fine_size();
        let (k, reach) = (blur.subpixels as f64, blur.reach as f64);
        let at = |i: usize| [(i % width) as f64, (i / width) as f64].map(|x| (x + 0.5) / k - reach);
        (0..width * height).map(|i| mean(at(i), 1.0 / k)).collect()
    }

    /// What is left of the contrast of a wave along both axes: the component of the pixels' means at it, over its amplitude.
    fn contrast(optics: &Optics, um: f64, [fx, fy]: [f64; 2]) -> f64 {
        let blur = Blur::new(optics, um, PIXELS);
        // With a phase that leaves no pixel's centre at a zero.
        let wave = |[x, y]: [f64; 2]| TAU * (fx * x + fy * y) + 0.7;
        let of_part = |at, w: f64| 1.0 + wave(at).cos() * mtf::mean(fx, w) * mtf::mean(fy, w);
        let pixels = blur.pixels(&fine(&blur, of_part));
        let centre = |i: usize| [(i % PIXELS[0]) as f64 + 0.5, (i / PIXELS[0]) as f64 + 0.5];
        // At its own frequency, aliased or not: values at centres against the wave at them, by least squares.
        let (mut product, mut square) = (0.0, 0.0);
        for (i, value) in pixels.iter().enumerate() {
            let reference = wave(centre(i)).cos();
            product += (value - 1.0) * reference;
            square += reference * reference;
        }
        product / square
    }

    fn optics() -> Optics {
        let lens = Some(Lens { f_number: 4.0, pixel_um: 30.0 });
        Optics { lens, gaussian_px: 0.2, jitter_px: 0.1, smear_px: [0.6, 0.0], ..Optics::default() }
    }

    #[test]
    fn waves_pass_as_the_product_of_transfers_says() {
        for um in [1.0, 3.0] {
            for f in [[0.25_f64, 0.0], [0.5, 0.0], [0.0, 0.5], [0.375, 0.25], [0.75, 0.0], [1.25, 0.0], [0.0, 1.5]] {
                let r = f[0].hypot(f[1]);
                let expected = mtf::mean(f[0], 1.0)
                    * mtf::mean(f[1], 1.0)
                    * mtf::mean(f[0], 0.6)
                    * mtf::diffraction(r * um * 4.0 / 30.0)
                    * mtf::gaussian(r, 0.2)
                    * mtf::gaussian(r, 0.1);
                let found = contrast(&optics(), um, f);
                assert!((found - expected).abs() < 1e-12, "{um} um, {f:?}: {found} {expected}");
            }
            // Waves that do not fit into the window pass between those that do; for a lens, whose transfer has a corner at 0, slow ones are worst.
            let found = contrast(&optics(), um, [0.3, 0.0]);
            let expected = mtf::mean(0.3, 1.0)
                * mtf::mean(0.3, 0.6)
                * mtf::diffraction(0.3 * um * 4.0 / 30.0)
                * mtf::gaussian(0.3, 0.2)
                * mtf::gaussian(0.3, 0.1);
            assert!((found - expected).abs() < 1e-3, "{um} um: {found} {expected}");
        }
    }

    #[test]
    fn no_light_is_lost_or_made() {
        // One part of a pixel in the middle is bright; what it sends arrives in the pixels around, all of it.
        let blur = Blur::new(&optics(), 3.0, [24, 20]);
        let [width, height] = blur.fine_size();
        let mut fine = vec![0.0; width * height];
        fine[height / 2 * width + width / 2 + 1] = 16.0;
        let pixels = blur.pixels(&fine);
        assert!((pixels.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        // Where none arrives there is none: rounding is not a signal.
        let mut aside = vec![0.0; width * height];
        aside[0] = 16.0;
        assert!(blur.pixels(&aside)[1..].iter().all(|value| *value == 0.0));
        // A uniform image stays as it is, up to its sides.
        let pixels = blur.pixels(&vec![7.0; width * height]);
        assert!(pixels.iter().all(|value| (value - 7.0).abs() < 1e-12));
    }

    #[test]
    fn a_slanted_edge_is_the_integral_of_a_gaussian() {
        // An edge at an angle of 0.1 to the columns: of a Gaussian alone, its pixels are known; all phases to the grid occur.
        let sigma_px = 0.5;
        let blur = Blur::new(&Optics { gaussian_px: sigma_px, ..Optics::default() }, 1.0, PIXELS);
        let (sin, cos) = 0.1_f64.sin_cos();
        let across = |[x, y]: [f64; 2]| (x - 12.3) * cos + (y - 8.0) * sin;
        // The mean over a square part of what lies beyond a line, by thin strips of it.
        let of_part = |[x, y]: [f64; 2], w: f64| {
            let strip = |i: i32| {
                let y = y + w * ((f64::from(i) + 0.5) / 64.0 - 0.5);
                (across([x, y]) / (w * cos) + 0.5).clamp(0.0, 1.0)
            };
            (0..64).map(strip).sum::<f64>() / 64.0
        };
        let pixels = blur.pixels(&fine(&blur, of_part));
        for (i, value) in pixels.iter().enumerate() {
            let centre = [(i % PIXELS[0]) as f64 + 0.5, (i / PIXELS[0]) as f64 + 0.5];
            // The mean over the pixel's height of the mean over its width, along which the edge is a Gaussian of s / cos.
            let strip = |j: i32| {
                let y = centre[1] + (f64::from(j) + 0.5) / 64.0 - 0.5;
                mtf::gaussian_edge_mean(across([centre[0], y]) / cos, sigma_px / cos)
            };
            let expected = (0..64).map(strip).sum::<f64>() / 64.0;
            assert!((value - expected).abs() < 1e-3, "{centre:?}: {value} {expected}");
        }
    }

    #[test]
    fn a_measured_gaussian_is_one() {
        let (step_px, sigma_px): (f64, f64) = (0.125, 0.3);
        let at = |i: usize| step_px * (i as f64 - 16.0);
        let value = |i: usize| (-0.5 * (at(i % 33).powi(2) + at(i / 33).powi(2)) / (sigma_px * sigma_px)).exp();
        let spread = crate::instrument::PointSpread { samples: 33, values: (0..33 * 33).map(value).collect(), step_px };
        let optics = Optics { measured: Some(spread), ..Optics::default() };
        for f in [[0.25_f64, 0.0], [0.5, 0.5], [0.0, 0.75]] {
            let expected = mtf::gaussian(f[0].hypot(f[1]), sigma_px) * mtf::mean(f[0], 1.0) * mtf::mean(f[1], 1.0);
            assert!((contrast(&optics, 1.0, f) - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn any_size_is_taken() {
        for pixels in [[1, 1], [7, 1], [1, 13]] {
            for (subpixels, reach_px) in [(1, 1), (3, 2), (2, 5)] {
                let blur =
                    Blur::new(&Optics { subpixels, reach_px, gaussian_px: 0.4, ..Optics::default() }, 2.0, pixels);
                let [width, height] = blur.fine_size();
                let means = blur.pixels(&vec![1.0; width * height]);
                assert_eq!(means.len(), pixels[0] * pixels[1]);
                assert!(means.iter().all(|value| (value - 1.0).abs() < 1e-13));
            }
        }
    }
}
