//! One pass over an image, its lines in parallel.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::detector::{Detector, PixelLine};
use super::pixel::Pixel;
use crate::error::Result;
use crate::progress::{Pulse, Watch, tell};
use crate::visibility::{Coverage, Drawing, Scratch};

/// A line of the image that is looked at.
pub(super) struct Line<'l, 's> {
    coverage: &'l Coverage<'l>,
    scratch: &'l mut Scratch<'s>,
    samples: u32,
    /// Its pixels, and the rows of cells in which they lie.
    pub(super) pixels: PixelLine<'l>,
}

impl Line<'_, '_> {
    /// Looks through each pixel, again for its pieces if those are needed, and hands it on.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if the sweep is asked to stop.
    pub(super) fn each(
        &mut self,
        pixel: &mut Pixel,
        needs_pieces: impl Fn(&Pixel) -> bool,
        mut gather: impl FnMut(&mut Pixel),
    ) -> Result<()> {
        pixel.new_line(self.pixels.rows);
        for sample in 0..self.samples {
            pixel.look(self.coverage, self.pixels.site(sample), self.scratch)?;
            let are_kept = pixel.pieces.are_kept;
            if !are_kept && needs_pieces(pixel) {
                pixel.pieces.are_kept = true;
                pixel.look(self.coverage, self.pixels.site(sample), self.scratch)?;
            }
            gather(pixel);
            pixel.pieces.are_kept = are_kept;
        }
        Ok(())
    }
}

/// What `look` makes of each line, in their order; `parts` are one for each line, and each thread has a state of its own.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub(super) fn sweep<S, P: Send, L: Send>(
    (drawing, detector): (&Drawing, &Detector),
    parts: Vec<P>,
    (stage, watch): (&'static str, Watch<'_>),
    start: impl Fn() -> S + Sync + Send,
    look: impl Fn(&mut S, &mut Line, P) -> Result<L> + Sync + Send,
) -> Result<Vec<L>> {
    let coverage = Coverage::new(drawing);
    let [samples, lines] = detector.size;
    let (done, total) = (AtomicU64::new(0), u64::from(lines));
    let pulse = || Pulse::new(watch, stage, &done, total);
    parts
        .into_par_iter()
        .zip(0..lines)
        .map_init(
            || (Scratch::new(pulse()), start()),
            |(scratch, state), (part, line)| {
                let mut line = Line { coverage: &coverage, scratch, samples, pixels: detector.line(line) };
                let made = look(state, &mut line, part)?;
                tell(watch, stage, done.fetch_add(1, Relaxed) + 1, total)?;
                Ok(made)
            },
        )
        .collect()
}
