//! How surfaces reflect, in a few numbers: factors at reference angles, albedos, where the numbers come from, what the uncertain ones are worth.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::site::Site;
use crate::geometry::angle_rad;
use crate::physics::reflectance::albedo::Measure;
use crate::physics::reflectance::{Brdf, KnownNumber, Lambert, Parameter, PhotometricAngles};
use crate::scene::{Material, Model, Setup};

/// Angles at which surfaces are compared: incidence, emission, azimuth of the view from the light's, deg. Seen along the beam; from the zenith; from
/// aside.
pub const REFERENCE_DEG: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [60.0, 40.0, 90.0]];

/// How a surface reflects at a wavelength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceEntry {
    /// Of the material.
    pub name: String,
    /// Its model's name in a scene file; "lambert" for those that need none.
    pub model: String,
    /// Wavelength of the numbers, um.
    pub wavelength_um: f64,
    /// Reflectance factors pi f at three reference geometries.
    pub reflectance_factors: Vec<FactorEntry>,
    /// Geometric albedo of a sphere of it: brightness at phase 0 over that of a white Lambert disc.
    pub geometric_albedo: f64,
    /// Hemispherical (spherical) albedo: Bond's, at this wavelength.
    pub hemispherical_albedo: f64,
    /// Bond albedo over all sunlight, for the heat balance.
    pub bond_albedo: f64,
    /// Where its numbers come from, if it has a preset's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preset: Option<PresetEntry>,
}

/// A reflectance factor and its angles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FactorEntry {
    /// Of the light from the normal, deg.
    pub incidence_deg: f64,
    /// Of the view from the normal, deg.
    pub emission_deg: f64,
    /// Between light and view, deg.
    pub phase_deg: f64,
    /// pi f.
    pub value: f64,
}

/// The preset of a surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PresetEntry {
    /// Its name.
    pub name: String,
    /// Each number of the model with where it comes from.
    pub numbers: Vec<NumberEntry>,
    /// What else is taken for granted.
    pub assumed: String,
    /// What the geometry is that the uncertainties are for.
    pub at: String,
    /// What they are worth together, as independent ones: one standard deviation of the radiance, relative.
    pub uncertainty: f64,
}

/// A number of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NumberEntry {
    /// Its key in a scene file, below the model's.
    pub key: String,
    /// What it is in this scene.
    pub value: f64,
    /// "published", "assumed", or "given": by the scene, in place of the preset's.
    pub origin: String,
    /// Where it was published, or why it is assumed; of one that is given, what the preset has.
    pub source: String,
    /// One standard deviation; 0 where none is known.
    pub sigma: f64,
    /// The change of the radiance by that, relative, with the same normal reflectance.
    pub worth: f64,
}

impl SurfaceEntry {
    /// Of a material at a wavelength, um; `None` where its reflectance is not known. `measure`, with its words, is what uncertainties are of.
    pub fn of(material: &Material, um: f64, (at, measure): (&str, &Measure)) -> Option<Self> {
        let lambert = |reflectance| Brdf::Lambert(Lambert { reflectance });
        let hemispherical_albedo = material.reflectance.at(um)?;
        let brdf = match material.photometry.key() {
            Some(_) => material.photometry.brdf(um)?,
            None => lambert(hemispherical_albedo),
        };
        let factor = |[incidence_deg, emission_deg, azimuth_deg]: [f64; 3]| {
            let [i, e, azimuth] = [incidence_deg, emission_deg, azimuth_deg].map(f64::to_radians);
            let angles = PhotometricAngles::of_angles(i, e, azimuth);
            let phase_deg = angles.phase_rad().to_degrees();
            FactorEntry { incidence_deg, emission_deg, phase_deg, value: brdf.reflectance_factor(&angles) }
        };
        let preset = material.photometry.model().and_then(|model| preset(model, um, at, measure));
        Some(SurfaceEntry {
            name: material.name.clone(),
            model: material.photometry.key().unwrap_or("lambert").to_owned(),
            wavelength_um: um,
            reflectance_factors: REFERENCE_DEG.map(factor).to_vec(),
            geometric_albedo: Measure::Geometric.of(&brdf),
            hemispherical_albedo,
            bond_albedo: material.bond_albedo,
            preset,
        })
    }
}

fn preset(model: &Model, um: f64, at: &str, measure: &Measure) -> Option<PresetEntry> {
    let preset = model.preset?;
    let (known, worth) = (preset.known(), preset.worth(&model.shape, model.albedo.at(um)?, um, measure));
    let number = |(parameter, of_preset): &(Parameter, KnownNumber)| {
        let found = worth.iter().find(|(p, number, _)| (p, number) == (parameter, of_preset));
        let value = parameter.of(&model.shape)?;
        let KnownNumber { sigma, is_published, source, .. } = *of_preset;
        let is_given = !of_preset.is(value);
        // What is uncertain elsewhere only is of no interest here.
        if found.is_none() && of_preset.certain_um.is_some() {
            return None;
        }
        let (origin, source) = match (is_given, is_published) {
            (true, _) => ("given", format!("the preset has {}", of_preset.value)),
            (false, true) => ("published", source.to_owned()),
            (false, false) => ("assumed", source.to_owned()),
        };
        Some(NumberEntry {
            key: parameter.key().to_owned(),
            value: if is_given { value } else { of_preset.value },
            origin: origin.to_owned(),
            source,
            sigma: if is_given { 0.0 } else { sigma },
            worth: found.map_or(0.0, |(.., worth)| *worth),
        })
    };
    Some(PresetEntry {
        name: preset.name().to_owned(),
        numbers: known.numbers.iter().filter_map(number).collect(),
        assumed: known.assumed.to_owned(),
        at: at.to_owned(),
        uncertainty: worth.iter().map(|(.., worth)| worth * worth).sum::<f64>().sqrt(),
    })
}

/// All materials in the middle of the bands that have sunlight; those alone that are known there.
pub(super) fn surfaces(scene: &Setup, site: &Site) -> Vec<SurfaceEntry> {
    let lit_um: Vec<f64> =
        scene.exposure.bands.iter().filter(|band| band.light.is_lit()).map(|band| band.centre_um).collect();
    let Some(&um) = lit_um.get(lit_um.len() / 2) else { return vec![] };
    let (at, measure) = angles(scene, site);
    scene.body.materials.iter().filter_map(|material| SurfaceEntry::of(material, um, (&at, &measure))).collect()
}

/// The angles at the scene's origin: on the mean surface of a site that is lit and seen there, else of a sphere at that phase.
fn angles(scene: &Setup, site: &Site) -> (String, Measure) {
    let (to_sun, to_eye) = (scene.sky.sun.direction.vec(), scene.exposure.camera.centre_m().normalize_or(DVec3::Z));
    let phase_rad = angle_rad(to_sun, to_eye);
    let phase = format!("phase {:.1} deg", phase_rad.to_degrees());
    if let Some(up) = site.up.filter(|up| up.dot(to_sun) > 0.0 && up.dot(to_eye) > 0.0) {
        let angles = PhotometricAngles::of_directions(up, to_sun, to_eye);
        let [i, e] = [angles.cos_incidence(), angles.cos_emission()].map(|cosine| cosine.acos().to_degrees());
        return (format!("incidence {i:.1}, emission {e:.1}, {phase}"), Measure::ReflectanceFactor(angles));
    }
    // A sphere lit from behind shows nothing.
    (format!("a sphere at {phase}"), Measure::SphereAtPhase { phase_rad: phase_rad.min(MOST_PHASE_RAD) })
}

/// Beyond this, 175 deg, a sphere is as uncertain as here.
const MOST_PHASE_RAD: f64 = 3.05;
