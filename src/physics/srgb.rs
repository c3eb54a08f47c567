//! sRGB (IEC 61966-2-1:1999): colours as files write them, and the linear light that they stand for.

/// Linear red, green and blue, 0 to 1, of `#rrggbb`; `None` for any other text.
pub fn linear_from_hex(hex: &str) -> Option<[f64; 3]> {
    let digits = hex.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let all = u32::from_str_radix(digits, 16).ok()?;
    Some([all >> 16, all >> 8 & 255, all & 255].map(|byte| linear(f64::from(byte) / 255.0)))
}

/// Linear light of a channel of sRGB, both 0 to 1.
pub fn linear(s: f64) -> f64 {
    if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
}

/// `#rrggbb` of linear RGB: the inverse of [`linear_from_hex`], rounded.
#[expect(clippy::cast_possible_truncation, reason = "0 to 255, rounded")]
pub fn hex_from_linear(rgb: [f64; 3]) -> String {
    let [r, g, b] = rgb.map(|c| {
        let s = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (255.0 * s).round().clamp(0.0, 255.0) as u8
    });
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_has_the_standards_values() {
        assert_eq!(linear_from_hex("#000000"), Some([0.0; 3]));
        assert_eq!(linear_from_hex("#ffffff"), Some([1.0; 3]));
        // Mid grey 188 is 0.5029 (IEC 61966-2-1), 10 is on the straight part: 10 / 255 / 12.92.
        let [r, g, _] = linear_from_hex("#bc0aFF").unwrap();
        assert!((r - 0.502_886).abs() < 1e-6 && (g - 10.0 / 255.0 / 12.92).abs() < 1e-15);
        for bad in ["bc0aff", "#bc0af", "#bc0afg", "#+c0aff", "#\u{e9}\u{e9}\u{e9}"] {
            assert_eq!(linear_from_hex(bad), None, "{bad}");
        }
        for hex in ["#000000", "#b03020", "#0a0b0c", "#ffffff"] {
            assert_eq!(hex_from_linear(linear_from_hex(hex).unwrap()), hex);
        }
    }
}
