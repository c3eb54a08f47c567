//! Light that reaches facets by way of others.

use serde::{Deserialize, Serialize};

use crate::geometry::MaterialId;
use crate::scene::Scene;
use crate::spectral::Light;

/// What is the same to within this, relative, has not changed.
const SAME: f64 = 1e-9;

/// Light that surfaces have reflected before it reaches a facet, at one wavelength; and what that says of all others.
///
/// Such light is a sum of very many spectra: of each source, reflected by each sequence of materials. A few of them make up all, and so many
/// wavelengths tell how: light with this irradiance there, and none at the wavelengths of the other columns, has the spectrum `parts`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reflected {
    /// The wavelength, um.
    pub um: f64,
    /// In bands of what light; if they hold heat, that of bodies is in it.
    pub light: Light,
    /// Irradiance there normal to the beam of each source, W m-2 um-1, as it was when this was solved.
    pub sources: Vec<f64>,
    /// Reflectance there of each material, as it was.
    pub reflectance: Vec<f64>,
    /// Its spectrum, for an irradiance of 1 at that wavelength: a sum.
    pub parts: Vec<ReflectedPart>,
    /// Irradiance there, the mean over each facet, W m-2 um-1.
    pub irradiance: Vec<f64>,
}

impl Reflected {
    /// What of a scene is not as it was when this was solved: the light of a source, or a material's reflectance.
    pub(super) fn changed_in(&self, scene: &Scene) -> Option<String> {
        let is_same = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs() || a.is_nan() && b.is_nan();
        let all = scene.sources();
        let mut sources = all.iter().zip(&self.sources);
        let of_source = sources.find(|(source, was)| {
            let [light, on_the_way] = scene.incoming_w_m2_um(source.incoming, self.light, self.um);
            !is_same(**was, light * on_the_way)
        });
        let mut materials = scene.body.materials.iter().zip(&self.reflectance);
        let of_material = materials.find(|(m, was)| !is_same(**was, m.reflectance.at(self.um).unwrap_or(f64::NAN)));
        let source = of_source.map(|(source, _)| format!("light of {:?}", source.name));
        source.or(of_material.map(|(material, _)| format!("reflectance of {:?}", material.name)))
    }
}

/// A term of a spectrum: a source's, times the reflectance of each material on the way.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReflectedPart {
    /// By what it is multiplied, of either sign.
    pub factor: f64,
    /// The source, by its place among those of the table.
    pub source: usize,
    /// The materials that have reflected it, ascending; one that did so twice is there twice.
    pub by: Vec<MaterialId>,
}
