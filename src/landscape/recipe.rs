//! What a landscape is made from: a seed and a few numbers, as people write them in TOML.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Location, Problem, number};

/// The facet counts that a recipe may ask for.
pub const FACETS: std::ops::RangeInclusive<u32> = 1_000..=4_000_000;

/// Least and largest side of a site, m.
const SIZE_M: (f64, f64) = (10.0, 1e5);

/// Largest boulder, m.
const LARGEST_BOULDER_M: f64 = 12.0;

/// The number of boulders that half of the largest number of facets can make.
const MOST_BOULDERS: u32 = 100_000;

/// A bound on the time a recipe can take.
const MOST_CRATERS: u32 = 100_000;

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
    /// How far age goes: each crater is worn by its own share between 0 (fresh) and this (1: worn away), old ones
    /// being more frequent. Wear lowers a crater and rounds its rim.
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
        Relief { rms_m: 22.0, longest_m: 1200.0, hurst: 1.0 }
    }
}

impl Default for Craters {
    fn default() -> Self {
        Craters {
            count: 6000,
            min_diameter_m: 8.0,
            max_diameter_m: 500.0,
            exponent: 1.8,
            depth: 0.2,
            rim: 0.04,
            softness: 0.9,
        }
    }
}

impl Default for Boulders {
    fn default() -> Self {
        Boulders { count: 3000, min_diameter_m: 2.0, max_diameter_m: 12.0, exponent: 2.5, sunk: 0.5 }
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

    /// The values that are out of their ranges.
    pub(super) fn out_of_range(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        let mut problem = |key: &str, message: String| {
            problems.push(Problem::new(Location::item(format!("recipe.{key}")), message));
        };
        if self.version != 1 {
            problem("version", format!("version {} is not known: this program makes version 1", self.version));
        }
        if i64::try_from(self.seed).is_err() {
            problem("seed", format!("{} is more than {}, the largest number TOML holds", self.seed, i64::MAX));
        }
        if !FACETS.contains(&self.facets) {
            problem("facets", format!("{} is not from {} to {}", self.facets, FACETS.start(), FACETS.end()));
        }
        for (key, most, count) in [
            ("craters.count", MOST_CRATERS, self.craters.count),
            ("boulders.count", MOST_BOULDERS, self.boulders.count),
        ] {
            if count > most {
                problem(key, format!("{count} is more than {most}"));
            }
        }
        let Recipe { relief, craters, boulders, .. } = self;
        // A range that hangs on a bad size is not worth telling.
        let size_m = if (SIZE_M.0..=SIZE_M.1).contains(&self.size_m) { self.size_m } else { f64::NAN };
        let largest_crater_m = 2.0 * size_m;
        let largest_boulder_m = LARGEST_BOULDER_M.min(0.1 * size_m);
        for (key, value, lo, hi) in [
            ("size_m", self.size_m, SIZE_M.0, SIZE_M.1),
            ("relief.rms_m", relief.rms_m, 0.0, 0.5 * size_m),
            ("relief.longest_m", relief.longest_m, 0.001 * size_m, 10.0 * size_m),
            ("relief.hurst", relief.hurst, 0.05, 2.0),
            ("craters.min_diameter_m", craters.min_diameter_m, 0.1, largest_crater_m),
            ("craters.max_diameter_m", craters.max_diameter_m, 0.1, largest_crater_m),
            ("craters.exponent", craters.exponent, 0.1, 10.0),
            ("craters.depth", craters.depth, 0.0, 1.0),
            ("craters.rim", craters.rim, 0.0, craters.depth.clamp(0.0, 1.0)),
            ("craters.softness", craters.softness, 0.0, 1.0),
            ("boulders.min_diameter_m", boulders.min_diameter_m, 0.1, largest_boulder_m),
            ("boulders.max_diameter_m", boulders.max_diameter_m, 0.1, largest_boulder_m),
            ("boulders.exponent", boulders.exponent, 0.1, 10.0),
            ("boulders.sunk", boulders.sunk, 0.0, 1.0),
        ] {
            // Written so that NaN fails; a limit that is NaN gives no range.
            if !(lo..=hi).contains(&value) && hi >= lo {
                problem(key, format!("{} is not from {lo} to {hi}", number(value)));
            }
        }
        for (key, lo, hi) in [
            ("craters.min_diameter_m", craters.min_diameter_m, craters.max_diameter_m),
            ("boulders.min_diameter_m", boulders.min_diameter_m, boulders.max_diameter_m),
        ] {
            if lo > hi {
                problem(key, format!("{} is more than max_diameter_m = {}", number(lo), number(hi)));
            }
        }
        problems
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn items(recipe: &Recipe) -> Vec<String> {
        recipe.check().into_iter().map(|problem| problem.at.item.unwrap()).collect()
    }

    #[test]
    fn version_and_seed_are_enough() {
        let recipe: Recipe = toml::from_str("version = 1\nseed = 7").unwrap();
        assert_eq!(recipe, Recipe::new(7));
        assert_eq!(recipe.check(), []);
        assert!(toml::from_str::<Recipe>("seed = 7").unwrap_err().to_string().contains("version"));
    }

    #[test]
    fn text_and_back_is_the_same_recipe() {
        let mut recipe = Recipe::new(i64::MAX as u64);
        recipe.relief.hurst = 0.1 + 0.2;
        recipe.craters.count = 0;
        let text = toml::to_string(&recipe).unwrap();
        assert_eq!(toml::from_str::<Recipe>(&text).unwrap(), recipe);
    }

    #[test]
    fn unknown_keys_are_refused() {
        for text in ["size = 2000.0", "relief = { amplitude = 3.0 }", "boulders = { cout = 3 }"] {
            let error = toml::from_str::<Recipe>(&format!("version = 1\nseed = 7\n{text}")).unwrap_err();
            assert!(error.to_string().contains("unknown field"), "{error}");
        }
    }

    #[test]
    fn all_bad_values_are_told_at_once() {
        let mut recipe = Recipe::new(u64::MAX);
        recipe.version = 2;
        recipe.facets = 999;
        recipe.relief.rms_m = f64::NAN;
        recipe.craters.depth = -0.2;
        recipe.craters.rim = 0.0;
        recipe.craters.count = u32::MAX;
        recipe.boulders.max_diameter_m = 12.5;
        recipe.boulders.min_diameter_m = f64::INFINITY;
        let expected = [
            "version",
            "seed",
            "facets",
            "craters.count",
            "relief.rms_m",
            "craters.depth",
            "boulders.min_diameter_m",
            "boulders.max_diameter_m",
            "boulders.min_diameter_m",
        ];
        assert_eq!(items(&recipe), expected.map(|key| format!("recipe.{key}")));
        recipe = Recipe::new(1);
        recipe.size_m = -f64::NAN;
        assert_eq!(items(&recipe), ["recipe.size_m"]);
    }

    #[test]
    fn too_many_boulders_for_the_facets_are_told() {
        // 6000 boulders of 4 m and more, at a grid step of 2000 / sqrt(100,000) = 6.3 m: all are kept, and need 120,000.
        let mut recipe = Recipe { facets: 200_000, ..Recipe::new(1) };
        recipe.boulders = Boulders { count: 6000, min_diameter_m: 4.0, ..Boulders::default() };
        let problems = recipe.check();
        assert_eq!(problems.len(), 1);
        assert!(problems[0].to_string().starts_with("recipe.boulders.count: "), "{}", problems[0]);
        assert!(problems[0].message.contains("need 120000 facets, more than half of recipe.facets = 200000"));
        recipe.boulders.count = 5000;
        assert_eq!(recipe.check(), []);
    }

    #[test]
    fn bench_landscapes_differ_in_facets_alone() {
        let texts =
            [include_str!("../../benches/landscape_2e5.toml"), include_str!("../../benches/landscape_2e6.toml")];
        let [small, large] = texts.map(|text| toml::from_str::<Recipe>(text).unwrap());
        assert_eq!((small.facets, large.facets), (200_000, 2_000_000));
        assert_eq!(Recipe { facets: 2_000_000, ..small }, large);
        assert_eq!(large.check(), []);
    }
}
