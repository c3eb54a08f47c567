//! `mmxrt chart`: a scene becomes a chart of error against time, or methods are driven to where they fail.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mmxrt::formats::Subject;
use mmxrt::formats::chart::ChartFolder;
use mmxrt::{Error, Location, Result, job};

use super::Outcome;
use super::console::Console;
use super::scene::ReadingArguments;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    #[arg(required_unless_present = "stability", conflicts_with = "stability")]
    scene: Option<PathBuf>,
    /// The folder to create
    #[arg(long, short, value_name = "FOLDER")]
    output: PathBuf,
    /// Replace an existing folder of charts
    #[arg(long)]
    force: bool,
    /// Also render with Mitsuba 3, by this Python, which has it (`pip install mitsuba`)
    #[arg(long, value_name = "PYTHON", conflicts_with = "stability")]
    mitsuba: Option<PathBuf>,
    /// Instead of a scene: drive each method to where it fails, and tell where that is
    #[arg(long, conflicts_with_all = ["set", "cache"])]
    stability: bool,
    #[command(flatten)]
    reading: ReadingArguments,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    let Some(scene) = &arguments.scene else { return stability(arguments, console) };
    super::settle_input(scene, console)?;
    super::settle(&arguments.output, console)?;
    let folder = ChartFolder::stage(&arguments.output, arguments.force)?;
    let subject = Subject::open_with(scene, &arguments.reading.reading(console)?, &watch)?;
    subject.one_moment().iter().for_each(|said| console.note(&format!("warning: {said}")));
    let threads = rayon::current_num_threads();
    let timed = format!("CPU times of this machine, {threads} {}.", if threads == 1 { "thread" } else { "threads" });
    let render = |path: &Path| arguments.mitsuba.as_deref().map_or(Ok(()), |python| render(python, path, console));
    let mitsuba: Option<job::Render> = arguments.mitsuba.as_ref().map(|_| &render as job::Render);
    let (chart, files) = job::chart(&subject, folder, &|| console.cpu_s(), &timed, mitsuba, &watch)?;
    chart.notes.iter().for_each(|note| console.note(&format!("note: {note}")));
    let advice: Vec<String> = chart.advice().into_iter().map(|advice| advice.said).collect();
    let output = arguments.output.display().to_string();
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let text = format!("{output}: {}\n{}", names.join(", "), advice.join("\n"));
    let json = serde_json::json!({ "chart": output, "files": names, "advice": advice, "notes": chart.notes });
    console.done(&text, &json);
    Ok(Outcome::Done)
}

/// Runs the script that was exported, and waits for it.
fn render(python: &Path, folder: &Path, console: &Console) -> Result<()> {
    let failed = |why: String| Err(Error::invalid(Location::file(python), why));
    let script = folder.join("render.py");
    match Command::new(python).arg(&script).arg(folder).output() {
        Err(error) => failed(format!("does not start: {error}")),
        Ok(Output { status, stdout, .. }) if status.success() => {
            String::from_utf8_lossy(&stdout).lines().for_each(|line| console.note(&format!("mitsuba: {line}")));
            Ok(())
        }
        Ok(Output { stderr, .. }) => {
            let said = String::from_utf8_lossy(&stderr).lines().last().unwrap_or_default().to_owned();
            failed(format!("did not render: {said}"))
        }
    }
}

fn stability(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    super::settle(&arguments.output, console)?;
    let folder = ChartFolder::stage(&arguments.output, arguments.force)?;
    let (hazards, files) = job::stability(folder, &|progress| console.watch(progress))?;
    let output = arguments.output.display().to_string();
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    let sweeps = hazards.iter().map(|hazard| hazard.sweeps.len()).sum::<usize>();
    let text = format!("{output}: {}\n{} hazards, {sweeps} rows", names.join(", "), hazards.len());
    console.done(&text, &serde_json::json!({ "stability": output, "files": names, "rows": sweeps }));
    Ok(Outcome::Done)
}
