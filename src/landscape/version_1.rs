//! Recipes of version 1: one relief, one group of craters, one of boulders, and defaults for all of them. They are the same places today; craters of theirs
//! add up instead of erasing one another.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::recipe::{Boulders, Craters, Overlap, Recipe, Relief, Span};

/// A recipe of version 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RecipeOne {
    /// Version of this format: 1.
    #[schemars(extend("const" = 1))]
    version: u32,
    /// Another seed is another landscape of the same kind; 0 to 2^63 - 1, the largest number TOML holds.
    seed: u64,
    /// Side of the site, m. Default 2000.
    size_m: Option<f64>,
    /// Facets of the whole mesh, 1e3 to 4e6. Default 400,000.
    facets: Option<u32>,
    /// Rolling ground.
    #[serde(default)]
    relief: ReliefOne,
    /// Craters.
    #[serde(default)]
    craters: CratersOne,
    /// Boulders.
    #[serde(default)]
    boulders: BouldersOne,
}

/// Rolling ground: octaves of noise, each with half the wavelength of the one before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct ReliefOne {
    /// Standard deviation of the height, all octaves together, m.
    rms_m: f64,
    /// Longest wavelength, m.
    longest_m: f64,
    /// How heights shrink with wavelength, as wavelength^hurst: 1 is smooth, towards 0 rough (0 excluded).
    hurst: f64,
}

/// Bowl craters with a raised rim and an apron of ejecta, placed evenly at random.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct CratersOne {
    /// How many; 0 for none.
    count: u32,
    /// Smallest rim-to-rim diameter, m.
    min_diameter_m: f64,
    /// Largest rim-to-rim diameter, m.
    max_diameter_m: f64,
    /// Number larger than D goes as D^-exponent.
    exponent: f64,
    /// Depth from rim to floor of a fresh crater, in diameters.
    depth: f64,
    /// Height of a fresh rim over the surroundings, in diameters.
    rim: f64,
    /// How far age goes: each crater is worn by its own share between 0 (fresh) and this (1: worn away), old ones
    /// being more frequent. Wear lowers a crater and rounds its rim.
    softness: f64,
}

/// Loose rocks of the second material, each a closed body half sunk in the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct BouldersOne {
    /// How many; 0 for none.
    count: u32,
    /// Smallest diameter (longest axis), m.
    min_diameter_m: f64,
    /// Largest diameter (longest axis), m.
    max_diameter_m: f64,
    /// Number larger than D goes as D^-exponent.
    exponent: f64,
    /// Share of a boulder's height that is below the ground, 0 to 1.
    sunk: f64,
}

impl Default for ReliefOne {
    fn default() -> Self {
        ReliefOne { rms_m: 22.0, longest_m: 1200.0, hurst: 1.0 }
    }
}

impl Default for CratersOne {
    fn default() -> Self {
        let Craters { min_diameter_m, max_diameter_m, exponent, depth, rim, softness, .. } = Craters::default();
        CratersOne { count: 6000, min_diameter_m, max_diameter_m, exponent, depth, rim, softness }
    }
}

impl Default for BouldersOne {
    fn default() -> Self {
        let Boulders { min_diameter_m, max_diameter_m, exponent, .. } = Boulders::default();
        BouldersOne { count: 3000, min_diameter_m, max_diameter_m, exponent, sunk: 0.5 }
    }
}

impl From<RecipeOne> for Recipe {
    fn from(one: RecipeOne) -> Recipe {
        let plane = Recipe::plane(one.seed);
        let ReliefOne { rms_m, longest_m, hurst } = one.relief;
        let CratersOne { count, min_diameter_m, max_diameter_m, exponent, depth, rim, softness } = one.craters;
        let craters = Craters {
            count,
            min_diameter_m,
            max_diameter_m,
            exponent,
            depth,
            rim,
            softness,
            overlap: Overlap::Add,
            ..Craters::default()
        };
        let BouldersOne { count, min_diameter_m, max_diameter_m, exponent, sunk } = one.boulders;
        let buried = Span::One(sunk);
        let boulders = Boulders { count, min_diameter_m, max_diameter_m, exponent, buried, ..Boulders::default() };
        Recipe {
            size_m: one.size_m.unwrap_or(plane.size_m),
            facets: one.facets.unwrap_or(plane.facets),
            relief: vec![Relief::Rolling { rms_m, longest_m, hurst }],
            craters: vec![craters],
            boulders: vec![boulders],
            ..plane
        }
    }
}
