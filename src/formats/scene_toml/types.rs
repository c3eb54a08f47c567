//! What people write in `scene.toml`. The published schema is made from these types and their comments.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::formats::mesh_file::{NamedPose, Up};
use crate::formats::recipe_toml::AnyRecipe;
use crate::spectral::Light;

use super::chain_types::{DetectorToml, OpticsToml};
pub(crate) use super::values::Values;

/// A scene: a body's surface, what lights it, and what looks at it. Relative paths start at this file's folder.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SceneToml {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    #[allow(dead_code, reason = "the schema checks it")]
    pub(crate) mmxrt_scene: u32,
    /// Origin of all local coordinates, in the body-fixed frame (x: longitude 0, z: north), m.
    pub(crate) origin_m: [f64; 3],
    /// The surface: one or more meshes.
    #[schemars(length(min = 1))]
    pub(crate) mesh: Vec<MeshToml>,
    /// What the surface is made of. The key is a material's name in the mesh, or its colour: `"#b03020"` (sRGB);
    /// `default` is for faces without a material.
    pub(crate) materials: BTreeMap<String, MaterialToml>,
    /// The Sun; it may be left out if `flight` says where it is.
    #[serde(default)]
    pub(crate) sun: SunToml,
    /// Mars as a second source; leave it out for none.
    pub(crate) mars: Option<MarsToml>,
    /// Further bodies of the sky, which light and warm the surface, hide the Sun and are drawn where they are in view: the Earth, moons.
    #[serde(default)]
    pub(crate) bodies: Vec<BodyToml>,
    /// Further sources at infinity, each with its own shadows.
    #[serde(default)]
    pub(crate) lamps: Vec<LampToml>,
    /// How warm the surface is.
    pub(crate) thermal: Option<ThermalToml>,
    /// Sun, camera or both by angles above a target, instead of their positions.
    pub(crate) geometry: Option<GeometryToml>,
    /// Where the camera is, and where it looks; left out if `geometry` or `flight` says so.
    pub(crate) observer: Option<ObserverToml>,
    /// Sun, Mars and camera by flight dynamics: where they are at a moment, and what moves between the bands or lines of an image.
    pub(crate) flight: Option<FlightToml>,
    /// The camera.
    pub(crate) sensor: SensorToml,
}

/// A mesh: from a file, or made from a recipe.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MeshToml {
    /// Path of a file: OBJ (`.obj`) or glTF (`.gltf`, `.glb`).
    pub(crate) file: Option<String>,
    /// The same as `file`.
    pub(crate) obj: Option<String>,
    /// A landscape recipe, or the path of one, or the name of a preset (`mmxrt landscape --list`).
    pub(crate) recipe: Option<RecipeToml>,
    /// The file's unit of length, m: 1000 for km. Default 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) unit_m: Option<f64>,
    /// The file's axis that points up. Default "z" for OBJ, "y" for glTF.
    pub(crate) up: Option<Up>,
    /// Whether the file's coordinates are local to `origin_m`, or start at the body's centre. Default "local".
    pub(crate) coordinates: Option<Coordinates>,
    /// How local coordinates stand on the body. Default "body"; "radial" for a recipe.
    pub(crate) pose: Option<PoseToml>,
    /// Whether all facets are turned over: for a mesh that is inside out. Default false.
    pub(crate) flip: Option<bool>,
    /// Entry of the dictionary that all of this mesh is made of, whatever the mesh itself says.
    pub(crate) material: Option<String>,
    /// An image that says which entry of the dictionary each facet is of.
    pub(crate) material_map: Option<MaterialMapToml>,
    /// Path of a CSV table of where the mesh stands, instead of once at its own place: `x_m`, `y_m`, `z_m` of its origin, in the coordinates that it else has itself, and
    /// `scale` (or `scale_x`, `scale_y`, `scale_z`) and a unit quaternion `qx`, `qy`, `qz`, `qw`, or the matrix of both, `xx`, `xy`, .. `zz`. A row for each instance.
    pub(crate) instances: Option<String>,
}

/// Which material each facet is of: that of the texel at the facet's middle.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MaterialMapToml {
    /// Path of a raster: one band of numbers, or a picture's three of colour.
    pub(crate) raster: String,
    /// Names of the raster's channels, if it has more.
    #[schemars(length(min = 1))]
    pub(crate) channels: Option<Vec<String>>,
    /// Which entry of the dictionary each number (`3 = "regolith"`) or colour (`"#aa907c" = "regolith"`) of the raster stands for; of pictures as they are stored, 0 to
    /// 255 or 65535.
    pub(crate) materials: BTreeMap<String, String>,
    /// Where it lies, as a texture does.
    pub(crate) placement: TexturePlacementToml,
    /// For `placement = "plane"`: where the raster lies. Default: where its own georeference in metres puts it, to the East and the North of `origin_m`.
    pub(crate) plane: Option<PlaneToml>,
    /// For `placement = "atlas"`: how the image continues beyond its border. Default: not at all.
    pub(crate) wrap: Option<WrapToml>,
    /// For `placement = "lonlat"`: east longitude of the outer border of the map's first column, deg, mostly 0 or -180.
    /// Default: what the raster says, if it lies in degrees.
    pub(crate) west_deg: Option<f64>,
}

/// A recipe, or a file with one.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum RecipeToml {
    /// Path of a recipe.
    File(String),
    /// The recipe itself.
    Given(AnyRecipe),
}

/// Where a mesh's coordinates start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Coordinates {
    /// At `origin_m`.
    Local,
    /// At the body's centre, axes of the body: `origin_m` is subtracted.
    Body,
}

/// How local coordinates stand on the body.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum PoseToml {
    /// By name.
    Named(NamedPose),
    /// By numbers.
    Given(GivenPose),
}

/// A rotation and a translation.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct GivenPose {
    /// Rotation as a unit quaternion (x, y, z, w) that carries mesh axes into body axes.
    pub(crate) world_from_mesh_xyzw: [f64; 4],
    /// Where the mesh's origin is, from `origin_m`, axes of the body, m. Default 0.
    pub(crate) translation_m: Option<[f64; 3]>,
}

/// What a surface is made of: its own reflectance, or a mixture of other entries.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MaterialToml {
    /// Reflectance, 0 to 1: a number, or the path of a CSV table. The surface is Lambert unless one of the models below, a preset or a table is given.
    pub(crate) reflectance: Option<Values>,
    /// A surface by name: its model and numbers, of which those given below replace single ones, and without a `reflectance` its albedo.
    pub(crate) preset: Option<PresetToml>,
    /// How the reflectance was measured; a model has the albedo that gives it. Default "hemispherical".
    pub(crate) measured: Option<MeasuredToml>,
    /// Lommel and Seeliger's model of dark particles; its albedo is that of single scattering.
    pub(crate) lommel_seeliger: Option<LommelSeeligerToml>,
    /// McEwen's mixture of Lommel and Seeliger's surface and Lambert's; its albedo is the normal one.
    pub(crate) lunar_lambert: Option<LunarLambertToml>,
    /// Minnaert's model; its albedo is the normal one.
    pub(crate) minnaert: Option<MinnaertToml>,
    /// Akimov's model of a very rough surface; its albedo is the normal one.
    pub(crate) akimov: Option<AkimovToml>,
    /// Hapke's model, whose albedo is that of single scattering; or the path of a CSV table of `w`, `c1`, `c2`, `c3`, `c4`, `h1`, `h2`.
    pub(crate) hapke: Option<HapkeToml>,
    /// The model of Rahman, Pinty and Verstraete, whose albedo is its amplitude rho0; or the path of a CSV table of `rho0`, `k`, `g`, `h`.
    pub(crate) rpv: Option<RpvToml>,
    /// Path of a CSV table of reflectance factors by `incidence_deg`, and where they count `emission_deg`, `azimuth_deg` and `wavelength_um`. A `reflectance`,
    /// measured as it says, sets its level; left out, the factors are as they stand.
    pub(crate) table: Option<String>,
    /// Shares of other entries, which add up to 1.
    pub(crate) mixture: Option<BTreeMap<String, f64>>,
    /// Values of tables beyond their ends: unknown ("error", the default), or their last value ("hold").
    pub(crate) extend: Option<ExtendToml>,
    /// Emissivity, 0 to 1: a number, or the path of a CSV table. Default 1 - reflectance, with a model by direction; for a mixture, that of its parts by their shares.
    pub(crate) emissivity: Option<Values>,
    /// Share of all sunlight that is not absorbed. Default: mean of the reflectance, weighted with the solar spectrum.
    pub(crate) bond_albedo: Option<f64>,
    /// Emissivity over all wavelengths, for the heat balance. Default 0.95.
    pub(crate) emissivity_bolometric: Option<f64>,
    /// Thermal inertia of the ground, J m-2 K-1 s-1/2; Phobos' is some 20 to 100. Default: that of `thermal`.
    #[schemars(range(min = 0))]
    pub(crate) thermal_inertia: Option<f64>,
    /// Temperature at which it is held, K, whatever it absorbs: of what is heated, or known. Default: that of the thermal model.
    #[schemars(range(min = 0))]
    pub(crate) temperature_k: Option<f64>,
    /// Variation of reflectance inside facets. Heat does not see it.
    pub(crate) texture: Option<TextureToml>,
}

/// Surfaces with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PresetToml {
    /// Phobos in green light: Hapke's model, w, B0 and h of Fornasier et al. (2024), b and mean slope assumed.
    PhobosAssumed,
    /// Deimos in green light: Hapke's model, w, B0 and h of Wargnier et al. (2025), b and mean slope assumed.
    DeimosAssumed,
    /// The Moon in red light: Hapke's model, typical numbers.
    Moon,
    /// Mars in red light: Minnaert's model, assumed.
    Mars,
    /// Phobos as Domagala (2020) has it: Lambert's surface, 0.07.
    Thesis,
}

/// How a reflectance was measured.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum MeasuredToml {
    /// By name.
    Named(MeasuredNameToml),
    /// As a reflectance factor at some angles.
    At(MeasuredAtToml),
}

/// Measurements with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum MeasuredNameToml {
    /// Share of the light from all of the sky that goes back: the spherical (Bond's) albedo at a wavelength.
    Hemispherical,
    /// Reflectance factor with light and view at the zenith.
    Normal,
    /// It is the model's own albedo.
    Albedo,
}

/// Angles of a reflectance factor.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MeasuredAtToml {
    /// Of the light from the normal, deg.
    pub(crate) incidence_deg: f64,
    /// Of the view from the normal, deg.
    pub(crate) emission_deg: f64,
    /// Between light and view, deg.
    pub(crate) phase_deg: f64,
}

/// Lommel and Seeliger's model.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LommelSeeligerToml {
    /// Asymmetry of the particles' phase function (Henyey and Greenstein), -1 to 1; below 0 scatters back. Default: isotropic.
    pub(crate) b: Option<f64>,
    /// For two terms: which is the stronger, above 0 the one that scatters back; `b` is then from 0, the width of both.
    pub(crate) c: Option<f64>,
}

/// Lunar-Lambert.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LunarLambertToml {
    /// L, how much of it is Lommel and Seeliger's.
    pub(crate) share: ShareToml,
    /// How brightness falls with phase. Default: not at all.
    pub(crate) phase: Option<PhaseCurveToml>,
}

/// How much of a lunar-Lambert surface is Lommel and Seeliger's.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum ShareToml {
    /// The same at all phase angles, 0 to 1.
    Constant(f64),
    /// By name.
    Named(ShareNameToml),
    /// exp(-g / scale).
    Exponential(ShareScaleToml),
}

/// Shares with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ShareNameToml {
    /// McEwen's (1996) polynomial for the Moon.
    Moon,
}

/// A share that falls with phase.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ShareScaleToml {
    /// Phase angle at which it is 1 / e, deg.
    pub(crate) scale_deg: f64,
}

/// Minnaert's model.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MinnaertToml {
    /// Exponent k, from 0; 1 is Lambert's surface.
    pub(crate) exponent: f64,
}

/// Akimov's model.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AkimovToml {
    /// How brightness falls with phase. Default: not at all.
    pub(crate) phase: Option<PhaseCurveToml>,
}

/// Brightness by the phase angle g, rad: exp(beta g + gamma g^2 + delta g^3).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PhaseCurveToml {
    /// Per rad; below 0. Default 0.
    pub(crate) beta: Option<f64>,
    /// Per rad^2. Default 0.
    pub(crate) gamma: Option<f64>,
    /// Per rad^3. Default 0.
    pub(crate) delta: Option<f64>,
}

/// Hapke's model.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum HapkeToml {
    /// Path of a table: every parameter is a spectrum.
    File(String),
    /// Numbers.
    Given(Box<HapkeNumbersToml>),
}

/// Parameters of Hapke's model that are the same at all wavelengths.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct HapkeNumbersToml {
    /// Asymmetry of the particles' phase function (Henyey and Greenstein), -1 to 1; below 0 scatters back. Default: isotropic.
    pub(crate) b: Option<f64>,
    /// For two terms: which is the stronger, above 0 the one that scatters back; `b` is then from 0, the width of both.
    pub(crate) c: Option<f64>,
    /// Opposition surge by shadows. Default: none.
    pub(crate) shadow_hiding: Option<SurgeToml>,
    /// Opposition surge by coherent backscatter. Default: none.
    pub(crate) coherent: Option<SurgeToml>,
    /// Mean slope of what is rough below the size of a facet, deg, 0 to 90. Default 0.
    pub(crate) mean_slope_deg: Option<f64>,
    /// K, from 1: by how much close packing brightens the layer. Default 1.
    pub(crate) porosity_factor: Option<f64>,
    /// Which H function. Default "exact".
    pub(crate) h: Option<HFormulaToml>,
}

/// A peak of brightness about phase 0.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SurgeToml {
    /// Height B0, from 0. May be left out where a preset has one.
    pub(crate) amplitude: Option<f64>,
    /// Width h, above 0. May be left out where a preset has one.
    pub(crate) width: Option<f64>,
}

/// H functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum HFormulaToml {
    /// Chandrasekhar's own.
    Exact,
    /// Hapke's approximation of 1981.
    Hapke1981,
    /// Hapke's approximation of 2002.
    Hapke2002,
}

/// The model of Rahman, Pinty and Verstraete.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum RpvToml {
    /// Path of a table: every parameter is a spectrum.
    File(String),
    /// Numbers.
    Given(RpvNumbersToml),
}

/// Parameters of RPV that are the same at all wavelengths.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RpvNumbersToml {
    /// Exponent k, from 0: below 1 the limb is bright.
    pub(crate) k: f64,
    /// Asymmetry, -1 to 1; below 0 scatters back.
    pub(crate) g: f64,
    /// rho_c of the hot spot, up to 2.
    pub(crate) h: f64,
}

/// An image on a material's facets.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TextureToml {
    /// Path of a raster, or of several of the same size whose bands are concatenated.
    pub(crate) raster: RasterToml,
    /// Names of the raster's channels, in the order of the bands. Default: all bands; of OpenEXR, the spectral layer or that of colours, in
    /// the order that names give by wavelength, red, green, blue, or a number.
    #[schemars(length(min = 1))]
    pub(crate) channels: Option<Vec<String>>,
    /// What its numbers are.
    pub(crate) quantity: TextureQuantityToml,
    /// Their unit. Default "1".
    pub(crate) unit: Option<FactorUnitToml>,
    /// Where it lies.
    pub(crate) placement: TexturePlacementToml,
    /// For `placement = "plane"`: where the raster lies. It is projected through everything. Default: where its own georeference in metres
    /// puts it, to the East and the North of `origin_m`.
    pub(crate) plane: Option<PlaneToml>,
    /// For `placement = "atlas"`: how the image continues beyond its border. Default: not at all.
    pub(crate) wrap: Option<WrapToml>,
    /// For `placement = "lonlat"`: east longitude of the outer border of the map's first column, deg, mostly 0 or -180.
    /// Default: what the raster says, if it lies in degrees.
    pub(crate) west_deg: Option<f64>,
    /// Whether factors are divided by their mean over the material's facets, so that it is 1 ("one", the default for factors), or
    /// stay as they are ("kept", the default for reflectances).
    pub(crate) mean: Option<MeanToml>,
    /// Interpolation between texel centres. Default "nearest".
    pub(crate) texels: Option<TexelsToml>,
    /// Wavelengths of the raster's bands, if it does not state them or to override them. A single band needs none: it is for all wavelengths.
    pub(crate) bands: Option<BandsToml>,
}

/// One file, or several.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum RasterToml {
    /// One raster.
    One(String),
    /// Several.
    Several(Vec<String>),
}

/// What a texture's numbers are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum TextureQuantityToml {
    /// Factors of the material's reflectance.
    Factor,
    /// Reflectances that replace the material's.
    Reflectance,
}

/// Units of factors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
pub(crate) enum FactorUnitToml {
    /// As it is.
    #[serde(rename = "1")]
    One,
    /// Times 100.
    #[serde(rename = "%")]
    Percent,
}

/// Where a texture lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum TexturePlacementToml {
    /// By the texture coordinates of the meshes.
    Atlas,
    /// On squares of a plane, put onto the scene along one direction.
    Plane,
    /// By longitude and latitude: columns go once around the body, to the East, rows from the North pole to the South pole in equal steps of
    /// planetocentric latitude.
    LonLat,
}

/// How an image continues beyond its border.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum WrapToml {
    /// It repeats in all directions; interpolation crosses the borders.
    Repeat,
    /// It repeats to the left and right, as a map of all longitudes.
    RepeatU,
    /// It repeats above and below.
    RepeatV,
}

/// What is done with a texture's mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum MeanToml {
    /// It is made 1.
    One,
    /// It stays.
    Kept,
}

/// Interpolation between texel centres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum TexelsToml {
    /// A texel has one value throughout.
    Nearest,
    /// Values vary linearly from centre to centre.
    Bilinear,
}

/// A raster on a plane.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlaneToml {
    /// The outer corner of the first pixel of the first line, m.
    pub(crate) corner_m: [f64; 3],
    /// From a pixel to the next one in its line, m.
    pub(crate) along_line_m: [f64; 3],
    /// From a line to the next one, m.
    pub(crate) line_to_line_m: [f64; 3],
    /// Direction towards the viewer, along which the plane is put onto the scene; any length. Default: the plane's normal, on the
    /// side from which the image is not a mirror image.
    pub(crate) towards: Option<[f64; 3]>,
    /// Whether positions are local to `origin_m` of the scene, or start at the body's centre. Axes are those of the body. Default "local".
    pub(crate) coordinates: Option<Coordinates>,
}

/// Values of a table beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ExtendToml {
    /// The last value.
    Hold,
    /// Unknown.
    Error,
}

/// The axes that positions and directions are given in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Frame {
    /// The body-fixed frame: from the body's centre, z north.
    #[default]
    Body,
    /// The site's: from `origin_m`, x east, y north, z along the outward radius.
    Site,
}

/// The Sun: a position, or a direction and a distance. Both are taken from `origin_m`.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SunToml {
    /// What `position_m` and `direction` are given in. Default "body".
    pub(crate) frame: Option<Frame>,
    /// Position in the body-fixed frame, from the body's centre, m; left out if `flight` says it.
    pub(crate) position_m: Option<[f64; 3]>,
    /// Towards the Sun from `origin_m`, axes of the body; any length.
    pub(crate) direction: Option<[f64; 3]>,
    /// From `origin_m` to the Sun, au.
    pub(crate) distance_au: Option<f64>,
    /// Irradiance at the scene, whatever the distance (1 au if there is none), instead of a spectrum: of a lamp in the Sun's stead, W m-2 um-1, a
    /// number (1: unit irradiance) or the path of a CSV table.
    pub(crate) irradiance: Option<Values>,
    /// Irradiance at 1 au: "e490" (ASTM E490-00a, built in, the default) or the path of a CSV table.
    pub(crate) spectrum: Option<String>,
    /// Total irradiance at 1 au that the spectrum is scaled to, with what is added beyond its ends, W m-2. Default: the spectrum as it is; beyond its
    /// ends E490, scaled to join it, if it may be the Sun's (0.5 to 2 times E490), else nothing. With `irradiance` it is that at the scene, and scales
    /// nothing; default: the integral of its table, 0 of a number.
    pub(crate) total_irradiance_w_m2: Option<f64>,
    /// How much darker its limb is than its middle, u in 1 - u (1 - cos(emission)): some 0.6 in the visible, 0.2 at 3 um. Default 0: a
    /// uniform disc. It matters with `points`.
    pub(crate) limb_darkening: Option<f64>,
    /// Number of points that stand for its disc, with the penumbrae that these cast: 3, 4, 7, 12, 19, 21 or 37; 1 is a point, without penumbrae.
    /// What is stated here stays, whatever the tolerance. Default: as many as the plan's tolerance takes, or a point where it drops the disc.
    pub(crate) points: Option<u32>,
}

/// Parallel light of a stated irradiance.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LampToml {
    /// What it is called: letters, digits, `-` and `_`.
    pub(crate) name: String,
    /// What `direction` is given in. Default "body".
    pub(crate) frame: Option<Frame>,
    /// Towards it; any length.
    pub(crate) direction: [f64; 3],
    /// Irradiance at the scene on a plane normal to its light, W m-2 um-1: a number, or the path of a CSV table.
    pub(crate) irradiance: Values,
    /// Total of that, for the heat balance, W m-2. Default: the integral of a table; 0 of a number.
    pub(crate) total_irradiance_w_m2: Option<f64>,
}

/// Mars as an extended second source.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MarsToml {
    /// Position of its centre in the body-fixed frame, from the body's centre, m; left out if `flight` says it.
    pub(crate) position_m: Option<[f64; 3]>,
    /// Radius, m. Default 3389500.
    pub(crate) radius_m: Option<f64>,
    /// Lambert reflectance, 0 to 1: a number, or the path of a CSV table. Default 0.25.
    pub(crate) albedo: Option<Values>,
    /// Bond albedo, for the heat balance. Default 0.25.
    pub(crate) bond_albedo: Option<f64>,
    /// Mean thermal exitance, for the heat balance, W m-2. Default 110.
    pub(crate) thermal_exitance_w_m2: Option<f64>,
    /// Brightness temperature of its day side, K. Default 270. It matters with `heat`.
    pub(crate) day_k: Option<f64>,
    /// The same of its night side. Default 200.
    pub(crate) night_k: Option<f64>,
    /// Whether its own heat lights the surface too, in bands that hold heat and sunlight: next to its reflected light it matters beyond
    /// 3 um. What is stated here stays, whatever the tolerance. Default: where the plan's tolerance needs it.
    pub(crate) heat: Option<bool>,
    /// Which equations. What is stated here stays, whatever the tolerance. Default "near_field", where the plan's tolerance needs Mars-light.
    pub(crate) model: Option<MarsModelToml>,
    /// Whether it hides the Sun where it stands before it: one choice for it and all `bodies`. What is stated here stays, whatever the tolerance.
    /// Default: where the plan's tolerance needs it.
    pub(crate) eclipse: Option<bool>,
    /// Number of parts of its disc that terrain may hide: 1, 3, 4, 7, 12, 19, 21 or 37. What is stated here stays, whatever the tolerance.
    /// Default: 7 where the plan keeps shadows in Mars-light; else only a facet's own horizon hides some of it.
    pub(crate) points: Option<u32>,
}

/// A body of the sky: a Lambert sphere. Terrain hides of it what `mars.points` says.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BodyToml {
    /// What it is called: letters, digits, `-` and `_`.
    pub(crate) name: String,
    /// Position of its centre in the body-fixed frame, from the body's centre, m; left out if `flight` says it.
    pub(crate) position_m: Option<[f64; 3]>,
    /// Radius, m.
    pub(crate) radius_m: f64,
    /// Lambert reflectance, 0 to 1: a number, or the path of a CSV table.
    pub(crate) albedo: Values,
    /// Bond albedo, for the heat balance. Default: the mean of `albedo`, weighted with sunlight.
    pub(crate) bond_albedo: Option<f64>,
    /// Brightness temperature of its day side, K. Default 0: it is not warm.
    pub(crate) day_k: Option<f64>,
    /// The same of its night side. Default 0.
    pub(crate) night_k: Option<f64>,
    /// Mean thermal exitance, for the heat balance, W m-2. Default: of black bodies at these temperatures.
    pub(crate) thermal_exitance_w_m2: Option<f64>,
    /// Whether bodies hide the Sun where they stand before it: one choice for all, and for Mars, as `mars.eclipse`.
    pub(crate) eclipse: Option<bool>,
}

/// How Mars-light is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MarsModelToml {
    /// Lambert sphere in the near field: phase, tilt and horizon of each facet.
    NearField,
    /// Domagala (2020), equations (4) to (8) as printed.
    Thesis,
    /// Mars sends no light that is seen; it still warms.
    Off,
}

/// How warm the surface is.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ThermalToml {
    /// Which model. What is stated here stays, whatever the tolerance: "equilibrium" is without conduction. Default "equilibrium", where the plan's
    /// tolerance needs heat; it is conducted, too, where the tolerance needs that, and `inertia` and (without `flight`) `period_s` are given.
    pub(crate) model: Option<ThermalModelToml>,
    /// Thermal inertia of all materials that don't state theirs, J m-2 K-1 s-1/2. Default: heat is not stored.
    #[schemars(range(min = 0))]
    pub(crate) inertia: Option<f64>,
    /// From noon to noon, s: 27553.84 on Phobos. With `flight` Sun, Mars and bodies are at each step of that day where they were before the scene. Default: as
    /// `flight` has it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) period_s: Option<f64>,
    /// Axis about which the body turns, by the right hand, in the body-fixed frame, where `flight` does not know the day before. Default z.
    pub(crate) axis: Option<[f64; 3]>,
    /// Steps of a day in which heat is conducted. Default 96.
    #[schemars(range(min = 3, max = 10000))]
    pub(crate) steps: Option<u32>,
    /// No part of a facet is colder, K, whatever it receives: what heat from below, or from its sides, keeps up in shadow. Default: no floor.
    #[schemars(range(min = 0, max = 10000))]
    pub(crate) floor_k: Option<f64>,
}

/// How temperature is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ThermalModelToml {
    /// Each facet in equilibrium with what it absorbs.
    Equilibrium,
    /// Heat is conducted into the ground and back, over a day that repeats.
    Conduction,
    /// Domagala (2020), equation (9).
    Thesis,
    /// No thermal emission.
    Off,
}

/// Sun and camera by angles above a target. `incidence_deg` places the Sun, `emission_deg` the camera; the phase angle can replace one of the
/// azimuths.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct GeometryToml {
    /// What `target_m` and `normal` are given in. Default "body".
    pub(crate) frame: Option<Frame>,
    /// Point that the camera looks at, in the body-fixed frame, m; with `frame = "site"` from `origin_m`. Default: `origin_m`.
    pub(crate) target_m: Option<[f64; 3]>,
    /// The target's zenith, any length. Default: the outward radius at the target; z with `frame = "site"`.
    pub(crate) normal: Option<[f64; 3]>,
    /// Angle from the zenith to the Sun, deg.
    #[schemars(range(min = 0, max = 180))]
    pub(crate) incidence_deg: Option<f64>,
    /// Azimuth of the Sun, from north through east, deg.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) sun_azimuth_deg: Option<f64>,
    /// Angle from the zenith to the camera, deg.
    #[schemars(range(min = 0, max = 180))]
    pub(crate) emission_deg: Option<f64>,
    /// Azimuth of the camera, from north through east, deg.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) observer_azimuth_deg: Option<f64>,
    /// Angle at the target between Sun and camera, deg, instead of one of the azimuths: the camera is then clockwise of the Sun, seen from
    /// the zenith.
    #[schemars(range(min = 0, max = 180))]
    pub(crate) phase_deg: Option<f64>,
    /// Height of the camera above the target's horizontal plane, m; or `range_m`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) altitude_m: Option<f64>,
    /// Distance of the camera from the target, m; or `altitude_m`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) range_m: Option<f64>,
    /// What is at the top of the image, as seen from the target. Default "north".
    pub(crate) up: Option<Top>,
}

/// What is at the top of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Top {
    /// North.
    North,
    /// The zenith: the horizon is level.
    Zenith,
    /// The Sun.
    Sun,
}

/// Trajectories and attitudes over time: from files, by a quasi-satellite orbit, or both. They place the Sun, Mars (if there is a table `mars`),
/// further bodies that they cover, and the camera, whose positions are then left out elsewhere.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FlightToml {
    /// Start of the (first) exposure, e.g. "2027-05-01T06:00:00 UTC"; time scales are UTC, TAI, TT, TDB and GPS.
    pub(crate) epoch: String,
    /// Paths of files: OEM, AEM, SPICE kernels and meta-kernels, tables. Where two overlap, the later one is used. Mars about the Sun, and Phobos and
    /// Deimos about Mars, are known approximately without files (1800 to 2050: the Sun's direction to 0.02 deg, Mars' to 3 deg).
    #[serde(default)]
    pub(crate) files: Vec<String>,
    /// The target body. Default "PHOBOS".
    pub(crate) body: Option<String>,
    /// Its body-fixed frame, in which the mesh does not move. Default: `IAU_` and its name.
    pub(crate) frame: Option<String>,
    /// The spacecraft, by its name in the files; or `orbit`.
    pub(crate) spacecraft: Option<String>,
    /// A quasi-satellite orbit about Phobos by its size in km, e.g. "qso-20x27". The mission's are qso-20x27, qso-22x31, qso-30x49, qso-50x94 and
    /// qso-100x198; any other size will do. "3d-qso-30x49x20" starts 20 km above the equator.
    pub(crate) orbit: Option<String>,
    /// Epoch at which the orbit crosses the line from Phobos to Mars. Default: `epoch`.
    pub(crate) orbit_epoch: Option<String>,
    /// Light time and stellar aberration of the Sun and bodies. Default "none": neither.
    pub(crate) correction: Option<CorrectionToml>,
    /// Where the camera looks. Default: at the body's centre, north up.
    pub(crate) pointing: Option<PointingToml>,
}

/// Light time and stellar aberration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum CorrectionToml {
    /// Neither: geometric positions.
    None,
    /// Light time.
    LightTime,
    /// Light time, and stellar aberration by the body's velocity.
    LightTimeAndAberration,
}

/// Where the camera looks: at `target_m`, by the attitude in a file (`frame`), fixed in a frame (`fixed_in`), or at the body's centre.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointingToml {
    /// Target point, from the body's centre in body axes, m.
    pub(crate) target_m: Option<[f64; 3]>,
    /// A frame whose orientation an attitude file or kernel gives, e.g. the spacecraft's.
    pub(crate) frame: Option<String>,
    /// A frame in which the camera's attitude is fixed, e.g. "J2000" or "IAU_PHOBOS".
    pub(crate) fixed_in: Option<String>,
    /// The sensor's mounting in `frame` or `fixed_in`: unit quaternion (x, y, z, w) from sensor axes (x sample, y line, z boresight) to those of the
    /// frame. Default: identity.
    pub(crate) frame_from_sensor_xyzw: Option<[f64; 4]>,
    /// The image's up direction, where the boresight follows a point: "north" (the default), "backward", "sun", or a direction in body axes.
    pub(crate) up: Option<UpToml>,
    /// A constant-rate rotation about a sensor axis, added to the above, e.g. of a scan mirror.
    pub(crate) scan: Option<ScanToml>,
    /// A constant pointing error about the sensor's axes, mrad.
    pub(crate) bias_mrad: Option<[f64; 3]>,
    /// A time-varying pointing error.
    pub(crate) jitter: Option<JitterToml>,
}

/// What is at the top of an image.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum UpToml {
    /// By name.
    Named(UpNameToml),
    /// A direction, axes of the body; any length.
    Direction([f64; 3]),
}

/// Tops of images with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum UpNameToml {
    /// The body's +z.
    North,
    /// Against the way over the ground: lines that are taken later lie below.
    Backward,
    /// The Sun.
    Sun,
}

/// A steady turn.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ScanToml {
    /// About which axis of the sensor, by the right hand.
    pub(crate) axis: SensorAxisToml,
    /// Angle at `epoch`, deg. Default 0.
    pub(crate) start_deg: Option<f64>,
    /// deg/s.
    pub(crate) rate_deg_s: f64,
}

/// Axes of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SensorAxisToml {
    /// Along a line: the turn moves what is seen from line to line.
    X,
    /// From line to line: the turn moves what is seen along the line.
    Y,
    /// The boresight.
    Z,
}

/// An unsteady error of pointing: random waves with a flat spectrum.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JitterToml {
    /// Root mean square about the sensor's axes, mrad.
    pub(crate) rms_mrad: [f64; 3],
    /// Lowest and highest frequency, Hz.
    pub(crate) band_hz: [f64; 2],
    /// The same seed, the same waves. Default 1.
    pub(crate) seed: Option<u64>,
}

/// Where the camera is, and one of: `target_m` and `up`; `h`, `v` and `u`; `world_from_sensor_xyzw`. Or all of it as `camera_to_world`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObserverToml {
    /// What all positions, directions and rotations of this table are given in. Default "body".
    pub(crate) frame: Option<Frame>,
    /// Projection centre in the body-fixed frame, from the body's centre, m.
    pub(crate) position_m: Option<[f64; 3]>,
    /// Point that the boresight goes through, in the body-fixed frame, m.
    pub(crate) target_m: Option<[f64; 3]>,
    /// Direction that points to the top of the image, axes of the body; any length.
    pub(crate) up: Option<[f64; 3]>,
    /// Unit vector to the right of the image (+X, along a line), axes of the body.
    pub(crate) h: Option<[f64; 3]>,
    /// Unit vector to the bottom of the image (+Y, line after line), axes of the body.
    pub(crate) v: Option<[f64; 3]>,
    /// Unit vector of the boresight (+Z): h x v = u.
    pub(crate) u: Option<[f64; 3]>,
    /// Unit quaternion (x, y, z, w) that carries sensor axes into body axes.
    pub(crate) world_from_sensor_xyzw: Option<[f64; 4]>,
    /// Position and axes as renderers give them, instead of all of the above: the rows of the 4 x 4 matrix that carries the camera's
    /// axes into those of the body, positions in m; which way the camera looks, `convention` says.
    pub(crate) camera_to_world: Option<[[f64; 4]; 4]>,
    /// Which axes the camera of `camera_to_world` has.
    pub(crate) convention: Option<ConventionToml>,
    /// Whether the position in `camera_to_world` is local to `origin_m` of the scene, or starts at the body's centre, as `position_m`
    /// does. Default "body".
    pub(crate) coordinates: Option<Coordinates>,
}

/// Axes of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ConventionToml {
    /// x right, y down, looks along +z: OpenCV, COLMAP.
    Opencv,
    /// x right, y up, looks along -z: OpenGL, glTF, NeRF.
    Opengl,
    /// As OpenGL: `matrix_world` of a camera in Blender.
    Blender,
    /// x left, y up, looks along +z: `to_world` of a sensor in Mitsuba.
    Mitsuba,
}

/// A camera, by preset or by its own numbers; keys given besides a preset override it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SensorToml {
    /// What one exposure takes: "frame" (the default, unless a preset says otherwise and there is a table `flight`), the whole image;
    /// "tunable_filter", one band after another; "push_broom", one line after another; "whisk_broom", one sample of a sweep after another.
    pub(crate) kind: Option<KindToml>,
    /// Period from one band or line to the next, s, for a sensor that does not take the whole image at once; for a whisk-broom from sweep to sweep.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) period_s: Option<f64>,
    /// For a whisk-broom: how its mirror sweeps; `period_s` is from sweep to sweep.
    pub(crate) mirror: Option<MirrorToml>,
    /// For a push-broom: smile, the shift of all band centres at a sample, um: coefficients of 1, u, u^2, ..., with u from -1 at the left border of
    /// the slit to 1 at the right one.
    pub(crate) smile_um: Option<Vec<f64>>,
    /// For a push-broom: keystone, the shift of a band to the right, pixels: coefficients of 1, w, w^2, ..., with w from -1 at the shortest centre to
    /// 1 at the longest.
    pub(crate) keystone_px: Option<Vec<f64>>,
    /// Exposure time, s. Default: `period_s`; for a whisk-broom all of a sample's time, for a frame camera 0.
    #[schemars(range(min = 0))]
    pub(crate) exposure_s: Option<f64>,
    /// Poses of the camera that stand for its motion during an exposure, at even steps; with n of them a pixel at an edge is off by at most d / (8 n^2) of the contrast, d
    /// the pixels that the edge moves. Default: as many as the tolerance of a plan needs, and 1, the middle alone, by a list of models without `smear`.
    #[schemars(range(min = 1, max = 1000))]
    pub(crate) exposure_poses: Option<u32>,
    /// "macromega": 256 x 256 pixels, 300 bands from 0.95 to 3.6 um, IFOV 0.5 mrad; with `flight` a tunable filter of a band a second. "mirs": a slit of 165
    /// pixels, 271 bands of 20 nm from 0.9 to 3.6 um, IFOV 0.35 mrad, a push-broom whose `lines` and `period_s` are given. Both come with optics and a detector, unless `ideal`.
    pub(crate) preset: Option<Preset>,
    /// Name of the instrument.
    pub(crate) name: Option<String>,
    /// Pixels in a line.
    #[schemars(range(min = 1, max = 16384))]
    pub(crate) samples: Option<u32>,
    /// Lines.
    #[schemars(range(min = 1, max = 16384))]
    pub(crate) lines: Option<u32>,
    /// Angle that a pixel on the boresight subtends, along a line, mrad.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) ifov_mrad: Option<f64>,
    /// Angle that a line of pixels subtends, seen about its middle, deg; with `window` a line of the larger image.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
    pub(crate) fov_deg: Option<f64>,
    /// Focal length in pixels: one number, or that along a line and that across (fx, fy).
    pub(crate) focal_px: Option<FocalToml>,
    /// Focal length, mm, with `sensor_mm`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) focal_mm: Option<f64>,
    /// Size of the sensor, mm: of the side that `sensor_fit` says.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) sensor_mm: Option<f64>,
    /// The side that `sensor_mm` and `shift` go by. Default "auto", the longer one.
    pub(crate) sensor_fit: Option<SensorFitToml>,
    /// Height of a pixel over its width. Default 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) pixel_aspect: Option<f64>,
    /// Where the boresight meets the image (principal point), sample and line, pixels from the outer corner of the first pixel: what
    /// counts from that pixel's centre (cx, cy of OpenCV), plus 0.5. Default: the middle. With `window` it is of the larger image.
    pub(crate) boresight_px: Option<[f64; 2]>,
    /// Shift of the lens to the right and up, in sizes of the sensor, as Blender's `shift_x` and `shift_y`; instead of `boresight_px`.
    pub(crate) shift: Option<[f64; 2]>,
    /// The image is a window of a larger one, which the keys above are about.
    pub(crate) window: Option<WindowToml>,
    /// What the lens does to the image of an ideal pinhole, whose keys are those above.
    pub(crate) distortion: Option<DistortionToml>,
    /// Path of a table of where pixels look, instead of the keys above: for the centre of each pixel, line by line, tangents (x right, y down, for 1 along the boresight)
    /// or vectors (x, y, z) along the sensor's axes, as an `.npy` array (lines, samples, 2 or 3) or as CSV with a header `x,y` or `x,y,z`. Corners of pixels are the means
    /// of the four centres around.
    pub(crate) directions: Option<String>,
    /// "scene": the smallest field of view that holds every vertex in front of the camera; the boresight stays.
    pub(crate) fit: Option<Fit>,
    /// Bands.
    pub(crate) bands: Option<BandsToml>,
    /// Focal length over aperture.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) f_number: Option<f64>,
    /// Pitch of the detector's pixels, um.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) pixel_um: Option<f64>,
    /// What blurs and veils the image.
    pub(crate) optics: Option<OpticsToml>,
    /// What counts the light.
    pub(crate) detector: Option<DetectorToml>,
    /// Whether the cube is the radiance at the aperture, averaged over pixels: neither `optics` nor `detector`, nor those of a preset. Default false.
    pub(crate) ideal: Option<bool>,
}

/// What a sensor takes at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum KindToml {
    /// All of the image.
    Frame,
    /// An image in one band.
    TunableFilter,
    /// A line in all bands.
    PushBroom,
    /// A sample in all bands, of one line or of a few: what `mirror` sweeps across the way.
    WhiskBroom,
}

/// How a mirror sweeps.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MirrorToml {
    /// Angle of a sweep, from the outer border of its first sample to that of its last, about the boresight, deg: the line of sight turns from left to right, or if
    /// it is negative from right to left.
    #[schemars(range(min = -180, max = 180))]
    pub(crate) field_deg: f64,
    /// Share of `period_s` in which samples are taken, from its beginning. Default 1.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub(crate) active: Option<f64>,
    /// Detector elements in a column along the way: lines of a sweep. Default 1.
    #[schemars(range(min = 1, max = 16384))]
    pub(crate) elements: Option<u32>,
}

/// A focal length in pixels.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum FocalToml {
    /// Of square pixels.
    Both(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// Along a line, and across.
    Each([f64; 2]),
}

/// The side of an image that a sensor's size refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SensorFitToml {
    /// The longer one.
    Auto,
    /// The width.
    Horizontal,
    /// The height.
    Vertical,
}

/// A window cut from a larger image.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WindowToml {
    /// Sample and line of the larger image at which the window begins, from 0.
    pub(crate) first_px: [f64; 2],
    /// Samples and lines of the larger image.
    pub(crate) of_px: [u32; 2],
}

/// The distortion of a lens, as OpenCV defines it: with tangents x, y of a direction, and r2 = x^2 + y^2, the image has it at
/// x (1 + k1 r2 + k2 r2^2 + k3 r2^3) + 2 p1 x y + p2 (r2 + 2 x^2) and y (1 + ...) + p1 (r2 + 2 y^2) + 2 p2 x y.
#[derive(Debug, Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct DistortionToml {
    /// Of r^2. Default 0.
    pub(crate) k1: f64,
    /// Of r^4. Default 0.
    pub(crate) k2: f64,
    /// Of r^6. Default 0.
    pub(crate) k3: f64,
    /// Tangential. Default 0.
    pub(crate) p1: f64,
    /// Tangential. Default 0.
    pub(crate) p2: f64,
}

/// The lens of a camera whose samples and lines are an image's: one of `ifov_mrad`, `fov_deg`, `focal_px`, and `focal_mm` with `sensor_mm`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MapSensorToml {
    /// Angle that a pixel on the boresight subtends, along a line, mrad.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) ifov_mrad: Option<f64>,
    /// Angle that a line of pixels subtends, seen about its middle, deg; with `window` a line of the larger image.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
    pub(crate) fov_deg: Option<f64>,
    /// Focal length in pixels: one number, or that along a line and that across (fx, fy).
    pub(crate) focal_px: Option<FocalToml>,
    /// Focal length, mm, with `sensor_mm`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) focal_mm: Option<f64>,
    /// Size of the sensor, mm: of the side that `sensor_fit` says.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) sensor_mm: Option<f64>,
    /// The side that `sensor_mm` and `shift` go by. Default "auto", the longer one.
    pub(crate) sensor_fit: Option<SensorFitToml>,
    /// Height of a pixel over its width. Default 1.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) pixel_aspect: Option<f64>,
    /// Where the boresight meets the image (principal point), sample and line, pixels from the outer corner of the first pixel: what
    /// counts from that pixel's centre (cx, cy of OpenCV), plus 0.5. Default: the middle. With `window` it is of the larger image.
    pub(crate) boresight_px: Option<[f64; 2]>,
    /// Shift of the lens to the right and up, in sizes of the sensor, as Blender's `shift_x` and `shift_y`; instead of `boresight_px`.
    pub(crate) shift: Option<[f64; 2]>,
    /// The image is a window of a larger one, which the keys above are about.
    pub(crate) window: Option<WindowToml>,
    /// What the lens does to the image of an ideal pinhole, whose keys are those above.
    pub(crate) distortion: Option<DistortionToml>,
    /// Path of a table of where pixels look, instead of the keys above: for the centre of each pixel, line by line, tangents (x right, y down, for 1 along the boresight)
    /// or vectors (x, y, z) along the sensor's axes, as an `.npy` array (lines, samples, 2 or 3) or as CSV with a header `x,y` or `x,y,z`. Corners of pixels are the means
    /// of the four centres around.
    pub(crate) directions: Option<String>,
}

/// Known instruments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Preset {
    /// MacrOmega on MMX.
    Macromega,
    /// MIRS on MMX.
    Mirs,
}

/// What the field of view is fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Fit {
    /// All meshes, without the surroundings of recipes' sites.
    Scene,
}

/// Bands: `start_um`, `stop_um` and `count` (both ends included), or `centres_um`, or `response`.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BandsToml {
    /// Centre of the first band, um.
    pub(crate) start_um: Option<f64>,
    /// Centre of the last band, um.
    pub(crate) stop_um: Option<f64>,
    /// Number of bands.
    #[schemars(range(min = 1, max = 100_000))]
    pub(crate) count: Option<u32>,
    /// Centres of the bands, um.
    #[schemars(length(min = 1, max = 100_000))]
    pub(crate) centres_um: Option<Vec<f64>>,
    /// Full width at half maximum of the response, um: one for all, or one for each (0: monochromatic). Default: monochromatic.
    pub(crate) fwhm_um: Option<Fwhm>,
    /// Full width at half maximum, cm-1, of which that in um follows at each centre (times the wavelength squared, 1e-4): as of a tunable filter. Instead of `fwhm_um`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) fwhm_cm_1: Option<f64>,
    /// Shape of responses that have a width: "gaussian" (the default), "box" or "sinc2" (for a tunable filter); one for all, or one for each. Where centres and
    /// `response` are given, "table" stands for the next column of `response`, whose centre and width count then.
    pub(crate) shape: Option<ShapesToml>,
    /// Path of a CSV table of responses, or of several: `wavelength_nm` or `wavelength_um`, then a column for each band, relative or
    /// absolute. Instead of centres and widths, which follow from it. It weights energy (W), not photons: a quantum efficiency, which is per
    /// photon, is multiplied by the wavelength first.
    pub(crate) response: Option<ResponseToml>,
    /// Names of the columns of `response` that are taken, in the order of the bands. Default: all.
    #[schemars(length(min = 1, max = 100_000))]
    pub(crate) columns: Option<Vec<String>>,
    /// What light a band has: "both" (the default), "sunlight" alone, or "heat" alone; one for all, or one for each.
    pub(crate) light: Option<LightsToml>,
}

/// One width, or one for each band.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Fwhm {
    /// One for all bands.
    All(f64),
    /// One for each band.
    Each(Vec<f64>),
}

/// One shape, or one for each band.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum ShapesToml {
    /// One for all bands.
    All(ShapeToml),
    /// One for each band.
    Each(Vec<ShapeToml>),
}

/// The shape of a response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum ShapeToml {
    /// A Gaussian.
    Gaussian,
    /// The same all over the full width.
    Box,
    /// A squared sinc.
    Sinc2,
    /// The next column of `response`.
    Table,
}

/// One table of responses, or several.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum ResponseToml {
    /// One table.
    One(String),
    /// Several, whose columns are concatenated.
    Several(Vec<String>),
}

/// One light, or one for each band.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum LightsToml {
    /// One for all bands.
    All(LightToml),
    /// One for each band.
    Each(Vec<LightToml>),
}

/// What light a band has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum LightToml {
    /// Sunlight, and no heat.
    Sunlight,
    /// Heat, and no sunlight.
    Heat,
    /// Both.
    Both,
}

impl From<LightToml> for Light {
    fn from(light: LightToml) -> Self {
        match light {
            LightToml::Sunlight => Light::Sunlight,
            LightToml::Heat => Light::Heat,
            LightToml::Both => Light::Both,
        }
    }
}

impl From<Light> for LightToml {
    fn from(light: Light) -> Self {
        match light {
            Light::Sunlight => LightToml::Sunlight,
            Light::Heat => LightToml::Heat,
            Light::Both => LightToml::Both,
        }
    }
}
