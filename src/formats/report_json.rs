//! `report.json`: what a product is made of and how good it is. `run.json`: how long that took, where and when.
//!
//! The first is the same, byte for byte, at every run; the second never is. JSON Schemas of both are in `schemas/`.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Write};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use schemars::{JsonSchema, Schema};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::InputFile;
use super::input;
use crate::error::{Error, Location, Result};
use crate::product::{Backplanes, ShownBands};
use crate::scene::Scene;
use crate::spectral::Band;
use crate::study::{
    BandSignal, Bound, Check, Coarser, Counts, Effect, MapAccount, Orientation, Plan, Reader, SurfaceEntry,
};

/// Version of both formats.
pub const FORMAT_VERSION: u32 = 2;

/// What a product is made of, and how good it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProductReport {
    /// Version of this format.
    pub format_version: u32,
    /// Version of mmxrt.
    pub mmxrt: String,
    /// The scene: a hash of its inputs.
    pub scene: String,
    /// Every file the result depends on.
    pub inputs: Vec<Input>,
    /// What of the scene file was replaced, as `KEY=VALUE`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub settings: Vec<String>,
    /// Size of the image.
    pub image: ImageEntry,
    /// Which way is which in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
    /// Its bands, if one of them is not Gaussian or monochromatic, has not both sunlight and heat, or is cut.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<BandEntry>,
    /// What decided by which models it was made; not there if a facet table did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<PlanEntry>,
    /// What was modelled, and what was left out. Errors are relative to the radiance of this image.
    pub effects: Vec<Effect>,
    /// How its materials reflect, at the wavelength of the middle band with sunlight.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub surfaces: Vec<SurfaceEntry>,
    /// What was verified of this result.
    pub checks: Vec<Check>,
    /// What the mesh is like.
    pub counts: Counts,
    /// The radiance maps that it was made from, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub maps: Option<MapAccount>,
    /// Signal and noise of each band, of an image that a detector has read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signal: Option<SignalEntry>,
    /// What the input did not say, and what was taken for it.
    pub defaults: Vec<String>,
    /// What a reader of the result should know.
    pub warnings: Vec<String>,
    /// The numbers of the cube (first, middle and last band, covered pixels) and of every backplane.
    pub statistics: Vec<Statistic>,
}

/// Signal and noise of an image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SignalEntry {
    /// Elements of the detector that see nothing.
    pub dead_elements: u64,
    /// Each band.
    pub bands: Vec<BandSignal>,
}

impl SignalEntry {
    /// Of a detector that has read all of an image.
    pub fn of(reader: &Reader) -> Self {
        SignalEntry { dead_elements: reader.dead_elements(), bands: reader.account() }
    }
}

/// What is said of a cube that an instrument was put over.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InstrumentReport {
    /// Version of this format.
    pub format_version: u32,
    /// Version of mmxrt.
    pub mmxrt: String,
    /// Every file the result depends on.
    pub inputs: Vec<Input>,
    /// Signal and noise of each band, if a detector has read it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signal: Option<SignalEntry>,
    /// What a reader of the result should know.
    pub warnings: Vec<String>,
}

/// What was asked of a plan, and what it says of the whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanEntry {
    /// `auto`, `thesis`, `full`, or a list of effects.
    pub model: String,
    /// The largest error of a pixel that was to be left.
    pub tolerance: f64,
    /// The sum of the bounds of effects that were dropped; null if one of them is not known. Open ones don't count, nor what has a tolerance of its own.
    pub dropped: Option<Bound>,
    /// The sum of what is left of those that were kept; null if one of them is not known.
    pub remaining: Option<Bound>,
    /// Whether both together stay within the tolerance.
    pub keeps_tolerance: bool,
    /// About the CPU time that all of it takes, s, on a machine of 2022; what it took is in `run.json`.
    pub cpu_s: f64,
    /// Where the mesh is far finer than pixels: one that would do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coarser: Option<Coarser>,
}

impl From<&Plan> for PlanEntry {
    fn from(plan: &Plan) -> Self {
        PlanEntry {
            model: plan.model.clone(),
            tolerance: plan.tolerance,
            dropped: plan.dropped,
            remaining: plan.remaining,
            keeps_tolerance: plan.keeps_tolerance(),
            cpu_s: plan.cpu_s,
            coarser: plan.coarser.clone(),
        }
    }
}

/// A file that a result depends on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Its path, as it was opened.
    pub path: String,
    /// Its length, bytes.
    pub bytes: u64,
    /// BLAKE3 hash of its bytes, 64 hexadecimal digits.
    pub blake3: String,
}

impl From<&InputFile> for Input {
    fn from(file: &InputFile) -> Self {
        Input { path: file.path.display().to_string(), bytes: file.bytes, blake3: file.blake3.clone() }
    }
}

/// Size of an image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ImageEntry {
    /// Pixels in a line.
    pub samples: u64,
    /// Lines.
    pub lines: u64,
    /// Bands.
    pub bands: u64,
    /// What its numbers are: "radiance" if nothing is said.
    #[serde(default)]
    pub quantity: String,
    /// Their unit.
    #[serde(default)]
    pub unit: String,
    /// Centre of the first band, um.
    pub first_band_um: f64,
    /// Centre of the last band, um.
    pub last_band_um: f64,
    /// The band that `quicklook.png` shows, from 1.
    pub quicklook_band: u64,
    /// The bands that `quicklook_rgb.png` shows as red, green and blue, from 1.
    pub quicklook_rgb_bands: [u64; 3],
}

/// A band of an image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BandEntry {
    /// What it is called, if it is called anything.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Centre, um: of a table, the mean of wavelength over its response.
    pub centre_um: f64,
    /// Full width at half maximum, um: of a table, its equivalent width; 0 for a monochromatic band.
    pub fwhm_um: f64,
    /// "monochromatic", "gaussian", "box", "sinc2" or "table".
    pub response: String,
    /// "sunlight", "heat" or "both".
    pub light: String,
    /// Share of the response that lies where not all spectra are known, and is left out.
    pub left_out: f64,
}

impl BandEntry {
    /// The bands of a scene; none if all are as they mostly are.
    pub fn of(scene: &Scene) -> Vec<Self> {
        let entry = |band: &Band| BandEntry {
            name: Some(band.name.clone()).filter(|name| !name.is_empty()),
            centre_um: band.centre_um,
            fwhm_um: band.fwhm_um.unwrap_or(0.0),
            response: band.fwhm_um.map_or("monochromatic", |_| band.response.name()).into(),
            light: band.light.name().into(),
            left_out: scene.share_left_out(band),
        };
        let bands: Vec<BandEntry> = scene.exposure.bands.iter().map(entry).collect();
        let is_usual = |b: &BandEntry| {
            ["monochromatic", "gaussian"].contains(&b.response.as_str())
                && b.light == "both"
                && b.left_out == 0.0
                && b.name.is_none()
        };
        if bands.iter().all(is_usual) { vec![] } else { bands }
    }
}

/// What the numbers of an image are like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Statistic {
    /// The image.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Pixels that have a value.
    pub count: u64,
    /// Smallest value; null without any.
    pub min: Option<f64>,
    /// Largest value; null without any.
    pub max: Option<f64>,
    /// Mean value; null without any.
    pub mean: Option<f64>,
}

impl Statistic {
    /// Of the values that are numbers.
    pub fn of(name: impl Into<String>, unit: impl Into<String>, values: &[f64]) -> Self {
        // Eight sums side by side do not wait for one another. A comparison with NaN is false.
        let mut lanes = [Lane { count: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, sum: 0.0 }; 8];
        for chunk in values.chunks(lanes.len()) {
            for (lane, &value) in lanes.iter_mut().zip(chunk) {
                let is_number = !value.is_nan();
                lane.count += u64::from(is_number);
                lane.min = if value < lane.min { value } else { lane.min };
                lane.max = if value > lane.max { value } else { lane.max };
                lane.sum += if is_number { value } else { 0.0 };
            }
        }
        let count = lanes.iter().map(|l| l.count).sum();
        let sum: f64 = lanes.iter().map(|l| l.sum).sum();
        let min = lanes.iter().map(|l| l.min).fold(f64::INFINITY, f64::min);
        let max = lanes.iter().map(|l| l.max).fold(f64::NEG_INFINITY, f64::max);
        let some = |value: f64| (count > 0).then_some(value);
        Statistic {
            name: name.into(),
            unit: unit.into(),
            count,
            // Not -0.
            min: some(min + 0.0),
            max: some(max),
            mean: some(sum / count as f64),
        }
    }
}

/// Part of the sums of a [`Statistic`].
#[derive(Clone, Copy)]
struct Lane {
    count: u64,
    min: f64,
    max: f64,
    sum: f64,
}

/// The bands that statistics are of: the first, the middle and the last.
pub fn bands_of_statistics(bands: &[Band]) -> Vec<usize> {
    let mut of = vec![0, bands.len() / 2, bands.len().saturating_sub(1)];
    of.dedup();
    of.retain(|band| *band < bands.len());
    of
}

/// Statistics of a cube's first, middle and last band over the pixels with `coverage`, and of every backplane.
pub fn statistics(cube: &ShownBands, coverage: &[f64], backplanes: &Backplanes) -> Vec<Statistic> {
    let covered = |band: usize| {
        let values = cube.band(band).iter().zip(coverage);
        values.filter(|(_, c)| **c > 0.0).map(|(value, _)| *value).collect::<Vec<f64>>()
    };
    let of_band = |band: usize| {
        let Band { name, centre_um, .. } = &cube.axes.bands[band];
        let called = if name.is_empty() { String::new() } else { format!(" ({name})") };
        let quantity = cube.axes.quantity;
        let name = format!("{} at {centre_um} um{called}", quantity.name());
        Statistic::of(name, quantity.unit(), &covered(band))
    };
    let of_planes = backplanes.planes.iter().map(|p| Statistic::of(&p.name, &p.unit, &p.values));
    bands_of_statistics(&cube.axes.bands).into_iter().map(of_band).chain(of_planes).collect()
}

/// How long a run took, where and when.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Version of this format.
    pub format_version: u32,
    /// Version of mmxrt.
    pub mmxrt: String,
    /// The command, as in "simulate".
    pub command: String,
    /// When it began, UTC (RFC 3339).
    pub date: String,
    /// Threads it used.
    pub threads: u64,
    /// Cores the machine has.
    pub host_cores: u64,
    /// From start to end, s.
    pub wall_s: f64,
    /// CPU time of all threads, s; null if whoever ran it does not know.
    #[serde(default)]
    pub cpu_s: Option<f64>,
    /// The stages, in the order they began.
    pub stages: Vec<Stage>,
    /// What the plan said that would take, and what it took: all of it first, and effects that have time of their own. Empty without a plan.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub costs: Vec<Cost>,
    /// The other files of a product, and their sizes, bytes: by these it is told whether it is whole.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, u64>,
}

/// A part of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// What was done.
    pub name: String,
    /// How long it took, s.
    pub wall_s: f64,
    /// CPU time of all threads in that time, s.
    pub cpu_s: f64,
}

/// What something was expected to take, and what it took.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// `all`, or an effect.
    pub of: String,
    /// CPU time that was predicted, s, on a machine of 2022.
    pub predicted_cpu_s: f64,
    /// CPU time that was measured, s.
    pub measured_cpu_s: f64,
}

/// What is called `of` where a cost is of all.
pub const ALL: &str = "all";

impl Run {
    /// Puts what was measured beside what a plan has predicted, if it was measured.
    pub fn set_costs(&mut self, plan: &Plan) {
        let Some(measured_cpu_s) = self.cpu_s else { return };
        let all = Cost { of: ALL.to_owned(), predicted_cpu_s: plan.cpu_s, measured_cpu_s };
        let of = |effect: &Effect| {
            let within = effect.stage.as_ref()?;
            let stage = self.stages.iter().find(|stage| stage.name == within.name)?;
            Some(Cost {
                of: effect.key.clone(),
                predicted_cpu_s: effect.cost_s?,
                measured_cpu_s: within.share * stage.cpu_s,
            })
        };
        self.costs = std::iter::once(all).chain(plan.effects.iter().filter_map(of)).collect();
    }
}

/// JSON Schema of [`ProductReport`].
pub fn report_schema() -> Schema {
    schemars::schema_for!(ProductReport)
}

/// JSON Schema of [`Run`].
pub fn run_schema() -> Schema {
    schemars::schema_for!(Run)
}

/// Writes either as JSON for people to read.
///
/// # Errors
/// [`Error::Io`] if the file cannot be written.
pub fn write(path: &Path, value: &impl Serialize) -> Result<()> {
    let io = |e| Error::io(path, "writing", e);
    let text = text(path, value)?;
    File::create(path).and_then(|mut file| file.write_all(text.as_bytes())).map_err(io)
}

/// The text of such a file.
///
/// # Errors
/// [`Error::Io`].
pub(crate) fn text(path: &Path, value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Error::io(path, "writing", e.into()))?;
    Ok(text + "\n")
}

/// Reads a [`ProductReport`] or a [`Run`].
///
/// # Errors
/// [`Error::Io`], or [`Error::Syntax`] at the place that is not of its format.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let file = input::open(path).map_err(|e| Error::io(path, "reading", e))?;
    serde_json::from_reader(BufReader::new(file)).map_err(|e| match e.classify() {
        serde_json::error::Category::Io => Error::io(path, "reading", e.into()),
        _ => {
            // Column 0 is the end of the line before.
            let at = Location { column: Some(e.column().max(1)), ..Location::line(path, e.line()) };
            let message = e.to_string();
            // The place is in the location already.
            Error::syntax(at, message.split(" at line ").next().unwrap_or(&message))
        }
    })
}

/// A time in UTC as RFC 3339, to the second: `2026-11-22T03:04:05Z`.
pub fn rfc3339(time: SystemTime) -> String {
    let seconds = match time.duration_since(UNIX_EPOCH) {
        Ok(after) => after.as_secs() as i64,
        Err(before) => -(before.duration().as_secs() as i64),
    };
    let (days, second) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    let (year, month, day) = date(days);
    format!("{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}Z", second / 3600, second / 60 % 60, second % 60)
}

/// Year, month and day of a day counted from 1970-01-01 (Gregorian).
///
/// Years are counted from 1 March, so that the leap day is a year's last. Source: Hinnant (2013), "chrono-Compatible
/// Low-Level Date Algorithms", `civil_from_days`.
fn date(days: i64) -> (i64, i64, i64) {
    let from_march_0000 = days + 719_468;
    let era = from_march_0000.div_euclid(146_097);
    let day_of_era = from_march_0000.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    (year_of_era + era * 400 + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn known_dates() {
        // From `date -u -d @N +%FT%TZ`.
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_709_251_199, "2024-02-29T23:59:59Z"),
            (1_000_000_000, "2001-09-09T01:46:40Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(rfc3339(UNIX_EPOCH + Duration::from_secs(seconds)), text);
        }
        assert_eq!(rfc3339(UNIX_EPOCH - Duration::from_secs(1)), "1969-12-31T23:59:59Z");
    }

    #[test]
    fn statistics_leave_out_what_is_no_number() {
        let s = Statistic::of("x", "m", &[f64::NAN, 1.0, 4.0, f64::NAN, 1.0]);
        assert_eq!((s.count, s.min, s.max, s.mean), (3, Some(1.0), Some(4.0), Some(2.0)));
        let none = Statistic::of("x", "m", &[f64::NAN]);
        assert_eq!((none.count, none.min, none.mean), (0, None, None));
    }
}
