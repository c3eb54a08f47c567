//! The hyperspectral cube, kept as what it was computed from.

use std::ops::Range;

use ndarray::Array3;

use crate::spectral::Band;

/// A radiance cube as a product of two matrices, [pixel, row] sparse weights x [row, band] spectra, and what maps add to it.
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
    pub row_start: Vec<usize>,
    /// The row of each weight.
    pub row: Vec<u32>,
    /// Weights.
    pub weight: Vec<f64>,
    /// Spectra, one row after the other: [row, band].
    pub spectra: Vec<f64>,
    /// Rows from this one on are what the surface emits; those before it are what it reflects.
    pub first_thermal_row: u32,
    /// Radiance from maps, added to that: [band, pixel]. Empty without maps.
    pub added: Vec<f64>,
}

impl Cube {
    /// The part of it that the surface emits; what maps add is not in it.
    pub fn thermal(&self) -> Cube {
        let mut part = Cube { row_start: vec![0], row: vec![], weight: vec![], added: vec![], ..self.clone() };
        for entries in self.row_start.windows(2) {
            for i in entries[0]..entries[1] {
                if self.row[i] >= self.first_thermal_row {
                    part.row.push(self.row[i]);
                    part.weight.push(self.weight[i]);
                }
            }
            part.row_start.push(part.row.len());
        }
        part
    }

    /// Radiance of some pixels in some bands, W m-2 sr-1 um-1: `put(pixel, first_band, values)` gets a few bands of
    /// one pixel at a time, all pixels before the next bands.
    ///
    /// Each value is the sum of its weights times spectra in the order they are stored, however it is asked for.
    pub fn expand(&self, pixels: Range<usize>, bands: Range<usize>, mut put: impl FnMut(usize, usize, &[f64])) {
        // 16 sums stay in registers while the weights stream by.
        let mut band = bands.start;
        while band + 16 <= bands.end {
            pixels.clone().for_each(|pixel| put(pixel, band, &self.panel::<16>(pixel, band)));
            band += 16;
        }
        while band + 4 <= bands.end {
            pixels.clone().for_each(|pixel| put(pixel, band, &self.panel::<4>(pixel, band)));
            band += 4;
        }
        while band < bands.end {
            pixels.clone().for_each(|pixel| put(pixel, band, &self.panel::<1>(pixel, band)));
            band += 1;
        }
    }

    /// Radiance of a pixel in `N` bands.
    fn panel<const N: usize>(&self, pixel: usize, first_band: usize) -> [f64; N] {
        let entries = self.row_start[pixel]..self.row_start[pixel + 1];
        let mut sum = [0.0; N];
        if !self.added.is_empty() {
            let pixels = self.samples * self.lines;
            sum = std::array::from_fn(|k| self.added[(first_band + k) * pixels + pixel]);
        }
        for (row, weight) in self.row[entries.clone()].iter().zip(&self.weight[entries]) {
            let spectrum = &self.spectra[*row as usize * self.bands.len() + first_band..][..N];
            for (sum, value) in sum.iter_mut().zip(spectrum) {
                *sum += weight * value;
            }
        }
        sum
    }

    /// Radiance of a pixel in every band, W m-2 sr-1 um-1.
    pub fn pixel(&self, pixel: usize, radiance: &mut [f64]) {
        self.expand(pixel..pixel + 1, 0..self.bands.len(), |_, band, values| {
            radiance[band..band + values.len()].copy_from_slice(values);
        });
    }

    /// Radiance of every pixel in one band, line by line, W m-2 sr-1 um-1.
    pub fn band(&self, band: usize) -> Vec<f64> {
        let mut radiance = Vec::with_capacity(self.samples * self.lines);
        self.expand(0..self.samples * self.lines, band..band + 1, |_, _, values| radiance.push(values[0]));
        radiance
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pixels of 21 bands; pixel 0 is 2 a + 3 b, pixel 1 is sky.
    fn cube() -> Cube {
        let bands = (0..21).map(|i| Band::new(1.0 + f64::from(i), None)).collect();
        let a = (0..21).map(f64::from);
        let b = (0..21).map(|i| 100.0 * f64::from(i));
        Cube {
            samples: 2,
            lines: 1,
            bands,
            row_start: vec![0, 2, 2],
            row: vec![0, 1],
            weight: vec![2.0, 3.0],
            spectra: a.chain(b).collect(),
            first_thermal_row: 1,
            added: vec![],
        }
    }

    #[test]
    fn a_pixel_is_the_weighted_sum_of_its_spectra() {
        let mut radiance = [f64::NAN; 21];
        cube().pixel(0, &mut radiance);
        for (i, value) in radiance.iter().enumerate() {
            assert_eq!(*value, 302.0 * i as f64);
        }
        cube().pixel(1, &mut radiance);
        assert_eq!(radiance, [0.0; 21]);
    }

    #[test]
    fn what_is_emitted_is_the_rows_from_the_first_thermal_one_on() {
        let mut radiance = [f64::NAN; 21];
        let mut cube = cube();
        cube.added = vec![1.0; 42];
        cube.thermal().pixel(0, &mut radiance);
        for (i, value) in radiance.iter().enumerate() {
            assert_eq!(*value, 300.0 * i as f64);
        }
        cube.thermal().pixel(1, &mut radiance);
        assert_eq!(radiance, [0.0; 21]);
    }

    #[test]
    fn maps_add_to_a_pixel() {
        let mut cube = cube();
        cube.added = (0..42).map(|i| f64::from(i) * 1000.0).collect();
        // Band i of pixel 1 is at 2 i + 1.
        let mut radiance = [f64::NAN; 21];
        cube.pixel(1, &mut radiance);
        assert_eq!((radiance[0], radiance[20]), (1000.0, 41_000.0));
        cube.pixel(0, &mut radiance);
        assert_eq!((radiance[0], radiance[20]), (0.0, 40_000.0 + 302.0 * 20.0));
    }

    #[test]
    fn pixels_bands_and_the_whole_cube_are_the_same_numbers() {
        let mut cube = cube();
        cube.weight = vec![0.1, 1.0 / 3.0];
        let array = cube.to_array();
        let mut radiance = [0.0; 21];
        cube.pixel(0, &mut radiance);
        for (band, value) in radiance.iter().enumerate() {
            assert_eq!(*value, array[[0, 0, band]]);
            assert_eq!(cube.band(band), [*value, 0.0]);
        }
    }
}
