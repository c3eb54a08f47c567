//! A draft of an image: sunlight from a point and the heat that it makes, in a few wavelengths. No pixel has less light than in it, but in half-shadow.

use super::cost::memory_bytes;
use super::effects::Given;
use super::extremes::{Draft, Extremes, Least};
use crate::error::{Error, Result};
use crate::integrate::{self, Wanted};
use crate::progress::Watch;
use crate::scene::{Models, Scene, Setup, Sky};
use crate::solve;
use crate::spectral::{Band, Light};

/// An image that takes more memory than this, bytes, has none.
const MOST_BYTES: u64 = 2 << 30;
/// Wavelengths at most.
const MOST: usize = 16;
/// What is lit to within this is lit.
const ROUNDING: f64 = 1e-9;

impl Extremes {
    /// With a draft of the image.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if `watch` asks to stop.
    pub fn with_draft(self, scene: &Scene, watch: Watch<'_>) -> Result<Self> {
        let wavelengths = Given::new(scene, &self, &self.sunlit).references();
        Ok(Extremes { draft: of(scene, &wavelengths, watch)?, ..self })
    }
}

/// By wavelengths, um, ascending, with their light, and a reference radiance of each, W m-2 sr-1 um-1. `None` if there is nothing to see by these.
///
/// # Errors
/// [`Error::Interrupted`] if `watch` asks to stop.
fn of(scene: &Scene, wavelengths: &[(f64, Light, f64)], watch: Watch<'_>) -> Result<Option<Draft>> {
    let step = wavelengths.len().div_ceil(MOST).max(1);
    let is_shown = |(i, (.., reference)): &(usize, &(f64, Light, f64))| {
        (i % step == 0 || *i + 1 == wavelengths.len()) && *reference > 0.0 && reference.is_finite()
    };
    let shown: Vec<_> = wavelengths.iter().enumerate().filter(is_shown).map(|(_, at)| *at).collect();
    let mut setup = Setup {
        models: Models { thermal: scene.models.thermal, ..Models::default() },
        sky: Sky { mars: None, bodies: vec![], beams: vec![], ..scene.sky.clone() },
        ..Setup::clone(scene)
    };
    setup.exposure.bands = shown.iter().map(|(um, light, _)| Band { light: *light, ..Band::new(*um, None) }).collect();
    // Of what no spectrum knows, there is no draft.
    let Some(scene) = Scene::new(setup).ok().filter(|scene| memory_bytes(scene, false) < MOST_BYTES) else {
        return Ok(None);
    };
    match least(&scene, &shown, watch) {
        Ok(least) => Ok(Some(Draft(least))),
        Err(Error::Interrupted) => Err(Error::Interrupted),
        Err(_) => Ok(None),
    }
}

fn least(scene: &Scene, shown: &[(f64, Light, f64)], watch: Watch<'_>) -> Result<Vec<Least>> {
    let table = solve::solve(scene, watch)?;
    let image = integrate::integrate(scene, &table, Wanted::default(), watch)?;
    let plane = |name: &str| image.backplanes.plane(name).map_or(&[][..], |plane| &plane.values);
    let (coverage, lit) = (plane("COVERAGE"), plane("LIT_FRACTION"));
    let mut least: Vec<Least> =
        shown.iter().map(|(um, light, _)| Least { um: *um, light: *light, least: [f64::INFINITY; 2] }).collect();
    image.slab.expand(0..coverage.len(), 0..shown.len(), |pixel, first, values| {
        if coverage[pixel] > 0.0 {
            for (band, value) in (first..).zip(values) {
                let over = value / coverage[pixel] / shown[band].2;
                let [of_lit, of_all] = &mut least[band].least;
                *of_all = of_all.min(over);
                if lit[pixel] > 1.0 - ROUNDING {
                    *of_lit = of_lit.min(over);
                }
            }
        }
    });
    Ok(least)
}
