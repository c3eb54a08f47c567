//! `mmxrt instrument`: a cube of radiance becomes what an instrument would have made of it.

use std::path::PathBuf;

use mmxrt::Result;
use mmxrt::formats::instrument_toml;
use mmxrt::job::{self, Asked};
use serde_json::json;

use super::Outcome;
use super::console::Console;
use super::product::FormatArguments;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The cube: radiance in W m-2 sr-1 um-1, with wavelengths
    cube: PathBuf,
    /// The instrument: a TOML file, of the keys in docs/reference/instrument.md
    #[arg(long, value_name = "FILE.toml")]
    instrument: PathBuf,
    /// The folder to create
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    /// Replace an existing product folder
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    format: FormatArguments,
    /// Blur pixel means, which lack subpixel detail: an approximation
    #[arg(long)]
    approximate: bool,
    /// The lines share detector elements, as for a push-broom
    #[arg(long)]
    by_line: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle(&arguments.output, console)?;
    super::settle_input(&arguments.cube, console)?;
    let instrument = instrument_toml::read(&arguments.instrument, &watch)?;
    let Arguments { cube, approximate, by_line, .. } = arguments;
    let (formats, exr) = arguments.format.formats();
    let (cube, approximate, by_line) = (cube.clone(), *approximate, *by_line);
    let asked = Asked { cube, instrument, approximate, by_line, formats, exr };
    let target = (arguments.output.as_path(), arguments.force);
    let report = job::instrument(&asked, target, || console.run("instrument"), &watch)?;
    report.warnings.iter().for_each(|warning| console.note(&format!("warning: {warning}")));
    let output = arguments.output.display().to_string();
    let bands = report.signal.as_ref().map(|signal| signal.bands.as_slice()).unwrap_or_default();
    let text = match (bands.iter().map(|b| b.snr_mean).reduce(f64::min), bands.iter().map(|b| b.saturated).sum::<u64>())
    {
        (Some(least), saturated) => {
            format!("{output}: signal over noise of the mean is at least {least:.1}; {saturated} values are saturated")
        }
        (None, _) => output.clone(),
    };
    console.done(&text, &json!({ "product": output, "signal": report.signal, "warnings": report.warnings }));
    Ok(Outcome::Done)
}
