//! Electrons that a detector counts, and their noise.

use std::f64::consts::PI;

use super::blackbody;
use super::quadrature::GaussLegendre;
use crate::units::{LIGHT_SPEED_M_S, PLANCK_J_S};

/// Photons of 1 J at a wavelength: l / (h c).
pub fn photons_per_j(lambda_um: f64) -> f64 {
    lambda_um * 1e-6 / (PLANCK_J_S * LIGHT_SPEED_M_S)
}

/// Area of a pixel times the solid angle of the cone of light that a lens of this F-number sends to it, m2 sr: pi p^2 / (4 F^2 + 1).
///
/// Limits: on the axis, for a uniform field; the cone's projected solid angle is pi sin^2 of its half angle, whose tangent is 1 / (2 F).
pub fn etendue_m2_sr(pixel_m: f64, f_number: f64) -> f64 {
    PI * pixel_m * pixel_m / (4.0 * f_number * f_number + 1.0)
}

/// Electrons of 1 W m-2 sr-1 um-1 in a band: its width x etendue x throughput (of optics, times electrons per photon) x time x l / (h c).
///
/// Limits: throughput and photons per joule are those of the band's centre.
pub fn electrons_per_radiance(lambda_um: f64, width_um: f64, etendue_m2_sr: f64, throughput: f64, t_s: f64) -> f64 {
    width_um * etendue_m2_sr * throughput * t_s * photons_per_j(lambda_um)
}

/// Electrons per second of a warm surrounding that fills the cone: emissivity x electrons per photon x etendue x photons of a black body up to a wavelength, m-2 sr-1 s-1.
///
/// Limits: what a cold detector is warmed by from outside its cone is not in it.
pub fn background_electrons_s(t_k: f64, emissivity: f64, etendue_m2_sr: f64, to_um: f64) -> f64 {
    // In ln l the integrand is smooth, and beyond the short end nothing is left of it: exp(-C2 / (l T)) at C2 / (l T) = 700.
    let from_um = blackbody::C2_UM_K / (700.0 * t_k);
    if !(t_k > 0.0 && to_um > from_um) {
        return 0.0;
    }
    let (lo, hi) = (from_um.ln(), to_um.ln());
    let steps = 64;
    let step = (hi - lo) / f64::from(steps);
    let rule = GaussLegendre::new(8);
    let photons = |ln_um: f64| {
        let um = ln_um.exp();
        blackbody::radiance_w_m2_sr_um(um, t_k) * photons_per_j(um) * um
    };
    let part = |i: i32| rule.nodes(lo + f64::from(i) * step, lo + f64::from(i + 1) * step);
    let sum: f64 = (0..steps).flat_map(part).map(|(ln_um, weight)| weight * photons(ln_um)).sum();
    emissivity * etendue_m2_sr * sum
}

/// Variance of a count, electrons squared: what is counted counts at random (Poisson), reading adds R, and rounding to steps of Q electrons Q^2 / 12.
pub fn variance_e2(counted_e: f64, read_e: f64, gain_e_dn: f64) -> f64 {
    counted_e + read_e * read_e + gain_e_dn * gain_e_dn / 12.0
}

/// Signal over noise, of which the signal counts too: N / sqrt(N + D + R^2 + Q^2 / 12 + (s N)^2), s the standard deviation of elements' sensitivities that calibration does not know.
pub fn snr(signal_e: f64, others_e: f64, read_e: f64, gain_e_dn: f64, prnu: f64) -> f64 {
    let variance = variance_e2(signal_e + others_e, read_e, gain_e_dn) + (prnu * signal_e).powi(2);
    if signal_e > 0.0 { signal_e / variance.sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_black_body_sends_as_many_photons_as_the_tables_say() {
        // All photons: 2 zeta(3) c (k T / h c)^3 m-2 sr-1 s-1 = 1.5202e15 T^3 / pi m-2 s-1 sr-1 (2014 CODATA: 1.520 461e15 T^3 m-2 s-1).
        let all = background_electrons_s(300.0, 1.0, 1.0, 1e5);
        assert!((all / (1.520_461e15 * 300.0_f64.powi(3) / PI) - 1.0).abs() < 3e-6, "{all:e}");
        assert_eq!(background_electrons_s(0.0, 1.0, 1.0, 5.0), 0.0);
    }

    #[test]
    fn noise_adds_in_squares() {
        // 100 electrons beside 21 others, read 2, steps of sqrt(12) x 2: sqrt(121 + 4 + 4).
        assert!((snr(100.0, 21.0, 2.0, 48.0_f64.sqrt(), 0.0) - 100.0 / 129.0_f64.sqrt()).abs() < 1e-13);
        assert_eq!(snr(0.0, 0.0, 0.0, 0.0, 0.1), 0.0);
    }
}
