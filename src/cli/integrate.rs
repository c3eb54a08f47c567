//! `mmxrt integrate`: a scene, and the radiance that its facets send, become a product folder.

use std::path::PathBuf;

use clap::ValueEnum;
use mmxrt::Result;
use mmxrt::formats::{Subject, radiance_map};
use mmxrt::geometry::Texels;
use mmxrt::integrate::Choice;
use mmxrt::job::{self, Radiance};
use mmxrt::study::Fill;

use super::Outcome;
use super::console::Console;
use super::product::ProductArguments;

#[derive(clap::Args)]
#[group(skip)]
#[command(group = clap::ArgGroup::new("source").args(["table", "radiance"]).required(true).multiple(true))]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// What its facets receive, from `mmxrt solve`; one table serves all cameras and bands, while Bond albedos stay
    #[arg(long, value_name = "TABLE.npz")]
    table: Option<PathBuf>,
    /// Radiance from elsewhere: a raster with its `.map.toml`, a table of facets, an output of DART. Maps joined by `+` add up, each
    /// times a number after `*`; given several times, they are maps of other views of the same
    #[arg(long, value_name = "MAP[+MAP*W]...")]
    radiance: Vec<String>,
    /// Which of maps of several views serve a facet
    #[arg(long, value_enum, default_value = "nearest", requires = "radiance")]
    views: Views,
    /// What a map is between the centres of its texels
    #[arg(long, value_enum, default_value = "nearest", requires = "radiance")]
    texels: Between,
    /// What is shown where no map knows the radiance: `error` if that is over 0.1 % of what is seen, `solve` to fill it from the
    /// scene's own sources, `nan` to mark pixels of which nothing is known, or a radiance in W m-2 sr-1 um-1
    #[arg(long, value_name = "error|solve|nan|VALUE", default_value = "error", value_parser = fill, requires = "radiance")]
    unknown: Fill,
    #[command(flatten)]
    product: ProductArguments,
}

#[derive(Clone, Copy, ValueEnum)]
enum Views {
    /// The one from the nearest direction
    Nearest,
    /// All of them, weighted by one over the squared angle
    Interpolated,
}

#[derive(Clone, Copy, ValueEnum)]
enum Between {
    /// A texel has one value
    Nearest,
    /// Values vary linearly from centre to centre
    Bilinear,
}

fn fill(text: &str) -> std::result::Result<Fill, String> {
    match text {
        "error" => Ok(Fill::default()),
        "solve" => Ok(Fill::Solved),
        "nan" | "NaN" => Ok(Fill::Nan),
        _ => match text.parse::<f64>() {
            Ok(value) if value >= 0.0 && value.is_finite() => Ok(Fill::Value(value)),
            _ => Err("give `error`, `solve`, `nan`, or a radiance from 0".into()),
        },
    }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    let maps: Vec<_> = arguments.radiance.iter().map(|text| radiance_map::summands(text)).collect::<Result<_>>()?;
    let paths = maps.iter().flatten().map(|summand| &summand.path);
    for input in arguments.table.iter().chain([&arguments.scene]).chain(paths) {
        super::settle_input(input, console)?;
    }
    let folder = arguments.product.stage(false, false, console)?;
    let subject = Subject::open(&arguments.scene, &watch)?;
    let radiance = Radiance {
        table: arguments.table.clone(),
        maps,
        choice: match arguments.views {
            Views::Nearest => Choice::Nearest,
            Views::Interpolated => Choice::Interpolated,
        },
        texels: match arguments.texels {
            Between::Nearest => Texels::Nearest,
            Between::Bilinear => Texels::Bilinear,
        },
        fill: arguments.unknown,
    };
    let written = job::integrate(subject, &radiance, folder, || console.run("integrate"), &watch)?;
    arguments.product.say(&written, console);
    Ok(Outcome::Done)
}
