//! `mmxrt validate`: the closed-form cases, and what passes.

use std::fmt::Write as _;
use std::path::PathBuf;

use mmxrt::Result;

use super::console::Console;
use super::{Outcome, seams};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Cases of a file, by group and inputs, instead of the built-in ones
    #[arg(long, value_name = "FILE")]
    oracles: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let cases = seams::validate(arguments.oracles.as_deref())?;
    let mut text = String::new();
    let verdict = |passed: Option<bool>| match passed {
        Some(true) => "PASS",
        Some(false) => "FAIL",
        None => "SKIPPED",
    };
    for case in &cases {
        let (expected, found, tolerance) = (case.expected, case.found, case.tolerance);
        let _ = write!(text, "{:8}{:40}", verdict(case.passed), case.name);
        let _ = writeln!(text, " found {found:<24e} expected {expected:<24e} +- {tolerance:e}  {}", case.source);
    }
    let count = |passed| cases.iter().filter(|c| c.passed == passed).count();
    let (passed, failed, skipped) = (count(Some(true)), count(Some(false)), count(None));
    let _ = writeln!(text, "{passed} passed, {failed} failed, {skipped} skipped");
    let list: Vec<serde_json::Value> = cases
        .iter()
        .map(|c| {
            serde_json::json!({
                "name": c.name, "verdict": verdict(c.passed), "found": c.found,
                "expected": c.expected, "tolerance": c.tolerance, "source": c.source,
            })
        })
        .collect();
    let json = serde_json::json!({ "passed": passed, "failed": failed, "skipped": skipped, "cases": list });
    console.result(&text, &json)?;
    Ok(if failed == 0 { Outcome::Done } else { Outcome::Failed })
}
