//! Instruments by name: what is published of them, and what is assumed where nothing is.

use super::types::Preset;
use crate::scene::Readout;
use crate::spectral::Band;

/// What a preset says where a scene does not.
pub(super) struct Instrument {
    pub(super) name: &'static str,
    pub(super) samples: u32,
    /// None of a push-broom, which takes as many as it is told to.
    pub(super) lines: Option<u32>,
    pub(super) ifov_mrad: f64,
    /// First and last centre, um, their number, and the width of each, if they have one.
    pub(super) bands: (f64, f64, u32, Option<f64>),
    /// What it takes at once where something moves.
    pub(super) readout: Readout,
    /// From one exposure to the next, s, if that is known.
    pub(super) period_s: Option<f64>,
    /// Focal length over aperture.
    pub(super) f_number: f64,
    /// Pitch of pixels, um.
    pub(super) pixel_um: f64,
    /// What optics without diffraction pass of half a cycle per pixel.
    pub(super) gaussian_mtf_nyquist: f64,
    /// Electrons per photon that enters.
    pub(super) throughput: f64,
    /// Width of bands that have none, um.
    pub(super) width_um: Option<f64>,
    /// How its detector counts.
    pub(super) reading: &'static Reading,
}

/// How a detector counts.
pub(super) struct Reading {
    /// Dark current, electrons per second.
    pub(super) dark_e_s: f64,
    /// Read noise, electrons.
    pub(super) read_e: f64,
    /// Full well, electrons.
    pub(super) full_well_e: f64,
    /// Gain, electrons per DN.
    pub(super) gain_e_dn: f64,
    /// Offset, DN.
    pub(super) offset_dn: f64,
    /// Bit depth.
    pub(super) bits: u32,
    /// PRNU, standard deviation.
    pub(super) prnu: f64,
}

/// Nothing of this is published of either instrument: what detectors of this kind have. Lambert ground of 0.07 under an overhead Sun at 1.5 au fills them to about three
/// quarters in a second, where it is brightest: in the first band.
const ASSUMED: Reading = Reading {
    dark_e_s: 1e4,
    read_e: 100.0,
    full_well_e: 4e6,
    gain_e_dn: 64.0,
    offset_dn: 200.0,
    bits: 16,
    prnu: 0.002,
};

/// MacrOmega (Domagala 2020, I.C): 256 x 256 pixels, a tunable filter, 300 bands of a second each, less than 10 nm apart; pixels below 20 m from 25 km. Its field of view is assumed, and all of
/// its optics and detector.
const MACROMEGA: Instrument = Instrument {
    name: "MacrOmega",
    samples: 256,
    lines: Some(256),
    ifov_mrad: 0.5,
    bands: (0.95, 3.6, 300, None),
    readout: Readout::Band,
    period_s: Some(1.0),
    f_number: 4.0,
    pixel_um: 30.0,
    gaussian_mtf_nyquist: 0.7,
    throughput: 0.2,
    width_um: Some(0.01),
    reading: &ASSUMED,
};

/// MIRS (Barucci et al. 2021, table 2): a slit of 3.3 deg with pixels of 0.35 mrad, 0.9 to 3.6 um, a band of 20 nm every 10 nm. That a pixel is square, and that
/// bands are Gaussian, is assumed; on a detector of 256 columns a band would be every 10.5 nm. Pixels of 30 um are published, and that more than 0.08 passes at Nyquist and that signal over noise is at least 100 from 2.7 to 3.2 um in 2 s; the
/// rest of its optics and detector is assumed, so that it does.
const MIRS: Instrument = Instrument {
    name: "MIRS",
    samples: 165,
    lines: None,
    ifov_mrad: 0.35,
    bands: (0.9, 3.6, 271, Some(0.02)),
    readout: Readout::Line,
    period_s: None,
    f_number: 4.0,
    pixel_um: 30.0,
    gaussian_mtf_nyquist: 0.5,
    throughput: 0.08,
    width_um: None,
    reading: &ASSUMED,
};

impl Preset {
    pub(super) fn instrument(self) -> &'static Instrument {
        match self {
            Preset::Macromega => &MACROMEGA,
            Preset::Mirs => &MIRS,
        }
    }
}

impl Instrument {
    pub(super) fn bands(&self) -> Vec<Band> {
        let (start_um, stop_um, count, fwhm_um) = self.bands;
        Band::evenly(start_um, stop_um, count).into_iter().map(|band| Band { fwhm_um, ..band }).collect()
    }

    /// Its bands, in words.
    pub(super) fn told(&self) -> String {
        let (start_um, stop_um, count, fwhm_um) = self.bands;
        let width = fwhm_um.map_or("monochromatic".to_owned(), |um| format!("{um} um wide"));
        format!("{}: {count} bands from {start_um} to {stop_um} um, {width}", self.name)
    }
}
