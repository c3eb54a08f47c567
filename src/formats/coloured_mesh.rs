//! How a mesh with names and colours of its materials becomes a scene, and a scene such a mesh.

use std::collections::BTreeSet;
use std::path::Path;

use glam::{DMat3, DVec3};

use crate::error::{Error, Location, Result};
use crate::geometry::{Direction, FrameCamera, Mesh, Pose, body_from_site, signed_solid_angle_sr};
use crate::physics::reflectance::kirchhoff_emissivity;
use crate::physics::srgb::hex_from_linear;
use crate::report::{Fate, Report};
use crate::scene::{
    Exposure, Material, Models, Photometry, Scene, SceneParts, Sky, Spectrometer, Sun, Surface, Thermal,
};
use crate::spectral::{Band, Spectrum, solar_e490};
use crate::units::{AU_M, TSI_1AU_W_M2};

use super::mesh_file::{ColouredMesh, NamedPose, Up};
use super::mtl::{self, ObjMaterial};
use super::scene_toml::{EMISSIVITY_BOLOMETRIC, SENSOR_NAME};

/// What the user knows about a mesh that its file does not state.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Placing {
    /// Where its origin is, body-fixed, m; where the file says if not given.
    pub origin_m: Option<DVec3>,
    /// The file's unit of length, m.
    pub unit_m: Option<f64>,
    /// The file's axis that points up.
    pub up: Option<Up>,
    /// How its coordinates stand on the body; with the body's axes if not given.
    pub pose: Option<NamedPose>,
    /// Whether it is inside out.
    pub flip: bool,
}

/// Reflectance of a surface of which nothing is known: about that of regolith, so that a first image is neither black nor white.
const REFLECTANCE: f64 = 0.1;
/// Pixels in a line, and lines.
const PIXELS: u32 = 256;
/// The camera's distance from the middle of the mesh, in its radii.
const AWAY: f64 = 10.0;

impl ColouredMesh {
    /// The surface of a scene; what of it has no place in a mesh is noted.
    pub fn of_scene(scene: &Scene, path: &Path, report: &mut Report) -> Self {
        let mut dropped =
            |item: &str, what: &str| report.note(Fate::Dropped, Location::file(path).with_item(item), what);
        dropped("materials", "spectra and what else is known of materials: only their names stay");
        dropped("sun", "where it is, and its spectrum");
        if scene.sky.mars.is_some() {
            dropped("mars", "where it is, and what it reflects");
        }
        dropped("thermal", "how warm the surface is");
        dropped("observer", "where the camera is, and where it looks");
        dropped("sensor", "its pixels and bands");
        let materials =
            scene.body.materials.iter().map(|m| ObjMaterial { name: mtl::plain_name(&m.name), kd: None }).collect();
        ColouredMesh { mesh: scene.body.mesh.clone(), materials, origin_m: Some(scene.body.origin_m), sun: None }
    }

    /// Places the mesh as its user says, who knows more than the file; `up` and `unit_m` are the up axis and the unit of its format.
    #[must_use]
    pub fn placed(mut self, placing: &Placing, (up, unit_m): (Up, f64)) -> Self {
        let turn = |v: DVec3| match (up, placing.up.unwrap_or(up)) {
            // The reader has turned what has y up.
            (Up::Y, Up::Z) => DVec3::new(v.x, v.z, -v.y),
            (Up::Z, Up::Y) => DVec3::new(v.x, -v.z, v.y),
            _ => v,
        };
        let unit_m = placing.unit_m.unwrap_or(unit_m);
        self.mesh.vertices_m.iter_mut().for_each(|v| *v = turn(*v) * unit_m);
        self.sun = self.sun.and_then(|sun| Direction::new(turn(sun.vec())));
        if placing.flip {
            self.mesh.flip();
        }
        self.origin_m = placing.origin_m.or(self.origin_m);
        self
    }

    /// A scene to begin with, in the mesh's axes: all that a mesh does not say is taken to be something, and noted.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the mesh has no area, or makes no scene, as [`SceneParts::check`] says.
    pub fn into_scene(self, path: &Path, pose: Option<NamedPose>, report: &mut Report) -> Result<Scene> {
        let mut taken = |item: &str, what: String| {
            report.note(Fate::Defaulted, Location::file(path).with_item(item), what);
        };
        let origin_m = self.origin_m.unwrap_or_else(|| {
            taken("origin_m", "[0, 0, 0]: the mesh's coordinates are those of the body, z is north".into());
            DVec3::ZERO
        });
        if pose.is_none() && origin_m != DVec3::ZERO {
            taken("mesh.pose", "body: the mesh's z is the body's north; --pose radial makes it the zenith".into());
        }
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
                    thermal_inertia: 0.0,
                    temperature_k: None,
                    mixture: vec![(i, 1.0)],
                }
            })
            .collect();
        let has_area = |facet: usize| self.mesh.facet(facet).cross_m2() != DVec3::ZERO;
        if !(0..self.mesh.facets.len()).any(has_area) {
            let message = "no triangle of the mesh has an area: are its corners in one place, or its scale 0?";
            return Err(Error::invalid(Location::file(path), message));
        }
        if let Some(volume_m3) = self.mesh.enclosed_m3().filter(|volume_m3| *volume_m3 < 0.0) {
            let message =
                format!("as it is: its facets face inwards (its volume is {volume_m3:.3e} m3); --flip turns them");
            taken("mesh.flip", message);
        }
        let (low, high) = self.mesh.bounds_m().unwrap_or_default();
        let radius_m = (0.5 * (high - low).length()).max(f64::MIN_POSITIVE.sqrt());
        let away_m = AWAY * radius_m;
        let zenith = if pose == Some(NamedPose::Radial) { DVec3::Z } else { origin_m };
        let outward = seen_best(&self.mesh, outward(&self.mesh, zenith), 0.5 * (low + high), away_m);
        let sun = self.sun.unwrap_or(outward);
        let e490 = solar_e490();
        let (first, last) = e490.coverage_um();
        let e490_w_m2 = e490.integral(first, last).unwrap_or(TSI_1AU_W_M2);
        let place = if self.sun.is_some() { "where the light is" } else { "behind the camera" };
        taken("sun", format!("1 au away, {place}, ASTM E490"));
        taken("thermal.model", "equilibrium".into());
        let u = -outward.vec();
        let north = if u.z.abs() < 0.9 { DVec3::Z } else { DVec3::Y };
        let h = u.cross(north).normalize();
        let world_from_sensor =
            Pose { rotation: DMat3::from_cols(h, u.cross(h), u), translation_m: 0.5 * (low + high) - away_m * u };
        taken("observer", format!("{away_m:.6e} m from the middle of the mesh, looking at it"));
        taken("sensor", format!("{PIXELS} x {PIXELS} pixels that hold the mesh, one band at 1 um"));
        // The sphere around the mesh fills the image.
        let pitch = 2.0 / (AWAY * AWAY - 1.0).sqrt() / f64::from(PIXELS);
        SceneParts {
            surface: Surface { origin_m, mesh: self.mesh, materials, textures: vec![] },
            sky: Sky {
                sun: Sun {
                    direction: sun,
                    distance_m: AU_M,
                    irradiance_1au: e490.clone(),
                    total_irradiance_1au_w_m2: e490_w_m2,
                    limb_darkening: 0.0,
                },
                mars: None,
                bodies: vec![],
                beams: vec![],
                rotation: None,
                past: None,
            },
            exposure: Exposure {
                instrument: SENSOR_NAME.into(),
                camera: FrameCamera::centred(world_from_sensor, PIXELS, PIXELS, pitch),
                bands: vec![Band::new(1.0, None)],
                spectrometer: Spectrometer::default(),
            },
            models: Models { thermal: Thermal::Equilibrium, ..Models::default() },
        }
        .check()
    }
}

/// A scene in its site's axes, in those of the body.
///
/// # Errors
/// [`Error::Invalid`] if its origin is the body's centre.
pub fn in_body_axes(scene: Scene) -> Result<Scene> {
    let Some(body_from_site) = body_from_site(scene.body.origin_m) else {
        return Err(Error::invalid(
            Location::item("--pose"),
            "radial needs an origin away from the body's centre: give --origin-m",
        ));
    };
    let SceneParts { mut surface, mut sky, mut exposure, models } = scene.into_parts();
    surface.mesh.vertices_m.iter_mut().for_each(|v| *v = body_from_site * *v);
    sky.sun.direction = Direction::new(body_from_site * sky.sun.direction.vec()).unwrap_or(sky.sun.direction);
    let pose = &mut exposure.camera.world_from_sensor;
    *pose = Pose { rotation: body_from_site * pose.rotation, translation_m: body_from_site * pose.translation_m };
    SceneParts { surface, sky, exposure, models }.check()
}

/// Facets that a place for the camera is judged by.
const SAMPLE: usize = 4096;

/// This direction, unless a camera there would see more of inner sides than of outer ones; then the one of the axes and the diagonals between
/// them from which most of outer sides is seen.
fn seen_best(mesh: &Mesh, first: Direction, middle_m: DVec3, away_m: f64) -> Direction {
    let outer_and_inner_sr = |towards: Direction| {
        let eye_m = middle_m + away_m * towards.vec();
        mesh.spread(SAMPLE).fold((0.0, 0.0), |(outer, inner): (f64, f64), facet| {
            let sr = signed_solid_angle_sr(mesh.facet(facet).corners_m.map(|p| p - eye_m));
            if sr > 0.0 { (outer, inner + sr) } else { (outer - sr, inner) }
        })
    };
    let (outer, inner) = outer_and_inner_sr(first);
    // What closed bodies show of both is the same, to rounding.
    if outer > 0.0 && inner <= 1.5 * outer {
        return first;
    }
    let steps = || [0.0, 1.0, -1.0].into_iter();
    let all = steps().flat_map(|z| steps().flat_map(move |y| steps().map(move |x| DVec3::new(x, y, z))));
    let judged = all.filter_map(Direction::new).map(|towards| (outer_and_inner_sr(towards), towards));
    // The first of those that are alike.
    let best = judged.reduce(|best, other| if other.0.0 - other.0.1 > best.0.0 - best.0.1 { other } else { best });
    best.map_or(first, |(_, towards)| towards)
}

/// Where most of a sheet faces; of a closed body, which faces everywhere, towards the zenith if there is one, or north.
fn outward(mesh: &Mesh, zenith: DVec3) -> Direction {
    let crosses = (0..mesh.facets.len()).map(|i| mesh.facet(i).cross_m2());
    let (sum, area) = crosses.fold((DVec3::ZERO, 0.0), |(sum, area), c| (sum + c, area + c.length()));
    let of_sheet = if sum.length() > 0.1 * area { sum } else { zenith };
    Direction::new(of_sheet).or_else(|| Direction::new(DVec3::Z)).expect("an axis has a length")
}
