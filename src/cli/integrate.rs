//! `mmxrt integrate`: a scene, and the radiance that its facets send, become a product folder.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mmxrt::formats::report_json::Input;
use mmxrt::formats::{npz, radiance_map};
use mmxrt::geometry::Texels;
use mmxrt::integrate::Choice;
use mmxrt::product::{FacetTable, RadianceMap};
use mmxrt::study::{Fill, MapOptions};
use mmxrt::{Error, Location, Problem, Result, solve, study};

use super::console::Console;
use super::product::{self, Extras, Made, ProductOptions};
use super::scene::Opened;
use super::{Outcome, scene};

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
    product: ProductOptions,
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
    for input in arguments.table.iter().chain([&arguments.scene]) {
        super::settle_input(input, console)?;
    }
    let staged = arguments.product.stage(console)?;
    let mut opened = scene::open(&arguments.scene, &watch)?;
    let table = arguments.table.as_deref().map(|path| table(path, &arguments.scene, &opened)).transpose()?;
    // Files that tables come from: one at most.
    let mut tables_from: Vec<PathBuf> = arguments.table.clone().into_iter().collect();
    if arguments.radiance.is_empty() {
        let Some(table) = table else { return Err(no_radiance()) };
        arguments.product.admit(&staged, &opened, &tables_from, false, Extras::default())?;
        let observation = study::observe(&opened.scene, &table, arguments.product.wanted(), &watch)?;
        let table_from = tables_from.pop();
        let made = Made { opened, table, table_from, observation, maps: None };
        return product::write("integrate", &arguments.product, staged, &made, Extras::default(), console);
    }
    let mut options = MapOptions {
        choice: match arguments.views {
            Views::Nearest => Choice::Nearest,
            Views::Interpolated => Choice::Interpolated,
        },
        texels: match arguments.texels {
            Between::Nearest => Texels::Nearest,
            Between::Bilinear => Texels::Bilinear,
        },
        fill: arguments.unknown,
        add_solved: false,
        footprints: arguments.product.wanted().footprints,
    };
    // Term by term, the maps of all views.
    let mut terms: Vec<Vec<RadianceMap>> = Vec::new();
    // How many terms each view has.
    let mut counts: Vec<usize> = Vec::new();
    let mut tables = table;
    for text in &arguments.radiance {
        let mut term = 0;
        for (path, weight) in summands(text)? {
            super::settle_input(&path, console)?;
            if is_table(&path) {
                if weight != 1.0 || options.add_solved || arguments.table.is_some() {
                    let problem = Problem::new(Location::file(&path), "a facet table counts once, and whole")
                        .with_help("its light and heat are of this scene: other maps may have weights");
                    return Err(Error::Invalid(vec![problem]));
                }
                tables_from.push(path.clone());
                tables = Some(self::table(&path, &arguments.scene, &opened)?);
                options.add_solved = true;
                continue;
            }
            let found = radiance_map::open(&path, &opened.scene, weight, &watch)?;
            opened.inputs.extend(found.inputs.iter().map(Input::from));
            opened.warnings.extend(found.notes);
            if terms.len() <= term {
                terms.push(Vec::new());
            }
            terms[term].extend(found.maps);
            term += 1;
        }
        counts.extend((term > 0).then_some(term));
    }
    if counts.iter().any(|count| *count != counts[0]) {
        let problem = Problem::new(Location::item("--radiance"), format!("names {counts:?} maps: each time as many"))
            .with_help("given several times, it names views of the same sum, its terms in the same order");
        return Err(Error::Invalid(vec![problem]));
    }
    terms.retain(|term| !term.is_empty());
    if matches!(arguments.views, Views::Interpolated) && terms.iter().all(|views| views.len() < 2) {
        opened.warnings.push("--views interpolated: there is one view, and nothing to interpolate between".to_owned());
    }
    arguments.product.admit(&staged, &opened, &tables_from, true, Extras::default())?;
    let table = match tables {
        Some(table) => table,
        None if options.fill == Fill::Solved => solve::solve(&opened.scene, &watch)?,
        None => solve::lit(&opened.scene, &watch)?,
    };
    let (observation, maps) = study::observe_maps(&opened.scene, &table, terms, &options, &watch)?;
    let table_from = tables_from.pop();
    let made = Made { opened, table, table_from, observation, maps: Some(maps) };
    product::write("integrate", &arguments.product, staged, &made, Extras::default(), console)
}

fn no_radiance() -> Error {
    Error::invalid(Location::item("--table"), "give `--table`, `--radiance`, or both")
}

/// A table of facets of this scene.
fn table(path: &Path, scene: &Path, opened: &Opened) -> Result<FacetTable> {
    let (table, header) = npz::read_table(path)?;
    if header.scene != study::table_id(&opened.scene) {
        let problem = Problem::new(
            Location::file(path),
            "was solved for another scene: another mesh, origin, Sun, Mars or heat (camera, bands and spectra may differ, but not what follows \
             from them: a total of the Sun, and Bond albedos)",
        );
        let own = |d: &&String| d.contains(".bond_albedo = ");
        let follow: Vec<&str> =
            opened.defaults.iter().filter(own).filter_map(|d| Some(d.split_once(" = ")?.0)).take(8).collect();
        let follow = match follow.is_empty() {
            true => String::new(),
            false => format!(
                "; not given, and so of the reflectance: {} (a table outlives its change if they are)",
                follow.join(", ")
            ),
        };
        let help = format!("solve it again: mmxrt solve {} -o TABLE.npz{follow}", scene.display());
        return Err(Error::Invalid(vec![problem.with_help(help)]));
    }
    Ok(table)
}

/// Whether a file is one of our facet tables.
fn is_table(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "npz")
        && npz::list(path).is_ok_and(|(header, _)| header.is_some_and(|h| h.format == npz::TABLE))
}

/// `A+B*0.5`: paths and what they are multiplied by. A path that is there is taken as it stands.
fn summands(text: &str) -> Result<Vec<(PathBuf, f64)>> {
    if Path::new(text).exists() {
        return Ok(vec![(text.into(), 1.0)]);
    }
    let summand = |part: &str| {
        let (mut path, mut weight) = (part.trim(), Ok(1.0));
        while let Some((before, factor)) = path.rsplit_once('*').filter(|_| !Path::new(path).exists()) {
            path = before.trim();
            let factor = factor.trim().parse::<f64>().map_err(|_| format!("{:?} is no weight", factor.trim()));
            weight = weight.and_then(|weight| Ok(weight * factor?));
        }
        let weight = if path.is_empty() { Err("a map has no name".to_owned()) } else { weight };
        weight.map(|weight| (path.into(), weight)).map_err(|message| {
            let at = Location::item(format!("--radiance {text:?}"));
            let help = "maps are joined as A.img+B.img*0.5; those with + or * in their names are named in map files, as `raster`";
            Error::Invalid(vec![Problem::new(at, message).with_help(help)])
        })
    };
    text.split('+').map(summand).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_add_up_with_weights() {
        let of = |text: &str| {
            summands(text).unwrap().into_iter().map(|(p, w)| (p.display().to_string(), w)).collect::<Vec<_>>()
        };
        assert_eq!(of("a.img"), [("a.img".into(), 1.0)]);
        assert_eq!(of("a.img + b/c.img*0.5"), [("a.img".into(), 1.0), ("b/c.img".into(), 0.5)]);
        let wrong = |text: &str| summands(text).unwrap_err().to_string();
        for (text, message) in [
            ("", "--radiance \"\": a map has no name"),
            ("a.img+", "a map has no name"),
            ("*2", "a map has no name"),
            ("a*b.img", "\"b.img\" is no weight"),
            ("a.img*", "\"\" is no weight"),
        ] {
            assert!(wrong(text).contains(message), "{}", wrong(text));
        }
    }
}
