//! Numbers as files store them.

/// How a number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DataType {
    /// 8 bits, unsigned.
    U8,
    /// 8 bits, signed.
    I8,
    /// 16 bits, unsigned.
    U16,
    /// 16 bits, signed.
    I16,
    /// 32 bits, unsigned.
    U32,
    /// 32 bits, signed.
    I32,
    /// 64 bits, unsigned; f64 holds them to 2^53.
    U64,
    /// 64 bits, signed; f64 holds them to 2^53.
    I64,
    /// Single precision.
    #[default]
    F32,
    /// Double precision.
    F64,
}

/// Runs `$body` with `$T` the type of a [`DataType`].
macro_rules! with_type {
    ($data_type:expr, $T:ident => $body:expr) => {
        match $data_type {
            DataType::U8 => with_type!(@ u8, $T => $body),
            DataType::I8 => with_type!(@ i8, $T => $body),
            DataType::U16 => with_type!(@ u16, $T => $body),
            DataType::I16 => with_type!(@ i16, $T => $body),
            DataType::U32 => with_type!(@ u32, $T => $body),
            DataType::I32 => with_type!(@ i32, $T => $body),
            DataType::U64 => with_type!(@ u64, $T => $body),
            DataType::I64 => with_type!(@ i64, $T => $body),
            DataType::F32 => with_type!(@ f32, $T => $body),
            DataType::F64 => with_type!(@ f64, $T => $body),
        }
    };
    (@ $type:ty, $T:ident => $body:expr) => {{
        type $T = $type;
        $body
    }};
}

impl DataType {
    /// All types.
    pub const ALL: [DataType; 10] = [
        DataType::U8,
        DataType::I8,
        DataType::U16,
        DataType::I16,
        DataType::U32,
        DataType::I32,
        DataType::U64,
        DataType::I64,
        DataType::F32,
        DataType::F64,
    ];

    /// Size of a number, bytes.
    pub fn bytes(self) -> usize {
        with_type!(self, T => size_of::<T>())
    }

    /// Its name, as in `u16`.
    pub fn name(self) -> &'static str {
        with_type!(self, T => std::any::type_name::<T>())
    }

    /// Whether it holds no fractions, and no NaN.
    pub fn is_integer(self) -> bool {
        !matches!(self, DataType::F32 | DataType::F64)
    }

    /// The numbers of some bytes. What there are more of than the other has is left as it is.
    #[expect(clippy::unnecessary_cast, reason = "of ten types one is f64")]
    pub(super) fn decode(self, big_endian: bool, bytes: &[u8], values: &mut [f64]) {
        with_type!(self, T => {
            let (numbers, _) = bytes.as_chunks::<{ size_of::<T>() }>();
            if big_endian {
                numbers.iter().zip(values).for_each(|(b, v)| *v = T::from_be_bytes(*b) as f64);
            } else {
                numbers.iter().zip(values).for_each(|(b, v)| *v = T::from_le_bytes(*b) as f64);
            }
        });
    }

    /// The bytes of some numbers, behind those in `bytes`: the nearest that the type holds; NaN is 0 in integers.
    #[expect(clippy::cast_possible_truncation, reason = "`as` takes what is beyond a type to its end")]
    pub(super) fn encode(self, big_endian: bool, values: &[f64], bytes: &mut Vec<u8>) {
        let is_integer = self.is_integer();
        let nearest = |v: &f64| if is_integer { v.round_ties_even() } else { *v };
        with_type!(self, T => {
            let start = bytes.len();
            bytes.resize(start + values.len() * self.bytes(), 0);
            let (numbers, _) = bytes[start..].as_chunks_mut::<{ size_of::<T>() }>();
            if big_endian {
                numbers.iter_mut().zip(values).for_each(|(b, v)| *b = (nearest(v) as T).to_be_bytes());
            } else {
                numbers.iter_mut().zip(values).for_each(|(b, v)| *b = (nearest(v) as T).to_le_bytes());
            }
        });
    }
}

/// The number of single precision nearest to this one; infinity beyond them.
#[expect(clippy::cast_possible_truncation, reason = "single precision is what is asked for")]
pub(super) fn single(number: f64) -> f32 {
    number as f32
}

/// The number at or next to `near` that is read as `wanted`, to the last bit; `near` if there is none.
pub(super) fn exact(near: f64, read: impl Fn(f64) -> f64, wanted: f64) -> f64 {
    let (mut below, mut above) = (near, near);
    for _ in 0..8 {
        if let Some(exact) = [below, above].into_iter().find(|x| read(*x) == wanted) {
            return exact;
        }
        (below, above) = (below.next_down(), above.next_up());
    }
    near
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_their_bytes() {
        // Two's complement and IEEE 754, by hand.
        for (data_type, big_endian, bytes, value) in [
            (DataType::U8, false, &[0xfe][..], 254.0),
            (DataType::I8, false, &[0xfe], -2.0),
            (DataType::U16, true, &[0x12, 0x34], 4660.0),
            (DataType::I16, false, &[0x01, 0x80], -32767.0),
            (DataType::U32, false, &[0, 0, 0, 0x80], 2147483648.0),
            (DataType::I32, true, &[0x80, 0, 0, 1], -2147483647.0),
            (DataType::U64, false, &[0, 0, 0, 0, 0, 0, 0, 0x80], 9223372036854775808.0),
            (DataType::I64, true, &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe], -2.0),
            (DataType::F32, true, &[0x40, 0x20, 0, 0], 2.5),
            (DataType::F64, false, &[0, 0, 0, 0, 0, 0, 0xd0, 0xbf], -0.25),
        ] {
            let mut values = [f64::NAN];
            data_type.decode(big_endian, bytes, &mut values);
            assert_eq!(values, [value], "{data_type:?}");
            let mut again = Vec::new();
            data_type.encode(big_endian, &values, &mut again);
            assert_eq!(again, bytes, "{data_type:?}");
            assert_eq!(data_type.bytes(), bytes.len());
        }
        let mut bytes = Vec::new();
        DataType::U8.encode(false, &[300.0, -1.0, 1.6, f64::NAN], &mut bytes);
        assert_eq!(bytes, [255, 0, 2, 0]);
        assert_eq!(DataType::ALL.map(DataType::name)[2..4], ["u16", "i16"]);
    }
}
