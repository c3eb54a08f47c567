//! How much a pixel may change.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The largest error of a pixel: the change of its radiance over that radiance, or over 0.01 of the band's median sunlit radiance if that is more.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bound {
    /// Of pixels that show nothing but sunlit ground.
    pub lit: f64,
    /// Of the others: something in them is in shadow, or turned away from the Sun.
    pub shadow: f64,
}

impl Bound {
    /// No change.
    pub const NOTHING: Bound = Bound { lit: 0.0, shadow: 0.0 };

    /// The larger of the two.
    pub fn most(&self) -> f64 {
        self.lit.max(self.shadow)
    }

    /// Of two changes together.
    #[must_use]
    pub fn and(&self, other: &Bound) -> Bound {
        Bound { lit: self.lit + other.lit, shadow: self.shadow + other.shadow }
    }

    /// Of a change that is so many times larger.
    #[must_use]
    pub fn times(&self, factor: f64) -> Bound {
        Bound { lit: self.lit * factor, shadow: self.shadow * factor }
    }
}
