//! Imaging through optics: the image is rendered on a finer grid with a margin, blurred there, and averaged over
//! pixels.
//!
//! Keystone is a shift, which commutes with the blur: it is applied to the finer image. Smile belongs to the detector:
//! each sample mixes blurred images of one smile each. For a whisk-broom each sample is an image of its own: a column
//! and its surroundings at that epoch.

use std::ops::Range;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::spectrometer::{self, Looks};
use crate::error::{Error, Location, Result};
use crate::geometry::{FrameCamera, whole_u32};
use crate::instrument::{Blur, Optics};
use crate::product::{FacetTable, Slab};
use crate::progress::Watch;
use crate::scene::{Exposure, Scene};

/// Bands expanded together: what [`Slab::expand`] computes at once.
const TOGETHER: usize = 16;
/// Subpixels rendered together: images are rendered in strips of so many, or line by line.
const STRIP: usize = 400_000;

/// Largest size of the kernel cache.
const KEPT_BYTES: usize = 512 << 20;

/// Kernels per band, for strips of equal size; made when first needed.
pub(super) struct Blurs {
    size: [usize; 2],
    of_bands: Vec<OnceLock<Blur>>,
}

impl Blurs {
    /// For the images of an exposure.
    pub(super) fn new(optics: &Optics, exposure: &Exposure) -> Self {
        let camera = &exposure.camera;
        let size = [camera.samples as usize, strip_lines(optics, exposure).min(camera.lines) as usize];
        let parts: usize =
            size.iter().map(|n| (n + 2 * optics.reach_px as usize) * optics.subpixels as usize).product();
        let bands = exposure.bands.len();
        let is_kept = parts.saturating_mul(bands).saturating_mul(size_of::<[f64; 2]>()) <= KEPT_BYTES;
        Blurs { size, of_bands: (0..if is_kept { bands } else { 0 }).map(|_| OnceLock::new()).collect() }
    }

    /// Blurs a subpixel image in a band.
    fn pixels(&self, optics: &Optics, exposure: &Exposure, band: usize, size: [usize; 2], fine: &[f64]) -> Vec<f64> {
        let make = || Blur::new(optics, exposure.bands[band].centre_um, size);
        match self.of_bands.get(band).filter(|_| size == self.size) {
            Some(kept) => kept.get_or_init(make).pixels(fine),
            None => make().pixels(fine),
        }
    }
}

/// Lines of an image that are looked at together: of a column, which is a sample of a whisk-broom, all.
fn strip_lines(optics: &Optics, exposure: &Exposure) -> u32 {
    if exposure.camera.samples == 1 {
        return exposure.camera.lines;
    }
    let parts = optics.subpixels as usize;
    let line_parts = (exposure.camera.samples as usize + 2 * optics.reach_px as usize) * parts * parts;
    u32::try_from((STRIP / line_parts.max(1)).max(2 * optics.reach_px as usize)).unwrap_or(u32::MAX).max(1)
}

/// A view through optics: from one pose, or from several within an exposure.
pub(super) struct Seen<'a> {
    /// The scene from each of them.
    pub(super) poses: &'a [Scene],
    /// What reaches its facets.
    pub(super) table: &'a FacetTable,
    /// What blurs the image.
    pub(super) optics: &'a Optics,
}

impl Seen<'_> {
    /// The image in slabs of lines, counted from 0, which `put` takes; `blurs` are those of its optics and exposure.
    pub(super) fn by_slabs(
        &self,
        blurs: &Blurs,
        put: &mut dyn FnMut(Slab) -> Result<()>,
        watch: Watch<'_>,
    ) -> Result<()> {
        let Some(first) = self.poses.first() else { return Ok(()) };
        let exposure = &first.exposure;
        let veil = self.veil(watch)?;
        let (lines, step) = (exposure.camera.lines, strip_lines(self.optics, exposure));
        for start in (0..lines).step_by(step as usize) {
            let mut slab = self.strip(start..lines.min(start.saturating_add(step)), blurs, watch)?;
            let pixels = pixels_of(exposure, &slab);
            for (band, veil) in slab.added.radiance.chunks_exact_mut(pixels).zip(&veil) {
                band.iter_mut().for_each(|value| *value += self.optics.stray * (veil - *value));
            }
            put(slab)?;
        }
        Ok(())
    }

    /// Stray light in each band: the mean radiance; none without stray light.
    fn veil(&self, watch: Watch<'_>) -> Result<Vec<f64>> {
        if self.optics.stray == 0.0 {
            return Ok(vec![]);
        }
        let mut sums: Vec<f64> = vec![];
        for scene in self.poses {
            let slab = spectrometer::radiance(scene, self.table, watch)?;
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
    fn strip(&self, lines: Range<u32>, blurs: &Blurs, watch: Watch<'_>) -> Result<Slab> {
        let Some(first) = self.poses.first() else { return Err(other_spectra()) };
        let (exposure, samples) = (&first.exposure, first.exposure.camera.samples as usize);
        let (bands, size) = (&exposure.bands, [samples, lines.len()]);
        let pixels = samples * lines.len();
        let mut radiance = vec![0.0; pixels * bands.len()];
        let Looks { smiles, keystones } = Looks::of(exposure);
        // One pose after another, as there may be many: blurred images are summed.
        for (smile_um, by_sample) in &smiles {
            for (keystone_px, by_band) in &keystones {
                let fine = self.fine(&lines, (*smile_um, *keystone_px), watch)?;
                let parts = fine.row_start.len().saturating_sub(1);
                radiance.par_chunks_mut(pixels * TOGETHER).zip(by_band.par_chunks(TOGETHER)).enumerate().for_each(
                    |(chunk, (to, by_band))| {
                        if by_band.iter().all(|share| *share == 0.0) {
                            return;
                        }
                        let first = chunk * TOGETHER;
                        let mut values = vec![0.0; parts * by_band.len()];
                        fine.expand(0..parts, first..first + by_band.len(), |part, band, of_bands| {
                            for (k, value) in of_bands.iter().enumerate() {
                                values[(band - first + k) * parts + part] = *value;
                            }
                        });
                        let bands = to.chunks_exact_mut(pixels).zip(values.chunks_exact(parts)).zip(by_band);
                        for (k, ((to, fine), of_band)) in bands.enumerate().filter(|(_, (_, share))| **share != 0.0) {
                            let blurred = blurs.pixels(self.optics, exposure, first + k, size, fine);
                            for ((to, value), of_sample) in to.iter_mut().zip(blurred).zip(by_sample.iter().cycle()) {
                                *to += of_sample * of_band * value;
                            }
                        }
                    },
                );
            }
        }
        Ok(Slab::dense(lines.start as usize..lines.end as usize, 0..bands.len(), radiance))
    }

    /// Some lines of the subpixel image with their margin, from all poses, with one smile, um, and one keystone,
    /// pixels.
    fn fine(&self, lines: &Range<u32>, (smile_um, keystone_px): (f64, f64), watch: Watch<'_>) -> Result<Slab> {
        let Optics { subpixels, reach_px, .. } = *self.optics;
        let mut parts = Vec::new();
        for scene in self.poses {
            let camera = refined(&scene.exposure, (subpixels, reach_px), lines.clone())?;
            let fine = scene.seen_by(Exposure { camera, ..scene.exposure.clone() })?;
            let slab = spectrometer::look(&fine, (smile_um, keystone_px * f64::from(subpixels)), self.table, watch)?;
            parts.push((1.0 / self.poses.len() as f64, slab));
        }
        let fine = if parts.len() == 1 { parts.pop().map(|(_, slab)| slab) } else { Slab::sum(&parts) };
        fine.ok_or_else(other_spectra)
    }
}

/// The subpixel camera of an exposure, with a margin of so many pixels; its lens also covers the keystone.
pub(super) fn refined(exposure: &Exposure, (parts, more): (u32, u32), lines: Range<u32>) -> Result<FrameCamera> {
    let shifts_px = exposure.spectrometer.keystones_px(&exposure.bands);
    let farthest = whole_u32(shifts_px.iter().fold(0.0_f64, |most, px| most.max(px.abs())).ceil());
    let refused = |message| Error::invalid(Location::item("sensor.optics"), message);
    let wide = exposure.camera.refined(parts, more + farthest, lines).map_err(refused)?;
    let within = |n: u32| farthest * parts..n - farthest * parts;
    Ok(wide.window(within(wide.samples), within(wide.lines)))
}

/// Error for sensors whose images cannot be blurred.
pub(super) fn serves(optics: Option<&Optics>, exposure: &Exposure) -> Result<()> {
    let Some(optics) = optics else { return Ok(()) };
    // What its camera says against it, it says before anything is computed.
    let by = (optics.subpixels, optics.reach_px);
    refined(exposure, by, 0..exposure.camera.lines).map(|_| ())
}

fn pixels_of(exposure: &Exposure, slab: &Slab) -> usize {
    exposure.camera.samples as usize * slab.lines.len()
}

/// Error if poses of one exposure show different bodies.
pub(super) fn other_spectra() -> Error {
    let message = "a body enters the view during the exposure: set exposure_poses = 1";
    Error::invalid(Location::item("sensor.exposure_poses"), message)
}
