//! `mmxrt integrate`: a scene and the radiance of its facets become a product folder.

use std::path::PathBuf;

use clap::ValueEnum;
use mmxrt::Result;
use mmxrt::formats::radiance_map;
use mmxrt::geometry::Texels;
use mmxrt::integrate::ViewChoice;
use mmxrt::job::{self, Radiance};
use mmxrt::study::Fill;

use super::Outcome;
use super::console::Console;
use super::product::ProductArguments;
use super::scene::SceneArguments;

#[derive(clap::Args)]
#[group(skip)]
#[command(group = clap::ArgGroup::new("source").args(["table", "radiance"]).required(true).multiple(true))]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// The facet table from `mmxrt solve`; one table serves all cameras and bands, as long as the Bond albedos stay the same
    #[arg(long, value_name = "TABLE.npz")]
    table: Option<PathBuf>,
    /// Radiance from elsewhere: a raster with its `.map.toml`, a table of facets, or DART output. Maps joined by `+` add up, each
    /// scaled by a factor after `*`; repeat the option for maps of the same scene from other views
    #[arg(long, value_name = "MAP[+MAP*W]...")]
    radiance: Vec<String>,
    /// Which map to use where several views see a facet
    #[arg(long, value_enum, default_value = "nearest", requires = "radiance")]
    views: Views,
    /// How to interpolate between texel centres
    #[arg(long, value_enum, default_value = "nearest", requires = "radiance")]
    texels: Between,
    /// What to do where no map knows the radiance: `error` fails if that is over 0.1 % of what is seen, `solve` fills it from the
    /// scene's own sources, `nan` marks pixels about which nothing is known, or give a radiance in W m-2 sr-1 um-1
    #[arg(long, value_name = "error|solve|nan|VALUE", default_value = "error", value_parser = fill, requires = "radiance")]
    unknown: Fill,
    #[command(flatten)]
    product: ProductArguments,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Views {
    /// The map from the nearest direction
    Nearest,
    /// All maps, weighted by one over the squared angle
    Interpolated,
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Between {
    /// A texel has one value
    Nearest,
    /// Values vary linearly from centre to centre
    Bilinear,
}

impl From<Views> for ViewChoice {
    fn from(name: Views) -> Self {
        match name {
            Views::Nearest => ViewChoice::Nearest,
            Views::Interpolated => ViewChoice::Interpolated,
        }
    }
}

impl From<Between> for Texels {
    fn from(name: Between) -> Self {
        match name {
            Between::Nearest => Texels::Nearest,
            Between::Bilinear => Texels::Bilinear,
        }
    }
}

/// What to do where no map knows the radiance.
pub(crate) fn fill(text: &str) -> std::result::Result<Fill, String> {
    match text {
        "error" => Ok(Fill::default()),
        "solve" => Ok(Fill::Solved),
        "nan" | "NaN" => Ok(Fill::Nan),
        _ => match text.parse::<f64>() {
            Ok(value) if value >= 0.0 && value.is_finite() => Ok(Fill::Value(value)),
            _ => Err("give `error`, `solve`, `nan`, or a radiance of at least 0".into()),
        },
    }
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    let maps: Vec<_> = arguments.radiance.iter().map(|text| radiance_map::summands(text)).collect::<Result<_>>()?;
    let paths = maps.iter().flatten().map(|summand| &summand.path);
    for input in arguments.table.iter().chain([&arguments.scene.scene]).chain(paths) {
        super::settle_input(input, console)?;
    }
    let folder = arguments.product.stage(false, false, console)?;
    let subject = arguments.scene.open(console)?;
    let radiance = Radiance {
        table: arguments.table.clone(),
        maps,
        choice: arguments.views.into(),
        texels: arguments.texels.into(),
        fill: arguments.unknown,
    };
    let written = job::integrate(subject, &radiance, folder, || console.run("integrate"), &watch)?;
    arguments.product.say(&written, console);
    Ok(Outcome::Done)
}
