//! Units of length as the files of other programs name them.

/// A unit's length, m, whatever its case and number; none of what is no length.
pub(in crate::formats) fn metres(unit: &str) -> Option<f64> {
    let unit = unit.trim().to_lowercase();
    Some(match unit.trim_end_matches('s').trim_end() {
        "m" | "meter" | "metre" => 1.0,
        "km" | "kilometer" | "kilometre" => 1000.0,
        "dm" | "decimeter" | "decimetre" => 0.1,
        "cm" | "centimeter" | "centimetre" => 0.01,
        "mm" | "millimeter" | "millimetre" => 1e-3,
        "ft" | "foot" | "feet" | "international foot" | "international feet" => 0.3048,
        // 1200 / 3937: NIST SP 811, appendix B.6; "ftUS" less its last letter.
        "us survey foot" | "us survey feet" | "us_survey_foot" | "us-ft" | "ftu" => 1200.0 / 3937.0,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::metres;

    #[test]
    fn units_are_known_in_any_case_and_number() {
        for (names, m) in [
            (&["m", "METERS", " metre "][..], 1.0),
            (&["km", "Kilometers", "KILOMETER"], 1000.0),
            (&["ft", "Feet", "foot"], 0.3048),
            (&["US survey foot", "US Survey Feet", "ftUS"], 0.304_800_609_601_219_2),
        ] {
            assert!(names.iter().all(|name| (metres(name).unwrap() / m - 1.0).abs() < 1e-12), "{names:?}");
        }
        assert!(["", "1", "deg", "s", "furlongs", "mm/s"].iter().all(|name| metres(name).is_none()));
    }
}
