//! `mmxrt locate`: where on the ground a pixel looks, and in which pixel a point of the ground lies.

use std::path::{Path, PathBuf};

use glam::DVec3;
use mmxrt::formats::Reading;
use mmxrt::formats::points_csv::{self, Asked, Question};
use mmxrt::job::{Mapped, SceneOf};
use mmxrt::study::MapWish;
use mmxrt::study::knowledge::{Row, Spread};
use mmxrt::study::locate::Place;
use mmxrt::{Result, job};
use serde_json::json;

use super::Outcome;
use super::console::Console;
use super::dry_run::short;
use super::scene::ReadingArguments;

#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("asked").required(true).multiple(true)))]
pub(crate) struct Arguments {
    /// The scene file, or a campaign's; with --ortho also a product folder, whose image is mapped
    scene: PathBuf,
    /// The acquisition of a campaign
    #[arg(long, value_name = "NAME")]
    acquisition: Option<String>,
    /// A place of the image, pixels from the outer corner of the first pixel: the middle of the first pixel is 0.5,0.5
    #[arg(long, value_name = "SAMPLE,LINE", group = "asked", value_parser = pixel, allow_hyphen_values = true)]
    pixel: Vec<Place>,
    /// A point of the ground in the body-fixed frame, from the body's centre, m. `inside` says whether it falls into the image, `hidden_by` which facet hides it there, `reason` why nothing is seen
    #[arg(long, value_name = "X,Y,Z", group = "asked", value_parser = point, allow_hyphen_values = true)]
    ground: Vec<DVec3>,
    /// A table of places (columns sample, line) or points (x_m, y_m, z_m), each of a `band` if it has that column
    #[arg(long, value_name = "FILE.csv", group = "asked")]
    points: Option<PathBuf>,
    /// Geolocation error per pixel, from the uncertainties in this file (schemas/knowledge.schema.json)
    #[arg(long, value_name = "KNOWLEDGE.toml", group = "asked", conflicts_with_all = ["pixel", "ground", "points"])]
    knowledge: Option<PathBuf>,
    /// With --knowledge: every N-th pixel in either direction; 1 is all. Default: at most 256 pixels
    #[arg(long, value_name = "N", requires = "knowledge", value_parser = clap::value_parser!(u32).range(1..))]
    every: Option<u32>,
    /// Orthorectify the image: `tangent:CELL`, the plane through the scene's origin, m, or `plate-carree:CELL`,
    /// longitudes and latitudes, deg
    #[arg(long, value_name = "MAP:CELL", group = "asked", conflicts_with_all = ["pixel", "ground", "points", "knowledge", "acquisition"], requires = "output", value_parser = map)]
    ortho: Option<MapWish>,
    /// With --ortho: west, south, east and north borders of the map, in its unit; default: the image's extent
    #[arg(long, value_name = "W,S,E,N", requires = "ortho", value_parser = borders, allow_hyphen_values = true)]
    borders: Option<[f64; 4]>,
    /// With --ortho of a product of a campaign: the campaign's file
    #[arg(long, value_name = "CAMPAIGN.toml", requires = "ortho")]
    campaign: Option<PathBuf>,
    /// Write the camera for other programs: image support data (ISD) for the models of usgscsm
    #[arg(long, value_name = "OUT.json", group = "asked", conflicts_with_all = ["pixel", "ground", "points", "knowledge", "ortho", "output"])]
    isd: Option<PathBuf>,
    /// The band, counted from 1, of a sensor that takes bands one after another. Default: the middle one, the reference
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    band: Option<u32>,
    /// Write the answers as a table, instead of printing them; with --knowledge a folder with errors.csv, errors.img (of the pixels told) and errors.json, with --ortho one with ortho.img, lookup.npz and ortho.json
    #[arg(long, short, value_name = "FILE.csv|FOLDER")]
    output: Option<PathBuf>,
    /// Replace that file or folder if it is there
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    reading: ReadingArguments,
}

fn numbers<const N: usize>(text: &str, example: &str) -> std::result::Result<[f64; N], String> {
    let values: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    values.and_then(|values| values.try_into().ok()).ok_or_else(|| format!("give {N} numbers, e.g. {example}"))
}

fn pixel(text: &str) -> std::result::Result<Place, String> {
    numbers(text, "128.5,0.5").map(|[sample, line]| Place { sample, line })
}

fn borders(text: &str) -> std::result::Result<[f64; 4], String> {
    numbers(text, "-100,-50,100,50")
}

fn map(text: &str) -> std::result::Result<MapWish, String> {
    let known = |(name, cell): (&str, &str)| {
        let plate_carree = match name {
            "tangent" => false,
            "plate-carree" => true,
            _ => return None,
        };
        let cell = cell.trim().parse().ok().filter(|cell: &f64| *cell > 0.0 && cell.is_finite())?;
        Some(MapWish { plate_carree, cell, borders: None })
    };
    text.split_once(':').and_then(known).ok_or_else(|| {
        "give tangent:CELL, e.g. tangent:5 (m), or plate-carree:CELL, e.g. plate-carree:0.01 (deg)".into()
    })
}

fn point(text: &str) -> std::result::Result<DVec3, String> {
    numbers(text, "-2743.6,11860.0,0.5").map(DVec3::from_array)
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle_input(&arguments.scene, console)?;
    let reading = &arguments.reading.reading(console)?;
    let of = SceneOf { file: &arguments.scene, acquisition: arguments.acquisition.as_deref(), reading };
    let band = arguments.band.map(|band| band as usize - 1);
    if let Some(known) = &arguments.knowledge {
        return errors(arguments, of, known, band, console);
    }
    if let Some(target) = &arguments.isd {
        super::settle(target, console)?;
        job::write_isd(of, band, (target, arguments.force), &watch)?;
        console.done(
            &format!("{}: image support data", target.display()),
            &json!({ "isd": target.display().to_string() }),
        );
        return Ok(Outcome::Done);
    }
    if let (Some(wish), Some(target)) = (arguments.ortho, &arguments.output) {
        return mapped(arguments, reading, (MapWish { borders: arguments.borders, ..wish }, band), target, console);
    }
    let question = |asked| Question { asked, band };
    let mut questions: Vec<Question> = arguments.pixel.iter().map(|place| question(Asked::Pixel(*place))).collect();
    questions.extend(arguments.ground.iter().map(|point_m| question(Asked::Ground(*point_m))));
    if let Some(path) = &arguments.points {
        questions.extend(points_csv::read(path)?.into_iter().map(|of| Question { band: of.band.or(band), ..of }));
    }
    let subject = of.open(&watch)?;
    let answers = job::answers(&subject, reading, &questions, &watch)?;
    let rows: Vec<String> = questions
        .iter()
        .zip(&answers)
        .map(|(question, (band, found))| points_csv::row(question, *band, found))
        .collect();
    let text = format!("{}\n{}", points_csv::COLUMNS, rows.join("\n"));
    match &arguments.output {
        Some(path) => {
            let read = subject.inputs.iter().map(|input| &input.path);
            let inputs: Vec<_> =
                read.chain(&arguments.points).chain([&arguments.scene]).map(PathBuf::as_path).collect();
            job::write_answers(path, arguments.force, &format!("{text}\n"), &inputs)?;
            console.note(&format!("{}: {} answers", path.display(), rows.len()));
        }
        None => console.result(&text, &json!({ "columns": points_csv::COLUMNS, "rows": rows }))?,
    }
    Ok(Outcome::Done)
}

/// Geolocation errors.
fn errors(
    arguments: &Arguments,
    of: SceneOf<'_>,
    known: &Path,
    band: Option<usize>,
    console: &Console,
) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    if let Some(target) = &arguments.output {
        super::settle(target, console)?;
    }
    let folder = arguments.output.as_deref().map(|target| (target, arguments.force));
    let (rows, json) = job::locate_errors(of, known, (arguments.every, band), folder, &watch)?;
    let text = summary_text(&rows);
    match &arguments.output {
        Some(target) => console.done(&format!("{}:\n{text}", target.display()), &json),
        None => console.result(&text, &json)?,
    }
    Ok(Outcome::Done)
}

/// Orthorectification.
fn mapped(
    arguments: &Arguments,
    reading: &Reading,
    wish: (MapWish, Option<usize>),
    target: &Path,
    console: &Console,
) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle(target, console)?;
    let Mapped { grid, entries, bands } = job::ortho(
        (&arguments.scene, arguments.campaign.as_deref(), reading),
        wish,
        (target, arguments.force),
        &watch,
    )?;
    let text =
        format!("{}: {} x {} cells, {entries} entries, {bands} bands", target.display(), grid.columns, grid.rows);
    let json = json!({
        "map": target.display().to_string(), "columns": grid.columns, "rows": grid.rows, "entries": entries, "bands": bands
    });
    console.done(&text, &json);
    Ok(Outcome::Done)
}

/// Horizontal errors, by source.
fn summary_text(rows: &[Row]) -> String {
    let heading =
        ["source", "pixels", "mean, m", "rms, m", "p95, m", "max, m", "rms, px", "p95, px"].map(str::to_owned);
    let of_row = |row: &Row| {
        let Spread { mean, rms, p95, max } = row.level_m;
        let [mean, rms, p95, max, rms_px, p95_px] =
            [mean, rms, p95, max, row.level_px.rms, row.level_px.p95].map(short);
        [row.source.to_owned(), row.pixels.to_string(), mean, rms, p95, max, rms_px, p95_px]
    };
    let lines = std::iter::once(heading).chain(rows.iter().map(of_row));
    let told = lines.map(|cells| {
        let (source, others) = (&cells[0], cells[1..].iter().map(|cell| format!("{cell:>12}")));
        format!("{source:14}{}", others.collect::<String>())
    });
    told.collect::<Vec<_>>().join("\n")
}
