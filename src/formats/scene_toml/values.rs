//! A quantity over wavelength, as files state it.

use schemars::JsonSchema;
use serde::Deserialize;

/// A number for all wavelengths, or a table.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Values {
    /// The same at all wavelengths.
    Constant(f64),
    /// Path of a CSV table.
    File(String),
}
