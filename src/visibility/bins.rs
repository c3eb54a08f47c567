//! Which triangles touch which cell.

use rayon::prelude::*;

use super::drawing::{Drawing, Grid};
use crate::geometry::polygon::Point;
use crate::geometry::{GroupSizes, Groups, whole_u32};

/// For every cell, row by row, the triangles that touch it, ascending: the lists of each stretch of triangles.
#[derive(Debug)]
pub(super) struct Bins(Vec<Groups<u32>>);

/// Triangles are sorted in this many stretches, whatever the number of threads.
const PIECES: usize = 4;
/// A triangle whose bounds hold more cells than this is traced row by row.
const TRACED_CELLS: u32 = 16;

impl Bins {
    pub(super) fn new(drawing: &Drawing) -> Self {
        let triangles = drawing.listed();
        let length = triangles.div_ceil(PIECES).max(1);
        let stretches: Vec<std::ops::Range<usize>> =
            (0..PIECES).map(|i| (i * length).min(triangles)..((i + 1) * length).min(triangles)).collect();
        Bins(stretches.into_par_iter().map(|range| sorted(drawing, range)).collect())
    }

    /// The triangles of a cell.
    pub(super) fn triangles(&self, cell: usize) -> impl Iterator<Item = u32> {
        self.0.iter().flat_map(move |stretch| stretch.of(cell)).copied()
    }

    /// Writes the triangles of a cell into `list`.
    pub(super) fn cell(&self, cell: usize, list: &mut Vec<u32>) {
        list.clear();
        for stretch in &self.0 {
            list.extend_from_slice(stretch.of(cell));
        }
    }
}

/// The lists of a stretch of triangles.
fn sorted(drawing: &Drawing, stretch: std::ops::Range<usize>) -> Groups<u32> {
    let mut sizes = GroupSizes::new(drawing.grid.columns as usize * drawing.grid.rows as usize);
    let triangles = || stretch.clone().map(|place| drawing.listed_at(place));
    triangles().for_each(|t| for_each_cell(drawing, t, |cell| sizes.count(cell)));
    let mut lists = sizes.into_groups();
    triangles().for_each(|t| for_each_cell(drawing, t, |cell| lists.put(cell, t)));
    lists
}

/// Columns or rows whose inside an extent touches; empty if it lies outside.
fn touched(lo: f64, hi: f64, count: u32) -> std::ops::Range<u32> {
    // By casts: floor and ceil would be library calls on plain x86-64.
    let first = whole_u32(lo).min(count);
    let below = whole_u32(hi);
    let last = (below + u32::from(f64::from(below) < hi)).min(count);
    first..last.max(first)
}

/// Calls `visit` with each cell that a triangle may touch, in ascending order.
fn for_each_cell(drawing: &Drawing, triangle: u32, mut visit: impl FnMut(usize)) {
    if !drawing.is_drawn(triangle) {
        return;
    }
    let corners = drawing.corners(triangle).map(|p| [p[0], p[1]]);
    for_each_cell_of(corners, drawing.grid, |row, columns| {
        let base = row as usize * drawing.grid.columns as usize;
        for column in columns {
            visit(base + column as usize);
        }
    });
}

/// Calls `visit` with each row and its columns that a triangle may touch, rows ascending.
pub fn for_each_cell_of(corners: [Point; 3], grid: Grid, mut visit: impl FnMut(u32, std::ops::Range<u32>)) {
    let [a, b, c] = corners;
    let columns = touched(a[0].min(b[0]).min(c[0]), a[0].max(b[0]).max(c[0]), grid.columns);
    let rows = touched(a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1]), grid.rows);
    if columns.is_empty() || rows.is_empty() {
        return;
    }
    if (columns.len() as u64) * (rows.len() as u64) <= u64::from(TRACED_CELLS) {
        rows.for_each(|row| visit(row, columns.clone()));
        return;
    }
    // Rounding of an interpolated x, with room to spare: a cell too many costs little, one too few is wrong.
    let slack = 1e-9 * (1.0 + corners.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs())));
    for row in rows {
        let (low, high) = (f64::from(row), f64::from(row) + 1.0);
        let (mut x0, mut x1) = (f64::INFINITY, f64::NEG_INFINITY);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let (p, q) = if p[1] <= q[1] { (p, q) } else { (q, p) };
            if q[1] < low || p[1] > high {
                continue;
            }
            for y in [low.max(p[1]), high.min(q[1])] {
                let t = if q[1] > p[1] { (y - p[1]) / (q[1] - p[1]) } else { 0.0 };
                let x = p[0] + t * (q[0] - p[0]);
                x0 = x0.min(x);
                x1 = x1.max(x);
            }
            // A level edge lies in the row with both its ends.
            if p[1] == q[1] {
                x0 = x0.min(q[0]);
                x1 = x1.max(q[0]);
            }
        }
        let inside = touched(x0 - slack, x1 + slack, grid.columns);
        visit(row, inside.start.max(columns.start)..inside.end.min(columns.end).max(inside.start.max(columns.start)));
    }
}
