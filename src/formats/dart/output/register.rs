//! Where an image lies, by its outline: texels with a value are those that show the scene, whose outline from there is known exactly.

use rayon::prelude::*;

use crate::error::Result;
use crate::geometry::whole;
use crate::product::{Registration, ViewImage};
use crate::progress::Watch;
use crate::scene::Scene;
use crate::visibility::{Drawing, Grid, View, covered};

/// What an outline shows.
pub(super) enum Found {
    /// Nothing, and why.
    Nothing(&'static str),
    /// A place; the printed one if it is that within half a texel.
    Place(Registration),
}

/// Shifts are looked for as far as this, m ...
const FARTHEST_M: f64 = 5.0;
/// ... but no less than this and no more than that, texels.
const FARTHEST_TEXELS: [f64; 2] = [8.0, 48.0];
/// The scene is drawn in this many cells per texel, along each axis, ...
const FINEST: usize = 4;
/// ... or in fewer, so that there are not more cells than this.
const MOST_CELLS: usize = 6_000_000;
/// A shift up to this counts as none: outlines of texels are not more precise.
const RESIDUAL: f64 = 0.5;
/// Shifts by whole texels that change the misfit by less than this, texels, fit as well as the best one: no outline decides between them.
const FLAT: f64 = 0.5;
/// Texels covered by less than this are beside the outline, by more than all but this within it.
const ROUNDING: f64 = 1e-9;

/// Finds the shift by which the scene's outline, seen from where an image was, fits the texels with a value best.
///
/// `valid` says for each texel whether it has one. What is minimised is the sum over texels of (valid - covered share) squared.
///
/// # Errors
/// [`Error::Interrupted`](crate::Error::Interrupted) if `watch` asks to stop.
pub(super) fn register(image: &ViewImage, valid: &[bool], scene: &Scene, watch: Watch<'_>) -> Result<Found> {
    if !valid.contains(&true) {
        return Ok(Found::Nothing("none of its texels has a value"));
    }
    let Some(outline) = Outline::draw(image, valid, scene, watch)? else {
        return Ok(Found::Nothing("its outline cannot be drawn"));
    };
    let Best { shift, unverified } = outline.best();
    let shift = if shift.iter().all(|s| s.abs() <= RESIDUAL) { [0.0; 2] } else { shift };
    let overlap = [[0.0; 2], shift].map(|shift| outline.overlap(outline.cells(shift)));
    // Rows of a mirror image are counted from the other side.
    let shift_texels = if outline.is_mirrored { [shift[0], 0.0 - shift[1]] } else { shift };
    let linear = image.camera.projection().linear;
    let per_m = [0, 1].map(|k| linear.row(k).length());
    let in_m = |texels: [f64; 2]| [0, 1].map(|k| texels[k] / per_m[k]);
    let (shift_m, unverified_m) = (in_m(shift_texels), in_m(unverified));
    Ok(Found::Place(Registration { shift_texels, shift_m, overlap, unverified_m }))
}

/// The shift of the least misfit, texels.
struct Best {
    shift: [f64; 2],
    /// How far from there shifts are that fit as well, if no outline decides; else 0.
    unverified: [f64; 2],
}

/// The outlines of an image and of the scene.
struct Outline {
    /// Columns and rows.
    size: [usize; 2],
    /// Row by row: which texels have a value.
    valid: Vec<bool>,
    /// Cells along a texel's side.
    fine: usize,
    /// Texels around the image that are drawn as well.
    margin: usize,
    /// For each corner of cells the area, cells, that is covered above and to the left of it.
    sums: Vec<f64>,
    is_mirrored: bool,
}

impl Outline {
    fn draw(image: &ViewImage, valid: &[bool], scene: &Scene, watch: Watch<'_>) -> Result<Option<Outline>> {
        let drawn = View::of_camera(&image.camera, scene.body.bounds_m());
        let Some((View::Parallel { h, v, u, scale, offset }, _, is_mirrored)) = drawn else {
            return Ok(None);
        };
        let size = image.size();
        let per_m = scale[0].max(scale[1]);
        let margin = whole((FARTHEST_M * per_m).clamp(FARTHEST_TEXELS[0], FARTHEST_TEXELS[1]).ceil());
        let texels = size.map(|n| n + 2 * margin);
        let fits = |fine: &usize| (texels[0] * texels[1]).saturating_mul(fine * fine) <= MOST_CELLS;
        let fine = (1..=FINEST).rev().find(fits).unwrap_or(1);
        let [columns, rows] = texels.map(|n| u32::try_from(n * fine).ok());
        let (Some(columns), Some(rows)) = (columns, rows) else { return Ok(None) };
        let cells = |texels: f64| texels * fine as f64;
        let view = View::Parallel {
            h,
            v,
            u,
            scale: scale.map(cells),
            offset: offset.map(|offset| cells(offset + margin as f64)),
        };
        let drawing = Drawing::new(&scene.body.mesh, scene.body.topology(), view, Grid { columns, rows });
        let shares = covered(&drawing, "outline of an image", |[outer, inner]| (outer + inner).min(1.0), watch)?;
        let width = columns as usize + 1;
        let mut sums = vec![0.0; width * (rows as usize + 1)];
        for (row, line) in shares.chunks_exact(columns as usize).enumerate() {
            let mut so_far = 0.0;
            for (column, share) in line.iter().enumerate() {
                so_far += share;
                sums[(row + 1) * width + column + 1] = sums[row * width + column + 1] + so_far;
            }
        }
        let mut valid = valid.to_vec();
        if is_mirrored {
            valid = valid.chunks(size[0]).rev().flatten().copied().collect();
        }
        Ok(Some(Outline { size, valid, fine, margin, sums, is_mirrored }))
    }

    /// A shift in whole cells.
    #[expect(clippy::cast_possible_truncation, reason = "shifts are within the margin")]
    fn cells(&self, shift: [f64; 2]) -> [isize; 2] {
        shift.map(|s| (s * self.fine as f64).round() as isize)
    }

    /// The covered share of a texel, if what the image shows is shifted by this many cells.
    fn covered(&self, column: usize, row: usize, shift: [isize; 2]) -> f64 {
        let width = (self.size[0] + 2 * self.margin) * self.fine + 1;
        let first = |texel: usize, k: usize| (((texel + self.margin) * self.fine) as isize - shift[k]) as usize;
        let (x, y) = (first(column, 0), first(row, 1));
        let at = |x: usize, y: usize| self.sums[y * width + x];
        let area = at(x + self.fine, y + self.fine) - at(x, y + self.fine) - at(x + self.fine, y) + at(x, y);
        (area / (self.fine * self.fine) as f64).clamp(0.0, 1.0)
    }

    fn misfit(&self, shift: [isize; 2]) -> f64 {
        let of_row = |row: usize| {
            let of_texel = |column: usize| {
                let valid = f64::from(u8::from(self.valid[row * self.size[0] + column]));
                (valid - self.covered(column, row, shift)).powi(2)
            };
            (0..self.size[0]).map(of_texel).sum::<f64>()
        };
        let rows: Vec<f64> = (0..self.size[1]).into_par_iter().map(of_row).collect();
        rows.iter().sum()
    }

    /// The shift of the least misfit. Along an axis where many fit as well, as where the scene reaches beyond the image on both sides or the
    /// image has values all around the scene: the least of them, which is no farther from the truth than none at all.
    fn best(&self) -> Best {
        let fine = self.fine as isize;
        let farthest = self.margin as isize * fine;
        let mut best = (self.misfit([0, 0]), [0_isize; 2]);
        let mut step = 4 * fine;
        let mut reach = farthest / step;
        while step > 0 {
            let middle = best.1;
            for i in -reach..=reach {
                for j in -reach..=reach {
                    let shift = [middle[0] + i * step, middle[1] + j * step];
                    if shift.iter().any(|s| s.abs() > farthest) {
                        continue;
                    }
                    let misfit = self.misfit(shift);
                    if misfit < best.0 {
                        best = (misfit, shift);
                    }
                }
            }
            step /= 2;
            reach = 2;
        }
        let beside = |k: usize, by: isize| {
            let mut shift = best.1;
            shift[k] += by;
            if shift[k].abs() > farthest { f64::INFINITY } else { self.misfit(shift) }
        };
        let fits = |k: usize, by: isize| beside(k, by) <= best.0 + FLAT;
        // Parts of texels are asked last: by them the misfit changes with what is left of texels, too.
        let reach = |k: usize, sign: isize| {
            let whole = (1..).take_while(|texels| fits(k, sign * texels * fine)).last().unwrap_or(0) * fine;
            whole + (1..fine).take_while(|cells| fits(k, sign * (whole + cells))).last().unwrap_or(0)
        };
        let texels = |cells: f64| cells / self.fine as f64;
        let mut found = Best { shift: [0.0; 2], unverified: [0.0; 2] };
        for k in 0..2 {
            let middle = best.1[k] as f64;
            let reach = [-1, 1].map(|sign| reach(k, sign));
            let (least, most) = (middle - reach[0] as f64, middle + reach[1] as f64);
            if reach.iter().any(|cells| *cells >= fine) {
                let shift = 0.0_f64.clamp(least, most);
                found.shift[k] = texels(shift);
                found.unverified[k] = texels((shift - least).max(most - shift));
                continue;
            }
            // Between cells, the misfit is taken for a parabola, unless it is flat there.
            let (before, after) = (beside(k, -1), beside(k, 1));
            let bend = before - 2.0 * best.0 + after;
            let has_bend = before > best.0 && after > best.0 && bend.is_finite();
            let between =
                if has_bend { middle + (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.5 * (least + most) };
            found.shift[k] = texels(between);
        }
        found
    }

    /// The share of what either of the outlines holds that both hold. A texel on the scene's outline may have a value or not.
    fn overlap(&self, shift: [isize; 2]) -> f64 {
        let (mut both, mut either) = (0_u64, 0_u64);
        for (i, valid) in self.valid.iter().enumerate() {
            let covered = self.covered(i % self.size[0], i / self.size[0], shift);
            both += u64::from(*valid && covered > ROUNDING);
            either += u64::from(*valid || covered > 1.0 - ROUNDING);
        }
        if either > 0 { both as f64 / either as f64 } else { 0.0 }
    }
}
