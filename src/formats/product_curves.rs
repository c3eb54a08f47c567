//! Curves over the bands of a product: how far they lie apart, and signal over noise.

use super::spectrum_svg;
use crate::product::Plane;
use crate::spectral::Band;
use crate::study::BandSignal;

/// How far 95 of 100 pixels lie from where they are in the reference band at most, along one axis, pixels; NaN where nothing is shown.
pub(super) fn within_px(plane: &Plane) -> f64 {
    let mut away: Vec<f64> = plane.values.iter().map(|value| value.abs()).filter(|px| px.is_finite()).collect();
    away.sort_by(f64::total_cmp);
    away.get(away.len().saturating_sub(1) * 95 / 100).copied().unwrap_or(f64::NAN)
}

/// How far bands lie from the reference band: along samples, then lines, of each band.
pub(super) fn displacement_svg(within_px: &[f64]) -> String {
    let bands: Vec<f64> = (1..=within_px.len() / 2).map(|i| i as f64).collect();
    let along = |axis: usize| within_px.iter().skip(axis).step_by(2).copied().collect::<Vec<_>>();
    let curves = [("samples", along(0)), ("lines", along(1))];
    let title = "Displacement against the reference band: 95th percentile of the pixels";
    spectrum_svg::draw(title, "band", "pixels", &bands, &curves)
}

/// Signal over noise of each band.
pub(super) fn signal_svg(bands: &[Band], signal: &[BandSignal]) -> String {
    let um: Vec<f64> = bands.iter().map(|band| band.centre_um).collect();
    let of = |value: fn(&BandSignal) -> f64| signal.iter().map(value).collect::<Vec<_>>();
    let curves = [("mean radiance", of(|s| s.snr_mean)), ("lowest radiance", of(|s| s.snr_lowest))];
    spectrum_svg::draw("Signal over noise", "um", "signal over noise", &um, &curves)
}
