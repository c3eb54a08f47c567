//! The command line: parses, calls the library, writes. Nothing is computed here.

mod campaign;
mod chart;
pub(crate) mod console;
mod convert;
mod coregister;
pub(crate) mod dry_run;
mod inspect;
mod instrument;
pub(crate) mod integrate;
mod landscape;
mod locate;
mod new;
mod plan;
pub(crate) mod product;
mod scene;
mod shell;
mod simulate;
mod solve;
mod surface;
mod validate;
mod view;

use std::ffi::OsString;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::{Parser, Subcommand};
use mmxrt::formats::folder;
use mmxrt::{Error, Location, Problem};

use console::Console;

/// What a space camera sees of a small body: exact facet-to-pixel hyperspectral image simulation.
///
/// Exit codes: 0 done; 1 bad input, failed I/O, a failed acquisition of a `campaign` (with `--shard`, of that shard), a failed case of `validate`, an error found by `convert --check`, a difference found by `convert --diff`, or Ctrl-C;
/// 2 usage; 3 a loss under `convert --strict`. Unless the code is 0, nothing new is left under the name of the output.
#[derive(Parser)]
#[command(name = "mmxrt", version)]
struct Cli {
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Args)]
#[command(next_help_heading = "Options of all commands")]
struct Global {
    /// Number of threads; by default all cores. Products do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print nothing but errors
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Report on standard error what is being done
    #[arg(long, short, global = true, conflicts_with = "quiet")]
    verbose: bool,
    /// Print results (standard output) and errors (standard error) as JSON
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Subcommand)]
enum Command {
    /// Write a folder to begin with: a commented scene that runs
    New(new::Arguments),
    /// Turn a scene into a radiance cube, backplanes, pictures and a report (`inspect SCENE` is a dry run)
    Simulate(simulate::Arguments),
    /// Compute what light and heat reach each facet of a scene, as a table
    Solve(solve::Arguments),
    /// Show which effects a simulation of a scene would model, which it would leave out, and what it would take
    Plan(plan::Arguments),
    /// Turn a scene and its facet table, or radiance maps, into the products of `simulate`
    Integrate(integrate::Arguments),
    /// Make of a radiance cube what an instrument would: blur, noise, and numbers that are sent
    Instrument(instrument::Arguments),
    /// Make many acquisitions of a scene, and a record of what of the surface they see
    Campaign(campaign::Arguments),
    /// Say where on the ground pixels look, and in which pixels points of the ground lie
    Locate(locate::Arguments),
    /// Match windows between two bands of a tunable filter's product, and say how far off the matches are
    Coregister(coregister::Arguments),
    /// Generate a landscape from a recipe
    Landscape(landscape::Arguments),
    /// Convert between formats: scenes, meshes, spectra, images, and inputs of DART
    Convert(convert::Arguments),
    /// Show what a file holds; for a scene also what simulating it would take, and its warnings
    Inspect(inspect::Arguments),
    /// Write a page for a browser that shows a product, an image, a campaign's or chart's folder, or spectra
    View(view::Arguments),
    /// Compare ways to make the image of a scene: error against CPU time
    Chart(chart::Arguments),
    /// Run the closed-form test cases and print the results
    Validate(validate::Arguments),
    /// Print a script by which a shell completes commands and options
    Completions(shell::CompletionArguments),
    /// Write the manual pages
    Man(shell::ManArguments),
}

/// How a command ended without an error.
pub(crate) enum Outcome {
    Done,
    /// It ran, but a check failed.
    Failed,
    /// Something would have been lost, which was forbidden.
    Lost,
}

/// Runs the command line, of which the first argument is the program's name, and gives its exit code.
pub(crate) fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // If neither output can be written, the exit code still reports the failure.
            let _ = error.print();
            return u8::try_from(error.exit_code()).unwrap_or(1);
        }
    };
    let console = Console::new(cli.global.quiet, cli.global.verbose, cli.global.json);
    match start(&cli.global, &console).and_then(|()| dispatch(cli.command, &console)) {
        Ok(Outcome::Done) => 0,
        Ok(Outcome::Failed) => 1,
        Ok(Outcome::Lost) => 3,
        Err(error) => {
            console.error(&error);
            1
        }
    }
}

fn start(global: &Global, console: &Console) -> mmxrt::Result<()> {
    let cannot = |what: &str, why: String| Error::invalid(Location::item(what), why);
    if global.verbose {
        // Only fails if another subscriber was set before; none was.
        let _ = tracing_subscriber::fmt()
            .with_writer(std::io::stderr)
            .with_ansi(std::io::stderr().is_terminal())
            .with_max_level(tracing::Level::DEBUG)
            .try_init();
    }
    console.catch_interrupt().map_err(|e| cannot("Ctrl-C", e.to_string()))?;
    if let Some(threads) = global.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(|e| cannot("--threads", e.to_string()))?;
    }
    Ok(())
}

fn dispatch(command: Command, console: &Console) -> mmxrt::Result<Outcome> {
    match command {
        Command::New(arguments) => new::run(&arguments, console),
        Command::Simulate(arguments) => simulate::run(&arguments, console),
        Command::Solve(arguments) => solve::run(&arguments, console),
        Command::Plan(arguments) => plan::run(&arguments, console),
        Command::Integrate(arguments) => integrate::run(&arguments, console),
        Command::Instrument(arguments) => instrument::run(&arguments, console),
        Command::Campaign(arguments) => campaign::run(&arguments, console),
        Command::Locate(arguments) => locate::run(&arguments, console),
        Command::Coregister(arguments) => coregister::run(&arguments, console),
        Command::Landscape(arguments) => landscape::run(&arguments, console),
        Command::Convert(arguments) => convert::run(&arguments, console),
        Command::Inspect(arguments) => inspect::run(&arguments, console),
        Command::View(arguments) => view::run(&arguments, console),
        Command::Chart(arguments) => chart::run(&arguments, console),
        Command::Validate(arguments) => validate::run(&arguments, console),
        Command::Completions(arguments) => shell::complete(&arguments, console),
        Command::Man(arguments) => shell::man(&arguments, console),
    }
}

/// Finishes or removes what killed runs have left behind of an output, and says so.
fn settle(output: &Path, console: &Console) -> mmxrt::Result<()> {
    folder::settle(output, true)?.iter().for_each(|said| console.note(said));
    Ok(())
}

/// Finishes what a killed run had begun to move into the place of an input, and says so.
fn settle_input(input: &Path, console: &Console) -> mmxrt::Result<()> {
    folder::settle(input, false)?.iter().for_each(|said| console.note(said));
    Ok(())
}

/// A location's file as JSON; a name that is not UTF-8 is shown as nearly as JSON can.
fn file_json(file: Option<&PathBuf>) -> serde_json::Value {
    file.map(|path| path.display().to_string()).into()
}

/// An error as the JSON object that `--json` prints.
fn error_json(error: &Error) -> serde_json::Value {
    use serde_json::json;
    let problem = |p: &Problem| {
        json!({
            "file": file_json(p.at.file.as_ref()), "line": p.at.line, "column": p.at.column, "item": p.at.item,
            "message": p.message, "help": p.help,
        })
    };
    let kind = match error {
        Error::Io { .. } => "io",
        Error::Syntax { .. } => "syntax",
        Error::Invalid(_) => "invalid",
        Error::Unsupported { .. } => "unsupported",
        Error::Interrupted => "interrupted",
    };
    let problems: Vec<_> = error.problems().iter().map(problem).collect();
    json!({ "error": { "kind": kind, "message": error.to_string(), "problems": problems } })
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        super::Cli::command().debug_assert();
    }
}
