//! Optics: point spread, motion blur and stray light, before pixel averaging.

use std::f64::consts::PI;

use rustfft::num_complex::Complex;

use crate::error::{Location, Problem};
use crate::physics::mtf;

/// A diffraction-limited lens over a detector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Focal length over aperture.
    pub f_number: f64,
    /// Pitch of the detector's pixels, um.
    pub pixel_um: f64,
}

/// A measured point spread function on a grid centred on the source.
#[derive(Debug, Clone, PartialEq)]
pub struct PointSpread {
    /// Values per line.
    pub samples: usize,
    /// Values, line by line; only relative ones count.
    pub values: Vec<f64>,
    /// Step, pixels.
    pub step_px: f64,
}

/// Blur before pixel averaging, and stray light. Transfer functions multiply; 0 or `None`: no effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Optics {
    /// Diffraction.
    pub lens: Option<Lens>,
    /// Standard deviation of a Gaussian that stands for aberrations and focus, pixels.
    pub gaussian_px: f64,
    /// Standard deviation of jitter that is fast against an exposure, pixels.
    pub jitter_px: f64,
    /// Linear smear during an exposure along a line and across, pixels, for images without a modelled motion.
    pub smear_px: [f64; 2],
    /// A measured point spread.
    pub measured: Option<PointSpread>,
    /// Stray light: fraction scattered evenly over all that is taken at once.
    pub stray: f64,
    /// Subpixels per pixel of the blurring grid, along and across.
    pub subpixels: u32,
    /// Reach of the kernel, pixels; light that would go farther wraps into it.
    pub reach_px: u32,
}

impl Default for Optics {
    /// No blur; the grid has quarters of pixels and a reach of eight pixels.
    fn default() -> Self {
        Optics {
            lens: None,
            gaussian_px: 0.0,
            jitter_px: 0.0,
            smear_px: [0.0; 2],
            measured: None,
            stray: 0.0,
            subpixels: 4,
            reach_px: 8,
        }
    }
}

/// Finest grid, and farthest reach.
const MOST: u32 = 64;
/// Largest blur length, pixels.
const MOST_PX: f64 = 16.0;
/// Most values of a measured point spread.
const MOST_VALUES: usize = 1 << 16;
/// Largest reach of the kernel, subpixels.
const MOST_PARTS: u32 = 512;

impl Optics {
    /// Optical transfer function at so many cycles per pixel along a line and across, before pixel averaging.
    pub fn transfer(&self, [fx, fy]: [f64; 2], lambda_um: f64) -> Complex<f64> {
        let f = fx.hypot(fy);
        let lens = self.lens.map_or(1.0, |lens| mtf::diffraction(f * lambda_um * lens.f_number / lens.pixel_um));
        let sigma_px = self.gaussian_px.hypot(self.jitter_px);
        let motion = mtf::mean(fx * self.smear_px[0] + fy * self.smear_px[1], 1.0);
        let measured = self.measured.as_ref().map_or(Complex::ONE, |spread| spread.transfer([fx, fy]));
        measured * (lens * motion * mtf::gaussian(f, sigma_px))
    }

    /// The same; where light stays in its place, on a grid of whole pixels.
    #[must_use]
    pub fn on_grid(self) -> Self {
        if self.blurs() { self } else { Optics { subpixels: 1, reach_px: 1, ..self } }
    }

    /// Whether there is blur, apart from stray light.
    pub fn blurs(&self) -> bool {
        self.lens.is_some()
            || self.measured.is_some()
            || self.gaussian_px.hypot(self.jitter_px) > 0.0
            || self.smear_px != [0.0; 2]
    }

    /// Problems with it.
    pub fn problems(&self, item: &str) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut problem =
            |key: &str, message: String| problems.push(Problem::new(Location::item(format!("{item}.{key}")), message));
        let is_length = |px: f64| (0.0..=MOST_PX).contains(&px);
        for (key, px) in [("gaussian_px", self.gaussian_px), ("jitter_px", self.jitter_px)] {
            if !is_length(px) {
                problem(key, format!("{px} is not from 0 to {MOST_PX} pixels"));
            }
        }
        if !self.smear_px.iter().all(|px| is_length(px.abs())) {
            problem("smear_px", format!("{:?} are not two numbers of pixels within {MOST_PX}", self.smear_px));
        }
        if !(0.0..1.0).contains(&self.stray) {
            problem("stray", format!("{} is not a share from 0 to 1, 1 excluded", self.stray));
        }
        for (key, number) in [("subpixels", self.subpixels), ("reach_px", self.reach_px)] {
            if !(1..=MOST).contains(&number) {
                problem(key, format!("{number} is not from 1 to {MOST}"));
            }
        }
        if self.subpixels.saturating_mul(self.reach_px) > MOST_PARTS {
            let message = format!("{} x {} parts of pixels are more than {MOST_PARTS}", self.subpixels, self.reach_px);
            problem("reach_px", message);
        }
        if let Some(lens) = self.lens {
            for (key, value) in [("f_number", lens.f_number), ("pixel_um", lens.pixel_um)] {
                if !(value > 0.0 && value.is_finite()) {
                    problem(key, format!("{value} is not positive"));
                }
            }
        }
        if let Some(message) = self.measured.as_ref().and_then(PointSpread::fault) {
            problem("point_spread", message);
        }
        problems
    }
}

impl PointSpread {
    /// Its Fourier transform about its middle, 1 at frequency 0: values are light at points, which is right for what is smooth over a step.
    fn transfer(&self, [fx, fy]: [f64; 2]) -> Complex<f64> {
        let lines = self.values.len() / self.samples;
        let middle = |count: usize| 0.5 * (count as f64 - 1.0);
        let wave = |f: f64, count: usize| {
            (0..count)
                .map(|i| Complex::cis(-2.0 * PI * f * self.step_px * (i as f64 - middle(count))))
                .collect::<Vec<_>>()
        };
        let (along, across) = (wave(fx, self.samples), wave(fy, lines));
        let (mut sum, mut all) = (Complex::ZERO, 0.0);
        for (line, y) in self.values.chunks_exact(self.samples).zip(across) {
            sum += y * line.iter().zip(&along).map(|(value, x)| x * value).sum::<Complex<f64>>();
            all += line.iter().sum::<f64>();
        }
        sum / all
    }

    fn fault(&self) -> Option<String> {
        let PointSpread { samples, values, step_px } = self;
        let sum: f64 = values.iter().sum();
        if *samples == 0 || values.is_empty() || values.len() % samples != 0 || values.len() > MOST_VALUES {
            Some(format!("{} values do not form lines of {samples}, or are more than {MOST_VALUES}", values.len()))
        } else if !(sum > 0.0 && sum.is_finite()) {
            Some("its values do not add up to a positive number".to_owned())
        } else if !(*step_px > 0.0 && *step_px <= MOST_PX) {
            Some(format!("the step must be above 0 and at most {MOST_PX} pixels: {step_px}"))
        } else {
            None
        }
    }
}
