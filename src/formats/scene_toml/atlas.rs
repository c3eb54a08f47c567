//! Texture coordinates as texel coordinates of an image, and images that are repeated.

use super::TomlReader;
use super::types::WrapToml;
use crate::error::number;
use crate::geometry::whole;
use crate::product::Atlas;

/// Texture coordinates this far beyond the image are on its border: they are f32, or have six decimals.
const ROUNDING: f64 = 2e-6;

/// Texel coordinates of a facet that an image does not cover: a triangle beside it.
pub(super) const UNCOVERED: [[f64; 2]; 3] = [[-3.0, -3.0], [-2.0, -3.0], [-3.0, -2.0]];

/// An image that is continued by its own other side: where in it the texels of a larger one are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::formats) struct Tiling {
    /// Rows and columns of the image.
    image: [usize; 2],
    /// Rows and columns of the larger one.
    pub(in crate::formats) size: [usize; 2],
    /// Texels of the larger one before the image's first.
    before: [usize; 2],
}

impl Tiling {
    /// An image of one more column on each side: that of the other end.
    pub(in crate::formats) fn around([rows, columns]: [usize; 2]) -> Self {
        Tiling { image: [rows, columns], size: [rows, columns + 2], before: [0, 1] }
    }

    /// The larger image, line by line, of a value for each texel of the image.
    pub(in crate::formats) fn expanded(&self, values: &[f64], all: &mut Vec<f64>) {
        let [rows, columns] = self.image;
        let wrapped = |i: usize, before: usize, count: usize| (i + count - before % count) % count;
        all.clear();
        for row in (0..self.size[0]).map(|row| wrapped(row, self.before[0], rows)) {
            let line = &values[row * columns..][..columns];
            all.extend((0..self.size[1]).map(|column| line[wrapped(column, self.before[1], columns)]));
        }
    }
}

impl TomlReader<'_> {
    /// Texel coordinates of facets' corners, of an image of `[rows, columns]`; where it is repeated, of a larger image.
    ///
    /// A facet is moved by whole images to where it begins in the first one, and a texel more is held on all sides, so that values
    /// between texel centres are those between neighbours across the border.
    pub(in crate::formats) fn atlas(
        &mut self,
        item: &str,
        mut uv: Vec<[[f64; 2]; 3]>,
        [rows, columns]: [usize; 2],
        wrap: Option<WrapToml>,
        most_texels: usize,
    ) -> Option<(Atlas, Option<Tiling>)> {
        let repeats = match wrap {
            None => [false, false],
            Some(WrapToml::Repeat) => [true, true],
            Some(WrapToml::RepeatU) => [true, false],
            Some(WrapToml::RepeatV) => [false, true],
        };
        for axis in 0..2 {
            if repeats[axis] {
                for corners in &mut uv {
                    let least = corners.iter().map(|c| c[axis]).fold(f64::INFINITY, f64::min).floor();
                    corners.iter_mut().for_each(|c| c[axis] -= least);
                }
                continue;
            }
            let beyond = |x: f64| !x.is_nan() && !(-ROUNDING..=1.0 + ROUNDING).contains(&x);
            if let Some(x) = uv.iter().flatten().map(|c| c[axis]).find(|x| beyond(*x)) {
                let name = ["repeat_u", "repeat_v"][axis];
                self.helped(
                    item,
                    format!("facets have texture coordinates outside 0 to 1: {}", number(x)),
                    format!(
                        "`wrap = \"repeat\"` continues the image by itself, `wrap = \"{name}\"` along this axis alone"
                    ),
                );
                return None;
            }
            // NaN stays.
            uv.iter_mut().flatten().for_each(|c| c[axis] = c[axis].clamp(0.0, 1.0));
        }
        let mut atlas = Atlas::of_uv(&uv, rows, columns);
        if repeats == [false, false] {
            return Some((atlas, None));
        }
        let mut tiling = Tiling { image: [rows, columns], size: [rows, columns], before: [0, 0] };
        for (axis, image) in [(0, 1), (1, 0)].into_iter().filter(|(axis, _)| repeats[*axis]) {
            let all = || atlas.corners.iter().flatten().map(|c| c[axis]).filter(|x| x.is_finite());
            let (low, high) = (all().fold(0.0, f64::min).floor(), all().fold(0.0, f64::max).ceil());
            // One more on both sides.
            let (before, count) = (1.0 - low, high - low + 2.0);
            if !(count <= most_texels as f64 && before <= most_texels as f64) {
                self.problem(
                    item,
                    format!(
                        "facets have texture coordinates that go over {} images",
                        number(count / tiling.image[image] as f64)
                    ),
                );
                return None;
            }
            (tiling.before[image], tiling.size[image]) = (whole(before), whole(count));
            atlas.corners.iter_mut().flatten().for_each(|c| c[axis] += before);
        }
        let [rows, columns] = tiling.size;
        if rows.saturating_mul(columns) > most_texels {
            self.problem(
                item,
                format!("the repeated image has {columns} x {rows} texels, more than can be held in memory"),
            );
            return None;
        }
        (atlas.rows, atlas.columns) = (rows, columns);
        Some((atlas, Some(tiling)))
    }
}
