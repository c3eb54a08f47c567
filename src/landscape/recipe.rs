//! What a landscape is made from: a seed and a few numbers, as people write them in TOML.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::power_law::PowerLaw;
use super::{BOULDERS, GROUND};

/// A landscape in a few numbers: the same recipe always makes the same mesh.
///
/// A square site, local axes x east, y north, z up, origin in the middle, at the height that relief has on average over far larger ground (a site of a few of its waves has another mean; mounds and craters add theirs). Relief comes first, craters dig into it in the
/// order of their ages, boulders rest on what that makes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Version of this format and of the generator behind it: 2. Recipes of version 1, of one relief, one group of craters and one of boulders, are read, too.
    #[schemars(extend("const" = 2))]
    pub version: u32,
    /// Another seed is another landscape of the same kind; 0 to 2^63 - 1, the largest number TOML holds.
    pub seed: u64,
    /// Side of the site, m.
    #[serde(default = "default_size_m")]
    pub size_m: f64,
    /// Facets of the whole mesh, boulders and surroundings included, 1e3 to 4e6; the mesh has this many to within 1 %.
    ///
    /// More facets are a finer mesh of the same place: relief, craters and boulders stay where they are, and
    /// only what is too fine for the facets is left out (relief and craters under two grid steps, boulders under a quarter of one; those of two to four
    /// steps are there in part).
    #[serde(default = "default_facets")]
    pub facets: u32,
    /// The part of the site that has the finest facets; left out, they are the same all over it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detail: Option<Detail>,
    /// Coarse ground around the site, so that what is beyond it can cast a shadow on it; left out, the mesh ends at the site's border.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surroundings: Option<Surroundings>,
    /// The ground before there were craters: layers that are added up. None: a plane.
    #[serde(default)]
    pub relief: Vec<Relief>,
    /// Groups of craters; those of all groups dig in the order of their ages.
    #[serde(default)]
    pub craters: Vec<Craters>,
    /// Layers that lie over relief and craters: what has roughened and covered the ground since.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cover: Vec<Relief>,
    /// Groups of boulders.
    #[serde(default)]
    pub boulders: Vec<Boulders>,
    /// Material of the ground where nothing is painted. Default "phobos_blue".
    #[serde(default = "default_ground")]
    pub ground: String,
    /// Colours and mixtures of materials, by their names. A material that is not here has a colour of its own.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub materials: BTreeMap<String, MaterialRecipe>,
    /// What is of other materials, in this order: the last that holds for a facet decides.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paint: Vec<Paint>,
    /// The body that the site lies on; left out, it lies on a plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<BodyRecipe>,
    /// A panchromatic texture over the site, written beside the mesh, with texture coordinates for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<Texture>,
}

/// A body, and where on it a site lies.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BodyRecipe {
    /// A shape by name: "phobos" is an ellipsoid of 12.95 x 11.30 x 9.16 km with Stickney, and craters of the measured population in places of their own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<ShapeName>,
    /// Half axes of an ellipsoid along the body's x, y and z, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ellipsoid_m: Option<[f64; 3]>,
    /// Paths of meshes, the whole body first, finer parts of it after: where a finer one is, it counts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub files: Option<Vec<String>>,
    /// The meshes' unit of length, m: 1000 for km. Default: what the files say, else 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit_m: Option<f64>,
    /// What is added to the shape's coordinates, m: its centre where the body's centre is not. Default 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset_m: Option<[f64; 3]>,
    /// The targeted point, body axes, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target_m: Option<[f64; 3]>,
    /// Instead: longitude east and latitude of a target on the body's surface, planetocentric, deg.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lonlat_deg: Option<[f64; 2]>,
    /// How high the site lies. Default "target"; with `lonlat_deg` "body".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height: Option<Height>,
    /// Where the site's y axis points to, from north over east, deg: along the swath. Default 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth_deg: Option<f64>,
    /// The same as a direction, body axes, that need not be level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<[f64; 3]>,
}

/// A shape that comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ShapeName {
    /// Phobos by a few numbers.
    Phobos,
}

/// How high a site lies on its body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Height {
    /// As high as the target: the body is moved so that its surface goes through it, and ranges to the target stay.
    Target,
    /// On the body's surface.
    Body,
}

/// The part of a site that has the finest facets; around it they grow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Detail {
    /// Its middle, east of the site's, m. Default 0.
    #[serde(default)]
    pub x_m: f64,
    /// Its middle, north of the site's, m. Default 0.
    #[serde(default)]
    pub y_m: f64,
    /// Its side, m.
    pub size_m: f64,
    /// By how much facets grow outward: a row of them is wider than the row within by this share. Default 0.1.
    #[serde(default = "default_growth")]
    pub growth: f64,
}

/// Coarse ground around a site.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Surroundings {
    /// How far it reaches beyond the site's border, m.
    pub reach_m: f64,
    /// By how much facets grow outward: a row of them is wider than the row within by this share. Default 0.1.
    #[serde(default = "default_growth")]
    pub growth: f64,
}

/// A layer of relief.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Relief {
    /// Rolling ground: octaves of noise, each with half the wavelength of the one before.
    Rolling {
        /// Standard deviation of the height over ground of many waves, all octaves together, m. A site that holds few of the longest waves may have half or twice
        /// of it.
        rms_m: f64,
        /// Cell of the coarsest lattice of noise, m: most of its waves are 1 to 2.5 times as long.
        longest_m: f64,
        /// How heights shrink with wavelength, as wavelength^hurst: 1 is smooth, towards 0 rough (0 excluded). Default 1.
        #[serde(default = "one")]
        hurst: f64,
    },
    /// Rugged ground: as rolling, with sharp crests.
    Ridged {
        /// Standard deviation of the height over ground of many waves, all octaves together, m. A site that holds few of the longest waves may have half or twice
        /// of it.
        rms_m: f64,
        /// Cell of the coarsest lattice of noise, m: most of its waves are 1 to 2.5 times as long.
        longest_m: f64,
        /// How heights shrink with wavelength, as wavelength^hurst. Default 0.9.
        #[serde(default = "default_rugged")]
        hurst: f64,
    },
    /// Rows of dunes, of which each rises slowly and falls steeply.
    Dunes {
        /// From trough to crest, m. Slopes follow from it, `wavelength_m`, `rise` and `wander`, and are not limited: sand stands up to about 34 deg.
        height_m: f64,
        /// From crest to crest, m.
        wavelength_m: f64,
        /// Where the wind goes to, from north over east, deg. Default 90.
        #[serde(default = "east")]
        towards_deg: f64,
        /// Share of a wavelength on which a dune rises; on the rest it falls. Default 0.7.
        #[serde(default = "default_rise")]
        rise: f64,
        /// How far crests wander from straight lines, and how much dunes differ in height, in wavelengths and in heights. Default 0.3.
        #[serde(default = "default_wander")]
        wander: f64,
    },
    /// One big structure with steep flanks: a ridge, a mesa, a scarp if it is long, a groove or pit if its height is negative.
    Mound {
        /// Its middle, east of the site's, m. Default 0.
        #[serde(default)]
        x_m: f64,
        /// Its middle, north of the site's, m. Default 0.
        #[serde(default)]
        y_m: f64,
        /// Height of its top over the ground, m; negative for a hollow.
        height_m: f64,
        /// Steepest slope of its flanks, deg, before they are ragged.
        flank_deg: f64,
        /// Length of the line that its top is drawn along, m; 0 for a round one. Default 0.
        #[serde(default)]
        length_m: f64,
        /// Where that line points to, from north over east, deg. Default 0.
        #[serde(default)]
        along_deg: f64,
        /// Radius of the flat top around that line, m. Default 0: a crest or a peak.
        #[serde(default)]
        top_m: f64,
        /// How ragged its flanks are, in widths of a flank. Default 0.
        #[serde(default)]
        ragged: f64,
    },
    /// Heights from a file: an elevation model, or an image that is taken for one.
    Elevation {
        /// Path of a raster.
        file: String,
        /// The part that is taken: first column, first line (counted from 0, from the top left), columns, lines. Default: all.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        crop: Option<[u32; 4]>,
        /// Size of a pixel in the field, m; default: what the file says.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pixel_m: Option<f64>,
        /// Width of the cropped part on the site, m: other than in the field, heights shrink or grow alike, and slopes stay. Default: the site's size.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        width_m: Option<f64>,
        /// From the lowest to the highest point of the part, m, whatever the file's values are; needed where the size of a pixel is not known.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        height_m: Option<f64>,
        /// Factor on heights. Default 1.
        #[serde(default = "one")]
        amplify: f64,
        /// How many times the same heights are added again, smaller each time. Default 0.
        #[serde(default)]
        repeat: u32,
        /// How much smaller. Default 4.
        #[serde(default = "default_ratio")]
        ratio: f64,
        /// How heights shrink in that, as ratio^-hurst. Default 1: slopes stay.
        #[serde(default = "one")]
        hurst: f64,
        /// Turns the part counter-clockwise, deg. Default 0.
        #[serde(default)]
        turn_deg: f64,
    },
}

/// A group of bowl craters with raised rims and aprons of ejecta, placed evenly at random, or one by one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Craters {
    /// Name, for what refers to these craters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// How many are made on the site. Default 0.
    pub count: u32,
    /// The same as a density, 1/km2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub per_km2: Option<f64>,
    /// The same as a share of geometric saturation, of which 1.54 D^-2 craters larger than D lie on a unit of area (Gault 1970, Radio Science 5); real
    /// surfaces keep 0.01 to 0.1 of it. It is that share at the smallest diameter; at larger ones more, if the exponent is below 2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub saturation: Option<f64>,
    /// Smallest rim-to-rim diameter, m, when fresh: wear moves a crest outward. Default 8.
    pub min_diameter_m: f64,
    /// Largest rim-to-rim diameter, m. Default 500.
    pub max_diameter_m: f64,
    /// Number larger than D goes as D^-exponent. Default 1.8: of Phobos' 1300 craters over 200 m, 70 are over 1 km (Basilevsky et al. 2014, Planet. Space Sci.
    /// 102, 95), which is 1.815; their 30 over 2 km are more than that, and below 200 m it is extrapolated.
    pub exponent: f64,
    /// Depth from rim to floor of a fresh crater, in diameters. Default 0.2.
    pub depth: f64,
    /// Height of a fresh rim over the surroundings, in diameters. Default 0.04.
    pub rim: f64,
    /// Share of its relief that the oldest crater has lost; one of age a, from 0 (now) to 1 (the oldest), has lost this times the square root of a. Wear lowers a
    /// crater and rounds its rim, whose crest moves outward. Default 0.9.
    pub softness: f64,
    /// Diameter, m, of a crater that soil creep alone has made half as deep if it is the oldest. A crater keeps 1 / (1 + age (this / D)^2) of its depth, as a bowl of
    /// Gaussian shape does that diffuses (that craters do: Fassett and Thomson 2014, JGR Planets 119, 2255). Default 0: none.
    pub creep_m: f64,
    /// What a crater does to what was there before. Default "erase".
    pub overlap: Overlap,
    /// Craters placed one by one, besides.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub placed: Vec<PlacedCrater>,
}

/// What a crater does to what was there before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Overlap {
    /// It erases it within its rim, and covers it with ejecta.
    Erase,
    /// It adds its own shape to it.
    Add,
}

/// A crater at a place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlacedCrater {
    /// Centre, east of the site's middle, m.
    pub x_m: f64,
    /// Centre, north of the site's middle, m.
    pub y_m: f64,
    /// Rim-to-rim diameter, m.
    pub diameter_m: f64,
    /// Age, 0 (now, the default) to 1 (the oldest).
    #[serde(default)]
    pub age: f64,
}

/// A group of boulders: closed bodies that stick in the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Boulders {
    /// Name, for what refers to these boulders.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// How many. Default 0.
    pub count: u32,
    /// The same as a density of the whole site, 1/km2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub per_km2: Option<f64>,
    /// Smallest diameter (longest axis), m. Default 2.
    pub min_diameter_m: f64,
    /// Largest diameter (longest axis), m. Default 12.
    pub max_diameter_m: f64,
    /// Number larger than D goes as D^-exponent. Default 2.5, a choice: counts on small bodies are somewhat steeper, as 2.65 on Ryugu (Michikami et al. 2019,
    /// Icarus 331, 179).
    pub exponent: f64,
    /// What they look like. Default "angular".
    pub shape: Shape,
    /// Share of a boulder's height that is below the ground, 0 to 1: one number, or from one to another. Default 0.5.
    pub buried: Span,
    /// Material. Default "phobos_red".
    pub material: String,
    /// Where they lie; default: everywhere.
    #[serde(rename = "where", skip_serializing_if = "Option::is_none")]
    pub area: Option<Where>,
    /// Boulders placed one by one, besides.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub placed: Vec<PlacedBoulder>,
}

/// What boulders look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// Blocks with flats and edges, axes about 1 : 0.75 : 0.55.
    Angular,
    /// Rounded stones, axes about 1 : 0.85 : 0.7.
    Rounded,
    /// Flat slabs with edges, axes about 1 : 0.8 : 0.25.
    Slab,
    /// Long splinters with edges, axes about 1 : 0.4 : 0.3.
    Shard,
    /// Knobbly lumps, axes about 1 : 0.85 : 0.75.
    Lumpy,
    /// Each boulder one of the others, by chance.
    Any,
}

/// A boulder at a place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlacedBoulder {
    /// East of the site's middle, m.
    pub x_m: f64,
    /// North of the site's middle, m.
    pub y_m: f64,
    /// Longest axis, m.
    pub diameter_m: f64,
}

/// A number, or two that others lie between.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Span {
    /// Always this.
    One(f64),
    /// Anything from the first to the second.
    Range([f64; 2]),
}

impl Span {
    /// Its two ends.
    pub fn ends(self) -> [f64; 2] {
        match self {
            Span::One(x) => [x, x],
            Span::Range(ends) => ends,
        }
    }
}

/// What a material of a landscape looks like to programs that know colours only, and what it is made of.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialRecipe {
    /// Linear red, green and blue, 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<[f64; 3]>,
    /// Shares of other materials, whose sum is 1. In a scene the mixture is an entry of its `[materials]`, too; the error without it gives the line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mixture: Option<BTreeMap<String, f64>>,
}

/// Facets that are of another material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Paint {
    /// The material.
    pub material: String,
    /// What is painted. Default "ground".
    #[serde(default)]
    pub on: Painted,
    /// Where; default: everywhere.
    #[serde(default, rename = "where", skip_serializing_if = "Option::is_none")]
    pub area: Option<Where>,
}

/// What is painted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Painted {
    /// Facets of the ground.
    #[default]
    Ground,
    /// Whole boulders, by where they lie.
    Boulders,
    /// Both.
    All,
}

/// A part of the site: all that is given must hold, and where several are between 0 and 1, their product counts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Where {
    /// In craters, or around them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub craters: Option<NearCraters>,
    /// In a circle: x and y of its middle, and its radius, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub circle_m: Option<[f64; 3]>,
    /// In a polygon: x and y of its corners, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub polygon_m: Option<Vec<[f64; 2]>>,
    /// In patches of noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<Patches>,
    /// Path of a raster that is stretched over the site, north up: the share of what would lie there, 0 to 1 (images of whole numbers: 0 to their largest).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map: Option<String>,
    /// Slope of the ground from and to, deg.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope_deg: Option<[f64; 2]>,
    /// Height of the ground from and to, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height_m: Option<[f64; 2]>,
    /// Everywhere but there. Default false.
    pub outside: bool,
}

/// Craters that are chosen, and how far from their middles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct NearCraters {
    /// Name of their group; default: all groups.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub group: Option<String>,
    /// Only those at least so wide, m. Default 0.
    pub min_diameter_m: f64,
    /// Only those at most so wide, m. Default: all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_diameter_m: Option<f64>,
    /// Only those no older. Default 1.
    pub max_age: f64,
    /// Of these a share by chance. Default 1.
    pub share: f64,
    /// Of these only so many, the largest. Default: all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest: Option<u32>,
    /// From this distance, in radii. Default 0.
    pub from: f64,
    /// To this distance, in radii. Default 1; ejecta reach to 3.
    pub to: f64,
    /// Whether there is less farther out, as the thickness of ejecta: r^-3 from the rim on. Default false.
    pub ejecta: bool,
}

/// Patches where noise is high.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patches {
    /// Size of the largest patches: the longest wavelength of the noise, m.
    pub longest_m: f64,
    /// Share of the area that is in a patch, 0 to 1. Default 0.5.
    #[serde(default = "half")]
    pub share: f64,
    /// How ragged: 1 is smooth, towards 0 ragged. Default 0.7.
    #[serde(default = "default_ragged")]
    pub hurst: f64,
}

/// A panchromatic texture: factors on the reflectance with the mean 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Texture {
    /// Texels along a side of the site.
    pub texels: u32,
    /// Standard deviation of the factors, which are kept from 0 to 2: of 0.5 that leaves 0.48. Default 0.1.
    #[serde(default = "default_contrast")]
    pub rms: f64,
    /// Longest wavelength, m. Default: 16 texels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_m: Option<f64>,
    /// How it shrinks with wavelength. Default 0.3.
    #[serde(default = "default_grain")]
    pub hurst: f64,
}

fn default_size_m() -> f64 {
    2000.0
}

fn default_facets() -> u32 {
    400_000
}

fn default_ground() -> String {
    GROUND.to_owned()
}

fn default_growth() -> f64 {
    0.1
}

fn one() -> f64 {
    1.0
}

fn half() -> f64 {
    0.5
}

fn east() -> f64 {
    90.0
}

fn default_rugged() -> f64 {
    0.9
}

fn default_rise() -> f64 {
    0.7
}

fn default_wander() -> f64 {
    0.3
}

fn default_ratio() -> f64 {
    4.0
}

fn default_ragged() -> f64 {
    0.7
}

fn default_contrast() -> f64 {
    0.1
}

fn default_grain() -> f64 {
    0.3
}

impl Default for Craters {
    fn default() -> Self {
        Craters {
            name: None,
            count: 0,
            per_km2: None,
            saturation: None,
            min_diameter_m: 8.0,
            max_diameter_m: 500.0,
            exponent: 1.8,
            depth: 0.2,
            rim: 0.04,
            softness: 0.9,
            creep_m: 0.0,
            overlap: Overlap::Erase,
            placed: Vec::new(),
        }
    }
}

impl Default for Boulders {
    fn default() -> Self {
        Boulders {
            name: None,
            count: 0,
            per_km2: None,
            min_diameter_m: 2.0,
            max_diameter_m: 12.0,
            exponent: 2.5,
            shape: Shape::Angular,
            buried: Span::One(0.5),
            material: BOULDERS.to_owned(),
            area: None,
            placed: Vec::new(),
        }
    }
}

impl Default for NearCraters {
    fn default() -> Self {
        NearCraters {
            group: None,
            min_diameter_m: 0.0,
            max_diameter_m: None,
            max_age: 1.0,
            share: 1.0,
            largest: None,
            from: 0.0,
            to: 1.0,
            ejecta: false,
        }
    }
}

impl Recipe {
    /// A plane of 2 x 2 km and 400,000 facets.
    pub fn plane(seed: u64) -> Self {
        Recipe {
            version: 2,
            seed,
            size_m: default_size_m(),
            facets: default_facets(),
            detail: None,
            surroundings: None,
            relief: Vec::new(),
            craters: Vec::new(),
            cover: Vec::new(),
            boulders: Vec::new(),
            ground: default_ground(),
            materials: BTreeMap::new(),
            paint: Vec::new(),
            body: None,
            texture: None,
        }
    }

    /// A site with rolling ground, 6000 craters and 3000 boulders: 2 x 2 km, 400,000 facets.
    pub fn new(seed: u64) -> Self {
        Recipe {
            relief: vec![Relief::Rolling { rms_m: 22.0, longest_m: 1200.0, hurst: 1.0 }],
            craters: vec![Craters { count: 6000, ..Craters::default() }],
            boulders: vec![Boulders { count: 3000, ..Boulders::default() }],
            ..Recipe::plane(seed)
        }
    }

    /// Area of the site, km2.
    pub(super) fn area_km2(&self) -> f64 {
        1e-6 * self.size_m * self.size_m
    }
}

impl Craters {
    /// Their diameters, m.
    pub(super) fn law(&self) -> PowerLaw {
        PowerLaw::new(self.min_diameter_m, self.max_diameter_m, self.exponent)
    }

    /// How many craters are made on a site with this area.
    pub(super) fn number(&self, area_km2: f64) -> f64 {
        let of_saturation = |share: f64| {
            let larger_per_km2 = 1.54 / (1e-6 * self.min_diameter_m * self.min_diameter_m);
            share * larger_per_km2 * area_km2 * self.law().share_within()
        };
        let by_density = self.per_km2.map(|density| density * area_km2);
        by_density.or(self.saturation.map(of_saturation)).map_or(f64::from(self.count), f64::round)
    }
}

impl Boulders {
    /// How many boulders are made on a site with this area.
    pub(super) fn number(&self, area_km2: f64) -> f64 {
        self.per_km2.map_or(f64::from(self.count), |density| (density * area_km2).round())
    }
}

impl Recipe {
    /// The rasters that it names: the item's key, and the name.
    pub fn files(&self) -> Vec<(String, &str)> {
        let under = self.relief.iter().enumerate().map(|(i, relief)| (format!("relief[{i}].file"), relief));
        let over = self.cover.iter().enumerate().map(|(i, relief)| (format!("cover[{i}].file"), relief));
        let relief = under.chain(over).filter_map(|(key, relief)| match relief {
            Relief::Elevation { file, .. } => Some((key, file.as_str())),
            _ => None,
        });
        let boulders = self.boulders.iter().enumerate().map(|(i, b)| (format!("boulders[{i}].where.map"), &b.area));
        let paint = self.paint.iter().enumerate().map(|(i, p)| (format!("paint[{i}].where.map"), &p.area));
        let maps = boulders.chain(paint).filter_map(|(key, area)| Some((key, area.as_ref()?.map.as_deref()?)));
        relief.chain(maps).collect()
    }

    /// The meshes that it names: the item's key, and the name.
    pub fn meshes(&self) -> Vec<(String, &str)> {
        let files = self.body.iter().filter_map(|body| body.files.as_deref()).flatten();
        files.enumerate().map(|(i, name)| (format!("body.files[{i}]"), name.as_str())).collect()
    }
}
