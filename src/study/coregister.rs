//! Co-registration of two images of a moving scene by a plain matcher, and its errors against the truth.
//!
//! A window of one image is sought in another by normalised cross-correlation at all integer shifts, then refined by
//! least squares of the two windows (zero mean, unit norm) with cubic interpolation (Catmull & Rom 1974): Gauss-Newton
//! steps, so that brightness and contrast may differ.

use rayon::prelude::*;

use crate::geometry::whole;

/// Least contrast: a window with less relative scatter is flat.
const LEAST_CONTRAST: f64 = 1e-3;
/// Least correlation of a match.
const LEAST_CORRELATION: f64 = 0.6;
/// Ambiguity: the second-best peak, away from the best one, must correlate by less than this fraction of it.
const RIVAL: f64 = 0.95;
/// Aperture problem: smallest ratio of the gradient variances along the two principal directions; below it the texture
/// is a stripe.
const STRIPE: f64 = 1e-3;
/// Margin for interpolation, pixels.
const BESIDE: usize = 2;
/// Most Gauss-Newton steps; they end below [`ENOUGH_PX`], and reject a match farther than [`AWAY_PX`] from its start.
const STEPS: usize = 30;
const ENOUGH_PX: f64 = 1e-4;
const AWAY_PX: f64 = 1.0;

/// One band of an image; NaN is not a value.
#[derive(Debug, Clone, Copy)]
pub struct Image<'a> {
    /// Line by line.
    pub values: &'a [f64],
    /// Pixels in a line.
    pub samples: usize,
    /// Lines.
    pub lines: usize,
}

/// Matching options.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Windows {
    /// Half width of a window, pixels.
    pub half: usize,
    /// Search radius around zero shift, pixels.
    pub search: usize,
    /// Spacing of windows, pixels.
    pub step: usize,
}

impl Default for Windows {
    /// Windows of 15 x 15 pixels, side by side; search radius 6 pixels.
    fn default() -> Self {
        Windows { half: 7, search: 6, step: 15 }
    }
}

/// A match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Shift, samples and lines.
    pub moved_px: [f64; 2],
    /// Correlation.
    pub correlation: f64,
}

/// A window with its match and its true shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tried {
    /// Sample and line of its middle pixel in the first image, from 0.
    pub pixel: [usize; 2],
    /// The match; `None`: rejected by the matcher.
    pub found: Option<Match>,
    /// True shift, samples and lines; `None`: unknown, or outside.
    pub truth_px: Option<[f64; 2]>,
}

impl Tried {
    /// Error of the match, pixels.
    pub fn error_px(&self) -> Option<f64> {
        let ([x, y], [u, v]) = (self.found?.moved_px, self.truth_px?);
        Some((x - u).hypot(y - v))
    }
}

/// Quality of a matcher.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Quality {
    /// Windows with a known true shift.
    pub windows: usize,
    /// Those matched.
    pub matched: usize,
    /// Median of their errors, pixels; NaN (null) if there is none.
    pub median_px: f64,
    /// 95th percentile, pixels.
    pub p95_px: f64,
    /// Fraction of matches within half a pixel.
    pub within_half: f64,
}

/// A window with zero mean and unit norm; `None` if it is flat, or has unknown values.
struct Normal {
    values: Vec<f64>,
    length: f64,
}

impl Normal {
    fn new(mut values: Vec<f64>) -> Option<Self> {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        values.iter_mut().for_each(|value| *value -= mean);
        let length = values.iter().map(|value| value * value).sum::<f64>().sqrt();
        let contrast = length / n.sqrt();
        // What is not a number, here, is not beyond it.
        let is_textured = contrast > LEAST_CONTRAST * mean.abs() && contrast.is_finite();
        is_textured.then(|| {
            values.iter_mut().for_each(|value| *value /= length);
            Normal { values, length }
        })
    }

    fn dot(&self, other: &[f64]) -> f64 {
        self.values.iter().zip(other).map(|(a, b)| a * b).sum()
    }
}

impl Image<'_> {
    fn at(&self, sample: isize, line: isize) -> f64 {
        let inside = |i: isize, n: usize| usize::try_from(i).ok().filter(|i| *i < n);
        match (inside(sample, self.samples), inside(line, self.lines)) {
            (Some(sample), Some(line)) => self.values.get(line * self.samples + sample).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        }
    }

    /// Interpolated window values at a subpixel shift, and their gradients along samples and lines.
    fn window(&self, [sample, line]: [usize; 2], half: usize, moved_px: [f64; 2]) -> [Vec<f64>; 3] {
        let floor = moved_px.map(f64::floor);
        let [fx, fy] = [0, 1].map(|k| moved_px[k] - floor[k]);
        #[expect(clippy::cast_possible_truncation, reason = "no search goes beyond an image")]
        let [left, top] =
            [(sample, floor[0]), (line, floor[1])].map(|(i, by)| i as isize + by as isize - half as isize);
        let (x, y) = (cubic(fx), cubic(fy));
        let side = 2 * half + 1;
        let mut all: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::with_capacity(side * side));
        for j in 0..side as isize {
            for i in 0..side as isize {
                let mut sums = [0.0; 3];
                for (row, (wy, dy)) in y.iter().enumerate() {
                    for (column, (wx, dx)) in x.iter().enumerate() {
                        let value = self.at(left + i + column as isize - 1, top + j + row as isize - 1);
                        // Between whole pixels' places, neighbours without weight need not be known.
                        for (sum, weight) in sums.iter_mut().zip([wx * wy, dx * wy, wx * dy]) {
                            if weight != 0.0 {
                                *sum += weight * value;
                            }
                        }
                    }
                }
                all.iter_mut().zip(sums).for_each(|(values, sum)| values.push(sum));
            }
        }
        all
    }

    fn pixels(&self, [sample, line]: [isize; 2], half: usize) -> Vec<f64> {
        let half = half as isize;
        let lines = line - half..=line + half;
        lines.flat_map(|j| (sample - half..=sample + half).map(move |i| self.at(i, j))).collect()
    }
}

/// Catmull-Rom weights of four neighbours, and their derivatives, at a fraction between the middle two.
fn cubic(t: f64) -> [(f64, f64); 4] {
    let weights = [
        -0.5 * t * (1.0 - t) * (1.0 - t),
        1.0 + t * t * (1.5 * t - 2.5),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        -0.5 * t * t * (1.0 - t),
    ];
    let slopes =
        [-0.5 * (1.0 - t) * (1.0 - 3.0 * t), t * (4.5 * t - 5.0), 0.5 + t * (4.0 - 4.5 * t), t * (1.5 * t - 1.0)];
    std::array::from_fn(|k| (weights[k], slopes[k]))
}

/// Matches the window around a pixel of one image in another; `None` if it is flat or a stripe, reaches unknown pixels,
/// or is found nowhere or in several places.
pub fn matched(of: Image<'_>, within: Image<'_>, pixel: [usize; 2], windows: Windows) -> Option<Match> {
    let middle = pixel.map(|i| i as isize);
    let wanted = Normal::new(of.pixels(middle, windows.half))?;
    let reach = windows.search as isize;
    let side = 2 * windows.search + 1;
    let shifts = (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| [i, j]));
    let correlations: Vec<f64> = shifts
        .map(|[i, j]| {
            let there = Normal::new(within.pixels([middle[0] + i, middle[1] + j], windows.half));
            there.map_or(f64::NAN, |there| wanted.dot(&there.values))
        })
        .collect();
    let (best, most) =
        correlations.iter().copied().enumerate().filter(|(_, c)| c.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let [i, j] = [best % side, best / side];
    let at_edge = [i, j].iter().any(|i| *i == 0 || *i == side - 1);
    let rivals =
        correlations.iter().enumerate().filter(|(k, _)| (k % side).abs_diff(i).max((k / side).abs_diff(j)) > 2);
    if at_edge || most < LEAST_CORRELATION || rivals.into_iter().any(|(_, c)| *c > RIVAL * most) {
        return None;
    }
    refined(&wanted, within, pixel, windows.half, [i, j].map(|i| i as f64 - windows.search as f64))
}

/// Refines an integer shift.
fn refined(wanted: &Normal, within: Image<'_>, pixel: [usize; 2], half: usize, start: [f64; 2]) -> Option<Match> {
    let mut moved = start;
    for _ in 0..STEPS {
        let [values, along, down] = within.window(pixel, half, moved);
        let there = Normal::new(values)?;
        let correlation = wanted.dot(&there.values);
        // Derivatives of the normalised window: without the parts that change mean and norm.
        let changes = [along, down].map(|slopes| {
            let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
            let mut change: Vec<f64> = slopes.iter().map(|slope| (slope - mean) / there.length).collect();
            let stretch = there.dot(&change);
            change.iter_mut().zip(&there.values).for_each(|(change, value)| *change -= stretch * value);
            change
        });
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let [a, b, c] = [(0, 0), (0, 1), (1, 1)].map(|(k, l)| product(&changes[k], &changes[l]));
        let left: Vec<f64> = wanted.values.iter().zip(&there.values).map(|(w, t)| w - t).collect();
        let [x, y] = [0, 1].map(|k| product(&changes[k], &left));
        let determinant = a * c - b * b;
        // The product of the eigenvalues over the square of the larger one at least: their ratio at most.
        if determinant.is_nan() || determinant <= STRIPE * (0.5 * (a + c)).powi(2) {
            return None;
        }
        let step = [(c * x - b * y) / determinant, (a * y - b * x) / determinant];
        moved = [moved[0] + step[0], moved[1] + step[1]];
        let away_px = (moved[0] - start[0]).hypot(moved[1] - start[1]);
        if away_px.is_nan() || away_px > AWAY_PX {
            return None;
        }
        if step[0].hypot(step[1]) < ENOUGH_PX {
            return (correlation >= LEAST_CORRELATION).then_some(Match { moved_px: moved, correlation });
        }
    }
    None
}

/// Bilinear value at a place of a plane; `None` outside or next to unknown values.
fn between(plane: Image<'_>, [x, y]: [f64; 2]) -> Option<f64> {
    let floor = [x, y].map(f64::floor);
    let is_inside = floor.iter().all(|at| *at >= 0.0);
    if !is_inside {
        return None;
    }
    let [i, j] = floor.map(|i| whole(i) as isize);
    let shares = [x - floor[0], y - floor[1]];
    let mut sum = 0.0;
    for (k, l) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let share = |on: isize, share: f64| if on == 1 { share } else { 1.0 - share };
        let weight = share(k, shares[0]) * share(l, shares[1]);
        if weight != 0.0 {
            sum += weight * plane.at(i + k, j + l);
        }
    }
    sum.is_finite().then_some(sum)
}

/// True displacements of two images relative to the reference image, samples and lines.
#[derive(Debug, Clone, Copy)]
pub struct Truth<'a> {
    /// Of the first image.
    pub from: [Image<'a>; 2],
    /// Of the second.
    pub to: [Image<'a>; 2],
}

impl Truth<'_> {
    /// True shift from a pixel's middle in the first image to the second: its place in the reference image is found by
    /// iteration.
    fn at(&self, pixel: [usize; 2]) -> Option<[f64; 2]> {
        let pixel = pixel.map(|i| i as f64);
        let moved = |by: [Image<'_>; 2], at: [f64; 2]| Some([between(by[0], at)?, between(by[1], at)?]);
        let mut at = pixel;
        for _ in 0..STEPS {
            let by = moved(self.from, at)?;
            at = [pixel[0] - by[0], pixel[1] - by[1]];
        }
        let (from, to) = (moved(self.from, at)?, moved(self.to, at)?);
        Some([to[0] - from[0], to[1] - from[1]])
    }
}

/// Matches windows all over an image, wherever the search area fits.
pub fn tried(of: Image<'_>, within: Image<'_>, truth: Truth<'_>, windows: Windows) -> Vec<Tried> {
    let reach = windows.half.saturating_add(windows.search).saturating_add(BESIDE);
    let middles = |n: usize| (reach..n.saturating_sub(reach)).step_by(windows.step.max(1));
    let pixels: Vec<[usize; 2]> =
        middles(of.lines).flat_map(|line| middles(of.samples).map(move |sample| [sample, line])).collect();
    let tried =
        |pixel: [usize; 2]| Tried { pixel, found: matched(of, within, pixel, windows), truth_px: truth.at(pixel) };
    pixels.into_par_iter().map(tried).collect()
}

/// Quality where the truth is known.
pub fn quality(tried: &[Tried]) -> Quality {
    let mut errors: Vec<f64> = tried.iter().filter_map(Tried::error_px).collect();
    errors.sort_unstable_by(f64::total_cmp);
    let rank = |share: f64| {
        let rank = whole((share * errors.len() as f64).ceil().max(1.0));
        errors.get(rank - 1).copied().unwrap_or(f64::NAN)
    };
    let within = errors.iter().filter(|error| **error <= 0.5).count();
    Quality {
        windows: tried.iter().filter(|window| window.truth_px.is_some()).count(),
        matched: errors.len(),
        median_px: rank(0.5),
        p95_px: rank(0.95),
        within_half: within as f64 / errors.len() as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Draws;
    use std::f64::consts::TAU;

    const SIZE: usize = 64;

    /// A sum of waves of up to a quarter of a cycle a pixel, moved by parts of a pixel: noise that is known between pixels too.
    fn waves(seed: u64, [dx, dy]: [f64; 2]) -> Vec<f64> {
        let mut draws = Draws::new(seed);
        let waves: Vec<[f64; 3]> =
            (0..60).map(|_| [draws.between(-0.25, 0.25), draws.between(-0.25, 0.25), draws.unit()]).collect();
        let value =
            |x: f64, y: f64| waves.iter().map(|[u, v, phase]| (TAU * (u * x + v * y + phase)).cos()).sum::<f64>();
        (0..SIZE * SIZE).map(|k| 100.0 + value((k % SIZE) as f64 - dx, (k / SIZE) as f64 - dy)).collect()
    }

    fn image(values: &[f64]) -> Image<'_> {
        Image { values, samples: SIZE, lines: SIZE }
    }

    /// Moved by parts of a pixel, brighter and with more contrast: found to a twentieth of a pixel everywhere.
    #[test]
    fn a_known_shift_is_found() {
        for (seed, shift) in [(1, [0.37, -1.61]), (2, [-2.5, 0.5]), (3, [0.0, 0.0]), (4, [3.25, 2.9])] {
            let (of, within) = (waves(seed, [0.0, 0.0]), waves(seed, shift));
            let within: Vec<f64> = within.iter().map(|value| 3.0 * value - 40.0).collect();
            let windows = Windows { half: 7, search: 5, step: 9 };
            let (zero, moved) = (vec![0.0; SIZE * SIZE], shift.map(|by| vec![by; SIZE * SIZE]));
            let truth = Truth { from: [image(&zero); 2], to: [image(&moved[0]), image(&moved[1])] };
            let tried = tried(image(&of), image(&within), truth, windows);
            // Windows whose search stays within the image, at least, are all found.
            let inner: Vec<&Tried> =
                tried.iter().filter(|t| t.pixel.iter().all(|i| (14..SIZE - 14).contains(i))).collect();
            assert!(inner.len() >= 16 && inner.iter().all(|t| t.found.is_some()), "{}", inner.len());
            for window in tried.iter().filter(|t| t.found.is_some()) {
                assert!(window.error_px().unwrap() < 0.05, "{shift:?}: {window:?}");
            }
            let quality = quality(&tried);
            assert!(quality.within_half == 1.0 && quality.p95_px < 0.05 && quality.median_px <= quality.p95_px);
        }
    }

    #[test]
    fn what_tells_nothing_is_no_match() {
        let windows = Windows { half: 5, search: 4, step: 1 };
        let found = |of: &[f64], within: &[f64]| matched(image(of), image(within), [30, 30], windows);
        let flat = vec![7.0; SIZE * SIZE];
        let texture = waves(1, [0.0, 0.0]);
        let noise = |seed: u64| {
            let mut draws = Draws::new(seed);
            (0..SIZE * SIZE).map(|_| 100.0 + draws.normal()).collect::<Vec<f64>>()
        };
        // Along x only: where it is along y is open. Every four pixels: which of them is open.
        let stripe: Vec<f64> = (0..SIZE * SIZE).map(|k| 100.0 + ((k % SIZE) as f64 * 0.3).sin()).collect();
        let periodic: Vec<f64> = (0..SIZE * SIZE)
            .map(|k| 100.0 + (TAU * ((k % SIZE) as f64 / 4.0)).cos() + (TAU * ((k / SIZE) as f64 / 4.0)).cos())
            .collect();
        let mut holes = texture.clone();
        holes[30 * SIZE + 32] = f64::NAN;
        for (of, within) in [
            (&flat, &flat),
            (&texture, &flat),
            (&flat, &texture),
            (&noise(1), &noise(2)),
            (&stripe, &stripe),
            (&periodic, &periodic),
            (&holes, &texture),
            (&texture, &waves(1, [9.0, 0.0])),
        ] {
            assert_eq!(found(of, within), None);
        }
        assert!(found(&texture, &texture).is_some());
        assert_eq!(matched(image(&texture), image(&texture), [2, 30], windows), None, "out of the image");
        let empty = Truth { from: [image(&[]); 2], to: [image(&[]); 2] };
        assert!(
            tried(image(&[]), image(&[]), empty, windows).iter().all(|t| t.found.is_none() && t.truth_px.is_none())
        );
    }

    /// Of an image that is not a reference: what is at 10 there is at 12 in the reference, where the other is off by 2 + 12 / 10 more.
    #[test]
    fn the_truth_between_two_images_goes_by_the_reference() {
        let [back, on, nothing] = [
            (0..SIZE * SIZE).map(|_| -2.0).collect::<Vec<f64>>(),
            (0..SIZE * SIZE).map(|k| 0.1 * (k % SIZE) as f64).collect(),
            vec![0.0; SIZE * SIZE],
        ];
        let truth = Truth { from: [image(&back), image(&nothing)], to: [image(&on), image(&nothing)] };
        let found = truth.at([10, 20]).unwrap();
        assert!((found[0] - 3.2).abs() < 1e-12 && found[1] == 0.0, "{found:?}");
        assert_eq!(truth.at([63, 20]), None, "beyond the reference");
    }
}
