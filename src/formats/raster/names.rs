//! What the names of bands say: a wavelength, a colour, a number, the layer that they are of.
//!
//! OpenEXR keeps channels in the alphabetical order of their names: B before G before R, `1000nm` before `900nm`. Which band is which
//! only the names tell.

use crate::formats::wave_unit::WaveUnit;

/// What orders bands that belong together, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Order {
    /// All names give wavelengths.
    Wavelength,
    /// Red, green, blue.
    Colour,
    /// X, Y, Z.
    Axis,
    /// Names differ in a number.
    Number,
    /// There is one.
    Single,
}

/// A wavelength, um, and if the name gives a range its width, um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wavelength {
    pub(super) centre_um: f64,
    pub(super) width_um: Option<f64>,
}

/// Wavelengths outside of this are no one's, um: digits that belong to a name were taken for a part of a number.
const PLAUSIBLE_UM: std::ops::RangeInclusive<f64> = 0.01..=1000.0;

/// A longer name is no one's, bytes: OpenEXR has none, and in ENVI it is a text that was taken for one.
const LONGEST: usize = 255;

/// Where a name's layer ends, and what it says behind that: `ViewLayer.Combined.R`, `S0.0950,000000nm`, `L.1000nm`.
pub(super) fn layer(name: &str) -> &str {
    let end = match spectral(name) {
        Some((end, _)) => end,
        None => {
            // The dot of 0.45 divides no names.
            let is_between_digits = |i: usize| {
                let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
                digit(name[..i].chars().next_back()) && digit(name[i + 1..].chars().next())
            };
            name.rmatch_indices('.').find(|(i, _)| !is_between_digits(*i)).map_or(0, |(i, _)| i)
        }
    };
    name[..end].trim_end_matches('.')
}

/// A name without its layer.
pub(super) fn base(name: &str) -> &str {
    name[layer(name).len()..].trim_start_matches('.')
}

/// The wavelength that a name ends with.
pub(super) fn wavelength(name: &str) -> Option<Wavelength> {
    spectral(name).map(|(_, wavelength)| wavelength)
}

/// Where the wavelength that a name ends with begins, and that.
fn spectral(name: &str) -> Option<(usize, Wavelength)> {
    if name.len() > LONGEST {
        return None;
    }
    layout(name).or_else(|| free(name))
}

/// The layout of Fichet, Pacanowski and Wilkie (2021): `S0` (to `S3`) of emissive and `T` of reflective images, a number with a decimal
/// comma, a unit of length or frequency.
fn layout(name: &str) -> Option<(usize, Wavelength)> {
    let begins = |start: usize| start == 0 || name[..start].ends_with('.');
    let (start, text) = ["S0.", "S1.", "S2.", "S3.", "T."].into_iter().find_map(|prefix| {
        let start = name.rfind(prefix).filter(|start| begins(*start))?;
        Some((start + prefix.len(), &name[start + prefix.len()..]))
    })?;
    let unit = text.rfind(|c: char| c.is_ascii_digit())? + 1;
    let number: f64 = text[..unit].replace(',', ".").parse().ok()?;
    let centre_um = WaveUnit::of(&text[unit..])?.um(number).filter(|um| *um > 0.0 && um.is_finite())?;
    Some((start, Wavelength { centre_um, width_um: None }))
}

/// Any name that ends in a number and a unit: `1000nm`, `L.0.95um`, `band 3 (450 nm)`, `360.00-380.00nm`.
fn free(name: &str) -> Option<(usize, Wavelength)> {
    let text = name.trim_end_matches([')', ']', ' ']);
    let (start, number, unit) = last(text)?;
    let um = unit.um(number)?;
    let single = || Some((start, Wavelength { centre_um: um, width_um: None }));
    // Of two wavelengths, as of what fluoresces, neither is that of the band.
    if last(text[..start].trim_end_matches(['.', '_', ' ', ')', ']'])).is_some() {
        return None;
    }
    // From one wavelength to another.
    let Some(before) = text[..start].strip_suffix('-') else { return single() };
    let before = before.trim_end_matches(|c: char| c.is_alphabetic());
    let Some((first, from)) = number_at_end(before, |_| true) else { return single() };
    let is_alone = first == 0 || before[..first].ends_with('.');
    let from_um = unit.um(from).unwrap_or(0.0);
    let (low, high) = (from_um.min(um), from_um.max(um));
    if !is_alone || low <= 0.0 || high - low > 0.5 * high {
        return single();
    }
    Some((first, Wavelength { centre_um: 0.5 * (low + high), width_um: Some(high - low).filter(|w| *w > 0.0) }))
}

/// The number and the unit that a text ends with, if they make a wavelength, and where they begin.
fn last(text: &str) -> Option<(usize, f64, WaveUnit)> {
    let end = text.rfind(|c: char| c.is_ascii_digit())? + 1;
    // "cm-1" ends in a digit.
    let (end, spelt) = match text.to_lowercase().strip_suffix("cm-1") {
        Some(before) => (before.trim_end_matches([' ', '_']).len(), "cm-1"),
        None => (end, text[end..].trim_matches([' ', '_'])),
    };
    // An A may be many things.
    if spelt.eq_ignore_ascii_case("a") || spelt.eq_ignore_ascii_case("m") {
        return None;
    }
    let unit = WaveUnit::of(spelt)?;
    let is_plausible = |number| unit.um(number).is_some_and(|um| PLAUSIBLE_UM.contains(&um));
    let (start, number) = number_at_end(text.get(..end)?, is_plausible)?;
    Some((start, number, unit))
}

/// The number that a text ends with, with a decimal point or comma; of several readings (`S0.950` is 950 of S0, or 0.950 of S) the
/// one that is accepted, if that is clear.
fn number_at_end(text: &str, accepted: impl Fn(f64) -> bool) -> Option<(usize, f64)> {
    let run = text.len() - text.bytes().rev().take_while(|b| b.is_ascii_digit() || matches!(b, b'.' | b',')).count();
    let starts = (run..text.len()).rev().filter(|i| {
        text.as_bytes()[*i].is_ascii_digit() && (*i == run || matches!(text.as_bytes()[*i - 1], b'.' | b','))
    });
    // From farther in front there are two points in it.
    let readings = starts.take(2).filter_map(|i| Some((i, text[i..].replace(',', ".").parse::<f64>().ok()?)));
    let readings: Vec<(usize, f64)> = readings.filter(|(_, number)| accepted(*number)).collect();
    match readings[..] {
        [one] => Some(one),
        [_, whole] => {
            // A number that is glued to a name may be a part of it, unless it begins with 0.
            let is_glued = text[..whole.0].chars().next_back().is_some_and(char::is_alphanumeric);
            (!is_glued || whole.1 < 1.0).then_some(whole)
        }
        _ => None,
    }
}

/// The number that a name is, without a unit: `450`, `L.0.45`.
pub(crate) fn bare_number(name: &str) -> Option<f64> {
    base(name).trim().replace(',', ".").parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite())
}

/// Whether a channel is coverage: `A`, `alpha`.
pub(super) fn is_alpha(name: &str) -> bool {
    ["a", "alpha"].contains(&base(name).to_lowercase().as_str())
}

/// Whether a channel is none of light: depth and numbers of things, as renderers put them beside colours.
pub(super) fn is_auxiliary(name: &str) -> bool {
    ["z", "zback", "depth", "id", "objectid", "materialid", "renderid"].contains(&base(name).to_lowercase().as_str())
}

/// Red, green, blue: 0, 1, 2.
pub(crate) fn colour(name: &str) -> Option<usize> {
    let base = base(name).to_lowercase();
    [["r", "red"], ["g", "green"], ["b", "blue"]].iter().position(|names| names.contains(&base.as_str()))
}

/// What orders these names, and their numbers in that order; `None` if nothing does.
pub(super) fn order(names: &[&str]) -> Option<(Order, Vec<usize>)> {
    let sorted = |keys: Vec<f64>| {
        let mut order: Vec<usize> = (0..keys.len()).collect();
        order.sort_by(|a, b| keys[*a].total_cmp(&keys[*b]));
        order.windows(2).all(|w| keys[w[0]] < keys[w[1]]).then_some(order)
    };
    let by = |order: Order, key: &dyn Fn(&str) -> Option<f64>| {
        let keys: Option<Vec<f64>> = names.iter().map(|name| key(name)).collect();
        Some((order, sorted(keys?)?))
    };
    let axis = |name: &str| ["x", "y", "z"].iter().position(|axis| *axis == base(name).to_lowercase());
    let first = numbered(names.first()?);
    let number = |name: &str| {
        let ((before, number, behind), first) = (numbered(name)?, first.as_ref()?);
        ((before, behind) == (first.0, first.2)).then_some(number)
    };
    by(Order::Wavelength, &|name| wavelength(name).map(|w| w.centre_um))
        .or_else(|| (names.len() == 1).then(|| (Order::Single, vec![0])))
        .or_else(|| by(Order::Colour, &|name| colour(name).map(|i| i as f64)))
        .or_else(|| by(Order::Axis, &|name| axis(name).map(|i| i as f64)))
        .or_else(|| by(Order::Number, &number))
}

/// The last number of a name, and what stands before and behind it.
fn numbered(name: &str) -> Option<(&str, f64, &str)> {
    let end = name.rfind(|c: char| c.is_ascii_digit())? + 1;
    let is_digit = |c: char| c.is_ascii_digit();
    let whole = name[..end].trim_end_matches(is_digit);
    let start = match whole.strip_suffix('.') {
        Some(before) if before.ends_with(is_digit) => before.trim_end_matches(is_digit).len(),
        _ => whole.len(),
    };
    Some((&name[..start], name[start..end].parse().ok()?, &name[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_give_wavelengths_in_every_spelling() {
        for (name, um) in [
            ("S0.0950,000000nm", 0.95),
            ("S0.950nm", 0.95),
            ("S0.950,5nm", 0.9505),
            ("S0.950.5nm", 0.9505),
            ("left.S0.10um", 10.0),
            ("T.5E-7m", 0.5),
            ("S0.299,792458THz", 1.0),
            ("1000nm", 1.0),
            ("1000 nm", 1.0),
            ("1000.5NM", 1.0005),
            ("0.95um", 0.95),
            ("0,95\u{b5}m", 0.95),
            ("10\u{3bc}m", 10.0),
            ("L.1000nm", 1.0),
            ("L.0.95um", 0.95),
            ("band 3 (450.0 Nanometers)", 0.45),
            ("band1_450nm", 0.45),
            ("5000 angstrom", 0.5),
            ("1000 cm-1", 10.0),
            ("layer0.950nm", 0.95),
        ] {
            let found = wavelength(name).unwrap_or_else(|| panic!("{name}")).centre_um;
            assert!((found / um - 1.0).abs() < 1e-14, "{name}: {found}");
        }
        let range = wavelength("360.00-380.00nm").unwrap();
        assert!((range.centre_um - 0.37).abs() < 1e-15 && (range.width_um.unwrap() - 0.02).abs() < 1e-15);
        for name in ["R", "S0.R", "B8A", "band 10", "0.95", "nm", "S0.nm", "S0.-3nm", "T.500nm.600nm", "B1.10um", ""] {
            assert_eq!(wavelength(name), None, "{name}");
        }
        // What says many wavelengths says none, and costs no stack; nor does a number of many points cost its square.
        for name in ["500nm".repeat(100_000), "500nm".repeat(100_001), "1.".repeat(1_000_000) + "nm"] {
            assert_eq!(wavelength(&name), None);
        }
    }

    #[test]
    fn layers_end_at_the_last_dot_that_is_not_decimal() {
        let parts = |name| (layer(name), base(name));
        assert_eq!(parts("ViewLayer.Combined.R"), ("ViewLayer.Combined", "R"));
        assert_eq!(parts("S0.0950,000000nm"), ("S0", "0950,000000nm"));
        assert_eq!(parts("L.0.95um"), ("L", "0.95um"));
        assert_eq!((parts("R"), parts("0.45"), parts(".R")), (("", "R"), ("", "0.45"), ("", "R")));
    }

    #[test]
    fn bands_are_ordered_by_what_their_names_say() {
        let ordered = |names: &[&str]| {
            order(names).map(|(by, order)| (by, order.iter().map(|i| names[*i].to_owned()).collect::<Vec<_>>()))
        };
        let expected = |by, names: &[&str]| Some((by, names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>()));
        assert_eq!(
            ordered(&["1000nm", "1100nm", "900nm"]),
            expected(Order::Wavelength, &["900nm", "1000nm", "1100nm"])
        );
        assert_eq!(ordered(&["B", "G", "R"]), expected(Order::Colour, &["R", "G", "B"]));
        assert_eq!(ordered(&["L.b", "L.g", "L.r"]), expected(Order::Colour, &["L.r", "L.g", "L.b"]));
        assert_eq!(
            ordered(&["band 1", "band 10", "band 2"]),
            expected(Order::Number, &["band 1", "band 2", "band 10"])
        );
        assert_eq!(ordered(&["0.45", "0.5", "10"]), expected(Order::Number, &["0.45", "0.5", "10"]));
        assert_eq!(ordered(&["whatever"]), expected(Order::Single, &["whatever"]));
        for names in [&["swir", "visible"][..], &["1000nm", "1000.0nm"], &["band 1", "ch 2"], &["1", "01"], &["R", "R"]]
        {
            assert_eq!(order(names), None, "{names:?}");
        }
    }
}
