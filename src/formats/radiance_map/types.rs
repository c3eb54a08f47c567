//! What people write in a map file. The published schema is made from these types and their comments.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::formats::scene_toml::types::{BandsToml, MapSensorToml, ObserverToml, PlaneToml, RasterToml, WrapToml};

/// A radiance map: the raster that holds it, what its numbers are, and where they lie in a scene. Relative paths start at this
/// file's folder.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct MapToml {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    #[allow(dead_code, reason = "the schema checks it")]
    pub(super) mmxrt_map: u32,
    /// The raster, or several of the same size whose bands are concatenated. Default: the file that this one is named after.
    pub(super) raster: Option<RasterToml>,
    /// Names of the raster's channels, in the order of the bands. Default: all bands; of OpenEXR, the spectral layer or that of colours, in
    /// the order that names give by wavelength, red, green, blue, or a number.
    #[schemars(length(min = 1))]
    pub(super) channels: Option<Vec<String>>,
    /// What the numbers are.
    pub(super) quantity: QuantityToml,
    /// Their unit, as "W m-2 sr-1 um-1", "W/m2/sr/um", "mW m-2 sr-1 nm-1", "uW/(cm^2 sr nm)", "mW/(m2 sr cm-1)" (per wavenumber) for radiance,
    /// "W m-2 sr-1" for that in a band, "1" or "%" for a factor, "K" for a temperature. Default: that which the raster states.
    pub(super) unit: Option<String>,
    /// For a reflectance factor: the irradiance that it refers to, W m-2 um-1, its cosine already in it; one for all bands, or one for each.
    pub(super) irradiance_w_m2_um: Option<NumbersToml>,
    /// The number that means "not known", besides NaN and what the raster itself states.
    pub(super) no_data: Option<f64>,
    /// The bands, where the raster does not know its wavelengths; they replace the raster's. Their `light` is what the numbers hold.
    pub(super) bands: Option<BandsToml>,
    /// Where the numbers lie.
    pub(super) placement: PlacementToml,
    /// For `placement = "camera"`: where the camera was, and where it looked.
    pub(super) observer: Option<ObserverToml>,
    /// For `placement = "camera"`: its lens. Its samples and lines are the raster's.
    pub(super) sensor: Option<MapSensorToml>,
    /// For `placement = "camera"`: a scene file whose `observer` and `sensor` the image was made by, instead of the two above.
    pub(super) scene: Option<String>,
    /// For `placement = "plane"`: where the raster lies. Default: where its own georeference in metres puts it, to the East and the North of
    /// the scene's `origin_m`.
    pub(super) plane: Option<PlaneToml>,
    /// For `placement = "atlas"`: how the image continues beyond its border. Default: not at all.
    pub(super) wrap: Option<WrapToml>,
    /// For `placement = "lonlat"`: east longitude of the outer border of the map's first column, deg, mostly 0 or -180.
    /// Default: what the raster says, if it lies in degrees.
    pub(super) west_deg: Option<f64>,
    /// For a camera or a plane: whether surface hidden from it is unknown (the default); if not, the image is
    /// projected through everything.
    pub(super) occlusion: Option<bool>,
    /// For a camera or a plane: what texels hold that show the scene only in part, and sky besides. Default: `included` for a camera, unless
    /// its raster knows their coverage, or what lies around the scene is as bright; `left_out` for a plane, unless that is dark.
    pub(super) sky: Option<SkyToml>,
    /// Whether the numbers hold thermal emission, which a sum must hold once. Default: brightness temperatures do, for others it is not known.
    /// For bands that differ, use `light` in `bands`.
    pub(super) heat: Option<bool>,
    /// What to do with small negative numbers, which renderers' filters leave next to bright edges. Default "error".
    pub(super) negative: Option<NegativeToml>,
}

/// What a texel holds that shows the scene only in part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum SkyToml {
    /// The mean over all of the texel, with a dark sky, as cameras and renderers have it: it is divided by the share that shows the scene.
    Included,
    /// The mean over what shows the scene.
    LeftOut,
}

/// What to do with negative numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum NegativeToml {
    /// They are an error.
    Error,
    /// Those whose magnitude is below a fifth of the band's largest number are 0; others are an error.
    Clip,
}

/// What DART computed, where its folder does not say how it lies in the scene, or under which light.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DartMapToml {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    #[allow(dead_code, reason = "the schema checks it")]
    pub(super) mmxrt_map: u32,
    /// A DART simulation, its `output`, a folder of images in it, or an image.
    pub(super) dart: String,
    /// Where the scene's `origin_m` is in DART's frame (x down the image, y to its right, z up, from the scene's corner), m. There, x is
    /// South and y East, as `convert` has them; at a pole y is +y of the body, and at the body's centre x is -y and y is x of it.
    pub(super) origin_in_dart_m: Option<[f64; 3]>,
    /// Columns and rows by which what an image shows lies beyond where its corners put it. Default 0: as DART says.
    pub(super) shift_texels: Option<[f64; 2]>,
    /// How an image's place is found. Default "outline".
    pub(super) registration: Option<RegistrationToml>,
    /// What texels of an image hold that show the scene in part. Default: whichever those at its rim look like.
    pub(super) sky: Option<SkyToml>,
    /// Irradiance of a horizontal plane that reflectance factors refer to, W m-2 um-1, one for each band. Default: as the output says.
    pub(super) irradiance_w_m2_um: Option<Vec<f64>>,
}

/// How an image's place is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum RegistrationToml {
    /// By its outline against the scene's; an image whose outline is another one is refused.
    Outline,
    /// As above, but whatever fits best is taken.
    Forced,
    /// By its corners, as DART says.
    Printed,
}

/// One number for all bands, or one for each.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(super) enum NumbersToml {
    /// One for all bands.
    All(f64),
    /// One for each band.
    Each(Vec<f64>),
}

/// What a map's numbers are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum QuantityToml {
    /// Spectral radiance.
    Radiance,
    /// Radiance in each band; bands need a width.
    BandRadiance,
    /// Reflectance factor (BRF): pi times radiance over `irradiance_w_m2_um`.
    ReflectanceFactor,
    /// Temperature of a black body of the same spectral radiance at the band's centre, whatever the band's width.
    BrightnessTemperature,
}

/// Where a map's numbers lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum PlacementToml {
    /// A number for each facet of the scene, in their order.
    Facets,
    /// By the texture coordinates of the scene's meshes.
    Atlas,
    /// Pixels of a frame camera's image.
    Camera,
    /// Squares of a plane, put onto the scene along one direction.
    Plane,
    /// By longitude and latitude: columns go once around the body, to the East, rows from the North pole to the South pole in equal steps of
    /// planetocentric latitude.
    LonLat,
}
