//! `mmxrt view`: a page for a browser.

use std::path::PathBuf;

use mmxrt::{Result, job};
use serde_json::json;

use super::Outcome;
use super::console::Console;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A product folder, the folder of a campaign or a chart, an image of any format that is read, or spectra (.sli, .csv)
    input: PathBuf,
    /// The page; by default beside the input, and named after it, with .html
    #[arg(long, short, value_name = "PAGE.html")]
    output: Option<PathBuf>,
    /// Megabytes of numbers in the page: images that take more are reduced, and the page says so. As text they take up to a third more
    #[arg(long, value_name = "MB", default_value_t = 40, value_parser = clap::value_parser!(u64).range(1..=400))]
    budget: u64,
    /// Replace an existing page
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    super::settle_input(&arguments.input, console)?;
    if let Some(target) = &arguments.output {
        super::settle(target, console)?;
    }
    let order = job::PageOrder {
        target: arguments.output.as_deref(),
        bytes: arguments.budget * 1_000_000,
        replace: arguments.force,
    };
    let shown = job::view(&arguments.input, &order, &|progress| console.watch(progress))?;
    let reduced: Vec<String> = shown
        .sides
        .iter()
        .filter(|(_, side)| *side > 1)
        .map(|(of, side)| format!("{of}: one number for {side} x {side} pixels"))
        .collect();
    let reduced = if reduced.is_empty() { String::new() } else { format!("; {}", reduced.join("; ")) };
    let page = shown.page.display().to_string();
    let megabytes = shown.bytes.div_ceil(100_000);
    let text = format!("{page}: {}.{} MB{reduced}", megabytes / 10, megabytes % 10);
    let sides: serde_json::Map<_, _> = shown.sides.into_iter().map(|(of, side)| (of, json!(side))).collect();
    console.done(&text, &json!({ "page": page, "kind": shown.kind, "bytes": shown.bytes, "pixels_of_a_cell": sides }));
    Ok(Outcome::Done)
}
