//! Reading whole files, with what a report records about them.

use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::marks;
use crate::error::{Error, Location, Problem, Result};

use super::staging::folder_of;

/// A file that a result depends on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFile {
    /// Its path, as it was opened.
    pub path: PathBuf,
    /// Its length, bytes.
    pub bytes: u64,
    /// BLAKE3 hash of its bytes, 64 hexadecimal digits.
    pub blake3: String,
}

impl InputFile {
    /// What to say of a file whose bytes are at hand.
    pub fn of(path: &Path, bytes: &[u8]) -> Self {
        let blake3 = blake3::hash(bytes).to_hex().to_string();
        InputFile { path: path.to_owned(), bytes: bytes.len() as u64, blake3 }
    }

    /// What to say of a file, which is read to its end for it.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub(crate) fn hashed(path: &Path) -> Result<Self> {
        let reading = |e| Error::io(path, "reading", e);
        let mut file = Hashing::new(File::open(path).map_err(reading)?);
        std::io::copy(&mut file, &mut std::io::sink()).map_err(reading)?;
        Ok(file.finish(path))
    }
}

/// A deflated byte expands to at most this many: 2 bits for 258 bytes. No compression of OpenEXR saves more.
pub(crate) const MOST_DEFLATED: u64 = 1032;

/// A file that is read in pieces, and hashed on the way.
pub(crate) struct Hashing {
    file: File,
    hasher: blake3::Hasher,
    bytes: u64,
}

impl Hashing {
    pub(crate) fn new(file: File) -> Self {
        Hashing { file, hasher: blake3::Hasher::new(), bytes: 0 }
    }

    /// What to say of the file, once it has been read to its end.
    pub(crate) fn finish(self, path: &Path) -> InputFile {
        InputFile { path: path.to_owned(), bytes: self.bytes, blake3: self.hasher.finalize().to_hex().to_string() }
    }
}

impl Read for Hashing {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let n = self.file.read(buffer)?;
        self.hasher.update(&buffer[..n]);
        self.bytes += n as u64;
        Ok(n)
    }
}

/// Opens a file to read it. A folder opens too on some systems, and fails later in words of whatever reads it.
pub(crate) fn open(path: &Path) -> std::io::Result<File> {
    let file = File::open(path)?;
    if file.metadata()?.is_dir() { Err(std::io::ErrorKind::IsADirectory.into()) } else { Ok(file) }
}

/// This much of a file is read to recognise its format, bytes.
const BEGINNING: usize = 4096;

/// All bytes of a file of at most `limit` bytes.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for a longer file, of which no more than `limit` bytes are read.
pub(crate) fn bytes(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let reading = |e| Error::io(path, "reading", e);
    let file = open(path).map_err(reading)?;
    let told = file.metadata().map_err(reading)?.len();
    let mut bytes = Vec::new();
    if told <= limit {
        // A pipe or device has no length, or a wrong one: the limit applies to what is read.
        let room = usize::try_from(told).unwrap_or(usize::MAX).saturating_add(1);
        bytes.try_reserve_exact(room).map_err(|e| reading(e.into()))?;
        file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(reading)?;
    }
    if told > limit || bytes.len() as u64 > limit {
        let message = format!("is longer than the {limit} bytes that are read of such a file");
        return Err(Error::invalid(Location::file(path), message));
    }
    Ok(bytes)
}

/// At most this many bytes of a file's beginning.
///
/// # Errors
/// [`Error::Io`].
pub(crate) fn beginning(path: &Path, limit: usize) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = open(path).and_then(|file| file.take(limit as u64).read_to_end(&mut bytes));
    read.map_err(|e| Error::io(path, "reading", e))?;
    Ok(bytes)
}

/// Where a name that stands in a file begins: in that file's folder; and if it is a link and there is nothing of that name beside it, in the
/// folder of what it leads to.
pub(crate) fn home(file: &Path, name: &Path) -> PathBuf {
    let is_there = |folder: &PathBuf| folder.join(name).exists();
    let near = folder_of(file).to_owned();
    let target = || if file.is_symlink() { file.canonicalize().ok() } else { None };
    if is_there(&near) {
        near
    } else {
        target().map(|target| folder_of(&target).to_owned()).filter(is_there).unwrap_or(near)
    }
}

/// The path that `name` in `file` leads to, which must not leave the file's folder unless `outside` allows it.
///
/// # Errors
/// What is wrong with the name, as a sentence.
pub(crate) fn beside(file: &Path, name: &str, outside: bool) -> std::result::Result<PathBuf, String> {
    let folder = &home(file, Path::new(name));
    let path = folder.join(name);
    if name.contains("://") {
        return Err(format!("{name:?} is an address: nothing is fetched; put the file beside this one"));
    }
    let leaves = |path: &Path| {
        !Path::new(name).components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir)) || {
            // Links count as well; a missing file is reported on reading.
            let real = |path: &Path| path.canonicalize().ok();
            real(path).zip(real(folder)).is_some_and(|(path, folder)| !path.starts_with(folder))
        }
    };
    if !outside && leaves(&path) {
        return Err(format!("{name:?} leads out of the folder of this file; --allow-outside permits that"));
    }
    Ok(path)
}

/// Text that says nowhere how it is encoded: UTF-8, or if it cannot be that, Windows-1252, where every byte is a sign of its own, so that
/// different names stay different; and whether it is UTF-8.
pub(crate) fn decoded(bytes: &[u8]) -> (Cow<'_, str>, bool) {
    /// Of 0x80 to 0x9f, by the WHATWG's Encoding Standard; the others are those of Unicode.
    const FROM_80: &str = "\u{20ac}\u{81}\u{201a}\u{192}\u{201e}\u{2026}\u{2020}\u{2021}\u{2c6}\u{2030}\u{160}\u{2039}\u{152}\u{8d}\u{17d}\u{8f}\
                           \u{90}\u{2018}\u{2019}\u{201c}\u{201d}\u{2022}\u{2013}\u{2014}\u{2dc}\u{2122}\u{161}\u{203a}\u{153}\u{9d}\u{17e}\u{178}";
    match std::str::from_utf8(bytes) {
        Ok(text) => (text.into(), true),
        Err(_) => {
            let sign = |&byte: &u8| match byte {
                0x80..=0x9f => FROM_80.chars().nth(usize::from(byte - 0x80)).unwrap_or(char::REPLACEMENT_CHARACTER),
                _ => char::from(byte),
            };
            (bytes.iter().map(sign).collect::<String>().into(), false)
        }
    }
}

/// What some editors put before UTF-8 text. Places in a text are counted from behind it.
pub(crate) const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// Text in UTF-16 as UTF-8, where its byte order mark says so; `None` for other text, and where it is damaged.
fn from_utf16(bytes: &[u8]) -> Option<String> {
    let (rest, is_little_endian) = match bytes {
        [0xff, 0xfe, rest @ ..] => (rest, true),
        [0xfe, 0xff, rest @ ..] => (rest, false),
        _ => return None,
    };
    let (pairs, odd) = rest.as_chunks::<2>();
    let unit = |pair: [u8; 2]| if is_little_endian { u16::from_le_bytes(pair) } else { u16::from_be_bytes(pair) };
    let units = pairs.iter().map(|pair| unit(*pair));
    char::decode_utf16(units).collect::<std::result::Result<_, _>>().ok().filter(|_| odd.is_empty())
}

/// Text whose lines end in CR alone, as old programs wrote it, with LF instead; places stay the same.
pub(crate) fn with_line_ends(text: String) -> String {
    if text.contains('\r') && !text.contains('\n') { text.replace('\r', "\n") } else { text }
}

/// The text of a file of at most `limit` bytes, without a byte order mark; UTF-8, or UTF-16 that has one.
///
/// # Errors
/// [`Error::Io`]; [`Error::Invalid`] for a longer file, of which no more is read; [`Error::Syntax`] where it is not UTF-8.
pub fn text(path: &Path, limit: u64) -> Result<(String, InputFile)> {
    let bytes = bytes(path, limit)?;
    let input = InputFile::of(path, &bytes);
    if let Some(text) = from_utf16(&bytes) {
        return Ok((with_line_ends(text), input));
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok((with_line_ends(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text)), input)),
        Err(e) => {
            let good = String::from_utf8_lossy(&e.as_bytes()[..e.utf8_error().valid_up_to()]);
            let at = Location::span(path, &good, good.len(), good.len());
            Err(Error::syntax(at, marks::not_text(&e.as_bytes()[..e.as_bytes().len().min(BEGINNING)])))
        }
    }
}

/// The first problems of a file, and the number of all.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    first: Vec<Problem>,
    count: usize,
}

impl Problems {
    /// At most this many are listed one by one.
    const TOLD: usize = 20;

    pub(crate) fn push(&mut self, problem: impl FnOnce() -> Problem) {
        self.count += 1;
        if self.first.len() < Self::TOLD {
            self.first.push(problem());
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub(crate) fn finish(mut self, path: &Path) -> Result<()> {
        if self.count > self.first.len() {
            let rest = self.count - self.first.len();
            self.first.push(Problem::new(Location::file(path), format!("and {rest} more problems")));
        }
        if self.first.is_empty() { Ok(()) } else { Err(Error::Invalid(self.first)) }
    }
}

/// Levels of folders in which files are looked for by their names.
const LEVELS: usize = 2;

/// The file of this path in a folder, or else the first whose name ends so, two levels deep.
pub fn file_named(folder: &Path, name: &str) -> Option<PathBuf> {
    Some(folder.join(name)).filter(|path| path.is_file()).or_else(|| find(folder, name, LEVELS))
}

/// The file in a folder whose name ends so; of several the first by its path.
fn find(folder: &Path, name: &str, levels: usize) -> Option<PathBuf> {
    let mut entries: Vec<PathBuf> = folder.read_dir().ok()?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    entries.sort();
    let is_it =
        |path: &&PathBuf| path.is_file() && path.file_name().is_some_and(|of| of.to_string_lossy().ends_with(name));
    let here = entries.iter().find(is_it).cloned();
    let below = || entries.iter().filter(|of| of.is_dir()).find_map(|of| find(of, name, levels.checked_sub(1)?));
    here.or_else(below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_longer_than_the_limit_is_refused() {
        let path = std::env::temp_dir().join(format!("mmxrt-input-{}", std::process::id()));
        std::fs::write(&path, b"12345").unwrap();
        assert_eq!(bytes(&path, 5).unwrap(), b"12345");
        assert!(bytes(&path, 4).unwrap_err().to_string().contains("longer than the 4 bytes"));
        std::fs::write(&path, b"ab\n\xffc").unwrap();
        assert!(text(&path, 99).unwrap_err().to_string().contains(":2:1: not UTF-8"));
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(bytes(&path, 5), Err(Error::Io { .. })));
    }

    #[test]
    fn the_hash_is_blake3() {
        // The empty input's hash, from the BLAKE3 paper's test vectors.
        let empty = InputFile::of(Path::new("x"), b"");
        assert_eq!(empty.blake3, "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262");
    }
}
