//! The file of an entry: its name, a text (JSON), columns of numbers, and the BLAKE3 hash of all of it.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::formats::input;

/// How such a file begins.
const MAGIC: &[u8] = b"mmxrt cache\n";
/// Bytes of a hash.
pub(super) const HASH: usize = 32;

/// What an entry holds.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Packed {
    text: Vec<u8>,
    columns: Vec<Vec<u8>>,
    /// How many columns have been taken out.
    taken: usize,
}

impl Packed {
    /// With a text; `None` if it cannot be one: a path may hold anything.
    pub(super) fn new(text: &impl Serialize) -> Option<Self> {
        Some(Packed { text: serde_json::to_vec(text).ok()?, ..Packed::default() })
    }

    /// The text.
    pub(super) fn text<T: DeserializeOwned>(&self) -> Option<T> {
        serde_json::from_slice(&self.text).ok()
    }

    /// Adds a column.
    pub(super) fn put<const N: usize>(&mut self, numbers: impl Iterator<Item = [u8; N]>) {
        let mut column = Vec::with_capacity(N * numbers.size_hint().0);
        numbers.for_each(|number| column.extend_from_slice(&number));
        self.columns.push(column);
    }

    /// The next column, by numbers of `N` bytes.
    pub(super) fn take<const N: usize, T>(&mut self, number: impl Fn([u8; N]) -> T) -> Option<Vec<T>> {
        let column = std::mem::take(self.columns.get_mut(self.taken)?);
        self.taken += 1;
        let (numbers, rest) = column.as_chunks::<N>();
        rest.is_empty().then(|| numbers.iter().map(|bytes| number(*bytes)).collect())
    }
}

/// Writes what is hashed on the way.
struct Hashed<W> {
    out: W,
    hasher: blake3::Hasher,
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.out.write(bytes)?;
        self.hasher.update(&bytes[..n]);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

pub(super) fn write(file: &File, name: &str, packed: &Packed) -> io::Result<()> {
    let out = BufWriter::with_capacity(1 << 20, file);
    let mut out = Hashed { out, hasher: blake3::Hasher::new() };
    out.write_all(MAGIC)?;
    for part in [name.as_bytes(), &packed.text].into_iter().chain(packed.columns.iter().map(Vec::as_slice)) {
        out.write_all(&(part.len() as u64).to_le_bytes())?;
        out.write_all(part)?;
    }
    let hash = out.hasher.finalize();
    out.out.write_all(hash.as_bytes())?;
    out.out.flush()
}

/// An entry that is whole, and is what its name says.
pub(super) fn read(path: &Path, name: &str) -> Option<Packed> {
    // What is no file may never end, or wait for one who writes.
    let length = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?.len();
    let bytes = input::bytes(path, length).ok()?;
    let (rest, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH)?)?;
    if blake3::hash(rest).as_bytes() != hash {
        return None;
    }
    let mut rest = rest.strip_prefix(MAGIC)?;
    let mut parts = Vec::new();
    while !rest.is_empty() {
        let (length, behind) = rest.split_first_chunk::<8>()?;
        let (part, behind) = behind.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
        parts.push(part);
        rest = behind;
    }
    let mut parts = parts.into_iter();
    if parts.next()? != name.as_bytes() {
        return None;
    }
    Some(Packed { text: parts.next()?.to_vec(), columns: parts.map(<[u8]>::to_vec).collect(), taken: 0 })
}
