//! What recipes name files for: rasters of heights and of shares, and meshes of bodies.

use std::collections::BTreeMap;

use crate::geometry::Mesh;

/// A raster that a recipe names, by lines from north to south. NaN: no data.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Columns, west to east.
    pub columns: usize,
    /// Lines, north to south.
    pub rows: usize,
    /// Values, line by line.
    pub values: Vec<f64>,
    /// Width and height of a pixel on the ground, m, if the file says it.
    pub pixel_m: Option<[f64; 2]>,
    /// The same, deg, if the file says that.
    pub pixel_deg: Option<[f64; 2]>,
    /// The largest value that the file's type holds, if that is a whole number of at most 16 bit; images are shares of it.
    pub full_scale: Option<f64>,
}

/// The files of a recipe, by the names that it has for them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sources {
    /// Rasters of heights and of shares.
    pub rasters: BTreeMap<String, Source>,
    /// Meshes of bodies, body axes, m.
    pub meshes: BTreeMap<String, Mesh>,
}

impl Source {
    /// The pixel nearest to a column and line.
    pub(super) fn at(&self, column: usize, row: usize) -> f64 {
        self.values[row.min(self.rows - 1) * self.columns + column.min(self.columns - 1)]
    }
}
