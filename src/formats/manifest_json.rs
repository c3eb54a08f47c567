//! `manifest.json`: what a campaign has made, and how much of the surface it has seen.
//!
//! It is the same, byte for byte, whether acquisitions were made or kept, by one process or by several, at once or with interruptions.

use serde::{Deserialize, Serialize};

use schemars::JsonSchema;

use super::report_json::Input;

/// What it says it is.
pub const FORMAT: &str = "mmxrt campaign manifest";
/// Version of the format.
pub const FORMAT_VERSION: u32 = 1;

/// What a campaign has made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// "mmxrt campaign manifest".
    pub format: String,
    /// Version of this format.
    pub format_version: u32,
    /// Version of mmxrt.
    pub mmxrt: String,
    /// The campaign file.
    pub campaign: Input,
    /// The files that all acquisitions depend on: the scene file first.
    pub inputs: Vec<Input>,
    /// All acquisitions, in the order of the campaign file.
    pub acquisitions: Vec<AcquisitionEntry>,
    /// What of the surface they see.
    pub coverage: CoverageEntry,
}

/// One acquisition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AcquisitionEntry {
    /// Its name: the product is `products/NAME`, what it sees of each facet `sights/NAME.npz`.
    pub name: String,
    /// When its first exposure begins, UTC, to a millisecond.
    pub epoch_utc: String,
    /// The same, s of TDB after J2000.
    pub epoch_tdb_s: f64,
    /// Whether it is there.
    pub state: EntryState,
    /// A hash of all that `sights/NAME.npz` depends on, as its header has it; null if that is not there.
    pub sights: Option<String>,
    /// A hash of all that its product depends on, as `scene` of its `report.json` has it; null if there is no product.
    pub product: Option<String>,
    /// How many warnings there are: those of its product, or if there is none, of what it sees.
    #[serde(default, skip_serializing_if = "is_none_of_them")]
    pub warnings: u64,
    /// The first of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_warning: Option<String>,
    /// Why it failed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<String>,
}

/// What is left out of the file.
fn is_none_of_them(count: &u64) -> bool {
    *count == 0
}

/// Whether an acquisition is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum EntryState {
    /// It is.
    Done,
    /// It could not be made.
    Failed,
}

/// How much of the surface has been seen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CoverageEntry {
    /// Number of facets.
    pub facets: u64,
    /// Their area, m2.
    pub area_m2: f64,
    /// Whether only what was in sunlight counts.
    pub in_sunlight: bool,
    /// Up to which emission, deg.
    pub most_emission_deg: f64,
    /// Up to which incidence, deg.
    pub most_incidence_deg: f64,
    /// The share of the surface that has been seen at all.
    pub seen: ShareEntry,
    /// The share that has been seen by pixels of this size or smaller ones.
    pub within: Vec<WithinEntry>,
}

/// A share of the surface. Parts of a facet that different acquisitions see are not told apart: what all of them see is between the two.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShareEntry {
    /// Of each facet the largest part that one acquisition has seen.
    pub at_least: f64,
    /// All of each facet of which some has been seen.
    pub at_most: f64,
}

/// The share of the surface that is seen so finely.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WithinEntry {
    /// Size of a pixel on the ground, m.
    pub within_m: f64,
    /// Of each facet the largest part that one acquisition has seen.
    pub at_least: f64,
    /// All of each facet of which some has been seen.
    pub at_most: f64,
}

impl Manifest {
    /// How many acquisitions could not be made.
    pub fn failed(&self) -> usize {
        self.acquisitions.iter().filter(|entry| entry.state == EntryState::Failed).count()
    }

    /// Acquisitions with warnings.
    pub fn warned(&self) -> impl Iterator<Item = &AcquisitionEntry> {
        self.acquisitions.iter().filter(|entry| entry.warnings > 0)
    }
}

/// Its JSON Schema.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(Manifest)
}
