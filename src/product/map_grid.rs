//! Grids of maps on a body, and which cells polygons of the ground fill.

use glam::{DMat3, DVec3};

use crate::geometry::latitude_longitude_deg;
use crate::geometry::polygon::{Point, Rect, area, clip_to_rect};
use crate::geometry::{index_u32, whole};

/// How a body is laid flat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Square onto the plane through a place, body-fixed, m, that touches the radius at a right angle there; map coordinates are east and north, m. Columns: east, north, up.
    Tangent {
        /// The place.
        origin_m: DVec3,
        /// Its axes.
        axes: DMat3,
    },
    /// Planetocentric longitude east and latitude, deg. Areas are those on a sphere, as seen from the body's centre.
    PlateCarree {
        /// Longitudes are within 180 deg of this one.
        middle_deg: f64,
    },
}

/// A grid of cells. Rows go from north to south, columns from west to east.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapGrid {
    /// How the body is laid flat.
    pub projection: Projection,
    /// Its western and northern borders, in map coordinates.
    pub west_north: [f64; 2],
    /// A cell's width and height, in map coordinates.
    pub cell: f64,
    /// Columns.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
}

/// What a pixel has in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellPart {
    /// The cell, row after row.
    pub cell: u32,
    /// The pixel's sample, from 0.
    pub sample: u32,
    /// Its line.
    pub line: u32,
    /// Area that they share: m^2 of a tangent plane, deg^2 at the equator of longitudes and latitudes.
    pub area: f64,
}

impl Projection {
    /// Where points, body-fixed, m, lie: map coordinates. Longitudes of one outline are those nearest to its first.
    pub fn at(&self, outline_m: impl Iterator<Item = DVec3>) -> Vec<Point> {
        match self {
            Projection::Tangent { origin_m, axes } => outline_m
                .map(|p| {
                    let local = axes.transpose() * (p - *origin_m);
                    [local.x, local.y]
                })
                .collect(),
            Projection::PlateCarree { middle_deg } => {
                let mut about_deg = *middle_deg;
                let mut is_first = true;
                outline_m
                    .map(|p| {
                        let [latitude_deg, longitude_deg] = latitude_longitude_deg(p);
                        let longitude_deg = longitude_deg + 360.0 * ((about_deg - longitude_deg) / 360.0).round();
                        if std::mem::take(&mut is_first) {
                            about_deg = longitude_deg;
                        }
                        [longitude_deg, latitude_deg]
                    })
                    .collect()
            }
        }
    }

    /// Map coordinates with areas as they are on the body: of latitudes the sine, in deg at the equator.
    fn equal_area(&self, [x, y]: Point) -> Point {
        match self {
            Projection::Tangent { .. } => [x, y],
            Projection::PlateCarree { .. } => [x, y.to_radians().sin().to_degrees()],
        }
    }
}

impl MapGrid {
    /// How many cells it has.
    pub fn cells(&self) -> usize {
        self.columns * self.rows
    }

    /// A cell in coordinates with areas as they are on the body.
    fn rect(&self, column: usize, row: usize) -> Rect {
        let [west, north] = self.west_north;
        let [x0, x1] = [column, column + 1].map(|i| west + i as f64 * self.cell);
        let [y1, y0] = [row, row + 1].map(|i| north - i as f64 * self.cell);
        let (min, max) = (self.projection.equal_area([x0, y0]), self.projection.equal_area([x1, y1]));
        Rect { min, max }
    }

    /// The area of a cell, as that of its [parts](CellPart).
    pub fn cell_area(&self, cell: usize) -> f64 {
        self.rect(cell % self.columns, cell / self.columns).area()
    }

    /// Hands out the cells that an outline, map coordinates, fills in part, and the areas.
    pub fn fill(&self, outline: &[Point], mut put: impl FnMut(u32, f64)) {
        let bounds = Rect::of(outline);
        let [west, north] = self.west_north;
        // A whole turn further on is the same place.
        let turns: &[f64] = match self.projection {
            Projection::Tangent { .. } => &[0.0],
            Projection::PlateCarree { .. } => &[-360.0, 0.0, 360.0],
        };
        for turn in turns {
            let range = |from: f64, to: f64, most: usize| {
                let cell = |x: f64| whole((x / self.cell).clamp(0.0, most as f64));
                cell(from)..(cell(to) + 1).min(most)
            };
            let (low, high) = (bounds.min[0] + turn - west, bounds.max[0] + turn - west);
            if high <= 0.0 || low >= self.columns as f64 * self.cell {
                continue;
            }
            let flat: Vec<Point> = outline.iter().map(|[x, y]| self.projection.equal_area([x + turn, *y])).collect();
            let (mut cut, mut spare) = (Vec::new(), Vec::new());
            for row in range(north - bounds.max[1], north - bounds.min[1], self.rows) {
                for column in range(low, high, self.columns) {
                    clip_to_rect(&flat, &self.rect(column, row), &mut cut, &mut spare);
                    let filled = area(&cut).abs();
                    if filled > 0.0 {
                        put(index_u32(row * self.columns + column), filled);
                    }
                }
            }
        }
    }

    /// The value of each cell: the mean of the pixels' that are in it, by area; NaN where there is none. `values` are line by line.
    pub fn means(&self, parts: &[CellPart], values: &[f64], samples: usize) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.cells()];
        for part in parts {
            let value = values.get(part.line as usize * samples + part.sample as usize).copied().unwrap_or(f64::NAN);
            if let (Some(sum), true) = (sums.get_mut(part.cell as usize), value.is_finite()) {
                *sum = (sum.0 + part.area * value, sum.1 + part.area);
            }
        }
        sums.into_iter().map(|(sum, area)| if area > 0.0 { sum / area } else { f64::NAN }).collect()
    }

    /// What each part counts in the mean of its cell: those of a cell add up to 1.
    pub fn weights(&self, parts: &[CellPart]) -> Vec<f64> {
        let mut sums = vec![0.0; self.cells()];
        for part in parts {
            if let Some(sum) = sums.get_mut(part.cell as usize) {
                *sum += part.area;
            }
        }
        parts.iter().map(|part| part.area / sums.get(part.cell as usize).copied().unwrap_or(f64::NAN)).collect()
    }

    /// The share of each cell that is seen: above 1 where ground lies over ground.
    pub fn coverage(&self, parts: &[CellPart]) -> Vec<f64> {
        let mut shares = vec![0.0; self.cells()];
        for part in parts {
            if let Some(share) = shares.get_mut(part.cell as usize) {
                *share += part.area / self.cell_area(part.cell as usize);
            }
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction_of_deg;
    use std::f64::consts::PI;

    #[test]
    fn a_square_fills_its_cells() {
        let projection = Projection::Tangent { origin_m: DVec3::ZERO, axes: DMat3::IDENTITY };
        let grid = MapGrid { projection, west_north: [0.0, 2.0], cell: 1.0, columns: 2, rows: 2 };
        let fill = |outline: &[Point]| {
            let mut cells = [0.0; 4];
            grid.fill(outline, |cell, area| cells[cell as usize] += area);
            cells
        };
        // From (0.5, 0.5) to (2.5, 1.5): a quarter of the cells to the left, half of those to the right.
        assert_eq!(fill(&[[0.5, 0.5], [2.5, 0.5], [2.5, 1.5], [0.5, 1.5]]), [0.25, 0.5, 0.25, 0.5]);
        assert_eq!(fill(&[[5.0, 0.0], [6.0, 0.0], [6.0, 1.0]]), [0.0; 4]);
        assert_eq!(fill(&[]), [0.0; 4]);
    }

    /// A zone of a sphere has the area of its height: a belt between 30 deg south and north is half of it, over the seam too.
    #[test]
    fn areas_of_longitudes_and_latitudes_are_those_of_a_sphere() {
        let projection = Projection::PlateCarree { middle_deg: 170.0 };
        let grid = MapGrid { projection, west_north: [-10.0, 90.0], cell: 30.0, columns: 12, rows: 6 };
        let all: f64 = (0..grid.cells()).map(|cell| grid.cell_area(cell)).sum();
        // 4 pi sr, in deg^2 at the equator.
        assert!((all / (4.0 * PI * (180.0 / PI).powi(2)) - 1.0).abs() < 1e-12);
        let mut belt = 0.0;
        for i in 0..36 {
            let [a, b] = [i, i + 1].map(|i| 10.0 * f64::from(i) - 180.0);
            let corner = |longitude: f64, latitude: f64| direction_of_deg([latitude, longitude]);
            let outline = [corner(a, -30.0), corner(b, -30.0), corner(b, 30.0), corner(a, 30.0)];
            grid.fill(&projection.at(outline.into_iter()), |_, area| belt += area);
        }
        assert!((belt / all - 0.5).abs() < 1e-12, "{}", belt / all);
    }
}
