//! `mmxrt solve`: a scene becomes a facet table.

use std::path::PathBuf;

use mmxrt::Result;
use mmxrt::job::{self, TableFiles, Towards};

use super::console::Console;
use super::plan::RequestArguments;
use super::scene::SceneArguments;
use super::{Outcome, product};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    #[command(flatten)]
    request: RequestArguments,
    /// The table to write
    #[arg(long, short, value_name = "TABLE.npz")]
    output: PathBuf,
    /// Also write what each facet sends towards an observer in each band, to TABLE_radiance.npz: `camera`, the scene's own; `at:X,Y,Z`, a place in the
    /// body-fixed frame, m; or `towards:X,Y,Z`, a direction in it
    #[arg(long, value_name = "OBSERVER", allow_hyphen_values = true)]
    radiance: Option<Towards>,
    /// Replace existing files
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle(&arguments.output, console)?;
    super::settle_input(&arguments.scene.scene, console)?;
    let files = TableFiles::stage(&arguments.output, arguments.radiance, arguments.force)?;
    let mut subject = arguments.scene.open(console)?;
    product::say_defaults(&subject, console);
    let tell = |warnings: &[String]| warnings.iter().for_each(|warning| console.note(&format!("warning: {warning}")));
    tell(&subject.warnings);
    tell(subject.one_moment().as_slice());
    let told = subject.warnings.len();
    let table = job::solve(&mut subject, &arguments.request.request(), files, &watch)?;
    tell(&subject.warnings[told..]);
    let (path, facets) = (arguments.output.display().to_string(), table.facets());
    let defaults: Vec<String> = subject.defaults.iter().map(ToString::to_string).collect();
    let radiance = arguments.radiance.map(|_| job::radiance_path(&arguments.output).display().to_string());
    let json = serde_json::json!({
        "table": path, "radiance": radiance, "facets": facets, "defaults": defaults, "warnings": subject.warnings,
    });
    let also = radiance.map_or_else(String::new, |radiance| format!(", and their radiance in {radiance}"));
    console.done(&format!("{path}: {facets} facets{also}"), &json);
    Ok(Outcome::Done)
}
