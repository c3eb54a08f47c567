//! What reaches each facet, and how warm it is. Not radiance: that depends on the observer.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Reflected, ReflectedPart};
use crate::error::{Error, Location, Problem, Result, number};
use crate::physics::heat;
use crate::scene::{DirectionField, Globe, Models, Scene, Sky, Thermal};
use crate::visibility::Seen;

/// Two directions to a source are the same to within this, rad: other programs' tables are rounded.
const DIRECTION_TOLERANCE: f64 = 1e-9;

/// What of each facet a source sees.
#[derive(Debug, Clone, PartialEq)]
pub enum Sees {
    /// All of it, as far as anybody asked.
    All,
    /// These parts: the rest is in its shadow.
    Polygons(Seen),
    /// This share of each facet, anywhere on it.
    Shares(Vec<f64>),
}

/// What one source sends to each facet.
///
/// Irradiances are geometric, relative to a reference, so that spectra can be multiplied in afterwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// What the source is called in its sky.
    pub source: String,
    /// From where its light comes.
    pub field: DirectionField,
    /// Irradiance on each facet where the source sees it. For a beam, relative to a plane normal to it: cos i, or 0 for a facet that
    /// faces away. For Mars, relative to its reflectance times the solar irradiance normal to the beam.
    pub irradiance: Vec<f64>,
    /// What of each facet it sees.
    pub sees: Sees,
}

impl Lighting {
    /// The parts of facets that the source sees, if it is known by parts.
    pub fn seen(&self) -> Option<&Seen> {
        match &self.sees {
            Sees::Polygons(seen) => Some(seen),
            Sees::All | Sees::Shares(_) => None,
        }
    }
}

/// What the sources send to each facet, and its temperature.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FacetTable {
    /// One for each source of the sky, in its order: the Sun first.
    pub sources: Vec<Lighting>,
    /// Temperature of the part that the Sun sees, K. Empty without thermal emission.
    pub temperature_lit_k: Vec<f64>,
    /// Temperature of the part in its shadow, K. Empty without thermal emission.
    pub temperature_shaded_k: Vec<f64>,
    /// Light that facets send each other, at a few wavelengths that tell of all others; none if it is left out.
    pub reflected: Vec<Reflected>,
    /// How far off that is, as its lines are no more than they are; `None` if it is left out, or not known.
    pub sampling: Option<Sampling>,
    /// By which equations it was solved.
    pub models: Models,
}

/// Errors of light between facets that come from sampling directions and places, of patches of a few facets, and wavelengths.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sampling {
    /// Where the Sun shines on some of a patch.
    pub lit: Option<SamplingError>,
    /// Where it does not.
    pub shadow: Option<SamplingError>,
    /// By how much a spectrum of such light is off at most, as it is known at a few wavelengths; over the most of itself, relative to the strongest
    /// source.
    #[serde(default)]
    pub spectra: f64,
}

/// What one half of the lines gives, against the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SamplingError {
    /// Median, over the light that a patch receives from others.
    pub p50: f64,
    /// Root mean square, over that of this light.
    pub rms: f64,
}

impl FacetTable {
    /// The same of some facets, ascending.
    #[must_use]
    pub fn part(&self, facets: &[u32]) -> FacetTable {
        let of =
            |all: &[f64]| -> Vec<f64> { facets.iter().filter_map(|facet| all.get(*facet as usize).copied()).collect() };
        let sees = |sees: &Sees| match sees {
            Sees::All => Sees::All,
            Sees::Polygons(seen) => Sees::Polygons(seen.part(facets)),
            Sees::Shares(shares) => Sees::Shares(of(shares)),
        };
        let lighting = |of_source: &Lighting| Lighting {
            source: of_source.source.clone(),
            field: of_source.field,
            irradiance: of(&of_source.irradiance),
            sees: sees(&of_source.sees),
        };
        FacetTable {
            sources: self.sources.iter().map(lighting).collect(),
            temperature_lit_k: of(&self.temperature_lit_k),
            temperature_shaded_k: of(&self.temperature_shaded_k),
            reflected: self
                .reflected
                .iter()
                .map(|all| Reflected { irradiance: of(&all.irradiance), ..all.clone() })
                .collect(),
            sampling: self.sampling,
            models: self.models,
        }
    }

    /// Number of facets.
    pub fn facets(&self) -> usize {
        self.sources.first().map_or(0, |sun| sun.irradiance.len())
    }

    /// What a source of this name sends.
    pub fn of(&self, source: &str) -> Option<&Lighting> {
        self.sources.iter().find(|lighting| lighting.source == source)
    }

    /// What the Sun sees of each facet; `None` in a table that lacks it.
    pub fn sunlit(&self) -> Option<&Seen> {
        self.sources.first().and_then(Lighting::seen)
    }

    /// Refuses a table that cannot be of the scene: what it lacks would be missing from the image without the report saying so.
    ///
    /// # Errors
    /// [`Error::Invalid`] with everything that does not fit.
    pub fn fits(&self, scene: &Scene) -> Result<()> {
        const OF_ANOTHER: &str =
            "the table is of another mesh, or of a scene with other sources or heat: solve the scene again";
        const AGAIN: &str = "solve the scene again";
        let mut problems = Vec::new();
        let mut problem = |item: String, message: String, help: &str| {
            problems.push(Problem::new(Location::item(item), message).with_help(help));
        };
        let sources = scene.sources();
        let facets = scene.body.mesh.facets.len();
        let mut has = |item: String, count: usize, wanted: usize| {
            if count != wanted {
                problem(item, format!("has {count} values, but the scene needs {wanted}"), OF_ANOTHER);
            }
        };
        for source in &sources {
            let irradiance = self.of(&source.name).map_or(0, |lighting| lighting.irradiance.len());
            has(format!("{}_irradiance", source.name), irradiance, facets);
        }
        let is_wanted = |name: &str| sources.iter().any(|source| source.name == name);
        for lighting in self.sources.iter().filter(|lighting| !is_wanted(&lighting.source)) {
            has(format!("{}_irradiance", lighting.source), lighting.irradiance.len(), 0);
        }
        for lighting in &self.sources {
            match &lighting.sees {
                Sees::All => {}
                Sees::Shares(shares) => has(format!("{}_share", lighting.source), shares.len(), facets),
                Sees::Polygons(seen) => has(format!("{}_lit", lighting.source), seen.shown.len(), facets),
            }
        }
        let warm = if scene.models.thermal == Thermal::Off { 0 } else { facets };
        let temperatures =
            [("temperature_lit_k", &self.temperature_lit_k), ("temperature_shaded_k", &self.temperature_shaded_k)];
        temperatures.iter().for_each(|(name, values)| has((*name).into(), values.len(), warm));
        let warmest_k = warmest_k(scene);
        for (name, values) in temperatures {
            if let Some(i) = values.iter().position(|t_k| *t_k > warmest_k) {
                let message =
                    format!("is {} K: nothing in this scene is warmer than {warmest_k:.1} K", number(values[i]));
                problem(format!("{name}[{i}]"), message, AGAIN);
            }
        }
        for (i, lighting) in self.sources.iter().enumerate() {
            if self.sources[..i].iter().any(|other| other.source == lighting.source) {
                problem(lighting.source.clone(), "appears twice".into(), AGAIN);
            }
            if let Some(Err(message)) = lighting.seen().map(Seen::validate) {
                problem(format!("{}_polygon_start", lighting.source), message, AGAIN);
            }
        }
        for (i, source) in sources.iter().enumerate() {
            let Some(lighting) = self.of(&source.name) else { continue };
            if self.sources.get(i).is_none_or(|lighting| lighting.source != source.name) {
                let message = format!("is not source {} of the table", i + 1);
                problem(source.name.clone().into_owned(), message, AGAIN);
            }
            if source.name == Sky::SUN && lighting.seen().is_none() {
                problem("sun_lit".into(), "what the Sun sees of each facet is missing".into(), AGAIN);
            }
            let directions = lighting.field.direction().zip(source.field.direction());
            let off_rad = directions.map_or(0.0, |(table, scene)| table.angle_rad(scene));
            if off_rad > DIRECTION_TOLERANCE {
                let whose = match &*source.name {
                    Sky::SUN => "the Sun",
                    Sky::MARS => "Mars",
                    name => name,
                };
                let message = format!("is {:.3e} deg from where the scene has {whose}", off_rad.to_degrees());
                problem(format!("{}_direction", source.name), message, AGAIN);
            }
        }
        for (i, reflected) in self.reflected.iter().enumerate() {
            let Reflected { sources: solved, reflectance, parts, irradiance, .. } = reflected;
            let is_known = |part: &ReflectedPart| {
                part.source < sources.len() && part.by.iter().all(|m| (m.0 as usize) < scene.body.materials.len())
            };
            let is_whole = solved.len() == sources.len() && reflectance.len() == scene.body.materials.len();
            if !is_whole || !parts.iter().all(is_known) || irradiance.len() != facets {
                let message = "light between facets is of other sources, materials or facets".into();
                problem(format!("reflected[{i}]"), message, OF_ANOTHER);
            } else if let Some(what) = reflected.changed_in(scene) {
                let message = format!("light between facets was solved with another {what} at {} um", reflected.um);
                problem(format!("reflected[{i}]"), message, AGAIN);
            }
        }
        if problems.is_empty() { Ok(()) } else { Err(Error::Invalid(problems)) }
    }
}

/// No facet is warmer, K: one that is held at a temperature, or one that faces the Sun, with a Mars and every other body that send it as much light again, and all their heat, and every beam.
pub(crate) fn warmest_k(scene: &Scene) -> f64 {
    let sun_w_m2 = scene.sky.sun.total_irradiance_w_m2();
    let mars_w_m2 = scene.sky.mars.as_ref().map_or(0.0, |mars| mars.thermal_exitance_w_m2);
    let of_body = |body: &Globe| body.thermal_exitance_w_m2 + sun_w_m2 * scene.sky.sun_on(body).strength;
    let bodies_w_m2: f64 = scene.sky.bodies.iter().map(of_body).sum();
    let beams_w_m2: f64 = scene.sky.beams.iter().map(|beam| beam.total_irradiance_w_m2).sum();
    let emissivity = scene.body.materials.iter().map(|m| m.emissivity_bolometric).fold(1.0, f64::min);
    let warmest_k = match scene.models.thermal {
        Thermal::Equilibrium => {
            heat::equilibrium_temperature_k(2.0 * sun_w_m2 + mars_w_m2 + bodies_w_m2 + beams_w_m2, emissivity)
        }
        // Tables of our own have rounding too.
        Thermal::Thesis => heat::thesis_temperature_k(1.0 + 1e-9),
        Thermal::Off => f64::INFINITY,
    };
    let held_k = scene.body.materials.iter().filter_map(|material| material.temperature_k);
    held_k.fold(warmest_k.max(scene.models.floor_k), f64::max)
}
