//! `mmxrt coregister`: how well a plain matcher lays the bands of a moving product on each other.

use std::path::PathBuf;

use mmxrt::study::coregister::{Quality, Windows};
use mmxrt::{Result, job};
use serde_json::json;

use super::Outcome;
use super::console::Console;
use super::dry_run::short;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The product folder of a tunable filter
    product: PathBuf,
    /// Two bands, counted from 1: windows of the first are sought in the second
    #[arg(long, value_name = "A,B", value_parser = pair)]
    bands: [u32; 2],
    /// Pixels along a window's side, an odd number
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = odd)]
    window: u32,
    /// Search radius, pixels
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=255))]
    search: u32,
    /// Spacing of windows, pixels; default: a window's side
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    step: Option<u32>,
    /// Write all matches and true shifts as a table
    #[arg(long, short, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// Replace that file if it is there
    #[arg(long)]
    force: bool,
}

fn pair(text: &str) -> std::result::Result<[u32; 2], String> {
    let bands: Option<Vec<u32>> = text.split(',').map(|band| band.trim().parse().ok().filter(|n| *n > 0)).collect();
    bands.and_then(|bands| bands.try_into().ok()).ok_or_else(|| "give two bands, counted from 1, e.g. 1,300".to_owned())
}

fn odd(text: &str) -> std::result::Result<u32, String> {
    let side = text.parse().ok().filter(|side| (3..=255).contains(side) && side % 2 == 1);
    side.ok_or_else(|| "give an odd number from 3 to 255: a window has a pixel in its middle".to_owned())
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle_input(&arguments.product, console)?;
    if let Some(target) = &arguments.output {
        super::settle(target, console)?;
    }
    let half = (arguments.window / 2) as usize;
    let step = arguments.step.map_or(2 * half + 1, |step| step as usize);
    let windows = Windows { half, search: arguments.search as usize, step };
    let output = arguments.output.as_deref().map(|target| (target, arguments.force));
    let bands = arguments.bands.map(|band| band as usize - 1);
    let quality = job::coregister(&arguments.product, bands, windows, output, &watch)?;
    let Quality { windows, matched, median_px, p95_px, within_half } = quality;
    let text = if matched == 0 {
        format!("none of {windows} windows matched: nothing in them stands out, or it moved farther than `--search`")
    } else {
        format!(
            "{matched} of {windows} windows matched; error {} pixels (median), {} (95th percentile); {} % within half a pixel",
            short(median_px),
            short(p95_px),
            short(100.0 * within_half)
        )
    };
    match &arguments.output {
        Some(target) => console.done(&format!("{}: {text}", target.display()), &json!(quality)),
        None => console.result(&text, &json!(quality))?,
    }
    Ok(Outcome::Done)
}
