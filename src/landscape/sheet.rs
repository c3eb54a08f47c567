//! The ground: heights on a regular grid, two triangles to a cell.

use glam::DVec3;
use rayon::prelude::*;

use super::crater::Crater;
use super::relief::Octave;
use super::{GROUND, STAGE, rounded_m};
use crate::error::Result;
use crate::geometry::cell::{self, cell_at, cut};
use crate::geometry::{Mesh, index_u32, whole};
use crate::progress::{Watch, tell};

/// Rows that are made together: they share one search for craters.
const BAND: usize = 16;

/// Bands between two progress reports.
const BANDS_AT_ONCE: usize = 8;

/// A square sheet of ground, centred.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    size_m: f64,
    /// Cells west to east and south to north; there is one grid point more each way.
    columns: usize,
    rows: usize,
    /// Heights of the grid points, row by row from the south-west corner, m, rounded as the mesh has them.
    heights_m: Vec<f64>,
}

impl Sheet {
    /// Sums relief and craters at each grid point.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
    pub(super) fn new(
        size_m: f64,
        columns: usize,
        rows: usize,
        octaves: &[Octave],
        craters: &[Crater],
        watch: Watch<'_>,
    ) -> Result<Self> {
        let width = columns + 1;
        let mut sheet = Sheet { size_m, columns, rows, heights_m: Vec::new() };
        let mut heights_m = vec![0.0; width * (rows + 1)];
        let points = heights_m.len();
        let block = width * BAND * BANDS_AT_ONCE;
        for (b, block_m) in heights_m.chunks_mut(block).enumerate() {
            tell(watch, STAGE, (b * block) as u64, points as u64)?;
            block_m
                .par_chunks_mut(width * BAND)
                .enumerate()
                .for_each(|(i, band_m)| sheet.fill(band_m, (b * BANDS_AT_ONCE + i) * BAND, octaves, craters));
        }
        sheet.heights_m = heights_m;
        Ok(sheet)
    }

    /// Grid points.
    pub(super) fn points(&self) -> usize {
        self.heights_m.len()
    }

    /// Makes the heights of whole rows, from row `first` on.
    fn fill(&self, heights_m: &mut [f64], first: usize, octaves: &[Octave], craters: &[Crater]) {
        let width = self.columns + 1;
        let rows = first..first + heights_m.len() / width;
        for (row_m, j) in heights_m.chunks_mut(width).zip(rows.clone()) {
            for (i, height_m) in row_m.iter_mut().enumerate() {
                let (x_m, y_m) = (self.x_m(i), self.y_m(j));
                *height_m = octaves.iter().map(|octave| octave.height_m(x_m, y_m)).sum();
            }
        }
        // Crater by crater and only where it reaches; each point still sums its craters in their order.
        for crater in craters {
            let reach_m = crater.reach_m();
            let reached = within(crater.y_m, reach_m, self.size_m, self.rows);
            for j in reached.start.max(rows.start)..reached.end.min(rows.end) {
                let dy_m = self.y_m(j) - crater.y_m;
                let half_chord_m = (reach_m * reach_m - dy_m * dy_m).max(0.0).sqrt();
                let row_m = &mut heights_m[(j - first) * width..][..width];
                for i in within(crater.x_m, half_chord_m, self.size_m, self.columns) {
                    let dx_m = self.x_m(i) - crater.x_m;
                    row_m[i] += crater.height_m(dx_m * dx_m + dy_m * dy_m);
                }
            }
        }
        for height_m in heights_m {
            *height_m = rounded_m(DVec3::splat(*height_m)).x;
        }
    }

    fn x_m(&self, column: usize) -> f64 {
        self.size_m * (column as f64 / self.columns as f64 - 0.5)
    }

    fn y_m(&self, row: usize) -> f64 {
        self.size_m * (row as f64 / self.rows as f64 - 0.5)
    }

    /// Heights of a cell's corners, counter-clockwise from the south-west, m.
    fn corners_m(&self, column: usize, row: usize) -> [f64; 4] {
        let south = row * (self.columns + 1) + column;
        let north = south + self.columns + 1;
        [south, south + 1, north + 1, north].map(|i| self.heights_m[i])
    }

    /// Height of the triangles at a place on the sheet, m.
    pub(super) fn height_m(&self, x_m: f64, y_m: f64) -> f64 {
        let place = |p_m: f64, cells: usize| {
            cell_at(((p_m / self.size_m + 0.5) * cells as f64).clamp(0.0, cells as f64), cells)
        };
        let ((i, u), (j, v)) = (place(x_m, self.columns), place(y_m, self.rows));
        cell::height_m(self.corners_m(i, j), u, v)
    }

    /// The sheet as a mesh, each cell cut by its shorter diagonal, facets counter-clockwise seen from above.
    pub(super) fn mesh(&self) -> Mesh {
        let width = self.columns + 1;
        let mut mesh = Mesh::default();
        mesh.vertices_m.reserve_exact(self.heights_m.len());
        mesh.facets.reserve_exact(2 * self.columns * self.rows);
        for (j, row_m) in self.heights_m.chunks(width).enumerate() {
            let y_m = self.y_m(j);
            mesh.vertices_m
                .extend(row_m.iter().enumerate().map(|(i, &z_m)| rounded_m(DVec3::new(self.x_m(i), y_m, z_m))));
        }
        for j in 0..self.rows {
            for i in 0..self.columns {
                let sw = index_u32(j * width + i);
                let nw = sw + index_u32(width);
                let (se, ne) = (sw + 1, nw + 1);
                mesh.facets.extend(cut([sw, se, ne, nw], self.corners_m(i, j)));
            }
        }
        mesh.material = vec![GROUND; mesh.facets.len()];
        mesh
    }
}

/// The grid points, of `cells` + 1 over a centred length, that lie within `reach_m` of a place (or one beyond).
fn within(centre_m: f64, reach_m: f64, length_m: f64, cells: usize) -> std::ops::Range<usize> {
    let point = |p_m: f64| (p_m / length_m + 0.5) * cells as f64;
    let first = whole(point(centre_m - reach_m));
    let last = whole(point(centre_m + reach_m).ceil());
    first.min(cells + 1)..(last + 1).min(cells + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landscape::{Recipe, crater, relief};

    fn sheet(columns: usize, rows: usize) -> Sheet {
        let recipe = Recipe::new(1);
        let octaves = relief::octaves(&recipe.relief, 1, 50.0);
        let craters: Vec<Crater> = crater::craters(&recipe.craters, 1, 300.0).take(300).collect();
        Sheet::new(300.0, columns, rows, &octaves, &craters, &|_| true).unwrap()
    }

    #[test]
    fn height_between_grid_points_is_that_of_the_facets() {
        let sheet = sheet(31, 29);
        let mesh = sheet.mesh();
        assert_eq!(mesh.facets.len(), 2 * 31 * 29);
        let mut rising = 0;
        for i in 0..mesh.facets.len() {
            for (u, v) in [(0.3, 0.3), (0.05, 0.05), (0.05, 0.9), (0.9, 0.05)] {
                let p = mesh.facet(i).point_m(u, v);
                // Coordinates are rounded to 1e-5 m, slopes are below 2.
                assert!((sheet.height_m(p.x, p.y) - p.z).abs() < 5e-5, "{p}");
            }
            let [_, b, c] = mesh.facets[i];
            rising += usize::from(i % 2 == 0 && c == b + 32);
        }
        // Of 899 cells, both diagonals are in use.
        assert!(rising > 100 && rising < 800, "{rising}");
    }

    #[test]
    fn each_cell_is_cut_by_its_shorter_diagonal() {
        let sheet = sheet(20, 20);
        let mesh = sheet.mesh();
        let mut seen = 0;
        for pair in mesh.facets.chunks(2) {
            let shared: Vec<u32> = pair[0].into_iter().filter(|v| pair[1].contains(v)).collect();
            let apart = pair.iter().map(|f| f.iter().find(|v| !shared.contains(v)).unwrap()).collect::<Vec<_>>();
            let length_m = |a: u32, b: u32| mesh.vertices_m[a as usize].distance(mesh.vertices_m[b as usize]);
            assert!(length_m(shared[0], shared[1]) <= length_m(*apart[0], *apart[1]) + 1e-5);
            seen += 1;
        }
        assert_eq!(seen, 400);
    }

    #[test]
    fn craters_are_summed_wherever_they_reach() {
        // The bands and chords of `fill` against all craters at all points.
        let sheet = sheet(40, 50);
        let recipe = Recipe::new(1);
        let octaves = relief::octaves(&recipe.relief, 1, 50.0);
        let craters: Vec<Crater> = crater::craters(&recipe.craters, 1, 300.0).take(300).collect();
        for (i, height_m) in sheet.heights_m.iter().enumerate() {
            let (x_m, y_m) = (sheet.x_m(i % 41), sheet.y_m(i / 41));
            let ground_m: f64 = octaves.iter().map(|octave| octave.height_m(x_m, y_m)).sum();
            let craters_m: f64 =
                craters.iter().map(|c| c.height_m((x_m - c.x_m).powi(2) + (y_m - c.y_m).powi(2))).sum();
            assert!((ground_m + craters_m - height_m).abs() < 0.6e-5);
        }
        assert_eq!(sheet.heights_m.len(), 41 * 51);
    }
}
