//! Units of wavelengths, as people spell them.

use crate::units::{ELECTRONVOLT_J, LIGHT_SPEED_M_S, PLANCK_J_S};

/// The unit of a wavelength, or of a wavenumber, frequency or energy in its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum WaveUnit {
    /// A length: this many make 1 um.
    PerUm(f64),
    /// A length: one is this many um.
    Um(f64),
    /// Waves in this many um: cm-1.
    Waves(f64),
    /// A frequency: one is this many Hz.
    Hz(f64),
    /// A photon's energy: one is this many eV.
    Ev(f64),
}

impl WaveUnit {
    pub(super) const MICROMETRES: WaveUnit = WaveUnit::Um(1.0);
    pub(super) const NANOMETRES: WaveUnit = WaveUnit::PerUm(1e3);

    /// The unit that a text names: in the singular or the plural, in American or British spelling, in capitals or not, with either of the
    /// two letters that look like a mu, and with the replacement character for invalid UTF-8.
    pub(super) fn of(text: &str) -> Option<Self> {
        // For hertz, capitals distinguish milli from mega.
        let hertz = [("Hz", 1.0), ("kHz", 1e3), ("MHz", 1e6), ("GHz", 1e9), ("THz", 1e12), ("PHz", 1e15)];
        if let Some((_, hz)) = hertz.iter().find(|(name, _)| *name == text.trim()) {
            return Some(WaveUnit::Hz(*hz));
        }
        // UTF-8 that was taken for Latin-1 has a letter before the sign.
        let text = text.trim().trim_start_matches('\u{c2}');
        let plain = text.to_lowercase().replace("metre", "meter").replace(['\u{3bc}', '\u{fffd}'], "\u{b5}");
        let plain = plain.strip_suffix("meters").map_or(plain.clone(), |stem| format!("{stem}meter"));
        Some(match plain.as_str() {
            "um" | "\u{b5}m" | "micron" | "microns" | "micrometer" | "mum" | "mu" | "\u{b5}" | "mkm" => {
                WaveUnit::Um(1.0)
            }
            "nm" | "nanometer" | "nanos" | "millimicron" | "millimicrons" => WaveUnit::PerUm(1e3),
            "a"
            | "\u{e5}"
            | "\u{212b}"
            | "a\u{30a}"
            | "angstrom"
            | "angstroms"
            | "\u{e5}ngstr\u{f6}m"
            | "\u{e5}ngstr\u{f6}ms"
            | "angstr\u{f6}m" => WaveUnit::PerUm(1e4),
            "pm" | "picometer" => WaveUnit::PerUm(1e6),
            "mm" | "millimeter" => WaveUnit::Um(1e3),
            "cm" | "centimeter" => WaveUnit::Um(1e4),
            "m" | "meter" => WaveUnit::Um(1e6),
            "wavenumber"
            | "wavenumbers"
            | "wave number"
            | "cm-1"
            | "cm^-1"
            | "cm**-1"
            | "1/cm"
            | "cm\u{207b}\u{b9}"
            | "kayser"
            | "inverse centimeter"
            | "reciprocal centimeter"
            | "inverse cm"
            | "/cm" => WaveUnit::Waves(1e4),
            "ev" | "electronvolt" | "electronvolts" | "electron volt" => WaveUnit::Ev(1.0),
            "kev" => WaveUnit::Ev(1e3),
            "hz" | "hertz" => WaveUnit::Hz(1.0),
            "ghz" | "gigahertz" => WaveUnit::Hz(1e9),
            "mhz" | "megahertz" => WaveUnit::Hz(1e6),
            "thz" | "terahertz" => WaveUnit::Hz(1e12),
            _ => return None,
        })
    }

    /// The wavelength that a number in this unit means, um; `None` if it is not a wavelength.
    pub(super) fn um(self, number: f64) -> Option<f64> {
        let um = match self {
            WaveUnit::PerUm(per_um) => number / per_um,
            WaveUnit::Um(um) => number * um,
            WaveUnit::Waves(um) => um / number,
            WaveUnit::Hz(hz) => 1e6 * LIGHT_SPEED_M_S / (number * hz),
            WaveUnit::Ev(ev) => 1e6 * PLANCK_J_S * LIGHT_SPEED_M_S / (number * ev * ELECTRONVOLT_J),
        };
        um.is_finite().then_some(um)
    }

    /// The width in um of an interval `width` wide around `centre`, both in this unit.
    pub(super) fn width_um(self, centre: f64, width: f64) -> Option<f64> {
        match self {
            WaveUnit::PerUm(_) | WaveUnit::Um(_) => self.um(width),
            // From end to end.
            WaveUnit::Waves(_) | WaveUnit::Hz(_) | WaveUnit::Ev(_) if width == 0.0 => Some(0.0),
            WaveUnit::Waves(_) | WaveUnit::Hz(_) | WaveUnit::Ev(_) => {
                let [from, to] = [centre - 0.5 * width, centre + 0.5 * width].map(|end| self.um(end));
                from.zip(to).map(|(from, to)| from - to).filter(|um| *um > 0.0)
            }
        }
    }
}

/// Words of a heading, in lower case; a mu of either alphabet is a u.
pub(super) fn words(heading: &str) -> Vec<String> {
    let plain = heading.to_lowercase().replace(['\u{b5}', '\u{3bc}'], "u");
    plain.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_known_in_every_spelling() {
        let um = |unit: &str, number: f64| WaveUnit::of(unit).unwrap_or_else(|| panic!("{unit}")).um(number).unwrap();
        for unit in [
            "um",
            "\u{b5}m",
            "\u{3bc}m",
            "\u{c2}\u{b5}m",
            "\u{fffd}m",
            "Micrometers",
            "micrometres",
            "MICRONS",
            "Micron",
            " Micrometre ",
        ] {
            assert_eq!(um(unit, 0.5), 0.5, "{unit}");
        }
        for unit in ["nm", "NM", "Nanometers", "nanometre", "Nanometres"] {
            assert_eq!(um(unit, 500.0), 0.5, "{unit}");
        }
        for unit in ["Angstroms", "angstrom", "\u{c5}", "\u{212b}", "\u{c5}ngstr\u{f6}m", "A"] {
            assert_eq!(um(unit, 5000.0), 0.5, "{unit}");
        }
        assert_eq!((um("Meters", 5e-7), um("mm", 5e-4), um("Millimetres", 5e-4)), (0.5, 0.5, 0.5));
        assert_eq!((um("Wavenumber", 1000.0), um("cm-1", 1e4), um("1/cm", 5000.0)), (10.0, 1.0, 2.0));
        assert!(
            (um("GHz", 299.792458) / 1000.0 - 1.0).abs() < 1e-15
                && WaveUnit::of("index").is_none()
                && WaveUnit::of("").is_none()
        );
    }

    #[test]
    fn a_width_in_waves_is_that_from_end_to_end() {
        // 995 to 1005 cm-1: 10.050251256 to 9.950248756 um.
        let width = WaveUnit::Waves(1e4).width_um(1000.0, 10.0).unwrap();
        assert!((width - 0.100_002_500_06).abs() < 1e-10, "{width}");
        assert_eq!(WaveUnit::PerUm(1e3).width_um(500.0, 10.0), Some(0.01));
    }
}
