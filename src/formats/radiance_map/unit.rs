//! Units as files spell them: `W m-2 sr-1 um-1`, `W.m^-2.sr^-1.nm^-1`, `uW/(cm^2 sr nm)`, `%`, `K`.

/// What units may be, for people.
pub(super) const KNOWN: &str = "units are W, m, sr and K with prefixes, a stroke or negative exponents: \"W m-2 sr-1 um-1\", \"W/m2/sr/um\", \
                                \"W/(m^2 sr nm)\", \"uW cm-2 sr-1 nm-1\"; \"mW/(m2 sr cm-1)\" per wavenumber; \"W m-2 sr-1\" in a band; \"1\", \"%\", \
                                \"K\"; a number stands before all of it, e.g. \"0.1 W/m2/sr/um\"";

/// Powers of W, m, sr and K, times a number and a power of ten.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::formats) struct Unit {
    powers: [i32; 4],
    number: f64,
    tens: i32,
}

const NAMES: [(&str, usize); 12] = [
    ("watts", 0),
    ("watt", 0),
    ("W", 0),
    ("w", 0),
    ("meters", 1),
    ("meter", 1),
    ("metres", 1),
    ("metre", 1),
    ("m", 1),
    ("steradian", 2),
    ("sr", 2),
    ("K", 3),
];
const PREFIXES: [(&str, i32); 17] = [
    ("", 0),
    ("milli", -3),
    ("micro", -6),
    ("nano", -9),
    ("centi", -2),
    ("kilo", 3),
    ("n", -9),
    ("u", -6),
    ("\u{b5}", -6),
    ("\u{3bc}", -6),
    ("\u{fffd}", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("k", 3),
    ("M", 6),
    ("G", 9),
];

/// A longer text is not a unit, bytes.
const LONGEST: usize = 255;

impl Unit {
    /// A pure number.
    pub(in crate::formats) const ONE: Unit = Unit { powers: [0; 4], number: 1.0, tens: 0 };

    /// What a text says; `None` if it is not understood.
    pub(in crate::formats) fn of(text: &str) -> Option<Self> {
        let text = text.trim();
        if text.len() > LONGEST {
            return None;
        }
        let whole = Parser { rest: text }.whole();
        // As in `Radiance (W/m^2/sr/um)` or `Radiance [W/m^2/sr/um]`.
        let inner = || {
            let begin = text.find(['(', '['])?;
            let end = text.rfind([')', ']']).filter(|end| *end > begin)?;
            let words = text[..begin].chars().all(|c| c.is_alphabetic() || c == ' ' || c == '_');
            words.then(|| Parser { rest: &text[begin + 1..end] }.whole())?
        };
        whole.or_else(inner)
    }

    /// Times a power of another; `None` for powers that no unit has.
    fn multiply(&mut self, other: &Unit, exponent: i32) -> Option<()> {
        self.number *= other.number.powi(exponent);
        let ours = self.powers.iter_mut().chain([&mut self.tens]);
        for (ours, power) in ours.zip(other.powers.into_iter().chain([other.tens])) {
            *ours = ours.checked_add(power.checked_mul(exponent)?)?;
        }
        (self.number > 0.0 && self.number.is_finite() && self.tens.abs() < 1000).then_some(())
    }

    /// This over another of the same dimension.
    pub(in crate::formats) fn over(&self, other: &Unit) -> Option<f64> {
        let tens = self.tens - other.tens;
        let ten = 10_f64.powi(tens.abs());
        let ratio = self.number / other.number;
        (self.powers == other.powers).then_some(if tens < 0 { ratio / ten } else { ratio * ten })
    }
}

struct Parser<'a> {
    rest: &'a str,
}

impl Parser<'_> {
    fn whole(mut self) -> Option<Unit> {
        let unit = self.product(false, false)?;
        self.rest.is_empty().then_some(unit)
    }

    /// Up to the end, or to the parenthesis that closes a group; `is_under` says whether a stroke stands before that.
    fn product(&mut self, is_group: bool, is_under: bool) -> Option<Unit> {
        let mut unit = Unit::ONE;
        let mut found = false;
        // What follows a stroke is below it, as in `W/m2 sr um`.
        let mut below = false;
        let mut after_stroke = false;
        loop {
            self.rest = self.rest.trim_start_matches([' ', '*', '.', '\u{b7}', '\u{d7}', '_']);
            if let Some(rest) = self.rest.strip_prefix('/').or_else(|| self.rest.strip_prefix("per ")) {
                (self.rest, below, after_stroke) = (rest, true, true);
                continue;
            }
            if let (true, Some(rest)) = (is_group, self.rest.strip_prefix(')')) {
                self.rest = rest;
                return found.then_some(unit);
            }
            if self.rest.is_empty() {
                return (found && !is_group).then_some(unit);
            }
            found = true;
            let sign = if below { -1 } else { 1 };
            let is_first = std::mem::take(&mut after_stroke);
            if let Some(rest) = self.rest.strip_prefix('(') {
                self.rest = rest;
                let group = self.product(true, is_under != below)?;
                unit.multiply(&group, sign * self.exponent()?)?;
                continue;
            }
            if let Some(rest) = self.rest.strip_prefix('%') {
                (self.rest, unit.tens) = (rest, unit.tens - 2);
                continue;
            }
            if self.rest.starts_with(|c: char| c.is_ascii_digit()) {
                // `W/m2/sr/um*10`: ten times, or a tenth?
                if below && !is_first {
                    return None;
                }
                self.number(&mut unit, below)?;
                continue;
            }
            let end = self.rest.find(|c: char| !c.is_alphabetic() && c != '\u{fffd}').unwrap_or(self.rest.len());
            let (word, rest) = self.rest.split_at(end);
            self.rest = rest;
            let (axis, tens) = match word.to_lowercase().as_str() {
                "percent" => {
                    unit.tens -= 2;
                    continue;
                }
                "dimensionless" | "unitless" => continue,
                "micron" | "microns" => (1, -6),
                "angstrom" | "angstroms" => (1, -10),
                "kelvin" | "kelvins" => (3, 0),
                "ster" | "steradians" | "str" => (2, 0),
                _ => named(word)?,
            };
            let exponent = self.exponent()?;
            // Below a stroke, cm-1 is a wavenumber; for other units it is unclear whether that is meant, or the minus is doubled.
            if is_under != below && exponent < 0 && (word, exponent) != ("cm", -1) {
                return None;
            }
            unit.powers[axis] += sign * exponent;
            unit.tens += tens * sign * exponent;
        }
    }

    /// A number, which may be a power of ten.
    fn number(&mut self, unit: &mut Unit, below: bool) -> Option<()> {
        let sign = if below { -1 } else { 1 };
        let end = self.rest.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(self.rest.len());
        let (digits, rest) = self.rest.split_at(end);
        self.rest = rest;
        let number: f64 = digits.trim_end_matches('.').parse().ok()?;
        if number == 10.0 && (rest.starts_with('^') || rest.starts_with("**") || rest.starts_with(['-', '+'])) {
            unit.tens += sign * self.exponent()?;
            return Some(());
        }
        if let Some(rest) = rest.strip_prefix(['e', 'E'])
            && rest.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '+')
        {
            self.rest = rest;
            unit.tens += sign * self.exponent()?;
        }
        if !(number > 0.0 && number.is_finite()) {
            return None;
        }
        unit.number = if below { unit.number / number } else { unit.number * number };
        Some(())
    }

    /// `2`, `-1`, `^-1`, `**-1`, `^{-1}`; 1 if there is none.
    fn exponent(&mut self) -> Option<i32> {
        let before = self.rest;
        let marked = self.rest.trim_start_matches(['^', '*', '{', '(']);
        let is_marked = self.rest.starts_with('^') || self.rest.starts_with("**");
        let text = if is_marked { marked } else { self.rest };
        if let Some(rest) = text.strip_prefix('\u{207b}') {
            let mut digits = rest.chars();
            let first = digits.next();
            let power = ['\u{2070}', '\u{b9}', '\u{b2}', '\u{b3}'].into_iter().zip(0..);
            let (_, power) = power.into_iter().find(|(digit, _)| Some(*digit) == first)?;
            self.rest = digits.as_str();
            return Some(-power);
        }
        if let Some(rest) = text.strip_prefix('\u{b2}') {
            self.rest = rest;
            return Some(2);
        }
        let signed = text.strip_prefix(['-', '+']).unwrap_or(text);
        let digits = signed.find(|c: char| !c.is_ascii_digit()).unwrap_or(signed.len());
        if digits == 0 {
            return (!is_marked && signed.len() == text.len()).then_some(1);
        }
        let end = text.len() - signed.len() + digits;
        let exponent: i32 = text[..end].parse().ok().filter(|n: &i32| n.abs() <= 30)?;
        self.rest = text[end..].trim_start_matches('}');
        if is_marked && self.rest.starts_with(')') && marked.len() < before.trim_start_matches(['^', '*', '{']).len() {
            self.rest = &self.rest[1..];
        }
        Some(exponent)
    }
}

/// The axis of a unit's name, and the power of ten of its prefix.
fn named(word: &str) -> Option<(usize, i32)> {
    let named = |word: &str| {
        NAMES.iter().find_map(|(name, axis)| {
            let prefix = word.strip_suffix(name)?;
            PREFIXES.iter().find(|(text, _)| *text == prefix).map(|(_, tens)| (*axis, *tens))
        })
    };
    // A word in capitals is a word still; of signs, M is not m.
    named(word).or_else(|| named(&word.to_lowercase()).filter(|_| word.len() > 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_understood_as_files_spell_them() {
        let per_um = Unit::of("W m-2 sr-1 um-1").unwrap();
        for (text, times) in [
            ("W.m^-2.sr^-1.um^-1", 1.0),
            ("W.m^-2.sr^-1.nm^-1", 1e3),
            ("W/m2/sr/um", 1.0),
            ("W/(m^2 sr um)", 1.0),
            ("W/(m^2*sr*\u{b5}m)", 1.0),
            ("W/m^2 sr \u{3bc}m", 1.0),
            ("mW m-2 sr-1 nm-1", 1.0),
            ("uW/(cm^2 sr nm)", 10.0),
            ("\u{b5}W cm-2 sr-1 nm-1", 10.0),
            ("Radiance (W/m^2/sr/um)", 1.0),
            ("Watts/(meter^2 steradian micron)", 1.0),
            ("W m^{-2} sr^{-1} um^{-1}", 1.0),
            ("W m**-2 sr**-1 um**-1", 1.0),
            ("W m\u{207b}\u{b2} sr\u{207b}\u{b9} \u{b5}m\u{207b}\u{b9}", 1.0),
            ("10^-6 W cm-2 sr-1 nm-1", 10.0),
            ("1e-6 W cm-2 sr-1 nm-1", 10.0),
            ("W m-3 sr-1", 1e-6),
            ("100 W m-2 sr-1 um-1", 100.0),
            ("W m-2 sr-1 (nm)-1", 1e3),
            ("W m^(-2) sr^(-1) um^(-1)", 1.0),
            ("W m-2 sr-1 um-1 / 10", 0.1),
            ("W/(m2 sr 10 nm)", 100.0),
        ] {
            let unit = Unit::of(text).unwrap_or_else(|| panic!("{text}"));
            assert_eq!(unit.over(&per_um), Some(times), "{text}");
        }
        assert_eq!(Unit::of("%").unwrap().over(&Unit::of("1").unwrap()), Some(0.01));
        assert!(Unit::of("kelvin") == Unit::of("K") && Unit::of("K").is_some());
        assert_eq!(Unit::of("W m-2 sr-1").unwrap().over(&per_um), None);
        for text in [
            "",
            "DN",
            "reflectance",
            "counts",
            "W m^",
            "m-99",
            "W m-2 sr-1 furlong-1",
            "0 W",
            "W/(m2 sr um",
            "W m-2)",
            "((((((((m30)30)30)30)30)30)30)30)30",
        ] {
            assert_eq!(Unit::of(text), None, "{text}");
        }
    }

    #[test]
    fn a_wavenumber_is_no_wavelength_and_what_could_be_either_is_nothing() {
        let per_wavenumber = Unit::of("W m-2 sr-1 (cm-1)-1").unwrap();
        assert_eq!(per_wavenumber.over(&Unit::of("W m-2 sr-1 um-1").unwrap()), None);
        for (text, times) in [
            ("mW/(m2 sr cm-1)", 1e-3),
            ("W/m2/sr/cm-1", 1.0),
            ("W/m^2/sr/cm^-1", 1.0),
            ("uW/(cm2 sr cm-1)", 1e-2),
            ("W cm m-2 sr-1", 1.0),
            ("Radiance [mW/(m^2 sr cm^{-1})]", 1e-3),
        ] {
            assert_eq!(Unit::of(text).and_then(|unit| unit.over(&per_wavenumber)), Some(times), "{text}");
        }
        for text in ["W/m2/sr/um*10", "W/(m2 sr um) 10", "W/m2/sr/um-1", "W/(m2 sr um-1)", "W/m-2/sr-1/um-1"] {
            assert_eq!(Unit::of(text), None, "{text}");
        }
    }
}
