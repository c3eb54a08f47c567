//! A spectral band of a sensor.

/// A band: monochromatic, or a Gaussian response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Centre wavelength, um.
    pub centre_um: f64,
    /// Full width at half maximum of a Gaussian response, um; `None`: monochromatic.
    pub fwhm_um: Option<f64>,
}

/// The response is cut this many standard deviations from the centre: exp(-k^2/2) = 1.5e-8 there.
const CUT_SIGMA: f64 = 6.0;
/// Simpson intervals between two knots, per standard deviation.
const STEPS_PER_SIGMA: f64 = 16.0;

impl Band {
    /// First and last wavelength that the band looks at, um.
    pub fn support_um(&self) -> (f64, f64) {
        let reach = CUT_SIGMA * self.sigma_um();
        (self.centre_um - reach, self.centre_um + reach)
    }

    /// Radiance in the band, W m-2 sr-1, from radiance per um: L times the FWHM; `None` for a monochromatic band.
    ///
    /// Source: equation (16) of Domagala (2020), a rectangle as wide as the FWHM. Limits: with the radiance of the centre, low or
    /// high by (FWHM^2 / 24) L'' / L; a Gaussian response with a peak of 1 lets 1.064 times as much through.
    pub fn in_band_w_m2_sr(&self, radiance_w_m2_sr_um: f64) -> Option<f64> {
        Some(radiance_w_m2_sr_um * self.fwhm_um?)
    }

    fn sigma_um(&self) -> f64 {
        self.fwhm_um.unwrap_or(0.0) / (8.0 * std::f64::consts::LN_2).sqrt()
    }

    /// Wavelengths and weights (sum 1) whose weighted sum is the band's mean of a function that is smooth between `knots_um` (ascending).
    ///
    /// Monochromatic: the centre alone. Gaussian: composite Simpson over the support, broken at the knots,
    /// because tabulated spectra have corners there.
    pub fn quadrature(&self, knots_um: &[f64]) -> Vec<(f64, f64)> {
        if self.fwhm_um.is_none() {
            return vec![(self.centre_um, 1.0)];
        }
        let sigma = self.sigma_um();
        let (lo, hi) = self.support_um();
        let inside = knots_um.iter().copied().filter(|k| lo < *k && *k < hi);
        let mut nodes: Vec<(f64, f64)> = Vec::new();
        let mut start = lo;
        for end in inside.chain([hi]) {
            let steps = 2 * ((end - start) / sigma * STEPS_PER_SIGMA / 2.0).ceil().max(1.0) as usize;
            let step = (end - start) / steps as f64;
            for i in 0..=steps {
                let simpson = if i == 0 || i == steps {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                let um = if i == steps { end } else { start + step * i as f64 };
                let z = (um - self.centre_um) / sigma;
                nodes.push((um, simpson * step / 3.0 * (-0.5 * z * z).exp()));
            }
            start = end;
        }
        let sum: f64 = nodes.iter().map(|n| n.1).sum();
        nodes.iter_mut().for_each(|n| n.1 /= sum);
        nodes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_errs_as_its_second_derivative_says() {
        // Black bodies, radiance of the centre times the width over the integral, less 1: computed independently in 40 digits.
        use crate::physics::blackbody::{band_radiance_w_m2_sr, radiance_w_m2_sr_um};
        for (um, width_um, t_k, error) in
            [(3.0, 0.02, 300.0, -0.000_173_541_730_972), (3.55, 0.1, 250.0, -0.003_239_009_646_838)]
        {
            let band = Band { centre_um: um, fwhm_um: Some(width_um) };
            let in_band = band.in_band_w_m2_sr(radiance_w_m2_sr_um(um, t_k)).unwrap();
            let exact = band_radiance_w_m2_sr(um - 0.5 * width_um, um + 0.5 * width_um, t_k);
            assert!((in_band / exact - 1.0 - error).abs() < 1e-9, "{um}: {in_band} {exact}");
        }
        assert_eq!(Band { centre_um: 1.0, fwhm_um: None }.in_band_w_m2_sr(1.0), None);
    }

    fn mean(band: Band, knots: &[f64], f: impl Fn(f64) -> f64) -> f64 {
        band.quadrature(knots).iter().map(|(um, w)| w * f(*um)).sum()
    }

    #[test]
    fn a_linear_spectrum_is_unchanged() {
        for fwhm_um in [None, Some(0.01), Some(0.2)] {
            let band = Band { centre_um: 2.0, fwhm_um };
            assert!((mean(band, &[], |um| 3.0 * um - 1.0) - 5.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_cosine_is_damped_by_the_transform_of_the_response() {
        // Gaussian of standard deviation s: contrast exp(-2 pi^2 s^2 nu^2).
        let band = Band { centre_um: 2.0, fwhm_um: Some(0.02) };
        let (s, nu) = (0.02 / 2.354_820_045_030_949, 25.0);
        let contrast = mean(band, &[], |um| (2.0 * std::f64::consts::PI * nu * (um - 2.0)).cos());
        let expected = (-2.0 * (std::f64::consts::PI * s * nu).powi(2)).exp();
        assert!((contrast - expected).abs() < 1e-7, "{contrast} {expected}");
    }

    #[test]
    fn a_corner_at_the_centre_gives_the_mean_of_a_half_gaussian() {
        // Mean of |um - centre| is s sqrt(2/pi).
        let band = Band { centre_um: 1.0, fwhm_um: Some(0.1) };
        let s = 0.1 / 2.354_820_045_030_949;
        let expected = s * (2.0 / std::f64::consts::PI).sqrt();
        assert!((mean(band, &[1.0], |um| (um - 1.0).abs()) / expected - 1.0).abs() < 1e-6);
    }
}
