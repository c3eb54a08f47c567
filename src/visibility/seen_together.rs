//! What several eyes see together, such as parts of the Sun's disc: of each facet one state where they agree, and the polygons of
//! all of them, with their shares, where they do not.

use std::borrow::Borrow;

use rayon::prelude::*;

use super::{Seen, Shown};
use crate::geometry::index_u32;
use crate::geometry::polygon::Point;

/// All of a facet, in (u, v).
const WHOLE: [Point; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
/// Facets that are joined together, by one thread.
const CHUNK: usize = 4096;

impl Seen {
    /// What several eyes see of the same facets. `shares(facet, out)` writes the share of each eye, which sum to 1, or are all 0: asked for
    /// where eyes differ. An eye whose share is 0 does not count.
    pub fn together<S: Borrow<Seen> + Sync>(eyes: &[S], shares: impl Fn(u32, &mut [f64]) + Sync) -> Seen {
        let eyes: &[&Seen] = &eyes.iter().map(Borrow::borrow).collect::<Vec<_>>();
        let facets = eyes.iter().map(|eye| eye.shown.len()).min().unwrap_or(0);
        let joined: Vec<Seen> = (0..facets.div_ceil(CHUNK))
            .into_par_iter()
            .map(|i| Joining::new(eyes, i * CHUNK).join(i * CHUNK..((i + 1) * CHUNK).min(facets), &shares))
            .collect();
        let mut all = Seen { polygon_start: vec![0], ..Seen::default() };
        for part in joined {
            let base = all.uv.len();
            all.shown.extend(part.shown);
            all.polygon_facet.extend(part.polygon_facet);
            all.polygon_start.extend(part.polygon_start[1..].iter().map(|end| base + end));
            all.uv.extend(part.uv);
            all.polygon_share.extend(part.polygon_share);
        }
        all
    }
}

/// Facets joined one after the other.
struct Joining<'a> {
    eyes: &'a [&'a Seen],
    /// The next polygon of each eye.
    next: Vec<usize>,
    out: Seen,
}

impl<'a> Joining<'a> {
    fn new(eyes: &'a [&'a Seen], first_facet: usize) -> Self {
        let next = |eye: &&Seen| eye.polygon_facet.partition_point(|f| (*f as usize) < first_facet);
        let out = Seen { polygon_start: vec![0], ..Seen::default() };
        Joining { eyes, next: eyes.iter().map(next).collect(), out }
    }

    fn join(mut self, facets: std::ops::Range<usize>, shares: &impl Fn(u32, &mut [f64])) -> Seen {
        let mut of_eye = vec![0.0; self.eyes.len()];
        for facet in facets {
            let first = self.eyes.first().map_or(Shown::Nothing, |eye| eye.shown[facet]);
            let agree = first != Shown::Part && self.eyes.iter().all(|eye| eye.shown[facet] == first);
            let shown = if agree {
                first
            } else {
                shares(index_u32(facet), &mut of_eye);
                self.mixed(facet, &of_eye)
            };
            self.out.shown.push(shown);
        }
        self.out
    }

    /// A facet of which eyes see different parts.
    fn mixed(&mut self, facet: usize, shares: &[f64]) -> Shown {
        let eyes = self.eyes;
        let counting = || eyes.iter().zip(shares).filter(|(_, share)| **share > 0.0).map(|(eye, _)| eye.shown[facet]);
        let state = match counting().next() {
            None => Shown::Nothing,
            Some(first) if first != Shown::Part && counting().all(|shown| shown == first) => first,
            Some(_) => Shown::Part,
        };
        let all_over: f64 =
            eyes.iter().zip(shares).filter(|(eye, _)| eye.shown[facet] == Shown::Whole).map(|(_, share)| share).sum();
        if state == Shown::Part && all_over > 0.0 {
            self.put(facet, &WHOLE, all_over);
        }
        for (k, eye) in eyes.iter().enumerate().filter(|(_, eye)| eye.shown[facet] == Shown::Part) {
            while let Some(of) = eye.polygon_facet.get(self.next[k]).filter(|of| **of as usize <= facet) {
                let i = self.next[k];
                if *of as usize == facet && state == Shown::Part && shares[k] > 0.0 {
                    self.put(facet, &eye.uv[eye.polygon_start[i]..eye.polygon_start[i + 1]], shares[k] * eye.share(i));
                }
                self.next[k] += 1;
            }
        }
        state
    }

    fn put(&mut self, facet: usize, uv: &[Point], share: f64) {
        self.out.uv.extend_from_slice(uv);
        self.out.polygon_facet.push(index_u32(facet));
        self.out.polygon_start.push(self.out.uv.len());
        self.out.polygon_share.push(share);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An eye that sees these states, and of facets in part the half u < v.
    fn eye(shown: &[Shown]) -> Seen {
        let mut eye = Seen { shown: shown.to_vec(), polygon_start: vec![0], ..Seen::default() };
        for (facet, _) in shown.iter().enumerate().filter(|(_, shown)| **shown == Shown::Part) {
            eye.uv.extend([[0.0, 0.0], [0.5, 0.5], [0.0, 1.0]]);
            eye.polygon_facet.push(index_u32(facet));
            eye.polygon_start.push(eye.uv.len());
        }
        eye
    }

    #[test]
    fn facets_that_eyes_agree_on_have_no_polygons() {
        use Shown::{Nothing, Part, Whole};
        let eyes = [
            eye(&[Whole, Nothing, Part, Whole, Whole, Nothing, Part]),
            eye(&[Whole, Nothing, Part, Part, Nothing, Whole, Whole]),
        ];
        // The last facet is below the second eye's horizon, the one before it below the first's.
        let shares = |facet: u32, out: &mut [f64]| match facet {
            5 => out.copy_from_slice(&[0.0, 1.0]),
            6 => out.copy_from_slice(&[1.0, 0.0]),
            _ => out.copy_from_slice(&[0.25, 0.75]),
        };
        let seen = Seen::together(&eyes, shares);
        assert_eq!(seen.shown, [Whole, Nothing, Part, Part, Part, Whole, Part]);
        seen.validate().unwrap();
        assert_eq!(seen.polygon_facet, [2, 2, 3, 3, 4, 6]);
        assert_eq!(seen.polygon_share, [0.25, 0.75, 0.25, 0.75, 0.25, 1.0]);
        let fractions: Vec<f64> = (0..7).map(|facet| seen.fraction(facet)).collect();
        assert_eq!(fractions, [1.0, 0.0, 0.5, 0.25 + 0.375, 0.25, 1.0, 0.5]);
        assert_eq!(seen.overfull(1.0), None);
    }

    #[test]
    fn one_eye_sees_what_it_sees_and_none_sees_nothing() {
        let alone = eye(&[Shown::Part, Shown::Whole, Shown::Nothing]);
        let seen = Seen::together(std::slice::from_ref(&alone), |_, out| out.fill(1.0));
        assert_eq!((&seen.shown, &seen.uv, seen.polygon_share), (&alone.shown, &alone.uv, vec![1.0]));
        assert_eq!(Seen::together::<Seen>(&[], |_, _| ()).shown.len(), 0);
    }
}
