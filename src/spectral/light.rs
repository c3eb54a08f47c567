//! What light is in a band: sunlight, heat, or both.

use serde::{Deserialize, Serialize};

/// What light a band has: radiative-transfer codes can leave out sunlight, or heat, band by band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Light {
    /// Sunlight that surfaces and Mars reflect; no thermal emission.
    Sunlight,
    /// Thermal emission; no sunlight.
    Heat,
    /// Both.
    #[default]
    Both,
}

impl Light {
    /// Whether there is sunlight.
    pub fn is_lit(self) -> bool {
        self != Light::Heat
    }

    /// Whether surfaces glow.
    pub fn glows(self) -> bool {
        self != Light::Sunlight
    }

    /// What it is called in files.
    pub fn name(self) -> &'static str {
        match self {
            Light::Sunlight => "sunlight",
            Light::Heat => "heat",
            Light::Both => "both",
        }
    }
}

/// What is known of the light in a band of a map; `None`: not stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub struct KnownLight {
    /// Whether it holds sunlight that surfaces reflect.
    pub sunlight: Option<bool>,
    /// Whether it holds thermal emission.
    pub heat: Option<bool>,
}

impl From<Light> for KnownLight {
    fn from(light: Light) -> Self {
        KnownLight { sunlight: Some(light.is_lit()), heat: Some(light.glows()) }
    }
}

impl KnownLight {
    /// That it holds thermal emission; with which sunlight may be.
    pub const HEAT: KnownLight = KnownLight { sunlight: None, heat: Some(true) };

    /// Whether it is known to hold light that a band has not: one number for both cannot be taken apart.
    pub fn has_more_than(self, light: Light) -> bool {
        self.is(Some(true), light)
    }

    /// Whether it may hold light that a band has not.
    pub fn may_have_more_than(self, light: Light) -> bool {
        self.is(Some(true), light) || self.is(None, light)
    }

    /// Whether it is known to lack sunlight, or heat.
    pub(super) fn lacks_some(self) -> bool {
        self.sunlight == Some(false) || self.heat == Some(false)
    }

    fn is(self, known: Option<bool>, light: Light) -> bool {
        (!light.is_lit() && self.sunlight == known) || (!light.glows() && self.heat == known)
    }
}
