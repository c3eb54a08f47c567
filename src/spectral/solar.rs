//! The Sun's spectrum.

use std::sync::OnceLock;

use super::{Extend, Spectrum};

/// Solar spectral irradiance at 1 au, W m-2 um-1, 0.1195 to 1000 um: ASTM E490-00a (2000), 1697 points, linear between them.
///
/// Its integral is 1366.09 W m-2; the present value of the total is 1361 ([`TSI_1AU_W_M2`](crate::units::TSI_1AU_W_M2)).
/// Uncertain by 1 to 3 % below 2 um, 3 to 5 % above 2.5 um.
pub fn solar_e490() -> &'static Spectrum {
    static E490: OnceLock<Spectrum> = OnceLock::new();
    E490.get_or_init(|| {
        let rows = include_str!("e490.csv").lines().filter_map(|line| {
            let (um, irradiance) = line.split_once(',')?;
            Some((um.parse::<f64>().ok()?, irradiance.parse::<f64>().ok()?))
        });
        let (um, irradiance) = rows.unzip();
        Spectrum::new(um, irradiance, Extend::Error).expect("the built-in table is in order: a test reads it")
    })
}

/// What a table of the Sun's irradiance at 1 au has in all.
///
/// A table that ends within sunlight lacks what lies beyond its ends: that is E490's, scaled by the ratio of the two over the
/// wavelengths of the table. A table with more than twice or less than half of the Sun's irradiance is something else, such as a lamp, or in another unit,
/// and has nothing beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunTotal {
    /// Integral of the table, W m-2.
    pub table_w_m2: f64,
    /// What is added beyond its ends, W m-2.
    pub beyond_w_m2: f64,
    /// Irradiance of the table over that of E490 at the same wavelengths; `None` where E490 has none.
    pub times_e490: Option<f64>,
}

impl SunTotal {
    /// That of a table, W m-2 um-1.
    pub fn of(table: &Spectrum) -> Self {
        let e490 = solar_e490();
        let integral = |of: &Spectrum, from_um: f64, to_um: f64| {
            if from_um < to_um { of.integral(from_um, to_um).unwrap_or(0.0) } else { 0.0 }
        };
        let (first, last) = table.coverage_um();
        let (low, high) = e490.coverage_um();
        let (from, to) = (first.max(low), last.min(high));
        // A table of one point has a value, and no integral.
        let both = [table, e490].map(|of| if from < to { integral(of, from, to) } else { of.at(from).unwrap_or(0.0) });
        let times_e490 = (from <= to && both[1] > 0.0).then(|| both[0] / both[1]);
        let beyond = integral(e490, low, first.min(high)) + integral(e490, last.max(low), high);
        let scale = times_e490.filter(|times| SunTotal::is_the_suns(*times)).unwrap_or(0.0);
        SunTotal { table_w_m2: integral(table, first, last), beyond_w_m2: scale * beyond, times_e490 }
    }

    /// Whether a table with this many times the irradiance of E490 may be the Sun's.
    pub fn is_the_suns(times_e490: f64) -> bool {
        (0.5..=2.0).contains(&times_e490)
    }

    /// The table and what is beyond it, W m-2.
    pub fn w_m2(&self) -> f64 {
        self.table_w_m2 + self.beyond_w_m2
    }
}

/// Mean of a spectrum over the wavelengths it is known at, weighted with [`solar_e490`]; `None` if the two do not overlap.
///
/// For a Lambert surface's reflectance this is its Bond albedo, as far as the table goes. Trapezoids on the union of
/// the two tables' points.
pub fn solar_mean(spectrum: &Spectrum) -> Option<f64> {
    let sun = solar_e490();
    let (first, last) = spectrum.coverage_um();
    let (lo, hi) = (sun.coverage_um().0.max(first), sun.coverage_um().1.min(last));
    if lo > hi {
        return None;
    }
    let inside = |um: &f64| lo < *um && *um < hi;
    let mut points: Vec<f64> =
        sun.wavelength_um().iter().chain(spectrum.wavelength_um()).copied().filter(inside).collect();
    points.extend([lo, hi]);
    points.sort_by(f64::total_cmp);
    points.dedup();
    let (mut weighted, mut weight) = (0.0, 0.0);
    for pair in points.windows(2) {
        let half = 0.5 * (pair[1] - pair[0]);
        for &um in pair {
            let irradiance = sun.at(um)?;
            weighted += half * irradiance * spectrum.at(um)?;
            weight += half * irradiance;
        }
    }
    if weight > 0.0 { Some(weighted / weight) } else { spectrum.at(lo) }
}

/// Share of the integral of [`solar_e490`] that lies from one wavelength, um, to another.
pub fn sunlight_share(first_um: f64, last_um: f64) -> f64 {
    let sun = solar_e490();
    let (low, high) = sun.coverage_um();
    let within = sun.integral(first_um.clamp(low, high), last_um.clamp(low, high));
    within.unwrap_or(0.0) / sun.integral(low, high).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn e490_has_the_standards_totals() {
        let sun = solar_e490();
        assert_eq!(sun.wavelength_um().len(), 1697);
        for (lo, hi, total) in [(0.1195, 1000.0, 1366.090796839), (0.2, 5.0, 1359.8763142500002)] {
            assert!((sun.integral(lo, hi).unwrap() / total - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_mean_of_a_constant_is_the_constant() {
        assert!((solar_mean(&Spectrum::constant(0.07)).unwrap() - 0.07).abs() < 1e-15);
        let narrow = Spectrum::new(vec![1.0, 2.0], vec![0.1, 0.1], Extend::Error).unwrap();
        assert!((solar_mean(&narrow).unwrap() - 0.1).abs() < 1e-15);
        let point = Spectrum::new(vec![1.5], vec![0.3], Extend::Error).unwrap();
        assert_eq!(solar_mean(&point), Some(0.3));
        let beyond = Spectrum::new(vec![2000.0], vec![0.3], Extend::Error).unwrap();
        assert_eq!(solar_mean(&beyond), None);
    }

    #[test]
    fn the_mean_of_a_step_is_the_share_of_sunlight_beyond_it() {
        // E490: 485.157 W m-2 from 0.9 to 3.6 um, of 1366.09.
        let step =
            Spectrum::new(vec![0.9, 0.9 + 1e-12, 3.6, 3.6 + 1e-12], vec![0.0, 1.0, 1.0, 0.0], Extend::Hold).unwrap();
        assert!((solar_mean(&step).unwrap() - 485.157 / 1366.09).abs() < 1e-5);
    }
}
