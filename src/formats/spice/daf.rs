//! NAIF's double precision array files (DAF): arrays of f64, each with a summary of some f64 and i32.
//!
//! The layout is that of NAIF's DAF Required Reading. Header values are checked against the file's length before use,
//! so a damaged file is an error and takes no more memory than its size.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::error::{Error, Location, Result};
use crate::formats::input;

/// Bytes of a record.
const RECORD: usize = 1024;
/// Bytes of a number.
const WORD: u64 = 8;

/// Bytes in a machine's byte order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    Little,
    Big,
}

impl Order {
    fn f64(self, bytes: [u8; 8]) -> f64 {
        if self == Order::Little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) }
    }

    fn i32(self, bytes: [u8; 4]) -> i32 {
        if self == Order::Little { i32::from_le_bytes(bytes) } else { i32::from_be_bytes(bytes) }
    }
}

/// An array of a file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    /// Doubles of its summary.
    pub(super) doubles: Vec<f64>,
    /// Integers of its summary, without the two trailing addresses.
    pub(super) integers: Vec<i32>,
    /// Its name.
    pub(super) name: String,
    /// Its place among all arrays, from 1.
    pub(super) index: usize,
    /// Words before its first.
    before: u64,
    /// How many words it has.
    pub(super) words: usize,
}

/// A file that is open.
#[derive(Debug)]
pub(super) struct Daf<R> {
    path: PathBuf,
    source: R,
    bytes: u64,
    order: Order,
    /// Its arrays, in their order.
    pub(super) arrays: Vec<Array>,
}

/// What SPICE writes into the first record, to find out whether a file was changed on its way.
const TRANSFERRED: &[u8] = b"FTPSTR:\r:\n:\r\n:\r\x00:\x81:\x10\xce:ENDFTP";

impl Daf<File> {
    /// Opens a file whose summaries have `doubles` and `integers` (including the two addresses), and reads them.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Invalid`] for a file that contradicts itself, or is shorter than it says.
    pub(super) fn open(path: &Path, doubles: usize, integers: usize) -> Result<Self> {
        let source = input::open(path).map_err(|e| Error::io(path, "reading", e))?;
        Daf::read(path, source, doubles, integers)
    }
}

impl<R: Read + Seek> Daf<R> {
    fn read(path: &Path, mut source: R, doubles: usize, integers: usize) -> Result<Self> {
        let bytes = source.seek(SeekFrom::End(0)).map_err(|e| Error::io(path, "reading", e))?;
        let mut daf = Daf { path: path.to_owned(), source, bytes, order: Order::Little, arrays: vec![] };
        let head = daf.record(1)?;
        // Where ends of lines were changed on the way, so was this; files of before 2000 do not have it.
        if head.windows(7).any(|part| part == b"FTPSTR:")
            && !head.windows(TRANSFERRED.len()).any(|part| part == TRANSFERRED)
        {
            return Err(daf.wrong("was damaged on its way: it was copied as text, where kernels are binary".to_owned()));
        }
        daf.order = match &head[88..96] {
            b"LTL-IEEE" => Order::Little,
            b"BIG-IEEE" => Order::Big,
            other => {
                let text = String::from_utf8_lossy(other);
                return Err(daf.wrong(format!("numbers are stored as {text:?}: must be LTL-IEEE or BIG-IEEE")));
            }
        };
        let [nd, ni, first] = [8, 12, 76].map(|at| daf.integer(&head, at));
        if usize::try_from(nd).ok() != Some(doubles) || usize::try_from(ni).ok() != Some(integers) {
            return Err(
                daf.wrong(format!("summaries have {nd} and {ni} numbers; its kind has {doubles} and {integers}"))
            );
        }
        if first == 0 {
            return Err(daf.wrong("has no record of summaries: the file is damaged"));
        }
        daf.summaries(first, doubles, integers)?;
        Ok(daf)
    }

    /// Follows the chain of summaries.
    fn summaries(&mut self, first: i32, doubles: usize, integers: usize) -> Result<()> {
        // Two integers take the place of one f64.
        let size = doubles + integers.div_ceil(2);
        let most = (RECORD / 8 - 3) / size;
        let records = self.bytes / RECORD as u64;
        let (mut next, mut passed, mut words) = (first, 0, 0);
        while next != 0 {
            passed += 1;
            if passed > records {
                return Err(self.wrong("the summary records form a loop: the file is damaged"));
            }
            let [summaries, names] = [self.record(next)?, self.record(next.saturating_add(1))?];
            let control = |i: usize| self.double(&summaries, 8 * i);
            let count = (0..=most).find(|count| count_as_f64(*count) == control(2));
            let following = crate::flight::whole(control(0)).filter(|next| *next >= 0);
            let (Some(count), Some(following)) = (count, following) else {
                return Err(self.wrong(format!("record {next} is not a summary record: the file is damaged")));
            };
            for i in 0..count {
                let at = 24 + 8 * size * i;
                let index = self.arrays.len() + 1;
                let whole = |k: usize| self.integer(&summaries, at + 8 * doubles + 4 * k);
                let [start, end] = [whole(integers - 2), whole(integers - 1)].map(|at| u64::try_from(at).unwrap_or(0));
                if start == 0 || end < start || end > self.bytes / WORD {
                    let message = format!(
                        "is declared at words {start} to {end}, but the file has {}: it is truncated or damaged",
                        self.bytes / WORD
                    );
                    return Err(Error::invalid(self.at(index), message));
                }
                words += end - start + 1;
                if words > self.bytes / WORD {
                    return Err(self.wrong("arrays overlap: the file is damaged"));
                }
                let array = Array {
                    doubles: (0..doubles).map(|k| self.double(&summaries, at + 8 * k)).collect(),
                    integers: (0..integers - 2).map(whole).collect(),
                    name: String::from_utf8_lossy(&names[8 * size * i..8 * size * (i + 1)]).trim().to_owned(),
                    index,
                    before: start - 1,
                    words: usize::try_from(end - start + 1).unwrap_or(usize::MAX),
                };
                if array.doubles.iter().any(|v| !v.is_finite()) {
                    return Err(Error::invalid(
                        self.at(index),
                        "has a summary that is not finite: the file is damaged",
                    ));
                }
                self.arrays.push(array);
            }
            next = following;
        }
        Ok(())
    }

    /// All words of an array, checked to be finite.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Invalid`] for what is not finite.
    pub(super) fn words(&mut self, array: &Array) -> Result<Vec<f64>> {
        let reading = |e| Error::io(&self.path, "reading", e);
        self.source.seek(SeekFrom::Start(array.before * WORD)).map_err(reading)?;
        let mut words = Vec::new();
        words.try_reserve_exact(array.words).map_err(|e| reading(e.into()))?;
        let mut piece = vec![0; 1 << 16];
        while words.len() < array.words {
            let piece = &mut piece[..(8 * (array.words - words.len())).min(1 << 16)];
            self.source.read_exact(piece).map_err(reading)?;
            words.extend(piece.as_chunks::<8>().0.iter().map(|word| self.order.f64(*word)));
        }
        match words.iter().position(|v| !v.is_finite()) {
            None => Ok(words),
            Some(i) => Err(Error::invalid(self.at(array.index), format!("word {} is not a finite number", i + 1))),
        }
    }

    /// Where an array is, for messages.
    pub(super) fn at(&self, index: usize) -> Location {
        Location::file(&self.path).with_item(format!("segment {index}"))
    }

    fn wrong(&self, message: impl Into<String>) -> Error {
        Error::invalid(Location::file(&self.path), message)
    }

    fn record(&mut self, number: i32) -> Result<[u8; RECORD]> {
        let number = u64::try_from(number).unwrap_or(0);
        if number == 0 || number.saturating_mul(RECORD as u64) > self.bytes {
            return Err(self.wrong(format!(
                "record {number} is needed, but the file has {}: it is truncated or damaged",
                self.bytes / RECORD as u64
            )));
        }
        let mut record = [0; RECORD];
        let read = self.source.seek(SeekFrom::Start((number - 1) * RECORD as u64));
        read.and_then(|_| self.source.read_exact(&mut record)).map_err(|e| Error::io(&self.path, "reading", e))?;
        Ok(record)
    }

    fn double(&self, record: &[u8; RECORD], at: usize) -> f64 {
        record.get(at..).and_then(<[u8]>::first_chunk).map_or(0.0, |bytes| self.order.f64(*bytes))
    }

    fn integer(&self, record: &[u8; RECORD], at: usize) -> i32 {
        record.get(at..).and_then(<[u8]>::first_chunk).map_or(0, |bytes| self.order.i32(*bytes))
    }
}

/// A summary count as stored.
fn count_as_f64(count: usize) -> f64 {
    u32::try_from(count).map_or(f64::NAN, f64::from)
}
