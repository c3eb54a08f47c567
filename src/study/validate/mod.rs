//! Checks against numbers from outside: oracles, each with its inputs, expected value, tolerance and source.
//!
//! A file of oracles is JSON: `{"oracles": [{"group", "name", "inputs", "expected", "unit", "tol_rel", "tol_abs", "tolerance", "source"}]}`.
//! `expected` is a number, a fraction as text ("2663/6800"), or lists and objects of them. What an oracle asks for is
//! given by its group, its name up to the first `(` or `=`, and its inputs; an input that is missing is looked for in the name ("rho=0.07").

mod closed_forms;
mod ephemerides;
mod flight;
mod kernels;
mod patch;
mod reflectance;
mod scene_cases;
mod shapes;
mod values;

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

pub use kernels::Kernels;
pub use shapes::Shapes;

use crate::error::{Error, Location, Problem, Result};

/// How a check ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Verdict {
    /// Within the tolerance.
    Pass,
    /// Not within it.
    Fail,
    /// Not something this version can compute.
    Skipped,
}

/// What computed a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum By {
    /// The functions that `simulate` goes through for the same thing.
    Simulate,
    /// A closed form, or a slower method, that `simulate` does not use: it confirms that the expected number is right,
    /// and nothing of `simulate`.
    Reference,
}

/// One number that was checked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Group of the oracle.
    pub group: String,
    /// Name of the oracle; of one with several quantities, `name/quantity` or `name[row][column]`.
    pub name: String,
    /// The number it should be; none where an oracle of several quantities is skipped as a whole.
    pub expected: Option<f64>,
    /// The number it is.
    pub got: Option<f64>,
    /// How far apart they may be, as in "1e-12 rel", "1e-8 abs", "factor 10" (of an oracle that gives an order of magnitude only).
    pub tolerance: String,
    /// Pass, fail or skipped.
    pub verdict: Verdict,
    /// What computed `got`; none if nothing did.
    pub by: Option<By>,
    /// Unit of the numbers.
    pub unit: String,
    /// Where the expected number comes from.
    pub source: String,
}

/// How many rows passed by the functions of `simulate`.
pub fn count_simulated(rows: &[Row]) -> usize {
    rows.iter().filter(|row| row.verdict == Verdict::Pass && row.by == Some(By::Simulate)).count()
}

/// How many rows have a verdict.
pub fn count(rows: &[Row], verdict: Verdict) -> usize {
    rows.iter().filter(|row| row.verdict == verdict).count()
}

/// The built-in checks: those of `tests/data/oracles.json`, and whole scenes that have a closed form.
///
/// # Errors
/// None in practice: the file is part of the program.
pub fn closed_forms() -> Result<Vec<Row>> {
    let mut rows =
        oracles(include_str!("../../../tests/data/oracles.json"), Path::new("tests/data/oracles.json"), None)?;
    rows.extend(scene_cases::rows()?);
    Ok(rows)
}

/// What finds the files that oracles name.
#[derive(Clone, Copy)]
pub struct Files<'a> {
    /// Kernels and orbits.
    pub kernels: &'a Kernels<'a>,
    /// Meshes.
    pub shapes: &'a Shapes<'a>,
}

/// Runs a file of oracles, given its text; `path` is what messages call it. `files` finds those that oracles
/// name; those without are skipped.
///
/// # Errors
/// [`Error::Syntax`] if the text is not JSON; [`Error::Invalid`] with every oracle that lacks a group, name or expected value.
pub fn oracles(text: &str, path: &Path, files: Option<Files<'_>>) -> Result<Vec<Row>> {
    let file: Value = serde_json::from_str(text).map_err(|error| {
        let at = Location { column: Some(error.column()), ..Location::line(path, error.line()) };
        Error::syntax(at, format!("not JSON: {error}"))
    })?;
    let Some(list) = file.get("oracles").and_then(Value::as_array).filter(|list| !list.is_empty()) else {
        return Err(Error::invalid(Location::file(path), "holds no oracles: a list \"oracles\" is expected"));
    };
    let (mut rows, mut problems) = (Vec::new(), Vec::new());
    for (i, record) in list.iter().enumerate() {
        match Oracle::read(record, files) {
            Ok(oracle) => oracle.run(&mut rows),
            Err(message) => {
                problems.push(Problem::new(Location::file(path).with_item(format!("oracles[{i}]")), message));
            }
        }
    }
    if problems.is_empty() { Ok(rows) } else { Err(Error::Invalid(problems)) }
}

/// Tolerance of an expected 0 that comes with a relative tolerance only, where it is an angle: what the arc cosine of a dot product
/// rounded to f64 resolves near 0 (sqrt(2 eps) rad), which is how such zeros were made.
const ZERO_TOLERANCE_DEG: f64 = 1.3e-6;
/// That of other numbers: what rounding of numbers about 1 leaves of a difference.
const ZERO_TOLERANCE: f64 = 4.0 * f64::EPSILON;

/// A number to check against, as its file gives it; [`values`] is this program's answer.
struct Oracle<'a> {
    group: &'a str,
    name: &'a str,
    inputs: &'a Value,
    expected: &'a Value,
    unit: &'a str,
    source: &'a str,
    tol_rel: Option<f64>,
    tol_abs: Option<f64>,
    files: Option<Files<'a>>,
}

impl<'a> Oracle<'a> {
    fn read(record: &'a Value, files: Option<Files<'a>>) -> std::result::Result<Self, String> {
        let text = |key: &str| record.get(key).and_then(Value::as_str);
        let number = |key: &str| record.get(key).and_then(Value::as_f64);
        let needed = |key: &str| text(key).ok_or_else(|| format!("has no text {key:?}"));
        Ok(Oracle {
            group: needed("group")?,
            name: needed("name")?,
            inputs: record.get("inputs").unwrap_or(&Value::Null),
            expected: record.get("expected").ok_or("has no \"expected\"")?,
            unit: text("unit").unwrap_or(""),
            source: text("source").unwrap_or(""),
            tol_rel: number("tol_rel"),
            tol_abs: number("tol_abs"),
            files,
        })
    }

    fn run(&self, rows: &mut Vec<Row>) {
        self.compare(self.name.to_owned(), self.expected, &self.answers(), rows);
    }

    /// A row for each number that is expected and each answer that has it; one that is skipped if none has.
    fn compare(&self, name: String, expected: &Value, answers: &[Answer], rows: &mut Vec<Row>) {
        let of = |part: &dyn Fn(&Value) -> Option<Value>| -> Vec<Answer> {
            answers.iter().filter_map(|a| Some(Answer { value: part(&a.value)?, ..a.clone() })).collect()
        };
        match expected {
            // An unknown case is one row, however many numbers it has.
            Value::Array(_) | Value::Object(_) if answers.is_empty() => rows.push(self.skipped(name, None)),
            Value::Array(list) => {
                for (i, expected) in list.iter().enumerate() {
                    let answers = of(&|value| value.get(i).cloned());
                    self.compare(format!("{name}[{i}]"), expected, &answers, rows);
                }
            }
            Value::Object(map) => {
                for (key, expected) in map {
                    let answers = of(&|value| value.get(key).cloned());
                    self.compare(format!("{name}/{key}"), expected, &answers, rows);
                }
            }
            leaf => {
                let expected = number(leaf);
                let before = rows.len();
                for answer in answers {
                    if let (Some(expected), Some(got)) = (expected, answer.value.as_f64()) {
                        rows.push(self.row(name.clone(), expected, got, answer));
                    }
                }
                if rows.len() == before {
                    rows.push(self.skipped(name, expected));
                }
            }
        }
    }

    fn row(&self, name: String, expected: f64, got: f64, answer: &Answer) -> Row {
        let difference = (got - expected).abs();
        let within = |limit: f64| difference <= limit;
        let (close, tolerance) = match (answer.own_tolerance, self.tol_rel, self.tol_abs) {
            (Some(own), ..) => (within(own), format!("{own:e} abs (its own bound)")),
            (_, None, None) => (expected == got || (0.1..=10.0).contains(&(got / expected)), "factor 10".to_owned()),
            (_, Some(_), None) if expected == 0.0 => {
                let zero = if self.unit.contains("deg") { ZERO_TOLERANCE_DEG } else { ZERO_TOLERANCE };
                (within(zero), format!("{zero:.1e} abs"))
            }
            (_, Some(rel), None) => (within(rel * expected.abs()), format!("{rel:e} rel")),
            (_, None, Some(abs)) => (within(abs), format!("{abs:e} abs")),
            (_, Some(rel), Some(abs)) => {
                (within(rel * expected.abs()) || within(abs), format!("{rel:e} rel or {abs:e} abs"))
            }
        };
        let verdict = if close { Verdict::Pass } else { Verdict::Fail };
        let (expected, got, by) = (Some(expected), Some(got), Some(answer.by));
        Row { expected, got, tolerance, verdict, by, ..self.skipped(name, None) }
    }

    fn skipped(&self, name: String, expected: Option<f64>) -> Row {
        Row {
            group: self.group.to_owned(),
            name,
            expected,
            got: None,
            tolerance: String::new(),
            verdict: Verdict::Skipped,
            by: None,
            unit: self.unit.to_owned(),
            source: self.source.to_owned(),
        }
    }
}

/// This program's answer to an oracle: a number, or lists and objects of them, some of which may be missing.
#[derive(Debug, Clone)]
struct Answer {
    by: By,
    value: Value,
    /// How far off the product may be by its own bound, where that is wider than what the oracle asks for.
    own_tolerance: Option<f64>,
}

/// A number, or a fraction as text.
fn number(value: &Value) -> Option<f64> {
    let text = match value {
        Value::String(text) => text,
        other => return other.as_f64(),
    };
    match text.split_once('/') {
        Some((over, under)) => Some(over.parse::<f64>().ok()? / under.parse::<f64>().ok()?),
        None => text.parse().ok(),
    }
}
