//! `.npz` and `.npy` archives of anyone: which arrays there are, and their bytes.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use glam::DVec3;
use zip::{CompressionMethod, ZipArchive};

use super::Header;
use crate::error::{Error, Location, Problem, Result};
use crate::formats::input::{self, MOST_DEFLATED};
use crate::formats::npy::{self, Preamble};
use crate::geometry::Direction;

const COMPRESSED: &str =
    "a .npz file compressed otherwise than by deflate (save it with np.savez or np.savez_compressed)";

/// Name, NumPy's type and shape of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArrayInfo {
    /// Name of the member, without `.npy`.
    pub name: String,
    /// Type, as in `<f8`.
    pub descr: String,
    /// Length of each axis.
    pub shape: Vec<usize>,
}

/// The header of one of our files (`None` in any other `.npz`) and its arrays.
///
/// # Errors
/// [`Error::Io`], or [`Error::Syntax`] if it is not an `.npz` file.
pub fn list(path: &Path) -> Result<(Option<Header>, Vec<ArrayInfo>)> {
    let mut file = Npz::open(path)?;
    let names = file.zip.file_names().filter_map(|n| Some(n.ok()?.strip_suffix(".npy")?.to_owned()));
    let names: Vec<String> = names.filter(|n| n != "header").collect();
    let header = file.array("header").ok().flatten().and_then(|a| serde_json::from_str(&a.text()?).ok());
    let mut arrays = Vec::new();
    for name in names {
        if let Some(array) = file.array(&name)? {
            arrays.push(ArrayInfo { name, descr: array.descr, shape: array.shape });
        }
    }
    Ok((header, arrays))
}

/// Shape and values of an array.
pub type Shaped = (Vec<usize>, Vec<f64>);

/// Arrays of numbers (f4, f8) by name, as f64; `None` if none has that name.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] naming the array that is damaged; [`Error::Unsupported`] for a compressed file;
/// [`Error::Invalid`] for an array of another type.
pub fn read_f64s(path: &Path, names: &[&str]) -> Result<Vec<Option<Shaped>>> {
    let mut file = Npz::open(path)?;
    names
        .iter()
        .map(|name| {
            let Some(array) = file.array(name)? else { return Ok(None) };
            let values = match array.descr.as_str() {
                "<f8" => array.data.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
                "<f4" => array.data.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
                other => {
                    return Err(Error::invalid(file.at(name), format!("is of type {other:?}; expected <f8 or <f4")));
                }
            };
            Ok(Some((array.shape, values)))
        })
        .collect()
}

pub(super) struct Npz {
    path: PathBuf,
    file_bytes: u64,
    /// Of all arrays so far.
    array_bytes: u64,
    zip: ZipArchive<BufReader<File>>,
}

/// An array as it is in the file.
struct Array {
    descr: String,
    shape: Vec<usize>,
    data: Vec<u8>,
}

impl Array {
    /// The text of a `<U` array without axes.
    fn text(&self) -> Option<String> {
        let is_text = self.descr.starts_with("<U") && self.shape.is_empty();
        let chars = self.data.chunks_exact(4).map(|c| char::from_u32(u32::from_le_bytes([c[0], c[1], c[2], c[3]])));
        is_text.then(|| chars.collect::<Option<String>>()).flatten().map(|s| s.trim_end_matches('\0').to_owned())
    }
}

impl Npz {
    pub(super) fn open(path: &Path) -> Result<Self> {
        let io = |e| Error::io(path, "reading", e);
        let file = input::open(path).map_err(io)?;
        let file_bytes = file.metadata().map_err(io)?.len();
        let zip = ZipArchive::new(BufReader::with_capacity(1 << 16, file)).map_err(|e| match e {
            zip::result::ZipError::Io(e) if e.kind() != std::io::ErrorKind::UnexpectedEof => io(e),
            e => Error::syntax(Location::file(path), format!("not a complete .npz file: {e}")),
        })?;
        Ok(Npz { path: path.to_owned(), file_bytes, array_bytes: 0, zip })
    }

    pub(super) fn at(&self, name: &str) -> Location {
        Location::file(&self.path).with_item(name)
    }

    /// The header of a file of this format, in one of these versions.
    pub(super) fn header(&mut self, format: &str, versions: &[u32]) -> Result<Header> {
        let Some(array) = self.array("header")? else {
            return Err(Error::invalid(self.at("header"), format!("is missing: this is not a {format}")));
        };
        let header: Header = array
            .text()
            .ok_or_else(|| "not a text".to_owned())
            .and_then(|text| serde_json::from_str(&text).map_err(|e| e.to_string()))
            .map_err(|e| Error::syntax(self.at("header"), e))?;
        if header.format != format {
            return Err(Error::invalid(self.at("header"), format!("says {:?}; expected {format:?}", header.format)));
        }
        if !versions.contains(&header.format_version) {
            let feature = format!("format version {} of {format}", header.format_version);
            return Err(Error::Unsupported { at: self.at("header"), feature });
        }
        Ok(header)
    }

    /// Whether there is an array of this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.zip.index_for_name(&format!("{name}.npy")).is_some()
    }

    /// The bytes of an array; `None` if none has this name. Never holds more than the file can; nor do all arrays together,
    /// which could be the same bytes over and over.
    fn bytes_of(&mut self, name: &str) -> Result<Option<Vec<u8>>> {
        let at = self.at(name);
        let damaged = |message: String| Error::syntax(at.clone(), message);
        let compressed = || Error::Unsupported { at: at.clone(), feature: COMPRESSED.to_owned() };
        let mut member = match self.zip.by_name(&format!("{name}.npy")) {
            Ok(member) => member,
            Err(zip::result::ZipError::FileNotFound) => return Ok(None),
            Err(zip::result::ZipError::UnsupportedArchive(_)) => return Err(compressed()),
            Err(e) => return Err(damaged(e.to_string())),
        };
        let most = match member.compression() {
            CompressionMethod::Stored => self.file_bytes,
            CompressionMethod::Deflated => self.file_bytes.saturating_mul(MOST_DEFLATED),
            _ => return Err(compressed()),
        };
        self.array_bytes = self.array_bytes.saturating_add(member.size());
        if self.array_bytes > most {
            let (size, all, file) = (member.size(), self.array_bytes, self.file_bytes);
            return Err(damaged(format!(
                "claims {size} bytes, and with the arrays before it {all}, in a file of {file}"
            )));
        }
        let mut bytes = Vec::new();
        bytes
            .try_reserve_exact(usize::try_from(member.size()).unwrap_or(usize::MAX))
            .map_err(|e| Error::io(&self.path, "reading", e.into()))?;
        // One more than promised: the checksum is compared at the end.
        let size = member.size();
        (&mut member).take(size.saturating_add(1)).read_to_end(&mut bytes).map_err(|e| damaged(e.to_string()))?;
        if bytes.len() as u64 != size {
            return Err(damaged(format!("{} bytes where {size} are promised", bytes.len())));
        }
        Ok(Some(bytes))
    }

    /// An array; `None` if none has this name.
    fn array(&mut self, name: &str) -> Result<Option<Array>> {
        let at = self.at(name);
        let damaged = |message: String| Error::syntax(at.clone(), message);
        let Some(mut bytes) = self.bytes_of(name)? else { return Ok(None) };
        let Preamble { descr, shape, fortran_order, start } = npy::preamble(&bytes).map_err(&damaged)?;
        if fortran_order && shape.len() > 1 {
            return Err(damaged("is in Fortran order; save it with np.ascontiguousarray".into()));
        }
        let width: Option<usize> = match descr.split_at_checked(2) {
            Some(("<U", length)) => length.parse::<usize>().ok().and_then(|n| n.checked_mul(4)),
            Some((_, width)) => width.parse().ok(),
            None => None,
        };
        let wanted = shape.iter().try_fold(width.unwrap_or(usize::MAX), |product, n| product.checked_mul(*n));
        if width.is_none() || wanted != Some(bytes.len() - start) {
            let message = format!("{} bytes of data do not make an array {shape:?} of {descr:?}", bytes.len() - start);
            return Err(damaged(message));
        }
        bytes.drain(..start);
        Ok(Some(Array { descr, shape, data: bytes }))
    }

    /// The data of an array of one of these types with `columns` values a row (1: a plain list), and its type; empty, and a problem
    /// if it is needed, when it is not there or of another type.
    fn data(
        &mut self,
        name: &str,
        descrs: &[&str],
        columns: usize,
        needed: bool,
        problems: &mut Vec<Problem>,
    ) -> Result<(String, Vec<u8>)> {
        let Some(array) = self.array(name)? else {
            if needed {
                problems.push(Problem::new(self.at(name), "is missing"));
            }
            return Ok(Default::default());
        };
        let is_shaped = match array.shape[..] {
            [_] => columns == 1,
            [_, n] => columns == n && n > 1,
            _ => false,
        };
        if !descrs.contains(&array.descr.as_str()) || !is_shaped {
            let rows = if columns == 1 { "(n,)".to_owned() } else { format!("(n, {columns})") };
            let wanted = descrs.iter().map(|descr| format!("{descr:?}")).collect::<Vec<_>>().join(" or ");
            let message = format!("is {:?} of {:?}, expected {wanted} of shape {rows}", array.descr, array.shape);
            problems.push(Problem::new(self.at(name), message));
            return Ok(Default::default());
        }
        Ok((array.descr, array.data))
    }

    pub(super) fn f64s(
        &mut self,
        name: &str,
        columns: usize,
        needed: bool,
        problems: &mut Vec<Problem>,
    ) -> Result<Vec<f64>> {
        let data = self.data(name, &["<f8"], columns, needed, problems)?.1;
        Ok(data.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect())
    }

    /// Of a plain list in single precision.
    pub(super) fn f32s(&mut self, name: &str, problems: &mut Vec<Problem>) -> Result<Vec<f64>> {
        let data = self.data(name, &["<f4"], 1, true, problems)?.1;
        Ok(data.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect())
    }

    pub(super) fn u32s(&mut self, name: &str, problems: &mut Vec<Problem>) -> Result<Vec<u32>> {
        let data = self.data(name, &["<u4"], 1, true, problems)?.1;
        Ok(data.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect())
    }

    /// Ends of lists, of 32 or 64 bits. An impossible end becomes the largest number, which is then refused in the table, too.
    pub(super) fn ends(&mut self, name: &str, problems: &mut Vec<Problem>) -> Result<Vec<usize>> {
        let (descr, data) = self.data(name, &["<u4", "<u8"], 1, true, problems)?;
        let end = |end: u64| usize::try_from(end).unwrap_or(usize::MAX);
        Ok(match descr.as_str() {
            "<u8" => data.as_chunks::<8>().0.iter().map(|b| end(u64::from_le_bytes(*b))).collect(),
            _ => data.as_chunks::<4>().0.iter().map(|b| end(u32::from_le_bytes(*b).into())).collect(),
        })
    }

    pub(super) fn bytes(&mut self, name: &str, problems: &mut Vec<Problem>) -> Result<Vec<u8>> {
        Ok(self.data(name, &["|u1"], 1, true, problems)?.1)
    }

    pub(super) fn direction(
        &mut self,
        name: &str,
        needed: bool,
        problems: &mut Vec<Problem>,
    ) -> Result<Option<Direction>> {
        let values = self.f64s(name, 1, needed, problems)?;
        if values.is_empty() {
            return Ok(None);
        }
        let direction = <[f64; 3]>::try_from(values).ok().and_then(|v| Direction::from_unit(DVec3::from_array(v)));
        if direction.is_none() {
            problems.push(Problem::new(self.at(name), "is not a unit vector of three components"));
        }
        Ok(direction)
    }
}

/// Where an array is in an `.npz` file.
pub(in crate::formats) struct Member {
    /// Its name, without `.npy`.
    pub(in crate::formats) name: String,
    /// Where its `.npy` file begins, bytes.
    pub(in crate::formats) start: u64,
    /// Size of that, bytes.
    pub(in crate::formats) bytes: u64,
    /// Whether its bytes are not in the file as they are, but compressed: `start` is then 0.
    pub(in crate::formats) is_packed: bool,
}

/// All arrays of a file.
///
/// # Errors
/// As [`list`], and [`Error::Unsupported`] for compressed ones.
pub(in crate::formats) fn members(path: &Path) -> Result<Vec<Member>> {
    let mut file = Npz::open(path)?;
    let mut members = Vec::new();
    for i in 0..file.zip.len() {
        let damaged = |message: String| Error::syntax(Location::file(path), message);
        let member = file.zip.by_index_raw(i).map_err(|e| damaged(e.to_string()))?;
        let Some(name) = member.name().ok().and_then(|n| Some(n.strip_suffix(".npy")?.to_owned())) else { continue };
        let at = Location::file(path).with_item(&name);
        match member.compression() {
            CompressionMethod::Stored => {}
            CompressionMethod::Deflated => {
                let bytes = member.size();
                members.push(Member { name, start: 0, bytes, is_packed: true });
                continue;
            }
            _ => return Err(Error::Unsupported { at, feature: COMPRESSED.to_owned() }),
        }
        let (start, bytes) = (member.data_start(), member.size());
        let end = start.and_then(|start| start.checked_add(bytes));
        let (Some(start), Some(_)) = (start, end.filter(|end| *end <= file.file_bytes)) else {
            return Err(Error::syntax(at, format!("claims {bytes} bytes in a file of {}", file.file_bytes)));
        };
        members.push(Member { name, start, bytes, is_packed: false });
    }
    Ok(members)
}

/// The `.npy` file of a compressed array, whole; of others, its first bytes, at most `most`.
///
/// # Errors
/// [`Error::Io`]; [`Error::Syntax`] for a damaged one.
pub(in crate::formats) fn beginning(path: &Path, member: &Member, most: u64) -> Result<Vec<u8>> {
    if member.is_packed {
        return Ok(Npz::open(path)?.bytes_of(&member.name)?.unwrap_or_default());
    }
    let mut bytes = Vec::new();
    let mut read = || {
        let mut file = input::open(path)?;
        file.seek(SeekFrom::Start(member.start))?;
        file.take(member.bytes.min(most)).read_to_end(&mut bytes)
    };
    read().map_err(|e| Error::io(path, "reading", e))?;
    Ok(bytes)
}

/// The text of an array that is one.
///
/// # Errors
/// As [`read_table`](super::read_table).
pub(in crate::formats) fn text(path: &Path, member: &Member) -> Result<Option<String>> {
    Ok(Npz::open(path)?.array(&member.name)?.and_then(|array| array.text()))
}
