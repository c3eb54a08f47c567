//! Which equations are used where there is a choice.

use serde::{Deserialize, Serialize};

use crate::physics::sun_disc::DiscRule;

/// The choice of models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Models {
    /// How warm the surface is.
    pub thermal: Thermal,
    /// How Mars lights it.
    pub mars_light: MarsModel,
    /// What the Sun is.
    pub sun: SunModel,
    /// Whether bodies of the sky hide the Sun.
    pub eclipses: bool,
    /// The parts of Mars' disc that terrain may hide; `None`: only a facet's own horizon does.
    pub mars_shadows: Option<DiscRule>,
    /// Whether Mars' own heat lights the surface, in bands that hold heat and sunlight.
    pub mars_heat: bool,
    /// Steps of a day in which heat is conducted into the ground and back, in equilibrium otherwise; `None`: no heat is stored.
    pub conduction: Option<u32>,
}

/// What the Sun is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SunModel {
    /// A point: shadows have sharp edges.
    #[default]
    Point,
    /// A disc, for which these points stand: shadows have penumbrae.
    Disc(DiscRule),
}

/// How warm the surface is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Thermal {
    /// Each facet in equilibrium with what it absorbs, its lit and shaded parts separately.
    #[default]
    Equilibrium,
    /// Domagala (2020), equation (9): 150 K + 180 K E_sun / E_S.
    Thesis,
    /// No thermal emission.
    Off,
}

/// How Mars-light is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MarsModel {
    /// Lambert sphere near at hand: phase, tilt and horizon of each facet.
    #[default]
    NearField,
    /// Domagala (2020), equations (4) to (8) as printed.
    Thesis,
    /// Mars sends no light that is seen; it still warms.
    Off,
}
