//! Who is seen where in a cell: a partition of the cell, owned by the sky at first.
//!
//! Facets are inserted front to back. Each takes from the fragments that are there the part where it is nearer.
//! Against one owner the overlap is convex and nearness is affine over it, so one cut by "equal nearness" decides exactly;
//! facets that pierce each other and cyclic overlaps need no special case. The fragments always add up to the cell.

use super::coverage::Visit;
use super::drawing::Drawing;
use super::topology::NONE;
use crate::geometry::polygon::{Point, Rect, area, clip_to_rect, side, split};

const SKY: u32 = u32::MAX;
/// A piece below this share of the cell's area is not split off: what rounding leaves of touching facets, not a surface.
const SLIVER: f64 = 1e-15;
/// Forward error of a nearness, in units of eps x (magnitude of nearness + slope x magnitude of coordinates).
const DEPTH_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A triangle in the cell.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    triangle: u32,
    facet: u32,
    outline: [Point; 3],
    bounds: Rect,
    /// Nearness is anchor[2] + slope . (p - anchor).
    anchor: [f64; 3],
    slope: [f64; 2],
    /// Bound of the error of a nearness within the triangle.
    error: f64,
    /// Greatest nearness in the cell, with its error.
    nearest: f64,
    continuations: [u32; 3],
    /// Something of it is hidden.
    cut: bool,
}

/// A convex part of the cell and who is seen there.
#[derive(Debug, Clone, Copy)]
struct Fragment {
    owner: u32,
    start: u32,
    end: u32,
    bounds: Rect,
    /// Least nearness in it; what lies farther than this is hidden here.
    farthest: f64,
}

/// The partition of one cell; kept to reuse its memory.
#[derive(Debug, Default)]
pub(super) struct Partition {
    candidates: Vec<Candidate>,
    fragments: Vec<Fragment>,
    points: Vec<Point>,
    cutter: Cutter,
}

impl Partition {
    /// Finds what is seen in `rect` and tells `visit`.
    pub(super) fn resolve(&mut self, drawing: &Drawing, rect: &Rect, triangles: &[u32], visit: &mut impl Visit) {
        self.gather(drawing, rect, triangles);
        self.points.clear();
        self.fragments.clear();
        self.add(SKY, &rect.corners());
        let least_area = SLIVER * rect.area();
        let mut inserted = 0;
        while inserted < self.candidates.len() {
            let farthest_seen = self.fragments.iter().map(|f| f.farthest).fold(f64::INFINITY, f64::min);
            if self.candidates[inserted].nearest < farthest_seen {
                break;
            }
            self.insert(drawing, inserted, least_area);
            inserted += 1;
        }
        for candidate in &mut self.candidates[inserted..] {
            candidate.cut = true;
        }
        for candidate in &self.candidates {
            if candidate.cut {
                visit.cut(candidate.triangle, rect);
            } else {
                visit.whole(candidate.triangle, rect);
            }
        }
        for fragment in self.fragments.iter().filter(|f| f.owner != SKY && f.start < f.end) {
            let owner = &self.candidates[fragment.owner as usize];
            if owner.cut {
                visit.piece(owner.triangle, rect, &self.points[fragment.start as usize..fragment.end as usize]);
            }
        }
    }

    /// The triangles that have a share of the cell, nearest first.
    fn gather(&mut self, drawing: &Drawing, rect: &Rect, triangles: &[u32]) {
        self.candidates.clear();
        let clipped = &mut self.cutter.overlap;
        for &triangle in triangles {
            let outline = drawing.outline(triangle);
            clip_to_rect(&outline, rect, clipped, &mut self.cutter.spare);
            if area(clipped) > SLIVER * rect.area() {
                self.candidates.push(Candidate::new(drawing, triangle, outline, clipped));
            }
        }
        self.candidates.sort_by(|a, b| b.nearest.total_cmp(&a.nearest));
    }

    fn add(&mut self, owner: u32, polygon: &[Point]) {
        let start = self.points.len() as u32;
        self.points.extend_from_slice(polygon);
        let farthest = match self.candidates.get(owner as usize) {
            Some(c) => polygon.iter().map(|p| c.nearness(*p)).fold(f64::INFINITY, f64::min) - c.error,
            None => f64::NEG_INFINITY,
        };
        let end = self.points.len() as u32;
        self.fragments.push(Fragment { owner, start, end, bounds: Rect::of(polygon), farthest });
    }

    /// Gives a candidate what it wins of the fragments that are there.
    fn insert(&mut self, drawing: &Drawing, new: usize, least_area: f64) {
        for i in 0..self.fragments.len() {
            let fragment = self.fragments[i];
            let candidate = &self.candidates[new];
            if fragment.start == fragment.end || !fragment.bounds.overlaps(&candidate.bounds) {
                continue;
            }
            let owner = self.candidates.get(fragment.owner as usize);
            if let Some(owner) = owner
                && (candidate.continues(owner) || (candidate.cut && candidate.nearest < fragment.farthest))
            {
                continue;
            }
            let polygon = &self.points[fragment.start as usize..fragment.end as usize];
            if !self.cutter.overlap(polygon, candidate, least_area) {
                continue;
            }
            let verdict = match owner {
                None => Verdict::WinsAll,
                Some(owner) => self.cutter.contest(drawing, candidate, owner, least_area),
            };
            if verdict != Verdict::WinsAll {
                self.candidates[new].cut = true;
            }
            if verdict == Verdict::WinsNothing {
                continue;
            }
            if fragment.owner != SKY {
                self.candidates[fragment.owner as usize].cut = true;
            }
            self.fragments[i] = Fragment { end: fragment.start, farthest: f64::INFINITY, ..fragment };
            let cutter = std::mem::take(&mut self.cutter);
            self.add(new as u32, &cutter.overlap);
            let mut start = 0;
            for &end in &cutter.kept_end {
                self.add(fragment.owner, &cutter.kept[start..end]);
                start = end;
            }
            self.cutter = cutter;
        }
    }
}

impl Candidate {
    fn new(drawing: &Drawing, triangle: u32, outline: [Point; 3], clipped: &[Point]) -> Self {
        let [magnitude_xy, magnitude_near] = drawing.magnitude();
        let [a, b, c] = drawing.corners(triangle);
        let (bx, by, bz) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        let (cx, cy, cz) = (c[0] - a[0], c[1] - a[1], c[2] - a[2]);
        let det = bx * cy - by * cx;
        let slope = [(bz * cy - cz * by) / det, (bx * cz - cx * bz) / det];
        let size = bx.abs().max(cx.abs()).max(by.abs()).max(cy.abs());
        let products = (bz * cy).abs() + (cz * by).abs() + (bx * cz).abs() + (cx * bz).abs();
        let steep = slope[0].abs() + slope[1].abs();
        let error = DEPTH_ROUNDING * (magnitude_near + steep * magnitude_xy + products / det.abs() * size);
        let mut candidate = Candidate {
            triangle,
            facet: drawing.facet(triangle),
            outline,
            bounds: Rect::of(clipped),
            anchor: a,
            slope,
            error,
            nearest: 0.0,
            continuations: drawing.continuations(triangle),
            cut: false,
        };
        let nearest = clipped.iter().map(|p| candidate.nearness(*p)).fold(f64::NEG_INFINITY, f64::max);
        candidate.nearest = nearest + error;
        candidate
    }

    fn nearness(&self, p: Point) -> f64 {
        self.anchor[2] + self.slope[0] * (p[0] - self.anchor[0]) + self.slope[1] * (p[1] - self.anchor[1])
    }

    /// Whether two candidates cannot overlap: one facet, or facets that share an edge and face the same way.
    fn continues(&self, other: &Candidate) -> bool {
        self.facet == other.facet || (other.facet != NONE && self.continuations.contains(&other.facet))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    WinsAll,
    WinsSome,
    WinsNothing,
}

/// Cuts a fragment into what a candidate covers and what its owner keeps.
#[derive(Debug, Default)]
struct Cutter {
    overlap: Vec<Point>,
    spare: Vec<Point>,
    value: Vec<f64>,
    /// What the owner keeps: convex polygons, one after the other, and where each ends.
    kept: Vec<Point>,
    kept_end: Vec<usize>,
    outside: Vec<Point>,
}

impl Cutter {
    fn keep(&mut self, least_area: f64) {
        if area(&self.outside) > least_area {
            self.kept.extend_from_slice(&self.outside);
            self.kept_end.push(self.kept.len());
        }
    }

    /// Whether a candidate overlaps a fragment; leaves the overlap and what lies outside it.
    fn overlap(&mut self, polygon: &[Point], candidate: &Candidate, least_area: f64) -> bool {
        self.overlap.clear();
        self.overlap.extend_from_slice(polygon);
        self.kept.clear();
        self.kept_end.clear();
        for k in 0..3 {
            let (a, b) = (candidate.outline[k], candidate.outline[if k == 2 { 0 } else { k + 1 }]);
            self.value.clear();
            self.value.extend(self.overlap.iter().map(|p| side(a, b, *p)));
            if self.value.iter().all(|d| *d <= 0.0) {
                return false;
            }
            if self.value.iter().all(|d| *d >= 0.0) {
                continue;
            }
            split(&self.overlap, &self.value, &mut self.spare, &mut self.outside);
            std::mem::swap(&mut self.overlap, &mut self.spare);
            self.keep(least_area);
        }
        area(&self.overlap) > least_area
    }

    /// Who is nearer in the overlap; where both are, in parts, the overlap is reduced to what the candidate wins.
    fn contest(&mut self, drawing: &Drawing, candidate: &Candidate, owner: &Candidate, least_area: f64) -> Verdict {
        let error = candidate.error + owner.error;
        self.value.clear();
        self.value.extend(self.overlap.iter().map(|p| {
            let lead = candidate.nearness(*p) - owner.nearness(*p);
            if lead.abs() <= error { 0.0 } else { lead }
        }));
        let ahead = self.value.iter().any(|d| *d > 0.0);
        let behind = self.value.iter().any(|d| *d < 0.0);
        match (ahead, behind) {
            (true, false) => Verdict::WinsAll,
            (false, true) => Verdict::WinsNothing,
            (false, false) if drawing.rank(candidate.facet) < drawing.rank(owner.facet) => Verdict::WinsAll,
            (false, false) => Verdict::WinsNothing,
            (true, true) => {
                split(&self.overlap, &self.value, &mut self.spare, &mut self.outside);
                if area(&self.spare) <= least_area {
                    return Verdict::WinsNothing;
                }
                std::mem::swap(&mut self.overlap, &mut self.spare);
                self.keep(least_area);
                Verdict::WinsSome
            }
        }
    }
}
