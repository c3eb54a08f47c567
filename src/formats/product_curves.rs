//! Curves over the bands of a product: how far they lie apart, and signal over noise.

use super::spectrum_svg;
use crate::product::Plane;
use crate::spectral::Band;
use crate::study::BandSignal;

/// Of one axis of the displacement of a band: what 5, 50 and 95 % of the pixels stay below; NaN where nothing is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread([f64; 3]);

impl Spread {
    pub(super) fn of(plane: &Plane) -> Self {
        let mut values: Vec<f64> = plane.values.iter().copied().filter(|value| value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let at =
            |percent: usize| values.get(values.len().saturating_sub(1) * percent / 100).copied().unwrap_or(f64::NAN);
        Spread([5, 50, 95].map(at))
    }
}

/// How far bands lie from the reference band: samples, then lines, of each band.
pub(super) fn displacement_svg(spreads: &[Spread]) -> String {
    let bands: Vec<f64> = (1..=spreads.len() / 2).map(|i| i as f64).collect();
    let curve =
        |axis: usize, k: usize| spreads.iter().skip(axis).step_by(2).map(|spread| spread.0[k]).collect::<Vec<_>>();
    let curves = [
        ("samples, median", curve(0, 1)),
        ("samples, 5 %", curve(0, 0)),
        ("samples, 95 %", curve(0, 2)),
        ("lines, median", curve(1, 1)),
        ("lines, 5 %", curve(1, 0)),
        ("lines, 95 %", curve(1, 2)),
    ];
    spectrum_svg::draw("Displacement of bands against the reference band", "band", "pixels", &bands, &curves)
}

/// Signal over noise of each band.
pub(super) fn signal_svg(bands: &[Band], signal: &[BandSignal]) -> String {
    let um: Vec<f64> = bands.iter().map(|band| band.centre_um).collect();
    let of = |value: fn(&BandSignal) -> f64| signal.iter().map(value).collect::<Vec<_>>();
    let curves = [("mean radiance", of(|s| s.snr_mean)), ("lowest radiance", of(|s| s.snr_lowest))];
    spectrum_svg::draw("Signal over noise", "um", "signal over noise", &um, &curves)
}
