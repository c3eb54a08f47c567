//! Numbers as a text in a page: little-endian, first all first bytes and then all second ones, so that they compress; zlib; base64.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::formats::base64::base64;
use crate::formats::number::single;

/// Up to here whole numbers are exact in single precision.
const WHOLE: f64 = 16_777_216.0;

/// Whether single precision would show another number: of a large index, or of one at or beyond the ends of its range.
pub(super) fn is_double(values: &[f64]) -> bool {
    values.iter().any(|value| {
        let short = f64::from(single(*value));
        value.is_finite()
            && short != *value
            && (short.is_infinite()
                || (value.abs() > WHOLE && value.fract() == 0.0)
                || value.abs() < f64::from(f32::MIN_POSITIVE))
    })
}

/// Values of so many bytes each.
pub(super) fn packed(values: &[f64], size: usize) -> String {
    let bytes: Vec<u8> = match size {
        4 => values.iter().flat_map(|value| single(*value).to_le_bytes()).collect(),
        _ => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
    };
    let sorted: Vec<u8> = (0..size).flat_map(|k| bytes.iter().skip(k).step_by(size).copied()).collect();
    let mut out = ZlibEncoder::new(Vec::new(), Compression::new(4));
    // Into memory.
    let done = out.write_all(&sorted).and_then(|()| out.finish());
    base64(&done.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn double_precision_is_for_numbers_that_single_precision_lacks() {
        // 2^-149 is the least of single precision, 2^24 + 2 an even number beyond which all are.
        for value in [0.0, -0.0, 2_f64.powi(-149), -3.0 * 2_f64.powi(-140), 0.1, 16_777_218.0, f64::NAN, f64::INFINITY]
        {
            assert!(!is_double(&[1.0, value]), "{value}");
        }
        for value in [2_f64.powi(-150), 1.5 * 2_f64.powi(-149), 1e-40, -1e-300, 16_777_217.0, 1e39] {
            assert!(is_double(&[1.0, value]), "{value}");
        }
    }
}
