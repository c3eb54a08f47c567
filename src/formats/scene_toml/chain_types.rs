//! Optics and detector as files state them: their comments are the schema's.

use schemars::JsonSchema;
use serde::Deserialize;

use super::values::Values;

/// What blurs and veils an image before the pixels' areas average it. What moves during an exposure is in `exposure_poses` instead.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OpticsToml {
    /// Whether light is spread by diffraction, for which `f_number` and `pixel_um` are needed. Default: if they are given.
    pub(crate) diffraction: Option<bool>,
    /// Standard deviation of a Gaussian that stands for aberrations and focus, pixels.
    #[schemars(range(min = 0, max = 16))]
    pub(crate) gaussian_px: Option<f64>,
    /// The same by what passes of half a cycle per pixel; instead of `gaussian_px`.
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1))]
    pub(crate) gaussian_mtf_nyquist: Option<f64>,
    /// Standard deviation of motion that is fast beside an exposure, pixels.
    #[schemars(range(min = 0, max = 16))]
    pub(crate) jitter_px: Option<f64>,
    /// Steady motion during an exposure, along a line and across, pixels: of scenes that don't say how they move.
    pub(crate) smear_px: Option<[f64; 2]>,
    /// A measured point spread.
    pub(crate) point_spread: Option<PointSpreadToml>,
    /// Share of the light that is scattered evenly over all that is taken at once.
    #[schemars(range(min = 0), extend("exclusiveMaximum" = 1))]
    pub(crate) stray: Option<f64>,
    /// The image is blurred on a grid of so many parts of a pixel, along and across. Default 4: waves of up to 2 cycles per pixel pass as they should.
    #[schemars(range(min = 1, max = 64))]
    pub(crate) subpixels: Option<u32>,
    /// How far light goes, pixels; what would go farther arrives within. Default 8.
    #[schemars(range(min = 1, max = 64))]
    pub(crate) reach_px: Option<u32>,
}

/// A measured point spread: an image of a point, whose place is the image's middle.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointSpreadToml {
    /// Path of an image.
    pub(crate) file: String,
    /// From value to value, pixels of the sensor.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) step_px: f64,
}

/// What counts the light. Without it, the cube is the radiance itself.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DetectorToml {
    /// Electrons per photon that enters the aperture, over wavelength: a number, or path of a CSV table with a column `throughput`.
    pub(crate) throughput: Option<Values>,
    /// Width of bands that have none, um.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) width_um: Option<f64>,
    /// Electrons per second without light. Default 0.
    #[schemars(range(min = 0))]
    pub(crate) dark_e_s: Option<f64>,
    /// Background from the instrument's own radiation, electrons per second, or its temperature. Default 0.
    pub(crate) background: Option<BackgroundToml>,
    /// Read noise, electrons. Default 0.
    #[schemars(range(min = 0))]
    pub(crate) read_e: Option<f64>,
    /// Full well, electrons. Default: that of the largest DN.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) full_well_e: Option<f64>,
    /// Gain, electrons per DN.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) gain_e_dn: Option<f64>,
    /// Offset (bias level), DN. Default: five times the read noise.
    #[schemars(range(min = 0))]
    pub(crate) offset_dn: Option<f64>,
    /// Bit depth. Default 16.
    #[schemars(range(min = 1, max = 32))]
    pub(crate) bits: Option<u32>,
    /// Photo-response non-uniformity (PRNU), standard deviation, not removed by calibration. Default 0.
    #[schemars(range(min = 0, max = 1))]
    pub(crate) prnu: Option<f64>,
    /// Fraction of dead elements. Default 0.
    #[schemars(range(min = 0, max = 1))]
    pub(crate) dead_fraction: Option<f64>,
    /// Seed of the noise. Default 1.
    pub(crate) seed: Option<u64>,
}

/// Background from the instrument's own radiation.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum BackgroundToml {
    /// Electrons per second.
    Electrons(#[schemars(range(min = 0))] f64),
    /// From its temperature.
    Warm(WarmToml),
}

/// A warm instrument, as its detector sees it.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WarmToml {
    /// Its temperature, K.
    #[schemars(range(min = 0))]
    pub(crate) temperature_k: f64,
    /// Its emissivity, times electrons per photon.
    #[schemars(range(min = 0, max = 1))]
    pub(crate) emissivity: f64,
    /// Longest wavelength that the detector sees, um.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) to_um: f64,
}
