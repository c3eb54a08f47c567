//! The signed pieces that a pixel's entries are made of, for callers who need more than their areas.

use crate::geometry::index_u32;
use crate::geometry::polygon::Point;

/// The convex pieces that a pixel's entries are made of: outer sides only, and only if they are kept.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    pub(super) are_kept: bool,
    /// Facet, sign (-1: taken away again), and end of the outline among the points.
    pieces: Vec<(u32, f64, usize)>,
    points: Vec<Point>,
    /// Pieces by facet, and the first of each entry.
    order: Vec<u32>,
    first: Vec<u32>,
}

impl Pieces {
    pub(super) fn clear(&mut self) {
        self.pieces.clear();
        self.points.clear();
    }

    pub(super) fn add(&mut self, facet: u32, sign: f64, outline: &[Point]) {
        if self.are_kept {
            self.points.extend_from_slice(outline);
            self.pieces.push((facet, sign, self.points.len()));
        }
    }

    /// Sorts the pieces by facet, for entries of these facets, ascending.
    pub(super) fn sort(&mut self, facets: impl Iterator<Item = u32>) {
        self.order.clear();
        self.order.extend(0..index_u32(self.pieces.len()));
        let pieces = &self.pieces;
        self.order.sort_by_key(|i| pieces[*i as usize].0);
        self.first.clear();
        let mut at = 0;
        for facet in facets {
            while at < self.order.len() && pieces[self.order[at] as usize].0 < facet {
                at += 1;
            }
            self.first.push(index_u32(at));
        }
        self.first.push(index_u32(self.order.len()));
    }

    /// The pieces of an entry: to be had one by one.
    pub(super) fn of(&self, entry: usize) -> std::ops::Range<usize> {
        self.first[entry] as usize..self.first[entry + 1] as usize
    }

    /// Whose a piece is, its sign, and its outline.
    pub(super) fn get(&self, k: usize) -> (u32, f64, &[Point]) {
        let i = self.order[k] as usize;
        let (facet, sign, end) = self.pieces[i];
        let start = if i == 0 { 0 } else { self.pieces[i - 1].2 };
        (facet, sign, &self.points[start..end])
    }
}
