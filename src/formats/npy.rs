//! The preamble of NumPy's arrays: of a `.npy` file, and of each array in a `.npz`. Source: NEP 1, "A simple file format for NumPy arrays".
//!
//! Not by the crate `npyz`: it gives numbers one by one from the first on, where bands are read here and there in a file; it does not say
//! where they begin; it builds a parser of Python's literals, with C code and a second, old `zip`, for this one line.

use super::marks;

/// What a `.npy` file says of its numbers.
pub(in crate::formats) struct Preamble {
    /// Type, as in `<f8`.
    pub(in crate::formats) descr: String,
    /// Length of each axis.
    pub(in crate::formats) shape: Vec<usize>,
    /// Whether the first index runs fastest.
    pub(in crate::formats) fortran_order: bool,
    /// Where the numbers begin, bytes.
    pub(in crate::formats) start: usize,
}

/// The preamble of a `.npy` file, of which `bytes` holds at least the beginning.
///
/// # Errors
/// What is wrong with it, as a sentence.
pub(in crate::formats) fn preamble(bytes: &[u8]) -> std::result::Result<Preamble, String> {
    let short = || "is cut short".to_owned();
    if !bytes.starts_with(marks::NUMPY) {
        return Err("is not a NumPy array".into());
    }
    let (length, start) = match bytes.get(6).ok_or_else(short)? {
        1 => (bytes.get(8..10).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]]))), 10),
        _ => (bytes.get(8..12).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize), 12),
    };
    let end = length.and_then(|l| l.checked_add(start)).ok_or_else(short)?;
    let text = bytes.get(start..end).ok_or_else(short)?;
    let text = std::str::from_utf8(text).map_err(|_| "its preamble is not text".to_owned())?;
    let value = |key: &str| text.split_once(&format!("'{key}':")).map(|(_, rest)| rest.trim_start());
    let descr = value("descr").and_then(|v| v.strip_prefix('\'')).and_then(|v| v.split_once('\'')).map(|v| v.0);
    let shape = value("shape").and_then(|v| v.strip_prefix('(')).and_then(|v| v.split_once(')')).map(|v| v.0);
    let shape: Option<Vec<usize>> =
        shape.and_then(|s| s.split(',').map(str::trim).filter(|s| !s.is_empty()).map(|s| s.parse().ok()).collect());
    match (descr, shape, value("fortran_order")) {
        (Some(descr), Some(shape), Some(order)) => {
            Ok(Preamble { descr: descr.to_owned(), shape, fortran_order: order.starts_with("True"), start: end })
        }
        _ => Err(format!("its preamble is not understood: {}", text.trim())),
    }
}

/// The preamble of an array of a type, as in `<f8`, and a shape, as in `(2, 3)`: version 1.0, so long that the numbers begin at a multiple of
/// 64 bytes.
pub(in crate::formats) fn written(descr: &str, shape: &str) -> Vec<u8> {
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    // Magic, version and length take 10 bytes, the end of the line one.
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    // A type and a shape are a few words.
    let length_16 = u16::try_from(length).unwrap_or(u16::MAX);
    [marks::NUMPY, b"\x01\x00", &length_16.to_le_bytes(), format!("{text:<0$}\n", length - 1).as_bytes()].concat()
}
