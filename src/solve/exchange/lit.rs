//! How parts of a facet are lit, to be looked up: each line that leaves it asks.

use rayon::prelude::*;

use crate::geometry::Mesh;
use crate::geometry::polygon::Point;
use crate::product::Lighting;
use crate::visibility::{Seen, Shown};

/// What of the light of each of the first sources a place has: to 1/255, more than a Sun of some tens of points can tell.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lit([u8; SOURCES]);

/// Sources of which it is known.
const SOURCES: usize = 8;
/// Into how many parts each side of a facet of mean area is cut, and that of any facet at most: powers of 2.
const SIDE: f64 = 4.0;
const MOST_SIDE: f64 = 64.0;
/// Facets of which parts are found together, by one thread.
const CHUNK: usize = 4096;

impl Lit {
    /// Of shares from 0 to 1.
    #[expect(clippy::cast_possible_truncation, reason = "a share is at most 1")]
    fn new(shares: &[f64; SOURCES]) -> Self {
        Lit(shares.map(|share| (255.0 * share).round() as u8))
    }

    /// Of a source; `None` if it is not one of the first.
    pub(super) fn by(self, source: usize) -> Option<f64> {
        self.0.get(source).map(|lit| f64::from(*lit) / 255.0)
    }
}

/// All facets, each in one part, or in side x side ones where it is lit in part.
#[derive(Debug)]
pub(super) struct LitParts {
    /// Where the parts of each facet begin; then the number of all.
    start: Vec<usize>,
    parts: Vec<Lit>,
}

impl LitParts {
    pub(super) fn new(mesh: &Mesh, areas_m2: &[f64], sources: &[Lighting]) -> Self {
        let seen: Vec<Option<&Seen>> = sources.iter().take(SOURCES).map(Lighting::seen).collect();
        let mean_m2 = areas_m2.iter().sum::<f64>() / areas_m2.len().max(1) as f64;
        let chunk = |first: usize| {
            let facets = first..(first + CHUNK).min(mesh.facets.len());
            let (mut counts, mut parts) = (Vec::with_capacity(CHUNK), Vec::with_capacity(CHUNK));
            for facet in facets {
                let before = parts.len();
                of_facet(&seen, facet, side(areas_m2[facet] / mean_m2), &mut parts);
                counts.push(parts.len() - before);
            }
            (counts, parts)
        };
        let found: Vec<_> = (0..mesh.facets.len()).into_par_iter().step_by(CHUNK).map(chunk).collect();
        let mut all = LitParts { start: vec![0], parts: vec![] };
        for (counts, parts) in found {
            let ends = counts.iter().scan(all.parts.len(), |end, count| {
                *end += count;
                Some(*end)
            });
            all.start.extend(ends);
            all.parts.extend(parts);
        }
        all
    }

    /// How a facet is lit at a point.
    #[inline]
    pub(super) fn at(&self, facet: u32, uv: impl FnOnce() -> Point) -> Lit {
        let [first, end] = [0, 1].map(|k| self.start[facet as usize + k]);
        let side = 1 << ((end - first).trailing_zeros() / 2);
        self.parts[if side == 1 { first } else { first + part_at(uv(), side) }]
    }
}

/// Into how many parts to cut each side of a facet, by its area over the mean.
fn side(area: f64) -> usize {
    let mut side = 2.0;
    while side < MOST_SIDE && side < SIDE * area.sqrt() {
        side *= 2.0;
    }
    crate::geometry::whole(side)
}

/// Adds the parts of a facet.
fn of_facet(sources: &[Option<&Seen>], facet: usize, side: usize, parts: &mut Vec<Lit>) {
    let state = |seen: &Option<&Seen>| seen.map_or(Shown::Whole, |seen| seen.shown[facet]);
    let is_in_part = sources.iter().any(|seen| state(seen) == Shown::Part);
    let count = if is_in_part { side * side } else { 1 };
    let middles: Vec<Point> = (0..if is_in_part { count } else { 0 }).map(|part| middle(part, side)).collect();
    let mut shares = vec![[0.0; SOURCES]; count];
    for (s, seen) in sources.iter().enumerate() {
        match (state(seen), seen) {
            (Shown::Part, Some(seen)) => {
                let of = crate::geometry::index_u32(facet);
                let found = seen.shares_at(of, &middles);
                shares.iter_mut().zip(found).for_each(|(shares, share)| shares[s] = share);
                // As much light as the polygons have.
                let (mean, all) = (shares.iter().map(|of| of[s]).sum::<f64>() / count as f64, seen.fraction(of));
                let scaled = |share: f64| if mean > 0.0 { share * all / mean } else { all };
                shares.iter_mut().for_each(|shares| shares[s] = scaled(shares[s]).min(1.0));
            }
            (Shown::Nothing, _) => {}
            _ => shares.iter_mut().for_each(|shares| shares[s] = 1.0),
        }
    }
    parts.extend(shares.iter().map(Lit::new));
}

/// The part of a facet that a point is in. A facet is half a square of side x side cells. Each cell below the diagonal has two parts; the upper one takes the
/// place of the cell opposite, which is beyond it.
fn part_at(uv: Point, side: usize) -> usize {
    let [x, y] = uv.map(|x| (x * side as f64).max(0.0));
    let i = crate::geometry::whole(x).min(side - 1);
    let j = crate::geometry::whole(y).min(side - 1 - i);
    let is_upper = i + j + 1 < side && (x - i as f64) + (y - j as f64) > 1.0;
    if is_upper { (side - 1 - i) * side + (side - 1 - j) } else { i * side + j }
}

/// The middle of a part.
fn middle(part: usize, side: usize) -> Point {
    let (i, j) = (part / side, part % side);
    let (i, j, third) = if i + j < side { (i, j, 1.0) } else { (side - 1 - i, side - 1 - j, 2.0) };
    [i, j].map(|k| (k as f64 + third / 3.0) / side as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_fill_a_facet() {
        for side in [2, 4, 16] {
            let mut found: Vec<usize> = (0..side * side).map(|part| part_at(middle(part, side), side)).collect();
            assert_eq!(found, (0..side * side).collect::<Vec<_>>());
            found.dedup();
            assert_eq!(found.len(), side * side);
            for part in 0..side * side {
                let [u, v] = middle(part, side);
                assert!(u > 0.0 && v > 0.0 && u + v < 1.0);
            }
        }
        // Corners, and what rounding puts beside a facet.
        for uv in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0 + 1e-15, 1e-15], [-1e-15, 1.0], [0.5, 0.5 + 1e-15]] {
            assert!(part_at(uv, 4) < 16);
        }
        assert_eq!([0.01, 0.25, 1.0, 1.1, 4.0, 1e9].map(side), [2, 2, 4, 8, 8, 64]);
    }
}
