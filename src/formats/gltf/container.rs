//! Where the bytes of a glTF are: the chunks of a GLB, and buffers in it, in `data:` URIs or in other files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::error::{Error, Location, Result};
use crate::formats::input::{self, InputFile};

use super::accessor::{Buffer, Data};
use super::extensions;

/// Longer files are refused, bytes.
pub(super) const LIMIT: u64 = 8 << 30;

/// The JSON and the binary chunk of a GLB; chunks of other kinds are ignored, as the format requires.
pub(super) fn chunks<'a>(bytes: &'a [u8], path: &Path) -> Result<(&'a [u8], Option<&'a [u8]>)> {
    let wrong = |message: String| Err(Error::syntax(Location::file(path), message));
    let number = |bytes: &[u8], at: usize| {
        let bytes = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?) as usize)
    };
    let (Some(version), Some(length)) = (number(bytes, 4), number(bytes, 8)) else {
        return wrong("a GLB ends within its header".into());
    };
    if version != 2 {
        let feature = format!("version {version} of GLB");
        return Err(Error::Unsupported { at: Location::file(path), feature });
    }
    if length > bytes.len() {
        return wrong(format!("a GLB of {length} bytes by its header, but of {}: is it cut short?", bytes.len()));
    }
    let bytes = &bytes[..length];
    let (mut json, mut binary, mut at) = (None, None, 12);
    while at < length {
        let (Some(size), Some(kind)) = (number(bytes, at), bytes.get(at + 4..at + 8)) else {
            return wrong(format!("a chunk's header is cut short at byte {at}"));
        };
        let Some(chunk) = bytes.get(at + 8..at + 8 + size) else {
            return wrong(format!("a chunk of {size} bytes at byte {at} reaches beyond the file's end"));
        };
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at += 8 + size;
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => wrong("a GLB without a JSON chunk".into()),
    }
}

/// The bytes of all buffers, as long as the file says they are.
pub(super) fn buffers(
    data: &Data<'_>,
    binary: Option<&[u8]>,
    outside: bool,
    inputs: &mut Vec<InputFile>,
) -> Result<Vec<Buffer>> {
    let mut all = Vec::new();
    let mut files: BTreeMap<PathBuf, Rc<Vec<u8>>> = BTreeMap::new();
    // What more files may hold.
    let mut left = LIMIT;
    for (i, buffer) in data.root.buffers.iter().enumerate() {
        let item = format!("buffers[{i}]");
        let bytes = match (&buffer.uri, binary) {
            (None, Some(binary)) if i == 0 => Rc::new(binary.to_owned()),
            (None, _) => {
                return match extensions::compression(&buffer.extensions) {
                    Some(name) => Err(Error::Unsupported { at: data.at(item), feature: extensions::compressed(name) }),
                    None => data.wrong(item, "has no `uri`, and is not the binary chunk of a GLB"),
                };
            }
            (Some(uri), _) => match uri.strip_prefix("data:").map(|rest| rest.split_once(',')) {
                Some(Some((kind, text))) if kind.ends_with(";base64") => match base64(text) {
                    Some(bytes) => Rc::new(bytes),
                    None => return data.wrong(item, "its data are not base64"),
                },
                Some(_) => return data.wrong(item, "its `data:` is not in base64"),
                None => {
                    let name = percent_decoded(uri);
                    let path = input::beside(data.path, &name, outside)
                        .map_err(|message| Error::invalid(data.at(&item), message))?;
                    match files.get(&path) {
                        Some(bytes) => bytes.clone(),
                        None => {
                            let bytes = input::bytes(&path, left).map_err(|e| match e {
                                Error::Io { path, source, .. } => {
                                    let message =
                                        format!("{}, which it names, cannot be read: {source}", path.display());
                                    Error::invalid(data.at(&item), message)
                                }
                                other => other,
                            })?;
                            left -= bytes.len() as u64;
                            inputs.push(InputFile::of(&path, &bytes));
                            files.entry(path).or_insert(Rc::new(bytes)).clone()
                        }
                    }
                }
            },
        };
        if bytes.len() < buffer.byte_length {
            let message = format!("`byteLength` {}, but there are {} bytes", buffer.byte_length, bytes.len());
            return data.wrong(item, message);
        }
        all.push(Buffer { all: bytes, length: buffer.byte_length });
    }
    Ok(all)
}

/// RFC 4648, with or without padding. Ours: the crate of that name would be a dependency for this one call, and has to be told as much to take
/// what files leave off at the end.
#[expect(clippy::cast_possible_truncation, reason = "the low eight of the bits that are held are the next byte")]
fn base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut held) = (0_u32, 0);
    for c in text.trim_end_matches('=').bytes() {
        let six = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(six);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    Some(bytes)
}

/// A path of a URI (RFC 3986, 2.1): `%20` is a blank. Ours: the crate for it would be a dependency for this one call.
#[expect(clippy::cast_possible_truncation, reason = "two hexadecimal digits are a byte")]
fn percent_decoded(uri: &str) -> String {
    let digit = |byte: Option<&u8>| byte.and_then(|byte| char::from(*byte).to_digit(16));
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = digit(after.first()).zip(digit(after.get(1))).filter(|_| first == b'%');
        bytes.push(code.map_or(first, |(high, low)| (16 * high + low) as u8));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
