//! Exact shadows: the sunlit part of every facet is what the Sun sees of it.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::polygon::{Point, Rect, area, clip_to_rect};
use crate::geometry::{Direction, Mesh};
use crate::product::{Lit, Sunlit};
use crate::progress::{Watch, tell};
use crate::visibility::{Coverage, Drawing, Scratch, Side, Topology, Visit, cells_of};

/// So many facets share a cell of the Sun's view, in the mean: fewer make more work at cell borders, more are quartered.
const FACETS_PER_CELL: f64 = 6.0;
/// Lit polygons below this share of their facet are what rounding leaves at shared edges.
const SLIVER: f64 = 1e-14;

/// Which part of each facet sees the Sun, a point at infinity in direction `towards`.
///
/// Facets that face away are dark; they still block.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub fn sunlit(mesh: &Mesh, topology: &Topology, towards: Direction, watch: Watch<'_>) -> Result<Sunlit> {
    let cells = mesh.facets.len() as f64 / FACETS_PER_CELL;
    let drawing = Drawing::from_sun(mesh, topology, towards, cells);
    let coverage = Coverage::new(&drawing);
    let total = u64::from(drawing.grid.rows);
    let done = AtomicU64::new(0);
    let rows: Result<Vec<Row>> = (0..drawing.grid.rows)
        .into_par_iter()
        .map_init(
            || (Scratch::default(), CellShadows::new(&drawing), Row::default()),
            |(scratch, shadows, work), row| {
                work.clear();
                for column in 0..drawing.grid.columns {
                    shadows.clear();
                    coverage.cell(column, row, scratch, shadows);
                    shadows.append_to(work, column);
                }
                tell(watch, "sunlight", done.fetch_add(1, Relaxed) + 1, total)?;
                // A copy is no longer than it must be, and the working memory serves the next row.
                Ok(work.clone())
            },
        )
        .collect();
    drop(coverage);
    Ok(assemble(&drawing, mesh.facets.len(), &rows?))
}

/// What is not wholly lit in the cells of one row, and the lit polygons there, in drawing coordinates.
#[derive(Debug, Clone, Default)]
struct Row {
    entries: Vec<Entry>,
    polygon_end: Vec<u32>,
    points: Vec<Point>,
}

/// A facet that is not wholly lit in a cell.
#[derive(Debug, Clone, Copy)]
struct Entry {
    facet: u32,
    column: u32,
    /// Its lit polygons among those of the row.
    first: u32,
    end: u32,
}

impl Row {
    fn clear(&mut self) {
        self.entries.clear();
        self.polygon_end.clear();
        self.points.clear();
    }

    fn add(&mut self, polygon: &[Point]) {
        self.points.extend_from_slice(polygon);
        self.polygon_end.push(self.points.len() as u32);
    }

    fn polygon(&self, i: u32) -> &[Point] {
        let start = if i == 0 { 0 } else { self.polygon_end[i as usize - 1] };
        &self.points[start as usize..self.polygon_end[i as usize] as usize]
    }
}

/// What the Sun sees in a cell: facets of which something is hidden, and what is seen of each facet.
struct CellShadows<'a> {
    drawing: &'a Drawing<'a>,
    cut: Vec<u32>,
    whole: Vec<(u32, Rect)>,
    /// A stretch of the points for each piece of a facet.
    pieces: Vec<(u32, std::ops::Range<usize>)>,
    points: Vec<Point>,
    clipped: Vec<Point>,
    spare: Vec<Point>,
}

impl<'a> CellShadows<'a> {
    fn new(drawing: &'a Drawing<'a>) -> Self {
        CellShadows {
            drawing,
            cut: vec![],
            whole: vec![],
            pieces: vec![],
            points: vec![],
            clipped: vec![],
            spare: vec![],
        }
    }

    fn clear(&mut self) {
        self.cut.clear();
        self.whole.clear();
        self.pieces.clear();
        self.points.clear();
    }

    fn append_to(&mut self, row: &mut Row, column: u32) {
        if self.cut.is_empty() {
            return;
        }
        self.cut.sort_unstable();
        self.cut.dedup();
        // Both in the order of `cut`; pieces of a facet stay in theirs.
        self.pieces.sort_by_key(|p| p.0);
        self.whole.sort_by_key(|w| w.0);
        let (mut pieces, mut whole) = (self.pieces.iter().peekable(), self.whole.iter().peekable());
        for &facet in &self.cut {
            let first = row.polygon_end.len() as u32;
            while let Some((of, points)) = pieces.next_if(|p| p.0 <= facet) {
                if *of == facet {
                    row.add(&self.points[points.clone()]);
                }
            }
            while let Some((of, rect)) = whole.next_if(|w| w.0 <= facet) {
                if *of == facet {
                    clip_to_rect(&self.drawing.outline(facet), rect, &mut self.clipped, &mut self.spare);
                    if !self.clipped.is_empty() {
                        row.add(&self.clipped);
                    }
                }
            }
            row.entries.push(Entry { facet, column, first, end: row.polygon_end.len() as u32 });
        }
    }

    fn receives(&self, facet: u32) -> bool {
        self.drawing.side(facet) == Side::Front
    }
}

// The parallel view cuts no facets, so a triangle's index is its facet's.
impl Visit for CellShadows<'_> {
    fn settled(&mut self, _: &[u32], _: &Rect) {}

    fn whole(&mut self, facet: u32, rect: &Rect) {
        if self.receives(facet) {
            self.whole.push((facet, *rect));
        }
    }

    fn cut(&mut self, facet: u32, _: &Rect) {
        if self.receives(facet) {
            self.cut.push(facet);
        }
    }

    fn piece(&mut self, facet: u32, _: &Rect, polygon: &[Point]) {
        if self.receives(facet) {
            let from = self.points.len();
            self.points.extend_from_slice(polygon);
            self.pieces.push((facet, from..self.points.len()));
        }
    }
}

/// Gathers what the cells say about each facet.
fn assemble(drawing: &Drawing, facets: usize, rows: &[Row]) -> Sunlit {
    // Entries by facet: (row, entry), rows ascending.
    let mut start = vec![0u32; facets + 1];
    for row in rows {
        for e in &row.entries {
            start[e.facet as usize + 1] += 1;
        }
    }
    for i in 0..facets {
        start[i + 1] += start[i];
    }
    let mut entry = vec![(0u32, 0u32); start[facets] as usize];
    let mut fill = start.clone();
    for (r, row) in rows.iter().enumerate() {
        for (i, e) in row.entries.iter().enumerate() {
            let at = &mut fill[e.facet as usize];
            entry[*at as usize] = (r as u32, i as u32);
            *at += 1;
        }
    }
    drop(fill);
    let chunk = 4096;
    let parts: Vec<Sunlit> = (0..facets.div_ceil(chunk))
        .into_par_iter()
        .map(|c| {
            let mut part = Sunlit { polygon_start: vec![0], ..Sunlit::default() };
            let mut gather = Gather::default();
            for facet in c * chunk..((c + 1) * chunk).min(facets) {
                let entries = &entry[start[facet] as usize..start[facet + 1] as usize];
                gather.facet(drawing, facet as u32, entries, rows, &mut part);
            }
            part
        })
        .collect();
    let mut all = Sunlit { polygon_start: vec![0], ..Sunlit::default() };
    all.lit.reserve_exact(facets);
    all.polygon_facet.reserve_exact(parts.iter().map(|p| p.polygon_facet.len()).sum());
    all.polygon_start.reserve_exact(parts.iter().map(|p| p.polygon_facet.len()).sum());
    all.uv.reserve_exact(parts.iter().map(|p| p.uv.len()).sum());
    for part in parts {
        let base = all.uv.len() as u32;
        all.lit.extend(part.lit);
        all.polygon_facet.extend(part.polygon_facet);
        all.polygon_start.extend(part.polygon_start[1..].iter().map(|e| base + e));
        all.uv.extend(part.uv);
    }
    all
}

/// Working memory for one facet after the other.
#[derive(Default)]
struct Gather {
    clipped: Vec<Point>,
    spare: Vec<Point>,
}

impl Gather {
    fn facet(&mut self, drawing: &Drawing, facet: u32, entries: &[(u32, u32)], rows: &[Row], out: &mut Sunlit) {
        if drawing.side(facet) != Side::Front {
            out.lit.push(Lit::Dark);
            return;
        }
        if entries.is_empty() {
            out.lit.push(Lit::Full);
            return;
        }
        let outline = drawing.outline(facet);
        let least_area = SLIVER * area(&outline);
        let frame = Barycentric::new(drawing.corners(facet).map(|p| [p[0], p[1]]));
        let polygons_before = out.polygon_facet.len();
        let mut add = |polygon: &[Point]| {
            if area(polygon) > least_area {
                out.uv.extend(polygon.iter().map(|p| frame.uv(*p)));
                out.polygon_facet.push(facet);
                out.polygon_start.push(out.uv.len() as u32);
            }
        };
        let mut next = 0;
        // Cells without an entry are wholly lit: they are joined along their row, so that a large facet has few polygons.
        cells_of(outline, drawing.grid, |row, columns| {
            let mut run = columns.start;
            let mut close_run = |from: u32, to: u32, add: &mut dyn FnMut(&[Point])| {
                if from < to {
                    let mut rect = drawing.grid.cell(from, row);
                    rect.max[0] = f64::from(to);
                    clip_to_rect(&outline, &rect, &mut self.clipped, &mut self.spare);
                    add(&self.clipped);
                }
            };
            while next < entries.len() && entries[next].0 == row {
                let cells = &rows[row as usize];
                let Entry { column, first, end, .. } = cells.entries[entries[next].1 as usize];
                close_run(run, column, &mut add);
                for i in first..end {
                    add(cells.polygon(i));
                }
                run = column + 1;
                next += 1;
            }
            close_run(run, columns.end, &mut add);
        });
        out.lit.push(if out.polygon_facet.len() == polygons_before { Lit::Dark } else { Lit::Part });
    }
}

/// Turns points of the drawing into (u, v) on a facet. A parallel view is affine, so this is exact up to rounding.
struct Barycentric {
    a: Point,
    b: Point,
    c: Point,
    det: f64,
}

impl Barycentric {
    fn new([a, b, c]: [Point; 3]) -> Self {
        let (b, c) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        Barycentric { a, b, c, det: b[0] * c[1] - b[1] * c[0] }
    }

    fn uv(&self, p: Point) -> [f64; 2] {
        let (x, y) = (p[0] - self.a[0], p[1] - self.a[1]);
        [(x * self.c[1] - y * self.c[0]) / self.det, (self.b[0] * y - self.b[1] * x) / self.det]
    }
}
