//! Who is seen where in a cell: a partition of the cell, owned by the sky at first.
//!
//! Facets are inserted front to back. Each takes from the fragments that are there the part where it is nearer.
//! Against one owner the overlap is convex and nearness is affine over it, so one cut by "equal nearness" decides exactly;
//! facets that pierce each other and cyclic overlaps need no special case. The fragments always add up to the cell.

use super::candidate::Contender;
use super::drawing::Drawing;
use super::visit::Visit;
use crate::error::Result;
use crate::geometry::index_u32;
use crate::geometry::polygon::{Point, Rect, area, clip_to_rect, clip_to_sides, split};
use crate::progress::Pulse;

const SKY: u32 = u32::MAX;
/// A piece below this share of the cell's area is not split off: what rounding leaves of touching facets, not a surface.
const SLIVER: f64 = 1e-15;
/// Facets are close if nowhere one leads by more than this, in units of that error: another view may take them to be tied.
const CLOSE: f64 = 4096.0;

/// A contender's part in the rectangle at hand.
#[derive(Debug, Clone, Copy)]
struct Share {
    contender: u32,
    bounds: Rect,
    /// Greatest nearness there, with its error.
    nearest: f64,
    /// Clipped polygon, a stretch of the partition's points.
    start: u32,
    end: u32,
    /// Something of it is hidden.
    cut: bool,
    /// Already in the partition.
    placed: bool,
}

/// A convex part of the rectangle and what is seen there: a share, or the sky.
#[derive(Debug, Clone, Copy)]
struct Fragment {
    owner: u32,
    start: u32,
    end: u32,
    bounds: Rect,
    /// Least nearness in it; what lies farther than this is hidden here.
    farthest: f64,
}

/// What is contested: a rectangle, and all that may be seen in it. Contenders stand in the places of their candidates; the places of hidden
/// candidates hold leftovers, which are not to be read.
pub(super) struct Ground<'a> {
    pub(super) drawing: &'a Drawing<'a>,
    pub(super) rect: &'a Rect,
    pub(super) contenders: &'a [Contender],
}

/// The partition of one rectangle; kept to reuse its memory.
#[derive(Debug, Default)]
pub(super) struct Partition {
    shares: Vec<Share>,
    fragments: Vec<Fragment>,
    points: Vec<Point>,
    cutter: Cutter,
}

impl Partition {
    /// Finds what is seen in the rectangle of the contenders in `list` and tells `visit`.
    ///
    /// `sheet`: contenders that cover the rectangle once, without overlap; empty if none are known to.
    ///
    /// # Errors
    /// [`Error::Interrupted`](crate::Error::Interrupted) if the watch of `pulse` asks to stop.
    pub(super) fn resolve(
        &mut self,
        ground: &Ground,
        list: &[u32],
        sheet: &[u32],
        pulse: &mut Pulse,
        visit: &mut impl Visit,
    ) -> Result<()> {
        let Ground { rect, contenders, .. } = ground;
        let least_area = least_area(rect);
        self.fragments.clear();
        self.gather(rect, contenders, list, least_area);
        if sheet.is_empty() {
            let start = index_u32(self.points.len());
            self.points.extend(rect.corners());
            let end = index_u32(self.points.len());
            self.fragments.push(Fragment { owner: SKY, start, end, bounds: **rect, farthest: f64::NEG_INFINITY });
        } else {
            self.start_with(sheet, contenders);
        }
        let mut next = 0;
        while next < self.shares.len() {
            if !self.shares[next].placed {
                pulse.beat(self.fragments.len())?;
                let farthest_seen = self.fragments.iter().map(|f| f.farthest).fold(f64::INFINITY, f64::min);
                if self.shares[next].nearest < farthest_seen {
                    break;
                }
                self.insert(ground, next, least_area);
            }
            next += 1;
        }
        for share in self.shares[next..].iter_mut().filter(|s| !s.placed) {
            share.cut = true;
        }
        for share in &self.shares {
            let triangle = contenders[share.contender as usize].triangle;
            if share.cut {
                visit.cut(triangle, rect);
            } else {
                visit.whole(triangle, rect);
            }
        }
        // One facet after the other, so that the visitor turns to each once.
        self.fragments.retain(|f| f.owner != SKY && f.start < f.end);
        self.fragments.sort_unstable_by_key(|f| (f.owner, f.start));
        for fragment in &self.fragments {
            let owner = &self.shares[fragment.owner as usize];
            if owner.cut {
                let polygon = &self.points[fragment.start as usize..fragment.end as usize];
                visit.piece(contenders[owner.contender as usize].triangle, rect, polygon);
            }
        }
        Ok(())
    }

    /// The contenders that have a share of the rectangle, nearest first.
    fn gather(&mut self, rect: &Rect, contenders: &[Contender], list: &[u32], least_area: f64) {
        self.shares.clear();
        self.points.clear();
        let clipped = &mut self.cutter.overlap;
        for &i in list {
            let contender = &contenders[i as usize];
            clip_to_rect(&contender.outline, rect, clipped, &mut self.cutter.spare);
            if area(clipped) <= least_area {
                continue;
            }
            let start = index_u32(self.points.len());
            self.points.extend_from_slice(clipped);
            let nearest = clipped.iter().map(|p| contender.nearness(*p)).fold(f64::NEG_INFINITY, f64::max);
            self.shares.push(Share {
                contender: i,
                bounds: Rect::of(clipped),
                nearest: nearest + contender.error,
                start,
                end: index_u32(self.points.len()),
                cut: false,
                placed: false,
            });
        }
        self.shares.sort_by(|a, b| b.nearest.total_cmp(&a.nearest));
    }

    /// Starts from a sheet: its facets are the fragments as they are, where the sky would first have to be cut up.
    fn start_with(&mut self, sheet: &[u32], contenders: &[Contender]) {
        for i in 0..self.shares.len() {
            let Share { contender, start, end, bounds, .. } = self.shares[i];
            if sheet.contains(&contender) {
                self.shares[i].placed = true;
                let farthest = self.farthest(&contenders[contender as usize], start, end);
                self.fragments.push(Fragment { owner: index_u32(i), start, end, bounds, farthest });
            }
        }
    }

    /// Least nearness of a contender at some points, with its error.
    fn farthest(&self, contender: &Contender, start: u32, end: u32) -> f64 {
        let points = &self.points[start as usize..end as usize];
        points.iter().map(|p| contender.nearness(*p)).fold(f64::INFINITY, f64::min) - contender.error
    }

    /// Gives a share what it wins of the fragments that are there.
    fn insert(&mut self, ground: &Ground, new: usize, least_area: f64) {
        let Ground { drawing, contenders, .. } = ground;
        let Share { contender, bounds, nearest, .. } = self.shares[new];
        let contender = &contenders[contender as usize];
        for i in 0..self.fragments.len() {
            let fragment = self.fragments[i];
            if fragment.start == fragment.end || !fragment.bounds.overlaps(&bounds) {
                continue;
            }
            let owner = self.shares.get(fragment.owner as usize).map(|s| &contenders[s.contender as usize]);
            if let Some(owner) = owner
                && (contender.continues(owner) || (self.shares[new].cut && nearest < fragment.farthest))
            {
                continue;
            }
            let polygon = &self.points[fragment.start as usize..fragment.end as usize];
            if !self.cutter.overlap(polygon, contender, least_area) {
                continue;
            }
            let verdict = match owner {
                None => Won::All,
                Some(owner) => self.cutter.contest(drawing, contender, owner, least_area),
            };
            if verdict != Won::All {
                self.shares[new].cut = true;
            }
            if verdict == Won::Nothing {
                continue;
            }
            if fragment.owner != SKY {
                self.shares[fragment.owner as usize].cut = true;
            }
            self.fragments[i] = Fragment { end: fragment.start, farthest: f64::INFINITY, ..fragment };
            self.add(index_u32(new), Some(contender), Cut::Overlap);
            for k in 0..self.cutter.kept_end.len() {
                self.add(fragment.owner, owner, Cut::Kept(k));
            }
        }
    }

    /// Adds what the cutter has cut as a fragment.
    fn add(&mut self, owner: u32, contender: Option<&Contender>, cut: Cut) {
        let polygon = self.cutter.polygon(cut);
        let start = index_u32(self.points.len());
        self.points.extend_from_slice(polygon);
        let end = index_u32(self.points.len());
        let bounds = Rect::of(polygon);
        let farthest = contender.map_or(f64::NEG_INFINITY, |c| self.farthest(c, start, end));
        self.fragments.push(Fragment { owner, start, end, bounds, farthest });
    }
}

/// What the cutter holds: the overlap, or the n-th polygon that the owner keeps.
#[derive(Clone, Copy)]
enum Cut {
    Overlap,
    Kept(usize),
}

/// A piece of a rectangle with less area than this is none.
pub(super) fn least_area(rect: &Rect) -> f64 {
    SLIVER * rect.area()
}

/// What a contender wins of an overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Won {
    All,
    Some,
    Nothing,
}

/// Cuts a fragment into what a contender covers and what its owner keeps.
#[derive(Debug, Default)]
pub(super) struct Cutter {
    overlap: Vec<Point>,
    spare: Vec<Point>,
    value: Vec<f64>,
    /// Of each side of the contender.
    distance: [Vec<f64>; 3],
    /// What the owner keeps: convex polygons, one after the other, and where each ends.
    kept: Vec<Point>,
    kept_end: Vec<usize>,
    outside: Vec<Point>,
}

impl Cutter {
    fn polygon(&self, cut: Cut) -> &[Point] {
        match cut {
            Cut::Overlap => &self.overlap,
            Cut::Kept(k) => &self.kept[if k == 0 { 0 } else { self.kept_end[k - 1] }..self.kept_end[k]],
        }
    }

    /// What the owner keeps, as convex polygons.
    pub(super) fn kept(&self) -> impl Iterator<Item = &[Point]> {
        (0..self.kept_end.len()).map(|k| self.polygon(Cut::Kept(k)))
    }

    fn keep(&mut self, least_area: f64) {
        if area(&self.outside) > least_area {
            self.kept.extend_from_slice(&self.outside);
            self.kept_end.push(self.kept.len());
        }
    }

    /// What a contender has won.
    pub(super) fn won(&self) -> &[Point] {
        &self.overlap
    }

    /// Whether a contender overlaps a polygon; leaves the overlap.
    pub(super) fn common(&mut self, polygon: &[Point], contender: &Contender, least_area: f64) -> bool {
        self.kept.clear();
        self.kept_end.clear();
        clip_to_sides(polygon, &contender.sides, &mut self.overlap, &mut self.spare);
        area(&self.overlap) > least_area
    }

    /// Whether a contender overlaps a fragment; leaves the overlap and what lies outside it.
    pub(super) fn overlap(&mut self, polygon: &[Point], contender: &Contender, least_area: f64) -> bool {
        let mut crosses = [false; 3];
        for ((distance, line), crosses) in self.distance.iter_mut().zip(&contender.sides).zip(&mut crosses) {
            let (mut some_inside, mut some_outside) = (false, false);
            distance.clear();
            distance.extend(polygon.iter().map(|p| {
                let d = line.side(*p);
                some_inside |= d > 0.0;
                some_outside |= d < 0.0;
                d
            }));
            if !some_inside {
                return false;
            }
            *crosses = some_outside;
        }
        self.overlap.clear();
        self.overlap.extend_from_slice(polygon);
        self.kept.clear();
        self.kept_end.clear();
        let mut whole = true;
        for k in (0..3).filter(|k| crosses[*k]) {
            if !whole {
                let line = &contender.sides[k];
                self.distance[k].clear();
                self.distance[k].extend(self.overlap.iter().map(|p| line.side(*p)));
            }
            let distance = &self.distance[k];
            if distance.iter().all(|d| *d <= 0.0) {
                return false;
            }
            if distance.iter().all(|d| *d >= 0.0) {
                continue;
            }
            split(&self.overlap, distance, &mut self.spare, &mut self.outside);
            std::mem::swap(&mut self.overlap, &mut self.spare);
            self.keep(least_area);
            whole = false;
        }
        area(&self.overlap) > least_area
    }

    /// Who is nearer in the overlap; where both are, in parts, the overlap is reduced to what the contender wins.
    pub(super) fn contest(
        &mut self,
        drawing: &Drawing,
        contender: &Contender,
        owner: &Contender,
        least_area: f64,
    ) -> Won {
        let error = contender.error + owner.error;
        self.value.clear();
        let mut largest = 0.0_f64;
        self.value.extend(self.overlap.iter().map(|p| {
            let lead = contender.nearness(*p) - owner.nearness(*p);
            largest = largest.max(lead.abs());
            if lead.abs() <= error { 0.0 } else { lead }
        }));
        if largest <= CLOSE * error
            && let Some(before) = drawing.is_before(contender.facet, owner.facet)
        {
            return if before { Won::All } else { Won::Nothing };
        }
        let ahead = self.value.iter().any(|d| *d > 0.0);
        let behind = self.value.iter().any(|d| *d < 0.0);
        match (ahead, behind) {
            (true, false) => Won::All,
            (false, true) => Won::Nothing,
            (false, false) if drawing.goes_before(contender.facet, owner.facet) => Won::All,
            (false, false) => Won::Nothing,
            (true, true) => {
                split(&self.overlap, &self.value, &mut self.spare, &mut self.outside);
                if area(&self.spare) <= least_area {
                    return Won::Nothing;
                }
                std::mem::swap(&mut self.overlap, &mut self.spare);
                self.keep(least_area);
                Won::Some
            }
        }
    }
}
