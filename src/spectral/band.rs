//! A spectral band of a sensor.

use std::sync::Arc;

use super::{Extend, Light, Spectrum, sinc_squared};
use crate::geometry::whole;

/// A band: monochromatic, or a mean over a response.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// What it is called, as a filter; mostly nothing.
    pub name: String,
    /// Centre wavelength, um. Of a tabulated response R, the mean of wavelength over it: integral of R l / integral of R.
    pub centre_um: f64,
    /// Full width at half maximum, um; `None`: monochromatic. Of a tabulated response, its equivalent width: its integral over its largest value.
    pub fwhm_um: Option<f64>,
    /// The shape of the response.
    pub response: Response,
    /// What light is in it.
    pub light: Light,
}

/// The shape of a band's response. Only relative values count.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Response {
    /// A Gaussian, cut 6 standard deviations from the centre.
    #[default]
    Gaussian,
    /// The same within the full width, nothing beyond.
    Box,
    /// A squared sinc, as of a tunable filter: sinc^2((l - centre) / D), cut [`sinc_squared::CUT_NULLS`] zeros D from the centre.
    Sinc2,
    /// Linear between points, nothing beyond them: see [`Band::tabulated`].
    Table(Arc<Spectrum>),
}

impl Response {
    /// The points of a table: relative, the largest is 1.
    pub fn table(&self) -> Option<&Spectrum> {
        match self {
            Response::Table(table) => Some(table),
            Response::Gaussian | Response::Box | Response::Sinc2 => None,
        }
    }

    /// What its shape is called in files.
    pub fn name(&self) -> &'static str {
        match self {
            Response::Gaussian => "gaussian",
            Response::Box => "box",
            Response::Sinc2 => "sinc2",
            Response::Table(_) => "table",
        }
    }
}

/// The response is cut this many standard deviations from the centre: exp(-k^2/2) = 1.5e-8 there.
const CUT_SIGMA: f64 = 6.0;
/// Simpson intervals between two knots, per standard deviation.
const STEPS_PER_SIGMA: f64 = 16.0;
/// Simpson intervals between two knots, from a zero of a squared sinc to the next.
const STEPS_PER_NULL: f64 = 32.0;
/// Simpson intervals of other responses between two knots, per wavelength: a black body at 100 K has the scale of a fiftieth of 3 um.
const STEPS_PER_WAVELENGTH: f64 = 1024.0;
/// No more of a response may lie where a spectrum is not known: so much of a Gaussian is beyond one of its half-maxima.
pub const MOST_BEYOND: f64 = 0.12;
/// All wavelengths: nothing of a response is cut off, but what is below 0.
pub const ALL_UM: (f64, f64) = (0.0, f64::INFINITY);

impl Band {
    /// A Gaussian response of this full width at half maximum, um; `None`: monochromatic.
    pub fn new(centre_um: f64, fwhm_um: Option<f64>) -> Self {
        Band { name: String::new(), centre_um, fwhm_um, response: Response::Gaussian, light: Light::Both }
    }

    /// Monochromatic bands at even steps from one wavelength to another, um, both included.
    pub fn evenly(start_um: f64, stop_um: f64, count: u32) -> Vec<Self> {
        let last = count.saturating_sub(1);
        let centre_um = |i: u32| match i {
            0 => start_um,
            // Not a rounding error beyond the end: tables may end there too.
            i if i == last => stop_um,
            i => start_um + (stop_um - start_um) * (f64::from(i) / f64::from(last)),
        };
        (0..count).map(|i| Band::new(centre_um(i), None)).collect()
    }

    /// The same response all over a full width, um.
    pub fn boxed(centre_um: f64, width_um: f64) -> Self {
        Band { response: Response::Box, ..Band::new(centre_um, Some(width_um)) }
    }

    /// A response (relative; its ends and unit do not count) that is linear between points and 0 beyond them. Zeros at its ends are left out.
    ///
    /// `None` for negative values, or if there is nothing under it: fewer than two points, or zeros.
    pub fn tabulated(response: &Spectrum) -> Option<Self> {
        let (um, value) = (response.wavelength_um(), response.value());
        let (first, last) = (value.iter().position(|v| *v > 0.0)?, value.iter().rposition(|v| *v > 0.0)?);
        let seen = first.saturating_sub(1)..(last + 2).min(um.len());
        let largest = value.iter().copied().fold(0.0, f64::max);
        if seen.len() < 2 || value.iter().any(|v| *v < 0.0) {
            return None;
        }
        // Of the peak: neither sums nor products of any numbers overflow.
        let share: Vec<f64> = value[seen.clone()].iter().map(|v| v / largest).collect();
        let table = Spectrum::new(um[seen].to_vec(), share, Extend::Error)?;
        let (mut area, mut moment) = (0.0, 0.0);
        for (um, v) in table.wavelength_um().windows(2).zip(table.value().windows(2)) {
            let width = um[1] - um[0];
            area += 0.5 * width * (v[0] + v[1]);
            // About the first point, whose digits are not lost: linear times linear.
            let from = um[0] - table.wavelength_um()[0];
            moment += width * (0.5 * from * (v[0] + v[1]) + width * (v[0] + 2.0 * v[1]) / 6.0);
        }
        // Of points that are next to one another, and next to 0, nothing is left.
        let (centre_um, width_um) = (decimals(table.wavelength_um()[0] + moment / area), decimals(area));
        (width_um > 0.0 && centre_um > 0.0)
            .then(|| Band { response: Response::Table(Arc::new(table)), ..Band::new(centre_um, Some(width_um)) })
    }

    /// First and last wavelength that the band looks at, um; not below 0.
    pub fn support_um(&self) -> (f64, f64) {
        let (lo, hi) = self.reach_um();
        (if lo < 0.0 { 0.0 } else { lo }, hi)
    }

    /// The ends of the response, also where there is no light.
    fn reach_um(&self) -> (f64, f64) {
        let reach = match &self.response {
            Response::Gaussian => CUT_SIGMA * self.sigma_um(),
            Response::Box => 0.5 * self.fwhm_um.unwrap_or(0.0),
            Response::Sinc2 => f64::from(sinc_squared::CUT_NULLS) * self.first_null_um(),
            Response::Table(table) => return table.coverage_um(),
        };
        (self.centre_um - reach, self.centre_um + reach)
    }

    /// What the band looks at of wavelengths that something is known at, um.
    pub fn support_within_um(&self, (first_um, last_um): (f64, f64)) -> (f64, f64) {
        let (lo, hi) = self.support_um();
        (if first_um > lo { first_um } else { lo }, if last_um < hi { last_um } else { hi })
    }

    /// Share of the response at wavelengths where something is not known, um, and below 0; of a monochromatic band 0 or 1.
    pub fn share_beyond(&self, known_um: (f64, f64)) -> f64 {
        let (first_um, last_um) = known_um;
        let Some(width_um) = self.fwhm_um else {
            return if first_um <= self.centre_um && self.centre_um <= last_um { 0.0 } else { 1.0 };
        };
        let (lo, hi) = self.reach_um();
        if lo >= first_um.max(0.0) && hi <= last_um {
            return 0.0;
        }
        let whole = self.equivalent_width_um().unwrap_or(width_um);
        let within: f64 = self.nodes(&[], known_um).iter().map(|n| n.1).sum();
        (1.0 - within / whole).clamp(0.0, 1.0)
    }

    /// Integral of the response over its largest value, um; `None` for a monochromatic band. Of a Gaussian 1.064 times its full width at half maximum, of a squared sinc 1.122 times.
    pub fn equivalent_width_um(&self) -> Option<f64> {
        let width_um = self.fwhm_um?;
        Some(match &self.response {
            Response::Gaussian => self.sigma_um() * std::f64::consts::TAU.sqrt(),
            Response::Sinc2 => self.first_null_um() * sinc_squared::energy_within(sinc_squared::CUT_NULLS),
            Response::Box | Response::Table(_) => width_um,
        })
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

    /// From the centre of a squared sinc to where it is first 0, um.
    fn first_null_um(&self) -> f64 {
        0.5 * self.fwhm_um.unwrap_or(0.0) / sinc_squared::HALF_WIDTH
    }

    /// Wavelengths and weights (sum 1) whose weighted sum is the band's mean of a function that is smooth between `knots_um`
    /// (ascending), over what it looks at within `known_um`.
    ///
    /// Monochromatic: the centre alone. Else composite Simpson over the support, broken at the knots, because tabulated spectra have
    /// corners there, and at those of the response: exact for a box or a table times products that are cubic in all.
    pub fn quadrature(&self, knots_um: &[f64], known_um: (f64, f64)) -> Vec<(f64, f64)> {
        if self.fwhm_um.is_none() {
            return vec![(self.centre_um, 1.0)];
        }
        let mut nodes = self.nodes(knots_um, known_um);
        let sum: f64 = nodes.iter().map(|n| n.1).sum();
        nodes.iter_mut().for_each(|n| n.1 /= sum);
        nodes
    }

    /// Nodes and weights that integrate the response times a function.
    fn nodes(&self, knots_um: &[f64], known_um: (f64, f64)) -> Vec<(f64, f64)> {
        let sigma = self.sigma_um();
        let (lo, hi) = self.support_within_um(known_um);
        if lo >= hi {
            return vec![];
        }
        let merged;
        let knots_um = match &self.response {
            Response::Table(table) => {
                let mut all = [knots_um, table.wavelength_um()].concat();
                all.sort_by(f64::total_cmp);
                all.dedup();
                merged = all;
                &merged
            }
            _ => knots_um,
        };
        let response = |um: f64| match &self.response {
            Response::Gaussian => {
                let z = (um - self.centre_um) / sigma;
                (-0.5 * z * z).exp()
            }
            Response::Box => 1.0,
            Response::Sinc2 => sinc_squared::at((um - self.centre_um) / self.first_null_um()),
            Response::Table(table) => table.at(um).unwrap_or(0.0),
        };
        let inside = knots_um.iter().copied().filter(|k| lo < *k && *k < hi);
        let mut nodes: Vec<(f64, f64)> = Vec::new();
        let mut start = lo;
        for end in inside.chain([hi]) {
            let wanted = match self.response {
                Response::Gaussian => (end - start) / sigma * STEPS_PER_SIGMA,
                Response::Sinc2 => (end - start) / self.first_null_um() * STEPS_PER_NULL,
                // By the middle: the short end may be 0.
                _ => (end - start) / (0.5 * (start + end)) * STEPS_PER_WAVELENGTH,
            };
            let steps = 2 * whole((wanted / 2.0).ceil()).max(1);
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
                nodes.push((um, simpson * step / 3.0 * response(um)));
            }
            start = end;
        }
        nodes
    }
}

/// A sum of many, without the digits that are rounding: to 13 of them.
fn decimals(sum: f64) -> f64 {
    format!("{sum:.12e}").parse().unwrap_or(sum)
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
            let band = Band::new(um, Some(width_um));
            let in_band = band.in_band_w_m2_sr(radiance_w_m2_sr_um(um, t_k)).unwrap();
            let exact = band_radiance_w_m2_sr(um - 0.5 * width_um, um + 0.5 * width_um, t_k);
            assert!((in_band / exact - 1.0 - error).abs() < 1e-9, "{um}: {in_band} {exact}");
        }
        assert_eq!(Band::new(1.0, None).in_band_w_m2_sr(1.0), None);
    }

    fn mean(band: Band, knots: &[f64], f: impl Fn(f64) -> f64) -> f64 {
        band.quadrature(knots, ALL_UM).iter().map(|(um, w)| w * f(*um)).sum()
    }

    #[test]
    fn a_linear_spectrum_is_unchanged() {
        for fwhm_um in [None, Some(0.01), Some(0.2)] {
            let band = Band::new(2.0, fwhm_um);
            assert!((mean(band, &[], |um| 3.0 * um - 1.0) - 5.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_cosine_is_damped_by_the_transform_of_the_response() {
        // Gaussian of standard deviation s: contrast exp(-2 pi^2 s^2 nu^2).
        let band = Band::new(2.0, Some(0.02));
        let (s, nu) = (0.02 / 2.354_820_045_030_949, 25.0);
        let contrast = mean(band, &[], |um| (2.0 * std::f64::consts::PI * nu * (um - 2.0)).cos());
        let expected = (-2.0 * (std::f64::consts::PI * s * nu).powi(2)).exp();
        assert!((contrast - expected).abs() < 1e-7, "{contrast} {expected}");
    }

    #[test]
    fn a_cosine_is_damped_by_the_triangle_of_a_squared_sinc() {
        // Contrast 1 - nu D, D the first null; what is cut off, 1 / (pi^2 N) of the whole at N nulls, is spread over the rest.
        let (fwhm_um, nu) = (0.02, 25.0);
        let band = Band { response: Response::Sinc2, ..Band::new(2.0, Some(fwhm_um)) };
        let first_null_um = fwhm_um / 0.885_892_941_378_904_7;
        let contrast = mean(band.clone(), &[], |um| (2.0 * std::f64::consts::PI * nu * (um - 2.0)).cos());
        assert!((contrast - (1.0 - nu * first_null_um)).abs() < 0.007, "{contrast}");
        // Its width is where it is half as high, and a straight line passes as it is.
        assert!((mean(band.clone(), &[], |um| 3.0 * um - 1.0) - 5.0).abs() < 1e-12);
        assert_eq!(band.share_beyond(ALL_UM), 0.0);
        assert!((band.share_beyond((2.0, 9.0)) - 0.5).abs() < 1e-3);
    }

    #[test]
    fn a_corner_at_the_centre_gives_the_mean_of_a_half_gaussian() {
        // Mean of |um - centre| is s sqrt(2/pi).
        let band = Band::new(1.0, Some(0.1));
        let s = 0.1 / 2.354_820_045_030_949;
        let expected = s * (2.0 / std::f64::consts::PI).sqrt();
        assert!((mean(band, &[1.0], |um| (um - 1.0).abs()) / expected - 1.0).abs() < 1e-6);
    }
}
