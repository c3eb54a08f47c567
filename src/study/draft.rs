//! A draft of an image: sunlight from a point and the heat that it makes, in a few wavelengths. No pixel has less light than in it, but in half-shadow.

use super::cost::memory_bytes;
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
/// A place that the middle of the Sun's disc lights sees this much of it at least, between edges that cross there.
pub(super) const HALF_SHADOW: f64 = 0.25;
/// What is lit to within this is lit.
const ROUNDING: f64 = 1e-9;

/// The least radiance of what pixels show of the surface.
pub(super) struct Draft(Vec<Least>);

/// At a wavelength, over a reference.
struct Least {
    um: f64,
    light: Light,
    /// Of pixels that show nothing but sunlit ground, and of all.
    least: [f64; 2],
}

impl Draft {
    /// By wavelengths, um, ascending, with their light, and a reference radiance of each, W m-2 sr-1 um-1. `None` if there is nothing to see by these.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if `watch` asks to stop.
    pub(super) fn of(scene: &Scene, wavelengths: &[(f64, Light, f64)], watch: Watch<'_>) -> Result<Option<Self>> {
        let step = wavelengths.len().div_ceil(MOST).max(1);
        let is_shown = |(i, (.., reference)): &(usize, &(f64, Light, f64))| {
            (i % step == 0 || *i + 1 == wavelengths.len()) && *reference > 0.0 && reference.is_finite()
        };
        let shown: Vec<_> = wavelengths.iter().enumerate().filter(is_shown).map(|(_, at)| *at).collect();
        let mut setup = Setup {
            models: Models { thermal: scene.models.thermal, ..Models::default() },
            sky: Sky { mars: None, beams: vec![], ..scene.sky.clone() },
            ..Setup::clone(scene)
        };
        setup.exposure.bands =
            shown.iter().map(|(um, light, _)| Band { light: *light, ..Band::new(*um, None) }).collect();
        // Of what no spectrum knows, there is no draft.
        let Some(scene) = Scene::new(setup).ok().filter(|scene| memory_bytes(scene, false) < MOST_BYTES) else {
            return Ok(None);
        };
        match Self::least(&scene, &shown, watch) {
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

    /// The least radiance, over the reference, of pixels that show nothing but sunlit ground, and of all: the lower one of those at the nearest wavelengths of the
    /// draft to both sides. 0 where there is none.
    pub(super) fn least_at(&self, um: f64, light: Light) -> [f64; 2] {
        let of_light = || self.0.iter().filter(|least| least.light == light);
        let below = of_light().rfind(|least| least.um <= um);
        let above = of_light().find(|least| least.um >= um);
        [0, 1].map(|k| match (below, above) {
            (Some(below), Some(above)) => below.least[k].min(above.least[k]),
            _ => 0.0,
        })
    }
}
