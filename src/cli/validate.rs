//! `mmxrt validate`: compares what the program computes with independent numbers.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use mmxrt::formats::{ephemeris, obj};
use mmxrt::study::validate::{self, By, Files, Row, Verdict};
use mmxrt::{Result, formats};

use super::Outcome;
use super::console::Console;

/// Longest file of cases that is read, bytes.
const LIMIT: u64 = 64 << 20;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// File of cases, by group and inputs, to run instead of the built-in ones; unknown cases are SKIPPED and counted
    #[arg(long, value_name = "FILE")]
    oracles: Option<PathBuf>,
    /// Folder of the files that cases name (kernels, orbits), two levels deep. Default: that of the file of cases
    #[arg(long, value_name = "FOLDER", requires = "oracles")]
    data: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let rows = match &arguments.oracles {
        None => validate::closed_forms()?,
        Some(path) => {
            let (text, _) = formats::text(path, LIMIT)?;
            let beside = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let folder = arguments.data.as_deref().unwrap_or(beside);
            let kernels = |names: &[&str]| ephemeris::of_names(folder, names);
            let shapes = |name: &str| Some(obj::read(&formats::file_named(folder, name)?).ok()?.mesh());
            validate::oracles(&text, path, Some(Files { kernels: &kernels, shapes: &shapes }))?
        }
    };
    let count = |verdict| validate::count(&rows, verdict);
    let (passed, failed, skipped) = (count(Verdict::Pass), count(Verdict::Fail), count(Verdict::Skipped));
    let simulated = validate::count_simulated(&rows);
    let json = serde_json::json!({
        "passed": passed,
        "passed_as_simulate_computes": simulated,
        "failed": failed,
        "skipped": skipped,
        "rows": rows,
    });
    let text = format!(
        "{}{simulated} of those that pass are computed as `simulate` does; {} check a reference only\n\
         {passed} passed, {failed} failed, {skipped} skipped",
        table(&rows),
        passed - simulated
    );
    console.result(&text, &json)?;
    Ok(if failed == 0 { Outcome::Done } else { Outcome::Failed })
}

fn table(rows: &[Row]) -> String {
    let width = |text: fn(&Row) -> &str| rows.iter().map(|row| text(row).chars().count()).max().unwrap_or(0);
    let (group, name, tolerance) = (width(|r| &r.group), width(|r| &r.name), width(|r| &r.tolerance));
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{v:e}"));
    let mut text = String::new();
    for row in rows {
        let verdict = match row.verdict {
            Verdict::Pass => "PASS",
            Verdict::Fail => "FAIL",
            Verdict::Skipped => "SKIPPED",
        };
        let by = match row.by {
            Some(By::Simulate) => "simulate",
            Some(By::Reference) => "reference",
            None => "-",
        };
        let (found, expected) = (number(row.got), number(row.expected));
        let _ = writeln!(
            text,
            "{verdict:7}  {by:9}  {:group$}  {:name$}  {found:>24}  expected {expected:>24}  {:tolerance$}  {}  [{}]",
            row.group, row.name, row.tolerance, row.unit, row.source
        );
    }
    text
}
