//! What an eye sees of each facet, exactly: the Sun, a source like it, or the camera of a map. What the Sun sees is lit.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use glam::DVec3;
use rayon::prelude::*;

use super::seen_through_lens::in_pixels;
use super::{Coverage, Drawing, Grid, OnFacet, Scratch, Side, Topology, View, Visit, cells_of};
use crate::error::Result;
use crate::geometry::polygon::{Point, Rect, area, clip_to_rect, side};
use crate::geometry::{Direction, FrameCamera, GroupSizes, Groups, Mesh, index_u32, whole_u32};
use crate::progress::{Pulse, Watch, tell};

/// Mean number of facets in a cell of the view from afar: fewer make more work at cell borders, more are quartered.
const FACETS_PER_CELL: f64 = 6.0;
/// Polygons below this share of their facet are what rounding leaves at shared edges, ...
const SLIVER: f64 = 1e-14;
/// ... and so are those narrower than this share of the drawing.
const NARROW: f64 = 4.0 * f64::EPSILON;

/// How much of a facet an eye sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Shown {
    /// Nothing.
    Nothing = 0,
    /// All of it: nothing was cut off anywhere.
    Whole = 1,
    /// The polygons in [`Seen`].
    Part = 2,
}

/// What an eye sees of every facet, as convex polygons that do not overlap: of the Sun, what it lights.
///
/// Of several eyes [together](Seen::together), the polygons of each, which overlap those of others; each has its eye's share.
/// Polygon vertices are (u, v) on the facet: point = a + u (b - a) + v (c - a).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Seen {
    /// How much of each facet.
    pub shown: Vec<Shown>,
    /// The facet of each polygon, ascending.
    pub polygon_facet: Vec<u32>,
    /// First vertex of each polygon, and the number of vertices as the last element.
    pub polygon_start: Vec<usize>,
    /// Vertices of the polygons.
    pub uv: Vec<[f64; 2]>,
    /// Of several eyes together, the share of each polygon's eye: at any point of a facet they sum to at most 1. Empty for one eye.
    pub polygon_share: Vec<f64>,
}

impl Seen {
    /// The same of some facets, ascending, which are then counted from 0.
    #[must_use]
    pub fn part(&self, facets: &[u32]) -> Seen {
        let shown = facets.iter().map(|facet| self.shown[*facet as usize]).collect();
        let mut part = Seen { shown, polygon_start: vec![0], ..Seen::default() };
        for (place, facet) in facets.iter().enumerate().filter(|(_, facet)| self.shown[**facet as usize] == Shown::Part)
        {
            for polygon in self.numbers(*facet) {
                part.uv.extend_from_slice(&self.uv[self.polygon_start[polygon]..self.polygon_start[polygon + 1]]);
                part.polygon_facet.push(index_u32(place));
                part.polygon_start.push(part.uv.len());
                part.polygon_share.extend(self.polygon_share.get(polygon));
            }
        }
        part
    }

    /// The polygons of a facet that is seen in part.
    pub fn polygons(&self, facet: u32) -> impl ExactSizeIterator<Item = &[[f64; 2]]> {
        self.numbers(facet).map(|i| &self.uv[self.polygon_start[i]..self.polygon_start[i + 1]])
    }

    /// Where the polygons of a facet are.
    fn numbers(&self, facet: u32) -> std::ops::Range<usize> {
        let first = self.polygon_facet.partition_point(|f| *f < facet);
        first..first + self.polygon_facet[first..].partition_point(|f| *f == facet)
    }

    /// The share of a polygon: 1 for one eye.
    #[inline]
    pub fn share(&self, polygon: usize) -> f64 {
        self.polygon_share.get(polygon).copied().unwrap_or(1.0)
    }

    /// Share of a facet's area that is seen.
    pub fn fraction(&self, facet: u32) -> f64 {
        match self.shown[facet as usize] {
            Shown::Nothing => 0.0,
            Shown::Whole => 1.0,
            Shown::Part => self.numbers(facet).map(|i| self.filled(i)).sum(),
        }
    }

    /// Whether points of a facet are seen; of several eyes, the share of those that see them. On a border it is as on either side.
    pub fn shares_at(&self, facet: u32, points: &[Point]) -> Vec<f64> {
        let all = |share: f64| vec![share; points.len()];
        match self.shown[facet as usize] {
            Shown::Nothing => all(0.0),
            Shown::Whole => all(1.0),
            Shown::Part => {
                let mut shares = all(0.0);
                for i in self.numbers(facet) {
                    let polygon = &self.uv[self.polygon_start[i]..self.polygon_start[i + 1]];
                    let bounds = Rect::of(polygon);
                    for (point, share) in points.iter().zip(&mut shares) {
                        let is_near = (0..2).all(|k| bounds.min[k] <= point[k] && point[k] <= bounds.max[k]);
                        if is_near && holds(polygon, *point) {
                            *share += self.share(i);
                        }
                    }
                }
                shares.iter_mut().for_each(|share| *share = share.min(1.0));
                shares
            }
        }
    }

    /// How much of its facet a polygon fills, times its share.
    pub fn filled(&self, polygon: usize) -> f64 {
        let uv = &self.uv[self.polygon_start[polygon]..self.polygon_start[polygon + 1]];
        2.0 * area(uv).abs() * self.share(polygon)
    }

    /// The first facet whose polygons fill more than `most` of its area, overlaps counted twice, and what they fill.
    pub fn overfull(&self, most: f64) -> Option<(u32, f64)> {
        // Polygons are in the order of their facets.
        let (mut facet, mut sum) = (None, 0.0);
        for (i, of) in self.polygon_facet.iter().enumerate() {
            if facet != Some(*of) {
                (facet, sum) = (Some(*of), 0.0);
            }
            sum += self.filled(i);
            if sum > most {
                return Some((*of, sum));
            }
        }
        None
    }

    /// Says what is inconsistent; `Ok` if nothing is.
    ///
    /// # Errors
    /// The first thing that does not hold, as a sentence.
    pub fn validate(&self) -> std::result::Result<(), String> {
        if self.polygon_start.len() != self.polygon_facet.len() + 1 {
            return Err(format!("{} polygons, but {} starts", self.polygon_facet.len(), self.polygon_start.len()));
        }
        if self.polygon_start.first() != Some(&0)
            || self.polygon_start.last() != Some(&self.uv.len())
            || self.polygon_start.windows(2).any(|w| w[0] > w[1])
        {
            return Err("polygon starts are not an ascending list from 0 to the number of vertices".into());
        }
        if self.polygon_facet.windows(2).any(|w| w[0] > w[1]) {
            return Err("polygons are not in the order of their facets".into());
        }
        if !self.polygon_share.is_empty() && self.polygon_share.len() != self.polygon_facet.len() {
            return Err(format!("{} polygons, but {} shares", self.polygon_facet.len(), self.polygon_share.len()));
        }
        match self.polygon_facet.iter().find(|f| self.shown.get(**f as usize) != Some(&Shown::Part)) {
            Some(f) => Err(format!("facet {f} has polygons, but is not seen in part")),
            None => Ok(()),
        }
    }
}

impl Seen {
    /// What an eye at infinity sees, in the direction `towards`; `stage` is the name reported to `watch`.
    ///
    /// Of facets that face away it sees nothing; they still block. Nor does it of facets seen edge-on, up to rounding.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
    pub fn from_afar(
        mesh: &Mesh,
        topology: &Topology,
        towards: Direction,
        stage: &'static str,
        watch: Watch<'_>,
    ) -> Result<Self> {
        tell(watch, stage, 0, 1)?;
        let cells = mesh.facets.len() as f64 / FACETS_PER_CELL;
        seen(&Drawing::from_afar(mesh, topology, towards, cells), None, stage, watch)
    }

    /// The same of some facets alone, which are counted from 0 in what comes out; `drawn` are they and all that may hide them. Both ascending.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
    pub fn of_facets_from_afar(
        mesh: &Mesh,
        topology: &Topology,
        towards: Direction,
        (facets, drawn): (&[u32], &[u32]),
        stage: &'static str,
        watch: Watch<'_>,
    ) -> Result<Self> {
        tell(watch, stage, 0, 1)?;
        let cells = drawn.len() as f64 / FACETS_PER_CELL;
        seen(&Drawing::of_facets_from_afar(mesh, topology, towards, cells, drawn), Some(facets), stage, watch)
    }

    /// What an eye at `centre_m`, local, m, sees within the cone of some rays about `axis`; `stage` is the name reported to `watch`.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
    pub fn from_point(
        mesh: &Mesh,
        topology: &Topology,
        centre_m: DVec3,
        (axis, rays): (Direction, &[DVec3]),
        stage: &'static str,
        watch: Watch<'_>,
    ) -> Result<Self> {
        tell(watch, stage, 0, 1)?;
        let u = axis.vec();
        let (h, v) = axis.frame();
        let tangents: Vec<Point> = rays.iter().map(|r| [r.dot(h) / r.dot(u), r.dot(v) / r.dot(u)]).collect();
        let frame = Rect::of(&tangents);
        let extent = [0, 1].map(|k| frame.max[k] - frame.min[k]);
        let cells = (mesh.facets.len() as f64 / FACETS_PER_CELL).clamp(1.0, 4096.0 * 4096.0);
        let scale = (cells / (extent[0] * extent[1])).sqrt();
        let [columns, rows] = extent.map(|e| whole_u32((e * scale).ceil().clamp(1.0, 16384.0)));
        let offset = [0, 1].map(|k| -frame.min[k] * scale);
        let view = View::pinhole(mesh.bounds_m(), centre_m, [h, v, u], [scale; 2], offset);
        seen(&Drawing::new(mesh, topology, view, Grid { columns, rows }), None, stage, watch)
    }

    /// What a camera sees within its image, whatever the number of its pixels; `stage` is the name reported to `watch`.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
    pub fn from_camera(
        mesh: &Mesh,
        topology: &Topology,
        camera: &FrameCamera,
        stage: &'static str,
        watch: Watch<'_>,
    ) -> Result<Self> {
        tell(watch, stage, 0, 1)?;
        // Pixels are joined or divided into cells of a few facets each: what is seen does not depend on them.
        let drawn = camera.drawn();
        let pinhole = &drawn.pinhole;
        let cells = (mesh.facets.len() as f64 / FACETS_PER_CELL).clamp(1.0, 4096.0 * 4096.0);
        let [samples, lines] = [pinhole.samples, pinhole.lines].map(f64::from);
        let scale = (cells / (samples * lines)).sqrt();
        let [columns, rows] = [samples, lines].map(|n| whole_u32((n * scale).ceil().clamp(1.0, 16384.0)));
        let by = [f64::from(columns) / samples, f64::from(rows) / lines];
        let cells = FrameCamera {
            samples: columns,
            lines: rows,
            pitch: [0, 1].map(|k| pinhole.pitch[k] / by[k]),
            boresight_px: [0, 1].map(|k| pinhole.boresight_px[k] * by[k]),
            ..pinhole.clone()
        };
        let (view, grid) = View::of_frame(&cells, mesh.bounds_m());
        let drawing = Drawing::new(mesh, topology, view, grid);
        let all = seen(&drawing, None, stage, watch)?;
        let size = [camera.samples, camera.lines];
        Ok(if drawn.is_distorted() { in_pixels(&all, &drawing, &drawn, size, by) } else { all })
    }
}

/// Whether a convex polygon holds a point: either way around, for tables of other programs.
fn holds(polygon: &[Point], point: Point) -> bool {
    let next = polygon.iter().cycle().skip(1);
    let sides = || polygon.iter().zip(next.clone()).map(|(a, b)| side(*a, *b, point));
    sides().all(|side| side >= 0.0) || sides().all(|side| side <= 0.0)
}

/// What a view sees of each facet, or of some, ascending.
fn seen(drawing: &Drawing, facets: Option<&[u32]>, stage: &'static str, watch: Watch<'_>) -> Result<Seen> {
    let coverage = Coverage::new(drawing);
    let total = u64::from(drawing.grid.rows);
    let done = AtomicU64::new(0);
    let pulse = || Pulse::new(watch, stage, &done, total);
    let rows: Result<Vec<Row>> = (0..drawing.grid.rows)
        .into_par_iter()
        .map_init(
            || (Scratch::new(pulse()), CellSight::new(drawing), Row::default()),
            |(scratch, sight, work), row| {
                work.clear();
                for column in 0..drawing.grid.columns {
                    sight.clear();
                    coverage.cell(column, row, scratch, sight)?;
                    sight.append_to(work, column);
                }
                tell(watch, stage, done.fetch_add(1, Relaxed) + 1, total)?;
                // A copy is no longer than it must be, and the working memory serves the next row.
                Ok(work.clone())
            },
        )
        .collect();
    drop(coverage);
    Ok(assemble(drawing, facets, &rows?))
}

/// What is not wholly seen in the cells of one row, and the polygons that are seen there, in drawing coordinates.
#[derive(Debug, Clone, Default)]
struct Row {
    entries: Vec<Entry>,
    polygon_end: Vec<usize>,
    points: Vec<Point>,
}

/// A triangle that is not wholly seen in a cell.
#[derive(Debug, Clone, Copy)]
struct Entry {
    triangle: u32,
    column: u32,
    /// Its polygons among those of the row.
    first: usize,
    end: usize,
}

impl Row {
    fn clear(&mut self) {
        self.entries.clear();
        self.polygon_end.clear();
        self.points.clear();
    }

    fn add(&mut self, polygon: &[Point]) {
        self.points.extend_from_slice(polygon);
        self.polygon_end.push(self.points.len());
    }

    fn polygon(&self, i: usize) -> &[Point] {
        let start = if i == 0 { 0 } else { self.polygon_end[i - 1] };
        &self.points[start..self.polygon_end[i]]
    }
}

/// What is seen in a cell: facets of which something is hidden, and what is seen of each facet.
struct CellSight<'a> {
    drawing: &'a Drawing<'a>,
    cut: Vec<u32>,
    whole: Vec<(u32, Rect)>,
    /// A stretch of the points for each piece of a facet.
    pieces: Vec<(u32, std::ops::Range<usize>)>,
    points: Vec<Point>,
    clipped: Vec<Point>,
    spare: Vec<Point>,
}

impl<'a> CellSight<'a> {
    fn new(drawing: &'a Drawing<'a>) -> Self {
        CellSight {
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
        for &triangle in &self.cut {
            let first = row.polygon_end.len();
            while let Some((of, points)) = pieces.next_if(|p| p.0 <= triangle) {
                if *of == triangle {
                    row.add(&self.points[points.clone()]);
                }
            }
            while let Some((of, rect)) = whole.next_if(|w| w.0 <= triangle) {
                if *of == triangle {
                    clip_to_rect(&self.drawing.outline(triangle), rect, &mut self.clipped, &mut self.spare);
                    if !self.clipped.is_empty() {
                        row.add(&self.clipped);
                    }
                }
            }
            row.entries.push(Entry { triangle, column, first, end: row.polygon_end.len() });
        }
    }

    fn receives(&self, triangle: u32) -> bool {
        self.drawing.side(triangle) == Side::Front
    }
}

impl Visit for CellSight<'_> {
    fn settled(&mut self, _: &[u32], _: &Rect) {}

    fn whole(&mut self, triangle: u32, rect: &Rect) {
        if self.receives(triangle) {
            self.whole.push((triangle, *rect));
        }
    }

    fn cut(&mut self, triangle: u32, _: &Rect) {
        if self.receives(triangle) {
            self.cut.push(triangle);
        }
    }

    fn piece(&mut self, triangle: u32, _: &Rect, polygon: &[Point]) {
        if self.receives(triangle) {
            let from = self.points.len();
            self.points.extend_from_slice(polygon);
            self.pieces.push((triangle, from..self.points.len()));
        }
    }
}

/// Triangles whose entries are looked up together: most have none, so that a place for each would cost more memory than all entries.
const BLOCK: usize = 32;

/// Where the entries of each triangle are: by block, of each the triangle, its row and its number there, ascending.
struct EntriesByTriangle(Groups<(u32, u32, u32)>);

impl EntriesByTriangle {
    fn new(triangles: usize, rows: &[Row]) -> Self {
        let blocks = triangles.div_ceil(BLOCK);
        let mut sizes = GroupSizes::new(blocks);
        rows.iter().flat_map(|row| &row.entries).for_each(|entry| sizes.count(entry.triangle as usize / BLOCK));
        let mut entries = sizes.into_groups();
        for (r, row) in rows.iter().enumerate() {
            for (i, Entry { triangle, .. }) in row.entries.iter().enumerate() {
                entries.put(*triangle as usize / BLOCK, (*triangle, index_u32(r), index_u32(i)));
            }
        }
        (0..blocks).for_each(|block| entries.of_mut(block).sort_unstable());
        EntriesByTriangle(entries)
    }

    fn of(&self, triangle: u32) -> &[(u32, u32, u32)] {
        let of_block = self.0.of(triangle as usize / BLOCK);
        let from = of_block.partition_point(|entry| entry.0 < triangle);
        let to = of_block.partition_point(|entry| entry.0 <= triangle);
        &of_block[from..to]
    }
}

/// Gathers what the cells say about each facet, or about some, which are then counted from 0.
fn assemble(drawing: &Drawing, asked: Option<&[u32]>, rows: &[Row]) -> Seen {
    let facets = asked.map_or(drawing.mesh().facets.len(), <[u32]>::len);
    let entries = EntriesByTriangle::new(drawing.len(), rows);
    let chunk = 4096;
    let parts: Vec<Seen> = (0..facets.div_ceil(chunk))
        .into_par_iter()
        .map(|c| {
            let mut part = Seen { polygon_start: vec![0], ..Seen::default() };
            let mut gather = Gather::default();
            for place in c * chunk..((c + 1) * chunk).min(facets) {
                let place = index_u32(place);
                let facet = asked.map_or(place, |asked| asked[place as usize]);
                gather.facet(drawing, (facet, place), &entries, rows, &mut part);
            }
            part
        })
        .collect();
    let mut all = Seen { polygon_start: vec![0], ..Seen::default() };
    all.shown.reserve_exact(facets);
    all.polygon_facet.reserve_exact(parts.iter().map(|p| p.polygon_facet.len()).sum());
    all.polygon_start.reserve_exact(parts.iter().map(|p| p.polygon_facet.len()).sum());
    all.uv.reserve_exact(parts.iter().map(|p| p.uv.len()).sum());
    for part in parts {
        let base = all.uv.len();
        all.shown.extend(part.shown);
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
    /// What is seen of a facet, under the number that it has in what comes out.
    fn facet(
        &mut self,
        drawing: &Drawing,
        (facet, number): (u32, u32),
        entries: &EntriesByTriangle,
        rows: &[Row],
        out: &mut Seen,
    ) {
        if drawing.side(facet) != Side::Front || (!drawing.is_cut(facet) && drawing.is_edge_on(facet)) {
            out.shown.push(Shown::Nothing);
            return;
        }
        let is_whole = !drawing.is_cut(facet) && entries.of(facet).is_empty();
        if is_whole && drawing.grid.bounds().contains(&Rect::of(&drawing.outline(facet))) {
            out.shown.push(Shown::Whole);
            return;
        }
        let frame = OnFacet::new(&drawing.view, &drawing.mesh().facet(facet as usize));
        let polygons_before = out.polygon_facet.len();
        let narrow = NARROW * f64::from(drawing.grid.columns.max(drawing.grid.rows));
        for triangle in drawing.triangles(facet) {
            let outline = drawing.outline(triangle);
            let least_area = SLIVER * area(&outline);
            let around = |polygon: &[Point]| {
                let Rect { min, max } = Rect::of(polygon);
                max[0] - min[0] + max[1] - min[1]
            };
            // No polygon is longer than its facet: most need no closer look.
            let ample = narrow * around(&outline);
            let mut add = |polygon: &[Point]| {
                let area = area(polygon);
                if area > least_area && (area > ample || area > narrow * around(polygon)) {
                    out.uv.extend(polygon.iter().map(|p| frame.uv(*p)));
                    out.polygon_facet.push(number);
                    out.polygon_start.push(out.uv.len());
                }
            };
            let entries = entries.of(triangle);
            let mut next = 0;
            // Cells without an entry are wholly seen: they are joined along their row, so that a large facet has few polygons.
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
                while next < entries.len() && entries[next].1 == row {
                    let cells = &rows[row as usize];
                    let Entry { column, first, end, .. } = cells.entries[entries[next].2 as usize];
                    close_run(run, column, &mut add);
                    for i in first..end {
                        add(cells.polygon(i));
                    }
                    run = column + 1;
                    next += 1;
                }
                close_run(run, columns.end, &mut add);
            });
        }
        out.shown.push(if out.polygon_facet.len() == polygons_before { Shown::Nothing } else { Shown::Part });
    }
}
