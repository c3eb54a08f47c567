//! The facets that meet along the lines of one bundle.
//!
//! Only behind a facet that faces away from the viewer can another be met from outside, and few do: those are drawn first, and
//! of the others only what lies on their lines. So a line costs something where it carries something.

use std::ops::Range;

use glam::DVec3;

use super::blocks::Blocks;
use super::coincident::{SAME_PLANE, rank};
use crate::geometry::polygon::Point;
use crate::geometry::{Facet, Mesh, index_u32, whole_u32};

/// In a row of so many cells it is not worth while to look for those that a facet meets.
const FEW: usize = 8;
/// No facet.
const NONE: u32 = u32::MAX;

/// The lattice of a bundle: cells with a line in the middle of each.
#[derive(Debug, Clone)]
pub struct Frame {
    middle_m: DVec3,
    /// Cells per metre across the lines, twice, and the way towards the viewer.
    axes: [DVec3; 3],
    offset: Point,
    /// Tiles of 8 x 8 cells in a row, and rows of them.
    tiles: [u32; 2],
    /// Cells per metre.
    scale: [f64; 2],
    rounding_m: f64,
}

/// Where a line leaves one facet and meets another, each on its outer side.
#[derive(Debug, Clone, Copy)]
pub struct Meeting {
    /// The one nearer to the viewer, and the one farther.
    pub facets: [u32; 2],
    /// The line.
    pub at: Point,
}

impl Frame {
    /// `extent_m`: how far the mesh reaches from its middle, to either side; `phase`: by what part of a cell the lattice is displaced.
    pub(super) fn new(
        middle_m: DVec3,
        [across, rising, towards]: [DVec3; 3],
        size_m: [f64; 2],
        extent_m: [f64; 2],
        phase: [f64; 2],
        magnitude_m: f64,
    ) -> Self {
        let scale = size_m.map(f64::recip);
        let offset = [0, 1].map(|k| extent_m[k] * scale[k] + 1.0 + phase[k]);
        let tiles = [0, 1].map(|k| whole_u32((2.0 * extent_m[k] * scale[k] + 4.0) / 8.0) + 1);
        let axes = [across * scale[0], rising * scale[1], towards];
        Frame { middle_m, axes, offset, tiles, scale, rounding_m: SAME_PLANE * magnitude_m }
    }

    #[inline]
    fn project(&self, p_m: DVec3) -> [f64; 3] {
        let p_m = p_m - self.middle_m;
        let [x, y, z] = self.axes.map(|axis| p_m.dot(axis));
        [x + self.offset[0], y + self.offset[1], z]
    }

    /// The tile of a cell, and its bit there.
    #[inline]
    fn place(&self, [column, row]: [u32; 2]) -> (usize, u64) {
        let tile = (row / 8) as usize * self.tiles[0] as usize + (column / 8) as usize;
        (tile, 1 << (row % 8 * 8 + column % 8))
    }

    /// The column of a place.
    #[inline]
    fn column(&self, (tile, bit): (usize, u64)) -> u32 {
        index_u32(tile % self.tiles[0] as usize) * 8 + bit.trailing_zeros() % 8
    }

    /// Whether something in the cells of a rectangle that is nowhere farther from the viewer than `low_m` may have before it what faces away.
    #[inline]
    fn has_any(&self, tiles: &[Tile], [first, last]: [[u32; 2]; 2], low_m: f64) -> bool {
        (first[1] / 8..=last[1] / 8).any(|row| {
            // The rows of the tile that are in the rectangle, and below the columns.
            let rows = (u64::MAX << (8 * first[1].saturating_sub(8 * row)))
                & (u64::MAX >> (56 - 8 * (last[1] - 8 * row).min(7)));
            let of_row = row as usize * self.tiles[0] as usize;
            (first[0] / 8..=last[0] / 8).any(|column| {
                let columns =
                    (0xff << first[0].saturating_sub(8 * column)) & (0xff >> (7 - (last[0] - 8 * column).min(7)));
                let tile = &tiles[of_row + column as usize];
                tile.cells & rows & (columns * 0x0101_0101_0101_0101) != 0 && low_m < tile.nearest_m
            })
        })
    }

    /// The point (u, v) where a line meets a facet.
    pub fn uv(&self, facet: &Facet, [x, y]: Point) -> Point {
        let [a, b, c] = facet.corners_m.map(|p| self.project(p));
        let ([bx, by], [cx, cy]) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        let (det, x, y) = (bx * cy - by * cx, x - a[0], y - a[1]);
        [(x * cy - y * cx) / det, (bx * y - by * x) / det]
    }
}

/// 8 x 8 cells.
#[derive(Debug, Clone, Copy)]
struct Tile {
    /// Those that are marked: something there faces away.
    cells: u64,
    /// How many are in the tiles before.
    before: u32,
    /// How near to the viewer the nearest such thing is, m.
    nearest_m: f64,
}

impl Tile {
    const EMPTY: Tile = Tile { cells: 0, before: 0, nearest_m: f64::NEG_INFINITY };
}

/// A facet that faces away, on a line, and the nearest one behind it that does not: [`NONE`] as long as none is known.
#[derive(Debug, Clone, Copy)]
struct Slot {
    cell: [u32; 2],
    facets: [u32; 2],
    /// Towards the viewer, m.
    height_m: [f64; 2],
    /// Within this they lie in one plane with others, m.
    rounding_m: [f64; 2],
}

impl Slot {
    const EMPTY: Slot = Slot { cell: [0; 2], facets: [NONE; 2], height_m: [0.0; 2], rounding_m: [0.0; 2] };
}

/// The tiles, row by row.
trait Tiles {
    fn line(&self, place: (usize, u64)) -> usize;
}

impl Tiles for [Tile] {
    /// Number of a cell's line among those with a facet that faces away.
    #[inline]
    fn line(&self, (tile, bit): (usize, u64)) -> usize {
        let Tile { cells, before, .. } = self[tile];
        (before + (cells & (bit - 1)).count_ones()) as usize
    }
}

/// Working memory of a bundle.
#[derive(Debug, Default)]
pub struct Scratch {
    /// The vertices in the lattice; and by themselves, since that decides about most facets, the first column and row whose middle each is not beyond.
    points: Vec<[f64; 3]>,
    first: Vec<[u32; 2]>,
    /// The places of facets that face the viewer, and are not between lines.
    fronts: Vec<u32>,
    tiles: Vec<Tile>,
    found: Vec<Slot>,
    /// Those found, line by line, from the nearest on.
    slots: Vec<Slot>,
    /// Of each line with any, in the order of the tiles, its first slot.
    start: Vec<u32>,
}

/// Calls `visit` with all meetings.
pub(super) fn meetings(
    mesh: &Mesh,
    blocks: &Blocks,
    frame: &Frame,
    scratch: &mut Scratch,
    mut visit: impl FnMut(&Frame, Meeting),
) {
    let towards = frame.axes[2];
    scratch.clear(frame);
    scratch.draw(frame, &blocks.vertices_m);
    for block in &blocks.blocks {
        let (may_face, may_face_away) = (block.may_face(towards), block.may_face_away(towards));
        for place in block.facets.clone() {
            let (facet, corners) = blocks.facets[place];
            let Some(drawn) = scratch.drawn(corners) else { continue };
            if drawn.turn > 0.0 && may_face {
                scratch.fronts.push(index_u32(place));
            } else if drawn.turn < 0.0 && may_face_away {
                scratch.add_back(frame, &drawn, facet);
            }
        }
    }
    if scratch.found.is_empty() {
        return;
    }
    scratch.sort(frame, mesh);
    for i in 0..scratch.fronts.len() {
        let (facet, corners) = blocks.facets[scratch.fronts[i] as usize];
        if let Some(drawn) = scratch.drawn(corners) {
            scratch.add_front(frame, mesh, &drawn, facet);
        }
    }
    for slot in scratch.slots.iter().filter(|slot| slot.facets[1] != NONE) {
        let at = slot.cell.map(|k| f64::from(k) + 0.5);
        visit(frame, Meeting { facets: slot.facets, at });
    }
}

/// A facet in the lattice.
struct Drawn {
    corners: [[f64; 3]; 3],
    /// Twice its area, above 0 if it faces the viewer.
    turn: f64,
    /// The columns and rows that its lines may be in: the first, and the one after the last.
    first: [u32; 2],
    end: [u32; 2],
}

impl Drawn {
    /// The columns of a row that its lines may be in.
    #[inline]
    fn columns(&self, row: u32) -> Range<u32> {
        let all = self.first[0]..self.end[0];
        if all.len() <= FEW { all } else { self.columns_between(row) }
    }

    /// The same where there are many: between where its sides cross the row, and one more on either side.
    fn columns_between(&self, row: u32) -> Range<u32> {
        let y = f64::from(row) + 0.5;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for k in 0..3 {
            let (p, q) = (self.corners[k], self.corners[(k + 1) % 3]);
            if (p[1] <= y) != (q[1] <= y) {
                let x = p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
                (low, high) = (low.min(x), high.max(x));
            }
        }
        let start = first_middle(low - 1.0).clamp(self.first[0], self.end[0]);
        start..first_middle(high + 1.0).min(self.end[0]).max(start)
    }

    /// Whether it meets the line of a cell. Of neighbours one meets a line on their common edge, whatever rounding does: on which side of it the
    /// line is, is computed from its ends in one order.
    #[inline]
    fn covers(&self, column: u32, row: u32) -> bool {
        let (x, y) = (f64::from(column) + 0.5, f64::from(row) + 0.5);
        let is_left = |p: &[f64; 3], q: &[f64; 3]| {
            let is_up = (p[1], p[0]) < (q[1], q[0]);
            let (p, q) = if is_up { (p, q) } else { (q, p) };
            ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) > 0.0) == is_up
        };
        let [a, b, c] = &self.corners;
        let faces = self.turn > 0.0;
        is_left(a, b) == faces && is_left(b, c) == faces && is_left(c, a) == faces
    }

    /// Its height on lines.
    fn heights(&self, frame: &Frame) -> Heights {
        let [a, b, c] = self.corners;
        let ([bx, by, bz], [cx, cy, cz]) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let slope = [(bz * cy - cz * by) / self.turn, (bx * cz - cx * bz) / self.turn];
        let steep = slope[0].abs() * frame.scale[0] + slope[1].abs() * frame.scale[1];
        Heights {
            anchor: a,
            slope,
            low: a[2].min(b[2]).min(c[2]),
            high: a[2].max(b[2]).max(c[2]),
            rounding_m: frame.rounding_m * (1.0 + steep),
        }
    }
}

/// How high a facet is towards the viewer on each line: affine.
struct Heights {
    anchor: [f64; 3],
    slope: [f64; 2],
    low: f64,
    high: f64,
    /// Facets that are no farther apart lie in one plane.
    rounding_m: f64,
}

impl Heights {
    #[inline]
    fn at(&self, column: u32, row: u32) -> f64 {
        let (x, y) = (f64::from(column) + 0.5 - self.anchor[0], f64::from(row) + 0.5 - self.anchor[1]);
        // A facet seen nearly edge-on has slopes that mean nothing.
        (self.anchor[2] + self.slope[0] * x + self.slope[1] * y).max(self.low).min(self.high)
    }
}

impl Scratch {
    fn clear(&mut self, frame: &Frame) {
        self.tiles.clear();
        self.tiles.resize(frame.tiles[0] as usize * frame.tiles[1] as usize, Tile::EMPTY);
        self.fronts.clear();
        self.found.clear();
    }

    fn draw(&mut self, frame: &Frame, vertices_m: &[DVec3]) {
        self.points.clear();
        self.points.extend(vertices_m.iter().map(|p_m| frame.project(*p_m)));
        self.first.clear();
        // What lies beyond the lattice meets no line.
        let [columns, rows] = frame.tiles.map(|tiles| 8 * tiles);
        let first = |[x, y, _]: &[f64; 3]| [first_middle(*x).min(columns), first_middle(*y).min(rows)];
        self.first.extend(self.points.iter().map(first));
    }

    /// A facet; `None` if it is between lines.
    #[inline]
    fn drawn(&self, corners: [u32; 3]) -> Option<Drawn> {
        let [a, b, c] = corners.map(|v| self.first[v as usize]);
        if (a[1] == b[1] && a[1] == c[1]) || (a[0] == b[0] && a[0] == c[0]) {
            return None;
        }
        let first = [0, 1].map(|k| a[k].min(b[k]).min(c[k]));
        let end = [0, 1].map(|k| a[k].max(b[k]).max(c[k]));
        let corners = corners.map(|v| self.points[v as usize]);
        let [a, b, c] = corners;
        let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        Some(Drawn { corners, turn, first, end })
    }

    /// Puts a facet that faces away on its lines.
    fn add_back(&mut self, frame: &Frame, drawn: &Drawn, facet: u32) {
        let mut heights = None;
        for row in drawn.first[1]..drawn.end[1] {
            for column in drawn.columns(row).filter(|column| drawn.covers(*column, row)) {
                let heights = heights.get_or_insert_with(|| drawn.heights(frame));
                let height_m = heights.at(column, row);
                let (tile, bit) = frame.place([column, row]);
                let tile = &mut self.tiles[tile];
                tile.cells |= bit;
                tile.nearest_m = tile.nearest_m.max(height_m);
                self.found.push(Slot {
                    cell: [column, row],
                    facets: [facet, NONE],
                    height_m: [height_m, f64::NEG_INFINITY],
                    rounding_m: [heights.rounding_m, 0.0],
                });
            }
        }
    }

    /// Sorts what was found by lines, and on each from the nearest on.
    fn sort(&mut self, frame: &Frame, mesh: &Mesh) {
        let mut lines = 0;
        for tile in &mut self.tiles {
            tile.before = lines;
            lines += tile.cells.count_ones();
        }
        // By counting, as in `GroupSizes`, but in memory that is kept.
        self.start.clear();
        self.start.resize(lines as usize + 2, 0);
        for slot in &self.found {
            self.start[self.tiles.line(frame.place(slot.cell)) + 2] += 1;
        }
        let mut sum = 0;
        for start in &mut self.start {
            sum += *start;
            *start = sum;
        }
        self.slots.clear();
        self.slots.resize(self.found.len(), Slot::EMPTY);
        for slot in &self.found {
            let end = &mut self.start[self.tiles.line(frame.place(slot.cell)) + 1];
            self.slots[*end as usize] = *slot;
            *end += 1;
        }
        for line in self.start[..=lines as usize].windows(2).filter(|line| line[1] - line[0] > 1) {
            sort_line(&mut self.slots[line[0] as usize..line[1] as usize], mesh);
        }
    }

    /// Gives a facet that faces the viewer to what is before it on its lines, if nothing nearer has been found there.
    fn add_front(&mut self, frame: &Frame, mesh: &Mesh, drawn: &Drawn, facet: u32) {
        let [a, b, c] = drawn.corners.map(|corner| corner[2]);
        if !frame.has_any(&self.tiles, [drawn.first, drawn.end.map(|end| end - 1)], lesser(lesser(a, b), c)) {
            return;
        }
        let mut heights = None;
        for row in drawn.first[1]..drawn.end[1] {
            for place in marked(&self.tiles, frame, row, &drawn.columns(row)) {
                let column = frame.column(place);
                if !drawn.covers(column, row) {
                    continue;
                }
                let heights = heights.get_or_insert_with(|| drawn.heights(frame));
                let line = self.tiles.line(place);
                let slots = &mut self.slots[self.start[line] as usize..self.start[line + 1] as usize];
                let (height_m, rounding_m) = (heights.at(column, row), heights.rounding_m);
                let is_before = |slot: &&mut Slot| slot.height_m[0] - height_m > slot.rounding_m[0] + rounding_m;
                let Some(slot) = slots.iter_mut().rev().find(is_before) else { continue };
                let lead_m = height_m - slot.height_m[1];
                let is_tie = lead_m.abs() <= rounding_m + slot.rounding_m[1];
                if if is_tie { rank(mesh, facet) < rank(mesh, slot.facets[1]) } else { lead_m > 0.0 } {
                    slot.facets[1] = facet;
                    slot.height_m[1] = height_m;
                    slot.rounding_m[1] = rounding_m;
                }
            }
        }
    }
}

/// Those cells of a row in which something faces away.
#[inline]
fn marked<'a>(
    tiles: &'a [Tile],
    frame: &Frame,
    row: u32,
    columns: &Range<u32>,
) -> impl Iterator<Item = (usize, u64)> + use<'a> {
    let Range { start, end } = *columns;
    let of_row = (row / 8) as usize * frame.tiles[0] as usize;
    (start / 8..end.div_ceil(8)).flat_map(move |tile| {
        let (first, last) = (start.saturating_sub(8 * tile), (end - 1 - 8 * tile).min(7));
        let columns = (0xff << first) & (0xff >> (7 - last));
        let at = of_row + tile as usize;
        let mut cells = tiles[at].cells & (columns << (row % 8 * 8));
        std::iter::from_fn(move || {
            let lowest = cells & cells.wrapping_neg();
            cells ^= lowest;
            (lowest != 0).then_some((at, lowest))
        })
    })
}

/// Sorts a line's facets that face away, the nearest first; of those in one place the one that wins is the last, which is seen from behind.
fn sort_line(slots: &mut [Slot], mesh: &Mesh) {
    let is_after = |one: &Slot, other: &Slot| {
        let lead_m = one.height_m[0] - other.height_m[0];
        let is_tie = lead_m.abs() <= one.rounding_m[0] + other.rounding_m[0];
        if is_tie { rank(mesh, one.facets[0]) < rank(mesh, other.facets[0]) } else { lead_m < 0.0 }
    };
    // By insertion: lines are short, and ties make no order that a library's sort could rely on.
    for i in 1..slots.len() {
        let mut k = i;
        while k > 0 && is_after(&slots[k - 1], &slots[k]) {
            slots.swap(k - 1, k);
            k -= 1;
        }
    }
}

/// The lesser of two numbers, in one instruction: there are no NaNs.
#[inline]
fn lesser(x: f64, y: f64) -> f64 {
    if x < y { x } else { y }
}

/// The first cell whose middle is not below a coordinate, which is not below 0.
#[inline]
fn first_middle(x: f64) -> u32 {
    // By casts: ceil would be a library call on plain x86-64.
    let whole = whole_u32(x - 0.5);
    whole + u32::from(f64::from(whole) < x - 0.5)
}
