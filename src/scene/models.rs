//! Which equations are used where there is a choice.

use serde::{Deserialize, Serialize};

use crate::geometry::whole_u32;
use crate::physics::sun_disc::DiscRule;

/// The choice of models.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
    /// The parts of the disc of Mars, and of other bodies, that terrain may hide; `None`: only a facet's own horizon does.
    pub mars_shadows: Option<DiscRule>,
    /// Whether Mars' own heat lights the surface, in bands that hold heat and sunlight.
    pub mars_heat: bool,
    /// Steps of a day in which heat is conducted into the ground and back, in equilibrium otherwise; `None`: no heat is stored.
    pub conduction: Option<u32>,
    /// How facets light and warm each other; `None`: they do not.
    pub exchange: Option<Exchange>,
    /// No part of a facet is colder, K, whatever it receives: heat from below, or from its sides. 0 is not a floor.
    pub floor_k: f64,
    /// How many bodies of the sky besides Mars light and warm the surface, those that fill the most sky first. Others are there to be seen.
    pub bodies: u32,
    /// Which of these choices no plan may make otherwise.
    #[serde(skip_serializing_if = "Fixed::is_nothing")]
    pub fixed: Fixed,
}

/// Choices that a scene states itself: what a tolerance decides leaves them as they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Fixed {
    /// How warm the surface is, and whether heat is conducted.
    pub thermal: bool,
    /// How Mars lights it.
    pub mars_light: bool,
    /// What the Sun is.
    pub sun: bool,
    /// Whether bodies of the sky hide the Sun.
    pub eclipses: bool,
    /// What terrain may hide of Mars.
    pub mars_shadows: bool,
    /// Whether Mars' own heat lights the surface.
    pub mars_heat: bool,
}

impl Fixed {
    /// Each with the key of a scene file that states it.
    pub fn by_key(&self) -> [(&'static str, bool); 6] {
        let Fixed { thermal, mars_light, sun, eclipses, mars_shadows, mars_heat } = *self;
        [
            ("thermal.model", thermal),
            ("mars.model", mars_light),
            ("sun.points", sun),
            ("mars.eclipse", eclipses),
            ("mars.points", mars_shadows),
            ("mars.heat", mars_heat),
        ]
    }

    /// Whether all choices are open.
    pub fn is_nothing(&self) -> bool {
        *self == Fixed::default()
    }
}

impl Models {
    /// The choices that a scene file has to state so that it is read as these models: those that are fixed, and those that no default makes.
    pub fn to_state(&self) -> Fixed {
        let usual = Models::default();
        Fixed {
            thermal: self.fixed.thermal || self.thermal != usual.thermal,
            mars_light: self.fixed.mars_light || self.mars_light != usual.mars_light,
            sun: self.fixed.sun || self.sun != usual.sun,
            eclipses: self.fixed.eclipses || self.eclipses != usual.eclipses,
            mars_shadows: self.fixed.mars_shadows || self.mars_shadows != usual.mars_shadows,
            mars_heat: self.fixed.mars_heat || self.mars_heat != usual.mars_heat,
        }
    }
}

impl Models {
    /// Keys whose choice a scene states, and of which these models make another.
    pub fn against(&self, stated: &Models) -> Vec<&'static str> {
        let differs = Fixed {
            thermal: (self.thermal, self.conduction) != (stated.thermal, stated.conduction),
            mars_light: self.mars_light != stated.mars_light,
            sun: self.sun != stated.sun,
            eclipses: self.eclipses != stated.eclipses,
            mars_shadows: self.mars_shadows != stated.mars_shadows,
            mars_heat: self.mars_heat != stated.mars_heat,
        };
        let both = stated.fixed.by_key().into_iter().zip(differs.by_key());
        both.filter(|((_, is_stated), (_, differs))| *is_stated && *differs).map(|((key, _), _)| key).collect()
    }
}

impl Default for Models {
    fn default() -> Self {
        Models {
            thermal: Thermal::default(),
            mars_light: MarsModel::default(),
            sun: SunModel::default(),
            eclipses: false,
            mars_shadows: None,
            mars_heat: false,
            conduction: None,
            exchange: None,
            floor_k: 0.0,
            bodies: u32::MAX,
            fixed: Fixed::default(),
        }
    }
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

/// How light and heat between facets are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Exchange {
    /// How often light is reflected on its way, at most: fewer times if what is left is nothing.
    pub bounces: u32,
    /// Directions along which facets look at each other.
    pub directions: u32,
    /// Lines that meet a facet, in all directions together, on average.
    pub lines_per_facet: u32,
}

/// Lines that meet what a pixel shows, from each direction: more would not make up for directions that are missing.
const LINES_PER_PIXEL: f64 = 24.0;
/// That meet a facet, at most: with more, several would be too near to each other to tell more.
const LINES_PER_DIRECTION: f64 = 8.0;
/// Fewer directions than this leave gaps.
const LEAST_DIRECTIONS: u32 = 32;

impl Exchange {
    /// What receives light between facets to within this share of it, root mean square over shadowed pixels that show so many facets each.
    ///
    /// Not a bound: [`expected_error`](Self::expected_error) turned round.
    pub fn to_within(tolerance: f64, bounces: u32, facets_per_pixel: f64) -> Self {
        let directions = whole_u32((192.0 * (0.03 / tolerance).powf(5.0 / 3.0)).clamp(64.0, 16384.0));
        let lines = (LINES_PER_PIXEL / facets_per_pixel).clamp(1.0, LINES_PER_DIRECTION);
        Exchange { bounces, directions, lines_per_facet: whole_u32((lines * f64::from(directions)).ceil()) }
    }

    /// Error of what neighbours send, root mean square over shadowed pixels under a Sun at 60 deg, about.
    ///
    /// Measured on a site of 2e5 and of 2e6 facets, where 192 directions gave 0.03 with enough lines, 1024 gave 0.0105.
    pub fn expected_error(self) -> f64 {
        0.03 * (192.0 / f64::from(self.directions)).powf(0.6)
    }

    /// CPU s of one bounce, about: 4e-8 for a facet and direction, 6e-9 for a line.
    pub fn bounce_s(self, facets: usize) -> f64 {
        facets as f64 * (4e-8 * f64::from(self.directions) + 6e-9 * f64::from(self.lines_per_facet))
    }

    /// What is enough for this share of all light, which may be off by more of itself.
    #[must_use]
    pub fn for_share(self, share: f64) -> Self {
        let least = f64::from(LEAST_DIRECTIONS.min(self.directions)) / f64::from(self.directions.max(1));
        let fewer = |number: u32| whole_u32((f64::from(number) * share.clamp(least, 1.0)).ceil());
        Exchange { directions: fewer(self.directions), lines_per_facet: fewer(self.lines_per_facet), ..self }
    }
}

impl Default for Exchange {
    /// Two bounces, to about 3 %.
    fn default() -> Self {
        Exchange::to_within(0.03, 2, 1.0)
    }
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
