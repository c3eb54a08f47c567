//! Smile and keystone of a push-broom spectrometer.

use crate::error::{Location, Problem};
use crate::geometry::polynomial;
use crate::spectral::{Band, Response};

/// Largest keystone, pixels; more is taken as a mistake.
const MOST_PX: f64 = 16.0;

/// Polynomials of a coordinate from -1 to 1, lowest order first; empty: no shift.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spectrometer {
    /// Smile: shift of all band centres at a sample, um. The coordinate is the sample's centre, from -1 at the first
    /// one's outer border to 1 at the last one's.
    pub smile_um: Vec<f64>,
    /// Keystone: shift of a band along the slit, pixels. The coordinate is the band's centre, from -1 at the shortest
    /// one to 1 at the longest; 0 for a single one.
    pub keystone_px: Vec<f64>,
}

impl Spectrometer {
    /// Whether it is an ideal one.
    pub fn is_ideal(&self) -> bool {
        self.smile_um.iter().chain(&self.keystone_px).all(|c| *c == 0.0)
    }

    /// Smile of each sample, um.
    pub fn smiles_um(&self, samples: u32) -> Vec<f64> {
        let at = |sample: u32| (2.0 * f64::from(sample) + 1.0) / f64::from(samples) - 1.0;
        (0..samples).map(|sample| polynomial(&self.smile_um, at(sample))).collect()
    }

    /// Keystone of each band, pixels.
    pub fn keystones_px(&self, bands: &[Band]) -> Vec<f64> {
        let (low, high) = bands
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), b| (b.centre_um.min(low), b.centre_um.max(high)));
        let at = |um: f64| if high > low { 2.0 * (um - low) / (high - low) - 1.0 } else { 0.0 };
        bands.iter().map(|band| polynomial(&self.keystone_px, at(band.centre_um))).collect()
    }

    /// Range of keystone, pixels, in steps of at most one: an image shifted by each covers what all bands see.
    pub fn steps_px(&self, bands: &[Band]) -> Vec<f64> {
        let all = self.keystones_px(bands);
        let (low, high) =
            all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), px| (px.min(low), px.max(high)));
        let steps = crate::geometry::whole_u32((high - low).ceil());
        (0..=steps).map(|i| if i == 0 { low } else { low + (high - low) * f64::from(i) / f64::from(steps) }).collect()
    }

    /// Problems with it, for an image of these samples and bands.
    pub(super) fn problems(&self, samples: u32, bands: &[Band]) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut problem = |item: &str, message: String| problems.push(Problem::new(Location::item(item), message));
        if self.smile_um.iter().any(|c| *c != 0.0) {
            if bands.iter().any(|band| matches!(band.response, Response::Table(_))) {
                problem("sensor.smile_um", "shifts bands by their centres, which tables of responses have not".into());
            }
            let shortest_um = bands.iter().map(|band| band.centre_um).fold(f64::INFINITY, f64::min);
            let smiles_um = self.smiles_um(samples);
            if let Some(odd) = smiles_um.iter().find(|um| um.is_nan() || um.abs() >= 0.5 * shortest_um) {
                problem("sensor.smile_um", format!("shifts a band by {odd} um; coefficients are in um"));
            }
        }
        if let Some(odd) = self.keystones_px(bands).iter().find(|px| px.is_nan() || px.abs() > MOST_PX) {
            problem("sensor.keystone_px", format!("shifts a band by {odd} pixels, more than {MOST_PX}"));
        }
        problems
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_go_from_one_end_to_the_other() {
        let of = Spectrometer { smile_um: vec![0.1, 1.0, 0.5], keystone_px: vec![0.0, 2.0] };
        // Four samples: -3/4, -1/4, 1/4, 3/4; 0.1 + u + u^2 / 2.
        let expected = [-0.36875, -0.11875, 0.38125, 1.13125];
        assert!(of.smiles_um(4).iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15));
        let bands: Vec<Band> = [3.0, 1.0, 1.5].iter().map(|um| Band::new(*um, None)).collect();
        assert_eq!(of.keystones_px(&bands), [2.0, -2.0, -1.0]);
        assert_eq!(of.keystones_px(&bands[..1]), [0.0]);
        assert_eq!(of.steps_px(&bands), [-2.0, -1.0, 0.0, 1.0, 2.0]);
        assert_eq!(of.steps_px(&bands[..1]), [0.0]);
        assert!(Spectrometer { smile_um: vec![0.0], ..Spectrometer::default() }.is_ideal() && !of.is_ideal());
        assert_eq!(of.problems(4, &bands).len(), 1);
    }
}
