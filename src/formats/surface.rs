//! A mesh with names and colours of its materials: what OBJ and glTF hold of a scene, and how one becomes the other.

use std::collections::BTreeSet;
use std::path::Path;

use glam::{DMat3, DVec3};

use crate::error::{Error, Location, Result};
use crate::geometry::{Direction, MaterialId, Mesh, Pose};
use crate::physics::reflectance::kirchhoff_emissivity;
use crate::report::{Fate, Report};
use crate::scene::{FrameCamera, Material, Photometry, Scene, Sensor, Sun, Thermal};
use crate::spectral::{Band, Spectrum, solar_e490};
use crate::units::{AU_M, TSI_1AU_W_M2};

use super::mtl::{self, ObjMaterial};
use super::obj::ObjFile;
use super::scene_toml::hex_from_linear;

/// A mesh and what its materials are called.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// The mesh, m, z up, local to the origin if there is one.
    pub mesh: Mesh,
    /// Its materials: names and linear colours.
    pub materials: Vec<ObjMaterial>,
    /// Origin of the mesh's coordinates in the body-fixed frame, m, if the file says it.
    pub origin_m: Option<DVec3>,
}

impl From<ObjFile> for Surface {
    /// As the file has it: metres, z up.
    fn from(obj: ObjFile) -> Self {
        let mesh = Mesh {
            vertices_m: obj.vertices,
            facets: obj.facets,
            material: obj.facet_material.into_iter().map(MaterialId).collect(),
            face_of_facet: obj.face_of_facet,
            uv: obj.uv,
        };
        Surface { mesh, materials: obj.materials, origin_m: None }
    }
}

/// A surface of which nothing is known: about that of regolith, so that a first image is neither black nor white.
const REFLECTANCE: f64 = 0.1;
/// As for a material that does not state one.
const EMISSIVITY_BOLOMETRIC: f64 = 0.95;
/// Pixels in a line, and lines.
const PIXELS: u32 = 256;
/// The camera's distance from the middle of the mesh, in its radii.
const AWAY: f64 = 10.0;

impl Surface {
    /// The surface of a scene; what of it has no place in a mesh is noted.
    pub fn of_scene(scene: &Scene, path: &Path, report: &mut Report) -> Self {
        let mut dropped =
            |item: &str, what: &str| report.note(Fate::Dropped, Location::file(path).with_item(item), what);
        dropped("materials", "spectra and what else is known of materials: only their names stay");
        dropped("sun", "where it is, and its spectrum");
        if scene.mars.is_some() {
            dropped("mars", "where it is, and what it reflects");
        }
        dropped("thermal", "how warm the surface is");
        dropped("observer", "where the camera is, and where it looks");
        dropped("sensor", "its pixels and bands");
        let materials =
            scene.materials.iter().map(|m| ObjMaterial { name: mtl::plain_name(&m.name), kd: None }).collect();
        Surface { mesh: scene.mesh.clone(), materials, origin_m: Some(scene.origin_m) }
    }

    /// A scene to begin with: all that a mesh does not say is taken to be something, and noted.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the mesh has no area, or makes no scene, as [`Scene::check`] says.
    pub fn into_scene(self, path: &Path, report: &mut Report) -> Result<Scene> {
        let mut taken = |item: &str, what: String| {
            report.note(Fate::Defaulted, Location::file(path).with_item(item), what);
        };
        let origin_m = self.origin_m.unwrap_or_else(|| {
            taken("origin_m", "[0, 0, 0]: the mesh's coordinates are those of the body, z is north".into());
            DVec3::ZERO
        });
        let mut names = BTreeSet::new();
        let materials: Vec<Material> = self
            .materials
            .iter()
            .enumerate()
            .map(|(i, material)| {
                let mut name = match material.name.as_str() {
                    "" => material.kd.map_or("default".into(), hex_from_linear),
                    name => name.to_owned(),
                };
                while !names.insert(name.clone()) {
                    name.push('_');
                }
                // Luminance, ITU-R BT.709.
                let [r, g, b] = material.kd.unwrap_or([REFLECTANCE; 3]);
                let reflectance = (0.2126 * r + 0.7152 * g + 0.0722 * b).clamp(0.0, 1.0);
                let source = if material.kd.is_some() { "the luminance of its colour" } else { "no colour is given" };
                taken(
                    &format!("materials.{name:?}"),
                    format!("reflectance {reflectance:.4} at all wavelengths: {source}"),
                );
                Material {
                    name,
                    reflectance: Spectrum::constant(reflectance),
                    photometry: Photometry::Lambert,
                    emissivity: Spectrum::constant(kirchhoff_emissivity(reflectance)),
                    bond_albedo: reflectance,
                    emissivity_bolometric: EMISSIVITY_BOLOMETRIC,
                    mixture: vec![(i, 1.0)],
                }
            })
            .collect();
        let has_area = |facet: usize| self.mesh.facet(facet).cross_m2() != DVec3::ZERO;
        if !(0..self.mesh.facets.len()).any(has_area) {
            let message = "no triangle of the mesh has an area: are its corners in one place, or its scale 0?";
            return Err(Error::invalid(Location::file(path), message));
        }
        let outward = outward(&self.mesh, origin_m);
        let e490 = solar_e490();
        let (first, last) = e490.coverage_um();
        let e490_w_m2 = e490.integral(first, last).unwrap_or(TSI_1AU_W_M2);
        taken("sun", "1 au away, at the zenith, ASTM E490".into());
        taken("thermal.model", "equilibrium".into());
        let (low, high) = self.mesh.bounds_m().unwrap_or_default();
        let radius_m = (0.5 * (high - low).length()).max(f64::MIN_POSITIVE.sqrt());
        let u = -outward.vec();
        let north = if u.z.abs() < 0.9 { DVec3::Z } else { DVec3::Y };
        let h = u.cross(north).normalize();
        let world_from_sensor = Pose {
            rotation: DMat3::from_cols(h, u.cross(h), u),
            translation_m: 0.5 * (low + high) - AWAY * radius_m * u,
        };
        taken("observer", format!("{:.6e} m above the middle of the mesh, looking at it", AWAY * radius_m));
        taken("sensor", format!("{PIXELS} x {PIXELS} pixels that hold the mesh, one band at 1 um"));
        // The sphere around the mesh fills the image.
        let pitch = 2.0 / (AWAY * AWAY - 1.0).sqrt() / f64::from(PIXELS);
        Scene {
            origin_m,
            mesh: self.mesh,
            materials,
            textures: vec![],
            sun: Sun {
                direction: outward,
                distance_m: AU_M,
                irradiance_1au: e490.clone(),
                total_irradiance_1au_w_m2: e490_w_m2,
            },
            mars: None,
            thermal: Thermal::Equilibrium,
            sensor: Sensor {
                name: "frame camera".into(),
                camera: FrameCamera::centred(world_from_sensor, PIXELS, PIXELS, pitch),
                bands: vec![Band { centre_um: 1.0, fwhm_um: None }],
            },
        }
        .check()
    }
}

/// Where most of a sheet faces; of a closed body, which faces everywhere, away from the body's centre, or north.
fn outward(mesh: &Mesh, origin_m: DVec3) -> Direction {
    let crosses = (0..mesh.facets.len()).map(|i| mesh.facet(i).cross_m2());
    let (sum, area) = crosses.fold((DVec3::ZERO, 0.0), |(sum, area), c| (sum + c, area + c.length()));
    let of_sheet = if sum.length() > 0.1 * area { sum } else { origin_m };
    Direction::new(of_sheet).or_else(|| Direction::new(DVec3::Z)).expect("an axis has a length")
}
