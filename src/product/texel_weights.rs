//! How much of each pixel each texel of a map fills.

use rayon::prelude::*;

/// One line of a sparse matrix [pixel, texel] of area fractions of pixels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TexelLine {
    /// First weight of each pixel of the line.
    pub row_start: Vec<usize>,
    /// The texel of each weight.
    pub texel: Vec<u32>,
    /// Weights: shares of the pixel's area.
    pub weight: Vec<f64>,
}

impl TexelLine {
    /// The weights of a pixel of the line: (texel, weight).
    pub fn pixel(&self, sample: usize) -> impl Iterator<Item = (u32, f64)> {
        let end = self.row_start.get(sample + 1).copied().unwrap_or(self.texel.len());
        (self.row_start[sample]..end).map(|i| (self.texel[i], self.weight[i]))
    }
}

/// A sparse matrix [pixel, texel] of area fractions of pixels, line by line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TexelWeights {
    /// The lines of the image.
    pub lines: Vec<TexelLine>,
}

impl TexelWeights {
    /// For each pixel the weighted sum of the texels' values, and the sum of the weights of texels that are NaN.
    pub fn apply(&self, values: &[f64]) -> Vec<(f64, f64)> {
        let of_line = |line: &TexelLine| {
            (0..line.row_start.len())
                .map(|sample| {
                    line.pixel(sample).fold((0.0, 0.0), |(sum, lost), (texel, weight)| {
                        let value = values[texel as usize];
                        if value.is_nan() { (sum, lost + weight) } else { (sum + weight * value, lost) }
                    })
                })
                .collect::<Vec<_>>()
        };
        self.lines.par_iter().flat_map_iter(of_line).collect()
    }
}
