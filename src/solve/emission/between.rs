//! Light that facets send each other: to the one that reflects it last, a source that lights all of it from everywhere.

use super::at;
use super::light::SourceLight;
use crate::product::{FacetTable, Reflected, ReflectedPart};
use crate::scene::Scene;

/// The spectra of such light.
#[derive(Debug)]
pub(super) struct Between<'a> {
    scene: &'a Scene,
    reflected: &'a [Reflected],
}

/// The sources, and then what facets send each other.
pub(super) fn lights(table: &FacetTable) -> Vec<SourceLight<'_>> {
    let between = table.reflected.iter().map(|reflected| SourceLight::diffuse(&reflected.irradiance));
    SourceLight::list(&table.sources).into_iter().chain(between).collect()
}

impl<'a> Between<'a> {
    pub(super) fn new(scene: &'a Scene, table: &'a FacetTable) -> Self {
        Between { scene, reflected: &table.reflected }
    }

    /// Irradiances, W m-2 um-1, for 1 at the wavelength of each column, given the sources'.
    pub(super) fn incoming(&self, um: f64, sources: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
        let materials = &self.scene.body.materials;
        let of_part = move |ReflectedPart { factor, source, by }: &ReflectedPart| {
            let [light, on_the_way] = sources[*source];
            let reflected = by.iter().map(|m| at(&materials[m.0 as usize].reflectance, um)).product::<f64>();
            factor * light * on_the_way * reflected
        };
        self.reflected.iter().map(move |Reflected { parts, .. }| [1.0, parts.iter().map(&of_part).sum()])
    }
}
