//! The units in which names of keys end: a slip in one is not a slip of the keyboard, and what helps is the number in the other unit.

use std::f64::consts::PI;

use serde_json::Value;

use super::spelling::nearest;
use crate::error::number;
use crate::units::AU_M;

/// Endings, what they measure, and how much of it 1 is. Longer ones stand before those that they end in.
const UNITS: [(&str, &str, f64); 25] = [
    ("kw_m2", "flux", 1e3),
    ("mw_m2", "flux", 1e-3),
    ("w_m2", "flux", 1.0),
    ("nm", "length", 1e-9),
    ("um", "length", 1e-6),
    ("micron", "length", 1e-6),
    ("microns", "length", 1e-6),
    ("angstrom", "length", 1e-10),
    ("mm", "length", 1e-3),
    ("cm", "length", 1e-2),
    ("m", "length", 1.0),
    ("km", "length", 1e3),
    ("au", "length", AU_M),
    ("rad", "angle", 1.0),
    ("mrad", "angle", 1e-3),
    ("urad", "angle", 1e-6),
    ("deg", "angle", PI / 180.0),
    ("arcmin", "angle", PI / 10_800.0),
    ("arcsec", "angle", PI / 648_000.0),
    ("ms", "time", 1e-3),
    ("s", "time", 1.0),
    ("h", "time", 3600.0),
    ("percent", "share", 0.01),
    ("px", "pixels", 1.0),
    ("texels", "texels", 1.0),
];
/// With more numbers than this only the factor is reported.
const SHOWN: usize = 8;

#[derive(Clone, Copy)]
struct Unit {
    name: &'static str,
    measures: &'static str,
    one: f64,
}

/// A key without its unit, and that.
fn parted(key: &str) -> (&str, Option<Unit>) {
    let found = UNITS.iter().find_map(|&(name, measures, one)| {
        Some((key.strip_suffix(name)?.strip_suffix('_')?, Unit { name, measures, one }))
    });
    found.map_or((key, None), |(stem, unit)| (stem, Some(unit)))
}

/// What may have been meant by a key that is not known, with its value: in the unit of the key that is.
pub(super) fn meant(key: &str, value: &Value, known: &[&str]) -> Option<String> {
    let (stem, unit) = parted(key);
    let fits = |name: &&str| {
        let (known_stem, known_unit) = parted(name);
        let is_share = unit.is_some_and(|u| u.measures == "share");
        known_stem == stem
            && match (unit, known_unit) {
                (Some(a), Some(b)) => a.measures == b.measures,
                (Some(_), None) => is_share,
                (None, unit) => unit.is_some(),
            }
    };
    let name = known.iter().copied().find(fits).or_else(|| nearest(key, known))?;
    let (wanted_stem, wanted) = parted(name);
    let factor = match (unit, wanted) {
        (Some(a), Some(b)) if a.measures == b.measures => a.one / b.one,
        // Metres given in seconds are a mistake.
        (Some(_), Some(_)) => return None,
        (Some(a), None) if a.measures == "share" => a.one,
        (None, Some(b)) if stem == wanted_stem => return Some(format!("did you mean `{name}`? It is in {}", b.name)),
        _ => 1.0,
    };
    if factor == 1.0 {
        return Some(format!("did you mean `{name}`?"));
    }
    let unit = wanted.map_or_else(|| "a fraction".to_owned(), |wanted| format!("in {}", wanted.name));
    Some(match shown(value, factor) {
        Some(converted) => format!("did you mean `{name}`? It is {unit}: `{name} = {converted}`"),
        None => format!("did you mean `{name}`? It is {unit}: numbers there are {} times these", rounded(factor)),
    })
}

/// A number, or a list of some, times a factor, as TOML writes it.
fn shown(value: &Value, factor: f64) -> Option<String> {
    match value {
        Value::Number(x) => Some(rounded(x.as_f64()? * factor)),
        Value::Array(list) if list.len() <= SHOWN => {
            let list = list.iter().map(|x| shown(x, factor)).collect::<Option<Vec<_>>>()?;
            Some(format!("[{}]", list.join(", ")))
        }
        _ => None,
    }
}

/// Without the last digits, which factors that are not powers of two disturb.
fn rounded(x: f64) -> String {
    number(format!("{x:.12e}").parse().unwrap_or(x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn another_unit_is_told_with_the_number_in_the_right_one() {
        let lens = ["fov_deg", "ifov_mrad", "focal_mm", "samples"];
        let told = |key: &str, value: Value, known: &[&str]| meant(key, &value, known).unwrap_or_default();
        for (key, value, known, expected) in [
            ("ifov_rad", json!(0.004), &lens[..], "did you mean `ifov_mrad`? It is in mrad: `ifov_mrad = 4`"),
            ("ifov_urad", json!(500), &lens, "`ifov_mrad = 0.5`"),
            // Half a turn is 180 deg; the key without its unit is the same, though another is nearer by letters.
            ("fov_rad", json!(std::f64::consts::FRAC_PI_2), &lens, "`fov_deg = 90`"),
            ("fov_arcmin", json!(90), &lens, "`fov_deg = 1.5`"),
            ("focal_m", json!(0.05), &lens, "`focal_mm = 50`"),
            ("position_km", json!([1.5, 0, -2]), &["position_m"], "`position_m = [1500, 0, -2000]`"),
            ("centres_nm", json!([950.0, 1000.0]), &["centres_um"], "`centres_um = [0.95, 1]`"),
            ("distance_km", json!(149_597_870.7), &["distance_au"], "`distance_au = 1`"),
            ("thermal_exitance_kw_m2", json!(0.11), &["thermal_exitance_w_m2"], "`thermal_exitance_w_m2 = 110`"),
            ("reflectance_percent", json!(7), &["reflectance"], "It is a fraction: `reflectance = 0.07`"),
            ("fwhm_nm", json!(vec![10; 20]), &["fwhm_um"], "numbers there are 0.001 times these"),
            ("distance", json!(1.5), &["distance_au"], "did you mean `distance_au`? It is in au"),
            ("ifov_mrda", json!(1), &lens, "did you mean `ifov_mrad`?"),
            ("position_s", json!(1), &["position_m"], ""),
        ] {
            let told = told(key, value, known);
            assert!(told.ends_with(expected) && told.is_empty() == expected.is_empty(), "{key}: {told}");
        }
    }
}
