//! Numbers in blocks of a few rows and columns, all of one size, with other bytes between them: tiles of ISIS, and lines of PDS3 between
//! what stands before and behind each.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use crate::error::{Error, Result};
use crate::formats::flat::Flat;
use crate::formats::input;

/// Where the blocks of a file are. All are whole; those at the right and at the bottom may reach beyond the image.
#[derive(Debug, Clone)]
pub(super) struct Blocks {
    /// Size of the image, type of the numbers, and where the first block begins.
    pub(super) flat: Flat,
    /// Rows and columns of a block.
    pub(super) size: [usize; 2],
    /// From one block's first byte to the next one's.
    pub(super) step: u64,
    /// Whether the first line of all bands comes first, and not all lines of the first band; blocks are lines then.
    pub(super) is_line_by_line: bool,
}

impl Blocks {
    /// Number of blocks below one another, and side by side.
    fn counts(&self) -> [usize; 2] {
        [self.flat.rows.div_ceil(self.size[0].max(1)), self.flat.columns.div_ceil(self.size[1].max(1))]
    }

    /// Bytes of a block's numbers.
    fn block_bytes(&self) -> Option<usize> {
        self.size[0].checked_mul(self.size[1])?.checked_mul(self.flat.data_type.bytes())
    }

    /// The byte behind the last number; `None` if no file can be that long.
    pub(super) fn end(&self) -> Option<u64> {
        let [down, across] = self.counts().map(|n| n as u64);
        let blocks = down.checked_mul(across)?.checked_mul(self.flat.bands as u64)?;
        let last = blocks.checked_sub(1)?.checked_mul(self.step)?;
        self.flat.start.checked_add(last)?.checked_add(self.block_bytes()? as u64)
    }

    /// Reads some bands, [band, row, column].
    pub(super) fn read(&self, path: &Path, bands: Range<usize>, values: &mut [f64]) -> Result<()> {
        let reading = |e| Error::io(path, "reading", e);
        let file = input::open(path).map_err(reading)?;
        self.read_from(BufReader::with_capacity(1 << 18, file), bands, values).map_err(reading)
    }

    fn read_from(&self, mut file: BufReader<File>, bands: Range<usize>, values: &mut [f64]) -> std::io::Result<()> {
        let Flat { rows, columns, data_type, big_endian, .. } = self.flat;
        let [down, across] = self.counts();
        let size = self.block_bytes().ok_or(std::io::ErrorKind::InvalidData)?;
        let (mut bytes, mut numbers) = (vec![0; size], vec![0.0; self.size[0] * self.size[1]]);
        let mut at = file.stream_position()?;
        for (band, plane) in bands.zip(values.chunks_exact_mut(rows * columns)) {
            for (i, j) in (0..down).flat_map(|i| (0..across).map(move |j| (i, j))) {
                let block =
                    if self.is_line_by_line { i * self.flat.bands + band } else { (band * down + i) * across + j };
                // That all of it is within the file's length was checked when it was opened.
                let wanted = self.flat.start + block as u64 * self.step;
                match i64::try_from(i128::from(wanted) - i128::from(at)) {
                    Ok(by) => file.seek_relative(by)?,
                    Err(_) => drop(file.seek(SeekFrom::Start(wanted))?),
                }
                file.read_exact(&mut bytes)?;
                at = wanted + size as u64;
                data_type.decode(big_endian, &bytes, &mut numbers);
                let first = [i * self.size[0], j * self.size[1]];
                let width = self.size[1].min(columns - first[1]);
                for (row, line) in (first[0]..rows).zip(numbers.chunks_exact(self.size[1])) {
                    plane[row * columns + first[1]..][..width].copy_from_slice(&line[..width]);
                }
            }
        }
        Ok(())
    }
}
