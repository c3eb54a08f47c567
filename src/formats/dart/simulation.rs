//! What mmxrt understands of a DART simulation, in DART's own frame, units and terms.
//!
//! Reading and writing XML, checking, comparing, and turning a scene into a simulation and back all meet here.
//! Frame: x down (South), y right (East), z up, metres, from the scene's corner; azimuths counter-clockwise from +x, degrees.

use glam::DVec3;

use crate::error::Location;

/// A version of DART's inputs, as in the root element of its files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Version {
    /// As in "5.7.4".
    pub version: String,
    /// As in "v1083"; empty before 5.7.
    pub build: String,
}

impl Version {
    /// Whether it is of before a version such as 5.10. One that cannot be read is not.
    pub fn is_before(&self, major: u32, minor: u32) -> bool {
        let mut numbers = self.version.split('.').map(|n| n.trim().parse::<u32>().ok());
        let number = numbers.next().flatten().zip(numbers.next().flatten());
        number.is_some_and(|number| number < (major, minor))
    }
}

/// The inputs of one simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// Version of the files.
    pub version: Version,
    /// Scene and cells.
    pub maket: Maket,
    /// Lists of optical properties, as coeff_diff.xml has them.
    pub optical: Vec<OpticalProperty>,
    /// Temperatures, in the order they are linked by.
    pub thermal: Vec<ThermalFunction>,
    /// Objects.
    pub objects: Vec<Object>,
    /// Objects that stand in many places.
    pub fields: Vec<ObjectField>,
    /// Spectral bands, illumination and products.
    pub phase: Phase,
    /// The Sun and directions of view.
    pub directions: Directions,
    /// Sweeps of parameters, from the files beside the input folder or in it.
    pub sequences: Vec<Sequence>,
}

/// maket.xml.
#[derive(Debug, Clone, PartialEq)]
pub struct Maket {
    /// Extent along x and y, m.
    pub size_m: [f64; 2],
    /// Size of a cell along x and y, and along z, m.
    pub cell_m: [f64; 2],
    /// 0 isolated, 1 repeated, 2 infinite slope.
    pub boundary: u32,
    /// What the ground plane is made of.
    pub ground: Links,
    /// There is a ground plane at z = 0 (always, before 5.10).
    pub ground_enabled: bool,
    /// Raster of heights, if there is one.
    pub topography: Option<Topography>,
    /// Latitude and longitude, deg, altitude, km: used for dates only.
    pub latitude_longitude_altitude: [f64; 3],
    /// Where it stands.
    pub at: Location,
}

/// A raster of heights that is the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Topography {
    /// Path as written.
    pub file: String,
    /// DART makes it before it runs.
    pub generated: bool,
    /// Where it is named.
    pub at: Location,
}

/// The lists of optical properties; the number is `OpticalPropertyLink@type`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum OpticalKind {
    /// `LambertianMulti`.
    Lambertian = 0,
    /// `HapkeSpecularMulti`.
    Hapke = 2,
    /// `RPVMulti`.
    Rpv = 4,
}

/// An entry of a list in coeff_diff.xml.
#[derive(Debug, Clone, PartialEq)]
pub struct OpticalProperty {
    /// The list it stands in; its place there is its index among those of the same kind.
    pub kind: OpticalKind,
    /// Name for people.
    pub ident: String,
    /// Database of reflectance; before 5.7 a text that holds one table.
    pub database: String,
    /// Table in the database; empty for a text.
    pub model: String,
    /// Database of transmittance (Hapke and RPV only) and table in it.
    pub transmittance: Option<(String, String)>,
    /// Multiplicative factors, a list for each band, by attribute name; empty if they are not used.
    pub factors: Vec<Vec<(String, f64)>>,
    /// Where it stands.
    pub at: Location,
}

/// An entry of `Temperatures`: temperatures lie within mean +- range / 2.
#[derive(Debug, Clone, PartialEq)]
pub struct ThermalFunction {
    /// Name for people.
    pub ident: String,
    /// K.
    pub mean_k: f64,
    /// K.
    pub range_k: f64,
    /// What has it has no temperatures of cells.
    pub overrides_cells: bool,
    /// Where it stands.
    pub at: Location,
}

/// A link to an optical and a thermal property: DART follows type and index, never the name.
#[derive(Debug, Clone, PartialEq)]
pub struct Links {
    /// `OpticalPropertyLink@type`.
    pub kind: u32,
    /// Index in the list of that type.
    pub index: u32,
    /// Name, for people.
    pub ident: String,
    /// Index of the thermal function.
    pub thermal_index: u32,
    /// Its name, for people.
    pub thermal_ident: String,
    /// Where the link stands.
    pub at: Location,
}

/// An object of object_3d.xml.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Name.
    pub name: String,
    /// OBJ file, as written.
    pub file: String,
    /// Place of the OBJ's origin, m.
    pub position_m: DVec3,
    /// Scale along DART's axes.
    pub scale: DVec3,
    /// Intrinsic rotation, nutation, precession, deg; scale comes before them, position after.
    pub rotation_deg: DVec3,
    /// 0 dropped to the ground, 1 part of the terrain, 2 as given.
    pub dem_mode: u32,
    /// Ignored by DART.
    pub hidden: bool,
    /// What lies beyond the scene's edge comes in at the other side.
    pub repeated_on_border: bool,
    /// Both faces have properties.
    pub double_face: bool,
    /// Links of the whole object; `None` if its groups have their own.
    pub links: Option<Links>,
    /// Back faces of the whole object, if they have their own.
    pub back: Option<Links>,
    /// Its groups.
    pub groups: Vec<Group>,
    /// Where it stands.
    pub at: Location,
}

impl Object {
    /// Where it stands, as a field has it of its models.
    pub fn place(&self) -> FieldInstance {
        let Object { position_m, scale, rotation_deg, .. } = *self;
        FieldInstance { model: 0, position_m, scale, rotation_deg }
    }

    /// Whether it says what some of its backs are made of.
    pub fn has_backs(&self) -> bool {
        self.back.is_some() || self.groups.iter().any(|group| group.back.is_some())
    }
}

/// A group of an object, bound to the OBJ's groups by its number.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// From 1, in the order that DART gives the OBJ's groups.
    pub number: u32,
    /// Name, for people.
    pub name: String,
    /// Ignored by DART.
    pub hidden: bool,
    /// Both faces have properties.
    pub double_face: bool,
    /// Front face; `None` if the object's are used.
    pub links: Option<Links>,
    /// Back face, if it has its own.
    pub back: Option<Links>,
    /// Where it stands.
    pub at: Location,
}

/// An object field: models, and the places where they stand.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectField {
    /// Name.
    pub name: String,
    /// Text file of the places, as written.
    pub file: String,
    /// What stands there.
    pub models: Vec<Object>,
    /// Where.
    pub places: Vec<FieldInstance>,
    /// Where the field stands.
    pub at: Location,
}

/// A place in an object field: with its scale and rotation instead of the model's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldInstance {
    /// Index of the model.
    pub model: u32,
    /// Place of the OBJ's origin, m.
    pub position_m: DVec3,
    /// Scale along DART's axes.
    pub scale: DVec3,
    /// As in [`Object::rotation_deg`].
    pub rotation_deg: DVec3,
}

impl Default for FieldInstance {
    /// As the file has it.
    fn default() -> Self {
        FieldInstance { model: 0, position_m: DVec3::ZERO, scale: DVec3::ONE, rotation_deg: DVec3::ZERO }
    }
}

impl ObjectField {
    /// The field's objects, one for each place.
    pub fn objects(&self) -> impl Iterator<Item = Object> {
        self.places.iter().filter_map(|place| {
            let model = self.models.get(place.model as usize)?.clone();
            let FieldInstance { position_m, scale, rotation_deg, .. } = *place;
            Some(Object { position_m, scale, rotation_deg, ..model })
        })
    }
}

/// A sequence: simulations that differ in some values.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// Name.
    pub name: String,
    /// Groups: every combination of a row of each is a simulation.
    pub groups: Vec<SequenceGroup>,
    /// Where it stands.
    pub at: Location,
}

/// Values that change together: the i-th of each entry.
#[derive(Debug, Clone, PartialEq)]
pub struct SequenceGroup {
    /// Name.
    pub name: String,
    /// Its entries; all have the same number of values.
    pub entries: Vec<SequenceEntry>,
}

/// An attribute of the inputs, and the values it takes.
#[derive(Debug, Clone, PartialEq)]
pub struct SequenceEntry {
    /// Dotted path: `Phase.DartInputParameters.SpectralIntervals.SpectralIntervalsProperties[0].meanLambda`.
    pub property: String,
    /// How the values are given.
    pub values: SequenceValues,
    /// Where it stands.
    pub at: Location,
}

/// The values of a [`SequenceEntry`].
#[derive(Debug, Clone, PartialEq)]
pub enum SequenceValues {
    /// `enumerate`: one by one, as text.
    Enumerated(Vec<String>),
    /// `linear`: `start + i step` for i from 0 to `count - 1`.
    Linear {
        /// The first value.
        start: f64,
        /// From value to value.
        step: f64,
        /// Number of values.
        count: u32,
    },
}

/// phase.xml.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// Bands, in order.
    pub bands: Vec<SpectralInterval>,
    /// `irradianceMode`: 1 where `irradiance` holds a value for each band.
    pub irradiance_mode: u32,
    /// Irradiance, W m-2 um-1, and share of diffuse light, for each band; `None` for one of which it is not said.
    pub irradiance: Vec<Option<(f64, f64)>>,
    /// `temperatureMode`: 0 by illumination, 1 of cells, 2 of layers, 3 of the atmosphere.
    pub temperature_mode: u32,
    /// Temperatures of cells, where they count: some band sees heat, and some thermal function leaves it to them.
    pub cells: Option<CellTemperatures>,
    /// Radiance products are written.
    pub radiance_products: bool,
    /// Cameras.
    pub cameras: Vec<Pinhole>,
}

/// Temperatures of the scene's cells.
#[derive(Debug, Clone, PartialEq)]
pub struct CellTemperatures {
    /// Path as written.
    pub file: String,
    /// Cells along x and y, and layers.
    pub count: [usize; 3],
    /// From the lowest layer up, line after line along y, K.
    pub values_k: Vec<f64>,
    /// Where the file is named.
    pub at: Location,
}

/// A spectral band.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralInterval {
    /// Centre, um.
    pub mean_um: f64,
    /// Full width, um.
    pub width_um: f64,
    /// 0 sunlight, 1 sunlight and heat, 2 heat.
    pub mode: u32,
    /// Where it stands.
    pub at: Location,
}

/// A frame camera (5.7: `Pinhole`; from 5.10 `Sensor`).
#[derive(Debug, Clone, PartialEq)]
pub struct Pinhole {
    /// Where it is, m.
    pub position_m: DVec3,
    /// Where it looks, from the camera: zenith angle and azimuth of the line of sight, deg.
    pub look_deg: [f64; 2],
    /// Turn about the line of sight, deg.
    pub roll_deg: f64,
    /// Full angles along columns (width) and rows (height), deg.
    pub field_of_view_deg: [f64; 2],
    /// Pixels in a row, and rows.
    pub pixels: [u32; 2],
    /// Where it stands.
    pub at: Location,
}

/// directions.xml.
#[derive(Debug, Clone, PartialEq)]
pub struct Directions {
    /// Zenith angle and azimuth of the Sun as seen from the ground, deg.
    pub sun_deg: [f64; 2],
    /// Directions from the scene in which images are asked for: zenith angle and azimuth, deg.
    pub views_deg: Vec<[f64; 2]>,
    /// Where the Sun stands.
    pub at: Location,
}
