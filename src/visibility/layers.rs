//! Who is seen where when there are two layers: a sheet of facets that covers a rectangle once, and others that overlap
//! the sheet but not one another, as a boulder does on its ground.
//!
//! No partition is needed then: what the others win, pair by pair, is what the sheet loses.

use super::candidate::Contender;
use super::partition::{Cutter, Ground, Won, least_area};
use super::visit::Visit;
use crate::geometry::index_u32;
use crate::geometry::polygon::{Point, Rect, area, clip_to_rect};

/// More pairs than this are left to be quartered first.
const MANY_PAIRS: usize = 4096;

/// A convex piece of a sheet's facet that another facet hides, a stretch of the points.
#[derive(Debug, Clone, Copy)]
struct Hidden {
    /// The sheet's facet, and the one that hides it.
    facet: u32,
    by: u32,
    start: u32,
    end: u32,
}

/// Two layers in one rectangle; kept to reuse its memory.
#[derive(Debug, Default)]
pub(super) struct Layers {
    /// Contenders, and their bounds: these are compared, each with each, before anything else is.
    sheet: Vec<(u32, Rect)>,
    others: Vec<(u32, Rect)>,
    hidden: Vec<Hidden>,
    points: Vec<Point>,
    clipped: Vec<Point>,
    spare: Vec<Point>,
    cutter: Cutter,
    rest: Rest,
}

impl Layers {
    /// Finds what is seen in the rectangle of the contenders in `list`, of which those that `in_sheet` names cover it once,
    /// and tells `visit`; or tells nothing, if the others may overlap one another.
    pub(super) fn resolve<V: Visit>(
        &mut self,
        ground: &Ground,
        list: &[u32],
        in_sheet: impl Fn(u32) -> bool,
        visit: &mut V,
    ) -> bool {
        let contenders = ground.contenders;
        self.sheet.clear();
        self.others.clear();
        for &i in list {
            let bounds = contenders[i as usize].bounds;
            if in_sheet(i) { self.sheet.push((i, bounds)) } else { self.others.push((i, bounds)) }
        }
        if self.others.len() * self.others.len().max(self.sheet.len()) > MANY_PAIRS || !self.are_apart(ground) {
            return false;
        }
        self.hidden.clear();
        self.points.clear();
        for k in 0..self.others.len() {
            self.insert(ground, self.others[k].0, visit);
        }
        self.hidden.sort_unstable_by_key(|h| (h.facet, h.start));
        let mut first = 0;
        for &(i, _) in &self.sheet {
            let count = self.hidden[first..].iter().take_while(|h| h.facet == i).count();
            let hidden = &self.hidden[first..first + count];
            first += count;
            let facet = &contenders[i as usize];
            if hidden.is_empty() || V::SIGNED {
                visit.whole(facet.triangle, ground.rect);
                for h in hidden {
                    visit.hidden(facet.triangle, ground.rect, &self.points[h.start as usize..h.end as usize]);
                }
            } else {
                visit.cut(facet.triangle, ground.rect);
                clip_to_rect(&facet.outline, ground.rect, &mut self.clipped, &mut self.spare);
                self.rest.start(&self.clipped);
                for h in hidden {
                    self.rest.lose(ground, facet, &contenders[h.by as usize], &mut self.cutter);
                }
                self.rest.pieces().for_each(|p| visit.piece(facet.triangle, ground.rect, p));
            }
        }
        true
    }

    /// Whether it is certain that no two of the others overlap in the rectangle.
    fn are_apart(&self, ground: &Ground) -> bool {
        let contender = |i: u32| &ground.contenders[i as usize];
        self.others.iter().enumerate().all(|(k, (i, bounds))| {
            let mut near = self.others[k + 1..].iter().filter(|(_, other)| bounds.overlaps(other));
            near.all(|(j, _)| are_apart(contender(*i), contender(*j), ground.rect))
        })
    }

    /// Gives a facet what it wins of the sheet.
    fn insert(&mut self, ground: &Ground, by: u32, visit: &mut impl Visit) {
        let other = &ground.contenders[by as usize];
        let (rect, least_area) = (ground.rect, least_area(ground.rect));
        clip_to_rect(&other.outline, rect, &mut self.clipped, &mut self.spare);
        if area(&self.clipped) <= least_area {
            return;
        }
        let bounds = Rect::of(&self.clipped);
        let first = self.hidden.len();
        let mut all = true;
        for &(i, _) in self.sheet.iter().filter(|(_, of_facet)| of_facet.overlaps(&bounds)) {
            let facet = &ground.contenders[i as usize];
            if !self.cutter.common(&self.clipped, facet, least_area) {
                continue;
            }
            let won = self.cutter.contest(ground.drawing, other, facet, least_area);
            all &= won == Won::All;
            if won != Won::Nothing {
                let start = index_u32(self.points.len());
                self.points.extend_from_slice(self.cutter.won());
                self.hidden.push(Hidden { facet: i, by, start, end: index_u32(self.points.len()) });
            }
        }
        if all {
            visit.whole(other.triangle, rect);
        } else {
            visit.cut(other.triangle, rect);
            for h in &self.hidden[first..] {
                visit.piece(other.triangle, rect, &self.points[h.start as usize..h.end as usize]);
            }
        }
    }
}

/// What is left of a facet, as convex pieces.
#[derive(Debug, Default)]
struct Rest {
    points: Vec<Point>,
    /// Stretches of the points.
    pieces: Vec<(u32, u32)>,
}

impl Rest {
    fn start(&mut self, polygon: &[Point]) {
        self.points.clear();
        self.pieces.clear();
        self.add(polygon);
    }

    fn add(&mut self, polygon: &[Point]) {
        let start = index_u32(self.points.len());
        self.points.extend_from_slice(polygon);
        self.pieces.push((start, index_u32(self.points.len())));
    }

    fn pieces(&self) -> impl Iterator<Item = &[Point]> {
        self.pieces.iter().map(|(start, end)| &self.points[*start as usize..*end as usize])
    }

    /// Takes away what another facet wins of this one.
    fn lose(&mut self, ground: &Ground, facet: &Contender, other: &Contender, cutter: &mut Cutter) {
        let least_area = least_area(ground.rect);
        let mut i = 0;
        // Pieces that are added lie beside the other facet and need not be looked at again.
        let mut before = self.pieces.len();
        while i < before {
            let (start, end) = self.pieces[i];
            let piece = &self.points[start as usize..end as usize];
            if !cutter.overlap(piece, other, least_area)
                || cutter.contest(ground.drawing, other, facet, least_area) == Won::Nothing
            {
                i += 1;
                continue;
            }
            cutter.kept().for_each(|p| self.add(p));
            self.pieces.remove(i);
            before -= 1;
        }
    }
}

/// Whether it is certain that two contenders whose bounds overlap do not overlap in a rectangle.
fn are_apart(one: &Contender, two: &Contender, rect: &Rect) -> bool {
    let beside = |a: &Contender, b: &Contender| a.sides.iter().any(|s| b.outline.iter().all(|p| s.side(*p) <= 0.0));
    one.continues(two) || !one.bounds.common(&two.bounds).overlaps(rect) || beside(one, two) || beside(two, one)
}
