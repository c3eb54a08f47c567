//! The hyperspectral cube, kept as what it was computed from.

use ndarray::Array3;

use crate::spectral::Band;

/// A radiance cube as a product of two matrices: [pixel, row] sparse weights x [row, band] spectra.
///
/// A row is a spectrum that many pixels share: a material under a source, or a material at a temperature.
/// A pixel needs a few of them, so 300 bands cost little more than one. W m-2 sr-1 um-1.
#[derive(Debug, Clone, PartialEq)]
pub struct Cube {
    /// Pixels in a line.
    pub samples: usize,
    /// Lines.
    pub lines: usize,
    /// The bands.
    pub bands: Vec<Band>,
    /// First weight of each pixel, and the number of weights as the last element.
    pub row_start: Vec<u32>,
    /// The row of each weight.
    pub row: Vec<u32>,
    /// Weights.
    pub weight: Vec<f64>,
    /// Spectra, one row after the other: [row, band].
    pub spectra: Vec<f64>,
}

impl Cube {
    /// Radiance of a pixel in every band, W m-2 sr-1 um-1.
    pub fn pixel(&self, pixel: usize, radiance: &mut [f64]) {
        let bands = self.bands.len();
        radiance[..bands].fill(0.0);
        for i in self.row_start[pixel] as usize..self.row_start[pixel + 1] as usize {
            let row = self.row[i] as usize * bands;
            let weight = self.weight[i];
            for (value, spectrum) in radiance.iter_mut().zip(&self.spectra[row..row + bands]) {
                *value += weight * spectrum;
            }
        }
    }

    /// Radiance of every pixel in one band, line by line, W m-2 sr-1 um-1.
    pub fn band(&self, band: usize) -> Vec<f64> {
        let bands = self.bands.len();
        self.row_start
            .windows(2)
            .map(|r| {
                let entries = r[0] as usize..r[1] as usize;
                entries
                    .map(|i| self.weight[i] * self.spectra[self.row[i] as usize * bands + band])
                    .fold(0.0, |a, b| a + b)
            })
            .collect()
    }

    /// The whole cube as [line, sample, band], W m-2 sr-1 um-1.
    pub fn to_array(&self) -> Array3<f64> {
        let mut array = Array3::zeros((self.lines, self.samples, self.bands.len()));
        if let Some(values) = array.as_slice_mut() {
            for (pixel, radiance) in values.chunks_exact_mut(self.bands.len()).enumerate() {
                self.pixel(pixel, radiance);
            }
        }
        array
    }
}
