//! What people write in a campaign file. The published schema is made from these types and their comments.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::formats::envi;
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
    /// The scene file that all are acquisitions of: its body, materials, models, orbit, pointing and instrument. It has a table `flight`.
    pub(crate) scene: String,
    /// What is acquired: single acquisitions, and series of them.
    #[schemars(length(min = 1))]
    pub(crate) acquisitions: Vec<AcquisitionToml>,
    /// Where to, and what of each acquisition.
    #[serde(default)]
    pub(crate) output: OutputToml,
    /// What counts as seen.
    #[serde(default)]
    pub(crate) coverage: CoverageToml,
}

/// An acquisition (`epoch` or `offset_s`), or a series of them (`start`, `stop` and `every_s`; or `epochs`).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AcquisitionToml {
    /// Its name: its product's folder. Of a series the beginning of all names; the moment follows, as in `map_2027-05-01T06-00-00.000` (UTC).
    pub(crate) name: String,
    /// When its first exposure begins, as "2027-05-01T06:00:00 UTC"; scales are UTC, TAI, TT, TDB and GPS.
    pub(crate) epoch: Option<String>,
    /// The same, s after `flight.epoch` of the scene; below 0: before it.
    pub(crate) offset_s: Option<f64>,
    /// Of a series: its moments, one after the other.
    #[schemars(length(min = 1))]
    pub(crate) epochs: Option<Vec<String>>,
    /// Of a series: its first moment, ...
    pub(crate) start: Option<String>,
    /// ... when it ends: an acquisition that begins then is its last, ...
    pub(crate) stop: Option<String>,
    /// ... and the time from one to the next, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) every_s: Option<f64>,
    /// A point of the body that the boresight follows, from its centre along its axes, m. The top of the image is as `pointing` says.
    pub(crate) target_m: Option<[f64; 3]>,
    /// The same by its planetocentric latitude, deg, ...
    #[schemars(range(min = -90, max = 90))]
    pub(crate) latitude_deg: Option<f64>,
    /// ... and longitude east, deg: of the surface there, the outermost if there is more than one.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) longitude_deg: Option<f64>,
    /// Where the camera looks, instead of the scene's `flight.pointing`.
    pub(crate) pointing: Option<PointingToml>,
    /// Files of flight dynamics instead of the scene's `flight.files`.
    pub(crate) files: Option<Vec<String>>,
    /// What carries the camera, by its name in the files, instead of the scene's `flight.spacecraft` or `flight.orbit`.
    pub(crate) spacecraft: Option<String>,
    /// An orbit by name instead of the scene's `flight.orbit` or `flight.spacecraft`.
    pub(crate) orbit: Option<String>,
    /// When that orbit is on the line from Phobos to Mars. Default: as in the scene.
    pub(crate) orbit_epoch: Option<String>,
    /// The camera, instead of all of the scene's `sensor`.
    pub(crate) sensor: Option<SensorToml>,
}

/// Where to, and what of each acquisition.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OutputToml {
    /// The folder of the campaign, which is made if it is not there; `--output` overrides it.
    pub(crate) folder: Option<String>,
    /// Which effects are modelled: `auto` (the default), `thesis`, `full`, or a list, as `--model` of `mmxrt simulate` has it.
    pub(crate) model: Option<String>,
    /// The largest error of a pixel that all that is left out may add up to. Default 0.001.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) tolerance: Option<f64>,
    /// Precision of the cube's numbers. Default "f32".
    pub(crate) dtype: Option<DtypeToml>,
    /// Order of the cube's numbers. Default "bsq".
    pub(crate) interleave: Option<InterleaveToml>,
    /// What the numbers of the cube are. Default "radiance".
    pub(crate) quantity: Option<QuantityToml>,
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
    /// Emission up to which a facet counts as seen, deg. Default 90.
    #[schemars(range(min = 0, max = 90))]
    pub(crate) most_emission_deg: Option<f64>,
    /// Incidence up to which it does, deg. Default 90; 180 if the dark counts as well.
    #[schemars(range(min = 0, max = 180))]
    pub(crate) most_incidence_deg: Option<f64>,
    /// Samplings, m, of which the manifest says how much of the surface is seen so finely. Default 1, 2, 5, 10, 20, 50 and 100.
    #[schemars(length(max = 100))]
    pub(crate) within_m: Option<Vec<f64>>,
}
