//! How a surface reflects: of a scene's material, or of a preset.

use std::path::{Path, PathBuf};

use super::CurveSheet;
use crate::error::{Error, Location, Problem, Result};
use crate::formats::scene_toml;
use crate::physics::reflectance::Preset;
use crate::progress::Watch;
use crate::study::{self, PhaseCurve, SurfaceEntry};

/// How a surface reflects.
#[derive(Debug, Clone)]
pub struct SurfaceFacts {
    /// In numbers, at each wavelength.
    pub entries: Vec<SurfaceEntry>,
    /// Brightness of a sphere of it over phase angles, at each wavelength, and of Lambert's surface.
    pub curve: PhaseCurve,
    /// That curve as a table and a drawing.
    pub sheet: CurveSheet,
}

impl SurfaceFacts {
    fn new(name: &str, (entries, curve): (Vec<SurfaceEntry>, PhaseCurve), inputs: Vec<PathBuf>) -> Self {
        let sheet = CurveSheet::of_surface(name, &curve, inputs);
        SurfaceFacts { entries, curve, sheet }
    }

    /// Of a preset, at its own wavelength.
    pub fn of_preset(preset: Preset) -> Self {
        SurfaceFacts::new(preset.name(), study::surface_of_preset(preset), vec![])
    }

    /// Of a scene's material at these wavelengths, um; without any those of the first, middle and last band with sunlight.
    ///
    /// # Errors
    /// Those of [`scene_toml::read`]; [`Error::Invalid`] if there is no such material, or if it is not known at a wavelength.
    pub fn of_material(scene: &Path, name: &str, um: &[f64], watch: Watch<'_>) -> Result<Self> {
        let file = scene_toml::read(scene, watch)?;
        let materials = &file.scene.body.materials;
        let Some(material) = materials.iter().find(|material| material.name == name) else {
            let names: Vec<String> = materials.iter().map(|material| format!("{:?}", material.name)).collect();
            let problem = Problem::new(Location::file(scene), format!("has no material {name:?}"));
            return Err(Error::Invalid(vec![problem.with_help(format!("materials are {}", names.join(", ")))]));
        };
        let found = study::surface_of_material(&file.scene, material, um).map_err(|um| {
            let (first, last) = material.reflectance.coverage_um();
            let message = format!("{name:?} is not known at {um} um: its tables are from {first} to {last} um");
            Error::invalid(Location::file(scene), message)
        })?;
        Ok(SurfaceFacts::new(name, found, file.inputs.into_iter().map(|input| input.path).collect()))
    }
}
