//! What a landscape is made from: a seed and a few numbers, as people write them in TOML.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Location, Problem};

/// The facet counts that a recipe may ask for.
pub const FACETS: std::ops::RangeInclusive<u32> = 1_000..=4_000_000;

/// A landscape in a few numbers: the same recipe always makes the same mesh.
///
/// A square site, local axes x east, y north, z up, origin in the middle at the relief's mean height.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Version of this format and of the generator behind it: 1.
    pub version: u32,
    /// Another seed is another landscape of the same kind; 0 to 2^63 - 1, the largest number TOML holds.
    pub seed: u64,
    /// Side of the site, m.
    #[serde(default = "default_size_m")]
    pub size_m: f64,
    /// Facets of the whole mesh, boulders included, 1e3 to 4e6; the mesh has this many to within 2 % (3 % below 1e4).
    ///
    /// More facets are a finer mesh of the same place: relief, craters and boulders stay where they are, and
    /// only what is too fine for the facets is left out (relief and craters under 3 grid steps, boulders under a
    /// quarter of one; a grid step is `size_m / sqrt(facets / 2)`).
    #[serde(default = "default_facets")]
    pub facets: u32,
    /// The ground without craters.
    #[serde(default)]
    pub relief: Relief,
    /// Craters.
    #[serde(default)]
    pub craters: Craters,
    /// Boulders.
    #[serde(default)]
    pub boulders: Boulders,
}

/// Rolling ground: octaves of noise, each with half the wavelength of the one before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Relief {
    /// Standard deviation of the height, all octaves together, m.
    pub rms_m: f64,
    /// Longest wavelength, m.
    pub longest_m: f64,
    /// How heights shrink with wavelength, as wavelength^hurst: 1 is smooth, towards 0 rough (0 excluded).
    pub hurst: f64,
}

/// Bowl craters with a raised rim and an apron of ejecta, placed evenly at random.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Craters {
    /// How many; 0 for none.
    pub count: u32,
    /// Smallest rim-to-rim diameter, m.
    pub min_diameter_m: f64,
    /// Largest rim-to-rim diameter, m.
    pub max_diameter_m: f64,
    /// Number larger than D goes as D^-exponent.
    pub exponent: f64,
    /// Depth from rim to floor of a fresh crater, in diameters.
    pub depth: f64,
    /// Height of a fresh rim over the surroundings, in diameters.
    pub rim: f64,
    /// How far age goes: each crater is worn by its own share between 0 (fresh) and this (1: worn away), which
    /// lowers it and rounds its rim.
    pub softness: f64,
}

/// Loose rocks of the second material, each a closed body half sunk in the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Boulders {
    /// How many; 0 for none.
    pub count: u32,
    /// Smallest diameter (longest axis), m.
    pub min_diameter_m: f64,
    /// Largest diameter (longest axis), m; at most 12.
    pub max_diameter_m: f64,
    /// Number larger than D goes as D^-exponent.
    pub exponent: f64,
    /// Share of a boulder's height that is below the ground at its centre, 0 to 1.
    pub sunk: f64,
}

fn default_size_m() -> f64 {
    2000.0
}

fn default_facets() -> u32 {
    400_000
}

impl Default for Relief {
    fn default() -> Self {
        Relief { rms_m: 25.0, longest_m: 1000.0, hurst: 0.85 }
    }
}

impl Default for Craters {
    fn default() -> Self {
        Craters {
            count: 4000,
            min_diameter_m: 8.0,
            max_diameter_m: 500.0,
            exponent: 2.0,
            depth: 0.2,
            rim: 0.04,
            softness: 0.8,
        }
    }
}

impl Default for Boulders {
    fn default() -> Self {
        Boulders { count: 3000, min_diameter_m: 2.0, max_diameter_m: 12.0, exponent: 3.0, sunk: 0.5 }
    }
}

impl Recipe {
    /// The defaults with a seed.
    pub fn new(seed: u64) -> Self {
        Recipe {
            version: 1,
            seed,
            size_m: default_size_m(),
            facets: default_facets(),
            relief: Relief::default(),
            craters: Craters::default(),
            boulders: Boulders::default(),
        }
    }

    /// Everything that [`generate`](super::generate) would refuse, each problem at `recipe.key`.
    pub fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if self.version != 1 {
            problems.push(Problem::new(
                Location::item("recipe.version"),
                format!("version {} is not known: this program makes version 1", self.version),
            ));
        }
        problems
    }
}
