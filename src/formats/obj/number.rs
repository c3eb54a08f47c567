//! Numbers in decimal digits, as fast as a mesh of 80 MB needs them.

/// A whole number of up to 18 digits, and the bytes after it.
pub(super) fn integer(bytes: &[u8]) -> Option<(i64, &[u8])> {
    let (negative, digits) = match bytes {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, bytes),
    };
    let (value, n) = digits_of(digits);
    (n > 0).then(|| (if negative { -value } else { value }, &digits[n..]))
}

/// Powers of ten that are exact in f64, as far as 15 digits need them.
const TEN: [f64; 16] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The same as integers.
const TEN_I64: [i64; 16] = {
    let mut ten = [1; 16];
    let mut i = 1;
    while i < 16 {
        ten[i] = ten[i - 1] * 10;
        i += 1;
    }
    ten
};

/// The number that up to 18 decimal digits at the start make, and how many they are.
#[inline(always)]
pub(super) fn digits_of(bytes: &[u8]) -> (i64, usize) {
    // Eight bytes at once: a loop over digits mispredicts its end at nearly every number, and half a file is numbers.
    if let Some(eight) = bytes.first_chunk::<8>() {
        let digits = u64::from_le_bytes(*eight) ^ 0x3030_3030_3030_3030;
        // The lowest high bit marks the first byte that is not a digit; what a carry does beyond it does not matter.
        let others = (digits.wrapping_add(0x7676_7676_7676_7676) | digits) & 0x8080_8080_8080_8080;
        let n = others.trailing_zeros() as usize / 8;
        if n == 0 {
            return (0, 0);
        }
        if n < 8 {
            let pairs = digits << (64 - 8 * n);
            let pairs = (pairs.wrapping_mul(10)).wrapping_add(pairs >> 8);
            let high = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(0x000f_4240_0000_0064);
            let low = ((pairs >> 16) & 0x0000_00ff_0000_00ff).wrapping_mul(0x0000_2710_0000_0001);
            return ((high.wrapping_add(low) >> 32) as i64, n);
        }
    }
    let (mut value, mut n) = (0, 0);
    for byte in bytes.iter().take(18) {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        value = value * 10 + i64::from(digit);
        n += 1;
    }
    (value, n)
}

/// The f64 nearest to the decimal number at the start, and its length in bytes.
pub(super) fn decimal(bytes: &[u8]) -> Option<(f64, usize)> {
    let sign = usize::from(bytes.first() == Some(&b'-'));
    let (whole, n) = digits_of(&bytes[sign..]);
    let mut end = sign + n;
    let (mut mantissa, mut decimals) = (whole, 0);
    if n > 0 && bytes.get(end) == Some(&b'.') {
        let fraction = &bytes[end + 1..];
        (mantissa, decimals) = match digits_of(fraction) {
            (part, k) if n + k <= 15 => (whole * TEN_I64[k] + part, k),
            (_, k) => (0, k),
        };
        end += 1 + decimals;
    }
    // Up to 15 digits and a power of ten up to 1e15 are exact in f64, so that their quotient is rounded once (Clinger 1990).
    if n > 0 && n + decimals <= 15 && bytes.get(end).is_none_or(|b| b.is_ascii_whitespace()) {
        let value = mantissa as f64 / TEN[decimals];
        return Some((if sign == 1 { -value } else { value }, end));
    }
    fast_float2::parse_partial(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_the_nearest_f64() {
        let mut seen = 0;
        for text in [
            "0",
            "-0",
            "1",
            "-1.5",
            "0.1",
            "-0.3",
            "123456.7891",
            "999999999999999",
            "9999999999999.99",
            "9007199254740993",
            "123456789012345.6",
            "0.30000000000000004",
            "1e-7",
            "-1.25E+3",
            "1.",
            ".5",
            "2.2250738585072014e-308",
            "0.000000000000001",
            "0.0000000000000001",
            "99999999999999999999",
            "1234567890123456789.5",
        ] {
            let expected: f64 = text.parse().unwrap();
            let (value, n) = decimal(text.as_bytes()).unwrap();
            assert_eq!((value.to_bits(), n), (expected.to_bits(), text.len()), "{text}");
            assert_eq!(decimal(format!("{text} 7").as_bytes()).unwrap().0.to_bits(), expected.to_bits());
            seen += 1;
        }
        assert_eq!(seen, 21);
        assert_eq!(decimal(b""), None);
        assert_eq!(decimal(b"-"), None);
        assert_eq!(decimal(b"x1"), None);
    }
}
