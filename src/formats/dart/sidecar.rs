//! `mmxrt.toml` next to a simulation: what DART's own files cannot hold, so that a scene comes back whole.
//!
//! DART never sees it. On the way back a value of it is used only where DART's files still hold what was written with it: an
//! edited XML file or database wins.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Location, Result};
use crate::formats::input::{self, InputFile};
use crate::formats::scene_toml::types::{LightToml, ShapeToml};
use crate::geometry::{Direction, Mesh, index_u32};
use crate::physics::sun_disc::DiscRule;
use crate::scene::{
    Beam, Fixed, Globe, Hapke, MARS_DAY_NIGHT_K, MarsModel, Material, Models, Photometry, Rotation, Rpv, Scene, Sky,
    Sun, SunModel, Thermal,
};
use crate::spectral::{Band, Extend, Light, Response, Spectrum, solar_e490};

use super::frame;

/// Its name in a simulation's folder.
pub(super) const FILE: &str = "mmxrt.toml";
/// Longer files are refused, bytes.
const LIMIT: u64 = 256 << 20;

/// What a scene holds and DART's files do not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sidecar {
    /// Version of this format: 1.
    mmxrt_dart: u32,
    /// Origin of the scene's local coordinates, body-fixed, m.
    pub(super) origin_m: [f64; 3],
    /// The same point in DART's frame, m.
    pub(super) origin_in_dart_m: [f64; 3],
    thermal: ThermalName,
    /// Steps of a day in which heat is conducted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    conduction_steps: Option<u32>,
    /// No part of a facet is colder, K.
    #[serde(default, skip_serializing_if = "is_zero")]
    floor_k: f64,
    /// Whether bodies hide the Sun, in a scene without Mars.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    eclipse: bool,
    /// Faces that are more than a facet, as runs of (facets of a face, number of such faces); left out where all are triangles.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    faces: Vec<(u32, u32)>,
    sensor: SensorPart,
    sun: SunPart,
    #[serde(skip_serializing_if = "Option::is_none")]
    mars: Option<MarsPart>,
    /// Which choices of models the scene states itself.
    #[serde(default, skip_serializing_if = "Fixed::is_nothing")]
    fixed: Fixed,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    day: Option<DayPart>,
    #[serde(default, rename = "body", skip_serializing_if = "Vec::is_empty")]
    bodies: Vec<BodyPart>,
    #[serde(default, rename = "lamp", skip_serializing_if = "Vec::is_empty")]
    lamps: Vec<LampPart>,
    #[serde(rename = "material")]
    materials: Vec<MaterialPart>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ThermalName {
    Equilibrium,
    Thesis,
    Off,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SensorPart {
    name: String,
    /// Axes of the image (right, down, ahead), body-fixed.
    axes: [[f64; 3]; 3],
    /// 0 for a monochromatic band.
    fwhm_um: Vec<f64>,
    /// Of bands that are not as most are: a Gaussian response, or none, and both sunlight and heat.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    unusual: Vec<UnusualBand>,
}

/// What a band has that a centre and a width do not say.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct UnusualBand {
    /// Counted from 0.
    band: usize,
    response: ShapeToml,
    light: LightToml,
    /// What it is called.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    table: Option<Table>,
}

impl UnusualBand {
    fn of((band, b): (usize, &Band)) -> Option<Self> {
        let (response, table) = match &b.response {
            Response::Gaussian => (ShapeToml::Gaussian, None),
            Response::Box => (ShapeToml::Box, None),
            Response::Sinc2 => (ShapeToml::Sinc2, None),
            Response::Table(table) => (ShapeToml::Table, Some(Table::of(table))),
        };
        let is_usual = response == ShapeToml::Gaussian && b.light == Light::Both;
        (!is_usual).then(|| UnusualBand { band, response, light: b.light.into(), name: b.name.clone(), table })
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SunPart {
    /// Where it is if it is below the site's horizon, body-fixed.
    #[serde(skip_serializing_if = "Option::is_none")]
    below_horizon: Option<[f64; 3]>,
    distance_m: f64,
    total_irradiance_1au_w_m2: f64,
    #[serde(default, skip_serializing_if = "is_zero")]
    limb_darkening: f64,
    /// How many stand for its disc.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    points: Option<usize>,
    irradiance_1au: SunSpectrum,
}

fn usual_day_night_k() -> [f64; 2] {
    MARS_DAY_NIGHT_K
}

fn is_usual_day_night_k(value: &[f64; 2]) -> bool {
    *value == MARS_DAY_NIGHT_K
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
enum SunSpectrum {
    /// "e490".
    Named(String),
    Table(Table),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MarsPart {
    /// From `origin_m`, axes of the body.
    centre_m: [f64; 3],
    radius_m: f64,
    bond_albedo: f64,
    thermal_exitance_w_m2: f64,
    model: MarsModelName,
    /// Whether it hides the Sun.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    eclipse: bool,
    /// How many stand for its lit disc.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    points: Option<usize>,
    /// Whether its heat lights the surface.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    heat: bool,
    #[serde(default = "usual_day_night_k", skip_serializing_if = "is_usual_day_night_k")]
    day_night_k: [f64; 2],
    reflectance: Table,
}

/// A body of the sky besides Mars.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyPart {
    name: String,
    /// From `origin_m`, axes of the body.
    centre_m: [f64; 3],
    radius_m: f64,
    bond_albedo: f64,
    thermal_exitance_w_m2: f64,
    day_night_k: [f64; 2],
    reflectance: Table,
}

/// A source at infinity besides the Sun.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LampPart {
    name: String,
    /// Towards it, body-fixed.
    direction: [f64; 3],
    total_irradiance_w_m2: f64,
    irradiance: Table,
}

/// How the body turns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct DayPart {
    /// Body-fixed.
    axis: [f64; 3],
    period_s: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum MarsModelName {
    NearField,
    Thesis,
    Off,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialPart {
    name: String,
    bond_albedo: f64,
    emissivity_bolometric: f64,
    #[serde(default, skip_serializing_if = "is_zero")]
    thermal_inertia: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    temperature_k: Option<f64>,
    /// Entry, counted from 0, and its share.
    mixture: Vec<(usize, f64)>,
    reflectance: Table,
    /// Left out where it is 1 - reflectance.
    #[serde(skip_serializing_if = "Option::is_none")]
    emissivity: Option<Table>,
    /// Parameters of Hapke's model, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    hapke: BTreeMap<String, Table>,
    /// Parameters of the RPV model, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    rpv: BTreeMap<String, Table>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    wavelength_um: Vec<f64>,
    value: Vec<f64>,
    /// The end values hold beyond the ends.
    held: bool,
}

impl Table {
    fn of(spectrum: &Spectrum) -> Self {
        Table {
            wavelength_um: spectrum.wavelength_um().to_vec(),
            value: spectrum.value().to_vec(),
            held: spectrum.coverage_um().1 == f64::INFINITY,
        }
    }

    fn spectrum(&self) -> Option<Spectrum> {
        let extend = if self.held { Extend::Hold } else { Extend::Error };
        Spectrum::new(self.wavelength_um.clone(), self.value.clone(), extend)
    }
}

impl Sidecar {
    /// Of a scene whose origin stands at `origin_in_dart_m`.
    pub(super) fn of(scene: &Scene, origin_in_dart_m: DVec3) -> Self {
        let sun = &scene.sky.sun;
        let spectrum = match sun.irradiance_1au == *solar_e490() {
            true => SunSpectrum::Named("e490".into()),
            false => SunSpectrum::Table(Table::of(&sun.irradiance_1au)),
        };
        Sidecar {
            mmxrt_dart: 1,
            origin_m: scene.body.origin_m.to_array(),
            origin_in_dart_m: origin_in_dart_m.to_array(),
            thermal: match scene.models.thermal {
                Thermal::Equilibrium => ThermalName::Equilibrium,
                Thermal::Thesis => ThermalName::Thesis,
                Thermal::Off => ThermalName::Off,
            },
            conduction_steps: scene.models.conduction,
            floor_k: scene.models.floor_k,
            fixed: scene.models.fixed,
            eclipse: scene.models.eclipses && scene.sky.mars.is_none(),
            day: scene
                .sky
                .rotation
                .map(|Rotation { axis, period_s }| DayPart { axis: axis.vec().to_array(), period_s }),
            bodies: scene.sky.bodies.iter().map(body_part).collect(),
            lamps: scene.sky.beams.iter().map(lamp_part).collect(),
            faces: runs_of_faces(&scene.body.mesh).unwrap_or_default(),
            sensor: SensorPart {
                name: scene.exposure.instrument.clone(),
                axes: scene.exposure.camera.world_from_sensor.rotation.to_cols_array_2d(),
                fwhm_um: scene.exposure.bands.iter().map(|b| b.fwhm_um.unwrap_or(0.0)).collect(),
                unusual: scene.exposure.bands.iter().enumerate().filter_map(UnusualBand::of).collect(),
            },
            sun: SunPart {
                below_horizon: frame::sun_deg(scene.body.origin_m, sun.direction)
                    .is_none()
                    .then(|| sun.direction.vec().to_array()),
                distance_m: sun.distance_m,
                total_irradiance_1au_w_m2: sun.total_irradiance_1au_w_m2,
                limb_darkening: sun.limb_darkening,
                points: match scene.models.sun {
                    SunModel::Point => None,
                    SunModel::Disc(rule) => Some(rule.count()),
                },
                irradiance_1au: spectrum,
            },
            mars: scene.sky.mars.as_ref().map(|mars| MarsPart {
                centre_m: mars.centre_m.to_array(),
                radius_m: mars.radius_m,
                bond_albedo: mars.bond_albedo,
                thermal_exitance_w_m2: mars.thermal_exitance_w_m2,
                model: match scene.models.mars_light {
                    MarsModel::NearField => MarsModelName::NearField,
                    MarsModel::Thesis => MarsModelName::Thesis,
                    MarsModel::Off => MarsModelName::Off,
                },
                eclipse: scene.models.eclipses,
                points: scene.models.mars_shadows.map(DiscRule::count),
                heat: scene.models.mars_heat,
                day_night_k: mars.day_night_k,
                reflectance: Table::of(&mars.reflectance),
            }),
            materials: scene.body.materials.iter().map(material_part).collect(),
        }
    }

    /// Reads the file next to a simulation; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Syntax`] at the first place that is not as it is written by this version.
    pub fn read(path: &Path) -> Result<Option<(Self, InputFile)>> {
        if !path.is_file() {
            return Ok(None);
        }
        let (text, input) = input::text(path, LIMIT)?;
        let sidecar: Sidecar = toml::from_str(&text).map_err(|e| {
            let at = e.span().map_or(Location::file(path), |s| Location::span(path, &text, s.start, s.end));
            Error::syntax(at, format!("{}: delete the file to do without it", e.message()))
        })?;
        if sidecar.mmxrt_dart != 1 {
            let at = Location::file(path).with_item("mmxrt_dart");
            return Err(Error::Unsupported { at, feature: format!("version {} of this file", sidecar.mmxrt_dart) });
        }
        Ok(Some((sidecar, input)))
    }

    /// The file's text.
    pub fn text(&self) -> String {
        let body = toml::to_string(self).unwrap_or_else(|e| format!("# {e}\n"));
        format!(
            "# What DART's files have no place for: mmxrt reads it, DART does not. A value counts only where DART's files still\n\
             # hold what was written with it: an edited XML file or database wins.\n{body}"
        )
    }

    /// Where the Sun is, body-fixed, if that is below the site's horizon.
    pub(super) fn sun_below_horizon(&self) -> Option<Direction> {
        Direction::new(DVec3::from_array(self.sun.below_horizon?))
    }

    /// The Sun towards `direction`; `None` if its spectrum is not a spectrum.
    pub(super) fn sun(&self, direction: Direction) -> Option<Sun> {
        let irradiance_1au = match &self.sun.irradiance_1au {
            SunSpectrum::Named(name) => (name == "e490").then(|| solar_e490().clone())?,
            SunSpectrum::Table(table) => table.spectrum()?,
        };
        let SunPart { distance_m, total_irradiance_1au_w_m2, limb_darkening, .. } = self.sun;
        Some(Sun { direction, distance_m, irradiance_1au, total_irradiance_1au_w_m2, limb_darkening })
    }

    pub(super) fn mars(&self) -> Option<Globe> {
        let mars = self.mars.as_ref()?;
        Some(Globe {
            name: Sky::MARS.into(),
            centre_m: DVec3::from_array(mars.centre_m),
            radius_m: mars.radius_m,
            reflectance: mars.reflectance.spectrum()?,
            bond_albedo: mars.bond_albedo,
            thermal_exitance_w_m2: mars.thermal_exitance_w_m2,
            day_night_k: mars.day_night_k,
        })
    }

    /// Bodies of the sky besides Mars; those whose spectra are none are left out.
    pub(super) fn bodies(&self) -> Vec<Globe> {
        let globe = |body: &BodyPart| {
            Some(Globe {
                name: body.name.clone(),
                centre_m: DVec3::from_array(body.centre_m),
                radius_m: body.radius_m,
                reflectance: body.reflectance.spectrum()?,
                bond_albedo: body.bond_albedo,
                thermal_exitance_w_m2: body.thermal_exitance_w_m2,
                day_night_k: body.day_night_k,
            })
        };
        self.bodies.iter().filter_map(globe).collect()
    }

    /// Sources at infinity besides the Sun; likewise.
    pub(super) fn beams(&self) -> Vec<Beam> {
        let beam = |lamp: &LampPart| {
            let direction = DVec3::from_array(lamp.direction);
            Some(Beam {
                name: lamp.name.clone(),
                direction: Direction::from_unit(direction).or_else(|| Direction::new(direction))?,
                irradiance: lamp.irradiance.spectrum()?,
                total_irradiance_w_m2: lamp.total_irradiance_w_m2,
            })
        };
        self.lamps.iter().filter_map(beam).collect()
    }

    /// How the body turns, if that was known.
    pub(super) fn rotation(&self) -> Option<Rotation> {
        let DayPart { axis, period_s } = self.day.as_ref()?;
        let axis = DVec3::from_array(*axis);
        Some(Rotation { axis: Direction::from_unit(axis).or_else(|| Direction::new(axis))?, period_s: *period_s })
    }

    pub(super) fn models(&self) -> Models {
        let thermal = match self.thermal {
            ThermalName::Equilibrium => Thermal::Equilibrium,
            ThermalName::Thesis => Thermal::Thesis,
            ThermalName::Off => Thermal::Off,
        };
        let mars_light = self.mars.as_ref().map_or_else(MarsModel::default, |mars| match mars.model {
            MarsModelName::NearField => MarsModel::NearField,
            MarsModelName::Thesis => MarsModel::Thesis,
            MarsModelName::Off => MarsModel::Off,
        });
        let sun = self.sun.points.and_then(DiscRule::of_count).map_or(SunModel::Point, SunModel::Disc);
        let mars_shadows = self.mars.as_ref().and_then(|mars| DiscRule::of_count(mars.points?));
        let eclipses = self.eclipse || self.mars.as_ref().is_some_and(|mars| mars.eclipse);
        let conduction = self.conduction_steps.filter(|_| self.rotation().is_some());
        let mars_heat = self.mars.as_ref().is_some_and(|mars| mars.heat);
        Models {
            thermal,
            mars_light,
            sun,
            eclipses,
            mars_shadows,
            mars_heat,
            conduction,
            floor_k: self.floor_k,
            fixed: self.fixed,
            ..Models::default()
        }
    }

    /// The camera's axes right, down, ahead as columns; `None` if they are not axes.
    pub(super) fn world_from_sensor(&self) -> Option<DMat3> {
        let axes = DMat3::from_cols_array_2d(&self.sensor.axes);
        let off = axes * axes.transpose() - DMat3::IDENTITY;
        let is_rotation = off.to_cols_array().iter().all(|x| x.abs() < 1e-9) && axes.determinant() > 0.0;
        is_rotation.then_some(axes)
    }

    pub(super) fn sensor_name(&self) -> &str {
        &self.sensor.name
    }

    /// The scene's band at a centre that DART uses.
    pub(super) fn band(&self, index: usize, centre_um: f64) -> Option<Band> {
        let fwhm_um = *self.sensor.fwhm_um.get(index)?;
        let plain = Band::new(centre_um, (fwhm_um > 0.0).then_some(fwhm_um));
        let Some(unusual) = self.sensor.unusual.iter().find(|u| u.band == index) else { return Some(plain) };
        let band = match unusual.response {
            ShapeToml::Gaussian => plain,
            ShapeToml::Box => Band { response: Response::Box, ..plain },
            ShapeToml::Sinc2 => Band { response: Response::Sinc2, ..plain },
            ShapeToml::Table => {
                let band = Band::tabulated(&unusual.table.as_ref()?.spectrum()?)?;
                // A centre that was edited is another band's.
                (band.centre_um == centre_um).then_some(band)?
            }
        };
        Some(Band { light: unusual.light.into(), name: unusual.name.clone(), ..band })
    }

    /// The place of a material in the scene's dictionary.
    pub(super) fn place_of(&self, name: &str) -> Option<usize> {
        self.materials.iter().position(|m| m.name == name)
    }

    pub(super) fn material(&self, name: &str) -> Option<Material> {
        let part = self.materials.iter().find(|m| m.name == name)?;
        let reflectance = part.reflectance.spectrum()?;
        Some(Material {
            name: part.name.clone(),
            emissivity: match &part.emissivity {
                Some(table) => table.spectrum()?,
                None => reflectance.map(|r| 1.0 - r),
            },
            photometry: match (part.hapke.is_empty(), part.rpv.is_empty()) {
                (true, true) => Photometry::Lambert,
                (false, _) => Photometry::Hapke(Box::new(Hapke::from(parameters(&part.hapke, Hapke::NAMES)?))),
                (true, false) => Photometry::Rpv(Box::new(Rpv::from(parameters(&part.rpv, Rpv::NAMES)?))),
            },
            reflectance,
            bond_albedo: part.bond_albedo,
            emissivity_bolometric: part.emissivity_bolometric,
            thermal_inertia: part.thermal_inertia,
            temperature_k: part.temperature_k,
            mixture: part.mixture.clone(),
        })
    }

    /// For facets that are read back in another order than the scene's: the runs of faces in that order, or none.
    pub(super) fn take_faces(&mut self, runs: Option<Vec<(u32, u32)>>) {
        self.faces = runs.unwrap_or_default();
    }

    /// The face that each of so many facets was cut from; empty if each is its own, or if the runs are of other facets.
    pub(super) fn faces(&self, facets: usize) -> Vec<u32> {
        let facets_of = |(size, faces): &(u32, u32)| u64::from(*size) * u64::from(*faces);
        let count = self.faces.iter().try_fold(0_u64, |sum, run| sum.checked_add(facets_of(run)));
        if count != Some(facets as u64) || self.faces.iter().any(|(size, _)| *size == 0) {
            return Vec::new();
        }
        let sizes = self.faces.iter().flat_map(|(size, faces)| std::iter::repeat_n(*size, *faces as usize));
        sizes.enumerate().flat_map(|(face, size)| std::iter::repeat_n(index_u32(face), size as usize)).collect()
    }
}

fn parameters<const N: usize>(tables: &BTreeMap<String, Table>, names: [&str; N]) -> Option<[Spectrum; N]> {
    let spectra: Option<Vec<Spectrum>> = names.iter().map(|name| tables.get(*name)?.spectrum()).collect();
    spectra?.try_into().ok()
}

fn material_part(material: &Material) -> MaterialPart {
    let parameters =
        || material.photometry.parameters().into_iter().map(|(name, s)| (name.to_owned(), Table::of(s))).collect();
    let by_kirchhoff = material.emissivity == material.reflectance.map(|r| 1.0 - r);
    MaterialPart {
        name: material.name.clone(),
        bond_albedo: material.bond_albedo,
        emissivity_bolometric: material.emissivity_bolometric,
        thermal_inertia: material.thermal_inertia,
        temperature_k: material.temperature_k,
        mixture: material.mixture.clone(),
        reflectance: Table::of(&material.reflectance),
        emissivity: (!by_kirchhoff).then(|| Table::of(&material.emissivity)),
        hapke: if matches!(material.photometry, Photometry::Hapke(_)) { parameters() } else { BTreeMap::new() },
        rpv: if matches!(material.photometry, Photometry::Rpv(_)) { parameters() } else { BTreeMap::new() },
    }
}

fn body_part(body: &Globe) -> BodyPart {
    BodyPart {
        name: body.name.clone(),
        centre_m: body.centre_m.to_array(),
        radius_m: body.radius_m,
        bond_albedo: body.bond_albedo,
        thermal_exitance_w_m2: body.thermal_exitance_w_m2,
        day_night_k: body.day_night_k,
        reflectance: Table::of(&body.reflectance),
    }
}

fn lamp_part(beam: &Beam) -> LampPart {
    LampPart {
        name: beam.name.clone(),
        direction: beam.direction.vec().to_array(),
        total_irradiance_w_m2: beam.total_irradiance_w_m2,
        irradiance: Table::of(&beam.irradiance),
    }
}

/// As [`runs_of_faces`], of facets in this order, in which faces have other numbers.
pub(super) fn runs_in_order(mesh: &Mesh, order: &[u32]) -> Option<Vec<(u32, u32)>> {
    if mesh.face_of_facet.is_empty() {
        return Some(Vec::new());
    }
    let face = |f: &u32| mesh.face(*f as usize);
    let (mut faces, mut face_of_facet) = (Vec::new(), Vec::new());
    for facets in order.chunk_by(|a, b| face(a) == face(b)) {
        face_of_facet.extend(std::iter::repeat_n(index_u32(faces.len()), facets.len()));
        faces.push(face(&facets[0]));
    }
    let count = faces.len();
    faces.sort_unstable();
    faces.dedup();
    // A face in two pieces would become two.
    (faces.len() == count).then(|| runs_of_faces(&Mesh { face_of_facet, ..Mesh::default() })).flatten()
}

/// Faces 0, 1, 2 ... of several facets each, as runs of faces with equally many facets; `None` if they are in another order.
pub(super) fn runs_of_faces(mesh: &Mesh) -> Option<Vec<(u32, u32)>> {
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for (i, face) in mesh.face_of_facet.chunk_by(|a, b| a == b).enumerate() {
        if face[0] as usize != i {
            return None;
        }
        match runs.last_mut() {
            Some((size, faces)) if *size == index_u32(face.len()) => *faces += 1,
            _ => runs.push((index_u32(face.len()), 1)),
        }
    }
    Some(runs)
}
