//! Images by other programs, which know less than this one: they are compared with the exact image of what they know.

use super::method::{Family, exact};
use super::{BandErrors, Chart, Entry};
use crate::error::Result;
use crate::progress::Watch;
use crate::scene::{Exposure, Photometry, Scene, Setup, SunModel, Thermal};

/// What another program made of [`lambert_sunlight`].
#[derive(Debug, Clone, PartialEq)]
pub struct Outside {
    /// A short name.
    pub name: String,
    /// What it does, in a sentence.
    pub account: String,
    /// CPU time, s.
    pub cpu_s: f64,
    /// Radiance of every pixel in the chart's first band, W m-2 sr-1 um-1.
    pub image: Vec<f64>,
}

/// What renderers know of a scene: sunlight alone, on Lambert surfaces of the materials' hemispherical reflectances, in the chart's first band.
///
/// # Errors
/// Those of [`Scene::new`].
pub fn lambert_sunlight(scene: &Scene) -> Result<Scene> {
    let Setup { body, mut sky, exposure, mut models } = (**scene).clone();
    let mut surface = body.into_surface();
    surface.textures.clear();
    surface.materials.iter_mut().for_each(|material| material.photometry = Photometry::Lambert);
    sky.mars = None;
    sky.bodies.clear();
    sky.beams.clear();
    models.thermal = Thermal::Off;
    models.sun = SunModel::Point;
    let bands = super::bands(scene).into_iter().take(1).collect();
    Scene::new(Setup { body: crate::scene::Body::new(surface)?, sky, exposure: Exposure { bands, ..exposure }, models })
}

impl Chart {
    /// Adds what other programs made of `known`, which is the chart's scene as they know it.
    ///
    /// # Errors
    /// Those of [`solve`](crate::solve::solve) and [`radiance`](crate::integrate::radiance).
    pub fn add(&mut self, known: &Scene, outsides: Vec<Outside>, watch: Watch<'_>) -> Result<()> {
        let truth = exact(known, watch)?;
        for Outside { name, account, cpu_s, image } in outsides {
            let errors = vec![BandErrors::new(&image, &truth[0], &self.ground)];
            self.entries.push(Entry {
                family: Family::Other,
                name,
                account: format!("{account} Compared with the exact image of sunlight alone on Lambert surfaces, which is all that it was told."),
                model: "sunlight on Lambert".into(),
                facets: self.facets,
                cpu_s,
                runs: 1,
                image: vec![image],
                errors,
                is_best: false,
            });
        }
        Ok(())
    }
}
