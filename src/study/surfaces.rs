//! How surfaces reflect, in a few numbers: factors at reference angles, albedos, where the numbers come from, what the uncertain ones are worth.

use glam::DVec3;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::site::Site;
use crate::geometry::angle_rad;
use crate::physics::reflectance::albedo::Measure;
use crate::physics::reflectance::{
    Brdf, KnownNumber, Lambert, Parameter, PhotometricAngles, Preset, kirchhoff_emissivity,
};
use crate::scene::{Material, Model, Photometry, Scene, Setup};
use crate::spectral::Spectrum;

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
    /// Its key in a scene file, below the model's; "albedo": the model's own, at the wavelength.
    pub key: String,
    /// What it is in this scene.
    pub value: f64,
    /// "published", "assumed", or "given": by the scene, in place of the preset's.
    pub origin: String,
    /// Where it was published, or why it is assumed; of one that is given, what the preset has.
    pub source: String,
    /// One standard deviation; 0 where none is known.
    pub sigma: f64,
    /// The change of the radiance by that, relative; but for that of the albedo with the same normal reflectance.
    pub worth: f64,
}

impl SurfaceEntry {
    /// Of a material at a wavelength, um; `None` where its reflectance is not known. `measure`, with its words, is what uncertainties are of.
    pub fn of(material: &Material, um: f64, (at, measure): (&str, &Measure)) -> Option<Self> {
        let (hemispherical_albedo, brdf) = (material.reflectance.at(um)?, brdf(material, um)?);
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

/// A material's surface at a wavelength, um; `None` where it is not known.
fn brdf(material: &Material, um: f64) -> Option<Brdf> {
    match material.photometry.key() {
        Some(_) => material.photometry.brdf(um),
        None => Some(Brdf::Lambert(Lambert { reflectance: material.reflectance.at(um)? })),
    }
}

fn preset(model: &Model, um: f64, at: &str, measure: &Measure) -> Option<PresetEntry> {
    let (preset, albedo) = (model.preset?, model.albedo.at(um)?);
    let known = preset.known();
    let worth = preset.worth(&model.shape, albedo, um, measure);
    let entry = |key: &str, value: f64, of_preset: &KnownNumber, worth: f64| {
        let KnownNumber { sigma, is_published, source, .. } = *of_preset;
        let is_given = !of_preset.is(value);
        let (origin, source) = match (is_given, is_published) {
            (true, _) => ("given", format!("the preset has {}", of_preset.value)),
            (false, true) => ("published", source.to_owned()),
            (false, false) => ("assumed", source.to_owned()),
        };
        NumberEntry {
            key: key.to_owned(),
            value: if is_given { value } else { of_preset.value },
            origin: origin.to_owned(),
            source,
            sigma: if is_given { 0.0 } else { sigma },
            worth: if is_given { 0.0 } else { worth },
        }
    };
    let number = |(parameter, of_preset): &(Parameter, KnownNumber)| {
        let found = worth.iter().find(|(p, number, _)| (p, number) == (parameter, of_preset));
        // What is uncertain elsewhere only is of no interest here.
        let is_elsewhere = found.is_none() && of_preset.certain_um.is_some();
        let worth = found.map_or(0.0, |(.., worth)| *worth);
        (!is_elsewhere).then_some(entry(parameter.key(), parameter.of(&model.shape)?, of_preset, worth))
    };
    let off = Measure::of(measure, &model.shape.brdf((albedo + known.albedo.sigma).min(model.shape.most())));
    let of_albedo = (off / measure.of(&model.shape.brdf(albedo)) - 1.0).abs();
    let numbers: Vec<NumberEntry> = std::iter::once(entry("albedo", albedo, &known.albedo, of_albedo))
        .chain(known.numbers.iter().filter_map(number))
        .collect();
    Some(PresetEntry {
        name: preset.name().to_owned(),
        uncertainty: numbers.iter().map(|number| number.worth * number.worth).sum::<f64>().sqrt(),
        numbers,
        assumed: known.assumed.to_owned(),
        at: at.to_owned(),
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

/// Disc-integrated brightness of spheres by the phase angle, over that of a white Lambert disc: the geometric albedo times the phase function.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PhaseCurve {
    /// Phase angles, deg.
    pub phase_deg: Vec<f64>,
    /// Names and values: the surface at each wavelength, and Lambert's surface of the first one's geometric albedo.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl PhaseCurve {
    fn new(surfaces: &[(String, Brdf)]) -> Self {
        // Every degree, and closer where surges peak.
        let phase_deg: Vec<f64> = (0..20).map(|k| 0.1 * f64::from(k)).chain((2..=170).map(f64::from)).collect();
        let geometric = surfaces.first().map_or(0.0, |(_, brdf)| Measure::Geometric.of(brdf));
        let white = Brdf::Lambert(Lambert { reflectance: 1.5 * geometric });
        let lambert = ("Lambert".to_owned(), white);
        let at = |brdf: &Brdf, deg: f64| match deg {
            0.0 => Measure::Geometric.of(brdf),
            deg => Measure::SphereAtPhase { phase_rad: deg.to_radians() }.of(brdf),
        };
        let column = |(name, brdf): &(String, Brdf)| {
            (name.clone(), phase_deg.par_iter().map(|deg| at(brdf, *deg)).collect::<Vec<f64>>())
        };
        let columns = surfaces.iter().chain([&lambert]).map(column).collect();
        PhaseCurve { phase_deg, columns }
    }
}

/// A scene's material at wavelengths, um, without any at those of the first, middle and last band with sunlight; and its phase curve.
///
/// # Errors
/// The wavelength at which it is not known.
pub fn surface_of_material(
    scene: &Scene,
    material: &Material,
    um: &[f64],
) -> Result<(Vec<SurfaceEntry>, PhaseCurve), f64> {
    let mut um = um.to_vec();
    if um.is_empty() {
        let lit: Vec<f64> =
            scene.exposure.bands.iter().filter(|band| band.light.is_lit()).map(|band| band.centre_um).collect();
        um = [0, lit.len() / 2, lit.len().saturating_sub(1)].into_iter().filter_map(|i| lit.get(i).copied()).collect();
        um.dedup();
    }
    let (at, measure) = angles(scene, &Site::new(&scene.body.mesh, scene.body.topology()));
    of_each(material, &um, (&at, &measure))
}

/// A preset at its wavelength, and its phase curve; uncertainties are for (30, 0, 0) deg.
pub fn surface_of_preset(preset: Preset) -> (Vec<SurfaceEntry>, PhaseCurve) {
    let known = preset.known();
    let albedo = Spectrum::constant(known.albedo.value);
    let (photometry, reflectance) = match known.shape {
        Some(shape) => {
            let model = Model { shape, albedo, preset: Some(preset) };
            let hemispherical = model.hemispherical();
            (Photometry::Model(Box::new(model)), hemispherical)
        }
        None => (Photometry::Lambert, albedo),
    };
    let bond_albedo = reflectance.value()[0];
    let material = Material {
        name: preset.name().to_owned(),
        emissivity: reflectance.map(kirchhoff_emissivity),
        reflectance,
        photometry,
        bond_albedo,
        emissivity_bolometric: 1.0 - bond_albedo,
        thermal_inertia: 0.0,
        temperature_k: None,
        mixture: vec![],
    };
    let measure = Measure::ReflectanceFactor(PhotometricAngles::of_angles(30f64.to_radians(), 0.0, 0.0));
    // A constant is known everywhere.
    let um = known.wavelength_um.unwrap_or(MIDDLE_UM);
    of_each(&material, &[um], ("incidence 30, emission 0, phase 30.0 deg", &measure)).unwrap_or_default()
}

/// Of what is the same at all wavelengths.
const MIDDLE_UM: f64 = 1.0;

fn of_each(material: &Material, um: &[f64], at: (&str, &Measure)) -> Result<(Vec<SurfaceEntry>, PhaseCurve), f64> {
    let of = |um: &f64| {
        let entry = SurfaceEntry::of(material, *um, at).ok_or(*um)?;
        // Digits that tell bands apart.
        let shown_um = (um * 1e4).round() / 1e4;
        Ok((entry, (format!("at {shown_um} um"), brdf(material, *um).ok_or(*um)?)))
    };
    let (entries, surfaces): (Vec<_>, Vec<_>) = um.iter().map(of).collect::<Result<Vec<_>, f64>>()?.into_iter().unzip();
    Ok((entries, PhaseCurve::new(&surfaces)))
}
