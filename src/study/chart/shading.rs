//! From what a pixel shows of which facets to its radiance, by the product's own radiometry, however that was found.

use crate::geometry::SphereShown;
use crate::product::FacetTable;
use crate::scene::Scene;
use crate::solve::{Emission, Fragment, ImagePart};

/// What of a pixel is seen of a facet, and what of that each source lights that is known by parts.
#[derive(Debug, Clone, Default)]
pub(super) struct Share {
    pub(super) facet: u32,
    pub(super) shown: ImagePart,
    pub(super) lit: Vec<ImagePart>,
}

/// Makes radiances of shares.
pub(super) struct Shading<'a> {
    emission: Emission<'a>,
    spectra: Vec<f64>,
    bands: usize,
}

impl<'a> Shading<'a> {
    /// For the facets of a scene and their table.
    pub(super) fn new(scene: &'a Scene, table: &'a FacetTable) -> Self {
        let emission = Emission::new(scene, table);
        Shading { spectra: emission.spectra(), emission, bands: scene.exposure.bands.len() }
    }

    /// Radiance of a pixel in each band, W m-2 sr-1 um-1, of facets and of the bodies in view, in their order. Textures are left out.
    pub(super) fn pixel(&self, shares: &[Share], globes: &[SphereShown]) -> Vec<f64> {
        let mut radiance = vec![0.0; self.bands];
        let mut add = |row: u32, weight: f64| {
            let spectrum = &self.spectra[row as usize * self.bands..][..self.bands];
            radiance.iter_mut().zip(spectrum).for_each(|(sum, value)| *sum += weight * value);
        };
        for (i, shown) in globes.iter().enumerate() {
            self.emission.send_globe(i, shown, &mut add);
        }
        for share in shares {
            let fragment = Fragment { facet: share.facet, shown: share.shown, lit: &share.lit };
            self.emission.send(&fragment, None, &mut add);
        }
        radiance
    }
}
