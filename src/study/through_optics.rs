//! What optics let through: an image is looked at on a grid finer than pixels, with what lies around it, blurred there, and averaged over pixels.

use std::ops::Range;

use rayon::prelude::*;

use crate::error::{Error, Location, Result};
use crate::instrument::{Blur, Optics};
use crate::integrate::{self, Wanted};
use crate::product::{Added, FacetTable, Slab};
use crate::progress::Watch;
use crate::scene::{Exposure, Scene};

/// Parts of pixels that are looked at together: lines of an image come in strips of so many, or one by one.
const STRIP: usize = 400_000;

/// What is seen through optics: from one pose, or from several that share the time of an exposure.
pub(super) struct Seen<'a> {
    /// The scene from each of them.
    pub(super) poses: &'a [Scene],
    /// What reaches its facets.
    pub(super) table: &'a FacetTable,
    /// What blurs the image.
    pub(super) optics: &'a Optics,
}

impl Seen<'_> {
    /// The image in slabs of lines, counted from 0, which `put` takes.
    pub(super) fn by_slabs(&self, put: &mut dyn FnMut(Slab) -> Result<()>, watch: Watch<'_>) -> Result<()> {
        let Some(first) = self.poses.first() else { return Ok(()) };
        // Where light stays in its place, pixels have no parts.
        let plain = Optics { subpixels: 1, reach_px: 1, ..self.optics.clone() };
        if !self.optics.blurs() && self.optics.subpixels > 1 {
            return Seen { optics: &plain, ..*self }.by_slabs(put, watch);
        }
        let exposure = &first.exposure;
        let veil = self.veil(watch)?;
        let (lines, reach, parts) = (exposure.camera.lines, self.optics.reach_px, self.optics.subpixels as usize);
        let line_parts = (exposure.camera.samples + 2 * reach) as usize * parts * parts;
        let step = u32::try_from((STRIP / line_parts.max(1)).max(2 * reach as usize)).unwrap_or(u32::MAX);
        for start in (0..lines).step_by(step.max(1) as usize) {
            let mut slab = self.strip(start..lines.min(start.saturating_add(step)), watch)?;
            let pixels = pixels_of(exposure, &slab);
            for (band, veil) in slab.added.radiance.chunks_exact_mut(pixels).zip(&veil) {
                band.iter_mut().for_each(|value| *value += self.optics.stray * (veil - *value));
            }
            put(slab)?;
        }
        Ok(())
    }

    /// What is scattered over the image, in each band: its mean radiance; none if nothing is.
    fn veil(&self, watch: Watch<'_>) -> Result<Vec<f64>> {
        if self.optics.stray == 0.0 {
            return Ok(vec![]);
        }
        let mut sums: Vec<f64> = vec![];
        for scene in self.poses {
            let slab = alone(scene, self.table, watch)?;
            let pixels = pixels_of(&scene.exposure, &slab);
            sums.resize(slab.bands.len(), 0.0);
            let share = 1.0 / (pixels * self.poses.len()) as f64;
            slab.expand(0..pixels, slab.bands.clone(), |_, band, values| {
                sums[band..].iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value);
            });
        }
        Ok(sums)
    }

    /// Some lines of the image, from all poses.
    fn strip(&self, lines: Range<u32>, watch: Watch<'_>) -> Result<Slab> {
        let Optics { subpixels, reach_px, .. } = *self.optics;
        let mut parts = Vec::new();
        for scene in self.poses {
            let camera = scene.exposure.camera.refined(subpixels, reach_px, lines.clone());
            let fine = scene.seen_by(Exposure { camera, ..scene.exposure.clone() })?;
            parts.push((1.0 / self.poses.len() as f64, alone(&fine, self.table, watch)?));
        }
        let fine = if parts.len() == 1 { parts.pop().map(|(_, slab)| slab) } else { Slab::sum(&parts) };
        let Some(fine) = fine else { return Err(other_spectra()) };
        let Some(first) = self.poses.first() else { return Err(other_spectra()) };
        let (bands, samples) = (&first.exposure.bands, first.exposure.camera.samples as usize);
        let size = [samples, lines.len()];
        let pixels = samples * lines.len();
        let mut added = Added::zeros((0..pixels).map(|_| true), bands.len());
        added.radiance.par_chunks_exact_mut(pixels).enumerate().for_each(|(band, to)| {
            let blur = Blur::new(self.optics, bands[band].centre_um, size);
            let [width, height] = blur.fine_size();
            let mut values = vec![0.0; width * height];
            fine.expand(0..width * height, band..band + 1, |part, _, value| values[part] = value[0]);
            to.copy_from_slice(&blur.pixels(&values));
        });
        Ok(Slab {
            lines: lines.start as usize..lines.end as usize,
            bands: 0..bands.len(),
            row_start: vec![0; pixels + 1],
            first_thermal_row: 0,
            added,
            ..Slab::default()
        })
    }
}

/// Radiance and nothing else.
fn alone(scene: &Scene, table: &FacetTable, watch: Watch<'_>) -> Result<Slab> {
    let wanted = Wanted { radiance_alone: true, ..Wanted::default() };
    Ok(integrate::integrate(scene, table, wanted, watch)?.slab)
}

fn pixels_of(exposure: &Exposure, slab: &Slab) -> usize {
    exposure.camera.samples as usize * slab.lines.len()
}

/// Poses of one exposure show other bodies.
pub(super) fn other_spectra() -> Error {
    let message = "poses of one exposure have not the same spectra: a body of the sky comes into view; take one pose";
    Error::invalid(Location::item("sensor.exposure_poses"), message)
}
