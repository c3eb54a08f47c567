//! How far optics, motion and a detector's area let contrast through (modulation transfer), and what they make of an edge.
//!
//! Frequencies are cycles per pixel, lengths pixels. Of what is convolved, the transfer functions multiply.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_PI, PI};

/// Transfer of a mean over a length d, as of a detector's area, or of steady motion during an exposure: sinc(f d) = sin(pi f d) / (pi f d).
///
/// Source: the Fourier transform of a box. Negative where contrast is reversed: |f d| from 1 to 2.
pub fn mean(cycles_per_px: f64, length_px: f64) -> f64 {
    let x = PI * cycles_per_px * length_px;
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// Transfer of a Gaussian of this standard deviation, as of jitter that is fast beside an exposure: exp(-2 pi^2 s^2 f^2).
///
/// Source: the Fourier transform of a Gaussian.
pub fn gaussian(cycles_per_px: f64, sigma_px: f64) -> f64 {
    (-2.0 * (PI * sigma_px * cycles_per_px).powi(2)).exp()
}

/// The standard deviation, pixels, of the Gaussian that lets this much through at half a cycle per pixel: the inverse of [`gaussian`].
pub fn sigma_px(transfer_at_nyquist: f64) -> f64 {
    (-0.5 * transfer_at_nyquist.ln()).sqrt() / (0.5 * PI)
}

/// Transfer of a perfect lens with a circular aperture: (2 / pi) (acos v - v sqrt(1 - v^2)), 0 beyond v = 1; v = f l F / p is the frequency over that at which nothing passes.
///
/// Source: Goodman, *Introduction to Fourier Optics*, 3rd edition, equation 6-32. Limits: incoherent light, in focus, without aberrations or a central obstruction.
pub fn diffraction(v: f64) -> f64 {
    let v = v.abs();
    if v < 1.0 { FRAC_2_PI * (v.acos() - v * (1.0 - v * v).sqrt()) } else { 0.0 }
}

/// A bright side x > 0 of 1 beside a dark one, blurred by a Gaussian, at x pixels: (1 + erf(x / (s sqrt 2))) / 2.
pub fn gaussian_edge(x_px: f64, sigma_px: f64) -> f64 {
    0.5 * libm::erfc(-x_px / sigma_px * FRAC_1_SQRT_2)
}

/// The mean of [`gaussian_edge`] over a pixel whose centre is x pixels from the edge: the difference of its primitive at the pixel's sides.
pub fn gaussian_edge_mean(x_px: f64, sigma_px: f64) -> f64 {
    let density = |x: f64| (-0.5 * (x / sigma_px).powi(2)).exp() / (sigma_px * (2.0 * PI).sqrt());
    let primitive = |x: f64| x * gaussian_edge(x, sigma_px) + sigma_px * sigma_px * density(x);
    primitive(x_px + 0.5) - primitive(x_px - 0.5)
}

/// The mean over a pixel, 0 to 1, and over an exposure, of a bright side that reaches from the pixel's start to an edge, which goes steadily from one place to another.
///
/// The mean of clamp(e, 0, 1) over e: differences of its primitive. Limits: an edge that stands still is at its place.
pub fn smeared_edge(from_px: f64, to_px: f64) -> f64 {
    if from_px == to_px {
        return from_px.clamp(0.0, 1.0);
    }
    let primitive = |e: f64| if e > 1.0 { e - 0.5 } else { 0.5 * e.max(0.0).powi(2) };
    (primitive(to_px) - primitive(from_px)) / (to_px - from_px)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transfer_is_as_computed_by_hand() {
        // sinc(1/2) = 2 / pi; the diffraction limit's at half of its cutoff is 2/3 - sqrt(3) / (2 pi).
        assert!((mean(0.5, 1.0) - FRAC_2_PI).abs() < 1e-15);
        assert!((diffraction(0.5) - (2.0 / 3.0 - 3.0_f64.sqrt() / (2.0 * PI))).abs() < 1e-15);
        assert_eq!([diffraction(0.0), diffraction(1.0), diffraction(-2.0), mean(0.0, 1.0)], [1.0, 0.0, 0.0, 1.0]);
        // 0.2 at Nyquist is found again.
        assert!((gaussian(0.5, sigma_px(0.2)) - 0.2).abs() < 1e-15);
    }

    #[test]
    fn an_edge_leaves_a_pixel_by_shares() {
        assert!((smeared_edge(0.4, 1.0) - 0.7).abs() < 1e-15);
        assert!((smeared_edge(0.7, 1.3) - 0.925).abs() < 1e-15);
        assert_eq!([smeared_edge(0.3, 0.3), smeared_edge(-2.0, -1.0), smeared_edge(2.0, 3.0)], [0.3, 0.0, 1.0]);
        // Far from the edge nothing is blurred, and both sides add up to 1.
        assert_eq!(gaussian_edge_mean(9.0, 0.3), 1.0);
        assert!((gaussian_edge_mean(0.7, 0.5) + gaussian_edge_mean(-0.7, 0.5) - 1.0).abs() < 1e-15);
    }
}
