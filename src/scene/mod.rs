//! The resolved model of a scene: complete, checked once, immutable. Nothing computed is stored in it.

mod material;
mod photometry;
mod sensor;
mod source;
mod texture;

use std::f64::consts::PI;

use glam::DVec3;

use crate::error::{Error, Location, Problem, Result};
use crate::geometry::{Mesh, signed_solid_angle_sr};
use crate::visibility::Topology;

pub use material::Material;
pub use photometry::{Hapke, Photometry, Rpv};
pub(crate) use sensor::LEAST_PITCH;
pub use sensor::{FrameCamera, Sensor};
pub use source::{Mars, MarsModel, Sun, Thermal};
pub use texture::{Texture, TextureKind};

/// A body's surface, what lights it, and what looks at it.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Origin of all local coordinates, in the body-fixed frame, m.
    pub origin_m: DVec3,
    /// The surface, local to the origin, axes of the body-fixed frame.
    pub mesh: Mesh,
    /// What the surface is made of; facets refer to it by index.
    pub materials: Vec<Material>,
    /// Variation of reflectance inside facets: at most one texture for a material.
    pub textures: Vec<Texture>,
    /// The Sun.
    pub sun: Sun,
    /// Mars as a second source, if there is one.
    pub mars: Option<Mars>,
    /// How warm the surface is.
    pub thermal: Thermal,
    /// What looks at it.
    pub sensor: Sensor,
}

/// A facet's number and one of its edges are kept in 31 bits.
pub(crate) const MOST_FACETS: usize = 1 << 29;

impl Scene {
    /// Checks what the parts owe each other; below this call no code asks again.
    ///
    /// # Errors
    /// [`Error::Invalid`] with everything that is missing or out of range; if nothing is, with a camera inside the only body.
    pub fn check(self) -> Result<Self> {
        let mut problems = Vec::new();
        let mut problem = |item: &str, message: String| {
            problems.push(Problem::new(Location::item(item), message));
        };
        let mesh = &self.mesh;
        if mesh.facets.is_empty() {
            problem("mesh", "has no facets".into());
        }
        if mesh.facets.len() > MOST_FACETS {
            problem("mesh", format!("{} facets are more than the {MOST_FACETS} there may be", mesh.facets.len()));
        }
        if mesh.material.len() != mesh.facets.len() {
            problem("mesh", format!("{} facets, but {} materials of facets", mesh.facets.len(), mesh.material.len()));
        }
        if let Some(i) = mesh.vertices_m.iter().position(|v| !v.is_finite()) {
            problem("mesh", format!("vertex {i} (counted from 0) is not finite"));
        }
        let far = |v: &DVec3| v.is_finite() && v.abs().max_element() > FARTHEST_M;
        if let Some(i) = mesh.vertices_m.iter().position(far) {
            problem("mesh", format!("vertex {i} (counted from 0) is more than {FARTHEST_M:e} m from the origin"));
        }
        let mars_m = self.mars.as_ref().map_or(DVec3::ZERO, |mars| mars.centre_m);
        for (item, place_m) in [
            ("origin_m", self.origin_m),
            ("observer.position_m", self.sensor.camera.centre_m()),
            ("mars.position_m", mars_m),
        ] {
            if !place_m.is_finite() || place_m.abs().max_element() > FARTHEST_M {
                problem(item, format!("is more than {FARTHEST_M:e} m away: positions are in metres"));
            }
        }
        let vertices = mesh.vertices_m.len();
        if let Some(i) = mesh.facets.iter().position(|f| f.iter().any(|v| *v as usize >= vertices)) {
            problem("mesh", format!("facet {i} (counted from 0) refers to a vertex beyond the {vertices} there are"));
        }
        if let Some(i) = mesh.material.iter().position(|m| m.0 as usize >= self.materials.len()) {
            problem("mesh", format!("facet {i} (counted from 0) has no material"));
        }
        self.sensor.check(&mut problem);
        for material in &self.materials {
            material.check(&self.sensor.bands, &mut problem);
        }
        for (i, texture) in self.textures.iter().enumerate() {
            let name = self.materials.get(texture.material.0 as usize).map_or("", |m| m.name.as_str());
            let item = format!("materials.{name:?}.texture");
            texture.check(mesh, &self.materials, &self.sensor.bands, |message| problem(&item, message));
            if self.textures[..i].iter().any(|t| t.material == texture.material) {
                problem(&item, "a material has one texture at most".into());
            }
        }
        self.sun.check(&self.sensor.bands, &mut problem);
        if let Some(mars) = &self.mars {
            mars.check(&self.sensor.bands, &mut problem);
        }
        if problems.is_empty() {
            problems.extend(inside_the_body(mesh, self.sensor.camera.centre_m()));
        }
        if problems.is_empty() { Ok(self) } else { Err(Error::Invalid(problems)) }
    }

    /// Whether this version can simulate the scene: it carries more than it can compute.
    ///
    /// # Errors
    /// [`Error::Unsupported`] at the first material that is not Lambert.
    pub fn simulable(&self) -> Result<()> {
        for material in &self.materials {
            if let Some(key) = material.photometry.key() {
                let at = Location::item(format!("materials.{:?}.{key}", material.name));
                let feature = format!("simulating a surface by its `{key}` parameters");
                return Err(Error::Unsupported { at, feature });
            }
        }
        Ok(())
    }
}

/// Nothing of a scene is farther away, m (100 light years): products of lengths stay far from what overflows.
const FARTHEST_M: f64 = 1e18;

/// Says that the camera is inside the only body there is, of which it would see nothing but the dark inner side.
fn inside_the_body(mesh: &Mesh, eye_m: DVec3) -> Option<Problem> {
    let first_m = *mesh.vertices_m.first()?;
    let (low_m, high_m) = mesh.vertices_m.iter().fold((first_m, first_m), |(lo, hi), v| (lo.min(*v), hi.max(*v)));
    let among = low_m.cmple(eye_m).all() && eye_m.cmple(high_m).all();
    if !among {
        return None;
    }
    // Cheaper than to find out what hangs together: 4 pi inside a closed body.
    let of = |f: usize| signed_solid_angle_sr(mesh.facet(f).corners_m.map(|p| p - eye_m));
    let omega_sr: f64 = (0..mesh.facets.len()).map(of).sum();
    if omega_sr < 2.0 * PI {
        return None;
    }
    let topology = Topology::new(mesh);
    if !topology.is_one_body() || topology.enclosure(mesh, eye_m).inside == 0 {
        return None;
    }
    let help = "positions are in metres from the body's centre: check their unit and `origin_m`, and the mesh's `unit_m`, `up` and `coordinates`";
    Some(Problem::new(Location::item("observer.position_m"), "the camera is inside the surface").with_help(help))
}

/// The first band that looks outside what a spectrum is known for, as a sentence.
fn uncovered(what: &str, spectrum: &crate::spectral::Spectrum, bands: &[crate::spectral::Band]) -> Option<String> {
    let (first, last) = spectrum.coverage_um();
    let outside: Vec<usize> = (0..bands.len())
        .filter(|&i| {
            let (lo, hi) = bands[i].support_um();
            !(first <= lo && hi <= last)
        })
        .collect();
    let i = *outside.first()?;
    Some(format!(
        "{what} is known from {first} to {last} um, which does not cover band {} at {} um{}",
        i + 1,
        bands[i].centre_um,
        match outside.len() {
            1 => String::new(),
            n => format!(" and {} more", n - 1),
        }
    ))
}
