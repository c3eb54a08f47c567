//! A body, what lights it, what looks at it, and by which equations: separate values, each checked once, and together a scene.
//! Nothing computed for an image is stored in them.

mod body;
mod coverage;
mod exposure;
mod globe;
mod material;
mod mirror;
mod models;
mod motion;
mod past;
mod photometry;
mod tabulated;
mod sky;
mod source;
mod spectrometer;
mod texture;
mod timing;

use std::f64::consts::PI;
use std::ops::Deref;

use glam::DVec3;

use crate::error::{Error, Location, Problem, Result};
use crate::geometry::signed_solid_angle_sr;
use crate::spectral::{ALL_UM, Band, Light, MOST_BEYOND, Spectrum, solar_e490};
use coverage::percent;
pub(crate) use coverage::uncovered;

pub use body::{Body, Surface};
pub use exposure::Exposure;
pub(crate) use exposure::LEAST_PITCH;
pub use globe::{Globe, MARS_ALBEDO, MARS_DAY_NIGHT_K, SAME_SUNLIGHT, SunOnGlobe};
pub use material::Material;
pub use mirror::Mirror;
pub use models::{Exchange, Fixed, MarsModel, Models, SunModel, Thermal};
pub use motion::Motion;
pub use past::Past;
pub(crate) use photometry::TOLERANCE;
pub use photometry::{Hapke, Model, Photometry, Rpv, out_of_parameters, problems as model_problems};
pub use sky::{Beam, MOST_IRRADIANCE, Rotation, Sky, Sun, out_of_irradiances};
pub use source::{DirectionField, Incoming, Source, SourceKind};
pub use spectrometer::Spectrometer;
pub use tabulated::Tabulated;
pub use texture::{Texture, TextureKind};
pub use timing::{Readout, Take, Timing};

/// Everything that makes up a scene, as plain, unchecked values.
#[derive(Debug, Clone)]
pub struct SceneParts {
    /// What is looked at.
    pub surface: Surface,
    /// What lights it.
    pub sky: Sky,
    /// What looks at it.
    pub exposure: Exposure,
    /// By which equations.
    pub models: Models,
}

/// A body under a sky, an exposure of it, and the choice of models.
#[derive(Debug, Clone)]
pub struct Setup {
    /// What is looked at.
    pub body: Body,
    /// What lights it.
    pub sky: Sky,
    /// What looks at it.
    pub exposure: Exposure,
    /// By which equations.
    pub models: Models,
}

/// A setup that has been checked: it is complete, and its parts fit together. Code below this layer does not check again.
///
/// Its parts can be read as those of a [`Setup`]; to change them, make another one: the body is shared.
#[derive(Debug, Clone)]
pub struct Scene(Setup);

impl Deref for Scene {
    type Target = Setup;

    fn deref(&self) -> &Setup {
        &self.0
    }
}

impl SceneParts {
    /// Checks all parts, and what they owe each other.
    ///
    /// # Errors
    /// [`Error::Invalid`] with everything that is missing or out of range; if nothing is, with a camera inside the only body.
    pub fn check(self) -> Result<Scene> {
        let SceneParts { surface, sky, exposure, models } = self;
        let mut problems = surface.problems();
        // Without a facet or with a wrong index there is nothing that others could fit.
        if problems.is_empty() {
            return Scene::new(Setup { body: Body::checked(surface), sky, exposure, models });
        }
        problems.extend(alone(&sky, &exposure));
        problems.extend(together(&surface, &sky, &exposure, models));
        Err(Error::Invalid(problems))
    }
}

impl Scene {
    /// Checks that a body, a sky and an exposure fit together, without visiting all facets unless the camera is among them.
    ///
    /// # Errors
    /// As [`SceneParts::check`].
    pub fn new(setup: Setup) -> Result<Self> {
        let Setup { body, sky, exposure, models } = &setup;
        let mut problems = alone(sky, exposure);
        problems.extend(together(body, sky, exposure, *models));
        if problems.is_empty() {
            problems.extend(setup.overcut());
        }
        if problems.is_empty() {
            problems.extend(inside(body, exposure.camera.centre_m()));
            problems.extend(globe::touching(sky, body, exposure.camera.centre_m()));
        }
        if problems.is_empty() { Ok(Scene(setup)) } else { Err(Error::Invalid(problems)) }
    }

    /// The same under another sky.
    ///
    /// # Errors
    /// As [`Scene::new`].
    pub fn under(&self, sky: Sky) -> Result<Self> {
        Scene::new(Setup { sky, ..self.0.clone() })
    }

    /// Another exposure of the same.
    ///
    /// # Errors
    /// As [`Scene::new`].
    pub fn seen_by(&self, exposure: Exposure) -> Result<Self> {
        Scene::new(Setup { exposure, ..self.0.clone() })
    }

    /// The same by other equations.
    ///
    /// # Errors
    /// As [`Scene::new`]: heat needs emissivities in the bands.
    pub fn by(&self, models: Models) -> Result<Self> {
        Scene::new(Setup { models, ..self.0.clone() })
    }

    /// All parts, to be changed and checked again; the surface is copied only if others share it.
    pub fn into_parts(self) -> SceneParts {
        let Setup { body, sky, exposure, models } = self.0;
        SceneParts { surface: body.into_surface(), sky, exposure, models }
    }
}

/// What is wrong with a sky and with an exposure, each on its own.
fn alone(sky: &Sky, exposure: &Exposure) -> Vec<Problem> {
    [exposure.problems(), sky.problems()].concat()
}

/// What bands look for where spectra are not known.
fn together(surface: &Surface, sky: &Sky, exposure: &Exposure, models: Models) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut problem = |item: &str, message: String| problems.push(Problem::new(Location::item(item), message));
    let (bands, is_lit) = (&exposure.bands, |band: &Band| band.light.is_lit());
    for material in &surface.materials {
        material.covers(bands, models.thermal, &mut problem);
    }
    for texture in &surface.textures {
        texture.covers(bands, |message| problem(&surface.item_of(texture), message));
    }
    if let Some(message) = uncovered("the solar spectrum", &sky.sun.irradiance_1au, bands, is_lit) {
        problem("sun.spectrum", message);
    }
    let of_bodies = sky.bodies.iter().enumerate().map(|(i, body)| (sky::body_item(i), body));
    for (item, globe) in sky.mars.iter().map(|mars| (Sky::MARS.to_owned(), mars)).chain(of_bodies) {
        if let Some(message) = uncovered("albedo", &globe.reflectance, bands, is_lit) {
            problem(&format!("{item}.albedo"), message);
        }
    }
    if !(0.0..=1e4).contains(&models.floor_k) {
        problem("thermal.floor_k", format!("{} K is not the temperature of ground", models.floor_k));
    }
    if let Some(steps) = models.conduction {
        if sky.rotation.is_none() {
            let message = "heat is conducted from one time of day to another, and nothing says how long a day is: give `period_s`";
            problem("thermal.model", message.into());
        }
        if !STEPS.contains(&steps) {
            problem("thermal.steps", format!("{steps} is not from {} to {}", STEPS.start(), STEPS.end()));
        }
    }
    for (i, beam) in sky.beams.iter().enumerate() {
        if let Some(message) = uncovered("irradiance", &beam.irradiance, bands, is_lit) {
            problem(&format!("{}.irradiance", sky::beam_item(i)), message);
        }
    }
    problems
}

impl Setup {
    /// First and last wavelength at which all spectra that matter for this light are known, um. Bands end there.
    pub fn known_um(&self, light: Light) -> (f64, f64) {
        let glows = light.glows() && self.models.thermal != Thermal::Off;
        let materials = self.body.materials.iter().flat_map(|m| {
            let parameters = m.photometry.parameters().into_iter().map(|(_, spectrum)| spectrum);
            let reflected = parameters.chain([&m.reflectance]).filter(|_| light.is_lit());
            reflected.chain(glows.then_some(&m.emissivity))
        });
        let all = materials.chain(self.sky.spectra().filter(|_| light.is_lit()));
        all.map(Spectrum::coverage_um).fold(ALL_UM, |(a, b), (first, last)| (a.max(first), b.min(last)))
    }

    /// Share of a band's response that lies where not all spectra are known, and is left out.
    pub fn share_left_out(&self, band: &Band) -> f64 {
        band.share_beyond(self.known_um(band.light))
    }

    /// Bands of which several spectra together leave too little.
    fn overcut(&self) -> Option<Problem> {
        let bands = &self.exposure.bands;
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
        let bands = &self.exposure.bands;
        let shares: Vec<f64> = bands.iter().map(|band| self.share_left_out(band)).collect();
        let of_material = |material: &Material| {
            let key = material.photometry.key()?;
            Some(format!("materials.{:?}.{key}: {}", material.name, material.photometry.below_nothing()?))
        };
        let mut all: Vec<String> = self.body.materials.iter().filter_map(of_material).collect();
        all.extend(self.finer_than_sunlight());
        let Some(i) = (0..bands.len()).max_by(|&i, &j| shares[i].total_cmp(&shares[j]).then(j.cmp(&i))) else {
            return all;
        };
        if shares[i] == 0.0 {
            return all;
        }
        let cut = shares.iter().filter(|share| **share > 0.0).count();
        let (low, high) = bands[i].support_within_um(self.known_um(bands[i].light));
        all.push(format!(
            "{} of the response of band {} at {} um lies where not all spectra are known, and is left out: it is taken from {low} to \
             {high} um{}",
            percent(shares[i]),
            i + 1,
            bands[i].centre_um,
            match cut {
                1 => String::new(),
                n => format!("; of {} other bands less", n - 1),
            }
        ));
        all
    }

    /// Bands that are narrower than the steps of the built-in sunlight: its lines are not in them. Who gives a table knows how fine it is.
    fn finer_than_sunlight(&self) -> Option<String> {
        let known_um =
            Some(self.sky.sun.irradiance_1au.wavelength_um()).filter(|um| *um == solar_e490().wavelength_um())?;
        let step_um = |um: f64| {
            let after = known_um.partition_point(|known| *known <= um);
            Some(known_um.get(after)? - known_um.get(after.checked_sub(1)?)?)
        };
        // Tables are rounded: what is as wide as a step is no finer.
        let finer = |band: &&Band| {
            let width_um = band.fwhm_um.filter(|_| band.light.is_lit());
            width_um.zip(step_um(band.centre_um)).is_some_and(|(width_um, step_um)| width_um < 0.99 * step_um)
        };
        let bands: Vec<&Band> = self.exposure.bands.iter().filter(finer).collect();
        let first = bands.first()?;
        Some(format!(
            "{} of {} bands are narrower than the steps of the solar spectrum (E490): that at {} um is {} um wide, and a step there is {:.3} um",
            bands.len(),
            self.exposure.bands.len(),
            first.centre_um,
            first.fwhm_um.unwrap_or(0.0),
            step_um(first.centre_um).unwrap_or(0.0)
        ))
    }

    /// Whether this version can simulate the scene: a scene can hold more than can be computed.
    ///
    /// # Errors
    /// [`Error::Unsupported`] at the first texture of reflectances on a surface whose radiance is not proportional to its reflectance.
    pub fn simulable(&self) -> Result<()> {
        for texture in self.body.textures.iter().filter(|texture| texture.kind == TextureKind::Reflectance) {
            let Some(material) = self.body.materials.get(texture.material.0 as usize) else { continue };
            if let Some(key) = material.photometry.key().filter(|_| !material.photometry.is_proportional()) {
                let at = Location::item(self.body.item_of(texture));
                let feature = format!("a texture of reflectances on a surface by its `{key}` parameters");
                return Err(Error::Unsupported { at, feature });
            }
        }
        Ok(())
    }
}

/// Steps of a day where a scene does not say how many: good to 0.3 K, at sunset.
pub const STEPS_OF_A_DAY: u32 = 96;
/// Steps in which a day may be divided.
pub const STEPS: std::ops::RangeInclusive<u32> = 3..=10_000;

/// Nothing in a scene may be farther away, m (100 light years): products of lengths stay far from overflow.
pub const FARTHEST_M: f64 = 1e18;

/// Says if a place is too far away.
fn near_enough(item: &str, place_m: DVec3, problem: &mut impl FnMut(&str, String)) {
    if !place_m.is_finite() || place_m.abs().max_element() > FARTHEST_M {
        problem(item, format!("is more than {FARTHEST_M:e} m away: positions are in metres"));
    }
}

/// Refuses a camera inside the only body, where it would see nothing but the dark inner side.
fn inside(body: &Body, eye_m: DVec3) -> Option<Problem> {
    let (low_m, high_m) = body.bounds_m()?;
    let mesh = &body.mesh;
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
    let topology = body.topology();
    if !topology.is_one_body() || topology.enclosure(mesh, eye_m).inside == 0 {
        return None;
    }
    let help = "positions are in metres from the body's centre: check their unit and `origin_m`, and the mesh's `unit_m`, `up` and `coordinates`";
    Some(Problem::new(Location::item("observer.position_m"), "the camera is inside the surface").with_help(help))
}
