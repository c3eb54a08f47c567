//! One bounce: what facets send reaches the facets that they face.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::lit::Lit;
use crate::error::Result;
use crate::geometry::index_u32;
use crate::progress::{Watch, tell};
use crate::visibility::{Bundles, Frame, LineScratch, Meeting};

/// Bundles whose meetings are known at a time.
const AT_A_TIME: u32 = 8;
/// Sums of facets are made in this many parts of the mesh, whatever the number of threads.
const PARTS: usize = 16;

/// Light on a line to a facet from another one.
#[derive(Debug, Clone, Copy)]
struct Way {
    to: u32,
    from: u32,
    /// How the other one is lit where the line leaves it.
    lit: Lit,
}

/// What has reached each facet.
#[derive(Debug, Default)]
pub(super) struct Arrived {
    /// Sums, [facet, column].
    pub(super) rows: Vec<f64>,
    /// Of the light, what one half of the bundles has brought, less what the other has.
    pub(super) difference: Vec<f64>,
}

/// The sum of what reaches each facet, for facets that would send 1 in all directions: `lit` says how the first or second facet
/// of a meeting is lit there, and `give` adds to a line of the result what a facet sends, if so lit, with a weight, and says how much light that is.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub(super) fn pass(
    levels: &[Bundles],
    areas_m2: &[f64],
    columns: usize,
    lit: impl Fn(&Frame, &Meeting, usize) -> Lit + Sync,
    give: impl Fn(&mut [f64], u32, Lit, f64) -> f64 + Sync,
    watch: Watch<'_>,
) -> Result<Arrived> {
    const STAGE: &str = "light between facets";
    let facets = areas_m2.len();
    let mut sums = Arrived { rows: vec![0.0; facets * columns], difference: vec![0.0; facets] };
    let part = facets.div_ceil(PARTS).max(1);
    let spare: Mutex<Vec<LineScratch>> = Mutex::default();
    let ways = |bundles: &Bundles, bundle: u32| {
        let mut scratch = spare.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        let mut ways: [Vec<Way>; PARTS] = Default::default();
        let lines = bundles.meetings(bundle, &mut scratch, |frame, meeting| {
            let lit = [0, 1].map(|which| lit(frame, &meeting, which));
            let [one, other] = meeting.facets;
            for (to, from, lit) in [(other, one, lit[0]), (one, other, lit[1])] {
                if bundles.is_of(to) {
                    ways[to as usize / part].push(Way { to, from, lit });
                }
            }
        });
        spare.lock().unwrap_or_else(PoisonError::into_inner).push(scratch);
        // Every other one: halves like these cover directions as evenly as so many would by themselves.
        (if bundle.is_multiple_of(2) { 1.0 } else { -1.0 }, lines, ways)
    };
    let all: u64 = levels.iter().map(|bundles| u64::from(bundles.count())).sum();
    let mut done = 0;
    let in_turn = |bundles: &Bundles| (0..bundles.count()).step_by(AT_A_TIME as usize);
    for (bundles, first) in levels.iter().flat_map(|bundles| in_turn(bundles).map(move |first| (bundles, first))) {
        tell(watch, STAGE, done, all)?;
        let some = first..(first + AT_A_TIME).min(bundles.count());
        done += some.len() as u64;
        let found: Vec<(f64, f64, [Vec<Way>; PARTS])> =
            some.into_par_iter().map(|bundle| ways(bundles, bundle)).collect();
        let parts = sums.rows.par_chunks_mut(part * columns).zip(sums.difference.par_chunks_mut(part));
        parts.enumerate().for_each(|(p, (rows, difference))| {
            for (half, lines, ways) in &found {
                for Way { to, from, lit } in &ways[p] {
                    let at = *to as usize - p * part;
                    difference[at] += half * give(&mut rows[at * columns..(at + 1) * columns], *from, *lit, *lines);
                }
            }
        });
    }
    tell(watch, STAGE, done, all)?;
    let share = |facet: usize| {
        let bundles = levels.iter().find(|bundles| bundles.is_of(index_u32(facet)));
        bundles.filter(|_| areas_m2[facet] > 0.0).map_or(1.0, |bundles| bundles.share_of_line(areas_m2[facet]))
    };
    let rows = sums.rows.par_chunks_mut(columns).zip(&mut sums.difference).enumerate();
    rows.for_each(|(facet, (row, difference))| {
        let share = share(facet);
        row.iter_mut().chain([difference]).for_each(|sum| *sum *= share);
    });
    Ok(sums)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::DVec3;

    use super::*;
    use crate::geometry::{MaterialId, Mesh, index_u32};
    use crate::progress::unwatched;

    /// A cavity: a sphere of radius 1 that is cut into an octahedron's facets, each n x n, and seen from inside.
    fn cavity(n: u32) -> Mesh {
        let mut mesh = Mesh::default();
        for (sx, sy, sz) in [0, 1, 2, 3, 4, 5, 6, 7].map(|k| (1 - 2 * (k & 1), 1 - (k & 2), 1 - (k & 4) / 2)) {
            let [a, b, c] = [DVec3::X * f64::from(sx), DVec3::Y * f64::from(sy), DVec3::Z * f64::from(sz)];
            let (b, c) = if sx * sy * sz > 0 { (c, b) } else { (b, c) };
            let base = index_u32(mesh.vertices_m.len());
            let at = |i: u32, j: u32| base + (0..i).map(|i| n + 1 - i).sum::<u32>() + j;
            for i in 0..=n {
                for j in 0..=n - i {
                    let p = a * f64::from(n - i - j) + b * f64::from(j) + c * f64::from(i);
                    mesh.vertices_m.push(p.normalize());
                }
            }
            for i in 0..n {
                for j in 0..n - i {
                    mesh.facets.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
                    if j + 1 < n - i {
                        mesh.facets.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
                    }
                }
            }
        }
        mesh.material = vec![MaterialId(0); mesh.facets.len()];
        mesh
    }

    #[test]
    fn a_furnace_is_as_bright_as_a_geometric_series() {
        // In a closed cavity of any shape the radiosity is M / (1 - rho), and 1e-6 of it is left after 6, 20, 270 bounces.
        let mesh = cavity(4);
        let areas_m2: Vec<f64> = (0..mesh.facets.len()).map(|f| mesh.facet(f).area_m2()).collect();
        let area_m2: f64 = areas_m2.iter().sum();
        assert!(area_m2 > 3.6 * PI && mesh.enclosed_m3().unwrap() < -3.5);
        let bundles = Bundles::new(&mesh, 16, 1024);
        let mean = |values: &[f64]| values.iter().zip(&areas_m2).map(|(x, a)| x * a).sum::<f64>() / area_m2;
        let mut sent = vec![1.0; mesh.facets.len()];
        let mut left = vec![];
        for _ in 0..8 {
            let give = |row: &mut [f64], from: u32, _: Lit, lines: f64| {
                row[0] += lines * sent[from as usize];
                0.0
            };
            sent = pass(std::slice::from_ref(&bundles), &areas_m2, 1, |_, _, _| Lit::default(), give, &unwatched)
                .unwrap()
                .rows;
            left.push(mean(&sent));
        }
        // All that is sent arrives, at every bounce: the series is that of rho.
        for (n, left) in left.iter().enumerate() {
            assert!((left - 1.0).abs() < 2e-3 * (n + 1) as f64, "{n}: {left}");
        }
        let ratio = left[7] / left[6];
        for (rho, bounces) in [(0.07_f64, 6), (0.5, 20), (0.95, 270)] {
            let tail = |n: i32| (rho * ratio).powi(n);
            assert!(tail(bounces) < 1.1e-6 && tail(bounces - 1) > 0.9e-6, "{rho}: {}", tail(bounces));
            let (mut all, mut factor) = (1.0, 1.0);
            for left in &left {
                factor *= rho;
                all += factor * left;
            }
            all += factor * left[7] * rho * ratio / (1.0 - rho * ratio);
            assert!((all * (1.0 - rho) - 1.0).abs() < 0.02, "{rho}: {all}");
        }
    }
}
