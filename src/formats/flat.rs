//! Numbers of one type in a file, one after the other: ENVI, ILWIS, NumPy and uncompressed OpenEXR differ in the order of axes only.
//! They are read band by band, and written tile by tile, each where it belongs.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

use crate::error::{Error, Result};
use crate::formats::envi::Interleave;
use crate::formats::input;
use crate::formats::number::DataType;

/// Numbers are read and written in pieces of about this many bytes.
const PIECE: usize = 1 << 20;

/// Order of the axes, slowest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AxisOrder {
    /// Band, row, column: a band in one piece.
    BandRowColumn,
    /// Band, column, row: the same in Fortran's order.
    BandColumnRow,
    /// Row, band, column.
    RowBandColumn,
    /// Row, column, band: a pixel in one piece.
    RowColumnBand,
}

impl From<Interleave> for AxisOrder {
    fn from(interleave: Interleave) -> Self {
        match interleave {
            Interleave::Bsq => AxisOrder::BandRowColumn,
            Interleave::Bil => AxisOrder::RowBandColumn,
            Interleave::Bip => AxisOrder::RowColumnBand,
        }
    }
}

/// The layout of a file's numbers.
#[derive(Debug, Clone)]
pub(super) struct Flat {
    pub(super) rows: usize,
    pub(super) columns: usize,
    pub(super) bands: usize,
    /// Bytes before the first number.
    pub(super) start: u64,
    pub(super) data_type: DataType,
    pub(super) big_endian: bool,
    pub(super) order: AxisOrder,
    /// Whether each row of [`AxisOrder::RowBandColumn`] has a head when it is written, as in OpenEXR: its number and its bytes, each an i32.
    pub(super) has_heads: bool,
}

impl Flat {
    /// Little-endian numbers from the file's first byte on.
    pub(super) fn new([rows, columns, bands]: [usize; 3], data_type: DataType, order: AxisOrder) -> Self {
        Flat { rows, columns, bands, start: 0, data_type, big_endian: false, order, has_heads: false }
    }

    /// Bytes of all numbers; `None` if no file can have that many.
    pub(super) fn data_bytes(&self) -> Option<u64> {
        let pixels = (self.rows as u64).checked_mul(self.columns as u64)?;
        pixels.checked_mul(self.bands as u64)?.checked_mul(self.data_type.bytes() as u64)
    }

    /// Whether a band is contiguous.
    pub(super) fn is_banded(&self) -> bool {
        matches!(self.order, AxisOrder::BandRowColumn | AxisOrder::BandColumnRow) || self.bands == 1
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
            AxisOrder::BandRowColumn => run.read(bands.start * pixels, values)?,
            AxisOrder::BandColumnRow => {
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
            AxisOrder::RowBandColumn => {
                numbers.resize(bands.len() * columns, 0.0);
                for row in 0..rows {
                    run.read((row * self.bands + bands.start) * columns, &mut numbers)?;
                    for (line, plane) in numbers.chunks_exact(columns).zip(values.chunks_exact_mut(pixels)) {
                        plane[row * columns..][..columns].copy_from_slice(line);
                    }
                }
            }
            AxisOrder::RowColumnBand => {
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
    /// Number of bands written at a time: as many as the memory limit allows, if they are interleaved.
    pub(super) fn together(&self, most_bytes: usize) -> usize {
        if self.is_banded() { 1 } else { (most_bytes / (8 * self.rows * self.columns)).clamp(1, self.bands) }
    }
}

/// Bytes of a row's head.
const HEAD: u64 = 8;

/// A file that is written tile by tile, in any order.
#[derive(Debug)]
pub(super) struct FlatFile {
    flat: Flat,
    file: File,
    /// Where the file would be written without seeking.
    at: u64,
}

impl FlatFile {
    /// A new file, with what comes before the numbers: they begin behind it.
    pub(super) fn create(path: &Path, flat: Flat, first: &[u8]) -> std::io::Result<Self> {
        let mut file = File::create(path)?;
        file.write_all(first)?;
        let at = first.len() as u64;
        Ok(FlatFile { flat: Flat { start: at, ..flat }, file, at })
    }

    /// A part of a file, whose other parts are written by others.
    pub(super) fn open(path: &Path, flat: Flat) -> std::io::Result<Self> {
        let file = File::options().write(true).create(true).truncate(false).open(path)?;
        Ok(FlatFile { flat, file, at: 0 })
    }

    /// Writes some bands of some rows: numbers, [band, row, column].
    pub(super) fn tile(&mut self, rows: Range<usize>, bands: Range<usize>, values: &[f64]) -> std::io::Result<()> {
        let columns = self.flat.columns;
        let plane = rows.len() * columns;
        let step = (PIECE / (8 * columns * bands.len()).max(1)).max(1);
        let Flat { data_type, big_endian, order, .. } = self.flat;
        let (mut pixels, mut bytes) = (Vec::new(), Vec::new());
        for first in (0..rows.len()).step_by(step) {
            let some = first..rows.len().min(first + step);
            bytes.clear();
            let mut lines = |band: usize, rows: Range<usize>| {
                let numbers = &values[band * plane..][rows.start * columns..rows.end * columns];
                data_type.encode(big_endian, numbers, &mut bytes);
            };
            match order {
                AxisOrder::BandRowColumn | AxisOrder::BandColumnRow => {
                    (0..bands.len()).for_each(|band| lines(band, some.clone()));
                }
                AxisOrder::RowBandColumn => {
                    some.clone().for_each(|row| (0..bands.len()).for_each(|band| lines(band, row..row + 1)));
                }
                AxisOrder::RowColumnBand => {
                    pixels.clear();
                    (some.start * columns..some.end * columns)
                        .for_each(|pixel| pixels.extend(values[pixel..].iter().step_by(plane)));
                    data_type.encode(big_endian, &pixels, &mut bytes);
                }
            }
            self.bytes(rows.start + some.start..rows.start + some.end, bands.clone(), &bytes)?;
        }
        Ok(())
    }

    /// Writes some bands of some rows: bytes in the order of the file.
    pub(super) fn bytes(&mut self, rows: Range<usize>, bands: Range<usize>, bytes: &[u8]) -> std::io::Result<()> {
        let Flat { columns, data_type, has_heads, .. } = self.flat;
        let (all_rows, all_bands) = (self.flat.rows, self.flat.bands);
        let line = columns * data_type.bytes();
        match self.flat.order {
            AxisOrder::BandRowColumn => {
                let runs = bytes.chunks_exact((rows.len() * line).max(1));
                bands.zip(runs).try_for_each(|(band, run)| self.run(band * all_rows + rows.start, 0, run))
            }
            AxisOrder::BandColumnRow => Err(std::io::ErrorKind::Unsupported.into()),
            AxisOrder::RowBandColumn => {
                let runs = bytes.chunks_exact((bands.len() * line).max(1));
                rows.zip(runs).try_for_each(|(row, run)| {
                    if has_heads && bands.start == 0 {
                        let int = |n: usize| i32::try_from(n).map_err(std::io::Error::other);
                        let head = [int(row)?.to_le_bytes(), int(all_bands * line)?.to_le_bytes()].concat();
                        self.run(row * all_bands, HEAD * row as u64, &head)?;
                    }
                    let heads = if has_heads { HEAD * (row as u64 + 1) } else { 0 };
                    self.run(row * all_bands + bands.start, heads, run)
                })
            }
            AxisOrder::RowColumnBand if bands.len() == all_bands => self.run(rows.start * all_bands, 0, bytes),
            AxisOrder::RowColumnBand => {
                let size = data_type.bytes();
                let pixels = rows.start * columns..rows.end * columns;
                pixels.zip(bytes.chunks_exact((bands.len() * size).max(1))).try_for_each(|(pixel, run)| {
                    self.put(self.flat.start + (pixel * all_bands + bands.start) as u64 * size as u64, run)
                })
            }
        }
    }

    /// Writes some pixels of one band, where bands are contiguous.
    pub(super) fn pixels(&mut self, band: usize, first: usize, bytes: &[u8]) -> std::io::Result<()> {
        let number = band * self.flat.rows * self.flat.columns + first;
        self.put(self.flat.start + number as u64 * self.flat.data_type.bytes() as u64, bytes)
    }

    /// Writes bytes that follow this many lines of one band and this many bytes of heads.
    fn run(&mut self, lines: usize, heads: u64, bytes: &[u8]) -> std::io::Result<()> {
        let line = (self.flat.columns * self.flat.data_type.bytes()) as u64;
        self.put(self.flat.start + lines as u64 * line + heads, bytes)
    }

    fn put(&mut self, at: u64, bytes: &[u8]) -> std::io::Result<()> {
        if at != self.at {
            self.file.seek(SeekFrom::Start(at))?;
        }
        self.file.write_all(bytes)?;
        self.at = at + bytes.len() as u64;
        Ok(())
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
