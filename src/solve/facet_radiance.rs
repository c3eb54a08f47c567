//! What each facet sends towards an observer, as a number for each band.

use std::ops::Range;

use rayon::prelude::*;

use super::emission::{Emission, Fragment, ImagePart, Observer};
use super::irradiance::share;
use crate::error::{Error, Location, Result};
use crate::geometry::index_u32;
use crate::product::FacetTable;
use crate::scene::Scene;

/// Answers what facets send towards an observer, whether or not anything stands between.
///
/// A facet's radiance is the mean over all of it: its sunlit part and the part in shadow count by their areas, and so do the parts that other sources
/// see. Angles are those at its centroid.
#[derive(Debug)]
pub struct FacetRadiance<'a> {
    scene: &'a Scene,
    table: &'a FacetTable,
    observer: Observer,
    emission: Emission<'a>,
    /// [row, band].
    spectra: Vec<f64>,
}

impl<'a> FacetRadiance<'a> {
    /// For a table that has been solved for the scene.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for textures, which a number for each facet does not hold.
    pub fn new(scene: &'a Scene, table: &'a FacetTable, observer: Observer) -> Result<Self> {
        if let Some(texture) = scene.body.textures.first() {
            let material = &scene.body.materials[texture.material.0 as usize].name;
            let at = Location::item(format!("materials.{material}.texture"));
            return Err(Error::Unsupported { at, feature: "one radiance for a facet under a texture".into() });
        }
        let emission = Emission::new(scene, table).seen_by(observer);
        let spectra = emission.spectra();
        Ok(FacetRadiance { scene, table, observer, emission, spectra })
    }

    /// Number of facets.
    pub fn facets(&self) -> usize {
        self.table.facets()
    }

    /// Cosine of emission of each facet of a range, at its centroid: below 0 from inside; 0 if it has no area.
    pub fn cos_emission(&self, facets: Range<usize>) -> Vec<f64> {
        let mesh = &self.scene.body.mesh;
        facets.map(|f| mesh.facet(f)).map(|f| f.normal().dot(self.observer.seen_from(&f))).collect()
    }

    /// The share of each facet of a range that the Sun sees, penumbrae by the share of the Sun.
    pub fn sunlit(&self, facets: Range<usize>) -> Vec<f64> {
        let sun = self.table.sources.first();
        facets.map(|f| sun.map_or(0.0, |sun| share(&sun.sees, f).min(1.0))).collect()
    }

    /// Radiance of each facet of a range, [facet, band], W m-2 sr-1 um-1; NaN where its outer side does not face the observer.
    pub fn radiance(&self, facets: Range<usize>) -> Vec<f64> {
        let bands = self.scene.exposure.bands.len();
        let cos_emission = self.cos_emission(facets.clone());
        let mut values = vec![f64::NAN; facets.len() * bands];
        let of_facet = |((values, facet), cos): ((&mut [f64], usize), f64)| {
            if cos > 0.0 {
                values.fill(0.0);
                let parts = self.table.sources.iter().filter(|source| source.seen().is_some());
                let lit: Vec<ImagePart> =
                    parts.map(|source| ImagePart { area: share(&source.sees, facet), moment: [0.0; 2] }).collect();
                let shown = ImagePart { area: 1.0, moment: [0.0; 2] };
                self.emission.send(&Fragment { facet: index_u32(facet), shown, lit: &lit }, None, |row, weight| {
                    let spectrum = &self.spectra[row as usize * bands..][..bands];
                    values.iter_mut().zip(spectrum).for_each(|(value, of_row)| *value += weight * of_row);
                });
            }
        };
        values.par_chunks_mut(bands.max(1)).zip(facets).zip(cos_emission).for_each(of_facet);
        values
    }
}
