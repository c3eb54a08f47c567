//! The bands of an image as blocks of a page: all pixels where they fit, else one number for each cell of a few by a few pixels.

use rayon::prelude::*;
use serde_json::{Value, json};

use super::block;
use crate::error::Result;
use crate::formats::envi;
use crate::formats::raster::Raster;
use crate::progress::{Watch, tell};

/// A block takes bands up to this size, as single precision, or one band if that is larger, bytes.
const BLOCK_BYTES: usize = 1 << 20;
/// Blocks that are packed at once.
const AT_ONCE: usize = 4;

/// What the number of a cell is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cells {
    /// The mean of its pixels that have a number.
    Mean,
    /// That of the pixel in its middle: indices and angles have no means.
    Middle,
}

/// What an image is to a page.
#[derive(Debug, Clone, Copy)]
pub struct Layer {
    /// By what the page's script knows it: the `cube`, its `thermal` part, or `planes`.
    pub key: &'static str,
    /// What it is called.
    pub title: &'static str,
    /// What stands for cells, if not all pixels fit.
    pub cells: Cells,
    /// Its numbers may take so much, before they are compressed, bytes.
    pub bytes: u64,
    /// Side of the least cells that it may have, pixels.
    pub least_side: usize,
}

/// The numbers of an image, for a page.
#[derive(Debug)]
pub struct Stack {
    /// Side of its cells, pixels.
    pub side: usize,
    pub(super) about: Value,
    pub(super) blocks: Vec<String>,
}

/// Some bands: how many numbers, of so many bytes each, and their text.
struct Block {
    count: usize,
    each: usize,
    text: String,
}

/// Side of the least cell, pixels, at which numbers of so many bytes `each` fit.
fn side([columns, rows]: [usize; 2], bands: usize, each: u64, bytes: u64) -> usize {
    let size = |side: usize| (columns.div_ceil(side) * rows.div_ceil(side)) as u64 * bands as u64 * each;
    let most = columns.max(rows).max(1);
    // Sizes fall as sides grow.
    let (mut low, mut high) = (1, most);
    while low < high {
        let middle = (low + high) / 2;
        if size(middle) <= bytes { high = middle } else { low = middle + 1 }
    }
    low
}

impl Stack {
    /// Reads an image band by band.
    ///
    /// # Errors
    /// Those of [`Raster::read`]; [`crate::Error::Interrupted`] if `watch` asks to stop.
    pub fn read(raster: &mut Raster, layer: &Layer, watch: Watch<'_>) -> Result<Self> {
        let size = [raster.columns, raster.rows];
        let side = |each| side(size, raster.bands.len(), each, layer.bytes).max(layer.least_side);
        let (single, double) = (side(4), side(8));
        let (stack, bytes) = Self::of_cells(raster, layer, single, watch)?;
        // Which numbers need double precision is known when they are read. Few images have so many of them.
        if bytes <= layer.bytes || double == single {
            return Ok(stack);
        }
        Ok(Self::of_cells(raster, layer, double, watch)?.0)
    }

    /// Its cells, and the size of their numbers, bytes.
    fn of_cells(raster: &mut Raster, layer: &Layer, side: usize, watch: Watch<'_>) -> Result<(Self, u64)> {
        let Layer { key, title, cells, .. } = *layer;
        let size = [raster.columns, raster.rows];
        let count = raster.bands.len();
        let together = (BLOCK_BYTES / 4 / (size[0].div_ceil(side) * size[1].div_ceil(side))).max(1);
        let (mut values, mut blocks, mut starts) = (Vec::new(), Vec::<Block>::new(), Vec::new());
        let mut waiting: Vec<Vec<f64>> = Vec::new();
        for band in 0..count {
            tell(watch, "reading", band as u64, count as u64)?;
            raster.read(band, &mut values)?;
            let reduced = reduced(&values, size, side, cells);
            if band % together == 0 {
                starts.push(band);
                waiting.push(Vec::new());
            }
            if let Some(block) = waiting.last_mut() {
                block.extend(reduced);
            }
            let is_whole = (band + 1) % together == 0 || band + 1 == count;
            if band + 1 == count || (is_whole && waiting.len() == AT_ONCE) {
                blocks.par_extend(std::mem::take(&mut waiting).into_par_iter().map(|block| {
                    let each = if block::is_double(&block) { 8 } else { 4 };
                    Block { count: block.len(), each, text: block::packed(&block, each) }
                }));
            }
        }
        let of = |value: fn(&crate::formats::raster::RasterBand) -> Value| {
            raster.bands.iter().map(value).collect::<Vec<_>>()
        };
        let colours = raster.colour_bands();
        let about = json!({
            "key": key, "title": title, "unit": raster.unit, "columns": size[0], "rows": size[1], "side": side,
            "cells": match cells { Cells::Mean => "mean", Cells::Middle => "middle" },
            "names": of(|band| json!(band.name)), "um": of(|band| json!(band.centre_um)), "fwhm_um": of(|band| json!(band.fwhm_um)),
            "data_type": format!("{:?}", raster.data_type), "full_scale": raster.full_scale, "colours": colours,
            "starts": starts, "bytes": blocks.iter().map(|block| block.each).collect::<Vec<usize>>(), "file": file(raster),
        });
        tell(watch, "reading", count as u64, count as u64)?;
        let bytes = blocks.iter().map(|block| (block.count * block.each) as u64).sum();
        Ok((Stack { side, about, blocks: blocks.into_iter().map(|block| block.text).collect() }, bytes))
    }
}

/// How the file's numbers lie, for the page to read the whole file: of ENVI's whose numbers are the values.
fn file(raster: &Raster) -> Option<Value> {
    let name = raster.path.file_name()?.to_str()?;
    let header = envi::read_header(&envi::header_of(&raster.path).ok()?).ok()?;
    let is_plain = header.scales(raster.bands.len(), &mut Vec::new()).is_empty() && header.samples == raster.columns;
    is_plain.then(|| {
        json!({
            "name": name, "interleave": header.interleave.name(), "data_type": envi::code(header.data_type), "big_endian": header.big_endian,
            "offset": header.header_offset, "ignore": header.ignore.filter(|number| number.is_finite()),
        })
    })
}

/// One number for each cell, row by row; NaN where no pixel has one.
fn reduced(values: &[f64], [columns, rows]: [usize; 2], side: usize, cells: Cells) -> Vec<f64> {
    if side == 1 {
        return values.to_vec();
    }
    let across = columns.div_ceil(side);
    let of_cell = |i: usize| {
        let (top, left) = (i / across * side, i % across * side);
        let (bottom, right) = ((top + side).min(rows), (left + side).min(columns));
        match cells {
            Cells::Middle => values[(top + bottom) / 2 * columns + (left + right) / 2],
            Cells::Mean => {
                let (mut sum, mut count) = (0.0, 0.0);
                for value in (top..bottom).flat_map(|row| &values[row * columns + left..row * columns + right]) {
                    if !value.is_nan() {
                        sum += value;
                        count += 1.0;
                    }
                }
                sum / count
            }
        }
    };
    (0..across * rows.div_ceil(side)).into_par_iter().map(of_cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_as_small_as_fits() {
        assert_eq!(side([256, 256], 300, 4, 78_643_200), 1);
        assert_eq!(side([256, 256], 300, 4, 78_643_199), 2);
        assert_eq!(side([256, 256], 300, 8, 78_643_200), 2);
        assert_eq!((side([1, 1], 5000, 4, 1), side([7, 3], 1, 4, 4)), (1, 7));
    }

    #[test]
    fn cells_at_the_edge_have_fewer_pixels() {
        let values = [1.0, 3.0, 10.0, 5.0, f64::NAN, f64::NAN];
        let means = reduced(&values, [3, 2], 2, Cells::Mean);
        assert!((means[0], means[1]) == (3.0, 10.0));
        assert!(reduced(&[f64::NAN; 4], [2, 2], 2, Cells::Mean)[0].is_nan());
    }

    #[test]
    fn a_cell_has_the_number_of_the_pixel_in_its_middle() {
        // Of two pixels the one to the right, or below, is the middle.
        let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(reduced(&values, [3, 2], 2, Cells::Middle), [5.0, 6.0]);
        assert_eq!(reduced(&values, [2, 3], 2, Cells::Middle), [4.0, 6.0]);
        assert_eq!(reduced(&values, [6, 1], 3, Cells::Middle), [2.0, 5.0]);
        assert_eq!(reduced(&values, [1, 6], 4, Cells::Middle), [3.0, 6.0]);
    }
}
