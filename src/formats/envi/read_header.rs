//! What a header says: its text, key by key, and what the keys mean.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::{CODES, DataType, Interleave, SPECTRAL_LIBRARY};
use crate::error::{Error, Location, Problem, Result};
use crate::formats::input;
use crate::formats::spelling;
use crate::formats::wave_unit::WaveUnit;
use crate::report::{Fate, Report};

/// Value = (number x gain + offset) / divisor.
#[derive(Debug, Clone, Copy)]
pub(in crate::formats) struct Scale {
    pub(in crate::formats) gain: f64,
    pub(in crate::formats) offset: f64,
    /// What a file has for a reflectance of 1.
    pub(in crate::formats) divisor: f64,
}

impl Scale {
    pub(in crate::formats) fn value(self, number: f64) -> f64 {
        (number * self.gain + self.offset) / self.divisor
    }
}

/// What a header says.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// The header file.
    pub path: PathBuf,
    /// Pixels in a line.
    pub samples: usize,
    /// Lines.
    pub lines: usize,
    /// Bands.
    pub bands: usize,
    /// Bytes before the first number.
    pub header_offset: u64,
    /// How a number is stored.
    pub data_type: DataType,
    /// In which order.
    pub interleave: Interleave,
    /// Most significant byte first.
    pub big_endian: bool,
    /// Centres of the bands, in `wavelength_units`; empty if not given.
    pub wavelength: Vec<f64>,
    /// Full widths at half maximum, in `wavelength_units`; empty if not given.
    pub fwhm: Vec<f64>,
    /// Names of the bands; empty if not given.
    pub band_names: Vec<String>,
    /// The number that means "nothing here".
    pub ignore: Option<f64>,
    /// Every key (lower case) and its text, in the order of the file.
    pub fields: Vec<(String, String)>,
    /// What was not taken literally.
    pub report: Report,
}

impl Header {
    /// The text of a key (lower case).
    pub fn field(&self, key: &str) -> Option<&str> {
        self.fields.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str())
    }

    /// Whether it is that of a spectral library, whose lines are spectra.
    pub fn is_library(&self) -> bool {
        self.field("file type").is_some_and(|t| t.eq_ignore_ascii_case(SPECTRAL_LIBRARY))
    }

    /// Of each of `count` bands, or channels of a spectral library, whether it is good: `bbl`, the list of bad bands, has 0 for those that are not.
    ///
    /// # Errors
    /// [`Error::Invalid`] for another list.
    pub(in crate::formats) fn good(&self, count: usize) -> Result<Vec<bool>> {
        let Some(list) = self.field("bbl") else { return Ok(vec![true; count]) };
        let flags: Option<Vec<bool>> =
            list.split(',').map(|flag| Some(flag.trim().parse::<f64>().ok()? != 0.0)).collect();
        flags.filter(|flags| flags.len() == count).ok_or_else(|| {
            let message = format!("is not a list of {count} numbers, 0 or 1");
            Error::invalid(Location::file(&self.path).with_item("bbl"), message)
        })
    }

    /// How the numbers of `count` bands, or channels of a spectral library, become values; none if they are the values. One gain or offset
    /// is for all of them.
    pub(in crate::formats) fn scales(&self, count: usize, problems: &mut Vec<Problem>) -> Vec<Scale> {
        let mut list = |key: &str, default: f64| -> Option<Vec<f64>> {
            let text = self.field(key)?;
            let numbers: Option<Vec<f64>> = text.split(',').map(|t| t.trim().parse().ok()).collect();
            let is_whole = |n: &Vec<f64>| n.len() == count || (n.len() == 1 && self.is_library());
            let numbers = numbers.filter(|n| is_whole(n) && n.iter().all(|v| v.is_finite()));
            if numbers.is_none() {
                let each = if self.is_library() { "channel, or a single one" } else { "band" };
                let message = format!("is not a list of {count} finite numbers, one for each {each}");
                problems.push(Problem::new(Location::file(&self.path).with_item(key), message));
            }
            numbers.filter(|n| n.iter().any(|v| *v != default))
        };
        let gains = list("data gain values", 1.0);
        let offsets = list("data offset values", 0.0);
        let divisor = match self.field("reflectance scale factor").map(str::parse::<f64>) {
            None => 1.0,
            Some(Ok(divisor)) if divisor > 0.0 && divisor.is_finite() => divisor,
            Some(_) => {
                let at = Location::file(&self.path).with_item("reflectance scale factor");
                problems.push(Problem::new(at, "is not a positive number"));
                1.0
            }
        };
        if gains.is_none() && offsets.is_none() && divisor == 1.0 {
            return Vec::new();
        }
        let of = |list: &Option<Vec<f64>>, i: usize, default| list.as_ref().map_or(default, |l| l[i % l.len()]);
        (0..count).map(|i| Scale { gain: of(&gains, i, 1.0), offset: of(&offsets, i, 0.0), divisor }).collect()
    }

    /// Wavelengths in um, and the unit that was taken for granted if the header gives none; `None` for other units, as an index.
    pub(in crate::formats) fn um(&self, wavelengths: &[f64]) -> Option<(Vec<f64>, Option<&'static str>)> {
        let (unit, taken) = self.wavelength_unit()?;
        let um = |w: &f64| unit.um(*w).unwrap_or(f64::INFINITY);
        Some((wavelengths.iter().map(um).collect(), taken))
    }

    /// The unit of wavelengths, and its name if it was taken for granted.
    fn wavelength_unit(&self) -> Option<(WaveUnit, Option<&'static str>)> {
        match self.field("wavelength units").unwrap_or_default().trim() {
            text if !["", "unknown"].contains(&text.to_lowercase().as_str()) => {
                WaveUnit::of(text).map(|unit| (unit, None))
            }
            _ if self.wavelength.iter().all(|w| *w >= 100.0) => Some((WaveUnit::PerUm(1e3), Some("nanometres"))),
            _ => Some((WaveUnit::Um(1.0), Some("micrometres"))),
        }
    }

    /// Widths of the bands, um, in the unit of `fwhm units`, if there is that key, or of the wavelengths; `None` if they cannot be used.
    /// The report lists what is odd.
    pub(in crate::formats) fn fwhm_um(&self, centres_um: &[f64], report: &mut Report) -> Option<Vec<f64>> {
        let at = || Location::file(&self.path).with_item("fwhm");
        let unit = match self.field("fwhm units").and_then(WaveUnit::of) {
            Some(unit) => unit,
            None => self.wavelength_unit()?.0,
        };
        let in_unit = |unit: WaveUnit| -> Option<Vec<f64>> {
            let all = self.wavelength.iter().zip(centres_um).zip(&self.fwhm);
            let widths = all.map(|((centre, um), width)| unit.width_um(*centre, *width).filter(|w| *w <= 2.0 * um));
            widths.collect()
        };
        if self.fwhm.is_empty() || centres_um.len() != self.fwhm.len() {
            return None;
        }
        if let Some(widths) = in_unit(unit) {
            return Some(widths);
        }
        // Wavelengths in um beside widths in nm.
        let in_nm = in_unit(WaveUnit::PerUm(1e3)).filter(|_| unit == WaveUnit::Um(1.0));
        match &in_nm {
            Some(_) => {
                report.note(Fate::Defaulted, at(), "wider than any band around these wavelengths: taken as nanometres")
            }
            None => report.note(Fate::Dropped, at(), "widths that are none: of more than twice the wavelength"),
        }
        in_nm
    }

    /// Size of the numbers in the data file, bytes; `None` if no file can be so large.
    pub fn data_bytes(&self) -> Option<u64> {
        let count = (self.samples as u64).checked_mul(self.lines as u64)?.checked_mul(self.bands as u64)?;
        count.checked_mul(self.data_type.bytes() as u64)
    }
}

/// Longer headers are refused, bytes: they are text of a few kilobytes.
const LIMIT: u64 = 16 << 20;

/// Reads a header.
///
/// # Errors
/// [`Error::Io`], [`Error::Syntax`] at the first line that is not of a header, [`Error::Invalid`] with all values that are missing
/// or wrong, [`Error::Unsupported`] for complex numbers and other data types we do not read.
pub fn read_header(path: &Path) -> Result<Header> {
    let bytes = input::bytes(path, LIMIT)?;
    parse_header(path, &input::with_line_ends(String::from_utf8_lossy(&bytes).into_owned()))
}

/// Reads the text of a header; `path` is for messages.
///
/// # Errors
/// As [`read_header`], except [`Error::Io`].
pub fn parse_header(path: &Path, text: &str) -> Result<Header> {
    let fields = Fields::parse(path, text)?;
    let mut problems = Vec::new();
    let samples = fields.whole("samples", None, 1, &mut problems);
    let lines = fields.whole("lines", None, 1, &mut problems);
    let bands = fields.whole("bands", None, 1, &mut problems);
    let header_offset = fields.whole("header offset", Some(0), 0, &mut problems);
    let code = fields.whole("data type", None, 1, &mut problems);
    let order = fields.whole("byte order", Some(0), 0, &mut problems);
    if order > 1 {
        problems.push(Problem::new(
            fields.at("byte order"),
            format!("{order} is neither 0, the least significant byte first, nor 1, the most significant"),
        ));
    }
    let big_endian = order == 1;
    let interleave = match fields.get("interleave").map(str::to_lowercase).as_deref() {
        Some("bsq") | None => Interleave::Bsq,
        Some("bil") => Interleave::Bil,
        Some("bip") => Interleave::Bip,
        Some(other) => {
            problems.push(Problem::new(fields.at("interleave"), format!("{other:?} is not one of bsq, bil, bip")));
            Interleave::Bsq
        }
    };
    // A spectral library has a wavelength for each sample: a line is a spectrum.
    let is_library = fields.get("file type").is_some_and(|t| t.eq_ignore_ascii_case(SPECTRAL_LIBRARY));
    let counted = if is_library { ("samples", samples) } else { ("bands", bands) };
    let wavelength = fields.numbers("wavelength", counted, &mut problems);
    let fwhm = fields.numbers("fwhm", counted, &mut problems);
    let ignore = fields.number("data ignore value", &mut problems);
    let mut report = Report::default();
    fields.tell_doubled(&mut problems, &mut report);
    if !problems.is_empty() {
        return Err(Error::Invalid(problems));
    }
    // Programs differ in whether they skip these bytes: ENVI Classic does, ENVI does not.
    for key in ["major frame offsets", "minor frame offsets"] {
        if fields.items(key).iter().any(|item| item.parse() != Ok(0.0)) {
            let feature = "bytes before or behind each frame (write the image without them)".to_owned();
            return Err(Error::Unsupported { at: fields.at(key), feature });
        }
    }
    let Some(data_type) = CODES.iter().find(|c| c.0 == code).map(|c| c.1) else {
        let complex = if matches!(code, 6 | 9) { " (complex numbers)" } else { "" };
        return Err(Error::Unsupported {
            at: fields.at("data type"),
            feature: format!("ENVI data type {code}{complex}"),
        });
    };
    let band_names = fields.names("band names", bands, &mut report);
    fields.tell_misspelt(&mut report);
    // What no memory can count is more than the file holds, too.
    let size = |count: u64| usize::try_from(count).unwrap_or(usize::MAX);
    let header = Header {
        path: path.to_owned(),
        samples: size(samples),
        lines: size(lines),
        bands: size(bands),
        header_offset,
        data_type,
        interleave,
        big_endian,
        wavelength,
        fwhm,
        band_names,
        ignore,
        fields: fields.list.iter().map(|f| (f.key.clone(), f.value.clone())).collect(),
        report,
    };
    match header.data_bytes() {
        Some(_) => Ok(header),
        None => Err(Error::invalid(fields.at("samples"), "samples x lines x bands is more than a file can hold")),
    }
}

/// What a header's text says, as text.
struct Fields<'a> {
    path: &'a Path,
    list: Vec<Field>,
}

struct Field {
    line: usize,
    /// In lower case.
    key: String,
    /// Without the braces of a list.
    value: String,
}

/// Keys that have a meaning here.
pub(in crate::formats) const KEYS: [&str; 22] = [
    "samples",
    "lines",
    "bands",
    "header offset",
    "file type",
    "file compression",
    "data type",
    "interleave",
    "byte order",
    "wavelength",
    "wavelength units",
    "fwhm",
    "fwhm units",
    "bbl",
    "band names",
    "data units",
    "data ignore value",
    "data gain values",
    "data offset values",
    "reflectance scale factor",
    "major frame offsets",
    "minor frame offsets",
];

/// At most this many keys that may be misspelt are reported.
const TOLD: usize = 30;

/// Lines that a header of ESRI has.
const OF_ESRI: [&str; 10] =
    ["nrows", "ncols", "nbands", "nbits", "byteorder", "layout", "skipbytes", "ulxmap", "bandrowbytes", "pixeltype"];

fn is_of_esri(text: &str) -> bool {
    let mut keys = text.lines().filter_map(|line| line.split_once([' ', '\t'])).map(|(key, _)| key.to_lowercase());
    keys.any(|key| OF_ESRI.contains(&key.as_str()))
}

/// Whether a text begins as one more `key = value` does.
fn begins_a_field(text: &str) -> bool {
    let text = text.trim_start();
    let behind_key = text.trim_start_matches(|c: char| c.is_alphanumeric() || " _-".contains(c)).trim_start();
    text.starts_with(char::is_alphabetic) && behind_key.starts_with('=')
}

/// Where a list ends: at a brace behind which the line ends, or the next field begins. Those inside of texts do not end it.
fn end_of_list(line: &str) -> Option<usize> {
    let line = line.trim_end();
    line.match_indices('}').map(|(i, _)| i).find(|i| {
        let rest = line[i + 1..].trim_start();
        rest.is_empty() || rest.starts_with(';') || begins_a_field(rest)
    })
}

impl<'a> Fields<'a> {
    fn parse(path: &'a Path, text: &str) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim_end())).peekable();
        if lines.next().is_none_or(|(_, first)| !first.trim().eq_ignore_ascii_case("ENVI")) {
            if is_of_esri(text) {
                let feature = "a header of ESRI for BIL, BIP or BSQ (`gdal_translate -of ENVI IN OUT.img` makes an image that is read)";
                return Err(Error::Unsupported { at: Location::file(path), feature: feature.into() });
            }
            return Err(Error::syntax(Location::line(path, 1), "an ENVI header begins with the line ENVI"));
        }
        let mut list = Vec::new();
        // What is left of a line behind a list.
        let mut left: Option<(usize, &str)> = None;
        while let Some((number, line)) = left.take().or_else(|| lines.next()) {
            if line.trim().is_empty() || line.trim_start().starts_with(';') {
                continue;
            }
            let Some((key, value)) = line.split_once('=') else {
                return Err(Error::syntax(Location::line(path, number), "expected `key = value`"));
            };
            let mut value = value.trim();
            if value.is_empty()
                && let Some((_, next)) = lines.next_if(|(_, next)| next.trim_start().starts_with('{'))
            {
                value = next.trim();
            }
            let value = if let Some(first) = value.strip_prefix('{') {
                let mut whole = String::new();
                let mut line = first;
                let mut at_line = number;
                loop {
                    if let Some(end) = end_of_list(line) {
                        whole.push_str(&line[..end]);
                        left = Some((at_line, &line[end + 1..]));
                        break;
                    }
                    whole.push_str(line);
                    whole.push('\n');
                    let Some((next_number, next)) = lines.next() else {
                        let at = Location::line(path, number).with_item(key.trim());
                        return Err(Error::syntax(at, "the list that begins here with { is not closed with }"));
                    };
                    (at_line, line) = (next_number, next.trim());
                }
                whole.trim().to_owned()
            } else {
                value.to_owned()
            };
            let key = key.split_whitespace().collect::<Vec<_>>().join(" ").to_lowercase();
            list.push(Field { line: number, key, value });
        }
        Ok(Fields { path, list })
    }

    /// Keys that appear twice must have the same value.
    fn tell_doubled(&self, problems: &mut Vec<Problem>, report: &mut Report) {
        let plain = |text: &str| text.split([' ', '\t', '\n', '\r']).collect::<String>().to_lowercase();
        let mut known: BTreeMap<&str, &Field> = BTreeMap::new();
        for field in self.list.iter().filter(|field| KEYS.contains(&field.key.as_str())) {
            let Some(first) = known.get(field.key.as_str()) else {
                known.insert(&field.key, field);
                continue;
            };
            let at = Location::line(self.path, field.line).with_item(&field.key);
            if plain(&first.value) == plain(&field.value) {
                report.note(Fate::Defaulted, at, format!("appears twice, the same as in line {}", first.line));
            } else {
                problems.push(Problem::new(at, format!("appears twice, and in line {} it is another", first.line)));
            }
        }
    }

    /// Tells keys that may be meant for others, which are not there.
    fn tell_misspelt(&self, report: &mut Report) {
        let there: BTreeSet<&str> = self.list.iter().map(|field| field.key.as_str()).collect();
        let mut known: BTreeSet<&str> = KEYS.into();
        let mut told = 0;
        for field in &self.list {
            if told == TOLD {
                break;
            }
            if !known.insert(&field.key) {
                continue;
            }
            if let Some(near) = spelling::nearest(&field.key, &KEYS).filter(|near| !there.contains(near)) {
                told += 1;
                let message = format!("is not an ENVI key and is ignored: did you mean `{near}`?");
                report.note(Fate::Dropped, Location::line(self.path, field.line).with_item(&field.key), message);
            }
        }
    }

    /// A name for each of `count` things: names may contain commas if each is on its own line. Empty if the count is wrong, which is reported.
    fn names(&self, key: &str, count: u64, report: &mut Report) -> Vec<String> {
        let Some(text) = self.get(key) else { return Vec::new() };
        let fits = |names: &Vec<String>| names.len() as u64 == count;
        let split = |by: fn(char) -> bool| -> Vec<String> {
            let text = text.trim().trim_end_matches(',');
            text.split(by).map(|name| name.trim().trim_end_matches(',').trim().to_owned()).collect()
        };
        let by_comma = split(|c| c == ',');
        let by_line = split(|c| c == '\n');
        let found = by_comma.len();
        let names = Some(by_comma).filter(fits).or(Some(by_line).filter(fits));
        if names.is_none() && !text.trim().is_empty() {
            let message = format!("{found} names for {count} bands, if commas part them: they are left out");
            report.note(Fate::Dropped, self.at(key), message);
        }
        names.unwrap_or_default()
    }

    fn get(&self, key: &str) -> Option<&str> {
        self.list.iter().find(|f| f.key == key).map(|f| f.value.as_str())
    }

    fn at(&self, key: &str) -> Location {
        match self.list.iter().find(|f| f.key == key) {
            Some(field) => Location::line(self.path, field.line).with_item(key),
            None => Location::file(self.path).with_item(key),
        }
    }

    /// A whole number of at least `least`; without a default it must be there.
    fn whole(&self, key: &str, default: Option<u64>, least: u64, problems: &mut Vec<Problem>) -> u64 {
        let message = match (self.get(key), default) {
            (Some(text), _) => match whole(text.split(';').next().unwrap_or_default().trim()) {
                Some(value) if value >= least => return value,
                _ => format!("{text:?} is not a whole number from {least}"),
            },
            (None, Some(default)) => return default,
            (None, None) => "is missing".into(),
        };
        let mut problem = Problem::new(self.at(key), message);
        let keys: Vec<&str> = self.list.iter().map(|f| f.key.as_str()).filter(|key| !KEYS.contains(key)).collect();
        if self.get(key).is_none()
            && let Some(near) = spelling::nearest(key, &keys)
        {
            problem = problem.with_help(format!("is `{near}` meant for it?"));
        }
        problems.push(problem);
        least
    }

    /// A number, which may be NaN.
    fn number(&self, key: &str, problems: &mut Vec<Problem>) -> Option<f64> {
        let text = self.get(key).filter(|text| !text.is_empty())?;
        let value = text.parse().ok();
        if value.is_none() {
            problems.push(Problem::new(self.at(key), format!("{text:?} is not a number")));
        }
        value
    }

    /// The items of a list; none if it is not there.
    fn items(&self, key: &str) -> Vec<String> {
        let text = self.get(key).unwrap_or("");
        let by_blanks = !text.contains(',');
        let items = text.split(|c: char| c == ',' || (by_blanks && c.is_whitespace())).map(str::trim);
        items.filter(|item| !item.is_empty()).map(str::to_owned).collect()
    }

    /// A number for each band; none if the list is not there.
    fn numbers(&self, key: &str, (counted, count): (&str, u64), problems: &mut Vec<Problem>) -> Vec<f64> {
        let items = self.items(key);
        let values: Vec<f64> =
            items.iter().filter_map(|item| item.parse().ok()).filter(|v: &f64| v.is_finite()).collect();
        if values.len() != items.len() {
            problems.push(Problem::new(self.at(key), "has items that are not finite numbers"));
        } else if !values.is_empty() && values.len() as u64 != count {
            problems.push(Problem::new(self.at(key), format!("{} values for {count} {counted}", values.len())));
        }
        values
    }
}

/// A whole number, also where it is written as 3.0.
#[expect(clippy::cast_possible_truncation, reason = "it is checked to be whole and within 9e15")]
fn whole(text: &str) -> Option<u64> {
    let of_real = || text.parse::<f64>().ok().filter(|v| v.fract() == 0.0 && (0.0..9e15).contains(v)).map(|v| v as u64);
    text.parse().ok().or_else(of_real)
}
