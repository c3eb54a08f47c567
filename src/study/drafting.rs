//! Makes the draft of an image.

use super::cost::memory_bytes;
use super::draft::{Draft, Shown, some};
use super::effects::Given;
use super::extremes::{Extremes, sunlit_places};
use crate::error::{Error, Result};
use crate::integrate::{self, Image, Wanted};
use crate::progress::Watch;
use crate::scene::{Models, Scene, Setup, Sky, SunModel};
use crate::solve;
use crate::spectral::{Band, Light};

/// A draft that takes more memory than this, bytes, is not made.
const MOST_BYTES: u64 = 2 << 30;
/// Its wavelengths, at most.
const MOST: usize = 48;

impl Extremes {
    /// With a draft of the image, and with what is sunlit in it.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if `watch` asks to stop.
    pub fn with_draft(self, scene: &Scene, watch: Watch<'_>) -> Result<Self> {
        let references = Given::new(scene, &self, &self.sunlit).references();
        match drawn(scene, &references, watch) {
            Ok(Some((image, shown))) => {
                let seen = Extremes { sunlit: sunlit_places(scene, &image.backplanes), ..self };
                let given = Given::new(scene, &seen, &seen.sunlit);
                let shown: Vec<Shown> =
                    shown.iter().map(|of| Shown { reference: given.median_at(of.um.0, of.light), ..*of }).collect();
                let bands = Draft::of(&image, &shown, SunModel::Point);
                Ok(Extremes { draft: Some(Draft { bands, is_whole: false }), ..seen })
            }
            Err(Error::Interrupted) => Err(Error::Interrupted),
            Ok(None) | Err(_) => Ok(self),
        }
    }
}

/// At some of these wavelengths, um, ascending, with their light, and a reference radiance of each, W m-2 sr-1 um-1. `None` if there is nothing to see by these.
fn drawn(scene: &Scene, wavelengths: &[(f64, Light, f64)], watch: Watch<'_>) -> Result<Option<(Image, Vec<Shown>)>> {
    let is_known = |(.., reference): &&(f64, Light, f64)| *reference > 0.0 && reference.is_finite();
    let known: Vec<_> = wavelengths.iter().filter(is_known).collect();
    let shown: Vec<Shown> = (some(known.len(), MOST).into_iter().enumerate())
        .map(|(band, i)| Shown { band, um: (known[i].0, known[i].0), light: known[i].1, reference: known[i].2 })
        .collect();
    let mut setup = Setup {
        models: Models { thermal: scene.models.thermal, floor_k: scene.models.floor_k, ..Models::default() },
        sky: Sky { mars: None, bodies: vec![], beams: vec![], ..scene.sky.clone() },
        ..Setup::clone(scene)
    };
    setup.exposure.bands =
        shown.iter().map(|shown| Band { light: shown.light, ..Band::new(shown.um.0, None) }).collect();
    // Of what no spectrum knows, there is no draft.
    let Some(scene) = Scene::new(setup).ok().filter(|scene| memory_bytes(scene, false) < MOST_BYTES) else {
        return Ok(None);
    };
    let table = solve::solve(&scene, watch)?;
    let image = integrate::integrate(&scene, &table, Wanted::default(), watch)?;
    Ok(Some((image, shown)))
}
