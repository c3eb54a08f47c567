//! `instrument.toml`: the optics and the detector of an instrument, apart from any scene.

use std::path::Path;

use glam::DVec3;
use schemars::JsonSchema;
use serde::Deserialize;

use super::InputFile;
use super::located::Document;
use super::scene_toml::TomlReader;
use super::scene_toml::chain::Said;
use super::scene_toml::chain_types::{DetectorToml, OpticsToml};
use super::scene_toml::types::Preset;
use crate::error::Result;
use crate::instrument::Chain;
use crate::progress::Watch;

/// An instrument: a preset, or what its keys say, or both.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct InstrumentToml {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    #[allow(dead_code, reason = "the schema checks it")]
    mmxrt_instrument: u32,
    /// A known instrument; supplies every key not given here.
    preset: Option<Preset>,
    /// Focal length over aperture.
    #[schemars(extend("exclusiveMinimum" = 0))]
    f_number: Option<f64>,
    /// Pitch of the detector's pixels, um.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pixel_um: Option<f64>,
    /// Exposure time, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    exposure_s: Option<f64>,
    /// Optics: what blurs the image, and stray light.
    optics: Option<OpticsToml>,
    /// Detector.
    detector: Option<DetectorToml>,
}

/// The JSON Schema of such files.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(InstrumentToml)
}

/// An instrument, its input files, and notes for readers of its results.
#[derive(Debug, Clone)]
pub struct InstrumentFile {
    /// The instrument.
    pub chain: Chain,
    /// The files that were read.
    pub inputs: Vec<InputFile>,
    /// Notes.
    pub notes: Vec<String>,
}

/// Reads an instrument.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) with all that is wrong in it; [`Error::Io`](crate::Error::Io).
pub fn read(path: &Path, watch: Watch<'_>) -> Result<InstrumentFile> {
    let (document, input) = Document::open(path)?;
    let toml: InstrumentToml = document.read()?;
    let mut reader = TomlReader::new(path, document, DVec3::ZERO, input, watch);
    let chain = reader.chain(&Said {
        at: "",
        preset: toml.preset,
        f_number: toml.f_number,
        pixel_um: toml.pixel_um,
        exposure_s: toml.exposure_s,
        optics: toml.optics.as_ref(),
        detector: toml.detector.as_ref(),
    });
    if chain.is_none() {
        reader.unless_told("", "says nothing of `optics` or `detector`");
    }
    let (inputs, notes) = reader.finish()?;
    Ok(InstrumentFile { chain: chain.unwrap_or_default(), inputs, notes })
}
