//! One pass over an image, its lines in parallel.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::pixel::Pixel;
use crate::error::Result;
use crate::progress::{Pulse, Watch, tell};
use crate::visibility::{Coverage, Drawing, Scratch};

/// A line of the image that is looked at.
pub(super) struct Line<'l, 's> {
    coverage: &'l Coverage<'l>,
    scratch: &'l mut Scratch<'s>,
    columns: u32,
    /// Which.
    pub(super) row: u32,
}

impl Line<'_, '_> {
    /// Looks through each pixel, and hands it on with its column.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if the sweep is asked to stop.
    pub(super) fn each(&mut self, pixel: &mut Pixel, mut gather: impl FnMut(&mut Pixel, u32)) -> Result<()> {
        pixel.new_line(self.row);
        for column in 0..self.columns {
            pixel.look(self.coverage, column, self.row, self.scratch)?;
            gather(pixel, column);
        }
        Ok(())
    }
}

/// What `look` makes of each line, in their order; `parts` are one for each line, and each thread has a state of its own.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub(super) fn sweep<S, P: Send, L: Send>(
    drawing: &Drawing,
    parts: Vec<P>,
    (stage, watch): (&'static str, Watch<'_>),
    start: impl Fn() -> S + Sync + Send,
    look: impl Fn(&mut S, &mut Line, P) -> Result<L> + Sync + Send,
) -> Result<Vec<L>> {
    let coverage = Coverage::new(drawing);
    let (done, total) = (AtomicU64::new(0), u64::from(drawing.grid.rows));
    let pulse = || Pulse::new(watch, stage, &done, total);
    parts
        .into_par_iter()
        .zip(0..drawing.grid.rows)
        .map_init(
            || (Scratch::new(pulse()), start()),
            |(scratch, state), (part, row)| {
                let mut line = Line { coverage: &coverage, scratch, columns: drawing.grid.columns, row };
                let made = look(state, &mut line, part)?;
                tell(watch, stage, done.fetch_add(1, Relaxed) + 1, total)?;
                Ok(made)
            },
        )
        .collect()
}
