//! Geolocation errors by source: biases exactly, covariances propagated linearly.
//!
//! A covariance L L^T propagates by central differences: per column of L, half the difference of the ground points at
//! plus and minus one standard deviation, on the plane of the facet that is met.

use std::ops::Range;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::drawn::{Sampled, draws, sampled};
use super::sight::{Believed, Ground, Met, site};
use super::{Asked, Deviation, Knowledge, Source};
use crate::error::{Error, Location, Result};
use crate::progress::{Watch, tell};
use crate::scene::Readout;
use crate::study::locate::{Locator, Place};
use crate::visibility::RayTree;

/// The error of a pixel's ground point: believed minus true, along east, north and up at the true point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Bias: error of the mean belief, m.
    pub bias_m: DVec3,
    /// Covariance about that, m^2.
    pub covariance_m2: DMat3,
}

impl Part {
    /// Standard deviations along east, north and up, m.
    pub fn sd_m(&self) -> DVec3 {
        let c = self.covariance_m2;
        DVec3::new(c.x_axis.x, c.y_axis.y, c.z_axis.z).map(|variance| variance.max(0.0).sqrt())
    }

    /// Root mean square of the error, m.
    pub fn rms_m(&self) -> f64 {
        self.bias_m.length().hypot(self.sd_m().length())
    }

    /// Root mean square of the horizontal error, m.
    pub fn level_m(&self) -> f64 {
        self.bias_m.truncate().length().hypot(self.sd_m().truncate().length())
    }
}

/// The errors of a pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelBudget {
    /// Where in the image.
    pub place: Place,
    /// A pixel's width at the true point, across the view, m: `PIXELRESOLUTION`.
    pub pixel_m: f64,
    /// By each stated source, in order; `None`: the believed ray misses the surface.
    pub sources: Vec<Option<Part>>,
    /// By all sources together.
    pub total: Option<Part>,
    /// The same by Monte Carlo, if asked for.
    pub sampled: Option<Sampled>,
}

/// The errors of an image's pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// The sources that are stated.
    pub sources: Vec<Source>,
    /// Columns and rows of pixels.
    pub size: [usize; 2],
    /// The reference band of the geometry, from 0.
    pub band: usize,
    /// Row by row; `None`: no surface.
    pub pixels: Vec<Option<PixelBudget>>,
}

/// The middle pixel of each block of `every` pixels along a side.
fn centres(pixels: u32, every: u32) -> impl ExactSizeIterator<Item = f64> {
    let every = every.clamp(1, pixels.max(1));
    let range: Range<u32> = 0..pixels.div_ceil(every);
    range.map(move |i| {
        let (begin, end) = (i * every, (i * every).saturating_add(every).min(pixels));
        f64::from(begin + (end - begin) / 2) + 0.5
    })
}

/// The errors of places of pixels.
///
/// # Errors
/// [`Error::Invalid`] if there is no such band, what is stated needs a time or a way that the scene does not have, or where something is, is not known then;
/// [`Error::Interrupted`] if `watch` asks to stop.
pub fn budget(locator: &Locator<'_>, knowledge: &Knowledge, asked: Asked, watch: Watch<'_>) -> Result<Budget> {
    if 1.0 + knowledge.bias.focal_length <= 0.0 {
        let message = format!("must be above -1: {}", knowledge.bias.focal_length);
        return Err(Error::invalid(Location::item("focal_length.bias"), message));
    }
    let camera = &locator.scene.exposure.camera;
    let truth = Ground { mesh: &locator.scene.body.mesh, tree: locator.tree };
    let tree = knowledge.mesh.as_ref().map(RayTree::new);
    let coarser = knowledge.mesh.as_ref().zip(tree.as_ref()).map(|(mesh, tree)| Ground { mesh, tree });
    let sources = knowledge.sources();
    let of = Study { locator, knowledge, truth, coarser, sources: &sources, draws: draws(knowledge, asked) };
    let (lines, samples) = (centres(camera.lines, asked.every), centres(camera.samples, asked.every));
    let size = [samples.len(), lines.len()];
    let (lines, samples): (Vec<f64>, Vec<f64>) = (lines.collect(), samples.collect());
    let done = std::sync::atomic::AtomicU64::new(0);
    let rows: Result<Vec<Vec<_>>> = lines
        .par_iter()
        .map(|line| {
            let row = of.row(*line, &samples, asked.band)?;
            let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            tell(watch, "errors", done, size[1] as u64)?;
            Ok(row)
        })
        .collect();
    Ok(Budget { pixels: rows?.into_iter().flatten().collect(), size, band: asked.band, sources })
}

/// State shared by all pixels.
struct Study<'a> {
    locator: &'a Locator<'a>,
    knowledge: &'a Knowledge,
    truth: Ground<'a>,
    coarser: Option<Ground<'a>>,
    sources: &'a [Source],
    draws: Vec<Deviation>,
}

/// A source's biased camera, and those at plus and minus one standard deviation.
struct OfSource {
    biased: (Deviation, Believed),
    beside: Vec<[(Deviation, Believed); 2]>,
}

/// The cameras of a place: true, by each source, by all together, and drawn.
struct Cameras {
    truth: Believed,
    by_source: Vec<OfSource>,
    together: (Deviation, Believed),
    drawn: Vec<(Deviation, Believed)>,
}

impl Study<'_> {
    fn cameras(&self, place: Place, band: usize) -> Result<Cameras> {
        let Study { knowledge, locator, .. } = *self;
        let camera = |by: Deviation| Ok::<_, Error>((by, Believed::new(locator, knowledge, (place, band), &by)?));
        let of_source = |source: &Source| {
            let beside = |column: Deviation| {
                let before = camera(knowledge.bias.and(column.reversed()))?;
                Ok::<_, Error>([before, camera(knowledge.bias.and(column))?])
            };
            let beside: Result<Vec<_>> = knowledge.columns(*source).into_iter().map(beside).collect();
            Ok::<_, Error>(OfSource { biased: camera(knowledge.bias.of(*source))?, beside: beside? })
        };
        Ok(Cameras {
            truth: camera(Deviation::default())?.1,
            by_source: self.sources.iter().map(of_source).collect::<Result<_>>()?,
            together: camera(knowledge.bias)?,
            drawn: self.draws.iter().map(|by| camera(*by)).collect::<Result<_>>()?,
        })
    }

    fn row(&self, line: f64, samples: &[f64], band: usize) -> Result<Vec<Option<PixelBudget>>> {
        // Pixels of a line share an epoch, except for a whisk-broom.
        let one_by_one = self.locator.motion.is_some_and(|(_, timing)| matches!(timing.readout, Readout::Sample(_)));
        let mut cameras: Option<Cameras> = None;
        let mut row = Vec::with_capacity(samples.len());
        for sample in samples {
            let place = Place { sample: *sample, line };
            let of = match cameras.take_if(|_| !one_by_one) {
                Some(of) => of,
                None => self.cameras(place, band)?,
            };
            let sight = of.truth.sight(self.locator, place);
            row.push(self.truth.met(&sight, DVec3::ZERO).map(|truth| {
                let range_m = (truth.point_m - sight.from_m).length();
                self.pixel(place, (truth, range_m), &of)
            }));
            cameras = Some(of);
        }
        Ok(row)
    }

    fn pixel(
        &self,
        place: Place,
        (truth, range_m): (Met, f64),
        Cameras { by_source, together, drawn, .. }: &Cameras,
    ) -> PixelBudget {
        let axes = site(self.locator, truth.point_m);
        let raised = |by: &Deviation| by.height_m * axes.z_axis;
        let off_m = |point_m: DVec3| axes.transpose() * (point_m - truth.point_m);
        let met = |ground: &Ground<'_>, (by, camera): &(Deviation, Believed)| {
            ground.met(&camera.sight(self.locator, place), raised(by))
        };
        let believed = self.coarser.as_ref().unwrap_or(&self.truth);
        let mean = met(believed, together);
        let covariance_m2 = |cameras: &OfSource, mean: &Met| {
            let covariance = |[before, behind]: &[(Deviation, Believed); 2]| {
                let on_plane = |(by, camera): &(Deviation, Believed)| {
                    // The plane includes the biased height.
                    let raised_m = raised(by) - raised(&together.0);
                    mean.on_plane(&camera.sight(self.locator, place), raised_m)
                };
                let off_m = axes.transpose() * (0.5 * (on_plane(behind) - on_plane(before)));
                DMat3::from_cols(off_m * off_m.x, off_m * off_m.y, off_m * off_m.z)
            };
            cameras.beside.iter().map(covariance).fold(DMat3::ZERO, |sum, covariance| sum + covariance)
        };
        let sources: Vec<Option<Part>> = self
            .sources
            .iter()
            .zip(by_source)
            .map(|(source, cameras)| {
                let ground = if *source == Source::Mesh { believed } else { &self.truth };
                let bias_m = off_m(met(ground, &cameras.biased)?.point_m);
                Some(Part { bias_m, covariance_m2: covariance_m2(cameras, mean.as_ref()?) })
            })
            .collect();
        let total = mean.map(|mean| Part {
            bias_m: off_m(mean.point_m),
            covariance_m2: by_source.iter().fold(DMat3::ZERO, |sum, cameras| sum + covariance_m2(cameras, &mean)),
        });
        let sampled = (!drawn.is_empty()).then(|| {
            let errors_m: Vec<DVec3> =
                drawn.iter().filter_map(|drawn| Some(off_m(met(believed, drawn)?.point_m))).collect();
            sampled(&errors_m, drawn.len())
        });
        let pixel_m = range_m * self.locator.scene.exposure.camera.mean_pitch();
        PixelBudget { place, pixel_m, sources, total, sampled }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_taken_evenly() {
        let of = |pixels, every| centres(pixels, every).collect::<Vec<f64>>();
        assert_eq!(of(3, 1), [0.5, 1.5, 2.5]);
        assert_eq!(of(7, 3), [1.5, 4.5, 6.5]);
        assert_eq!(of(2, 9), [1.5]);
        assert_eq!(of(2, 0), [0.5, 1.5]);
    }
}
