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
    /// For each pixel the weighted sum of the texels' values.
    ///
    /// # Errors
    /// A texel with a weight whose value is not from 0 to `largest`.
    pub fn apply(&self, values: &[f64], largest: f64) -> Result<Vec<f64>, u32> {
        let is_good = |value: f64| 0.0 <= value && value <= largest;
        let of_line = |line: &TexelLine| {
            let mut all_good = true;
            let sum = |sample: usize| {
                line.pixel(sample).fold(0.0, |sum, (texel, weight)| {
                    let value = values[texel as usize];
                    all_good &= is_good(value);
                    sum + weight * value
                })
            };
            let sums: Vec<f64> = (0..line.row_start.len()).map(sum).collect();
            match line.texel.iter().find(|texel| !all_good && !is_good(values[**texel as usize])) {
                Some(texel) => Err(*texel),
                None => Ok(sums),
            }
        };
        let lines: Vec<_> = self.lines.par_iter().map(of_line).collect();
        let mut all = Vec::with_capacity(lines.iter().flatten().map(Vec::len).sum());
        lines.into_iter().try_for_each(|line| line.map(|sums| all.extend(sums)))?;
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_sums_and_what_cannot_be_is_refused() {
        let line = TexelLine { row_start: vec![0, 2], texel: vec![3, 0, 3], weight: vec![0.5, 0.25, 1.0] };
        let weights = TexelWeights { lines: vec![line.clone(), line] };
        // The values of texels without a weight do not matter.
        let each = [0.5 * 8.0 + 0.25 * 4.0, 8.0];
        assert_eq!(weights.apply(&[4.0, -1.0, f64::NAN, 8.0], 9.0).unwrap(), [each, each].concat());
        assert_eq!(weights.apply(&[4.0, 0.0, 0.0, f64::NAN], 9.0), Err(3));
        assert_eq!(weights.apply(&[-4.0, 0.0, 0.0, 1.0], 9.0), Err(0));
        assert_eq!(weights.apply(&[4.0, 0.0, 0.0, 9.5], 9.0), Err(3));
    }
}
