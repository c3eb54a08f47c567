//! What people write in a campaign file. The published schema is made from these types and their comments.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::formats::envi;
use crate::formats::product_cubes::CubeFormat;
use crate::formats::scene_toml::types::{PointingToml, SensorToml};
use crate::product;

/// Many acquisitions of a scene. Relative paths start at this file's folder.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CampaignToml {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    #[allow(dead_code, reason = "the schema checks it")]
    pub(crate) mmxrt_campaign: u32,
    /// The scene file of all acquisitions: body, materials, models, orbit, pointing and instrument. It must have a
    /// table `flight`.
    pub(crate) scene: String,
    /// The acquisitions: single ones, and series.
    #[schemars(length(min = 1))]
    pub(crate) acquisitions: Vec<AcquisitionToml>,
    /// Where to, and what of each acquisition.
    #[serde(default)]
    pub(crate) output: OutputToml,
    /// Coverage rule: what counts as seen.
    #[serde(default)]
    pub(crate) coverage: CoverageToml,
}

/// An acquisition (`epoch` or `offset_s`), or a series of them (`start`, `stop` and `every_s`; or `epochs`).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AcquisitionToml {
    /// Name of its product's folder. For a series the common beginning; the epoch follows, e.g.
    /// `map_2027-05-01T06-00-00.000` (UTC).
    pub(crate) name: String,
    /// Start of its first exposure, e.g. "2027-05-01T06:00:00 UTC"; time scales are UTC, TAI, TT, TDB and GPS.
    pub(crate) epoch: Option<String>,
    /// The same, s after the scene's `flight.epoch`; may be negative.
    pub(crate) offset_s: Option<f64>,
    /// For a series: its epochs, ascending.
    #[schemars(length(min = 1))]
    pub(crate) epochs: Option<Vec<String>>,
    /// For a series: its first epoch, ...
    pub(crate) start: Option<String>,
    /// ... its end (included), ...
    pub(crate) stop: Option<String>,
    /// ... and the time from one to the next, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) every_s: Option<f64>,
    /// Target point, from the body's centre in body axes, m. The image's up direction is as `pointing` says.
    pub(crate) target_m: Option<[f64; 3]>,
    /// The same by its planetocentric latitude, deg, ...
    #[schemars(range(min = -90, max = 90))]
    pub(crate) latitude_deg: Option<f64>,
    /// ... and east longitude, deg, on the outermost surface there.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) longitude_deg: Option<f64>,
    /// Where the camera looks, instead of the scene's `flight.pointing`.
    pub(crate) pointing: Option<PointingToml>,
    /// Flight-dynamics files, instead of the scene's `flight.files`.
    pub(crate) files: Option<Vec<String>>,
    /// The spacecraft, by its name in the files, instead of the scene's `flight.spacecraft` or `flight.orbit`.
    pub(crate) spacecraft: Option<String>,
    /// An orbit by name instead of the scene's `flight.orbit` or `flight.spacecraft`.
    pub(crate) orbit: Option<String>,
    /// Epoch at which that orbit crosses the line from Phobos to Mars. Default: as in the scene.
    pub(crate) orbit_epoch: Option<String>,
    /// The camera, instead of all of the scene's `sensor`.
    pub(crate) sensor: Option<SensorToml>,
}

/// Where to, and what of each acquisition.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OutputToml {
    /// The campaign's folder, created if missing; `--output` overrides it.
    pub(crate) folder: Option<String>,
    /// Which effects are modelled: `auto` (the default), `thesis`, `full`, or a list, as `--model` of `mmxrt simulate` has it.
    pub(crate) model: Option<String>,
    /// Largest total error of a pixel by everything left out. Default 0.001.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) tolerance: Option<f64>,
    /// Precision of the cube's numbers. Default "f32".
    pub(crate) dtype: Option<DtypeToml>,
    /// Order of the cube's numbers. Default "bsq".
    pub(crate) interleave: Option<InterleaveToml>,
    /// What the numbers of the cube are. Default "radiance".
    pub(crate) quantity: Option<QuantityToml>,
    /// Formats of the cubes. Default ["envi"].
    #[schemars(length(min = 1))]
    pub(crate) formats: Option<Vec<CubeFormat>>,
    /// Also write the cube as spectral OpenEXR.
    #[serde(default)]
    pub(crate) exr: bool,
    /// Also write which facets each pixel sees.
    #[serde(default)]
    pub(crate) footprints: bool,
    /// Also write the facet table.
    #[serde(default)]
    pub(crate) table: bool,
    /// Also write the thermal part of the cube.
    #[serde(default)]
    pub(crate) split: bool,
}

/// Precision of numbers.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum DtypeToml {
    /// Single.
    F32,
    /// Double.
    F64,
}

impl From<DtypeToml> for envi::Precision {
    fn from(dtype: DtypeToml) -> Self {
        match dtype {
            DtypeToml::F32 => envi::Precision::F32,
            DtypeToml::F64 => envi::Precision::F64,
        }
    }
}

/// Order of numbers.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum InterleaveToml {
    /// Band, line, sample.
    Bsq,
    /// Line, band, sample.
    Bil,
    /// Line, sample, band.
    Bip,
}

impl From<InterleaveToml> for envi::Interleave {
    fn from(interleave: InterleaveToml) -> Self {
        match interleave {
            InterleaveToml::Bsq => envi::Interleave::Bsq,
            InterleaveToml::Bil => envi::Interleave::Bil,
            InterleaveToml::Bip => envi::Interleave::Bip,
        }
    }
}

/// What numbers are.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum QuantityToml {
    /// Mean spectral radiance over each band, W m-2 sr-1 um-1.
    Radiance,
    /// Radiance in each band: that times its width, W m-2 sr-1.
    BandRadiance,
    /// I/F: pi times radiance over sunlight normal to its beam.
    RadianceFactor,
    /// Pi times radiance over sunlight on level ground at the origin.
    ReflectanceFactor,
    /// Temperature of the black body of the same radiance in the band, K.
    BrightnessTemperature,
}

impl From<QuantityToml> for product::Quantity {
    fn from(quantity: QuantityToml) -> Self {
        match quantity {
            QuantityToml::Radiance => product::Quantity::Radiance,
            QuantityToml::BandRadiance => product::Quantity::BandRadiance,
            QuantityToml::RadianceFactor => product::Quantity::RadianceFactor,
            QuantityToml::ReflectanceFactor => product::Quantity::ReflectanceFactor,
            QuantityToml::BrightnessTemperature => product::Quantity::BrightnessTemperature,
        }
    }
}

/// What counts as seen, in the record of coverage.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CoverageToml {
    /// Whether only what is in sunlight counts. Default true.
    pub(crate) in_sunlight: Option<bool>,
    /// Largest emission angle at which a facet counts as seen, deg. Default 90.
    #[schemars(range(min = 0, max = 90))]
    pub(crate) most_emission_deg: Option<f64>,
    /// Largest incidence angle at which it does, deg. Default 90; 180 if the dark counts as well.
    #[schemars(range(min = 0, max = 180))]
    pub(crate) most_incidence_deg: Option<f64>,
    /// Pixel sizes on the ground, m, at which the manifest reports how much of the surface is seen at least that
    /// finely. Default 1, 2, 5, 10, 20, 50 and 100.
    #[schemars(length(max = 100))]
    pub(crate) within_m: Option<Vec<f64>>,
}
