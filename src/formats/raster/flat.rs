//! Numbers of one type in a file, one after the other: ENVI, ILWIS and NumPy differ in the order of axes only.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

use crate::error::{Error, Result};
use crate::formats::envi::Interleave;
use crate::formats::input;
use crate::formats::number::DataType;

/// Numbers are read, and written, in pieces of about as many bytes.
const PIECE: usize = 1 << 20;

/// Order of the axes, slowest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// Band, row, column: a band in one piece.
    BandRowColumn,
    /// Band, column, row: the same in Fortran's order.
    BandColumnRow,
    /// Row, band, column.
    RowBandColumn,
    /// Row, column, band: a pixel in one piece.
    RowColumnBand,
}

impl From<Interleave> for Order {
    fn from(interleave: Interleave) -> Self {
        match interleave {
            Interleave::Bsq => Order::BandRowColumn,
            Interleave::Bil => Order::RowBandColumn,
            Interleave::Bip => Order::RowColumnBand,
        }
    }
}

/// How a file's numbers lie.
#[derive(Debug, Clone)]
pub(super) struct Flat {
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) bands: usize,
    /// Bytes before the first number.
    pub(super) start: u64,
    pub(super) data_type: DataType,
    pub(super) big_endian: bool,
    pub(super) order: Order,
    /// Bytes before each row of [`Order::RowBandColumn`] when written: OpenEXR has a head there.
    pub(super) gap: u64,
}

impl Flat {
    /// Bytes of all numbers; `None` if no file can have as many.
    pub(super) fn data_bytes(&self) -> Option<u64> {
        let pixels = (self.rows as u64).checked_mul(self.columns as u64)?;
        pixels.checked_mul(self.bands as u64)?.checked_mul(self.data_type.bytes() as u64)
    }

    /// Whether a band lies in one piece.
    pub(super) fn is_banded(&self) -> bool {
        matches!(self.order, Order::BandRowColumn | Order::BandColumnRow) || self.bands == 1
    }

    /// Reads some bands, [band, row, column].
    pub(super) fn read(&self, path: &Path, bands: Range<usize>, values: &mut [f64]) -> Result<()> {
        let reading = |e| Error::io(path, "reading", e);
        let file = input::open(path).map_err(reading)?;
        self.read_from(file, bands, values).map_err(reading)
    }

    /// Reads some bands, [band, row, column], of what is a file or lies in memory.
    pub(super) fn read_from(
        &self,
        file: impl Read + Seek,
        bands: Range<usize>,
        values: &mut [f64],
    ) -> std::io::Result<()> {
        let mut run = Run { file, flat: self, bytes: Vec::new() };
        let (rows, columns) = (self.rows, self.columns);
        let pixels = rows * columns;
        let mut numbers = Vec::new();
        match self.order {
            Order::BandRowColumn => run.read(bands.start * pixels, values)?,
            Order::BandColumnRow => {
                let step = (PIECE / 8 / rows).clamp(1, columns);
                for (band, values) in bands.zip(values.chunks_exact_mut(pixels)) {
                    for first in (0..columns).step_by(step) {
                        numbers.resize(rows * step.min(columns - first), 0.0);
                        run.read(band * pixels + first * rows, &mut numbers)?;
                        for (i, number) in numbers.iter().enumerate() {
                            values[i % rows * columns + first + i / rows] = *number;
                        }
                    }
                }
            }
            Order::RowBandColumn => {
                numbers.resize(bands.len() * columns, 0.0);
                for row in 0..rows {
                    run.read((row * self.bands + bands.start) * columns, &mut numbers)?;
                    for (line, plane) in numbers.chunks_exact(columns).zip(values.chunks_exact_mut(pixels)) {
                        plane[row * columns..][..columns].copy_from_slice(line);
                    }
                }
            }
            Order::RowColumnBand => {
                let step = (PIECE / 8 / self.bands).clamp(1, pixels);
                for first in (0..pixels).step_by(step) {
                    numbers.resize(self.bands * step.min(pixels - first), 0.0);
                    run.read(first * self.bands, &mut numbers)?;
                    for (band, plane) in bands.clone().zip(values.chunks_exact_mut(pixels)) {
                        let one_band = numbers[band..].iter().step_by(self.bands);
                        plane[first..].iter_mut().zip(one_band).for_each(|(value, number)| *value = *number);
                    }
                }
            }
        }
        Ok(())
    }
}

impl Flat {
    /// Bands that are written at a time: as many as memory is given for, where they are interleaved.
    pub(super) fn together(&self, most_bytes: usize) -> usize {
        if self.is_banded() { 1 } else { (most_bytes / (8 * self.rows * self.columns)).clamp(1, self.bands) }
    }

    /// Writes some bands, [band, row, column], each where it belongs.
    pub(super) fn write(&self, file: &mut File, bands: Range<usize>, values: &[f64]) -> std::io::Result<()> {
        let size = self.data_type.bytes();
        let (rows, columns) = (self.rows, self.columns);
        let pixels = rows * columns;
        let mut bytes = Vec::new();
        let mut put = |at: u64, numbers: &[f64]| {
            file.seek(SeekFrom::Start(self.start + at))?;
            for piece in numbers.chunks(PIECE / size) {
                bytes.clear();
                self.data_type.encode(self.big_endian, piece, &mut bytes);
                file.write_all(&bytes)?;
            }
            Ok::<(), std::io::Error>(())
        };
        let at = |number: usize| number as u64 * size as u64;
        match self.order {
            Order::BandRowColumn => put(at(bands.start * pixels), values),
            Order::BandColumnRow => Err(std::io::ErrorKind::Unsupported.into()),
            Order::RowBandColumn => (0..rows).try_for_each(|row| {
                let lines = values.chunks_exact(pixels).flat_map(|plane| &plane[row * columns..][..columns]);
                let line: Vec<f64> = lines.copied().collect();
                put(at((row * self.bands + bands.start) * columns) + self.gap * (row as u64 + 1), &line)
            }),
            Order::RowColumnBand if bands.len() == self.bands => {
                let step = (PIECE / 8 / self.bands).max(1);
                (0..pixels).step_by(step).try_for_each(|first| {
                    let some = first..pixels.min(first + step);
                    let numbers = some.flat_map(|pixel| values[pixel..].iter().step_by(pixels));
                    put(at(first * self.bands), &numbers.copied().collect::<Vec<f64>>())
                })
            }
            Order::RowColumnBand => (0..pixels).try_for_each(|pixel| {
                let numbers: Vec<f64> = values[pixel..].iter().step_by(pixels).copied().collect();
                put(at(pixel * self.bands + bands.start), &numbers)
            }),
        }
    }
}

/// An open file, from which runs of numbers are read.
struct Run<'a, F> {
    file: F,
    flat: &'a Flat,
    bytes: Vec<u8>,
}

impl<F: Read + Seek> Run<'_, F> {
    /// Reads numbers from the `first` on.
    fn read(&mut self, first: usize, values: &mut [f64]) -> std::io::Result<()> {
        let size = self.flat.data_type.bytes();
        // That all of it is within the file's length was checked when it was opened.
        self.file.seek(SeekFrom::Start(self.flat.start + first as u64 * size as u64))?;
        for piece in values.chunks_mut(PIECE / size) {
            self.bytes.resize(piece.len() * size, 0);
            self.file.read_exact(&mut self.bytes)?;
            self.flat.data_type.decode(self.flat.big_endian, &self.bytes, piece);
        }
        Ok(())
    }
}
