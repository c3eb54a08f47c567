//! The hyperspectral cube, kept as what it was computed from.

use std::ops::Range;

use ndarray::Array3;

use super::{Added, Filling, Quantity};
use crate::error::{Error, Result};
use crate::scene::Exposure;
use crate::spectral::Band;

/// Some bands of some lines of a cube, as a product of two matrices, [pixel, row] sparse weights x [row, band] spectra, and what maps
/// add to it.
///
/// A row is a spectrum that many pixels share: a material under a source, or a material at a temperature.
/// A pixel needs a few of them, so 300 bands cost little more than one. W m-2 sr-1 um-1.
///
/// All of a slab is made under one sky: a frame camera's cube is one slab; a tunable filter's has one for each band,
/// a push-broom's one for each line.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Slab {
    /// Its lines in the cube.
    pub lines: Range<usize>,
    /// Its bands in the cube.
    pub bands: Range<usize>,
    /// First weight of each of its pixels, and the number of weights as the last element.
    pub row_start: Vec<usize>,
    /// The row of each weight.
    pub row: Vec<u32>,
    /// Weights.
    pub weight: Vec<f64>,
    /// Spectra, one row after the other: [row, band].
    pub spectra: Vec<f64>,
    /// Rows from this one on are what the surface emits; those before it are what it reflects.
    pub first_thermal_row: u32,
    /// Radiance from maps, added to that.
    pub added: Added,
}

/// The axes of a cube.
#[derive(Debug, Clone, PartialEq)]
pub struct CubeAxes {
    /// Pixels in a line.
    pub samples: usize,
    /// Lines.
    pub lines: usize,
    /// The bands.
    pub bands: Vec<Band>,
    /// What its numbers are.
    pub quantity: Quantity,
}

impl CubeAxes {
    /// Of the cube of an exposure: radiance.
    pub fn of(exposure: &Exposure) -> Self {
        let (samples, lines) = (exposure.camera.samples as usize, exposure.camera.lines as usize);
        CubeAxes { samples, lines, bands: exposure.bands.clone(), quantity: Quantity::Radiance }
    }
}

/// The hyperspectral cube, kept in the form it was computed in: slabs that fill it.
#[derive(Debug, Clone, PartialEq)]
pub struct Cube {
    /// Its axes.
    pub axes: CubeAxes,
    slabs: Vec<Slab>,
}

impl Cube {
    /// Of slabs that fill it.
    ///
    /// # Errors
    /// [`Error::Invalid`] if slabs overlap or leave gaps, or one does not have the size it states.
    pub fn new(axes: CubeAxes, slabs: Vec<Slab>) -> Result<Self> {
        let mut filling = Filling::new(&axes);
        let mut problems = Vec::new();
        for slab in &slabs {
            match filling.admits(slab) {
                Ok(()) => filling.add(slab),
                Err(Error::Invalid(more)) => problems.extend(more),
                Err(other) => return Err(other),
            }
        }
        if !problems.is_empty() {
            return Err(Error::Invalid(problems));
        }
        filling.end()?;
        Ok(Cube { axes, slabs })
    }

    /// The slabs it is made of.
    pub fn slabs(&self) -> &[Slab] {
        &self.slabs
    }

    /// The slabs, to be put together with others.
    pub fn into_slabs(self) -> Vec<Slab> {
        self.slabs
    }

    /// The part of it that the surface emits; what maps add is not in it.
    pub fn thermal(&self) -> Cube {
        Cube { axes: self.axes.clone(), slabs: self.slabs.iter().map(Slab::thermal).collect() }
    }

    /// Radiance of some pixels in some bands, W m-2 sr-1 um-1: `put(pixel, first_band, values)` gets a few bands of
    /// one pixel at a time, of each slab all pixels before the next bands.
    ///
    /// Each value is the sum of its weights times spectra in the order they are stored, whichever pixels and bands are requested.
    pub fn expand(&self, pixels: Range<usize>, bands: Range<usize>, mut put: impl FnMut(usize, usize, &[f64])) {
        for slab in &self.slabs {
            let of_lines = slab.lines.start * self.axes.samples..slab.lines.end * self.axes.samples;
            let pixels = pixels.start.max(of_lines.start)..pixels.end.min(of_lines.end);
            let bands = bands.start.max(slab.bands.start)..bands.end.min(slab.bands.end);
            if !pixels.is_empty() && !bands.is_empty() {
                let (first_pixel, first_band) = (of_lines.start, slab.bands.start);
                let of_slab = |range: Range<usize>, first: usize| range.start - first..range.end - first;
                slab.expand(of_slab(pixels, first_pixel), of_slab(bands, first_band), |pixel, band, values| {
                    put(first_pixel + pixel, first_band + band, values);
                });
            }
        }
    }

    /// Radiance of a pixel in every band, W m-2 sr-1 um-1.
    pub fn pixel(&self, pixel: usize, radiance: &mut [f64]) {
        self.expand(pixel..pixel + 1, 0..self.axes.bands.len(), |_, band, values| {
            radiance[band..band + values.len()].copy_from_slice(values);
        });
    }

    /// Radiance of every pixel in one band, line by line, W m-2 sr-1 um-1.
    pub fn band(&self, band: usize) -> Vec<f64> {
        // Slabs come in any order.
        let pixels = self.axes.samples * self.axes.lines;
        let mut radiance = vec![0.0; pixels];
        self.expand(0..pixels, band..band + 1, |pixel, _, values| radiance[pixel] = values[0]);
        radiance
    }

    /// The whole cube as [line, sample, band], W m-2 sr-1 um-1.
    pub fn to_array(&self) -> Array3<f64> {
        let CubeAxes { samples, lines, bands, .. } = &self.axes;
        let mut array = Array3::zeros((*lines, *samples, bands.len()));
        if let Some(values) = array.as_slice_mut() {
            for (pixel, radiance) in values.chunks_exact_mut(bands.len()).enumerate() {
                self.pixel(pixel, radiance);
            }
        }
        array
    }
}

impl Slab {
    /// Of radiance that has no weights: [band, pixel], of so many lines from each line to the next.
    pub fn dense(lines: Range<usize>, bands: Range<usize>, radiance: Vec<f64>) -> Self {
        let pixels = radiance.len() / bands.len().max(1);
        let added = Added { start: (0..=pixels).collect(), radiance };
        Slab { lines, bands, row_start: vec![0; pixels + 1], added, ..Slab::default() }
    }

    /// What does not fit together in it, as a slab of this many pixels: a sentence for each problem.
    pub(super) fn problems(&self, pixels: usize) -> Vec<String> {
        let Slab { bands, row_start, row, weight, spectra, added, .. } = self;
        let mut problems = Vec::new();
        let is_listed = row_start.len().checked_sub(1) == Some(pixels)
            && row_start.first() == Some(&0)
            && row_start.last() == Some(&row.len())
            && row_start.is_sorted();
        let rows = spectra.len() / bands.len().max(1);
        if !is_listed || row.len() != weight.len() || row.iter().any(|row| *row as usize >= rows) {
            problems.push(format!("{} weights of {rows} rows are not those of {pixels} pixels", row.len()));
        }
        if spectra.len() != rows * bands.len() || !added.fits(pixels, bands.len()) {
            problems.push(format!("has not {} bands of {pixels} pixels", bands.len()));
        }
        problems
    }

    /// As [`Cube::thermal`].
    #[must_use]
    pub fn thermal(&self) -> Slab {
        let Slab { lines, bands, spectra, first_thermal_row, .. } = self;
        let mut part = Slab {
            lines: lines.clone(),
            bands: bands.clone(),
            row_start: vec![0],
            row: vec![],
            weight: vec![],
            spectra: spectra.clone(),
            first_thermal_row: *first_thermal_row,
            added: Added::default(),
        };
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

    /// One slab of several, each times its weight: the same lines and bands, seen from several poses. Spectra may be others, as of a body that comes into view.
    /// `None` if they are not of the same pixels and bands, or one does not fit together.
    pub fn sum(parts: &[(f64, Slab)]) -> Option<Slab> {
        let (_, first) = parts.first()?;
        let pixels = first.row_start.len().checked_sub(1)?;
        let is_alike = |slab: &Slab| {
            slab.problems(pixels).is_empty() && (&slab.lines, &slab.bands) == (&first.lines, &first.bands)
        };
        if !parts.iter().all(|(_, slab)| is_alike(slab)) {
            return None;
        }
        let mut sum = Self::sum_of_weights(parts, pixels);
        let bands = first.bands.len();
        let is_reached = |pixel| parts.iter().any(|(_, slab)| slab.added.place(pixel).is_some());
        sum.added = Added::zeros((0..pixels).map(is_reached), bands);
        let all = sum.added.reached();
        for (share, Slab { added, .. }) in parts {
            let places = (0..pixels).filter_map(|pixel| sum.added.place(pixel).zip(added.place(pixel)));
            for (to, from) in places.collect::<Vec<_>>() {
                for band in 0..bands {
                    sum.added.radiance[band * all + to] += share * added.radiance[band * added.reached() + from];
                }
            }
        }
        Some(sum)
    }

    /// The same without what maps add: one list of spectra where all have it, else those of all.
    fn sum_of_weights(parts: &[(f64, Slab)], pixels: usize) -> Slab {
        let Some((_, first)) = parts.first() else { return Slab::default() };
        let has_spectra_of_first =
            |slab: &Slab| slab.first_thermal_row == first.first_thermal_row && slab.spectra == first.spectra;
        if !parts.iter().all(|(_, slab)| has_spectra_of_first(slab)) {
            let weighted = |(share, slab): &(f64, Slab)| {
                let weight = slab.weight.iter().map(|weight| share * weight).collect();
                Slab { weight, added: Added::default(), ..slab.clone() }
            };
            return Slab::over(&parts.iter().map(weighted).collect::<Vec<_>>());
        }
        let mut sum =
            Slab { row_start: vec![0], row: vec![], weight: vec![], added: Added::default(), ..first.clone() };
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for pixel in 0..pixels {
            entries.clear();
            for (share, slab) in parts {
                let of = slab.row_start[pixel]..slab.row_start[pixel + 1];
                entries.extend(slab.row[of.clone()].iter().copied().zip(slab.weight[of].iter().map(|w| share * w)));
            }
            entries.sort_by_key(|entry| entry.0);
            entries.dedup_by(|next, first| {
                let same = next.0 == first.0;
                if same {
                    first.1 += next.1;
                }
                same
            });
            sum.row.extend(entries.iter().map(|entry| entry.0));
            sum.weight.extend(entries.iter().map(|entry| entry.1));
            sum.row_start.push(sum.row.len());
        }
        sum
    }

    /// The same with a factor on each pixel and one on each band; what maps add is not carried over.
    #[must_use]
    pub fn scaled(mut self, by_pixel: &[f64], by_band: &[f64]) -> Slab {
        for (entries, factor) in self.row_start.windows(2).zip(by_pixel) {
            self.weight[entries[0]..entries[1]].iter_mut().for_each(|weight| *weight *= factor);
        }
        self.spectra.iter_mut().zip(by_band.iter().cycle()).for_each(|(value, factor)| *value *= factor);
        self.added = Added::default();
        self
    }

    /// One slab of several of the same pixels and bands, whose radiances add up, each with its own spectra; empty of none. What maps add is not carried over.
    pub fn over(parts: &[Slab]) -> Slab {
        let (mut all, numbers) = joined(parts, |_, _| true);
        let pixels = parts.iter().map(|part| part.row_start.len().saturating_sub(1)).min().unwrap_or(0);
        let mut entries: Vec<(u32, f64)> = Vec::new();
        for pixel in 0..pixels {
            entries.clear();
            parts.iter().zip(&numbers).for_each(|(part, numbers)| entries.extend(part.renumbered(pixel, numbers)));
            entries.sort_by_key(|entry| entry.0);
            all.push_pixel(&entries);
        }
        all
    }

    /// One slab of several of the same bands and number of lines, side by side, each with those of its own spectra that pixels have; empty of none.
    pub fn beside(parts: &[Slab]) -> Slab {
        let used: Vec<Vec<bool>> = parts
            .iter()
            .map(|part| {
                let mut used = vec![false; part.rows()];
                part.row.iter().for_each(|row| used[*row as usize] = true);
                used
            })
            .collect();
        let (mut all, numbers) = joined(parts, |part, row| used[part][row]);
        let lines = all.lines.len().max(1);
        let mut order: Vec<(&Added, usize)> = Vec::new();
        for line in 0..lines {
            for (part, numbers) in parts.iter().zip(&numbers) {
                let samples = part.row_start.len().saturating_sub(1) / lines;
                for pixel in line * samples..(line + 1) * samples {
                    let entries: Vec<(u32, f64)> = part.renumbered(pixel, numbers).collect();
                    all.push_pixel(&entries);
                    order.push((&part.added, pixel));
                }
            }
        }
        let bands = all.bands.len();
        all.added = Added::zeros(order.iter().map(|(added, pixel)| added.place(*pixel).is_some()), bands);
        let reached = all.added.reached();
        for (pixel, (from, of_part)) in order.into_iter().enumerate() {
            let Some((place, of_part)) = all.added.place(pixel).zip(from.place(of_part)) else { continue };
            for band in 0..bands {
                all.added.radiance[band * reached + place] = from.radiance[band * from.reached() + of_part];
            }
        }
        all
    }

    /// Number of spectra.
    fn rows(&self) -> usize {
        self.spectra.len() / self.bands.len().max(1)
    }

    /// A pixel's rows, by other numbers, and weights.
    fn renumbered(&self, pixel: usize, numbers: &[u32]) -> impl Iterator<Item = (u32, f64)> {
        let of = self.row_start[pixel]..self.row_start[pixel + 1];
        of.map(|i| (numbers[self.row[i] as usize], self.weight[i]))
    }

    fn push_pixel(&mut self, entries: &[(u32, f64)]) {
        self.row.extend(entries.iter().map(|entry| entry.0));
        self.weight.extend(entries.iter().map(|entry| entry.1));
        self.row_start.push(self.row.len());
    }

    /// As [`Cube::expand`], of its own pixels and bands: they count from 0.
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
        if let Some(place) = self.added.place(pixel) {
            let reached = self.added.reached();
            sum = std::array::from_fn(|k| self.added.radiance[(first_band + k) * reached + place]);
        }
        for (row, weight) in self.row[entries.clone()].iter().zip(&self.weight[entries]) {
            let spectrum = &self.spectra[*row as usize * self.bands.len() + first_band..][..N];
            for (sum, value) in sum.iter_mut().zip(spectrum) {
                *sum += weight * value;
            }
        }
        sum
    }
}

/// A slab without pixels that has the spectra of several, those that are kept (part, row): of all the reflected ones first; and for each part its rows' new numbers.
fn joined(parts: &[Slab], is_kept: impl Fn(usize, usize) -> bool) -> (Slab, Vec<Vec<u32>>) {
    let mut all = Slab { row_start: vec![0], ..Slab::default() };
    if let Some(first) = parts.first() {
        (all.lines, all.bands) = (first.lines.clone(), first.bands.clone());
    }
    let mut numbers: Vec<Vec<u32>> = parts.iter().map(|part| vec![0; part.rows()]).collect();
    let mut count = 0;
    for is_thermal in [false, true] {
        for (place, part) in parts.iter().enumerate() {
            let bands = part.bands.len();
            for row in (0..part.rows()).filter(|row| is_kept(place, *row)) {
                if (row >= part.first_thermal_row as usize) == is_thermal {
                    all.spectra.extend_from_slice(&part.spectra[row * bands..][..bands]);
                    numbers[place][row] = count;
                    count += 1;
                }
            }
        }
        if !is_thermal {
            all.first_thermal_row = count;
        }
    }
    (all, numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slabs_beside_and_over_each_other_keep_their_spectra() {
        // One band; a: two pixels of one line, sunlight 2 and heat 3; b: sunlight 5, heat 7 unused.
        let slab = |spectra: [f64; 2], row_start: Vec<usize>, row: Vec<u32>, weight: Vec<f64>| Slab {
            lines: 4..5,
            bands: 0..1,
            row_start,
            row,
            weight,
            spectra: spectra.to_vec(),
            first_thermal_row: 1,
            added: Added::default(),
        };
        let a = slab([2.0, 3.0], vec![0, 2, 3], vec![0, 1, 1], vec![1.0, 10.0, 1.0]);
        let b = slab([5.0, 7.0], vec![0, 1, 1], vec![0], vec![2.0]);
        let radiance = |slab: &Slab| {
            let mut all = Vec::new();
            slab.expand(0..slab.row_start.len() - 1, 0..1, |_, _, values| all.push(values[0]));
            all
        };
        let (beside, over) = (Slab::beside(&[a.clone(), b.clone()]), Slab::over(&[a.clone(), b.clone()]));
        // Poses that see other spectra: half of each.
        let sum = Slab::sum(&[(0.5, a.clone()), (0.5, b.clone())]).unwrap();
        assert_eq!((radiance(&sum), radiance(&sum.thermal())), (vec![21.0, 1.5], vec![15.0, 1.5]));
        assert_eq!(
            (radiance(&beside), radiance(&beside.thermal())),
            (vec![32.0, 3.0, 10.0, 0.0], vec![30.0, 3.0, 0.0, 0.0])
        );
        assert_eq!((radiance(&over), radiance(&over.thermal())), (vec![42.0, 3.0], vec![30.0, 3.0]));
        assert_eq!((beside.spectra, beside.lines.clone()), (vec![2.0, 5.0, 3.0], 4..5));
        assert_eq!(radiance(&a.scaled(&[1.0, 2.0], &[0.5])), [16.0, 3.0]);
        assert!(Slab::beside(&[]).problems(0).is_empty());
    }

    /// Two pixels of 21 bands; pixel 0 is 2 a + 3 b, pixel 1 is sky.
    fn cube() -> Cube {
        let bands: Vec<Band> = (0..21).map(|i| Band::new(1.0 + f64::from(i), None)).collect();
        let a = (0..21).map(f64::from);
        let b = (0..21).map(|i| 100.0 * f64::from(i));
        let slab = Slab {
            lines: 0..1,
            bands: 0..21,
            row_start: vec![0, 2, 2],
            row: vec![0, 1],
            weight: vec![2.0, 3.0],
            spectra: a.chain(b).collect(),
            first_thermal_row: 1,
            added: Added::default(),
        };
        Cube::new(CubeAxes { samples: 2, lines: 1, bands, quantity: Quantity::Radiance }, vec![slab]).unwrap()
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
        cube.slabs[0].added = Added { start: vec![0, 1, 2], radiance: vec![1.0; 42] };
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
        // Pixel 1 alone is reached.
        let radiance = (0..21).map(|i| f64::from(i) * 1000.0).collect();
        cube.slabs[0].added = Added { start: vec![0, 0, 1], radiance };
        let mut radiance = [f64::NAN; 21];
        cube.pixel(1, &mut radiance);
        assert_eq!((radiance[0], radiance[16], radiance[20]), (0.0, 16_000.0, 20_000.0));
        cube.pixel(0, &mut radiance);
        assert_eq!((radiance[0], radiance[20]), (0.0, 302.0 * 20.0));
        // Both are.
        let radiance_of_both = (0..42).map(|i| f64::from(i) * 1000.0).collect();
        cube.slabs[0].added = Added { start: vec![0, 1, 2], radiance: radiance_of_both };
        cube.pixel(0, &mut radiance);
        assert_eq!((radiance[0], radiance[20]), (0.0, 40_000.0 + 302.0 * 20.0));
        cube.pixel(1, &mut radiance);
        assert_eq!((radiance[0], radiance[20]), (1000.0, 41_000.0));
    }

    #[test]
    fn pixels_bands_and_the_whole_cube_are_the_same_numbers() {
        let mut cube = cube();
        cube.slabs[0].weight = vec![0.1, 1.0 / 3.0];
        let array = cube.to_array();
        let mut radiance = [0.0; 21];
        cube.pixel(0, &mut radiance);
        for (band, value) in radiance.iter().enumerate() {
            assert_eq!(*value, array[[0, 0, band]]);
            assert_eq!(cube.band(band), [*value, 0.0]);
        }
    }
}
