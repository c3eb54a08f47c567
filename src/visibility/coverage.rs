//! Exact visible area: which part of which facet is seen in each cell.
//!
//! A cell that no open edge crosses holds the same number of layers everywhere (an edge that is not open only passes
//! from a facet to its continuation). If that number, counted at the cell's centre, is one, everything in the cell is seen;
//! nothing needs to be compared. Elsewhere what lies behind the nearest [whole sheet](Front) is set aside; if more than that
//! sheet is left, the cell is quartered until few facets remain, then [partitioned](super::partition).

use rayon::prelude::*;
use robust::{Coord, orient2d};

use super::bins::Bins;
use super::candidate::{Candidate, Contender, Plane};
use super::drawing::{Drawing, Side};
use super::layers::Layers;
use super::partition::{Ground, Partition};
use super::topology::NONE;
use super::visit::Visit;
use crate::error::Result;
use crate::geometry::index_u32;
use crate::geometry::polygon::{Line, Point, Rect};
use crate::progress::Pulse;

/// A cell with more triangles than this is quartered, if quartering helps.
const FEW: usize = 12;
/// Quartering is worthwhile if the quarters list their triangles at most this many times.
const WORTHWHILE: f64 = 1.8;
/// Above this many triangles a cell is quartered even if they are listed up to ...
const MANY: usize = 64;
/// ... this many times (more often, they are layers on one another, as many in every quarter), down to ...
const HOPELESS: f64 = 2.5;
/// ... this depth.
const DEEP: u32 = 8;
/// A cell is quartered at most this often: 4^-25 of a cell is below the rounding of its area.
const DEEPEST: u32 = 25;

/// The drawing, sorted into cells: ready to be asked what is seen in each.
#[derive(Debug)]
pub struct Coverage<'a> {
    drawing: &'a Drawing<'a>,
    bins: Bins,
    /// Cells with exactly one layer everywhere, or none.
    settled: Vec<bool>,
}

/// A part of a cell: where, how deep, and its stretch of the list of candidates.
type Part = (Rect, u32, usize, usize);

/// Working memory of a thread.
#[derive(Debug)]
pub struct Scratch<'a> {
    pulse: Pulse<'a>,
    triangles: Vec<u32>,
    candidates: Vec<Candidate>,
    /// In the places of their candidates. The places of hidden ones hold leftovers, which no list names.
    contenders: Vec<Contender>,
    list: Vec<u32>,
    stack: Vec<Part>,
    waiting: Vec<u32>,
    front: Front,
    layers: Layers,
    partition: Partition,
}

impl<'a> Scratch<'a> {
    /// Working memory; `pulse` is asked while a cell is processed.
    pub fn new(pulse: Pulse<'a>) -> Self {
        Scratch {
            pulse,
            triangles: vec![],
            candidates: vec![],
            contenders: vec![],
            list: vec![],
            stack: vec![],
            waiting: vec![],
            front: Front::default(),
            layers: Layers::default(),
            partition: Partition::default(),
        }
    }
}

impl<'a> Coverage<'a> {
    /// Sorts a drawing's triangles into its cells, and finds those that one layer covers, or none.
    pub fn new(drawing: &'a Drawing<'a>) -> Self {
        let bins = Bins::new(drawing);
        let columns = drawing.grid.columns as usize;
        let mut settled = vec![false; columns * drawing.grid.rows as usize];
        settled.par_chunks_mut(columns.max(1)).enumerate().for_each(|(row, settled)| {
            // No open edge between two such cells: what is counted in one holds in the other.
            let mut layers = None;
            for (column, settled) in settled.iter_mut().enumerate() {
                let rect = drawing.grid.cell(index_u32(column), index_u32(row));
                let cell = row * columns + column;
                layers = if bins.triangles(cell).any(|t| open_edge_crosses(drawing, t, &rect)) {
                    None
                } else {
                    Some(layers.unwrap_or_else(|| layers_at(drawing, bins.triangles(cell), rect.centre())))
                };
                *settled = matches!(layers, Some(0 | 1));
            }
        });
        Coverage { drawing, bins, settled }
    }

    /// The drawing.
    pub fn drawing(&self) -> &'a Drawing<'a> {
        self.drawing
    }

    /// Tells `visit` what is seen in a cell.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if the watch of `scratch` asks to stop.
    pub fn cell<V: Visit>(&self, column: u32, row: u32, scratch: &mut Scratch, visit: &mut V) -> Result<()> {
        let cell = row as usize * self.drawing.grid.columns as usize + column as usize;
        let Scratch { pulse, triangles, candidates, contenders, list, stack, waiting, front, layers, partition } =
            scratch;
        self.bins.cell(cell, triangles);
        let rect = self.drawing.grid.cell(column, row);
        if self.settled[cell] {
            visit.settled(triangles, &rect);
            return Ok(());
        }
        candidates.clear();
        candidates.extend(triangles.iter().map(|t| Candidate::new(self.drawing, *t)));
        Candidate::link(candidates);
        // The stack holds rectangles with their candidates, a stretch of `waiting` each; the last one is the last stretch.
        waiting.clear();
        waiting.extend(0..index_u32(candidates.len()));
        stack.clear();
        stack.push((rect, 0, 0, waiting.len()));
        while let Some((rect, depth, from, to)) = stack.pop() {
            list.clear();
            list.extend_from_slice(&waiting[from..to]);
            waiting.truncate(from);
            if list.is_empty() {
                continue;
            }
            pulse.beat(list.len())?;
            front.find(self.drawing, &rect, candidates, list);
            if depth == 0 && list.len() > MANY && front.sees_copies(candidates) {
                let originals = originals(self.drawing, triangles);
                list.retain(|i| {
                    let original = originals[*i as usize];
                    if !original {
                        visit.cut(candidates[*i as usize].triangle, &rect);
                    }
                    original
                });
                front.find(self.drawing, &rect, candidates, list);
            }
            list.retain(|i| {
                let hidden = front.hides(*i, &candidates[*i as usize]);
                if hidden {
                    visit.cut(candidates[*i as usize].triangle, &rect);
                }
                !hidden
            });
            if list.len() == front.sheet.len() {
                list.iter().for_each(|i| visit.whole(candidates[*i as usize].triangle, &rect));
                continue;
            }
            if depth == 0 {
                make_contenders(self.drawing, candidates, list, contenders);
            }
            let ground = Ground { drawing: self.drawing, rect: &rect, contenders };
            if depth == DEEPEST {
                let nearest = front.at_centre.first();
                nearest.into_iter().for_each(|i| visit.whole(candidates[*i as usize].triangle, &rect));
            } else if !front.sheet.is_empty() && layers.resolve(&ground, list, |i| front.has(i), visit) {
                // Two layers: reported.
            } else if list.len() <= FEW || !quarter(&rect, depth, list, contenders, waiting, stack) {
                partition.resolve(&ground, list, &front.sheet, pulse, visit)?;
            }
        }
        Ok(())
    }
}

/// Makes contenders of the candidates in `list`, in their places.
fn make_contenders(drawing: &Drawing, candidates: &[Candidate], list: &[u32], contenders: &mut Vec<Contender>) {
    if let (Some(first), true) = (list.first(), contenders.len() < candidates.len()) {
        contenders.resize(candidates.len(), Contender::new(drawing, &candidates[*first as usize]));
    }
    for &i in list {
        contenders[i as usize] = Contender::new(drawing, &candidates[i as usize]);
    }
}

/// Whether one of a triangle's sides that are open may cross a cell.
pub(super) fn open_edge_crosses(drawing: &Drawing, triangle: u32, rect: &Rect) -> bool {
    let open = drawing.open_sides(triangle);
    open != 0 && open_side_crosses(open, &drawing.outline(triangle), rect)
}

/// How many triangles cover a point.
fn layers_at(drawing: &Drawing, triangles: impl Iterator<Item = u32>, at: Point) -> usize {
    triangles.filter(|t| covers(&drawing.outline(*t), at)).count()
}

/// For each triangle of a cell whether it is not the copy of one that hides it: of those drawn alike, to the last bit and from the same
/// side, one wins every tie.
fn originals(drawing: &Drawing, triangles: &[u32]) -> Vec<bool> {
    let key = |t: u32| {
        let mut corners = drawing.corners(t).map(|p| p.map(|x| (x + 0.0).to_bits()));
        corners.sort_unstable();
        (corners, drawing.side(t) == Side::Front)
    };
    let mut by_place: Vec<_> = triangles.iter().enumerate().map(|(i, t)| (key(*t), i)).collect();
    by_place.sort_unstable();
    let mut originals = vec![false; triangles.len()];
    for copies in by_place.chunk_by(|a, b| a.0 == b.0) {
        let original = match copies {
            [(_, only)] => Some(*only),
            _ => copies.iter().map(|c| c.1).min_by_key(|i| drawing.rank(drawing.facet(triangles[*i]))),
        };
        original.into_iter().for_each(|i| originals[i] = true);
    }
    originals
}

/// The nearest sheet of facets that hang together and cover a rectangle once, without an open edge in it.
///
/// What lies behind all of it is hidden and need not be looked at further.
#[derive(Debug, Default)]
struct Front {
    /// Candidates that cover the centre, nearest first.
    at_centre: Vec<u32>,
    /// The same with their nearness there.
    by_nearness: Vec<(f64, u32)>,
    /// The sheet; empty if there is none.
    sheet: Vec<u32>,
    /// For each candidate the number of the last search in which it was listed, covered the centre, and joined a sheet.
    listed: Vec<u32>,
    central: Vec<u32>,
    joined: Vec<u32>,
    search: u32,
    /// Least nearness in the sheet.
    farthest: f64,
}

impl Front {
    fn find(&mut self, drawing: &Drawing, rect: &Rect, candidates: &[Candidate], list: &[u32]) {
        let centre = rect.centre();
        if self.listed.len() < candidates.len() {
            self.listed.resize(candidates.len(), 0);
            self.central.resize(candidates.len(), 0);
            self.joined.resize(candidates.len(), 0);
        }
        self.next_search();
        self.at_centre.clear();
        self.sheet.clear();
        self.farthest = f64::NEG_INFINITY;
        for &i in list {
            self.listed[i as usize] = self.search;
            if covers(&candidates[i as usize].outline, centre) {
                self.at_centre.push(i);
                self.central[i as usize] = self.search;
            }
        }
        if self.at_centre.len() > 1 {
            let plane = |i: u32| Plane::through(drawing.corners(candidates[i as usize].triangle));
            self.by_nearness.clear();
            self.by_nearness.extend(self.at_centre.iter().map(|i| (plane(*i).nearness(centre), *i)));
            self.by_nearness.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            self.at_centre.clear();
            self.at_centre.extend(self.by_nearness.iter().map(|(_, i)| *i));
        }
        let listing = self.search;
        for first in 0..self.at_centre.len() {
            if self.grow(rect, candidates, listing, first) {
                let farthest = self.sheet.iter().map(|i| candidates[*i as usize].farthest);
                // Corners are projected with this error; strictly separate ranges of nearness then mean separate surfaces.
                self.farthest = farthest.fold(f64::INFINITY, f64::min) - 8.0 * f64::EPSILON * drawing.magnitude()[1];
                return;
            }
            self.sheet.clear();
        }
    }

    /// Whether two that cover the centre may be drawn alike.
    fn sees_copies(&self, candidates: &[Candidate]) -> bool {
        let extent = |i: &u32| {
            let c = &candidates[*i as usize];
            (c.nearest, c.farthest, c.bounds)
        };
        self.at_centre.windows(2).any(|w| extent(&w[0]) == extent(&w[1]))
    }

    /// Follows a facet to its continuations. Whether they make a sheet that covers the rectangle once.
    fn grow(&mut self, rect: &Rect, candidates: &[Candidate], listing: u32, first: usize) -> bool {
        let first = self.at_centre[first];
        if self.joined[first as usize] > listing {
            // Part of a sheet that failed.
            return false;
        }
        self.search += 1;
        self.sheet.push(first);
        self.joined[first as usize] = self.search;
        let mut grown = 0;
        while grown < self.sheet.len() {
            let member = &candidates[self.sheet[grown] as usize];
            grown += 1;
            if member.open != 0 && open_side_crosses(member.open, &member.outline, rect) {
                return false;
            }
            for i in member.beside {
                if i == NONE {
                    continue;
                }
                let i = i as usize;
                if self.listed[i] != listing {
                    // Beside the rectangle, or found hidden before the cell was quartered: then the sheet is not whole.
                    if candidates[i].may_touch(rect) {
                        return false;
                    }
                } else if self.joined[i] < self.search {
                    if self.joined[i] > listing || self.central[i] == listing {
                        return false;
                    }
                    self.joined[i] = self.search;
                    self.sheet.push(index_u32(i));
                }
            }
        }
        true
    }

    /// Numbers of searches only grow; before they run out, all is forgotten.
    fn next_search(&mut self) {
        if self.search > u32::MAX / 2 {
            self.listed.fill(0);
            self.central.fill(0);
            self.joined.fill(0);
            self.search = 0;
        }
        self.search += 1;
    }

    /// Whether a candidate lies behind the whole sheet.
    fn hides(&self, i: u32, candidate: &Candidate) -> bool {
        candidate.nearest < self.farthest && !self.has(i)
    }

    /// Whether a candidate belongs to the sheet that was found.
    fn has(&self, i: u32) -> bool {
        self.joined[i as usize] == self.search && !self.sheet.is_empty()
    }
}

/// Quarters a rectangle, unless its candidates would only be listed again and again: a bundle of slivers
/// seen edge-on is as thick in every part of it.
fn quarter(
    rect: &Rect,
    depth: u32,
    list: &[u32],
    contenders: &[Contender],
    waiting: &mut Vec<u32>,
    stack: &mut Vec<Part>,
) -> bool {
    let (listed, stacked) = (waiting.len(), stack.len());
    for quarter in rect.quarters() {
        let from = waiting.len();
        waiting.extend(list.iter().copied().filter(|&i| contenders[i as usize].may_touch(&quarter)));
        stack.push((quarter, depth + 1, from, waiting.len()));
    }
    let times = (waiting.len() - listed) as f64 / list.len() as f64;
    if times <= WORTHWHILE || (times <= HOPELESS && list.len() > MANY && depth < DEEP) {
        return true;
    }
    waiting.truncate(listed);
    stack.truncate(stacked);
    false
}

/// Whether one of the sides of an outline that `open` names (bit k: from corner k on) may cross a rectangle.
fn open_side_crosses(open: u8, outline: &[Point; 3], rect: &Rect) -> bool {
    (0..3).any(|k| open >> k & 1 == 1 && may_cross(outline[k], outline[(k + 1) % 3], rect))
}

/// Whether a segment may cross a rectangle; errs on the side of yes.
fn may_cross(a: Point, b: Point, rect: &Rect) -> bool {
    if !(a[0].min(b[0]) <= rect.max[0]
        && a[0].max(b[0]) >= rect.min[0]
        && a[1].min(b[1]) <= rect.max[1]
        && a[1].max(b[1]) >= rect.min[1])
    {
        return false;
    }
    !Line::through(a, b).passes_by(rect)
}

/// Whether a counter-clockwise triangle holds a point, in exact arithmetic. A point on a shared edge belongs to one side:
/// it is looked at as if moved by (e, e^2), e infinitesimal.
fn covers(outline: &[Point; 3], p: Point) -> bool {
    let lowest = |k: usize| outline[0][k].min(outline[1][k]).min(outline[2][k]);
    let highest = |k: usize| outline[0][k].max(outline[1][k]).max(outline[2][k]);
    if p[0] < lowest(0) || p[0] > highest(0) || p[1] < lowest(1) || p[1] > highest(1) {
        return false;
    }
    let coord = |p: Point| Coord { x: p[0], y: p[1] };
    (0..3).all(|k| {
        let (a, b) = (outline[k], outline[(k + 1) % 3]);
        let turn = orient2d(coord(a), coord(b), coord(p));
        if turn != 0.0 {
            return turn > 0.0;
        }
        // d(turn) = -(b.y - a.y) e + (b.x - a.x) e^2
        if a[1] != b[1] { b[1] < a[1] } else { b[0] > a[0] }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_on_a_shared_edge_belongs_to_one_triangle() {
        let (a, b, c, d) = ([0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]);
        for p in [[0.5, 0.5], [0.25, 0.25], [0.5, 0.25]] {
            assert_eq!(u8::from(covers(&[a, b, c], p)) + u8::from(covers(&[a, c, d], p)), 1);
        }
        // Four triangles around a centre: the centre belongs to one of them.
        let m = [0.5, 0.5];
        let fan = [[a, b, m], [b, c, m], [c, d, m], [d, a, m]];
        assert_eq!(fan.iter().filter(|t| covers(t, m)).count(), 1);
    }

    #[test]
    fn a_segment_beside_a_cell_does_not_cross_it() {
        let rect = Rect { min: [0.0, 0.0], max: [1.0, 1.0] };
        assert!(may_cross([-1.0, 0.5], [2.0, 0.6], &rect));
        assert!(!may_cross([-1.0, 1.5], [2.0, 1.1], &rect));
        assert!(!may_cross([0.9, -1.0], [3.0, 1.0], &rect));
    }
}
