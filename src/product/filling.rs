//! How slabs fill a cube, once.

use std::ops::Range;

use super::{CubeAxes, Slab};
use crate::error::{Error, Location, Problem, Result};

/// What of a cube is there, while its slabs come one by one, in any order.
#[derive(Debug, Clone)]
pub struct Filling {
    samples: usize,
    lines: usize,
    bands: usize,
    /// Lines and bands of the slabs that came, those that make a rectangle as one.
    slabs: Vec<[Range<usize>; 2]>,
}

impl Filling {
    /// Nothing is there.
    pub fn new(axes: &CubeAxes) -> Self {
        Filling { samples: axes.samples, lines: axes.lines, bands: axes.bands.len(), slabs: vec![] }
    }

    /// Whether a slab may come.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it overlaps one that is there, reaches beyond the cube, or is not as large as it says.
    pub fn admits(&self, slab: &Slab) -> Result<()> {
        let mut told = Vec::new();
        let is_within = |range: &Range<usize>, size: usize| range.start <= range.end && range.end <= size;
        if is_within(&slab.lines, self.lines) && is_within(&slab.bands, self.bands) {
            told.extend(slab.problems(self.samples.saturating_mul(slab.lines.len())));
            let overlap = |a: &Range<usize>, b: &Range<usize>| a.start.max(b.start) < a.end.min(b.end);
            let overlaps = |of: &&[Range<usize>; 2]| overlap(&of[0], &slab.lines) && overlap(&of[1], &slab.bands);
            told.extend(
                self.slabs.iter().find(overlaps).map(|[lines, bands]| format!("overlaps {}", named(lines, bands))),
            );
        } else {
            told.push(format!("reaches beyond {} lines and {} bands", self.lines, self.bands));
        }
        let problem = |message| Problem::new(Location::item(named(&slab.lines, &slab.bands)), message);
        let problems: Vec<Problem> = told.into_iter().map(problem).collect();
        if problems.is_empty() { Ok(()) } else { Err(Error::Invalid(problems)) }
    }

    /// Records a slab that [`admits`](Filling::admits) has let in.
    pub fn add(&mut self, slab: &Slab) {
        let mut added = [slab.lines.clone(), slab.bands.clone()];
        // Slabs that come one after the other are one: then few are to be looked through, however many come.
        while let Some((i, joined)) = self.slabs.iter().enumerate().find_map(|(i, of)| Some((i, joined(of, &added)?))) {
            self.slabs.swap_remove(i);
            added = joined;
        }
        self.slabs.push(added);
    }

    /// Ends the filling: no more slabs come.
    ///
    /// # Errors
    /// [`Error::Invalid`] if they leave something open.
    pub fn end(&self) -> Result<()> {
        let (filled, all) = (self.filled(), self.all());
        if filled == all {
            return Ok(());
        }
        Err(Error::invalid(Location::item("cube"), format!("slabs hold {filled} of {all} lines of bands")))
    }

    /// How many lines there are, those of each band counted by themselves.
    pub fn filled(&self) -> usize {
        self.slabs.iter().map(|[lines, bands]| lines.len().saturating_mul(bands.len())).fold(0, usize::saturating_add)
    }

    /// How many there are once it is full.
    pub fn all(&self) -> usize {
        self.lines.saturating_mul(self.bands)
    }
}

/// Two rectangles as one, where they have a side in common.
fn joined(a: &[Range<usize>; 2], b: &[Range<usize>; 2]) -> Option<[Range<usize>; 2]> {
    let joined = |along: usize| {
        let (a_part, b_part) = (&a[along], &b[along]);
        let meet = a[1 - along] == b[1 - along] && (a_part.end == b_part.start || b_part.end == a_part.start);
        let mut all = a.clone();
        all[along] = a_part.start.min(b_part.start)..a_part.end.max(b_part.end);
        meet.then_some(all)
    };
    joined(0).or_else(|| joined(1))
}

/// What a slab is called.
fn named(lines: &Range<usize>, bands: &Range<usize>) -> String {
    format!("slab of lines {}..{}, bands {}..{} (from 0)", lines.start, lines.end, bands.start, bands.end)
}
