//! What the headings of a table of spectra say: a quantity, and the unit of its numbers.
//!
//! Units stand in brackets, or behind the name: `Reflectance (percent)`, `irradiance_w_m2_nm`, `wavenumber_cm-1`. What is stated and not
//! understood is never ignored: the numbers would be taken for others.

use super::radiance_map::unit::Unit as Dimension;
use super::wave_unit::{self, WaveUnit};

/// Quantities, and what people call them.
const QUANTITIES: [(&str, &[&str]); 10] = [
    (REFLECTANCE, &["reflectance", "reflectances", "reflectivity", "refl"]),
    (EMISSIVITY, &["emissivity", "emissivities", "emittance"]),
    (ALBEDO, &["albedo"]),
    (THROUGHPUT, &["throughput"]),
    (IRRADIANCE, &["irradiance"]),
    ("radiance", &["radiance"]),
    ("transmittance", &["transmittance", "transmission", "transmissivity"]),
    ("absorbance", &["absorbance"]),
    ("absorptance", &["absorptance", "absorption", "absorptivity"]),
    (LOG, &[]),
];
pub(super) const REFLECTANCE: &str = "reflectance";
pub(super) const EMISSIVITY: &str = "emissivity";
pub(super) const ALBEDO: &str = "albedo";
pub(super) const THROUGHPUT: &str = "throughput";
pub(super) const IRRADIANCE: &str = "irradiance";
pub(super) const LOG: &str = "log(1/R)";
/// Words next to a quantity that do not change it.
const AROUND: [&str; 13] = [
    "spectral",
    "solar",
    "sun",
    "sunlight",
    "percent",
    "percentage",
    "pct",
    "fraction",
    "fractional",
    "unitless",
    "dimensionless",
    "y",
    "per",
];
/// What a fraction's unit may be.
const ONE: [&str; 14] = [
    "",
    "-",
    "1",
    "fraction",
    "fractional",
    "unitless",
    "dimensionless",
    "ratio",
    "0-1",
    "0 to 1",
    "0..1",
    "none",
    "decimal",
    "absolute",
];
const HUNDRED: [&str; 9] = ["%", "percent", "percentage", "percents", "pct", "per cent", "0-100", "0 to 100", "0..100"];
/// Units of irradiance, for messages.
const IRRADIANCES: &str = "W, mW, uW or kW, per m2 or cm2, per nm, um or angstrom, e.g. `mW m-2 nm-1`";
/// Units of wavelength, for messages.
pub(super) const WAVE_UNITS: &str = "um, nm, angstrom, pm, mm, cm, m, cm-1, Hz, GHz, THz, eV";

/// What a heading says that numbers are in.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Unit {
    /// Nothing, or a fraction.
    Plain,
    /// Percent.
    Percent,
    /// So many W m-2 um-1, and how that is spelt.
    Irradiance(f64, String),
    /// Words that are perhaps no unit.
    Doubtful(String),
    /// An unknown unit, or a missing one: why, and what to do.
    Unread(String, String),
}

/// The quantity, if a heading names nothing else, or else the heading without its unit; and the unit.
pub(super) fn of_column(cell: &str) -> (String, Unit) {
    let (outer, inner) = bracketed(cell);
    let words = wave_unit::words(outer);
    let named = quantities(cell);
    let is_light = named.contains(&IRRADIANCE) || (named.is_empty() && trailing_unit(cell).is_some());
    if is_light {
        return irradiance(cell, inner);
    }
    let unit = fraction_unit(cell, inner);
    let rest: Vec<&str> = words.iter().map(String::as_str).filter(|word| !is_around(word)).collect();
    match (rest.as_slice(), named.as_slice()) {
        (_, [LOG]) => (LOG.to_owned(), unit),
        ([_], [one]) => ((*one).to_owned(), unit),
        _ => {
            let name = cell.strip_suffix("_percent").unwrap_or(cell);
            let name = name.split(['(', '[']).next().unwrap_or(name).trim();
            let unit = if matches!(unit, Unit::Percent) { unit } else { Unit::Plain };
            (name.trim_end_matches('%').trim().to_owned(), unit)
        }
    }
}

fn is_around(word: &str) -> bool {
    AROUND.contains(&word) || word == "cent"
}

/// The quantities that a heading names.
pub(super) fn quantities(cell: &str) -> Vec<&'static str> {
    let plain: String = cell.to_lowercase().chars().filter(|c| !c.is_whitespace() && *c != '_').collect();
    if ["log(1/r", "log10(1/r", "log1/r", "log10(r", "log(r"].iter().any(|log| plain.contains(log)) {
        return vec![LOG];
    }
    let words = wave_unit::words(cell);
    let is_named = |names: &[&str]| words.iter().any(|word| names.contains(&word.as_str()));
    QUANTITIES.iter().filter(|(_, names)| is_named(names)).map(|(quantity, _)| *quantity).collect()
}

/// The text before the last brackets of a heading, and in them.
fn bracketed(cell: &str) -> (&str, Option<&str>) {
    let begin = cell.find(['(', '[']);
    let end = cell.rfind([')', ']']);
    match begin.zip(end) {
        Some((begin, end)) if begin < end => (&cell[..begin], Some(cell[begin + 1..end].trim())),
        _ => (cell, None),
    }
}

fn fraction_unit(cell: &str, inner: Option<&str>) -> Unit {
    let words = wave_unit::words(cell);
    let has = |word: &str| words.iter().any(|w| w == word);
    let is_percent = |text: &str| HUNDRED.contains(&text.to_lowercase().as_str());
    if cell.contains('%')
        || HUNDRED.iter().any(|word| has(word))
        || words.windows(2).any(|pair| pair == ["per", "cent"])
        || inner.is_some_and(is_percent)
    {
        return Unit::Percent;
    }
    let Some(inner) = inner.filter(|inner| !ONE.contains(&inner.to_lowercase().as_str())) else { return Unit::Plain };
    let digits = inner.to_lowercase();
    let digits = digits.trim_start_matches(['x', '*', '\u{d7}', ' ']);
    let is_scale = digits.parse::<f64>().is_ok()
        || digits.starts_with("10^")
        || ["\u{2030}", "ppm", "permille", "permil", "per mille"].contains(&digits);
    match is_scale || Dimension::of(inner).is_some() {
        true => {
            let message = format!("`{inner}` is not a known unit of a fraction");
            Unit::Unread(message, "name the column `reflectance` (0 to 1) or `reflectance_percent`".to_owned())
        }
        false => Unit::Doubtful(inner.to_owned()),
    }
}

/// A unit of irradiance at the end of a heading that does not name the quantity.
fn trailing_unit(cell: &str) -> Option<&str> {
    let starts = cell.char_indices().zip(std::iter::once(' ').chain(cell.chars()));
    let mut starts = starts.filter(|((_, c), before)| c.is_alphabetic() && !before.is_alphanumeric());
    starts.find_map(|((at, _), _)| {
        let text = cell[at..].trim_end_matches([')', ']']);
        dimension(text).filter(|unit| w_m2_um(unit).is_some()).map(|_| text)
    })
}

fn irradiance(cell: &str, inner: Option<&str>) -> (String, Unit) {
    let at = cell.to_lowercase().find(IRRADIANCE).filter(|at| cell.is_char_boundary(at + IRRADIANCE.len()));
    let behind = at.map(|at| cell[at + IRRADIANCE.len()..].trim_matches(['_', ' ', ',', ':', '-']));
    // `irradiance_sigma (W m-2 nm-1)` is another quantity.
    let is_other = |text: &str| {
        let words = wave_unit::words(text.split(['(', '[']).next().unwrap_or_default());
        ["sigma", "std", "stdev", "error", "err", "uncertainty", "unc", "deviation"]
            .iter()
            .any(|word| words.iter().any(|w| w == word))
    };
    if behind.is_some_and(is_other) {
        return (cell.to_owned(), Unit::Plain);
    }
    let spelt = inner.or(behind).or_else(|| trailing_unit(cell)).unwrap_or_default();
    let refused = |message: String| {
        let help = format!("name the column `irradiance_w_m2_um` or `irradiance_w_m2_nm`; units are {IRRADIANCES}");
        (IRRADIANCE.to_owned(), Unit::Unread(message, help))
    };
    if spelt.is_empty() {
        return refused(format!("`{cell}` does not state its unit: per um and per nm differ by 1000"));
    }
    let plain: String = spelt.to_lowercase().replace('\u{207b}', "-").replace('\u{b9}', "1");
    let plain: String = plain.chars().filter(|c| !" ^(){}[]*._".contains(*c)).collect();
    if plain.contains("cm-1") || plain.contains("wavenumber") {
        let message = format!("`{spelt}` is per wavenumber, which is not read");
        let help = "per um it is as many times 1e4 / (wavelength in um)^2: write that as `irradiance_w_m2_um`";
        return (IRRADIANCE.to_owned(), Unit::Unread(message, help.to_owned()));
    }
    match dimension(spelt).as_ref().and_then(w_m2_um) {
        Some(times) => (IRRADIANCE.to_owned(), Unit::Irradiance(times, spelt.to_owned())),
        None => refused(format!("`{spelt}` is not a known unit of spectral irradiance")),
    }
}

/// A unit; where nothing says what is below the stroke, all lengths are: `w_m2_um`.
fn dimension(text: &str) -> Option<Dimension> {
    let is_plain = !text.contains(['-', '/', '\u{2212}', '\u{207b}']) && !text.to_lowercase().contains("per ");
    let text = text.replace('\u{2212}', "-");
    let text = match is_plain {
        true => text.split(['_', ' ', '.', '\u{b7}']).filter(|word| !word.is_empty()).collect::<Vec<_>>().join("/"),
        false => text,
    };
    let is_capitals = text.chars().all(|c| !c.is_lowercase()) && text.chars().filter(|c| c.is_alphabetic()).count() > 2;
    Dimension::of(&if is_capitals { text.to_lowercase() } else { text })
}

fn w_m2_um(unit: &Dimension) -> Option<f64> {
    unit.over(&Dimension::of("W m-2 um-1")?)
}

/// The unit of wavelengths, wavenumbers or frequencies that a heading states; `None` if it states none.
///
/// # Errors
/// What is wrong, and what to do: an unknown unit, or none where the column is not a wavelength.
pub(super) fn of_wavelength(cell: &str) -> Result<Option<WaveUnit>, (String, String)> {
    let (_, inner) = bracketed(cell);
    if let Some(unit) = inner.filter(|inner| !inner.is_empty()).and_then(WaveUnit::of)
        && !inner.is_some_and(is_wave_name)
    {
        return Ok(Some(unit));
    }
    let mut pieces: Vec<&str> = Vec::new();
    for piece in cell.split(['_', ' ', ',', ':', ';', '(', ')', '[', ']', '\t']).filter(|piece| !piece.is_empty()) {
        match piece.split_once(['/', '-']) {
            // `wavelength/nm`; not `1/cm` and `cm-1`.
            Some((name, unit)) if is_wave_name(name) => pieces.extend([name, unit]),
            _ => pieces.push(piece),
        }
    }
    let names: Vec<&str> = pieces.iter().copied().filter(|piece| is_wave_name(piece)).collect();
    let others: Vec<&str> =
        pieces.iter().copied().filter(|piece| !is_wave_name(piece) && !is_harmless(piece)).collect();
    // In a sentence `a` is an article.
    let is_unit = |piece: &&str| *piece != "a" || others.len() == 1;
    let unit = others.iter().copied().filter(is_unit).find_map(WaveUnit::of);
    let help = || format!("units are {WAVE_UNITS}, e.g. `wavelength_nm` or `wavenumber_cm-1`");
    match (unit, names.first()) {
        (Some(unit), _) => Ok(Some(unit)),
        (None, Some(name)) if !others.is_empty() => {
            Err((format!("`{cell}` states no unit of {} that is known", name.to_lowercase()), help()))
        }
        (None, Some(name)) if !is_wavelength_name(name) => Err((format!("`{cell}` does not state its unit"), help())),
        _ => Ok(None),
    }
}

/// Whether a heading begins with what wavelengths are called, or is a unit of them.
pub(super) fn is_of_wavelength(cell: &str) -> bool {
    let first = cell.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
    is_wave_name(first) || WaveUnit::of(cell).is_some()
}

fn is_wavelength_name(word: &str) -> bool {
    let word = word.to_lowercase();
    word.starts_with("wavelen") || ["lambda", "wl", "wave", "wvl", "\u{3bb}"].contains(&word.as_str())
}

fn is_wave_name(word: &str) -> bool {
    let plain = word.to_lowercase();
    is_wavelength_name(word) || ["wavenumber", "wavenumbers", "frequency", "energy"].contains(&plain.as_str())
}

/// Words next to a wavelength that are not units.
fn is_harmless(word: &str) -> bool {
    const HARMLESS: [&str; 21] = [
        "vacuum", "vac", "air", "centre", "center", "central", "band", "channel", "x", "axis", "nominal", "mean", "of",
        "in", "the", "unit", "units", "data", "photon", "value", "values",
    ];
    HARMLESS.contains(&word.to_lowercase().as_str())
}
