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
use crate::spectral::{ALL_UM, Band, Light, MOST_BEYOND, Spectrum};
use crate::visibility::Topology;

pub use material::Material;
pub use photometry::{Hapke, Photometry, Rpv};
pub(crate) use sensor::LEAST_PITCH;
pub use sensor::{FrameCamera, Sensor};
pub use source::{MARS_ALBEDO, Mars, MarsModel, Sun, Thermal};
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
            material.check(&self.sensor.bands, self.thermal, &mut problem);
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
            problems.extend(self.overcut());
        }
        if problems.is_empty() {
            problems.extend(inside_the_body(mesh, self.sensor.camera.centre_m()));
        }
        if problems.is_empty() { Ok(self) } else { Err(Error::Invalid(problems)) }
    }

    /// First and last wavelength at which all spectra are known that count in such a light, um. Bands end there.
    pub fn known_um(&self, light: Light) -> (f64, f64) {
        let glows = light.glows() && self.thermal != Thermal::Off;
        let materials = self.materials.iter().flat_map(|m| {
            let reflectance = light.is_lit().then_some(&m.reflectance);
            reflectance.into_iter().chain(glows.then_some(&m.emissivity))
        });
        let sources = [&self.sun.irradiance_1au].into_iter().chain(self.mars.iter().map(|m| &m.reflectance));
        let all = materials.chain(sources.filter(|_| light.is_lit()));
        all.map(Spectrum::coverage_um).fold(ALL_UM, |(a, b), (first, last)| (a.max(first), b.min(last)))
    }

    /// Share of a band's response that lies where not all spectra are known, and is left out.
    pub fn share_left_out(&self, band: &Band) -> f64 {
        band.share_beyond(self.known_um(band.light))
    }

    /// Bands of which several spectra together leave too little.
    fn overcut(&self) -> Option<Problem> {
        let bands = &self.sensor.bands;
        let i = bands.iter().position(|band| self.share_left_out(band) > MOST_BEYOND)?;
        let (first, last) = self.known_um(bands[i].light);
        let message = format!(
            "all spectra are known from {first} to {last} um only: {} of this response lies beyond",
            percent(self.share_left_out(&bands[i]))
        );
        Some(Problem::new(Location::item(format!("sensor.bands[{i}]")), message))
    }

    /// What is unusual in a scene and still defined, as sentences.
    pub fn remarks(&self) -> Vec<String> {
        let bands = &self.sensor.bands;
        let shares: Vec<f64> = bands.iter().map(|band| self.share_left_out(band)).collect();
        let Some(i) = (0..bands.len()).max_by(|&i, &j| shares[i].total_cmp(&shares[j]).then(j.cmp(&i))) else {
            return vec![];
        };
        if shares[i] == 0.0 {
            return vec![];
        }
        let cut = shares.iter().filter(|share| **share > 0.0).count();
        let (low, high) = bands[i].support_within_um(self.known_um(bands[i].light));
        vec![format!(
            "{} of the response of band {} at {} um lies where not all spectra are known, and is left out: it is taken from {low} to \
             {high} um{}",
            percent(shares[i]),
            i + 1,
            bands[i].centre_um,
            match cut {
                1 => String::new(),
                n => format!("; of {} other bands less", n - 1),
            }
        )]
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
pub const FARTHEST_M: f64 = 1e18;

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

/// The first of the bands that count which looks too far outside what a spectrum is known for, as a sentence.
fn uncovered(what: &str, spectrum: &Spectrum, bands: &[Band], counts: impl Fn(&Band) -> bool) -> Option<String> {
    let known_um = spectrum.coverage_um();
    let is_outside = |i: &usize| {
        let band = &bands[*i];
        // A response that lies below 0 is told of the band.
        counts(band) && band.share_beyond(known_um) > MOST_BEYOND && band.share_beyond(ALL_UM) <= MOST_BEYOND
    };
    let outside: Vec<usize> = (0..bands.len()).filter(is_outside).collect();
    let i = *outside.first()?;
    let share = match bands[i].fwhm_um {
        Some(_) => format!(": {} of its response lies beyond", percent(bands[i].share_beyond(known_um))),
        None => String::new(),
    };
    let (first, last) = known_um;
    Some(format!(
        "{what} is known from {first} to {last} um, which does not cover band {} at {} um{share}{}",
        i + 1,
        bands[i].centre_um,
        match outside.len() {
            1 => String::new(),
            n => format!(" and {} more", n - 1),
        }
    ))
}

/// A share in percent, with as many digits as tell it from nothing and from all.
fn percent(share: f64) -> String {
    if share < 0.001 { format!("{:.1e} %", 100.0 * share) } else { format!("{:.1} %", 100.0 * share) }
}
