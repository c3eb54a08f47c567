//! `mmxrt completions` and `mmxrt man`: what shells and packages want of a command, made of its own arguments.

use std::path::PathBuf;

use clap::CommandFactory;
use clap_complete::Shell;
use mmxrt::error::{Error, Location};
use mmxrt::{Result, job};

use super::console::Console;
use super::{Cli, Outcome};

#[derive(clap::Args)]
pub(crate) struct CompletionArguments {
    /// The shell whose script is printed
    #[arg(value_enum)]
    shell: Shell,
}

#[derive(clap::Args)]
pub(crate) struct ManArguments {
    /// The folder to create, with a page for each command
    folder: PathBuf,
}

pub(crate) fn complete(arguments: &CompletionArguments, console: &Console) -> Result<Outcome> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "mmxrt", &mut script);
    let script = String::from_utf8_lossy(&script).into_owned();
    console.result(&script, &serde_json::json!({ "shell": arguments.shell.to_string(), "script": script }))?;
    Ok(Outcome::Done)
}

pub(crate) fn man(arguments: &ManArguments, console: &Console) -> Result<Outcome> {
    super::settle(&arguments.folder, console)?;
    let mut main = Cli::command();
    main.build();
    let others = main.get_subcommands().filter(|command| command.get_name() != "help");
    let commands = std::iter::once(("mmxrt.1".to_owned(), &main))
        .chain(others.map(|command| (format!("mmxrt-{}.1", command.get_name()), command)));
    let mut pages = Vec::new();
    for (name, command) in commands {
        let mut page = Vec::new();
        let rendered = clap_mangen::Man::new(command.clone()).render(&mut page);
        rendered.map_err(|e| Error::invalid(Location::item(&name), e.to_string()))?;
        pages.push((name, page));
    }
    job::write_pages(&arguments.folder, &pages)?;
    let folder = arguments.folder.display().to_string();
    let json = serde_json::json!({ "folder": folder, "pages": pages.len() });
    console.done(&format!("{folder}: {} pages", pages.len()), &json);
    Ok(Outcome::Done)
}
