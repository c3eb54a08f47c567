//! NetCDF, as it is written: the classic format in its version with 64-bit offsets, which every NetCDF library reads, or with 64-bit data ("CDF-5"), where
//! an array is larger than the former holds, or of a type that it has not.
//!
//! Source: "The NetCDF Classic Format Specification" (Unidata, User's Guide, appendix B). Arrays are contiguous and big-endian, so that they are written
//! piece by piece; HDF5, on which NetCDF-4 is built, would bring nothing that cubes need.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use super::dataset::{Attributes, Dataset, Slot, Value, Variable};
use super::number::DataType;
use crate::error::{Error, Result};

/// Tags of the lists of a header; an empty list has none.
const DIMENSIONS: u32 = 10;
const VARIABLES: u32 = 11;
const ATTRIBUTES: u32 = 12;
/// Codes of types.
const CHAR: u32 = 2;
/// Arrays of the version with 64-bit offsets are smaller than this.
const LARGEST: u64 = u32::MAX as u64 - 3;

/// The code of a type, and whether CDF-5 alone has it.
fn code(data_type: DataType) -> (u32, bool) {
    match data_type {
        DataType::I8 => (1, false),
        DataType::I16 => (3, false),
        DataType::I32 => (4, false),
        DataType::F32 => (5, false),
        DataType::F64 => (6, false),
        DataType::U8 => (7, true),
        DataType::U16 => (8, true),
        DataType::U32 => (9, true),
        DataType::I64 => (10, true),
        DataType::U64 => (11, true),
    }
}

/// The type in which numbers are written: of whole numbers without a sign the next larger one, which older programs know, too.
pub(super) fn type_of(data_type: DataType) -> DataType {
    match data_type {
        DataType::U8 => DataType::I16,
        DataType::U16 => DataType::I32,
        other => other,
    }
}

/// A header in the making.
struct Header {
    bytes: Vec<u8>,
    wide: bool,
}

impl Header {
    fn tag(&mut self, tag: u32) {
        self.bytes.extend(tag.to_be_bytes());
    }

    /// A count or a length: of CDF-5 it has 64 bits.
    fn count(&mut self, count: u64) {
        match u32::try_from(count) {
            Ok(short) if !self.wide => self.bytes.extend(short.to_be_bytes()),
            // Only sizes of the other version are as large, whose readers reckon them from the axes.
            Err(_) if !self.wide => self.bytes.extend(u32::MAX.to_be_bytes()),
            _ => self.bytes.extend(count.to_be_bytes()),
        }
    }

    fn padded(&mut self, bytes: &[u8]) {
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }

    fn name(&mut self, name: &str) {
        self.count(name.len() as u64);
        self.padded(name.as_bytes());
    }

    fn list(&mut self, tag: u32, length: usize) {
        self.tag(if length == 0 { 0 } else { tag });
        self.count(length as u64);
    }

    fn attributes(&mut self, attributes: &Attributes, data_type: DataType) {
        self.list(ATTRIBUTES, attributes.len());
        for (name, value) in attributes {
            self.name(name);
            let mut numbers = Vec::new();
            let (code, length) = match value {
                Value::Text(text) => {
                    numbers.extend(text.as_bytes());
                    (CHAR, text.len())
                }
                Value::Sample(value) => {
                    data_type.encode(true, &[*value], &mut numbers);
                    (code(data_type).0, 1)
                }
            };
            self.tag(code);
            self.count(length as u64);
            self.padded(&numbers);
        }
    }
}

/// The header, and where each variable and each text begins.
fn laid_out(data: &Dataset<'_>) -> (Vec<u8>, Vec<u64>) {
    let wide = data.variables.iter().any(|v| code(v.data_type).1 || data.bytes(v) > LARGEST);
    // A first header has the right length, a second one the right places.
    let length = header(data, wide, &[]).len() as u64;
    let mut at = length.next_multiple_of(4);
    let mut starts = Vec::new();
    for bytes in data.variables.iter().map(|v| data.bytes(v)).chain(data.texts.iter().map(|t| t.text.len() as u64)) {
        starts.push(at);
        at = at.saturating_add(bytes).saturating_add(3) / 4 * 4;
    }
    (header(data, wide, &starts), starts)
}

fn header(data: &Dataset<'_>, wide: bool, starts: &[u64]) -> Vec<u8> {
    let mut header = Header { bytes: vec![b'C', b'D', b'F', if wide { 5 } else { 2 }], wide };
    // No records: all axes have a length.
    header.count(0);
    header.list(DIMENSIONS, data.axes.len() + data.texts.len());
    for axis in &data.axes {
        header.name(axis.name);
        header.count(axis.length as u64);
    }
    for text in &data.texts {
        header.name(&format!("{}_length", text.name));
        header.count(text.text.len() as u64);
    }
    header.attributes(&data.attributes, DataType::F64);
    header.list(VARIABLES, data.variables.len() + data.texts.len());
    let mut starts = starts.iter();
    let mut variable = |name: &str, axes: &[usize], attributes: &Attributes, data_type, (code, bytes): (u32, u64)| {
        header.name(name);
        header.count(axes.len() as u64);
        axes.iter().for_each(|axis| header.count(*axis as u64));
        header.attributes(attributes, data_type);
        header.tag(code);
        header.count(bytes.saturating_add(3) / 4 * 4);
        header.bytes.extend(starts.next().unwrap_or(&0).to_be_bytes());
    };
    for v in &data.variables {
        let Variable { name, axes, data_type, attributes, .. } = v;
        variable(name, axes, attributes, *data_type, (code(*data_type).0, data.bytes(v)));
    }
    for (i, text) in data.texts.iter().enumerate() {
        let attributes = vec![("long_name", Value::from(text.about))];
        variable(text.name, &[data.axes.len() + i], &attributes, DataType::U8, (CHAR, text.text.len() as u64));
    }
    header.bytes
}

/// Where the numbers of each variable go.
pub(super) fn slots(path: &Path, data: &Dataset<'_>) -> Vec<Slot> {
    let (_, starts) = laid_out(data);
    let slot = |(_, start): (&Variable<'_>, u64)| Slot { path: path.to_owned(), start, big_endian: true };
    data.variables.iter().zip(starts).map(slot).collect()
}

/// Writes the header and the texts: the file is then whole.
///
/// # Errors
/// [`Error::Io`].
pub(super) fn finish(path: &Path, data: &Dataset<'_>) -> Result<()> {
    let (header, starts) = laid_out(data);
    let write = || {
        let mut file = File::options().write(true).open(path)?;
        file.write_all(&header)?;
        let mut end = header.len() as u64;
        for (text, start) in data.texts.iter().zip(&starts[data.variables.len()..]) {
            file.seek(SeekFrom::Start(*start))?;
            file.write_all(text.text.as_bytes())?;
            end = start + text.text.len() as u64;
        }
        if data.texts.is_empty()
            && let (Some(last), Some(start)) = (data.variables.last(), starts.last())
        {
            end = start + data.bytes(last);
        }
        file.set_len(end.next_multiple_of(4))
    };
    write().map_err(|e| Error::io(path, "writing", e))
}
