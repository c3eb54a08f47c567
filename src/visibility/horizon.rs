//! How high the horizons of a site are at most: from no point of a facet does anything rise higher.

use glam::DVec3;
use rayon::prelude::*;

use super::topology::NONE;
use super::{Seen, Shown, Topology};
use crate::error::Result;
use crate::geometry::polygon::Point;
use crate::geometry::{Direction, Mesh, hull, whole};
use crate::progress::Watch;

/// Mean number of facets in a cell.
const FACETS_PER_CELL: f64 = 4.0;
/// Cells along a side at most.
const MOST_SIDE: f64 = 2048.0;
/// Facets may touch this many cells each, on average: of large facets on top of each other nothing is found out.
const CELLS_PER_FACET: usize = 64;
/// Cells to either side of one that are near it: how far they are, their boxes do not tell.
const NEAR: usize = 2;
/// Of places, cells: their rounding, with room to spare.
const ROUNDING: f64 = 1e-6;
/// By how much a way across a notch of the rim may be steeper than facets beside it.
const ACROSS_A_NOTCH: f64 = 2.0;

/// Of each facet a bound of the tangent of its horizon's elevation, above the plane across `up`; infinite where nothing is known.
///
/// What is near rises no steeper than the steepest facet on the way, where all are a height field: wholly seen from above, and
/// without gaps but at the mesh's own rim. What is far rises no more than the cells of a grid do, which are the larger the farther they are.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn highest_horizons(mesh: &Mesh, topology: &Topology, up: Direction, watch: Watch<'_>) -> Result<Vec<f64>> {
    let from_above = Seen::from_afar(mesh, topology, up, "plan", watch)?;
    let plan = Plan::of(mesh, topology, up);
    let Some(finest) = plan.finest(&from_above) else { return Ok(vec![f64::INFINITY; mesh.facets.len()]) };
    let mut levels = vec![finest];
    while let Some(coarser) = levels.last().filter(|level| level.side > 1).map(Level::coarser) {
        levels.push(coarser);
    }
    levels[0].look_near();
    for far in 0..levels.len() {
        // From cells smaller than those that are looked at: their lowest points are less far below the others.
        let from = far.saturating_sub(2);
        let tangents = levels[from].tangents_to(from, &levels[far], far);
        levels[from].rise(tangents.into_iter());
    }
    for level in (1..levels.len()).rev() {
        let (finer, coarser) = levels.split_at_mut(level);
        let of_parents = finer[level - 1].parents(&coarser[0]).map(|cell| cell.tangent);
        finer[level - 1].rise(of_parents.collect::<Vec<_>>().into_iter());
    }
    let cells = &levels[0].cells;
    let of_facet = |facet: &[u32; 3]| {
        let mut tangent = 0.0_f64;
        plan.cells(facet, |cell| tangent = tangent.max(cells[cell].tangent));
        tangent
    };
    Ok(mesh.facets.par_iter().map(of_facet).collect())
}

/// A mesh as a map.
struct Plan<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    up: Direction,
    /// Of each vertex its place, cells, and its height, m.
    at: Vec<[f64; 3]>,
    cell_m: f64,
    /// Cells along a side: a power of 2.
    side: usize,
    /// Around all, counter-clockwise, cells.
    outline: Vec<Point>,
}

/// What is over a square.
#[derive(Clone, Copy)]
struct Cell {
    low_m: f64,
    high_m: f64,
    /// Of the steepest slope; then of the horizon.
    tangent: f64,
}

const EMPTY: Cell = Cell { low_m: f64::INFINITY, high_m: f64::NEG_INFINITY, tangent: 0.0 };

/// Squares of one size, row by row.
struct Level {
    cells: Vec<Cell>,
    side: usize,
    cell_m: f64,
}

impl<'a> Plan<'a> {
    fn of(mesh: &'a Mesh, topology: &'a Topology, up: Direction) -> Self {
        let (h, v) = up.frame();
        let mut at: Vec<[f64; 3]> = mesh.vertices_m.iter().map(|p| [p.dot(h), p.dot(v), p.dot(up.vec())]).collect();
        let used = || mesh.facets.iter().flatten().map(|vertex| *vertex as usize);
        let low = [0, 1].map(|k| used().map(|i| at[i][k]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|k| used().map(|i| at[i][k]).fold(f64::NEG_INFINITY, f64::max));
        let extent_m = (high[0] - low[0]).max(high[1] - low[1]).max(f64::MIN_POSITIVE);
        let most = (mesh.facets.len() as f64 / FACETS_PER_CELL).sqrt().min(MOST_SIDE);
        let mut side = 1;
        while (side as f64) < most {
            side *= 2;
        }
        let cell_m = extent_m / side as f64;
        for p in &mut at {
            // Not beyond the last cell, by rounding.
            (p[0], p[1]) = (((p[0] - low[0]) / cell_m).min(side as f64), ((p[1] - low[1]) / cell_m).min(side as f64));
        }
        let mut plan = Plan { mesh, topology, up, at, cell_m, side, outline: vec![] };
        let rim = (0..mesh.facets.len()).flat_map(|facet| plan.open_edges(facet)).flatten().collect();
        plan.outline = hull(rim);
        plan
    }

    fn place(&self, vertex: u32) -> Point {
        let [x, y, _] = self.at[vertex as usize];
        [x, y]
    }

    /// The edges of a facet beyond which there is no other.
    fn open_edges(&self, facet: usize) -> impl Iterator<Item = [Point; 2]> {
        let corners = self.mesh.facets[facet].map(|vertex| self.place(vertex));
        let is_open = move |k: &usize| self.topology.neighbour[facet][*k] == NONE;
        (0..3).filter(is_open).map(move |k| [corners[k], corners[(k + 1) % 3]])
    }

    /// Rows and columns of the cells that a facet may touch.
    fn reach(&self, facet: &[u32; 3]) -> [std::ops::RangeInclusive<usize>; 2] {
        [1, 0].map(|k| {
            let of = facet.map(|vertex| self.at[vertex as usize][k]);
            // On a line between two cells it touches both, to rounding.
            let [low, high] = [of[0].min(of[1]).min(of[2]) - ROUNDING, of[0].max(of[1]).max(of[2]) + ROUNDING];
            whole(low).min(self.side - 1)..=whole(high).min(self.side - 1)
        })
    }

    fn cells(&self, facet: &[u32; 3], mut visit: impl FnMut(usize)) {
        let [rows, columns] = self.reach(facet);
        rows.for_each(|row| columns.clone().for_each(|column| visit(row * self.side + column)));
    }

    /// Heights and slopes; `None` if facets touch too many cells.
    fn finest(&self, from_above: &Seen) -> Option<Level> {
        let (facets, mut cells) = (self.mesh.facets.len(), 0);
        for facet in &self.mesh.facets {
            cells += self.reach(facet).map(|range| range.end() - range.start() + 1).iter().product::<usize>();
            if cells > CELLS_PER_FACET * facets + self.side * self.side {
                return None;
            }
        }
        let mut level = Level { cells: vec![EMPTY; self.side * self.side], side: self.side, cell_m: self.cell_m };
        for (i, facet) in self.mesh.facets.iter().enumerate() {
            let heights_m = facet.map(|vertex| self.at[vertex as usize][2]);
            let low_m = heights_m.iter().copied().fold(f64::INFINITY, f64::min);
            let high_m = heights_m.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let is_whole = from_above.shown[i] == Shown::Whole;
            let tangent = if is_whole { self.steepest(i) } else { self.hidden_slope(i) };
            self.cells(facet, |cell| {
                let cell = &mut level.cells[cell];
                cell.low_m = cell.low_m.min(low_m);
                cell.high_m = cell.high_m.max(high_m);
                cell.tangent = cell.tangent.max(tangent);
            });
        }
        Some(level)
    }

    /// Tangent of the slope of a facet that is seen from above, or of a way across a gap beside it.
    fn steepest(&self, facet: usize) -> f64 {
        let cross_m2 = self.mesh.facet(facet).cross_m2();
        let rise_m2 = cross_m2.dot(self.up.vec());
        let slope = (cross_m2 - rise_m2 * self.up.vec()).length() / rise_m2;
        self.open_edges(facet)
            .map(|edge| if self.is_rim(edge) { ACROSS_A_NOTCH * slope } else { f64::INFINITY })
            .fold(slope, f64::max)
    }

    /// Infinite, but for what has no area: nothing is behind it.
    fn hidden_slope(&self, facet: usize) -> f64 {
        if self.mesh.facet(facet).cross_m2() == DVec3::ZERO { 0.0 } else { f64::INFINITY }
    }

    /// Whether an edge is part of the mesh's own rim: it goes along the outline where that is nearest, within 60 deg. Ways between points of such a rim
    /// that leave the mesh are half as long as the rim between them, or longer.
    fn is_rim(&self, [a, b]: [Point; 2]) -> bool {
        let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
        let sides = (0..self.outline.len()).map(|i| [self.outline[i], self.outline[(i + 1) % self.outline.len()]]);
        let nearest = sides.min_by(|s, t| distance(middle, *s).total_cmp(&distance(middle, *t)));
        nearest.is_some_and(|[p, q]| {
            let (along, edge) = ([q[0] - p[0], q[1] - p[1]], [b[0] - a[0], b[1] - a[1]]);
            along[0] * edge[0] + along[1] * edge[1] >= 0.5 * along[0].hypot(along[1]) * edge[0].hypot(edge[1])
        })
    }
}

/// Of a point from a segment.
fn distance(p: Point, [a, b]: [Point; 2]) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let along = ((d[0] * e[0] + d[1] * e[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    (e[0] - along * d[0]).hypot(e[1] - along * d[1])
}

impl Level {
    /// The steepest of all cells near each.
    fn look_near(&mut self) {
        for by_row in [true, false] {
            let at =
                |line: usize, place: usize| if by_row { line * self.side + place } else { place * self.side + line };
            let most = |line: usize, place: usize| {
                let near = place.saturating_sub(NEAR)..(place + NEAR + 1).min(self.side);
                near.map(|place| self.cells[at(line, place)].tangent).fold(0.0, f64::max)
            };
            let tangents: Vec<f64> = (0..self.side * self.side)
                .into_par_iter()
                .map(|cell| {
                    let (row, column) = (cell / self.side, cell % self.side);
                    if by_row { most(row, column) } else { most(column, row) }
                })
                .collect();
            self.cells.iter_mut().zip(tangents).for_each(|(cell, tangent)| cell.tangent = tangent);
        }
    }

    /// The next one: four cells are one.
    fn coarser(&self) -> Level {
        let side = self.side / 2;
        let mut level = Level { cells: vec![EMPTY; side * side], side, cell_m: 2.0 * self.cell_m };
        for (i, cell) in self.cells.iter().enumerate() {
            let of = &mut level.cells[self.parent(i)];
            of.low_m = of.low_m.min(cell.low_m);
            of.high_m = of.high_m.max(cell.high_m);
        }
        level
    }

    /// The place of a cell in the next level.
    fn parent(&self, cell: usize) -> usize {
        (cell / self.side / 2) * (self.side / 2) + cell % self.side / 2
    }

    /// Tangents of what is in cells of the level `far` that are not near, but in larger cells are: of each cell of this level.
    fn tangents_to(&self, from: usize, far: &Level, level: usize) -> Vec<f64> {
        let size = 1_usize << (level - from);
        let tangent = |cell: usize| {
            let Cell { low_m, .. } = self.cells[cell];
            let (row, column) = (cell / self.side, cell % self.side);
            let mut tangent = 0.0_f64;
            if low_m.is_finite() {
                for_far_cells([row / size, column / size], far.side, |at| {
                    let high_m = far.cells[at[0] * far.side + at[1]].high_m;
                    if high_m > low_m {
                        let [y, x] = [0, 1].map(|k| gap([row, column][k], at[k] * size, size) as f64 * self.cell_m);
                        tangent = tangent.max((high_m - low_m) / x.hypot(y));
                    }
                });
            }
            tangent
        };
        (0..self.cells.len()).into_par_iter().map(tangent).collect()
    }

    /// Raises cells to these tangents, each at least.
    fn rise(&mut self, tangents: impl Iterator<Item = f64>) {
        self.cells.iter_mut().zip(tangents).for_each(|(cell, tangent)| cell.tangent = cell.tangent.max(tangent));
    }

    fn parents<'a>(&'a self, coarser: &'a Level) -> impl Iterator<Item = &'a Cell> {
        (0..self.cells.len()).map(|cell| &coarser.cells[self.parent(cell)])
    }
}

/// Cells between one and the nearest of `size` from `first` on.
fn gap(cell: usize, first: usize, size: usize) -> usize {
    first.saturating_sub(cell + 1).max(cell.saturating_sub(first + size - 1).saturating_sub(1))
}

/// Each cell that is not near this one, while the cell twice as large that it is in is near the one that this is in.
fn for_far_cells(at: [usize; 2], side: usize, mut visit: impl FnMut([usize; 2])) {
    let around = |place: usize, near: usize| place.saturating_sub(near)..(place + near + 1).min(side);
    let parents = at.map(|place| 2 * (place / 2).saturating_sub(NEAR)..(2 * (place / 2 + NEAR + 1)).min(side));
    let near = at.map(|place| around(place, NEAR));
    for row in parents[0].clone() {
        for column in parents[1].clone() {
            if !(near[0].contains(&row) && near[1].contains(&column)) {
                visit([row, column]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{MaterialId, index_u32};
    use crate::progress::unwatched;

    /// A sheet of n x n cells of 1 m.
    fn sheet(n: u32, height_m: impl Fn(f64, f64) -> f64) -> Mesh {
        let mut mesh = Mesh::default();
        for j in 0..=n {
            for i in 0..=n {
                let (x, y) = (f64::from(i), f64::from(j));
                mesh.vertices_m.push(DVec3::new(x, y, height_m(x, y)));
            }
        }
        let row = n + 1;
        for a in (0..n).flat_map(|j| (0..n).map(move |i| j * row + i)) {
            mesh.facets.extend([[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]);
        }
        mesh.material = vec![MaterialId(0); mesh.facets.len()];
        mesh
    }

    fn with(mut mesh: Mesh, other: &Mesh) -> Mesh {
        let first = index_u32(mesh.vertices_m.len());
        mesh.vertices_m.extend(&other.vertices_m);
        mesh.facets.extend(other.facets.iter().map(|facet| facet.map(|vertex| vertex + first)));
        mesh.material.extend(&other.material);
        mesh
    }

    fn moved(mut mesh: Mesh, by_m: [f64; 3], scale: f64) -> Mesh {
        mesh.vertices_m.iter_mut().for_each(|p| *p = scale * *p + DVec3::from_array(by_m));
        mesh
    }

    fn horizons(mesh: &Mesh, up: DVec3) -> Vec<f64> {
        highest_horizons(mesh, &Topology::new(mesh), Direction::new(up).unwrap(), &unwatched).unwrap()
    }

    /// From points of each facet to those of all others, tangents of the elevation: by brute force.
    fn truth(mesh: &Mesh, up: DVec3) -> Vec<f64> {
        let places = |facet: usize| {
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 0.4], [0.5, 0.5]].map(|[u, v]| mesh.facet(facet).point_m(u, v))
        };
        let points: Vec<DVec3> = (0..mesh.facets.len()).flat_map(places).collect();
        let highest = |facet: usize| {
            let tangents = places(facet).into_iter().flat_map(|p| {
                points.iter().map(move |q| {
                    let rise_m = (*q - p).dot(up);
                    // Where facets meet, their points are the same but for rounding.
                    let is_apart = (*q - p).length() > 1e-9 * p.length();
                    if rise_m > 0.0 && is_apart { rise_m / (*q - p - rise_m * up).length() } else { 0.0 }
                })
            });
            tangents.fold(0.0, f64::max)
        };
        (0..mesh.facets.len()).map(highest).collect()
    }

    fn hills(x: f64, y: f64) -> f64 {
        1.5 * (0.4 * x + 0.1 * y).sin() + 0.8 * (0.7 * y - 0.3 * x).cos()
    }

    #[test]
    fn no_point_rises_above_a_horizon() {
        let plate = |at: [f64; 3], size: f64| moved(sheet(2, |_, _| 0.0), at, size);
        let cliff = |x: f64, y: f64| hills(x, y) + if x >= 12.0 { 6.0 } else { 0.0 };
        let step = with(sheet(11, hills), &moved(sheet(11, |x, y| hills(x + 12.0, y)), [11.0, 0.0, 7.0], 1.0));
        let mut with_nothing = sheet(20, hills);
        with_nothing.facets.push([0, 0, 1]);
        with_nothing.material.push(MaterialId(0));
        let scenes = [
            sheet(24, hills),
            sheet(24, cliff),
            // What floats, what is upside down, what stands beside without a wall between, and what covers all.
            with(sheet(24, hills), &plate([9.0, 9.0, 5.0], 2.0)),
            with(sheet(24, hills), &plate([9.0, 9.0, 5.0], 0.1)),
            with(sheet(16, hills), &plate([-1.0, -1.0, 30.0], 9.0)),
            step,
            with_nothing,
            moved(sheet(24, hills), [1e6, -1e6, 1e5], 1e-3),
        ];
        for (i, mesh) in scenes.iter().enumerate() {
            for up in [DVec3::Z, DVec3::new(0.1, -0.05, 1.0).normalize()] {
                let (found, truth) = (horizons(mesh, up), truth(mesh, up));
                for (facet, (found, truth)) in found.iter().zip(&truth).enumerate() {
                    assert!(*found >= truth * (1.0 - 1e-6), "scene {i}, facet {facet}: {found} {truth}");
                }
            }
        }
    }

    #[test]
    fn horizons_of_plains_and_hills_are_of_use() {
        assert!(horizons(&sheet(20, |_, _| 3.0), DVec3::Z).iter().all(|tangent| *tangent == 0.0));
        // A slope rises as steeply as it does; of cells that are far, boxes around them tell three times as much at the most.
        let slope = horizons(&sheet(20, |x, _| 0.5 * x), DVec3::Z);
        assert!(slope.iter().all(|tangent| (0.499_999..=1.5).contains(tangent)), "{slope:?}");
        // A tower 10 m high, far from the ground's edge: from 20 m away it has 10 / 20.
        let tower = |x: f64, y: f64| if (x - 50.0).abs() < 1.0 && (y - 50.0).abs() < 1.0 { 10.0 } else { 0.0 };
        let mesh = sheet(100, tower);
        let (found, truth) = (horizons(&mesh, DVec3::Z), truth_of(&mesh, 20));
        assert!(found[truth.0] >= truth.1 && found[truth.0] < 1.6 * truth.1, "{} {}", found[truth.0], truth.1);
    }

    /// The facet so far to the left of the tower's middle, and the tower's elevation there.
    fn truth_of(mesh: &Mesh, away: u32) -> (usize, f64) {
        let facet = mesh.facets.iter().position(|f| f[0] == 50 * 101 + 50 - away).unwrap();
        (facet, 10.0 / (f64::from(away) - 1.0))
    }

    #[test]
    fn nothing_and_what_cannot_be_told() {
        assert!(horizons(&Mesh::default(), DVec3::Z).is_empty());
        let mut upright = sheet(4, |_, _| 0.0);
        upright.vertices_m.iter_mut().for_each(|p| *p = DVec3::new(p.x, 0.0, p.y));
        assert!(horizons(&upright, DVec3::Z).iter().all(|tangent| *tangent == f64::INFINITY));
        // Many sheets, each of two facets as large as all.
        let sheets = (1..400).fold(sheet(1, |_, _| 0.0), |all, i| {
            with(all, &moved(sheet(1, |_, _| 0.0), [0.0, 0.0, f64::from(i)], 1.0))
        });
        assert!(horizons(&sheets, DVec3::Z).iter().all(|tangent| *tangent == f64::INFINITY));
    }
}
