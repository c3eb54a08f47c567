//! Numbers in decimal, multiplied by a power of ten without rounding twice: files count in km, and here all is in m.

/// The number that a text stands for, times ten to a power: rounded once, so that 0.1 km are exactly what 100 m are. `None` if it is not
/// a finite number.
pub(super) fn parse(text: &str, power: i32) -> Option<f64> {
    let (digits, exponent) = match text.split_once(['e', 'E']) {
        Some((digits, exponent)) => (digits, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    // Words such as `inf` hold no digit.
    if !digits.contains(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let exponent = exponent.checked_add(power)?;
    format!("{digits}e{exponent}").parse().ok().filter(|value: &f64| value.is_finite())
}

/// The shortest text that [`parse`] reads as the same number: its decimal digits with the point moved.
pub(super) fn text(value: f64, power: i32) -> String {
    let scientific = format!("{value:e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent = if value == 0.0 { 0 } else { exponent.parse::<i32>().unwrap_or(0) - power };
    let (sign, digits) = digits.strip_prefix('-').map_or(("", digits), |digits| ("-", digits));
    if !(-7..=15).contains(&exponent) {
        return format!("{sign}{digits}e{exponent}");
    }
    let digits: String = digits.chars().filter(|c| *c != '.').collect();
    let zeros = |count: i32| "0".repeat(usize::try_from(count).unwrap_or(0));
    let length = i32::try_from(digits.len()).unwrap_or(i32::MAX);
    let (whole, fraction) = match exponent {
        ..0 => ("0".to_owned(), format!("{}{digits}", zeros(-exponent - 1))),
        _ if exponent + 1 >= length => (format!("{digits}{}", zeros(exponent + 1 - length)), "0".to_owned()),
        _ => {
            let (whole, fraction) = digits.split_at(usize::try_from(exponent + 1).unwrap_or(0));
            (whole.to_owned(), fraction.to_owned())
        }
    };
    format!("{sign}{whole}.{fraction}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_point_is_moved_without_rounding() {
        for (metres, km) in [
            (100.0, "0.1"),
            (-1.5, "-0.0015"),
            (123_456.789, "123.456789"),
            (7e6, "7000.0"),
            (0.0, "0.0"),
            (1e-9, "1e-12"),
            (2.5e22, "2.5e19"),
            (1e18, "1000000000000000.0"),
        ] {
            assert_eq!(text(metres, 3), km);
            assert_eq!(parse(km, 3), Some(metres));
        }
        // 4.35 km are 4350 m, where 4.35 * 1000 in f64 is 4350 less an ulp.
        assert_eq!(parse("4.35", 3), Some(4350.0));
        assert_eq!(parse("+2E-3", 3), Some(2.0));
        for wrong in ["", ".", "inf", "nan", "1e", "e3", "1e999", "1e99999999999", "--1", "1 2", "0x1"] {
            assert_eq!(parse(wrong, 3), None, "{wrong}");
        }
    }

    #[test]
    fn every_number_comes_back() {
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        for _ in 0..20_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let value = f64::from_bits(bits);
            // Beyond these, thousandths or thousandfolds are no longer numbers of full precision.
            if value.is_finite() && (1e-300..1e300).contains(&value.abs()) {
                for power in [0, 3] {
                    assert_eq!(parse(&text(value, power), power).map(f64::to_bits), Some(bits), "{value:e}");
                }
            }
        }
    }
}
