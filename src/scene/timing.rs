//! Readout timing: what a sensor takes at once, and what one after another.

use std::ops::Range;

use super::{Exposure, Mirror};
use crate::geometry::Pose;

/// What a sensor takes at once.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Readout {
    /// All of the image.
    #[default]
    Frame,
    /// An image in one band, as through a tunable filter.
    Band,
    /// A line in all bands: a push-broom.
    Line,
    /// A sample of one line, or of a few, in all bands: a whisk-broom.
    Sample(Mirror),
}

impl Readout {
    /// Whether lines of the image differ in time.
    pub fn is_along_the_way(self) -> bool {
        matches!(self, Readout::Line | Readout::Sample(_))
    }
}

/// Most poses of an exposure that a scene may state.
const MOST_POSES: f64 = 1000.0;

/// Readout timing of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Timing {
    /// What it takes at once.
    pub readout: Readout,
    /// Period from one exposure to the next, s; for a whisk-broom from sweep to sweep.
    pub period_s: f64,
    /// Exposure time, s.
    pub exposure_s: f64,
    /// Camera poses that sample its motion during the exposure, at even steps: 1 is the middle alone. 0, which counts as
    /// 1, leaves the number to a plan.
    pub poses: u32,
}

/// A part of a cube that is taken at once.
#[derive(Debug, Clone, PartialEq)]
pub struct Take {
    /// The middle of its exposure, s after the start.
    pub middle_s: f64,
    /// Its samples in the cube.
    pub samples: Range<usize>,
    /// Its lines in the cube.
    pub lines: Range<usize>,
    /// Its bands in the cube.
    pub bands: Range<usize>,
    /// Scan angle in the middle of its exposure, rad, and its rate, rad/s.
    pub mirror: Option<(f64, f64)>,
    /// Whether it is a line of a push-broom, even if there is only one.
    pub is_slit: bool,
}

impl Timing {
    /// Whether an image has more than one exposure.
    pub fn is_in_parts(&self) -> bool {
        self.readout != Readout::Frame || self.poses > 1
    }

    /// Number of parts.
    pub fn count(&self, exposure: &Exposure) -> usize {
        match self.readout {
            Readout::Frame => 1,
            Readout::Band => exposure.bands.len(),
            Readout::Line => exposure.camera.lines as usize,
            Readout::Sample(mirror) => {
                mirror.samples as usize * (exposure.camera.lines / mirror.elements.max(1)) as usize
            }
        }
    }

    /// The parts of a cube, in order of time.
    pub fn takes(&self, exposure: &Exposure) -> impl Iterator<Item = Take> + use<> {
        let (timing, all_lines, all_bands) = (*self, 0..exposure.camera.lines as usize, 0..exposure.bands.len());
        let all_samples = 0..exposure.camera.samples as usize;
        (0..self.count(exposure)).map(move |i| {
            let mut mirror = None;
            let mut samples = all_samples.clone();
            let (lines, bands) = match timing.readout {
                Readout::Frame => (all_lines.clone(), all_bands.clone()),
                Readout::Band => (all_lines.clone(), i..i + 1),
                Readout::Line => (i..i + 1, all_bands.clone()),
                Readout::Sample(of) => {
                    let (sweep, sample) = of.place(i);
                    samples = sample..sample + 1;
                    mirror = Some((of.angle_rad(sample as f64 + 0.5), of.step_rad / of.sample_s));
                    let lines = of.elements as usize;
                    (sweep * lines..(sweep + 1) * lines, all_bands.clone())
                }
            };
            let is_slit = timing.readout == Readout::Line;
            Take { middle_s: timing.middle_s(i), samples, lines, bands, mirror, is_slit }
        })
    }

    /// The reference exposure, to which an image's account refers: the middle one.
    pub fn reference(&self, exposure: &Exposure) -> usize {
        self.count(exposure) / 2
    }

    /// The middle of an exposure, s after the start of the first.
    #[allow(clippy::cast_precision_loss, reason = "fewer than 2^53 exposures")]
    pub fn middle_s(&self, i: usize) -> f64 {
        let Readout::Sample(of) = self.readout else { return i as f64 * self.period_s + 0.5 * self.exposure_s };
        let (sweep, sample) = of.place(i);
        sweep as f64 * self.period_s + of.since_s(sample as f64 + 0.5) + 0.5 * self.exposure_s
    }

    /// Times of a part's poses, s after the start: the middles of equal shares of its exposure.
    pub fn poses_s(&self, take: &Take) -> impl Iterator<Item = f64> + use<> {
        let (count, middle_s, exposure_s) = (self.poses.max(1), take.middle_s, self.exposure_s);
        (0..count).map(move |k| middle_s + exposure_s * ((f64::from(k) + 0.5) / f64::from(count) - 0.5))
    }

    /// Smear error bound, relative to the brightest radiance, for a motion of `d` pixels during the exposure: d / (8
    /// n^2) at a straight edge with n poses, d with one.
    pub fn smear_error(&self, moved_px: f64) -> f64 {
        let poses = f64::from(self.poses.max(1));
        if poses > 1.0 { moved_px / (8.0 * poses * poses) } else { moved_px }.min(1.0)
    }

    /// Number of poses that keeps this error within a tolerance; no more than a scene may state.
    pub fn poses_for(moved_px: f64, tolerance: f64) -> f64 {
        (moved_px / (8.0 * tolerance)).sqrt().ceil().clamp(2.0, MOST_POSES)
    }

    /// Duration from the start of the first exposure to the end of the last, s.
    pub fn duration_s(&self, exposure: &Exposure) -> f64 {
        self.middle_s(self.count(exposure).saturating_sub(1)) + 0.5 * self.exposure_s
    }
}

impl Take {
    /// The optical pose, from the sensor's pose at a time, s after the start.
    pub fn pose(&self, sensor: Pose, s: f64) -> Pose {
        let Some((middle_rad, rad_s)) = self.mirror else { return sensor };
        Mirror::turned(sensor, middle_rad + rad_s * (s - self.middle_s))
    }

    /// The lines and samples that one exposure takes: all for a frame camera or filter; the slit, at the boresight, for
    /// a push-broom; its column, centred on the boresight, for a whisk-broom.
    pub fn exposure(&self, all: &Exposure) -> Exposure {
        let mut exposure = Exposure { bands: all.bands[self.bands.clone()].to_vec(), ..all.clone() };
        if self.mirror.is_some() {
            let elements = u32::try_from(self.lines.len()).unwrap_or(u32::MAX);
            (exposure.camera.samples, exposure.camera.lines) = (1, elements);
            exposure.camera.boresight_px = [0.5, 0.5 * f64::from(elements)];
        } else if self.is_slit {
            exposure.camera.lines = 1;
            exposure.camera.boresight_px[1] = 0.5;
        }
        exposure
    }
}
