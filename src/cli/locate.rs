//! `mmxrt locate`: where on the ground a pixel looks, and in which pixel a point of the ground lies.

use std::path::PathBuf;

use glam::DVec3;
use mmxrt::formats::points_csv::{self, Asked, Question};
use mmxrt::study::locate::Place;
use mmxrt::{Result, job};
use serde_json::json;

use super::Outcome;
use super::console::Console;

#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("asked").required(true).multiple(true)))]
pub(crate) struct Arguments {
    /// The scene file, or a campaign's
    scene: PathBuf,
    /// Of a campaign, which acquisition
    #[arg(long, value_name = "NAME")]
    acquisition: Option<String>,
    /// A place of the image, pixels from the outer corner of the first pixel: the middle of the first pixel is 0.5,0.5
    #[arg(long, value_name = "SAMPLE,LINE", group = "asked", value_parser = pixel, allow_hyphen_values = true)]
    pixel: Vec<Place>,
    /// A point of the ground in the body-fixed frame, from the body's centre, m
    #[arg(long, value_name = "X,Y,Z", group = "asked", value_parser = point, allow_hyphen_values = true)]
    ground: Vec<DVec3>,
    /// A table of places (columns sample, line) or points (x_m, y_m, z_m), each of a `band` if it has that column
    #[arg(long, value_name = "FILE.csv", group = "asked")]
    points: Option<PathBuf>,
    /// The band, counted from 1, of a sensor that takes one after the other. Default: the reference, the middle one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    band: Option<u32>,
    /// Write the answers as a table, instead of printing them
    #[arg(long, short, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// Replace that file if it is there
    #[arg(long)]
    force: bool,
}

fn numbers<const N: usize>(text: &str, example: &str) -> std::result::Result<[f64; N], String> {
    let values: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
    values.and_then(|values| values.try_into().ok()).ok_or_else(|| format!("give {N} numbers, as {example}"))
}

fn pixel(text: &str) -> std::result::Result<Place, String> {
    numbers(text, "128.5,0.5").map(|[sample, line]| Place { sample, line })
}

fn point(text: &str) -> std::result::Result<DVec3, String> {
    numbers(text, "-2743.6,11860.0,0.5").map(DVec3::from_array)
}

pub(crate) fn run(arguments: &Arguments, console: &Console) -> Result<Outcome> {
    let watch = |progress| console.watch(progress);
    super::settle_input(&arguments.scene, console)?;
    let band = arguments.band.map(|band| band as usize - 1);
    let question = |asked| Question { asked, band };
    let mut questions: Vec<Question> = arguments.pixel.iter().map(|place| question(Asked::Pixel(*place))).collect();
    questions.extend(arguments.ground.iter().map(|point_m| question(Asked::Ground(*point_m))));
    if let Some(path) = &arguments.points {
        questions.extend(points_csv::read(path)?.into_iter().map(|of| Question { band: of.band.or(band), ..of }));
    }
    let answers = job::locate(&arguments.scene, arguments.acquisition.as_deref(), &questions, &watch)?;
    let rows: Vec<String> = questions
        .iter()
        .zip(&answers)
        .map(|(question, (band, found))| points_csv::row(question, *band, found))
        .collect();
    let text = format!("{}\n{}", points_csv::COLUMNS, rows.join("\n"));
    match &arguments.output {
        Some(path) => {
            let inputs: Vec<_> = arguments.points.iter().chain([&arguments.scene]).map(PathBuf::as_path).collect();
            job::write_answers(path, arguments.force, &format!("{text}\n"), &inputs)?;
            console.note(&format!("{}: {} answers", path.display(), rows.len()));
        }
        None => console.result(&text, &json!({ "columns": points_csv::COLUMNS, "rows": rows }))?,
    }
    Ok(Outcome::Done)
}
