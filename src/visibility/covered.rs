//! How much of each cell of a drawing shows the mesh.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use super::{Coverage, Drawing, Scratch, Side, Visit};
use crate::error::Result;
use crate::geometry::polygon::{Point, Rect, area, clip_to_rect};
use crate::progress::{Pulse, Watch, tell};

/// For each cell, row by row, what `of` makes of the share of it that shows outer sides and the share that shows inner ones: exact.
/// `stage` is the name reported to `watch`.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn covered(
    drawing: &Drawing,
    stage: &'static str,
    of: impl Fn([f64; 2]) -> f64 + Sync,
    watch: Watch<'_>,
) -> Result<Vec<f64>> {
    let coverage = Coverage::new(drawing);
    let total = u64::from(drawing.grid.rows);
    let done = AtomicU64::new(0);
    let pulse = || Pulse::new(watch, stage, &done, total);
    let rows: Result<Vec<Vec<f64>>> = (0..drawing.grid.rows)
        .into_par_iter()
        .map_init(
            || (Scratch::new(pulse()), CellShares { drawing, shares: [0.0; 2], clipped: vec![], spare: vec![] }),
            |(scratch, shown), row| {
                let of_cell = |column| {
                    shown.shares = [0.0; 2];
                    coverage.cell(column, row, scratch, shown)?;
                    Ok(of(shown.shares.map(|share| share.clamp(0.0, 1.0))))
                };
                let cells: Result<Vec<f64>> = (0..drawing.grid.columns).map(of_cell).collect();
                tell(watch, stage, done.fetch_add(1, Relaxed) + 1, total)?;
                cells
            },
        )
        .collect();
    Ok(rows?.concat())
}

/// Adds up what a cell shows of outer and of inner sides.
struct CellShares<'a> {
    drawing: &'a Drawing<'a>,
    shares: [f64; 2],
    clipped: Vec<Point>,
    spare: Vec<Point>,
}

impl CellShares<'_> {
    fn add(&mut self, triangle: u32, area: f64) {
        match self.drawing.side(triangle) {
            Side::Front => self.shares[0] += area,
            Side::Back => self.shares[1] += area,
            Side::Edge => {}
        }
    }
}

impl Visit for CellShares<'_> {
    fn whole(&mut self, triangle: u32, rect: &Rect) {
        let outline = self.drawing.outline(triangle);
        let shown = if rect.contains(&Rect::of(&outline)) {
            area(&outline)
        } else {
            clip_to_rect(&outline, rect, &mut self.clipped, &mut self.spare);
            area(&self.clipped)
        };
        self.add(triangle, shown);
    }

    const SIGNED: bool = true;

    fn hidden(&mut self, triangle: u32, _: &Rect, polygon: &[Point]) {
        self.add(triangle, -area(polygon));
    }

    fn cut(&mut self, _: u32, _: &Rect) {}

    fn piece(&mut self, triangle: u32, _: &Rect, polygon: &[Point]) {
        self.add(triangle, area(polygon));
    }
}
