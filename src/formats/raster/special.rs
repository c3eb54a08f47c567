//! Numbers that mean "nothing here": of planetary files there are several, one for each reason.

use crate::formats::number::{DataType, single};

/// What means nothing here, among numbers as they are stored.
#[derive(Debug, Clone, Default)]
pub(super) struct Special {
    /// These numbers.
    pub(super) numbers: Vec<f64>,
    /// What is outside of this.
    pub(super) valid: Option<[f64; 2]>,
}

impl Special {
    /// Makes NaN of what means nothing here.
    pub(super) fn remove(&self, values: &mut [f64]) {
        let [low, high] = self.valid.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        if self.numbers.is_empty() && self.valid.is_none() {
            return;
        }
        let is_special = |v: f64| v < low || v > high || self.numbers.contains(&v);
        values.iter_mut().filter(|v| is_special(**v)).for_each(|v| *v = f64::NAN);
    }

    /// Adds a number as a label writes it: in decimals, or as the bits in which it is stored, `16#FF7FFFFB#` or `0xFF7FFFFB`.
    pub(super) fn add(&mut self, text: &str, data_type: DataType) -> Option<f64> {
        let number = stored(text, data_type)?;
        self.numbers.push(number);
        Some(number)
    }
}

/// A number as a label writes it, as it is stored.
pub(super) fn stored(text: &str, data_type: DataType) -> Option<f64> {
    let text = text.trim();
    let bits = text.strip_prefix("16#").map(|bits| bits.trim_end_matches('#'));
    let bits = bits.or_else(|| text.strip_prefix("0x")).or_else(|| text.strip_prefix("0X"));
    match bits {
        Some(bits) => {
            let bits = u64::from_str_radix(bits, 16).ok()?;
            let size = data_type.bytes();
            let mut value = [0.0];
            data_type.decode(true, &bits.to_be_bytes()[8 - size..], &mut value);
            Some(value[0])
        }
        None => {
            let number: f64 = text.parse().ok()?;
            Some(if data_type == DataType::F32 { f64::from(single(number)) } else { number })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_in_decimals_or_as_bits() {
        // ISIS's Null, the largest finite number but for its last bits: 0xff7ffffb.
        let null = f64::from(f32::from_bits(0xff7f_fffb));
        assert_eq!(stored("16#FF7FFFFB#", DataType::F32), Some(null));
        assert_eq!(stored("0xff7ffffb", DataType::F32), Some(null));
        assert_eq!(stored("-3.40282265508890445e+38", DataType::F32), Some(null));
        assert_eq!(stored("-32768", DataType::I16), Some(-32768.0));
        assert_eq!(stored("16#8000#", DataType::I16), Some(-32768.0));
        assert_eq!(stored("-0.1", DataType::F32), Some(f64::from(-0.1_f32)));
        assert_eq!((stored("N/A", DataType::F32), stored("16#XY#", DataType::F32)), (None, None));
        let mut values = [1.0, 2.0, 3.0, 9.0, f64::NAN];
        Special { numbers: vec![2.0], valid: Some([1.0, 8.0]) }.remove(&mut values);
        assert!(values[0] == 1.0 && values[2] == 3.0 && [1, 3, 4].iter().all(|i| values[*i].is_nan()));
    }
}
