//! Bands against what spectra are known for.

use crate::spectral::{ALL_UM, Band, MOST_BEYOND, Spectrum};

/// The first relevant band that reaches too far beyond where a spectrum is known, as a sentence.
pub(crate) fn uncovered(
    what: &str,
    spectrum: &Spectrum,
    bands: &[Band],
    counts: impl Fn(&Band) -> bool,
) -> Option<String> {
    let known_um = spectrum.coverage_um();
    let is_outside = |i: &usize| {
        let band = &bands[*i];
        // A response at wavelengths below 0 is reported for the band.
        counts(band) && band.share_beyond(known_um) > MOST_BEYOND && band.share_beyond(ALL_UM) <= MOST_BEYOND
    };
    let outside: Vec<usize> = (0..bands.len()).filter(is_outside).collect();
    let i = *outside.first()?;
    let share = match bands[i].fwhm_um {
        Some(_) => format!(": {} of its response lies beyond", percent(bands[i].share_beyond(known_um))),
        None => String::new(),
    };
    let (first, last) = known_um;
    Some(format!(
        "{what} is known from {first} to {last} um, which does not cover band {} at {} um{share}{}",
        i + 1,
        bands[i].centre_um,
        match outside.len() {
            1 => String::new(),
            n => format!(" and {} more", n - 1),
        }
    ))
}

/// A share in percent, with enough digits to distinguish it from 0 and 100.
pub(super) fn percent(share: f64) -> String {
    if share < 0.001 { format!("{:.1e} %", 100.0 * share) } else { format!("{:.1} %", 100.0 * share) }
}
