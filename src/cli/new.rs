//! `mmxrt new`: a folder to begin with.

use std::path::PathBuf;

use clap::ValueEnum;
use mmxrt::Result;
use mmxrt::job::{self, Template};

use super::Outcome;
use super::console::Console;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The folder to create
    folder: PathBuf,
    /// What is in it
    #[arg(long, value_enum, default_value = "site")]
    template: TemplateName,
}

#[derive(Clone, Copy, ValueEnum)]
enum TemplateName {
    /// A site on Phobos, from a recipe
    Site,
    /// A whole body, from a shape
    Body,
    /// A scene for DART
    Dart,
    /// Radiance from elsewhere, as a sensor sees it
    Map,
    /// Many looks from an orbit
    Campaign,
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    super::settle(&arguments.folder, console)?;
    let template = match arguments.template {
        TemplateName::Site => Template::Site,
        TemplateName::Body => Template::Body,
        TemplateName::Dart => Template::Dart,
        TemplateName::Map => Template::Map,
        TemplateName::Campaign => Template::Campaign,
    };
    let files = job::new(template, &arguments.folder)?;
    let (folder, next) = (arguments.folder.display().to_string(), template.first_command());
    let text = format!("{folder}: {}\nnext: cd {folder} && {next}", files.join(", "));
    console.done(&text, &serde_json::json!({ "folder": folder, "files": files, "next": next }));
    Ok(Outcome::Done)
}
