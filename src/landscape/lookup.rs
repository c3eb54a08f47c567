//! Which circles may hold a place.

use crate::geometry::whole;

/// Cells along a side of the square in which circles are looked up.
const CELLS: usize = 256;

/// Numbers of circles by the cells of a square about the origin that they reach, in the order in which they came.
#[derive(Debug, Clone)]
pub(super) struct Lookup {
    half_m: f64,
    cells: Vec<Vec<u32>>,
}

impl Lookup {
    /// For places within this distance of the origin, east, north, west and south.
    pub(super) fn new(half_m: f64) -> Self {
        Lookup { half_m, cells: vec![Vec::new(); CELLS * CELLS] }
    }

    /// Cells from a coordinate; may lie outside.
    fn place(&self, x_m: f64) -> f64 {
        (x_m / self.half_m + 1.0) * (0.5 * CELLS as f64)
    }

    pub(super) fn insert(&mut self, [x_m, y_m]: [f64; 2], radius_m: f64, number: u32) {
        let range = |centre_m: f64| {
            let (from, to) = (self.place(centre_m - radius_m).floor(), self.place(centre_m + radius_m).floor());
            whole(from.max(0.0))..whole((to + 1.0).max(0.0)).min(CELLS)
        };
        let (columns, rows) = (range(x_m), range(y_m));
        for row in rows {
            for column in columns.clone() {
                self.cells[row * CELLS + column].push(number);
            }
        }
    }

    /// The circles that may hold a place; none if it is not in the square.
    pub(super) fn at(&self, x_m: f64, y_m: f64) -> Option<&[u32]> {
        if x_m.abs() > self.half_m || y_m.abs() > self.half_m {
            return None;
        }
        let cell = |x_m: f64| whole(self.place(x_m)).min(CELLS - 1);
        Some(&self.cells[cell(y_m) * CELLS + cell(x_m)])
    }
}
